"""Parsing by a whitelist: what it reads is exact, and a refusal states the reason and the place."""

import pytest
import sympy
from hypothesis import given, settings
from hypothesis import strategies as st

from geomtorsion.errors import ExpressionError, GeomtorsionError, LimitError
from geomtorsion.exact.parsing import parse_expression

t, r, theta, M = sympy.symbols("t r theta M", positive=True)
NAMES = {"t": t, "r": r, "theta": theta, "M": M}
f, h = sympy.Function("f"), sympy.Function("h")


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        ("0", 0),
        ("007", 7),
        ("1_000", 1000),
        ("2/6", sympy.Rational(1, 3)),
        ("2 - 3 - 4", -5),
        ("2 - (3 - 4)", 3),
        ("M/r/2*theta", M * theta / (2 * r)),
        ("-r**2", -(r**2)),
        ("(-r)**2", r**2),
        ("-r^2", -(r**2)),
        ("r^-2", 1 / r**2),
        ("2**3**2", 512),
        ("r*-M", -r * M),
        ("2^(1/2)", sympy.sqrt(2)),
        ("sqrt(1 - 2*M/r)", sympy.sqrt(1 - 2 * M / r)),
        ("2 r", 2 * r),
        ("2r sin(theta)", 2 * r * sympy.sin(theta)),
        ("r^2 (1 + M)(1 - M)", r**2 * (1 + M) * (1 - M)),
        ("1/2 r M", r * M / 2),
        ("1/2 (r)(M)M", r * M**2 / 2),
        ("-1/2 r + 1/3 M", -r / 2 + M / 3),
        ("r/2*M theta", r * M * theta / 2),
        ("(r + M)sqrt(r)", (r + M) * sympy.sqrt(r)),
        ("f(r) r", f(r) * r),
        ("pi*E", sympy.pi * sympy.E),
        ("π", sympy.pi),
        ("I**2", -1),
        ("r·M − 1 × 2", r * M - 2),
        ("ln(r) + log(r) + arcsin(0)", 2 * sympy.log(r)),
        ("log(r, 2)", sympy.log(r) / sympy.log(2)),
        ("atan2(r, M)", sympy.atan2(r, M)),
        ("  r\n  + M\t", r + M),
        ("f(r)*h(r, theta)", f(r) * h(r, theta)),
        ("diff(f(r), r)", f(r).diff(r)),
        ("Derivative(f(r), r)", f(r).diff(r)),
        ("diff(h(r, theta), r, 2, theta)", h(r, theta).diff(r, 2, theta)),
        ("diff(diff(f(r), r), r)", f(r).diff(r, 2)),
        ("Derivative(f(r), (r, 2))", f(r).diff(r, 2)),
        ("Derivative(h(r, t), t, (r, 2))", h(r, t).diff(r, 2, t)),
        ("2*Subs(Derivative(f(x), x), x, 2*r)", f(2 * r).diff(r)),
        ("r**2*Subs(diff(h(r+M, y), y, 2), y, r*t)", h(r + M, r * t).diff(t, 2)),
    ],
)
def test_written_text_reads_back(text, expected):
    """Precedence, associativity, powers and names of functions follow mathematical notation."""
    assert parse_expression(text, NAMES) == expected


@pytest.mark.parametrize(
    "name",
    "sin cos tan cot sec csc sinh cosh tanh coth sech csch exp asin acos atan acot asec acsc asinh "
    "acosh atanh acoth asech acsch".split(),
)
def test_each_function_is_sympys(name):
    """A function of the whitelist is the sympy function of the same name."""
    assert parse_expression(f"{name}(r/7)", NAMES) == getattr(sympy, name)(r / 7)


def test_a_declared_name_wins():
    """A coordinate may be called E, pi, sin or even lambda."""
    symbols = {name: sympy.Symbol(name) for name in ("E", "pi", "lambda", "is", "λ", "_")}
    for name, symbol in symbols.items():
        assert parse_expression(f"2*{name}", symbols) == 2 * symbol


def test_a_declared_function_may_be_written_without_its_arguments():
    """With a = a(t) declared, a means a(t), and a(2*t) is still possible."""
    functions = {"a": sympy.Function("a")(t)}
    a = functions["a"]
    assert parse_expression("a**2 + diff(a, t)", NAMES, functions) == a**2 + a.diff(t)
    assert parse_expression("a(2*t)", NAMES, functions) == a.func(2 * t)
    assert parse_expression("g(t)", NAMES, {"g": sympy.Function("g")}) == sympy.Function("g")(t)
    with pytest.raises(ExpressionError, match="a takes 1 argument, not 2"):
        parse_expression("a(t, r)", NAMES, functions)


def test_functions_must_be_declared_once_any_are():
    """With a list of functions given, even an empty one, unknown calls are errors."""
    with pytest.raises(ExpressionError, match="f is not a function that is known here"):
        parse_expression("f(r)", NAMES, {})
    assert parse_expression("f(r)", NAMES, None) == f(r)


@pytest.mark.parametrize(
    "text",
    [
        "__import__('os').system('true')",
        "__import__",
        "_",
        "().__class__",
        "r.diff(r)",
        "r . diff",
        "lambda: 0",
        "lambda x: x",
        "[r for r in M]",
        "{r}",
        "r[0]",
        "'r'",
        'f"{r}"',
        "r if M else 0",
        "r and M",
        "not r",
        "r < M",
        "r == M",
        "r = M",
        "(r := M)",
        "f(r=1)",
        "f(*r)",
        "f(**r)",
        "r; M",
        "r # M",
        "r % M",
        "r // M",
        "r @ M",
        "r | M",
        "~r",
        "r!",
        "2j",
        "0x10",
        "True",
        "None",
        "eval(r)",
        "exec(r)",
        "open(r)",
        "import os",
        "r\\\nM",
        "r\0",
        "...",
        "`r`",
        "$r",
    ],
)
def test_code_is_refused(text):
    """Text with a meaning in a programming language is refused, and nothing is executed."""
    with pytest.raises(ExpressionError, match=r"(?s)entry: .+\n    .*\^"):
        parse_expression(text, NAMES, where="entry")


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("", "is empty"),
        ("   ", "is empty"),
        ("r +", r"missing after \+"),
        ("* r", r"missing before \*"),
        ("r * / M", "missing before /"),
        ("()", r"missing before \)"),
        ("sin()", "sin takes 1 argument, not 0"),
        ("sin(r, M)", "sin takes 1 argument, not 2"),
        ("log(r, 2, 3)", "log takes 1 or 2 arguments, not 3"),
        ("f()", "f is not a function"),
        ("(r", "never closed"),
        ("r)", "no opening one"),
        ("r, M", "a comma is allowed only between"),
        ("(r, M)", "a comma is allowed only between"),
        ("2 3", "missing between 2 and 3"),
        ("1/2r", "in two ways"),
        ("1/r M", "in two ways"),
        ("r/(2 M)(r)", "in two ways"),
        ("E^2 r", "in two ways"),
        ("(r)2", r"missing between \) and 2"),
        ("sin r", "sin is a function"),
        ("r(2)", r"r is a symbol.*\n.*\n.*\nFor a product write r\*"),
        ("sin", "Write its argument"),
        ("0.1*r", "Write 1/10 if"),
        (".5", "Write 1/2 if"),
        ("2.", "Write 2 if"),
        ("1e-3", "Write 1/1000 if"),
        ("1.5e90", r"Write 3/2\*10\*\*\(90\) if"),
        ("thetta", "Did you mean theta"),
        ("Theta", "Did you mean theta"),
        ("θ", "Did you mean theta"),
        ("q", "Declare q as a parameter"),
        ("sinn(r)", "Did you mean sin"),
        ("Sin(r)", "Did you mean sin"),
        ("sign(r)", "sign is not smooth"),
        ("floor(r)", "floor is not smooth"),
        ("Piecewise(r)", "Piecewise is not smooth"),
        ("1/0", "division by zero"),
        ("1/(r - r)", "division by zero"),
        ("0**-1", "division by zero"),
        ("log(0)", "no finite value"),
        ("tan(pi/2)", "no finite value"),
        ("diff(r)", "needs a function and a symbol"),
        ("diff(sin(r), r)", "only unknown functions"),
        ("diff(f(r), 2)", "2 is not a symbol"),
        ("diff(f(r), r, r*M)", r"M\*r is not a symbol"),
        ("diff((f(r), r), r)", "a comma is allowed only between"),
        ("diff(f(r), ())", r"missing before \)"),
        ("diff(f(r), (r, 2,))", r"missing before \)"),
        ("diff(f((r, 2)), r)", "a comma is allowed only between"),
        ("sin((r, 2))", "a comma is allowed only between"),
        ("Subs(f(r), r)", "Subs needs a derivative, its"),
        ("Subs(f(r), r, 2)", "only derivatives of unknown functions"),
        ("Subs(diff(f(x), x), x, (r, t))", "one place for each"),
        ("Subs(diff(f(x), x), (x, x), (r, t))", "one place for each"),
        ("Subs(diff(f(x), x), 2*x, r)", "one place for each"),
    ],
)
def test_an_error_names_the_reason_and_the_remedy(text, message):
    """Each mistake has its own message."""
    with pytest.raises(ExpressionError, match=message):
        parse_expression(text, NAMES)


def test_an_error_points_at_the_part():
    """Carets mark exactly the wrong part, also in a long text."""
    with pytest.raises(ExpressionError) as caught:
        parse_expression("r^2 + sin(thetta)*r", NAMES, where="coframe[0, 1]")
    first, shown, caret, remedy = str(caught.value).split("\n")
    assert first == "coframe[0, 1]: thetta is neither a coordinate nor a declared parameter"
    assert shown[caret.index("^") : caret.rindex("^") + 1] == "thetta"
    assert remedy == "Did you mean theta? Otherwise declare thetta as a parameter."

    with pytest.raises(ExpressionError) as caught:
        parse_expression("r + " * 500 + "thetta" + " + r" * 500, NAMES)
    _, shown, caret, _ = str(caught.value).split("\n")
    assert len(shown) < 100
    assert shown[caret.index("^") : caret.rindex("^") + 1] == "thetta"


def test_decimals_are_read_on_request():
    """With decimals=True, 0.1 is read as 1/10, never as a float; the limit on digits holds."""
    read = {
        "0.1*r": r / 10,
        "2.5e-3": sympy.Rational(1, 400),
        ".5 + 1.": sympy.Rational(3, 2),
        "1e3*M": 1000 * M,
        "1_0.2_5": sympy.Rational(41, 4),
        "r**0.5": sympy.sqrt(r),
    }
    for text, expected in read.items():
        assert parse_expression(text, NAMES, decimals=True) == expected
    with pytest.raises(LimitError, match="more digits than the limit"):
        parse_expression("1e5000", NAMES, decimals=True)
    for text in ("1.2.3", "1.e", "0x1.8p0", "1..2", "r.5"):
        with pytest.raises(ExpressionError):
            parse_expression(text, NAMES, decimals=True)


def _texts() -> st.SearchStrategy[str]:
    """Texts of nested expressions with all operators."""
    leaves = st.sampled_from(["r", "M", "theta", "2", "3/4", "f(r)", "pi"])
    return st.recursive(
        leaves,
        lambda inner: st.one_of(
            st.tuples(inner, st.sampled_from(["+", "-", "*", "/"]), inner).map(
                lambda p: f"({p[0]}){p[1]}({p[2]})"
            ),
            inner.map(lambda x: f"sin({x})"),
            inner.map(lambda x: f"-({x})^2"),
        ),
        max_leaves=8,
    )


@settings(max_examples=60, deadline=None)
@given(_texts())
def test_agrees_with_sympys_own_reader(text):
    """Agreement with an independent reader: sympy's, which evaluates code and never sees files."""
    try:
        value = parse_expression(text, NAMES)
    except ExpressionError as error:
        assert "division by zero" in str(error)  # noqa: PT017 - the only error that may occur
        return
    expected = sympy.sympify(text.replace("^", "**"), locals={**NAMES, "f": f})
    assert value == expected


@settings(max_examples=100, deadline=None)
@given(st.text(max_size=30))
def test_any_text_is_read_or_refused(text):
    """Any text is read or raises an error of our own."""
    try:
        value = parse_expression(text, NAMES)
    except GeomtorsionError:
        return
    assert isinstance(value, sympy.Basic)


@settings(max_examples=300, deadline=None)
@given(st.lists(st.sampled_from("r M 2 0 + - * / ** ^ ( ) , sin f diff I . _ [ lambda".split())))
def test_any_sequence_of_tokens_is_read_or_refused(pieces):
    """As above, with texts that resemble expressions more closely."""
    for text in (" ".join(pieces), "".join(pieces)):
        try:
            value = parse_expression(text, NAMES)
        except GeomtorsionError:
            continue
        assert isinstance(value, sympy.Basic)


def test_the_imaginary_unit_is_not_offered_for_a_moment_of_inertia():
    """I is not offered as a correction of I1, but it is offered for i."""
    with pytest.raises(ExpressionError) as refused:
        parse_expression("I1*2", {})
    assert "Did you mean" not in str(refused.value)
    with pytest.raises(ExpressionError, match="Did you mean I"):
        parse_expression("i*2", {})

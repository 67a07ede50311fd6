"""Expression graphs: all printers give the values of expressions and derivatives."""

import math
import re
import warnings
from fractions import Fraction

import mpmath
import numpy as np
import pytest
import sympy as sp
from hypothesis import given, settings
from hypothesis import strategies as st

from geomtorsion.codegen import compiled, graph
from geomtorsion.errors import ExpressionError, MissingValueError
from geomtorsion.exact import Field
from tests import strategies
from tests.codegen.systems import NAMES, SPACES, SYMBOLS, TABLE, geodesic_graph, geodesic_rates
from tests.rounding import ROUNDED

x, y, z, a, b = SYMBOLS
TEXTS = (
    "a*b*x*y + a*b*y*z - a**2*x**5/7",
    "1/x + 1/(y*z) - 3/x**2",
    "sqrt(x**2 + a**2)**3*sin(y) - cos(y)**4*b",
    "exp(-x)*cosh(y) + log(1 + z**2) - sinh(a*z)",
    "(x + y)**3/(x + y + z)**2/b",
    "atan(x/2) + asin(y/4) - pi*z",
    "(1 + x**2)**(1/3)*y - 2",
    "-(x + y + z)",
    "a**2*b**3*x/3",
    "0",
)
# Functions that a field does not read, or reads in another form.
TREES = (
    "atan2(y, x) + acos(z/3) - acosh(1 + x**2)*asinh(y)*atanh(z/2)",
    "tan(x)*tanh(y) + cot(x) + sech(y) - csc(z)",
    "x**y + (1 + x)**a + z**Rational(7, 2) + x**(-Rational(5, 3))",
    "x**100 + (x + y)**(-30)",
    "acos(x/5)*asech(z) + acoth(2 + x)",
)
KINKED = ("Abs(x - y)*sign(z - 1)", "Max(x, y, z) - Min(x, y)", "floor(7*x) + ceiling(3*y)*x")
POINT = [0.7, 1.3, 0.4, 0.6, 1.1]
VALUES = dict(zip(SYMBOLS, map(sp.Rational, POINT), strict=True))


def trees(texts):
    """Expressions from texts."""
    return [sp.sympify(text, TABLE) for text in texts]


def elements(texts):
    """The same expressions as elements of one field."""
    field = Field(SYMBOLS)
    return [field.read(tree) for tree in trees(texts)]


def expected(found):
    """Values by sympy, to 30 digits."""
    return [float(tree.subs(VALUES).evalf(30)) for tree in found]


OUTPUTS = {
    "elements": (elements(TEXTS), expected(trees(TEXTS))),
    "trees": (trees(TEXTS + TREES), expected(trees(TEXTS + TREES))),
    "both": ([*elements(TEXTS), *trees(TREES)], expected(trees(TEXTS + TREES))),
}
CASES = [(kind, factor) for kind in OUTPUTS for factor in (True, False)]


@pytest.mark.parametrize(("kind", "factor"), CASES)
def test_printers_without_an_engine(kind, factor):
    """Floats, arrays and exact numbers agree with sympy."""
    outputs, wanted = OUTPUTS[kind]
    made = graph(NAMES, outputs, ["a", "b"], factor=factor)
    assert made.python()(*POINT) == pytest.approx(wanted, rel=1e-13)
    found = made.numpy()(*(np.full((2, 3), value) for value in POINT))
    assert found.shape == (len(outputs), 2, 3)
    assert found[:, 1, 2] == pytest.approx(wanted, rel=1e-13)
    exact = made.exactly([sp.Rational(value) for value in POINT])
    assert [float(value) for value in exact] == pytest.approx(wanted, rel=ROUNDED)


@pytest.mark.parametrize(("kind", "factor"), CASES)
def test_heyoka_values(kind, factor):
    """heyoka's expressions agree with sympy in each precision."""
    hy = pytest.importorskip("heyoka")
    outputs, wanted = OUTPUTS[kind]
    known = dict(zip(NAMES, hy.make_vars(*NAMES), strict=True))
    made = graph(NAMES, outputs, ["a", "b"], factor=factor)
    for number_type in (float, np.longdouble):
        written = made.heyoka(
            known, lambda p, q, kind=number_type: hy.expression(kind(p) / kind(q))
        )
        function = hy.cfunc(written, list(known.values()), fp_type=number_type)
        values = function(np.array(POINT, dtype=number_type))
        assert [float(value) for value in values] == pytest.approx(wanted, rel=1e-13)


def test_kinks_have_values_but_no_taylor_series():
    """Abs, sign, Max, Min, floor and ceiling give numbers; heyoka's printer refuses them."""
    found = trees(KINKED)
    made = graph(NAMES, found)
    wanted = expected(found)
    assert made.python()(*POINT) == pytest.approx(wanted, rel=ROUNDED)
    assert made.numpy()(*POINT) == pytest.approx(wanted, rel=ROUNDED)
    assert [float(value) for value in made.exactly(POINT)] == pytest.approx(wanted, rel=ROUNDED)
    hy = pytest.importorskip("heyoka")
    known = dict(zip(NAMES, hy.make_vars(*NAMES), strict=True))
    with pytest.raises(ExpressionError, match="no Taylor series"):
        made.heyoka(known, lambda p, q: hy.expression(p / q))


random_expressions = strategies.expressions(strategies.COORDINATES)


@settings(max_examples=60, deadline=None)
@given(random_expressions, st.lists(st.fractions(-2, 2, max_denominator=8), min_size=5, max_size=5))
def test_random_expressions_by_all_printers(expression, point):
    """Random expressions at random points agree with sympy's evaluation to 40 digits."""
    names = [symbol.name for symbol in strategies.COORDINATES]
    table = {
        s: sp.Rational(p.numerator, p.denominator)
        for s, p in zip(strategies.COORDINATES, point, strict=True)
    }
    wanted = expression.subs(table).evalf(40)
    if not (wanted.is_number and wanted.is_finite and wanted.is_real):
        return
    read = Field(strategies.COORDINATES).read(expression)
    for output in (expression, read):
        for factor in (True, False):
            made = graph(names, [output], factor=factor)
            try:
                (exact,) = made.exactly(point, 200)
                (scale,) = made.sizes(*map(float, point))
            except ZeroDivisionError:
                continue
            assert abs(mpmath.mpf(str(wanted)) - float(exact)) <= ROUNDED * (1 + abs(float(exact)))
            if not math.isfinite(scale):
                continue
            bound = 1e-12 * (1 + scale)
            (value,) = made.python()(*map(float, point))
            assert abs(value - float(exact)) <= bound
            assert made.numpy()(*map(float, point))[0] == pytest.approx(value, abs=bound)


def far_point(names):
    """Numbers by name, outside all horizons."""
    point = {name: sp.Rational(2 * k + 5, 16) for k, name in enumerate(names)}
    return point | ({"r": sp.Integer(9)} if "r" in point else {})


def difference(one, two):
    """Absolute difference of two exact numbers."""
    with mpmath.workprec(250):
        numbers = [mpmath.mpf(x.numerator) / x.denominator if isinstance(x, Fraction) else x
                   for x in (one, two)]  # fmt: skip
        return abs(numbers[0] - numbers[1])


@pytest.mark.parametrize("name", SPACES)
def test_spaces_against_their_elements(name):
    """Rates of geodesics, factored or not, agree with their elements to 50 digits."""
    states, parameters, rates = geodesic_rates(name)
    names = [*states, *parameters]
    point = far_point(names)
    wanted = []
    with mpmath.workprec(200):
        for row in rates:
            total = mpmath.mpf(0)
            for element, factors in row:
                value = element.evaluate({s: point[s.name] for s in element.symbols}, 200)
                for factor in factors:
                    value = value * int(point[factor].p) / int(point[factor].q)
                total += value
            wanted.append(total)
    for factor in (True, False):
        made = geodesic_graph(name, factor=factor)
        exact = made.exactly(list(point.values()), 200)
        for one, two in zip(exact, wanted, strict=True):
            assert difference(one, two) < 1e-50
        floats = [float(value) for value in point.values()]
        assert made.python()(*floats) == pytest.approx(
            list(map(float, wanted)), rel=1e-12, abs=ROUNDED
        )


@pytest.mark.parametrize("name", SPACES)
def test_derivatives_of_spaces(name):
    """The Jacobian of geodesics agrees with the derivatives of their elements."""
    states, parameters, rates = geodesic_rates(name)
    names = [*states, *parameters]
    slopes = []
    for row in rates:
        for state in states:
            terms = []
            for element, factors in row:
                terms += [(element.diff(s), factors) for s in element.symbols if s.name == state]
                rest = list(factors)
                if state in rest:
                    rest.remove(state)
                    terms.append((element * factors.count(state), tuple(rest)))
            slopes.append(tuple(terms))
    point = list(far_point(names).values())
    wanted = graph(names, slopes, factor=False).exactly(point, 200)
    found = geodesic_graph(name).derivative(states).exactly(point, 200)
    for one, two in zip(found, wanted, strict=True):
        assert difference(one, two) < 1e-50


def test_derivatives_of_every_function():
    """First and second derivatives of each function agree with sympy."""
    found = trees(TEXTS + TREES)
    made = graph(NAMES, found)
    first = made.derivative(NAMES)
    wanted = [tree.diff(symbol) for tree in found for symbol in SYMBOLS]
    assert first.python()(*POINT) == pytest.approx(expected(wanted), rel=1e-12, abs=1e-13)
    second = first.derivative(["y"])
    wanted = [tree.diff(symbol, y) for tree in found for symbol in SYMBOLS]
    assert second.python()(*POINT) == pytest.approx(expected(wanted), rel=1e-11, abs=1e-12)


def test_derivatives_of_kinks():
    """Abs has the derivative of its side, and steps have derivative zero; Max is refused."""
    made = graph(["x"], [sp.Abs(x), sp.sign(x) * x, sp.floor(x) + x]).derivative(["x"])
    assert made.python()(-0.5) == (-1.0, -1.0, 1.0)
    with pytest.raises(ExpressionError, match="Max has no derivative"):
        graph(["x"], [sp.Max(x, 1)]).derivative(["x"])


def test_exact_values_stay_fractions_where_they_can():
    """Rational outputs are fractions, and other outputs have the requested bits."""
    made = graph(["x"], [(x + 1) / 3, sp.sqrt(x), sp.Abs(x), sp.pi])
    third, root, size, pi = made.exactly([2], bits=300)
    assert third == Fraction(1)
    with mpmath.workprec(300):
        assert abs(root**2 - 2) < mpmath.mpf(2) ** -295
        assert abs(pi - mpmath.pi) < mpmath.mpf(2) ** -295
    assert size == 2


def test_sizes_add_up_the_sizes_of_the_terms():
    """The size of a value adds the sizes of its terms, also if factors are pulled out."""
    outputs = [x**2 * z - x * y * z, x - y, (x - y) / (x - z), sp.sin(x) - 1]
    made = graph(NAMES, outputs)
    point = np.array([[2.0, 3.0], [-2.0, 3.0], [5.0, -1.0]])
    px, py, pz = point
    wanted = [
        abs(px**2 * pz) + abs(px * py * pz),
        abs(px) + abs(py),
        (abs(px) + abs(py)) / abs(px - pz),
        abs(np.sin(px)) + 1,
    ]
    assert made.sizes(*point, 0.0, 0.0) == pytest.approx(np.array(wanted), rel=ROUNDED)


def test_arrays_without_values():
    """A missing value is nan or infinite, without a warning."""
    made = graph(["x", "y"], [1 / x, sp.sqrt(x), sp.log(x), x**y])
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        found = made.numpy()(np.array([-1.0, 0.0, 2.0]), 0.5)
    assert np.isfinite(found).tolist() == [
        [True, False, True],
        [False, True, True],
        [False, False, True],
        [False, True, True],
    ]


@pytest.mark.parametrize(
    ("outputs", "error"),
    [
        ([1 / x], ZeroDivisionError),
        ([sp.sqrt(x - 1)], ValueError),
        ([(x - 1) ** sp.Rational(1, 3)], ValueError),
        ([sp.log(x)], ValueError),
        ([sp.exp(1 / (x + sp.Rational(1, 10**6)))], OverflowError),
    ],
)
def test_floats_without_values(outputs, error):
    """On floats a missing value raises one of three errors."""
    with pytest.raises(error):
        graph(["x"], outputs).python()(0.0)


def test_powers_have_derivatives_where_their_base_vanishes():
    """heyoka divides by x in its series of x**n with n > 2; ours are finite at x = 0."""
    hy = pytest.importorskip("heyoka")
    made, nodes = decomposition(hy, "x**5*y + y", "x**7", "(x*y)**4 + z**3")
    assert not any("**" in node.replace("**2.0", "") for node in nodes)
    made.state[:] = [0.0, 0.5, -0.25]
    made.step()
    assert made.state[0] > 0
    assert all(math.isfinite(value) for value in made.state)


def decomposition(hy, *texts):
    """The equations that heyoka computes for x, y, z with these rates, as texts."""
    variables = hy.make_vars("x", "y", "z")
    made, _ = graph(["x", "y", "z", "a", "b"], elements(texts), ["a", "b"]).hoisted(3, "c")
    known = dict(zip("xyz", variables, strict=True))
    known |= {name: hy.par[k] for k, name in enumerate(made.arguments[3:])}
    rates = made.heyoka(known, lambda p, q: hy.expression(p / q))
    made = hy.taylor_adaptive(list(zip(variables, rates, strict=True)), [0.0] * 3, tol=1e-9)
    return made, [str(node) for node, _ in made.decomposition]


def test_terms_of_parameters_are_computed_before():
    """Terms of parameters only are computed before: a node contains at most one parameter."""
    hy = pytest.importorskip("heyoka")
    texts = "a*b*x*y", "a**2*x + sin(a)/b", "(a + b)*y*z/(a - b)"
    _, nodes = decomposition(hy, *texts)
    assert not any(len(re.findall(r"p\d", node)) > 1 for node in nodes)
    assert not any("sin" in node or ("p0" in node and "p1" in node) for node in nodes)


def test_inverses_are_quotients():
    """1/x is written as a quotient, which costs less than a power."""
    hy = pytest.importorskip("heyoka")
    _, nodes = decomposition(hy, "1/x", "1/(1 + y**2)", "z")
    assert not any("**-1" in node for node in nodes)
    assert sum("div" in node for node in nodes) == 2


def test_nothing_is_too_long_or_too_deep():
    """Sums of ten thousand terms, and functions 120 deep, run on floats and arrays."""
    symbols = sp.symbols("c0:10000")
    long = graph([s.name for s in symbols], [sp.Add(*symbols)])
    assert long.python()(*[1.0] * 10000) == (10000.0,)
    deep, value = x, 0.5
    for _ in range(120):
        deep = sp.sin(1 + deep)
        value = math.sin(1 + value)
    made = graph(["x"], [deep])
    assert made.python()(0.5) == pytest.approx((value,), rel=1e-12)
    assert made.derivative(["x"]).numpy()([0.5, 0.6]).shape == (1, 2)


def test_one_content_one_key():
    """The key depends on order and constants, but not on names; equality depends on names."""
    one, two = (graph(["x", "y"], [x * y + sp.sin(x)], ["y"]) for _ in range(2))
    assert one is not two
    assert one == two
    assert hash(one) == hash(two)
    renamed = graph(["z", "a"], [z * a + sp.sin(z)], ["a"])
    assert renamed.key == one.key
    assert renamed != one
    assert graph(["x", "y"], [x * y + sp.sin(x)], []).key != one.key
    assert graph(["y", "x"], [x * y + sp.sin(x)], ["y"]).key != one.key
    assert one.python() is renamed.python()


def test_outputs_of_all_kinds_share_their_parts():
    """An element, a sum of products, an expression and numbers share steps in one graph."""
    field = Field(SYMBOLS)
    wave = field.read(sp.sin(x) * y)
    made = graph(NAMES, [wave, ((wave, ("z", "z")),), sp.sin(x) * y + 1, 3, Fraction(1, 2), ()])
    assert sum(step.kind == "call" for step in made.steps) == 1
    assert made.size == 6
    wanted = math.sin(0.7) * 1.3
    assert made.python()(*POINT) == pytest.approx((wanted, wanted * 0.16, wanted + 1, 3, 0.5, 0))


def test_unknown_functions_by_name():
    """f(r) may be an argument; the error for a missing argument names it."""
    r, f = sp.Symbol("r"), sp.Function("f")
    element = Field([r]).read(f(r) / r)
    assert graph(["r", "f(r)"], [element]).python()(2.0, 3.0) == (1.5,)
    with pytest.raises(MissingValueError, match=r"f\(r\) is not among the arguments \(r\)"):
        graph(["r"], [element])
    with pytest.raises(MissingValueError, match=r"x is not among the arguments \(none\)"):
        graph([], [x])


def test_what_no_printer_knows():
    """Functions without a numerical form are refused by name."""
    with pytest.raises(ExpressionError, match=r"zeta\(x\) has no numerical form here"):
        graph(["x"], [sp.zeta(x)])
    with pytest.raises(ExpressionError, match="no numerical form"):
        graph(["x"], [x + sp.oo])


def test_special_functions_come_from_scipy():
    """Special functions with a form in scipy run on floats and on arrays."""
    element = Field([x]).read(sp.erf(x) + sp.besselj(0, x))
    made = graph(["x"], [element])
    wanted = float(sp.erf(sp.Rational(1, 2)) + sp.besselj(0, sp.Rational(1, 2)))
    assert made.python()(0.5) == pytest.approx((wanted,), rel=ROUNDED)
    assert made.numpy()([0.5])[0] == pytest.approx([wanted], rel=ROUNDED)


def test_text_becomes_a_function_once():
    """Equal texts give the same function."""
    text = "def values(a0): return (atan2(a0, 1.0),)"
    assert compiled(text, "floats") is compiled(text, "floats")
    assert compiled(text, "floats")(1.0) == compiled(text, "arrays")(1.0) == (math.pi / 4,)


@pytest.mark.parametrize(("gap", "certain"), [(2.0**-47, True), (2.0**-49, False)])
def test_a_sign_needs_a_value_above_rounding(gap, certain):
    """The terms of 1 - x add up to 2; a value below eight roundings of that has no sign."""
    made = graph(["x"], [1 - x]).above_rounding()
    assert (made.python()(1 - gap)[0] > 0) is certain


@pytest.mark.parametrize("longest", [5, 100])
def test_statements_of_any_length(longest, monkeypatch):
    """The length at which code is cut into statements does not change a single bit."""
    term = sp.Add(*(sp.sin(k * x) / (k + y) for k in range(1, 30)))
    values = graph(["x", "y"], [term]).python()(0.7, 1.3)
    monkeypatch.setattr("geomtorsion.codegen.printers._LONGEST_PIECE", longest)
    assert graph(["x", "y"], [term]).python()(0.7, 1.3) == values

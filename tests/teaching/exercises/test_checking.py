"""Checking: each diagnosis that depends only on the answer, and hostile answers."""

import pytest
import sympy as sp

from geomtorsion import exercises
from geomtorsion.errors import LimitError
from geomtorsion.exact import limits
from geomtorsion.teaching.exercises.checking import check_question
from geomtorsion.teaching.exercises.domain import Domain
from geomtorsion.teaching.exercises.question import Mistake, Question, advice
from tests.calls import python_calls

x, y = sp.symbols("x y", real=True)
t = sp.Symbol("t", positive=True)
WIDE = Domain((x, y, t), (x > 0, x < 2 * sp.pi, y > -1, y < 1))


def asked(answer, domain=WIDE, kind="expression", **more) -> Question:
    """A question with this answer."""
    return Question("q", kind, "What?", lambda: answer, domain, **more)


def code_of(question: Question, given) -> str:
    """The diagnosis of an answer, "right" if it is right."""
    said = check_question(question, given)
    return "right" if said.right else said.diagnosis


RIGHT_ON_A_PART = [
    (sp.sin(x), "sqrt(1 - cos(x)^2)"),
    (sp.cos(x), "sqrt(1 - sin(x)^2)"),
    (sp.cos(x), "sqrt(cos(x)^2)"),
    (y, "sqrt(y^2)"),
    (y**3, "y*sqrt(y^4)*y/sqrt(y^2)"),
    (sp.sin(2 * x), "2*sqrt(1 - cos(x)^2)*cos(x)"),
    (sp.tan(x), "sqrt(1/cos(x)^2 - 1)"),
    (sp.sin(x) / (2 + sp.cos(x)), "sqrt(1 - cos(x)^2)/(2 + cos(x))"),
    (y * t, "sqrt(y^2*t^2)"),
    (sp.sinh(y), "sqrt(cosh(y)^2 - 1)"),
    (sp.tanh(y), "sqrt(1 - 1/cosh(y)^2)"),
    (y, "(y^6)^(1/6)"),
    (x, "acos(cos(x))"),
    (x, "2*atan(tan(x/2))"),
    (y + 1 - 1, "sqrt((y + 1)^2) - sqrt(1) + (sqrt(y^2) - y)/2"),
    (sp.sin(x) * y, "y*sqrt(1 - cos(x)**2)"),
    (sp.cos(x / 2), "sqrt((1 + cos(x))/2)"),
    (sp.sin(x) ** 3, "(1 - cos(x)^2)*sqrt(1 - cos(x)^2)"),
    (sp.exp(y), "exp(sqrt(y^2))"),
    (sp.log(1 + y), "log((1 + y)^2)/2 + (sqrt(y^2) - y)"),
    (1 / y, "1/sqrt(y^2)"),
]


@pytest.mark.parametrize(("right", "given"), RIGHT_ON_A_PART, ids=lambda case: str(case)[:30])
def test_right_on_a_part_of_the_domain(right, given):
    """A root with the wrong sign on a part of the domain has a diagnosis of its own."""
    assert code_of(asked(right), given) == "domain"


@pytest.mark.parametrize(
    ("right", "given"),
    [
        (sp.sin(x / 2), "sqrt((1 - cos(x))/2)"),
        (t, "sqrt(t^2)"),
        (sp.cosh(y), "sqrt(1 + sinh(y)^2)"),
        (1 + y, "sqrt((1 + y)^2)"),
        (2 - y, "sqrt((y - 2)^2)"),
        (sp.exp(y), "cosh(y) + sinh(y)"),
        (sp.log(t**2), "2*log(t)"),
        (sp.sin(x) ** 2, "(1 - cos(2*x))/2"),
        (sp.S.Zero, "sin(x)^2 + cos(x)^2 - 1"),
        (
            x + 10**7 + sp.sqrt((x + 10**7) ** 2 - 1),
            "1/(x + 10^7 - sqrt((x + 10^7)^2 - 1))",
        ),
        (x**2, "10^20*x^2/10^20 + (x + 10^12)^2 - x^2 - 2*x*10^12 - 10^24"),
    ],
    ids=lambda case: str(case)[:30],
)
def test_roots_that_are_right_everywhere(right, given):
    """A form that agrees on the whole domain is right, also one that cancels twenty digits."""
    assert code_of(asked(right), given) == "right"


@pytest.mark.parametrize(
    ("right", "given"),
    [
        (sp.sin(x), "sin(x) + 10^(-20)"),
        (sp.sin(x), "sin(x)*(1 + t/10^12)"),
        (sp.pi * t, "22*t/7"),
        (sp.sqrt(2), "14142135623730951/10^16"),
        (sp.S.Zero, "10^(-15)*x"),
    ],
    ids=lambda case: str(case)[:30],
)
def test_nearly_right_is_wrong(right, given):
    """Equality is decided exactly: a difference far below double precision is an error."""
    assert code_of(asked(right), given) != "right"


@pytest.mark.parametrize(
    ("given", "code"),
    [
        ("-sin(x)", "sign"),
        ("2*sin(x)", "factor"),
        ("sin(x)/2", "factor"),
        ("sin(x)/3", ""),
        ("-2*sin(x)", "factor"),
        ("-sin(x)/2", "factor"),
    ],
)
def test_signs_and_factors(given, code):
    """A wrong sign and a factor 2 are recognised in expressions and in numbers."""
    assert code_of(asked(sp.sin(x)), given) == code
    assert code_of(number(0.5), given.replace("sin(x)", "0.5")) == code


def components(values, **more) -> Question:
    """A question for a matrix."""
    return asked(values, kind="components", shape=(2, 2), **more)


@pytest.mark.parametrize(
    ("given", "code"),
    [
        ("1,1 = x; 1,2 = y", "right"),
        ("[[x, y], [0, 0]]", "right"),
        ([["x", "y"], [0, 0]], "right"),
        ({"1,1": "x", "12": "y"}, "right"),
        ({"x,x": "x", "g_12": "y", "2,2": 0}, "right"),
        ("g_{11} = x\ng_{12} = y\n", "right"),
        ("-1 * 1", "unreadable"),
        ("1,1 = -x; 1,2 = -y", "sign"),
        ("1,1 = 2*x; 1,2 = 2*y", "factor"),
        ("1,1 = x; 2,1 = y", "permuted"),
        ("0,0 = x; 0,1 = y", "counted"),
        ("0,1 = x", "counted"),
        ("1,1 = x; 1,2 = -y", "sign"),
        ("1,1 = x/2; 1,2 = y", "factor"),
        ("1,1 = x", "incomplete"),
        ("1,1 = x; 1,2 = y; 2,2 = 7", "incomplete"),
        ("1,1 = x; 1,1 = x", "unreadable"),
        ("1,1 = x; 11 = y", "unreadable"),
        ("1,3 = x", "unreadable"),
        ("1,1,1 = x", "unreadable"),
        ("[[x, y], [0, 0, 0]]", "unreadable"),
        ("[[x, y]", "unreadable"),
        ("x = = y", "unreadable"),
        ({}, "incomplete"),
        ({"1,1": None}, "unreadable"),
        (3.5, "unreadable"),
        (True, "unreadable"),
        ("", "empty"),
        (None, "empty"),
    ],
)
def test_components(given, code):
    """Tables, lists and texts are read; other answers get a diagnosis."""
    assert code_of(components([[x, y], [0, 0]]), given) == code


def test_half_of_a_symmetric_answer_is_enough():
    """Half of a symmetric answer is completed; a wrong other half is noticed."""
    anti = components([[0, x], [-x, 0]], symmetry="antisymmetric")
    assert code_of(anti, "1,2 = x") == "right"
    assert code_of(anti, "2,1 = -x") == "right"
    assert code_of(anti, "1,2 = x; 2,1 = x") == "sign"
    assert code_of(anti, "1,2 = -x") == "sign"
    both = components([[1, x], [x, 0]], symmetry="symmetric")
    assert code_of(both, "1,1 = 1; 2,1 = x") == "right"
    # An explicit zero differs from an omitted component.
    assert code_of(anti, "1,2 = x; 2,1 = 0") == "incomplete"
    assert code_of(both, "[[1, x], [0, 0]]") == "incomplete"
    assert code_of(both, "[[1, x], [x, 0]]") == "right"


def test_a_share_of_the_components_counts():
    """The score is the fraction of right components; the message names the wrong one."""
    said = check_question(components([[x, y], [1, 0]]), "1,1 = x; 1,2 = y; 2,1 = 5")
    assert said.score == pytest.approx(2 / 3, abs=1e-3)
    assert "[2,1]" in said.message


def number(value, **more) -> Question:
    """A question for a number."""
    return asked(value, Domain(), "number", **more)


@pytest.mark.parametrize(
    ("given", "code"),
    [
        ("0.7854", "right"),
        (0.7854, "right"),
        ("pi/4", "right"),
        ("45 deg", "right"),
        ("45°", "right"),
        ("0.125 rev", "right"),
        ("0.125 turns", "right"),
        ("785.4 mrad", "right"),
        ("0.7854 rad", "right"),
        ("7.854e-1", "right"),
        ("45", "degrees"),
        ("-pi/4", "sign"),
        ("pi/2", "factor"),
        ("0.79", "rounded"),
        ("0.81", "rounded"),
        ("0.85", ""),
        ("3 s", "unit"),
        ("3 parsec", "unit"),
        ("2", ""),
        ("sqrt(-1)", "unreadable"),
        ("1/0", "unreadable"),
        ("x", "unreadable"),
        ("inf", "unreadable"),
        ("nan", "unreadable"),
        ("1e999999", "too large"),
        ("atan2(1, 0)", "factor"),
        ("[1, 2]", "unreadable"),
    ],
)
def test_numbers(given, code):
    """Units are read; degrees, signs, factors and rounding have different diagnoses."""
    assert code_of(number(0.78539816, unit="rad"), given) == code


def test_angles_asked_in_degrees():
    """A number without a unit is in the unit of the question."""
    assert code_of(number(45.0, unit="deg"), "pi/4 rad") == "right"
    assert code_of(number(45.0, unit="deg"), "0.7853982") == "degrees"


def test_several_numbers():
    """The tolerance is relative to the largest number; the message names the wrong ones."""
    three = number([1.0, 2.0, 1e-9], shape=(3,), label="b")
    assert code_of(three, "[1, 2, 0]") == "right"
    assert code_of(three, [1, 2, 0]) == "right"
    assert code_of(three, "1 = 1; 2 = 2") == "right"
    assert code_of(three, "[-1, -2, 0]") == "sign"
    assert "b[2]" in check_question(three, "[1, 7, 0]").message
    said = check_question(three, "[1, -2, 0]")
    assert (said.score, said.diagnosis) == (pytest.approx(2 / 3, abs=1e-3), "sign")
    assert "Look again at b[2]. The sign is wrong." in said.message
    assert code_of(three, "0 = 1; 1 = 2") == "counted"


def test_an_index_zero_is_explained_for_every_question():
    """The message explains an index 0, also if the exercise expects no general mistake."""
    matrix = components([[x, 0], [0, y]], generic=())
    for answer, words in (("0,0 = x; 1,1 = y", "Indices are"), ("0,1 = x", "An index is 0: ")):
        said = check_question(matrix, answer)
        assert (said.diagnosis, said.message.startswith(words)) == ("counted", True)


RATES = Question(
    "q", "equations", "?", lambda: [x * y, -x], Domain((x, y, t)),
    lambda: [Mistake("naive", [0, 0])], unknowns=("x'", "y'"), generic=("sign",),
)  # fmt: skip


@pytest.mark.parametrize(
    ("given", "code"),
    [
        ("x' = x*y; y' = -x", "right"),
        ("y' + x = 0\nx'/y - x = 0", "right"),
        ("x' + y' = x*y - x; x' - y' = x*y + x", "right"),
        ("t*x' + (1 - t)*y' = t*x*y - (1 - t)*x; y' = -x", "right"),
        ({"x'": "x*y", "y'": "-x"}, "right"),
        (["x′ = x*y", "y' = -x"], "right"),
        ("x' = -x*y; y' = x", "sign"),
        ("x' = 0; y' = 0", "naive"),
        ("x' = x*y; y' = x", "sign"),
        ("x' = x*y; y' = 3", "incomplete"),
        ("x' = x*y", "unreadable"),
        ("x' = x*y; 2*x' = 2*x*y", "unreadable"),
        ("x'*y' = 1; y' = -x", "unreadable"),
        ("x'^2 = 1; y' = -x", "unreadable"),
        ("x' = x*y; z' = -x", "unreadable"),
        ("x' = x*y = 1; y' = -x", "unreadable"),
        ("x'; y'", "unreadable"),
        ("atan(x)*x' = x*y*atan(x); y' = -x", "unreadable"),
        (7, "unreadable"),
    ],
)
def test_equations(given, code):
    """Any equivalent set is right; a set that does not determine the rates is refused."""
    assert code_of(RATES, given) == code


def test_choices():
    """A key or its text is accepted in upper and lower case; a misspelt key gets a hint."""
    choice = asked("yes", kind="choice", options={"yes": "it does", "no": "it does not"})
    assert code_of(choice, "yes") == code_of(choice, " YES ") == code_of(choice, "it does")
    assert code_of(choice, "no") == ""
    assert code_of(choice, "perhaps") == "unreadable"
    assert "Did you mean yes" in check_question(choice, "yess").message
    assert code_of(choice, True) == "right"
    assert code_of(choice, "it does.") == "right"


def test_a_choice_is_not_read_out_of_its_beginning():
    """The text "no" is refused: it could mean "no curvature" or begin "not zero"."""
    question = exercises.load("3.1").question("riemann")
    for text in ("no", "it does", "it", "not", ""):
        assert check_question(question, text).diagnosis in ("unreadable", "empty")


def test_a_decimal_comma():
    """The message shows how to write the number."""
    said = check_question(number(1.5), "1,5")
    assert said.message == "q: expected a number with a decimal point, got 1,5. Write 1.5."


HOSTILE = [
    "__import__('os').system('true')",
    "().__class__.__bases__[0].__subclasses__()",
    "lambda: 0",
    "x" * 100_000,
    "(" * 5000 + "x" + ")" * 5000,
    "-" * 3000 + "x",
    "9**9**9**9",
    "x**(10**9)",
    "((x**24)**24)**24",
    "(x + y + t + 1)**24 * (x - y + t)**24 * (x*y + 1)**24",
    "exp(exp(exp(exp(100))))",
    "cbrt(cosh(pi))/tan(asinh(sec(cosh(10^20))))",
    "ln((cosh(cosh(3e5)))/(10^20))",
    "exp(10^20)^log(0.5)",
    "sec(cosh(9999))",
    "sin(x) + 1/cosh(cosh(300000*x + 1))",
    "2^(10^5/3)",
    "exp(-exp(exp(exp(9)))) + x*0",
    "sin(10**30*x)",
    "tan(tan(tan(tan(tan(10^12*x)))))",
    "sqrt(sqrt(sqrt(x+1)+sqrt(y+2))+sqrt(sqrt(t)+x))",
    "1" * 5000,
    "1/" * 500 + "x",
    "x^0.0000001",
    "factorial(100000)",
    "diff(f(x), x, 1000)",
    "[" * 500,
    "a = 1; " * 3000,
    "\0\0\0",
    "𝒙𝒚" * 100,
    "sin(x)\n" * 900,
    "*".join(f"(sin({k}*x) + cos({k}*y) + {k})" for k in range(1, 60)),
    "+".join(f"1/(x + {k}*y + {k * k})" for k in range(1, 120)),
    "log(log(log(log(x))))^(x^(y^(t^x)))",
    "atan(atan(sqrt(x))^(1/23))^(1/19)",
]


@pytest.mark.parametrize("given", HOSTILE, ids=lambda text: repr(text[:24]))
@pytest.mark.parametrize("kind", ["expression", "components", "equations", "number"])
def test_hostile_answers_end_soon(kind, given):
    """A hostile answer ends after few Python calls, with a message and without marks."""
    questions = {
        "expression": asked(sp.sin(x)),
        "components": components([[x, y], [0, 0]]),
        "equations": RATES,
        "number": number(1.5),
    }
    # Five times the largest number here.
    assert 0 < python_calls(lambda: check_question(questions[kind], given)) < 2e6
    said = check_question(questions[kind], given)
    assert not said.right
    assert said.message


@pytest.mark.parametrize(
    ("given", "words"),
    [
        ("xx", "xx is not a name of this question"),
        ("xx", "Did you mean x? Names that may occur here: x, y, t."),
        ("banana", "Names that may occur here: x, y, t."),
        ("foo(x)", "Write it with sin, cos, tan,"),
        ("sinn(x)", "Did you mean sin? Write it with"),
        ("x^9999", "the limit is 1000"),
        ("x^9999", "Write a smaller one."),
    ],
)
@pytest.mark.parametrize("kind", ["expression", "components", "equations"])
def test_advice_is_for_those_who_answer(kind, given, words):
    """The advice does not mention parameters, because an answer cannot declare them."""
    question = {"expression": asked(x), "components": components([[x, 0], [0, 0]])}.get(kind)
    if question is None:
        question, given = asked({x: y}, kind="equations"), f"x = {given}"
    else:
        given = {"1,1": given} if kind == "components" else given
    message = check_question(question, given).message
    assert words in message
    assert "arameter" not in message
    assert "eclare" not in message


def test_advice_replaces_the_parameter_of_every_limit():
    """Whichever limit a number exceeds, an answer gets advice without a parameter."""
    question = asked(x)
    field = question.domain.field()
    with pytest.raises(LimitError) as digits:
        limits.check_digits(field.read(sp.Integer(10) ** 3000 * x), 2)
    with pytest.raises(LimitError) as exponent:
        limits.check_exponent(field.read(sp.Integer(10) ** 300))
    for refused in (digits, exponent):
        assert "Replace it by a parameter" in str(refused.value)
        assert advice(question, str(refused.value)).endswith(" Write a smaller one.")


def test_advice_where_no_names_occur():
    """In a question for a number, the message states that no names occur."""
    assert "No names occur in this answer." in check_question(number(1.5), "radius").message


def test_hostile_forms_of_the_right_answer_end_soon():
    """A huge form of the right answer is refused for its size, not multiplied out."""
    one = "*".join(f"(sin({k}*x)^2 + cos({k}*x)^2)" for k in range(1, 24))
    question = asked(sp.sin(x))
    assert python_calls(lambda: check_question(question, f"sin(x)*{one}")) < 2e5
    assert check_question(question, f"sin(x)*{one}").diagnosis == "too large"
    roots = "*".join(f"sqrt({k} + t)^2/({k} + t)" for k in range(1, 9))
    assert python_calls(lambda: check_question(question, f"sin(x)*{roots}")) < 2e5
    said = check_question(question, f"sin(x)*{roots}")
    assert said.right or said.diagnosis == "too large"


@pytest.mark.parametrize(
    ("number", "name", "answer"), [("3.2", "christoffel", "cot(phi1)"), ("6.4", "body", "v/3")]
)
def test_symbols_do_not_coincide_at_sample_points(number, name, answer):
    """An answer in the wrong symbol is wrong everywhere, not "right on a part of the domain"."""
    said = exercises.load(number).check({name: answer})[name]
    assert not said.right
    assert said.diagnosis != "domain"


def test_answers_leave_no_trace():
    """Each answer is read in a field of its own, so the order of answers does not matter."""
    exercise = exercises.load("3.2")
    first = exercise.check("cos(phi2)/sin(phi2)")
    exercise.check("sqrt(1 + phi1^2)*exp(phi2)*acos(phi2/9)")
    assert exercise.check("cos(phi2)/sin(phi2)") == first


def test_a_single_answer_and_unknown_names():
    """A single text counts for the first question; a misspelt name gets a hint."""
    exercise = exercises.load("3.3")
    notes = exercise.check("[[1/R^2, 0], [0, sin(r/R)^2]]").notes
    assert "several questions" in notes[0]
    verdict = exercise.check({"riccci": "0"})
    assert "Did you mean ricci?" in verdict.notes[0]
    assert verdict["ricci"].diagnosis == "empty"
    assert str(verdict).startswith("ricci: no answer. No answer")


@pytest.mark.parametrize(
    ("number", "text"),
    [("3.2", "1/2 cot phi2/2"), ("3.2", "cot(phi2"), ("3.2", "cot(theta)"), ("2.1", "1,2,2 = 1/2r"),
     ("1.1", "[[1, 0], [0"), ("3.1", {"cartan": "perhaps", "riemann": "zero", "torsion": "zero"})],
)  # fmt: skip
def test_unreadable_answers_make_a_range(number, text):
    """An unreadable answer is neither right nor wrong; the possible points count its question."""
    verdict = exercises.load(number).check(text)
    first, *others = verdict.questions
    assert first.state == "could not be read"
    assert not first.right
    assert verdict.unread == (first.name,)
    assert verdict.points == first.points + sum(one.points for one in others)
    assert verdict.at_most == verdict.earned + first.points
    assert verdict.points_text == (
        f"{verdict.earned:.3g} to {verdict.at_most:.3g} of {verdict.points} points"
    )
    assert f"{first.name}: could not be read." in str(verdict)
    assert "wrong" not in str(verdict).partition("\n")[0]


@pytest.mark.parametrize(
    ("number", "text", "read_as"),
    [("3.2", "1/tan φ_2", "1/tan(phi2)"), ("3.2", "2phi2^2", "2*phi2^2"),
     ("2.1", "Gamma_12^2 = 1/r", "1,2,2 = 1/r"),
     ("1.1", "[[1, 0], [0, r]]", "1,1 = 1; 1,2 = 0; 2,1 = 0; 2,2 = r"),
     ("6.1", "I1 Omega1' = (I2 - I3) Omega2 Omega3; Omega2' = 0; Omega3' = 0", "Omega2*Omega3")],
)  # fmt: skip
def test_a_verdict_shows_how_the_answer_was_read(number, text, read_as):
    """The verdict shows how the answer was read, in the notation of solutions."""
    verdict = exercises.load(number).check(text)
    assert read_as in verdict.questions[0].read_as
    assert f"Read as: {verdict.questions[0].read_as}." in str(verdict)

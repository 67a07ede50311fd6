"""Answers: read in the notation of students, and written so that they can be read again."""

import pytest
import sympy as sp

from geomtorsion.errors import ExpressionError, LimitError
from geomtorsion.teaching.exercises.answers import answer_text
from geomtorsion.teaching.exercises.checking import check_question
from geomtorsion.teaching.exercises.domain import Domain
from geomtorsion.teaching.exercises.entries import index
from geomtorsion.teaching.exercises.equations import equations
from geomtorsion.teaching.exercises.expressions import expression
from geomtorsion.teaching.exercises.question import Question, plain_name
from geomtorsion.teaching.exercises.reading import components, numbers

x, y = sp.symbols("x y", real=True)


def question(kind="expression", **more) -> Question:
    """A question whose answer is x."""
    return Question("q", kind, "?", lambda: more.pop("right", x), Domain((x, y)), **more)


def test_decimals_are_exact():
    """0.1 is read as exactly 1/10; a prime becomes a suffix of the name."""
    assert expression(question(), "0.1 + 2.5e-2*x", "q") == sp.Rational(1, 10) + x / 40
    assert expression(question(), "0.1*3 - 0.3", "q") == 0
    assert expression(question(), "x^0.5", "q") == sp.sqrt(x)
    assert plain_name("phi1' + r''") == "phi1_d + r_dd"


@pytest.mark.parametrize(
    ("text", "found"),
    [("1,2,1", (0, 1, 0)), ("121", (0, 1, 0)), ("Gamma_12^1", (0, 1, 0)), ("Γ_{12}^{1}", (0, 1, 0)),
     ("Gamma[1, 2, 1]", (0, 1, 0)), ("x,y,x", (0, 1, 0)), ("(1 2 1)", (0, 1, 0)),
     ("0,1,0", (-1, 0, -1))],
)  # fmt: skip
def test_indices(text, found):
    """All notations for an index are read."""
    assert index(question("components", shape=(2, 2, 2)), text, "q") == found


@pytest.mark.parametrize(
    "text", ["1,2", "1,2,3", "1,2,9999", "a,b,c", "", "1,-2,1", "x", "1.5,1,1"]
)
def test_no_indices(text):
    """A text that is not an index is refused with an example."""
    with pytest.raises(ExpressionError, match=r"Write 1,1,1 = \.\.\."):
        index(question("components", shape=(2, 2, 2)), text, "q")


def test_components_are_counted():
    """More entries than the limit are refused."""
    with pytest.raises(LimitError, match="expected at most 500 entries, got 600"):
        components(question("components", shape=(2, 2)), {f"1,{k}": 1 for k in ["1"] * 1} | {
            f"1,1{' ' * k}": 1 for k in range(600)
        }, "q")  # fmt: skip


def test_answers_are_written_as_they_are_read():
    """Texts that the library writes are read as the same values."""
    value = {(0, 1): sp.sin(x) / y, (1, 1): -x}
    asked = question("components", shape=(2, 2))
    assert components(asked, answer_text(asked, value), "q") == value
    asked = question("equations", unknowns=("x'", "y''"))
    value = {(0,): x * y, (1,): -x}
    assert answer_text(asked, value) == "x' = x*y; y'' = -x"
    assert equations(asked, answer_text(asked, value), "q") == value
    asked = question("number", unit="deg")
    assert numbers(asked, answer_text(asked, {(): 12.5}), "q") == {(): 12.5}


def test_a_prime_at_the_end_of_an_entry_stays():
    """In [v, r'] the last sign is a prime, not a quote; quotes around an entry are removed."""
    r, r_d = sp.symbols("r r_d", real=True)
    asked = Question("q", "components", "?", lambda: [r, r_d], Domain((r, r_d)), shape=(2,))
    for text in ("[r, r']", '["r", "r\'"]', "['r', \"r'\"]", "matrix([r, r'])"):
        assert check_question(asked, text).right, text
    assert not check_question(asked, "[r', r]").right


MATRIX = question("components", shape=(2, 2))
LOWER_UPPER = question("components", shape=(2, 2, 2), marks="__^")
RATES = question("equations", unknowns=("x'", "y'"))


@pytest.mark.parametrize(
    ("asked", "answer", "words"),
    [
        (question(), True, "expected an expression in quotes, got true. Write"),
        (question(), "x" * 4001, "expected at most 4,000 characters, got 4,001. Write it shorter."),
        (MATRIX, 3, "expected components, got the number 3. Write for instance"),
        (MATRIX, "x", "expected components, got 'x'. Write for instance"),
        (MATRIX, "1,1 = x; y", "expected index = value, got 'y'. Separate components by semi"),
        (MATRIX, "1,1 = x; 1,1 = y", "expected each component once, got 1,1 twice. Remove one"),
        (MATRIX, {"1,1": "x", "11": "y"}, "expected each component once, got q[1,1] twice."),
        (MATRIX, "[[x, y]", "expected a bracket ] for each bracket [, got '[[x, y]'. Write [[a"),
        (MATRIX, "[x]]", "expected a bracket [ before each bracket ], got none. Write [[a, b]"),
        (MATRIX, "[[x, y]]", "expected 2 x 2 components, got a list of 1. Write all of them"),
        (MATRIX, ["x", "y"], "q[1]: expected a list, got 'x'. Write one list for each row."),
        (MATRIX, "1,3 = x", "expected an index from 1 to 2, got 3 as index 2 of '1,3'. Write 1,1"),
        (MATRIX, "1,2,1 = x", "expected 2 indices, got 3 in '1,2,1'. Write 1,1 = ... (indices"),
        (MATRIX, "a,b = x", "expected a number or a coordinate as index 1, got 'a'. Write 1,1"),
        (MATRIX, "[" * 7 + "]" * 7, "expected at most 6 nested lists, got 7. Write one level"),
        (MATRIX, "[[5½, 0], [0, 0]]", "q: expected one number, got a number in front of a frac"),
        (LOWER_UPPER, "T^12_1 = x", "expected 2 lower and 1 upper indices, got 1 and 2 in"),
        (RATES, 7, "expected equations in quotes, got the number 7. Write left = right."),
        (RATES, "x' = y", "expected 2 equations, got 1. Write one equation for each of x', y'."),
        (RATES, "x'; y'", 'expected left = right, got "x\'". Separate equations by semicolons.'),
        (RATES, "x'*y' = 1; y' = x", "expected an equation that is linear in x', y', got one that"),
        (RATES, "x' = y; 2x' = 2y", "expected equations that determine y', got some that follow"),
        (RATES, "atan(x) x' = y; y' = x", "expected sums, products, powers, and functions such as"),
        (question("number"), "1,5", "expected a number with a decimal point, got 1,5. Write 1.5."),
        (question("number"), "sqrt(-1)", "expected a finite real number, got I. Write for inst"),
        (question("choice", options={"yes": "", "no": ""}), "perhaps",
         "expected one of yes, no, got 'perhaps'. Write one of these words."),
    ],
)  # fmt: skip
def test_refused_answers(asked, answer, words):
    """Each answer that cannot be read is refused with the reason and a remedy."""
    verdict = check_question(asked, answer)
    assert verdict.diagnosis in ("unreadable", "too large")
    assert words in verdict.message

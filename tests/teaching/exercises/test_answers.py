"""Answers: read as students write them, and written as they are read."""

import pytest
import sympy as sp

from geomtorsion.errors import ExpressionError, LimitError
from geomtorsion.teaching.exercises.answers import answer_text, components, expression
from geomtorsion.teaching.exercises.checking import check_question, equations, numbers
from geomtorsion.teaching.exercises.domain import Domain
from geomtorsion.teaching.exercises.entries import index
from geomtorsion.teaching.exercises.question import (
    Question,
    plain_name,
)

x, y = sp.symbols("x y", real=True)


def question(kind="expression", **more) -> Question:
    """A question whose answer is x."""
    return Question("q", kind, "?", lambda: more.pop("right", x), Domain((x, y)), **more)


def test_decimals_are_exact():
    """0.1 is a tenth."""
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
    """All ways to write an index."""
    assert index(question("components", shape=(2, 2, 2)), text, "q") == found


@pytest.mark.parametrize(
    "text", ["1,2", "1,2,3", "1,2,9999", "a,b,c", "", "1,-2,1", "x", "1.5,1,1"]
)
def test_no_indices(text):
    """What is no index is refused with an example."""
    with pytest.raises(ExpressionError, match=r"1,1,1 = \.\.\.|runs from 1 to 2"):
        index(question("components", shape=(2, 2, 2)), text, "q")


def test_components_are_counted():
    """More entries than there can be are refused."""
    with pytest.raises(LimitError, match="the limit is"):
        components(question("components", shape=(2, 2)), {f"1,{k}": 1 for k in ["1"] * 1} | {
            f"1,1{' ' * k}": 1 for k in range(600)
        }, "q")  # fmt: skip


def test_answers_are_written_as_they_are_read():
    """Texts that the library writes are read back as the same values."""
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
    """In [v, r'] the last sign is no quote; quotes round an entry go."""
    r, r_d = sp.symbols("r r_d", real=True)
    asked = Question("q", "components", "?", lambda: [r, r_d], Domain((r, r_d)), shape=(2,))
    for text in ("[r, r']", '["r", "r\'"]', "['r', \"r'\"]", "matrix([r, r'])"):
        assert check_question(asked, text).right, text
    assert not check_question(asked, "[r', r]").right

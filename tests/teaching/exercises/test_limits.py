"""Limits: oversized answers are refused, usual ones are read."""

from dataclasses import replace

import pytest
import sympy as sp

from geomtorsion.errors import ExpressionError, LimitError
from geomtorsion.exact import parse_expression
from geomtorsion.teaching.exercises.domain import Domain
from geomtorsion.teaching.exercises.equations import equations
from geomtorsion.teaching.exercises.limits import ANSWER, MOST, check_weight
from geomtorsion.teaching.exercises.question import Question
from geomtorsion.teaching.exercises.reading import components

x, y = sp.symbols("x y", real=True)


def read(text):
    """An answer in x."""
    return parse_expression(text, {"x": x}, {}, where="q", limits=ANSWER, decimals=True)


def test_weights_limit_the_size_of_expanded_forms():
    """Powers, products, multiple angles and fractions all count."""
    check_weight(sp.sin(5 * x) / (1 + x) + sp.sqrt(1 + y), "q")
    for heavy in (
        ((1 + x + y) * (1 - x + 2 * y) * (x - 3 * y + 5)) ** 24,
        sp.sin(10**9 * x),
        sp.Add(*(1 / (x + k * y + k**2) for k in range(30))),
        sp.Mul(*(sp.sqrt(x + k) for k in range(2, 9))),
    ):
        with pytest.raises(LimitError, match="Write it shorter"):
            check_weight(heavy, "q")


@pytest.mark.parametrize(
    "text", ["sin(1000*pi)", "x^24", "exp(-30)*x", "sqrt(10^40)", "log(10^40)", "cosh(x)^2",
             "10^20*x", "pi^2/E", "1/3 - 1/2", "atan2(1, x)", "sin(", "", "x x"],
)  # fmt: skip
def test_constants_of_use(text):
    """Usual constants pass the limits; the parser refuses text that is not an expression."""
    try:
        read(text)
    except LimitError:
        pytest.fail("refused for its size")
    except ExpressionError:
        assert text in ("sin(", "", "x x")


@pytest.mark.parametrize(
    "text",
    ["sin(10^20)", "sec(cosh(9999))", "exp(10^5)", "x^(10^3/7)", "tan(-10^9)", "cosh(1/10^-9)"],
)
def test_constants_beyond_use(text):
    """Functions of huge constants are refused before sympy evaluates them."""
    with pytest.raises(LimitError, match="Write it shorter"):
        read(text)


def test_limits_hold_on_both_sides():
    """The limits of entries, equations and roots are accepted, one more is refused."""
    many = Question("q", "components", "?", lambda: 0, Domain((x,)), shape=(MOST.entries,))
    assert len(components(many, ["x"] * MOST.entries, "q")) == MOST.entries
    more = replace(many, shape=(MOST.entries + 1,))
    with pytest.raises(LimitError, match="at most 500 entries, got 501"):
        components(more, ["x"] * (MOST.entries + 1), "q")
    roots = [sp.sqrt(x**2 + k) for k in range(1, MOST.roots + 2)]
    check_weight(sp.Add(*roots[:-1]), "q")
    with pytest.raises(LimitError, match="at most 4 different roots"):
        check_weight(sp.Add(*roots), "q")
    names = [f"v{k}'" for k in range(1, MOST.equations + 2)]
    text = "; ".join(f"{name} = x" for name in names)
    asked = Question("q", "equations", "?", lambda: 0, Domain((x,)), unknowns=(*names[:-1],))
    assert len(equations(asked, text.rpartition(";")[0], "q")) == MOST.equations
    with pytest.raises(LimitError, match="at most 12 equations, got 13"):
        equations(replace(asked, unknowns=(*names,)), text, "q")


@pytest.mark.parametrize(("power", "refused"), [("201/2", True), ("199/2", False), ("101", False)])
def test_large_fractional_powers_are_refused(power, refused):
    """Fractional powers above 100 are refused before sympy evaluates them."""
    if refused:
        with pytest.raises(LimitError, match="a power above 100"):
            read(f"2^({power})")
    else:
        read(f"2^({power})")

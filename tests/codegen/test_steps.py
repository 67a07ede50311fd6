"""Hoisting: constants computed once give the same values."""

import numpy as np
import pytest
import sympy as sp
from hypothesis import given
from hypothesis import strategies as st

from geomtorsion.codegen import graph

x, y, a, b = sp.symbols("x y a b")
TERMS = [
    x * a * b, y * (a + b) ** 2, x / a, x / (a + b * y), (a - b) / (a**2 + 1), a * x**2 / b**3,
    sp.sin(a) * x, sp.sqrt(1 + a**2) * y, a, sp.Integer(3), x * y, sp.pi * a * x, x / 7,
    1 / (a * b),
]  # fmt: skip


@given(
    st.lists(st.lists(st.sampled_from(TERMS), min_size=1, max_size=4), min_size=1, max_size=3),
    st.tuples(*[st.floats(0.25, 4)] * 4),
)
def test_values_stay(rows, values):
    """Both graphs together give the values of the original graph."""
    made = graph(["x", "y", "a", "b"], [sp.Add(*row) for row in rows], ["a", "b"])
    rest, constants = made.hoisted(2, "c")
    further = constants.numpy()(*values[2:])
    found = rest.numpy()(*values, *further)
    assert found == pytest.approx(made.numpy()(*values), rel=1e-12, abs=1e-12)
    assert rest.arguments == ("x", "y", "a", "b", *(f"c {k}" for k in range(len(further))))


@given(st.lists(st.sampled_from(TERMS), min_size=1, max_size=6))
def test_nothing_constant_is_left_to_do(row):
    """Each constant step is an argument or a number, and no quotient has a constant divisor."""
    rest, _ = graph(["x", "y", "a", "b"], row, ["a", "b"]).hoisted(2, "c")
    for step in rest.steps:
        assert not step.constant or step.kind in ("argument", "number", "digits")
        if step.kind == "quotient":
            below = rest.steps[step.operands[1]]
            assert below.kind == "number" or not below.constant


def test_an_infinite_inverse_raises_no_error():
    """The inverse of zero is infinite, as in the equations."""
    rest, constants = graph(["x", "a"], [x / a], ["a"]).hoisted(1, "c")
    assert np.isinf(constants.numpy()(0.0)).all()
    assert np.isinf(rest.numpy()(1.0, 0.0, *constants.numpy()(0.0))).all()


def test_what_an_element_divides_by_cancels():
    """r**3 over r**2 is r, whether the factors come from an element or by name."""
    from geomtorsion.exact import Field

    r = sp.Symbol("r")
    made = graph(["r"], [((Field([r]).read(2 / r**2), ("r", "r", "r")),)])
    assert [step.kind for step in made.steps] == ["argument", "number", "product"]

"""Elements by the cosine of an angle: the same values, exactly, or a refusal."""

import pytest
import sympy as sp
from hypothesis import given
from hypothesis import strategies as st

from geomtorsion.exact import Field
from geomtorsion.exact.cosine import by_cosine

X, Y, Z = sp.symbols("x y z", real=True)

pieces = st.sampled_from([sp.Integer(2), X, sp.cos(Y), sp.sin(Y) ** 2, sp.cos(Y) ** 3 - X])


def turned(expression):
    """In the field of x and z."""
    return by_cosine(Field([X, Y]).read(expression), Y, Field([X, Z]), Z)


@given(pieces, pieces, pieces, pieces, st.integers(0, 2))
def test_put_back_it_is_the_same(one, two, three, four, odd):
    """cos y for z gives the element again; odd sines above and below go together."""
    below = (three + 5 * four + 7) * sp.sin(Y) ** odd
    if Field([X, Y]).read(below).is_zero:
        return
    expression = (one * two + three) * sp.sin(Y) ** odd / below
    found = turned(expression)
    assert found is not None
    assert found.symbols <= {X, Z}
    field = Field([X, Y])
    assert field.read(found.sympy.subs(Z, sp.cos(Y))) == field.read(expression)


@pytest.mark.parametrize(
    "expression",
    [sp.sin(Y), sp.sin(Y) + sp.cos(Y), X / sp.sin(Y), Y * sp.cos(Y), sp.cos(Y / 2), sp.exp(X)],
)
def test_what_is_more_than_the_cosine(expression):
    """Odd sines, the angle itself, other angles and other functions are refused."""
    assert turned(expression) is None


def test_nothing():
    """Zero stays zero."""
    found = turned(sp.Integer(0))
    assert found is not None
    assert found.is_zero

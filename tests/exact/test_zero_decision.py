"""Zero is decided: every hard zero is zero, every near-zero is not, whatever else was read."""

import pytest
import sympy as sp

from geomtorsion.errors import ExpressionError, LimitError
from geomtorsion.exact import Field
from tests.exact import deep_zeros, hard_zeros, near_zeros
from tests.exact.symbols import POINT, plain


def read(expression, *, complex=False, sample=POINT):
    """An expression read into a field of its own."""
    symbols = sorted(expression.free_symbols, key=str)
    given = None if sample is None else {s: v for s, v in sample.items() if s in symbols}
    return Field(symbols, complex=complex, sample=given).read(expression)


def cases(groups):
    """All cases of a dictionary of groups, as pytest parameters with readable names."""
    return [
        pytest.param(sp.sympify(e), id=f"{group}: {label}".replace(" ", "-"))
        for group, members in groups.items()
        for label, e in members.items()
    ]


REAL_ZEROS = cases(hard_zeros.REAL_GROUPS)
REAL_NEAR = cases(near_zeros.REAL_GROUPS)


@pytest.mark.parametrize("expression", REAL_ZEROS)
def test_hard_zeros_are_zero(expression):
    """A listed zero is read as zero, and with it every form that multiplies or shifts it."""
    assert read(expression).is_zero is True


@pytest.mark.parametrize("expression", REAL_ZEROS)
def test_hard_zeros_are_never_called_non_zero_without_assumptions(expression):
    """Symbols without assumptions, no sample: zero on the stated branch, or undecided."""
    bare = plain(expression)
    try:
        element = read(bare, sample=None)
    except ExpressionError:
        return
    assert element.is_zero in (True, None) or element.field.branches


@pytest.mark.parametrize("expression", REAL_ZEROS)
def test_hard_zeros_plus_one_are_not_zero(expression):
    """Nothing is called zero that is one."""
    assert read(expression + 1).is_zero is False


@pytest.mark.parametrize("expression", REAL_NEAR)
def test_near_zeros_are_not_zero(expression):
    """A near-zero is not zero, however small; too fine a basis may be refused, with its limit."""
    try:
        element = read(expression)
    except LimitError:
        return
    assert element.is_zero is False


@pytest.mark.parametrize("expression", REAL_NEAR)
def test_near_zeros_have_an_inverse(expression):
    """What is not zero can be divided by: e * (1 / e) is one."""
    try:
        element = read(expression)
    except LimitError:
        pytest.skip("refused, see above")
    assert element * element.inverse() == element.field.one


@pytest.mark.parametrize("expression", cases({"complex": hard_zeros.COMPLEX}))
def test_complex_zeros(expression):
    """Zeros that need the imaginary unit."""
    assert read(expression, complex=True).is_zero is True


@pytest.mark.parametrize("expression", cases({"complex": near_zeros.COMPLEX}))
def test_complex_near_zeros(expression):
    """Near-zeros that need the imaginary unit."""
    assert read(expression, complex=True).is_zero is False


@pytest.mark.parametrize("expression", cases({"deep": deep_zeros.DEEP}))
def test_deep_zeros_are_never_called_non_zero(expression):
    """Refused, undecided or zero: all are honest; non-zero would be wrong."""
    try:
        element = read(expression)
    except ExpressionError:
        return
    assert element.is_zero in (True, None)

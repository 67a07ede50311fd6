"""Addition theorems for arguments of each form, read at once or one after the other."""

import pytest
import sympy as sp

from geomtorsion.errors import LimitError
from geomtorsion.exact import Field
from tests.exact.shifted_zeros import ARGUMENTS, identities, near_misses
from tests.exact.symbols import POINT, number

LARGE = sp.Integer(2) ** 331 - 1, sp.Integer(3) ** 211 + 2


def field_of(expression):
    """A field over the symbols of an expression."""
    return Field(sorted(expression.free_symbols, key=str), sample=POINT)


@pytest.mark.parametrize("label", ARGUMENTS)
def test_the_list_is_right(label):
    """By mpmath only: zeros vanish, near misses do not."""
    for zero in identities(ARGUMENTS[label]).values():
        assert abs(number(zero, 80)) < 1e-60
    for near in near_misses(ARGUMENTS[label]).values():
        assert abs(number(near, 80)) > 1e-40


@pytest.mark.parametrize("label", ARGUMENTS)
def test_addition_theorems(label):
    """Every theorem is decided as zero, every near miss as not zero."""
    argument = ARGUMENTS[label]
    wrong = [k for k, e in identities(argument).items() if field_of(e).read(e).is_zero is not True]
    wrong += [
        k for k, e in near_misses(argument).items() if field_of(e).read(e).is_zero is not False
    ]
    assert wrong == []


@pytest.mark.parametrize("label", ARGUMENTS)
def test_addition_theorems_term_by_term(label):
    """The terms read one by one, in either order, also add up to zero."""
    for name, zero in identities(ARGUMENTS[label]).items():
        for terms in (sp.Add.make_args(zero), sp.Add.make_args(zero)[::-1]):
            field = field_of(zero)
            elements = [field.read(term) for term in terms]
            assert field.sum([(1, e) for e in elements]).is_zero is True, name


@pytest.mark.parametrize("function", [sp.sqrt, sp.log, sp.cbrt], ids=["sqrt", "log", "cbrt"])
def test_large_integers_do_not_hang(function):
    """Integers too large to factor: decided, or refused by a stated limit, at once."""
    difference = function(LARGE[0]) - function(LARGE[1])
    try:
        assert Field([]).read(difference).is_zero is False
    except LimitError as error:
        limit = str(error)
        assert any(c.isdigit() for c in limit), limit


def test_very_large_arguments():
    """atan(10**100) is not pi/2, though 100 digits agree."""
    for exponent in (20, 75, 100, 200):
        expression = sp.atan(sp.Integer(10) ** exponent) - sp.pi / 2
        assert Field([]).read(expression).is_zero in (False, None)

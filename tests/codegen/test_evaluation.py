"""Evaluation: numbers become fractions, or numbers with the requested bits."""

# Bad input, lists as arrays and results that may be None: the types are stricter.
# pyright: reportArgumentType=false

from fractions import Fraction

import mpmath
import numpy as np
import pytest
import sympy as sp

from geomtorsion.codegen import graph
from geomtorsion.codegen.evaluation import exact_number, rational
from geomtorsion.support.precision import EXACT_BITS

x, y = sp.symbols("x y")


@pytest.mark.parametrize(
    ("given", "wanted"),
    [
        (3, Fraction(3)),
        (0.1, Fraction(3602879701896397, 2**55)),
        (Fraction(1, 3), Fraction(1, 3)),
        (sp.Rational(2, 7), Fraction(2, 7)),
        (np.float64(0.25), Fraction(1, 4)),
        (np.int64(-5), Fraction(-5)),
        (np.array(0.5), Fraction(1, 2)),
        (sp.pi, None),
        (mpmath.mpf(1) / 3, None),
        (np.longdouble(0.1), None),
    ],
)
def test_numbers_that_are_fractions(given, wanted):
    """Floats are exact fractions; irrational and long numbers give None."""
    if isinstance(given, np.longdouble):
        assert isinstance(exact_number(given, 100), mpmath.mpf)
    else:
        assert rational(given) == wanted


def test_irrational_numbers_and_long_floats_keep_their_bits():
    """sqrt(2) has the requested bits, and a long float keeps the bits that it has."""
    with mpmath.workprec(300):
        assert abs(exact_number(sp.sqrt(2), 300) ** 2 - 2) < mpmath.mpf(2) ** -295
    third = np.longdouble(1) / np.longdouble(3)
    with mpmath.workprec(100):
        error = abs(3 * exact_number(third, 100) - 1)
        assert error < 4 * mpmath.mpf(float(np.finfo(np.longdouble).eps))


def test_values_meet_in_one_graph():
    """A fraction times sqrt(2) is not a fraction; a result from fractions is one."""
    made = graph(["x", "y"], [x / 7, x * y, y**2 / y])
    seventh, product, same = made.exactly([Fraction(1, 2), sp.sqrt(2)])
    assert seventh == Fraction(1, 14)
    with mpmath.workprec(EXACT_BITS):
        assert abs(product - mpmath.sqrt(2) / 2) < mpmath.mpf(2) ** (5 - EXACT_BITS)
        assert abs(same - mpmath.sqrt(2)) < mpmath.mpf(2) ** (5 - EXACT_BITS)


def test_no_value_is_an_error():
    """1/0 raises an error, because it has no exact value."""
    with pytest.raises(ZeroDivisionError):
        graph(["x"], [1 / x]).exactly([0])

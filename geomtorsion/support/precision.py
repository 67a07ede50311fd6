"""Precision: work with more digits, one thread at a time.

The precision of mpmath and of python-flint is a setting of the whole process. Two threads that set
it by turns would each permanently restore the value set by the other.
"""

from __future__ import annotations

import math
import sys
from collections.abc import Iterator
from contextlib import contextmanager

import flint
import mpmath

from geomtorsion.support.exclusive import LOCK

# The distance from 1 to the next double; rounding changes a number by half of it at most.
EPS = sys.float_info.epsilon
# Half of the digits of a double: an error below this share may be rounding that grew on its way, as
# under a root or in a quotient; a larger difference is real.
HALF = math.sqrt(EPS)
# Largest error of numbers printed with seven digits: a smaller deviation counts as rounding, a
# larger one as a mistake.
PRINTED = 1e-6
# And by so much those that came out of a calculation with doubles: a few thousand roundings. Points
# nearer than this share of a loop are one point, a velocity with such a norm is null.
CALCULATED = 1e-12
# Points at multiples of the golden section are in phase with no frequency.
GOLDEN = (math.sqrt(5) - 1) / 2
# Bits of constants that are computed once: two doubles, and as many again to spare.
CONSTANT_BITS = 180
# Bits of numbers that are not fractions in exact decisions: no engine has more.
EXACT_BITS = 400


@contextmanager
def working_precision(bits: int) -> Iterator[None]:
    """Block in which mpmath works with a given number of bits.

    Examples
    --------
    >>> with working_precision(200):
    ...     third = mpmath.mpf(1) / 3
    >>> third == mpmath.mpf(1) / 3
    False
    """
    with LOCK, mpmath.workprec(bits):
        yield


@contextmanager
def working_digits(digits: int) -> Iterator[None]:
    """Block in which mpmath works with a given number of decimal digits."""
    with LOCK, mpmath.workdps(digits):
        yield


@contextmanager
def ball_precision(bits: int) -> Iterator[None]:
    """Block in which python-flint works with a given number of bits.

    Examples
    --------
    >>> with ball_precision(140):
    ...     third = flint.arb(1) / 3
    >>> float(third.rad()) < 1e-40
    True
    """
    with LOCK, flint.ctx.workprec(bits):
        yield


@contextmanager
def series_length(length: int) -> Iterator[None]:
    """Block in which series of python-flint have a given number of coefficients.

    Examples
    --------
    >>> with series_length(3):
    ...     print(1 / flint.arb_series([1, -1]))
    1.00000000000000 + 1.00000000000000*x + 1.00000000000000*x^2 + O(x^3)
    """
    with LOCK:
        before = flint.ctx.cap
        flint.ctx.cap = length
        try:
            yield
        finally:
            flint.ctx.cap = before

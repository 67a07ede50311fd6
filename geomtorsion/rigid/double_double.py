"""Double-double: times against a period of 32 digits, reduced without losing the last digits."""

from __future__ import annotations

import sys
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

if TYPE_CHECKING:
    from numpy.typing import NDArray

# 2^27 + 1: it cuts the 53 bits of a double into two halves [Dekker1971].
SPLITTER = 2.0 ** (sys.float_info.mant_dig // 2 + 1) + 1


@dataclass(frozen=True)
class DoubleDouble:
    """A number as an unevaluated sum of two doubles: about 32 digits.

    high: the nearest double.
    low: the remainder, again rounded to the nearest double.
    """

    high: float
    low: float

    @classmethod
    def of(cls, value: Any) -> DoubleDouble:
        """The nearest pair to a real ball of python-flint, at the precision in use.

        Examples
        --------
        >>> import flint
        >>> with flint.ctx.workprec(140):
        ...     third = DoubleDouble.of(flint.arb(1) / 3)
        >>> third.high, abs(third.low) < 2e-17
        (0.3333333333333333, True)
        """
        high = float(value)
        return cls(high, float(value - high))


def product(factor: NDArray[np.float64], constant: DoubleDouble) -> tuple[Any, Any]:
    """factor * constant as a rounded product and its rounding error [Dekker1971]."""
    high = factor * constant.high
    part = SPLITTER * factor
    top = part - (part - factor)
    rest = factor - top
    split = SPLITTER * constant.high
    head = split - (split - constant.high)
    tail = constant.high - head
    low = ((top * head - high) + top * tail + rest * head) + rest * tail
    return high, low + factor * constant.low


def total(a: Any, b: Any) -> tuple[Any, Any]:
    """a + b as a rounded sum and its rounding error [Knuth1969]."""
    high = a + b
    part = high - a
    return high, (a - (high - part)) + (b - part)


def turns(factor: NDArray[np.float64], per_unit: DoubleDouble) -> NDArray[np.float64]:
    """The part of factor * per_unit beyond whole numbers, in [-1/2, 1/2].

    Right to rounding of the result however many turns there are.

    Examples
    --------
    >>> import flint
    >>> with flint.ctx.workprec(140):
    ...     third = DoubleDouble.of(flint.arb(1) / 3)
    >>> float(turns(np.array([1e15]), third)[0])
    0.3333333333333333
    """
    high, low = product(factor, per_unit)
    left = (high - np.rint(high)) + low
    return left - np.rint(left)


def reduced(
    times: NDArray[np.float64], offset: DoubleDouble, step: DoubleDouble
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """n and r with times + offset = n * step + r, |r| <= step / 2; n as doubles.

    An infinite step leaves all times where they are: n = 0.

    Examples
    --------
    >>> n, r = reduced(np.array([7.5]), DoubleDouble(1.0, 0.0), DoubleDouble(3.0, 0.0))
    >>> float(n[0]), float(r[0])
    (3.0, -0.5)
    """
    # On the separatrix half a period is infinite.
    if np.isinf(step.high):
        high, low = total(times, offset.high)
        return np.zeros_like(times), high + (low + offset.low)
    count = np.rint((times + offset.high) / step.high)
    whole, part = product(count, step)
    rest, first = total(times, -whole)
    high, second = total(rest, offset.high)
    return count, high + ((first + second) + (offset.low - part))

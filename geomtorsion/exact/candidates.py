"""Candidates: points to try one after another, plausible ones first, the same in every process."""

from __future__ import annotations

import math
import zlib
from collections.abc import Collection, Iterable, Mapping, Sequence
from fractions import Fraction
from typing import TypeVar

import mpmath
import sympy

from geomtorsion.support.precision import GOLDEN

Number = TypeVar("Number", Fraction, float)
Bounds = tuple[Fraction | None, Fraction | None]

# Fractional parts of multiples of their square roots fill a cube evenly.
PRIMES = (2, 3, 5, 7, 11, 13, 17, 19, 23, 29, 31, 37, 41, 43, 47, 53, 59, 61, 67, 71)
# Denominators without a common factor: no linear relation between symbols holds by accident.
GRAINS = (9973, 9967, 9949, 9941, 9931, 9929, 9923, 9907, 9901, 9887)
# Powers of four: coordinates are tried near one first, then far out and far in.
SCALES = (1.0, 4.0, 0.25, 16.0, 0.0625, 64.0)


class Candidates:
    """Numbered points over symbols: positive near one, then of other sizes and signs.

    Coordinates are larger than parameters, so that r > 2*M holds at most of them; angles are acute.
    Many odd numbers have some signs reversed. Bounds and assumptions hold at all of them.

    symbols: the symbols, or unknown functions, that get values.
    coordinates: how many of them, from the first, are coordinates; so are unknown functions.
    bounds: least and largest value of a symbol, None where there is none.
    angles: symbols that occur only in sin and cos.
    scales: further sizes of coordinates, such as numbers that occur in the formulas.

    Examples
    --------
    >>> r, M = sympy.symbols("r M", positive=True)
    >>> first = Candidates([r, M], 1).exact(0)
    >>> bool(first[r] > first[M] > 0)
    True
    """

    def __init__(
        self,
        symbols: Sequence[sympy.Expr],
        coordinates: int,
        bounds: Mapping[sympy.Expr, Bounds] | None = None,
        angles: Collection[sympy.Expr] = (),
        scales: Sequence[float] = (),
    ) -> None:
        self.symbols = tuple(symbols)
        self._coordinates = coordinates
        bounds = bounds or {}
        self._bounds = [_bounds_of(s, bounds.get(s, (None, None))) for s in self.symbols]
        self._angles = [s in angles for s in self.symbols]
        self._scales = (*SCALES, *scales)

    def floats(self, start: int, stop: int) -> list[list[float]]:
        """Rows of values of all symbols, one row for each number from start to stop."""
        size = range(len(self.symbols))
        return [[self._value(number, k, float) for k in size] for number in range(start, stop)]

    def exact(self, number: int) -> dict[sympy.Expr, sympy.Rational]:
        """The same values as fractions."""
        values = [self._value(number, k, Fraction) for k in range(len(self.symbols))]
        return {
            symbol: sympy.Rational(value.numerator, value.denominator)
            for symbol, value in zip(self.symbols, values, strict=True)
        }

    def _value(self, number: int, k: int, kind: type[Number]) -> Number:
        symbol, grain = self.symbols[k], GRAINS[k % len(GRAINS)]
        share = kind(int(_part(number, k) * (grain - 1)) + 1) / grain
        low, high = (None if bound is None else kind(bound) for bound in self._bounds[k])
        if low is not None and high is not None:
            value = low + (high - low) * share
        elif self._angles[k]:
            value = (3 + 25 * share) / 20
        elif k < self._coordinates or not symbol.is_Symbol:
            # Some have a scale for each coordinate: a cosine below one, a radius far above.
            shift = _part(number // 8, k + 1) if number % 8 == 7 else 0.0
            scale = self._scales[int((number * GOLDEN + shift) % 1 * len(self._scales))]
            value = (1 + 5 * share) / 4 * kind(scale)
        else:
            # Later ones are smaller, as a < M.
            value = (1 + 4 * share) / 10 * kind(4) ** (k - self._coordinates)
            value /= 5 ** (k - self._coordinates)
        if low is not None and high is None:
            value = low + value
        elif high is not None and low is None:
            value = high - value
        elif low is None and number % 2 and number % 8 < 7 and _part(number, -1 - k) < 0.5:
            value = -value
        return kind(_whole(symbol, value, low is not None) if symbol.is_integer else value)


def interval(symbol: sympy.Symbol, relations: Iterable[sympy.Basic]) -> Bounds:
    """Bounds of a symbol from relations to numbers.

    Examples
    --------
    >>> r = sympy.Symbol("r")
    >>> interval(r, [r > 2, r < 3])
    (Fraction(2, 1), Fraction(3, 1))
    """
    low = high = None
    for relation in relations:
        if relation.free_symbols != {symbol} or not hasattr(relation, "lts"):
            continue
        less, greater = relation.lts, relation.gts
        if less == symbol and greater.is_number and greater.is_finite:
            bound = Fraction(float(greater)).limit_denominator(10**6)
            high = bound if high is None else min(high, bound)
        elif greater == symbol and less.is_number and less.is_finite:
            bound = Fraction(float(less)).limit_denominator(10**6)
            low = bound if low is None else max(low, bound)
    return low, high


def value_of_name(text: str, number: int) -> mpmath.mpf:
    """A number between 0 and 1 made from a name and the number of a candidate."""
    # Made from the name, so that it is the same in every process and for every order of reading.
    seed = zlib.crc32(f"{text} {number}".encode()) / 2**32
    return mpmath.frac(mpmath.sqrt(2) * 1000 * (seed + 1))


def _bounds_of(symbol: sympy.Expr, bounds: Bounds) -> Bounds:
    """Bounds of a symbol that its assumptions also allow."""
    low, high = bounds
    if symbol.is_nonnegative:
        low = Fraction(0) if low is None else max(low, Fraction(0))
    if symbol.is_nonpositive:
        high = Fraction(0) if high is None else min(high, Fraction(0))
    return low, high


def _part(number: int, k: int) -> float:
    """The fractional part of a multiple of the root of a prime."""
    return math.sqrt(PRIMES[k % len(PRIMES)]) * (number + 1 + abs(k) // len(PRIMES)) % 1


def _whole(symbol: sympy.Expr, value: Fraction | float, above: bool) -> int:
    """A whole number near a value, on the side where zero is not."""
    whole = math.floor(value) + above if value < 0 or above else math.ceil(value)
    if (symbol.is_even and whole % 2) or (symbol.is_odd and not whole % 2):
        whole += 1 if value > 0 else -1
    return whole

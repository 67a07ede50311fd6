"""Numbers: values at any precision, accuracy, times and engine from what users give."""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from fractions import Fraction
from functools import lru_cache
from typing import Any, TypeAlias

import mpmath
import numpy as np
import sympy as sp

from geomtorsion.codegen import exact_number, rational
from geomtorsion.errors import AccuracyError, ShapeError, StartError, TimeError
from geomtorsion.exact.units import in_unit
from geomtorsion.support import checks
from geomtorsion.support.caching import read_only
from geomtorsion.support.precision import GOLDEN, working_precision

# A finite real number as it came: a float, a fraction, an exact sympy number, a longer float.
Real: TypeAlias = float | Fraction | sp.Expr | mpmath.mpf
# What users give for coordinates, velocities and states.
Numbers: TypeAlias = Sequence[Real] | np.ndarray


def checked_numbers(values: object, wanted: int, what: str) -> tuple[Any, ...]:
    """So many finite real numbers, unchanged (also fractions and sympy numbers)."""
    return checks.numbers(values, wanted, what, StartError, shape_error=ShapeError)


def mpf(value: Real, precision: int) -> mpmath.mpf:
    """A number as mpmath number with a given number of bits."""
    exact = exact_number(value, precision)
    if isinstance(exact, Fraction):
        with working_precision(precision):
            return mpmath.mpf(exact.numerator) / exact.denominator
    return exact


def precision_of(values: np.ndarray) -> int:
    """Precision in bits of the numbers in an array of an engine.

    Examples
    --------
    >>> precision_of(np.zeros(3))
    53
    """
    kind = values.dtype.type
    if kind in (np.float64, np.longdouble):
        return np.finfo(kind).nmant + 1
    return int(getattr(values.flat[0], "prec", 113)) if values.size else 113


def divided(value: Real, unit: float) -> Real:
    """A number of any kind divided by a power of two, exactly."""
    if unit == 1.0:
        return value
    if isinstance(value, int | float):
        return value / unit
    ratio = Fraction(unit)
    if isinstance(value, sp.Expr):
        return value / sp.Rational(ratio.numerator, ratio.denominator)
    if isinstance(value, Fraction):
        return value / ratio
    if isinstance(value, mpmath.mpf):
        # A quotient would be rounded to the digits that mpmath has at the moment.
        return mpmath.ldexp(value, -int(math.log2(unit)))
    return value / type(value)(unit)


def multiplied(values: np.ndarray, factors: float | np.ndarray) -> np.ndarray:
    """Rows of numbers of any precision times powers of two, at their own precision."""
    if values.dtype.type in (np.float64, np.longdouble):
        return values * factors
    kind = values.dtype.type
    table = np.array([kind(x) for x in np.broadcast_to(factors, values.shape[1:]).flat], dtype=kind)
    return values * table.reshape(values.shape[1:])


def floats(values: Iterable[Real]) -> list[float]:
    """Numbers as floats; StartError where one is beyond all floats, or complex."""
    try:
        return [float(value) for value in values]
    except (OverflowError, TypeError):
        raise StartError(
            "numbers of the equations: expected real numbers below 1.8e308 in size, got another. "
            "Use other units, or real equations."
        ) from None


def perturbed(
    values: Sequence[Real], part: float, precision: int, *, all_of_them: bool
) -> list[Real]:
    """Numbers changed by a relative part; zeros stay.

    Up by the part and down by its golden section in turn: up and down by the same would leave the
    energy of a circular orbit as it is.

    all_of_them: False keeps numbers that a float of this precision holds without rounding, and
        changes numbers of equal size alike, as rounding does: laws of conservation stay.

    Examples
    --------
    >>> perturbed([1.0, 2.0], 2.0**-10, 53, all_of_them=True)
    [1.0009765625, 1.998792902365723]
    """
    changed: list[Real] = []
    sizes = [] if all_of_them else [abs(value) for value in values]
    for place, value in enumerate(values):
        if not all_of_them and _is_held(value, precision):
            changed.append(value)
            continue
        k = place if all_of_them else sizes.index(sizes[place])
        change = -GOLDEN * part if k % 2 else part
        if precision == 53:
            changed.append(float(value) * (1 + change))
            continue
        bits = 2 * precision
        with working_precision(bits):
            changed.append(mpf(value, bits) * (1 + mpmath.mpf(change)))
    return changed


def _is_held(value: Real, precision: int) -> bool:
    """Whether a number is a float of this precision without rounding."""
    if precision >= 53 and isinstance(value, float | int):
        return True
    fraction = rational(value)
    if fraction is None:
        return False
    p, q = abs(fraction.numerator), fraction.denominator
    return q & (q - 1) == 0 and (p // (p & -p) if p else 0).bit_length() <= precision


# Default number of parts of a motion: samples of a solution requested at one time, pieces kept in a
# checkpoint, and points between which its error is examined.
PARTS = 64


def checked_accuracy(accuracy: object) -> float:
    """A positive finite number."""
    value = checks.real(accuracy)
    if value is None:
        raise AccuracyError(
            f"accuracy: expected a positive number, got {checks.shown(accuracy)}; 1e-10 is usual."
        )
    if not 0 < value < float("inf"):
        raise AccuracyError(f"accuracy: expected a positive number, got {value}.")
    return value


@lru_cache(maxsize=64)
def _samples(last: float) -> np.ndarray:
    """Even samples up to a time."""
    return read_only(np.linspace(0.0, last, PARTS + 1) if last else np.zeros(1))


TIMES = "a number or a list of numbers"


def checked_times(t: object) -> tuple[np.ndarray, np.ndarray]:
    """Times to report, and the grid from 0 through them; text with a unit is in seconds."""
    if isinstance(t, str | list | tuple):
        t = in_unit(t, "s", "t", TimeError)
    single = checks.real(t)
    if single is not None:
        if not np.isfinite(single):
            raise TimeError(f"t: expected finite times, got {single}.")
        if 0 < abs(single) < np.finfo(float).tiny:
            raise TimeError(
                f"t = {single}: expected 0 or at least 2.2e-308 in size, below which floats lose "
                "their digits. Use another unit of time."
            )
        return _samples(single), _samples(single)
    if isinstance(t, np.ndarray):
        # An array may show one number very often; it is looked at before it is copied.
        check_memory(t.size, 1)
    # A copy: what becomes of an array later is its owner's business.
    times = np.array(checks.array(t, "t", TimeError, expected=TIMES, infinite=None))
    if times.size == 0 or times.ndim != 1:
        raise TimeError(f"t: expected a number or a list of times, got shape {times.shape}.")
    if not np.isfinite(times).all():
        bad = times[~np.isfinite(times)][0]
        raise TimeError(f"t: expected finite times, got {bad}.")
    steps = np.diff(times)
    if (steps == 0).any():
        k = int(np.flatnonzero(steps == 0)[0])
        raise TimeError(
            f"t: expected different times, got {times[k]:.6g} at [{k}] and [{k + 1}]. Give it once."
        )
    rising = times[-1] > 0
    if not ((steps > 0).all() if rising else (steps < 0).all()):
        raise TimeError(
            "t: expected sorted times, got unsorted ones. Sort them from t = 0 outwards."
        )
    if (times[0] < 0) if rising else (times[0] > 0):
        raise TimeError(
            f"t: expected times on one side of the start at t = 0, got {times[0]:.6g} to "
            f"{times[-1]:.6g}. Solve forwards and backwards separately."
        )
    if times[0] != 0:
        return times, np.concatenate(([0.0], times))
    return times, times


def times_between(t: object) -> np.ndarray:
    """Times at which a solution is requested, of any shape, in any order."""
    times = checks.array(t, "t", TimeError, expected=TIMES, infinite=None)
    if not times.size:
        raise TimeError(f"t: expected a number or a list of times, got shape {times.shape}.")
    return times


def check_memory(times: int, states: int, members: int = 1) -> None:
    """Refuse more states than fit into memory, together with the states of the finer run."""
    many = f"{members:,} members at " if members > 1 else ""
    checks.check_room(
        2 * times * states * members,
        f"t: {many}{times:,} times of {states} states",
        "Give fewer times, or solve in parts: each from where the one before ended.",
    )


def one_time_only(t: object, times: np.ndarray, grid: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Only the last time, if one was requested: ensembles keep no samples on the way."""
    if checks.real(t) is not None and len(grid) > 1:
        return times[-1:], np.array([0.0, float(times[-1])])
    return times, grid

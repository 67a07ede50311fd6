"""Roots: all crossings of zero of a smooth function of time, given by its values."""

from __future__ import annotations

import math
import sys
from collections.abc import Callable
from typing import TypeAlias

import numpy as np

from geomtorsion.support.precision import EPS, GOLDEN

# Two crossings may hide where a parabola through three places comes this near to zero.
NEAR = 0.3
# Golden sections until the lowest place between three is found as exactly as doubles allow.
SECTIONS = math.ceil(math.log(EPS) / math.log(GOLDEN))

Values: TypeAlias = Callable[[np.ndarray], np.ndarray]


def crossings(
    function: Values, times: np.ndarray, values: np.ndarray, direction: int = 0
) -> np.ndarray:
    """Times, in order, at which a function crosses zero.

    Parameters
    ----------
    function
        of an array of times.
    times, values
        places close enough to see each crossing, or the valley of each close pair of them.
    direction
        1: upwards only, in the order of the times; -1: downwards only.
    """
    times, values = times[values != 0], values[values != 0]
    times, values = _with_valleys(function, times, values)
    signs = np.sign(values)
    place = np.flatnonzero(signs[:-1] != signs[1:])
    if direction:
        place = place[signs[place + 1] == direction]
    return bisected(function, times[place], times[place + 1], signs[place])


def _with_valleys(
    function: Values, times: np.ndarray, values: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """With a place beyond zero in each valley that reaches through it between two places."""
    if len(values) < 3:
        return times, values
    signs, sizes = np.sign(values), np.abs(values)
    left, middle, right = sizes[:-2], sizes[1:-1], sizes[2:]
    bend = left - 2 * middle + right
    with np.errstate(all="ignore"):
        reach = middle - (right - left) ** 2 / (8 * bend)
    valley = (signs[:-2] == signs[1:-1]) & (signs[2:] == signs[1:-1]) & (bend > 0)
    valley &= (middle <= left) & (middle <= right) & (reach < NEAR * middle)
    place = np.flatnonzero(valley) + 1
    if not len(place):
        return times, values
    sign, low, high = signs[place], times[place - 1], times[place + 1]
    through, crossed = np.zeros(len(place)), np.zeros(len(place), dtype=bool)
    for _ in range(SECTIONS):
        first, second = high - GOLDEN * (high - low), low + GOLDEN * (high - low)
        one, two = sign * function(first), sign * function(second)
        for at, value in ((first, one), (second, two)):
            through = np.where(~crossed & (value < 0), at, through)
            crossed |= value < 0
        if crossed.all():
            break
        lower = one <= two
        high, low = np.where(lower, second, high), np.where(lower, low, first)
    return _inserted(times, values, place[crossed], through[crossed], -sign[crossed])


def _inserted(
    times: np.ndarray, values: np.ndarray, place: np.ndarray, extra: np.ndarray, signs: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """Places added in the order of the times."""
    forward = times[-1] >= times[0]
    before = extra < times[place] if forward else extra > times[place]
    where = np.where(before, place, place + 1)
    return np.insert(times, where, extra), np.insert(values, where, signs)


def bisected(function: Values, low: np.ndarray, high: np.ndarray, sign: np.ndarray) -> np.ndarray:
    """The crossings between pairs of times, all at once."""
    if not len(low):
        return low
    # Each halving adds a digit of a double.
    for _ in range(sys.float_info.mant_dig):
        middle = low + (high - low) / 2
        if ((middle == low) | (middle == high)).all():
            break
        before = np.sign(function(middle)) == sign
        low, high = np.where(before, middle, low), np.where(before, high, middle)
    return high


def crossing_beyond(function: Values, time: float, sign: float) -> float:
    """Where a function crosses zero downwards soon after a time at which it is a rounding above.

    It is looked for over half of the digits: a function that crosses later vanishes so slowly that
    the time itself is as good an answer.

    Parameters
    ----------
    function
        of an array of times.
    sign
        direction of time.
    """
    steps = np.exp2(np.arange(math.ceil(-math.log2(EPS) / 2)))
    times = time + sign * math.ulp(time) * np.concatenate(([0.0], steps))
    signs = np.where(function(times) > 0, 1, -1)
    place = np.flatnonzero(signs[:-1] > signs[1:])[:1]
    if signs[0] < 0 or not len(place):
        return time
    return float(bisected(function, times[place], times[place + 1], signs[place])[0])


def shares_left(here: np.ndarray, before: np.ndarray) -> list[float]:
    """Remaining fraction of each of several values; zero for values that no longer exist."""
    with np.errstate(all="ignore"):
        return np.nan_to_num(np.abs(here / before), nan=0.0).tolist()


def nearest_to_zero(here: np.ndarray, before: np.ndarray) -> int:
    """Index of the value nearest to zero, each relative to its size before."""
    return int(np.argmin(shares_left(here, before)))

"""Fitting: parameters of a family of geometries at which the invariants of a given point recur."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass

import numpy as np
import sympy as sp

from geomtorsion.same.demands import ALIKE, Demands, best_starts
from geomtorsion.same.invariant_values import Array, Evaluation
from geomtorsion.same.invariants import Invariants
from geomtorsion.same.matching import coordinate_bounds, floats
from geomtorsion.support.allowance import check_limits

# A parameter that may change by this factor without effect is zero, infinite or free.
STRETCH = ALIKE**-0.5
# Sum of squares of relative differences at which parameters fit.
ENOUGH = ALIKE**2


@dataclass(frozen=True, eq=False)
class Fit:
    """Point and parameters of the second geometry with the invariants of a point of the first.

    place: coordinates of the point of the second geometry.
    values: one number for each parameter; 0 and infinity are limits.
    """

    place: Array
    values: tuple[float, ...]


def parameters_near(
    one: Invariants, start: Mapping[sp.Symbol, sp.Rational], two: Invariants, starts: int
) -> Iterator[Fit | None]:
    """Values of the parameters of the second geometry at which a point of the first recurs.

    One result for each start, None where the fit fails. The scale of lengths is fitted first, then
    the scalars of low order, then all of them.
    """
    highest = max(one.highest, 1)
    exact = Evaluation(one, highest).at(start, 20)
    if exact is None:
        yield None
        return
    goal = floats(exact)
    positive = _lengths(two)
    orders = sorted({max(highest - 1, 0), highest})
    stages = [Demands(goal, two, order, positive) for order in orders]
    if not len(stages[-1].aim):
        yield None
        return
    first = next(stage for stage in stages if len(stage.aim))
    for y in best_starts(first, starts):
        check_limits()
        y = _fitted(stages, y)
        n = len(two.frame.coordinates)
        limits = None if y is None else tuple(_limits(stages[-1], y, n))
        yield None if y is None or limits is None else Fit(stages[-1].symbols(y)[:n], limits)


def _lengths(two: Invariants) -> Array:
    """Which symbols are positive without an upper bound, as lengths are."""
    frame = two.frame
    symbols = (*frame.coordinates, *frame.parameters)
    _, high = coordinate_bounds(frame, symbols)
    signs = [x.is_positive or frame.region.sign(x) == 1 for x in symbols]
    return np.array([bool(sign) and end == np.inf for sign, end in zip(signs, high, strict=True)])


def _fitted(stages: Sequence[Demands], y: Array) -> Array | None:
    """Symbols that meet all demands, from a start; None if they were not reached."""
    for stage in stages:
        if len(stage.aim):
            solution = stage.nearest(y, ENOUGH)
            if solution is None:
                return None
            y = solution
    return y


def _limits(demands: Demands, y: Array, first: int) -> Iterator[float]:
    """The values of the parameters, of which those that have no effect are 0 or infinite."""
    values = demands.symbols(y)
    for k in range(first, len(y)):
        # In units of the lengths at the point.
        size = float(values[k]) * demands.size
        if demands.positive[k] and not ALIKE < size < 1 / ALIKE:
            yield 0.0 if size < 1 else np.inf
            continue
        if demands.positive[k]:
            changes = [y[k] - np.log(STRETCH), y[k] + np.log(STRETCH)]
        else:
            changes = [0.0, y[k] * STRETCH]
        free = []
        for other in changes:
            moved = y.copy()
            moved[k] = other
            rest = demands.miss(moved)
            free.append(rest is not None and float(rest @ rest) < ENOUGH)
        if free == [True, True]:
            # Without effect: the simplest allowed value.
            yield 1.0 if demands.positive[k] else 0.0
        else:
            yield 0.0 if free[0] else np.inf if free[1] else float(values[k])

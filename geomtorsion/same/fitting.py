"""Fitting: parameters of a family of geometries at which the invariants of a given point recur."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from itertools import islice

import numpy as np
import sympy as sp

from geomtorsion.same.invariants import Invariants
from geomtorsion.same.matching import floats, least_squares
from geomtorsion.same.values import ROUNDING, Array, Evaluation, Values
from geomtorsion.support.allowance import check_limits
from geomtorsion.support.precision import EPS

# A parameter that may change by this factor without effect is zero, infinite or free.
STRETCH = 1e3
# Sum of squares of relative differences at which parameters fit: rounding errors, some hundred.
ENOUGH = 1e4 * EPS
# The largest logarithm of a positive symbol, in units of the scale of lengths.
LARGEST = 30.0


@dataclass(frozen=True)
class Fit:
    """Values of parameters at which the invariants of a point recur.

    values: one number for each parameter; 0 and infinity are limits.
    """

    values: tuple[float, ...]


class Demands:
    """Differences of the scalars of two geometries up to an order, each a power of 1/length.

    Scalars of very different powers of length become comparable as sign(s) |s|^(1/weight).
    """

    def __init__(self, goal: Values, two: Invariants, order: int, positive: Array) -> None:
        self.goal, self.two, self.positive = goal.to(order), two, positive
        self.evaluation = Evaluation(two, order)
        aim = self._numbers(self.goal)
        weights = self.goal.scalar_weights if two.turns else self.goal.component_weights
        self.weights = weights(two.weights)
        rooted = self._rooted(aim)
        self.size = float(np.max(np.abs(rooted), initial=0.0))
        # The others are sums of larger terms that cancel.
        self.used = np.abs(aim) > ROUNDING * self.size**self.weights
        self.aim = rooted[self.used]

    def _numbers(self, values: Values) -> Array:
        return np.real(values.scalars if self.two.turns else values.flat)

    def _rooted(self, numbers: Array) -> Array:
        return np.sign(numbers) * np.abs(numbers) ** (1 / self.weights)

    def symbols(self, y: Array) -> Array:
        """Values of the symbols; positive ones are given by their logarithms."""
        return np.where(self.positive, np.exp(np.clip(y, -LARGEST, LARGEST)), y)

    def _at(self, y: Array) -> Array | None:
        values = self.evaluation.near(self.symbols(y))
        if values is None or values.signs != self.goal.signs:
            return None
        with np.errstate(all="ignore"):
            numbers = self._rooted(self._numbers(values))[self.used]
        return numbers if np.all(np.isfinite(numbers)) else None

    def miss(self, y: Array) -> Array | None:
        """Differences in units of the largest; None where they are not finite."""
        numbers = self._at(y)
        return None if numbers is None else (numbers - self.aim) / self.size

    def scale(self, y: Array) -> float | None:
        """Lengths of the point of the first geometry in units of those of the second."""
        numbers = self._at(y)
        if numbers is None:
            return None
        with np.errstate(all="ignore"):
            ratio = float(np.median(np.abs(numbers / self.aim)))
        return ratio if np.isfinite(ratio) and ratio > 0 else None


def parameters_near(
    one: Invariants, start: Mapping[sp.Symbol, sp.Rational], two: Invariants, starts: int
) -> Iterator[Fit]:
    """Values of the parameters of the second geometry at which a point of the first recurs.

    The scale of lengths is fitted first, then the scalars of low order, then all of them.
    """
    highest = max(one.highest, 1)
    exact = Evaluation(one, highest).at(start, 20)
    if exact is None:
        return
    goal = floats(exact)
    symbols = (*two.frame.coordinates, *two.frame.parameters)
    positive = np.array([bool(q.is_positive) for q in symbols])
    orders = sorted({max(highest - 1, 0), highest})
    stages = [Demands(goal, two, order, positive) for order in orders]
    if not len(stages[-1].aim):
        return
    for point in islice(two.frame.region.points(), starts):
        check_limits()
        y = np.array([float(point[q]) for q in symbols])
        y[positive] = np.log(y[positive])
        for stage in stages:
            scale = stage.scale(y) if len(stage.aim) else None
            if scale is not None:
                y = np.where(positive, y + np.log(scale), y)
                break
        y = _fitted(stages, y)
        if y is not None:
            yield Fit(tuple(_limits(stages[-1], y, len(two.frame.coordinates))))


def _fitted(stages: Sequence[Demands], y: Array) -> Array | None:
    """Symbols that meet all demands, from a start; None if they were not reached."""
    for stage in stages:
        if len(stage.aim):
            solution = least_squares(stage.miss, y, ENOUGH)
            if solution is None:
                return None
            y = solution
    return y


def _limits(demands: Demands, y: Array, first: int) -> Iterator[float]:
    """The values of the parameters, of which those that have no effect are 0 or infinite."""
    values = demands.symbols(y)
    for k in range(first, len(y)):
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
        yield (
            0.0 if free == [True, False] else np.inf if free == [False, True] else float(values[k])
        )

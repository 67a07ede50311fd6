"""Demands: the scalars of a point that must recur, as powers of length that can be compared."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from itertools import islice

import numpy as np
import scipy  # loads its subpackages at first use

from geomtorsion.same.invariant_values import ROUNDING, Array, Evaluation, Values
from geomtorsion.same.invariants import Invariants
from geomtorsion.support.caching import cached_property
from geomtorsion.support.precision import EPS

# Singular values that are zero up to the errors of floats, in units of the largest.
ALIKE = 1e-6
# Relative difference of invariants that is used for points where they are not finite.
FAR = ALIKE**-0.5
# Relative fall of the sum of squares below which it ends at a minimum that is not a zero.
STALLED = ALIKE
# Points of the region among which starts are chosen.
POINTS = 200
# The largest logarithm of a positive symbol: beyond it sums of floats forget the smaller term.
LARGEST = -np.log(EPS)


class Demands:
    """Differences of the scalars of two geometries up to an order, each a power of 1/length.

    Scalars of very different powers of length become comparable as sign(s) |s|^(1/weight).
    """

    def __init__(self, goal: Values, two: Invariants, order: int, positive: Array) -> None:
        self.goal, self.two, self.positive = goal.to(order), two, positive
        self.order = order
        self.evaluation = Evaluation(two, order)
        aim = self._numbers(self.goal)
        weights = self.goal.scalar_weights if two.turns else self.goal.component_weights
        self.weights = weights(two.weights)
        rooted = self._rooted(aim)
        self.size = float(np.max(np.abs(rooted), initial=0.0))
        # The others are sums of larger terms that cancel.
        self.used = np.abs(aim) > ROUNDING * self.size**self.weights
        self.aim = rooted[self.used]

    @cached_property
    def moving(self) -> Array:
        """Which symbols change any of the invariants."""
        frame, orders = self.two.frame, range(self.order + 1)
        tensors = [*(t for k in orders for t in self.two.order(k)), self.two.scalar_product]
        elements = [x for t in tensors for x in t.components.independent.values()]
        symbols = (*frame.coordinates, *frame.parameters)
        return np.array([not all(x.free_of(q) for x in elements) for q in symbols])

    def nearest(
        self, y: Array, enough: float = 1e-14, bounds: tuple[Array, Array] | None = None
    ) -> Array | None:
        """Symbols that meet the demands, by least squares from a start; None if not reached."""
        moving = self.moving

        def whole(part: Array) -> Array:
            result = y.copy()
            result[moving] = part
            return result

        within = None if bounds is None else (bounds[0][moving], bounds[1][moving])
        part = least_squares(lambda x: self.miss(whole(x)), y[moving], enough, within)
        return None if part is None else whole(part)

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
        """Factor from lengths at a point of the second geometry to lengths at the first."""
        numbers = self._at(y)
        if numbers is None:
            return None
        with np.errstate(all="ignore"):
            ratio = float(np.median(np.abs(numbers / self.aim)))
        return ratio if np.isfinite(ratio) and ratio > 0 else None


def best_starts(demands: Demands, most: int) -> Iterator[Array]:
    """Points of the region at which the demands are met best, in the units of the goal."""
    frame, positive = demands.two.frame, demands.positive
    symbols = (*frame.coordinates, *frame.parameters)
    ranked = []
    for point in islice(frame.region.points(), POINTS):
        y = np.array([float(point[q]) for q in symbols])
        y[positive] = np.log(y[positive])
        scale = demands.scale(y) if np.any(positive) else None
        if scale is not None:
            y = np.where(positive, y + np.log(scale), y)
        rest = demands.miss(y)
        if rest is not None:
            ranked.append((float(rest @ rest), y))
    yield from (y for _, y in sorted(ranked, key=lambda entry: entry[0])[:most])


def least_squares(
    miss: Callable[[Array], Array | None],
    start: Array,
    enough: float = 1e-14,
    bounds: tuple[Array, Array] | None = None,
) -> Array | None:
    """A zero of a function near a start, within bounds; None if none was reached.

    enough: the sum of squares at which it counts as a zero.
    """
    first = miss(start)
    if first is None:
        return None

    def finite(x: Array) -> Array:
        value = miss(x)
        return np.full(len(first), FAR) if value is None else value

    limits = (-np.inf, np.inf) if bounds is None else bounds
    options = {"ftol": STALLED, "xtol": EPS, "gtol": None, "x_scale": "jac", "max_nfev": 80}
    with np.errstate(all="ignore"):
        # Steps of length zero in directions without effect, as along symmetries.
        result = scipy.optimize.least_squares(finite, start, "2-point", limits, **options)
    return result.x if 2 * result.cost < enough else None

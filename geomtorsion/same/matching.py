"""Matching: a point of one geometry, and a turn of its legs, at which another looks the same."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from itertools import islice

import mpmath
import numpy as np
import sympy as sp

from geomtorsion.geometry import Frame
from geomtorsion.same.demands import ALIKE, Demands, best_starts, least_squares
from geomtorsion.same.invariant_values import Array, Evaluation, Values, generators
from geomtorsion.same.invariants import Invariants
from geomtorsion.support.allowance import check_limits
from geomtorsion.support.caching import cached_property
from geomtorsion.support.precision import working_digits

# Digits to which invariants are compared, and those with which they are computed.
DIGITS = 50
WORKING = DIGITS + 15


@dataclass(frozen=True, eq=False)
class Match:
    """Two points, and the difference of the compared invariants there.

    start, goal: coordinates of the first and of the second geometry.
    turn: turn[a, b], legs of the first in terms of legs of the second; None: fixed legs.
    difference: the largest difference of two invariants, relative to the largest of its order.
    """

    start: Mapping[sp.Symbol, sp.Rational | mpmath.mpf]
    goal: Mapping[sp.Symbol, sp.Rational | mpmath.mpf]
    turn: Array | None
    difference: float

    def inverted(self) -> Match:
        """The match of the second geometry with the first."""
        turn = self.turn
        if turn is not None:
            with working_digits(WORKING):
                turn = np.array((mpmath.matrix(turn.tolist()) ** -1).tolist(), dtype=object)
        return Match(self.goal, self.start, turn, self.difference)

    @property
    def reflects(self) -> bool:
        """Whether left and right are exchanged."""
        return self.turn is not None and np.linalg.det(self.turn.astype(float)) < 0


def identity(invariants: Invariants) -> Match:
    """The match of a geometry with itself."""
    frame = invariants.frame
    point = {q: frame.region.point[q] for q in frame.coordinates}
    n = range(frame.dimension)
    turn = np.array([[mpmath.mpf(i == j) for j in n] for i in n], dtype=object)
    return Match(point, point, turn if invariants.turns else None, 0.0)


class Search:
    """The search for a point at which a geometry has the invariants of another at its point."""

    def __init__(
        self,
        one: Invariants,
        two: Invariants,
        proper: bool,
        tries: int,
        near: Array | None = None,
    ) -> None:
        self.one, self.two, self.proper, self.tries = one, two, proper, tries
        self.near = near
        self.highest = max(one.highest, 1)
        self.random = np.random.default_rng(1)

    def match(self) -> Match | None:
        """The best match; None if no point was near one."""
        # All orders of the first geometry at one point, and of the second where they are needed.
        evaluation, values, start = Evaluation(self.one, self.highest), None, {}
        for start in islice(self.one.frame.region.points(), 20):
            values = evaluation.at(start, WORKING)
            if values is not None:
                break
        if values is None:
            return None
        best: Match | None = None
        for place, turn in islice(self._near(values), 6):
            match = self._refined(start, values, place, turn)
            if match is not None and (best is None or match.difference < best.difference):
                best = match
            if best is not None and best.difference < 10.0**-DIGITS * 1e8:
                break
        return best

    # -- floats ----------------------------------------------------------------------------------

    def _near(self, exact: Values) -> Iterator[tuple[Array, Array | None]]:
        """Points and turns at which the invariants agree as floats."""
        goal = floats(exact).to(self.highest - 1)
        self._evaluation = Evaluation(self.two, self.highest - 1)
        scale = _scales(goal)
        n, signs = self.two.frame.dimension, goal.signs
        planes = generators(signs) if self.two.turns else []
        base = np.eye(n)

        def miss(x: Array) -> Array | None:
            values = self._evaluation.near(x[:n])
            if values is None or values.signs != signs:
                return None
            if planes:
                values = values.turned(_cayley(planes, x[n:]) @ base)
            rest = (values.flat - goal.flat) / scale
            return np.concatenate([rest.real, rest.imag]) if np.iscomplexobj(rest) else rest

        def turn_miss(angles: Array) -> Array:
            assert here is not None
            values = here.turned(_cayley(planes, angles) @ base)
            return (values.flat - goal.flat) / scale

        every = floats(exact)
        sizes = _scales(every)
        for start in self._starts(goal):
            here = self._evaluation.near(start)
            if here is None:
                continue
            whole: Values | None = None
            tried = 0
            # Legs in all parts of the group of turns: some only after a reflection.
            for base in self._bases(here, goal) if planes else [np.eye(n)]:
                check_limits()
                angles = np.zeros(len(planes))
                if planes and self.two.coordinates and goal.has_scalars:
                    angles = least_squares(turn_miss, angles, 1e-12)
                    if angles is None:
                        continue
                x = least_squares(miss, np.concatenate([start, angles]), bounds=self._bounds)
                if x is None or not lies_in(self.two.frame, x[:n]):
                    continue
                turn = _cayley(planes, x[n:]) @ base if planes else None
                if turn is None:
                    yield x[:n], None
                    break
                # Turns that agree so far may differ in the last derivatives, as reflections do.
                tried += 1
                if whole is None or _size(x[:n] - start) > ALIKE:
                    whole = self._whole(x[:n])
                if whole is None:
                    break
                rest = (whole.turned(turn).flat - every.flat) / sizes
                if _size(rest) < 1e-4 or tried == self.tries:
                    yield x[:n], turn
                    break

    @cached_property
    def _bounds(self) -> tuple[Array, Array]:
        """The smallest and the largest value of each coordinate and of each angle of a turn."""
        frame = self.two.frame
        low, high = coordinate_bounds(frame, frame.coordinates)
        free = np.full(len(self.two.pairs), np.inf)
        return np.concatenate([low, -free]), np.concatenate([high, free])

    def _whole(self, place: Array) -> Values | None:
        """All orders at a point, as floats."""
        point = {q: mpmath.mpf(x) for q, x in zip(self.two.frame.coordinates, place, strict=True)}
        values = Evaluation(self.two, self.highest).at(point, 20)
        return None if values is None else floats(values)

    def _starts(self, goal: Values) -> Iterator[Array]:
        """Points at which the scalars agree, or points of the region where none is needed."""
        coordinates = self.two.frame.coordinates
        if self.near is not None and lies_in(self.two.frame, self.near):
            yield self.near
            return
        points = islice(self.two.frame.region.points(), self.tries)
        plain = (np.array([float(point[q]) for q in coordinates]) for point in points)
        if not self.two.turns:
            yield from plain
        elif self.two.coordinates == 0:
            yield from islice(plain, 1)
        elif not goal.has_scalars:
            yield from plain
        else:
            demands = Demands(goal, self.two, self.highest - 1, np.zeros(len(coordinates), bool))
            low, high = (ends[: len(coordinates)] for ends in self._bounds)
            for start in best_starts(demands, self.tries):
                check_limits()
                place = demands.nearest(start, bounds=(low, high))
                if place is not None:
                    yield place

    def _bases(self, here: Values, goal: Values) -> Iterator[Array]:
        """Turns to begin with: those that turn the matrices into each other, then random ones."""
        turns = [t for t in _between(here, goal, self.random) if self._allows(t)]
        yield from sorted(turns, key=lambda turn: _size(here.turned(turn).flat - goal.flat))[:4]
        signs = goal.signs
        planes = generators(signs)
        minus, plus = ([k for k, s in enumerate(signs) if s == sign] for sign in (-1, 1))
        for _ in range(self.tries):
            for flips in ((), minus[:1], plus[:1], (*minus[:1], *plus[:1])):
                base = np.eye(len(signs))
                for k in flips:
                    base[k, k] = -1.0
                turn = _cayley(planes, self.random.normal(size=len(planes))) @ base
                if self._allows(turn):
                    yield turn

    def _allows(self, turn: Array) -> bool:
        """Whether a turn is one that may be used."""
        return not self.proper or np.linalg.det(turn) > 0

    # -- many digits -----------------------------------------------------------------------------

    def _refined(
        self, start: dict, values: Values, place: Array, turn: Array | None
    ) -> Match | None:
        """A match to all digits, by Newton's method with the slopes of the first geometry."""
        frame = self.two.frame
        goal = values.to(self.highest - 1)
        plain = floats(goal)
        scale, planes, n = _scales(plain), generators(values.signs), frame.dimension

        def miss(x: Array) -> Array | None:
            near = self._evaluation.near(x[:n])
            if near is None or near.signs != goal.signs:
                return None
            near = near if turn is None else near.turned(_cayley(planes, x[n:]) @ turn)
            return (near.flat - plain.flat) / scale

        zeros = np.zeros(0 if turn is None else len(planes))
        slopes = _slopes(miss, np.concatenate([place, zeros]))
        if slopes is None:
            return None
        inverse = np.linalg.pinv(slopes, rcond=ALIKE)
        evaluation = Evaluation(self.two, self.highest - 1)
        with working_digits(WORKING):
            point = {q: mpmath.mpf(x) for q, x in zip(frame.coordinates, place, strict=True)}
            turning = None if turn is None else _orthogonal(turn, values.signs)
            before = mpmath.inf
            for _ in range(16):
                other = evaluation.at(point, WORKING)
                if other is None or other.signs != values.signs:
                    return None
                along = other if turning is None else other.turned(turning)
                rest = (along.flat - goal.flat) / scale
                size = max((abs(x) for x in rest), default=mpmath.mpf(0))
                if size < mpmath.mpf(10) ** (5 - WORKING):
                    break
                if size > before / 10 and size > mpmath.mpf(10) ** -DIGITS:
                    # A minimum that is not a zero.
                    return Match(start, point, turning, float(size))
                before = size
                step = -inverse @ np.array([complex(x / size) for x in rest])
                step = [mpmath.mpf(float(x.real)) * size for x in step]
                for q, x in zip(frame.coordinates, step, strict=False):
                    point[q] += x
                if turning is not None:
                    change = sum(
                        x * g.astype(object) for x, g in zip(step[n:], planes, strict=True)
                    )
                    turning = _orthogonal(turning + change @ turning, values.signs)
            whole = Evaluation(self.two, self.highest).at(point, WORKING)
            if whole is None:
                return None
            whole = whole if turning is None else whole.turned(turning)
            return Match(start, point, turning, _difference(values, whole))


def coordinate_bounds(frame: Frame, symbols: Sequence[sp.Symbol]) -> tuple[Array, Array]:
    """Numbers between which the region of a frame and the assumptions hold symbols."""
    ends = []
    for q in symbols:
        low, high = (0.0 if q.is_positive else -np.inf), (0.0 if q.is_negative else np.inf)
        for relation in frame.region.relations:
            less, greater = getattr(relation, "lts", q), getattr(relation, "gts", q)
            if greater == q and less.is_number:
                low = max(low, float(less))
            elif less == q and greater.is_number:
                high = min(high, float(greater))
        ends.append((low, high))
    low, high = np.array(ends).reshape(-1, 2).T
    return low, high


def lies_in(frame: Frame, place: Array) -> bool:
    """Whether the region of a frame contains a point."""
    point = {q: sp.Float(float(x)) for q, x in zip(frame.coordinates, place, strict=True)}
    return all(relation.subs(point) != sp.false for relation in frame.region.relations)


def _slopes(miss: Callable[[Array], Array | None], x: Array) -> Array | None:
    """Slopes of a function by central differences."""
    columns = []
    for k in range(len(x)):
        # The errors of rounding and of the third derivative are of one size.
        width = 1e-5 * max(abs(x[k]), 1.0)
        ends = []
        for sign in (1, -1):
            moved = x.copy()
            moved[k] += sign * width
            ends.append(miss(moved))
        if ends[0] is None or ends[1] is None:
            return None
        columns.append((ends[0] - ends[1]) / (2 * width))
    return np.stack(columns, axis=1)


def _cayley(planes: Sequence[Array], angles: Array) -> Array:
    """A turn by its angles in planes, as long as they are small (Cayley)."""
    half = np.tensordot(angles, np.stack(planes), 1) / 2
    one = np.eye(len(half))
    return np.linalg.solve(one - half, one + half)


def _between(one: Values, two: Values, random: np.random.Generator) -> Iterator[Array]:
    """Turns L with two.matrices = L one.matrices L^T, as far as matrices determine them."""
    signs, n = np.array(one.signs), len(one.signs)
    rows = []
    for first, second in zip(one.matrices, two.matrices, strict=True):
        size = np.max(np.abs(second), initial=0)
        if size:
            # L M_1 = M_2 L with mixed indices, linear in L.
            a, b = signs[:, None] * first / size, signs[:, None] * second / size
            rows.append(np.kron(np.eye(n), a.T) - np.kron(b, np.eye(n)))
    if not rows:
        return
    _, lengths, vectors = np.linalg.svd(np.concatenate(rows))
    basis = vectors[lengths < ALIKE * lengths[0]] if lengths[0] else vectors
    if not len(basis):
        return
    for _ in range(16 * n):
        turn = (random.normal(size=len(basis)) @ basis).reshape(n, n)
        for _ in range(40):
            if not abs(np.linalg.det(turn)) > 1e-12:
                break
            # Newton's method for the polar decomposition; both terms solve the linear equations.
            turn = (turn + signs[:, None] * np.linalg.inv(turn).T * signs) / 2
        rest = (turn * signs) @ turn.T - np.diag(signs)
        if np.all(np.isfinite(rest)) and np.max(np.abs(rest)) < 1e-6 * np.max(turn**2):
            yield turn


def _size(numbers: Array) -> float:
    return float(np.max(np.abs(numbers), initial=0))


def _orthogonal(turn: Array, signs: Sequence[int]) -> Array:
    """The turn near a matrix that is nearly one."""
    n = len(signs)
    matrix = np.array([[mpmath.mpf(x) for x in row] for row in turn], dtype=object)
    eta = np.array([mpmath.mpf(s) for s in signs], dtype=object)
    for _ in range(8):
        square = (matrix * eta) @ matrix.T * eta
        rest = square - np.array([[mpmath.mpf(i == j) for j in range(n)] for i in range(n)])
        if max(abs(x) for x in rest.ravel()) < mpmath.mpf(10) ** (3 - WORKING):
            break
        matrix = matrix - rest @ matrix / 2
    return matrix


def floats(values: Values) -> Values:
    """The same numbers as floats."""

    def plain(t: Array) -> Array:
        numbers = t.astype(complex)
        return numbers if np.any(np.imag(numbers)) else np.real(numbers)

    orders = tuple(tuple(plain(t) for t in order) for order in values.orders)
    return Values(values.signs, orders, plain(values.legs))


def _scales(values: Values) -> Array:
    """For each component the largest one of its order."""
    sizes = []
    for order in values.orders:
        most = max((float(np.max(np.abs(t), initial=0)) for t in order), default=0.0)
        sizes += [np.full(t.size, most or 1.0) for t in order]
    return np.concatenate(sizes) if sizes else np.zeros(0)


def _difference(one: Values, two: Values) -> float:
    """The largest difference, relative to the largest component of its order."""
    worst = 0.0
    for first, second in zip(one.orders, two.orders, strict=True):
        size = max((abs(x) for t in first for x in t.ravel()), default=0) or mpmath.mpf(1)
        for a, b in zip(first, second, strict=True):
            worst = max(
                [worst, *(float(abs(x - y) / size) for x, y in zip(a.flat, b.flat, strict=True))]
            )
    return worst

"""Shooting: where motions from one point end, and by how much they miss another point."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from itertools import product

import numpy as np

from geomtorsion.curves.atlas import MovingPoint
from geomtorsion.curves.distance import angles_of
from geomtorsion.curves.problem import CurveProblem
from geomtorsion.errors import ChartEdgeError
from geomtorsion.geometry import Frame
from geomtorsion.ode.engines import Engine
from geomtorsion.ode.newton import Shot, lengths_of
from geomtorsion.ode.trajectory import integrate
from geomtorsion.support.caching import cached_property
from geomtorsion.support.checks import check_room

TURN = 2 * np.pi
# Coordinates of a target and of an end are each off by a rounding, their frame by some more.
ROUNDING = 16 * np.finfo(float).eps
# Nodes of the quadrature along a line; nodes cluster at both ends, to 1e-37 of its length.
NODES = np.linspace(-4.0, 4.0, 257)


@dataclass(frozen=True, eq=False)
class Aim:
    """A point to be hit.

    label: the chart in which the point is farthest from the edge.
    names: its coordinates there, one row for each name of the point.
    frames: for each name the matrix from coordinate differences to weighted frame components; in a
        redundant chart further rows give the part of a difference that is normal to the space.
    rounding: size of the rounding error of the coordinates, in the frame.
    """

    label: str
    names: np.ndarray
    frames: np.ndarray
    rounding: float


@dataclass(frozen=True, eq=False)
class Line:
    """The straight line in coordinates from a point to an image of another.

    start, end: coordinates; lengths: at NODES, measured by |eta|; not finite outside the frame.
    """

    start: np.ndarray
    end: np.ndarray
    lengths: np.ndarray

    @property
    def length(self) -> float:
        """Length of the line."""
        return float(self.lengths[-1])

    def at(self, length: float) -> np.ndarray:
        """Coordinates of the point at a length from the start."""
        if length >= self.length:
            return self.end
        ahead, behind = _shares(np.interp(length, self.lengths, NODES))
        return ahead * self.start + behind * self.end


def _shares(nodes: np.ndarray | np.floating) -> tuple[np.ndarray, np.ndarray]:
    """Shares of the start and of the end of a line in its points; both keep all digits."""
    exponent = np.pi * np.sinh(nodes)
    return 1 / (1 + np.exp(exponent)), 1 / (1 + np.exp(-exponent))


def weights_of(frame: Frame) -> np.ndarray:
    """The symmetric matrix W with W W = |eta|: all signs of the metric count as positive."""
    squares, axes = np.linalg.eigh(np.real(frame.eta.at({})))
    return axes @ np.diag(np.sqrt(np.abs(squares))) @ axes.T


@dataclass(frozen=True, eq=False)
class Shooter:
    """Motions from one point, as a function of the weighted initial velocity v = W u.

    The length of v is the length of the motion where eta is definite. Lengths of differences are
    measured in the frame at the target, so that units of coordinates do not matter.

    problem: the law and the start; engine, tolerance: how motions are followed.
    """

    problem: CurveProblem
    engine: Engine
    tolerance: float

    @property
    def home(self) -> str:
        """Name of the chart of the problem."""
        return self.problem.atlas.home

    @cached_property
    def numbers(self) -> dict[str, float]:
        """Values of the parameters."""
        return {key: float(value) for key, value in self.problem.parameters.items()}

    @cached_property
    def weights(self) -> np.ndarray:
        """W of the frame of the problem."""
        return weights_of(self.problem.frame)

    @cached_property
    def eta(self) -> np.ndarray:
        """The constant metric of the frame."""
        return np.real(self.problem.frame.eta.at({}))

    @cached_property
    def is_definite(self) -> bool:
        """Whether all squares of eta have one sign, so that lengths can be compared."""
        squares = np.linalg.eigvalsh(self.eta)
        return bool(squares.min() > 0 or squares.max() < 0)

    @cached_property
    def start(self) -> np.ndarray:
        """Coordinates of the start."""
        return np.array([float(x) for x in self.problem.start or ()])

    @cached_property
    def _turning(self) -> dict[str, list[int]]:
        """Chart -> coordinates that count modulo 2 pi."""
        names = {self.home, *self.problem.charts}
        return {name: angles_of(self.problem, name) for name in names}

    def velocity(self, vector: np.ndarray) -> np.ndarray:
        """Frame velocity u of a weighted velocity."""
        return np.linalg.solve(self.weights, vector)

    # -- motions ---------------------------------------------------------------------------------

    def places(
        self, vector: np.ndarray, parts: Sequence[float] | np.ndarray
    ) -> list[tuple[str, np.ndarray]]:
        """Charts and coordinates at parts of unit time, as far as the motion can be followed."""
        velocity = self.velocity(vector)
        member = replace(self.problem, frame_velocity=tuple(velocity.tolist()))
        stage = member.first_stage(self.engine.precision, 0.0)
        times = np.array([0.0, *parts]) * member.time_unit
        places, skip = [], 1
        for segment in integrate(stage, times, self.tolerance, self.engine).segments:
            width = member.equations(segment.label).width
            states = np.asarray(segment.states, dtype=float)[:, :width]
            places += [(segment.label, row) for row in states[skip:]]
            skip = max(skip - len(states), 0)
        return places

    def end(self, vector: np.ndarray) -> tuple[str, np.ndarray]:
        """Chart and coordinates at t = 1."""
        for label, place in self.places(vector, [1.0]):
            return label, place
        raise ChartEdgeError("the motion ends before t = 1")

    def shot(self, vector: np.ndarray, aim: Aim) -> Shot:
        """The motion of a velocity, with its miss."""
        return self.measured(vector, *self.end(vector), aim)

    def measured(self, vector: np.ndarray, label: str, place: np.ndarray, aim: Aim) -> Shot:
        """A motion at a position, with its distance from the target."""
        with np.errstate(all="ignore"):
            gaps = self._wrapped(aim.label, self._in(label, aim.label, place) - aim.names)
            rows = np.einsum("kij,kj->ki", aim.frames, gaps)
        sizes = lengths_of(rows)
        name = int(np.argmin(sizes))
        if not math.isfinite(sizes[name]):
            raise ChartEdgeError("the end of the motion has no coordinates near the target")
        return Shot(vector, rows[name, : len(vector)], float(sizes[name]), name)

    def distances(self, places: Sequence[tuple[str, np.ndarray]], aim: Aim) -> np.ndarray:
        """Distances of many positions from the target, infinite where they have no coordinates."""
        sizes = np.full(len(places), np.inf)
        for label in {label for label, _ in places}:
            chosen = [k for k, (name, _) in enumerate(places) if name == label]
            rows = np.array([places[k][1] for k in chosen])
            with np.errstate(all="ignore"):
                there = self._in(label, aim.label, rows)
                gaps = self._wrapped(aim.label, there[:, None, :] - aim.names)
                distances = lengths_of(np.einsum("kij,mkj->mki", aim.frames, gaps))
            sizes[chosen] = distances.min(axis=1)
        return sizes

    def slopes(self, shot: Shot, aim: Aim) -> np.ndarray:
        """d gap / d v by central differences."""
        h = self.difference(shot.vector, aim)
        frame, columns = aim.frames[shot.name, : len(shot.vector)], []
        for side in h * np.eye(len(shot.vector)):
            ahead, behind = (self.end(shot.vector + x) for x in (side, -side))
            ahead, behind = (self._in(label, aim.label, place) for label, place in (ahead, behind))
            difference = self._wrapped(aim.label, ahead - behind)
            columns.append(frame @ difference / (2 * h))
        return np.array(columns).T

    def difference(self, vector: np.ndarray, aim: Aim) -> float:
        """The step at which errors of ends and third derivatives balance in differences."""
        length = float(lengths_of(vector))
        noise = self.tolerance + aim.rounding / length * max(1.0, self.tolerance / ROUNDING)
        return length * min(1.0, noise) ** (1 / 3)

    # -- points ----------------------------------------------------------------------------------

    def aim(self, place: np.ndarray) -> Aim:
        """A point of the home chart as a target."""
        problem, n = self.problem, self.problem.frame.dimension
        still = MovingPoint(place.tolist(), [0.0] * n, [])
        label = problem.atlas.best_chart(
            problem.charts, self.home, still, problem.parameters, 53, starting=True
        )
        label = label or self.home
        return self.aim_in(label, self._in(self.home, label, place))

    def aim_in(self, label: str, there: np.ndarray) -> Aim:
        """A point of a chart as a target."""
        names = np.array([there])
        if opposite := self.problem.atlas.chart(label).antipodal:
            names = np.array([there, there])
            names[1, list(opposite)] *= -1
        frames = np.array([self._frame_at(label, name) for name in names])
        rounding = ROUNDING * float(lengths_of(np.abs(frames[0]) @ np.abs(names[0])))
        if not math.isfinite(rounding):
            raise ChartEdgeError("the frame has no value at the target")
        return Aim(label, names, frames, rounding)

    def _frame_at(self, label: str, place: np.ndarray) -> np.ndarray:
        """The matrix from coordinate differences to weighted components in the home frame."""
        atlas = self.problem.atlas
        own = self.frame_of_chart(label, place)
        if self.problem.atlas.chart(label).frame is None:
            # Opposite points of a sphere differ by a normal.
            tangent = np.linalg.pinv(own) @ own
            normal = np.linalg.norm(own, 2) * (np.eye(len(tangent)) - tangent)
            return np.concatenate((own, normal))
        if label == self.home or atlas.same_frame(label, self.home):
            return own
        # Between orthonormal frames of one metric lengths agree; the home frame gives components.
        columns = []
        for unit in np.eye(len(own)):
            point = MovingPoint(place.tolist(), unit.tolist(), [])
            moved = atlas.moved(label, self.home, point, self.problem.parameters, 53)
            columns.append([float(x) for x in moved.velocities])
        if not np.isfinite(columns).all():
            # The home frame is singular there: the components are those in the frame of the chart.
            return own
        chart = atlas.chart(label)
        assert chart.frame is not None
        unweighted = np.linalg.solve(weights_of(chart.frame), own)
        return self.weights @ np.array(columns).T @ unweighted

    def frame_of_chart(self, label: str, place: np.ndarray) -> np.ndarray:
        """The matrix from coordinate differences to weighted components in the chart's frame."""
        chart = self.problem.atlas.chart(label)
        point = dict(zip(chart.names, place.tolist(), strict=True)) | self.numbers
        with np.errstate(all="ignore"):
            if chart.frame is None:
                return self.weights @ np.linalg.pinv(chart.frame_vectors.at(point))
            own = self.problem.frame if label == self.home else chart.frame
            return weights_of(own) @ chart.coframe.at(point)

    def _in(self, source: str, target: str, places: np.ndarray) -> np.ndarray:
        """Coordinates of one point, or one row for each of many, in another chart."""
        columns = places.T
        for change in self.problem.atlas.route(source, target):
            columns = change(columns, self.problem.parameters)
        return np.asarray(columns, dtype=float).T

    def _wrapped(self, label: str, differences: np.ndarray) -> np.ndarray:
        """Coordinate differences, whole turns of angles taken out."""
        turning = self._turning[label]
        if turning:
            differences = differences.copy()
            differences[..., turning] -= TURN * np.round(differences[..., turning] / TURN)
        return differences

    # -- lines -----------------------------------------------------------------------------------

    def line(self, end: np.ndarray) -> Line:
        """The straight line in coordinates to a point of the home chart."""
        ahead, behind = _shares(NODES)
        points = np.outer(ahead, self.start) + np.outer(behind, end)
        rows = self._rows(points, np.broadcast_to(end - self.start, points.shape))
        speeds = lengths_of(rows) * np.pi * np.cosh(NODES) * ahead * behind
        steps = (speeds[1:] + speeds[:-1]) / 2 * np.diff(NODES)
        return Line(self.start, end, np.concatenate(([0.0], np.cumsum(steps))))

    def step(self, place: np.ndarray, difference: np.ndarray) -> np.ndarray:
        """Weighted frame components of a coordinate difference at a position in the home chart."""
        return self._rows(place[None, :], difference[None, :])[0]

    def _rows(self, points: np.ndarray, differences: np.ndarray) -> np.ndarray:
        chart = self.problem.atlas.chart(self.home)
        place = dict(zip(chart.names, np.ascontiguousarray(points.T), strict=True))
        with np.errstate(all="ignore"):
            return (self.weights @ chart.coframe.applied(place | self.numbers, differences.T)).T

    @cached_property
    def is_constant(self) -> bool:
        """Whether the coframe is the same at all points, so that the space is flat."""
        entries = self.problem.frame.coframe.components.nonzero.values()
        coordinates = set(self.problem.frame.coordinates)
        return not any(entry.symbols & coordinates for entry in entries)

    def lines(self, end: np.ndarray) -> tuple[list[Line], bool]:
        """The shortest lines to images of a point under full turns, in order of their length.

        There is one more than dimensions, because as many lines may be equally long. Also whether
        no motion to any other image is shorter: where the coframe is constant.
        """
        turning, count = self._turning[self.home], len(end) + 1
        turns = np.array(list(product((0.0, 1.0, -1.0), repeat=len(turning))))
        turns = turns.reshape(3 ** len(turning), len(turning))
        centre = end.copy()
        centre[turning] -= TURN * np.round((end - self.start)[turning] / TURN)
        while True:
            # Where coordinates are oblique, images by another turn may be nearer.
            lines = [self.line(_turned(centre, turning, turn)) for turn in turns]
            lines.sort(key=lambda line: line.length)
            if not lines[0].length < self.line(centre).length:
                break
            centre = lines[0].end
        if not self.is_constant or not turning:
            return lines[:count], self.is_constant
        matrix = self.frame_of_chart(self.home, self.start)
        # |dq_k| is at most the length times the size of dq_k in the frame.
        bounds = lines[0].length * np.linalg.norm(np.linalg.inv(matrix)[turning], axis=1)
        bounds, offset = bounds * (1 + ROUNDING), (centre - self.start)[turning]
        ranges = [
            np.arange(np.ceil((-bound - x) / TURN), np.floor((bound - x) / TURN) + 1)
            for bound, x in zip(bounds, offset, strict=True)
        ]
        number = math.prod(map(len, ranges))
        remedy = "Give coordinates whose axes are less oblique, or a nearer end."
        check_room(number * len(end), f"{number:,} images of the end under full turns", remedy)
        every = np.stack(np.meshgrid(*ranges, indexing="ij"), axis=-1).reshape(number, len(turning))
        images = np.tile(centre, (number, 1))
        images[:, turning] += TURN * every
        sizes = lengths_of((images - self.start) @ matrix.T)
        chosen = [self.line(images[k]) for k in np.argsort(sizes, kind="stable")[:count]]
        return chosen or lines[:count], True

    # -- conjugate points ------------------------------------------------------------------------

    def spreads(self, vector: np.ndarray, parts: np.ndarray, aim: Aim) -> tuple[np.ndarray, bool]:
        """Smallest singular value of d q(t) / (t d v) at parts of the motion, in the frame.

        It is 1 at the start, and 0 where neighbouring motions meet: at a conjugate point. Empty
        where rounding errors of coordinates hide the separation of two parts. Also whether motions
        meet between the last two parts: there a direction of the slopes is reversed.
        """
        h = self.difference(vector, aim)
        if h > parts[0] * float(lengths_of(vector)):
            return np.array([]), False
        middle = self.places(vector, parts)
        columns = []
        for side in h * np.eye(len(vector)):
            both = [self.places(vector + x, parts) for x in (side, -side)]
            differences = []
            for (label, _), plus, minus in zip(middle, *both, strict=False):
                ahead, behind = (self._in(source, label, place) for source, place in (plus, minus))
                differences.append(self._wrapped(label, ahead - behind))
            columns.append(differences)
        count = min(map(len, columns), default=0)
        spreads, matrices = [], []
        for k in range(count):
            label, place = middle[k]
            matrix = np.array([column[k] for column in columns]).T
            slopes = self.frame_of_chart(label, place) @ matrix / (2 * h * parts[k])
            if not np.isfinite(slopes).all():
                break
            matrices.append(slopes)
            spreads.append(float(np.linalg.svd(slopes, compute_uv=False)[-1]))
        if len(spreads) < len(parts) or middle[-1][0] != middle[-2][0]:
            return np.array(spreads), False
        change = np.linalg.eigvals(matrices[-1] @ np.linalg.inv(matrices[-2]))
        return np.array(spreads), bool(change.real.min() < 0)


def _turned(place: np.ndarray, turning: Sequence[int], turns: np.ndarray) -> np.ndarray:
    """A position after whole turns of its periodic coordinates."""
    turned = place.copy()
    turned[list(turning)] += TURN * turns
    return turned

"""Camera: light traced back from a camera that a tetrad carries, up to where it ends."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
import sympy as sp

from geomtorsion.codegen import graph
from geomtorsion.curves.constructors import autoparallel, geodesic
from geomtorsion.curves.equations import velocity_names
from geomtorsion.curves.problem import CurveProblem
from geomtorsion.curves.shadow_image import Fate, ShadowEdge, ShadowImage
from geomtorsion.errors import AccuracyError, MetricError, ShapeError, StartError
from geomtorsion.geometry import Frame
from geomtorsion.geometry.connections import as_connection
from geomtorsion.ode.engines import Engine
from geomtorsion.ode.ensemble import Ensemble, solve_many
from geomtorsion.ode.error_estimate import AIM
from geomtorsion.support import checks
from geomtorsion.support.copies import only_fields
from geomtorsion.support.executors import Executor
from geomtorsion.support.hints import argument_hints

# A ray that has come this much nearer to an edge of the domain than the camera is captured. Light
# that comes so near does not return; nearer to it, frame velocities only grow.
NEARER = 1e-9
# A ray has escaped at this multiple of the distance of the camera from the edge.
FARTHER = 4
# Length of rays in units of the distance of the camera: many turns.
LENGTHS = 64
# Angles from the axis of the camera among which the edge is found before it is bisected.
SCANNED = 24
# The field of view where none is given, in units of the largest angle of the edge.
WIDER = 1.5
# Accuracy of rays that only show where they end.
RAYS = 1e-3


@dataclass(frozen=True, eq=False)
class Shadow:
    """Rays of light that reach a camera, followed back; made by `shadow`.

    rays: the equations of the rays, with the camera as start.
    axis, up, right: directions of the camera in the spatial legs, unit vectors, shape (3,).
    time: which leg is timelike.
    dark: the conditions at which a ray is captured, as text; all others lead to the sky.
    length: largest curve parameter of a ray; the camera measures the frequency 1.
    engine, executor: as in `solve_many`.
    """

    rays: CurveProblem
    axis: np.ndarray
    up: np.ndarray
    right: np.ndarray
    time: int
    dark: tuple[str, ...]
    length: float
    engine: Engine | None = None
    executor: Executor | None = None

    def __getstate__(self) -> dict[str, object]:
        return only_fields(self)

    def directions(self, x: np.ndarray, y: np.ndarray) -> np.ndarray:
        """Unit vectors in the spatial legs at points of the image plane, shape (..., 3).

        x, y: to the right and upwards, tangents of angles from the axis.
        """
        x, y = (np.asarray(v, dtype=float)[..., None] for v in (x, y))
        lines = self.axis + x * self.right + y * self.up
        return lines / np.linalg.norm(lines, axis=-1, keepdims=True)

    def edge(self, angles: int | Sequence[float] | np.ndarray = 36, accuracy: float = 1e-7
             ) -> ShadowEdge:  # fmt: skip
        """The edge of the shadow around the axis of the camera, by bisection.

        Parameters
        ----------
        angles
            directions in the image in radians from the right upwards, shape (m,), or their number.
        accuracy
            largest half width of the bracket of the edge, in radians. A direction in which a ray
            meets an axis of the coordinates is turned by this angle, and its error is twice as
            large.

        Raises
        ------
        StartError
            the ray along the axis is not captured, or no ray escapes.

        Examples
        --------
        >>> hole = shadow("schwarzschild", [0, 10, 1.5, 0], parameters={"M": 1})
        >>> edge = hole.edge([0.0, 1.0], accuracy=1e-5)
        >>> (np.sin(edge.radii) * 10 / np.sqrt(0.8) / np.sqrt(27)).round(4).tolist()
        [1.0, 1.0]
        """
        number = checks.whole(angles)
        turns = np.arange(number or 0) * (2 * np.pi / max(number or 1, 1))
        if number is None:
            turns = checks.array(angles, "angles", ShapeError, shape=(None,))
        if not len(turns):
            raise ShapeError(
                f"angles: expected at least one direction, got {checks.shown(angles)}."
            )
        accuracy = checks.positive(accuracy, "accuracy", StartError)
        scan = np.pi * np.arange(SCANNED) / SCANNED
        moved = np.zeros(len(turns), dtype=bool)
        first, beside = self._beside(turns[:, None], scan, accuracy)
        moved |= beside.any(axis=1)
        if not (first[:, 0] == Fate.dark).all():
            raise StartError(
                "expected a camera whose axis points into the shadow, got a ray along it that is "
                "not captured. Give another axis, or the conditions `dark` at which rays end."
            )
        if not (first == Fate.sky).any(axis=1).all():
            raise StartError(
                "expected rays that escape in each direction, got none. Give the condition `sky`, "
                "or a greater `length`."
            )
        place = (first != Fate.dark).argmax(axis=1)
        low, high = scan[place - 1], scan[(first == Fate.sky).argmax(axis=1)]
        open_ = np.ones(len(turns), dtype=bool)
        while (open_ & (high - low > 2 * accuracy)).any():
            some = np.flatnonzero(open_ & (high - low > 2 * accuracy))
            middle = (low[some] + high[some]) / 2
            fate, beside = self._beside(turns[some], middle, accuracy)
            moved[some] |= beside
            low[some] = np.where(fate == Fate.dark, middle, low[some])
            high[some] = np.where(fate == Fate.sky, middle, high[some])
            # The end of this ray depends on its error: the bracket is as narrow as it gets.
            open_[some] = fate != Fate.undecided
        return ShadowEdge(turns, (low + high) / 2, (high - low) / 2 + accuracy * moved)

    def image(
        self, pixels: int = 64, field: float | None = None, accuracy: float = 1e-6,
        progress: bool | None = None,
    ) -> ShadowImage:  # fmt: skip
        """An image of pixels x pixels rays, with the end of each.

        Parameters
        ----------
        pixels
            rays along each side.
        field
            width of the image as an angle, in radians below pi; None: 1.5 times the width of the
            edge.
        accuracy
            of each ray, as in `solve_many`.

        Raises
        ------
        StartError
            `field` is not an angle between 0 and pi, or is missing where no edge is found.

        Examples
        --------
        >>> hole = shadow("schwarzschild", [0, 10, 1.5, 0], parameters={"M": 1})
        >>> image = hole.image(4, field=1.5)
        >>> image.dark.astype(int).tolist()
        [[0, 0, 0, 0], [0, 1, 1, 0], [0, 1, 1, 0], [0, 0, 0, 0]]
        """
        count = checks.count(pixels, "pixels", StartError, 1)
        if field is None:
            field = min(2 * WIDER * float(self.edge(8, 1e-3).radii.max()), 0.9 * math.pi)
        width = checks.positive(field, "field", StartError)
        if not width < math.pi:
            raise StartError(f"field: expected an angle below pi, got {width:.6g}.")
        side = math.tan(width / 2) * ((2 * np.arange(count) + 1) / count - 1)
        x, y = np.meshgrid(side, -side)
        rays = self._traced(self.directions(x, y).reshape(-1, 3), accuracy, progress)
        shape = count, count
        parts = [part.reshape(*shape, *part.shape[1:]) for part in rays]
        return ShadowImage(self.rays, self.time, width, accuracy, *parts)

    def _beside(
        self, angles: np.ndarray, chi: np.ndarray, turn: float
    ) -> tuple[np.ndarray, np.ndarray]:
        """Fates, and which rays were turned a little because they have no end where they are."""
        angles, chi = np.broadcast_arrays(angles, chi)
        fate = self._fates(angles, chi)
        lost = fate == Fate.undecided
        if lost.any():
            # So near to an axis only a more accurate ray passes it on the right side.
            fate[lost] = self._fates(angles[lost] + turn, chi[lost], AIM**2 * turn)
        return fate, lost & (fate != Fate.undecided)

    def _fates(self, angles: np.ndarray, chi: np.ndarray, accuracy: float = RAYS) -> np.ndarray:
        """Whether rays at angles chi from the axis end in the dark, the sky, or neither."""
        angles, chi = np.broadcast_arrays(angles, chi)
        round_ = np.cos(angles)[..., None] * self.right + np.sin(angles)[..., None] * self.up
        lines = np.cos(chi)[..., None] * self.axis + np.sin(chi)[..., None] * round_
        fate, *_ = self._traced(lines.reshape(-1, 3), accuracy, False)
        return fate.reshape(chi.shape)

    def _traced(
        self, lines: np.ndarray, accuracy: float, progress: bool | None
    ) -> tuple[np.ndarray, ...]:
        """Fate, condition, coordinates, frame velocity and error of rays in some directions."""
        number, n = len(lines), self.rays.frame.dimension
        speeds = np.insert(lines, self.time, -1.0, axis=1)
        fate, errors = np.full(number, Fate.undecided), np.full(number, np.nan)
        stopped_by = np.full(number, "", dtype=object)
        q, u = np.full((2, number, n), np.nan)
        # Most rays stay in the chart of the camera; the others are followed through all charts.
        home = self.rays.with_charts(self.rays.atlas.home)
        for problem in (home, self.rays):
            left = np.flatnonzero(fate == Fate.undecided)
            if not len(left) or (problem is self.rays and len(problem.charts) == 1):
                break
            many = self._solved(problem, speeds[left], accuracy, progress)
            if many is None:
                continue
            done = many.finished & (many.stopped_by != "")
            place, end = left[done], many.end
            is_dark = np.isin(many.stopped_by[done], self.dark)
            fate[place] = np.where(is_dark, Fate.dark, Fate.sky)
            stopped_by[place], errors[place] = many.stopped_by[done], many.errors[done]
            q[place], u[place] = end.coordinates[done], end.frame_velocity[done]
        return fate, stopped_by.astype(str), q, u, errors

    def _solved(
        self, problem: CurveProblem, speeds: np.ndarray, accuracy: float, progress: bool | None
    ) -> Ensemble | None:
        """The rays that come to an end; None where no ray does."""
        try:
            return solve_many(
                problem, None, self.length, accuracy, self.engine, frame_velocities=speeds,
                progress=progress, executor=self.executor,
            )  # fmt: skip
        except AccuracyError as error:
            return getattr(error, "ensemble", None)
        except StartError:
            # The start was checked before: no ray has reached an end.
            return None

    def __repr__(self) -> str:
        where = ", ".join(
            f"{name} = {float(x):.6g}"
            for name, x in zip(self.rays.coordinates, self.rays.start or (), strict=True)
        )
        return (
            f"shadow on {self.rays.frame.name or 'a frame'}: camera at {where}, rays by "
            f"{self.rays.name}, dark at {', '.join(self.dark)}"
        )


@argument_hints()
def shadow(
    space: Any,
    camera: Any,
    *,
    parameters: Any = None,
    axis: Any = None,
    up: Any = None,
    dark: Any = None,
    sky: Any = None,
    light: str = "geodesic",
    length: float | None = None,
    engine: Engine | None = None,
    executor: Executor | None = None,
) -> Shadow:
    """Shadow of a black hole, or of any region that captures light, in an orthonormal tetrad.

    The legs of the tetrad carry the camera: a direction n in the spatial legs is a pixel, and its
    ray is followed back with the frame velocity u = (-1, n) until it is captured or escapes.

    Equation
    --------
    u'^k = -omega_ij^k u^i u^j, eta_ij u^i u^j = 0

    Parameters
    ----------
    space
        a frame with one timelike and three spatial legs, a space or the name of a shipped one; a
        connection for light along its autoparallels.
    camera
        q^mu, shape (4,), or {"t": 0, "r": 30, ...}.
    parameters
        values of the parameters of the frame, by name.
    axis, up
        directions in the spatial legs, shape (3,); None: towards the first edge of the domain, and
        against the first leg that is not along the axis (north, for the legs r, theta, phi).
    dark, sky
        expressions (or lists of these) over coordinates, frame velocities and parameters: a ray is
        captured or escapes where one falls through zero. None: a ray is captured where it comes to
        a billionth of the camera's distance from an edge of the domain (bounds of angles do
        not count), and escapes at four times its distance.
    light
        "geodesic" of the metric or "autoparallel" of the connection.
    length
        largest curve parameter of a ray; None: 64 times the distance of the camera from `dark`, as
        the gradient of that condition measures it.
    engine, executor
        as in `solve_many`; the result has the same bits for any number of workers.

    Raises
    ------
    MetricError
        the frame is not orthonormal with one timelike and three spatial legs.
    StartError
        the camera is not in the domain, or there is no edge of the domain and no `dark`, `sky`.
    ShapeError
        a direction does not have three components, or vanishes.

    Examples
    --------
    >>> hole = shadow("kerr", [0, 20, 1.5, 0], parameters={"M": 1, "a": 0.9})
    >>> edge = hole.edge([0.0, np.pi], accuracy=1e-4)
    >>> bool(edge.radii[0] > edge.radii[1]), edge.error <= 1e-4
    (True, True)
    """
    checks.choice(light, ("geodesic", "autoparallel"), "light", StartError)
    frame = space if isinstance(space, Frame) else as_connection(space).frame
    time, spatial = _legs(frame)
    make: Callable[..., CurveProblem] = geodesic if light == "geodesic" else autoparallel
    forward = np.insert(np.array([1.0, 0.0, 0.0]), time, -1.0).tolist()
    options: dict[str, Any] = {"frame_velocity": forward, "parameters": parameters}
    plain = make(space, camera, **options)
    plain.check_parameters(plain.atlas.home)
    captured, escaped = _conditions(plain, dark, sky)
    rays = make(space, camera, **options, stop=[*captured, *escaped])
    # A condition with a kink is two stops.
    texts = make(space, camera, **options, stop=captured).stop_texts
    slope, far = _slope(rays, len(texts), spatial)
    if not far > 0 and (axis is None or length is None):
        raise StartError(
            "dark: expected a condition that changes with the position of the camera, got "
            f"{', '.join(texts)}. Give axis and length."
        )
    lines = _directions(axis, up, slope)
    far = far if length is None else checks.positive(length, "length", StartError)
    return Shadow(rays, *lines, time, texts, far, engine, executor)


def _legs(frame: Frame) -> tuple[int, list[int]]:
    """The timelike leg and the three others of an orthonormal tetrad."""
    eta = np.real(frame.eta.at({}))
    squares = np.diagonal(eta)
    plain = np.array_equal(eta, np.diag(squares)) and (np.abs(squares) == 1).all()
    times = [k for k, x in enumerate(squares) if (squares == x).sum() == 1]
    if not plain or len(squares) != 4 or len(times) != 1:
        raise MetricError(
            "expected an orthonormal tetrad with one timelike and three spatial legs, got eta = "
            f"{eta.tolist()}. Give another frame."
        )
    return times[0], [k for k in range(4) if k != times[0]]


def _conditions(problem: CurveProblem, dark: Any, sky: Any) -> tuple[list[Any], list[Any]]:
    """Conditions at which rays are captured and escape, from the domain where none are given."""
    captured, escaped = ([] if x is None else checks.entries(x, "stop", StartError)
                         if isinstance(x, list | tuple) else [x] for x in (dark, sky))  # fmt: skip
    if dark is not None and sky is not None:
        return list(captured), list(escaped)
    point = problem.floats()
    edges = _open_edges(problem.frame)
    if not edges:
        raise StartError(
            "expected conditions at which rays end, got none, and the domain of the frame has no "
            'edge that is a horizon. Give dark="r - 2.001*M" and sky="50 - r", for example.'
        )
    values = [_value(term, point) for term in edges]
    own = [f"{term} - {NEARER * size:.2g}" for term, size in zip(edges, values, strict=True)]
    far = [f"{FARTHER * values[0]:.2g} - ({edges[0]})"]
    return list(captured) or own, list(escaped) or far


def _open_edges(frame: Frame) -> list[sp.Expr]:
    """Edges of the domain that belong to coordinates with a bound on one side only."""
    terms = [
        relation.gts - relation.lts
        for relation in frame.domain
        if isinstance(relation, sp.Rel) and sp.oo not in (relation.gts, -relation.lts)
    ]
    slopes = {(x, term.diff(x)) for term in terms for x in frame.coordinates}
    between = {x for x in frame.coordinates if {(x, sp.S.One), (x, sp.S.NegativeOne)} <= slopes}
    inside = set(frame.coordinates)
    return [x for x in terms if x.free_symbols & inside and not x.free_symbols & between]


def _value(term: sp.Expr, point: Mapping[str, float]) -> float:
    """A term at a point."""
    names = sorted(symbol.name for symbol in term.free_symbols)
    return float(graph(names, [term], factor=False).numpy()(*(point[x] for x in names))[0])


def _slope(problem: CurveProblem, count: int, spatial: list[int]) -> tuple[np.ndarray, float]:
    """Direction along which the first condition falls, and the length to follow rays."""
    speeds = zip(velocity_names(problem.frame), problem.frame_velocity, strict=True)
    point = problem.floats() | {name: float(u) for name, u in speeds}
    units = (np.eye(4)[k].tolist() for k in spatial)
    legs = np.array([problem.with_start(frame_velocity=unit).velocity for unit in units])
    slopes, lengths = [], []
    for stop in problem.stops[:count]:
        own = {symbol.name: symbol for symbol in stop.term.free_symbols}
        rates = [
            _value(stop.term.diff(own[name]), point) if name in own else 0.0
            for name in problem.coordinates
        ]
        along = legs @ np.array(rates)
        size = float(np.linalg.norm(along))
        slopes.append(-along)
        lengths.append(LENGTHS * _value(stop.term, point) / size if size else 0.0)
    longest = int(np.argmax(lengths))
    return slopes[longest], lengths[longest]


def _directions(axis: Any, up: Any, slope: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Orthonormal axis, up and right of a camera."""
    ahead = _unit(slope if axis is None else axis, "axis")
    if up is None:
        place = int(np.flatnonzero(np.abs(ahead) < 0.9)[0])
        up = -np.eye(3)[place]
    above = _unit(up, "up")
    above = _unit(above - (above @ ahead) * ahead, "up")
    return ahead, above, np.cross(ahead, above)


def _unit(vector: Any, what: str) -> np.ndarray:
    """A direction of length one."""
    line = np.array(checks.array(vector, what, ShapeError, shape=(3,)), dtype=float)
    size = float(np.linalg.norm(line))
    if not size > 0:
        raise ShapeError(
            f"{what}: expected a direction across the axis, got {checks.shown(vector)}."
        )
    return line / size

"""Covering: charts of a space that hold where the frame of a connection is singular."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from geomtorsion.curves.atlas import Atlas, MovingPoint, atlas_of
from geomtorsion.curves.constructors import autoparallel
from geomtorsion.curves.problem import CurveProblem, checked_start
from geomtorsion.errors import StartError
from geomtorsion.geometry import Connection, Frame, levi_civita
from geomtorsion.ode.numbers import Numbers, Real, floats
from geomtorsion.support import checks
from geomtorsion.support.precision import HALF


@dataclass(frozen=True, eq=False)
class Ends:
    """Start and end of a motion, each in a chart that holds there.

    problem: the motion at rest, whose home chart holds at the start.
    target: the end in the coordinates of that chart, shape (n,).
    label, place: chart and coordinates of the end where that chart does not hold; else None.
    own: name and coordinates of the start in the chart in whose frame velocities are given, where
        that is another one; else None.
    """

    problem: CurveProblem
    target: np.ndarray
    label: str | None = None
    place: np.ndarray | None = None
    own: tuple[str, np.ndarray] | None = None

    @property
    def chart(self) -> str:
        """Name of the chart in whose frame velocities are given."""
        return self.problem.atlas.home if self.own is None else self.own[0]

    def given(self, vector: np.ndarray) -> np.ndarray:
        """A velocity of the problem at the start in that frame."""
        home = self.problem.atlas.home
        start = np.array(floats(self.problem.start or ()))
        return vector if self.own is None else self._turned(home, self.own[0], start, vector)

    def followed(self, vector: np.ndarray) -> np.ndarray:
        """A velocity in that frame as one of the problem."""
        home = self.problem.atlas.home
        return vector if self.own is None else self._turned(self.own[0], home, self.own[1], vector)

    def _turned(
        self, source: str, target: str, place: np.ndarray, vector: np.ndarray
    ) -> np.ndarray:
        point = MovingPoint(place.tolist(), vector.tolist(), [])
        moved = self.problem.atlas.moved(source, target, point, self.problem.parameters, 53)
        return np.array(floats(moved.velocities))


def ends_of(
    connection: Connection, start: Numbers, end: Numbers, parameters: Mapping[Any, Any] | None
) -> Ends:
    """The ends in the frame of the connection, or in other charts where that is singular.

    Raises
    ------
    StartError
        An end is not regular, and the space has no other chart there, or the connection depends on
        the frame itself.
    """
    frame = connection.frame
    named = checks.by_name(parameters, "parameters", StartError)
    is_free = connection.is_torsion_free and connection.metric_compatible
    at_rest = [0] * frame.dimension
    try:
        problem = autoparallel(connection, start, frame_velocity=at_rest, parameters=parameters)
        target = checked_start(frame, end, problem.parameters)
    except StartError:
        ends = _elsewhere(frame, start, end, named) if is_free else None
        if ends is None:
            raise
        return ends
    here = Ends(problem, np.array(floats(target)))
    # Where the solver leaves a chart, as within rounding of a pole, its frame is of little use.
    whole, numbers = before_substitution(frame, named)
    atlas, values = atlas_of(whole), _floats(numbers)
    chart = atlas.chart(atlas.home)
    places = (floats(problem.start or ()), here.target.tolist())
    near = [chart.distance(dict(zip(chart.names, x, strict=True)) | values) < 1 for x in places]
    return (any(near) and is_free and _elsewhere(frame, start, end, named)) or here


def _elsewhere(
    frame: Frame, start: Numbers, end: Numbers, parameters: Mapping[str, Real]
) -> Ends | None:
    """The ends in charts of the space; None where it has none there."""
    whole, numbers = before_substitution(frame, parameters)
    atlas, n = atlas_of(whole), frame.dimension
    values = _floats(numbers)
    names = [symbol.name for symbol in frame.coordinates]
    points = [
        np.array(floats(checks.numbers(row, n, f"{what} ({', '.join(names)})", StartError)))
        for row, what in ((start, "start"), (end, "end"))
    ]
    first, last = (_distances(atlas, point, values) for point in points)
    if not first or not last:
        return None
    both = {name: min(first[name], last[name]) for name in first if name in last}
    name = _best(atlas, both or first)
    home = atlas.chart(name)
    assert home.frame is not None
    moved = replace(atlas, home=name, origin=None) if name != atlas.home else atlas
    begin, target = (_moved(atlas, name, point, values) for point in points)
    problem = autoparallel(
        levi_civita(whole if name == atlas.home else home.frame), begin.tolist(),
        frame_velocity=[0] * n, parameters=numbers, atlas=moved,
    )  # fmt: skip
    # Nearer to its edge the home frame keeps less than half of the digits.
    is_regular = first.get(atlas.home, 0.0) > HALF
    own = (atlas.home, points[0]) if name != atlas.home and is_regular else None
    if both:
        return Ends(problem, target, own=own)
    label = _best(atlas, last)
    return Ends(problem, target, label, _moved(atlas, label, points[1], values), own)


def _distances(atlas: Atlas, point: np.ndarray, values: dict[str, float]) -> dict[str, float]:
    """Charts that hold at a point of the home chart, with its distance from their edges."""
    distances: dict[str, float] = {}
    for name in atlas.names:
        chart = atlas.chart(name)
        place = _moved(atlas, name, point, values)
        if chart.frame is None or not np.isfinite(place).all():
            continue
        at = dict(zip(chart.names, place.tolist(), strict=True)) | values
        if (
            not (chart.at_edges(at) <= 0).any()
            and np.isfinite(chart.frame_vectors.values(at)).all()
        ):
            distances[name] = chart.distance(at)
    return distances


def _best(atlas: Atlas, distances: Mapping[str, float]) -> str:
    """The home chart if it is far from its edge, else the chart that is furthest from its own."""
    if distances.get(atlas.home, 0.0) >= 1:
        return atlas.home
    return max(distances, key=lambda name: distances[name])


def _floats(parameters: Mapping[str, Real]) -> dict[str, float]:
    return {name: float(value) for name, value in parameters.items()}


def _moved(atlas: Atlas, label: str, point: np.ndarray, values: Mapping[str, float]) -> np.ndarray:
    """A point of the home chart in the coordinates of another."""
    for change in atlas.route(atlas.home, label):
        point = np.asarray(change(point.tolist(), values), dtype=float)
    return point


def before_substitution(
    frame: Frame, parameters: Mapping[str, Real]
) -> tuple[Frame, dict[str, Real]]:
    """The frame from which `Frame.subs` made this one, and values for all its parameters.

    Its atlas holds for both. A frame without such an origin is returned as it is.
    """
    numbers = dict(parameters)
    while "substituted" in frame.attached and len(atlas_of(frame).names) == 1:
        whole, table = frame.attached["substituted"]
        by_symbol = {s: numbers[s.name] for s in frame.parameters if s.name in numbers}
        numbers |= {s.name: value.subs(by_symbol) for s, value in table.items()}
        frame = whole
    own = {symbol.name for symbol in frame.parameters}
    return frame, {name: value for name, value in numbers.items() if name in own}

"""Readout: many starts as states, and coordinates, velocities and invariants off the states."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

import mpmath
import numpy as np

from geomtorsion.curves.atlas import MovingPoint
from geomtorsion.errors import ChartEdgeError, ShapeError, StartError
from geomtorsion.ode.engines import Taylor
from geomtorsion.ode.error_estimate import NOISE, alike
from geomtorsion.ode.members import Members, Rows
from geomtorsion.ode.moment import Moment
from geomtorsion.ode.numbers import Real, floats, multiplied, precision_of
from geomtorsion.ode.trajectory import Segment, Trajectory
from geomtorsion.support import checks
from geomtorsion.support.precision import EPS, working_precision

if TYPE_CHECKING:
    from geomtorsion.curves.problem import CurveProblem


def moment(
    problem: CurveProblem,
    times: np.ndarray,
    pieces: Sequence[tuple[Segment, np.ndarray]],
    shape: tuple[int, ...],
    bits: int,
) -> Moment:
    """Everything at the times of some pieces, in the home chart and frame."""
    parts = [_at_home(problem, segment, states, bits) for segment, states in pieces]
    q, v, u, w = (np.concatenate(values) for values in zip(*parts, strict=True))
    whole = {"coordinates": q, "velocity": v, "frame_velocity": u, "transported": w}
    values: dict[str, np.ndarray] = {}
    equations = problem.equations(problem.charts[0])
    for names, columns in (
        (problem.coordinates if q.shape[1] else (), q),
        (equations.velocities, u),
        (equations.carried, w),
    ):
        values |= {name: columns[:, k].reshape(shape) for k, name in enumerate(names)}
    values |= {name: x.reshape((*shape, x.shape[1])) for name, x in whole.items()}
    return Moment(times.reshape(shape), values, whole=tuple(whole))


def gaps(
    problem: CurveProblem, one: Trajectory, two: Trajectory, count: int, accuracy: float
) -> list[tuple[np.ndarray, float]]:
    """Differences at each sample, and size, of groups of coordinates and the velocities at home.

    States of the home chart are compared already: only q' is read off these. Nothing where the home
    chart does not reach, or where an edge is within the accuracy.
    """
    if problem.start is None or not count:
        return []
    try:
        here, there = [_read(problem, x, count, doubles=accuracy > NOISE * EPS) for x in (one, two)]
    except ChartEdgeError:
        return []
    (q, v, u), (q2, v2, u2) = here, there
    pairs = [(v, v2)]
    if set(one.labels) != {problem.atlas.home}:
        pairs += [(u, u2), *_coordinate_pairs(problem, q, q2)]
    inside = ~_at_edge(problem, q, accuracy)
    differences = []
    for a, b in pairs:
        gap, size = (np.abs(x).astype(float).max(axis=1) for x in (a - alike(a, b), a))
        differences.append((np.where(inside, gap, 0.0), float(size[inside].max(initial=0.0))))
    return differences


def _read(
    problem: CurveProblem, trajectory: Trajectory, count: int, *, doubles: bool
) -> list[np.ndarray]:
    """(q, q', u) at the first samples, in the home chart."""
    bits = 53 if doubles else trajectory.engine.precision
    parts = [
        _at_home(problem, x, x.states.astype(float) if doubles else x.states, bits)[:3]
        for x in trajectory.segments
        if x.count
    ]
    return [np.concatenate(values)[:count] for values in zip(*parts, strict=True)]


def _coordinate_pairs(
    problem: CurveProblem, one: np.ndarray, two: np.ndarray
) -> list[tuple[np.ndarray, np.ndarray]]:
    """Coordinates at home of the same places in two runs, by groups.

    Angles that another chart gives are turned to the nearest of the first run: where they are cut,
    half a turn from the start, either side is right.
    """
    atlas, two = problem.atlas, alike(one, two).copy()
    routes = [atlas.route(name, atlas.home) for name in problem.charts]
    for k in sorted({k for route in routes if route for k in route[-1].angles}):
        turns = np.round((two[..., k] - one[..., k]).astype(float) / (2 * np.pi))
        if np.any(turns):
            _turn_back(two, k, turns)
    groups = map(list, atlas.chart(atlas.home).groups)
    return [(one[..., group], two[..., group]) for group in groups]


def _at_edge(problem: CurveProblem, q: np.ndarray, accuracy: float) -> np.ndarray:
    """Whether places are as near to an edge of the home chart as the accuracy.

    Coordinates and frame vectors have no definite values there, such as the angle at the origin.
    q: shape (..., n). Distances are in coordinates, each in units of its largest value.
    """
    chart = problem.atlas.chart(problem.atlas.home)
    rows = np.asarray(q).reshape(-1, q.shape[-1]).astype(float)
    if not chart.edges:
        return np.zeros(q.shape[:-1], dtype=bool)
    numbers = {key: float(value) for key, value in problem.parameters.items()}
    place = dict(zip(chart.names, rows.T, strict=True)) | numbers
    with np.errstate(all="ignore"):
        sizes = np.broadcast_to(np.abs(rows).max(axis=0, initial=0.0), rows.shape)
        left, reach = chart.edge_distances(place, accuracy * sizes.T)
        near = ~(np.abs(left) > reach)
    return np.asarray(near.any(axis=0)).reshape(q.shape[:-1])


def places(
    problem: CurveProblem,
    times: np.ndarray,
    pieces: Sequence[tuple[Segment, np.ndarray]],
    shape: tuple[int, ...],
) -> Moment:
    """Coordinates in the home chart, as floats; not a number where it does not give one."""
    home, parts = problem.atlas.home, []
    for segment, states in pieces:
        width = problem.equations(segment.label).width
        q = np.asarray(states[:, :width]).astype(float)
        parts.append(
            _turned(problem, segment.label, home, _mapped(problem, segment.label, home, q))
        )
    q = np.concatenate(parts)
    names = problem.coordinates
    values = {name: q[:, k].reshape(shape) for k, name in enumerate(names)}
    return Moment(times.reshape(shape), values)


def _mapped(problem: CurveProblem, source: str, target: str, q: np.ndarray) -> np.ndarray:
    """Coordinates of many points in another chart."""
    there = q.T
    for change in problem.atlas.route(source, target):
        there = change(there, problem.parameters)
    return np.asarray(there).T


def _at_home(
    problem: CurveProblem, segment: Segment, states: np.ndarray, bits: int
) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray]:
    """(q, q', u, carried) of one segment in the home chart and frame."""
    equations, n = problem.equations(segment.label), problem.frame.dimension
    width, unit = equations.width, problem.time_unit
    u, carried = _velocities(problem, segment, states, bits)
    if equations.moves:
        carried = states[:, width + n :].copy()
    for k, power in enumerate(problem.carried.speed_powers if problem.carried else ()):
        if power:
            carried[:, [k]] = multiplied(carried[:, [k]], unit)
    if not width:
        empty = np.empty((len(states), 0))
        return empty, empty, u, carried
    target = problem.atlas.home
    q = states[:, :width]
    if segment.label != target:
        q, u = converted(problem, segment.label, target, q, u, bits)
    return q, coordinate_velocities(problem, q, u, bits), u, carried


def _velocities(
    problem: CurveProblem, segment: Segment, states: np.ndarray, bits: int = 53
) -> tuple[np.ndarray, np.ndarray]:
    """u^i of a segment in its own frame, and the states behind the coordinates."""
    equations, n = problem.equations(segment.label), problem.frame.dimension
    width, unit = equations.width, problem.time_unit
    if equations.moves:
        return multiplied(states[:, width : width + n], unit), states[:, width + n :]
    table = dict(zip(equations.parameters, segment.stage.parameters, strict=True))
    values = Taylor(bits).array([table[name] for name in equations.velocities])
    rows = np.array([values] * len(states), dtype=values.dtype)
    return multiplied(rows.reshape(len(states), n), unit), states[:, width:].copy()


def converted(
    problem: CurveProblem, source: str, target: str, q: np.ndarray, u: np.ndarray, bits: int = 53
) -> tuple[np.ndarray, np.ndarray]:
    """Coordinates and frame velocities of many points in another chart.

    Numbers have the type in which an engine of this precision calculates.
    """
    if bits == 53:
        q, u = np.asarray(q, dtype=float), np.asarray(u, dtype=float)
    if bits > 53 or not problem.atlas.same_frame(source, target):
        numbers = problem.parameters
        points = []
        for a, b in zip(q, u, strict=True):
            point = MovingPoint(list(a), list(b), [])
            try:
                points.append(problem.atlas.moved(source, target, point, numbers, bits))
            except ArithmeticError:
                raise _not_covered(a, source, target) from None
        there = _long_rows([point.coordinates for point in points], bits)
        turned = _long_rows([point.velocities for point in points], bits)
    else:
        there, turned = _mapped(problem, source, target, q), u
    finite = np.isfinite(there.astype(float))
    if not finite.all():
        bad = int(np.argmin(finite.all(axis=1)))
        raise _not_covered(q[bad], source, target)
    return _turned(problem, source, target, there), turned


def _not_covered(place: np.ndarray, source: str, target: str) -> ChartEdgeError:
    """The error for a place that a chart does not reach."""
    numbers = ", ".join(f"{float(x):.6g}" for x in place)
    return ChartEdgeError(
        f"the motion passes ({numbers}) in chart {source!r}, which chart {target!r} does not "
        f"reach. Use solution.in_chart({source!r})."
    )


def _turned(problem: CurveProblem, source: str, target: str, q: np.ndarray) -> np.ndarray:
    """Angles of the home chart shifted to within half a turn of the start."""
    route = problem.atlas.route(source, target)
    if target != problem.atlas.home or problem.start is None or not route:
        return q
    q = q.copy()
    for k in route[-1].angles:
        centre = float(problem.start[k])
        _turn_back(q, k, np.round((q[:, k].astype(float) - centre) / (2 * np.pi)))
    return q


def continued(problem: CurveProblem, chart: str, q: np.ndarray) -> np.ndarray:
    """Points of a curve, shape (m, n), with angles that pass a full turn without a jump."""
    atlas, q = problem.atlas, q.copy()
    routes = [atlas.route(name, chart) for name in atlas.makers]
    for k in sorted({k for route in routes if route for k in route[-1].angles}):
        angles = q[:, k].astype(float)
        _turn_back(q, k, np.round((angles - np.unwrap(angles)) / (2 * np.pi)))
    return q


def _turn_back(q: np.ndarray, k: int, turns: np.ndarray) -> None:
    """Subtract whole turns from column k of points, in their precision."""
    bits = precision_of(q)
    if bits == 53:
        q[..., k] -= 2 * np.pi * turns
        return
    with working_precision(2 * bits):
        shifts = [2 * mpmath.pi * int(turn) for turn in turns]
    q[..., k] -= Taylor(bits).array(shifts)


def _long_rows(rows: Sequence[Sequence[Real]], bits: int) -> np.ndarray:
    """Rows of numbers in the type in which an engine of this precision calculates."""
    return np.array([Taylor(bits).array(row) for row in rows])


def coordinate_velocities(
    problem: CurveProblem, q: np.ndarray, u: np.ndarray, bits: int = 53
) -> np.ndarray:
    """q'^mu = E_i^mu u^i at many points of the home chart."""
    chart = problem.atlas.chart(problem.atlas.home)
    if bits > 53:
        velocities = [
            chart.frame_vectors.precisely(
                dict(zip(chart.names, place, strict=True)) | dict(problem.parameters), speeds, bits
            )
            for place, speeds in zip(q, u, strict=True)
        ]
        return _long_rows(velocities, bits)
    place = dict(zip(chart.names, np.asarray(q, float).T, strict=True))
    numbers = {key: float(value) for key, value in problem.parameters.items()}
    return chart.frame_vectors.applied(place | numbers, np.asarray(u, float).T).T


def in_chart(problem: CurveProblem, trajectory: Trajectory, name: str) -> np.ndarray:
    """Coordinates of all samples in a chart."""
    segments = [segment for segment in trajectory.segments if segment.count]
    return np.concatenate([_placed(problem, one, one.states, name) for one in segments])


def at_times(
    problem: CurveProblem, trajectory: Trajectory, times: np.ndarray, name: str
) -> np.ndarray:
    """Coordinates at any times, in units of the problem, in a chart."""
    width = len(problem.atlas.chart(name).names)
    rows = np.empty((len(times), width))
    for segment, states, index in trajectory.at(times * problem.time_unit):
        rows[index] = _placed(problem, segment, states, name)
    return rows


def _placed(problem: CurveProblem, segment: Segment, states: np.ndarray, name: str) -> np.ndarray:
    """Coordinates of states of a segment in a chart."""
    q = states[:, : problem.equations(segment.label).width]
    if segment.label == name:
        return q
    u, _ = _velocities(problem, segment, states)
    return converted(problem, segment.label, name, q, u)[0]


def invariant_changes(problem: CurveProblem, trajectory: Trajectory) -> dict[str, np.ndarray]:
    """Relative change of each invariant at each sample, counted separately in each chart."""
    pieces: dict[str, list[np.ndarray]] = {}
    done = 0
    for segment in trajectory.segments:
        if not segment.count:
            continue
        for name, change in _changes_of_segment(problem, segment).items():
            before = pieces.setdefault(name, [])
            missing = done - sum(map(len, before))
            if missing:
                before.append(np.full(missing, np.nan))
            before.append(change)
        done += segment.count
    changes = {name: np.concatenate(parts) for name, parts in pieces.items()}
    return {
        name: np.pad(x, (0, done - len(x)), constant_values=np.nan) for name, x in changes.items()
    }


def _changes_of_segment(problem: CurveProblem, segment: Segment) -> dict[str, np.ndarray]:
    """Relative change of each invariant since a segment began."""
    equations = problem.equations(segment.label)
    states = np.asarray(segment.states).astype(float)
    states = np.concatenate((segment.stage.first[None, :], states))
    numbers = floats(segment.stage.parameters)
    sizes = dict(zip(equations.parameters, np.abs(numbers), strict=True))
    sizes |= dict(zip(equations.states, np.abs(states).max(axis=0), strict=True))
    if equations.moves:
        # All velocities have the size of the largest, so that a vanishing momentum has one.
        first, n = equations.width, len(equations.velocities)
        largest = float(np.abs(states[:, first : first + n]).max())
        sizes |= dict.fromkeys(equations.velocities, largest)
    changes = {}
    for name, products in equations.invariants.items():
        total, terms = equations.invariant_graphs[name]
        values = np.broadcast_to(total.numpy()(*states.T, *numbers)[0], len(states))
        weights = [np.prod([sizes[x] for x in factors]) for _, factors in products]
        parts = np.abs(terms.numpy()(*states.T, *numbers))
        size = float(np.max(sum(w * part for w, part in zip(weights, parts, strict=True))))
        change = np.abs(values - values[0])[1:]
        changes[name] = change / size if size else change
    return changes


def read_members(
    problem: CurveProblem, members: Members, rows: Rows, times: np.ndarray
) -> dict[str, np.ndarray]:
    """Coordinates and frame velocities of an ensemble, and each by its name."""
    equations, n = problem.equations(members.label), problem.frame.dimension
    width, number, m = equations.width, len(members), len(times)
    q, u = np.full((number, m, n if width else 0), np.nan), np.full((number, m, n), np.nan)
    done = rows.finished.copy()
    done[list(rows.trajectories)] = False
    states = rows.states[done, -m:]
    if equations.moves:
        u[done] = states[..., width : width + n] * members.units[done, None, None]
    else:
        u[done] = members.varied["own_velocity"][done, None, :]
    if width:
        there, turned = states[..., :width].reshape(-1, width), u[done].reshape(-1, n)
        home = problem.atlas.home
        if members.label != home:
            there, turned = converted(problem, members.label, home, there, turned)
        q[done], u[done] = there.reshape(-1, m, n), turned.reshape(-1, m, n)
    for k, trajectory in rows.trajectories.items():
        single = problem.member(members, k)
        pieces = [(x, x.states) for x in trajectory.segments if x.count]
        try:
            grid = np.concatenate([x.times for x, _ in pieces])
            motion = moment(single, grid, pieces, grid.shape, 53)
        except ChartEdgeError:
            continue
        q[k], u[k] = motion.coordinates[-m:], motion.frame_velocity[-m:]
    table = {"coordinates": q, "frame_velocity": u}
    if width:
        table |= {name: q[..., k] for k, name in enumerate(problem.coordinates)}
    return table | {name: u[..., k] for k, name in enumerate(equations.velocities)}


def member_gaps(
    problem: CurveProblem, members: Members, one: Rows, two: Rows, accuracy: float
) -> list[tuple[np.ndarray, np.ndarray]]:
    """Pairs of coordinates (by groups) and of velocities at home, each (number, m, n).

    Nothing where the members are at home: these are their states. Zeros at edges: see `gaps`.
    """
    home = problem.atlas.home
    if members.label in (home, ""):
        return []
    times = np.zeros(one.states.shape[1])
    try:
        here, there = (read_members(problem, members, rows, times) for rows in (one, two))
    except ChartEdgeError:
        return []
    q, q2 = here["coordinates"], there["coordinates"]
    pairs = [(here["frame_velocity"], there["frame_velocity"]), *_coordinate_pairs(problem, q, q2)]
    inside = ~np.array([_at_edge(problem, rows, accuracy) for rows in q])[..., None]
    return [(np.where(inside, a, 0.0), np.where(inside, b, 0.0)) for a, b in pairs]


def start_lists(
    problem: CurveProblem, starts: object, velocities: object, frame_velocities: object
) -> tuple[np.ndarray | None, np.ndarray]:
    """Coordinates (or None) and frame velocities, both with one row per motion."""
    n = problem.frame.dimension
    lists = {"starts": starts, "velocities": velocities, "frame_velocities": frame_velocities}
    if velocities is not None and frame_velocities is not None:
        raise StartError("expected velocities or frame_velocities, got both. Give one of them.")
    arrays = {key: _rows(value, n, key) for key, value in lists.items() if value is not None}
    if not arrays:
        raise StartError(
            "expected starts, velocities or frame_velocities, got none. Give one row per motion."
        )
    counts = {key: len(value) for key, value in arrays.items()}
    if len(set(counts.values())) > 1:
        raise ShapeError(f"expected lists of equal length, got {counts}. Give one row per motion.")
    number = next(iter(counts.values()))
    place = arrays.get("starts")
    if problem.start is None and place is not None:
        raise StartError(
            "starts: expected a problem with coordinates, got one with velocities only. Make it "
            "with a start."
        )
    if place is None and problem.start is not None:
        place = np.tile([float(x) for x in problem.start], (number, 1))
    if "velocities" not in arrays:
        own = np.tile([float(x) for x in problem.frame_velocity], (number, 1))
        return place, arrays.get("frame_velocities", own)
    if place is None:
        raise StartError(
            "velocities: expected a problem with coordinates, got one without. Give "
            "frame_velocities."
        )
    chart = problem.atlas.chart(problem.atlas.home)
    point = dict(zip(chart.names, place.T, strict=True))
    numbers = {key: float(value) for key, value in problem.parameters.items()}
    return place, chart.coframe.applied(point | numbers, arrays["velocities"].T).T


def _rows(values: object, n: int, what: str) -> np.ndarray:
    """An array of shape (number, n) of finite numbers."""
    array = checks.array(
        values,
        what,
        StartError,
        shape=(None, n),
        shape_error=ShapeError,
        message=f"{{subject}}: expected rows of {n} numbers.",
        shaped=f"{{subject}}: expected shape (number, {n}), got {{came}}.",
        infinite="{subject}{place} = {value} is not finite.",
    )
    if not len(array):
        raise ShapeError(f"{what}: expected shape (number, {n}), got {array.shape}.")
    return array


def laid_out(problem: CurveProblem, place: np.ndarray | None, velocities: np.ndarray) -> Members:
    """Members in the chart of preference, each with a time unit of its own."""
    if problem.carried is not None:
        raise StartError(
            "expected curves without vectors carried along, got curves with them. Solve such "
            "problems one by one."
        )
    if problem.stops:
        raise StartError(
            "expected curves without stop=..., because each such curve ends at its own time, got "
            f"stop = {', '.join(stop.text for stop in problem.stops)}. Solve them one by one, or "
            "omit it and use event_times."
        )
    sizes = np.abs(velocities).max(axis=1)
    units = np.where(sizes > 0, 2.0 ** np.round(np.log2(np.where(sizes > 0, sizes, 1))), 1.0)
    scaled = velocities / units[:, None]
    varied = {"frame_velocity": velocities}
    if place is not None:
        varied["start"] = place
    label = problem.charts[0] if place is not None else ""
    if place is not None and label != problem.atlas.home:
        place, scaled = converted(problem, problem.atlas.home, label, place, scaled)
    equations = problem.equations(label)
    varied["own_velocity"] = scaled * units[:, None]
    parts = [part for part in (place, scaled if equations.moves else None) if part is not None]
    number = len(scaled)
    values = equations.numbers(problem.parameters, list(scaled.T))
    columns = [np.broadcast_to(np.asarray(x, dtype=float), number) for x in values]
    parameters = np.array(columns).T if columns else np.zeros((number, 0))
    return Members(
        problem.system(label),
        equations.groups,
        np.concatenate(parts, axis=1),
        parameters,
        units,
        np.abs(velocities).sum(axis=1),
        label=label,
        varied=varied,
    )

"""Readout: many starts as states, and coordinates, velocities and invariants off the states."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING

import mpmath
import numpy as np

from geomtorsion.curves.atlas import MovingPoint, not_covered
from geomtorsion.curves.equations import velocity_names
from geomtorsion.curves.stops import check_stops
from geomtorsion.errors import ChartEdgeError, ShapeError, StartError
from geomtorsion.ode.engines import Taylor
from geomtorsion.ode.error_estimate import NOISE
from geomtorsion.ode.members import Members, Rows
from geomtorsion.ode.moment import Moment
from geomtorsion.ode.numbers import Real, alike, floats, multiplied, precision_of
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
    q, v, u, w = _at_home(problem, pieces, bits)
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
        (q, v, u), (q2, v2, u2) = _read(problem, one, two, count, doubles=accuracy > NOISE * EPS)
    except ChartEdgeError:
        return []
    pairs = [(v, v2)]
    if set(one.labels) != {problem.atlas.home}:
        q2 = _turned_alike(problem, q, q2)
        groups = map(list, problem.chart(problem.atlas.home).groups)
        pairs += [(u, u2), *((q[:, group], q2[:, group]) for group in groups)]
    first, second = (np.concatenate(columns, axis=1) for columns in zip(*pairs, strict=True))
    starts = np.cumsum([0, *(a.shape[1] for a, _ in pairs[:-1])])
    differences, sizes = (
        np.maximum.reduceat(np.abs(x).astype(float), starts, axis=1)
        for x in (first - alike(first, second), first)
    )
    inside = ~_at_edge(problem, q, accuracy)
    differences[~inside] = 0.0
    return list(zip(differences.T, sizes[inside].max(axis=0, initial=0.0).tolist(), strict=True))


def _read(
    problem: CurveProblem, one: Trajectory, two: Trajectory, count: int, *, doubles: bool
) -> list[tuple[np.ndarray, ...]]:
    """(q, q', u) of two trajectories at the first samples, in the home chart."""
    runs = []
    for trajectory in (one, two):
        pieces, left = [], count
        for segment in trajectory.segments:
            states = segment.states[:left]
            if len(states):
                pieces.append((segment, states.astype(float) if doubles else states))
            left -= len(states)
        runs.append(pieces)
    bits = [53, 53] if doubles else [x.engine.precision for x in (one, two)]
    if bits[0] != bits[1]:
        return [_at_home(problem, *run)[:3] for run in zip(runs, bits, strict=True)]
    both = _at_home(problem, runs[0] + runs[1], bits[0])[:3]
    return [tuple(x[:count] for x in both), tuple(x[count:] for x in both)]


def _turned_alike(problem: CurveProblem, one: np.ndarray, two: np.ndarray) -> np.ndarray:
    """Coordinates at home in a second run, angles turned to the nearest of the first run.

    Only angles that another chart gives: where they are cut, half a turn from the start, either
    side is right.
    """
    atlas, two = problem.atlas, alike(one, two).copy()
    angles = atlas.angles(problem.charts, atlas.home)
    gaps = (two[..., angles] - one[..., angles]).astype(float)
    return _turned_back(two, angles, gaps)


def _at_edge(problem: CurveProblem, q: np.ndarray, accuracy: float) -> np.ndarray:
    """Whether places are as near to an edge of the home chart as the accuracy.

    Coordinates and frame vectors have no definite values there, such as the angle at the origin.
    q: shape (..., n). Distances are in coordinates, each in units of its largest value.
    """
    chart = problem.chart(problem.atlas.home)
    rows = np.asarray(q).reshape(-1, q.shape[-1]).astype(float)
    if not chart.edges:
        return np.zeros(q.shape[:-1], dtype=bool)
    numbers = {key: float(value) for key, value in problem.parameters.items()}
    place = dict(zip(chart.names, rows.T, strict=True)) | numbers
    with np.errstate(all="ignore"):
        # After its stop a member has no numbers.
        sizes = np.nan_to_num(np.abs(rows)).max(axis=0, initial=0.0)
        left, reach = chart.edge_distances(place, accuracy * sizes)
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
    problem: CurveProblem, pieces: Sequence[tuple[Segment, np.ndarray]], bits: int
) -> tuple[np.ndarray, ...]:
    """(q, q', u, carried) of states of some segments in the home chart and frame, in order.

    All states of one chart are read at once.
    """
    labels = [segment.label for segment, _ in pieces]
    by_chart = [[k for k, x in enumerate(labels) if x == one] for one in dict.fromkeys(labels)]
    parts = [_chart_at_home(problem, [pieces[k] for k in some], bits) for some in by_chart]
    if len(parts) == 1:
        return parts[0]
    ends = np.cumsum([len(states) for _, states in pieces])
    places = np.split(np.arange(ends[-1]), ends[:-1])
    order = np.argsort(np.concatenate([places[k] for some in by_chart for k in some]))
    return tuple(np.concatenate(values)[order] for values in zip(*parts, strict=True))


def _chart_at_home(
    problem: CurveProblem, pieces: Sequence[tuple[Segment, np.ndarray]], bits: int
) -> tuple[np.ndarray, ...]:
    """As above, for segments in one chart."""
    label, home = pieces[0][0].label, problem.atlas.home
    unit = problem.time_unit
    q, u, carried = taken_apart(problem, pieces, bits)
    u = multiplied(u, unit)
    powers = problem.carried.speed_powers if problem.carried else ()
    if any(powers):
        carried = carried.copy()
    for k, power in enumerate(powers):
        if power:
            carried[:, [k]] = multiplied(carried[:, [k]], unit)
    if not q.shape[1]:
        empty = np.empty((len(u), 0))
        return empty, empty, u, carried
    if label != home:
        q, u = converted(problem, label, home, q, u, bits)
    return q, coordinate_velocities(problem, q, u, bits), u, carried


def taken_apart(
    problem: CurveProblem, pieces: Sequence[tuple[Segment, np.ndarray]], bits: int = 53
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Coordinates, u^i in units of the time and carried quantities of segments in one chart."""
    equations, n = problem.equations(pieces[0][0].label), problem.frame.dimension
    width = equations.width
    blocks = [states for _, states in pieces]
    states = blocks[0] if len(blocks) == 1 else np.concatenate(blocks)
    if equations.moves:
        carried = states[:, equations.plain_width :]
        return states[:, :width], states[:, width : width + n], carried
    numbers = Taylor(bits)
    places = [equations.parameters.index(name) for name in equations.velocities]
    own = [numbers.array([one.stage.parameters[k] for k in places]) for one, _ in pieces]
    table = own[0].reshape(1, n) if len(own) == 1 else np.array(own, dtype=own[0].dtype)
    segments = np.repeat(np.arange(len(pieces)), [len(block) for block in blocks])
    return states[:, :width], table[segments], states[:, width:]


def converted(
    problem: CurveProblem, source: str, target: str, q: np.ndarray, u: np.ndarray, bits: int = 53
) -> tuple[np.ndarray, np.ndarray]:
    """Coordinates and frame velocities of many points in another chart.

    Numbers have the type in which an engine of this precision calculates. Angles of the home chart
    are shifted to within half a turn of the start.
    """
    there, turned = mapped(problem, source, target, q, u, bits)
    return _turned(problem, source, target, there), turned


def mapped(
    problem: CurveProblem, source: str, target: str, q: np.ndarray, u: np.ndarray, bits: int = 53
) -> tuple[np.ndarray, np.ndarray]:
    """The same with angles as the maps give them."""
    atlas, numbers = problem.atlas, problem.parameters
    if bits == 53:
        many = atlas.moved(source, target, MovingPoint(q.T, u.T, []), numbers, bits)
        return np.asarray(many.coordinates).T, np.asarray(many.velocities).T
    points = []
    for a, b in zip(q, u, strict=True):
        try:
            point = MovingPoint(list(a), list(b), [])
            points.append(atlas.moved(source, target, point, numbers, bits))
        except ArithmeticError:
            raise not_covered(a, source, target) from None
    there = _long_rows([point.coordinates for point in points], bits)
    return there, _long_rows([point.velocities for point in points], bits)


def _turned(problem: CurveProblem, source: str, target: str, q: np.ndarray) -> np.ndarray:
    """Angles of the home chart shifted to within half a turn of the start."""
    route = problem.atlas.route(source, target)
    if target != problem.atlas.home or problem.start is None or not route:
        return q
    angles = list(route[-1].angles)
    centre = np.array([float(problem.start[k]) for k in angles])
    return _turned_back(q.copy(), angles, q[:, angles].astype(float) - centre)


def continued(problem: CurveProblem, chart: str, q: np.ndarray) -> np.ndarray:
    """Points of a curve, shape (m, n), with angles that pass a full turn without a jump."""
    places = problem.atlas.angles(problem.atlas.makers, chart)
    angles = q[:, places].astype(float)
    return _turned_back(q.copy(), places, angles - np.unwrap(angles, axis=0))


def _turned_back(q: np.ndarray, places: list[int], gaps: np.ndarray) -> np.ndarray:
    """Points, in place, whose angles are turned back by the whole turns in some gaps.

    gaps: in radians, shape (..., angles).
    """
    turns = np.round(gaps / (2 * np.pi))
    if not turns.any():
        return q
    bits = precision_of(q)
    if bits == 53:
        q[..., places] -= 2 * np.pi * turns
        return q
    with working_precision(2 * bits):
        for k, column in zip(places, turns.T, strict=True):
            q[..., k] -= Taylor(bits).array([2 * mpmath.pi * int(turn) for turn in column])
    return q


def _long_rows(rows: Sequence[Sequence[Real]], bits: int) -> np.ndarray:
    """Rows of numbers in the type in which an engine of this precision calculates."""
    return np.array([Taylor(bits).array(row) for row in rows])


def coordinate_velocities(
    problem: CurveProblem, q: np.ndarray, u: np.ndarray, bits: int = 53
) -> np.ndarray:
    """q'^mu = E_i^mu u^i at many points of the home chart."""
    chart = problem.chart(problem.atlas.home)
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
    width = len(problem.chart(name).names)
    rows = np.empty((len(times), width))
    for segment, states, index in trajectory.at(times * problem.time_unit):
        rows[index] = _placed(problem, segment, states, name)
    return rows


def _placed(problem: CurveProblem, segment: Segment, states: np.ndarray, name: str) -> np.ndarray:
    """Coordinates of states of a segment in a chart."""
    q, u, _ = taken_apart(problem, [(segment, states)])
    if segment.label == name:
        return q
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
    width, number, m = equations.width, len(members), times.shape[-1]
    q, u = np.full((number, m, n if width else 0), np.nan), np.full((number, m, n), np.nan)
    done = rows.finished.copy()
    done[list(rows.trajectories)] = False
    states = rows.states[done, -m:]
    if equations.moves:
        u[done] = states[..., width : width + n] * members.units[done, None, None]
    else:
        seen = np.all(np.isfinite(states), axis=2, keepdims=True)
        u[done] = np.where(seen, members.varied["own_velocity"][done, None, :], np.nan)
    if width:
        there, turned = states[..., :width].reshape(-1, width), u[done].reshape(-1, n)
        home = problem.atlas.home
        if members.label != home:
            # After its stop a member has no numbers.
            seen = np.isfinite(there).all(axis=1)
            read = converted(problem, members.label, home, there[seen], turned[seen])
            there, turned = np.full((2, there.shape[0], n), np.nan)
            there[seen], turned[seen] = read
        q[done], u[done] = there.reshape(-1, m, n), turned.reshape(-1, m, n)
    first = rows.states.shape[1] - m
    for k, trajectory in rows.trajectories.items():
        single = problem.member(members, k)
        pieces = [(x, x.states) for x in trajectory.segments if x.count]
        try:
            grid = np.concatenate([x.times for x, _ in pieces])
            motion = moment(single, grid, pieces, grid.shape, 53)
        except ChartEdgeError:
            continue
        count = max(len(grid) - first, 0)
        q[k, :count], u[k, :count] = motion.coordinates[first:], motion.frame_velocity[first:]
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
    q2 = _turned_alike(problem, q, q2)
    groups = map(list, problem.chart(home).groups)
    pairs = [(here["frame_velocity"], there["frame_velocity"])]
    pairs += [(q[..., group], q2[..., group]) for group in groups]
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
    legs = velocity_names(problem.frame)
    own = dict(zip(problem.coordinates, problem.start or (), strict=False))
    own |= dict(zip(legs, problem.frame_velocity, strict=True))
    names = {"starts": problem.coordinates, "velocities": problem.coordinates}
    arrays = {
        key: _rows(_by_rows(value, names.get(key, legs), own, key), n, key)
        for key, value in lists.items()
        if value is not None
    }
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
    chart = problem.chart(problem.atlas.home)
    point = dict(zip(chart.names, place.T, strict=True))
    numbers = {key: float(value) for key, value in problem.parameters.items()}
    return place, chart.coframe.applied(point | numbers, arrays["velocities"].T).T


def _by_rows(values: object, names: Sequence[str], own: Mapping[str, Real], what: str) -> object:
    """Columns with names (a mapping, a table) as rows; missing ones have the own values."""
    labelled = checks.labelled(values)
    if labelled is None:
        return values
    columns = checks.known_keys(labelled, names, what, StartError)
    if what != "velocities":
        columns = {name: float(own[name]) for name in names if name in own} | columns
    checks.check_values(names, columns, what, StartError, "Add it.")
    try:
        return np.column_stack(np.broadcast_arrays(*(np.atleast_1d(columns[x]) for x in names)))
    except ValueError:
        lengths = {name: np.shape(column) for name, column in columns.items()}
        raise ShapeError(f"{what}: expected lists of equal length, got {lengths}.") from None


def _rows(values: object, n: int, what: str) -> np.ndarray:
    """An array of shape (number, n) of finite numbers."""
    array = checks.array(values, what, StartError, shape=(None, n), shape_error=ShapeError)
    if not len(array):
        raise ShapeError(f"{what}: expected at least one row of {n} numbers, got none.")
    return array


def _check_members(
    problem: CurveProblem, names: Sequence[str], place: np.ndarray | None, velocities: np.ndarray
) -> None:
    """Refuse members whose condition to stop has fallen at their start already."""
    if not problem.stops:
        return
    point: dict[str, float | np.ndarray] = {k: float(x) for k, x in problem.parameters.items()}
    if place is not None:
        point |= dict(zip(problem.coordinates, place.T, strict=True))
    check_stops(problem.stops, point | dict(zip(names, velocities.T, strict=True)))


def laid_out(problem: CurveProblem, place: np.ndarray | None, velocities: np.ndarray) -> Members:
    """Members in the chart of preference, each with a time unit of its own."""
    if problem.carried is not None:
        raise StartError(
            "expected curves without vectors carried along, got curves with them. Solve such "
            "problems one by one."
        )
    names = velocity_names(problem.frame)
    _check_members(problem, names, place, velocities)
    sizes = np.abs(velocities).max(axis=1)
    if not problem.law.is_quadratic:
        # As `CurveProblem.time_unit`: the path depends on the speed.
        sizes = np.ones(len(velocities))
    units = np.where(sizes > 0, 2.0 ** np.round(np.log2(np.where(sizes > 0, sizes, 1))), 1.0)
    if any(symbol.name in names for stop in problem.stops for symbol in stop.term.free_symbols):
        # The condition is compiled for velocities in one unit.
        units = np.full(len(velocities), problem.time_unit)
    scaled = velocities / units[:, None]
    varied = {"frame_velocity": velocities}
    if place is not None:
        varied["start"] = place
    label = problem.charts[0] if place is not None else ""
    if place is not None and label != problem.atlas.home:
        place, scaled = converted(problem, problem.atlas.home, label, place, scaled)
    equations = problem.equations(label)
    varied["own_velocity"] = scaled * units[:, None]
    clock = np.zeros((len(scaled), 1)) if equations.clock else None
    moving = scaled if equations.moves else None
    parts = [part for part in (place, moving, clock) if part is not None]
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

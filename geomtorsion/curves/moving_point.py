"""Moving point: a start, checked, and carried from one chart into another at any precision."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from geomtorsion import checks
from geomtorsion.codegen.expression_graph import branch_check
from geomtorsion.curves.atlas import atlas_of
from geomtorsion.curves.transported import speed_powers
from geomtorsion.errors import (
    BranchError,
    ChartEdgeError,
    GeomtorsionError,
    MissingValueError,
    SingularPointError,
    StartError,
)
from geomtorsion.ode.numbers import Real, checked_numbers, divided, floats
from geomtorsion.precision import CALCULATED

if TYPE_CHECKING:
    from geomtorsion.curves.problem import CurveProblem
    from geomtorsion.geometry import Frame


# A chart is worth moving to if it is this much further from its edge, in units of its margin.
GAIN = 1.5


class MovingPoint(NamedTuple):
    """Coordinates, velocities u^i in units of the speed, and what is carried along."""

    coordinates: list[Real]
    velocities: list[Real]
    carried: list[Real]

    @property
    def has_value(self) -> bool:
        """Whether a motion can begin here."""
        return all(math.isfinite(float(x)) for row in self for x in row)


def beginning(problem: CurveProblem, precision: int) -> tuple[str, MovingPoint]:
    """The chart in which to begin, and the point there."""
    unit = problem.time_unit
    velocities = [divided(u, unit) for u in _frame_velocity(problem, precision)]
    carried: list[Real] = []
    if problem.carried is not None:
        powers = speed_powers(problem.carried)
        carried = [
            divided(x, unit) if power else x
            for x, power in zip(problem.carried.start, powers, strict=True)
        ]
    if problem.start is None:
        return "", MovingPoint([], velocities, carried)
    home, point = problem.atlas.home, MovingPoint(list(problem.start), velocities, carried)
    name = best_chart(problem, home, point, precision, starting=True)
    if name is None or name == home:
        return home, point
    return name, moved(problem, home, name, point, precision)


def _frame_velocity(problem: CurveProblem, precision: int) -> Sequence[Real]:
    """u^i at the start, worked out from q'^mu where more digits are needed."""
    given = problem.coordinate_velocity
    if precision <= 53 or given is None or problem.start is None:
        return problem.frame_velocity
    chart = problem.atlas.chart(problem.atlas.home)
    point = dict(zip(chart.names, problem.start, strict=True)) | dict(problem.parameters)
    return chart.coframe.precisely(point, given, precision + 20)


def best_chart(
    problem: CurveProblem,
    source: str,
    point: MovingPoint,
    precision: int,
    *,
    starting: bool = False,
) -> str | None:
    """The first chart far from its edge, or else the one that is furthest from it.

    Of those that are far from their edges none in which the motion is much faster than in another:
    behind a horizon, ingoing coordinates run away from what comes out of it, and outgoing ones from
    what falls in.
    """
    best, score = None, 0.0
    far: list[tuple[str, float]] = []
    for name in problem.charts:
        if name == source and not starting:
            continue
        try:
            there = moved(problem, source, name, point, precision)
        except (ChartEdgeError, ArithmeticError, ValueError):
            continue
        if not there.has_value:
            continue
        chart = problem.atlas.chart(name)
        place = dict(zip(chart.names, map(float, there.coordinates), strict=True))
        numbers = {key: float(value) for key, value in problem.parameters.items()}
        distance = chart.distance(place | numbers)
        if distance >= 2 * GAIN:
            far.append((name, math.hypot(*map(float, there.velocities))))
        if distance > score:
            best, score = name, distance
    if far:
        slowest = min(speed for _, speed in far)
        return next(name for name, speed in far if speed <= 2 * GAIN * slowest)
    return best if starting or score > GAIN else None


def moved(
    problem: CurveProblem, source: str, target: str, point: MovingPoint, bits: int
) -> MovingPoint:
    """A moving point in another chart; above 53 bits with mpmath numbers throughout."""
    if source == target:
        return point
    coordinates, velocities, carried = point
    numbers = dict(problem.parameters)
    turning = not same_frame(problem, source, target)
    rates: list[Real] = []
    if turning:
        chart = problem.atlas.chart(source)
        place = dict(zip(chart.names, coordinates, strict=True)) | numbers
        rates = chart.frame_vectors.precisely(place, velocities, bits)
    for change in problem.atlas.route(source, target):
        here = problem.atlas.chart(change.source)
        if turning:
            place = dict(zip(here.names, coordinates, strict=True)) | numbers
            rates = change.slopes.precisely(place, rates, bits)
        if bits > 53:
            coordinates = list(change.precisely(coordinates, numbers, bits))
        else:
            coordinates = change([float(x) for x in coordinates], numbers).tolist()
    if not np.isfinite([float(x) for x in coordinates]).all():
        raise ChartEdgeError(f"chart {target!r} does not reach this point")
    if turning:
        chart = problem.atlas.chart(target)
        place = dict(zip(chart.names, coordinates, strict=True)) | numbers
        velocities = chart.coframe.precisely(place, rates, bits)
    return MovingPoint(coordinates, list(velocities), carried)


def same_frame(problem: CurveProblem, source: str, target: str) -> bool:
    """Whether two charts have the same frame vectors."""
    return problem.atlas.chart(source).keeps_frame and problem.atlas.chart(target).keeps_frame


CAUSAL = ("timelike", "null", "spacelike")


def checked_parameters(frame: Frame, parameters: Mapping[Any, Any] | None) -> dict[str, Real]:
    """Parameters by name, each one known to the frame, finite and as it was declared."""
    known = {s.name: s for s in frame.field.symbols if s not in frame.coordinates}
    found: dict[str, Real] = {}
    for name, value in checks.by_name(parameters, "parameters", StartError).items():
        if name not in known:
            listed = ", ".join(sorted(known)) or "none"
            raise StartError(
                f"{checks.shown(name)} is no parameter of this frame. Known are {listed}."
            )
        checked_numbers([value], 1, f"parameter {name}")
        checks.check_declared(known[name], value)
        found[name] = value
    return found


def checked_start(frame: Frame, start: object, parameters: Mapping[str, Real]) -> tuple[Real, ...]:
    """Coordinates at which the frame is regular."""
    names = ", ".join(symbol.name for symbol in frame.coordinates)
    found = checked_numbers(start, frame.dimension, f"start ({names})")
    point = {s.name: float(x) for s, x in zip(frame.coordinates, found, strict=True)}
    where = ", ".join(f"{name} = {value:.6g}" for name, value in point.items())
    point |= {name: float(value) for name, value in parameters.items()}
    try:
        size = abs(complex(frame.determinant.element().evaluate(point)))
        if not _has_legs(frame, point):
            frame.legs.at(point)
    except MissingValueError as error:
        raise StartError(f"{error} Give parameters={{...}}.") from None
    except BranchError as error:
        # The frame may be regular there, but was read for the other side.
        raise StartError(f"start {where}: {error}") from None
    except (SingularPointError, ZeroDivisionError):
        size = 0.0
    if size == 0.0 or not math.isfinite(size):
        raise StartError(
            f"the frame {frame.name or 'of this problem'} is singular at the start {where}: "
            "its determinant vanishes or has no value. Start beside the edge of the chart, "
            "or in another chart."
        )
    return found


def _has_legs(frame: Frame, point: Mapping[str, float]) -> bool:
    """Whether doubles give all legs at a point, on the right branches; exact work takes longer."""
    atlas = atlas_of(frame)
    try:
        values = atlas.chart(atlas.home).frame_vectors.values(point)
    except (KeyError, GeomtorsionError):
        # What is missing, exact work says by name.
        return False
    branches = branch_check([frame.field], list(point))
    kept = branches is None or not branches.broken(*point.values()).any()
    return kept and not frame.complex and bool(np.isfinite(values).all())


def frame_velocities(
    frame: Frame,
    start: Sequence[Real] | None,
    velocity: object,
    frame_velocity: object,
    parameters: Mapping[str, Real],
) -> tuple[tuple[Real, ...], tuple[Real, ...] | None]:
    """u^i, as given or from the coordinate velocity, and that velocity if it was given."""
    if (velocity is None) == (frame_velocity is None):
        came = "none" if velocity is None else "both"
        raise StartError(
            f"exactly one of velocity (q'^mu) and frame_velocity (u^i) was needed, {came} came."
        )
    if velocity is None:
        return checked_numbers(frame_velocity, frame.dimension, "frame_velocity"), None
    rates = checked_numbers(velocity, frame.dimension, "velocity")
    if start is None:
        raise StartError("velocity needs a start; without one, give frame_velocity (u^i).")
    point = {s.name: float(x) for s, x in zip(frame.coordinates, start, strict=True)}
    point |= {name: float(value) for name, value in parameters.items()}
    coframe = frame.coframe.at(point)
    found = np.real(coframe) @ np.array(floats(rates))
    return tuple(found.tolist()), rates


def check_causal(frame: Frame, velocity: Sequence[Real], causal: str | None) -> None:
    """Refuse a velocity that has not the causal character asked for."""
    if causal is None:
        return
    if causal not in CAUSAL:
        raise StartError(f"causal={causal!r}: one of {', '.join(CAUSAL)} was needed.")
    eta = np.real(frame.eta.at({}))
    squares = np.linalg.eigvalsh(eta)
    if squares.min() > 0:
        raise StartError(f"causal={causal!r} needs a metric with time; this one is Euclidean.")
    u = np.array([float(x) for x in velocity])
    norm, size = float(u @ eta @ u), float(abs(eta).max() * (u @ u))
    # Null as far as rounding can tell: the norm is nothing against its terms.
    is_null = abs(norm) <= CALCULATED * size
    # Time is the one direction whose square has the other sign; in two dimensions the negative one.
    time = 1 if (squares > 0).sum() == 1 < (squares < 0).sum() else -1
    found = "null" if is_null else ("timelike" if time * norm > 0 else "spacelike")
    if found != causal:
        raise StartError(
            f"the velocity is {found}: eta_ij u^i u^j = {norm:.6g}, but {causal} was asked for. "
            "Give another velocity, or causal=None."
        )

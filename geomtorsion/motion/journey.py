"""Journey: one integration across as many charts as it takes."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, NamedTuple

from geomtorsion.errors import ChartEdgeError
from geomtorsion.motion.crossing import State, has_value, moved_over
from geomtorsion.motion.disturbed import interrupted, moved_start
from geomtorsion.motion.engines.protocol import Engine, Run
from geomtorsion.motion.equations import Equations
from geomtorsion.motion.passengers import weights
from geomtorsion.motion.reduced.runs import integrated
from geomtorsion.motion.system import evaluated

if TYPE_CHECKING:
    from geomtorsion.motion.problem import Problem

# A motion that changes charts more often than this goes round in circles on an edge.
MOST_CHANGES = 10_000
# One that gets stuck in so many charts in turn, without going on by this part of its time, is at
# the end of all of them.
PATIENCE, STANDSTILL = 2, 1e-9
# A chart is worth moving to if it is this much further from its edge, in units of its margin.
GAIN = 1.5


class Segment(NamedTuple):
    """What was computed in one chart.

    chart: its name; "" where velocities alone are followed.
    begin: time at which the segment starts, in units of the journey.
    skips: 1 if its first sample is the change of charts, which nobody asked for.
    """

    chart: str
    equations: Equations
    run: Run
    begin: float
    skips: int
    start: Sequence[Any]
    parameters: Sequence[Any]

    @property
    def times(self) -> Any:
        """Sample times that were asked for."""
        return self.run.times[self.skips :]

    @property
    def states(self) -> Any:
        """States at these times."""
        return self.run.states[self.skips :]


@dataclass(frozen=True, eq=False)
class Journey:
    """Segments in order, in time units of 1/speed and velocities in units of speed."""

    problem: Problem
    engine: Engine
    tolerance: float
    segments: tuple[Segment, ...]
    outcome: str
    reason: str

    @property
    def count(self) -> int:
        """Number of samples reached."""
        return sum([len(segment.run.times) - segment.skips for segment in self.segments])

    @property
    def steps(self) -> int:
        """Steps of all segments."""
        return sum([segment.run.steps for segment in self.segments])

    @property
    def evaluations(self) -> int:
        """Evaluations of all segments."""
        return sum([segment.run.evaluations for segment in self.segments])

    @property
    def compile_seconds(self) -> float:
        """Time spent on compilation."""
        return sum([segment.run.compile_seconds for segment in self.segments])

    @property
    def run_seconds(self) -> float:
        """Time spent on integration."""
        return sum([segment.run.run_seconds for segment in self.segments])

    @property
    def reached(self) -> float:
        """The last time, in units of the journey."""
        return float(self.segments[-1].run.reached)


def travel(
    problem: Problem,
    engine: Engine,
    tolerance: float,
    times: Any,
    *,
    dense: bool = False,
    moved: float = 0.0,
    at: int = 0,
) -> Journey:
    """Follow a motion through times (from 0, in units of 1/speed), changing charts on the way.

    moved: by how much to move the states at the start and at one sample, relative to their size;
        a run that checks another is moved, so that the difference contains how rounding grows.
    at: index of that sample.
    """
    import numpy as np

    several = len(problem.charts) > 1
    name, velocities, vector, parameters = departure(problem, engine.precision)
    segments: list[Segment] = []
    rest, skips, idle = times, 0, 0
    if moved:
        vector = moved_start(problem.equations(name), vector, moved, engine.precision)
    while True:
        equations = problem.equations(name)
        system = equations.system if several else equations.system.to_the_end
        # What is rounded after the last sample shows nowhere.
        place = min(at, len(rest) - 2)
        if moved and not segments and place > 0:
            start = vector, parameters
            run = interrupted(engine, (equations, system), start, rest, tolerance, moved, place)
        else:
            run = integrated(
                engine, equations, system, vector, parameters, rest, tolerance, dense=dense
            )
        first = float(rest[0])
        segments.append(Segment(name, equations, run, first, skips, vector, parameters))
        if run.outcome != "edge" and not (run.outcome == "stuck" and several and name):
            return Journey(problem, engine, tolerance, tuple(segments), run.outcome, run.reason)
        moved_on = abs(float(run.reached) - first) > STANDSTILL * abs(float(run.reached))
        idle = idle + 1 if run.outcome == "stuck" and not moved_on else 0
        if idle == PATIENCE:
            return Journey(problem, engine, tolerance, tuple(segments), "stuck", run.reason)
        state = _joined(equations, run.last, velocities)
        target = best_chart(problem, name, state, engine.precision)
        if target is None or len(segments) > MOST_CHANGES:
            reason = run.reason or _ending(equations)
            return Journey(problem, engine, tolerance, tuple(segments), "stuck", reason)
        state = moved_over(problem, name, target, state, engine.precision)
        name, skips = target, 1
        velocities, vector, parameters = _laid_out(problem, name, state)
        rest = np.concatenate(([run.reached], rest[len(run.times) :]))


def _ending(equations: Equations) -> str:
    """What is the matter where a chart ends."""
    chart = equations.chart
    if chart is None or chart.edge is None:
        return "no other chart of the space reaches further"
    return f"{chart.edge.sympy} = 0"


def beginning(problem: Problem, precision: int) -> tuple[str, State]:
    """The chart in which to begin, and the state there."""
    return problem.kept(("beginning", precision), lambda: _beginning(problem, precision))


def _beginning(problem: Problem, precision: int) -> tuple[str, State]:
    speed = problem.speed
    velocities = [_divided(u, speed) for u in problem.frame_velocity]
    riders: list[Any] = []
    if problem.passengers is not None:
        scales = weights(problem)
        riders = [
            _divided(x, speed) if w else x
            for x, w in zip(problem.passengers.start, scales, strict=True)
        ]
    if problem.start is None:
        return "", ([], velocities, riders)
    home: State = (list(problem.start), velocities, riders)
    name = best_chart(problem, problem.atlas.home, home, precision, starting=True)
    if name is None or name == problem.atlas.home:
        return problem.atlas.home, home
    return name, moved_over(problem, problem.atlas.home, name, home, precision)


def best_chart(
    problem: Problem, source: str, state: State, precision: int, *, starting: bool = False
) -> str | None:
    """The first chart far from its edge, or else the one that is furthest from it."""
    best, score = None, 0.0
    for name in problem.charts:
        if name == source and not starting:
            continue
        try:
            there = moved_over(problem, source, name, state, precision)
        except (ChartEdgeError, ArithmeticError, ValueError):
            continue
        if not has_value(there):
            continue
        distance = edge_distance(problem, name, there)
        if distance >= 2 * GAIN:
            return name
        if distance > score:
            best, score = name, distance
    return best if starting or score > GAIN else None


def edge_distance(problem: Problem, name: str, state: State) -> float:
    """Edge function of a chart in units of its margin; infinite where there is no edge."""
    chart = problem.atlas.chart(name)
    if chart.edge is None or not chart.margin:
        return float("inf")
    values = dict(zip(chart.names, map(float, state[0]), strict=True))
    values |= {key: float(value) for key, value in problem.parameters.items()}
    return float(evaluated([((chart.edge, ()),)], values)[0]) / chart.margin


def _divided(value: Any, speed: float) -> Any:
    """A velocity in units of the speed, which is a power of two: nothing is lost."""
    if speed == 1.0:
        return value
    if isinstance(value, int | float):
        return value / speed
    from fractions import Fraction

    import sympy as sp

    ratio = Fraction(speed)
    if isinstance(value, sp.Expr):
        return value / sp.Rational(ratio.numerator, ratio.denominator)
    return value / ratio


def departure(problem: Problem, precision: int) -> tuple[str, list[Any], Any, Any]:
    """Chart, velocities, vector of states and values of parameters with which to begin.

    In double precision the last two are arrays, made once for all runs.
    """
    return problem.kept(("departure", precision), lambda: _departure(problem, precision))


def _departure(problem: Problem, precision: int) -> tuple[str, list[Any], Any, Any]:
    import numpy as np

    name, state = beginning(problem, precision)
    velocities, vector, parameters = _laid_out(problem, name, state)
    if precision == 53:
        vector, parameters = (np.array([float(x) for x in y]) for y in (vector, parameters))
        vector.flags.writeable = parameters.flags.writeable = False
    return name, velocities, vector, parameters


def _laid_out(
    problem: Problem, name: str, state: State
) -> tuple[list[Any], Sequence[Any], Sequence[Any]]:
    """Velocities, vector of states for an engine, and values of the parameters."""
    equations = problem.equations(name)
    coordinates, velocities, riders = state
    moving = velocities if equations.moves else []
    parameters = tuple(values_of(problem, equations, velocities))
    return velocities, (*coordinates, *moving, *riders), parameters


def _joined(equations: Equations, vector: Any, velocities: list[Any]) -> State:
    """The vector of states, taken apart again."""
    width, n = equations.width, len(velocities)
    values = list(vector)
    if equations.moves:
        return values[:width], values[width : width + n], values[width + n :]
    return values[:width], velocities, values[width:]


def values_of(problem: Problem, equations: Equations, velocities: Sequence[Any]) -> list[Any]:
    """Values of the parameters of a system, in its order."""
    table: dict[str, Any] = dict(problem.parameters) | dict(equations.constants)
    if not equations.moves:
        table |= dict(zip(equations.velocities, velocities, strict=True))
    return [table[name] for name in equations.system.parameters]

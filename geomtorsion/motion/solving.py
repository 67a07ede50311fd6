"""Solving: an answer to the accuracy asked for, or an error that says what can be had."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator
from dataclasses import replace
from typing import Any

from geomtorsion.errors import AccuracyError, ChartEdgeError
from geomtorsion.motion.asked import SAMPLES, checked_accuracy, checked_times
from geomtorsion.motion.beside import solved_beside
from geomtorsion.motion.checking import CAUTION, Checked, checked
from geomtorsion.motion.compare import difference
from geomtorsion.motion.disturbed import busiest
from geomtorsion.motion.engines.protocol import Engine
from geomtorsion.motion.engines.rungekutta import RungeKutta, Stiff
from geomtorsion.motion.engines.taylor import Taylor, is_available
from geomtorsion.motion.in_turn import told_in_turn
from geomtorsion.motion.journey import Journey, beginning, travel, values_of
from geomtorsion.motion.problem import Problem
from geomtorsion.motion.solution import Cost, Solution

__all__ = ["CAUTION", "SAMPLES", "checked_accuracy", "checked_times", "choices", "solve"]

# The first tolerance is this much below the accuracy; later ones go down by STEP.
MARGIN, STEP = 0.1, 1e-2
# States of which the largest is so many times another are of uneven size.
UNEVEN = 3e3
# Starts of checks are moved by so many units in the last place, as roundings add up on the way.
ROUNDINGS = 2.0
# A motion whose fastest decay times the duration exceeds this is left to an implicit engine.
STIFF = 3e4


def solve(
    problem: Problem, t: Any, accuracy: float = 1e-10, engine: Engine | None = None
) -> Solution:
    """Solve a motion so that the result, not each step, is as accurate as asked.

    The error is told by runs beside the answer or after it (see `abreast`, `in_turn`, and for
    what they cannot tell `checking`). The tolerance goes down until the error is below the
    accuracy.

    Parameters
    ----------
    problem
        from `autoparallel`, `geodesic`, ...
    t
        last time, or increasing (or decreasing) times from 0 on; the motion starts at t = 0.
    accuracy
        largest error, relative to the size of the solution (see `Solution.error`).
    engine
        Taylor(), RungeKutta() or Stiff(); None chooses and says why.

    Raises
    ------
    AccuracyError
        accuracy <= 0, or not to be had with this engine.
    TimeError
        times are empty, repeated, unsorted, not finite or on both sides of 0.
    ChartEdgeError
        the motion ran out of its last chart; the error carries what was computed.

    Examples
    --------
    >>> from geomtorsion.geometry import cartan
    >>> from geomtorsion.motion import autoparallel
    >>> from geomtorsion.spaces import load
    >>> spiral = autoparallel(cartan(load("flat_polar").frame), [1.0, 0.0], [1.0, 0.5])
    >>> sol = solve(spiral, [1.0, 2.0], accuracy=1e-8)
    >>> [round(float(r), 7) for r in sol.coordinates[:, 0]]
    [2.0, 3.0]
    """
    accuracy = checked_accuracy(accuracy)
    times, grid = checked_times(t)
    speed = problem.speed
    # What nobody may write to need not be copied.
    scaled = grid if speed == 1.0 and not grid.flags.writeable else grid * speed
    spent: list[Journey] = []
    best = math.inf
    for candidate, why in candidates(problem, scaled, accuracy, engine):
        found = _refined(problem, candidate, scaled, accuracy)
        spent += found.spent
        best = min(best, found.error)
        if found.error <= accuracy or found.answer.outcome == "stuck":
            solution = _solution(problem, times, grid, accuracy, why, found, spent)
            if not solution.complete:
                raise ChartEdgeError(stopped(solution), solution)
            return solution
    raise AccuracyError(
        f"accuracy {accuracy:.3g} was asked for; {_tried(spent)} gets to {best:.2g}. "
        + remedy(engine)
    )


def _refined(problem: Problem, engine: Engine, times: Any, accuracy: float) -> Checked[Journey]:
    """Answer, check and error of the first tolerance that is good enough, or of the last."""
    known = learned(problem)
    key = (engine.name, accuracy)
    if isinstance(engine, Taylor) and engine.precision == 53:
        beside = solved_beside(problem, engine, times, accuracy, known)
        if beside is not None:
            return beside
    places: list[int] = [0]
    made: dict[float, Journey] = {}

    def attempt(tolerance: float) -> Journey:
        if tolerance not in made:
            made[tolerance] = travel(problem, engine, tolerance, times)
            first = made[tolerance].segments[0]
            places[0] = busiest(first.run.states, first.equations.system.blocks)
        return made[tolerance]

    def moved(tolerance: float, part: float) -> Journey:
        return travel(problem, engine, tolerance, times, moved=ROUNDINGS * part, at=places[0])

    if isinstance(engine, RungeKutta):
        in_turn = told_in_turn(engine, accuracy, known, attempt, moved, _held)
        if in_turn is not None:
            return in_turn
    found = checked(
        engine,
        accuracy,
        known.get(key) or engine.first(accuracy),
        attempt,
        _held,
        lambda journey: journey.outcome == "stuck",
        # Of RungeKutta's runs only short ones are left.
        coarse=not isinstance(engine, RungeKutta),
        disturbed=moved,
    )
    if found.error <= accuracy:
        known[key] = found.answer.tolerance
    return found


def _held(one: Journey, two: Journey) -> tuple[float, int]:
    """Their difference; a coarser run says nothing about a motion of uneven sizes.

    Engines measure steps by the largest state: the small ones are then as good as luck has it.
    """
    if two.tolerance > one.tolerance and _uneven(one):
        return math.inf, one.count
    return difference(one, two)


def _uneven(journey: Journey) -> bool:
    """Whether states end up of very different size, block by block."""
    segment = journey.segments[-1]
    last = [abs(float(x)) for x in segment.run.last]
    sizes = [max([last[k] for k in block]) for block in segment.equations.system.blocks]
    return max(sizes) > UNEVEN * min(size for size in sizes if size) if any(sizes) else False


def tolerances(first: float, finest: float) -> Iterator[float]:
    """Decreasing tolerances, at least two: rounded to powers of ten, so that few are compiled."""
    tolerance = 10.0 ** math.floor(math.log10(min(first, 1e-3)) + 1e-9)
    tolerance = max(tolerance, finest * 3)
    yield tolerance
    while tolerance > finest * 1.01:
        tolerance = max(tolerance * STEP, finest)
        yield tolerance


def learned(problem: Problem) -> dict[Any, float]:
    """Tolerances that were good enough before, for equal equations."""
    return problem.equations(problem.charts[0]).system.__dict__.setdefault("_learned", {})


def candidates(
    problem: Problem, times: Any, accuracy: float, engine: Engine | None
) -> Iterator[tuple[Engine, str]]:
    """Engines in the order in which to try them, each with the reason."""
    return choices(lambda: _is_stiff(problem, times), accuracy, engine)


def choices(
    stiff: Callable[[], bool], accuracy: float, engine: Engine | None
) -> Iterator[tuple[Engine, str]]:
    """The same for equations of any kind; stiff is asked only where it matters."""
    if engine is not None:
        yield engine, "as asked"
        return
    if stiff():
        yield Stiff(), "the equations are stiff at the start"
    if not is_available():
        if accuracy > 1e-13:
            yield RungeKutta(), "heyoka is not installed"
        return
    if accuracy > 4e-16:
        yield Taylor(), "heyoka is installed: the fastest"
    if accuracy > 4e-19:
        yield Taylor(64), "double precision does not give this accuracy"
    yield Taylor(113), "long double precision does not give this accuracy"
    yield Taylor(300), "quadruple precision does not give this accuracy"


def _is_stiff(problem: Problem, times: Any) -> bool:
    """Whether some direction decays much faster than the motion lasts; False if unknown."""
    rate = problem.kept("decay", lambda: fastest_decay(problem))
    return rate * abs(float(times[-1])) > STIFF


def fastest_decay(problem: Problem) -> float:
    """The largest rate at which a neighbouring motion decays towards this one, at the start."""
    import numpy as np

    name, state = beginning(problem, 53)
    equations = problem.equations(name)
    if not equations.moves and not equations.passengers:
        return 0.0
    vector = [*state[0], *(state[1] if equations.moves else []), *state[2]]
    values = [float(x) for x in values_of(problem, equations, state[1])]
    try:
        jacobian = equations.system.scalar_jacobian(values)
        matrix = jacobian(0.0, np.array([float(x) for x in vector]))
    except (ArithmeticError, ValueError):
        return 0.0
    return float(-np.linalg.eigvals(matrix).real.min()) if np.isfinite(matrix).all() else 0.0


def _solution(
    problem: Problem,
    times: Any,
    grid: Any,
    accuracy: float,
    why: str,
    found: Checked[Journey],
    spent: list[Journey],
) -> Solution:
    """The answer with what is known about it."""
    answer = found.answer
    complete = answer.outcome == "done"
    reached = times if complete else grid[: answer.count]
    if complete and len(grid) > len(times):
        first = answer.segments[0]
        first = first._replace(skips=first.skips + 1)
        answer = replace(answer, segments=(first, *answer.segments[1:]))
    run_seconds = answer.run_seconds
    cost = Cost(
        answer.steps,
        answer.evaluations,
        sum([journey.compile_seconds for journey in spent]),
        run_seconds,
        sum([journey.run_seconds for journey in spent]) - run_seconds,
    )
    return Solution(
        problem,
        reached,
        accuracy,
        found.error,
        answer.engine.name,
        why,
        cost,
        complete,
        answer,
        found.against,
        found.share,
    )


def stopped(solution: Solution) -> str:
    """Where a motion ended, why, and what can be done."""
    journey = solution.journey
    segment = journey.segments[-1]
    chart = solution.problem.atlas.chart(segment.chart) if segment.chart else None
    names = chart.names if chart else segment.equations.velocities
    last = [float(x) for x in list(segment.run.last)[: len(names)]]
    pairs = zip(names, last, strict=True)
    place = ", ".join(f"{name} = {x:.6g}" for name, x in pairs if math.isfinite(x))
    time = journey.reached / solution.problem.speed
    problem = solution.problem
    advice = "The space has one chart only; give an atlas with another, or stop earlier."
    if len(problem.charts) > 1:
        advice = "No other chart of the space reaches further; stop earlier."
    elif len(problem.atlas.makers) > 1 and problem.law.keeps_frame:
        advice = "The law is about this very frame, which ends here; stop earlier."
    elif problem.passengers is not None and not problem.passengers.any_chart:
        advice = "What rides along is given in this very frame, which ends here; stop earlier."
    elif len(problem.atlas.makers) > 1:
        advice = f"Allow another chart of {', '.join(problem.atlas.makers)}, or stop earlier."
    return (
        f"the motion stops at t = {time:.6g}, at {place}: chart {segment.chart!r} ends there "
        f"({journey.reason}). {advice} What was computed is in the error's `solution`."
    )


def _tried(spent: list[Journey]) -> str:
    names = dict.fromkeys(journey.engine.name for journey in spent)
    return ", then ".join(names) or "no engine at hand"


def remedy(engine: Engine | None) -> str:
    """What to do where an accuracy is not reached."""
    if engine is None and not is_available():
        return "Install heyoka (geomtorsion[fast]) for more digits, or ask for fewer."
    return "Ask for less, for a shorter time, or use Taylor(precision=113) or more."

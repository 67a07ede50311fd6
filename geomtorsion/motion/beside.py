"""Beside: a motion in a space with the runs that tell its error in the lanes beside it."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from geomtorsion.motion.abreast import Told, gaps, judged, moves, side_by_side, told
from geomtorsion.motion.disturbed import steps_of
from geomtorsion.motion.engines.abreast import looseness, tolerance_of_second
from geomtorsion.motion.journey import Journey, Segment, departure

if TYPE_CHECKING:
    from geomtorsion.motion.checking import Checked
    from geomtorsion.motion.engines.taylor import Taylor
    from geomtorsion.motion.equations import Equations
    from geomtorsion.motion.problem import Problem


def solved_beside(
    problem: Problem,
    engine: Taylor,
    times: Any,
    accuracy: float,
    known: dict[Any, Any],
) -> Checked[Journey] | None:
    """Answer, check and error; None where one run after the other has to tell."""
    if len(times) < 2 or times[0] == times[-1]:
        return None
    return told(
        engine,
        accuracy,
        known,
        lambda tolerance: _attempt(problem, engine, tolerance, times, accuracy, known),
    )


def _attempt(
    problem: Problem,
    engine: Taylor,
    tolerance: float,
    times: Any,
    accuracy: float,
    known: dict[Any, Any],
) -> Told[Journey] | None:
    """One answer with what its neighbours tell."""
    name, _, vector, numbers = departure(problem, 53)
    equations = problem.equations(name)
    system = equations.system if len(problem.charts) > 1 else equations.system.to_the_end
    looser = looseness(accuracy)
    starts = problem.kept(("abreast", looser), lambda: _starts(equations, vector, looser))
    lanes = side_by_side(engine, system, starts, numbers[:, None], times, tolerance, looser, known)
    if lanes is None:
        return None
    apart = gaps(lanes.states, lanes.sizes, equations.system.blocks)
    if apart is None:
        return None
    left_out, rounded = judged(lanes.share, apart)
    journeys = []
    for lane in (0, 1):
        run = lanes.run(lane)
        part = Segment(name, equations, run, float(times[0]), 0, vector, numbers)
        own = tolerance if lane == 0 else tolerance_of_second(tolerance, lanes.looser)
        journeys.append(Journey(problem, engine, own, (part,), "done", ""))
    return Told(*journeys, lanes.share, left_out, rounded)


def _starts(equations: Equations, vector: Any, looser: float) -> Any:
    """States at the start of each lane, shape (size, lanes)."""
    import numpy as np

    return vector[:, None] + np.multiply.outer(steps_of(equations, vector), moves(looser))

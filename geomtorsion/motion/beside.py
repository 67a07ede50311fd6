"""Beside: a motion in a space with the runs that tell its error in the lanes beside it."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from geomtorsion.motion.abreast import gaps, judged, moves, side_by_side, told
from geomtorsion.motion.disturbed import steps_of
from geomtorsion.motion.engines.abreast import extents, looseness, tolerance_of_second
from geomtorsion.motion.journey import Journey, Segment, departure
from geomtorsion.motion.search import Told

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
    opened = problem.kept(
        ("abreast", looser), lambda: _opened(engine, equations, vector, numbers, looser)
    )
    smaller = None if opened.widths is None else equations.reduction
    if smaller is not None:
        system = smaller.watching(system, opened.confined)
    lanes = side_by_side(
        engine, system, opened.starts, opened.numbers, times, tolerance, looser, known
    )
    if lanes is None:
        return None
    states, found = lanes.states, lanes.extents
    if smaller is not None:
        states = smaller.abreast(states, opened.widths, opened.confined)
        found = extents(states)
    apart = gaps(found, equations.system.blocks)
    if apart is None:
        return None
    left_out, rounded = judged(lanes.share, apart)

    def journey(lane: int, own: float) -> Journey:
        run = lanes.run(lane, states[:, :, lane])
        part = Segment(name, equations, run, float(times[0]), 0, vector, numbers)
        return Journey(problem, engine, own, (part,), "done", "")

    def against() -> Journey:
        return journey(1, tolerance_of_second(tolerance, looser))

    answer = journey(0, tolerance)
    return Told(answer, against, apart[0], left_out, rounded, (answer,), lanes.run_seconds)


@dataclass(frozen=True, eq=False)
class _Opened:
    """Starts and numbers of all lanes, shapes (size, lanes) and (parameters, lanes).

    widths: numbers of which velocities are made that are no states, or None where all are.
    confined: whether the smaller system is that of confined motions.
    """

    starts: Any
    numbers: Any
    widths: Any
    confined: bool = False


def _opened(
    engine: Taylor, equations: Equations, vector: Any, numbers: Any, looser: float
) -> _Opened:
    """The starts of all lanes, in the smaller system where that serves."""
    import numpy as np

    starts = vector[:, None] + np.multiply.outer(steps_of(equations, vector), moves(looser))
    smaller = equations.reduction
    if smaller is not None:
        first = smaller.opened(engine, starts[:, 0], numbers)
        others = starts.T[1:] if first is not None else ()
        lanes = [first, *(smaller.opened(engine, start, numbers, first) for start in others)]
        found = [lane for lane in lanes if lane is not None]
        if first is not None and len(found) == len(lanes):
            parts = ([getattr(x, name) for x in found] for name in ("start", "values", "numbers"))
            starts, values, widths = (np.array(part).T for part in parts)
            return _Opened(starts, values, widths, first.confined)
    return _Opened(starts, numbers[:, None], None)

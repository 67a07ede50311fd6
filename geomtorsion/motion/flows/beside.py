"""Beside: a flow with the runs that tell its error in the lanes beside it."""

from __future__ import annotations

from collections.abc import Sequence
from functools import partial
from typing import TYPE_CHECKING, Any

from geomtorsion.motion.abreast import gaps, judged, moves, side_by_side, told
from geomtorsion.motion.engines.abreast import LANES, looseness, sizes_of, tolerance_of_second
from geomtorsion.motion.flows.adjust import make_unit, moved_by, unit_rows
from geomtorsion.motion.flows.compare import is_noise
from geomtorsion.motion.flows.law import CLOCK
from geomtorsion.motion.flows.travel import Leg, Piece, Trip, samples_of
from geomtorsion.motion.search import Told

if TYPE_CHECKING:
    from geomtorsion.motion.checking import Checked
    from geomtorsion.motion.engines.taylor import Taylor
    from geomtorsion.motion.flows.flow import Flow


def solved_beside(
    flow: Flow,
    engine: Taylor,
    grid: Any,
    legs: Sequence[Leg],
    accuracy: float,
    known: dict[Any, Any],
) -> Checked[Trip] | None:
    """Answer, check and error; None where one run after the other has to tell."""
    if flow.law.stop is not None or legs[0].begin == legs[-1].end:
        return None
    return told(
        engine,
        accuracy,
        known,
        lambda tolerance: _attempt(flow, engine, tolerance, grid, legs, accuracy, known),
    )


def _attempt(
    flow: Flow,
    engine: Taylor,
    tolerance: float,
    grid: Any,
    legs: Sequence[Leg],
    accuracy: float,
    known: dict[Any, Any],
) -> Told[Trip] | None:
    """One answer with what its neighbours tell."""
    import numpy as np

    looser = looseness(accuracy)
    parts = moves(looser)
    pieces: list[list[Piece]] = [[], []]
    rows, share, starts = [], 0.0, None
    for k, leg in enumerate(legs):
        starts, numbers = _prepared(flow, engine, leg, starts, parts)
        times, head, inside = samples_of(grid, legs, k)
        lanes = side_by_side(engine, flow.system, starts, numbers, times, tolerance, looser, known)
        if lanes is None:
            return None
        share = max(share, lanes.share)
        rows.append(lanes.states[head : head + len(inside), : flow.size])
        for lane, found in enumerate(pieces):
            run = lanes.run(lane)
            states = run.states[head : head + len(inside)]
            found.append(Piece(leg, starts[:, lane].tolist(), run, inside, states))
        starts = lanes.states[-1]
    states = rows[0] if len(rows) == 1 else np.concatenate(rows)
    own = tolerance, tolerance_of_second(tolerance, looser)
    answer, check = (
        Trip(flow, engine, one, tuple(found), "done", "")
        for one, found in zip(own, pieces, strict=True)
    )
    apart = _gaps(flow, answer, states)
    if apart is None:
        return None
    left_out, rounded = judged(share, apart)
    runs = answer, check
    return Told(answer, check, apart[0], left_out, rounded, runs, answer.run_seconds)


def _prepared(
    flow: Flow, engine: Taylor, leg: Leg, last: Any, parts: Sequence[float]
) -> tuple[Any, Any]:
    """States and numbers of all lanes at the beginning of a leg; last: where they were."""
    if last is not None:
        return _made(flow, engine, leg, last, parts)
    # The first leg begins as the flow does: its lanes are worked out once.
    kept = flow.__dict__.setdefault("_abreast", {})
    if parts not in kept:
        kept[parts] = _made(flow, engine, leg, None, parts)
    return kept[parts]


def _made(
    flow: Flow, engine: Taylor, leg: Leg, last: Any, parts: Sequence[float]
) -> tuple[Any, Any]:
    """The same, worked out."""
    import numpy as np

    columns, numbers = [], []
    for lane, part in enumerate(parts):
        start = list(flow.start) if last is None else last[: flow.size, lane].tolist()
        for name, value in leg.jumps.items():
            start[flow.states.index(name)] = value
        values = leg.numbers
        if part:
            values = moved_by(values, engine, part, exact_too=False)
            start = moved_by(start, engine, part, exact_too=True) if last is None else start
        for places in flow.unit_places:
            make_unit(start, places, engine)
        if flow.law.clock:
            start.append(leg.begin / CLOCK)
        columns.append([float(x) for x in start])
        numbers.append([float(x) for x in values])
    return np.array(columns).T, np.array(numbers).reshape(LANES, -1).T


def _gaps(flow: Flow, answer: Trip, states: Any) -> list[float] | None:
    """How far each lane is from the first, relative to the size of each block."""
    import numpy as np

    if flow.unit_places:
        each = [unit_rows(flow, states[:, :, lane]) for lane in range(LANES)]
        states = np.stack(each, axis=2)
    begun = [abs(x) for x in answer.pieces[0].start[: flow.size]]
    sizes = list(map(max, sizes_of(states), begun))
    # The clock is no state of the flow.
    blocks = [block for block in flow.system.blocks if block[0] < flow.size]
    return gaps(states, sizes, blocks, partial(is_noise, answer))

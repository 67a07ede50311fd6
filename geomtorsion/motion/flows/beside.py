"""Beside: a flow with the runs that tell its error in the lanes beside it."""

from __future__ import annotations

from collections.abc import Sequence
from functools import partial
from typing import TYPE_CHECKING, Any, NamedTuple

from geomtorsion.motion.abreast import GROWN, gaps, judged, moves, side_by_side, told
from geomtorsion.motion.engines.abreast import (
    LANES,
    Abreast,
    extents,
    looseness,
    tolerance_of_second,
)
from geomtorsion.motion.flows.adjust import make_unit, moved_by, unit_rows
from geomtorsion.motion.flows.compare import is_noise
from geomtorsion.motion.flows.law import CLOCK
from geomtorsion.motion.flows.travel import Leg, Piece, Trip, samples_of
from geomtorsion.motion.search import Told

if TYPE_CHECKING:
    from geomtorsion.motion.checking import Checked
    from geomtorsion.motion.engines.taylor import Taylor
    from geomtorsion.motion.flows.flow import Flow

# Lanes of a motion that grows out of all proportion have their first steps in common, as these are
# measured by what it grows to: they show a part of the error that these steps make.
WARY = 4.0


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
    looser = looseness(accuracy)
    parts = moves(looser)
    passed: list[_Passed] = []
    starts = None
    for k, leg in enumerate(legs):
        starts, numbers = _prepared(flow, engine, leg, starts, parts)
        times, head, inside = samples_of(grid, legs, k)
        lanes = side_by_side(engine, flow.system, starts, numbers, times, tolerance, looser, known)
        if lanes is None:
            return None
        passed.append(_Passed(leg, starts, lanes, head, inside))
        starts = lanes.states[-1]

    def trip(lane: int, own: float) -> Trip:
        pieces = tuple([each.piece(lane) for each in passed])
        return Trip(flow, engine, own, pieces, "done", "")

    def against() -> Trip:
        return trip(1, tolerance_of_second(tolerance, looser))

    answer = trip(0, tolerance)
    apart = _gaps(flow, answer, passed)
    if apart is None:
        return None
    left_out, rounded = judged(max([each.lanes.share for each in passed]), apart)
    if known.get("size", 1.0) > GROWN * max(map(abs, passed[0].starts[:, 0].tolist())):
        left_out *= WARY
    return Told(answer, against, apart[0], left_out, rounded, (answer,), answer.run_seconds)


class _Passed(NamedTuple):
    """One leg with its lanes.

    starts: of all lanes, shape (size, lanes).
    head: how many samples come first that nobody asked for; inside: the times of the others.
    """

    leg: Leg
    starts: Any
    lanes: Abreast
    head: int
    inside: Any

    @property
    def states(self) -> Any:
        """States of all lanes at the samples asked for, shape (m, size, lanes)."""
        return self.lanes.states[self.head : self.head + len(self.inside)]

    def piece(self, lane: int) -> Piece:
        """What was computed in one lane."""
        start, run = self.starts[:, lane].tolist(), self.lanes.run(lane)
        states = run.states[self.head : self.head + len(self.inside)]
        return Piece(self.leg, start, run, self.inside, states)


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


def _gaps(flow: Flow, answer: Trip, passed: Sequence[_Passed]) -> list[float] | None:
    """How far each lane is from the first, relative to the size of each block."""
    # The clock is no state of the flow.
    blocks = [block for block in flow.system.blocks if block[0] < flow.size]
    return gaps(_extents(flow, passed), blocks, partial(is_noise, answer))


def _extents(flow: Flow, passed: Sequence[_Passed]) -> list[list[float]]:
    """How large states are, and how far apart lanes are, at the samples; the first is the start."""
    import numpy as np

    first = passed[0]
    if len(passed) == 1 and not flow.unit_places and len(first.inside) == len(first.lanes.states):
        return first.lanes.extents
    states = np.concatenate([each.states[:, : flow.size] for each in passed])
    if flow.unit_places:
        lanes = [unit_rows(flow, states[:, :, lane]) for lane in range(LANES)]
        states = np.stack(lanes, axis=2)
    return extents(states)

"""Travel: one integration of a flow, piece by piece from switch to switch."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any, NamedTuple

from geomtorsion.motion.engines.protocol import Engine, Run
from geomtorsion.motion.engines.taylor import Taylor
from geomtorsion.motion.flows.adjust import make_unit, moved_by
from geomtorsion.motion.flows.law import CLOCK
from geomtorsion.motion.flows.roots import crossings
from geomtorsion.motion.system import System

if TYPE_CHECKING:
    from geomtorsion.motion.flows.flow import Flow

RunLeg = Callable[[tuple[int, float], Engine, Sequence[Any], Sequence[Any], Any, float], Run]


class Leg(NamedTuple):
    """What is to be integrated without a break.

    begin, end: times; parameters: name -> number; numbers: those of the system.
    jumps: state -> number, new values at the beginning.
    """

    begin: float
    end: float
    parameters: Mapping[str, Any]
    numbers: Sequence[Any]
    jumps: Mapping[str, Any]


class Piece(NamedTuple):
    """One leg with what was computed.

    start: the states at its beginning, of the engine's kind, as a list; clock included.
    times, states: samples asked for, shapes (m,) and (m, size of the system).
    """

    leg: Leg
    start: Sequence[Any]
    run: Run
    times: Any
    states: Any


@dataclass(frozen=True, eq=False)
class Trip:
    """Pieces in order, and how it ended: "done", "stopped" or "stuck"."""

    flow: Flow
    engine: Engine
    tolerance: float
    pieces: tuple[Piece, ...]
    outcome: str
    reason: str

    @property
    def count(self) -> int:
        """Number of samples reached."""
        return sum([len(piece.times) for piece in self.pieces])

    @property
    def steps(self) -> int:
        """Steps of all pieces."""
        return sum([piece.run.steps for piece in self.pieces])

    @property
    def evaluations(self) -> int:
        """Evaluations of all pieces."""
        return sum([piece.run.evaluations for piece in self.pieces])

    @property
    def compile_seconds(self) -> float:
        """Time spent on compilation."""
        return sum([piece.run.compile_seconds for piece in self.pieces])

    @property
    def run_seconds(self) -> float:
        """Time spent on integration."""
        return sum([piece.run.run_seconds for piece in self.pieces])

    @property
    def reached(self) -> float:
        """The last time."""
        return float(self.pieces[-1].run.reached)

    @property
    def states(self) -> Any:
        """States at the samples, shape (m, size of the flow), of the engine's kind."""
        size = self.flow.size
        parts = [piece.states[:, :size] for piece in self.pieces]
        if len(parts) == 1:
            return parts[0]
        import numpy as np

        return np.concatenate(parts)


class Recipe(NamedTuple):
    """What is needed to make a trip again.

    grid: times from 0 on; cuts: whether it was cut into legs for a checkpoint.
    """

    engine: Engine
    tolerance: float
    grid: Any
    cuts: int

    def trip(self, flow: Flow) -> Trip:
        """The same trip once more."""
        legs = cut_legs(flow, float(self.grid[-1]), self.cuts)
        return travel(flow, self.engine, self.tolerance, self.grid, legs)

    def described(self) -> dict[str, Any]:
        """Everything but the grid, as text and numbers."""
        from geomtorsion.motion.flows.files import engine_text

        return {
            "engine": engine_text(self.engine),
            "tolerance": self.tolerance.hex(),
            "cuts": self.cuts,
        }


def cut_legs(flow: Flow, end: float, cuts: int) -> tuple[Leg, ...]:
    """The flow from 0 to a last time, cut into so many legs of equal length, and at switches."""
    return legs_of(flow, end, [end * k / cuts for k in range(1, cuts)] if end and cuts > 1 else ())


def legs_of(flow: Flow, end: float, breaks: Sequence[float] = ()) -> tuple[Leg, ...]:
    """The flow from 0 to a last time, cut at switches and at other breaks."""
    if not flow.switches and not breaks:
        return (Leg(0.0, end, flow.parameters, flow.numbers_of(flow.parameters), {}),)
    sign = -1.0 if end < 0 else 1.0
    parameters = dict(flow.parameters)
    table = {at: values for at, values in flow.switches if at == 0 or 0 < at * sign < end * sign}
    cuts = sorted({0.0, *table, *breaks}, key=lambda at: at * sign)
    found, names = [], flow.law.parameters
    numbers = None
    for k, begin in enumerate(cuts):
        values = table.get(begin, {})
        if numbers is None or any(name in values for name in names):
            parameters = parameters | {name: values[name] for name in values if name in names}
            numbers = flow.numbers_of(parameters)
        jumps = {name: value for name, value in values.items() if name not in names}
        last = cuts[k + 1] if k + 1 < len(cuts) else end
        found.append(Leg(begin, last, parameters, numbers, jumps))
    return tuple(found)


def travel(
    flow: Flow,
    engine: Engine,
    tolerance: float,
    grid: Any,
    legs: Sequence[Leg],
    run_leg: RunLeg | None = None,
    *,
    moved: float = 0.0,
) -> Trip:
    """Follow a flow through the times of a grid from 0 on.

    moved: the relative part by which start and numbers are moved, up and down in turn, to show how
    rounding grows.
    """
    import numpy as np

    size = flow.size
    plain = engine.precision == 53 and not moved and run_leg is None
    state: Sequence[Any] = flow.start_floats if plain else flow.start
    pieces: list[Piece] = []
    for k, leg in enumerate(legs):
        start = list(state[:size])
        for name, value in leg.jumps.items():
            start[flow.states.index(name)] = value
        numbers = flow.floats_of(leg.numbers) if plain else leg.numbers
        if moved:
            numbers = moved_by(numbers, engine, moved, exact_too=False)
            start = moved_by(start, engine, moved, exact_too=True) if k == 0 else start
        for places in flow.unit_places:
            make_unit(start, places, engine)
        if k and flow.room(leg.begin, start, leg.parameters) < 0:
            return Trip(flow, engine, tolerance, tuple(pieces), "stopped", "")
        if flow.law.clock:
            start.append(leg.begin / CLOCK)
        times, head, inside = samples_of(grid, legs, k)
        if run_leg is None:
            run = run_one(flow, engine, start, numbers, times, tolerance)
        else:
            run = run_leg((k, moved), engine, start, numbers, times, tolerance)
        count = min(len(run.times) - head, len(inside))
        outcome = {"edge": "stopped"}.get(run.outcome, run.outcome)
        pieces.append(
            Piece(leg, start, run, inside[:count], np.asarray(run.states)[head : head + count])
        )
        if run.outcome != "done":
            return Trip(flow, engine, tolerance, tuple(pieces), outcome, run.reason)
        state = list(run.last)
    return Trip(flow, engine, tolerance, tuple(pieces), "done", "")


def samples_of(grid: Any, legs: Sequence[Leg], k: int) -> tuple[Any, int, Any]:
    """Times for an engine in one leg, how many of them come first that nobody asked for (0 or 1),
    and those that are of the grid."""
    leg, final = legs[k], k + 1 == len(legs)
    if len(legs) == 1 and grid[0] == leg.begin and grid[-1] == leg.end:
        return grid, 0, grid
    import numpy as np

    sign = -1.0 if legs[-1].end < 0 else 1.0
    order = sign * grid
    first = int(np.searchsorted(order, sign * leg.begin, "left"))
    last = int(np.searchsorted(order, sign * leg.end, "right" if final else "left"))
    inside = grid[first:last]
    head = 0 if len(inside) and inside[0] == leg.begin else 1
    times = np.concatenate(([leg.begin], inside)) if head else inside
    if not final or times[-1] != leg.end:
        times = np.concatenate((times, [leg.end]))
    return times, head, inside


def run_one(
    flow: Flow,
    engine: Engine,
    start: Sequence[Any],
    numbers: Sequence[Any],
    times: Any,
    tolerance: float,
) -> Run:
    """One leg, ended where the flow stops."""
    system = flow.system
    if system.edge is None or isinstance(engine, Taylor):
        return engine.run(system, start, numbers, times, tolerance)
    run = engine.run(system, start, numbers, times, tolerance, dense=True)
    return run if run.dense is None else _ended_earlier(system, run, times, numbers)


def _ended_earlier(system: System, run: Run, times: Any, numbers: Sequence[Any]) -> Run:
    """A run by scipy, cut where it fell through the condition and rose again within one step."""
    import numpy as np

    from geomtorsion.motion.flows.zeros import places

    values, dense = [float(x) for x in numbers], run.dense
    assert dense is not None

    def room(at: Any) -> Any:
        return np.broadcast_to(system.edge_values(dense(at).T, values), len(at))

    begin, end = float(times[0]), float(run.reached)
    looked = places(begin, end, run)
    # The last place is where scipy itself has found the end.
    found = crossings(room, looked[:-1], room(looked[:-1]), -1)
    if not len(found):
        return replace(run, dense=None)
    sign = 1.0 if end >= begin else -1.0
    keep = sign * np.asarray(run.times) < sign * found[0]
    last = dense(found[:1])[0]
    return replace(
        run, times=run.times[keep], states=run.states[keep], reached=float(found[0]), last=last,
        outcome="edge", reason="", dense=None,
    )  # fmt: skip

"""Reading: outputs, invariants and dense states off a solved flow."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from geomtorsion.motion.flows.adjust import unit_rows

if TYPE_CHECKING:
    from geomtorsion.motion.flows.flow import Flow
    from geomtorsion.motion.flows.solution import FlowSolution


def arguments(flow: Flow, times: Any, states: Any) -> list[Any]:
    """What the tape of a flow is run on: states, parameters as they are at the times, times."""
    import numpy as np

    values: list[Any] = list(states.T)
    for name in flow.law.parameters:
        column: Any = float(flow.parameters[name])
        for at, table in flow.switches:
            if name in table and len(times):
                after = times >= at
                if after.any():
                    column = np.where(after, float(table[name]), column)
        values.append(column)
    return [*values, times]


def outputs(flow: Flow, times: Any, states: Any) -> dict[str, Any]:
    """Each output at the times, shape (m,) or (m, k)."""
    import numpy as np

    if not flow.outputs:
        return {}
    found = flow.tape.arrays(arguments(flow, times, states))
    place, table = 0, {}
    for name, parts in flow.shapes(flow.outputs):
        columns = [np.broadcast_to(x, len(times)) for x in found[place : place + max(parts, 1)]]
        table[name] = np.array(columns).T if parts else np.array(columns[0])
        place += max(parts, 1)
    return table


def drifts(solution: FlowSolution) -> dict[str, float]:
    """Largest relative change of each invariant between two switches."""
    import numpy as np

    flow, table = solution.flow, {}
    shapes = flow.shapes(flow.invariants)
    if not shapes or not len(solution.times):
        return {}
    skip = sum(max(parts, 1) for _, parts in flow.shapes(flow.outputs))
    times, states = solution.times, np.asarray(solution.states, dtype=float)
    start = np.array([[float(x) for x in flow.start]])
    if times[0] != 0 and not any(at == 0 for at, _ in flow.switches):
        times, states = np.concatenate(([0.0], times)), np.concatenate((start, states))
    values = arguments(flow, times, states)
    rows = [np.broadcast_to(x, len(times)) for x in flow.tape.arrays(values)[skip:]]
    sizes = [np.broadcast_to(x, len(times)) for x in flow.tape.sizes(values)[skip:]]
    marks = [at for at, _ in flow.switches]
    leg = np.searchsorted(marks, times, "right") if marks else np.zeros(len(times), dtype=int)
    place = 0
    for name, parts in shapes:
        count = max(parts, 1)
        total = np.array(rows[place : place + count])
        size = float(np.abs(np.array(sizes[place : place + count])).max())
        change = 0.0
        for k in np.unique(leg):
            part = total[:, leg == k]
            change = max(change, float(np.abs(part - part[:, :1]).max()))
        table[name] = change / size if size else change
        place += count
    return table


def dense_states(solution: FlowSolution, times: Any) -> Any:
    """States at any times, by integrating once more and keeping every step."""
    import numpy as np

    trip = solution.trip
    sign = -1.0 if float(solution.times[-1]) < 0 else 1.0
    begins = [sign * piece.leg.begin for piece in trip.pieces]
    place = np.clip(np.searchsorted(begins, sign * times, "right") - 1, 0, None)
    states = np.empty((len(times), trip.flow.size))
    for k in np.unique(place):
        index = np.flatnonzero(place == k)
        found = dense_piece(solution, int(k))(times[index])
        states[index] = np.asarray(found)[:, : trip.flow.size].astype(float)
    return unit_rows(trip.flow, states)


def dense_piece(solution: FlowSolution, k: int) -> Any:
    """Dense output of one piece."""
    import numpy as np

    kept = solution.__dict__.setdefault("_dense", {})
    if k not in kept:
        trip, piece = solution.trip, solution.trip.pieces[k]
        ends = np.array([piece.leg.begin, float(piece.run.reached)])
        if ends[0] == ends[1]:
            last = np.asarray(piece.run.last)
            kept[k] = lambda t: np.broadcast_to(last, (len(t), len(last)))
        else:
            kept[k] = trip.engine.run(
                trip.flow.system.without_edge,
                piece.start,
                piece.leg.numbers,
                ends,
                trip.tolerance,
                dense=True,
            ).dense
    return kept[k]


def columns(solution: FlowSolution) -> dict[str, Any]:
    """Named columns for tables."""
    flow = solution.flow
    table: dict[str, Any] = {flow.law.time: solution.times}
    for name in (*flow.states, *flow.outputs):
        value = solution[name]
        if value.ndim == 1:
            table[name] = value
        else:
            table |= {f"{name}[{k}]": value[:, k] for k in range(value.shape[1])}
    return table

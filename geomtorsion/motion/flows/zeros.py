"""Zeros: the times at which something read off a solved flow crosses zero."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from geomtorsion.errors import ExpressionError, UnknownNameError
from geomtorsion.motion.flows.reading import arguments, dense_states
from geomtorsion.motion.flows.roots import crossings
from geomtorsion.motion.flows.tape import Tape
from geomtorsion.motion.flows.terms import expression, symbol_table

if TYPE_CHECKING:
    import numpy as np

    from geomtorsion.motion.engines.protocol import Run
    from geomtorsion.motion.flows.solution import FlowSolution

# Places looked at in each step of the engine, and at least in each piece.
PER_STEP, FEWEST = 8, 64
# So many places are looked at together.
BLOCK = 65_536


def zeros(solution: FlowSolution, term: Any, direction: int = 0) -> np.ndarray:
    """Times at which a term crosses zero; see `FlowSolution.zeros`."""
    import numpy as np

    tape = _tape(solution, term)

    def function(times: Any) -> Any:
        states = dense_states(solution, times)
        (values,) = tape.arrays(arguments(solution.flow, times, states))
        return np.broadcast_to(values, len(times))

    found = [np.zeros(0)]
    for times in _stretches(solution):
        blocks = range(0, len(times), BLOCK)
        values = np.concatenate([function(times[k : k + BLOCK]) for k in blocks])
        if not np.isfinite(values).all():
            raise ExpressionError(
                f"{term!r} has no finite value at t = {times[~np.isfinite(values)][0]:.6g}."
            )
        found.append(crossings(function, times, values, direction))
    return np.concatenate(found)


def places(begin: float, end: float, run: Run) -> Any:
    """Times close enough to see what a run did."""
    import numpy as np

    count = max(PER_STEP * run.steps, run.evaluations, FEWEST, 4 * len(run.times))
    return np.linspace(begin, end, int(count) + 1)


def _tape(solution: FlowSolution, term: Any) -> Tape:
    """The term over states, parameters and time."""
    flow = solution.flow
    names = (*flow.states, *flow.law.parameters, flow.law.time)
    if isinstance(term, str) and term in flow.outputs:
        read = flow.outputs[term]
        if isinstance(read, tuple):
            raise UnknownNameError(
                f"{term} has {len(read)} components; give an expression of one number."
            )
        return Tape(names, (read,))
    return Tape(names, (expression(term, "zeros", symbol_table(names), smooth=False),))


def _stretches(solution: FlowSolution) -> list[Any]:
    """Times close enough to see each crossing, for each stretch without a switch."""
    import numpy as np

    stretches: list[list[Any]] = []
    for piece in solution.trip.pieces:
        begin, end = piece.leg.begin, float(piece.run.reached)
        if begin == end:
            continue
        times = places(begin, end, piece.run)
        if stretches and not any(at == begin for at, _ in solution.flow.switches):
            stretches[-1].append(times[1:])
        else:
            if stretches:
                # What is at the very time of a switch belongs to what comes after it.
                stretches[-1][-1][-1] = np.nextafter(begin, stretches[-1][-1][-2])
            stretches.append([times])
    return [np.concatenate(parts) for parts in stretches]

"""Zeros: the times at which something read off a solved flow crosses zero."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from geomtorsion.errors import ExpressionError, UnknownNameError
from geomtorsion.motion.flows.reading import arguments, dense_states
from geomtorsion.motion.flows.tape import Tape
from geomtorsion.motion.flows.terms import expression, symbol_table

if TYPE_CHECKING:
    import numpy as np

    from geomtorsion.motion.flows.solution import FlowSolution

# Places looked at in each step of the engine, and at least in each piece.
PER_STEP, FEWEST = 8, 64
# So many places are looked at together.
BLOCK = 65_536
# Halvings until a double is found.
HALVINGS = 60
# Two zeros may hide where a parabola through three places comes this near to zero.
NEAR = 0.3
# Golden sections until the lowest place between three is found.
SECTIONS = 80


def zeros(solution: FlowSolution, term: Any, direction: int = 0) -> np.ndarray:
    """Times at which a term crosses zero; see `FlowSolution.zeros`."""
    import numpy as np

    tape = _tape(solution, term)
    found = []
    for times in _runs(solution):
        values = np.concatenate(
            [_values(solution, tape, times[k : k + BLOCK]) for k in range(0, len(times), BLOCK)]
        )
        if not np.isfinite(values).all():
            raise ExpressionError(
                f"{term!r} has no finite value at t = {times[~np.isfinite(values)][0]:.6g}."
            )
        times, values = times[values != 0], values[values != 0]
        times, values = _with_lowest(solution, tape, times, values)
        crossing = np.flatnonzero(np.sign(values[:-1]) != np.sign(values[1:]))
        if direction:
            crossing = crossing[np.sign(values[crossing + 1]) == direction]
        low, high = times[crossing], times[crossing + 1]
        found.append(_bisected(solution, tape, low, high, np.sign(values[crossing])))
    return np.concatenate(found) if found else np.zeros(0)


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


def _runs(solution: FlowSolution) -> list[Any]:
    """Times close enough to see each crossing, for each stretch without a jump."""
    import numpy as np

    runs: list[list[Any]] = []
    for piece in solution.trip.pieces:
        begin, end = piece.leg.begin, float(piece.run.reached)
        if begin == end:
            continue
        run = piece.run
        count = max(PER_STEP * run.steps, run.evaluations, FEWEST, 4 * len(piece.times))
        times = np.linspace(begin, end, int(count) + 1)
        switched = any(at == begin for at, _ in solution.flow.switches)
        if runs and not switched:
            runs[-1].append(times[1:])
        else:
            runs.append([times])
    return [np.concatenate(parts) for parts in runs]


def _values(solution: FlowSolution, tape: Tape, times: Any) -> Any:
    """The term at times."""
    import numpy as np

    states = dense_states(solution, times)
    (values,) = tape.arrays(arguments(solution.flow, times, states))
    return np.broadcast_to(values, len(times))


def _with_lowest(solution: FlowSolution, tape: Tape, times: Any, values: Any) -> tuple[Any, Any]:
    """With the lowest place of each valley that may reach through zero between two places."""
    import numpy as np

    if len(values) < 3:
        return times, values
    left, middle, right = (np.abs(values[k : len(values) - 2 + k]) for k in range(3))
    same = (np.sign(values[:-2]) == np.sign(values[1:-1])) & (
        np.sign(values[2:]) == np.sign(values[1:-1])
    )
    bend = left - 2 * middle + right
    with np.errstate(all="ignore"):
        reach = middle - (right - left) ** 2 / (8 * bend)
    valley = same & (middle <= left) & (middle <= right) & (bend > 0) & (reach < NEAR * middle)
    place = np.flatnonzero(valley) + 1
    if not len(place):
        return times, values
    sign = np.sign(values[place])
    low, high = times[place - 1], times[place + 1]
    golden = (np.sqrt(5) - 1) / 2
    for _ in range(SECTIONS):
        first, second = high - golden * (high - low), low + golden * (high - low)
        one = sign * _values(solution, tape, first)
        two = sign * _values(solution, tape, second)
        # Once it is through, the place is kept in sight from both sides.
        left_side = one <= two
        high, low = np.where(left_side, second, high), np.where(left_side, low, first)
        if ((one < 0) | (two < 0)).all():
            break
    middle_times = (low + high) / 2
    through = sign * _values(solution, tape, middle_times) < 0
    extra = middle_times[through]
    order = np.argsort(np.concatenate((times, extra)), kind="stable")
    if times[0] > times[-1]:
        order = order[::-1]
    return (
        np.concatenate((times, extra))[order],
        np.concatenate((values, -sign[through]))[order],
    )


def _bisected(solution: FlowSolution, tape: Tape, low: Any, high: Any, sign: Any) -> Any:
    """The crossings between pairs of times, all at once."""
    import numpy as np

    if not len(low):
        return low
    for _ in range(HALVINGS):
        middle = low + (high - low) / 2
        if ((middle == low) | (middle == high)).all():
            break
        before = np.sign(_values(solution, tape, middle)) == sign
        low, high = np.where(before, middle, low), np.where(before, high, middle)
    return high

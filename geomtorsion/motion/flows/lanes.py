"""Lanes: equal flows with other numbers, through one batch integrator or one stacked system."""

from __future__ import annotations

from collections.abc import Mapping
from types import SimpleNamespace
from typing import TYPE_CHECKING, Any

from geomtorsion.errors import ShapeError, StartError, UnknownNameError
from geomtorsion.exact.names import near_names
from geomtorsion.motion.engines import Engine
from geomtorsion.motion.flows.adjust import unit_rows
from geomtorsion.motion.flows.intake import NEARLY_UNIT
from geomtorsion.motion.flows.law import CLOCK
from geomtorsion.motion.many import run_lanes

if TYPE_CHECKING:
    from geomtorsion.motion.flows.flow import Flow


def start_columns(flow: Flow, starts: Any) -> tuple[Any, dict[str, Any]]:
    """States (number, size), and parameters: name -> array (number,) or number."""
    import numpy as np

    parameters: dict[str, Any] = dict(flow.parameters)
    if not isinstance(starts, Mapping):
        states = _array("starts", starts)
        if states.ndim != 2 or states.shape[1] != flow.size or not len(states):
            raise ShapeError(
                f"starts: shape (number, {flow.size}) was needed, {states.shape} came."
            )
        return _made_unit(flow, states), parameters
    arrays = {}
    for name, values in starts.items():
        if name not in flow.states and name not in flow.law.parameters:
            near = near_names(name, (*flow.states, *flow.law.parameters))
            raise UnknownNameError(
                f"starts: {name} is no state and no parameter. "
                + (f"Did you mean {near}? " if near else "")
                + f"There are {', '.join((*flow.states, *flow.law.parameters))}."
            )
        arrays[name] = _array(f"starts of {name}", values)
    lengths = {name: array.shape for name, array in arrays.items() if array.ndim}
    if len(set(lengths.values())) != 1 or len(next(iter(lengths.values()))) != 1:
        raise ShapeError(f"starts: lists of one common length were needed, {lengths} came.")
    (number,) = next(iter(lengths.values()))
    if not number:
        raise StartError("starts: the lists are empty; give one number for each motion.")
    states = np.tile([float(x) for x in flow.start], (number, 1))
    for name, array in arrays.items():
        if name in flow.states:
            states[:, flow.states.index(name)] = array
        else:
            parameters[name] = array
    return _made_unit(flow, states), parameters


def _made_unit(flow: Flow, states: Any) -> Any:
    """Starts of length one where they should be."""
    import numpy as np

    for places, names in zip(flow.unit_places, flow.unit, strict=True):
        lengths = np.sqrt((states[:, places] ** 2).sum(axis=1))
        if (np.abs(lengths - 1) > NEARLY_UNIT).any():
            k = int(np.argmax(np.abs(lengths - 1)))
            raise StartError(
                f"starts[{k}]: {', '.join(names)} should have length 1 together, not "
                f"{lengths[k]:.9g}. Divide them by that."
            )
    return unit_rows(flow, states)


def _array(what: str, values: Any) -> Any:
    """Finite numbers."""
    import numpy as np

    try:
        array = np.asarray(values, dtype=float)
    except (TypeError, ValueError):
        raise ShapeError(f"{what}: numbers were needed, {values!r} came.") from None
    if not np.isfinite(array).all():
        raise StartError(f"{what}: a number is not finite.")
    return array


def only(value: Any, index: Any) -> Any:
    """Some of a list of numbers, or the one number for all."""
    return value[index] if getattr(value, "ndim", 0) else value


def _legs(flow: Flow, end: float) -> list[tuple[float, float, Mapping[str, Any]]]:
    """(begin, end, new values) between switches."""
    table = {at: values for at, values in flow.switches if at == 0 or at < end}
    cuts = sorted({0.0, *table})
    return [
        (begin, cuts[k + 1] if k + 1 < len(cuts) else end, table.get(begin, {}))
        for k, begin in enumerate(cuts)
    ]


def run_flows(
    flow: Flow,
    engine: Engine,
    states: Any,
    parameters: Mapping[str, Any],
    grid: Any,
    tolerance: float,
    show: Any,
) -> tuple[Any, Any, bool, float]:
    """States (number, times, size), which finished, whether interrupted, compile time."""
    import numpy as np

    size, number = flow.size, len(states)
    result = np.zeros((number, len(grid), size))
    finished, compiling, table = np.ones(number, dtype=bool), 0.0, dict(parameters)
    legs = _legs(flow, float(grid[-1]))
    for k, (begin, end, new) in enumerate(legs):
        table |= {name: value for name, value in new.items() if name not in flow.states}
        states = states.copy()
        for name, value in new.items():
            if name in flow.states:
                states[:, flow.states.index(name)] = float(value)
        with np.errstate(all="ignore"):
            states = unit_rows(flow, states)
        own = _numbers(flow, table, number)
        start = states
        if flow.law.clock:
            start = np.concatenate((states, np.full((number, 1), begin / CLOCK)), axis=1)
        lanes = SimpleNamespace(
            problem=None,
            equations=SimpleNamespace(system=flow.system, reduction=None),
            velocities=np.abs(start).sum(axis=1, keepdims=True),
            states=start,
            parameters=own,
            speeds=np.ones(number),
        )
        final = k + 1 == len(legs)
        inside = np.ones(len(grid), dtype=bool) if end < 0 else grid >= begin
        inside &= final | (grid < end)
        local = grid[inside] - begin
        times = np.unique(np.concatenate(([0.0], local, [end - begin])))
        if end < 0:
            times = times[::-1]
        # Flows have what a batch reads of its lanes, but no problem in a space.
        rows, done, interrupted, more = run_lanes(engine, lanes, times, tolerance, show)  # type: ignore[arg-type]
        compiling += more
        finished &= done
        place = np.searchsorted(np.abs(times), np.abs(local))
        result[:, inside] = rows[:, place, :size]
        states = rows[:, -1, :size]
        if interrupted:
            finished &= final
            break
    else:
        interrupted = False
    with np.errstate(all="ignore"):
        result = unit_rows(flow, result.reshape(-1, size)).reshape(result.shape)
    result[~finished] = 0.0
    return result, finished, interrupted, compiling


def _numbers(flow: Flow, table: Mapping[str, Any], number: int) -> Any:
    """The run-time numbers of the system for each motion, shape (number, parameters)."""
    import numpy as np

    names = flow.system.parameters
    if not names:
        return np.zeros((number, 0))
    varied = any(getattr(value, "ndim", 0) for value in table.values())
    values = [table[name] for name in flow.law.parameters]
    if not varied:
        return np.tile([float(x) for x in flow.law.numbers.exactly(values)], (number, 1))
    floats = [x if getattr(x, "ndim", 0) else float(x) for x in values]
    columns = flow.law.numbers.arrays(floats)
    return np.array([np.broadcast_to(x, number) for x in columns], dtype=float).T

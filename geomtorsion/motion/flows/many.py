"""Many: one flow from many starts, and with many values of its parameters, at once."""

from __future__ import annotations

import time
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from types import SimpleNamespace
from typing import TYPE_CHECKING, Any

from geomtorsion.errors import AccuracyError, ShapeError, StartError, TimeError, UnknownNameError
from geomtorsion.exact.names import near_names
from geomtorsion.motion.batch import CHECKED, batch_engine
from geomtorsion.motion.engines import Engine
from geomtorsion.motion.flows.solution import unknown
from geomtorsion.motion.flows.travel import unit_rows
from geomtorsion.motion.many import run_lanes
from geomtorsion.motion.progress import Bar
from geomtorsion.motion.solving import CAUTION, MARGIN, checked_accuracy, checked_times, tolerances

if TYPE_CHECKING:
    import numpy as np

    from geomtorsion.motion.flows.flow import Flow


@dataclass(frozen=True, eq=False)
class FlowBundle:
    """Many solved flows of one law.

    flow: what was solved, from many starts.
    times: shape (m,); starts: shape (number, size).
    parameters: name -> array (number,) or number, at the start.
    states: shape (number, m, size); zero where a motion is not finished.
    error: estimate of the largest relative error, from the motions that were solved twice.
    checked: how many those were.
    finished: shape (number,), which motions reached the last time.
    interrupted: whether it was stopped by Ctrl-C.
    engine, why, tolerance: what solved them.
    compile_seconds, run_seconds, check_seconds: apart.

    Examples
    --------
    >>> import numpy as np
    >>> from geomtorsion.motion import flow, solve_many
    >>> decay = flow({"x": "-k*x"}, [1], parameters={"k": 1}, outputs={"half": "x/2"})
    >>> many = solve_many(decay, {"k": np.array([1.0, 2.0])}, 1.0)
    >>> many["half"][:, -1].round(6).tolist()
    [0.18394, 0.067668]
    """

    flow: Flow
    times: np.ndarray
    starts: np.ndarray
    parameters: Mapping[str, Any]
    states: np.ndarray
    error: float
    checked: int
    finished: np.ndarray
    interrupted: bool
    engine: str
    why: str
    tolerance: float
    compile_seconds: float
    run_seconds: float
    check_seconds: float

    def __len__(self) -> int:
        return len(self.finished)

    def __getitem__(self, name: str) -> np.ndarray:
        """A state or an output by name, shape (number, m) or (number, m, k)."""
        names = self.flow.states
        if name in names:
            return self.states[..., names.index(name)]
        if name in self.flow.outputs:
            return self._read[name]
        raise UnknownNameError(unknown(name, (*names, *self.flow.outputs)))

    @cached_property
    def _read(self) -> dict[str, Any]:
        import numpy as np

        flow, shape = self.flow, self.states.shape[:2]
        values = [
            *np.moveaxis(self.states, -1, 0),
            *_parameter_columns(flow, self.parameters, self.times),
            self.times,
        ]
        found, place, table = flow.tape.arrays(values), 0, {}
        for name, parts in flow.shapes(flow.outputs):
            columns = [np.broadcast_to(x, shape) for x in found[place : place + max(parts, 1)]]
            table[name] = np.stack(columns, axis=-1) if parts else np.array(columns[0])
            place += max(parts, 1)
        return table

    def __str__(self) -> str:
        rate = self.finished.sum() / self.run_seconds if self.run_seconds else 0.0
        return (
            f"{self.finished.sum()} of {len(self)} flows by {self.engine} ({self.why}), "
            f"error below {self.error:.2g} in {self.checked} of them solved twice; "
            f"{self.run_seconds:.3g} s ({rate:.3g} per second), "
            f"compiled in {self.compile_seconds:.3g} s, checked in {self.check_seconds:.3g} s"
        )

    __repr__ = __str__


def solve_many_flows(
    flow: Flow,
    starts: Any,
    t: Any = None,
    accuracy: float = 1e-10,
    engine: Engine | None = None,
    *,
    check: int | None = CHECKED,
    progress: bool | None = None,
) -> FlowBundle:
    """Solve a flow from many starts; see `solve_many`."""
    import numpy as np

    accuracy = checked_accuracy(accuracy)
    if t is None:
        raise TimeError("t was not given; give the last time, or a list of times.")
    if flow.law.stop is not None:
        raise StartError(
            "flows with stop=... end at times of their own; solve them one by one, or leave stop "
            "out and use zeros."
        )
    times, grid = checked_times(t)
    if np.ndim(t) == 0 and len(grid) > 1:
        times, grid = times[-1:], np.array([0.0, float(times[-1])])
    solver, why = batch_engine(engine)
    states, parameters = _columns(flow, starts)
    number = len(states)
    few = np.unique(np.linspace(0, number - 1, min(check or number, number)).astype(int))
    began = time.perf_counter()
    steps = tolerances(accuracy * MARGIN, solver.finest)
    part = {name: _only(value, few) for name, value in parameters.items()}
    used = next(steps)
    before, good, _, compiling = _run(flow, solver, states[few], part, grid, used, None)
    error = np.inf
    for tolerance in steps:
        after, also, _, more = _run(flow, solver, states[few], part, grid, tolerance, None)
        compiling += more
        both = good & also
        if not both.any():
            raise StartError("none of the flows that were checked reaches the last time.")
        error = max(CAUTION * _worst(flow, before[both], after[both]), 2.0**-53)
        if error <= accuracy:
            break
        used, before, good = tolerance, after, also
    else:
        raise AccuracyError(
            f"accuracy {accuracy:.3g} was asked for; {solver.name} gets to {error:.2g} in double "
            "precision. Ask for less, or solve one by one with Taylor(precision=113)."
        )
    checked = time.perf_counter()
    show = Bar(number, progress)
    rows, finished, interrupted, more = _run(flow, solver, states, parameters, grid, used, show)
    show.close()
    ended = time.perf_counter()
    if len(times) != len(grid):
        rows = rows[:, 1:]
    return FlowBundle(
        flow, times, states, parameters, rows, error, len(few), finished, interrupted,
        solver.name, why, used, compiling + more, ended - checked - more,
        checked - began - compiling,
    )  # fmt: skip


def _columns(flow: Flow, starts: Any) -> tuple[Any, dict[str, Any]]:
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

    from geomtorsion.motion.flows.intake import NEARLY_UNIT

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


def _only(value: Any, index: Any) -> Any:
    return value[index] if getattr(value, "ndim", 0) else value


def _legs(flow: Flow, end: float) -> list[tuple[float, float, Mapping[str, Any]]]:
    """(begin, end, new values) between switches."""
    table = {at: values for at, values in flow.switches if at == 0 or at < end}
    cuts = sorted({0.0, *table})
    return [
        (begin, cuts[k + 1] if k + 1 < len(cuts) else end, table.get(begin, {}))
        for k, begin in enumerate(cuts)
    ]


def _run(
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
            start = np.concatenate((states, np.full((number, 1), begin)), axis=1)
        lanes = SimpleNamespace(
            problem=None,
            equations=SimpleNamespace(system=flow.system),
            velocities=np.abs(start).sum(axis=1, keepdims=True),
            states=start,
            parameters=own,
            speeds=np.ones(number),
        )
        final = k + 1 == len(legs)
        inside = (grid >= begin) & ((grid <= end) if final else (grid < end))
        local = grid[inside] - begin
        times = np.unique(np.concatenate(([0.0], local, [end - begin])))
        if end < 0:
            times = times[::-1]
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


def _parameter_columns(flow: Flow, parameters: Mapping[str, Any], times: Any) -> list[Any]:
    """Values of the parameters as they are at the times, to go with states (number, m)."""
    import numpy as np

    columns = []
    for name in flow.law.parameters:
        value = parameters[name]
        column: Any = value[:, None] if getattr(value, "ndim", 0) else float(value)
        for at, new in flow.switches:
            if name in new:
                column = np.where(times >= at, float(new[name]), column)
        columns.append(column)
    return columns


def _worst(flow: Flow, one: Any, two: Any) -> float:
    """Largest relative difference of any motion, block by block."""
    import numpy as np

    worst = 0.0
    for block in flow.system.blocks:
        index: Sequence[int] = [k for k in block if k < flow.size]
        if index:
            size = np.abs(one[..., index]).max(axis=(1, 2))
            gap = np.abs(one[..., index] - two[..., index]).max(axis=(1, 2))
            worst = max(worst, float((gap / np.where(size > 0, size, 1.0)).max()))
    return worst

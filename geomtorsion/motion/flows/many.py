"""Many: one flow from many starts, and with many values of its parameters, at once."""

from __future__ import annotations

import time
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING, Any

from geomtorsion.errors import AccuracyError, StartError, TimeError, UnknownNameError
from geomtorsion.motion.batch import CHECKED, batch_engine
from geomtorsion.motion.engines import Engine
from geomtorsion.motion.flows.lanes import only, run_flows, start_columns
from geomtorsion.motion.flows.solution import unknown
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
    states, parameters = start_columns(flow, starts)
    number = len(states)
    few = np.unique(np.linspace(0, number - 1, min(check or number, number)).astype(int))
    began = time.perf_counter()
    steps = tolerances(accuracy * MARGIN, solver.finest)
    part = {name: only(value, few) for name, value in parameters.items()}
    used = next(steps)
    before, good, _, compiling = run_flows(flow, solver, states[few], part, grid, used, None)
    error = np.inf
    for tolerance in steps:
        after, also, _, more = run_flows(flow, solver, states[few], part, grid, tolerance, None)
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
    rows, finished, interrupted, more = run_flows(
        flow, solver, states, parameters, grid, used, show
    )
    show.close()
    ended = time.perf_counter()
    if len(times) != len(grid):
        rows = rows[:, 1:]
    return FlowBundle(
        flow, times, states, parameters, rows, error, len(few), finished, interrupted,
        solver.name, why, used, compiling + more, ended - checked - more,
        checked - began - compiling,
    )  # fmt: skip


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

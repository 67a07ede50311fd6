"""Groups: lanes of a batch that one integrator takes, by smaller systems where these serve."""

from __future__ import annotations

import time
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from functools import partial
from typing import TYPE_CHECKING, Any

from geomtorsion.motion.engines.taylor import heyoka
from geomtorsion.motion.equations import Equations
from geomtorsion.motion.reduced.openings import Openings, openings
from geomtorsion.motion.system import System

if TYPE_CHECKING:
    from geomtorsion.motion.engines.taylor import Taylor
    from geomtorsion.motion.reduced.form import Reduction

Show = Callable[[int], None] | None
# Systems of at most so many states take two registers at a time.
FEW = 4
# After so many steps, one looks which lanes still get anywhere: by this part of their time.
MOST_STEPS, STANDSTILL = 20_000, 1e-9


@dataclass(frozen=True, eq=False)
class Group:
    """Lanes of equal equations.

    index: which of the batch they are.
    states, parameters: shapes (number, size of the system) and (number, parameters).
    speeds: by which their times are multiplied, shape (number,).
    full: (states of shape (number, times, size)) -> those of the full system.
    """

    index: Any
    system: System
    states: Any
    parameters: Any
    speeds: Any
    full: Callable[[Any], Any]


def groups(
    equations: Equations, system: System, states: Any, parameters: Any, speeds: Any
) -> Iterator[Group]:
    """All lanes, in the smaller system where that loses no digits, apart from the rest.

    system: that of the equations, or one of its variants without edge or margin.
    """
    import numpy as np

    rest = np.full(len(states), True)
    smaller = equations.reduction
    if smaller is not None:
        for part in openings(smaller, states.T, parameters.T):
            rest[part.index] = False
            own = smaller.watching(system, part.confined)
            full = partial(_widened, smaller, part)
            yield Group(part.index, own, part.start.T, part.values.T, speeds[part.index], full)
    if rest.any():
        index = np.flatnonzero(rest)
        yield Group(index, system, states[rest], parameters[rest], speeds[rest], _itself)


def _itself(states: Any) -> Any:
    return states


def _widened(smaller: Reduction, part: Openings, states: Any) -> Any:
    """Full states of lanes, of shape (number, times, size)."""
    found = smaller.abreast(states.transpose(1, 2, 0), part.numbers, part.confined)
    return found.transpose(2, 0, 1)


@dataclass(frozen=True, eq=False)
class Ran:
    """What a group came to.

    states: of the full system, shape (number, times, size).
    finished, crossed: which lanes came to the end, and which to an edge that was watched.
    """

    states: Any
    finished: Any
    crossed: Any
    interrupted: bool
    compile_seconds: float


def run_group(
    engine: Taylor, group: Group, pace: Any, grid: Any, tolerance: float, show: Show, before: int
) -> Ran:
    """All lanes of a group, some at a time, through heyoka's batch integrator.

    pace: by which lanes are sorted, as those of a call wait for the slowest.
    before: how many of the batch are done.
    """
    import numpy as np

    number, size = group.states.shape
    simd = int(heyoka().recommended_simd_size())
    width = 2 * simd if size <= FEW else simd
    compiled, compiling = engine.ready(group.system, tolerance, width)
    states = np.zeros((number, len(grid), size))
    finished, crossed = np.zeros(number, dtype=bool), np.zeros(number, dtype=bool)
    told = None if show is None else lambda done: show(before + done)
    interrupted = False
    try:
        with compiled.lock:
            watched = crossed if group.system.edge is not None else None
            calls = _in_calls(group, pace, grid, width)
            _run(compiled.integrator, calls, states, finished, watched, told)
    except KeyboardInterrupt:
        interrupted = True
    with np.errstate(all="ignore"):
        return Ran(group.full(states), finished, crossed, interrupted, compiling)


@dataclass(frozen=True, eq=False)
class _Calls:
    """Lanes in calls of the integrator: index, shape (calls * width,), and blocks, lanes last."""

    index: Any
    starts: Any
    states: Any
    parameters: Any
    times: Any


def _in_calls(group: Group, pace: Any, grid: Any, width: int) -> _Calls:
    """Lanes of like pace together, the last call filled up with the last lane."""
    import numpy as np

    number = len(group.states)
    order = np.argsort(pace)
    count = -(-number // width)
    index = order[np.minimum(np.arange(count * width), number - 1)]
    states, parameters = (
        _blocks(group.states[index], width),
        _blocks(group.parameters[index], width),
    )
    times = np.multiply.outer(grid, group.speeds[index]).reshape(len(grid), count, width)
    return _Calls(index, group.states, states, parameters, times)


def _blocks(array: Any, width: int) -> Any:
    """Rows of lanes as one contiguous block per call, lanes last."""
    import numpy as np

    blocks = array.reshape(len(array) // width, width, array.shape[1])
    return np.ascontiguousarray(blocks.swapaxes(1, 2))


def _run(
    integrator: Any,
    calls: _Calls,
    result: Any,
    finished: Any,
    crossed: Any,
    show: Show,
) -> None:
    """Fill in states of lanes that come to the end, and which those are."""
    import numpy as np

    index, (count, size, width) = calls.index, calls.states.shape
    own, pars, until = integrator.state, integrator.pars, integrator.propagate_until
    ends, clocks = calls.times[-1], np.zeros((count, width))
    several = len(calls.times) > 2
    found = np.zeros((count, len(calls.times) if several else 1, size, width))
    last, done = time.perf_counter(), 0
    # Lanes that have come to the edge in this call; heyoka keeps a copy of its own.
    hits = integrator.nt_events[0].callback.lanes if crossed is not None else set()
    # Beyond an edge steps may become as small as they like; without one, motions just go on.
    most = MOST_STEPS if crossed is not None else 0
    try:
        for k in range(count):
            own[:] = calls.states[k]
            if calls.parameters.shape[1]:
                pars[:] = calls.parameters[k]
            integrator.set_time(0.0)
            if several:
                block = np.ascontiguousarray(calls.times[:, k])
                rows = integrator.propagate_grid(block, max_steps=most)[1]
                found[k, : len(rows)] = rows
            else:
                until(ends[k], max_steps=most)
                if most and (integrator.time != ends[k]).any():
                    _go_on(integrator, ends[k], hits, most)
                found[k, 0] = own
            clocks[k] = integrator.time
            if hits and crossed is not None:
                crossed[index[k * width + np.array(sorted(hits))]] = True
                hits.clear()
            done = k + 1
            if show is not None and time.perf_counter() - last > 0.2:
                last = time.perf_counter()
                show(min(done * width, len(result)))
    finally:
        # Also after Ctrl-C: what is done is kept.
        arrived = (clocks == ends) & np.isfinite(found).all(axis=(1, 2))
        arrived[done:] = False
        good = arrived.reshape(-1)
        rows = found.transpose(0, 3, 1, 2).reshape(count * width, found.shape[1], -1)
        finished[index[good]] = True
        if several:
            result[index[good]] = rows[good]
        else:
            result[index[good], 0] = calls.starts[index[good]]
            result[index[good], -1] = rows[good, 0]


def _go_on(integrator: Any, ends: Any, crossed: set[int], most: int) -> None:
    """Go on until all lanes have arrived, have crossed an edge or get no further.

    most: steps between two looks.
    """
    import numpy as np

    moved = np.full(len(ends), True)
    while True:
        waiting = [
            lane
            for lane, result in enumerate(integrator.propagate_res)
            if result[0] == type(result[0]).step_limit and lane not in crossed
        ]
        if not moved[waiting].any():
            return
        before = integrator.time.copy()
        integrator.propagate_until(ends, max_steps=most)
        moved = np.abs(integrator.time - before) > STANDSTILL * np.abs(ends)

"""Joint runs: the same equations from several starts, each to a tolerance of its own, in one batch.

A processor adds four pairs of doubles as fast as one, and compiling one integrator takes half the
time of two: so an answer and the finer runs that tell its error share an integrator. heyoka leaves
out of a series what is small beside the largest state; here that is a constant of each column.
"""

from __future__ import annotations

import time
from collections.abc import Sequence

import numpy as np

from geomtorsion.ode.engines.protocol import STEPS_AT_ONCE, Engine, Run
from geomtorsion.ode.engines.taylor import Taylor
from geomtorsion.ode.scaling import units_of
from geomtorsion.ode.system import System
from geomtorsion.ode.trajectory import Segment, Stage, Trajectory, is_beyond

# Doubles in a register of today's processors.
WIDTH = 4


def side_by_side(
    stages: Sequence[Stage], times: np.ndarray, tolerances: Sequence[float], engine: Engine
) -> list[Trajectory]:
    """Motions by equal equations in one batch; none where they have to go one by one.

    That is with other engines, where an event comes in between, where numbers are far from one,
    and where `run_jointly` says so. The times begin with the stages and go on.
    """
    first, duration = stages[0], abs(float(times[-1] - times[0]))
    system, timed = first.system, first.timed
    if not isinstance(engine, Taylor) or engine.precision != 53 or not duration:
        return []
    if timed is not None and timed.when is not None and abs(timed.when) < abs(times[-1]):
        return []
    starts, numbers = ([getattr(x, name) for x in stages] for name in ("start", "parameters"))
    if units_of(system, starts[0], numbers[0], duration, first.extents) is not None:
        return []
    # A start that loses digits as a momentum may do so only where it is perturbed.
    if any(stage.system is not system for stage in stages):
        return []
    size = max(1.0, first.reach(duration))
    runs = run_jointly(engine, system, starts, numbers, times, tolerances, size)
    pairs = zip(runs, numbers, strict=False)
    if not system.guard_is_entire and any(is_beyond(system, run, own) for run, own in pairs):
        return []
    parts = zip(stages, runs, tolerances, strict=False)
    return [
        Trajectory(engine, tolerance, (Segment(stage, run, 0, len(times)),), "done")
        for stage, run, tolerance in parts
    ]


def run_jointly(
    engine: Taylor,
    system: System,
    starts: Sequence[np.ndarray],
    parameters: Sequence[np.ndarray],
    times: np.ndarray,
    tolerances: Sequence[float],
    size: float,
) -> list[Run]:
    """A run for each of up to WIDTH starts; none where they have to run one by one.

    That is where one meets the guard, where steps or times are many, or where states grow so
    far above `size`, which is what tolerances are relative to, that runs to different tolerances
    would take the same steps.
    """
    if len(times) > STEPS_AT_ONCE:
        return []
    finest = min(tolerances)
    backward = bool(times[-1] < times[0])
    kept, compiling = engine.compiled(
        system, finest, width=WIDTH, optimised=False, measured=True, backward=backward
    )
    # Columns without a use repeat the first.
    order = [k if k < len(starts) else 0 for k in range(WIDTH)]
    with kept.lock:
        began = time.perf_counter()
        integrator = kept.integrator
        integrator.set_time(float(times[0]))
        integrator.state[:-1] = np.array([starts[k] for k in order]).T
        integrator.state[-1] = [size * tolerances[k] / finest for k in order]
        if len(integrator.pars):
            pars = system.with_constants(np.array([parameters[k] for k in order])).T
            integrator.pars[:] = pars[: len(integrator.pars)]
        if integrator.with_events:
            integrator.reset_cooldowns()
        grid = times.repeat(WIDTH).reshape(-1, WIDTH)
        rows = integrator.propagate_grid(grid, max_steps=STEPS_AT_ONCE)[1]
        results = integrator.propagate_res
        spent = time.perf_counter() - began
    if [x[0] for x in results] != [type(results[0][0]).time_limit] * WIDTH:
        return []
    states = np.ascontiguousarray(rows[:, :-1].transpose(2, 0, 1))
    # Steps are measured by states that are larger than `size` in each column; finer runs are to
    # leave out half as much at least.
    if 2 * np.abs(states[0]).max() > size * max(tolerances) / finest:
        return []
    runs = []
    for k in range(len(starts)):
        steps = int(results[k][3])
        runs.append(
            Run(
                times, states[k], times[-1], states[k, -1], "done", steps,
                steps * (integrator.order + 1), 0.0 if k else compiling, 0.0 if k else spent,
            )
        )  # fmt: skip
    return runs

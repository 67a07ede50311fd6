"""Dispatch: one name for solving motions in spaces and flows."""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING, Any, overload

from geomtorsion.errors import StartError
from geomtorsion.motion import solving
from geomtorsion.motion.engines import Engine
from geomtorsion.motion.flows.flow import Flow
from geomtorsion.motion.flows.solution import FlowSolution
from geomtorsion.motion.flows.solving import solve_flow
from geomtorsion.motion.problem import Problem
from geomtorsion.motion.solution import Solution

if TYPE_CHECKING:
    from pathlib import Path

Progress = Callable[[float], None]


@overload
def solve(
    problem: Problem, t: Any, accuracy: float = 1e-10, engine: Engine | None = None
) -> Solution: ...
@overload
def solve(
    problem: Flow,
    t: Any,
    accuracy: float = 1e-10,
    engine: Engine | None = None,
    checkpoint: str | Path | None = None,
    progress: Progress | None = None,
    *,
    overwrite: bool = False,
) -> FlowSolution: ...
def solve(
    problem: Problem | Flow,
    t: Any,
    accuracy: float = 1e-10,
    engine: Engine | None = None,
    checkpoint: str | Path | None = None,
    progress: Progress | None = None,
    *,
    overwrite: bool = False,
) -> Solution | FlowSolution:
    """Solve a motion so that the result, not each step, is as accurate as asked.

    The error is measured against an independent integration with a smaller tolerance; the
    tolerance goes down until the error is below the accuracy.

    Parameters
    ----------
    problem
        from `autoparallel`, `geodesic`, ...; or any first-order equations, from `flow`.
    t
        last time, or increasing (or decreasing) times from 0 on; the motion starts at t = 0.
    accuracy
        largest error, relative to the size of the solution (see `Solution.error`).
    engine
        Taylor(), RungeKutta() or Stiff(); None chooses and says why.
    checkpoint
        (flows) a file into which the run is written as it goes; a later call with the same flow,
        times, accuracy and engine goes on from there, to the same result.
    progress
        (flows) called with the part that is done, from 0 to 1.

    Raises
    ------
    AccuracyError
        accuracy <= 0, or not to be had with this engine.
    TimeError
        times are empty, repeated, unsorted, not finite or on both sides of 0.
    ChartEdgeError, StuckError
        the motion ran out of its last chart, or cannot go on; the error carries what was computed.
    CheckpointError
        the file is the checkpoint of another run.

    Examples
    --------
    >>> from geomtorsion.motion import RungeKutta, flow, solve
    >>> sol = solve(flow({"x": "-x"}, [1]), 1.0, accuracy=1e-8, engine=RungeKutta())
    >>> round(float(sol["x"][-1]), 8)
    0.36787944
    """
    if isinstance(problem, Flow):
        return solve_flow(problem, t, accuracy, engine, checkpoint, progress, overwrite=overwrite)
    if not isinstance(problem, Problem):
        raise StartError(
            f"solve: a problem (autoparallel, geodesic, ...) or a flow was needed, {problem!r} "
            "came."
        )
    if checkpoint is not None or progress is not None:
        raise StartError("checkpoint and progress are for flows; leave them out for this problem.")
    return solving.solve(problem, t, accuracy, engine)

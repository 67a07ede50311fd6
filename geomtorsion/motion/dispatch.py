"""Dispatch: one name for solving motions in spaces and flows."""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING, Any, overload

from geomtorsion.errors import StartError
from geomtorsion.motion import batch, solving
from geomtorsion.motion.batch import CHECKED, Bundle
from geomtorsion.motion.engines import Engine
from geomtorsion.motion.flows.flow import Flow
from geomtorsion.motion.flows.many import FlowBundle, solve_many_flows
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

    Each answer comes with its error: the same motion with longer steps, and from starts that are
    one unit in the last place away, runs beside the answer (in one pass where heyoka is
    installed), and how far these come apart tells it. The tolerance goes down until the error is
    below the accuracy.

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
    _check_engine(engine)
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


@overload
def solve_many(
    problem: Problem,
    starts: Any = None,
    t: Any = None,
    accuracy: float = 1e-10,
    engine: Engine | None = None,
    *,
    velocities: Any = None,
    frame_velocities: Any = None,
    check: int | None = CHECKED,
    progress: bool | None = None,
) -> Bundle: ...
@overload
def solve_many(
    problem: Flow,
    starts: Any = None,
    t: Any = None,
    accuracy: float = 1e-10,
    engine: Engine | None = None,
    *,
    check: int | None = CHECKED,
    progress: bool | None = None,
) -> FlowBundle: ...
def solve_many(
    problem: Problem | Flow,
    starts: Any = None,
    t: Any = None,
    accuracy: float = 1e-10,
    engine: Engine | None = None,
    *,
    velocities: Any = None,
    frame_velocities: Any = None,
    check: int | None = CHECKED,
    progress: bool | None = None,
) -> Bundle | FlowBundle:
    """Solve one problem, or one flow, from many starts at once.

    Parameters
    ----------
    problem
        gives the law and whatever the lists below leave out.
    starts
        q^mu, shape (number, n); for flows all states, shape (number, size), or a mapping from
        states and parameters to lists of numbers.
    t
        last time (only the end is kept), or times.
    accuracy
        as in `solve`, for every motion that is checked.
    engine
        Taylor() or RungeKutta(); None chooses.
    velocities, frame_velocities
        (not for flows) q'^mu or u^i, shape (number, n); None: all with that of the problem.
    check
        how many motions, evenly spread, are solved twice for the error; None: all.
    progress
        show a bar; None: on a terminal, for long work.

    Ctrl-C returns what is finished.

    Raises
    ------
    StartError, ShapeError, UnknownNameError
        lists of different length or shape, numbers that are not finite, or unknown names.
    AccuracyError
        the accuracy is not reached by the motions that are checked.

    Examples
    --------
    >>> from geomtorsion.motion import flow, solve_many
    >>> swing = flow({"x": "v", "v": "-k*x"}, [1, 0], parameters={"k": 1})
    >>> solve_many(swing, {"k": [1.0, 4.0]}, 1.0)["x"][:, -1].round(6).tolist()
    [0.540302, -0.416147]
    """
    _check_engine(engine)
    if isinstance(problem, Flow):
        if velocities is not None or frame_velocities is not None:
            raise StartError("velocities: a flow has states only; give all of them in starts.")
        return solve_many_flows(
            problem, starts, t, accuracy, engine, check=check, progress=progress
        )
    return batch.solve_many(
        problem,
        starts,
        t,
        accuracy,
        engine,
        velocities=velocities,
        frame_velocities=frame_velocities,
        check=check,
        progress=progress,
    )


def _check_engine(engine: Any) -> None:
    """Refuse what cannot run a motion, such as the name of an engine."""
    if engine is not None and (isinstance(engine, type) or not callable(getattr(engine, "run", 0))):
        raise StartError(
            f"engine = {engine!r}: Taylor(), RungeKutta() or Stiff() was needed, or None, which "
            "chooses."
        )

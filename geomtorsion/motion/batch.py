"""Batch: many motions of one problem at once."""

from __future__ import annotations

import time
from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING, Any

from geomtorsion.errors import AccuracyError, StartError, TimeError
from geomtorsion.motion import reading
from geomtorsion.motion.across import apart, at_home, passage
from geomtorsion.motion.checking import CAUTION
from geomtorsion.motion.engines import Engine, RungeKutta, Taylor
from geomtorsion.motion.engines.taylor import is_available
from geomtorsion.motion.journey import Journey
from geomtorsion.motion.lists import start_lists
from geomtorsion.motion.many import Lanes
from geomtorsion.motion.problem import Problem
from geomtorsion.motion.progress import Bar
from geomtorsion.motion.solving import MARGIN, checked_accuracy, checked_times, tolerances

if TYPE_CHECKING:
    import numpy as np

# So many motions, spread over all, are solved twice for the error estimate.
CHECKED = 48


@dataclass(frozen=True, eq=False)
class Bundle:
    """Many solved motions.

    problem: what was solved, from many starts.
    times: shape (m,).
    error: estimate of the largest relative error, from the motions that were solved twice.
    checked: how many those were.
    finished: shape (number,), which motions reached the last time.
    interrupted: whether it was stopped by Ctrl-C.
    engine, why, tolerance: what solved them.
    compile_seconds, run_seconds, check_seconds: apart.
    lanes, states: starts and states in the chart of the batch, zero where it was left.
    journeys: number -> journey, for motions that went on in other charts.

    Examples
    --------
    >>> from geomtorsion.motion import geodesic, solve_many
    >>> from geomtorsion.spaces import load
    >>> top = geodesic(load("so3").frame, frame_velocity=[1, 0, 0], metric=[1, 2, 3])
    >>> many = solve_many(top, t=5.0, frame_velocities=[[1, 0.1, 0], [0, 1, 0.1], [0, 0, 1]])
    >>> many.frame_velocity.shape, bool(many.finished.all())
    ((3, 1, 3), True)
    """

    problem: Problem
    times: np.ndarray
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
    lanes: Lanes
    states: np.ndarray
    journeys: Mapping[int, Journey]

    def __len__(self) -> int:
        return len(self.finished)

    @cached_property
    def frame_velocity(self) -> np.ndarray:
        """u^i, shape (number, m, n); zero where a motion is not finished."""
        return self._home[1]

    @cached_property
    def coordinates(self) -> np.ndarray:
        """q^mu in the chart of the problem, shape (number, m, n); see `finished`.

        Not a number for a motion that went where this chart does not reach; see `journeys`.
        """
        return self._home[0]

    @cached_property
    def _home(self) -> tuple[np.ndarray, np.ndarray]:
        import numpy as np

        problem, lanes = self.problem, self.lanes
        width, n = lanes.equations.width, problem.frame.dimension
        number, m = len(self), len(self.times)
        q = np.zeros((number, m, n if width else 0))
        u = np.zeros((number, m, n))
        done = self.finished.copy()
        done[list(self.journeys)] = False
        states = self.states[done]
        if lanes.equations.moves:
            u[done] = states[..., width : width + n] * lanes.speeds[done, None, None]
        else:
            u[done] = (lanes.velocities * lanes.speeds[:, None])[done, None, :]
        if width:
            there = states[..., :width].reshape(-1, width)
            turned = u[done].reshape(-1, n)
            home = problem.atlas.home
            if lanes.chart != home:
                there, turned = reading.converted(problem, lanes.chart, home, there, turned)
            q[done], u[done] = there.reshape(-1, m, n), turned.reshape(-1, m, n)
        for k, journey in self.journeys.items():
            q[k], u[k] = at_home(journey, journey.count - m) or (np.nan, np.nan)
        return q, u

    def __str__(self) -> str:
        rate = self.finished.sum() / self.run_seconds if self.run_seconds else 0.0
        return (
            f"{self.finished.sum()} of {len(self)} motions by {self.engine} ({self.why}), "
            f"error below {self.error:.2g} in {self.checked} of them solved twice; "
            f"{self.run_seconds:.3g} s ({rate:.3g} per second), "
            f"compiled in {self.compile_seconds:.3g} s, checked in {self.check_seconds:.3g} s"
        )

    __repr__ = __str__


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
) -> Bundle:
    """Solve one problem from many starts at once.

    Parameters
    ----------
    problem
        gives the law and whatever the lists below leave out.
    starts
        q^mu, shape (number, n); None: all from the start of the problem.
    t
        last time (only the end is kept), or times.
    accuracy
        as in `solve`, for every motion that is checked.
    velocities, frame_velocities
        q'^mu or u^i, shape (number, n); None: all with the velocity of the problem.
    check
        how many motions, evenly spread, are solved twice for the error; None: all.
    progress
        show a bar; None: on a terminal, for long work.

    Ctrl-C returns what is finished.

    Raises
    ------
    StartError, ShapeError
        lists of different length or shape, or numbers that are not finite.
    AccuracyError
        the accuracy is not reached by the motions that are checked.

    Examples
    --------
    >>> from geomtorsion.motion import geodesic, solve_many
    >>> from geomtorsion.spaces import load
    >>> p = geodesic(load("flat_polar").frame, [1.0, 0.0], [0.0, 1.0])
    >>> many = solve_many(p, [[1.0, 0.0], [2.0, 0.0]], 1.0)
    >>> many.coordinates[:, -1, 0].round(6).tolist()
    [1.414214, 2.236068]
    """
    import numpy as np

    accuracy = checked_accuracy(accuracy)
    if t is None:
        raise TimeError("t was not given; give the last time, or a list of times.")
    times, grid = checked_times(t)
    if np.ndim(t) == 0 and len(grid) > 1:
        times, grid = times[-1:], np.array([0.0, float(times[-1])])
    solver, why = batch_engine(engine)
    place, speed = start_lists(problem, starts, velocities, frame_velocities)
    lanes = Lanes.laid_out(problem, place, speed)
    number = len(lanes.velocities)
    few = np.unique(np.linspace(0, number - 1, min(check or number, number)).astype(int))
    began = time.perf_counter()
    tolerance, error, compiling = _tolerance(solver, lanes, grid, few, accuracy)
    checked = time.perf_counter()
    show = Bar(number, progress)
    found = passage(solver, lanes, grid, tolerance, show)
    more = found.compile_seconds
    ended = time.perf_counter()
    show.close()
    states = found.states[:, 1:] if len(times) != len(grid) else found.states
    return Bundle(
        problem,
        times,
        error,
        len(few),
        found.finished,
        found.interrupted,
        solver.name,
        why,
        tolerance,
        compiling + more,
        ended - checked - more,
        checked - began - compiling,
        lanes,
        states,
        found.journeys,
    )


def batch_engine(engine: Engine | None) -> tuple[Engine, str]:
    """The engine asked for, or the fastest at hand."""
    if engine is not None:
        if engine.precision != 53 or isinstance(engine, Taylor | RungeKutta) is False:
            raise AccuracyError(
                f"batches run in double precision by Taylor() or RungeKutta(); {engine.name} came."
            )
        return engine, "as asked"
    if is_available():
        return Taylor(), "heyoka is installed: several motions in one instruction"
    return RungeKutta(), "heyoka is not installed: motions stacked into one system"


def _tolerance(
    engine: Engine, lanes: Lanes, grid: Any, few: Any, accuracy: float
) -> tuple[float, float, float]:
    """The tolerance with which the checked motions are accurate enough; error; compile time."""
    import numpy as np

    some = lanes.only(few)
    steps = tolerances(accuracy * MARGIN, engine.finest)
    used = next(steps)
    before = passage(engine, some, grid, used, None)
    compiling, error = before.compile_seconds, np.inf
    for tolerance in steps:
        after = passage(engine, some, grid, tolerance, None)
        compiling += after.compile_seconds
        gap, compared = apart(some, before, after)
        if not compared:
            raise StartError("none of the motions that were checked reaches the last time.")
        error = max(CAUTION * gap, 2.0**-53)
        if error <= accuracy:
            return used, error, compiling
        used, before = tolerance, after
    raise AccuracyError(
        f"accuracy {accuracy:.3g} was asked for; {engine.name} gets to {error:.2g} in double "
        "precision. Ask for less, or solve one by one with Taylor(precision=113)."
    )

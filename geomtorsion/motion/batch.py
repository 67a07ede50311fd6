"""Batch: many motions of one problem at once."""

from __future__ import annotations

import sys
import time
from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING, Any

from geomtorsion.errors import AccuracyError, ShapeError, StartError, TimeError
from geomtorsion.motion import reading
from geomtorsion.motion.engines import Engine, RungeKutta, Taylor
from geomtorsion.motion.engines.taylor import is_available
from geomtorsion.motion.many import Lanes, run_lanes
from geomtorsion.motion.problem import Problem
from geomtorsion.motion.solving import CAUTION, MARGIN, checked_accuracy, checked_times, tolerances

if TYPE_CHECKING:
    import numpy as np

# So many motions, spread over all, are solved twice for the error estimate.
CHECKED = 48
# Progress is shown for work that takes longer than this, in seconds.
PATIENCE = 2.0


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

    def __len__(self) -> int:
        return len(self.finished)

    @cached_property
    def frame_velocity(self) -> np.ndarray:
        """u^i, shape (number, m, n); zero where a motion is not finished."""
        return self._home[1]

    @cached_property
    def coordinates(self) -> np.ndarray:
        """q^mu in the chart of the problem, shape (number, m, n); see `finished`."""
        return self._home[0]

    @cached_property
    def _home(self) -> tuple[np.ndarray, np.ndarray]:
        import numpy as np

        problem, lanes = self.problem, self.lanes
        width, n = lanes.equations.width, problem.frame.dimension
        number, m = len(self), len(self.times)
        q = np.zeros((number, m, n if width else 0))
        u = np.zeros((number, m, n))
        done = self.finished
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
    solver, why = _engine(engine)
    place, speed = _lists(problem, starts, velocities, frame_velocities)
    lanes = Lanes.laid_out(problem, place, speed)
    number = len(lanes.velocities)
    few = np.unique(np.linspace(0, number - 1, min(check or number, number)).astype(int))
    began = time.perf_counter()
    tolerance, error, compiling = _tolerance(solver, lanes, grid, few, accuracy)
    checked = time.perf_counter()
    show = _Bar(number, progress)
    states, finished, interrupted, more = run_lanes(solver, lanes, grid, tolerance, show)
    ended = time.perf_counter()
    show.close()
    if len(times) != len(grid):
        states = states[:, 1:]
    return Bundle(
        problem,
        times,
        error,
        len(few),
        finished,
        interrupted,
        solver.name,
        why,
        tolerance,
        compiling + more,
        ended - checked - more,
        checked - began - compiling,
        lanes,
        states,
    )


def _engine(engine: Engine | None) -> tuple[Engine, str]:
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


def _lists(problem: Problem, starts: Any, velocities: Any, frame_velocities: Any) -> Any:
    """Coordinates (or None) and frame velocities, both with one row per motion."""
    import numpy as np

    n = problem.frame.dimension
    given = {"starts": starts, "velocities": velocities, "frame_velocities": frame_velocities}
    if velocities is not None and frame_velocities is not None:
        raise StartError("velocities and frame_velocities were both given; give one of them.")
    arrays = {key: _rows(value, n, key) for key, value in given.items() if value is not None}
    if not arrays:
        raise StartError("give starts, velocities or frame_velocities: one row per motion.")
    counts = {key: len(value) for key, value in arrays.items()}
    if len(set(counts.values())) > 1:
        raise ShapeError(f"lists of different length came: {counts}. Give one row per motion.")
    number = next(iter(counts.values()))
    place = arrays.get("starts")
    if problem.start is None and place is not None:
        raise StartError("the problem follows velocities alone; make it with a start.")
    if place is None and problem.start is not None:
        place = np.tile([float(x) for x in problem.start], (number, 1))
    if "velocities" in arrays:
        if place is None:
            raise StartError("velocities need coordinates; give frame_velocities.")
        speed = _in_frame(problem, place, arrays["velocities"])
    else:
        own = np.tile([float(x) for x in problem.frame_velocity], (number, 1))
        speed = arrays.get("frame_velocities", own)
    return place, speed


def _rows(values: Any, n: int, what: str) -> Any:
    """An array of shape (number, n) of finite numbers."""
    import numpy as np

    try:
        array = np.asarray(values, dtype=float)
    except (TypeError, ValueError):
        raise ShapeError(f"{what}: rows of {n} numbers were needed.") from None
    if array.ndim != 2 or array.shape[1] != n or not len(array):
        raise ShapeError(f"{what}: shape (number, {n}) was needed, {array.shape} came.")
    if not np.isfinite(array).all():
        row, column = (int(k) for k in np.argwhere(~np.isfinite(array))[0])
        raise StartError(f"{what}[{row}, {column}] = {array[row, column]} is not finite.")
    return array


def _in_frame(problem: Problem, place: Any, rates: Any) -> Any:
    """u^i = e^i_mu q'^mu for many points."""
    import numpy as np

    from geomtorsion.motion.system import evaluated

    values: dict[str, Any] = dict(zip(problem.coordinates, place.T, strict=True))
    values |= {key: float(value) for key, value in problem.parameters.items()}
    result = np.zeros(place.shape)
    for (i, mu), value in problem.frame.coframe.components.nonzero.items():
        result[:, i] += evaluated([((value, ()),)], values)[0] * rates[:, mu]
    return result


def _tolerance(
    engine: Engine, lanes: Lanes, grid: Any, few: Any, accuracy: float
) -> tuple[float, float, float]:
    """The tolerance with which the checked motions are accurate enough; error; compile time."""
    import numpy as np

    some = lanes.only(few)
    steps = tolerances(accuracy * MARGIN, engine.finest)
    used = next(steps)
    before, good, _, compiling = run_lanes(engine, some, grid, used, None)
    error = np.inf
    for tolerance in steps:
        after, also, _, more = run_lanes(engine, some, grid, tolerance, None)
        compiling += more
        both = good & also
        if not both.any():
            raise StartError("none of the motions that were checked reaches the last time.")
        error = max(CAUTION * _worst(lanes, before[both], after[both]), 2.0**-53)
        if error <= accuracy:
            return used, error, compiling
        used, before, good = tolerance, after, also
    raise AccuracyError(
        f"accuracy {accuracy:.3g} was asked for; {engine.name} gets to {error:.2g} in double "
        "precision. Ask for less, or solve one by one with Taylor(precision=113)."
    )


def _worst(lanes: Lanes, one: Any, two: Any) -> float:
    """Largest relative difference of any motion, block by block."""
    import numpy as np

    worst = 0.0
    for block in lanes.equations.system.blocks:
        index = slice(block[0], block[-1] + 1)
        size = np.abs(one[..., index]).max(axis=(1, 2))
        gap = np.abs(one[..., index] - two[..., index]).max(axis=(1, 2))
        ratio = gap / np.where(size > 0, size, 1.0)
        worst = max(worst, float(ratio.max()))
    return worst


class _Bar:
    """A bar on the terminal, shown for long work only."""

    def __init__(self, number: int, wanted: bool | None) -> None:
        self.number = number
        self.shown = False
        self.wanted = sys.stderr.isatty() if wanted is None else wanted
        self.began = self.last = time.perf_counter()
        self.patience = 0.0 if wanted else PATIENCE

    def __call__(self, done: int) -> None:
        now = time.perf_counter()
        if self.wanted and now - self.began >= self.patience and now - self.last > 0.2:
            part = int(40 * done / self.number)
            sys.stderr.write(f"\r[{'=' * part}{' ' * (40 - part)}] {done} of {self.number}")
            sys.stderr.flush()
            self.shown, self.last = True, now

    def close(self) -> None:
        """End the line."""
        if self.shown:
            sys.stderr.write("\n")

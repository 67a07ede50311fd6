"""Solution: a motion that was solved, with its error, its cost and everything read off it."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING, Any

from geomtorsion.errors import TimeError, UnknownNameError
from geomtorsion.motion import measures, reading
from geomtorsion.motion.between import error_between
from geomtorsion.motion.checking import CAUTION

if TYPE_CHECKING:
    from pathlib import Path

    import numpy as np

    from geomtorsion.motion.journey import Journey
    from geomtorsion.motion.problem import Problem


@dataclass(frozen=True)
class Cost:
    """What a solution cost.

    steps, evaluations: of the answer, without the run that gave the error estimate.
    compile_seconds: compilation, of answer and check; zero where it was kept from before.
    run_seconds: integration of the answer, and of what runs side by side with it.
    check_seconds: integration of everything else: other checks, attempts that were too coarse.
    """

    steps: int
    evaluations: int
    compile_seconds: float
    run_seconds: float
    check_seconds: float

    def __str__(self) -> str:
        return (
            f"{self.steps} steps, {self.evaluations} evaluations, "
            f"compiled in {self.compile_seconds:.3g} s, ran in {self.run_seconds:.3g} s, "
            f"checked in {self.check_seconds:.3g} s"
        )


@dataclass(frozen=True)
class Moment:
    """Where a motion is at one time, or at several.

    time: as asked; coordinates q^mu, velocity q'^mu, frame_velocity u^i: shape (..., n).
    passengers: transported vectors or separation, shape (..., number).
    """

    time: Any
    coordinates: Any
    velocity: Any
    frame_velocity: Any
    passengers: Any


@dataclass(frozen=True, eq=False)
class Solution:
    """A solved motion.

    problem: what was solved.
    times: shape (m,), as asked for, or 65 of them up to the time asked for.
    accuracy: what was asked for, relative to the size of the solution.
    error: estimate of the largest error at `times`, and at no others, relative to the size of the
        solution: coordinates, velocities and passengers each against their own largest value.
        What `at` gives between the times is not part of it: see `error_between`.
    engine, why: what solved it, and why that was chosen.
    cost: steps, evaluations, seconds.
    complete: whether the last time was reached.
    journey, against: the integration, and what gives the other one that it was held against.
    share: the error is this many times the difference of the two.

    Examples
    --------
    >>> from geomtorsion.motion import RungeKutta, geodesic, solve
    >>> from geomtorsion.spaces import load
    >>> equator = geodesic(load("s2").frame, [1.5707963267948966, 0], [0, 1], parameters={"R": 1})
    >>> sol = solve(equator, 1.0, accuracy=1e-9, engine=RungeKutta())
    >>> sol.error < 1e-9, round(float(sol.at(0.5).coordinates[1]), 9)
    (True, 0.5)
    """

    problem: Problem
    times: np.ndarray
    accuracy: float
    error: float
    engine: str
    why: str
    cost: Cost
    complete: bool
    journey: Journey
    against: Callable[[], Journey] | None = None
    share: float = CAUTION

    # -- arrays at the times ---------------------------------------------------------------------

    @cached_property
    def moment(self) -> Moment:
        """Everything at the times."""
        return reading.at_samples(self)

    @property
    def coordinates(self) -> np.ndarray:
        """q^mu in the chart of the problem, shape (m, n); its angles within half a turn of the
        start where the motion was followed in another chart.

        Raises
        ------
        ChartEdgeError
            the motion went where this chart does not reach; use `in_chart`.
        """
        return self.moment.coordinates

    @property
    def velocity(self) -> np.ndarray:
        """q'^mu in the chart of the problem, shape (m, n)."""
        return self.moment.velocity

    @property
    def frame_velocity(self) -> np.ndarray:
        """u^i = e^i_mu q'^mu, shape (m, n)."""
        return self.moment.frame_velocity

    @property
    def passengers(self) -> np.ndarray:
        """Transported vectors (frame) or separation (offset, rate), shape (m, number)."""
        return self.moment.passengers

    @property
    def charts(self) -> tuple[str, ...]:
        """Names of the charts through which the motion was followed, in order."""
        return tuple(segment.chart for segment in self.journey.segments)

    def in_frame(self) -> np.ndarray:
        """The velocity in the frame, u^i, shape (m, n)."""
        return self.frame_velocity

    def in_chart(self, name: str) -> np.ndarray:
        """Coordinates in another chart of the space, shape (m, number of coordinates there).

        Raises
        ------
        UnknownNameError
            there is no such chart.
        ChartEdgeError
            the motion went where that chart does not reach.
        """
        self.problem.atlas.chart(name)
        return reading.in_chart(self, name)

    # -- between the times -----------------------------------------------------------------------

    def at(self, time: Any) -> Moment:
        """Coordinates and velocities at any time up to the last; arrays of times are welcome.

        Between the times of the solution these are interpolated by the engine. `error` is about
        the times alone; `error_between` covers these, too. Series (Taylor) are as good in
        between; RungeKutta and Stiff interpolate to a lower order than they step, and may be worse.

        Raises
        ------
        TimeError
            a time lies outside of what was solved.
        """
        return reading.at_times(self, time)

    # -- how good it is --------------------------------------------------------------------------

    @cached_property
    def witness(self) -> Journey | None:
        """The integration that the answer was held against."""
        return None if self.against is None else self.against()

    @cached_property
    def drift(self) -> Mapping[str, float]:
        """For each known invariant its largest change, relative to the size of its terms."""
        return measures.drifts(self)

    @cached_property
    def error_between(self) -> float:
        """Estimate of the largest error of `at`, between the times, too; relative as `error` is.

        Worked out on first use, from dense output of the solution and of the run that it was held
        against, at about a hundred places: it costs as much as the solution did.
        """
        return error_between(self)

    def __str__(self) -> str:
        reach = f"to t = {float(self.times[-1]):.6g}, {len(self.times)} times"
        lines = [
            str(self.problem),
            f"{reach}, by {self.engine} ({self.why})",
            f"error below {self.error:.2g} (asked: {self.accuracy:.2g}); {self.cost}",
        ]
        drifts = ", ".join(f"{name} {value:.1e}" for name, value in self.drift.items())
        return "\n".join([*lines, f"drift: {drifts}"] if drifts else lines)

    def __repr__(self) -> str:
        return str(self)

    # -- taking it elsewhere ---------------------------------------------------------------------

    def column(self, name: str) -> np.ndarray:
        """A coordinate (q), velocity (q') or frame velocity (u) by name, shape (m,)."""
        names = self.problem.coordinates
        if name in names:
            return self.coordinates[:, names.index(name)]
        velocities = self.journey.segments[0].equations.velocities
        if name in velocities:
            return self.frame_velocity[:, velocities.index(name)]
        raise UnknownNameError(
            f"{name!r} is no coordinate or velocity here. "
            f"There are {', '.join((*names, *velocities))}."
        )

    def to_pandas(self) -> Any:
        """A pandas table: times, coordinates, coordinate and frame velocities.

        Raises
        ------
        MissingExtraError
            pandas is not installed.
        """
        from geomtorsion.motion.tables import pandas_table

        return pandas_table(measures.columns(self))

    def save(self, path: str | Path) -> None:
        """Write an NPZ file with arrays and metadata; `Recorded.load` reads it."""
        from geomtorsion.motion.recorded import save

        save(self, path)


def distance_apart(one: Solution, two: Solution, chart: str | None = None) -> np.ndarray:
    """How far two motions are from each other at each of the times of the first.

    Parameters
    ----------
    one, two
        solutions over the same space.
    chart
        chart in whose coordinates to measure; that of the problem if not given.

    Returns
    -------
    Array, shape (m,): length of e^i_mu (q_two - q_one)^mu, with the coframe half way between: the
    distance in the metric where the two are close. Lorentzian signs are taken as positive.

    Raises
    ------
    TimeError
        the second solution does not reach the times of the first.

    Examples
    --------
    >>> from geomtorsion.geometry import cartan
    >>> from geomtorsion.motion import autoparallel, geodesic, solve
    >>> from geomtorsion.spaces import load
    >>> frame = load("so3").frame
    >>> start, turn = [0.3, 1.0, 0.2], [0.1, 0.5, -0.2]
    >>> straight = solve(autoparallel(cartan(frame), start, turn), 1.0)
    >>> shortest = solve(geodesic(frame, start, turn), 1.0)
    >>> bool(distance_apart(straight, shortest).max() < 1e-9)
    True
    """
    last, other = float(one.times[-1]), float(two.times[-1])
    if abs(other) < abs(last) or last * other < 0:
        raise TimeError(
            f"the second solution ends at t = {other:.6g}, the first at {last:.6g}. "
            "Solve both to the same time."
        )
    return measures.gaps(one, two, chart)

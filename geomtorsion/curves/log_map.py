"""Logarithm map: the shortest of the curves found from one point to another, by shooting."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from geomtorsion.curves.covering import Ends, ends_of
from geomtorsion.curves.problem import CurveProblem
from geomtorsion.curves.search import Followed, Search, reach_of
from geomtorsion.curves.shooting import ROUNDING, Line, Shooter
from geomtorsion.errors import EndpointError, GeomtorsionError
from geomtorsion.geometry import Connection
from geomtorsion.geometry.connections import ConnectionLike, as_connection
from geomtorsion.ode.engines import Engine, RungeKutta, Taylor
from geomtorsion.ode.newton import STALE, Hit, lengths_of
from geomtorsion.ode.numbers import Numbers, checked_accuracy, checked_numbers
from geomtorsion.ode.solution import Solution
from geomtorsion.ode.solve import engines, solve
from geomtorsion.ode.system import STEPS_AT_ONCE, WorkLimitError, checked_engine
from geomtorsion.support.caching import cached_property

# The relative accuracy to which a motion is aimed again where the requested one found no answer.
SHARPEST = 4 * ROUNDING


@dataclass(frozen=True, eq=False)
class LogMap:
    """Motion from one point to another in unit time.

    vector: its initial frame velocity u^i.
    miss: distance of its end from the target, in the frame at the target, with the Euclidean
        metric delta_ij instead of eta_ij.
    solution: the motion.
    shots: number of motions that Newton's iteration computed.
    length: sqrt(|eta_ij u^i u^j|); the length of the motion, or its proper time.
    conjugate: parts of the motion, between 0 and 1, at which a point is conjugate to the start.
    guarantee: the set of motions among which it is the shortest, in words.
    chart: name of the chart in whose frame `vector` is given: the chart of the connection's frame,
        unless that is singular at the start.
    """

    vector: np.ndarray
    miss: float
    solution: Solution
    shots: int
    length: float
    conjugate: tuple[float, ...]
    guarantee: str
    chart: str


def log_map(
    connection: ConnectionLike,
    start: Numbers,
    end: Numbers,
    *,
    guess: Numbers | None = None,
    parameters: Mapping[Any, Any] | None = None,
    accuracy: float = 1e-10,
    engine: Engine | None = None,
) -> LogMap:
    """The motion from one point to another in unit time: the inverse of the exponential map.

    Without a guess, the answer is the shortest of the motions found in two ways. First, by
    continuation: the end moves from the start to its position along a straight line in coordinates,
    and the motion follows it; there is one line for each image of the end under full turns of
    periodic coordinates. Second, a fan of motions of the length found so far leaves the start, and
    Newton's iteration continues from the points nearest to the end. `guarantee` states among how
    many motions the answer is the shortest. It is the shortest of all where the frame is constant.
    In general this cannot be proved from finitely many motions, but a geodesic with a conjugate
    point before its end, which is never the shortest, is refused. Where two motions have the least
    length, the end is on the cut locus, and an error reports both.

    Lengths and misses are measured with eta in the frame, so units of coordinates do not matter.
    With an indefinite metric no motion is the shortest: the answer has the least frame velocity,
    all signs of eta counted as positive.

    Parameters
    ----------
    connection, start
        as in `exponential_map`. A geodesic may also start at a point where the frame is singular,
        such as the pole of a sphere, if the space has another chart there: `LogMap.chart`.
    end
        q^mu to be reached, shape (n,), also such a point.
    guess
        frame velocity from which Newton's iteration starts, to choose among several answers.
    parameters, accuracy, engine
        as in `exponential_map`; the end is hit to ten times the accuracy times the length, or to
        the rounding error of the coordinates where that is larger.

    Raises
    ------
    EndpointError
        no motion was found, or several of equal length; or the end is conjugate to the start; or
        every motion found passes a conjugate point.

    Examples
    --------
    >>> from geomtorsion.geometry import levi_civita
    >>> from geomtorsion.spaces import load
    >>> plane = levi_civita(load("flat_polar").frame)
    >>> found = log_map(plane, [1, 0], [1, 0.5])
    >>> found.vector.round(6).tolist(), round(found.length, 6)
    ([-0.122417, 0.479426], 0.494808)
    """
    connection = as_connection(connection)
    frame = connection.frame
    n = frame.dimension
    accuracy = checked_accuracy(accuracy)
    checked_engine(engine)
    ends = ends_of(connection, start, end, parameters)
    problem, target = ends.problem, ends.target
    solver = _solver(problem, accuracy, engine)

    first = None if guess is None else checked_numbers(guess, n, "guess")

    def answer(aimed: float) -> LogMap:
        shooter = Shooter(problem, solver, solver.first(aimed / 10))
        if ends.label is None or ends.place is None:
            aim = shooter.aim(target)
        else:
            aim = shooter.aim_in(ends.label, ends.place)
        search = Search(shooter, aim, aimed)
        choice = _Choice(connection, search, engine, (start, end), ends)
        if first is None or guess is None:
            return choice.shortest(target)
        velocity = ends.followed(np.array([float(x) for x in first]))
        return choice.from_guess(shooter.weights @ velocity, guess)

    try:
        return answer(accuracy)
    except EndpointError as error:
        # Near a conjugate point directions differ only in motions that are as sharp as floats
        # allow.
        if accuracy <= SHARPEST or engine is not None:
            raise
        try:
            return answer(SHARPEST)
        except GeomtorsionError:
            raise error from None


def _solver(problem: CurveProblem, accuracy: float, engine: Engine | None) -> Engine:
    """The requested engine, or the one that `solve` tries first."""
    if engine is not None:
        return engine
    first, _ = next(iter(engines(problem, accuracy, None)), (RungeKutta(), ""))
    # A motion with this many steps approaches an edge forever, and does not hit.
    return Taylor(max_steps=STEPS_AT_ONCE) if first == Taylor() else first


@dataclass(frozen=True, eq=False)
class _Choice:
    """The choice of one motion of a connection among those found from a start to an end.

    ends: start and end as they were given, for messages; charts: where they are.
    """

    connection: Connection
    search: Search
    engine: Engine | None
    ends: tuple[Numbers, Numbers]
    charts: Ends

    @property
    def where(self) -> str:
        """Start and end in words."""
        return f"from {list(self.ends[0])} to {list(self.ends[1])}"

    @cached_property
    def is_geodesic(self) -> bool:
        """Whether the motions are geodesics by their very connection."""
        return bool(self.connection.is_torsion_free and self.connection.metric_compatible)

    def from_guess(self, first: np.ndarray, guess: Numbers) -> LogMap:
        """The motion that Newton's iteration reaches from a guess."""
        hit = self.search.newton.hit(self.search.aim, first) if first.any() else None
        answer = None if hit is None else self.answer(hit, "the motion nearest to the guess")
        if answer is None:
            raise EndpointError(
                f"expected a motion {self.where}, got none from the guess {list(guess)}. "
                "Give another guess, or none."
            )
        return answer

    def shortest(self, target: np.ndarray) -> LogMap:
        """The shortest of the motions found."""
        at_start = self.search.shooter.measured(
            np.zeros(len(target)),
            self.search.shooter.home,
            self.search.shooter.start,
            self.search.aim,
        )
        if at_start.size == 0:
            return self._answered(
                Hit(at_start, self.search.aim, None, 0), "start and end are one point"
            )
        lines, complete = self.search.shooter.lines(target)
        followed: list[Followed] = []
        for line in lines:
            shortest = min((one.length for one in followed if one.hit), default=np.inf)
            # A line that is much longer than a motion known hardly leads to a shorter one.
            if not line.length > 2 * shortest:
                followed.append(self.search.followed(line))
        hits = [one.hit for one in followed if one.hit is not None]
        exhaustive = complete and self.is_geodesic and followed[0].hit is not None
        directions = [] if exhaustive else self.search.directions(hits)
        hits += self.search.fan(directions, reach_of(followed, lines), hits)
        # Among equal motions the first is kept, which took the fewest differences of coordinates.
        hits = sorted(self.search.apart(hits), key=lambda hit: hit.length)
        if not hits:
            near = self.search.newton.flat
            reason = (
                "The end is conjugate to the start, or so near to a conjugate point that errors of "
                f"the motions hide the direction (at a length of {lengths_of(near[-1]):.9g})"
                if near
                else "The end may be beyond an edge of the chart"
            )
            raise EndpointError(
                f"expected a motion {self.where}, got none from {len(followed)} images of "
                f"the end and {len(directions)} directions. {reason}. Give a guess (initial frame "
                "velocity), a nearer end, or start and end in the opposite order."
            )
        self.check_length(hits[0], lines)
        self.check_unique(hits)
        if exhaustive:
            return self._answered(
                hits[0],
                "shortest of all motions: the coframe is constant, and all images of the end under "
                "full turns were compared",
            )
        many = f"{len(hits)} motions found from {len(followed)} images of the end "
        least = "shortest" if self.search.shooter.is_definite else "least frame velocity (|eta|)"
        return self._answered(hits[0], f"{least} of {many}and {len(directions)} directions")

    def check_length(self, found: Hit, lines: list[Line]) -> None:
        """Refuse a geodesic that is longer than a line in coordinates."""
        bound = min((line.length for line in lines if np.isfinite(line.length)), default=np.inf)
        if (
            self.search.shooter.is_definite
            and self.is_geodesic
            and found.length > (1 + STALE) * bound
        ):
            raise EndpointError(
                f"expected the shortest motion {self.where}, but the shortest one found has length "
                f"{found.length:.9g}, and a straight line in coordinates {bound:.9g}. Give a guess "
                "(initial frame velocity) near the shortest motion."
            )

    def check_unique(self, found: list[Hit]) -> None:
        """Refuse an end to which two motions of least length lead."""
        if not self.search.shooter.is_definite:
            return
        best, *others = found
        length = best.length
        for hit in others:
            longer = hit.length - length
            if longer <= 4 * self.search.newton.allowed(best.vector, self.search.aim):
                one, two = (
                    self.charts.given(self.search.shooter.velocity(x.vector)).round(6)
                    for x in (best, hit)
                )
                raise EndpointError(
                    f"expected one shortest motion {self.where}, got no unique answer: at least "
                    f"two have length {length:.9g}, with initial frame velocities {one.tolist()} "
                    f"and {two.tolist()}. The end is on the cut locus. Give a guess to choose "
                    "one."
                )

    def _answered(self, found: Hit, guarantee: str) -> LogMap:
        """The answer, unless it is shown not to be the shortest or not to be accurate."""
        answer = self.answer(found, guarantee)
        if answer is None:
            raise EndpointError(
                f"expected a motion {self.where} to accuracy {self.search.accuracy:.3g}, but its "
                "end depends too much on its start. Request a lower accuracy, or give a nearer "
                "end, or start and end in the opposite order."
            )
        if answer.conjugate and self.search.shooter.is_definite and self.is_geodesic:
            # Beyond an antipode the shorter motion leaves the start in the opposite direction.
            back = self.search.newton.hit(
                self.search.aim, found.vector * (1 - 2 * answer.conjugate[0])
            )
            if back is not None and back.length < found.length:
                return self._answered(back, guarantee)
            raise EndpointError(
                f"expected the shortest motion {self.where}, but the shortest one found, of length "
                f"{answer.length:.9g}, passes a point conjugate to its start at t = "
                f"{answer.conjugate[0]:.6g}, so that a shorter one exists. Give a guess (initial "
                "frame velocity) near the shortest motion."
            )
        return answer

    def answer(self, found: Hit, guarantee: str) -> LogMap | None:
        """A motion solved to the accuracy; None if its end misses."""
        shooter, velocity = self.search.shooter, self.search.shooter.velocity(found.vector)
        problem = shooter.problem.with_start(frame_velocity=velocity)
        try:
            solution = solve(problem, [1.0], self.search.accuracy / 10, self.engine)
        except (ArithmeticError, WorkLimitError) as reason:
            raise EndpointError(
                f"expected a motion {self.where} to accuracy {self.search.accuracy:.3g}, but the "
                f"one found cannot be solved: {reason}"
            ) from None
        place = solution.in_chart(self.search.aim.label)[-1].astype(float)
        shot = shooter.measured(found.vector, self.search.aim.label, place, self.search.aim)
        if shot.size > 10 * self.search.newton.allowed(found.vector, self.search.aim):
            return None
        conjugate = self.search.conjugate_parts(found.vector)
        if not conjugate and found.vector.any():
            guarantee += "; no conjugate point on it was noticed"
            turn = self.search.direction_error(found, shot.size)
            if turn > 100 * self.search.accuracy:
                good = f"good to {turn:.1g}" if np.isfinite(turn) else "not determined"
                guarantee += f"; so near to a conjugate point its direction is {good}"
        length = found.length
        if length and not shooter.is_definite:
            unit = velocity / length
            length *= float(np.sqrt(abs(unit @ shooter.eta @ unit)))
        return LogMap(
            self.charts.given(velocity),
            shot.size,
            solution,
            found.shots,
            length,
            conjugate,
            guarantee,
            self.charts.chart,
        )

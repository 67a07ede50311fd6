"""Motions: their price by each engine, plain, with error estimate and proved; and their truth."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from functools import partial
from typing import Any

import numpy as np

from geomtorsion.curves import CurveProblem, closed_form
from geomtorsion.errors import GeomtorsionError, StartError
from geomtorsion.ode import (
    ODE,
    Engine,
    Ensemble,
    Run,
    RungeKutta,
    Segment,
    Solution,
    Stage,
    Taylor,
    Trajectory,
    WorkLimitError,
    integrate,
    solve,
)
from geomtorsion.ode.engines.stepwise import FLOOR
from geomtorsion.ode.engines.taylor import is_available
from geomtorsion.ode.error_estimate import difference
from geomtorsion.ode.numbers import checked_times
from geomtorsion.prices import offer as offers
from geomtorsion.prices.offer import Bounds, Claim, Offer, Request, Way
from geomtorsion.proofs import Proof, prove
from geomtorsion.support.precision import EPS

# The square of double rounding, which is above the rounding of quadruple numbers.
QUADRUPLE_TOLERANCE = EPS * EPS
# The proved truth has four digits more than doubles.
TRUTH_ACCURACY = EPS * 1e-4
# Function of times that gives exact states, one row for each time.
States = Callable[[np.ndarray], Any]


@dataclass(frozen=True)
class Truth:
    """Reference solution of a motion: a closed form, a proof, or the most accurate run.

    name: its source; trajectory: states at the times of the requested solutions.
    radius: proved relative bound of its error; 0.0 without a proof.
    """

    name: str
    problem: CurveProblem | ODE
    trajectory: Trajectory
    radius: float = 0.0

    def error(self, solution: Solution) -> float:
        """Largest error of a solution, each group of states against its own size."""
        return difference(self.problem, solution.trajectory, self.trajectory, solution.accuracy)

    def bounds(self, trajectory: Trajectory, accuracy: float) -> Bounds:
        """Bounds of the largest error of a trajectory."""
        gap = difference(self.problem, trajectory, self.trajectory, accuracy)
        return Bounds(max(0.0, gap - self.radius), gap + self.radius)


def truth_of(problem: CurveProblem | ODE, grid: np.ndarray, exact: States | None = None) -> Truth:
    """Reference for a motion: its closed form, quadruple precision, or the finest Runge-Kutta.

    grid: times from 0 on; exact: the closed form, where the problem does not know it itself.
    """
    known = closed_form(problem) if exact is None and isinstance(problem, CurveProblem) else None
    if exact is not None or known is not None:
        label, states = known if known is not None else ("", exact)
        assert states is not None
        return Truth("the closed form", problem, tabulated(problem, grid, label, states(grid)))
    engine: Engine = RungeKutta()
    tolerance, name = FLOOR, "the finest Runge-Kutta solution"
    if is_available():
        engine, tolerance, name = Taylor(113), QUADRUPLE_TOLERANCE, "quadruple precision"
    return Truth(name, problem, _plain(problem, grid, tolerance, engine))


def proved_truth(problem: CurveProblem | ODE, times: np.ndarray) -> Truth | None:
    """The finest solution with a proved bound of its error; None without a proof."""
    engine: Engine = Taylor(113) if is_available() else RungeKutta()
    try:
        finest = solve(problem, times, TRUTH_ACCURACY if is_available() else 1e-12, engine)
        proof = prove(finest)
    except GeomtorsionError:
        return None
    return Truth("a proof, so that they are enclosed", problem, finest.trajectory, proof.error)


def best_truth(problem: CurveProblem | ODE, times: np.ndarray, *, proved: bool) -> Truth:
    """A proof where one is wanted and possible, else what `truth_of` gives."""
    truth = proved_truth(problem, times) if proved else None
    return truth or truth_of(problem, checked_times(times)[1])


def _plain(
    problem: CurveProblem | ODE, grid: np.ndarray, tolerance: float, engine: Engine
) -> Trajectory:
    """One integration without an error estimate."""
    stage = problem.first_stage(engine.precision, 0.0)
    try:
        return integrate(stage, grid * problem.time_unit, tolerance, engine)
    except WorkLimitError as limit:
        raise limit.counted(1 / problem.time_unit, problem.time_name) from None


def tabulated(problem: CurveProblem | ODE, grid: np.ndarray, label: str, states: Any) -> Trajectory:
    """A trajectory of states at the times of a grid, in the coordinates of a label."""
    stage: Stage = problem.first_stage(53, 0.0)
    assert stage.label == label
    rows = np.array([list(row) for row in states])
    times = grid * problem.time_unit
    run = Run(times, rows, float(times[-1]), rows[-1], "done", 0, 0, 0.0, 0.0)
    return Trajectory(RungeKutta(), 0.0, (Segment(stage, run, 0, len(grid)),), "done")


def default_engines() -> tuple[Engine, ...]:
    """The engines that are compared: series, if installed, and Runge-Kutta."""
    return (*([Taylor()] if is_available() else []), RungeKutta())


def motion_offer(
    problem: CurveProblem | ODE,
    request: Request,
    *,
    name: str = "",
    more: Sequence[Way] = (),
    solved: Callable[[Engine, float], offers.Run] | None = None,
) -> Offer:
    """Ways to a motion, with the reference for their true errors, for `price`.

    request.at: last time, or times. more: further ways. solved: (engine, accuracy) -> run with an
    error estimate, by default `solve`.
    """
    times, grid = checked_times(10.0 if request.at is None else request.at)
    problem.check_start()
    truth = best_truth(problem, times, proved=bool(request.proofs))
    engines = request.engines or default_engines()
    ways = list(more)
    for engine in engines:
        checked = partial(solved or partial(_checked, problem, times), engine)
        plain = partial(_unchecked, problem, times, grid, engine)
        name_plain, some = f"{engine.name}, plain", request.accuracies
        ways += [
            Way(engine.name, "estimate", checked, some, engine=engine.name),
            Way(name_plain, "plain", plain, some, engine=engine.name),
        ]
    if request.proofs:
        ready = partial(_proved, problem, times, engines, request.accuracies)
        ways.append(Way("proof", "proof", ready, request.proved))
    title = f"{name or problem}, to {problem.time_name} = {float(times[-1]):.6g}"
    return Offer(title, ways, truth.name, partial(_judged, truth))


def _judged(truth: Truth, value: Trajectory | Proof, accuracy: float) -> Bounds:
    if isinstance(value, Proof):
        return Bounds(0.0, value.relative_radius)
    return truth.bounds(value, accuracy)


def _checked(
    problem: CurveProblem | ODE, times: np.ndarray, engine: Engine, accuracy: float
) -> offers.Run:
    def run() -> Claim:
        solution = solve(problem, times, accuracy, engine)
        return Claim(solution.trajectory, solution.error)

    return run


def _unchecked(
    problem: CurveProblem | ODE,
    times: np.ndarray,
    grid: np.ndarray,
    engine: Engine,
    accuracy: float,
) -> offers.Run:
    """One integration with the tolerance that reaches the accuracy."""
    tolerance = solve(problem, times, accuracy, engine).trajectory.tolerance
    return lambda: Claim(_plain(problem, grid, tolerance, engine), None)


def _proved(
    problem: CurveProblem | ODE,
    times: np.ndarray,
    engines: Sequence[Engine],
    accuracies: Sequence[float],
    accuracy: float,
) -> offers.Run:
    """A proof of the finest solution that there is."""
    finest: Solution | None = None
    refused: GeomtorsionError | None = None
    for asked in sorted(accuracies):
        for engine in engines:
            try:
                finest = finest or solve(problem, times, asked, engine)
            except GeomtorsionError as error:
                refused = error
    if finest is None:
        assert refused is not None
        raise refused
    return partial(proved_claim, finest, accuracy)


def proved_claim(result: Any, accuracy: float) -> Claim:
    """A proof of a result, whose claim is the radius of its balls."""
    proof = prove(result, offers.digits_of(accuracy))
    return Claim(proof, proof.relative_radius)


def solution_offer(solution: Solution, request: Request) -> Offer:
    """The price of the motion of a solution, at its times."""
    return motion_offer(solution.problem, offers.at(request, solution.times))


def ensemble_offer(ensemble: Ensemble, request: Request) -> Offer:
    """The price of the motions of an ensemble; three of them are compared with the truth."""
    problem, members = ensemble.problem, ensemble.members
    times = offers.at(request, ensemble.times).at
    whole = np.flatnonzero(ensemble.finished).tolist()
    if not whole:
        raise StartError(
            "ensemble: expected a finished member, got none. Solve it for a shorter time."
        )
    some = sorted({whole[0], whole[len(whole) // 2], whole[-1]})
    truths = {
        k: best_truth(problem.member(members, k), times, proved=bool(request.proofs)) for k in some
    }
    names = " or ".join(dict.fromkeys(truth.name for truth in truths.values()))
    ways = []
    for engine in request.engines or default_engines():
        run = partial(_members, ensemble, engine)
        ways.append(
            Way(engine.name, "estimate", lambda a, run=run: partial(run, a), request.accuracies)
        )
    text = f"{names} (members {', '.join(map(str, some))})"
    title = f"{len(members)} members of {problem}, to {problem.time_name} = {float(times[-1]):.6g}"
    return Offer(title, ways, text, partial(_judged_members, truths))


def _members(ensemble: Ensemble, engine: Engine, accuracy: float) -> Claim:
    again = ensemble.at_accuracy(accuracy, engine)
    return Claim(again, again.error)


def _judged_members(truths: Mapping[int, Truth], value: Ensemble, accuracy: float) -> Bounds:
    """The largest error of some members."""
    every = [truth.bounds(_followed(value, k, truth), accuracy) for k, truth in truths.items()]
    return Bounds(max(one.low for one in every), max(one.high for one in every))


def _followed(ensemble: Ensemble, k: int, truth: Truth) -> Trajectory:
    """The trajectory of one member."""
    if k in ensemble.trajectories:
        return ensemble.trajectories[k]
    grid = checked_times(ensemble.times)[1]
    return tabulated(truth.problem, grid, ensemble.members.label, ensemble.rows.states[k])

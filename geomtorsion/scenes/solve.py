"""Solve: a scene solved, in closed form where there is one, and the ways that have a price."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import partial
from pathlib import Path
from time import perf_counter
from typing import TYPE_CHECKING, Any

import numpy as np

from geomtorsion.errors import AccuracyError, StuckError, TimeError
from geomtorsion.ode import Checkpoint, Cost, Engine, integrate, solve
from geomtorsion.ode.checkpoint import fingerprint
from geomtorsion.ode.error_estimate import difference
from geomtorsion.ode.numbers import checked_times
from geomtorsion.ode.solution import DOUBLE
from geomtorsion.ode.solve import batch_engine
from geomtorsion.prices import (
    Bounds,
    Claim,
    Offer,
    Request,
    Way,
    motion_offer,
    tabulated,
)
from geomtorsion.prices.offer import at
from geomtorsion.rigid import FreeTop, attitude, free_top
from geomtorsion.scenes.context import OMEGA, POSITION, QUATERNION, VELOCITY, VERTICAL
from geomtorsion.scenes.result import SceneResult, result_of
from geomtorsion.scenes.to_ode import observed, parameters_of, start_of
from geomtorsion.support.caching import cached_property
from geomtorsion.support.precision import EPS
from geomtorsion.support.progress import reports

if TYPE_CHECKING:
    from geomtorsion.ode import Solution
    from geomtorsion.scenes.scene import Scene

NAME = "free top (Jacobi elliptic functions)"
# The check looks at so many turns, at one time in each: a wrong formula or constant shows in all.
CHECKED_TURNS = 32
# What the formulas lose themselves, relative to the size of each group of states: 16 roundings.
ROUNDING = 16 * EPS
# Period and precession are pairs of doubles: their relative error, by which angles drift away.
PAIR = 4 * EPS**2


@dataclass(frozen=True, eq=False)
class ClosedForm:
    """The motion of a free body at any time, without stepping.

    scene: it needs nothing but free rotation, and translation without forces.
    """

    scene: Scene

    @cached_property
    def _top(self) -> tuple[FreeTop, np.ndarray]:
        """The free top in its principal axes, and these as columns in body axes."""
        body, start = self.scene.body, self.scene.start
        moments, omega, axes = body.in_principal_axes(start.omega or ())
        q = start.attitude if start.attitude is not None else np.array([1.0, 0.0, 0.0, 0.0])
        turned = attitude.product(q, attitude.quaternion_from_matrix(axes))
        return free_top(moments, omega, tuple(turned)), axes

    def drift(self, time: float) -> float:
        """Error of the angles at a time by the digits of period and precession, radians."""
        top, _ = self._top
        moments, omega = (np.array([float(x) for x in row]) for row in (top.moments, top.omega0))
        return PAIR * abs(time) * float(moments.max() / moments.min() * np.linalg.norm(omega))

    def away_at_start(self) -> float:
        """Largest difference to the rates at the start, each relative to what changes it.

        Next to an unstable axis the smallest rate determines when the body flips, so that each is
        compared with itself, or with its change in the time to the middle of a flip, from which the
        formulas count, and in a radian of turning.
        """
        top, axes = self._top
        if top.constants is None:
            return 0.0
        moments, omega = (np.array([float(x) for x in row]) for row in (top.moments, top.omega0))
        changes = np.abs(np.cross(moments * omega, omega) / moments)
        waits = 1 / np.linalg.norm(omega) + abs(top.constants.offset.high)
        sizes, first = np.abs(omega) + changes * waits, top.omega(0.0)
        start = np.array([float(x) for x in self.scene.start.omega or ()])
        gaps = np.abs(np.concatenate((first - omega, axes @ first - start)))
        sizes = np.concatenate((sizes, np.abs(axes) @ sizes))
        with np.errstate(divide="ignore"):
            return float((gaps[gaps > 0] / sizes[gaps > 0]).max(initial=0.0))

    def states(self, times: np.ndarray) -> np.ndarray:
        """States of the equations of the scene at the times, shape (m, size)."""
        top, axes = self._top
        scene, columns = self.scene, {}
        names = scene.selection.states
        rates = top.omega(times) @ axes.T
        columns |= {s.name: rates[:, k] for k, s in enumerate(OMEGA)}
        begin = scene.start.attitude
        if {QUATERNION[0].name, VERTICAL[0].name} & set(names) and begin is not None:
            back = attitude.quaternion_from_matrix(axes.T)
            q = attitude.product(top.quaternion(times), back)
            first = attitude.product(top.quaternion(np.zeros(1)), back)[0]
            # q and -q are one attitude: take the sign that the start has.
            q = q if first @ begin >= 0 else -q
            columns |= {s.name: q[:, k] for k, s in enumerate(QUATERNION)}
            n = attitude.matrix_from_quaternion(q)[:, 2, :]
            columns |= {s.name: n[:, k] for k, s in enumerate(VERTICAL)}
        numbers = start_of(scene.selection, scene.start)
        numbers |= parameters_of(scene.selection, scene.start)
        for place, velocity in zip(POSITION, VELOCITY, strict=True):
            if place.name in names:
                speed = float(numbers.get(velocity.name, 0))
                columns[place.name] = float(numbers[place.name]) + speed * times
        return np.stack([columns[name] for name in names], -1)


@dataclass(frozen=True)
class CheckedStates:
    """States by the closed form, with their error and what they took.

    states: shape (m, size). error: relative. compile_seconds, run_seconds, check_seconds.
    """

    states: np.ndarray
    error: float
    compile_seconds: float
    run_seconds: float
    check_seconds: float


def closed_form(scene: Scene) -> ClosedForm | None:
    """The closed form of a scene, or None if it has none."""
    selection = scene.selection
    here = set(selection.symbols)
    turning = {*OMEGA, *QUATERNION, *VERTICAL}
    if selection.assembly.constraint is not None or set(selection.effects) - {"spin", "drift"}:
        return None
    if not here <= {*turning, *POSITION} or not here & turning:
        return None
    pairs = zip(POSITION, VELOCITY, strict=True)
    if any(place in here and speed not in selection.constants for place, speed in pairs):
        return None
    return ClosedForm(scene)


def checked_states(form: ClosedForm, times: np.ndarray) -> CheckedStates:
    """States at the times, refused by an AccuracyError where they are not as good as requested."""
    began = perf_counter()
    try:
        states = form.states(times)
    except (TimeError, OverflowError) as error:
        raise AccuracyError(f"closed form: {error}") from error
    if not np.isfinite(states).all():
        raise AccuracyError("closed form: expected finite states, got others.")
    ran = perf_counter() - began
    began = perf_counter()
    defect, compiled = _defect(form, float(times[-1]))
    error = defect + ROUNDING + form.drift(float(times[-1]))
    if not error <= form.scene.accuracy:
        raise AccuracyError(
            f"closed form: expected an error up to {form.scene.accuracy:.3g}, got {error:.3g}."
        )
    return CheckedStates(states, error, compiled, ran, perf_counter() - began - compiled)


def _defect(form: ClosedForm, last: float) -> tuple[float, float]:
    """How far the closed form is from a solution over the first turns; seconds of compiling.

    Each of its values is integrated to the next one. Over so short a time no instability hides an
    error of a formula, and a clock that runs wrong shows at each of them.
    """
    ode, start = form.scene.ode, form.scene.start
    speed = math.hypot(*(float(x) for x in start.omega or ()))
    reach = min(abs(last), 2 * math.pi * CHECKED_TURNS / speed if speed else abs(last))
    places = CHECKED_TURNS + 1 if reach else 1
    times = np.linspace(0.0, math.copysign(reach, last), places)
    values = form.states(times)
    engine, _ = batch_engine(None, ode)
    stage, compiled = ode.first_stage(engine.precision, 0.0), 0.0
    ends = [np.array(stage.start)]
    for k, value in enumerate(values[:-1]):
        begun = replace(stage, start=value, begin=float(times[k]))
        followed = integrate(begun, times[k : k + 2], EPS, engine)
        ends.append(followed.segments[-1].last)
        compiled += followed.compile_seconds
    one, two = (tabulated(ode, times, "", rows) for rows in (values, ends))
    defect = max(form.away_at_start(), difference(ode, one, two))
    # Differences of free motions grow no faster than the body turns.
    most = ROUNDING * math.exp(speed * reach / CHECKED_TURNS)
    if not defect <= most:
        raise AccuracyError(
            f"closed form: expected the equations to hold to {most:.3g}, got {defect:.3g}."
        )
    return defect, compiled


def solve_scene(
    scene: Scene,
    engine: Engine | None = None,
    checkpoint: str | Path | None = None,
    progress: Callable[[float], object] | bool | None = None,
) -> SceneResult:
    """Solve a scene; see `Scene.run`."""
    # Equations that cannot be written down are refused before anything is computed.
    ode = scene.ode
    if scene.accuracy < DOUBLE:
        raise AccuracyError(
            f"accuracy: expected {DOUBLE:.3g} or more, got {scene.accuracy:.3g}. The values of a "
            "scene are doubles; for more digits solve its equations, `solve(scene.ode, ...)`."
        )
    if checkpoint is not None:
        # From here on until the caller removes it, the file marks a run that can be resumed.
        key = fingerprint(ode, checked_times(scene.times)[0], scene.accuracy, engine)
        Checkpoint(checkpoint, key).begin()
    form = closed_form(scene) if engine is None else None
    refusal = ""
    if form is not None:
        try:
            result = _in_closed_form(scene, form)
        except AccuracyError as error:
            refusal = str(error).removeprefix("closed form: ")
        else:
            with reports(progress, "scene") as show:
                if show is not None:
                    show(1.0)
            return result
    try:
        solved = solve(ode, scene.times, scene.accuracy, engine, checkpoint, progress)
    except StuckError as stuck:
        # The computed part becomes a result of the scene.
        if stuck.solution is not None:
            stuck.solution = of_solution(scene, stuck.solution)
        if refusal:
            raise StuckError(
                f"{stuck} The closed form was refused: {refusal}", stuck.solution
            ) from stuck
        raise
    found = of_solution(scene, solved)
    return replace(found, reason=f"{found.reason}; closed form: {refusal}") if refusal else found


def of_solution(scene: Scene, solved: Solution) -> SceneResult:
    """The result of a scene from the solution of its equations."""
    states = np.asarray(solved.states, dtype=float)
    return result_of(
        scene,
        times=solved.times,
        values=observed(scene.ode, scene.selection, solved.times, states),
        # Outputs are doubles.
        error=max(solved.error, DOUBLE),
        drift=dict(solved.drift),
        cost=solved.cost,
        engine=solved.engine,
        reason=solved.reason,
        outcome=solved.outcome,
        solved=solved,
    )


def _in_closed_form(scene: Scene, form: ClosedForm) -> SceneResult:
    """The result by the closed form; see `checked_states` for where it is refused."""
    times = scene.times
    motion = checked_states(form, times)
    changes = scene.ode.changes(times, motion.states)
    return result_of(
        scene,
        times=times,
        values=observed(scene.ode, scene.selection, times, motion.states),
        error=motion.error,
        drift={name: float(change.max()) for name, change in changes.items()},
        cost=Cost(0, 0, motion.compile_seconds, motion.run_seconds, motion.check_seconds),
        engine="closed form",
        reason="a free body; checked against the integrator",
        outcome="done",
        closed_form=NAME,
        form=form,
    )


def scene_offer(scene: Scene, request: Request) -> Offer:
    """The ways to the motion of a scene: its closed form where it has one, engines, a proof.

    A row with an error estimate is the price of `run`: of the scene, or of an engine.
    """
    request = at(request, scene.times)
    name, more = scene.title or scene.name or "scene", []
    if closed_form(scene) is not None:
        ready = partial(_run_by, scene, None)
        more = [Way("closed form", "estimate", ready, request.accuracies)]
    solved = partial(_run_by, scene)
    offer = motion_offer(scene.ode, request, name=name, more=more, solved=solved)
    return replace(offer, judge=partial(_judged, scene, offer.judge))


def _run_by(scene: Scene, engine: Engine | None, accuracy: float) -> Callable[[], Claim]:
    """A run of the scene; without an engine by its closed form."""
    asked = replace(scene, accuracy=accuracy)

    def run() -> Claim:
        result = asked.run(engine)
        if engine is None and result.form is None:
            raise AccuracyError(
                f"expected accuracy {accuracy:.3g} by the closed form, got: {result.reason}"
            )
        return Claim(result, result.error)

    return run


def _judged(
    scene: Scene, judge: Callable[[Any, float], Bounds | None], value: Any, accuracy: float
) -> Bounds | None:
    """Bounds of the true error of a run, from the states of its equations."""
    if isinstance(value, SceneResult):
        grid = checked_times(scene.times)[1]
        if value.solved is not None:
            value = value.solved.trajectory
        elif value.form is not None:
            value = tabulated(scene.ode, grid, "", value.form.states(grid))
    return judge(value, accuracy)

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
from geomtorsion.ode import Checkpoint, Cost, Engine, solve
from geomtorsion.ode.checkpoint import fingerprint
from geomtorsion.ode.numbers import checked_times
from geomtorsion.ode.solution import DOUBLE
from geomtorsion.prices import (
    Bounds,
    Claim,
    Offer,
    Request,
    Way,
    motion_offer,
    tabulated,
    truth_of,
)
from geomtorsion.prices.offer import at
from geomtorsion.rigid import FreeTop, attitude, free_top
from geomtorsion.scenes.context import OMEGA, POSITION, QUATERNION, VELOCITY, VERTICAL
from geomtorsion.scenes.result import SceneResult, result_of
from geomtorsion.scenes.to_ode import observed, parameters_of, start_of
from geomtorsion.support.caching import cached_property
from geomtorsion.support.progress import reports

if TYPE_CHECKING:
    from geomtorsion.ode import Solution
    from geomtorsion.scenes.scene import Scene

NAME = "free top (Jacobi elliptic functions)"
# The check follows so many turns, at a time in each: enough to see a wrong formula or a wrong start
# (the closed form gets no worse with time), and about a millisecond of integration.
CHECKED_TURNS = 32
# The check is at least this accurate, whatever accuracy is requested, so that the estimate is not
# far above the true error; it takes a millisecond either way.
CHECKED_ACCURACY = 1e-9
# Doubles do not suffice for this accuracy, so that the integrator takes more digits.
MORE_DIGITS = float(np.finfo(float).eps) / 8
# What the formulas lose themselves, on top of what the check can see: 16 roundings.
ROUNDING = 16 * float(np.finfo(float).eps)
# Period and precession are pairs of doubles: their relative error, by which angles drift away.
PAIR = 4 * float(np.finfo(float).eps) ** 2


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


def checked_states(form: ClosedForm, times: np.ndarray) -> CheckedStates | None:
    """States at the times; None where the closed form does not reach or fails its check."""
    began = perf_counter()
    try:
        states = form.states(times)
    except (TimeError, OverflowError):
        return None
    if not np.isfinite(states).all():
        return None
    ran = perf_counter() - began
    began = perf_counter()
    error, compiled = _checked(form, float(times[-1]))
    error += form.drift(float(times[-1]))
    if not error <= form.scene.accuracy:
        return None
    return CheckedStates(states, error, compiled, ran, perf_counter() - began - compiled)


def _checked(form: ClosedForm, last: float) -> tuple[float, float]:
    """Difference to the integrator over the first turns, with its error; seconds of compiling.

    Where doubles lose too much (next to an unstable axis) the integrator takes more digits, and
    where it has none, a shorter time.
    """
    scene = form.scene
    speed = math.hypot(*(float(x) for x in scene.start.omega or ()))
    reach = min(abs(last), 2 * math.pi * CHECKED_TURNS / speed if speed else abs(last))
    if reach == 0:
        return ROUNDING, 0.0
    # A quarter allows for the error of the check itself.
    asked = min(scene.accuracy / 4, CHECKED_ACCURACY)
    compiled = 0.0
    tries = [(1.0, asked), (1.0, min(asked, MORE_DIGITS))]
    tries += [(0.5**halvings, asked) for halvings in (1, 2, 3)]
    for part, accuracy in tries:
        times = np.linspace(0.0, math.copysign(part * reach, last), CHECKED_TURNS + 1)
        try:
            solved = solve(scene.ode, times, accuracy)
        except AccuracyError:
            continue
        compiled += solved.cost.compile_seconds
        gap = truth_of(scene.ode, times, form.states).error(solved)
        error = gap + solved.error + ROUNDING
        if error <= scene.accuracy:
            return error, compiled
        if gap > scene.accuracy:
            # Known better than that, the motion is another one, however little of it is looked at.
            break
    return math.inf, compiled


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
    if form is not None:
        result = _in_closed_form(scene, form)
        if result is not None:
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
        raise
    return of_solution(scene, solved)


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


def _in_closed_form(scene: Scene, form: ClosedForm) -> SceneResult | None:
    """The result by the closed form; None where it does not reach or fails its check."""
    times = scene.times
    motion = checked_states(form, times)
    if motion is None:
        return None
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
                f"expected accuracy {accuracy:.3g}; the closed form fails its check."
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

"""Closed form: the motion of a free body at any time, without steps, checked by the integrator."""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cached_property
from time import perf_counter
from typing import TYPE_CHECKING

import numpy as np

from geomtorsion.accuracy.truth import truth_of
from geomtorsion.errors import AccuracyError, TimeError
from geomtorsion.ode import solve
from geomtorsion.rigid import FreeTop, attitude, free_top
from geomtorsion.scenes.context import OMEGA, POSITION, QUATERNION, VELOCITY, VERTICAL
from geomtorsion.scenes.to_ode import parameters_of, start_of

if TYPE_CHECKING:
    from geomtorsion.scenes.scene import Scene

NAME = "free top (Jacobi elliptic functions)"
# The check follows so many turns, at a time in each: enough to see a wrong formula or a wrong start
# (the closed form gets no worse with time), and about a millisecond of integration.
CHECKED_TURNS = 32
# The check is at least so accurate, however little is asked for, so that the estimate is not far
# above the true error; it takes a millisecond either way.
CHECKED_ACCURACY = 1e-9
# Doubles do not suffice for this accuracy, so that the integrator takes more digits.
MORE_DIGITS = float(np.finfo(float).eps) / 8
# What the formulas lose themselves, on top of what the check can see: 16 roundings.
ROUNDING = 16 * float(np.finfo(float).eps)


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
        tensor = body.tensor
        if np.count_nonzero(tensor - np.diag(np.diagonal(tensor))) == 0:
            moments, axes = np.diagonal(tensor), np.eye(3)
        else:
            moments, axes = body.principal_moments, body.principal_axes
        omega = axes.T @ np.array([float(x) for x in start.omega or ()])
        q = start.attitude if start.attitude is not None else np.array([1.0, 0.0, 0.0, 0.0])
        turned = attitude.product(q, attitude.quaternion_from_matrix(axes))
        return free_top(tuple(moments.tolist()), tuple(omega), tuple(turned)), axes

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
    # A quarter leaves room for the error of the check itself.
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
    return math.inf, compiled

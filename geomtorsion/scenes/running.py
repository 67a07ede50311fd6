"""Running: a scene solved, in closed form where there is one, and what was watched read off."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property
from time import perf_counter
from typing import TYPE_CHECKING, Any

import numpy as np

from geomtorsion.errors import AccuracyError, StuckError, TimeError
from geomtorsion.motion import free_top, solve
from geomtorsion.motion.flows import reading
from geomtorsion.motion.solution import Cost
from geomtorsion.rigid import attitude
from geomtorsion.scenes.context import OMEGA, POSITION, QUATERNION, VELOCITY, VERTICAL
from geomtorsion.scenes.flowing import parameters_of, start_of
from geomtorsion.scenes.result import SceneResult

if TYPE_CHECKING:
    from pathlib import Path

    from geomtorsion.motion import Engine, FlowSolution
    from geomtorsion.scenes.scene import Scene

CLOSED = "free top (Jacobi elliptic functions)"
# The closed form is checked up to so many radians of turning, at so many times.
CHECKED_TURNS, CHECKED_TIMES = 200.0, 33
# Next to an unstable axis an integrator without more digits reaches a part of that only.
PARTS = (0.5, 0.25, 0.125)
# The integrator that checks is this much more accurate than what is asked for, and at least so.
CHECKED_PART, CHECKED_ACCURACY = 0.25, 1e-9
# For this accuracy doubles do not suffice.
MORE_DIGITS = 1e-17
# Rounding of the closed form, on top of what the check can see.
ROUNDING = 2.0**-48


@dataclass(frozen=True, eq=False)
class ClosedForm:
    """The motion of a free body at any time, without stepping.

    scene: its plan holds nothing but free rotation, and translation without forces.
    """

    scene: Scene

    @cached_property
    def _top(self) -> tuple[Any, np.ndarray]:
        """The free top in its principal axes, and these as columns in body axes."""
        body = self.scene.body
        tensor = body.tensor
        if np.count_nonzero(tensor - np.diag(np.diagonal(tensor))) == 0:
            moments, axes = tuple(body.exact_tensor[k][k] for k in range(3)), np.eye(3)
            moments = tuple(float(x) for x in moments)
        else:
            moments, axes = body.principal_moments, body.principal_axes
        state: Any = self.scene.start
        omega = axes.T @ np.array([float(x) for x in state.omega])
        q = state.attitude if state.attitude is not None else np.array([1.0, 0.0, 0.0, 0.0])
        turned = attitude.product(q, attitude.quaternion_from_matrix(axes))
        return free_top(tuple(moments), tuple(omega), tuple(turned)), axes

    def states(self, times: Any) -> np.ndarray:
        """States of the flow at the times, shape (m, size)."""
        top, axes = self._top
        columns: dict[str, Any] = {}
        names = self.scene.plan().states
        rates = top.omega(times) @ axes.T
        columns |= {s.name: rates[:, k] for k, s in enumerate(OMEGA)}
        if {QUATERNION[0].name, VERTICAL[0].name} & set(names):
            back = attitude.quaternion_from_matrix(axes.T)
            q = attitude.product(top.quaternion(times), back)
            first = attitude.product(top.quaternion(np.zeros(1)), back)[0]
            # Who watches an attitude was asked for a start with one.
            begin = self.scene.start.attitude  # type: ignore[union-attr]
            q = q if first @ begin >= 0 else -q
            columns |= {s.name: q[:, k] for k, s in enumerate(QUATERNION)}
            n = attitude.matrix_from_quaternion(q)[:, 2, :]
            columns |= {s.name: n[:, k] for k, s in enumerate(VERTICAL)}
        begin, speed = start_of(self.scene), parameters_of(self.scene)
        for place, velocity in zip(POSITION, VELOCITY, strict=True):
            if place.name in names:
                v = speed.get(velocity.name, begin.get(velocity.name, 0))
                columns[place.name] = float(begin[place.name]) + float(v) * times
        return np.stack([columns[name] for name in names], -1)


def closed_form(scene: Scene) -> ClosedForm | None:
    """The closed form of a scene, or None if it has none."""
    plan = scene.plan()
    made = plan.assembly
    here = set(plan.symbols)
    known = {*OMEGA, *QUATERNION, *VERTICAL, *POSITION}
    if made.constraint is not None or not here <= known or not here & set(known - {*POSITION}):
        return None
    acting = set(plan.effects) - {"spin", "drift"}
    if acting:
        return None
    if any(s in here and v not in plan.constants for s, v in zip(POSITION, VELOCITY, strict=True)):
        return None
    return ClosedForm(scene)


def read(scene: Scene, times: Any, states: Any) -> dict[str, Any]:
    """Watched quantities of states, shape (m, size), at these times."""
    found = reading.outputs(scene.flow, times, states)
    values = {}
    for item in scene.plan().watch:
        value = found[f"watch {item.name}"]
        if item.finish is not None:
            value = item.finish(value)
        values[item.name] = value if item.labels or value.ndim == 1 else value[:, 0]
    return values


def run(
    scene: Scene,
    engine: Engine | None = None,
    checkpoint: str | Path | None = None,
    progress: Callable[[float], None] | None = None,
) -> SceneResult:
    """Solve a scene; see `Scene.run`."""
    _ = scene.flow
    form = closed_form(scene) if engine is None else None
    if form is not None:
        found = _in_closed_form(scene, form)
        if found is not None:
            if progress is not None:
                progress(1.0)
            return found
    try:
        solved = solve(scene.flow, scene.times, scene.accuracy, engine, checkpoint, progress)
    except StuckError as stuck:
        # What was computed is told in the terms of the scene.
        if stuck.solution is not None:
            stuck.solution = of_solution(scene, stuck.solution)
        raise
    return of_solution(scene, solved)


def of_solution(scene: Scene, solved: FlowSolution) -> SceneResult:
    """The result of a scene from the solution of its flow."""
    states = np.asarray(solved.states, dtype=float)
    return _result(
        scene,
        times=solved.times,
        values=read(scene, solved.times, states),
        error=solved.error,
        drift=dict(solved.drift),
        cost=solved.cost,
        engine=solved.engine,
        why=solved.why,
        outcome=solved.outcome,
        closed_form=None,
        solved=solved,
    )


def _in_closed_form(scene: Scene, form: ClosedForm) -> SceneResult | None:
    """The result by the closed form; None where it does not reach or fails its check."""
    times = scene.times
    began = perf_counter()
    try:
        states = form.states(times)
    except (TimeError, OverflowError):
        return None
    if not np.isfinite(states).all():
        return None
    spent = perf_counter() - began
    began = perf_counter()
    error, compiled = _checked(scene, form, times)
    if not error <= scene.accuracy:
        return None
    check = perf_counter() - began - compiled
    return _result(
        scene,
        times=times,
        values=read(scene, times, states),
        error=error,
        drift=_drifts(scene, times, np.asarray(states)),
        cost=Cost(0, 0, compiled, spent, check),
        engine="closed form",
        why="a free body; checked against the integrator",
        outcome="done",
        closed_form=CLOSED,
        form=form,
    )


def _checked(scene: Scene, form: ClosedForm, times: Any) -> tuple[float, float]:
    """Difference to the integrator over the first turns, with its error; seconds of compiling.

    Where doubles lose too much (next to an unstable axis) the integrator has more digits.
    """
    state: Any = scene.start
    speed = math.hypot(*(float(x) for x in state.omega))
    last = float(times[-1])
    reach = min(abs(last), CHECKED_TURNS / speed if speed else abs(last))
    if reach == 0:
        return ROUNDING, 0.0
    asked = min(CHECKED_PART * scene.accuracy, CHECKED_ACCURACY)
    compiled = 0.0
    tries = [(1.0, asked), (1.0, min(asked, MORE_DIGITS)), *((part, asked) for part in PARTS)]
    for part, accuracy in tries:
        some = np.linspace(0.0, math.copysign(part * reach, last), CHECKED_TIMES)
        try:
            solved = solve(scene.flow, some, accuracy)
        except AccuracyError:
            continue
        compiled += solved.cost.compile_seconds
        error = _gap(scene, form.states(some), solved.states) + solved.error + ROUNDING
        if error <= scene.accuracy:
            return error, compiled
    return math.inf, compiled


def _gap(scene: Scene, ours: Any, theirs: Any) -> float:
    """Largest difference of states, each block against its own size."""
    theirs, worst = np.asarray(theirs, dtype=float), 0.0
    for block in scene.flow.system.blocks:
        places = list(block)
        size = np.abs(theirs[:, places]).max()
        gap = np.abs(ours[:, places] - theirs[:, places]).max()
        part = float(gap / size) if size else float(gap)
        worst = max(worst, part) if math.isfinite(part) else math.inf
    return worst


def _drifts(scene: Scene, times: Any, states: Any) -> dict[str, float]:
    """Largest relative change of each invariant along given states."""
    from types import SimpleNamespace

    # Of a solution no more is read than these three.
    return reading.drifts(SimpleNamespace(flow=scene.flow, times=times, states=states))  # type: ignore[arg-type]


def _result(scene: Scene, **known: Any) -> SceneResult:
    plan = scene.plan()
    return SceneResult(
        scene=scene,
        labels={item.name: item.labels for item in plan.watch},
        units={item.name: item.unit for item in plan.watch},
        accuracy=scene.accuracy,
        plan=plan,
        **known,
    )

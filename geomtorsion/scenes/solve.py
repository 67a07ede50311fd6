"""Solve: a scene solved, in closed form where there is one."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from geomtorsion.errors import StuckError
from geomtorsion.ode import solve
from geomtorsion.ode.solution import DOUBLE, Cost
from geomtorsion.scenes.closed_form import NAME, ClosedForm, checked_states, closed_form
from geomtorsion.scenes.result import SceneResult, result_of
from geomtorsion.scenes.to_ode import observed

if TYPE_CHECKING:
    from geomtorsion.ode import Engine, Solution
    from geomtorsion.scenes.scene import Scene


def solve_scene(
    scene: Scene,
    engine: Engine | None = None,
    checkpoint: str | Path | None = None,
    progress: Callable[[float], None] | None = None,
) -> SceneResult:
    """Solve a scene; see `Scene.run`."""
    # Equations that cannot be written down are refused before anything is computed.
    ode = scene.ode
    form = closed_form(scene) if engine is None else None
    if form is not None:
        found = _in_closed_form(scene, form)
        if found is not None:
            if progress is not None:
                progress(1.0)
            return found
    try:
        solved = solve(ode, scene.times, scene.accuracy, engine, checkpoint, progress)
    except StuckError as stuck:
        # What was computed so far is handed on as a result of the scene.
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
        # What was watched is handed out as doubles.
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
    found = checked_states(form, times)
    if found is None:
        return None
    changes = scene.ode.changes(times, found.states)
    return result_of(
        scene,
        times=times,
        values=observed(scene.ode, scene.selection, times, found.states),
        error=found.error,
        drift={name: float(change.max()) for name, change in changes.items()},
        cost=Cost(0, 0, found.compile_seconds, found.run_seconds, found.check_seconds),
        engine="closed form",
        reason="a free body; checked against the integrator",
        outcome="done",
        closed_form=NAME,
        form=form,
    )

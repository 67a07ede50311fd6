"""Accuracies: what accuracy costs in time, measured on a scene."""

from __future__ import annotations

import time
from collections.abc import Callable, Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from geomtorsion.accuracy.cost import ACCURACIES, WATCHED, CostRow, CostTable
from geomtorsion.errors import AccuracyError, GeomtorsionError
from geomtorsion.motion import Engine, RungeKutta, Taylor, solve
from geomtorsion.motion.engines.taylor import is_available
from geomtorsion.motion.solving import checked_accuracy
from geomtorsion.scenes.closed_form import closed_form

if TYPE_CHECKING:
    from geomtorsion.scenes.scene import Scene

# Bits of the numbers that serve as truth, and the accuracy asked of them.
BITS, TRUE = 113, 1e-22


def scene_accuracy(
    scene: Scene,
    engines: Sequence[Engine] | None = None,
    accuracies: Sequence[float] = ACCURACIES,
    progress: Callable[[float], object] = lambda _: None,
) -> CostTable:
    """Measure what each accuracy costs with each engine, on the equations of a scene.

    Errors are those of the states at the times of the scene, each block of states against its
    largest size: against the closed form where the scene has one, else against quadruple
    precision, else (without heyoka) against the most accurate Runge-Kutta solution.

    Raises
    ------
    AccuracyError
        an accuracy is not a positive number, or none is given.

    Examples
    --------
    >>> from geomtorsion.scenes import load
    >>> table = scene_accuracy(load("lagrange_cusp"), [RungeKutta()], [1e-6])
    >>> table.rows[0].holds
    True
    """
    asked = [checked_accuracy(accuracy) for accuracy in accuracies]
    if not asked:
        raise AccuracyError("no accuracy was given; give some, such as [1e-6, 1e-9].")
    solvers = list(engines or ([Taylor()] if is_available() else []) + [RungeKutta()])
    truth, name = _truth(scene)
    rows: list[CostRow] = []
    for solver in solvers:
        for accuracy in asked:
            rows.append(_row(scene, solver, accuracy, truth))
            progress(len(rows) / (len(solvers) * len(asked)))
    return CostTable(str(scene), float(scene.times[-1]), name, tuple(rows))


def _truth(scene: Scene) -> tuple[Any, str]:
    """States that count as true, shape (m, size), and what they are."""
    form = closed_form(scene)
    if form is not None:
        return np.asarray(form.states(scene.times), dtype=float), "the closed form"
    if is_available():
        solved = solve(scene.ode, scene.times, TRUE, Taylor(precision=BITS))
        return np.asarray(solved.states).astype(float), "quadruple precision"
    solved = solve(scene.ode, scene.times, 1e-13, RungeKutta())
    return np.asarray(solved.states, dtype=float), "the most accurate Runge-Kutta solution"


def _error(scene: Scene, states: Any, truth: Any) -> float:
    """Largest error, each block against its own largest size."""
    found = np.asarray(states).astype(float)
    count = min(len(found), len(truth))
    worst = 0.0
    for block in scene.ode.system.blocks:
        index = list(block)
        size = float(np.abs(truth[:, index]).max())
        gap = float(np.abs(found[:count, index] - truth[:count, index]).max())
        worst = max(worst, gap / size if size else gap)
    return worst


def _row(scene: Scene, engine: Engine, accuracy: float, truth: Any) -> CostRow:
    """Solve, repeat for the clock, measure the error."""
    try:
        first = solve(scene.ode, scene.times, accuracy, engine)
    except GeomtorsionError as error:
        note = str(error).split(". ")[0]
        return CostRow(engine.name, accuracy, None, None, None, None, 0.0, 0, 0, note)
    best, total = first, float("inf")
    began = time.perf_counter()
    while total == float("inf") or time.perf_counter() - began < WATCHED:
        start = time.perf_counter()
        found = solve(scene.ode, scene.times, accuracy, engine)
        total = min(total, time.perf_counter() - start)
        if found.cost.run_seconds < best.cost.run_seconds:
            best = found
    return CostRow(
        engine.name,
        accuracy,
        _error(scene, best.states, truth),
        best.error,
        best.cost.run_seconds,
        total,
        first.cost.compile_seconds,
        best.cost.steps,
        best.cost.evaluations,
    )

"""Accuracy table: what accuracy costs in time, measured on a scene."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace
from typing import TYPE_CHECKING

from geomtorsion.accuracy.cost import ACCURACIES, CostTable, accuracy_cost
from geomtorsion.ode import Engine
from geomtorsion.scenes.closed_form import closed_form

if TYPE_CHECKING:
    from geomtorsion.scenes.scene import Scene


def scene_accuracy(
    scene: Scene,
    engines: Sequence[Engine] | None = None,
    accuracies: Sequence[float] = ACCURACIES,
    progress: Callable[[float], object] = lambda _: None,
) -> CostTable:
    """Measure what each accuracy costs with each engine, on the equations of a scene.

    Errors are those of the states at the times of the scene, each group of states against its
    largest size: against the closed form where the scene has one, else against quadruple
    precision, else (without heyoka) against the most accurate Runge-Kutta solution.

    Raises
    ------
    AccuracyError
        an accuracy is not a positive number, or none is given.

    Examples
    --------
    >>> from geomtorsion.ode import RungeKutta
    >>> from geomtorsion.scenes import load
    >>> table = scene_accuracy(load("lagrange_cusp"), [RungeKutta()], [1e-6])
    >>> table.rows[0].holds
    True
    """
    form = closed_form(scene)
    exact = None if form is None else form.states
    table = accuracy_cost(
        scene.ode, scene.times, engines, accuracies, exact=exact, progress=progress
    )
    return replace(table, problem=str(scene))

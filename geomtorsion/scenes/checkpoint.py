"""Checkpoint: what a run that was stopped had computed, read from the file that kept it."""

from __future__ import annotations

import math
import re
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from geomtorsion.errors import CheckpointError
from geomtorsion.motion import Engine, RungeKutta, Stiff, Taylor
from geomtorsion.motion.engines.protocol import Run
from geomtorsion.motion.flows.checkpoint import LEGS, Checkpoint, fingerprint
from geomtorsion.motion.flows.travel import cut_legs, travel
from geomtorsion.motion.solution import Cost
from geomtorsion.motion.solving import checked_times
from geomtorsion.scenes.result import SceneResult, result_of
from geomtorsion.scenes.to_ode import observed

if TYPE_CHECKING:
    from geomtorsion.scenes.scene import Scene


def partial_result(scene: Scene, path: str | Path, engine: Engine | None = None) -> SceneResult:
    """The result of a scene up to where its run was stopped.

    Its error is infinite: that is known only when the run has come to its end.

    Parameters
    ----------
    scene, engine
        as they were run.
    path
        the checkpoint.

    Raises
    ------
    CheckpointError
        the file is no checkpoint, is that of another run, or holds nothing yet.

    Examples
    --------
    >>> from tempfile import TemporaryDirectory
    >>> from geomtorsion.scenes import load
    >>> scene = load("lagrange_cusp")
    >>> with TemporaryDirectory() as folder:
    ...     whole = scene.run(checkpoint=Path(folder, "run.npz"))
    ...     part = partial_result(scene, Path(folder, "run.npz"))
    >>> part.outcome, bool(abs(part["energy"] - whole["energy"]).max() < 1e-9)
    ('interrupted', True)
    """
    ode, (times, grid) = scene.ode, checked_times(scene.times)
    if not Path(path).exists():
        raise CheckpointError(f"{path}: there is no such checkpoint. Run the scene with it first.")
    saved = Checkpoint(path, fingerprint(ode, times, scene.accuracy, engine))
    found: dict[tuple[str, str, str], int] = {}
    for leg in saved.metadata["legs"]:
        name, tolerance, _, moved = leg.rsplit(" ", 3)
        found[name, tolerance, moved] = found.get((name, tolerance, moved), 0) + 1
    if not found:
        raise CheckpointError(f"{path}: nothing was computed yet. Run the scene again.")
    # Runs from a start that is moved only show how rounding grows.
    name, tolerance, moved = max(found, key=lambda key: (float(key[2]) == 0, found[key]))
    solver = engine if engine is not None and engine.name == name else _engine(name)

    def leg_run(
        leg: tuple[int, float],
        _: Engine,
        start: Sequence[float],
        __: Sequence[float],
        at: np.ndarray,
        ___: float,
    ) -> Run:
        """A leg from the file; where it has none, the end."""
        run = saved.known(f"{name} {tolerance} {leg[0]} {moved}", solver, at)
        if run is not None:
            return run
        none = np.zeros((0, len(start)))
        return Run(at[:0], none, float(at[0]), start, "interrupted", 0, 0, 0.0, 0.0)

    legs = cut_legs(ode, float(grid[-1]), LEGS)
    trip = travel(ode, solver, float(tolerance), grid, legs, leg_run)
    states = np.asarray(trip.states).astype(float)
    # The start is in the grid even where it was not asked for.
    states = states[len(grid) - len(times) :]
    reached = times[: len(states)]
    return result_of(
        scene,
        times=reached,
        values=observed(ode, scene.selection, reached, states),
        error=math.inf,
        drift={},
        cost=Cost(trip.steps, trip.evaluations, 0.0, trip.run_seconds, 0.0),
        engine=name,
        reason="kept from a run that was stopped",
        outcome="interrupted",
    )


def _engine(name: str) -> Engine:
    """The engine that calls itself so."""
    bits = re.fullmatch(r"Taylor\((\d+)\)", name)
    if bits is not None:
        return Taylor(precision=int(bits[1]))
    return next(engine for engine in (Taylor(), RungeKutta(), Stiff()) if engine.name == name)

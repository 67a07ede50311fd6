"""Checkpoint: what a run that was stopped had computed, read from the file that kept it."""

from __future__ import annotations

import math
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from geomtorsion.errors import CheckpointError
from geomtorsion.ode import Checkpoint, Cost, Engine, Run, Stage, integrate
from geomtorsion.ode.checkpoint import fingerprint, part_name
from geomtorsion.ode.engines.named import engine_named, is_own
from geomtorsion.ode.numbers import PARTS, checked_times
from geomtorsion.scenes.result import SceneResult, result_of
from geomtorsion.scenes.to_ode import observed
from geomtorsion.support.checks import shown

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
        the file is not a checkpoint, belongs to another run, or is still empty.

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
    own = None if engine is None else engine.name
    counts: dict[tuple[str, float, float], int] = {}
    for part in saved.parts:
        try:
            name, tolerance, perturbation, number = part.rsplit(" ", 3)
            key = name, float(tolerance), float(perturbation)
            if not is_own(name) and name != own:
                raise ValueError(name)
        except ValueError:
            raise CheckpointError(
                f"{path}: expected a checkpoint of a run, got a file with the part {shown(part)}. "
                "Remove the file, or name another."
            ) from None
        # Parts of runs that were cut at more times go by other numbers.
        if "/" not in number:
            counts[key] = counts.get(key, 0) + 1
    if not counts:
        raise CheckpointError(
            f"{path}: expected computed samples, got none yet. Run the scene again."
        )
    # Runs from a perturbed start only show how rounding grows.
    name, tolerance, perturbation = max(counts, key=lambda key: (key[2] == 0, counts[key]))
    solver = engine if engine is not None and own == name else engine_named(name)

    def from_file(k: int, stage: Stage, at: np.ndarray) -> Run:
        """A part from the file; where it has none, the end."""
        run = saved.known(part_name(solver, tolerance, perturbation, k), solver, stage, at)
        if run is not None:
            return run
        none = np.zeros((0, len(stage.start)))
        return Run(at[:0], none, float(at[0]), stage.start, "interrupted", 0, 0, 0.0, 0.0)

    end = float(grid[-1])
    cuts = [end * k / PARTS for k in range(1, PARTS)]
    stage = ode.first_stage(solver.precision, perturbation)
    trajectory = integrate(stage, grid, tolerance, solver, cuts=cuts, runner=from_file)
    rows = [ode.rows(segment, segment.states, "") for segment in trajectory.segments]
    states = np.concatenate(rows).astype(float)
    # The grid contains the start even if it was not requested.
    states = states[len(grid) - len(times) :]
    reached = times[: len(states)]
    return result_of(
        scene,
        times=reached,
        values=observed(ode, scene.selection, reached, states),
        error=math.inf,
        drift={},
        cost=Cost(trajectory.steps, trajectory.evaluations, 0.0, trajectory.run_seconds, 0.0),
        engine=name,
        reason="kept from a run that was stopped",
        outcome="interrupted",
    )

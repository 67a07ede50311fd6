"""Saving: everything about a run of a scene in one directory, and a film of it."""

from __future__ import annotations

import json
from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from geomtorsion.errors import SceneError
from geomtorsion.pictures import style as pictures
from geomtorsion.pictures.scene_film import block_sides, write_film
from geomtorsion.pictures.style import save
from geomtorsion.scenes.observables import FINE
from geomtorsion.scenes.plotting import album
from geomtorsion.scenes.result import write_csv
from geomtorsion.scenes.writing import write_file

if TYPE_CHECKING:
    from geomtorsion.scenes.result import SceneResult

# Enough for a screen, and files that are not large: the limit is 250 kB each, as a test says.
DPI = 92
TABLE, ARRAYS, FACTS, SCENE = "table.csv", "result.npz", "run.json", "scene.toml"


def write_run(
    result: SceneResult,
    directory: Path,
    form: str = "png",
    progress: Callable[[str], object] = lambda _: None,
) -> list[Path]:
    """Write table.csv, result.npz, run.json, scene.toml and, with matplotlib, the pictures.

    Everything is computed and drawn before the first file is written.

    Raises
    ------
    SceneError
        the result was loaded from a file.

    Examples
    --------
    >>> from tempfile import TemporaryDirectory
    >>> from geomtorsion.scenes import load
    >>> result = load("lagrange_cusp").with_values(watch=["nutation"]).run()
    >>> with TemporaryDirectory() as folder:
    ...     [path.name for path in write_run(result, Path(folder))][:4]
    ['table.csv', 'result.npz', 'run.json', 'scene.toml']
    """
    if result.scene is None:
        raise SceneError("a result from a file has no scene; run the scene and write that.")
    figures: dict[str, Any] = {}
    if pictures.can_draw():
        for name, (draw, _) in album(result).items():
            progress(f"drawing {name}")
            figures[f"{name}.{form}"] = draw(result)
    directory.mkdir(parents=True, exist_ok=True)
    written = [directory / name for name in (TABLE, ARRAYS, FACTS, SCENE)]
    write_csv(written[0], result.columns())
    result.save(written[1])
    facts = metadata(result) | {"table": TABLE, "pictures": list(figures)}
    written[2].write_text(json.dumps(facts, indent=2, ensure_ascii=False) + "\n", "utf-8")
    write_file(result.scene, written[3])
    for name, figure in figures.items():
        save(figure, directory / name, DPI)
        written.append(directory / name)
    return written


def metadata(result: SceneResult) -> dict[str, Any]:
    """What was solved, how and how well, ready for JSON."""
    scene = result.scene
    return {
        "name": getattr(scene, "name", ""),
        "title": getattr(scene, "title", ""),
        "watch": list(result.values),
        "units": dict(result.units),
        "t": float(result.times[-1]),
        "accuracy": result.accuracy,
        "error": result.error,
        "drift": {name: float(value) for name, value in result.drift.items()},
        "engine": result.engine,
        "reason": result.reason,
        "closed_form": result.closed_form,
        "outcome": result.outcome,
        "complete": result.complete,
        "cost": {name: float(value) for name, value in vars(result.cost).items()},
        "selection": str(result.selection).splitlines(),
    }


def write_scene_film(result: SceneResult, path: Path) -> Path:
    """Write a film of a scene (.gif or .mp4); the directory is made if it is missing.

    The attitude, if it was not watched, is solved for anew.

    Raises
    ------
    SceneError
        the result was loaded from a file.
    """
    scene = result.scene
    if scene is None:
        raise SceneError("a result from a file has no scene; run the scene and draw that.")
    names = ["matrix", *(["position"] if "position" in result.values else [])]
    if "matrix" not in result.values:
        result = scene.with_values(watch=names).run()
    # A film shows equal times in equal times, whatever times were asked for.
    times = np.linspace(float(result.times[0]), float(result.times[-1]), FINE)
    found = result.at(times)
    body = scene.body
    moments = np.linalg.eigvalsh(body.tensor) if body.moments is None else body.moments
    path.parent.mkdir(parents=True, exist_ok=True)
    write_film(
        path,
        times,
        found["matrix"].reshape(-1, 3, 3),
        found.get("position"),
        block_sides([float(x) for x in moments]),
        title=scene.title or scene.name,
    )
    return path

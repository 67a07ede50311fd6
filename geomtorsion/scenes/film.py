"""Film: a solved scene as a moving picture."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from geomtorsion.errors import SceneError
from geomtorsion.pictures.scene_film import block_sides, write_film
from geomtorsion.scenes.result import SceneResult

# What a film is drawn from, the accuracy that it needs at most, and its moments.
SEEN, ACCURACY, SAMPLES = ("matrix", "position"), 1e-8, 401


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
    names = [name for name in SEEN if name in result.values]
    if "matrix" not in names:
        names = list(dict.fromkeys(("matrix", *names)))
        result = scene.with_values(watch=names, accuracy=max(scene.accuracy, ACCURACY)).run()
    times = np.linspace(float(result.times[0]), float(result.times[-1]), SAMPLES)
    values = result.at(times)
    body = scene.body
    moments = np.linalg.eigvalsh(body.tensor) if body.moments is None else body.moments
    path.parent.mkdir(parents=True, exist_ok=True)
    write_film(
        path,
        times,
        values["matrix"].reshape(-1, 3, 3),
        values.get("position"),
        block_sides([float(x) for x in moments]),
        title=scene.title or scene.name,
    )
    return path

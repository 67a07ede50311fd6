"""Plotting: which pictures a result has, and how they are drawn."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from geomtorsion.errors import UnknownNameError
from geomtorsion.pictures.scene_attitude import (
    axes_picture,
    axis_picture,
    cones_picture,
    path_picture,
)
from geomtorsion.pictures.scene_cones import rolling_picture
from geomtorsion.pictures.scene_over_time import change_picture, trust_picture, watched_picture
from geomtorsion.pictures.style import FLAT, number, save
from geomtorsion.scenes.observables import FINE
from geomtorsion.scenes.selection import selection_figure
from geomtorsion.support import checks

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from geomtorsion.scenes.result import SceneResult

Draw = Callable[["SceneResult"], "Figure"]
# Effects outside of mechanics: such a scene is compared with the scene without them.
LAWS = frozenset({"naive", "torsion"})


def plot(result: SceneResult, path: str | Path | None = None, figure: str = "watched") -> Figure:
    """One of the `drawings` of a result; written to a file if a path is given."""
    choices = drawings(result)
    kind, remedy = "a figure of these outputs", "Watch more quantities for other figures."
    name = checks.known_name(
        figure, choices, "figure", UnknownNameError, expected=kind, remedy=remedy
    )
    drawn = choices[name][0](result)
    if path is not None:
        save(drawn, Path(path))
    return drawn


def drawings(result: SceneResult) -> dict[str, tuple[Draw, str]]:
    """Which pictures a result has: name -> (how to draw it, what it shows).

    Examples
    --------
    >>> from geomtorsion.scenes import load
    >>> list(drawings(load("lagrange_cusp").run()))
    ['watched', 'axis', 'trust', 'plan']
    """
    shown: dict[str, tuple[Draw, str]] = {
        "watched": (watched, "Everything that was watched, over time.")
    }
    values, scene = result.values, result.scene
    if "axis" in values and len(result.times) > 1:
        shown["axis"] = (axis, "The path of the tip of the axis on the sphere.")
    if "matrix" in values:
        shown["attitude"] = (attitude, "The axes of the body in space.")
    if scene is not None and scene.body.moments is not None and _turns(values.get("omega")):
        shown["cones"] = (cones, "How the body turns, seen from itself and from space.")
        if "matrix" in values:
            shown["rolling"] = (rolling, "The cone of the body rolls on the cone of space.")
    if "position" in values:
        shown["path"] = (path_in_space, "The path in space.")
    if scene is not None and LAWS & set(scene.keyed):
        shown["laws"] = (laws, "In comparison, the same start by the law that bodies obey.")
    if scene is not None:
        shown["trust"] = (trust, "Error, and drift of conserved quantities.")
        shown["plan"] = (
            plan,
            "The computed and the omitted states and effects.",
        )
    return shown


def _turns(omega: np.ndarray | None) -> bool:
    """Whether an angular velocity changes its direction in the body."""
    if omega is None or not np.abs(omega).max():
        return False
    return bool(np.abs(np.cross(omega, omega[0])).max() > FLAT * np.abs(omega).max() ** 2)


def finely(result: SceneResult, *names: str) -> list[Any]:
    """Times, and quantities of these names at them, close enough for smooth curves."""
    # A result from a file has no values between its times.
    if result.scene is None or len(result.times) >= FINE or len(result.times) < 2:
        return [result.times, *(result.values.get(name) for name in names)]
    times = np.linspace(float(result.times[0]), float(result.times[-1]), FINE)
    values = result.at(times)
    return [times, *(values.get(name) for name in names)]


def notes_of(result: SceneResult) -> list[str]:
    """One line on how good the numbers are."""
    error = number(float(f"{result.error:.1e}"))
    how = result.closed_form or result.engine
    ended = "" if result.outcome == "done" else f"; {result.outcome}"
    return [f"By {how}; error below {error}, {number(result.accuracy)} requested{ended}."]


def watched(result: SceneResult) -> Figure:
    """Everything that was watched, over time."""
    quantities = getattr(result.selection, "watch", ())
    times, *values = finely(result, *result.values)
    named = dict(zip(result.values, values, strict=True))
    # Nine lines are too many; the figure of the attitude shows them.
    shown = {name: x for name, x in named.items() if x[0].size < 9} or named
    return watched_picture(
        times,
        shown,
        result.units,
        result.labels,
        {item.name: f"{item.name.replace('_', ' ')}: {item.meaning}" for item in quantities},
        result.title,
        notes_of(result),
    )


def axis(result: SceneResult) -> Figure:
    """The tip of the axis on the sphere."""
    times, tips = finely(result, "axis")
    return axis_picture(times, tips, title=result.title, notes=notes_of(result))


def attitude(result: SceneResult) -> Figure:
    """The axes of the body on the sphere."""
    _, matrix = finely(result, "matrix")
    return axes_picture(matrix.reshape(-1, 3, 3), result.title, notes_of(result))


def cones(result: SceneResult) -> Figure:
    """Polhode and cones."""
    assert result.scene is not None
    moments = [float(x) for x in result.scene.body.moments or ()]
    _, omega, matrix = finely(result, "omega", "matrix")
    turned = None if matrix is None else matrix.reshape(-1, 3, 3)
    return cones_picture(moments, omega, turned, result.title, notes_of(result))


def rolling(result: SceneResult) -> Figure:
    """The cone of the body on the cone of space."""
    _, omega, matrix = finely(result, "omega", "matrix")
    return rolling_picture(omega, matrix.reshape(-1, 3, 3), result.title, notes_of(result))


def path_in_space(result: SceneResult) -> Figure:
    """The path in space, with the body on it."""
    _, places, matrix = finely(result, "position", "matrix")
    turned = None if matrix is None else matrix.reshape(-1, 3, 3)
    return path_picture({"position": places}, turned, result.title, notes_of(result))


def laws(result: SceneResult) -> Figure:
    """What should be constant, or the path, by this law and by that which bodies obey."""
    scene = result.scene
    assert scene is not None
    (key,) = LAWS & set(scene.keyed)
    effects = tuple(effect for effect in scene.effects if effect.key not in LAWS)
    other = replace(scene, effects=effects).run()
    if "position" in result.values:
        _, places = finely(result, "position")
        _, others = finely(other, "position")
        # A straight line soon leaves the helix behind: it is drawn as far as that reaches.
        way = np.linalg.norm(others - others[0], axis=1)
        near = way <= 2 * float(np.ptp(places, axis=0).max())
        names = ("autoparallel", "geodesic") if key == "torsion" else (key, "right")
        paths = dict(zip(names, (places, others[near]), strict=True))
        return path_picture(paths, title=result.title, notes=notes_of(result))
    names = [name for name in ("energy", "angular_momentum_space") if name in result.values]
    times, *ours = finely(result, *names)
    _, *theirs = finely(other, *names)
    pairs = zip(names, zip(theirs, ours, strict=True), strict=True)
    changes = {name: {"right": right, key: own} for name, (right, own) in pairs}
    return change_picture(times, changes, result.title, notes_of(result))


def trust(result: SceneResult) -> Figure:
    """Error and drift over time."""
    return trust_picture(
        result.times,
        result.changes(),
        result.error,
        result.accuracy,
        title=result.title,
        notes=notes_of(result),
    )


def plan(result: SceneResult) -> Figure:
    """Included and omitted states and effects."""
    # A result that was loaded has a text for its selection; `drawings` offers it no picture of one.
    return selection_figure(result.selection)  # type: ignore[arg-type]

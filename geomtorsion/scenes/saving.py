"""Saving: a scene as text that reads back, and a run with everything about it in one directory."""

from __future__ import annotations

import json
import math
from collections.abc import Callable, Iterable, Mapping
from dataclasses import MISSING, fields
from fractions import Fraction
from os import PathLike
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
import sympy as sp

from geomtorsion.errors import FileFormatError, SceneError
from geomtorsion.pictures import style as pictures
from geomtorsion.pictures.scene_film import block_sides, write_film
from geomtorsion.pictures.style import save
from geomtorsion.scenes.observables import FINE
from geomtorsion.scenes.plotting import drawings
from geomtorsion.scenes.scene import Scene
from geomtorsion.scenes.scene_files import START_UNITS
from geomtorsion.scenes.state import State
from geomtorsion.support.csv_table import write_csv
from geomtorsion.support.files import write_text, written

if TYPE_CHECKING:
    from geomtorsion.scenes.effects import Effect
    from geomtorsion.scenes.result import SceneResult


# Enough for a screen, and files that are not large: a test limits each to 250 kB.
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
        raise SceneError(
            "expected a result with its scene, got one from a file. Run the scene and write that "
            "result."
        )
    figures: dict[str, Any] = {}
    if pictures.can_draw():
        for name, (draw, _) in drawings(result).items():
            progress(f"drawing {name}")
            figures[f"{name}.{form}"] = draw(result)
    with written(directory, is_folder=True):
        paths = [directory / name for name in (TABLE, ARRAYS, FACTS, SCENE)]
    write_csv(paths[0], result.columns())
    result.save(paths[1])
    facts = metadata(result) | {"table": TABLE, "pictures": list(figures)}
    write_text(paths[2], json.dumps(facts, indent=2, ensure_ascii=False) + "\n")
    write_file(result.scene, paths[3])
    for name, figure in figures.items():
        save(figure, directory / name, DPI)
        paths.append(directory / name)
    return paths


def metadata(result: SceneResult) -> dict[str, Any]:
    """Scene, method and error of a result, ready for JSON."""
    scene = result.scene
    return {
        "name": getattr(scene, "name", ""),
        "title": getattr(scene, "title", ""),
        "watch": list(result.values),
        "units": dict(result.units),
        "t": float(result.times[-1]),
        "accuracy": result.accuracy,
        # JSON knows no infinity, which is the error of a run that was stopped.
        "error": result.error if math.isfinite(result.error) else None,
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
    """Write an animation of a scene (.gif or .mp4); the directory is made if it is missing.

    If the attitude is not an output, the scene is solved again.

    Raises
    ------
    SceneError
        the result was loaded from a file.
    """
    scene = result.scene
    if scene is None:
        raise SceneError(
            "expected a result with its scene, got one from a file. Run the scene and draw that "
            "result."
        )
    names = ["matrix", *(["position"] if "position" in result.values else [])]
    if "matrix" not in result.values:
        result = scene.with_values(watch=names).run()
    # An animation needs equidistant times, whatever times were requested.
    times = np.linspace(float(result.times[0]), float(result.times[-1]), FINE)
    values = result.at(times)
    body = scene.body
    moments = np.linalg.eigvalsh(body.tensor) if body.moments is None else body.moments
    with written(path.parent, is_folder=True):
        write_film(
            path,
            times,
            values["matrix"].reshape(-1, 3, 3),
            values.get("position"),
            block_sides([float(x) for x in moments]),
            title=scene.title or scene.name,
        )
    return path


# Lines of a list longer than this are broken, an entry each.
LONGEST = 88


def write_file(scene: Scene, path: str | PathLike[str], story: str = "") -> None:
    """Write a scene to a scene file, in SI units.

    Raises
    ------
    FileFormatError
        Something in the scene cannot be written: an expression that is not text, or a function.
    """
    text = to_toml(scene, story)
    write_text(path, text)


def to_toml(scene: Scene, story: str = "") -> str:
    """The text of a scene file; numbers are in SI units, with all their digits.

    Raises
    ------
    FileFormatError
        As for `write_file`.

    Examples
    --------
    >>> import geomtorsion as gt
    >>> scene = gt.Scene(gt.Body(moments=(1, 2, 3)), start=gt.State(omega=(0, 1, 0.1)),
    ...                  watch=["omega"], t=2.5, name="top")
    >>> print(to_toml(scene))
    name = "top"
    watch = ["omega"]
    t = 2.5
    accuracy = 1e-10
    <BLANKLINE>
    [body]
    mass = 1.0
    moments = [1, 2, 3]
    <BLANKLINE>
    [start]
    omega = [0, 1, 0.1]
    <BLANKLINE>
    """
    head = {"name": scene.name, "title": scene.title, "story": story}
    body = scene.body
    parts = [
        "".join(_line(key, text) for key, text in head.items() if text)
        + _line("watch", list(scene.watch))
        + _line("t", scene.t)
        + _line("accuracy", scene.accuracy)
        + (_line("samples", scene.samples) if scene.samples != Scene.samples else ""),
        "[body]\n"
        + _line("mass", body.mass)
        + (
            _line("moments", body.moments)
            if body.moments is not None
            else _line("inertia", body.inertia)
        ),
    ]
    parts += [_effect(effect) for effect in scene.effects]
    start = {key: getattr(scene.start, key) for key in START_UNITS}
    # A convention without angles, or the default, is not written.
    if start["euler"] is None or start["euler_convention"] == State.euler_convention:
        del start["euler_convention"]
    lines = "".join(_line(key, value) for key, value in start.items() if value is not None)
    if lines:
        parts.append(f"[start]\n{lines}")
    return "\n".join(parts)


def _effect(effect: Effect) -> str:
    """One table of [[effects]], without default values."""
    text = f"[[effects]]\n{_line('kind', effect.key)}"
    for item in fields(effect):
        value = getattr(effect, item.name)
        usual = item.default_factory() if item.default_factory is not MISSING else item.default
        if not item.init or value is None or _same(value, usual):
            continue
        text += _line(item.name, value)
    return text


def _same(value: Any, usual: Any) -> bool:
    """Whether a field has its default; arrays and tuples are compared by their entries."""
    if usual is MISSING or usual is None:
        return False
    return _written(value) == _written(usual)


def _line(key: str, value: Any) -> str:
    return f"{key} = {_written(value, len(key) + 3)}\n"


def _written(value: Any, indent: int = 0) -> str:
    """A value in TOML."""
    if isinstance(value, bool):
        return "true" if value else "false"
    if isinstance(value, str):
        return _text(value)
    if isinstance(value, Mapping):
        inside = ", ".join(f"{_key(key)} = {_written(part)}" for key, part in value.items())
        return f"{{{inside}}}" if not inside else f"{{ {inside} }}"
    if isinstance(value, Iterable):
        parts = [_written(part) for part in value]
        short = f"[{', '.join(parts)}]"
        if indent + len(short) <= LONGEST:
            return short
        return "[\n" + "".join(f"  {part},\n" for part in parts) + "]"
    if isinstance(value, int):
        return str(value)
    # Exact numbers would lose digits as TOML numbers: they are written as text and read exactly.
    if isinstance(value, Fraction):
        return _text(str(value))
    if hasattr(value, "free_symbols"):
        return _text(_with_all_digits(value))
    try:
        number = float(value)
    except (TypeError, ValueError):
        raise FileFormatError(
            f"expected numbers or expressions as text for a scene file, got {value!r}."
        ) from None
    if not math.isfinite(number):
        raise FileFormatError(f"expected a finite number for a scene file, got {value!r}.")
    return repr(number)


def _with_all_digits(value: sp.Expr) -> str:
    """An exact expression as text; its doubles, of which sympy writes 15 digits, read back."""
    doubles = {x for x in value.atoms(sp.Float) if sp.Rational(x) == sp.Rational(float(x))}
    # In brackets, since (-0.5)**x is not -0.5**x.
    texts = {x: repr(float(x)) if x > 0 else f"({float(x)!r})" for x in doubles}
    return str(value.xreplace({x: sp.Symbol(text) for x, text in texts.items()}))


def _text(value: str) -> str:
    """A text in quotes; one of several lines keeps them."""
    # JSON and TOML agree on texts, but for the character DEL.
    quoted = json.dumps(value, ensure_ascii=False).replace("\x7f", "\\u007f")
    if "\\n" not in quoted or '"""' in value or "\\\\" in quoted:
        return quoted
    return '"""\n' + quoted[1:-1].replace("\\n", "\n").replace('\\"', '"') + '"""'


def _key(key: Any) -> str:
    name = str(key)
    return name if name.isidentifier() and name.isascii() else _text(name)

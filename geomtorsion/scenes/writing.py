"""Writing: a scene as the text of a scene file, which reads back as the same scene."""

from __future__ import annotations

import json
import math
from collections.abc import Iterable, Mapping
from dataclasses import MISSING, fields
from fractions import Fraction
from os import PathLike
from pathlib import Path
from typing import TYPE_CHECKING, Any

from geomtorsion.errors import FileFormatError
from geomtorsion.scenes.files import START_UNITS
from geomtorsion.scenes.scene import Scene
from geomtorsion.scenes.state import State

if TYPE_CHECKING:
    from geomtorsion.scenes.effects import Effect
# Lines of a list longer than this are broken, an entry each.
LONGEST = 88


def write_file(scene: Scene, path: str | PathLike[str], story: str = "") -> None:
    """Write a scene to a scene file, in SI units.

    Raises
    ------
    FileFormatError
        Something in the scene cannot be written down: an expression that is no text, a function.
    """
    Path(path).write_text(to_toml(scene, story), "utf-8")


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
    # A convention without angles, or the usual one, says nothing.
    if start["euler"] is None or start["euler_convention"] == State.euler_convention:
        del start["euler_convention"]
    lines = "".join(_line(key, value) for key, value in start.items() if value is not None)
    if lines:
        parts.append(f"[start]\n{lines}")
    return "\n".join(parts)


def _effect(effect: Effect) -> str:
    """One table of [[effects]], without what is as it would be anyway."""
    text = f"[[effects]]\n{_line('kind', effect.key)}"
    for item in fields(effect):
        value = getattr(effect, item.name)
        usual = item.default_factory() if item.default_factory is not MISSING else item.default
        if not item.init or value is None or _same(value, usual):
            continue
        text += _line(item.name, value)
    return text


def _same(value: Any, usual: Any) -> bool:
    """Whether a field has its default; arrays and tuples are compared by what is in them."""
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
    # Exact numbers would lose digits as TOML numbers: they stand as text, and are read exactly.
    if isinstance(value, Fraction):
        return _text(str(value))
    if hasattr(value, "free_symbols"):
        return _text(str(value))
    try:
        number = float(value)
    except (TypeError, ValueError):
        raise FileFormatError(
            f"{value!r} cannot be written to a scene file. Give numbers, or expressions as text."
        ) from None
    if not math.isfinite(number):
        raise FileFormatError(f"{value!r} is not finite and has no place in a scene file.")
    return repr(number)


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

"""Files: a scene file (TOML) read into a scene; nothing in it is ever run as code."""

from __future__ import annotations

import re
from collections.abc import Callable, Iterable, Iterator, Mapping
from contextlib import contextmanager
from dataclasses import MISSING, fields, replace
from os import PathLike
from pathlib import Path
from typing import Any

from geomtorsion.errors import FileFormatError, GeomtorsionError
from geomtorsion.exact.names import CONSTANTS, FUNCTIONS
from geomtorsion.exact.units import quantity, scale_of, with_unit
from geomtorsion.ode import Table
from geomtorsion.scenes.body import Body
from geomtorsion.scenes.effects import EFFECTS, Effect
from geomtorsion.scenes.scene import Scene
from geomtorsion.scenes.state import State
from geomtorsion.support.files import Key, TomlFile, read_toml

_WORD = re.compile(r"[^\W0-9]\w*")
_QUOTED = re.compile(r"'([^']*)'")
# Messages of an effect about its fields begin like this, with its key: thrust2.force[2].
_FIELD = re.compile(r"(\w+)(?:\.(\w+)(?:\[(\d+)\])?|:)")


@contextmanager
def placed(file: TomlFile, key: Key, what: str, known: Iterable[str] = ()) -> Iterator[None]:
    """Add file and line to errors inside: the line of the first key that the error names.

    Parameters
    ----------
    key
        Where it is read; it is named if the message speaks of nothing below it.
    what
        Put before the message.
    known
        Keys below this one.

    Raises
    ------
    FileFormatError
        Something went wrong inside.

    Examples
    --------
    >>> from geomtorsion.errors import SceneError
    >>> from geomtorsion.support.files import read_toml_text
    >>> file = read_toml_text("[body]\\nmass = 1\\nmoments = [1, 2, 4]", "a.toml")
    >>> with placed(file, ("body",), "body: ", ["mass", "moments"]):
    ...     raise SceneError("moments cannot be.")
    Traceback (most recent call last):
    geomtorsion.errors.FileFormatError: a.toml: line 3: body: moments cannot be.
    """
    try:
        yield
    except FileFormatError:
        raise
    except GeomtorsionError as error:
        text = str(error)
        # Errors come from deep inside and know no file: the key is found by what they speak of.
        named = _of_effect(file.data, text)
        # `t = 1` speaks of t more surely than a word in passing.
        words = sorted(_WORD.finditer(text), key=lambda w: not re.match(r" =|\[", text[w.end() :]))
        named += [(*key, word[0]) for word in words if word[0] in known]
        named += [path for word in _QUOTED.findall(text) for path in _leaves(file.data, word)]
        there = next((path for path in named if file.line(path) and path[: len(key)] == key), key)
        # A message that begins with the name of its part does not get it twice.
        spoken = what.rstrip(": ")
        prefix = "" if spoken and re.match(rf"{re.escape(spoken)}\b", text) else what
        file.fail(there, f"{prefix}{text}")


def _of_effect(data: Mapping[str, object], text: str) -> list[Key]:
    """The field of an effect that a message begins with; a second spring is spring2."""
    match, tables = _FIELD.match(text), data.get("effects")
    count: dict[object, int] = {}
    for number, table in enumerate(tables if isinstance(tables, list) and match else ()):
        kind = table.get("kind") if isinstance(table, dict) else None
        count[kind] = count.get(kind, 0) + 1
        if match and match[1] == f"{kind}{count[kind] if count[kind] > 1 else ''}":
            field: Key = ("effects", number, match[2] or "kind")
            return [(*field, int(match[3])) if match[3] else field]
    return []


def _leaves(value: object, text: str, path: Key = ()) -> Iterator[Key]:
    """Position of a text in the content of a file."""
    if isinstance(value, dict):
        for key, inside in value.items():
            yield from _leaves(inside, text, (*path, key))
    elif isinstance(value, list):
        for number, inside in enumerate(value):
            yield from _leaves(inside, text, (*path, number))
    elif value == text:
        yield path


# The last sentence of an error in the form of a file.
ADVICE = 'Put expressions and numbers with units in quotes, as in "9.81 m/s^2".'
TEXT_KEYS = ("name", "title", "story")
KEYS = (*TEXT_KEYS, "watch", "t", "accuracy", "samples", "body", "effects", "start")
START_UNITS: Mapping[str, str | None] = {
    "omega": "rad/s",
    "euler": "rad",
    "quaternion": "",
    "matrix": "",
    "position": "m",
    "velocity": "m/s",
    "euler_convention": None,
}
# Shape -> its maker and the keys that it takes, with their units.
SHAPES: Mapping[str, tuple[Callable[..., Body], Mapping[str, str]]] = {
    "": (Body, {"mass": "kg", "moments": "kg m^2", "inertia": "kg m^2"}),
    "box": (Body.box, {"mass": "kg", "sides": "m"}),
    "ellipsoid": (Body.ellipsoid, {"mass": "kg", "semiaxes": "m"}),
    "cylinder": (Body.cylinder, {"mass": "kg", "radius": "m", "height": "m"}),
    "points": (Body.points, {"points": ""}),
}


def read_file(path: str | PathLike[str]) -> Scene:
    """Read a scene from a scene file.

    Keys
    ----
    name, title, story
        Texts; the default name is the name of the file.
    watch
        List of outputs: "nutation", "energy", ...
    t, accuracy, samples
        How long (s), the accuracy of the result (relative), and how many times are reported; t may
        also be the list of these times.
    [body]
        mass with moments or inertia; or shape = "box" with sides, "ellipsoid" with semiaxes,
        "cylinder" with radius and height (mass with each), "points" with points =
        [{mass = 1, place = [1, 0, 0]}, ...].
    [[effects]]
        kind = "gravity" and so on, with the fields of the effect.
    [start]
        omega, euler or quaternion or matrix, position, velocity, euler_convention.

    Numbers are numbers, or texts with an exact expression and a unit: "9.81 m/s^2", "3 rpm",
    "20 deg", "sqrt(2)/2 kg m^2". A unit that does not measure what the field measures is refused.

    Raises
    ------
    FileFormatError
        The file cannot be read, is not TOML, has an unknown key, a value of the wrong kind or unit,
        or describes an impossible scene; the message names file, line and the nearest key.
    LimitError
        The file is too large.

    Examples
    --------
    >>> from pathlib import Path
    >>> from tempfile import TemporaryDirectory
    >>> text = '''watch = ["omega"]
    ... t = 1
    ... [body]
    ... moments = [1, 2, 3]
    ... [start]
    ... omega = [0, "30 rpm", 0]
    ... '''
    >>> with TemporaryDirectory() as folder:
    ...     file = Path(folder, "top.toml")
    ...     _ = file.write_text(text)
    ...     scene = read_file(file)
    >>> scene.name, round(scene.start.omega[1], 6)
    ('top', 3.141593)
    """
    file = read_toml(path, advice=ADVICE)
    return scene_from(_with_tables(file, Path(path).parent), Path(path).stem)


def _with_tables(file: TomlFile, folder: Path) -> TomlFile:
    """The file with the rows of the tables in its folder that it names.

    Raises
    ------
    FileFormatError
        A table is not in the folder of the file, or has no two columns.
    """
    listed = file.data.get("effects", [])
    effects = list(listed) if isinstance(listed, list) else []
    for number, effect in enumerate(effects):
        tables = effect.get("tables") if isinstance(effect, dict) else None
        if not isinstance(tables, dict):
            continue
        read: dict[str, object] = {}
        for name, value in tables.items():
            key: Key = ("effects", number, "tables", name)
            options = value if isinstance(value, dict) else {"rows": value}
            rows = options.get("rows")
            read[name] = value
            if isinstance(rows, str):
                if Path(rows).name != rows:
                    file.fail(
                        key,
                        f"tables: expected the name of a file beside the scene, got {rows!r}. Put "
                        "it into the same folder.",
                    )
                with placed(file, key, "tables: "):
                    table = Table.of(folder / rows)
                pairs = list(zip(table.places.tolist(), table.values.tolist(), strict=True))
                read[name] = {**options, "rows": pairs}
        effects[number] = {**effect, "tables": read}
    return file if not effects else replace(file, data={**file.data, "effects": effects})


def scene_from(file: TomlFile, name: str = "") -> Scene:
    """The scene that the content of a scene file describes.

    Raises
    ------
    FileFormatError
        As for `read_file`.
    """
    data = file.data
    for key in data:
        if key not in KEYS:
            file.unknown((key,), KEYS, f"unknown key {key!r}")
    if "body" not in data:
        file.fail((), "a scene has a body: [body] and below it moments = [1, 2, 3].")
    arguments: dict[str, Any] = {
        "name": _text(file, "name") or name,
        "title": _text(file, "title"),
        "effects": tuple(_effects(file)),
    }
    if "watch" in data:
        arguments["watch"] = _watch(file)
    for key, unit in (("t", "s"), ("accuracy", ""), ("samples", "")):
        if key in data:
            arguments[key] = _numbers(file, (key,), data[key], unit)
    body = _body(file)
    arguments["start"] = _start(file)
    # What does not fit together is seen by the scene; the file adds the line.
    with placed(file, (), "", KEYS):
        scene = Scene(body, **arguments)
    # A start that contradicts a constraint shows only when its numbers are worked out.
    if "start" in data:
        with placed(file, ("start",), "", START_UNITS):
            _ = scene.numbers
    return scene


def _text(file: TomlFile, key: str) -> str:
    value = file.data.get(key, "")
    if not isinstance(value, str):
        file.fail((key,), f"{key}: expected text in quotes, got {value!r}.")
    return value


def _watch(file: TomlFile) -> list[str]:
    """The outputs: one text, or a list of them."""
    value = file.data.get("watch", [])
    names = [value] if isinstance(value, str) else value
    if not isinstance(names, list) or not all(isinstance(name, str) for name in names):
        file.fail(("watch",), f'watch: expected a list of names, got {value!r}: ["energy"].')
    return names


def _body(file: TomlFile) -> Body:
    table = _table(file, "body", file.data["body"])
    shape = table.get("shape", "")
    if not isinstance(shape, str) or shape not in SHAPES:
        shapes = [name for name in SHAPES if name]
        file.fail(("body", "shape"), f"body: {shape!r} is not a shape. Known: {', '.join(shapes)}.")
    maker, units = SHAPES[shape]
    for key in table:
        if key not in units and key != "shape":
            what = f"body: unknown key {key!r}" + (f" of a {shape}" if shape else "")
            file.unknown(("body", key), ["shape", *units], what)
    if shape == "points":
        with placed(file, ("body",), "body: ", units):
            return maker(_points(file, table.get("points")))
    values = {
        key: _numbers(file, ("body", key), table[key], unit)
        for key, unit in units.items()
        if key in table
    }
    missing = [key for key in units if key not in values] if shape else []
    if missing:
        file.fail(("body",), f"body: a {shape} needs {', '.join(units)}; {missing[0]} is missing.")
    with placed(file, ("body",), "body: ", units):
        return maker(**values)


def _points(file: TomlFile, value: Any) -> list[tuple[Any, Any]]:
    """Point masses: tables with mass and place."""
    key: Key = ("body", "points")
    if not isinstance(value, list) or not value:
        file.fail(key, "body: expected points = [{mass = 1, place = [1, 0, 0]}, ...].")
    points = []
    for number, point in enumerate(value):
        if not isinstance(point, dict) or set(point) != {"mass", "place"}:
            file.fail((*key, number), f"body: point {number}: expected mass and place.")
        mass = _numbers(file, (*key, number), point["mass"], "kg")
        points.append((mass, _numbers(file, (*key, number), point["place"], "m")))
    return points


def _effects(file: TomlFile) -> Iterator[Effect]:
    """Effects in their order."""
    tables = file.data.get("effects", [])
    if not isinstance(tables, list):
        file.fail(("effects",), 'effects: write [[effects]] and below it kind = "gravity".')
    kinds = {effect.key: effect for effect in EFFECTS}
    for number, table in enumerate(tables):
        key: Key = ("effects", number)
        if not isinstance(table, dict) or not isinstance(table.get("kind"), str):
            file.fail(key, f'effects[{number}]: kind = "..." is missing: {", ".join(kinds)}.')
        kind = table["kind"]
        if kind not in kinds:
            # The nearest name is looked for as the last part of the key.
            near = TomlFile(file.name, file.data, {(*key, kind): file.line((*key, "kind"))})
            near.unknown((*key, kind), list(kinds), f"there is no effect {kind!r}")
        yield _effect(file, key, kinds[kind], table)


def _effect(file: TomlFile, key: Key, maker: type[Effect], table: Mapping[str, Any]) -> Effect:
    field_of = {item.name: item for item in fields(maker) if item.init}
    units = maker.units()
    values: dict[str, Any] = {}
    for name, value in table.items():
        if name == "kind":
            continue
        if name not in field_of:
            file.unknown((*key, name), ["kind", *field_of], f"{maker.key}: unknown key {name!r}")
        values[name] = (
            _numbers(file, (*key, name), value, units[name], texts=True)
            if name in units
            else _plain(value)
        )
    for name, item in field_of.items():
        if name not in values and item.default is MISSING and item.default_factory is MISSING:
            unit = f" ({units[name]})" if units.get(name) else ""
            file.fail(key, f"{maker.key}: {name}{unit} is missing.")
    tables = values.get("tables", {})
    for name, rows in tables.items() if isinstance(tables, dict) else ():
        if isinstance(rows.get("rows") if isinstance(rows, dict) else rows, str):
            # Only a scene that is read from a folder may name a file in it.
            file.fail((*key, "tables", name), f"tables: expected rows of {name}, got {rows!r}.")
    with placed(file, key, f"{maker.key}: ", field_of):
        return maker(**values)


def _start(file: TomlFile) -> State:
    table = _table(file, "start", file.data.get("start", {}))
    values: dict[str, Any] = {}
    for name, value in table.items():
        if name not in START_UNITS:
            file.unknown(("start", name), list(START_UNITS), f"start: unknown key {name!r}")
        unit = START_UNITS[name]
        values[name] = value if unit is None else _numbers(file, ("start", name), value, unit)
    with placed(file, ("start",), "start: ", START_UNITS):
        return State(**values)


def _table(file: TomlFile, name: str, value: Any) -> Mapping[str, Any]:
    if not isinstance(value, dict):
        file.fail((name,), f"{name}: expected a table, got {value!r}. Write [{name}].")
    return value


def _numbers(file: TomlFile, key: Key, value: Any, unit: str, *, texts: bool = False) -> Any:
    """Numbers in the unit of their field, lists as tuples; with texts also expressions."""
    if isinstance(value, list):
        return tuple(
            _numbers(file, (*key, number), part, unit, texts=texts)
            for number, part in enumerate(value)
        )
    name = "".join(f"[{part}]" if isinstance(part, int) else f".{part}" for part in key)
    with placed(file, key, f"{name.removeprefix('.')}: "):
        if texts and isinstance(value, str):
            expression, own_unit = with_unit(value)
            names = set(_WORD.findall(expression)) - set(FUNCTIONS) - set(CONSTANTS)
            # With names in it, it is an expression of time and state, left to the effect to read.
            if names:
                scale = 1.0 if own_unit is None else scale_of(own_unit, unit)
                return expression if scale == 1 else f"({scale!r})*({expression})"
        return quantity(value, unit)


def _plain(value: Any) -> Any:
    """A value without a unit, lists as tuples."""
    return tuple(_plain(part) for part in value) if isinstance(value, list) else value

"""Loop files: loops from plain data, JSON or CSV."""

from __future__ import annotations

import csv
import io
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING, Any

import sympy as sp

from geomtorsion.errors import FileFormatError, GeomtorsionError
from geomtorsion.exact import parse_expression
from geomtorsion.loops.loop import Loop
from geomtorsion.loops.symbol_values import refuse_undeclared_turns
from geomtorsion.loops.validation import TWO_SIDES
from geomtorsion.support import checks
from geomtorsion.support.files import plain_float, read_json_text, read_text

if TYPE_CHECKING:
    from geomtorsion.geometry import Frame

# Kind of loop -> keys that are needed, keys that may be there.
KINDS: Mapping[str, tuple[tuple[str, ...], tuple[str, ...]]] = {
    "circle": (("centre", "radius"), ("plane",)),
    "ellipse": (("centre", "axes"), ("plane",)),
    "polygon": (("vertices",), ("centre", "size")),
    "plaquette": (("corner", "steps"), ("plane",)),
    "curve": (("expressions",), ("parameter", "interval", "centre", "size", "periods")),
    "spline": (("points",), ("centre", "size")),
}
COMMON = ("name", "times")


def loop_from_data(frame: Frame, data: Any, where: str = "loop") -> Loop:
    """A loop from a mapping such as {"circle": {"centre": [0, 0], "radius": "1/2"}, "times": 2}.

    Exactly one key names the kind: circle (centre, radius, plane), ellipse (centre, axes, plane),
    polygon (vertices, centre, size), plaquette (corner, steps, plane), curve (expressions,
    parameter, interval, centre, size, periods), spline (points, centre, size); name and times are
    optional. Periods are {coordinate: period}, such as {"phi": "2*pi"}. Numbers may be text
    such as "pi/2"; a plane is two coordinates, by number or name, or two vectors.

    Raises
    ------
    FileFormatError
        A key is missing, unknown or of the wrong kind; the message names it.
    LoopError
        The loop is none: it does not close, has no length, or is not finite.
    ExpressionError
        An expression cannot be read.

    Examples
    --------
    >>> from geomtorsion.geometry import Frame
    >>> plane = Frame("x y", [[1, 0], [0, 1]])
    >>> loop = loop_from_data(plane, {"circle": {"centre": [0, 0], "radius": "1/2"}, "times": 2})
    >>> loop.size, loop.winding([0, 0])
    (0.5, 2)
    """
    data = _keyed(data, (*KINDS, *COMMON), where)
    kinds = [key for key in data if key in KINDS]
    if len(kinds) != 1:
        came = " and ".join(kinds) or "none"
        raise FileFormatError(f"{where}: expected exactly one of {', '.join(KINDS)}, got {came}.")
    (kind,) = kinds
    inner, place = data[kind], f"{where}: {kind}"
    needed, others = KINDS[kind]
    inner = _keyed(inner, (*needed, *others), place)
    checks.check_values(needed, inner, place, FileFormatError, "Add the key {missing}.")
    values = {key: _value(frame, key, value, place) for key, value in inner.items()}
    name = data.get("name", kind)
    checks.text(name, f"{where}: name", FileFormatError)
    maker = {"curve": Loop.parametric}.get(kind) or getattr(Loop, kind)
    try:
        loop = maker(**values, name=name)
        refuse_undeclared_turns(frame, loop)
        return loop.times(data["times"]) if "times" in data else loop
    except GeomtorsionError as error:
        raise type(error)(f"{where}: {error}") from None


def _keyed(data: object, known: Sequence[str], where: str) -> dict[str, Any]:
    """A mapping with known keys."""
    return checks.known_keys(data, known, where, FileFormatError, expected="a known key")


def _value(frame: Frame, key: str, value: Any, where: str) -> Any:
    """The value of one key: expressions stay text, a plane may name coordinates."""
    if key in ("expressions", "parameter"):
        return value
    if key == "plane":
        return plane_of(frame, value, where)
    if key == "periods":
        names = [symbol.name for symbol in frame.coordinates]
        checks.known_keys(value, names, f"{where}: periods", FileFormatError)
        return {
            names.index(name): _numbers(period, f"{where}: periods: {name}")
            for name, period in value.items()
        }
    return _numbers(value, f"{where}: {key}")


def plane_of(frame: Frame, value: object, where: str) -> tuple[Any, Any]:
    """Two coordinates, by number or name, or two vectors."""
    subject = f"{where}: plane"
    names = [symbol.name for symbol in frame.coordinates]
    sides = []
    for side in checks.entries(value, subject, FileFormatError, 2, expected=TWO_SIDES):
        if not isinstance(side, str):
            sides.append(_numbers(side, subject))
        elif side.isdigit() and side not in names:
            sides.append(int(side))
        else:
            kind = "a coordinate"
            name = checks.known_name(side, names, subject, FileFormatError, expected=kind)
            sides.append(names.index(name))
    return sides[0], sides[1]


def _numbers(value: Any, where: str) -> Any:
    """Numbers at any depth of lists; text is read as an exact number."""
    if isinstance(value, list | tuple):
        return [_numbers(part, f"{where}[{k}]") for k, part in enumerate(value)]
    if isinstance(value, str):
        return number_of(value, where)
    return checks.exact_number(value, where, FileFormatError)


def number_of(text: str, where: str) -> float | sp.Expr:
    """A number from text: decimal, or an exact expression such as pi/2.

    Raises
    ------
    ExpressionError
        The text is not a number.

    Examples
    --------
    >>> number_of("0.25", "radius"), number_of("2*pi/3", "angle")
    (0.25, 2*pi/3)
    """
    try:
        return int(text) if text.strip().lstrip("+-").isdigit() else plain_float(text)
    except ValueError:
        value = parse_expression(text, {}, {}, where=where)
    if isinstance(value, sp.Expr) and value.is_real is not False:
        return value
    raise FileFormatError(f"{where}: expected a real number, got {checks.shown(text)}.")


TOP_KEYS = ("loops", "parameters", "accuracy")


@dataclass(frozen=True)
class LoopFile:
    """Content of a file of loops.

    loops: the loops in order. parameters: values of the frame's parameters, by name.
    accuracy: the requested relative error, or None.
    """

    loops: tuple[Loop, ...]
    parameters: dict[str, float | sp.Expr] = field(default_factory=dict)
    accuracy: float | None = None


def read_loops(frame: Frame, path: str | Path) -> LoopFile:
    """Read loops from a JSON or CSV file.

    JSON: a list of loops as `loop_from_data` takes them, or {"loops": [...], "parameters": {...},
    "accuracy": ...}. CSV with a column for every coordinate: and a column radius (and perhaps
    plane, two coordinate names): one circle per row; or a column loop: one vertex per row, rows of
    one name being a polygon.

    Raises
    ------
    FileFormatError
        The file cannot be read, is truncated or malformed; the message names place and reason.
    LoopError
        An entry is not a loop; the message names it.
    LimitError
        The file is too large.
    """
    path = checks.file_name(path)
    reader = loops_from_csv if path.suffix.lower() == ".csv" else loops_from_json
    # A million circles take no more bytes.
    return reader(frame, read_text(path, largest=50_000_000), path.name)


def loops_from_json(frame: Frame, text: str, where: str = "loops") -> LoopFile:
    """Read loops from JSON text; see `read_loops`.

    Examples
    --------
    >>> from geomtorsion.geometry import Frame
    >>> plane = Frame("x y", [[1, 0], [0, 1]])
    >>> text = '[{"polygon": {"vertices": [[0, 0], [1, 0], [0, 1]]}}]'
    >>> loops_from_json(plane, text).loops[0].name
    'polygon'
    """
    data = read_json_text(text, where)
    if isinstance(data, list):
        data = {"loops": data}
    if not isinstance(data, dict) or not isinstance(data.get("loops"), list) or not data["loops"]:
        raise FileFormatError(
            f'{where}: expected a list of loops or {{"loops": [...]}} with at least one.'
        )
    _keyed(data, TOP_KEYS, where)
    subject = f"{where}: parameters"
    table, kind = data.get("parameters", {}), "names with values"
    parameters = checks.instance(table, dict, subject, FileFormatError, expected=kind)
    accuracy: Any = data.get("accuracy")
    if accuracy is not None:
        checks.number(accuracy, f"{where}: accuracy", FileFormatError)
    return LoopFile(
        loops=tuple(
            loop_from_data(frame, item, f"{where}: loops[{k}]")
            for k, item in enumerate(data["loops"])
        ),
        parameters={
            name: number_of(value, f"{where}: {name}") if isinstance(value, str) else value
            for name, value in parameters.items()
        },
        accuracy=accuracy,
    )


def loops_from_csv(frame: Frame, text: str, where: str = "loops") -> LoopFile:
    """Read circles or polygons from CSV text; see `read_loops`.

    Examples
    --------
    >>> from geomtorsion.geometry import Frame
    >>> plane = Frame("x y", [[1, 0], [0, 1]])
    >>> loops_from_csv(plane, "x,y,radius\\n0,0,1\\n2,0,1e-9\\n").loops[1].size
    1e-09
    """
    rows = list(csv.reader(io.StringIO(text), skipinitialspace=True))
    rows = [(k + 1, row) for k, row in enumerate(rows) if any(cell.strip() for cell in row)]
    if not rows:
        raise FileFormatError(f"{where}: the file is empty.")
    header = [cell.strip() for cell in rows[0][1]]
    names = [symbol.name for symbol in frame.coordinates]
    missing = [name for name in names if name not in header]
    if missing or len(set(header)) != len(header) or not {"radius", "loop"} & set(header):
        raise FileFormatError(
            f"{where}: line 1: the header is {checks.shown(', '.join(header))}; needed are "
            f"{', '.join(names)} and either radius (circles) or loop (vertices of polygons)."
        )
    table = []
    for line, row in rows[1:]:
        if len(row) != len(header):
            raise FileFormatError(
                f"{where}: line {line}: expected {len(header)} columns, got {len(row)}. "
                "Is the file complete?"
            )
        table.append((line, dict(zip(header, (cell.strip() for cell in row), strict=True))))
    if not table:
        raise FileFormatError(f"{where}: the file has a header, but no rows.")
    maker = _circles if "radius" in header else _polygons
    return LoopFile(tuple(maker(frame, names, table, where)))


Table = Sequence[tuple[int, dict[str, str]]]


def _circles(frame: Frame, names: list[str], table: Table, where: str) -> list[Loop]:
    """One circle per row."""
    circles = []
    for line, row in table:
        place = f"{where}: line {line}"
        plane = plane_of(frame, row["plane"].split(), place) if row.get("plane") else (0, 1)
        centre = [_cell(row, name, place) for name in names]
        name = row.get("name") or row.get("loop") or f"line {line}"
        try:
            circles.append(Loop.circle(centre, _cell(row, "radius", place), plane, name=name))
        except GeomtorsionError as error:
            raise type(error)(f"{place}: {error}") from None
    return circles


def _polygons(_: Frame, names: list[str], table: Table, where: str) -> list[Loop]:
    """One polygon for each name in the column loop."""
    corners: dict[str, list[list[float | sp.Expr]]] = {}
    for line, row in table:
        point = [_cell(row, name, f"{where}: line {line}") for name in names]
        corners.setdefault(row["loop"], []).append(point)
    polygons = []
    for name, vertices in corners.items():
        try:
            polygons.append(Loop.polygon(vertices, name=name))
        except GeomtorsionError as error:
            raise type(error)(f"{where}: loop {name}: {error}") from None
    return polygons


def _cell(row: dict[str, str], name: str, where: str) -> float | sp.Expr:
    """A number of a row."""
    return number_of(row[name], f"{where}: {name}")

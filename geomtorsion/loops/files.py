"""Files: lists of loops from JSON or CSV."""

from __future__ import annotations

import csv
import io
import json
from collections.abc import Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING, Any, NoReturn

from geomtorsion.errors import FileFormatError, GeomtorsionError, LimitError
from geomtorsion.loops.describe import loop_from_data, number_of, plane_of
from geomtorsion.loops.loop import Loop

if TYPE_CHECKING:
    from geomtorsion.geometry import Frame

LARGEST_FILE = 50_000_000
TOP_KEYS = ("loops", "parameters", "accuracy")


@dataclass(frozen=True)
class LoopFile:
    """What a file of loops says.

    loops: the loops in order. parameters: values of the frame's parameters, by name.
    accuracy: the relative error asked for, or None.
    """

    loops: tuple[Loop, ...]
    parameters: dict[str, Any] = field(default_factory=dict)
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
        One of the loops is none; the message says which.
    LimitError
        The file is too large.
    """
    path = Path(path)
    try:
        size = path.stat().st_size
        if size > LARGEST_FILE:
            raise LimitError(f"{path.name}: {size:,} bytes; the limit is {LARGEST_FILE:,}.")
        text = path.read_text("utf-8-sig")
    except OSError as error:
        reason = error.strerror or type(error).__name__
        raise FileFormatError(f"{path}: the file cannot be read: {reason}.") from None
    except UnicodeDecodeError:
        raise FileFormatError(f"{path.name}: the file is no UTF-8 text.") from None
    reader = loops_from_csv if path.suffix.lower() == ".csv" else loops_from_json
    return reader(frame, text, path.name)


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

    def refuse(word: str) -> NoReturn:
        raise FileFormatError(f"{where}: {word} is no number that JSON knows.")

    try:
        data = json.loads(text, parse_constant=refuse)
    except json.JSONDecodeError as error:
        raise FileFormatError(
            f"{where}: line {error.lineno}, column {error.colno}: this is no JSON: {error.msg}. "
            "Is the file complete?"
        ) from None
    except RecursionError:
        raise LimitError(f"{where}: lists are nested too deeply to be read.") from None
    if isinstance(data, list):
        data = {"loops": data}
    if not isinstance(data, dict) or not isinstance(data.get("loops"), list) or not data["loops"]:
        raise FileFormatError(
            f'{where}: a list of loops was needed, or {{"loops": [...]}} with at least one.'
        )
    for key in data:
        if key not in TOP_KEYS:
            raise FileFormatError(f"{where}: unknown key {key!r}. Known are {', '.join(TOP_KEYS)}.")
    parameters, accuracy = data.get("parameters", {}), data.get("accuracy")
    if not isinstance(parameters, dict):
        raise FileFormatError(f"{where}: parameters: names and values were needed.")
    if accuracy is not None and (
        isinstance(accuracy, bool) or not isinstance(accuracy, float | int)
    ):
        raise FileFormatError(f"{where}: accuracy: a number was needed, but {accuracy!r} came.")
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
            f"{where}: line 1: the header is {', '.join(header)!r}; needed are "
            f"{', '.join(names)} and either radius (circles) or loop (vertices of polygons)."
        )
    table = []
    for line, row in rows[1:]:
        if len(row) != len(header):
            raise FileFormatError(
                f"{where}: line {line}: {len(header)} columns were needed, but {len(row)} came. "
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
    found = []
    for line, row in table:
        place = f"{where}: line {line}"
        plane = plane_of(frame, row["plane"].split(), place) if row.get("plane") else (0, 1)
        centre = [_cell(row, name, place) for name in names]
        name = row.get("name") or row.get("loop") or f"line {line}"
        try:
            found.append(Loop.circle(centre, _cell(row, "radius", place), plane, name=name))
        except GeomtorsionError as error:
            raise type(error)(f"{place}: {error}") from None
    return found


def _polygons(_: Frame, names: list[str], table: Table, where: str) -> list[Loop]:
    """One polygon for each name in the column loop."""
    corners: dict[str, list[list[Any]]] = {}
    for line, row in table:
        point = [_cell(row, name, f"{where}: line {line}") for name in names]
        corners.setdefault(row["loop"], []).append(point)
    found = []
    for name, vertices in corners.items():
        try:
            found.append(Loop.polygon(vertices, name=name))
        except GeomtorsionError as error:
            raise type(error)(f"{where}: loop {name}: {error}") from None
    return found


def _cell(row: dict[str, str], name: str, where: str) -> Any:
    """A number of a row."""
    return number_of(row[name], f"{where}: {name}")

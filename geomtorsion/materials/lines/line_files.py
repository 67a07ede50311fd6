"""Line files: dislocation networks in the format given by the end of a name, and back."""

from __future__ import annotations

import json
import re
from collections.abc import Hashable, Mapping, Sequence
from fractions import Fraction
from os import PathLike
from pathlib import Path
from typing import Any

import numpy as np

from geomtorsion.errors import FileFormatError, GeomtorsionError, NetworkError
from geomtorsion.loops import Number
from geomtorsion.materials.lines.box import Box
from geomtorsion.materials.lines.crystal_analysis import (
    Clusters,
    crystal_analysis_text,
    read_crystal_analysis,
)
from geomtorsion.materials.lines.line_arrays import LineArrays
from geomtorsion.materials.lines.paradis import paradis_text, read_paradis
from geomtorsion.materials.lines.polylines import Polyline
from geomtorsion.materials.lines.reactions import Vector
from geomtorsion.support import checks
from geomtorsion.support.checks import file_name
from geomtorsion.support.file_kinds import naming_other_kinds
from geomtorsion.support.files import conforming, ending, read_json_text, read_text

FORMAT = {"format": "geomtorsion dislocation lines", "version": 1}
_FRACTION = re.compile(r"(-?[0-9]{1,30})/([1-9][0-9]{0,29})")


@naming_other_kinds("lines")
def read_lines(
    path: str | PathLike[str], periodic: bool = True
) -> tuple[LineArrays, list[tuple[Number, ...]] | None]:
    """Lines from a ParaDiS file, or from .ca and .json, whose boxes contain their periodicity.

    Files packed by gzip or bzip2 (.data.gz, .ca.gz) are unpacked while they are read.

    Returns
    -------
    The lines, and their b if the file has them more exactly than floats.

    Raises
    ------
    FileFormatError
        The file is missing, truncated or malformed; the message names the line if there is one.
    """
    kind = ending(path)
    if kind == ".vtk":
        raise FileFormatError(
            f"{Path(path).name}: expected a file that holds a network with its box, got a VTK "
            "file, which holds no box. Save the network as .json, .ca or .data, and read that file."
        )
    if kind == ".json":
        return read_json_lines(path)
    return (read_crystal_analysis(path) if kind == ".ca" else read_paradis(path, periodic)), None


def lines_text(
    path: str | PathLike[str],
    lines: LineArrays,
    curves: Sequence[Polyline],
    vectors: Sequence[Vector],
    clusters: Clusters,
) -> str:
    """A network as the text of a file with such a name.

    Parameters
    ----------
    curves
        Its polylines.
    vectors
        b of each line, exact where it is.
    clusters
        The grains of the polylines.

    Raises
    ------
    NetworkError
        The format cannot hold the network; the message gives the reason.
    """
    kind = ending(path)
    if kind != file_name(path).suffix.lower():
        raise NetworkError(
            f"{file_name(path).name}: expected the name of a plain file, such as lines.data, got "
            "the name of a packed file. Save it without the last ending, then pack it with gzip."
        )
    if kind == ".vtk":
        return vtk_text(curves)
    if kind == ".ca":
        return crystal_analysis_text(lines, curves, *clusters)
    return json_text(lines, vectors) if kind == ".json" else paradis_text(lines)


# -- VTK ------------------------------------------------------------------------------------------


def vtk_text(curves: Sequence[Polyline]) -> str:
    """Lines as a legacy VTK file: straight pieces, with `line` (the number) and `burgers` of each.

    Raises
    ------
    NetworkError
        b does not have three components.
    """
    for curve in curves:
        if len(curve.burgers) != 3:
            raise NetworkError(
                f"expected three components of b for a VTK file, got {len(curve.burgers)}. Save "
                "the network as .json."
            )
    places = [place for curve in curves for place in curve.points.tolist()]
    cells, numbers, vectors, first = [], [], [], 0
    for k, curve in enumerate(curves):
        count = len(curve.points) - 1
        cells += [f"2 {first + j} {first + j + 1}" for j in range(count)]
        numbers += [str(k)] * count
        vectors += [" ".join(repr(float(x)) for x in curve.burgers)] * count
        first += count + 1
    rows = [
        "# vtk DataFile Version 3.0", "dislocation lines by geomtorsion", "ASCII",
        "DATASET UNSTRUCTURED_GRID", f"POINTS {len(places)} double",
        *(" ".join(map(repr, place)) for place in places),
        # Three whole numbers a piece; 3 is the VTK type of a straight piece, read by all programs.
        f"CELLS {len(cells)} {3 * len(cells)}", *cells,
        f"CELL_TYPES {len(cells)}", *["3"] * len(cells), f"CELL_DATA {len(cells)}",
        "SCALARS line int 1", "LOOKUP_TABLE default", *numbers,
        "VECTORS burgers double", *vectors,
    ]  # fmt: skip
    return "\n".join(rows) + "\n"


# -- JSON -----------------------------------------------------------------------------------------

_ENTRY = (float, str)
_FORM = {
    "format": str,
    "version": int,
    "box": (None, {"vectors": [[float]], "origin": [float], "periodic": [bool]}),
    "nodes": [{"name": (int, str, [int]), "position": [float], "constraint": int}],
    "lines": [{"nodes": [int], "burgers": [_ENTRY], "image?": [int], "plane?": [float]}],
}


def json_text(lines: LineArrays, vectors: Sequence[Vector]) -> str:
    """A network as JSON that reads as the same network; fractions stay exact, as "1/2".

    Raises
    ------
    NetworkError
        A name of a node is not a whole number, a text or a list of whole numbers, or b is neither
        rational nor a float.
    """
    box = lines.box
    nodes = [
        {"name": _name(label), "position": place, "constraint": constraint}
        for label, place, constraint in zip(
            lines.labels, lines.positions.tolist(), lines.constraint_list, strict=True
        )
    ]
    rows = []
    for k, (pair, b) in enumerate(zip(lines.pairs.tolist(), vectors, strict=True)):
        row: dict[str, Any] = {"nodes": pair, "burgers": [_written(x) for x in b]}
        if box is not None:
            row["image"] = lines.image_list[k]
        if lines.planes is not None:
            row["plane"] = lines.planes[k].tolist()
        rows.append(row)
    document = {
        **FORMAT,
        "box": None
        if box is None
        else {
            "vectors": np.asarray(box.vectors).tolist(),
            "origin": np.asarray(box.origin).tolist(),
            "periodic": np.asarray(box.periodic).tolist(),
        },
        "nodes": nodes,
        "lines": rows,
    }
    return json.dumps(document, indent=1, allow_nan=False) + "\n"


def _name(label: Hashable) -> int | str | list[int]:
    """The name of a node in a form that JSON can keep."""
    plain = checks.plain(label)
    if isinstance(plain, str):
        return plain
    if (number := checks.whole(plain)) is not None:
        return number
    if isinstance(plain, tuple) and all(type(x) is int for x in plain):
        return list(plain)
    raise NetworkError(
        f"name of a node: expected a whole number, a text or a tuple of whole numbers for a JSON "
        f"file, got {checks.shown(label)}. Rename the node: networkx.relabel_nodes."
    )


def _written(value: object) -> float | int | str:
    """A component of b: whole numbers and floats as they are, fractions as text."""
    if isinstance(value, float):
        return value
    ratio = checks.fraction(value)
    if ratio is None:
        raise NetworkError(
            f"b: expected a rational number or a float for a JSON file, got {checks.shown(value)}. "
            "Give it as a float."
        )
    return ratio.numerator if ratio.denominator == 1 else f"{ratio.numerator}/{ratio.denominator}"


def read_json_lines(
    path: str | PathLike[str],
) -> tuple[LineArrays, list[tuple[Number, ...]]]:
    """Lines from JSON that `json_text` wrote, and their b, exact where they were written so.

    Raises
    ------
    FileFormatError
        The file is missing, is not JSON, or holds something else.
    """
    name = Path(path).name
    data = conforming(read_json_text(read_text(path, checks.LARGEST_ARRAYS), name), _FORM, name)
    came = {key: data[key] for key in FORMAT}
    if came != FORMAT:
        raise FileFormatError(
            f"{name}: expected {FORMAT}, got {checks.shown(came)}. Give a file that "
            "DislocationNetwork.save has written."
        )
    box, rows = data["box"], data["lines"]
    labels = [tuple(x["name"]) if isinstance(x["name"], list) else x["name"] for x in data["nodes"]]
    vectors = [tuple(_exact(x, name) for x in row["burgers"]) for row in rows]
    try:
        lines = LineArrays(
            np.array([x["position"] for x in data["nodes"]] or np.zeros((0, 3))),
            np.array([x["nodes"] for x in rows] or np.zeros((0, 2)), dtype=np.int64),
            np.array([[float(x) for x in b] for b in vectors] or np.zeros((0, 3))),
            None if box is None else Box(box["vectors"], box["origin"], box["periodic"]),
            _column(rows, "image", name),
            labels,
            np.array([x["constraint"] for x in data["nodes"]], dtype=np.int64),
            _column(rows, "plane", name),
        )
    except GeomtorsionError as error:
        raise FileFormatError(f"{name}: {error}") from None
    except (ValueError, OverflowError):
        raise FileFormatError(
            f"{name}: expected lists of equal lengths and whole numbers of 64 bits. A position, a "
            "pair or a b has another length or size. Is the file complete?"
        ) from None
    return lines, vectors


def _column(rows: Sequence[Mapping[str, Any]], key: str, name: str) -> list[Any] | None:
    """The values of all lines under a key, or None if no line has the key."""
    values = [row.get(key) for row in rows]
    if None not in values:
        return values or None
    if all(x is None for x in values):
        return None
    raise FileFormatError(
        f"{name}: lines[{values.index(None)}]: expected {key} as in other lines, got none. Give it "
        "in each line, or in none."
    )


def _exact(value: float | int | str, name: str) -> float | int | Fraction:
    """A component of b, exact where it was written exactly."""
    if not isinstance(value, str):
        return value
    match = _FRACTION.fullmatch(value)
    if match is None:
        raise FileFormatError(
            f'{name}: b: expected a number or a fraction such as "1/2", got '
            f"{checks.shown(value)}. Correct it."
        )
    return Fraction(int(match[1]), int(match[2]))

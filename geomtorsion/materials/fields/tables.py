"""Tables: sampled frames node by node, as CSV with a header, or as points of a VTK file."""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from itertools import product
from pathlib import Path
from typing import Any

import numpy as np

from geomtorsion.errors import LONGEST_SHOWN, FileFormatError, GridError
from geomtorsion.materials.columns import other_reader
from geomtorsion.materials.fields.contents import (
    TEXTS,
    Contents,
    guarded,
    module,
    periodic_names,
)
from geomtorsion.materials.fields.point_values import (
    PointValues,
    check_filled,
    displacement_in,
    nodes_of,
)
from geomtorsion.support.checks import cut, shown
from geomtorsion.support.files import BOUNDS, opened, read_text
from geomtorsion.support.npz import LARGEST_ARRAYS
from geomtorsion.support.outgoing import one_line, quiet_libraries
from geomtorsion.support.text_rows import number_table

_COLUMN = re.compile(r"(e|beta|sigma)_([0-9])_([0-9])")
# Reference of XDMF to an array in HDF5: file:/data set.
_HEAVY = re.compile(r">\s*([^<>]*?\.(?:h5|hdf5|hdf))\s*:")
_SAID = re.compile(r"#\s*(unit|vector_unit|source|signature|periodic)\s*:\s*(.*)")

# File ending of a mesh -> module of meshio that reads it.
MESHES = {
    ".vtk": "vtk", ".vtu": "vtu", ".msh": "gmsh", ".xdmf": "xdmf", ".xmf": "xdmf", ".inp": "abaqus",
}  # fmt: skip


def holds_coframe(path: Path) -> bool:
    """Whether a text file begins like a table of a coframe or a distortion with commas."""
    with opened(path) as file:
        text = file.read(BOUNDS.beginning).decode("utf-8-sig", "replace")
    rows = (row for row in text.splitlines() if row.strip() and not row.startswith("#"))
    return any(_COLUMN.fullmatch(name.strip()) for name in next(rows, "").split(","))


def read_csv(path: Path) -> Contents:
    """Read columns x, y, ..., e_0_0, e_0_1, ... (or beta_0_0, ...), sigma_0_0, ...; a node a line.

    Lines with # contain unit, vector_unit, source, signature and periodic. Nodes without a line,
    and values without a number, are holes.
    """
    lines = read_text(path, LARGEST_ARRAYS).splitlines()
    texts: dict[str, str] = {}
    first = 0
    while first < len(lines) and (not lines[first].strip() or lines[first].startswith("#")):
        match = _SAID.match(lines[first])
        if match:
            texts[match[1]] = match[2].strip()
        first += 1
    if first >= len(lines):
        raise FileFormatError(
            f"{path}: expected a header such as x,y,e_0_0,e_0_1, got none. Write the file again."
        )
    header = [name.strip() for name in lines[first].split(",")]
    axes, values = _header(path, header, first + 1)
    line_numbers = [k for k in range(first + 1, len(lines)) if lines[k].strip()]
    if not line_numbers:
        raise FileFormatError(
            f"{path}: expected nodes below the header, got none. Is the file complete?"
        )
    rows = [lines[k] for k in line_numbers]
    table, _ = number_table(path, [k + 1 for k in line_numbers], rows, len(header), split=",")
    columns = dict(zip(header, table.T, strict=True))
    options: dict[str, Any] = {key: texts[key] for key in TEXTS if key in texts}
    if "periodic" in texts:
        options["periodic"] = periodic_names(texts["periodic"], path)
    where = [f"line {k + 1}" for k in line_numbers]
    return _gridded(path, {name: columns[name] for name in axes}, columns, values, options, where)


def _header(path: Path, header: Sequence[str], line: int) -> tuple[list[str], str]:
    """Names of the axes, and the name of the values: e or beta."""
    kinds = {match[1] for name in header if (match := _COLUMN.fullmatch(name))}
    axes = [name for name in header if not _COLUMN.fullmatch(name)]
    if len(set(header)) != len(header) or len(kinds & {"e", "beta"}) != 1 or len(axes) < 2:
        raise FileFormatError(
            f"{path}: line {line}: expected different names of columns, first the axes, then "
            "e_0_0, e_0_1, ... or beta_0_0, ... (or x, y, u, v of a displacement), got "
            f"{cut(', '.join(header))}. {other_reader([','.join(header)], 'SampledFrame.read')}"
            'Rename the columns, or name them: columns={"x": 0, "y": 1, "u": 2, "v": 3} '
            "(--columns x=0,y=1,u=2,v=3)."
        )
    return axes, "e" if "e" in kinds else "beta"


def _gridded(
    path: Path,
    places: Mapping[str, np.ndarray],
    columns: Mapping[str, np.ndarray],
    kind: str,
    options: dict[str, Any],
    where: Sequence[str],
) -> Contents:
    """Contents from nodes in any order, on the grid of their coordinates."""
    axes, flat = nodes_of(path, places, where)
    shape = tuple(len(axis) for axis in axes)
    arrays = {
        name: _array(path, columns, name, flat, shape)
        for name in (kind, "sigma")
        if any(column.startswith(f"{name}_") for column in columns)
    }
    if "sigma" in arrays:
        options["sigma"] = arrays["sigma"]
    return Contents(axes, arrays[kind], tuple(places), kind == "beta", options)


def _array(
    path: Path,
    columns: Mapping[str, np.ndarray],
    kind: str,
    flat: np.ndarray,
    shape: tuple[int, ...],
) -> np.ndarray:
    """All columns of one kind as an array (rows, columns, grid...)."""
    keys = {
        (int(found[2]), int(found[3])): name
        for name in columns
        if (found := _COLUMN.fullmatch(name)) and found[1] == kind
    }
    rows, width = (max(key[k] for key in keys) + 1 for k in (0, 1))
    missing = [key for key in product(range(rows), range(width)) if key not in keys]
    if missing:
        i, mu = missing[0]
        raise FileFormatError(
            f"{path}: expected a column {kind}_{i}_{mu}, got none. Add the missing column."
        )
    check_filled(path, rows * width, shape)
    found = np.full((rows, width, int(np.prod(shape))), np.nan)
    for (i, mu), name in keys.items():
        found[i, mu, flat] = columns[name]
    return found.reshape(rows, width, *shape)


def _columns(contents: Contents) -> dict[str, np.ndarray]:
    """All values node by node, the last axis fastest."""
    mesh = np.meshgrid(*contents.axes, indexing="ij")
    columns = {name: axis.ravel() for name, axis in zip(contents.names, mesh, strict=True)}
    arrays = {"e": contents.values}
    if "sigma" in contents.options:
        d = len(contents.axes)
        shape = (len(contents.values), d, *contents.values.shape[2:])
        arrays["sigma"] = np.broadcast_to(contents.options["sigma"], shape)
    for kind, values in arrays.items():
        for i, mu in np.ndindex(*values.shape[:2]):
            columns[f"{kind}_{i}_{mu}"] = values[i, mu].ravel()
    return columns


def write_csv(path: Path, contents: Contents) -> None:
    """Write one line for each node; numbers read back as the same doubles."""
    columns = _columns(contents)
    comments = [
        f"# {key}: {one_line(contents.options[key])}" for key in TEXTS if contents.options.get(key)
    ]
    if "periodic" in contents.options:
        pairs = zip(contents.names, contents.options["periodic"], strict=True)
        comments.append("# periodic: " + " ".join(name for name, wraps in pairs if wraps))
    with path.open("w", encoding="utf-8") as stream:
        stream.writelines(f"{line}\n" for line in [*comments, ",".join(columns)])
        for row in zip(*(column.tolist() for column in columns.values()), strict=True):
            stream.write(",".join("" if x != x else repr(x) for x in row) + "\n")


# -- VTK ------------------------------------------------------------------------------------------


def read_vtk(path: Path) -> Contents:
    """Read points on a grid, with point data e_0_0, ... (or beta_0_0, ...), by meshio.

    Point data may also hold a displacement, as written by finite elements; see `read_mesh`. A
    coordinate that all points share is not an axis. Field data unit, vector_unit, source, periodic
    and names are texts, stored as UTF-8 codes, because meshio reads only numbers.
    """
    points, data, texts = _mesh(path)
    columns = {name: values.ravel() for name, values in data.items() if values.size == len(values)}
    chosen = {name: column for name, column in columns.items() if _COLUMN.fullmatch(name)}
    if not chosen and displacement_in(data) is not None:
        return _displaced(points, data, texts).gridded(path)
    names, places = _places(points, texts.pop("names", ""))
    _, kind = _header(path, [*names, *chosen], 1)
    where = [f"point {k}" for k in range(len(points))]
    options: dict[str, Any] = dict(texts)
    if "periodic" in texts:
        options["periodic"] = periodic_names(texts["periodic"], path)
    return _gridded(path, places, chosen, kind, options, where)


def read_mesh(path: Path) -> PointValues:
    """Read the displacement at the points of a mesh of finite elements, by meshio.

    It is a vector named displacement, u, U or DISP, or columns such as ux, uy, with any case of
    letters. A component normal to a plane mesh is omitted where it is zero.

    Raises
    ------
    FileFormatError
        The file is damaged, or has no displacement.
    """
    points, data, texts = _mesh(path)
    if displacement_in(data) is None:
        raise FileFormatError(
            f"{path}: expected point data displacement, u or U with two or three components, got "
            f"{cut(', '.join(data)) or 'none'}. Rename the field."
        )
    return _displaced(points, data, texts)


def _displaced(
    points: np.ndarray, data: Mapping[str, np.ndarray], texts: Mapping[str, str]
) -> PointValues:
    """Points of a mesh with a displacement."""
    values = displacement_in(data)
    assert values is not None
    _, places = _places(points, texts.get("names", ""))
    if len(values) > len(places) == 2 and not values[2].any():
        values = values[:2]
    where = [f"point {k}" for k in range(len(points))]
    return PointValues(places, values, where, texts.get("unit", ""), texts.get("vector_unit", ""))


def _places(points: np.ndarray, names: str) -> tuple[list[str], dict[str, np.ndarray]]:
    """Names of the axes along which points differ, and their coordinates."""
    wide = [k for k in range(points.shape[1]) if np.ptp(points[:, k]) > 0] if len(points) else []
    chosen = names.split()
    if len(chosen) != len(wide):
        chosen = ["xyz"[k] for k in wide]
    return chosen, {name: points[:, k] for name, k in zip(chosen, wide, strict=True)}


def _mesh(path: Path) -> tuple[np.ndarray, dict[str, np.ndarray], dict[str, str]]:
    """Points of a mesh, shape (n, d), its point data by name, and the texts of its field data."""
    meshio = module("meshio", path)
    kind = path.suffix.lower()
    reader = getattr(meshio, MESHES[kind])
    if MESHES[kind] == "xdmf":
        _check_heavy(path)

    def load() -> tuple[np.ndarray, dict[str, np.ndarray], dict[str, str]]:
        try:
            with quiet_libraries():
                mesh = reader.read(path)
        except Exception as error:  # noqa: BLE001
            # A damaged file makes meshio, and the parser of XML below it, raise many classes.
            raise ValueError(f"{type(error).__name__}: {error}") from None
        codes = _legacy_field(path) if kind == ".vtk" else mesh.field_data
        texts = {
            key: np.asarray(codes[key]).astype(np.uint8).tobytes().decode()
            for key in (*TEXTS, "periodic", "names")
            if key in codes and np.size(codes[key]) <= LONGEST_SHOWN
        }
        return np.asarray(mesh.points, float), {
            str(name): np.asarray(values, float)
            for name, values in mesh.point_data.items()
            if np.ndim(values) in (1, 2)
        }, texts  # fmt: skip

    return guarded(path, load)


def _check_heavy(path: Path) -> None:
    """Refuse an XDMF file whose arrays are in a file of another folder."""
    for found in _HEAVY.findall(read_text(path, LARGEST_ARRAYS)):
        if Path(found).name != found or "\\" in found:
            raise FileFormatError(
                f"{path.name}: expected arrays in a file beside it, got {shown(found)}. Copy the "
                "HDF5 file into the folder and write its name only."
            )


def write_vtk(path: Path, contents: Contents) -> None:
    """Write points, cells, point data and field data, such as for ParaView; holes are NaN."""
    meshio = module("meshio", path)
    d, shape = len(contents.axes), contents.values.shape[2:]
    if d not in (2, 3):
        raise GridError(f"{path}: expected a grid of two or three axes for VTK, got {d}. Use .npz.")
    columns = _columns(contents)
    points = np.zeros((int(np.prod(shape)), 3))
    for k, name in enumerate(contents.names):
        points[:, k] = columns.pop(name)
    corners = [(0, 0), (1, 0), (1, 1), (0, 1)]
    if d == 3:
        corners = [(*corner, k) for k in (0, 1) for corner in corners]
    numbers = np.arange(len(points)).reshape(shape)
    inner = [
        numbers[tuple(slice(c, n - 1 + c) for c, n in zip(corner, shape, strict=True))].ravel()
        for corner in corners
    ]
    kind = "quad" if d == 2 else "hexahedron"
    mesh = meshio.Mesh(points, [(kind, np.stack(inner, axis=1))], point_data=columns)
    xml = path.suffix.lower() == ".vtu"
    (meshio.vtu if xml else meshio.vtk).write(path, mesh)
    texts = {key: contents.options[key] for key in TEXTS if contents.options.get(key)}
    if "periodic" in contents.options:
        pairs = zip(contents.names, contents.options["periodic"], strict=True)
        texts["periodic"] = " ".join(name for name, wraps in pairs if wraps)
    texts["names"] = " ".join(contents.names)
    _add_field(path, texts, xml)


def _add_field(path: Path, said: Mapping[str, str], xml: bool) -> None:
    """Add field data, which meshio does not write, to a file written by meshio."""
    content = path.read_bytes()
    codes = {key: text.encode() for key, text in said.items()}
    if xml:
        mark, rows = b"<UnstructuredGrid>", [b"<FieldData>"]
        for key, text in codes.items():
            numbers = " ".join(map(str, text)).encode()
            rows.append(
                b'<DataArray type="UInt8" Name="%b" NumberOfTuples="%d" format="ascii">%b'
                b"</DataArray>" % (key.encode(), len(text), numbers)
            )
        rows.append(b"</FieldData>")
    else:
        mark, rows = b"DATASET UNSTRUCTURED_GRID", [b"", b"FIELD FieldData %d" % len(codes)]
        for key, text in codes.items():
            rows += [b"%b 1 %d vtktypeuint8" % (key.encode(), len(text)), text]
    head, separator, rest = content.partition(mark)
    path.write_bytes(head + separator + b"\n".join(rows) + rest)


def _legacy_field(path: Path) -> dict[str, np.ndarray]:
    """Field data of letters in the header of a legacy file, which meshio ignores."""
    field: dict[str, np.ndarray] = {}
    with path.open("rb") as stream:
        lines = [stream.readline(LONGEST_SHOWN) for _ in range(5)]
        words = lines[-1].split()
        if words[:1] != [b"FIELD"]:
            return field
        for _ in range(int(words[2])):
            name, width, count, kind = stream.readline(LONGEST_SHOWN).split()
            size = int(width) * int(count)
            if kind not in (b"vtktypeuint8", b"unsigned_char") or not 0 <= size <= LONGEST_SHOWN:
                break
            field[name.decode()] = np.frombuffer(stream.read(size), np.uint8)
            stream.readline()
    return field

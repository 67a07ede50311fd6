"""Point values: a field at the points of a file, on a grid or scattered."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from geomtorsion.errors import FileFormatError, GridError, LimitError
from geomtorsion.materials.fields.contents import Contents
from geomtorsion.materials.fields.grid import regular_axis
from geomtorsion.materials.fields.quantities import COMPONENTS
from geomtorsion.support.npz import most_unpacked

# Names of vectors in the results of finite elements, in lower case.
VECTORS = ("displacement", "displacements", "disp", "u", "d", "nodal displacement")


@dataclass(frozen=True, eq=False)
class PointValues:
    """A field at points of a file.

    places: name of each axis -> coordinates, shape (n,). values: displacement, shape (rows, n), or
    coframe or distortion, shape (rows, columns, n); NaN where nothing is known. where: line or
    number of each point, for messages. unit, vector_unit: of coordinates and displacement. form:
    displacement, coframe or distortion. source: origin of the values, in words. height: of a
    surface over its two axes, shape (n,).
    """

    places: Mapping[str, np.ndarray]
    values: np.ndarray
    where: Sequence[str]
    unit: str = ""
    vector_unit: str = ""
    form: str = "displacement"
    source: str = ""
    height: np.ndarray | None = None

    @property
    def options(self) -> dict[str, Any]:
        """Units that the file states, and the origin of the values."""
        texts = (
            ("unit", self.unit), ("vector_unit", self.vector_unit), ("source", self.source)
        )  # fmt: skip
        return {key: text for key, text in texts if text}

    def gridded(self, path: Path) -> Contents:
        """The values at the nodes of a grid; nodes without a point are holes.

        Raises
        ------
        FileFormatError
            The points are not a regular grid.
        """
        axes, flat = nodes_of(path, self.places, self.where)
        shape, rows = tuple(len(axis) for axis in axes), self.values.shape[:-1]
        check_filled(path, math.prod(rows), shape)
        values = np.full((*rows, math.prod(shape)), np.nan)
        values[..., flat] = self.values
        options = self.options
        if self.height is not None:
            options["height"] = np.full(math.prod(shape), np.nan)
            options["height"][flat] = self.height
            options["height"] = options["height"].reshape(shape)
        return Contents(
            axes, values.reshape(*rows, *shape), tuple(self.places), self.form == "distortion",
            options, self.form == "displacement",
        )  # fmt: skip


def displacement_in(data: Mapping[str, np.ndarray]) -> np.ndarray | None:
    """The displacement among the values at the points of a mesh, (rows, n); None without one.

    It is a vector with one of the `VECTORS` names, or two or three columns of `COMPONENTS`.
    """
    plain = {name.strip().lower(): values for name, values in data.items()}
    for name in VECTORS:
        values = plain.get(name)
        if values is not None and values.ndim == 2 and values.shape[1] in (2, 3):
            return values.T
    columns = [next((plain[n] for n in names if n in plain), None) for names in COMPONENTS]
    rows = [column.reshape(len(column)) for column in columns if column is not None]
    return np.array(rows) if len(rows) > 1 and columns[0] is not None else None


def nodes_of(
    path: Path, places: Mapping[str, np.ndarray], where: Sequence[str]
) -> tuple[list[np.ndarray], np.ndarray]:
    """The axes of the grid of nodes, and the number of each node in this grid.

    where: line or number of each node, for messages.
    """
    axes, index = [], []
    for name, column in places.items():
        bad = np.flatnonzero(~np.isfinite(column))
        if len(bad):
            raise FileFormatError(
                f"{path}: {where[bad[0]]}: expected a finite coordinate {name}, got "
                f"{column[bad[0]]}. Correct the row."
            )
        axis, inverse = np.unique(column, return_inverse=True)
        try:
            axes.append(regular_axis(axis, name))
        except GridError as error:
            raise FileFormatError(
                f"{path}: the nodes are not on a regular grid: {error} For values at "
                "scattered points use ScatteredFrame.read."
            ) from None
        index.append(inverse)
    shape = tuple(len(axis) for axis in axes)
    flat: np.ndarray = np.asarray(np.ravel_multi_index(tuple(index), shape))
    order: np.ndarray = np.argsort(flat, kind="stable")
    twice = np.flatnonzero(np.diff(flat[order]) == 0)
    if len(twice):
        one, two = order[twice[0] : twice[0] + 2].tolist()
        raise FileFormatError(
            f"{path}: expected each node once, got the same node in {where[one]} and {where[two]}. "
            "Keep one of them."
        )
    return axes, flat


def check_filled(path: Path, rows: int, shape: Sequence[int]) -> None:
    """Refuse a grid with many more nodes than rows in the file, from a few distant nodes."""
    size, most = 8 * rows * math.prod(shape), most_unpacked(path.stat().st_size)
    if size > most:
        raise LimitError(
            f"{path}: expected a grid of at most {most:,} bytes, for a file of this length, got "
            f"{size:,} bytes for {' x '.join(map(str, shape))} nodes, most of them missing. Give "
            "the part in which values are known, or save it as .npz."
        )

"""Nodes: points of a file as the nodes of a regular grid."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from pathlib import Path

import numpy as np

from geomtorsion.errors import FileFormatError, GridError, LimitError
from geomtorsion.materials.fields.grid import regular_axis
from geomtorsion.support.npz import most_unpacked


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
                f"{path}: the nodes are not on a regular grid: {error} For a displacement at "
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

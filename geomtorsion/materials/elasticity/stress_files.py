"""Files of stresses: xarray datasets and VTK."""

from __future__ import annotations

from collections.abc import Mapping
from importlib import import_module
from typing import Any

import numpy as np

from geomtorsion.errors import GridError, MissingExtraError
from geomtorsion.materials.elasticity.cell import Cell
from geomtorsion.support.checks import shown


def stress_dataset(
    cell: Cell, fields: Mapping[str, np.ndarray], remarks: Mapping[str, object]
) -> Any:  # xarray is not a dependency
    """Tensors of shape (3, 3, grid...) by name over the axes of a cell; remarks are attributes."""
    if not cell.is_along_axes:
        raise GridError(
            "to_xarray: expected a cell along the coordinates, got the edges "
            f"{shown(np.asarray(cell.box.vectors).tolist())}. Save it as .vtk, or use .stress."
        )
    try:
        xarray = import_module("xarray")
    except ImportError:
        raise MissingExtraError(
            "to_xarray needs xarray, which is not installed. Run `pip install "
            "'geomtorsion[files]'`."
        ) from None
    names = list("xyz")
    variables = {name: (["i", "j", *names], values) for name, values in fields.items()}
    coordinates = dict(zip(names, cell.axes, strict=True)) | {"i": names, "j": names}
    return xarray.Dataset(variables, coords=coordinates, attrs=dict(remarks))


def vtk_bytes(cell: Cell, mises: np.ndarray, fields: Mapping[str, np.ndarray]) -> bytes:
    """A legacy VTK file with von Mises' stress and tensors at the nodes of a cell."""
    nodes = cell.shape
    count = int(np.prod(nodes))
    parts = [
        b"# vtk DataFile Version 3.0\nstress by geomtorsion\nBINARY\nDATASET STRUCTURED_GRID\n",
        b"DIMENSIONS %d %d %d\nPOINTS %d double\n" % (*nodes, count),
        _numbers(cell.points()),
        b"\nPOINT_DATA %d\nSCALARS mises double 1\nLOOKUP_TABLE default\n" % count,
        _numbers(mises[None]),
    ]
    for name, values in fields.items():
        parts += [b"\nTENSORS %b double\n" % name.encode(), _numbers(values.reshape(9, *nodes))]
    return b"".join(parts) + b"\n"


def _numbers(values: np.ndarray) -> bytes:
    """Components of each node, the first axis of the grid fastest, as VTK orders them."""
    return values.transpose(3, 2, 1, 0).astype(">f8").tobytes()

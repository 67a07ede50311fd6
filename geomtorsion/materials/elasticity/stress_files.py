"""Stress files: a stress field for ParaView, and as an xarray Dataset."""

from __future__ import annotations

from importlib import import_module
from typing import TYPE_CHECKING, Any

import numpy as np

from geomtorsion.checks import shown
from geomtorsion.errors import GridError, MissingExtraError

if TYPE_CHECKING:
    from geomtorsion.materials.elasticity.stresses import Stresses


def stress_dataset(result: Stresses) -> Any:  # xarray is not a dependency
    """Stress, strain and distortion over the axes of the cell; attributes hold energy and units."""
    cell = result.cell
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
    dimensions, names = ("i", "j", "x", "y", "z"), list("xyz")
    fields = {"stress": result.stress, "strain": result.strain, "distortion": result.distortion}
    variables = {name: (dimensions, values) for name, values in fields.items()}
    coordinates = dict(zip(names, cell.axes, strict=True)) | {"i": names, "j": names}
    attributes = {
        "energy": result.energy, "error": result.error, "unit": result.unit,
        "length_unit": result.length_unit, "corrections": " ".join(result.corrections),
    }  # fmt: skip
    data = xarray.Dataset(variables, coords=coordinates, attrs=attributes)
    data["stress"].attrs["units"] = result.unit
    return data


def vtk_bytes(result: Stresses) -> bytes:
    """A legacy VTK file with the stress, strain and von Mises stress at the nodes."""
    nodes = result.cell.shape
    count = int(np.prod(nodes))
    parts = [
        b"# vtk DataFile Version 3.0\nstress by geomtorsion\nBINARY\nDATASET STRUCTURED_GRID\n",
        b"DIMENSIONS %d %d %d\nPOINTS %d double\n" % (*nodes, count),
        _numbers(result.cell.points()),
        b"\nPOINT_DATA %d\nSCALARS mises double 1\nLOOKUP_TABLE default\n" % count,
        _numbers(result.mises[None]),
    ]
    for name, values in ((b"stress", result.stress), (b"strain", result.strain)):
        parts += [b"\nTENSORS %b double\n" % name, _numbers(values.reshape(9, *nodes))]
    return b"".join(parts) + b"\n"


def _numbers(values: np.ndarray) -> bytes:
    """Components of each node, the first axis of the grid fastest, as VTK orders them."""
    return values.transpose(3, 2, 1, 0).astype(">f8").tobytes()

"""Atom arrays: positions in .npy and .npz files, with a cell that may be in the file or not."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from geomtorsion.errors import CrystalError
from geomtorsion.materials.crystals.atom_rows import AtomData
from geomtorsion.materials.crystals.given import POSITIONS, Given
from geomtorsion.materials.fields.contents import guarded
from geomtorsion.support.npz import ArrayForm, mapped_npy, read_npz

# Arrays of an .npz file. An .npy file holds only the positions.
_FORMS = {
    POSITIONS: ArrayForm((None, 3)),
    "cell": ArrayForm(optional=True),
    "periodic": ArrayForm((3,), "biu", optional=True),
}


def is_atom_array(path: Path) -> bool:
    """Whether the name of a file has the suffix of an array."""
    return path.suffix.lower() in (".npy", ".npz")


def read_atom_array(
    path: Path, cell: np.ndarray | None = None, periodic: tuple[bool, bool, bool] | None = None
) -> AtomData:
    """Atoms of an array of positions, shape (atoms, 3).

    cell, periodic: as for `Crystal`; if None, those in the file.

    Raises
    ------
    CrystalError
        Some axes are periodic, but neither the file nor the call gives a cell.
    FileFormatError
        The file is missing, damaged, or holds something else.
    """
    if path.suffix.lower() == ".npz":
        arrays = read_npz(path, _FORMS)
    else:
        # Mapped: a header that declares more than the file holds takes no memory.
        arrays = {POSITIONS: guarded(path, lambda: mapped_npy(path))}
    edges = arrays.get("cell") if cell is None else cell
    axes: tuple[bool, ...] = (True, True, True)
    if periodic is not None:
        axes = periodic
    elif "periodic" in arrays:
        axes = tuple(bool(flag) for flag in arrays["periodic"])
    if edges is None and any(axes):
        raise CrystalError(
            f"{path.name}: expected the edges of the cell, got an array of positions without them. "
            "Give --cell, or --periodic none for an open crystal."
        )
    inputs = Given.of(edges, axes, None, None, None)
    x, y, z = inputs.periodic.tolist()
    return AtomData(arrays[POSITIONS], inputs.cell, (x, y, z), None, path.name)

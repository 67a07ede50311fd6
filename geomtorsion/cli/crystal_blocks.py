"""crystal blocks: the command `crystal` for more atoms than memory holds."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from geomtorsion.checks import cut, shown
from geomtorsion.cli.options import processes
from geomtorsion.errors import CheckpointError, CrystalError
from geomtorsion.materials.crystals.atom_files import atom_frames, frame_count
from geomtorsion.materials.crystals.blocked import blocked_crystal, forget_blocks
from geomtorsion.materials.crystals.reports import Json, crystal_report
from geomtorsion.materials.crystals.trajectories import Wanted
from geomtorsion.materials.lines import DislocationNetwork
from geomtorsion.npz import ArrayForm, read_npz

BLOCKS = "blocks"
ARRAYS = (".npy", ".npz", ".zarr")


@dataclass(frozen=True)
class Blocks:
    """Options of crystals in blocks, as they are typed: length, cell, periodic edges, processes."""

    size: float | None
    cell: str | None
    periodic: str | None
    workers: int | None


def is_blocked(file: Path, blocks: Blocks) -> bool:
    """Whether a crystal is done in blocks; options that belong to them alone are refused if not."""
    if blocks.size is not None:
        return True
    if file.suffix.lower() in ARRAYS:
        raise CrystalError(
            f"{file.name}: atoms in an array are done in blocks: give --blocks LENGTH, some fifty "
            "neighbour distances or more."
        )
    for name, value in (("--cell", blocks.cell), ("--periodic", blocks.periodic)):
        if value is not None:
            raise CrystalError(f"{name}: it belongs to arrays in blocks. The file says it itself.")
    if blocks.workers is not None:
        raise CrystalError("--workers: it belongs to crystals in blocks. Give --blocks LENGTH.")
    return False


def report_in_blocks(
    file: Path, wanted: Wanted, blocks: Blocks, folder: Path
) -> tuple[Json, DislocationNetwork]:
    """What is found in the atoms of a file, by way of blocks in a folder."""
    source, cell, periodic = _opened(file, wanted, blocks)
    orient = None if wanted.orient is None else np.array(wanted.orient)
    crystal = blocked_crystal(
        source, folder, cell, blocks.size or 0.0, periodic, lattice=wanted.lattice,
        orient=orient, constant=wanted.constant, workers=processes(blocks.workers),
    )  # fmt: skip
    net = crystal.dislocations(wanted.partials)
    return {"frame": 0, **crystal_report(crystal, net, wanted.convention)}, net


def opened_folder(output: Path | None, *, resume: bool, overwrite: bool) -> Path:
    """Where blocks are kept; refuse to run over what was not finished."""
    if output is None:
        raise CheckpointError("--blocks: they are kept in a directory: name it with -o.")
    folder = output / BLOCKS
    begun = folder.is_dir() and any(folder.iterdir())
    if begins_anew(folder, "crystal", begun=begun, resume=resume, overwrite=overwrite):
        forget_blocks(folder)
    return folder


def begins_anew(folder: Path, holds: str, *, begun: bool, resume: bool, overwrite: bool) -> bool:
    """Whether what a folder holds is to be removed; refuse to run over what was not finished.

    begun: whether something was stopped there; holds: what that is.
    """
    if resume and overwrite:
        raise CheckpointError("--overwrite begins anew, --resume does not: give one of them.")
    if begun and not resume and not overwrite:
        raise CheckpointError(
            f"{folder} holds a {holds} that was stopped. Give --resume to go on with it, or "
            "--overwrite to begin anew."
        )
    if resume and not begun:
        raise CheckpointError(f"{folder} holds nothing that was stopped. Leave out --resume.")
    return begun and overwrite


def _opened(
    file: Path, wanted: Wanted, blocks: Blocks
) -> tuple[Any, np.ndarray | None, tuple[bool, bool, bool]]:
    """Positions, cell and periodic edges of a file."""
    edges, axes = _cell(blocks.cell), _periodic(blocks.periodic)
    if file.suffix.lower() in ARRAYS:
        if file.suffix.lower() == ".npz":
            forms = {"cell": ArrayForm(optional=True),
                     "periodic": ArrayForm((3,), "biu", optional=True)}  # fmt: skip
            said = read_npz(file, forms)
            edges = said.get("cell") if edges is None else edges
            if axes is None and "periodic" in said:
                x, y, z = (bool(flag) for flag in said["periodic"])
                axes = x, y, z
        if edges is None and axes is None:
            raise CrystalError(
                f"{file.name}: edges of the cell were needed, but an array of positions alone says "
                "none. Give --cell, or --periodic none for a crystal that is open."
            )
        return file, edges, (True, True, True) if axes is None else axes
    for name, value in (("--cell", blocks.cell), ("--periodic", blocks.periodic)):
        if value is not None:
            raise CrystalError(f"{name}: it belongs to arrays. {file.name} says it itself.")
    frames = frame_count(file, wanted.form)
    if frames > 1:
        raise CrystalError(
            f"--blocks: one frame was needed, but {file.name} has {frames}. Do a trajectory frame "
            "by frame, without it, or give one frame alone."
        )
    data = next(atom_frames(file, wanted.form))
    return data.positions, data.cell, data.periodic


def _cell(text: str | None) -> np.ndarray | None:
    """Edges of a cell: three lengths, or three vectors with semicolons between them."""
    if text is None:
        return None
    try:
        rows = [[float(x) for x in part.split(",")] for part in text.split(";")]
        found = np.array(rows if len(rows) > 1 else rows[0])
    except ValueError:
        found = np.zeros(0)
    if found.shape not in ((3,), (3, 3)):
        raise CrystalError(
            f"--cell {cut(text)}: three lengths such as 80,80,14.4 were needed, or three edges "
            "such as 80,0,0;0,80,0;0,0,14.4."
        )
    return found


def _periodic(text: str | None) -> tuple[bool, bool, bool] | None:
    """Edges along which a cell repeats, as letters."""
    if text is None:
        return None
    letters = "" if text == "none" else text
    if not set(letters) <= set("xyz") or len(set(letters)) < len(letters):
        raise CrystalError(
            f"--periodic: letters of xyz, for the first to the third edge, or none were needed, "
            f"but {shown(text)} came."
        )
    return "x" in letters, "y" in letters, "z" in letters

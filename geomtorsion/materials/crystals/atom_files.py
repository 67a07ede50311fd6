"""Atom files: positions, cell and species; XYZ, LAMMPS and arrays here, others by ase."""

from __future__ import annotations

import io
from collections.abc import Iterator
from contextlib import contextmanager
from importlib import import_module
from os import PathLike
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from geomtorsion.errors import CrystalError, FileFormatError, MissingExtraError
from geomtorsion.materials.crystals.atom_rows import AtomData, check_number, completed, is_number
from geomtorsion.materials.crystals.given import POSITIONS, Given
from geomtorsion.materials.crystals.lammps import (
    data_frame,
    dump_blocks,
    dump_frame,
    seems_data,
    seems_dump,
)
from geomtorsion.materials.crystals.xyz import xyz_blocks, xyz_frame
from geomtorsion.materials.fields.contents import guarded
from geomtorsion.support import checks
from geomtorsion.support.checks import LARGEST_ARRAYS, cut, file_name, shown
from geomtorsion.support.file_kinds import other_kinds
from geomtorsion.support.files import BOUNDS, ending, opened, read_text
from geomtorsion.support.npz import ArrayForm, mapped_npy, read_npz
from geomtorsion.support.outgoing import quiet_libraries
from geomtorsion.support.text_rows import TextRows

if TYPE_CHECKING:
    from ase import Atoms

# Formats that are text or NetCDF, by their names in ase. Some other formats of ase read Python
# objects or run Python: their files are refused before ase opens them.
FORMATS = {
    "extxyz": "extended XYZ",
    "xyz": "XYZ",
    "lammps-dump-text": "LAMMPS dump",
    "lammps-data": "LAMMPS data",
    "vasp": "VASP POSCAR",
    "vasp-xdatcar": "VASP XDATCAR",
    "cfg": "AtomEye CFG",
    "cif": "CIF",
    "dlp4": "DL_POLY CONFIG",
    "eon": "EON",
    "gromacs": "Gromacs GRO",
    "netcdftrajectory": "AMBER NetCDF",
    "proteindatabank": "PDB",
    "xsf": "XSF",
}
# Formats that are tables of numbers below a title, which are checked before ase reads them.
TABLES = frozenset(("vasp", "vasp-xdatcar", "cfg", "dlp4", "eon", "gromacs", "xsf"))
# Formats with several frames that are read here: how to split the frames, and how to read one.
FRAMES = {
    "extxyz": (xyz_blocks, xyz_frame),
    "xyz": (xyz_blocks, xyz_frame),
    "lammps-dump-text": (dump_blocks, dump_frame),
}
# Suffixes that ase has under other names, or not at all.
ENDS = {
    ".xyz": "extxyz",
    ".extxyz": "extxyz",
    ".poscar": "vasp",
    ".vasp": "vasp",
    ".lmp": "lammps-data",
    ".lammps": "lammps-data",
    ".lammps-data": "lammps-data",
    ".lammpstrj": "lammps-dump-text",
    ".dump": "lammps-dump-text",
    ".cfg": "cfg",
    ".xsf": "xsf",
    ".nc": "netcdftrajectory",
}
# Arrays of an .npz file. An .npy file holds only the positions.
_ARRAYS = {
    POSITIONS: ArrayForm((None, 3)),
    "cell": ArrayForm(optional=True),
    "periodic": ArrayForm((3,), "biu", optional=True),
}


def atom_frames(path: str | PathLike[str], form: str | None = None) -> Iterator[AtomData]:
    """Frames of a file, one after another.

    Parameters
    ----------
    form
        A name of FORMATS; if not given, it is found from the name and beginning of the file.

    Raises
    ------
    FileFormatError
        The file is missing, damaged, or of an unsupported format.
    MissingExtraError
        ase is not installed.
    """
    file = file_name(path)
    count = 0
    with other_kinds(file, "atoms"):
        kind = _form_of(file, form)
        for data in _frames(file, kind):
            yield data
            count += 1
    if not count:
        raise FileFormatError(f"{file.name}: expected atoms, got none. Is the file complete?")


def frame_count(path: str | PathLike[str], form: str | None = None) -> int:
    """How many frames a file has; 1 for formats whose lines do not separate frames.

    Raises
    ------
    FileFormatError
        The file is missing, or its frames are not whole.
    """
    file = file_name(path)
    kind = _form_of(file, form)
    if kind not in FRAMES:
        return 1
    blocks, _ = FRAMES[kind]
    with _text_of(file) as stream:
        return sum(1 for _ in blocks(file.name, stream))


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
        arrays = read_npz(path, _ARRAYS)
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


def _ase(name: str) -> Any:
    """A module of ase, which is an optional extra."""
    try:
        return import_module(name)
    except ImportError:
        raise MissingExtraError(
            "files of atoms in this format need ase, which is not installed. Run `pip install "
            "'geomtorsion[crystals]'`, or give arrays: Crystal(positions, cell)."
        ) from None


def _form_of(file: Path, form: str | None) -> str:
    """The format of a file, one of FORMATS: by its beginning where that leaves no doubt."""
    with opened(file) as stream:
        start = stream.read(BOUNDS.beginning).decode("utf-8-sig", errors="replace")
    if form is not None:
        return checks.choice(form, tuple(FORMATS), "form", FileFormatError)
    if seems_dump(start):
        return "lammps-dump-text"
    if seems_data(start):
        return "lammps-data"
    choices = ", ".join(FORMATS)
    if "nodalData" in start or "dataFileVersion" in start:
        raise FileFormatError(
            f"{file.name}: expected atoms, got a network of dislocation lines (ParaDiS). Read it "
            "with DislocationNetwork.read, or show it with `geomtorsion network`."
        )
    if ending(file) in ENDS:
        return ENDS[ending(file)]
    if _seems_xyz(start):
        return "extxyz"
    formats = _ase("ase.io.formats")
    try:
        with quiet_libraries():
            kind = formats.filetype(str(file), read=True, guess=False)
    except Exception:  # noqa: BLE001
        # A damaged beginning makes ase raise more than its own class of errors.
        raise FileFormatError(
            f"{file.name}: expected a name or beginning that shows the format, got a file of "
            f"unknown format. Name its format by form=... (--read-as), one of {choices}."
        ) from None
    if kind not in FORMATS:
        raise FileFormatError(
            f"{file.name}: expected one of the formats {choices}, got a file that looks like "
            f"{kind!r}, which may hold more than numbers and is not read. Name the format by "
            "form=... (--read-as) if it is one of these, or export the file as extended XYZ."
        )
    return kind


def _seems_xyz(start: str) -> bool:
    """Whether a number of atoms and a comment go before rows of a species and three numbers."""
    rows = start.split("\n", 3)
    words = rows[2].split() if len(rows) > 2 else []
    return rows[0].strip().isdecimal() and len(words) > 3 and all(map(is_number, words[1:4]))


def _frames(file: Path, kind: str) -> Iterator[AtomData]:
    """Frames of a file, each with its number in the file."""
    name = file.name
    if kind in FRAMES:
        blocks, frame = FRAMES[kind]
        with _text_of(file) as stream:
            for number, (line, rows) in enumerate(blocks(name, stream)):
                yield frame(name, line, rows, f"{name}: frame {number}")
    elif kind == "lammps-data":
        yield data_frame(name, read_text(file, LARGEST_ARRAYS, otherwise="latin-1"))
    else:
        for number, atoms in enumerate(_by_ase(file, kind)):
            yield _data(atoms, f"{name}: frame {number}" if number else name)


@contextmanager
def _text_of(file: Path) -> Iterator[io.TextIOBase]:
    """A file as text, line by line."""
    with opened(file) as stream:
        yield io.TextIOWrapper(stream, encoding="utf-8-sig", errors="replace")


def _by_ase(file: Path, kind: str) -> Iterator[Atoms]:
    """Frames as ase reads them."""
    ase_io, formats = _ase("ase.io"), _ase("ase.io.formats")
    source: Any = str(file)
    length = 1.0
    if kind == "netcdftrajectory":
        if file.suffix.lower() != ".nc":
            raise FileFormatError(
                f"{file.name}: expected the name of an AMBER NetCDF file to end in .nc, got "
                f"{shown(file.suffix)}. Unpack or rename the file."
            )
    else:
        text = read_text(file, LARGEST_ARRAYS, otherwise="latin-1")
        if kind == "cfg":
            length = _length_of_cfg(file.name, text)
        if kind in TABLES:
            rows = text.rstrip().split("\n")
            # The first row is a title.
            _check_numbers(file.name, 2, rows[1:])
            if kind == "gromacs":
                _check_count_of_gro(file.name, rows)
        binary = formats.ioformats[kind].isbinary
        source = io.BytesIO(text.encode()) if binary else io.StringIO(text)
    try:
        frames = iter(ase_io.iread(source, index=":", format=kind))
        while True:
            with quiet_libraries():
                atoms = next(frames, None)
            if atoms is None:
                return
            if length != 1:
                atoms.set_cell(length * atoms.cell, scale_atoms=True)
            yield atoms
    except Exception as error:  # noqa: BLE001
        # Readers of many formats have errors of their own.
        raise _unreadable(file.name, kind, error) from None


def _length_of_cfg(name: str, text: str) -> float:
    """The unit of length of the cell in a CFG file, which ase takes for 1."""
    for number, row in enumerate(text.split("\n"), 1):
        key, equals, value = row.partition("=")
        if not equals and row.strip() and not row.lstrip().startswith(("#", ".")):
            # The atoms begin here.
            break
        if key.strip() == "A":
            rows = TextRows(name, line=number)
            (length,) = rows.numbers(value.split(), 1, "A", more=True)
            if length <= 0:
                rows.fail(f"A: expected a length above 0, got {shown(value.strip())}. Correct it.")
            return length
    return 1.0


def _check_numbers(name: str, line: int, rows: list[str]) -> None:
    """Refuse numbers that only Python accepts; line: the number of the first row."""
    text = "".join(rows)
    if text.isascii() and "_" not in text:
        return
    for number, row in enumerate(rows, line):
        for word in row.partition("#")[0].split():
            check_number(name, number, word)


def _check_count_of_gro(name: str, rows: list[str]) -> None:
    """Refuse a GRO file with a wrong number of rows, since ase takes the last row for the cell."""
    count = rows[1].strip() if len(rows) > 1 else ""
    if not count.isdecimal() or len(count) > 18 or len(rows) != int(count) + 3:
        raise FileFormatError(
            f"{name}: line 2: expected the number of atoms, then one row for each atom and one row "
            f"with the cell. Line 2 is {shown(count)}, and {max(len(rows) - 2, 0):,} rows follow. "
            "Is the file complete, and does it hold only one frame?"
        )


def _unreadable(where: str, kind: str, error: Exception) -> FileFormatError | MissingExtraError:
    """The error for a file that ase refuses."""
    if isinstance(error, ModuleNotFoundError):
        return MissingExtraError(
            f"{where}: {FORMATS[kind]} files need {error.name}, which is not installed. Run `pip "
            f"install {error.name}`, or export the file as extended XYZ."
        )
    reason = cut(str(error).strip().split("\n")[0]) or type(error).__name__
    return FileFormatError(
        f"{where}: expected {FORMATS[kind]}, got a file that ase cannot read in this format "
        f"({reason}). Is the file complete? Name another format by form=... (--read-as)."
    )


def _data(atoms: Atoms, where: str) -> AtomData:
    """The values that a frame needs."""
    edges = np.array(atoms.cell, dtype=float)
    flags = tuple(bool(x) for x in atoms.pbc)
    missing = [k for k in range(3) if flags[k] and not edges[k].any()]
    if missing:
        raise FileFormatError(
            f"{where}: expected edge {missing[0] + 1} of the cell, along which the atoms are "
            "periodic, got none. Give it (Lattice in extended XYZ), or write pbc F for this edge."
        )
    # Edges along which nothing repeats may be missing; perpendicular ones replace them.
    cell = completed(where, edges)
    return AtomData(
        positions=np.array(atoms.positions, dtype=float),
        cell=cell,
        periodic=(flags[0], flags[1], flags[2]),
        species=tuple(atoms.get_chemical_symbols()),
        where=where,
    )

"""Atom files: positions, cell and species of a file, read by ase from formats of plain numbers."""

from __future__ import annotations

import io
from collections import Counter
from collections.abc import Iterator
from dataclasses import dataclass
from importlib import import_module
from os import PathLike
from pathlib import Path
from stat import S_ISREG
from typing import TYPE_CHECKING, Any

import numpy as np

from geomtorsion import checks
from geomtorsion.checks import LARGEST_ARRAYS, cut, file_name, shown
from geomtorsion.errors import FileFormatError, MissingExtraError
from geomtorsion.files import finite_number, read_text
from geomtorsion.materials.crystals.atom_counts import (
    check_columns,
    check_count_of_data,
    check_count_of_gro,
    check_declared,
)

if TYPE_CHECKING:
    from ase import Atoms

# Formats that are text or NetCDF, by their names in ase. Some of its others read Python objects or
# run Python: files of those are refused before ase looks into them.
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
# Those that are tables of numbers below a title, which are looked at before ase reads them.
TABLES = frozenset(("lammps-data", "vasp", "vasp-xdatcar", "cfg", "dlp4", "eon", "gromacs", "xsf"))
# Ends of names that ase knows under other names, or not at all.
ENDS = {
    ".xyz": "extxyz",
    ".extxyz": "extxyz",
    ".poscar": "vasp",
    ".vasp": "vasp",
    ".lmp": "lammps-data",
    ".lammpstrj": "lammps-dump-text",
    ".dump": "lammps-dump-text",
    ".cfg": "cfg",
    ".xsf": "xsf",
    ".nc": "netcdftrajectory",
}


@dataclass(frozen=True, eq=False)
class AtomData:
    """Atoms of one frame of a file.

    positions: shape (atoms, 3), in the unit of the file (ase: angstrom).
    cell: edges as rows, shape (3, 3), or None if there is none.
    periodic: along which edges it repeats. species: chemical symbols, None where the file has none.
    where: the file and frame.
    """

    positions: np.ndarray
    cell: np.ndarray | None
    periodic: tuple[bool, bool, bool]
    species: tuple[str, ...] | None
    where: str


def atom_frames(path: str | PathLike[str], form: str | None = None) -> Iterator[AtomData]:
    """Frames of a file, one after another.

    Parameters
    ----------
    form
        A name of FORMATS; found from the name and the beginning of the file if not given.

    Raises
    ------
    FileFormatError
        The file is missing, damaged, or of a format that is not read.
    MissingExtraError
        ase is not installed.
    """
    file = file_name(path)
    _regular(file)
    kind = _form_of(file, form)
    count = 0
    for atoms, where in _read(file, kind):
        yield _data(atoms, f"{file.name}{where}" if where else file.name)
        count += 1
    if not count:
        raise FileFormatError(f"{file.name}: it holds no atoms. Is the file complete?")


def _regular(file: Path) -> None:
    """Refuse what is no file: a pipe or a device would never end."""
    try:
        if not S_ISREG(file.stat().st_mode):
            raise OSError(0, "this is no regular file")
    except (OSError, ValueError) as error:
        reason = getattr(error, "strerror", None) or "this is no name of a file"
        raise FileFormatError(f"{shown(str(file))}: the file cannot be read: {reason}.") from None


def _ase(name: str) -> Any:
    """A module of ase, which is an optional extra."""
    try:
        return import_module(name)
    except ImportError:
        raise MissingExtraError(
            "files of atoms are read by ase, which is not installed. Run `pip install "
            "'geomtorsion[crystals]'`, or give arrays: Crystal(positions, cell)."
        ) from None


def _form_of(file: Path, form: str | None) -> str:
    """The format of a file, one of FORMATS."""
    if form is not None:
        return checks.choice(form, tuple(FORMATS), "form", FileFormatError)
    formats = _ase("ase.io.formats")
    known = ", ".join(FORMATS)
    if file.suffix.lower() in ENDS:
        return ENDS[file.suffix.lower()]
    if file.suffix.lower() in (".gz", ".bz2", ".xz"):
        raise FileFormatError(f"{file.name}: it is compressed. Unpack it, then read that.")
    try:
        found = formats.filetype(str(file), read=True, guess=False)
    except Exception:  # noqa: BLE001
        # What ase makes of damaged beginnings is not its own class of errors alone.
        raise FileFormatError(
            f"{file.name}: its format is not known by its name or beginning. Name it: "
            f"form = one of {known}."
        ) from None
    if found not in FORMATS:
        raise FileFormatError(
            f"{file.name}: one of the formats {known} was needed, but it looks like {found!r}, "
            "which is not read: such files may hold more than numbers. Export it as extended XYZ."
        )
    return found


def _read(file: Path, kind: str) -> Iterator[tuple[Atoms, str]]:
    """Frames as ase has them, with their places in the file."""
    if kind in ("extxyz", "xyz", "lammps-dump-text"):
        blocks = _xyz_blocks if kind != "lammps-dump-text" else _dump_blocks
        with file.open(encoding="utf-8-sig", errors="replace") as stream:
            for number, (line, rows) in enumerate(blocks(file.name, stream)):
                where = f": frame {number}"
                # The second row of XYZ is a comment.
                skipped = 2 if blocks is _xyz_blocks else 0
                _check_numbers(file.name, line + skipped, rows[skipped:])
                if kind == "extxyz":
                    check_columns(file.name, line, rows)
                yield _one(file.name, kind, line, rows), where
        return
    ase_io = _ase("ase.io")
    length = _length_of_cfg(file) if kind == "cfg" else 1.0
    if kind in TABLES:
        rows = read_text(file, LARGEST_ARRAYS, otherwise="latin-1").rstrip().split("\n")
        # The first row is a title.
        _check_numbers(file.name, 2, rows[1:])
        check_declared(file.name, kind, rows)
        if kind == "gromacs":
            check_count_of_gro(file.name, rows)
        elif kind == "lammps-data":
            check_count_of_data(file.name, rows)
    try:
        frames = ase_io.iread(str(file), index=":", format=kind)
        for number, atoms in enumerate(frames):
            if length != 1:
                atoms.set_cell(length * atoms.cell, scale_atoms=True)
            yield atoms, f": frame {number}" if number else ""
    except Exception as error:  # noqa: BLE001
        # Readers of many formats, each with errors of its own.
        raise _unreadable(file.name, kind, error) from None


def _length_of_cfg(file: Path) -> float:
    """The length in which a CFG file gives its cell: ase takes it for 1."""
    with file.open(encoding="utf-8-sig", errors="replace") as stream:
        for number, row in enumerate(stream, 1):
            key, equals, said = row.partition("=")
            if not equals and row.strip() and not row.lstrip().startswith(("#", ".")):
                # Here the atoms begin.
                break
            if key.strip() == "A":
                words = said.split()
                found = finite_number(words[0]) if words else None
                if found is None or found <= 0:
                    raise FileFormatError(
                        f"{file.name}: line {number}: A: a length above 0 was needed, but "
                        f"{shown(said.strip())} came."
                    )
                return found
    return 1.0


def _check_numbers(name: str, line: int, rows: list[str]) -> None:
    """Refuse what Python takes for a number and nobody else: 1_8 is 18 to it.

    line: the number of the first row in the file.
    """
    text = "".join(rows)
    if text.isascii() and "_" not in text:
        return
    for number, row in enumerate(rows, line):
        for word in row.partition("#")[0].split():
            if (not word.isascii() or "_" in word) and _is_number(word):
                raise FileFormatError(
                    f"{name}: line {number}: {shown(word)} is no number as programs write it, but "
                    f"would be read as {float(word):g}. Correct it, or export the file again."
                )


def _one(name: str, kind: str, line: int, rows: list[str]) -> Atoms:
    """One frame from its rows, of which the first has a number in the file."""
    ase_io = _ase("ase.io")
    try:
        found = ase_io.read(io.StringIO("".join(rows)), format=kind, index=0)
    except Exception as error:  # noqa: BLE001
        # Here, too, ase fails with errors of many classes.
        odd = _odd_row(rows)
        if odd is not None:
            raise FileFormatError(
                f"{name}: line {line + odd}: a row like the others of its frame was needed, but "
                f"{shown(rows[odd].strip())} came."
            ) from None
        raise _unreadable(f"{name}: line {line}", kind, error) from None
    return found


def _unreadable(where: str, kind: str, error: Exception) -> FileFormatError | MissingExtraError:
    """The error for what ase refuses."""
    if isinstance(error, ModuleNotFoundError):
        return MissingExtraError(
            f"{where}: {FORMATS[kind]} is read by {error.name}, which is not installed. Run `pip "
            f"install {error.name}`, or export the file as extended XYZ."
        )
    reason = cut(str(error).strip().split("\n")[0]) or type(error).__name__
    return FileFormatError(
        f"{where}: {FORMATS[kind]} was needed, but ase cannot read it ({reason}). Is the file "
        "complete, and of this format?"
    )


def _odd_row(rows: list[str]) -> int | None:
    """The first row of numbers that differs from most in how many words and numbers it has."""
    shapes = [tuple(_is_number(word) for word in row.split()) for row in rows]
    # Headers are few: rows of atoms are what most rows look like.
    usual, count = Counter(shapes).most_common(1)[0]
    first = shapes.index(usual)
    odd = (k for k in range(first, len(rows)) if shapes[k] != usual)
    found = next(odd, None)
    # Of few rows nothing can be said.
    return found if count > len(rows) / 2 else None


def _is_number(word: str) -> bool:
    try:
        float(word)
    except ValueError:
        return False
    return True


def _xyz_blocks(name: str, stream: io.TextIOBase) -> Iterator[tuple[int, list[str]]]:
    """Frames of an XYZ file as rows, with the numbers of their first lines.

    What follows a frame is looked at before it is given: an atom too many is no other frame.
    """
    line, head = _next_head(name, stream, 0)
    while head:
        rows = [head]
        for _ in range(int(head) + 1):
            row = stream.readline()
            if row == "":
                raise FileFormatError(
                    f"{name}: line {line + len(rows) - 1}: the file ends after "
                    f"{max(len(rows) - 2, 0):,} of {int(head):,} atoms. Is it complete?"
                )
            rows.append(row)
        first = line
        line, head = _next_head(name, stream, line + len(rows) - 1)
        yield first, rows


def _next_head(name: str, stream: io.TextIOBase, line: int) -> tuple[int, str]:
    """The row with the number of atoms of the next frame, and its number; empty at the end."""
    while (head := stream.readline()) != "":
        line += 1
        if not head.strip():
            continue
        if not head.strip().isdecimal() or len(head) > 20:
            raise FileFormatError(
                f"{name}: line {line}: the number of atoms of a frame was needed, but "
                f"{shown(head.strip())} came."
            )
        return line, head
    return line, ""


def _dump_blocks(name: str, stream: io.TextIOBase) -> Iterator[tuple[int, list[str]]]:
    """Frames of a LAMMPS dump as rows, with the numbers of their first lines."""
    first, rows = 1, []
    for number, row in enumerate(stream, 1):
        if row.startswith("ITEM: TIMESTEP") and rows:
            yield first, _whole_dump(name, first, rows)
            first, rows = number, []
        elif not rows and not row.startswith("ITEM: TIMESTEP"):
            if not row.strip() or row.startswith("ITEM: UNITS"):
                continue
            raise FileFormatError(
                f"{name}: line {number}: ITEM: TIMESTEP was needed, but {shown(row.strip())} came."
            )
        rows.append(row)
    if rows:
        yield first, _whole_dump(name, first, rows)


def _whole_dump(name: str, first: int, rows: list[str]) -> list[str]:
    """The rows of a frame, as many as it says itself."""
    marks = {
        row.strip()[6:].split(" ")[0]: k for k, row in enumerate(rows) if row.startswith("ITEM: ")
    }
    for key in ("NUMBER", "BOX", "ATOMS"):
        if key not in marks:
            raise FileFormatError(
                f"{name}: line {first}: ITEM: {key} ... was needed in this frame, but there is "
                "none. Is the file complete?"
            )
    said = rows[marks["NUMBER"] + 1].strip() if marks["NUMBER"] + 1 < len(rows) else ""
    if not said.isdecimal() or len(said) > 18:
        raise FileFormatError(
            f"{name}: line {first + marks['NUMBER'] + 1}: the number of atoms was needed, but "
            f"{shown(said)} came."
        )
    while not rows[-1].strip():
        rows.pop()
    body = len(rows) - 1 - marks["ATOMS"]
    if body > int(said):
        raise FileFormatError(
            f"{name}: line {first + marks['NUMBER'] + 1}: {said} atoms are said to follow, but "
            f"{body:,} rows do. Correct the number, or export the file again."
        )
    if body < int(said):
        raise FileFormatError(
            f"{name}: line {first + len(rows) - 1}: the frame ends after {body:,} of "
            f"{int(said):,} atoms. Is the file complete?"
        )
    return rows


def _data(atoms: Atoms, where: str) -> AtomData:
    """What is needed of a frame."""
    edges = np.array(atoms.cell, dtype=float)
    flags = tuple(bool(x) for x in atoms.pbc)
    missing = [k for k in range(3) if flags[k] and not edges[k].any()]
    if missing:
        raise FileFormatError(
            f"{where}: it is said to repeat along edge {missing[0] + 1} of its cell, but the file "
            "gives no such edge. Give the cell (Lattice in extended XYZ), or pbc F there."
        )
    # Edges along which nothing repeats may be missing; they are put across the others.
    cell = np.array(atoms.cell.complete(), dtype=float) if edges.any() else None
    return AtomData(
        positions=np.array(atoms.positions, dtype=float),
        cell=cell,
        periodic=(flags[0], flags[1], flags[2]),
        species=tuple(atoms.get_chemical_symbols()),
        where=where,
    )


def frame_count(path: str | PathLike[str], form: str | None = None) -> int:
    """How many frames a file has; of formats whose frames are not told apart by their lines, 1.

    Raises
    ------
    FileFormatError
        The file is missing, or its frames are not whole.
    """
    file = Path(path)
    _regular(file)
    kind = _form_of(file, form)
    if kind not in ("extxyz", "xyz", "lammps-dump-text"):
        return 1
    blocks = _xyz_blocks if kind != "lammps-dump-text" else _dump_blocks
    with file.open(encoding="utf-8-sig", errors="replace") as stream:
        return sum(1 for _ in blocks(file.name, stream))

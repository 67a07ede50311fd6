"""Reading: crystals from files of atoms, and from the frames of a trajectory."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from os import PathLike

from numpy.typing import ArrayLike

from geomtorsion.errors import CrystalError, FileFormatError
from geomtorsion.materials.crystals.atom_files import atom_frames
from geomtorsion.materials.crystals.atom_rows import AtomData
from geomtorsion.materials.crystals.crystal import Crystal
from geomtorsion.materials.crystals.known_grains import KnownGrains
from geomtorsion.support import checks

# Symbols of elements or numbers of types; None for all atoms.
Species = str | int | Sequence[str | int] | None


def species_of(given: Species) -> tuple[str, ...] | None:
    """The names of species in the form that files use."""
    if given is None:
        return None
    each = (given,) if isinstance(given, str) or checks.whole(given) is not None else given
    names = checks.entries(each, "species", FileFormatError)
    if not names or not all(isinstance(x, str) or checks.whole(x) is not None for x in names):
        raise FileFormatError(
            f"species: expected symbols of elements or numbers of types, got "
            f"{checks.shown(given)}. Give, for example, 'U', 1 or ('U', 'Pu')."
        )
    return tuple(map(str, names))


def read(
    path: str | PathLike[str],
    *,
    frame: int = 0,
    lattice: str | None = None,
    orient: ArrayLike | None = None,
    constant: float | None = None,
    form: str | None = None,
    species: Species = None,
) -> Crystal:
    """A crystal from a file of atoms: extended XYZ, LAMMPS dump or data, POSCAR, CIF, and more.

    Files packed by gzip or bzip2 are unpacked while they are read.

    Parameters
    ----------
    frame
        Number of a frame in a trajectory, from 0.
    lattice, orient, constant
        As for `Crystal`; found from the atoms if not given.
    form
        The format, one of `atom_files.FORMATS`; found from name and content if not given.
    species
        Atoms to keep, by chemical symbol or number of type: "U" of UO2, or several, ("U", "Pu"). A
        sublattice may be a crystal even if all atoms together are not.

    Raises
    ------
    FileFormatError
        The file is missing, damaged (the message names the line if there is one), does not have
        this frame or species, or has a format that may hold more than numbers.
    CrystalError
        Positions or cell are refused. Atoms without a lattice are refused when lattice or lines are
        requested.
    MissingExtraError
        ase, which reads all formats but XYZ and LAMMPS, is not installed: the extra `crystals`.

    Examples
    --------
    >>> import pathlib, tempfile
    >>> rows = [f"W {(x + k / 2) * 3.2} {(y + k / 2) * 3.2} {(z + k / 2) * 3.2}"
    ...         for k in (0, 1) for x in range(4) for y in range(4) for z in range(4)]
    >>> head = ["128", 'Lattice="12.8 0 0 0 12.8 0 0 0 12.8" pbc="T T T"']
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     path = pathlib.Path(folder) / "w.xyz"
    ...     _ = path.write_text("\\n".join([*head, *rows]))
    ...     crystal = read(path)
    >>> crystal.lattice, len(crystal.positions)
    ('bcc', 128)
    """
    number = checks.count(frame, "frame", FileFormatError)
    last = 0
    for last, data in enumerate(atom_frames(path, form)):
        if last == number:
            return crystal_of(data.chosen(species_of(species)), lattice, orient, constant)
    raise FileFormatError(f"{path}: frame: expected a number from 0 to {last}, got {number}.")


def read_all(
    path: str | PathLike[str],
    *,
    lattice: str | None = None,
    orient: ArrayLike | None = None,
    constant: float | None = None,
    form: str | None = None,
    species: Species = None,
) -> Iterator[Crystal]:
    """Crystals of all frames of a trajectory, one after another, in the axes of the first one.

    Lattice, orientation and lattice constant of the first frame are kept in all later ones, so
    that a Burgers vector along the crystal axes is the same from frame to frame; in a polycrystal
    this holds for each grain, which keeps its number (`Crystal.following`). Parameters and errors
    as for `read`.
    """
    grains, names = None, species_of(species)
    for data in atom_frames(path, form):
        crystal = crystal_of(data.chosen(names), lattice, orient, constant, grains)
        # Atoms in a plane are compared with no frame before.
        if isinstance(crystal, Crystal):
            grains = KnownGrains.of(crystal.grains)
        yield crystal


def crystal_of(
    data: AtomData,
    lattice: str | None,
    orient: ArrayLike | None,
    constant: float | None,
    known: KnownGrains | None = None,
) -> Crystal:
    """The crystal of a frame, after one with known grains; errors name the file of the frame.

    Lattice and orientation are found when they are requested.
    """
    try:
        crystal = Crystal(
            data.positions, data.cell, data.periodic, lattice, orient, constant, data.species
        )
        crystal = crystal.from_file(data.where)
        in_space = isinstance(crystal, Crystal)
        return crystal.following(known) if in_space and known is not None else crystal
    except CrystalError as error:
        raise CrystalError(f"{data.where}: {error}") from None

"""Near torsion: T = de on the tetrahedra about atoms whose neighbours do not exclude it."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from geomtorsion.materials.crystals.enclosed import inserted_about
from geomtorsion.materials.crystals.frames import Frame
from geomtorsion.materials.crystals.lattices import Lattice
from geomtorsion.materials.crystals.method import METHOD
from geomtorsion.materials.crystals.networks import cluster_of, network_of
from geomtorsion.materials.crystals.stacking_faults import (
    MODULES,
    fault_labels,
    layered,
    stacked_labels,
)
from geomtorsion.materials.crystals.torsion import TornFaces, Torsion
from geomtorsion.materials.crystals.triangulation import Cell, Triangulation, triangulated
from geomtorsion.materials.lines.dislocation_network import DislocationNetwork


@dataclass(frozen=True, eq=False)
class Atoms:
    """Atoms in a cell that may contain many more.

    numbers: among all atoms, increasing, shape (k,); places: wrapped, shape (k, 3); kinds:
    sublattice of each, shape (k,).
    """

    numbers: np.ndarray
    places: np.ndarray
    kinds: np.ndarray


def lattice_read(frame: Frame, partials: bool) -> Lattice:
    """The lattice of the bond vectors, with the vectors of stacking faults if partials are kept."""
    lattice = frame.lattice
    if not partials:
        return lattice
    return layered(lattice) if lattice.name == "hcp" else MODULES.get(lattice.name, lattice)


def torsion_on(
    frame: Frame, mesh: Triangulation, kinds: np.ndarray, partials: bool = False
) -> Torsion:
    """T = de on some tetrahedra."""
    pairs, images, _ = mesh.edges
    first, second = pairs.T
    lattice, limit = frame.lattice, frame.lattice.nearest / 2
    module = lattice_read(frame, partials=True)
    steps = mesh.places[second] - mesh.places[first] + mesh.cell.shifts(images)
    values = frame.values(steps)
    labels = lattice.decode(values, lattice.shift(kinds[first], kinds[second]))
    doubtful = frame.apart(steps, labels) > limit
    if lattice.name == "hcp":
        finer = 1
        read, torn = stacked_labels(lattice, values, pairs, kinds, mesh.known)
    elif lattice.name == "fcc" or (partials and lattice.name in MODULES):
        finer = 3
        read, torn = fault_labels(lattice, values, labels, pairs, kinds, mesh.known)
    else:
        return Torsion(mesh, lattice, labels, doubtful)
    here = replace(frame, lattice=module)
    if partials:
        return Torsion(mesh, module, read, torn | (here.apart(steps, read) > limit))
    # A fault joins its partials to one core, in which they cannot be separated.
    crossing = (read != finer * labels).any(axis=1)
    return Torsion(mesh, lattice, labels, doubtful | crossing)


def torsion_near(
    frame: Frame, cell: Cell, wanted: np.ndarray, atoms: Atoms, partials: bool
) -> Torsion:
    """The torsion around some of the atoms, and around the atoms to which it continues from there.

    wanted: which atoms, shape (atoms,).
    """
    reach, region = METHOD.reach * frame.lattice.nearest * frame.constant, wanted
    while True:
        mesh = triangulated(atoms.places, cell, reach, region, atoms.numbers)
        torsion = torsion_on(frame, mesh, atoms.kinds, partials)
        more = torsion.leading_on
        if not more.any():
            return torsion
        region = region | more


def sites_in(frame: Frame, cell: Cell) -> int | None:
    """Number of lattice sites in a cell that is periodic along all edges."""
    if not cell.periodic.all():
        return None
    lattice, values = frame.lattice, frame.values(cell.vectors)
    periods = lattice.decode(values)
    if frame.apart(cell.vectors, periods).max() > lattice.nearest / 2:
        return None
    cells = abs(np.linalg.det(periods)) / abs(np.linalg.det(lattice.translations))
    return round(cells) * len(lattice.offsets)


def lines_of(
    faces: TornFaces,
    places: np.ndarray,
    cell: Cell,
    frame: Frame,
    partials: bool,
    occupied: int | None,
) -> DislocationNetwork:
    """The dislocation lines that carry the torsion of faces.

    places: of all atoms in the cell. occupied: atoms, and vacancies that are not part of a line;
    None if they do not fill the cell.
    """
    sites = None if occupied is None else sites_in(frame, cell)
    width = METHOD.width * frame.lattice.nearest * frame.constant

    def extra(path: np.ndarray, others: np.ndarray) -> float:
        more = None
        if occupied is not None and sites is not None and not len(others):
            more = occupied - sites
        more = more or inserted_about(path, others, frame, cell, places) or 0
        return more * frame.atom_volume

    here = replace(frame, lattice=lattice_read(frame, partials))
    return network_of(faces, cell, here, width, extra, cluster_of(frame))

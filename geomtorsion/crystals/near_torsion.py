"""Near torsion: T = de on the tetrahedra about atoms whose neighbours do not exclude it."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np

from geomtorsion.crystals.enclosed import Near, inserted_about
from geomtorsion.crystals.faults import MODULES, fault_labels
from geomtorsion.crystals.frames import Frame
from geomtorsion.crystals.method import METHOD
from geomtorsion.crystals.networks import cluster_of, network_of
from geomtorsion.crystals.stacking import layered, stacked_labels
from geomtorsion.crystals.torsion import Torsion
from geomtorsion.crystals.triangulation import Cell, Triangulation, triangulated
from geomtorsion.loops.dislocation_network import DislocationNetwork


@dataclass(frozen=True, eq=False)
class Atoms:
    """Atoms in a cell, perhaps of many more.

    numbers: among all, increasing, shape (k,); places: wrapped, shape (k, 3); kinds: sublattice of
    each, shape (k,).
    """

    numbers: np.ndarray
    places: np.ndarray
    kinds: np.ndarray


def torsion_on(
    frame: Frame, mesh: Triangulation, kinds: np.ndarray, partials: bool = False
) -> Torsion:
    """T = de on some tetrahedra."""
    pairs, images, _ = mesh.edges
    first, second = pairs.T
    lattice, limit = frame.lattice, frame.constant * frame.lattice.nearest / 2
    steps = mesh.places[second] - mesh.places[first] + mesh.cell.shifts(images)
    values = frame.values(steps)
    labels = lattice.decode(values, kinds[second] - kinds[first])
    doubtful = frame.apart(steps, labels) > limit
    if lattice.name == "hcp":
        module, finer = layered(lattice), 1
        read, torn = stacked_labels(lattice, values, pairs, kinds, mesh.known)
    elif lattice.name == "fcc" or (partials and lattice.name in MODULES):
        module, finer = MODULES[lattice.name], 3
        read, torn = fault_labels(lattice, values, labels, pairs, kinds, mesh.known)
    else:
        return Torsion(mesh, lattice, labels, doubtful)
    here = replace(frame, lattice=module)
    if partials:
        return Torsion(mesh, module, read, torn | (here.apart(steps, read) > limit))
    # A fault joins its partials to one core, in which they cannot be told apart.
    crossing = (read != finer * labels).any(axis=1)
    return Torsion(mesh, lattice, labels, doubtful | crossing)


def torsion_near(
    frame: Frame,
    cell: Cell,
    wanted: np.ndarray,
    atoms: Atoms,
    more: Callable[[np.ndarray, float], Atoms],
    partials: bool,
) -> Torsion:
    """The torsion about some atoms, and about those to which it goes on from there.

    Parameters
    ----------
    wanted
        Numbers of the atoms.
    atoms
        All as near to them as twice the largest empty sphere is wide, or more.
    more
        Gives all atoms as near to some places as a distance.
    """
    reach = METHOD.reach * frame.lattice.nearest * frame.constant
    while True:
        here = np.isin(atoms.numbers, wanted)
        mesh = triangulated(atoms.places, cell, reach, here, atoms.numbers)
        found = torsion_on(frame, mesh, atoms.kinds, partials)
        beyond = found.beyond
        if not beyond.any():
            return found
        # Cores reach as far as the neighbours of what is torn.
        here[mesh.corners[beyond[mesh.corners].any(axis=1)].ravel()] = True
        wanted = atoms.numbers[here]
        # What is jittered may lie a little further.
        atoms = more(atoms.places[here], 2.001 * reach)


def sites_in(frame: Frame, cell: Cell) -> int | None:
    """How many sites the lattice has in a cell that is periodic along all edges."""
    if not cell.periodic.all():
        return None
    lattice, values = frame.lattice, frame.values(cell.vectors)
    periods = lattice.decode(values)
    far = frame.apart(cell.vectors, periods)
    if far.max() > frame.constant * lattice.nearest / 2:
        return None
    cells = abs(np.linalg.det(periods)) / abs(np.linalg.det(lattice.translations))
    return round(cells) * (2 if lattice.basis else 1)


def lines_of(found: Torsion, frame: Frame, occupied: int | None, near: Near) -> DislocationNetwork:
    """The dislocation lines that carry a torsion.

    occupied: atoms, and vacancies that are not part of a line; None if they do not fill the cell.
    near: gives the places of all atoms as near to some places as a distance.
    """
    cell = found.mesh.cell
    sites = None if occupied is None else sites_in(frame, cell)
    width = METHOD.width * frame.lattice.nearest * frame.constant

    def extra(path: np.ndarray, others: np.ndarray) -> float:
        more = None
        if occupied is not None and sites is not None and not len(others):
            more = occupied - sites
        more = more or inserted_about(path, others, frame, cell, near) or 0
        return more * frame.lattice.atom_volume * frame.constant**3

    here = replace(frame, lattice=found.lattice)
    return network_of(found.relaxed(), here, width, extra, cluster_of(frame))

"""Plane grains: regions of atoms in a plane with one lattice, and its direction at each atom."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import scipy  # loads its subpackages at first use

from geomtorsion.materials.crystals.plane_lattices import PlaneLattice

# Fewest atoms of a grain.
LEAST = 20

# Fewest atoms of a grain.


@dataclass(frozen=True, eq=False)
class PlaneGrain:
    """A grain in a plane: its atoms, by number, and its mean lattice.

    vectors: lattice vectors as rows, shape (2, 2), in coordinates. angle: of the first one to x, in
    degrees. lattice: its name. constant: length of the first vector.
    """

    number: int
    atoms: np.ndarray
    vectors: np.ndarray
    lattice: str

    @property
    def constant(self) -> float:
        """Length of the first lattice vector."""
        return float(np.linalg.norm(self.vectors[0]))

    @property
    def angle(self) -> float:
        """Angle of the first lattice vector to x, in degrees."""
        return float(np.degrees(np.arctan2(self.vectors[0, 1], self.vectors[0, 0])))

    def __repr__(self) -> str:
        return (
            f"PlaneGrain({self.number}: {len(self.atoms):,} atoms, {self.lattice}, "
            f"a = {self.constant:.6g}, {self.angle:.1f} degrees)"
        )


def grains_of(order: np.ndarray, near: np.ndarray, lattice: PlaneLattice) -> np.ndarray:
    """Number of the grain of each atom, -1 for none; the largest grain first.

    Neighbours with directions within a sixth of the period belong to one grain.
    """
    first = np.repeat(np.arange(len(near)), near.shape[1])
    second = near.ravel()
    alike = np.abs(np.angle(order[first] * np.conj(order[second]))) < np.pi / 3
    alike &= (np.abs(order[first]) > 0.5) & (np.abs(order[second]) > 0.5)
    graph = scipy.sparse.csr_array(
        (np.ones(int(alike.sum())), (first[alike], second[alike])), shape=(len(near), len(near))
    )
    count, group = scipy.sparse.csgraph.connected_components(graph, directed=False)
    sizes = np.bincount(group, minlength=count)
    ranks = np.full(count, -1)
    large = np.argsort(-sizes, kind="stable")[: int((sizes >= LEAST).sum())]
    ranks[large] = np.arange(len(large))
    return ranks[group]


def angles_of(
    order: np.ndarray, near: np.ndarray, grain: np.ndarray, lattice: PlaneLattice
) -> np.ndarray:
    """Direction of the lattice at each atom of a grain, rad, without jumps between neighbours.

    It follows the spanning tree of each grain from its first atom.
    """
    angle = np.angle(order) / lattice.fold
    first, second = np.repeat(np.arange(len(near)), near.shape[1]), near.ravel()
    same = (grain[first] == grain[second]) & (grain[first] >= 0)
    same &= np.abs(np.angle(order[first] * np.conj(order[second]))) < np.pi / 3
    size = (len(near), len(near))
    graph = scipy.sparse.csr_array((np.ones(int(same.sum())), (first[same], second[same])), size)
    for number in range(int(grain.max()) + 1):
        root = int(np.argmax(grain == number))
        atoms, before = scipy.sparse.csgraph.breadth_first_order(graph, root, directed=False)
        steps = np.angle(order[atoms[1:]] * np.conj(order[before[atoms[1:]]])) / lattice.fold
        for atom, parent, step in zip(
            atoms[1:].tolist(), before[atoms[1:]].tolist(), steps.tolist(), strict=True
        ):
            angle[atom] = angle[parent] + step
    return angle


def filled(grain: np.ndarray, near: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Each atom in the grain of the nearest atom that has one, and the number of that atom."""
    grain, source = grain.copy(), np.arange(len(grain))
    while True:
        open_atoms = np.flatnonzero(grain < 0)
        around = grain[near[open_atoms]]
        has = (around >= 0).any(axis=1)
        if not has.any():
            break
        mine = open_atoms[has]
        one = near[mine, (around[has] >= 0).argmax(axis=1)]
        grain[mine], source[mine] = grain[one], source[one]
    # Atoms without any way to a grain.
    grain[grain < 0] = 0
    return grain, source


def rotations(angle: np.ndarray) -> np.ndarray:
    """Rotations by angles, shape (..., 2, 2)."""
    c, s = np.cos(angle), np.sin(angle)
    return np.stack([np.stack([c, -s], axis=-1), np.stack([s, c], axis=-1)], axis=-2)

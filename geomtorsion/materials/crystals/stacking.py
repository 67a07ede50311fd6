"""Stacking: bonds of hcp read layer by layer, so that basal faults are not torsion."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from geomtorsion.materials.crystals.lattices import Lattice


def layered(lattice: Lattice) -> Lattice:
    """All sites of close-packed layers A, B and C at all heights, in the units of hcp.

    They are differences of vectors of hcp, shifts 1/3<1 -1 0 0> in the plane and c/2 along the
    axis.
    """
    return replace(lattice, period=(2, 2, 1), points=((0, 0, 0), (1, 1, 0)), basis=())


def stacked_labels(
    lattice: Lattice,
    values: np.ndarray,
    pairs: np.ndarray,
    kinds: np.ndarray,
    known: np.ndarray,
) -> tuple[np.ndarray, np.ndarray]:
    """Labels of bonds in `layered`, and a mask of bonds about whose layers the atoms disagree.

    The layers above and below an atom each have one of two positions over its own layer. Its bonds,
    free of its own deviation in the plane, decide by least squares. Two equal positions are hcp,
    different ones cubic. A bond to the next layer is read in the way of its two atoms.

    Parameters
    ----------
    values
        Bonds along the crystal axes in units of the lattice, shape (k, 3).
    pairs
        Their atoms, shape (k, 2).
    kinds
        Sublattice of each atom, 0 or 1, shape (atoms,).
    known
        Atoms all of whose bonds are here; for others the sublattice gives the layers, (atoms,).
    """
    ways = _ways(lattice, values, pairs, kinds, known)
    first, second = pairs.T
    low = np.floor(values[:, 2]).astype(np.int64)
    best = np.full(len(values), np.inf)
    labels = np.zeros(values.shape, dtype=np.int64)
    torn = np.zeros(len(values), dtype=bool)
    for height in (low, low + 1):
        side = (height > 0).astype(np.int64)
        one, other = ways[first, side], -ways[second, 1 - side]
        for layer in (one, other):
            # The next layer but one is where the shifts of both lead.
            way = np.select([height == 0, np.abs(height) == 1], [0, layer], one + other)
            near, distances = _nearest(lattice, values, height, way)
            closer = distances < best
            best = np.where(closer, distances, best)
            labels[closer] = near[closer]
            torn[closer] = ((np.abs(height) == 1) & (one != other))[closer]
    return labels, torn


def _ways(
    lattice: Lattice, values: np.ndarray, pairs: np.ndarray, kinds: np.ndarray, known: np.ndarray
) -> np.ndarray:
    """Positions of the layers below and above each atom, in 1/3[1 -1 0 0]: 1 or -1, (atoms, 2)."""
    at = np.concatenate([values, -values])
    atom = np.concatenate([pairs[:, 0], pairs[:, 1]])
    height = np.rint(at[:, 2]).astype(np.int64)
    count = len(kinds)
    inside, sums = height == 0, np.zeros((count, 3))
    np.add.at(sums, atom[inside], at[inside] - lattice.decode(at[inside]))
    many = np.bincount(atom[inside], minlength=count)
    own = sums / np.maximum(many, 1)[:, None]
    steep = np.abs(height) == 1
    at, atom, height = at[steep], atom[steep], height[steep]
    one, other = (_nearest(lattice, at - own[atom], height, way)[1] for way in (1, -1))
    votes = np.zeros((count, 2))
    np.add.at(votes, (atom, (height > 0).astype(np.int64)), other - one)
    by_kind = np.repeat((1 - 2 * kinds)[:, None], 2, axis=1)
    return np.where(known[:, None] & (votes != 0), np.where(votes > 0, 1, -1), by_kind)


def _nearest(
    lattice: Lattice, values: np.ndarray, height: np.ndarray, way: np.ndarray | int
) -> tuple[np.ndarray, np.ndarray]:
    """The nearest site of layers at a height with a given shift, and its distance squared."""
    move = height[:, None] * np.array([0, 0, 1]) + np.multiply.outer(way, [0, 2, 0])
    near = lattice.decode(values - move) + move
    return near, (((values - near) * lattice.units) ** 2).sum(axis=1)

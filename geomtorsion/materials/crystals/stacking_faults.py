"""Stacking faults: bonds across them in fcc, diamond and hcp, so that faults are not torsion."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from geomtorsion.materials.crystals.lattices import LATTICES, Lattice

# Differences of lattice vectors of fcc and shifts 1/6<112> are again face-centred, in sixths of a.
SIXTHS = replace(LATTICES["fcc"], units=(1 / 6, 1 / 6, 1 / 6))
# As above in twelfths, for diamond, whose bonds are counted in quarters of a.
TWELFTHS = replace(
    LATTICES["diamond"],
    units=(1 / 12, 1 / 12, 1 / 12),
    points=tuple((2 * x, 2 * y, 2 * z) for x, y, z in LATTICES["fcc"].points),
)
MODULES = {"fcc": SIXTHS, "diamond": TWELFTHS}
# Normals of the planes {111}: bonds of diamond, from its atoms of the first kind.
NORMALS = np.array([[1, 1, 1], [1, -1, -1], [-1, 1, -1], [-1, -1, 1]])
# Shift of the layer above a fault, in sixths of a, three equivalent ones up to lattice vectors:
# the other sense would lead from B over A not to C but onto A.
SHIFTS = NORMALS[:, None] * [[1, 1, -2], [1, -2, 1], [-2, 1, 1]]


def fault_labels(
    lattice: Lattice,
    values: np.ndarray,
    labels: np.ndarray,
    pairs: np.ndarray,
    kinds: np.ndarray,
    known: np.ndarray,
) -> tuple[np.ndarray, np.ndarray]:
    """Labels of bonds in sixths of a (diamond: in twelfths), and a mask.

    The mask marks bonds about whose layers the two atoms do not agree.

    For each plane {111}, the layers above and below an atom are where the lattice has them, or are
    shifted; the bonds of the atom, free of its own deviation in the plane, decide by least squares.
    A bond to the next layer is read in the way of its two atoms.

    Parameters
    ----------
    values, labels
        Bonds along the crystal axes and their nearest lattice vectors, in units of the lattice,
        shape (k, 3).
    pairs
        Their atoms, shape (k, 2).
    kinds
        Sublattice of each atom, 0 or 1, shape (atoms,).
    known
        Atoms all of whose bonds are here; next to others there is no fault, shape (atoms,).
    """
    change = kinds[pairs[:, 1]] - kinds[pairs[:, 0]]
    scale = 2 if lattice.basis else 1
    moved = np.zeros(values.shape, dtype=np.int64)
    torn = np.zeros(len(values), dtype=bool)
    for normal, shifts in zip(NORMALS, SHIFTS, strict=True):
        # A bond along the normal joins two diamond atoms that count as one fcc atom: faults are in
        # the glide set, between such layers.
        steps = (values - change[:, None] * normal * (scale - 1)) / scale
        upwards = steps @ normal / 2
        above = np.rint(upwards).astype(np.int64)
        flat = steps - np.multiply.outer((upwards - above) * 2 / 3, normal)
        off = flat - LATTICES["fcc"].decode(flat)
        layers, split = _shifted(off, above, pairs, shifts / 3, known)
        moved += scale * np.multiply.outer(layers, shifts[0])
        torn |= split
    sixths, some = 3 * labels, np.flatnonzero(moved.any(axis=1))
    at = values[some] - moved[some] / 3
    sixths[some] = 3 * lattice.decode(at, change[some]) + moved[some]
    return sixths, torn


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


def _shifted(
    off: np.ndarray, height: np.ndarray, pairs: np.ndarray, shifts: np.ndarray, known: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """Number of shifts of each bond, and a mask of bonds whose two atoms do not agree.

    off: from the nearest site in the layer at the end of a bond, shape (k, 3); height: the number
    of layers up to it, shape (k,); shifts: of the layer above a fault, in the same units, (3, 3).
    """
    count = len(known)
    inside, steep = (np.flatnonzero(np.abs(height) == m) for m in (0, 1))
    own, many = np.zeros((count, 3)), np.zeros(count)
    for atom, sign in zip(pairs[inside].T, (1, -1), strict=True):
        many += np.bincount(atom, minlength=count)
        for k in range(3):
            own[:, k] += sign * np.bincount(atom, off[inside, k], minlength=count)
    own /= np.maximum(many, 1)[:, None]
    sense = np.sign(height)
    low, high = np.where(height >= 0, pairs.T, pairs.T[::-1])
    up, below, above = sense[steep, None] * off[steep], low[steep], high[steep]
    ways = np.zeros((2, count), dtype=np.int64)
    for way, atom, free in ((ways[0], below, up - own[below]), (ways[1], above, up + own[above])):
        way[known & (np.bincount(atom, _gain(free, shifts), minlength=count) > 0)] = 1
    one, other = ways[0, low], ways[1, high]
    layers = np.zeros(len(height), dtype=np.int64)
    # Where two atoms do not agree, the one whose label is nearer to the bond counts.
    layers[steep] = np.where(one == other, one, 0)[steep]
    split = steep[one[steep] != other[steep]]
    layers[split] = _gain(sense[split, None] * off[split], shifts) > 0
    # A layer further off is where the shifts of both lead.
    far = np.abs(height) > 1
    layers[far] = (one + other)[far]
    torn = np.zeros(len(height), dtype=bool)
    torn[split] = True
    return layers * sense, torn


def _gain(off: np.ndarray, shifts: np.ndarray) -> np.ndarray:
    """Decrease of squared distances from sites when these are shifted, shape (k,)."""
    x, y, z = off.T
    best = np.max([x * a + y * b + z * c for a, b, c in shifts], axis=0)
    return 2 * best - shifts[0] @ shifts[0]


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

"""Faults: bonds across stacking faults, whose shift is no lattice vector."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from geomtorsion.crystals.lattices import LATTICES, Lattice

# Differences of lattice vectors of fcc and shifts 1/6<112> are again face-centred, in sixths of a.
SIXTHS = replace(LATTICES["fcc"], units=(1 / 6, 1 / 6, 1 / 6))
# The same of diamond, whose bonds are counted in quarters of a, in twelfths.
TWELFTHS = replace(
    LATTICES["diamond"],
    units=(1 / 12, 1 / 12, 1 / 12),
    points=tuple((2 * x, 2 * y, 2 * z) for x, y, z in LATTICES["fcc"].points),
)
MODULES = {"fcc": SIXTHS, "diamond": TWELFTHS}
# One shift for each plane {111} and sense, in sixths of a; the second half are the first reversed.
_PLANES = np.array([[1, 1, -2], [-1, 1, 2], [1, -1, 2], [1, 1, 2]])
SHIFTS = np.concatenate([_PLANES, -_PLANES])


def fault_shifts(
    lattice: Lattice,
    values: np.ndarray,
    labels: np.ndarray,
    pairs: np.ndarray,
    kinds: np.ndarray,
) -> tuple[np.ndarray, np.ndarray]:
    """Bonds that cross a stacking fault, and their labels in sixths of a; in diamond twelfths.

    A bond crosses one if it lies nearer to a lattice vector plus 1/6<112> than to any lattice
    vector, and so do two more of the bonds of each of its atoms, in one plane and sense: three
    bonds of an atom cross the plane {111} at its side.

    Parameters
    ----------
    values, labels
        Bonds along the crystal axes and their nearest lattice vectors, in units of the lattice,
        shape (k, 3).
    pairs
        Their atoms, shape (k, 2).
    kinds
        Sublattice of each atom, 0 or 1, shape (atoms,).
    """
    own = ((values - labels) ** 2).sum(axis=1)
    found = 3 * labels
    # Nearer to a shift than to none it can only be beyond half the shift.
    shifts = SHIFTS * (1 if lattice.name == "fcc" else 2)
    half = (shifts[0] / 3 / 2) @ (shifts[0] / 3 / 2)
    change = kinds[pairs[:, 1]] - kinds[pairs[:, 0]]
    some = np.flatnonzero(own > half)
    best, which = own[some], np.full(len(some), -1)
    for number, shift in enumerate(shifts / 3):
        near = lattice.decode(values[some] - shift, change[some])
        apart = ((values[some] - shift - near) ** 2).sum(axis=1)
        closer = apart < best
        best = np.where(closer, apart, best)
        which[closer] = number
        found[some[closer]] = 3 * near[closer] + shifts[number]
    mine = some[which >= 0]
    shift = which[which >= 0]
    opposite = (shift + len(_PLANES)) % len(SHIFTS)
    count = np.zeros((len(kinds), len(SHIFTS)), dtype=np.int64)
    np.add.at(count, (pairs[mine, 0], shift), 1)
    np.add.at(count, (pairs[mine, 1], opposite), 1)
    agreed = (count[pairs[mine, 0], shift] >= 3) & (count[pairs[mine, 1], opposite] >= 3)
    crossing = np.zeros(len(values), dtype=bool)
    crossing[mine[agreed]] = True
    return crossing, np.where(crossing[:, None], found, 3 * labels)

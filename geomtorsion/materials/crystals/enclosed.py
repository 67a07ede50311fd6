"""Enclosed: the number of atoms in excess of lattice sites inside a closed dislocation line.

A surface is placed around the line, in the good crystal. There every atom has a site, given by
whole numbers that add up from bond to bond. This sum does not depend on the path, because the
surface is a sphere without torsion. The sites that the surface separates from the outside are the
inner sites. The atoms in excess of them are the atoms that the line has inserted.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from itertools import product

import numpy as np
import scipy  # loads its parts on first use

from geomtorsion.materials.crystals.frames import Frame
from geomtorsion.materials.crystals.lattices import Lattice
from geomtorsion.materials.crystals.method import METHOD
from geomtorsion.materials.crystals.shells import Shells, reach_of_shells, shells_of
from geomtorsion.materials.crystals.surroundings import Places
from geomtorsion.materials.crystals.torsion import components
from geomtorsion.materials.crystals.triangulation import Cell, distinct


@dataclass(frozen=True, eq=False)
class Around:
    """A prism around a closed path; its base is convex and in the plane of the path.

    middle: centre of a box around the path, shape (3,); axes: axes of the box as rows, shape
        (3, 3); half: half of its sides, shape (3,).
    sides: outward normals of the base and their distances from the middle, shape (k, 3).
    """

    middle: np.ndarray
    axes: np.ndarray
    half: np.ndarray
    sides: np.ndarray

    @classmethod
    def of(cls, path: np.ndarray) -> Around | None:
        """The prism along the principal axes of a path; None for a path without area."""
        mean = path.mean(axis=0)
        axes = np.linalg.svd(path - mean)[2]
        along = (path - mean) @ axes.T
        low, high = along.min(axis=0), along.max(axis=0)
        flat = (along - (low + high) / 2)[:, :2]
        half = (high - low) / 2
        try:
            hull = scipy.spatial.ConvexHull(flat).equations
        except scipy.spatial.QhullError:
            return None
        # The sides of the box keep corners of acute angles within it.
        box = [[1, 0, -half[0]], [-1, 0, -half[0]], [0, 1, -half[1]], [0, -1, -half[1]]]
        return cls(mean + (low + high) / 2 @ axes, axes, half, np.concatenate([hull, box]))

    def inside(
        self, places: np.ndarray, cell: Cell, margin: float, every: bool = True
    ) -> np.ndarray:
        """Vectors from the middle to all images of places inside it or within a margin, (k, 3).

        every: if False, places are unwrapped, and their own image is omitted.
        """
        steps, vectors = places - self.middle, [np.zeros((0, 3))]
        if every:
            steps -= (np.rint(steps @ cell.inverse) * cell.periodic) @ cell.vectors
        # Its extent along the edges, in periods.
        shares = np.abs(self.axes @ cell.inverse).T @ (self.half + margin)
        wide = cell.periodic & (shares >= 0.5)
        for image in product(*((-1, 0, 1) if flag else (0,) for flag in wide)):
            if every or any(image):
                moved = cell.moved(steps, image)
                near = moved[(np.abs(moved @ self.axes.T) < self.half + margin).all(axis=1)]
                vectors.append(near[self.depth(near) < margin])
        return np.concatenate(vectors)

    def depth(self, steps: np.ndarray) -> np.ndarray:
        """Distance of the ends of steps from the prism, shape (k,); negative inside."""
        along = steps @ self.axes.T
        base = (along[:, :2] @ self.sides[:, :2].T + self.sides[:, 2]).max(axis=1, initial=-np.inf)
        return np.maximum(base, np.abs(along[:, 2]) - self.half[2])


def inserted_about(
    path: np.ndarray, others: np.ndarray, frame: Frame, cell: Cell, places: np.ndarray
) -> int | None:
    """Atoms in excess of sites around a closed line; an isolated vacancy counts as an atom.

    Parameters
    ----------
    path
        Points of the line, shape (k, 3).
    others
        Points of all other lines, shape (n, 3).
    places
        Positions of all atoms in the cell, shape (atoms, 3).

    Returns
    -------
    None where no good crystal surrounds this line by itself: at a surface, in much noise, next
    to another line, or in a cell that is hardly larger than the line.
    """
    around = Around.of(path)
    if around is None:
        return None
    nearest, reach = frame.lattice.nearest * frame.constant, reach_of_shells(frame)
    # On either side, a core is at most as wide as the least distance of two separate lines.
    for margin in nearest * np.arange(1, 2 * METHOD.width + 1):
        outer = margin + reach
        # Neither another line nor an image of this line is inside.
        if len(around.inside(others, cell, outer)) or len(around.inside(path, cell, outer, False)):
            return None
        steps = around.inside(places, cell, outer + reach)
        excess = _counted(steps, around, margin, outer, frame)
        if excess is not None:
            return excess
    return None


def _counted(
    steps: np.ndarray, around: Around, margin: float, outer: float, frame: Frame
) -> int | None:
    """Atoms in excess of sites inside, if all is sound between two depths; steps: of atoms."""
    if len(steps) < 2:
        return None
    lattice, middle = frame.lattice, (margin + outer) / 2
    open_box = Cell(np.eye(3), np.zeros(3, dtype=bool))
    shells = shells_of(Places(steps, open_box, reach_of_shells(frame)), frame)
    deep = around.depth(steps)
    shell = np.flatnonzero((deep > margin) & (deep < outer))
    sites = _sites(shells, shell, lattice)
    if sites is None:
        return None
    bonds = np.array(lattice.neighbours)[shells.kind[shell]]
    beside = (sites[:, None] + bonds).reshape(-1, 3)
    root = steps[shell[int((~sites.any(axis=1)).argmax())]]

    def apart(some: np.ndarray) -> np.ndarray:
        return around.depth(root + frame.vectors(some))

    free, outside = _free(sites, lattice, apart, outer + 2 * reach_of_shells(frame))
    if len(distinct(sites.T)[0]) < len(sites):
        # Two atoms share one site.
        return None
    every = np.concatenate([free, sites])
    # The expected position of a free site next to the shell decides on which side it is: nothing
    # else is missing in the shell, and the shell has no hole.
    which = distinct(np.concatenate([every, beside]).T)[1]
    number = np.full(which.max() + 1, len(every))
    number[which[: len(every)]] = np.arange(len(every))
    other = number[which[len(every) :]]
    ideal = np.array(lattice.ideal)[shells.kind[shell]] @ frame.matrix
    expected = around.depth((steps[shell][:, None] + ideal).reshape(-1, 3)) > middle
    # A site that was not examined is far outside.
    gaps = (other < len(free)) | (other == len(every))
    outside = np.concatenate([outside, np.ones(len(sites) + 1, dtype=bool)])
    if (outside[other[gaps]] != expected[gaps]).any():
        return None
    first = shells.vacancies
    slot = (shells.near[first] == shells.sites[:, None]).argmax(axis=1)
    # The site itself decides: the first atom beside it may be on the other side of the middle.
    vacant = steps[first] + np.array(lattice.ideal)[shells.kind[first], slot] @ frame.matrix
    vacancies = int((around.depth(vacant) < middle).sum())
    return int((deep <= margin).sum()) + vacancies - int((~outside).sum())


def _sites(shells: Shells, shell: np.ndarray, lattice: Lattice) -> np.ndarray | None:
    """Sites of atoms in whole numbers, from an atom of the first kind, shape (k, 3).

    None where the sites depend on the path along bonds, or where the atoms are not connected.
    """
    kind, count = shells.kind[shell], len(shell)
    if not count or kind.all():
        return None
    number = np.full(len(shells.near) + 1, -1)
    number[shell] = np.arange(count)
    near = shells.near[shell]
    # The numbers after the atoms are vacancies.
    to = number[np.where(near < len(shells.near), near, -1)]
    first, slot = np.nonzero(to >= 0)
    second = to[first, slot]
    bonds = np.array(lattice.neighbours)[kind[first], slot]
    table = scipy.sparse.coo_array((np.ones(len(first)), (first, second)), (count, count)).tocsr()
    root = int(kind.argmin())
    order, before = scipy.sparse.csgraph.breadth_first_order(table, root)
    if len(order) < count:
        return None
    # The bond that reached each atom, and then sums along bonds, twice as many each time.
    before[root] = root
    sites = np.zeros((count, 3), dtype=np.int64)
    chosen = before[second] == first
    sites[second[chosen]] = bonds[chosen]
    sites[root] = 0
    while (before != root).any():
        sites += sites[before]
        before = before[before]
    return sites if (sites[second] - sites[first] == bonds).all() else None


def _free(
    sites: np.ndarray, lattice: Lattice, depth: Callable[[np.ndarray], np.ndarray], far: float
) -> tuple[np.ndarray, np.ndarray]:
    """Sites around others no deeper than far, in whole numbers, and a mask.

    The mask marks the sites that the others do not separate from the outside.
    """
    period = np.array(lattice.period)
    low, high = (
        (sites.min(axis=0) // period - 2).tolist(),
        (sites.max(axis=0) // period + 3).tolist(),
    )
    kinds = [np.array(lattice.points) + place for place in lattice.offsets]
    parts = []
    for x in range(low[0], high[0]):
        cells = np.array(list(product((x,), *map(range, low[1:], high[1:])))) * period
        some = (cells[:, None] + np.concatenate(kinds)).reshape(-1, 3)
        parts.append(some[depth(some) < far])
    every = np.concatenate(parts)
    # Keep the first occurrence of each; those after the old sites are free.
    first, _ = distinct(np.concatenate([sites, every]).T)
    free = every[first[first >= len(sites)] - len(sites)]
    longest = np.linalg.norm(lattice.ideal[0], axis=1).max()
    tree = scipy.spatial.cKDTree(free * np.array(lattice.units))
    number = components(len(free), tree.query_pairs(longest * (1 + 1e-9), output_type="ndarray"))
    return free, number == number[int(depth(free).argmax())]

"""Shells: the neighbours of each atom by the lattice vector between them, and where they close.

Where every atom has all its neighbours and every triangle of lattice vectors closes at its first
atom, there is no torsion: only the other regions need a triangulation.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import scipy  # loads its parts on first use

from geomtorsion.materials.crystals.frames import Frame
from geomtorsion.materials.crystals.lattices import Lattice
from geomtorsion.materials.crystals.local_frames import squared
from geomtorsion.materials.crystals.method import METHOD
from geomtorsion.materials.crystals.surroundings import Places
from geomtorsion.materials.crystals.triangulation import Cell


@dataclass(frozen=True, eq=False)
class Shells:
    """Neighbours by lattice vector.

    near: number of the neighbour for each vector of `Lattice.neighbours`, -1 where there is none,
        shape (atoms, k).
    kind: of each atom, from 0, one of `Lattice.offsets`, shape (atoms,).
    closed: atoms about which every triangle closes, shape (atoms,); those at a surface lack
        neighbours.
    vacancies: sites without an atom on which all their neighbours agree: the first of these.
    sites: numbers of these sites in `near`, after the numbers of the atoms.
    """

    near: np.ndarray
    kind: np.ndarray
    closed: np.ndarray
    vacancies: np.ndarray
    sites: np.ndarray


def dilated(atoms: np.ndarray, near: np.ndarray) -> np.ndarray:
    """Atoms and their neighbours, shape (atoms,) of truth values."""
    region = atoms.copy()
    behind = near[atoms].ravel()
    # Other numbers are vacancies or missing neighbours.
    region[behind[(behind >= 0) & (behind < len(atoms))]] = True
    return region


def reach_of_shells(frame: Frame) -> float:
    """Distance within which an atom has all its neighbours, coordinates."""
    lattice = frame.lattice
    longest = np.linalg.norm(lattice.ideal[0], axis=1).max()
    return float(frame.largest_stretch * frame.constant * (longest + lattice.nearest / 2))


def shells_of(atoms: Places, frame: Frame, together: int = METHOD.together) -> Shells:
    """Neighbours of all atoms in a cell, and where their vectors close.

    A neighbour counts if it is nearer to its place than half the neighbour distance. Missing
    neighbours on whose place all others agree are vacancies: they are inserted before the test. So
    many atoms are processed together, which affects memory, not values.
    """
    lattice, places, cell = frame.lattice, atoms.places, atoms.cell
    count, reach = len(places), reach_of_shells(frame)
    around = atoms.within(reach)
    points, numbers, tree = around.points, around.numbers, around.tree
    near = np.empty((count, lattice.shells), dtype=np.int64)
    kind = np.empty(count, dtype=np.int64)
    single = np.empty(count, dtype=bool)
    for start in range(0, count, together):
        part = slice(start, min(start + together, count))
        _, indices = tree.query(places[part], k=lattice.shells + 1, distance_upper_bound=reach)
        near[part], kind[part], single[part] = _slots(
            places[part], points, numbers, indices[:, 1:], frame
        )
    near, kind, held = _with_vacancies(near, kind, places, cell, frame)
    closed = _closing(near, kind, lattice)
    closed[:count] &= single
    gaps = np.flatnonzero((near[:count] < 0).any(axis=1) & closed[:count])
    if len(gaps):
        closed[gaps] = _at_surface(gaps, near, kind, tree, places, cell, frame)
    # An atom that needs a vacancy that does not close is also open.
    leaning = held[~closed[count:]].ravel()
    closed[leaning[leaning < count]] = False
    filled = (near[count:] >= 0).all(axis=1) & closed[count:]
    firsts = held[filled].min(axis=1)
    sites = count + np.flatnonzero(filled)
    return Shells(near[:count], kind[:count], closed[:count], firsts, sites)


def _slots(
    places: np.ndarray, points: np.ndarray, numbers: np.ndarray, found: np.ndarray, frame: Frame
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Neighbours in the order of lattice vectors, kinds, and whether none is claimed twice."""
    lattice = frame.lattice
    there = found < len(points)
    safe = np.where(there, found, 0)
    at = (points[safe] - places[:, None]) @ frame.inverse
    rows = np.arange(len(places))[:, None]
    sure_below = (lattice.nearest / 2) ** 2
    best = None
    for number, ideal in enumerate(lattice.ideal):
        closeness = at @ (2 * ideal.T) - (ideal**2).sum(axis=1)
        which = closeness.argmax(axis=2)
        squares = squared(at - ideal[which])
        sure = there & (squares < sure_below)
        near = np.full(found.shape, -1, dtype=np.int64)
        near[np.broadcast_to(rows, found.shape)[sure], which[sure]] = numbers[safe[sure]]
        # A neighbour that lost its place to a vacancy counts as missing, wherever it is.
        misfit = np.where(there, np.minimum(squares, sure_below), sure_below).sum(axis=1)
        single = (near >= 0).sum(axis=1) == sure.sum(axis=1)
        if best is None:
            best = (near, np.zeros(len(places), dtype=np.int64), single, misfit)
            continue
        closer = misfit < best[3]
        best = (
            np.where(closer[:, None], near, best[0]),
            np.where(closer, number, best[1]),
            np.where(closer, single, best[2]),
            np.minimum(misfit, best[3]),
        )
    assert best is not None
    return best[:3]


def _tables(lattice: Lattice) -> tuple[np.ndarray, np.ndarray, list[tuple[int, int, int, int]]]:
    """Slots of reversed vectors, kinds of their atoms, and triangles for each kind.

    Slot of each vector reversed, and kind of the atom at its end, both of shape (kinds, k).
    A triangle is (kind, s, t, u): vector s, then vector t of the neighbour, is vector u.
    """
    kinds = lattice.neighbours
    slot = [{tuple(v): k for k, v in enumerate(vectors.tolist())} for vectors in kinds]
    behind = np.zeros((len(kinds), lattice.shells), dtype=np.int64)
    cell = np.array(lattice.period)
    points = {tuple(p) for p in (np.array(lattice.points) % cell).tolist()}
    for kind, vectors in enumerate(kinds):
        for end_kind, place in enumerate(lattice.offsets):
            ends = (vectors + lattice.offsets[kind] - place) % cell
            behind[kind, [tuple(v) in points for v in ends.tolist()]] = end_kind
    back = np.array(
        [
            [slot[behind[kind][k]][tuple((-v).tolist())] for k, v in enumerate(vectors)]
            for kind, vectors in enumerate(kinds)
        ]
    )
    # Each triangle is counted once, along a direction that is perpendicular to no side.
    along = np.array([1.0, np.sqrt(2) - 1, np.sqrt(3) - np.sqrt(2)])
    triangles = []
    for kind, vectors in enumerate(kinds):
        for s, first in enumerate(vectors):
            if first @ along < 0:
                continue
            for t, second in enumerate(kinds[behind[kind][s]]):
                if second @ along < 0:
                    continue
                u = slot[kind].get(tuple((first + second).tolist()))
                if u is not None:
                    triangles.append((kind, s, t, u))
    return back, behind, triangles


def _closing(near: np.ndarray, kind: np.ndarray, lattice: Lattice) -> np.ndarray:
    """Atoms whose existing neighbours have them as neighbours, and whose triangles close."""
    back, behind, triangles = _tables(lattice)
    torn = np.zeros(len(near), dtype=bool)
    # The neighbour of number -1 does not exist and has no neighbours.
    near = np.concatenate([near, np.full((1, near.shape[1]), -1)])
    kind = np.append(kind, -1)
    for number in range(len(lattice.neighbours)):
        mine = np.flatnonzero(kind == number)
        for s in range(near.shape[1]):
            neighbour = near[mine, s]
            wrong = near[neighbour, back[number, s]] != mine
            wrong |= kind[neighbour] != behind[number, s]
            wrong &= neighbour >= 0
            torn[mine[wrong]] = True
            # A neighbour that does not have this atom as a neighbour is out of place as well.
            torn[neighbour[wrong]] = True
        for one, s, t, u in triangles:
            if one != number:
                continue
            middle, last = near[mine, s], near[mine, u]
            third = near[middle, t]
            hit = np.flatnonzero((third != last) & (middle >= 0))
            for atoms in (mine[hit], middle[hit], last[hit], third[hit]):
                torn[atoms[atoms >= 0]] = True
    return ~torn


def _at_surface(
    atoms: np.ndarray, near: np.ndarray, kind: np.ndarray, tree: scipy.spatial.cKDTree,
    places: np.ndarray, cell: Cell, frame: Frame,
) -> np.ndarray:  # fmt: skip
    """Which of some atoms touch an empty sphere that is larger than any in a crystal."""
    lattice = frame.lattice
    ideal = np.array(lattice.ideal)
    missing = near[atoms] < 0
    steps = ideal[kind[atoms]] @ frame.matrix
    radius = METHOD.reach * lattice.nearest * frame.constant
    mask = np.zeros(len(atoms), dtype=bool)
    ways = [(steps * missing[:, :, None]).sum(axis=1), *np.swapaxes(steps, 0, 1)]
    for number, way in enumerate(ways):
        left = np.flatnonzero(~mask & (missing[:, number - 1] if number else True))
        out = way[left] / np.maximum(np.linalg.norm(way[left], axis=1), 1e-300)[:, None]
        # In the cell, since outside it images extend only as far as neighbours do.
        centres, _ = cell.wrapped(places[atoms[left]] + radius * out)
        distances, _ = tree.query(centres)
        # The atom itself touches the sphere; others may be slightly inside at an uneven surface.
        mask[left[distances > METHOD.uneven * radius]] = True
    return mask


def _with_vacancies(
    near: np.ndarray, kind: np.ndarray, places: np.ndarray, cell: Cell, frame: Frame
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Neighbours extended by sites for vacancies after the atoms, and the atoms around each site.

    The atoms around a site have the number of all atoms where there is none, shape (sites, k).
    """
    lattice = frame.lattice
    back, behind, _ = _tables(lattice)
    gaps = (near < 0).sum(axis=1)
    # An atom that lacks most of its neighbours does not determine their places.
    atom, slot = np.nonzero((near < 0) & (gaps <= lattice.shells // 2)[:, None])
    if not len(atom):
        return near, kind, np.zeros((0, lattice.shells), dtype=np.int64)
    ideal = np.array(lattice.ideal)
    steps = ideal[kind[atom], slot] @ frame.matrix
    seen, _ = cell.wrapped(places[atom] + steps)
    near_by = frame.constant * lattice.nearest / 2
    points, numbers, _ = cell.with_ghosts(seen, near_by)
    pairs = scipy.spatial.cKDTree(points).query_pairs(near_by, output_type="ndarray")
    table = scipy.sparse.coo_array(
        (np.ones(len(pairs)), (numbers[pairs[:, 0]], numbers[pairs[:, 1]])),
        shape=(len(seen), len(seen)),
    )
    _, site = scipy.sparse.csgraph.connected_components(table, directed=False)
    many, count = int(site.max()) + 1, len(near)
    first = np.unique(site, return_index=True)[1]
    # One place for each, around the one that was found first.
    from_first, _ = _nearest_image(seen - seen[first][site], cell)
    centre = seen[first].copy()
    sums = np.zeros((many, 3))
    np.add.at(sums, site, from_first)
    centre += sums / np.bincount(site)[:, None]
    site_kind = behind[kind[atom], slot][first]
    around = np.full((many, lattice.shells), -1, dtype=np.int64)
    claims = np.zeros((many, lattice.shells), dtype=np.int64)
    where = back[kind[atom], slot]
    np.add.at(claims, (site, where), 1)
    around[site, where] = atom
    # Neighbouring sites are found from the atoms around them.
    inside, _ = cell.wrapped(centre)
    size = frame.largest_stretch * frame.constant * np.linalg.norm(ideal[0], axis=1).max() + near_by
    points, numbers, _ = cell.with_ghosts(inside, size)
    tree = scipy.spatial.cKDTree(points)
    empty, slots = np.nonzero(around < 0)
    target = inside[empty] + ideal[site_kind[empty], slots] @ frame.matrix
    distances, which = tree.query(target, distance_upper_bound=near_by)
    held = np.isfinite(distances)
    around[empty[held], slots[held]] = count + numbers[which[held]]
    good = (around >= 0).all(axis=1) & (claims <= 1).all(axis=1)
    good &= np.bincount(site, site_kind[site] != behind[kind[atom], slot], many) == 0
    near = near.copy()
    chosen = good[site]
    near[atom[chosen], slot[chosen]] = count + site[chosen]
    sites = np.where(around >= 0, np.minimum(around, count), count)
    around[~good] = -1
    return np.concatenate([near, around]), np.concatenate([kind, site_kind]), sites


def _nearest_image(steps: np.ndarray, cell: Cell) -> tuple[np.ndarray, np.ndarray]:
    """Steps in the nearest image, and the periods added."""
    moved = -np.rint(steps @ cell.inverse) * cell.periodic
    return steps + moved @ cell.vectors, moved

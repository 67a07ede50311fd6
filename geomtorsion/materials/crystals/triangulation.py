"""Triangulation: Delaunay tetrahedra of atoms in a cell, periodic along any of its edges."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import combinations

import numpy as np
import scipy  # loads its parts on first use

from geomtorsion.errors import CrystalError
from geomtorsion.materials.crystals.method import METHOD
from geomtorsion.support.caching import cached_property

# Corners of the faces of a tetrahedron, the omitted corner first to last: its boundary is
# sum of (-1)^k face_k.
FACES = ((1, 2, 3), (0, 2, 3), (0, 1, 3), (0, 1, 2))
EDGES = tuple(combinations(range(4), 2))
SIGNS = np.array([1, -1, 1, -1])
# Numbers of edges and faces, some ten or more for each atom: fewer than 2^31 fit in memory.
NUMBER = np.int32
# The options of scipy, and Q7: facets depth first, which takes 0.8 of the time for the same result.
QHULL = "Qbb Qc Qz Q12 Q7"


@dataclass(frozen=True, eq=False)
class Cell:
    """A cell with atoms in it.

    vectors: its edges as rows, shape (3, 3); unit vectors for an open box without edges.
    periodic: along which edges it repeats, shape (3,).
    """

    vectors: np.ndarray
    periodic: np.ndarray

    @cached_property
    def inverse(self) -> np.ndarray:
        """Takes coordinates to fractions of the edges: x @ inverse."""
        return np.linalg.inv(self.vectors)

    @cached_property
    def heights(self) -> np.ndarray:
        """Distance of opposite sides, shape (3,)."""
        return 1.0 / np.linalg.norm(self.inverse, axis=0)

    def wrapped(self, positions: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Positions inside the cell along its periodic edges, and the periods added to each."""
        if not self.periodic.any():
            return positions, np.zeros(positions.shape, dtype=np.int64)
        moved = -np.floor(positions @ self.inverse) * self.periodic
        return positions + moved @ self.vectors, moved.astype(np.int64)

    def shifts(self, images: np.ndarray) -> np.ndarray:
        """Positions of images, shape (k, 3): the same bits for each, whatever the others are."""
        return by_rows(images, self.vectors)

    def moved(self, places: np.ndarray, image: Sequence[int]) -> np.ndarray:
        """Places in another image, edge after edge, as `with_ghosts` has them to the last bit."""
        for k, m in enumerate(image):
            places = places + m * self.vectors[k] if m else places
        return places

    def with_ghosts(
        self, places: np.ndarray, width: float
    ) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Wrapped positions and their images as far as `width` outside the cell.

        Returns positions, number of the atom and image of each; the atoms themselves come first.
        """
        numbers = np.arange(len(places), dtype=np.int64)
        offsets = np.zeros((len(places), 3), dtype=np.int64)
        for k in np.flatnonzero(self.periodic):
            share = places @ self.inverse[:, k]
            margin = width / self.heights[k]
            parts = [(places, numbers, offsets)]
            for m in range(1, int(np.ceil(margin)) + 1):
                for sign in (1, -1):
                    at = share + sign * m
                    chosen = (at < 1 + margin) if sign > 0 else (at > -margin)
                    moved = offsets[chosen].copy()
                    moved[:, k] += sign * m
                    place = places[chosen] + sign * m * self.vectors[k]
                    parts.append((place, numbers[chosen], moved))
            places, numbers, offsets = (np.concatenate(x) for x in zip(*parts, strict=True))
        return places, numbers, offsets


@dataclass(frozen=True, eq=False)
class Triangulation:
    """Tetrahedra with their faces and edges, each once in a periodic cell.

    Corners, and with them all senses, are in the order of the numbers of the atoms.

    corners: atoms of each tetrahedron, shape (k, 4); offsets: their images, the first being in the
        cell, shape (k, 4, 3).
    places: positions in the cell, shape (atoms, 3); cell: the cell.
    senses: 1 or -1, the sign of the volume spanned by the corners, shape (k,).
    known: atoms all of whose tetrahedra are there, shape (atoms,).
    """

    corners: np.ndarray
    offsets: np.ndarray
    places: np.ndarray
    cell: Cell
    senses: np.ndarray
    known: np.ndarray

    @cached_property
    def edges(self) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Edges as atoms, images and numbers.

        Atoms of each edge, shape (n, 2); image of the second, (n, 3); edges of each
        tetrahedron, (k, 6).
        """
        # Column by column: all rows at once would take four times as much memory.
        ends = [np.concatenate([self.corners[:, e[k]] for e in EDGES]) for k in (0, 1)]
        images = [
            np.concatenate([self.offsets[:, b, k] - self.offsets[:, a, k] for a, b in EDGES])
            for k in range(3)
        ]
        first, which = distinct([*ends, *images])
        pairs, moved = (np.stack([x[first] for x in part], axis=1) for part in (ends, images))
        return pairs, moved, which.reshape(6, -1).T

    @cached_property
    def faces(self) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Faces as edges, tetrahedra and images.

        Edges of each face, shape (n, 3): its boundary is the first plus the third minus the
        second. Tetrahedra at its two sides, -1 where there is none, (n, 2): its normal points from
        the first to the second. Image of the second relative to the first, (n, 3).
        """
        edge_of = {pair: k for k, pair in enumerate(EDGES)}
        of_cell = self.edges[2]
        count = len(self.corners)
        sides_of = [[edge_of[(a, b)], edge_of[(a, c)], edge_of[(b, c)]] for a, b, c in FACES]
        rows = [np.concatenate([of_cell[:, face[k]] for face in sides_of]) for k in range(3)]
        first, which = distinct(rows)
        sides = np.full((len(first), 2), -1, dtype=NUMBER)
        base = np.zeros((len(first), 2, 3), dtype=NUMBER)
        owner = np.arange(count, dtype=NUMBER)
        # Only in a cell of about one atom can two faces have the same three edges: images differ.
        for face, sign, mine in zip(FACES, SIGNS, which.reshape(4, -1), strict=True):
            slot = (sign * self.senses < 0).astype(np.int8)
            sides[mine, slot] = owner
            base[mine, slot] = self.offsets[:, face[0]]
        images = base[:, 0] - base[:, 1]
        return np.stack([x[first] for x in rows], axis=1), sides, images

    @cached_property
    def centres(self) -> np.ndarray:
        """Centre of gravity of each tetrahedron, shape (k, 3)."""
        shift = self.cell.shifts(self.offsets.mean(axis=1))
        return self.places[self.corners].mean(axis=1) + shift


def by_rows(vectors: np.ndarray, matrix: np.ndarray) -> np.ndarray:
    """vectors @ matrix, shape (k, 3), each row rounded alike wherever it is, unlike in BLAS."""
    x, y, z = vectors.T[:, :, None]
    return x * matrix[0] + y * matrix[1] + z * matrix[2]


def distinct(columns: Sequence[np.ndarray] | np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """First occurrence of each distinct row of whole numbers, and the distinct row of each row."""
    count = len(columns[0])
    keys, room = [np.zeros(count, dtype=np.int64)], 1
    for column in columns:
        low = int(column.min(initial=0))
        span = int(column.max(initial=0)) - low + 1
        # As many columns in one key as 63 bits can hold.
        if room * span >= 2**62:
            keys.append(np.zeros(count, dtype=np.int64))
            room = 1
        keys[-1] *= span
        keys[-1] += column
        keys[-1] -= low
        room *= span
    # Equal rows stay in their order.
    order = keys[0].argsort(kind="stable") if len(keys) == 1 else np.lexsort(keys[::-1])
    new = np.zeros(count, dtype=bool)
    new[:1] = True
    while keys:
        key = keys.pop()[order]
        new[1:] |= key[1:] != key[:-1]
    which = np.empty(count, dtype=NUMBER)
    which[order] = np.cumsum(new, dtype=NUMBER) - 1
    return order[new], which


def jitter(numbers: np.ndarray) -> np.ndarray:
    """Random numbers from -1 to 1, fixed by the numbers of atoms, shape (atoms, 3).

    They are rows of an endless table, which is made only as far as needed.
    """
    noise = np.empty((len(numbers), 3))
    size = METHOD.together
    for start in np.unique(numbers // size).tolist():
        mine = np.flatnonzero(numbers // size == start)
        source = np.random.PCG64(0).advance(3 * size * start)
        rows = np.random.Generator(source).uniform(-1, 1, (size, 3))
        noise[mine] = rows[numbers[mine] - size * start]
    return noise


def triangulated(
    places: np.ndarray,
    cell: Cell,
    reach: float,
    wanted: np.ndarray | None = None,
    atoms: np.ndarray | None = None,
) -> Triangulation:
    """Delaunay tetrahedra with empty spheres up to a radius, periodic where the cell is.

    Parameters
    ----------
    places
        Positions in the cell (wrapped), shape (atoms, 3).
    reach
        Radius of the largest empty sphere that a tetrahedron may have: a larger sphere is a void,
        or is outside the crystal.
    wanted
        Atoms whose tetrahedra are requested, shape (atoms,) of truth values; all if not given.
        Atoms further than twice the reach from them, where no sphere reaches, are omitted.
    atoms
        Numbers of the atoms, increasing, where some are omitted: the tetrahedra are the same.

    Raises
    ------
    CrystalError
        All atoms are in one plane.
    """
    if wanted is not None and not wanted.any():
        none, images = np.zeros((0, 4), dtype=NUMBER), np.zeros((0, 4, 3), dtype=NUMBER)
        return Triangulation(none, images, places, cell, none[:, 0].astype(np.int64), wanted)
    noise = jitter(np.arange(len(places)) if atoms is None else atoms)
    moved = places + METHOD.jitter * reach * noise
    points, numbers, images = cell.with_ghosts(moved, 2 * reach)
    known = np.ones(len(places), dtype=bool) if wanted is None else wanted
    # One image of each requested tetrahedron has a known corner in the cell.
    inner = np.append(known, np.zeros(len(points) - len(places), dtype=bool))
    if wanted is not None:
        tree = scipy.spatial.cKDTree(points[inner])
        used = np.isfinite(tree.query(points, distance_upper_bound=2 * reach)[0])
        points, numbers, images, inner = points[used], numbers[used], images[used], inner[used]
    if len(points) < 5:
        raise CrystalError(
            f"positions: expected atoms that fill space, got only {len(places)}. Give more."
        )
    try:
        simplices = scipy.spatial.Delaunay(points, qhull_options=QHULL).simplices
    except scipy.spatial.QhullError:
        raise CrystalError(
            "positions: expected atoms that fill space, got atoms in one plane. Give more."
        ) from None
    simplices = simplices[inner[simplices].any(axis=1)].astype(np.int64)
    # Corners are in the order of atoms, and of images where one atom occurs twice.
    span = 2 * np.abs(images).max(initial=0) + 1
    code = ((images[:, 0] * span) + images[:, 1]) * span + images[:, 2]
    rank = np.lexsort((code, numbers))
    place = np.empty(len(rank), dtype=np.int64)
    place[rank] = np.arange(len(rank))
    simplices = rank[np.sort(place[simplices], axis=1)]
    small, senses = np.empty(len(simplices), dtype=bool), np.empty(len(simplices), dtype=np.int8)
    for start in range(0, len(simplices), METHOD.together):
        part = slice(start, start + METHOD.together)
        small[part], senses[part] = _spheres(points[simplices[part]], reach)
    tetrahedra = simplices[small]
    corners, offsets = numbers[tetrahedra], images[tetrahedra]
    # A tetrahedron found in several images is kept once, with the first of its corners in the cell.
    # The order is the one of the atoms, independent of other tetrahedra.
    offsets = offsets - offsets[:, :1]
    order, _ = distinct([*corners.T, *offsets[:, 1:].reshape(-1, 9).T])
    corners, offsets = corners.astype(NUMBER)[order], offsets.astype(NUMBER)[order]
    senses = senses[small].astype(np.int64)[order]
    return Triangulation(corners, offsets, places, cell, senses, known)


def _spheres(corners: np.ndarray, reach: float) -> tuple[np.ndarray, np.ndarray]:
    """Which tetrahedra have a circumsphere up to a radius, and the signs of their volumes.

    corners: shape (k, 4, 3).
    """
    sides = corners[:, 1:] - corners[:, :1]
    volume = np.linalg.det(sides)
    squares = (sides**2).sum(axis=2)
    middle = np.cross(sides[:, 1], sides[:, 2]) * squares[:, :1]
    middle += np.cross(sides[:, 2], sides[:, 0]) * squares[:, 1:2]
    middle += np.cross(sides[:, 0], sides[:, 1]) * squares[:, 2:]
    return np.linalg.norm(middle, axis=1) <= 2 * reach * np.abs(volume), np.sign(volume)

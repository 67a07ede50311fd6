"""Local frames: orientation and lattice constant of each atom, from only its neighbours."""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cache, lru_cache

import numpy as np

from geomtorsion.materials.crystals.lattices import LATTICES, Lattice
from geomtorsion.materials.crystals.method import METHOD
from geomtorsion.materials.maps import LaueGroup, laue_group
from geomtorsion.rigid.attitude import matrix_from_quaternion, quaternion_from_matrix
from geomtorsion.support.caching import read_only


@dataclass(frozen=True, eq=False)
class LocalFrames:
    """Orientation, lattice constant and misfit of the neighbours of single atoms.

    quaternions: crystal to specimen, in any variant of the symmetry, shape (atoms, 4).
    constants: lattice constants, shape (atoms,).
    good: atoms with each neighbour nearer to a place of its own than half the neighbour
        distance, shape (atoms,).
    misfit: root mean square distance over the neighbour distance, shape (atoms,).
    """

    quaternions: np.ndarray
    constants: np.ndarray
    good: np.ndarray
    misfit: np.ndarray


@cache
def symmetry_of(name: str) -> LaueGroup:
    """Rotations that map a lattice to itself, its two sublattices counted as one."""
    return laue_group("6/mmm" if LATTICES[name].is_hexagonal else "m-3m")


def local_frames(lattice: Lattice, vectors: np.ndarray) -> LocalFrames:
    """The frame of each atom that its neighbours fit best, and how well they fit.

    Two of the neighbours, as perpendicular as any, are mapped to each pair of neighbours of the
    perfect crystal that is not equivalent by symmetry to another pair. The best rotation is then
    refined by least squares.

    Parameters
    ----------
    vectors
        To the nearest neighbours, nearest first, shape (atoms, k, 3), with k at least
        `lattice.shells`.
    """
    part = METHOD.together // lattice.shells
    pieces = [
        _some(lattice, vectors[start : start + part, : lattice.shells])
        for start in range(0, max(len(vectors), 1), part)
    ]
    return LocalFrames(*(np.concatenate(x) for x in zip(*pieces, strict=True)))


@cache
def clear_misfit(name: str) -> float:
    """The least misfit in a lattice of an atom that is in another lattice without any noise."""
    misfits = [np.inf]
    for lattice in LATTICES.values():
        if lattice.name != name:
            ideal = replace(lattice, shells=50).ideal[0]
            # Any of several neighbours at the same distance may be counted.
            moved = ideal + 1e-6 * np.random.default_rng(0).normal(size=(200, *ideal.shape))
            order = np.linalg.norm(moved, axis=2).argsort(axis=1)[:, :, None]
            fit = local_frames(LATTICES[name], np.take_along_axis(moved, order, axis=1))
            misfits += fit.misfit[fit.good].tolist()
    return min(misfits)


def _some(lattice: Lattice, vectors: np.ndarray) -> tuple[np.ndarray, ...]:
    """The fields of the local frames of some atoms."""
    ideal = lattice.ideal[0]
    count, k, _ = vectors.shape
    sizes = np.sqrt(squared(vectors))
    scale = sizes.mean(axis=1) / np.linalg.norm(ideal, axis=1).mean()
    r = vectors / scale[:, None, None]
    unit = vectors / np.maximum(sizes, 1e-300)[:, :, None]
    cosines = np.abs(np.einsum("ni,nki->nk", unit[:, 0], unit))
    partner = cosines.argmin(axis=1)
    here = triads(unit[:, 0], unit[np.arange(count), partner])
    best, turns = np.full(count, -np.inf), np.tile(np.eye(3), (count, 1, 1))
    squares = (ideal**2).sum(axis=1)
    at = (r @ np.swapaxes(here, 1, 2)).reshape(-1, 3)
    for there in _seeds(lattice):
        # Neighbours along their triad, and places along the triad of the lattice.
        close = largest(at @ (2 * there @ ideal.T) - squares)
        total = close.reshape(count, k).sum(axis=1)
        closer = total > best
        best = np.where(closer, total, best)
        turns[closer] = there.T @ here[closer]
    # Places are reassigned once or twice, as in `frames.refined`.
    for _ in range(3):
        which, _ = _nearest(r @ np.swapaxes(turns, 1, 2), ideal)
        u, _, v = np.linalg.svd(np.swapaxes(ideal[which], 1, 2) @ r)
        u[:, :, 2] *= np.linalg.det(u @ v)[:, None]
        turns = u @ v
    which, residuals = _nearest(r @ np.swapaxes(turns, 1, 2), ideal)
    filled = np.zeros((count, k), dtype=bool)
    filled[np.arange(count)[:, None], which] = True
    good = filled.all(axis=1) & (residuals.max(axis=1) < (lattice.nearest / 2) ** 2)
    misfit = np.sqrt(residuals.mean(axis=1)) / lattice.nearest
    return quaternion_from_matrix(np.swapaxes(turns, 1, 2)), scale, good, misfit


def _nearest(at: np.ndarray, ideal: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """The place nearest to each vector, and the square of its distance, shape (atoms, k)."""
    closeness = 2 * at @ ideal.T - (ideal**2).sum(axis=1)
    which = closeness.argmax(axis=2)
    best = np.take_along_axis(closeness, which[:, :, None], axis=2)[:, :, 0]
    return which, np.maximum(squared(at) - best, 0.0)


def squared(vectors: np.ndarray) -> np.ndarray:
    """Squared lengths, shape (..., 3) to (...), since numpy is slow at sums of three."""
    x, y, z = vectors[..., 0], vectors[..., 1], vectors[..., 2]
    return x**2 + y**2 + z**2


def largest(table: np.ndarray) -> np.ndarray:
    """The largest entry of each row, found by columns, since numpy is slow at short rows."""
    maxima = table[:, 0].copy()
    for column in table.T[1:]:
        np.maximum(maxima, column, out=maxima)
    return maxima


def triads(first: np.ndarray, second: np.ndarray) -> np.ndarray:
    """Orthonormal rows along the first vectors and in the plane of both, shape (n, 3, 3)."""
    normal = np.cross(first, second)
    normal /= np.maximum(np.linalg.norm(normal, axis=1), 1e-300)[:, None]
    return np.stack([first, np.cross(normal, first), normal], axis=1)


@lru_cache(16)
def _seeds(lattice: Lattice) -> np.ndarray:
    """Triads of pairs of neighbours, one for each set of equivalent pairs, shape (n, 3, 3)."""
    ideal = lattice.ideal[0]
    unit = ideal / np.linalg.norm(ideal, axis=1)[:, None]
    rotations = matrix_from_quaternion(symmetry_of(lattice.name).quaternions)
    turned = np.einsum("nij,kj->nki", rotations, ideal)
    distances = np.linalg.norm(turned[:, :, None] - ideal, axis=3)
    # Symmetries that map neighbours of one sublattice to neighbours of the same sublattice.
    images = distances.argmin(axis=2)[distances.min(axis=2).max(axis=1) < lattice.nearest / 2]
    seen: set[tuple[int, int]] = set()
    pairs = []
    for a in range(len(ideal)):
        for b in range(len(ideal)):
            # Two neighbours that determine an orientation are not on a line.
            if (a, b) in seen or abs(unit[a] @ unit[b]) > 0.9:
                continue
            seen |= {(int(image[a]), int(image[b])) for image in images}
            pairs.append((a, b))
    first, second = np.array(pairs).T
    return read_only(triads(unit[first], unit[second]))

"""Frames: orientation and lattice constant of a crystal, found from its neighbour vectors."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np

from geomtorsion.crystals.lattices import LATTICES, Lattice, lattice_named
from geomtorsion.crystals.local_frames import (
    clear_misfit,
    local_frames,
    squared,
    symmetry_of,
    triads,
)
from geomtorsion.crystals.method import METHOD
from geomtorsion.crystals.triangulation import by_rows
from geomtorsion.errors import CrystalError
from geomtorsion.rigid.attitude import quaternion_from_matrix

# Of each atom of a sample: twice as many as tell a lattice, since noise brings others among them.
NEIGHBOURS = 2 * max(lattice.shells for lattice in LATTICES.values())


@dataclass(frozen=True, eq=False)
class Frame:
    """How a crystal lies in the specimen.

    lattice: which, with c/a of hcp; constant: lattice constant a, coordinates.
    orient: crystal axes from specimen axes, a rotation, shape (3, 3): v_crystal = orient @ v.
    """

    lattice: Lattice
    orient: np.ndarray
    constant: float

    def values(self, vectors: np.ndarray) -> np.ndarray:
        """Vectors of the specimen along the crystal axes, in units of the lattice, (k, 3)."""
        return by_rows(vectors, self.orient.T / (self.constant * np.array(self.lattice.units)))

    def vectors(self, values: np.ndarray) -> np.ndarray:
        """Lattice vectors as vectors of the specimen, shape (k, 3)."""
        return by_rows(values * (self.constant * np.array(self.lattice.units)), self.orient)

    def apart(self, vectors: np.ndarray, labels: np.ndarray) -> np.ndarray:
        """Distance of vectors from their labels, coordinates."""
        return np.linalg.norm(vectors - self.vectors(labels), axis=1)


class InFrame:
    """The parts of the frame in which something lies: a field `frame`, or found when asked for."""

    @property
    def lattice(self: Any) -> str:
        """ "fcc", "bcc", "hcp" or "diamond"."""
        return self.frame.lattice.name

    @property
    def orient(self: Any) -> np.ndarray:
        """Crystal axes from specimen axes, a rotation, shape (3, 3): v_crystal = orient @ v."""
        return self.frame.orient

    @property
    def constant(self: Any) -> float:
        """Lattice constant a, in the unit of the positions."""
        return self.frame.constant


@dataclass(frozen=True, eq=False)
class Fit:
    """How well neighbours fit a frame.

    kind: of each atom, 0 or 1: which of the two sets of neighbour vectors it has, shape (atoms,).
    labels: the neighbour vector nearest to each, whole numbers, shape (atoms, k, 3).
    whole: atoms whose neighbours are all different neighbour vectors, shape (atoms,).
    misfit: root mean square distance over the neighbour distance, shape (atoms,).
    """

    kind: np.ndarray
    labels: np.ndarray
    whole: np.ndarray
    misfit: np.ndarray


def fitted(frame: Frame, vectors: np.ndarray) -> Fit:
    """Neighbour vectors, shape (atoms, k, 3), held against those of the perfect crystal."""
    lattice = frame.lattice
    count, k, _ = vectors.shape
    at = vectors.reshape(-1, 3) @ (frame.orient.T / frame.constant)
    found = []
    for template, ideal in zip(lattice.neighbours, lattice.ideal, strict=True):
        # The nearest is that with the largest 2 x.t - t.t.
        closeness = 2 * at @ ideal.T - (ideal**2).sum(axis=1)
        which = closeness.argmax(axis=1)
        apart = squared(at - ideal[which]).reshape(count, k)
        which = which.reshape(count, k)
        filled = np.zeros((count, k), dtype=bool)
        filled[np.arange(count)[:, None], which] = True
        found.append((filled.all(axis=1), apart, template[which]))
    first, second = found[0], found[-1]
    # As for shells: beyond half the neighbour distance a neighbour is missing.
    missing = (lattice.nearest / 2) ** 2
    other = np.zeros(count, dtype=bool)
    if second is not first:
        other = np.minimum(second[1], missing).sum(1) < np.minimum(first[1], missing).sum(1)
        first = (
            np.where(other, second[0], first[0]),
            np.where(other[:, None], second[1], first[1]),
            np.where(other[:, None, None], second[2], first[2]),
        )
    misfit = np.sqrt(first[1].mean(axis=1)) / lattice.nearest
    return Fit(other.astype(np.int64), first[2], first[0], misfit)


def occupied(frame: Frame, vectors: np.ndarray) -> np.ndarray:
    """Atoms with another one at every neighbour vector, shape (atoms,) of truth values.

    It is there if it lies nearer than half the neighbour distance; what else is near, as in a
    lattice whose next shell noise mixes with this one, does not count.
    """
    lattice = frame.lattice
    at = vectors @ (frame.orient.T / frame.constant)
    found = np.zeros(len(vectors), dtype=bool)
    for ideal in lattice.ideal:
        there = np.ones(len(vectors), dtype=bool)
        for place in ideal:
            apart = squared(at - place).min(axis=1)
            there &= apart < (lattice.nearest / 2) ** 2
        found |= there
    return found


def _is_ordered(frame: Frame, vectors: np.ndarray) -> bool:
    """Whether neighbours lie at their places in the mean, in which noise cancels.

    In a dense crystal of another kind every place is occupied, too, but not in its midst.
    """
    lattice, fit = frame.lattice, fitted(frame, vectors[:, : frame.lattice.shells])
    for kind, ideal in enumerate(lattice.ideal):
        at = vectors[fit.kind == kind] @ (frame.orient.T / frame.constant)
        if len(at):
            off = [
                at[np.arange(len(at)), squared(at - x).argmin(axis=1)].mean(axis=0) for x in ideal
            ]
            misfit = np.sqrt(squared(np.array(off) - ideal).mean()) / lattice.nearest
            if misfit < clear_misfit(lattice.name):
                return True
    return False


def share_within(frame: Frame, vectors: np.ndarray) -> float:
    """Share of those atoms that tell an orientation that lie in the frame, up to the angle of a
    wall; all where none tells."""
    angles = _turns(frame, vectors)
    return float((angles < METHOD.wall).mean()) if len(angles) else 1.0


def check_turn(frame: Frame, vectors: np.ndarray) -> None:
    """Refuse a given orientation in which no atom of a crystal lies."""
    if share_within(frame, vectors) == 0:
        least = np.degrees(_turns(frame, vectors).min())
        raise CrystalError(
            "orient: that of the crystal, or of one of its grains, was needed, but all atoms are "
            f"turned from it by {least:.3g} degrees or more. Its rows are the crystal axes in the "
            "specimen; leave it out to have it found."
        )


def _turns(frame: Frame, vectors: np.ndarray) -> np.ndarray:
    """Misorientations of single atoms from a frame, of those that fit in one of their own, rad."""
    local = local_frames(frame.lattice, vectors)
    found = local.quaternions[local.good]
    own = np.tile(quaternion_from_matrix(frame.orient.T), (len(found), 1))
    return symmetry_of(frame.lattice.name).nearest(own, found)[1]


def _seeded(lattice: Lattice, vectors: np.ndarray) -> Frame:
    """The frame of one atom, from its neighbour vectors alone, shape (k, 3)."""
    ideal = lattice.ideal[0]
    scale = np.linalg.norm(vectors, axis=1).mean() / np.linalg.norm(ideal, axis=1).mean()
    r = vectors / scale
    unit = r / np.linalg.norm(r, axis=1)[:, None]
    other = int(np.abs(unit @ unit[0]).argmin())
    directions = ideal / np.linalg.norm(ideal, axis=1)[:, None]
    angle = unit[0] @ unit[other]
    # Any pair of neighbour vectors with about this angle may be these two.
    cosines = directions @ directions.T
    first, second = np.nonzero((np.abs(cosines - angle) < 0.5) & (np.abs(cosines) < 0.9))
    if not len(first):
        # All neighbours lie on a line, or seem so from very far: any turn is as good.
        return Frame(lattice, np.eye(3), float(scale))
    here = triads(unit[:1], unit[other : other + 1])[0]
    turns = np.swapaxes(triads(directions[first], directions[second]), 1, 2) @ here
    at = np.einsum("nij,kj->nki", turns, r)
    apart = squared(at[:, :, None] - ideal).min(axis=2).sum(axis=1)
    return Frame(lattice, turns[apart.argmin()], float(scale))


def refined(
    frame: Frame, vectors: np.ndarray, keep_orient: bool = False, keep_constant: bool = False
) -> Frame:
    """The frame that fits neighbour vectors best, in the sense of least squares."""
    before = None
    # Labels are exchanged a few times at most; without a crystal it may go on.
    for _ in range(5):
        fit = fitted(frame, vectors)
        if before is not None and (fit.labels == before).all():
            break
        before = fit.labels
        labels, r = fit.labels.reshape(-1, 3), vectors.reshape(-1, 3)
        near = frame.apart(r, labels) < frame.constant * frame.lattice.nearest / 2
        ideal, r = labels[near] * np.array(frame.lattice.units), r[near]
        if len(r) < 3:
            return frame
        orient, constant, lattice = frame.orient, frame.constant, frame.lattice
        if not keep_orient:
            u, _, v = np.linalg.svd(ideal.T @ r)
            orient = u @ np.diag([1.0, 1.0, np.linalg.det(u @ v)]) @ v
        if not keep_constant:
            at = r @ orient.T
            constant = float((at * ideal).sum() / (ideal**2).sum())
            if lattice.name == "hcp" and ideal[:, :2].any() and ideal[:, 2].any():
                across, along = (
                    float((at * ideal)[:, k].sum() / (ideal**2)[:, k].sum())
                    for k in (slice(0, 2), slice(2, 3))
                )
                ratio = 2 * lattice.units[2] * along / across
                lattice, constant = lattice_named("hcp", ratio), across
        frame = Frame(lattice, orient, constant)
    return frame


def single_frame(
    lattice: Lattice,
    vectors: np.ndarray,
    orient: np.ndarray | None = None,
    constant: float | None = None,
) -> tuple[Frame, Fit]:
    """The frame into which most atoms fit, of those that single atoms suggest, and how they fit."""
    k = lattice.shells
    vectors = vectors[:, :k]
    if orient is not None:
        ideal = np.linalg.norm(lattice.ideal[0], axis=1).mean()
        scale = float(np.linalg.norm(vectors, axis=2).mean() / ideal)
        best = Frame(lattice, orient, scale)
    else:
        spread = np.linspace(0, len(vectors) - 1, min(METHOD.seeds, len(vectors)))
        chosen = vectors[spread.astype(int)]
        every = [refined(_seeded(lattice, one), one[None]) for one in chosen]
        scores = [float(np.minimum(fitted(frame, chosen).misfit, 0.5).mean()) for frame in every]
        best = every[int(np.argmin(scores))]
    if constant is not None:
        best = refined(best, vectors, orient is not None)
        if abs(best.constant / constant - 1) > METHOD.strain:
            raise CrystalError(
                f"constant: neighbours are as far apart as with a = {best.constant:.4g}, but "
                f"{constant:.4g} came. Give it in the unit of the positions, or leave it out."
            )
        best = Frame(best.lattice, best.orient, constant)
    best = refined(best, vectors, orient is not None, constant is not None)
    return best, fitted(best, vectors)


def sampled(count: int) -> np.ndarray:
    """Numbers of atoms that stand for all."""
    if count <= METHOD.sample:
        return np.arange(count)
    return np.sort(np.random.default_rng(0).choice(count, METHOD.sample, replace=False))


def likely_lattice(
    vectors: np.ndarray, orient: np.ndarray | None = None, constant: float | None = None
) -> tuple[Frame, Fit]:
    """The frame of the lattice into which most atoms fit, in axes that may be given."""
    # Few tell the lattice, all then its orientation and constant; where few fit, all tell it.
    for some in (vectors[:: max(len(vectors) // (10 * METHOD.seeds), 1)], vectors):
        found = [single_frame(lattice, some, orient) for lattice in LATTICES.values()]
        frame, fit = max(found, key=lambda pair: (pair[1].whole.mean(), -pair[1].misfit.mean()))
        if fit.whole.mean() >= METHOD.share:
            break
    return single_frame(frame.lattice, vectors, orient, constant)


def frame_of(
    vectors: np.ndarray,
    name: str | None = None,
    orient: np.ndarray | None = None,
    constant: float | None = None,
    shares: Callable[[Lattice], dict[str, float]] | None = None,
) -> tuple[Frame, Fit]:
    """The frame of a crystal from neighbour vectors of a sample of its atoms, and how they fit.

    name, orient, constant: of the lattice, where they are given. shares: of atoms that fit into
    each lattice in frames of their own, as in a polycrystal.

    Raises
    ------
    CrystalError
        The atoms are no crystal, or one of another lattice.
    """
    if name is None:
        found = likely_lattice(vectors, orient, constant)
    else:
        found = single_frame(lattice_named(name), vectors, orient, constant)
    share = float(found[1].whole.mean())
    if share < 0.5 and shares is not None:
        # In many grains single atoms tell the lattice.
        parts = shares(found[0].lattice)
        most = max(parts, key=lambda key: parts[key])
        if name is None and most != found[0].lattice.name and parts[most] > 2 * share:
            found = single_frame(lattice_named(most), vectors, orient, constant)
        share = max(share, parts[found[0].lattice.name])
    if name is not None and share < 0.5:
        other = likely_lattice(vectors)
        # Without a doubt it is another one.
        if other[0].lattice.name != name and other[1].whole.mean() > 2 * share:
            raise CrystalError(
                f"lattice: the neighbours of {other[1].whole.mean():.1%} of the atoms fit into "
                f"{other[0].lattice.name}, but {name} came, into which {share:.1%} fit. Name "
                "that one, or none."
            )
    if share < METHOD.share and (
        occupied(found[0], vectors).mean() < METHOD.share or not _is_ordered(found[0], vectors)
    ):
        raise CrystalError(
            f"positions: a crystal was needed ({name or 'fcc, bcc, hcp or diamond'}), but of "
            f"only {share:.1%} of the atoms the neighbours fit, as in a liquid or in a lattice of "
            "another kind. Name the lattice, or cut out the part that is crystalline."
        )
    return found

"""Frames: orientation and lattice constant of a crystal, found from its neighbour vectors."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np

from geomtorsion.errors import CrystalError
from geomtorsion.materials.crystals.lattices import LATTICES, Lattice, lattice_named
from geomtorsion.materials.crystals.local_frames import (
    clear_misfit,
    local_frames,
    squared,
    symmetry_of,
    triads,
)
from geomtorsion.materials.crystals.method import METHOD
from geomtorsion.materials.crystals.triangulation import by_rows
from geomtorsion.rigid.attitude import matrix_from_quaternion, product, quaternion_from_matrix
from geomtorsion.support.caching import cached_property

# For each atom of a sample: twice as many as determine a lattice, since noise adds others.
NEIGHBOURS = 2 * max(lattice.shells for lattice in LATTICES.values())


@dataclass(frozen=True, eq=False)
class Frame:
    """Lattice, orientation and mean deformation of a crystal in the specimen.

    lattice: with c/a if hexagonal; constant: mean lattice constant a, coordinates.
    orient: crystal axes from specimen axes, a rotation, shape (3, 3): v_crystal = orient @ v.
    deformation: mean deformation gradient of the crystal from the perfect one of this constant and
        orientation, in specimen axes, shape (3, 3): b along the crystal axes is
        deformation @ orient.T @ b in the specimen.
    error: standard error of the deformation.
    """

    lattice: Lattice
    orient: np.ndarray
    constant: float
    deformation: np.ndarray = field(default_factory=lambda: np.eye(3))
    error: float = 0.0

    @cached_property
    def matrix(self) -> np.ndarray:
        """Takes rows along the crystal axes, in lattice constants, to vectors of the specimen."""
        return self.constant * self.orient @ self.deformation.T

    @cached_property
    def inverse(self) -> np.ndarray:
        """Takes rows of the specimen to vectors along the crystal axes, in lattice constants."""
        return np.linalg.inv(self.deformation).T @ self.orient.T / self.constant

    @property
    def atom_volume(self) -> float:
        """Volume of an atom, coordinates cubed."""
        return self.lattice.atom_volume * abs(float(np.linalg.det(self.matrix)))

    @property
    def largest_stretch(self) -> float:
        """Largest factor by which the deformation stretches a vector."""
        return float(np.linalg.norm(self.deformation, 2))

    def values(self, vectors: np.ndarray) -> np.ndarray:
        """Vectors of the specimen along the crystal axes, in units of the lattice, (k, 3)."""
        return by_rows(vectors, self.inverse / np.array(self.lattice.units))

    def vectors(self, values: np.ndarray) -> np.ndarray:
        """Lattice vectors as vectors of the specimen, shape (k, 3)."""
        return by_rows(values * np.array(self.lattice.units), self.matrix)

    def apart(self, vectors: np.ndarray, labels: np.ndarray) -> np.ndarray:
        """Distance of vectors from their labels in the undeformed crystal, lattice constants."""
        return np.linalg.norm(
            (self.values(vectors) - labels) * np.array(self.lattice.units), axis=1
        )

    def deformed(self, vectors: np.ndarray, fit: Fit) -> tuple[Frame, Fit]:
        """The same lattice, orientation and constant with a mean deformation, and the new fit.

        The deformation is found from the neighbour vectors of atoms that fit, shape (atoms, k, 3),
        and omitted where it is within the scatter of the atoms. fit: the fit to this frame, which
        has no deformation.
        """
        frame = self
        # As for the frame itself, labels are exchanged a few times at most.
        for _ in range(5):
            # A whole atom has all its neighbours: none is missing on one side.
            ideal = fit.labels[fit.whole] * np.array(self.lattice.units)
            if not len(ideal):
                break
            squares = np.swapaxes(ideal, 1, 2) @ ideal
            each = np.linalg.solve(squares, np.swapaxes(ideal, 1, 2) @ vectors[fit.whole])
            each = np.swapaxes(each, 1, 2) @ self.orient / self.constant
            # Lines along an axis leave no scatter there, but the mean is not better for it.
            error = float(each.std(axis=0).max()) / np.sqrt(len(each))
            before, frame = frame, self.of(each.mean(axis=0), error)
            # Without a deformation all atoms fit as before.
            if np.array_equal(frame.matrix, before.matrix):
                break
            fit = fitted(frame, vectors)
        return frame, fit

    def along(self, like: Frame) -> Frame:
        """The same lattice vectors in space, described by another frame with nearly equal axes."""
        units = np.array(self.lattice.units) / np.array(like.lattice.units)
        matrix = units[:, None] * self.matrix
        return like.of(matrix.T @ like.orient / like.constant, self.error)

    def of(self, deformation: np.ndarray, error: float) -> Frame:
        """The same frame with a deformation, or without one if it may be only error."""
        off = np.abs(deformation - np.eye(3))
        matrix = deformation if off.max() > METHOD.sigma * error else np.eye(3)
        return replace(self, deformation=matrix, error=error)


class InFrame:
    """Parts of the frame of an object, which has it as a field `frame` or finds it on demand."""

    @property
    def lattice(self: Any) -> str:
        """ "fcc", "bcc", "hcp", "diamond" or "hexagonal diamond"."""
        return self.frame.lattice.name

    @property
    def orient(self: Any) -> np.ndarray:
        """Crystal axes from specimen axes, a rotation, shape (3, 3): v_crystal = orient @ v."""
        return self.frame.orient

    @property
    def constant(self: Any) -> float:
        """Mean lattice constant a, in the unit of the positions."""
        return self.frame.constant

    @property
    def deformation(self: Any) -> np.ndarray:
        """Mean deformation gradient, specimen axes, shape (3, 3).

        The lattice vector b (crystal axes, coordinates) is deformation @ orient.T @ b in the
        coordinates of the positions.
        """
        return self.frame.deformation


@dataclass(frozen=True, eq=False)
class Fit:
    """How well neighbours fit a frame.

    kind: set of neighbour vectors of each atom, from 0, shape (atoms,).
    labels: the neighbour vector nearest to each, whole numbers, shape (atoms, k, 3).
    whole: atoms with each neighbour nearer to a place of its own than half the neighbour
        distance, shape (atoms,).
    misfit: root mean square distance over the neighbour distance, shape (atoms,).
    """

    kind: np.ndarray
    labels: np.ndarray
    whole: np.ndarray
    misfit: np.ndarray


def fitted(frame: Frame, vectors: np.ndarray) -> Fit:
    """Neighbour vectors, shape (atoms, k, 3), compared with the vectors of the perfect crystal."""
    lattice = frame.lattice
    count, k, _ = vectors.shape
    at = vectors.reshape(-1, 3) @ frame.inverse
    # As for shells: beyond half the neighbour distance a neighbour is missing.
    missing = (lattice.nearest / 2) ** 2
    places = []
    for ideal in lattice.ideal:
        # The nearest place has the largest 2 x.t - t.t.
        closeness = 2 * at @ ideal.T - (ideal**2).sum(axis=1)
        which = closeness.argmax(axis=1)
        places.append((which.reshape(count, k), squared(at - ideal[which]).reshape(count, k)))
    rows, kind, (which, errors) = np.arange(count), np.zeros(count, dtype=np.int64), places[0]
    if len(places) > 1:
        kind = np.argmin([np.minimum(errors, missing).sum(axis=1) for _, errors in places], axis=0)
        which, errors = (np.stack(one)[kind, rows] for one in zip(*places, strict=True))
    filled = np.zeros((count, k), dtype=bool)
    filled[rows[:, None], which] = True
    whole = filled.all(axis=1) & (errors.max(axis=1) < missing)
    labels = np.stack(lattice.neighbours)[kind[:, None], which]
    return Fit(kind, labels, whole, np.sqrt(errors.mean(axis=1)) / lattice.nearest)


def occupied(frame: Frame, vectors: np.ndarray) -> np.ndarray:
    """Atoms with another atom at every neighbour vector, shape (atoms,) of truth values.

    A neighbour exists if it is nearer than half the neighbour distance. Other atoms nearby do not
    count, as in a lattice whose next shell noise mixes with this one.
    """
    lattice = frame.lattice
    at = vectors @ frame.inverse
    mask = np.zeros(len(vectors), dtype=bool)
    for ideal in lattice.ideal:
        there = np.ones(len(vectors), dtype=bool)
        for place in ideal:
            squares = squared(at - place).min(axis=1)
            there &= squares < (lattice.nearest / 2) ** 2
        mask |= there
    return mask


def is_ordered(frame: Frame, vectors: np.ndarray) -> bool:
    """Whether neighbours are at their places in the mean, in which noise cancels.

    In another lattice, such as simple cubic, atoms may have a neighbour for every place, but not at
    its centre. Deformation is not removed: it would turn any lattice of one atom into another.
    """
    frame = replace(frame, deformation=np.eye(3))
    return _is_ordered(frame, vectors, fitted(frame, vectors[:, : frame.lattice.shells]).kind)


def _is_ordered(frame: Frame, vectors: np.ndarray, kinds: np.ndarray) -> bool:
    """`is_ordered` of atoms of known kinds, in a frame without deformation."""
    lattice = frame.lattice
    for kind, ideal in enumerate(lattice.ideal):
        at = vectors[kinds == kind] @ (frame.orient.T / frame.constant)
        if len(at):
            # The nearest place has the least x.x - 2 x.t.
            rows, sizes = np.arange(len(at)), squared(at)
            off = [at[rows, (sizes - at @ (2 * x)).argmin(axis=1)].mean(axis=0) for x in ideal]
            misfit = np.sqrt(squared(np.array(off) - ideal).mean()) / lattice.nearest
            if misfit < clear_misfit(lattice.name):
                return True
    return False


def share_of(frame: Frame, fit: Fit, vectors: np.ndarray) -> float:
    """Share of some atoms that fit into a frame without deformation.

    It is zero if the atoms are of another lattice.
    """
    some, kinds = vectors[fit.whole], fit.kind[fit.whole]
    return len(some) / len(vectors) if len(some) and _is_ordered(frame, some, kinds) else 0.0


def _is_crowded(frame: Frame, vectors: np.ndarray) -> bool:
    """Whether most atoms have more atoms around them than the lattice has.

    Noise moves as many atoms of the next shell in as out.
    """
    lattice = frame.lattice
    more = replace(lattice, shells=lattice.shells + 1)
    sizes = np.linalg.norm(more.ideal[0], axis=1)
    within = frame.constant * (sizes[-1] + sizes[-2]) / 2
    counts = (np.linalg.norm(vectors, axis=2) < within).sum(axis=1)
    return float(counts.mean()) > METHOD.crowd * lattice.shells


def share_within(frame: Frame, vectors: np.ndarray) -> float:
    """Share of the atoms with an orientation that agree with the frame within the angle of a wall.

    It is 1 where no atom has an orientation.
    """
    angles = _turns(frame, vectors)
    return float((angles < METHOD.wall).mean()) if len(angles) else 1.0


def check_turn(frame: Frame, vectors: np.ndarray) -> None:
    """Refuse a given orientation that no atom of a crystal has."""
    if share_within(frame, vectors) == 0:
        least = np.degrees(_turns(frame, vectors).min())
        raise CrystalError(
            "orient: expected the orientation of the crystal or of one of its grains, got one from "
            f"which all atoms are turned by {least:.3g} degrees or more. Give the crystal axes in "
            "the specimen as rows, or omit orient to have it found."
        )


def _turns(frame: Frame, vectors: np.ndarray) -> np.ndarray:
    """Misorientations from a frame of single atoms that fit in a frame of their own, rad."""
    local = local_frames(frame.lattice, vectors)
    quaternions = local.quaternions[local.good]
    own = np.tile(quaternion_from_matrix(frame.orient.T), (len(quaternions), 1))
    return symmetry_of(frame.lattice.name).nearest(own, quaternions)[1]


def _seeded(lattice: Lattice, vectors: np.ndarray) -> Frame:
    """The frame of one atom, from only its neighbour vectors, shape (k, 3)."""
    ideal = lattice.ideal[0]
    scale = np.linalg.norm(vectors, axis=1).mean() / np.linalg.norm(ideal, axis=1).mean()
    r = vectors / scale
    unit = r / np.maximum(np.linalg.norm(r, axis=1), 1e-300)[:, None]
    partner = int(np.abs(unit @ unit[0]).argmin())
    directions = ideal / np.linalg.norm(ideal, axis=1)[:, None]
    angle = unit[0] @ unit[partner]
    # Any pair of neighbour vectors with about this angle is a candidate for these two.
    cosines = directions @ directions.T
    first, second = np.nonzero((np.abs(cosines - angle) < 0.5) & (np.abs(cosines) < 0.9))
    if not len(first) or not unit[0].any():
        # All neighbours are on a line, or seem so from very far, or one overlaps with the atom: any
        # rotation fits equally.
        return Frame(lattice, np.eye(3), float(scale))
    here = triads(unit[:1], unit[partner : partner + 1])[0]
    turns = np.swapaxes(triads(directions[first], directions[second]), 1, 2) @ here
    at = np.einsum("nij,kj->nki", turns, r)
    misfits = squared(at[:, :, None] - ideal).min(axis=2).sum(axis=1)
    return Frame(lattice, turns[misfits.argmin()], float(scale))


def refined(
    frame: Frame, vectors: np.ndarray, keep_orient: bool = False, keep_constant: bool = False
) -> Frame:
    """The frame that fits neighbour vectors best by least squares."""
    before = None
    # Exchange labels a few times at most; without a crystal this may not end.
    for _ in range(5):
        fit = fitted(frame, vectors)
        if before is not None and (fit.labels == before).all():
            break
        before = fit.labels
        labels, r = fit.labels.reshape(-1, 3), vectors.reshape(-1, 3)
        near = frame.apart(r, labels) < frame.lattice.nearest / 2
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
            # Atoms at a core lack neighbours on one side, which would shift c/a.
            whole = np.repeat(fit.whole, vectors.shape[1])[near]
            at, ideal = at[whole], ideal[whole]
            if lattice.is_hexagonal and ideal[:, :2].any() and ideal[:, 2].any():
                across, along = (
                    float((at * ideal)[:, k].sum() / (ideal**2)[:, k].sum())
                    for k in (slice(0, 2), slice(2, 3))
                )
                ratio = lattice.ratio * along / across
                lattice, constant = lattice_named(lattice.name, ratio), across
        frame = Frame(lattice, orient, constant)
    return frame


def best_frame(frame: Frame, vectors: np.ndarray) -> Frame:
    """The frame with its deformation that fits neighbour vectors best."""
    refined_frame = refined(replace(frame, deformation=np.eye(3)), vectors)
    return refined_frame.deformed(vectors, fitted(refined_frame, vectors))[0]


def upright(frame: Frame) -> Frame:
    """The same frame in the variant of its symmetry that is nearest to the axes of the specimen.

    Among variants within a thousandth of the nearest, it takes the one with the largest first
    entries, so that the result does not depend on the atom that suggested the frame.
    """
    group = symmetry_of(frame.lattice.name)
    turns = product(quaternion_from_matrix(frame.orient.T), group.quaternions)
    every = np.swapaxes(matrix_from_quaternion(turns), 1, 2)
    keys = np.column_stack([np.abs(turns[:, 0]), every.reshape(len(every), 9)]).round(3) + 0.0
    best = max(range(len(every)), key=lambda k: tuple(keys[k].tolist()))
    return replace(frame, orient=every[best])


def single_frame(
    lattice: Lattice,
    vectors: np.ndarray,
    orient: np.ndarray | None = None,
    constant: float | None = None,
) -> tuple[Frame, Fit]:
    """The frame into which most atoms fit, among those from single atoms, and its fit."""
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
        best = upright(every[int(np.argmin(scores))])
    if constant is not None:
        best = refined(best, vectors, orient is not None)
        if abs(best.constant / constant - 1) > METHOD.strain:
            raise CrystalError(
                f"constant: expected about {best.constant:.4g}, from the distance of neighbours, "
                f"got {constant:.4g}. Give it in the unit of the positions, or omit it."
            )
        best = replace(best, constant=constant)
    best = refined(best, vectors, orient is not None, constant is not None)
    return best, fitted(best, vectors)


def sampled(count: int) -> np.ndarray:
    """Numbers of atoms that represent all."""
    if count <= METHOD.sample:
        return np.arange(count)
    return np.sort(np.random.default_rng(0).choice(count, METHOD.sample, replace=False))


def likely_lattice(
    vectors: np.ndarray, orient: np.ndarray | None = None, constant: float | None = None
) -> tuple[Frame, Fit]:
    """The frame, without deformation, of the lattice into which most atoms fit.

    Its axes may be given.
    """
    # A few atoms decide the lattice, or all if few of these fit; all give orientation and constant.
    for some in (vectors[:: max(len(vectors) // (10 * METHOD.seeds), 1)], vectors):
        fits = [single_frame(lattice, some, orient) for lattice in LATTICES.values()]
        shares = [share_of(frame, fit, some) for frame, fit in fits]
        # Under strain atoms may fit into two lattices: each counts for the better fit.
        off = [
            np.where(fit.whole & (share > 0), fit.misfit, np.inf)
            for (_, fit), share in zip(fits, shares, strict=True)
        ]
        mine = np.where(np.isfinite(off).any(axis=0), np.argmin(off, axis=0), -1)
        count = [int((mine == k).sum()) for k in range(len(fits))]
        best = max(range(len(fits)), key=lambda k: (count[k], -fits[k][1].misfit.mean()))
        frame = fits[best][0]
        if shares[best] >= METHOD.share:
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

    name, orient, constant: of the lattice, where they are given. shares: shares of atoms that fit
    into each lattice in frames of their own, as in a polycrystal.

    Raises
    ------
    CrystalError
        The atoms are not a crystal, or are a crystal of another lattice.
    """
    if name is None:
        match = likely_lattice(vectors, orient, constant)
    else:
        match = single_frame(lattice_named(name), vectors, orient, constant)
    share = share_of(*match, vectors)
    alike = True
    if share < 0.5 and shares is not None:
        # In many grains, single atoms decide the lattice.
        parts = shares(match[0].lattice)
        most = max(parts, key=lambda key: parts[key])
        if name is None and parts[most] > max(share, parts[match[0].lattice.name]):
            match = single_frame(lattice_named(most), vectors, orient, constant)
        # Atoms around those with frames of their own must be oriented alike, as in grains.
        alike = parts[match[0].lattice.name] > 0
        share = max(share_of(*match, vectors), parts[match[0].lattice.name])
    if name is not None and share < 0.5:
        best_fit = likely_lattice(vectors)
        rival = share_of(*best_fit, vectors)
        # Clearly another lattice.
        if best_fit[0].lattice.name != name and rival > 2 * share:
            raise CrystalError(
                f"lattice: expected {best_fit[0].lattice.name}, which {rival:.1%} of the atoms fit "
                f"with their neighbours, got {name}, which {share:.1%} fit. Name "
                f"{best_fit[0].lattice.name}, or omit lattice to have it found."
            )
    if not (alike if share >= METHOD.share else _is_noisy(match[0], vectors)):
        kinds = name or f"one of {', '.join(LATTICES)}"
        beside = ", and adjacent ones are not oriented alike" if share >= METHOD.share else ""
        raise CrystalError(
            f"positions: expected a crystal ({kinds}), got atoms as in a liquid or in a lattice of "
            f"another kind: the neighbours of only {share:.1%} of the atoms fit{beside}. Cut out "
            "the crystalline part, or one sublattice of a compound."
        )
    return match[0].deformed(vectors[:, : match[0].lattice.shells], match[1])


def _is_noisy(frame: Frame, vectors: np.ndarray) -> bool:
    """Whether atoms are a crystal in much noise: hardly one fits, but places are occupied."""
    taken = occupied(frame, vectors).mean() >= METHOD.places
    return bool(taken) and is_ordered(frame, vectors) and not _is_crowded(frame, vectors)

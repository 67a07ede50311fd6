"""Phases: crystal structures in a map, with Laue group, lattice and families of lines."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from geomtorsion.errors import OrientationError
from geomtorsion.materials.maps.symmetry import LaueGroup, laue_group
from geomtorsion.rigid.attitude import rotated
from geomtorsion.support import checks
from geomtorsion.support.caching import cached_property


@dataclass(frozen=True)
class Phase:
    """A crystal structure, with the properties that circuits need.

    name: of the phase. laue: name of its Laue group, such as "m-3m".
    lengths: a, b, c in angstrom; zeros where they are not known.
    angles: alpha, beta, gamma in degrees.
    horizontal: which axis of the crystal frame is parallel to a lattice vector: "x" (a along x, as
        in .ang files) or "y" (b along y, as in .ctf files). z is along c, or at least orthogonal to
        a and b.

    Raises
    ------
    OrientationError
        The Laue group is unknown, or no lattice has these constants.

    Examples
    --------
    >>> copper = Phase("copper", "m-3m", (3.615, 3.615, 3.615))
    >>> copper.lattice.round(6).tolist()
    [[3.615, 0.0, 0.0], [0.0, 3.615, 0.0], [0.0, 0.0, 3.615]]
    >>> len(copper.family((0.5, 0.5, 0)))
    6
    """

    name: str
    laue: str
    lengths: tuple[float, float, float] = (0.0, 0.0, 0.0)
    angles: tuple[float, float, float] = (90.0, 90.0, 90.0)
    horizontal: str = "x"

    def __post_init__(self) -> None:
        """Check the group and the constants."""
        _ = self.group
        for key in ("lengths", "angles"):
            subject = f"phase {self.name!r}: {key}"
            values = checks.numbers(getattr(self, key), 3, subject, OrientationError)
            for value in map(float, values):
                checks.measured(value, subject, OrientationError, is_length=True)
            object.__setattr__(self, key, tuple(float(x) for x in values))
        if min(self.lengths) < 0 or not all(0 < x < 180 for x in self.angles):
            raise OrientationError(
                f"phase {self.name!r}: expected positive lengths and angles between 0 and 180 "
                f"degrees, got {self.lengths} and {self.angles}. Correct the constants."
            )
        if self.has_lattice and min(self._excess) <= 0:
            raise OrientationError(
                f"phase {self.name!r}: expected angles of a cell with a volume, got "
                f"{self.angles}. Correct them."
            )

    @cached_property
    def group(self) -> LaueGroup:
        """The rotations of its Laue group."""
        return laue_group(self.laue, self.horizontal)

    @property
    def _excess(self) -> tuple[float, ...]:
        """180 - s and s minus each angle, in degrees, with s half of the sum of the angles.

        All four are above 0 if and only if the three edges of the cell are not in one plane.
        """
        # Exact decimals, because 40.1 + 50.2 - 90.3 of doubles is not 0.
        angles = [checks.repr_fraction(angle) for angle in self.angles]
        half = sum(angles) / 2
        return tuple(float(x) for x in (180 - half, *(half - angle for angle in angles)))

    @property
    def has_lattice(self) -> bool:
        """Whether the lattice constants are known."""
        return min(self.lengths) > 0

    @cached_property
    def lattice(self) -> np.ndarray:
        """Columns a, b, c in the axes of the crystal, angstrom, shape (3, 3)."""
        if not self.has_lattice:
            raise OrientationError(
                f"phase {self.name!r}: expected lattice constants, got none. Give lengths=(a, b, "
                "c)."
            )
        a, b, c = self.lengths
        alpha, beta, gamma = np.radians(self.angles)
        cosine = (np.cos(alpha) - np.cos(beta) * np.cos(gamma)) / np.sin(gamma)
        # Written as a product, the height of c over a and b keeps its digits for a flat cell.
        height = 2 * np.sqrt(np.prod(np.sin(np.radians(self._excess)))) / np.sin(gamma)
        columns = np.array(
            [
                [a, b * np.cos(gamma), c * np.cos(beta)],
                [0.0, b * np.sin(gamma), c * cosine],
                [0.0, 0.0, c * height],
            ]
        )
        if self.horizontal == "y" and self.laue in ("-3", "-3m", "6/m", "6/mmm"):
            # The same lattice, rotated about c so that b is along y.
            turn = np.pi / 2 - gamma
            cos, sin = np.cos(turn), np.sin(turn)
            columns = np.array([[cos, -sin, 0], [sin, cos, 0], [0, 0, 1]]) @ columns
        return columns

    def family(self, vector: Sequence[float]) -> np.ndarray:
        """All symmetry equivalents of a vector, up to sign, in crystal axes, angstrom.

        Parameters
        ----------
        vector
            In units of a, b, c, such as (0.5, 0.5, 0) for <110>/2; or with the four indices of
            hexagonal and trigonal cells.

        Returns
        -------
        Array of shape (k, 3).
        """
        subject = "Burgers vector of a family"
        burgers = self.lattice @ cell_vector(vector, subject, self)
        if not burgers.any():
            raise OrientationError(
                f"{subject}: expected a vector different from zero, got 0. Give [u, v, w]."
            )
        images: list[np.ndarray] = []
        # Lattice constants have about four digits.
        near = 1e-4 * np.abs(burgers).max()
        for image in images_of(self, burgers[None])[:, 0]:
            if all(min(abs(image - x).max(), abs(image + x).max()) > near for x in images):
                images.append(image)
        return np.array(images)


def images_of(phase: Phase, vectors: np.ndarray) -> np.ndarray:
    """Images of vectors under the rotations of a phase, crystal axes, shape (rotations, k, 3).

    Raises
    ------
    OrientationError
        The rotations do not map the lattice to itself, so that the images are not equivalent.
    """
    edges = phase.lattice.T
    both = np.concatenate([edges, vectors])
    turns = phase.group.quaternions
    images = np.stack([rotated(turns, np.broadcast_to(x, (len(turns), 3))) for x in both], axis=1)
    whole = images[:, :3] @ np.linalg.inv(edges)
    # Small errors of the constants are harmless: an image closer to a lattice vector than to the
    # middle between two lattice vectors counts as the lattice vector.
    off = np.abs(whole - np.rint(whole))
    if (off > 0.5 - off).any():
        raise OrientationError(
            f"phase {phase.name!r}: expected a lattice of the symmetry {phase.laue}, got lengths "
            f"{phase.lengths} and angles {phase.angles}, which have another symmetry. Give the "
            "constants of the cell, for example angles=(90, 90, 120) for a hexagonal one."
        )
    return images[:, 3:]


def cell_vector(
    given: Sequence[float], subject: str, phase: Phase, *, plane: bool = False
) -> np.ndarray:
    """Three indices of a direction or a plane, from three indices or from Bravais' four.

    Raises
    ------
    OrientationError
        There are not three or four indices, or the four indices are not valid for this cell.

    Examples
    --------
    >>> zinc = Phase("zinc", "6/mmm", (2.66, 2.66, 4.95), (90, 90, 120))
    >>> cell_vector((1, 1, -2, 0), "direction", zinc).tolist()
    [3.0, 3.0, 0.0]
    """
    indices = checks.array(given, subject, OrientationError)
    if indices.shape not in ((3,), (4,)):
        raise OrientationError(
            f"{subject}: expected three indices, or four for a hexagonal cell, got "
            f"{checks.shown(given)}."
        )
    if len(indices) == 3:
        return indices
    h, k, i, last = indices
    if (
        phase.laue not in ("-3", "-3m", "6/m", "6/mmm")
        or abs(h + k + i) > 1e-6 * np.abs(indices).max()
    ):
        raise OrientationError(
            f"{subject}: expected four indices only in a hexagonal or trigonal cell, with a sum "
            f"of 0 for the first three, got {checks.shown(given)} for {phase.laue}. Give three."
        )
    return np.array([h, k, last]) if plane else np.array([h - i, k - i, last])

"""Symmetry: the rotations of the 11 Laue groups, variants of orientations, disorientations.

An orientation is a unit quaternion that rotates crystal axes into specimen axes (as in
`rigid.attitude`, scalar first). A rotation s that maps the lattice to itself gives the variant q s
of the orientation q.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from geomtorsion.errors import OrientationError
from geomtorsion.loops.quadrature import PIECE
from geomtorsion.rigid.attitude import product, quaternion_from_rotation_vector, rotated
from geomtorsion.support import checks
from geomtorsion.support.caching import cached_property

# Generators of the rotations: axis, and number of rotations in a full turn. _H is the horizontal
# two-fold axis of -3m, which is along x or y depending on the choice of crystal axes.
_Z, _Y, _X, _D, _H = (0, 0, 1), (0, 1, 0), (1, 0, 0), (1, 1, 1), None
GENERATORS: dict[str, tuple[tuple[Sequence[int] | None, int], ...]] = {
    "-1": (),
    "2/m": ((_Y, 2),),
    "mmm": ((_Z, 2), (_X, 2)),
    "4/m": ((_Z, 4),),
    "4/mmm": ((_Z, 4), (_X, 2)),
    "-3": ((_Z, 3),),
    "-3m": ((_Z, 3), (_H, 2)),
    "6/m": ((_Z, 6),),
    "6/mmm": ((_Z, 6), (_X, 2)),
    "m-3": ((_Z, 2), (_D, 3)),
    "m-3m": ((_Z, 4), (_D, 3)),
}
LAUE_GROUPS = tuple(GENERATORS)
# A direction off all axes and mirrors of all Laue groups, near z and nearer to x than to y. The
# standard triangle contains the directions that are nearer to it than to its images.
_GENERIC = np.array([0.41, 0.17, 0.9])


@dataclass(frozen=True, eq=False, repr=False)
class LaueGroup:
    """The rotations of a Laue group.

    name: as in the International Tables, such as "m-3m". The unique axis of 2/m is y; all other
        groups have the unique axis z.
    quaternions: one for each rotation, the identity first, shape (n, 4).

    Examples
    --------
    >>> [len(laue_group(name).quaternions) for name in LAUE_GROUPS]
    [1, 2, 4, 4, 8, 3, 6, 6, 12, 12, 24]
    """

    name: str
    quaternions: np.ndarray

    @cached_property
    def products(self) -> np.ndarray:
        """Number of the rotation s_i s_j, shape (n, n)."""
        rotations = product(self.quaternions[:, None], self.quaternions[None, :])
        return np.abs(rotations @ self.quaternions.T).argmax(axis=-1)

    def nearest(self, one: np.ndarray, other: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """The variant of each other orientation nearest to the first one, and the angle.

        Parameters
        ----------
        one, other
            Unit quaternions, shape (k, 4).

        Returns
        -------
        Numbers of the rotations s for which other s is nearest, and the angles, rad; shape (k,).

        Examples
        --------
        >>> import numpy as np
        >>> quarter = np.array([[np.sqrt(0.5), 0, 0, np.sqrt(0.5)]])
        >>> laue_group("m-3m").nearest(np.array([[1.0, 0, 0, 0]]), quarter)[1].round(9).tolist()
        [0.0]
        """
        variants, angles = np.empty(len(one), dtype=np.int64), np.empty(len(one))
        back = conjugated(self.quaternions)
        for first in range(0, len(one), PIECE):
            chosen = slice(first, first + PIECE)
            between = product(conjugated(one[chosen]), other[chosen])
            # The scalar of (between s) is the inner product of between and the inverse of s.
            scalars = np.abs(between @ back.T)
            best = scalars.argmax(axis=1)
            variants[chosen] = best
            angles[chosen] = angle_of(product(between, self.quaternions[best]))
        return variants, angles

    def disorientation(self, one: np.ndarray, other: np.ndarray) -> np.ndarray:
        """The misorientation of two orientations of one phase, in the fundamental zone.

        This is the smallest rotation from one to a variant of the other. Its axis, in crystal axes,
        is within the standard triangle. The order of the two orientations does not matter.

        Parameters
        ----------
        one, other
            Unit quaternions, shape (..., 4).

        Returns
        -------
        Unit quaternions, shape (..., 4), scalar not negative.

        Examples
        --------
        In a cubic crystal, a rotation by 50 degrees about z equals a rotation by 40 degrees.

        >>> import numpy as np
        >>> turn = quaternion_from_rotation_vector([0, 0, np.radians(50)])
        >>> found = laue_group("m-3m").disorientation(np.array([1.0, 0, 0, 0]), turn)
        >>> float(np.degrees(2 * np.arccos(found[0])).round(6)), (found[1:].round(6) + 0.0).tolist()
        (40.0, [0.0, 0.0, 0.34202])
        """
        shape = np.broadcast_shapes(np.shape(one), np.shape(other))
        p = np.broadcast_to(one, shape).reshape(-1, 4)
        q = np.broadcast_to(other, shape).reshape(-1, 4)
        variants, _ = self.nearest(p, q)
        turn = product(conjugated(p), product(q, self.quaternions[variants]))
        turn = np.where(turn[:, :1] < 0, -turn, turn)
        images = rotated(self.quaternions, np.broadcast_to(_GENERIC, (len(self.quaternions), 3)))
        # The inverse rotation, from the other orientation to the first, is also a candidate.
        nearness = turn[:, 1:] @ images.T
        best = np.abs(nearness).argmax(axis=1)
        sign = np.sign(np.take_along_axis(nearness, best[:, None], axis=1))
        back = conjugated(self.quaternions[best])
        axis = rotated(back, turn[:, 1:]) * np.where(sign == 0, 1, sign)
        return np.concatenate([turn[:, :1], axis], axis=1).reshape(shape) + 0.0

    def __repr__(self) -> str:
        return f"LaueGroup({self.name!r}, {len(self.quaternions)} rotations)"


def laue_group(name: str, horizontal: str = "x") -> LaueGroup:
    """A Laue group by its name.

    Parameters
    ----------
    horizontal
        Direction of the two-fold axis of -3m: "x" (a along x, as in .ang files) or "y" (b along y,
        as in .ctf files).

    Raises
    ------
    OrientationError
        There is no such group; the message lists all.
    """
    checks.known_name(name, LAUE_GROUPS, "Laue group", OrientationError)
    checks.known_name(horizontal, ("x", "y"), "horizontal axis", OrientationError)
    rotations = [np.array([1.0, 0.0, 0.0, 0.0])]
    across = _X if horizontal == "x" else _Y
    generators = []
    for axis, times in GENERATORS[name]:
        direction = np.array(across if axis is None else axis, dtype=float)
        turn = 2 * np.pi / times * direction / np.linalg.norm(direction)
        generators.append(quaternion_from_rotation_vector(turn))
    # Multiply each new rotation by each generator until no new rotation appears.
    for rotation in rotations:
        for generator in generators:
            new = product(generator, rotation)
            if all(abs(new @ old) < 1 - 1e-9 for old in rotations):
                rotations.append(new)
    return LaueGroup(name, np.array(rotations))


def conjugated(q: np.ndarray) -> np.ndarray:
    """The inverse rotations, shape (..., 4)."""
    return q * np.array([1.0, -1.0, -1.0, -1.0])


def angle_of(q: np.ndarray) -> np.ndarray:
    """Rotation angles in [0, pi], rad, shape (...); small angles keep all digits."""
    return 2 * np.arctan2(np.linalg.norm(q[..., 1:], axis=-1), np.abs(q[..., 0]))

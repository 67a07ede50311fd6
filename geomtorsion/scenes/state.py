"""State: position, attitude and velocities of a body at the start of a scene."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from geomtorsion.errors import StartError
from geomtorsion.exact.units import in_unit
from geomtorsion.rigid import attitude
from geomtorsion.scenes.body import Number
from geomtorsion.support import checks
from geomtorsion.support.caching import cached_property
from geomtorsion.support.displays import short_repr


@dataclass(frozen=True)
class State:
    """Initial state of a body; the attitude is given in at most one form.

    omega: angular velocity in body axes, rad/s.
    euler: three angles, rad; by default the paper's (phi1, phi2, phi3), z-y-z,
        R = Rz(phi3) Ry(phi2) Rz(phi1); other conventions by `euler_convention`.
    quaternion: (q0, q1, q2, q3), scalar first, body to space, length 1.
    matrix: 3 x 3 rotation, body to space.
    position, velocity: of the centre of mass in space axes, m and m/s; 0 if not given.
    euler_convention: one of 24 names, see `geomtorsion.rigid.attitude`.

    Numbers may be texts with a unit, such as "100 rpm".

    Raises
    ------
    StartError
        a number is not finite, there are too few or too many, or the attitude is not a rotation.
    UnknownNameError
        no convention has this name.

    Examples
    --------
    >>> State(omega=(0, 0, 20), euler=(0, 0.3, 0)).attitude.round(6).tolist()
    [0.988771, 0.0, 0.149438, 0.0]
    >>> State(omega=(0, 0, "60 rpm"), euler=(0, "90 deg", 0)).omega
    (0, 0, 6.283185307179586)
    >>> State(omega=(0, 0, 1), quaternion=(0, 0, 0, 0))
    Traceback (most recent call last):
    geomtorsion.errors.StartError: quaternion: expected length 1, got 0. Use \
(1, 0, 0, 0) for no rotation.
    """

    omega: Sequence[Number] | None = None
    euler: Sequence[Number] | None = None
    quaternion: Sequence[Number] | None = None
    matrix: Sequence[Sequence[Number]] | np.ndarray | None = None
    position: Sequence[Number] | None = None
    velocity: Sequence[Number] | None = None
    euler_convention: str = attitude.PAPER

    __repr__ = short_repr

    def __post_init__(self) -> None:
        """Check, and keep tuples."""
        name = attitude.checked_convention(self.euler_convention)
        object.__setattr__(self, "euler_convention", name)
        for key, unit in (
            ("omega", "rad/s"), ("euler", "rad"), ("position", "m"), ("velocity", "m/s"),
        ):  # fmt: skip
            if getattr(self, key) is not None:
                values = in_unit(getattr(self, key), unit, key, StartError)
                object.__setattr__(self, key, _three(values, key, unit))
        keys = [k for k in ("euler", "quaternion", "matrix") if getattr(self, k) is not None]
        if len(keys) > 1:
            raise StartError(
                f"attitude: expected it once, got {' and '.join(keys)}. Give one of them."
            )
        if self.quaternion is not None:
            attitude.checked_quaternion(self.quaternion)
            object.__setattr__(self, "quaternion", tuple(self.quaternion))
        if self.matrix is not None:
            attitude.checked_matrix(self.matrix)
            object.__setattr__(self, "matrix", tuple(tuple(row) for row in self.matrix))

    @cached_property
    def attitude(self) -> np.ndarray | None:
        """The attitude as unit quaternion, shape (4,), body to space; None if not given."""
        if self.quaternion is not None:
            return attitude.checked_quaternion(self.quaternion)
        if self.matrix is not None:
            return attitude.checked_matrix(self.matrix)
        if self.euler is not None:
            angles = [float(x) for x in self.euler]
            return attitude.quaternion_from_euler(angles, self.euler_convention)
        return None


def _three(values: Sequence[Number], name: str, unit: str) -> tuple[Number, ...]:
    """Three finite numbers, as they came."""
    return checks.numbers(values, 3, name, StartError, expected=f"three numbers ({unit})")

"""Angular damping: something thick around the body slows its rotation."""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field
from typing import ClassVar

from geomtorsion.errors import SceneError
from geomtorsion.scenes.body import Body, Number
from geomtorsion.scenes.context import Context
from geomtorsion.scenes.effects.protocol import Contribution, Effect, Typical, unit
from geomtorsion.scenes.effects.surroundings import Surroundings, mean_radius
from geomtorsion.support.checks import entries, not_negative, plain


@dataclass(frozen=True)
class AngularDamping(Effect):
    """Damping torque, proportional to the angular velocity and opposite to it.

    Equation
    --------
    M_i = -c_i Omega_i, body axes; power -c_i Omega_i^2

    Parameters
    ----------
    coefficient
        c, N m s: one number, or three for the three body axes.

    Raises
    ------
    SceneError
        A coefficient is negative or not a number.

    Examples
    --------
    >>> sorted(AngularDamping(0.1).needs()), AngularDamping((0, 0, 1)).coefficient
    (['omega'], (0, 0, 1))
    """

    key: ClassVar[str] = "angular_damping"
    title: ClassVar[str] = "damping of the rotation"

    coefficient: Number | Sequence[Number] = field(metadata=unit("N m s"))

    @classmethod
    def typical(cls, body: Body, surroundings: Surroundings) -> Typical:
        """The torque of a viscous fluid on a sphere             [LandauLifshitz6] section 20."""
        radius = mean_radius(body)
        return Typical(
            cls(8 * math.pi * surroundings.viscosity * radius**3),
            "c = 8 pi viscosity r^3, r the mean radius",
            "slow rotation in air; fast rotation is damped more",
        )

    def __post_init__(self) -> None:
        """One number or three, none of them negative."""
        value = plain(self.coefficient)
        several = isinstance(value, Iterable) and not isinstance(value, str)
        object.__setattr__(self, "coefficient", tuple(value) if several else value)
        subject, wanted = "angular_damping.coefficient", "one number >= 0 (N m s), or three"
        for each in entries(self._three(), subject, SceneError, 3, expected=wanted):
            not_negative(each, subject, SceneError, expected=wanted)

    def _three(self) -> tuple[Number, ...]:
        """The three coefficients."""
        value = self.coefficient
        return tuple(value) if isinstance(value, Sequence) else (value, value, value)

    def adds(self, context: Context) -> Contribution:
        """Torque in body axes."""
        if isinstance(self.coefficient, tuple):
            sizes = context.vector("c", self.coefficient)
        else:
            sizes = [context.parameter("c", self.coefficient)] * 3
        moment = [-c * w for c, w in zip(sizes, context.Omega, strict=True)]
        return Contribution(moment=(moment[0], moment[1], moment[2]))

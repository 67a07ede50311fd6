"""Gravity: a uniform field, straight down."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import ClassVar

from geomtorsion.scenes.body import Body, Number
from geomtorsion.scenes.context import Context
from geomtorsion.scenes.effects.fields import check_numbers
from geomtorsion.scenes.effects.protocol import Contribution, Effect, Typical, unit
from geomtorsion.scenes.effects.surroundings import Surroundings


@dataclass(frozen=True)
class Gravity(Effect):
    """Uniform gravity along the negative third space axis.

    It does not affect the rotation of a free body; on a body with a pivot it exerts a torque.

    Equation
    --------
    F = -m g e_z (space axes), potential m g z

    Parameters
    ----------
    g
        acceleration, m/s^2; positive is downwards.

    Examples
    --------
    >>> Gravity(1.62).g
    1.62
    """

    key: ClassVar[str] = "gravity"
    title: ClassVar[str] = "uniform gravity, downwards"

    g: Number = field(default=9.81, metadata=unit("m/s^2"))

    def __post_init__(self) -> None:
        """Check the number."""
        check_numbers(self, "g")

    @classmethod
    def typical(cls, body: Body, surroundings: Surroundings) -> Typical:
        """The weight at the surface."""
        return Typical(cls(surroundings.gravity), "F = m g", "near the surface of the planet")

    def adds(self, context: Context) -> Contribution:
        """A force at the centre of mass, with its potential."""
        weight = context.mass * context.parameter("g", self.g)
        return Contribution(force=(0, 0, -weight), energy=weight * context.position[2])

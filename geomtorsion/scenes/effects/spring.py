"""Spring: a point of the body hangs on a point of space."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import ClassVar

import sympy as sp

from geomtorsion.scenes.body import Number
from geomtorsion.scenes.context import Context
from geomtorsion.scenes.effects.fields import check_numbers, check_vectors
from geomtorsion.scenes.effects.protocol import Contribution, Effect, unit


@dataclass(frozen=True)
class Spring(Effect):
    """Linear spring between a fixed point in space and a point of the body.

    Equation
    --------
    F = -k (|d| - length) d / |d|, d = position + R arm - anchor; V = (k/2) (|d| - length)^2

    Parameters
    ----------
    stiffness
        k, N/m.
    length
        of the spring at rest, m. If it is not 0, the force has no direction at d = 0.
    anchor
        fixed end in space, shape (3,), m.
    arm
        from the centre of mass to the end on the body, shape (3,), body axes, m.

    Raises
    ------
    SceneError
        A number is missing or negative, or a vector does not have three components.

    Examples
    --------
    >>> sorted(Spring(stiffness=10).needs()), sorted(Spring(10, arm=(0, 0, 1)).needs())
    (['position'], ['attitude', 'position'])
    """

    key: ClassVar[str] = "spring"
    title: ClassVar[str] = "spring to a point of space"
    several: ClassVar[bool] = True

    stiffness: Number = field(metadata=unit("N/m"))
    length: Number = field(default=0, metadata=unit("m"))
    anchor: Sequence[Number] = field(default=(0, 0, 0), metadata=unit("m"))
    arm: Sequence[Number] = field(default=(0, 0, 0), metadata=unit("m"))

    def __post_init__(self) -> None:
        """Check numbers and vectors."""
        check_numbers(self, "stiffness", "length", sign="not negative")
        check_vectors(self, "anchor", "arm")

    def adds(self, context: Context) -> Contribution:
        """A force at a point, and its potential."""
        k = context.parameter("k", self.stiffness)
        rest = context.parameter("length", self.length)
        arm = context.vector("arm", self.arm)
        reach = sp.Matrix(context.position) + context.in_space(arm)
        reach -= context.vector("anchor", self.anchor)
        force, energy = -k * reach, k * reach.dot(reach) / 2
        # Without a length at rest no root is needed, and nothing is singular.
        if rest != 0:
            distance = sp.sqrt(reach.dot(reach))
            force, energy = force * (1 - rest / distance), k * (distance - rest) ** 2 / 2
        moment = tuple(arm.cross(context.in_body(force))) if any(arm) else None
        return Contribution(moment=moment, force=tuple(force), energy=energy)

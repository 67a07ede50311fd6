"""Knife edge: a blade under the body lets it go forward and turn, not sideways."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import ClassVar

import sympy as sp

from geomtorsion.scenes.body import Number
from geomtorsion.scenes.context import Context
from geomtorsion.scenes.effects.fields import check_numbers, check_vectors
from geomtorsion.scenes.effects.protocol import Constraint, Contribution, Effect, unit


@dataclass(frozen=True)
class KnifeEdge(Effect):
    """A body on a plane with a blade along its first axis: Chaplygin's sleigh.

    It stays in the plane of its first two body axes. If those are not level at the start, the
    plane is inclined.

    Equation
    --------
    omega = (0, 0, Omega3), velocity of the blade = (u, 0, 0), body axes
    m (u' - a Omega3^2) = F_1, (I3 + m a^2) Omega3' + m a u Omega3 = M for arm (a, 0, 0)
                                                            [NeimarkFufaev1972]

    Parameters
    ----------
    arm
        from the blade to the centre of mass, body axes, m.
    speed
        u at the start, m/s, along the first body axis.

    Raises
    ------
    SceneError
        The arm does not have three components, or the speed is not a number.

    Examples
    --------
    >>> KnifeEdge((0.1, 0, 0), speed=1).arm
    (0.1, 0, 0)
    """

    key: ClassVar[str] = "knife_edge"
    title: ClassVar[str] = "knife edge: forward and turning, not sideways"
    excludes: ClassVar[frozenset[str]] = frozenset({"drift", "pivot", "rolling"})

    arm: Sequence[Number] = field(default=(0, 0, 0), metadata=unit("m"))
    speed: Number = field(default=0, metadata=unit("m/s"))

    def __post_init__(self) -> None:
        """Check vector and number."""
        check_vectors(self, "arm")
        check_numbers(self, "speed")

    def adds(self, context: Context) -> Contribution:
        """The constraint; the remaining speeds are u, forwards, and Omega3."""
        u = context.state("u")
        spin = context.Omega[2]
        arm = context.vector("a", self.arm)
        blade = sp.Matrix([u, 0, 0])
        constraint = Constraint(
            speeds=(u.name, spin.name),
            omega=(sp.S.Zero, sp.S.Zero, spin),
            velocity=tuple(blade + sp.Matrix([0, 0, spin]).cross(arm)),
            start={u.name: self.speed},
        )
        place = sp.Matrix(context.position) - context.in_space(arm)
        return Contribution(constraint=constraint, outputs={"blade": tuple(place), "forward": u})

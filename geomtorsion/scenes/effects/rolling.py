"""Rolling: a disc or a ball on a level plane, without slipping."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import ClassVar

import sympy as sp

from geomtorsion.errors import SceneError
from geomtorsion.scenes.body import Number
from geomtorsion.scenes.context import Context
from geomtorsion.scenes.effects.fields import check_numbers
from geomtorsion.scenes.effects.protocol import Constraint, Contribution, Effect, unit
from geomtorsion.support.checks import choice

SHAPES = ("disc", "ball")


@dataclass(frozen=True)
class Rolling(Effect):
    """The lowest point of the body is at rest on the plane z = 0: a nonholonomic constraint.

    The axis of a disc is the third body axis; its rim is sharp. The centre of mass is the centre
    of disc or ball; moments of inertia are free (a hoop, a disc, Chaplygin's ball). Its height
    follows from the attitude: a start may omit the position, or give that height.

    Equation
    --------
    v = c x Omega (body axes), c from the centre to the point of contact:
    disc: c = -r (n1, n2, 0) / sqrt(n1^2 + n2^2), n upwards; ball: c = -r n    [NeimarkFufaev1972]

    Parameters
    ----------
    radius
        r, m.
    shape
        "disc" or "ball".

    Raises
    ------
    SceneError
        the radius is not positive, or the shape is neither "disc" nor "ball".

    Examples
    --------
    >>> Rolling(0.3).shape, sorted(Rolling.excludes)
    ('disc', ['drift', 'knife_edge', 'pivot'])
    """

    key: ClassVar[str] = "rolling"
    title: ClassVar[str] = "rolling on a plane without slipping"
    excludes: ClassVar[frozenset[str]] = frozenset({"drift", "pivot", "knife_edge"})

    radius: Number = field(metadata=unit("m"))
    shape: str = "disc"

    def __post_init__(self) -> None:
        """A positive radius and one of two words."""
        check_numbers(self, "radius", sign="positive")
        choice(self.shape, SHAPES, "rolling.shape", SceneError)

    def adds(self, context: Context) -> Contribution:
        """The constraint; the remaining speeds are the angular velocity."""
        r = context.parameter("radius", self.radius)
        n1, n2, n3 = context.vertical
        # The lowest point is on the plane: the height of the centre is -c . n.
        if self.shape == "disc":
            slope = sp.sqrt(n1**2 + n2**2)
            contact, height = -r / slope * sp.Matrix([n1, n2, 0]), r * slope
        else:
            contact, height = -r * sp.Matrix([n1, n2, n3]), r
        velocity = contact.cross(sp.Matrix(context.Omega))
        constraint = Constraint(
            speeds=tuple(symbol.name for symbol in context.Omega),
            omega=context.Omega,
            velocity=tuple(velocity),
            position=(*context.position[:2], height),
        )
        return Contribution(
            constraint=constraint, outputs={"contact": self._place(context, contact)}
        )

    def _place(self, context: Context, contact: sp.Matrix) -> tuple[sp.Expr, sp.Expr]:
        """Where it touches the plane: x and y."""
        place = sp.Matrix(context.position) + context.in_space(contact)
        return (place[0], place[1])

"""Pivot: one point of the body is held in space."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import ClassVar

import sympy as sp

from geomtorsion.errors import SceneError
from geomtorsion.scenes.body import Number
from geomtorsion.scenes.context import Context
from geomtorsion.scenes.effects.fields import check_vectors
from geomtorsion.scenes.effects.protocol import Constraint, Contribution, Effect, unit
from geomtorsion.support.checks import choice


@dataclass(frozen=True)
class Pivot(Effect):
    """A body that turns about a fixed point: with gravity, the heavy top.

    Equation
    --------
    (I + m (|a|^2 - a a^T)) Omega' + Omega x L = M + a x R^T F, a the arm

    Parameters
    ----------
    arm
        from the pivot to the centre of mass, body axes, m. A top on its tip with its
        axis along the third body axis has (0, 0, height).
    place
        position of the pivot in space, m.
    moments_at
        "centre": the body's moments are about its centre of mass, Steiner's part is added;
        "pivot": they are about the pivot already.

    Raises
    ------
    SceneError
        the arm is not a vector, or moments_at is neither "centre" nor "pivot".

    Examples
    --------
    >>> Pivot([0, 0, 0.1]).arm
    (0, 0, 0.1)
    >>> sorted(Pivot([0, 0, 0.1]).needs()), Pivot.units()["arm"]
    (['attitude', 'omega'], 'm')
    """

    key: ClassVar[str] = "pivot"
    title: ClassVar[str] = "one point of the body is held"
    excludes: ClassVar[frozenset[str]] = frozenset({"drift", "rolling", "knife_edge"})

    arm: Sequence[Number] = field(metadata=unit("m"))
    place: Sequence[Number] = field(default=(0, 0, 0), metadata=unit("m"))
    moments_at: str = "centre"

    def __post_init__(self) -> None:
        """Tuples of three numbers, and one of two words."""
        check_vectors(self, "arm", "place")
        remedy = "It is the point about which the moments of the body are given."
        points = ("centre", "pivot")
        choice(self.moments_at, points, "pivot.moments_at", SceneError, remedy=remedy)

    def adds(self, context: Context) -> Contribution:
        """The constraint v = Omega x a; moments about the pivot are reduced to the centre."""
        arm = context.vector("a", self.arm)
        place = context.vector("place", self.place)
        constraint = Constraint(
            speeds=tuple(symbol.name for symbol in context.Omega),
            omega=context.Omega,
            velocity=tuple(sp.Matrix(context.Omega).cross(arm)),
            position=tuple(place + context.in_space(arm)),
            arm=tuple(arm),
        )
        steiner = None
        # The projection adds Steiner's part in any case; moments about the pivot contain it.
        if self.moments_at == "pivot":
            matrix = context.mass * (arm * arm.T - arm.dot(arm) * sp.eye(3))
            steiner = tuple(tuple(matrix[i, :]) for i in range(3))
        return Contribution(constraint=constraint, inertia=steiner)

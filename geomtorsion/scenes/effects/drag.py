"""Drag: the air holds back a body that moves, linearly or with the square of its speed."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import ClassVar

import sympy as sp

from geomtorsion.scenes.body import Body, Number
from geomtorsion.scenes.context import Context
from geomtorsion.scenes.effects.fields import check_numbers, check_vectors
from geomtorsion.scenes.effects.protocol import Contribution, Effect, Typical, unit
from geomtorsion.scenes.effects.surroundings import Surroundings, mean_radius, semiaxes


@dataclass(frozen=True)
class LinearDrag(Effect):
    """Drag proportional to the speed (slow motion in a viscous fluid).

    Equation
    --------
    F = -c w at the point `arm` of the body, w = v + R (Omega x arm) - wind: its speed in the air

    Parameters
    ----------
    coefficient
        c, N s/m.
    arm
        from the centre of mass to the centre of pressure, body axes, m.
    wind
        speed of the air, space axes, m/s.

    Raises
    ------
    SceneError
        The coefficient is negative or not a number, or a vector does not have three components.

    Examples
    --------
    >>> sorted(LinearDrag(0.1).needs()), sorted(LinearDrag(0.1, arm=(0, 0, 1)).needs())
    (['velocity'], ['attitude', 'omega', 'velocity'])
    """

    key: ClassVar[str] = "linear_drag"
    title: ClassVar[str] = "drag in proportion to the speed"

    coefficient: Number = field(metadata=unit("N s/m"))
    arm: Sequence[Number] = field(default=(0, 0, 0), metadata=unit("m"))
    wind: Sequence[Number] = field(default=(0, 0, 0), metadata=unit("m/s"))

    @classmethod
    def typical(cls, body: Body, surroundings: Surroundings) -> Typical:
        """The drag of a viscous fluid on a slow sphere          [LandauLifshitz6] section 20."""
        radius = mean_radius(body)
        return Typical(
            cls(6 * math.pi * surroundings.viscosity * radius),
            "c = 6 pi viscosity r, r the mean radius",
            "slow motion in still air: density v r / viscosity below 1",
        )

    def __post_init__(self) -> None:
        """Check numbers and vectors."""
        check_numbers(self, "coefficient", sign="not negative")
        check_vectors(self, "arm", "wind")

    def adds(self, context: Context) -> Contribution:
        """A force at the centre of pressure."""
        arm = context.vector("arm", self.arm)
        speed = _through_air(context, arm, self.wind)
        return _at(context, arm, -context.parameter("c", self.coefficient) * speed)


@dataclass(frozen=True)
class QuadraticDrag(Effect):
    """Drag proportional to the square of the speed (a ball or a stone in air).

    Equation
    --------
    F = -c sqrt(w^2 + s^2) w at the point `arm` of the body, w = v + R (Omega x arm) - wind
    c = (1/2) density * area * drag coefficient                 [LandauLifshitz6] section 45

    Parameters
    ----------
    coefficient
        c, kg/m.
    arm
        from the centre of mass to the centre of pressure, body axes, m.
    wind
        speed of the air, space axes, m/s.
    smoothing
        s, m/s: |w| is sqrt(w^2 + s^2), since |w| has a corner at rest, where series in time end.
        The default changes the force by less than one part in 1e12 from 1 m/s on; with 0 a body
        must neither start at rest nor come to it.

    Raises
    ------
    SceneError
        A number is negative or missing, or a vector does not have three components.

    Examples
    --------
    >>> sorted(QuadraticDrag(0.01).needs())
    ['velocity']
    """

    key: ClassVar[str] = "quadratic_drag"
    title: ClassVar[str] = "drag in proportion to the square of the speed"

    coefficient: Number = field(metadata=unit("kg/m"))
    arm: Sequence[Number] = field(default=(0, 0, 0), metadata=unit("m"))
    wind: Sequence[Number] = field(default=(0, 0, 0), metadata=unit("m/s"))
    smoothing: Number = field(default=1e-6, metadata=unit("m/s"))

    @classmethod
    def typical(cls, body: Body, surroundings: Surroundings) -> Typical:
        """The drag of air on the largest cross-section of the body."""
        a, b, _ = semiaxes(body)
        area = math.pi * a * b
        return Typical(
            cls(surroundings.density * area * surroundings.drag_coefficient / 2),
            "c = density area drag_coefficient / 2, area of the largest section",
            "fast motion in still air: density v r / viscosity from 1e3 to 1e5",
        )

    def __post_init__(self) -> None:
        """Check numbers and vectors."""
        check_numbers(self, "coefficient", "smoothing", sign="not negative")
        check_vectors(self, "arm", "wind")

    def adds(self, context: Context) -> Contribution:
        """A force at the centre of pressure."""
        arm = context.vector("arm", self.arm)
        speed = _through_air(context, arm, self.wind)
        smooth = context.parameter("smoothing", self.smoothing)
        size = sp.sqrt(speed.dot(speed) + smooth**2)
        return _at(context, arm, -context.parameter("c", self.coefficient) * size * speed)


def _through_air(context: Context, arm: sp.Matrix, wind: Sequence[Number]) -> sp.Matrix:
    """Velocity of the centre of pressure in the air, space axes."""
    speed = sp.Matrix(context.velocity) - context.vector("wind", wind)
    if any(arm):
        speed += context.in_space(sp.Matrix(context.Omega).cross(arm))
    return speed


def _at(context: Context, arm: sp.Matrix, force: sp.Matrix) -> Contribution:
    """A force at a point of the body."""
    moment = tuple(arm.cross(context.in_body(force))) if any(arm) else None
    return Contribution(moment=moment, force=tuple(force))

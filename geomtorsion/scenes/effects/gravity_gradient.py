"""Gravity gradient: a satellite on a circular orbit is turned by the tide."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import ClassVar

import sympy as sp

from geomtorsion.scenes.body import Body, Number
from geomtorsion.scenes.context import Context
from geomtorsion.scenes.effects.fields import check_numbers
from geomtorsion.scenes.effects.protocol import Contribution, Effect, Typical, unit
from geomtorsion.scenes.effects.surroundings import Surroundings


@dataclass(frozen=True)
class GravityGradient(Effect):
    """Gravity-gradient torque of a central field on a body in a prescribed circular orbit.

    The orbit is in the plane of the first two space axes; at t = 0 the centre of attraction is
    seen from the body in the direction (cos phase, sin phase, 0), or the opposite one.

    Equation
    --------
    M = 3 n^2 c x I c, c = R^T (cos(n t + phase), sin(n t + phase), 0)      [Beletskii1966]
    V = (3/2) n^2 c.I c (up to a constant); it depends on time: dE/dt = dV/dt at rest

    Parameters
    ----------
    rate
        n, of the orbit, rad/s; sqrt(mu / radius^3).
    phase
        angle of the orbit at t = 0, rad.

    Raises
    ------
    SceneError
        a field is not a number, or the rate is negative.

    Examples
    --------
    >>> sorted(GravityGradient(rate=1e-3).needs())
    ['attitude', 'time']
    """

    key: ClassVar[str] = "gravity_gradient"
    title: ClassVar[str] = "gravity gradient on a circular orbit"

    rate: Number = field(metadata=unit("rad/s"))
    phase: Number = field(default=0, metadata=unit("rad"))

    @classmethod
    def typical(cls, body: Body, surroundings: Surroundings) -> Typical:
        """The tide on a low orbit, where it is largest."""
        return Typical(
            cls(surroundings.orbital_rate),
            "M = 3 n^2 c x I c, n = sqrt(g / radius)",
            "on a low circular orbit",
            at_surface=False,
        )

    def __post_init__(self) -> None:
        """Check the numbers."""
        check_numbers(self, "rate", sign="not negative")
        check_numbers(self, "phase")

    def adds(self, context: Context) -> Contribution:
        """Torque, its potential, and the power of the rotating field."""
        n = context.parameter("n", self.rate)
        angle = n * context.t + context.parameter("phase", self.phase)
        centre = context.in_body((sp.cos(angle), sp.sin(angle), 0))
        inert = context.inertia * centre
        moment = 3 * n**2 * centre.cross(inert)
        potential = sp.Rational(3, 2) * n**2 * centre.dot(inert)
        # The field turns with the orbit, so that the potential changes even at rest.
        across = context.in_body((-sp.sin(angle), sp.cos(angle), 0))
        power = 3 * n**3 * across.dot(inert)
        return Contribution(moment=tuple(moment), energy=potential, power=power)

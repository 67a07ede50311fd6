"""Surroundings: air and gravity around a body, and the size of the body in them."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from geomtorsion.errors import SceneError
from geomtorsion.support import checks

if TYPE_CHECKING:
    from geomtorsion.scenes.body import Body


@dataclass(frozen=True)
class Surroundings:
    """Air and gravity around a body; by default at rest at sea level on the Earth.

    gravity: m/s^2, standard gravity.
    radius: of the planet, m.
    density, viscosity: of the air, kg/m^3 and Pa s; 15 degrees Celsius    [ISO2533].
    drag_coefficient: of the body in fast motion, a sphere at Reynolds numbers from 1e3 to 1e5.

    Raises
    ------
    SceneError
        a number is negative or not finite, or the radius is 0.

    Examples
    --------
    >>> mars = Surroundings(gravity=3.71, radius=3.39e6, density=0.02, viscosity=1.1e-5)
    >>> round(mars.orbital_rate, 6)
    0.001046
    """

    gravity: float = 9.80665
    radius: float = 6.371e6
    density: float = 1.225
    viscosity: float = 1.79e-5
    drag_coefficient: float = 0.47

    def __post_init__(self) -> None:
        """Check the numbers."""
        for name, value in vars(self).items():
            convert = checks.positive if name == "radius" else checks.not_negative
            convert(value, f"surroundings.{name}", SceneError, remedy="Give it in SI units.")

    @property
    def orbital_rate(self) -> float:
        """Angular velocity of a circular orbit at the surface, rad/s: sqrt(gravity / radius)."""
        return math.sqrt(self.gravity / self.radius)


def semiaxes(body: Body) -> tuple[float, float, float]:
    """Semiaxes of the homogeneous ellipsoid of equal mass and moments, the largest first, m.

    Equation
    --------
    a^2 = 5 (I_b + I_c - I_a) / (2 m), from I_a = m (b^2 + c^2) / 5

    Examples
    --------
    >>> from geomtorsion.scenes import Body
    >>> [round(a, 12) for a in semiaxes(Body.ellipsoid(mass=2, semiaxes=(1, 3, 2)))]
    [3.0, 2.0, 1.0]
    """
    moments = body.principal_moments
    squares = 5 * (moments.sum() / 2 - moments) / float(body.mass)
    # A flat body has a thickness of zero, up to rounding.
    a, b, c = np.sqrt(np.maximum(squares, 0.0)).tolist()
    return a, b, c


def mean_radius(body: Body) -> float:
    """Radius of the sphere with the volume of that ellipsoid, m; of a flat body its largest one.

    Examples
    --------
    >>> from geomtorsion.scenes import Body
    >>> round(mean_radius(Body.ellipsoid(mass=2, semiaxes=(1, 3, 9))), 12)
    3.0
    """
    axes = semiaxes(body)
    return math.prod(axes) ** (1 / 3) or axes[0]

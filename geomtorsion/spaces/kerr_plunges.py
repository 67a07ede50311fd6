"""kerr_plunges: particles that fall into a rotating black hole, by their constants of motion."""

from __future__ import annotations

import math
from dataclasses import dataclass

import mpmath

from geomtorsion.curves.constructors import geodesic
from geomtorsion.curves.problem import CurveProblem
from geomtorsion.errors import StartError
from geomtorsion.spaces.kerr_constants import radial_roots
from geomtorsion.spaces.kerr_orbits import exact_constants
from geomtorsion.spaces.registry import load
from geomtorsion.support import checks
from geomtorsion.support.precision import CONSTANT_BITS, working_precision


@dataclass(frozen=True)
class KerrPlunge:
    """A geodesic of Kerr's space that ends in the hole, M = 1; made by `kerr_plunge`.

    a: spin. energy, angular_momentum, carter: E = -p_t, L = p_phi and Q for a unit mass.
    highest: the largest r of the fall, infinite for a particle from afar. horizon: its r.
    """

    a: float
    energy: float
    angular_momentum: float
    carter: float
    highest: float
    horizon: float

    def geodesic(self, radius: object = None, stop: object = None) -> CurveProblem:
        """The fall as a curve in `kerr`, inwards from a radius on the equator.

        radius: where it begins; by default the largest r. stop: where it ends; by default a
        thousandth of the radius of the horizon above it, see `gt.geodesic`.

        Raises
        ------
        StartError
            the radius is not between the horizon and the largest r.
        """
        if radius is None and math.isinf(self.highest):
            raise StartError(
                "radius: expected the r where the curve begins, got none, and the particle comes "
                "from infinity. Give geodesic(10), for example."
            )
        r = self.highest if radius is None else checks.positive(radius, "radius", StartError)
        if not self.horizon < r <= self.highest:
            raise StartError(
                f"radius: expected a number above {self.horizon:.6g} and at most "
                f"{self.highest:.6g}, got {r:.6g}."
            )
        a, energy, turn = self.a, self.energy, self.angular_momentum
        size = r**2 - 2 * r + a**2
        pull = energy * (r**2 + a**2) - a * turn
        radial = max(pull**2 - size * (r**2 + (turn - a * energy) ** 2 + self.carter), 0.0)
        if r == self.highest:
            radial = 0.0
        velocity = [
            pull / (r * math.sqrt(size)), -math.sqrt(radial / size) / r,
            math.sqrt(self.carter) / r, (turn - a * energy) / r,
        ]  # fmt: skip
        end = f"r - {1.001 * self.horizon!r}" if stop is None else stop
        place = [0.0, r, math.pi / 2, 0.0]
        numbers = {"M": 1.0, "a": a}
        return geodesic(
            load("kerr").frame, place, frame_velocity=velocity, parameters=numbers, stop=end
        )


def kerr_plunge(
    a: float, energy: float, angular_momentum: float = 0.0, carter: float = 0.0
) -> KerrPlunge:
    """Fall into Kerr's hole by the constants of motion; M = 1.

    A particle with the constants of a bound or scattering orbit also has a fall, which begins at
    the turning point next to the horizon.

    Parameters
    ----------
    a
        spin, -1 <= a <= 1; a < 0 is read as the spin -a with -L.
    energy, angular_momentum, carter
        E > 0, L and Q >= 0 of a particle of unit mass.

    Raises
    ------
    StartError
        A number is out of its range.

    Examples
    --------
    A particle that falls from rest at r = 10 without spin:

    >>> round(kerr_plunge(0, 0.8**0.5).highest, 12)
    10.0
    >>> kerr_plunge(0.9, 1, 1.2).highest
    inf
    """
    with working_precision(CONSTANT_BITS):
        *numbers, _ = exact_constants(a, energy, angular_momentum, carter)
        horizon = 1 + mpmath.sqrt(1 - numbers[0] ** 2)
        outside = [x for x in radial_roots(*numbers) if x > horizon]
        highest = min(outside, default=mpmath.inf)
        return KerrPlunge(*(float(x) for x in (*numbers, highest, horizon)))

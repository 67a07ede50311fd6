"""kerr_orbits: bound orbits of a rotating black hole by (a, p, e, x), with their frequencies."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import TypeAlias

import mpmath
import numpy as np

from geomtorsion.curves.constructors import geodesic
from geomtorsion.curves.problem import CurveProblem
from geomtorsion.errors import AccuracyError, StartError
from geomtorsion.ode.problem import ODE
from geomtorsion.spaces.registry import load
from geomtorsion.support import checks
from geomtorsion.support.caching import cached_property
from geomtorsion.support.precision import CALCULATED, CONSTANT_BITS, working_precision

# Places on a turn at which an average is taken first; they are doubled until it stays the same.
FIRST_PLACES = 64
# So many places serve all orbits but those that hover beside the separatrix for hundreds of turns.
MOST_PLACES = 2**20

# Coefficients of r^0, r^1, ...
Polynomial: TypeAlias = Sequence[int | mpmath.mpf]


@dataclass(frozen=True)
class Frequencies:
    """Angular frequencies of an orbit per unit of one time; M = 1.

    radial, polar, azimuthal: 2 pi over the period of r, of theta, and of phi in the mean.
    time: name of the time; rate: mean of this time per unit of Mino time.
    """

    radial: float
    polar: float
    azimuthal: float
    time: str
    rate: float


@dataclass(frozen=True)
class KerrOrbit:
    """A bound geodesic of Kerr's space in units of the mass M = 1; made by `kerr_orbit`.

    a: spin; p: semilatus rectum; e: eccentricity; x: cosine of the inclination.
    energy, angular_momentum, carter: E = -p_t, L = p_phi and Q of a particle of unit mass.
    radii: roots r1 >= r2 > r3 >= r4 of the radial equation; the orbit is between r2 and r1.
    reduced: L / x, which is finite for polar orbits also.
    `room`: r2 - r3, which vanishes at the separatrix.

    Examples
    --------
    >>> orbit = kerr_orbit(0.9, 6, 0.3, 1)
    >>> round(orbit.energy, 12), round(orbit.frequencies.azimuthal, 12)
    (0.92912170912, 0.058161220611)
    """

    a: float
    p: float
    e: float
    x: float
    energy: float
    angular_momentum: float
    carter: float
    radii: tuple[float, float, float, float]
    reduced: float
    room: float

    @property
    def _bound(self) -> float:
        """a^2 (1 - E^2)."""
        return self.a**2 * (1 - self.energy) * (1 + self.energy)

    @cached_property
    def separatrix(self) -> float:
        """Smallest p of stable bound orbits with the same a, e and x; inside it orbits plunge.

        Equation
        --------
        r2 = r3; without spin p = 6 + 2 e (Levin and Perez-Giz, 2009)

        Examples
        --------
        >>> round(kerr_orbit(0, 10, 0.5).separatrix, 12)
        7.0
        """
        with working_precision(CONSTANT_BITS):
            a, e, x = (mpmath.mpf(number) for number in (self.a, self.e, self.x))
            # No turning point is inside the horizon; this orbit is outside the separatrix.
            low, high = (1 + e) * (1 + mpmath.sqrt(1 - a * a)), mpmath.mpf(self.p)
            while float(low) != float(high):
                middle = (low + high) / 2
                bound = _constants(a, middle, e, x) is not None
                low, high = (low, middle) if bound else (middle, high)
        return float(high)

    def radius(self, psi: np.ndarray) -> np.ndarray:
        """r at the angle psi of the ellipse, 0 at the periapsis."""
        return self.p / (1 + self.e * np.cos(psi))

    def _radial_speed(self, psi: np.ndarray) -> np.ndarray:
        """d psi / d lambda."""
        scale = (1 - self.energy) * (1 + self.energy) / ((1 - self.e) * (1 + self.e))
        r, r4 = self.radius(psi), self.radii[3]
        # r - r3 as a sum of two parts that are positive, so that nothing cancels.
        above = self.room + r * self.e * 2 * np.sin(psi / 2) ** 2 / (1 + self.e)
        return self.p * np.sqrt(scale * above / r * (1 - r4 / r))

    def _mean_turn(self, function: Callable[[np.ndarray], np.ndarray]) -> float:
        """Mean over psi, with more places at the periapsis, where orbits hover."""
        return mean(function, (self.room / self.radii[1]) ** 0.25)

    def _height(self, chi: np.ndarray) -> np.ndarray:
        """cos(theta)^2 at the polar angle chi."""
        return (1 - self.x) * (1 + self.x) * np.cos(chi) ** 2

    def _polar_speed(self, chi: np.ndarray) -> np.ndarray:
        """d chi / d lambda."""
        return np.sqrt(self.reduced**2 + self._bound * (1 - self._height(chi)))

    @cached_property
    def mino_frequencies(self) -> Frequencies:
        """Frequencies per unit of Mino time lambda, d tau = (r^2 + a^2 cos(theta)^2) d lambda.

        Equation
        --------
        Upsilon = 2 pi / Lambda of r and theta; Upsilon_phi the mean of d phi / d lambda
        """
        return self._frequencies("mino", 1.0)

    @cached_property
    def frequencies(self) -> Frequencies:
        """Frequencies per unit of the time t of Boyer and Lindquist, as seen from afar."""
        a, energy, turn = self.a, self.energy, self.angular_momentum

        def radial(psi: np.ndarray) -> np.ndarray:
            r = self.radius(psi)
            return (r**2 + a**2) * (energy * (r**2 + a**2) - a * turn) / (r**2 - 2 * r + a**2)

        squares = self._mean_polar(lambda chi: 1 - self._height(chi))
        rate = self._mean_radial(radial) + a * turn - a**2 * energy * squares
        return self._frequencies("t", rate)

    @cached_property
    def proper_frequencies(self) -> Frequencies:
        """Frequencies per unit of proper time."""
        rate = self._mean_radial(lambda psi: self.radius(psi) ** 2)
        rate += self.a**2 * self._mean_polar(self._height)
        return self._frequencies("tau", rate)

    def _frequencies(self, time: str, rate: float) -> Frequencies:
        """The frequencies of Mino time, per unit of another time."""
        a, energy, turn = self.a, self.energy, self.angular_momentum

        def dragged(psi: np.ndarray) -> np.ndarray:
            r = self.radius(psi)
            return a * (energy * (r**2 + a**2) - a * turn) / (r**2 - 2 * r + a**2)

        # L / sin(theta)^2 has poles beside the way where the orbit is nearly polar. They are taken
        # out: with v = d chi / d lambda, 1 / v is 1 / l less (a^2 (1 - E^2) sin^2) / (l v (l + v)).
        once = mean(lambda chi: 1 / self._polar_speed(chi))
        speed = self._polar_speed
        rest = mean(lambda chi: 1 / (speed(chi) * (self.reduced + speed(chi))))
        turning = (math.copysign(1.0, self.x) - self._bound * self.x * rest) / once
        radial = 1 / self._mean_turn(lambda psi: 1 / self._radial_speed(psi))
        azimuthal = self._mean_radial(dragged) + turning - a * energy
        return Frequencies(radial / rate, 1 / once / rate, azimuthal / rate, time, rate)

    def _mean_radial(self, function: Callable[[np.ndarray], np.ndarray]) -> float:
        """Mean over Mino time of a function of psi."""
        weight = self._mean_turn(lambda psi: 1 / self._radial_speed(psi))
        return self._mean_turn(lambda psi: function(psi) / self._radial_speed(psi)) / weight

    def _mean_polar(self, function: Callable[[np.ndarray], np.ndarray]) -> float:
        """Mean over Mino time of a function of chi."""
        weight = mean(lambda chi: 1 / self._polar_speed(chi))
        return mean(lambda chi: function(chi) / self._polar_speed(chi)) / weight

    # -- the motion ------------------------------------------------------------------------------

    def geodesic(self, stop: object = None) -> CurveProblem:
        """The orbit as a curve in `kerr`, from its periapsis on the equator towards larger theta.

        stop: where it ends; see `gt.geodesic`.
        """
        a, r = self.a, self.radii[1]
        size = r**2 - 2 * r + a**2
        velocity = [
            (self.energy * (r**2 + a**2) - a * self.angular_momentum) / (r * math.sqrt(size)),
            0.0,
            math.sqrt(max(self.carter, 0.0)) / r,
            (self.angular_momentum - a * self.energy) / r,
        ]
        return geodesic(
            load("kerr").frame,
            [0.0, r, math.pi / 2, 0.0],
            frame_velocity=velocity,
            parameters={"M": 1.0, "a": a},
            stop=stop,
        )

    def mino(self) -> ODE:
        """The orbit in Mino time, from the same start: states psi, chi, t, phi, tau.

        r and theta are outputs; r = p / (1 + e cos(psi)), cos(theta) = sqrt(1 - x^2) cos(chi). All
        is smooth at turning points. The phi of a polar orbit does not jump at the poles.

        Examples
        --------
        >>> from geomtorsion.ode import solve
        >>> orbit = kerr_orbit(0.9, 6, 0.3, 0.5)
        >>> period = 2 * math.pi / orbit.mino_frequencies.radial
        >>> solution = solve(orbit.mino(), period)
        >>> bool(abs(solution["r"][-1] - orbit.radii[1]) < 1e-8)
        True
        """
        _, _, r3, r4 = self.radii
        z2 = (1 - self.x) * (1 + self.x)
        values = {
            "a": self.a, "p": self.p, "e": self.e, "E": self.energy, "L": self.angular_momentum,
            "r3": r3, "r4": r4, "l": self.reduced, "z2": z2,
            "scale": (1 - self.energy) * (1 + self.energy) / ((1 - self.e) * (1 + self.e)),
            "b": self._bound,
        }  # fmt: skip
        radius, height = "(p/(1 + e*cos(psi)))", "(z2*cos(chi)**2)"
        pull = f"(E*({radius}**2 + a**2) - a*L)/({radius}**2 - 2*{radius} + a**2)"
        turning = f"L/(1 - {height})" if self.x else "0"
        return ODE.of(
            {
                "psi": f"p*sqrt(scale*(1 - r3/{radius})*(1 - r4/{radius}))",
                "chi": f"sqrt(l**2 + b*(1 - {height}))",
                "t": f"({radius}**2 + a**2)*{pull} + a*L - a**2*E*(1 - {height})",
                "phi": f"a*{pull} + {turning} - a*E",
                "tau": f"{radius}**2 + a**2*{height}",
            },
            {"psi": 0, "chi": math.pi / 2, "t": 0, "phi": 0, "tau": 0},
            parameters=values,
            outputs={"r": radius, "theta": "acos(sqrt(z2)*cos(chi))"},
            time="mino",
            name="Kerr orbit in Mino time",
        )


def kerr_orbit(a: float, p: float, e: float = 0.0, x: float = 1.0) -> KerrOrbit:
    """Bound geodesic of Kerr's space by its shape; M = 1.

    Equation
    --------
    r = p / (1 + e cos(psi)), |cos(theta)| <= sqrt(1 - x^2); E, L, Q as in Schmidt (2002), from
    f E^2 - 2 g E L - h L^2 = d at both turning points

    Parameters
    ----------
    a
        spin, -1 <= a <= 1; a < 0 is read as the spin -a with -x, the same orbit against the spin.
    p, e
        semilatus rectum and eccentricity: r between p / (1 + e) and p / (1 - e); 0 <= e < 1.
    x
        cosine of the inclination: 1 in the equator, 0 over the poles, below 0 against the spin.

    Raises
    ------
    StartError
        A number is out of its range, or no such orbit is bound and stable.

    Examples
    --------
    A circular orbit at r = 10 without spin has the frequency 10^(-3/2) of Kepler:

    >>> orbit = kerr_orbit(0, 10)
    >>> round(orbit.frequencies.azimuthal * 10**1.5, 12), round(orbit.mino_frequencies.polar, 9)
    (1.0, 3.77964473)
    """
    numbers = {}
    for name, value in (("a", a), ("p", p), ("e", e), ("x", x)):
        real = checks.real(value)
        if real is None or not math.isfinite(real):
            raise StartError(f"{name}: expected a finite number, got {checks.shown(value)}.")
        numbers[name] = real
    if -1 <= numbers["a"] < 0:
        numbers |= {"a": -numbers["a"], "x": 0.0 - numbers["x"]}
    low = {"a": 0 <= numbers["a"] <= 1, "e": 0 <= numbers["e"] < 1, "x": abs(numbers["x"]) <= 1}
    low["p"] = numbers["p"] > 0
    ranges = {"a": "-1 <= a <= 1", "e": "0 <= e < 1", "x": "-1 <= x <= 1", "p": "p > 0"}
    for name, inside in low.items():
        if not inside:
            raise StartError(f"expected {ranges[name]}, got {name} = {numbers[name]:.6g}.")
    with working_precision(CONSTANT_BITS):
        constants = _constants(*(mpmath.mpf(numbers[name]) for name in "apex"))
    if constants is None:
        raise StartError(
            f"expected a stable bound orbit, got p = {numbers['p']:.6g} inside the separatrix of "
            f"a = {numbers['a']:.6g}, e = {numbers['e']:.6g}, x = {numbers['x']:.6g}. Give a "
            "larger p."
        )
    energy, turn, carter, reduced, *radii, room = (float(value) for value in constants)
    r1, r2, r3, r4 = radii
    return KerrOrbit(**numbers, energy=energy, angular_momentum=turn, carter=carter,
                     radii=(r1, r2, r3, r4), reduced=reduced, room=room)  # fmt: skip


def _constants(
    a: mpmath.mpf, p: mpmath.mpf, e: mpmath.mpf, x: mpmath.mpf
) -> tuple[mpmath.mpf, ...] | None:
    """E, L, Q, L/x and the radii; None where no orbit is bound and stable."""
    outer, inner, z2 = p / (1 - e), p / (1 + e), 1 - x * x
    # Coefficients of r^0, r^1, ...: E^2 f - 2 E l x g - l^2 h = d with l = L/x.
    f = [z2 * a**4, 2 * a * a * (1 - z2), a * a * (1 + z2), 0, 1]
    g = [0, 2 * a]
    h = [z2 * a * a, -2, 1]
    d = [z2 * a**4, -2 * z2 * a * a, a * a * (1 + z2), -2, 1]

    def value(row: Polynomial) -> mpmath.mpf:
        return mpmath.fsum(c * outer**k for k, c in enumerate(row))

    def slope(row: Polynomial) -> mpmath.mpf:
        # The divided difference between the turning points, which has a limit where they meet.
        return mpmath.fsum(
            c * outer**i * inner ** (k - 1 - i) for k, c in enumerate(row) for i in range(k)
        )

    def cross(one: Polynomial, two: Polynomial) -> mpmath.mpf:
        return value(one) * slope(two) - value(two) * slope(one)

    kappa, epsilon, rho = cross(d, h), cross(d, g), cross(f, h)
    eta, sigma = cross(f, g), cross(g, h)
    inside = sigma * (sigma * (x * epsilon) ** 2 + rho * epsilon * kappa - eta * kappa**2)
    below = rho**2 + 4 * x * x * eta * sigma
    if inside < 0 or below == 0:
        return None
    square = (kappa * rho + 2 * x * x * epsilon * sigma - 2 * x * mpmath.sqrt(inside)) / below
    if not 0 < square < 1:
        return None
    energy = mpmath.sqrt(square)
    half, rest = x * value(g) * energy, value(f) * square - value(d)
    root = half**2 + rest * value(h)
    if root < 0:
        return None
    root = mpmath.sqrt(root)
    # The form of the root in which nothing cancels.
    reduced = rest / (half + root) if half >= 0 else (root - half) / value(h)
    carter = z2 * (a * a * (1 - square) + reduced**2)
    total = 2 / (1 - square) - outer - inner
    product = a * a * carter / ((1 - square) * outer * inner)
    gap = total**2 - 4 * product
    third = (total + mpmath.sqrt(gap)) / 2 if gap >= 0 else mpmath.inf
    if not (reduced > 0 and third < inner and inner > 1 + mpmath.sqrt(1 - a * a)):
        return None
    radii = outer, inner, third, product / third
    return energy, x * reduced, carter, reduced, *radii, inner - third


def mean(function: Callable[[np.ndarray], np.ndarray], width: float = 1.0) -> float:
    """Mean of a smooth periodic function over a turn, by equal steps, doubled until it stays.

    width: below 1 the steps are equal in s, tan(angle / 2) = width tan(s / 2): closer around 0.

    Raises
    ------
    AccuracyError
        It does not stay the same for the most steps that are taken.

    Examples
    --------
    >>> round(mean(lambda angle: 1 / (1.25 + np.cos(angle))), 12)
    1.333333333333
    """
    places, before = FIRST_PLACES, math.nan
    while places <= MOST_PLACES:
        half = np.pi * np.arange(places) / places
        sine, cosine = width * np.sin(half), np.cos(half)
        weights = width / (sine**2 + cosine**2)
        average = float(np.mean(weights * function(2 * np.arctan2(sine, cosine))))
        if abs(average - before) <= CALCULATED * abs(average) / 100:
            return average
        places, before = 2 * places, average
    raise AccuracyError(
        f"expected a mean over the orbit that settles within {MOST_PLACES:,} steps, got none: the "
        "orbit hovers beside the separatrix. Give a larger p."
    )

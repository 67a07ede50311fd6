"""kerr_orbits: orbits of a rotating black hole by their shape or constants, with frequencies."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, field

import mpmath
import numpy as np
from scipy.integrate import quad

from geomtorsion.curves.constructors import geodesic
from geomtorsion.curves.problem import CurveProblem
from geomtorsion.errors import AccuracyError, StartError
from geomtorsion.ode.problem import ODE
from geomtorsion.spaces.kerr_constants import constants, inclination, radial_roots
from geomtorsion.spaces.registry import load
from geomtorsion.support import checks
from geomtorsion.support.caching import cached_property
from geomtorsion.support.precision import CALCULATED, CONSTANT_BITS, working_precision

# Places on a turn at which an average is taken first; they are doubled until it stays the same.
FIRST_PLACES = 64
# So many places serve all orbits but those that hover beside the separatrix for hundreds of turns.
MOST_PLACES = 2**20


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
    """A geodesic of Kerr's space that does not fall in, for the mass M = 1; made by `kerr_orbit`.

    It is bound for e < 1, and comes from infinity and returns there (scattering) for e >= 1.

    a: spin; p: semilatus rectum; e: eccentricity; x: cosine of the inclination.
    energy, angular_momentum, carter: E = -p_t, L = p_phi and Q of a particle of unit mass.
    radii: roots r1 >= r2 > r3 >= r4 of the radial equation; the orbit is between r2 and r1. For
        scattering r1 is negative, or infinite if e = 1, and the orbit is beyond r2.
    reduced: L / x, which is finite for polar orbits also.
    `room`: r2 - r3, which vanishes at the separatrix.
    remark: how a negative spin was read, or "".

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
    remark: str = field(default="", compare=False)

    def __repr__(self) -> str:
        kind = "bound orbit" if self.e < 1 else "scattering orbit"
        words = ", ".join(f"{name} = {getattr(self, name):.8g}" for name in "apex")
        sense = " against the spin" if self.x < 0 < self.a else ""
        return f"{kind} of Kerr{sense}: {words}{'; ' * bool(self.remark)}{self.remark}"

    def _check_bound(self, what: str) -> None:
        """Refuse a question that only a bound orbit answers."""
        if self.e >= 1:
            raise StartError(
                f"{what}: expected a bound orbit, 0 <= e < 1, got e = {self.e:.6g}, which does not "
                "return. Ask for its deflection."
            )

    @property
    def _scale(self) -> float:
        """(1 - E^2)/(1 - e^2), which has a limit at e = 1."""
        if self.e == 1:
            return 1 / self.p
        return (1 - self.energy) * (1 + self.energy) / ((1 - self.e) * (1 + self.e))

    @cached_property
    def mino_reach(self) -> float:
        """Mino time from the periapsis of a scattering orbit to infinity, which is finite.

        Raises
        ------
        StartError
            the orbit is bound.
        """
        return quad(lambda psi: 1 / float(self._radial_speed(psi)), 0, self._infinity)[0]

    @cached_property
    def deflection(self) -> float:
        """Deflection angle of a scattering orbit, in radians.

        Equation
        --------
        |Delta phi| - pi over the whole orbit; with a minus sign if x < 0, against the spin

        Raises
        ------
        StartError
            the orbit is bound, or is not in the equator of a hole with spin.

        Examples
        --------
        >>> round(kerr_orbit(0, 200, 2).deflection + math.pi - 2 * math.acos(-1 / 2), 3)
        0.083
        """
        if self.a and abs(self.x) < 1:
            raise StartError(
                f"deflection: expected an orbit in the equator, x = 1 or -1, got x = {self.x:.6g}. "
                "Follow the orbit with geodesic()."
            )
        a, energy = self.a, self.energy
        sense = 1.0 if self.x >= 0 else -1.0
        turn = sense * self.reduced

        def rate(psi: float) -> float:
            r = float(self.radius(np.asarray(psi)))
            pull = a * (energy * (r**2 + a**2) - a * turn) / (r**2 - 2 * r + a**2) if a else 0.0
            return (pull + turn - a * energy) / float(self._radial_speed(np.asarray(psi)))

        swept = 2 * quad(rate, 0, self._infinity, epsabs=0, epsrel=CALCULATED, limit=500)[0]
        return sense * (abs(swept) - math.pi)

    @property
    def _infinity(self) -> float:
        """The angle psi at which r is infinite."""
        if self.e < 1:
            raise StartError(
                f"expected a scattering orbit, e >= 1, got e = {self.e:.6g}. Ask for frequencies."
            )
        return math.acos(-1 / self.e)

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
                bound = constants(a, middle, e, x) is not None
                low, high = (low, middle) if bound else (middle, high)
        return float(high)

    def radius(self, psi: np.ndarray) -> np.ndarray:
        """r at the angle psi of the ellipse, 0 at the periapsis."""
        return self.p / (1 + self.e * np.cos(psi))

    def _radial_speed(self, psi: np.ndarray) -> np.ndarray:
        """d psi / d lambda."""
        scale, r4 = self._scale, self.radii[3]
        r = self.radius(psi)
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
        self._check_bound("frequencies")
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
        self._check_bound("frequencies")
        rate = self._mean_radial(lambda psi: self.radius(psi) ** 2)
        rate += self.a**2 * self._mean_polar(self._height)
        return self._frequencies("tau", rate)

    def _frequencies(self, time: str, rate: float) -> Frequencies:
        """The frequencies of Mino time, per unit of another time."""
        self._check_bound("frequencies")
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
            "scale": self._scale,
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
    """Bound or scattering geodesic of Kerr's space by its shape; M = 1.

    Equation
    --------
    r = p / (1 + e cos(psi)), |cos(theta)| <= sqrt(1 - x^2); E, L, Q as in Schmidt (2002), from
    f E^2 - 2 g E L - h L^2 = d at both turning points

    Parameters
    ----------
    a
        spin, -1 <= a <= 1; a < 0 is read as the spin -a with -x, the same orbit against the spin.
    p, e
        semilatus rectum and eccentricity: r between p / (1 + e) and p / (1 - e). With e >= 1 the
        orbit comes from infinity, is next to the hole at p / (1 + e), and returns to infinity.
    x
        cosine of the inclination: 1 in the equator, 0 over the poles, below 0 against the spin.

    Raises
    ------
    StartError
        A number is out of its range, or such an orbit would fall into the hole.

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
    remark = ""
    if -1 <= numbers["a"] < 0:
        remark = f"a = {numbers['a']:.8g} was read as the spin {-numbers['a']:.8g} with x reversed"
        numbers |= {"a": -numbers["a"], "x": 0.0 - numbers["x"]}
    low = {"a": 0 <= numbers["a"] <= 1, "e": numbers["e"] >= 0, "x": abs(numbers["x"]) <= 1}
    low["p"] = numbers["p"] > 0
    ranges = {"a": "-1 <= a <= 1", "e": "e >= 0", "x": "-1 <= x <= 1", "p": "p > 0"}
    for name, inside in low.items():
        if not inside:
            raise StartError(f"expected {ranges[name]}, got {name} = {numbers[name]:.6g}.")
    with working_precision(CONSTANT_BITS):
        a, p, e, x = (mpmath.mpf(numbers[name]) for name in "apex")
        return _orbit(a, p, e, x, remark)


def _orbit(a: mpmath.mpf, p: mpmath.mpf, e: mpmath.mpf, x: mpmath.mpf, remark: str) -> KerrOrbit:
    """The orbit of a shape with many digits."""
    values = constants(a, p, e, x)
    shape = {name: float(value) for name, value in zip("apex", (a, p, e, x), strict=True)}
    if values is None:
        kind = "stable bound orbit" if shape["e"] < 1 else "scattering orbit"
        raise StartError(
            f"expected a {kind}, got p = {shape['p']:.6g} inside the separatrix of "
            f"a = {shape['a']:.6g}, e = {shape['e']:.6g}, x = {shape['x']:.6g}. Give a larger p, "
            "or the constants of a fall to kerr_plunge."
        )
    energy, turn, carter, reduced, r1, r2, r3, r4, room = (float(value) for value in values)
    return KerrOrbit(**shape, energy=energy, angular_momentum=turn, carter=carter,
                     radii=(r1, r2, r3, r4), reduced=reduced, room=room, remark=remark)  # fmt: skip


def kerr_orbit_of(
    a: float, energy: float, angular_momentum: float, carter: float = 0.0
) -> KerrOrbit:
    """Bound or scattering geodesic of Kerr's space by its constants; M = 1.

    Parameters
    ----------
    a
        spin, -1 <= a <= 1; a < 0 is read as the spin -a with -L.
    energy, angular_momentum, carter
        E = -p_t > 0, L = p_phi and Q >= 0 of a particle of unit mass; E >= 1 for scattering.

    Raises
    ------
    StartError
        A number is out of its range, or the particle falls into the hole; see `kerr_plunge`.

    Examples
    --------
    >>> orbit = kerr_orbit(0.9, 6, 0.3, 0.5)
    >>> other = kerr_orbit_of(0.9, orbit.energy, orbit.angular_momentum, orbit.carter)
    >>> round(other.p, 9), round(other.e, 9), round(other.x, 9)
    (6.0, 0.3, 0.5)
    """
    with working_precision(CONSTANT_BITS):
        *numbers, remark = exact_constants(a, energy, angular_momentum, carter)
        roots, horizon = radial_roots(*numbers), 1 + mpmath.sqrt(1 - numbers[0] ** 2)
        outside = [x for x in roots if x > horizon]
        needed = 1 if numbers[1] >= 1 else 2
        if len(outside) < needed:
            raise StartError(
                f"expected a particle that turns outside of the horizon r = {float(horizon):.6g}, "
                f"got one that falls in, with E = {float(numbers[1]):.8g}, L = "
                f"{float(numbers[2]):.8g}, Q = {float(numbers[3]):.8g}. Give other constants, or "
                "ask kerr_plunge for the fall."
            )
        inner = outside[needed - 1]
        if numbers[1] == 1:
            e, p = mpmath.mpf(1), 2 * inner
        else:
            outer = roots[-1] if numbers[1] > 1 else outside[0]
            e, p = (outer - inner) / (outer + inner), 2 * outer * inner / (outer + inner)
        return _orbit(numbers[0], p, e, inclination(*numbers), remark)


def exact_constants(
    a: float, energy: float, angular_momentum: float, carter: float
) -> tuple[mpmath.mpf, mpmath.mpf, mpmath.mpf, mpmath.mpf, str]:
    """Constants with many digits, checked, for a spin that is not negative; and how it was read."""
    names = ("a", "energy", "angular_momentum", "carter")
    numbers = [
        checks.number(value, name, StartError)
        for name, value in zip(names, (a, energy, angular_momentum, carter), strict=True)
    ]
    spin, E, L, Q = numbers
    for name, inside, wanted in (
        ("a", abs(spin) <= 1, "-1 <= a <= 1"), ("energy", E > 0, "energy > 0"),
        ("carter", Q >= 0, "carter >= 0, an orbit that crosses the equator"),
    ):  # fmt: skip
        if not inside:
            raise StartError(f"expected {wanted}, got {name} = {numbers[names.index(name)]:.6g}.")
    remark = ""
    if spin < 0:
        remark = f"a = {spin:.8g} was read as the spin {-spin:.8g} with L reversed"
        spin, L = -spin, -L
    return mpmath.mpf(spin), mpmath.mpf(E), mpmath.mpf(L), mpmath.mpf(Q), remark


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

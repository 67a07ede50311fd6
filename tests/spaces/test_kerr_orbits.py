"""Kerr orbits: constants and frequencies agree with published values and long integrations."""

import math
from typing import Any

import mpmath
import numpy as np
import pytest

import geomtorsion as gt
from geomtorsion.errors import StartError
from tests.rounding import ROUNDED

# KerrGeodesics (Black Hole Perturbation Toolkit), KerrGeoConstantsOfMotion and KerrGeoFrequencies.
PUBLISHED_CONSTANTS = (0.95426997475311240549, 1.79647169810973255845, 9.73622324161324995960)
PUBLISHED_FREQUENCIES = (0.037645648405229756, 0.05262560724893245, 0.05816122061091471)
ORBITS = [(0.9, 6, 0.3, 0.5), (0.998, 2.5, 0.4, 0.9), (0.5, 10, 0.6, -0.7), (0.0, 9, 0.2, 0.4)]


def test_published_constants():
    """E, L and Q of a = 0.9, p = 10, e = 0.1 at 60 degrees, to the last digit of a double."""
    orbit = gt.spaces.kerr_orbit(0.9, 10, 0.1, math.cos(math.pi / 3))
    found = (orbit.energy, orbit.angular_momentum, orbit.carter)
    assert found == pytest.approx(PUBLISHED_CONSTANTS, rel=ROUNDED)


def test_published_frequencies():
    """Omega of a = 0.9, p = 6, e = 0.3 in the equator."""
    found = gt.spaces.kerr_orbit(0.9, 6, 0.3, 1).frequencies
    assert (found.radial, found.polar, found.azimuthal) == pytest.approx(
        PUBLISHED_FREQUENCIES, rel=ROUNDED
    )


@pytest.mark.parametrize("r", [6.5, 10, 1e3, 1e6])
@pytest.mark.parametrize("x", [1, 0.3, 0, -1])
def test_circles_without_spin(r, x):
    """Omega = r^(-3/2), radial r^-2 sqrt(r - 6): Schwarzschild's, at any inclination."""
    orbit = gt.spaces.kerr_orbit(0, r, 0, x)
    found = orbit.frequencies
    assert found.radial == pytest.approx(math.sqrt(r - 6) / r**2, rel=ROUNDED)
    assert found.polar == pytest.approx(r**-1.5, rel=ROUNDED)
    assert found.azimuthal == pytest.approx((1 if x >= 0 else -1) * r**-1.5, rel=ROUNDED)
    assert orbit.energy == pytest.approx((1 - 2 / r) / math.sqrt(1 - 3 / r), rel=ROUNDED)


@pytest.mark.parametrize("sense", [1, -1])
@pytest.mark.parametrize("a", [0.3, 0.95])
def test_circles_in_the_equator(a, sense):
    """Omega = +-1 / (r^(3/2) +- a) [Bardeen, Press, Teukolsky 1972]; both senses."""
    found = gt.spaces.kerr_orbit(a, 12, 0, sense).frequencies
    assert found.azimuthal == pytest.approx(sense / (12**1.5 + sense * a), rel=ROUNDED)
    radial = 1 - 6 / 12 + sense * 8 * a / 12**1.5 - 3 * a**2 / 144
    assert found.radial == pytest.approx(abs(found.azimuthal) * math.sqrt(radial), rel=1e-13)


@pytest.mark.parametrize("shape", ORBITS)
def test_the_orbit_in_mino_time_is_the_geodesic(shape):
    """The curve of gt.geodesic, solved in proper time, agrees with Mino's equations."""
    orbit = gt.spaces.kerr_orbit(*shape)
    mino = gt.solve(orbit.mino(), 3 * 2 * math.pi / orbit.mino_frequencies.radial)
    curve = gt.solve(orbit.geodesic(), float(mino["tau"][-1]))
    expected = [float(mino[name][-1]) for name in ("t", "r", "theta", "phi")]
    turns = 2 * math.pi * round((expected[3] - curve.coordinates[-1, 3]) / (2 * math.pi))
    assert curve.coordinates[-1] + [0, 0, 0, turns] == pytest.approx(expected, rel=1e-7)
    assert mino["r"][-1] == pytest.approx(orbit.radii[1], rel=1e-8)
    # The curve has the largest and the smallest radius of the shape.
    r = curve.at(np.linspace(0, curve.times[-1], 4001)).coordinates[:, 1]
    p, e = shape[1:3]
    assert (r.min(), r.max()) == pytest.approx((p / (1 + e), p / (1 - e)), rel=1e-5)


@pytest.mark.parametrize("shape", ORBITS)
def test_frequencies_of_a_long_integration(shape):
    """Means over a few hundred radial periods agree as well as their length allows."""
    orbit = gt.spaces.kerr_orbit(*shape)
    slow, fast = orbit.mino_frequencies, orbit.frequencies
    turns = 300
    end = turns * 2 * math.pi / slow.radial
    solution = gt.solve(orbit.mino(), [end], accuracy=1e-9)
    last = {name: float(solution[name][-1]) for name in ("psi", "chi", "t", "phi", "tau")}
    assert last["psi"] == pytest.approx(2 * math.pi * turns, rel=1e-8)
    near = 1 / turns
    assert (last["chi"] - math.pi / 2) / end == pytest.approx(slow.polar, rel=near)
    assert last["phi"] / end == pytest.approx(slow.azimuthal, rel=near)
    assert last["t"] / end == pytest.approx(fast.rate, rel=near)
    assert last["tau"] / end == pytest.approx(orbit.proper_frequencies.rate, rel=near)
    assert fast.azimuthal == pytest.approx(slow.azimuthal / fast.rate, rel=ROUNDED)


def test_through_the_equator_and_over_the_poles():
    """Frequencies are smooth where orbits become circular, polar or equatorial."""
    for shape, beside in [
        ((0.9, 6, 0, 0.5), (0.9, 6, 1e-9, 0.5)),
        ((0.9, 6, 0.3, 0), (0.9, 6, 0.3, 1e-10)),
        ((0.9, 6, 0.3, 1), (0.9, 6, 0.3, 1 - 1e-15)),
        ((0, 9, 0.2, 0.4), (1e-12, 9, 0.2, 0.4)),
    ]:
        one, two = (gt.spaces.kerr_orbit(*x).frequencies for x in (shape, beside))
        for name in ("radial", "polar", "azimuthal"):
            assert getattr(one, name) == pytest.approx(getattr(two, name), rel=1e-8)


@pytest.mark.parametrize("distance", [1.0, 1e-6, 1e-10])
def test_frequency_beside_the_separatrix(distance):
    """Without spin the radial frequency is an elliptic integral, down to p = 6 + 2 e."""
    p, e = 6.6 + distance, 0.3
    with mpmath.workdps(40):
        p_exact, e_exact = mpmath.mpf(p), mpmath.mpf(e)
        square = ((p_exact - 2) ** 2 - 4 * e_exact**2) / (p_exact * (p_exact - 3 - e_exact**2))
        r1, r2 = p_exact / (1 - e_exact), p_exact / (1 + e_exact)
        r3 = 2 / (1 - square) - r1 - r2
        modulus = (r1 - r2) * r3 / ((r1 - r3) * r2)
        speed = mpmath.sqrt((1 - square) * (r1 - r3) * r2)
        exact = float(mpmath.pi * speed / (2 * mpmath.ellipk(modulus)))
    assert gt.spaces.kerr_orbit(0, p, e).mino_frequencies.radial == pytest.approx(exact, rel=1e-12)


@pytest.mark.parametrize("x", [1, 0.3, 0, -1])
@pytest.mark.parametrize("e", [0, 0.3, 0.9])
def test_separatrix_without_spin(e, x):
    """p = 6 + 2 e at any inclination."""
    assert gt.spaces.kerr_orbit(0, 20, e, x).separatrix == pytest.approx(6 + 2 * e, rel=ROUNDED)


@pytest.mark.parametrize("sense", [1, -1])
@pytest.mark.parametrize("e", [0.0, 0.3, 0.9])
@pytest.mark.parametrize("a", [1e-3, 0.5, 0.95])
def test_separatrix_in_the_equator(a, e, sense):
    """The polynomial of degree four in p; for circles the radius of Bardeen, Press, Teukolsky."""
    orbit = gt.spaces.kerr_orbit(a, 20, e, sense)
    with mpmath.workdps(40):
        p, spin, shape = mpmath.mpf(orbit.separatrix), mpmath.mpf(a), mpmath.mpf(e)
        plain = spin**2 * (3 - shape) * (1 + shape) + p * (6 + 2 * shape - p)
        mixed = 14 + 2 * shape**2 + (3 - shape) * p
        cross = 2 * spin**2 * (1 + shape) * p
        # The terms of a^4 and p^2 (p - 6 - 2 e)^2 as a square: its cross term is taken back.
        both = cross * mixed + cross * (3 - shape) * (6 + 2 * shape - p)
        # The root of each side has the sign of the sense.
        gap = plain + sense * -mpmath.sqrt(both)
        slope = mpmath.fabs(6 + 2 * shape - 2 * p) + mpmath.sqrt(both) / p
        assert abs(gap) <= ROUNDED * slope * p
    for side, bound in ((1 + 1e-9, True), (1 - 1e-9, False)):
        if bound:
            assert gt.spaces.kerr_orbit(a, orbit.separatrix * side, e, sense).energy < 1
        else:
            with pytest.raises(StartError, match="inside the separatrix"):
                gt.spaces.kerr_orbit(a, orbit.separatrix * side, e, sense)


def test_a_negative_spin_turns_the_sense():
    """a < 0 is the orbit of -a against the spin."""
    assert gt.spaces.kerr_orbit(-0.9, 12, 0.2, 0.5) == gt.spaces.kerr_orbit(0.9, 12, 0.2, -0.5)
    polar = [gt.spaces.kerr_orbit(a, 12, 0.2, 0).frequencies.azimuthal for a in (-0.9, 0.9)]
    assert polar[0] == polar[1]


def test_constants_agree_with_the_curve():
    """E, L and Carter's constant agree with the frame velocities of the geodesic."""
    orbit = gt.spaces.kerr_orbit(0.9, 6, 0.3, 0.5)
    a, r = orbit.a, orbit.radii[1]
    u = orbit.geodesic().frame_velocity
    assert -(u[0] ** 2) + u[1] ** 2 + u[2] ** 2 + u[3] ** 2 == pytest.approx(-1, abs=ROUNDED)
    shifted = orbit.carter + (orbit.angular_momentum - a * orbit.energy) ** 2
    assert r**2 * (u[2] ** 2 + u[3] ** 2) == pytest.approx(shifted, rel=ROUNDED)


# -- scattering, constants and falls ---------------------------------------------------------------

MUCH: Any = "much"
SCATTERING = [(0, 12, 2, 1), (0, 10, 1, 0.3), (0.9, 8, 1, 1), (0.9, 8, 1.5, 1),
              (0.9, 16, 1.5, -1), (0.9, 8, 1.5, 0.4),
              (0.9, 25, 3, -0.4), (0.9, 8, 1.5, 0), (0.5, 50, 1, 0.2)]  # fmt: skip


@pytest.mark.parametrize("shape", SCATTERING)
def test_scattering_turns_at_the_periapsis(shape):
    """R(r) vanishes at p/(1 + e) and p/(1 - e); without spin E and L as of bound orbits."""
    orbit = gt.spaces.kerr_orbit(*shape)
    a, p, e, x = shape
    E, L, Q = orbit.energy, orbit.angular_momentum, orbit.carter
    for u in ((1 + e) / p, (1 - e) / p):
        # R/r^4 at 1/r = u, which is regular at infinity.
        terms = [
            E**2 - 1, 2 * u, (a**2 * (E**2 - 1) - L**2 - Q) * u**2,
            2 * ((L - a * E) ** 2 + Q) * u**3, -(a**2) * Q * u**4,
        ]  # fmt: skip
        assert abs(sum(terms)) <= 100 * ROUNDED * sum(map(abs, terms))
    z2 = 1 - x**2
    bound = a**2 * (1 - E**2)
    assert z2 * (Q + L**2 + bound - z2 * bound) == pytest.approx(Q, rel=1e-12)
    assert (E > 1) == (e > 1)
    assert orbit.radii[1] == pytest.approx(p / (1 + e), rel=ROUNDED)
    if a == 0:
        assert pytest.approx(p**2 / (p - 3 - e**2), rel=1e-12) == L**2 + Q


@pytest.mark.parametrize(("p", "e"), [(12, 2.0), (10, 1.0), (9, 1.2), (1e4, 3.0)])
def test_deflection_without_spin(p, e):
    """An elliptic integral (Cutler, Kennefick, Poisson 1994)."""
    with mpmath.workdps(30):
        modulus = 4 * mpmath.mpf(e) / (p - 6 + 2 * mpmath.mpf(e))
        angle = (mpmath.pi - mpmath.acos(-1 / mpmath.mpf(e))) / 2
        part = mpmath.ellipk(modulus) - mpmath.ellipf(angle, modulus)
        exact = 4 * mpmath.sqrt(p / (p - 6 + 2 * mpmath.mpf(e))) * part - mpmath.pi
    for x in (1, -1, 0.3):
        found = gt.spaces.kerr_orbit(0, p, e, x).deflection
        assert (found if x > 0 else -found) == pytest.approx(float(exact), rel=1e-10)


@pytest.mark.parametrize("shape", [(0.9, 8, 1.5, 1), (0.9, 16, 1.5, -1)])
def test_deflection_of_the_geodesic(shape):
    """The curve, followed far away, turns by the same angle less M/r."""
    orbit = gt.spaces.kerr_orbit(*shape)
    curve = gt.solve(orbit.geodesic(stop="1e7 - r"), 1e8)
    swept = 2 * abs(float(curve.coordinates[-1, 3])) - math.pi
    assert swept == pytest.approx(abs(orbit.deflection), abs=1e-4)
    mino = gt.solve(orbit.mino(), orbit.mino_reach * (1 - 1e-6))
    assert float(mino["r"][-1]) > 1e4


@pytest.mark.parametrize("shape", [*ORBITS, *SCATTERING])
def test_an_orbit_by_its_constants(shape):
    """The constants lead back to the shape."""
    orbit = gt.spaces.kerr_orbit(*shape)
    constants = orbit.energy, orbit.angular_momentum, orbit.carter
    other = gt.spaces.kerr_orbit_of(shape[0], *constants)
    # Beside the separatrix shapes are more sensitive than this by the inverse of the gap.
    assert [other.p, other.e, other.x] == pytest.approx(list(shape[1:]), rel=1e-9, abs=1e-9)
    assert other.energy == pytest.approx(orbit.energy, rel=1e-10)


def test_falls_without_spin():
    """The proper times of a fall from rest at r = 10, and from rest at infinity."""
    cycloid = gt.spaces.kerr_plunge(0, math.sqrt(0.8))
    assert cycloid.highest == pytest.approx(10, rel=ROUNDED)
    angle = math.acos(2 * 4 / 10 - 1)
    time = gt.solve(cycloid.geodesic(stop="r - 4"), 100).times[-1]
    # A start at rest that is rounded changes the time by the root of the rounding of its energy.
    assert float(time) == pytest.approx(math.sqrt(1000 / 8) * (angle + math.sin(angle)), rel=1e-8)
    parabola = gt.spaces.kerr_plunge(0, 1)
    assert parabola.highest == math.inf
    time = gt.solve(parabola.geodesic(8, stop="r - 4"), 100).times[-1]
    assert float(time) == pytest.approx(2 / 3 * (8**1.5 - 8) / math.sqrt(2), rel=1e-10)


def test_a_fall_with_spin_conserves_its_constants():
    """To the horizon, inclined; and the fall that has the constants of a bound orbit."""
    fall = gt.spaces.kerr_plunge(0.9, 0.95, 0.5, 1.0)
    curve = gt.solve(fall.geodesic(8), 100)
    assert curve.outcome == "stopped"
    assert curve.drift
    assert max(curve.drift.values()) < 1e-7
    orbit = gt.spaces.kerr_orbit(0.9, 6, 0.3, 0.5)
    other = gt.spaces.kerr_plunge(0.9, orbit.energy, orbit.angular_momentum, orbit.carter)
    assert other.highest == pytest.approx(orbit.radii[2], rel=1e-9)


def test_the_text_names_a_negative_spin():
    """The text of the orbit names the change; otherwise there is none."""
    assert "a = -0.9 was read as the spin 0.9 with x reversed" in repr(
        gt.spaces.kerr_orbit(-0.9, 12, 0.2, 0.5)
    )
    assert "L reversed" in repr(gt.spaces.kerr_orbit_of(-0.9, 1.1, 9))
    assert "was read" not in repr(gt.spaces.kerr_orbit(0.9, 12, 0.2, 0.5))


@pytest.mark.parametrize(
    ("call", "words"),
    [
        (lambda: gt.spaces.kerr_orbit(0, 9.9, 2), "a scattering orbit, got p = 9.9 inside"),
        (lambda: gt.spaces.kerr_orbit(0.9, 6, 1.2).frequencies, "expected a bound orbit"),
        (lambda: gt.spaces.kerr_orbit(0.9, 6, 1.2).mino_frequencies, "expected a bound orbit"),
        (lambda: gt.spaces.kerr_orbit(0.9, 6, 0.2).deflection, "expected a scattering orbit"),
        (lambda: gt.spaces.kerr_orbit(0.9, 8, 1.5, 0.4).deflection, "in the equator"),
        (lambda: gt.spaces.kerr_orbit_of(0.9, 0.95, 0.5), "one that falls in"),
        (lambda: gt.spaces.kerr_orbit_of(0.9, -1, 3), "energy > 0"),
        (lambda: gt.spaces.kerr_orbit_of(2, 0.95, 3), "-1 <= a <= 1"),
        (lambda: gt.spaces.kerr_orbit_of(0.9, 0.95, 3, -1), "carter >= 0"),
        (lambda: gt.spaces.kerr_orbit_of(0.9, MUCH, 3), "energy: expected a number"),
        (lambda: gt.spaces.kerr_plunge(0, 1).geodesic(), "comes from infinity"),
        (lambda: gt.spaces.kerr_plunge(0, 1).geodesic(1), "radius"),
    ],
)
def test_refusals_of_scattering_and_falls(call, words):
    """Each error names the expected value and a remedy."""
    with pytest.raises(StartError, match=words):
        call()


@pytest.mark.parametrize(
    ("shape", "words"),
    [
        ((0.9, 2, 0.3, 1), "stable bound orbit, got p = 2 inside the separatrix"),
        ((0, 6.99, 0.5, 1), "inside the separatrix"),
        ((0.9, 8, 0.2, -1), "inside the separatrix"),
        ((1.2, 6, 0, 1), "-1 <= a <= 1, got a = 1.2"),
        ((-1.2, 6, 0, 1), "-1 <= a <= 1, got a = -1.2"),
        ((-0.9, 8, 0.2, 1), "inside the separatrix"),
        ((0.9, 6, -0.1, 1), "e >= 0"),
        ((0.9, 6, 0.1, 1.1), "-1 <= x <= 1"),
        ((0.9, -6, 0.1, 1), "p > 0"),
        ((0.9, "six", 0.1, 1), "p: expected a finite number"),
        ((float("nan"), 6, 0.1, 1), "a: expected a finite number"),
    ],
)
def test_refusals(shape, words):
    """Shapes without a stable bound orbit are refused."""
    with pytest.raises(StartError, match=words):
        gt.spaces.kerr_orbit(*shape)
    assert gt.spaces.kerr_orbit(0, 7.01, 0.5, 1).energy < 1

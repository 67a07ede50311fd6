"""Kerr orbits: constants and frequencies agree with published values and long integrations."""

import math

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


@pytest.mark.parametrize(
    ("shape", "words"),
    [
        ((0.9, 2, 0.3, 1), "stable bound orbit, got p = 2 inside the separatrix"),
        ((0, 6.99, 0.5, 1), "inside the separatrix"),
        ((0.9, 8, 0.2, -1), "inside the separatrix"),
        ((1.2, 6, 0, 1), "-1 <= a <= 1, got a = 1.2"),
        ((-1.2, 6, 0, 1), "-1 <= a <= 1, got a = -1.2"),
        ((-0.9, 8, 0.2, 1), "inside the separatrix"),
        ((0.9, 6, 1, 1), "0 <= e < 1"),
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

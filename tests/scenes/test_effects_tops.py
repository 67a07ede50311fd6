"""Whole scenes agree with classical results: tops, a missile, a rolling disc and ball."""

import math

import mpmath
import numpy as np
import pytest

from geomtorsion.errors import SceneError
from geomtorsion.scenes import Body, Scene, State, effects
from tests.chosen import one_in
from tests.scenes.missile_truth import missile

E = effects
G = 9.81


def run(body, acting, watch, t, accuracy=1e-12, **start):
    return Scene(body, acting, State(**start), watch, t, accuracy=accuracy, samples=101).run()


def test_a_missile_agrees_with_thirty_digits():
    """Thrust fixed to the body and off its axis, burning from 0.5 to 2.25, spin-stabilised."""
    mass, moments = 12.0, (3.0, 2.7, 0.4)
    force, point = (0.0, 1.5, 80.0), (0.0, 0.01, -1.2)
    omega, quaternion, velocity = (0.1, 0.0, 15.0), (0.5, 0.5, 0.5, 0.5), (20.0, 0.0, 5.0)
    spans = [(0.5, False), (1.75, True), (0.75, False)]
    truth = missile(mass, moments, force, point, (*omega, *quaternion, *velocity, 0, 0, 0), spans)
    result = run(
        Body(mass, moments), [E.Thrust(force, point, start=0.5, end=2.25)],
        ["omega", "quaternion", "velocity", "position"], [0.0, 3.0],
        omega=omega, quaternion=quaternion, velocity=velocity,
    )  # fmt: skip
    names = ("omega", "quaternion", "velocity", "position")
    found = np.concatenate([result[name][-1] for name in names])
    exact = np.array([float(x) for x in truth])
    for part in (slice(0, 3), slice(3, 7), slice(7, 10), slice(10, 13)):
        size = np.linalg.norm(exact[part])
        assert abs(found[part] - exact[part]).max() < 1e-11 * size


def test_spin_keeps_a_missile_straight():
    """The paper's remark: the same thrust off its axis, with and without spin."""
    body = Body(12.0, (3.0, 3.0, 0.4))
    push = E.Thrust((0, 0, 80.0), point=(0, 0.01, -1.2))
    apart = []
    for spin in (0.0, 60.0):
        result = run(
            body, [push], ["nutation"], 6, 1e-10, omega=(0, 0, spin), quaternion=(1, 0, 0, 0)
        )
        apart.append(result["nutation"].max())
    assert apart[0] > 2
    # Torque / (spin C) gives the deflection of the axis, which is at most doubled in one turn.
    assert apart[1] < 2.2 * 0.8 * 3.0 / (0.4 * 60) ** 2


@pytest.mark.parametrize(
    ("spin", "precession"), [(40.0, 0.0), (40.0, 3.0), (25.0, -1.0)], ids=["cusp", "wave", "loop"]
)
def test_lagranges_top_turns_at_roots_of_the_cubic(spin, precession):
    """Turning points and precession per nutation from (1-u^2)(a - b u) - (c - d u)^2."""
    mass, height, a, c, tilt = 0.5, 0.1, 0.006, 0.002, 0.6
    about = a - mass * height**2  # the body's own moments are about its centre
    u0 = math.cos(tilt)
    # Omega from the angles' rates: phi2' = 0 at the start.
    omega = (-precession * math.sin(tilt), 0.0, spin)
    with mpmath.workdps(30):
        m, h, i1, i3 = map(mpmath.mpf, (mass, height, a, c))
        u0, rate, w3 = map(mpmath.mpf, (u0, precession, spin))
        d = i3 * w3 / i1
        beta = 2 * m * mpmath.mpf(G) * h / i1
        b = d * u0 + rate * (1 - u0**2)
        alpha = rate**2 * (1 - u0**2) + beta * u0
        # (1 - u^2)(alpha - beta u) - (b - d u)^2 as a cubic in u.
        roots = mpmath.polyroots(
            [beta, -alpha - d**2, 2 * b * d - beta, alpha - b**2], maxsteps=200, extraprec=200
        )
        low, high, third = sorted(mpmath.re(x) for x in roots)
        assert -1 < low < high < 1 < third

        # u between low and high: u = low + (high - low) sin^2 s removes both end points.
        def period(s):
            return 2 / mpmath.sqrt(beta * (third - low - (high - low) * mpmath.sin(s) ** 2))

        def turning(s):
            u = low + (high - low) * mpmath.sin(s) ** 2
            return period(s) * (b - d * u) / (1 - u**2)

        half = mpmath.quad(period, [0, mpmath.pi / 2])
        advance = 2 * mpmath.quad(turning, [0, mpmath.pi / 2])
    result = run(
        Body(mass, (about, about, c)), [E.Gravity(G), E.Pivot((0, 0, height))],
        ["nutation", "precession"], [0.0, float(half), float(2 * half)],
        omega=omega, euler=(0, tilt, 0),
    )  # fmt: skip
    other = mpmath.acos(low if abs(u0 - high) < 1e-12 else high)
    # At a turning point cos(nutation) is flat in time, but not the angle's error: 1e-11.
    assert result["nutation"][1] == pytest.approx(float(other), abs=1e-11)
    assert result["nutation"][2] == pytest.approx(tilt, abs=1e-11)
    turned = result["precession"][2] - result["precession"][0]
    lost = (turned - float(advance)) / (2 * math.pi)
    assert abs(lost - round(lost)) < 1e-11


def test_kovalevskayas_integral_stays():
    """A = B = 2 C, centre of mass across the axis: |(W1 + i W2)^2 - c (n1 + i n2)|^2."""
    mass, arm, c = 1.0, 0.3, 0.25
    body = Body(mass, (2 * c, 2 * c, c))
    result = run(
        body, [E.Gravity(G), E.Pivot((arm, 0, 0), moments_at="pivot")],
        ["omega", "vertical", "energy"], 10, omega=(1.0, 2.0, 3.0), euler=(0.3, 1.0, 0.2),
    )  # fmt: skip
    strength = mass * G * arm / c
    w, n = result["omega"], result["vertical"]
    kept = abs((w[:, 0] + 1j * w[:, 1]) ** 2 - strength * (n[:, 0] + 1j * n[:, 1])) ** 2
    assert abs(kept / kept[0] - 1).max() < 1e-10
    assert np.ptp(n[:, 2]) > 0.5


# A disc and a hoop.
@pytest.mark.parametrize(
    ("steady", "thickness"), one_in(2, [(0.4, 2.0), (1.1, -3.0), (1.4, 0.7)], [1.0, 2.0])
)
def test_a_disc_rolls_steadily_in_circles(steady, thickness):
    """A P^2 s c - (C + m r^2) W3 P s - m g r c = 0: constant tilt, and a circle of the centre."""
    (tilt, precession), m, r = steady, 1.5, 0.4
    big, small = thickness * m * r**2 / 2, thickness * m * r**2 / 4
    s, c = math.sin(tilt), math.cos(tilt)
    spin = (small * precession**2 * s * c - m * G * r * c) / ((big + m * r**2) * precession * s)
    result = run(
        Body(m, (small, small, big)), [E.Rolling(r), E.Gravity(G)],
        ["nutation", "position", "contact", "energy"], 3,
        omega=(-precession * s, 0, spin), euler=(0, tilt, 0), position=(0, 0, r * s),
    )  # fmt: skip
    assert abs(result["nutation"] - tilt).max() < 1e-9
    place = result["position"]
    assert abs(place[:, 2] - r * s).max() < 1e-9
    radius = abs(r * spin / precession)
    # The centre starts across the line of nodes and moves around a point beside it.
    angle = precession * result.times
    start = place[0, :2]
    centre_direction = np.array([1.0, 0.0])
    for sign in (1, -1):
        middle = start + sign * radius * centre_direction
        if np.ptp(np.linalg.norm(place[:, :2] - middle, axis=1)) < 1e-8:
            break
    else:
        pytest.fail("the centre does not go in a circle of this radius")
    turn = np.unwrap(np.arctan2(*(place[:, :2] - middle).T[::-1]))
    assert abs(turn - turn[0] - angle).max() < 1e-8
    assert np.ptp(result["energy"]) < 1e-9 * abs(result["energy"][0])
    assert result["contact"].shape == (101, 2)


@pytest.mark.parametrize(("factor", "grows"), [(0.97, True), (1.03, False)])
def test_a_disc_rolls_upright_if_it_is_fast_enough(factor, grows):
    """Straight ahead, rolling is stable above W^2 = A m g r / (C (C + m r^2)) = g / 3r."""
    m, r = 1.5, 0.4
    limit = math.sqrt(G / (3 * r))
    tilt = math.pi / 2 - 1e-4
    result = run(
        Body(m, (m * r**2 / 4, m * r**2 / 4, m * r**2 / 2)), [E.Rolling(r), E.Gravity(G)],
        ["nutation"], 12, 1e-10, omega=(0, 0, factor * limit), euler=(0, tilt, 0),
    )  # fmt: skip
    apart = abs(result["nutation"] - math.pi / 2).max()
    assert (apart > 1e-2) == grows
    assert grows or apart < 5e-3


def test_a_ball_rolls_straight_on():
    """The centre of a homogeneous ball keeps its velocity, whatever its spin."""
    m, r = 2.0, 0.3
    body = Body(m, (0.4 * m * r**2,) * 3)
    result = run(
        body, [E.Rolling(r, "ball"), E.Gravity(G)], ["position", "omega_space"], 4,
        omega=(3, -2, 5), euler=(0.1, 0.5, 0.2), position=(0, 0, r),
    )  # fmt: skip
    spin = result["omega_space"]
    assert abs(spin - spin[0]).max() < 1e-10
    # v = Omega x r e_z
    exact = r * np.transpose([spin[:, 1], -spin[:, 0], 0 * spin[:, 0]]) * result.times[:, None]
    assert abs(result["position"] - [0, 0, r] - exact).max() < 1e-10


@pytest.mark.parametrize(
    ("shape", "height"),
    [("disc", lambda nutation: 0.3 * np.sin(nutation)), ("ball", lambda nutation: 0.3)],
)
def test_what_rolls_is_as_high_as_it_leans(shape, height):
    """Without a position the plane is z = 0; a start with another height is refused."""
    body, acting = Body(2.0, (0.05, 0.08, 0.11)), [E.Rolling(0.3, shape), E.Gravity(G)]
    start = {"omega": (0.5, 1, 6), "euler": (0.1, 1.0, 0.2)}
    result = run(body, acting, ["position", "nutation"], 1, **start)
    assert abs(result["position"][:, 2] - height(result["nutation"])).max() < 1e-12
    with pytest.raises(SceneError, match="start: expected position = .* Omit position"):
        run(body, acting, ["nutation"], 1, position=(0, 0, 9), **start)


def test_chaplygins_ball_keeps_its_momentum_about_the_contact():
    """K = I Omega + m r^2 n x (Omega x n) is constant in space, for unequal moments."""
    m, r, moments = 2.0, 0.3, (0.05, 0.08, 0.11)
    result = run(
        Body(m, moments), [E.Rolling(r, "ball")], ["omega", "vertical", "matrix", "energy"], 5,
        omega=(3, -2, 5), euler=(0.1, 0.5, 0.2),
    )  # fmt: skip
    w, n = result["omega"], result["vertical"]
    kept = w * moments + m * r**2 * np.cross(n, np.cross(w, n))
    space = np.einsum("tij,tj->ti", result["matrix"].reshape(-1, 3, 3), kept)
    assert abs(space - space[0]).max() < 1e-10 * np.linalg.norm(space[0])
    assert np.ptp(result["energy"]) < 1e-10 * result["energy"][0]
    assert np.ptp(w, axis=0).max() > 1


def test_a_gyrostat_on_its_orbit_keeps_jacobis_integral():
    """T + V - n L3 in space is constant: the energy in axes that rotate with the orbit."""
    n = 0.6
    result = run(
        Body(1.0, (1.0, 1.4, 2.0)), [E.GravityGradient(n), E.Rotor((1, 2, 2), momentum=0.8)],
        ["energy", "angular_momentum_space"], 6, 1e-11,
        omega=(0.3, -0.5, 1.1), euler=(0.1, 0.5, 0.2),
    )  # fmt: skip
    jacobi = result["energy"] - n * result["angular_momentum_space"][:, 2]
    assert np.ptp(result["energy"]) > 0.05
    assert np.ptp(jacobi) < 1e-9

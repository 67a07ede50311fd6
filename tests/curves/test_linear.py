"""Motions with known answers, with every engine, to the requested accuracy."""

import numpy as np
import pytest
from scipy.integrate import quad
from scipy.spatial.transform import Rotation
from scipy.special import ellipj

from geomtorsion.curves import autoparallel, geodesic
from geomtorsion.geometry import cartan, levi_civita
from geomtorsion.ode import solve
from geomtorsion.spaces import load
from tests.ode.engines import every_engine
from tests.rounding import ROUNDED

ACCURACY = 1e-10


def attitude(angles):
    """Rz(phi3) Ry(phi2) Rz(phi1), body to space, for rows (phi1, phi2, phi3)."""
    return Rotation.from_euler("ZYZ", np.asarray(angles)[..., ::-1]).as_matrix()


@every_engine
def test_rotations_are_exponentials(engine):
    """so3: autoparallels are R0 exp(t [Omega]x), through every gimbal lock on the way."""
    start, omega = [0.3, 1.0, 0.2], np.array([0.7, 1.1, -0.4])
    problem = autoparallel(cartan(load("so3").frame), start, frame_velocity=omega)
    sol = solve(problem, 20, ACCURACY, engine)
    turns = Rotation.from_rotvec(sol.times[:, None] * omega).as_matrix()
    assert np.abs(attitude(sol.coordinates) - attitude(start) @ turns).max() < 3 * ACCURACY
    assert sol.frame_velocity == pytest.approx(np.tile(omega, (65, 1)), rel=ROUNDED)


@every_engine
@pytest.mark.parametrize("name", ["so3_zxz", "so3_xyz", "so3_zyx", "so3_right"])
def test_other_angles_give_the_same_rotations(name, engine):
    """All sets of Euler angles give the rotation that they describe."""
    start, omega = [0.3, 0.9, 0.2], np.array([0.7, 1.1, -0.4])
    problem = autoparallel(cartan(load(name).frame), start, frame_velocity=omega)
    sol = solve(problem, 6.0, ACCURACY, engine)
    order = {"so3_zxz": "ZXZ", "so3_xyz": "XYZ", "so3_zyx": "ZYX", "so3_right": "ZYZ"}[name]
    rows = sol.coordinates[:, ::-1] if name == "so3_right" else sol.coordinates
    turned = Rotation.from_euler(order, rows).as_matrix()
    step = Rotation.from_rotvec(sol.times[:, None] * omega).as_matrix()
    first = turned[0]
    expected = step @ first if name == "so3_right" else first @ step
    assert np.abs(turned - expected).max() < 3 * ACCURACY


@every_engine
def test_rigid_body_autoparallels_are_screws(engine):
    """r3xso3: x moves on a helix, x' = R(t) V with V constant in the body."""
    frame = load("r3xso3").frame
    start, speeds = [0.3, 1.0, 0.2, 1.0, 2.0, 3.0], [0.7, 1.1, -0.4, 0.5, 0.2, 1.0]
    sol = solve(autoparallel(cartan(frame), start, frame_velocity=speeds), 5.0, ACCURACY, engine)
    omega, v = np.array(speeds[:3]), np.array(speeds[3:])
    size, axis = np.linalg.norm(omega), omega / np.linalg.norm(omega)
    t = sol.times[:, None]
    along, across = axis * (axis @ v), v - axis * (axis @ v)
    turning = np.sin(size * t) / size * across
    turning = turning + (1 - np.cos(size * t)) / size * np.cross(axis, v)
    expected = start[3:] + (t * along + turning) @ attitude(start[:3]).T
    assert np.abs(sol.coordinates[:, 3:] - expected).max() < 5 * ACCURACY


@every_engine
def test_rigid_body_geodesics_are_straight(engine):
    """r3xso3: the body moves in a straight line while it rotates."""
    frame = load("r3xso3").frame
    start, velocity = [0.3, 1.0, 0.2, 1.0, 2.0, 3.0], [0.1, 0.5, -0.2, 0.5, 0.2, 1.0]
    sol = solve(geodesic(frame, start, velocity), 8.0, ACCURACY, engine)
    line = np.array(start[3:]) + sol.times[:, None] * np.array(velocity[3:])
    assert np.abs(sol.coordinates[:, 3:] - line).max() < 20 * ACCURACY


@every_engine
def test_polar_autoparallels_are_logarithmic(engine):
    """Flat plane, polar frame: r = r0 + a t, phi = phi0 + (b/a) ln(r/r0)."""
    a, b = 0.7, 1.3
    problem = autoparallel(cartan(load("flat_polar").frame), [1.5, 0.3], frame_velocity=[a, b])
    sol = solve(problem, 10.0, ACCURACY, engine)
    r = 1.5 + a * sol.times
    assert np.abs(sol.coordinates[:, 0] - r).max() < 10 * ACCURACY
    expected = 0.3 + b / a * np.log(r / 1.5)
    assert np.abs(sol.coordinates[:, 1] - expected).max() < 10 * ACCURACY


@every_engine
def test_compass_autoparallels_are_loxodromes(engine):
    """s2: a constant bearing gives phi = (b/a) ln tan(theta/2) + const."""
    a, b = 0.3, 0.8
    problem = autoparallel(
        cartan(load("s2").frame), [0.6, 0.0], frame_velocity=[a, b], parameters={"R": 1}
    )
    sol = solve(problem, 5.0, ACCURACY, engine)
    theta = 0.6 + a * sol.times
    expected = b / a * (np.log(np.tan(theta / 2)) - np.log(np.tan(0.3)))
    assert np.abs(sol.coordinates[:, 0] - theta).max() < 5 * ACCURACY
    assert np.abs(sol.coordinates[:, 1] - expected).max() < 10 * ACCURACY


@every_engine
def test_geodesics_of_the_sphere_are_great_circles(engine):
    """s2 of radius 2: the point moves on a circle in a plane through the centre."""
    problem = geodesic(load("s2").frame, [1.0, 0.5], [0.4, 0.9], parameters={"R": 2})
    sol = solve(problem, 12.0, ACCURACY, engine)
    theta, phi = sol.coordinates.T
    n = np.array([np.sin(theta) * np.cos(phi), np.sin(theta) * np.sin(phi), np.cos(theta)]).T
    t0, p0 = 1.0, 0.5
    east = np.array([-np.sin(p0), np.cos(p0), 0])
    south = np.array([np.cos(t0) * np.cos(p0), np.cos(t0) * np.sin(p0), -np.sin(t0)])
    rate = 0.4 * south + 0.9 * np.sin(t0) * east
    size = np.linalg.norm(rate)
    angle = size * sol.times[:, None]
    expected = np.cos(angle) * n[0] + np.sin(angle) * rate / size
    assert np.abs(n - expected).max() < 10 * ACCURACY


@every_engine
def test_free_top_in_elliptic_functions(engine):
    """Euler's equations with I = 1, 2, 3 agree with Jacobi's sn, cn, dn."""
    moments, start = np.array([1.0, 2.0, 3.0]), np.array([0.2, 0.0, 1.0])
    energy = (moments * start**2).sum()
    momentum = ((moments * start) ** 2).sum()
    i1, i2, i3 = moments
    rate = np.sqrt((i3 - i2) * (momentum - energy * i1) / (i1 * i2 * i3))
    k2 = (i2 - i1) * (energy * i3 - momentum) / ((i3 - i2) * (momentum - energy * i1))
    problem = geodesic(load("so3").frame, frame_velocity=start, metric=moments)
    sol = solve(problem, 30.0, ACCURACY, engine)
    sn, cn, dn, _ = ellipj(rate * sol.times, k2)
    size = np.sqrt((energy * i3 - momentum) / (i2 * (i3 - i2)))
    expected = np.array([0.2 * cn, size * sn, dn]).T
    # From (u1, 0, u3) the second component falls or rises with the sign of (I3 - I1) u3 u1 / I2.
    assert np.abs(sol.frame_velocity - expected).max() < 5 * ACCURACY


@every_engine
def test_perihelion_advance(engine):
    """Schwarzschild: the angle between two perihelia is the published elliptic integral."""
    mass, inner, outer = 1.0, 30.0, 60.0
    f = [1 - 2 * mass / r for r in (inner, outer)]
    # Energy and angular momentum for which both radii are turning points.
    l2 = (f[1] - f[0]) / (f[0] / inner**2 - f[1] / outer**2)
    e2 = f[0] * (1 + l2 / inner**2)
    start = [0.0, inner, np.pi / 2, 0.0]
    velocity = [np.sqrt(e2) / f[0], 0.0, 0.0, np.sqrt(l2) / inner**2]
    third = 1 / (2 * mass) - 1 / inner - 1 / outer

    def rate(s):
        """d phi / d s with 1/r = mean + half * cos(s)."""
        u = (1 / inner + 1 / outer) / 2 + (1 / inner - 1 / outer) / 2 * np.cos(s)
        return 1 / np.sqrt(2 * mass * (third - u))

    turn = 2 * quad(rate, 0, np.pi, epsabs=1e-12, epsrel=1e-12)[0]
    weak = 6 * np.pi * mass / ((inner + outer) / 2 * (1 - ((outer - inner) / (outer + inner)) ** 2))
    assert turn - 2 * np.pi == pytest.approx(weak, rel=0.15)
    frame = load("schwarzschild").frame
    problem = geodesic(frame, start, velocity, parameters={"M": mass}, causal="timelike")
    sol = solve(problem, 2500.0, 1e-10, engine)
    times = np.linspace(1500, 2500, 4001)
    k = times[int(np.argmin(sol.at(times).coordinates[:, 1]))]
    low, high = k - 1, k + 1
    for _ in range(60):
        middle = (low + high) / 2
        if sol.at(middle).velocity[1] < 0:
            low = middle
        else:
            high = middle
    assert sol.at(low).coordinates[3] == pytest.approx(turn, abs=1e-6)


@every_engine
def test_autoparallels_are_geodesics_on_so3(engine):
    """On so3 the torsion force vanishes: both curves agree to the requested accuracy."""
    frame = load("so3").frame
    start, velocity = [0.3, 1.0, 0.2], [0.1, 0.5, -0.2]
    straight = solve(autoparallel(cartan(frame), start, velocity), 30.0, ACCURACY, engine)
    shortest = solve(geodesic(frame, start, velocity), 30.0, ACCURACY, engine)
    gap = straight.in_chart("quaternion") - shortest.in_chart("quaternion")
    assert np.abs(gap).max() < 2 * ACCURACY


@every_engine
def test_torsion_force_accounts_for_the_difference_on_r3xso3(engine):
    """q'' + Gamma_bar q' q' of an autoparallel is the torsion force 2 S_a^c_b q'^a q'^b."""
    frame = load("r3xso3").frame
    start, velocity = [0.3, 1.0, 0.2, 1.0, 2.0, 3.0], [0.1, 0.5, -0.2, 0.5, 0.2, 1.0]
    problem = autoparallel(cartan(frame), start, velocity)
    sol = solve(problem, 0.5, 1e-12, engine)
    h = 1e-3
    middle = sol.at(np.array([0.25 - h, 0.25, 0.25 + h]))
    # Second-order differences: error h^2/6 of the third derivative.
    bend = (middle.velocity[2] - middle.velocity[0]) / (2 * h)
    point = dict(zip(frame.coordinates, map(float, middle.coordinates[1]), strict=True))
    rates = middle.velocity[1]
    bar = levi_civita(frame).coefficients.at(point)
    force = cartan(frame).torsion.force_coefficients.at(point)
    left = bend + np.einsum("abc,a,b->c", bar, rates, rates)
    right = np.einsum("abc,a,b->c", force, rates, rates)
    assert np.abs(right).max() > 0.1
    assert np.abs(left - right).max() < 5e-6

"""Spinning: bodies with spin agree with known orbits, geodesics and conserved quantities."""

import math
from typing import Any

import numpy as np
import pytest
import sympy as sp

import geomtorsion as gt
from geomtorsion.errors import GeomtorsionError

HOLE = gt.spaces.load("schwarzschild").frame
BAR = gt.levi_civita(HOLE)
HALF_PI = math.pi / 2
RADIUS = 10.0
SHARE = sp.Rational(1, 3)
START = [0, RADIUS, 1.2, 0]
SPEED = [1.3, -0.1, 0.01, 0.03]


def aligned(speed: float, spin: float) -> gt.ODE:
    """A body on the equator with the given local speed along phi and spin along the axis."""
    gamma = 1 / math.sqrt(1 - speed**2)
    velocity = [gamma / math.sqrt(1 - 2 / RADIUS), 0, 0, gamma * speed / RADIUS]
    return gt.spinning(
        BAR,
        [0, RADIUS, HALF_PI, 0],
        velocity,
        [0, 0, -spin, 0],
        coupling="orbital",
        parameters={"M": 1},
    )


def circular_frequency(spin: float) -> float:
    """phi'/t' on the circular orbit, whose speed is found by the secant method."""

    def fall(speed: float) -> float:
        return gt.solve(aligned(speed, spin), [0, 0.5])["r"][-1] - RADIUS

    one, two = 0.35, 0.36
    first, second = fall(one), fall(two)
    while abs(two - one) > 1e-13 and first != second:
        one, two = two, two - second * (two - one) / (second - first)
        first, second = second, fall(two)
    solution = gt.solve(aligned(two, spin), [0, 1.0])
    return float(solution["phi"][-1] / solution["t"][-1])


def test_circular_orbit_in_schwarzschild() -> None:
    """Omega = Omega_0 (1 - (3/2) (s/m) Omega_0) + O(s^2), s along the orbital momentum."""
    kepler = RADIUS**-1.5
    assert circular_frequency(0.0) == pytest.approx(kepler, rel=1e-12)
    plus, minus = circular_frequency(0.01), circular_frequency(-0.01)
    slope = (plus - minus) / 0.02 / kepler
    # The rest is of third order in the spin.
    assert slope == pytest.approx(-1.5 * kepler, rel=1e-5)
    assert plus < kepler < minus


def conserved(connection: gt.Connection, solution: gt.ode.Solution, xi: gt.Tensor) -> np.ndarray:
    """p_a xi^a + S^ab (D_a xi_b + xi^c T_cab) / 2 along a solution, from the tensors."""
    frame = connection.frame
    slope = connection.covariant_derivative(xi.lowered(0)).in_frame()
    torsion = connection.torsion.T.lowered(2).in_frame()
    along, names = xi.in_frame(), [str(q) for q in frame.coordinates]
    found = []
    for k in range(len(solution["r"])):
        point = {name: float(solution[name][k]) for name in names} | {"M": 1}
        p = np.array([solution[f"p{i}"][k] for i in range(1, 5)])
        spin = np.zeros((4, 4))
        for i in range(4):
            for j in range(i + 1, 4):
                spin[i, j] = solution[f"S{i + 1}{j + 1}"][k]
        spin = spin - spin.T
        vector = along.at(point)
        turn = slope.at(point) + np.einsum("c,cab->ab", vector, torsion.at(point))
        found.append(p @ vector + np.sum(spin * turn) / 2)
    return np.array(found)


@pytest.mark.parametrize("coupling", ["orbital", "intrinsic"])
def test_symmetries_give_conserved_quantities(coupling: str) -> None:
    """Energy and angular momentum with spin are conserved, where torsion has the same symmetry."""
    twisted = gt.blend(BAR, gt.cartan(HOLE), SHARE)
    problem = gt.spinning(
        twisted, START, SPEED, [0, 0.3, -0.2, 0.4], coupling=coupling, parameters={"M": 1}
    )
    solution = gt.solve(problem, np.linspace(0, 20, 5))
    felt = twisted if coupling == "intrinsic" else BAR
    for xi in ([1, 0, 0, 0], [0, 0, 0, 1]):
        values = conserved(felt, solution, HOLE.vector(xi))
        assert np.ptp(values) < 1e-9
        # The other connection does not conserve them.
        others = conserved(BAR if coupling == "intrinsic" else twisted, solution, HOLE.vector(xi))
        assert np.ptp(others) > 1e-6
    assert max(float(np.max(drift)) for drift in solution.drift.values()) < 1e-9


@pytest.mark.parametrize("coupling", ["orbital", "intrinsic"])
def test_without_spin_it_is_a_geodesic(coupling: str) -> None:
    """Without spin the path is a geodesic in every connection: torsion acts only on spin."""
    norm = float(HOLE.metric.at({"r": RADIUS, "theta": 1.2, "M": 1}) @ SPEED @ SPEED)
    unit = [float(v) / math.sqrt(-norm) for v in SPEED]
    path = gt.solve(gt.geodesic(HOLE, START, unit, parameters={"M": 1}), [0, 10, 20])
    body = gt.spinning(
        gt.cartan(HOLE), START, SPEED, np.zeros((4, 4)), coupling=coupling, parameters={"M": 1}
    )
    found = gt.solve(body, [0, 10, 20])
    for name in ("t", "r", "theta", "phi"):
        assert np.allclose(found[name], path[name], rtol=1e-9)


def test_antisymmetric_torsion_turns_spin_only() -> None:
    """T_123 = c in flat space: momentum stays, an intrinsic spin rotates by K = T/2."""
    t, x, y, z = sp.symbols("t x y z")
    flat = gt.Frame([t, x, y, z], sp.eye(4), signature=(-1, 1, 1, 1))
    strength = sp.Rational(1, 2)
    torsion = [[[0] * 4 for _ in range(4)] for _ in range(4)]
    for i, j, k in ((0, 1, 2), (1, 2, 0), (2, 0, 1)):
        # T_ab^c from T_012 = 1/2, whose first index is raised with a sign.
        sign = -1 if k == 0 else 1
        torsion[i][j][k], torsion[j][i][k] = sign * strength / 2, -sign * strength / 2
    twisted = gt.from_torsion(flat, torsion)
    rest = [1, 0, 0, 0]
    body = gt.spinning(twisted, [0, 0, 0, 0], rest, [0, 1e-6, 0, 0], coupling="intrinsic")
    found = gt.solve(body, [0.0, 1.0])
    # K_0ij = T_0ij / 2 rotates vectors in the plane of 1 and 2.
    spin = np.array([found["S34"][-1], -found["S24"][-1]]) / 1e-6
    angle = math.atan2(spin[1], spin[0])
    assert abs(angle) == pytest.approx(0.25, abs=1e-6)
    still = gt.spinning(twisted, [0, 0, 0, 0], rest, [0, 1e-6, 0, 0], coupling="orbital")
    assert gt.solve(still, [0.0, 1.0])["S34"][-1] == pytest.approx(1e-6, rel=1e-9)


def test_spin_on_a_sphere_and_signatures() -> None:
    """Three dimensions, spin as a matrix, both signatures; spin along the momentum is dropped."""
    t, r, phi = sp.symbols("t r phi", positive=True)
    plane = gt.Frame([t, r, phi], sp.diag(1, 1, r), signature=(-1, 1, 1))
    spin = [[0, 0.1, 0], [-0.1, 0, 0.2], [0, -0.2, 0]]
    bar = gt.levi_civita(plane)
    body = gt.spinning(bar, [0, 2, 0], [1, 0, 0], spin, coupling="orbital")
    assert body.start[6] == 0
    assert gt.solve(body, [0, 3.0])["r"][-1] == pytest.approx(2)
    other = gt.Frame([t, r, phi], sp.diag(1, 1, r), signature=(1, -1, -1))
    moved = [1, 0.1, 0.2]
    one = gt.solve(gt.spinning(bar, [0, 2, 0], moved, spin, coupling="orbital"), [0, 3.0])
    two = gt.spinning(gt.levi_civita(other), [0, 2, 0], moved, spin, coupling="orbital")
    assert gt.solve(two, [0, 3.0])["phi"][-1] == pytest.approx(one["phi"][-1], rel=1e-9)


def call(spin: Any = (0, 0, 0.1, 0), velocity=SPEED, connection: Any = BAR, coupling="orbital"):
    """A body of the tests with one wrong argument."""
    return gt.spinning(connection, START, velocity, spin, coupling=coupling, parameters={"M": 1})


ARRAY = np.zeros((4, 4, 4)).tolist()
ARRAY[0][0][0] = 1
SEVEN = gt.levi_civita(gt.spaces.load("r3xso3").frame)
REFUSALS = [
    (lambda: call(coupling="both"), "coupling"),
    (lambda: call(spin=[1, 2, 3]), "4 rows"),
    (lambda: call(spin=np.ones((4, 4))), "antisymmetric"),
    (lambda: call(velocity=[0.1, 1, 0, 0]), "timelike"),
    (lambda: call(connection=gt.from_coefficients(HOLE, ARRAY)), "metric connection"),
    (lambda: call(connection=HOLE), "connection"),
    (
        lambda: gt.spinning(SEVEN, [1] * 6, [1] * 6, np.zeros((6, 6)), coupling="orbital"),
        "two to four",
    ),
]


@pytest.mark.parametrize(("wrong", "words"), REFUSALS)
def test_anything_but_a_body_is_refused(wrong, words):
    """Each error names the expected input."""
    with pytest.raises(GeomtorsionError, match=words):
        wrong()


def test_without_torsion_the_coupling_does_not_matter() -> None:
    """The default is the given connection; the metric's own connection has no torsion."""
    start, velocity, spin = [0, 10, 1.5, 0], [1.2, 0, 0, 0.04], [0, 0, -0.1, 0]
    ends = [
        gt.solve(gt.spinning(BAR, start, velocity, spin, parameters={"M": 1}, **given), 5.0)
        for given in ({}, {"coupling": "orbital"}, {"coupling": "intrinsic"})
    ]
    assert ends[0].states.tolist() == ends[2].states.tolist()
    assert np.abs(ends[0].states - ends[1].states).max() < 1e-9

"""Oracle: its values are compared with closed forms from textbooks and from the paper."""

import mpmath
import numpy as np
import pytest
from mpmath import cos, cosh, exp, mpf, sin, sqrt

from tests.differences import DIGITS, largest
from tests.oracle import Oracle

TIGHT = 1e-24  # nested differences leave about 28 digits

SO3_POINT = (mpf("0.7"), mpf("1.1"), mpf("-0.4"))


def so3(q):
    """Coframe of eq. (8): body angular velocity in z-y-z Euler angles."""
    s1, c1, s2, c2 = sin(q[0]), cos(q[0]), sin(q[1]), cos(q[1])
    return [[0, s1, -c1 * s2], [0, c1, s1 * s2], [1, 0, c2]]


def sphere(q):
    """Orthonormal coframe of a sphere of radius 3."""
    return [[3, 0], [0, 3 * sin(q[0])]]


def schwarzschild(q):
    """Diagonal tetrad with M = 1."""
    f = sqrt(1 - 2 / q[1])
    return [[f, 0, 0, 0], [0, 1 / f, 0, 0], [0, 0, q[1], 0], [0, 0, 0, q[1] * sin(q[2])]]


def epsilon():
    """Levi-Civita symbol."""
    e = np.zeros((3, 3, 3), dtype=int)
    e[0, 1, 2] = e[1, 2, 0] = e[2, 0, 1] = 1
    e[0, 2, 1] = e[2, 1, 0] = e[1, 0, 2] = -1
    return e


@pytest.fixture(scope="module", autouse=True)
def full_precision():
    """Closed forms use as many digits as the oracle."""
    with mpmath.workdps(DIGITS):
        yield


def test_sphere():
    """A sphere of radius a has Ricci = g / a^2, scalar 2 / a^2, Kretschmann 4 / a^4."""
    o = Oracle(sphere, (mpf("0.8"), mpf("2.1")))
    assert largest(o.ricci - o.metric / 9) < TIGHT
    assert abs(o.scalar - mpf(2) / 9) < TIGHT
    assert abs(o.kretschmann - mpf(4) / 81) < TIGHT
    assert largest(o.einstein) < TIGHT
    assert largest(o.curvature) < TIGHT, "the Cartan connection is flat"


def test_so3_of_the_paper():
    """SO(3) has connection (10), its torsion, anholonomy (12), Ricci g/2 and scalar 3/2."""
    o = Oracle(so3, SO3_POINT)
    s2, c2 = sin(SO3_POINT[1]), cos(SO3_POINT[1])
    gamma = np.zeros((3, 3, 3), dtype=object)
    gamma[0, 1, 0] = gamma[1, 2, 2] = c2 / s2
    gamma[0, 1, 2] = gamma[1, 2, 0] = -1 / s2
    gamma[0, 2, 1] = s2
    assert largest(o.gamma - gamma) < TIGHT
    assert largest(o.torsion_lowered + s2 * epsilon()) < TIGHT
    assert largest(o.anholonomy + epsilon()) < TIGHT
    assert largest(o.ricci - o.metric / 2) < TIGHT
    assert abs(o.scalar - mpf(3) / 2) < TIGHT
    assert largest(o.curvature) < TIGHT
    assert largest(o.force((1, 2, 3))) < TIGHT
    assert largest(o.torsion_axial - o.torsion_lowered) < TIGHT
    assert largest(o.weyl) < TIGHT
    lowered = o.christoffel @ o.metric
    assert abs(lowered[0, 1, 2] + s2 / 2) < TIGHT
    assert abs(lowered[0, 2, 1] - s2 / 2) < TIGHT


def test_schwarzschild():
    """Schwarzschild has Ricci = 0, Weyl = Riemann and Kretschmann = 48 / r^6."""
    o = Oracle(
        schwarzschild,
        (mpf(0), mpf(5), mpf("0.9"), mpf(1)),
        eta=[[-1, 0, 0, 0], [0, 1, 0, 0], [0, 0, 1, 0], [0, 0, 0, 1]],
    )
    assert largest(o.ricci) < TIGHT
    assert largest(o.weyl - o.riemann_lowered) < TIGHT
    assert abs(o.kretschmann - mpf(48) / 5**6) < TIGHT


def test_scalar_identity_of_teleparallel_gravity():
    """R_bar = -T - 2 D_bar_a v^a with the signs used here, on a frame without symmetry."""

    def e(q):
        x, y, z = q
        return [[1 + x * y, sin(z), 0], [y, exp(x), z * x], [0, x, cosh(y)]]

    def density(q):
        o = Oracle(e, q, eta=eta)
        return o.determinant * (o.inverse_metric @ o.torsion_vector)

    eta = [[1, 0, 0], [0, 1, 0], [0, 0, -1]]
    point = (mpf("0.3"), mpf("0.5"), mpf("-0.2"))
    o, step = Oracle(e, point, eta=eta), mpf(10) ** -12
    divergence = mpf(0)
    for axis in range(3):
        ahead, behind = list(point), list(point)
        ahead[axis] += step
        behind[axis] -= step
        divergence += (density(ahead) - density(behind))[axis] / (2 * step)
    divergence /= o.determinant
    signs = {
        (s, t): abs(o.scalar - s * o.torsion_scalar - t * 2 * divergence)
        for s in (1, -1)
        for t in (1, -1)
    }
    right = min(signs, key=lambda pair: signs[pair])
    assert signs[right] < 1e-20
    assert right == (-1, -1), "R_bar = -T - 2 D_bar_a v^a"


def test_general_coefficients():
    """Coefficients without symmetry: torsion, curvature and nonmetricity equal hand-made values."""
    gamma = np.zeros((2, 2, 2), dtype=object)

    def coefficients(q):
        g = gamma.copy()
        g[0, 1, 0] = q[0] * q[1]
        g[1, 1, 1] = q[1] ** 2
        return g

    x, y = mpf("1.5"), mpf("0.5")
    o = Oracle(lambda q: [[1, 0], [0, q[0]]], (x, y), coefficients=coefficients)
    assert abs(o.torsion[0, 1, 0] - x * y / 2) < TIGHT
    assert abs(o.torsion[1, 0, 0] + x * y / 2) < TIGHT
    # R_011^0 = d_0 G_11^0 - d_1 G_01^0 - G_01^t G_1t^0 + G_11^t G_0t^0
    assert abs(o.curvature[0, 1, 1, 0] - (-x + y**2 * x * y)) < TIGHT
    assert abs(o.nonmetricity[0, 1, 1] - 2 * x) < TIGHT
    assert abs(o.nonmetricity[1, 1, 1] + 2 * y**2 * x**2) < TIGHT
    assert abs(o.nonmetricity[0, 0, 1] + x * y) < TIGHT


def test_spin_connection_of_cartan_vanishes_and_rotates():
    """Legs are parallel for Cartan's connection; polar legs turn for the Levi-Civita connection."""
    assert largest(Oracle(so3, SO3_POINT).spin_connection) < TIGHT
    polar = Oracle(lambda q: [[1, 0], [0, q[0]]], (mpf(2), mpf(1)))
    bar = Oracle(polar.coframe, polar.point, coefficients=polar.christoffel_at)
    # D_phi e_r = e_phi and D_phi e_phi = -e_r
    assert abs(bar.spin_connection[1, 0, 1] - 1) < TIGHT
    assert abs(bar.spin_connection[1, 1, 0] + 1) < TIGHT
    assert largest(bar.spin_connection[0]) < TIGHT

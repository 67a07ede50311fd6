"""Closed forms: all components for the plane, spheres, SO(3), Schwarzschild and Kerr."""

from __future__ import annotations

from itertools import product

import pytest
import sympy as sp

from geomtorsion.geometry import Frame, Tensor, cartan, levi_civita

r, M, a = sp.symbols("r M a", positive=True)
t, theta, phi = sp.symbols("t theta phi", real=True)
phi1, phi2, phi3 = sp.symbols("phi1 phi2 phi3", real=True)
s2, c2 = sp.sin(phi2), sp.cos(phi2)


def polar() -> Frame:
    return Frame([r, phi], [[1, 0], [0, r]])


def rotations() -> Frame:
    """SO(3) as in the paper, eq. (6); indices here count from 0."""
    s1, c1 = sp.sin(phi1), sp.cos(phi1)
    return Frame([phi1, phi2, phi3], [[0, s1, -c1 * s2], [0, c1, s1 * s2], [1, 0, c2]])


def schwarzschild() -> Frame:
    h = sp.sqrt(1 - 2 * M / r)
    coframe = sp.diag(h, 1 / h, r, r * sp.sin(theta))
    return Frame([t, r, theta, phi], coframe, signature=(-1, 1, 1, 1), domain=r > 2 * M)


def kerr() -> Frame:
    """Carter's tetrad."""
    sigma = sp.sqrt(r**2 + a**2 * sp.cos(theta) ** 2)
    delta = sp.sqrt(r**2 - 2 * M * r + a**2)
    sine = sp.sin(theta)
    rows = [
        [delta / sigma, 0, 0, -a * sine**2 * delta / sigma],
        [0, sigma / delta, 0, 0],
        [0, 0, sigma, 0],
        [-a * sine / sigma, 0, 0, (r**2 + a**2) * sine / sigma],
    ]
    return Frame([t, r, theta, phi], rows, signature=(-1, 1, 1, 1))


def assert_components(tensor: Tensor, wanted: dict) -> None:
    """Each listed component has its value, and all others are zero."""
    n, rank = tensor.frame.dimension, len(tensor.slots)
    for index in product(range(n), repeat=rank):
        (expected,) = tensor.frame.read([("expected", wanted.get(index, 0))])
        assert tensor.element(*index) == expected, (index, tensor[index], wanted.get(index, 0))


def test_polar_plane() -> None:
    """The plane in orthonormal polar legs: curved coordinates, no curvature, torsion 1/r."""
    frame = polar()
    c, bar = cartan(frame), levi_civita(frame)
    assert_components(c.coefficients, {(0, 1, 1): 1 / r})
    assert_components(bar.coefficients, {(0, 1, 1): 1 / r, (1, 0, 1): 1 / r, (1, 1, 0): -r})
    assert_components(c.torsion.S, {(0, 1, 1): 1 / (2 * r), (1, 0, 1): -1 / (2 * r)})
    assert_components(frame.anholonomy, {(0, 1, 1): 1 / r, (1, 0, 1): -1 / r})
    assert_components(c.torsion.vector, {(0,): 1 / r})
    assert bar.is_flat is True
    assert c.torsion.scalar.is_zero is True
    assert c.torsion.axial.is_zero is True
    assert frame.determinant[()] == r
    # Autoparallels keep their angle to the legs, geodesics are straight: they differ by r phi'^2.
    assert_components(c.torsion.force([0, 1]), {(0,): -r})


def test_sphere() -> None:
    """Sphere of radius one: R = 2, Ricci = g, K = 4; spheres have positive curvature."""
    frame = Frame([theta, phi], [[1, 0], [0, sp.sin(theta)]])
    bar = levi_civita(frame)
    assert bar.curvature.scalar[()] == 2
    assert bar.curvature.ricci == frame.metric
    assert bar.curvature.kretschmann[()] == 4
    assert bar.curvature.einstein.is_zero is True
    # R_mnl^k = g_nl delta_m^k - g_ml delta_n^k
    square = sp.sin(theta) ** 2
    wanted = {(0, 1, 1, 0): square, (1, 0, 1, 0): -square, (0, 1, 0, 1): -1, (1, 0, 0, 1): 1}
    assert_components(bar.curvature.riemann, wanted)


def test_rotation_group_of_the_paper() -> None:
    """Each line of the table in READING.md, section SO(3)."""
    frame = rotations()
    c, bar = cartan(frame), levi_civita(frame)
    assert frame.determinant[()] == s2
    assert_components(frame.metric, {(0, 0): 1, (1, 1): 1, (2, 2): 1, (0, 2): c2, (2, 0): c2})
    inverse = {(0, 0): 1, (0, 2): -c2, (1, 1): s2**2, (2, 0): -c2, (2, 2): 1}
    assert_components(frame.inverse_metric, {k: v / s2**2 for k, v in inverse.items()})
    minus = [(0, 1, 2), (1, 0, 2), (1, 2, 0), (2, 1, 0)]
    plus = [(0, 2, 1), (2, 0, 1)]
    lower = {**dict.fromkeys(minus, -s2 / 2), **dict.fromkeys(plus, s2 / 2)}
    assert_components(bar.coefficients.lowered(2), lower)
    gamma = {
        (0, 1, 0): c2 / s2,
        (1, 2, 2): c2 / s2,
        (0, 1, 2): -1 / s2,
        (1, 2, 0): -1 / s2,
        (0, 2, 1): s2,
    }
    assert_components(c.coefficients, gamma)
    epsilon = {p: sp.LeviCivita(*p) for p in product(range(3), repeat=3)}
    assert_components(c.torsion.S.lowered(2), {p: -s2 * e / 2 for p, e in epsilon.items()})
    assert_components(frame.anholonomy.lowered(2), {p: -e for p, e in epsilon.items()})
    assert bar.curvature.scalar[()] == sp.Rational(3, 2)
    assert bar.curvature.ricci == frame.metric / 2
    assert c.curvature.is_zero is True
    assert c.torsion.force_coefficients.is_zero is True
    assert c.torsion.scalar[()] == -sp.Rational(3, 2)
    assert c.torsion.tensor.is_zero is True
    assert str(c[0, 1, 0]) == "cos(phi2)/sin(phi2)"


def test_schwarzschild() -> None:
    """Vacuum: Ricci = 0, K = 48 M^2/r^6, R_tr^.. = 2M/r^3 and the known connection."""
    frame = schwarzschild()
    c, bar = cartan(frame), levi_civita(frame)
    f = 1 - 2 * M / r
    assert_components(
        c.coefficients,
        {
            (1, 0, 0): M / (r**2 * f),
            (1, 1, 1): -M / (r**2 * f),
            (1, 2, 2): 1 / r,
            (1, 3, 3): 1 / r,
            (2, 3, 3): sp.cos(theta) / sp.sin(theta),
        },
    )
    assert bar[0, 0, 1] == sp.factor(M * f / r**2)
    assert bar.curvature.ricci.is_zero is True
    assert bar.curvature.kretschmann[()] == 48 * M**2 / r**6
    framed = bar.curvature.lower.in_frame()
    # Tidal forces: R_(t r t r) = -2M/r^3, M/r^3 across; R_mnlk with k paired to m.
    assert framed[0, 1, 0, 1] == 2 * M / r**3
    assert framed[0, 2, 0, 2] == -M / r**3
    assert framed[2, 3, 2, 3] == -2 * M / r**3
    assert bar.curvature.weyl == bar.curvature.lower
    assert c.curvature.is_zero is True
    # R_bar = 0, so the torsion scalar is minus a divergence and need not vanish.
    assert c.torsion.scalar.is_zero is False


def kerr_kretschmann() -> sp.Expr:
    """48 M^2 (r^2 - a^2 c^2) ((r^2 + a^2 c^2)^2 - 16 r^2 a^2 c^2) / (r^2 + a^2 c^2)^6."""
    q = a**2 * sp.cos(theta) ** 2
    return 48 * M**2 * (r**2 - q) * ((r**2 + q) ** 2 - 16 * r**2 * q) / (r**2 + q) ** 6


def test_kerr_from_the_tetrad() -> None:
    """Carter's tetrad: Ricci = 0, the known Kretschmann scalar, a flat Cartan connection."""
    frame = kerr()
    bar = levi_civita(frame)
    assert bar.curvature.ricci.is_zero is True
    (expected,) = frame.read([("K", kerr_kretschmann())])
    assert bar.curvature.kretschmann.element() == expected
    assert cartan(frame).curvature.is_zero is True


def test_kerr_from_the_metric() -> None:
    """The metric of the tetrad, read by itself, has the same curvature."""
    metric = kerr().metric.to_sympy().tolist()
    frame = Frame.from_metric([t, r, theta, phi], metric, signature=(-1, 1, 1, 1))
    curvature = levi_civita(frame).curvature
    assert curvature.ricci.is_zero is True
    (expected,) = frame.read([("K", kerr_kretschmann())])
    assert curvature.kretschmann.element() == expected


def test_kerr_from_a_null_tetrad() -> None:
    """Kinnersley's complex legs with off-diagonal eta give the same real metric and Ricci = 0."""
    sigma = r**2 + a**2 * sp.cos(theta) ** 2
    delta = r**2 - 2 * M * r + a**2
    sine = sp.sin(theta)
    q = r + sp.I * a * sp.cos(theta)
    l = [(r**2 + a**2) / delta, 1, 0, a / delta]  # noqa: E741 - the letter of the literature
    n = [(r**2 + a**2) / (2 * sigma), -delta / (2 * sigma), 0, a / (2 * sigma)]
    m = [sp.I * a * sine, 0, 1, sp.I / sine]
    m = [sp.sympify(x) / (sp.sqrt(2) * q) for x in m]
    bar = [x.subs(sp.I, -sp.I) for x in m]
    legs = sp.Matrix([l, n, m, bar]).T
    eta = [[0, -1, 0, 0], [-1, 0, 0, 0], [0, 0, 0, 1], [0, 0, 1, 0]]
    frame = Frame.from_frame([t, r, theta, phi], legs, signature=eta, complex=True)
    orthonormal = kerr()
    for index in product(range(4), repeat=2):
        (expected,) = frame.read([("g", orthonormal.metric[index])])
        assert frame.metric.element(*index) == expected
    assert levi_civita(frame).curvature.ricci.is_zero is True
    assert cartan(frame).curvature.is_zero is True
    assert cartan(frame).metric_compatible is True
    assert cartan(frame).nonmetricity.is_zero is True
    # The imaginary determinant of a null tetrad still gives the real volume.
    (volume,) = frame.read([("volume", sigma * sine)])
    assert frame.volume.element() in (volume, -volume)


@pytest.mark.parametrize("n", [3, 4, 5])
def test_conformally_flat_space_has_no_weyl_tensor(n: int) -> None:
    """g = f^2 delta: Weyl vanishes, Riemann does not."""
    symbols = sp.symbols(f"x1:{n + 1}", real=True)
    factor = 2 / (1 + sum(x**2 for x in symbols))
    frame = Frame(symbols, factor * sp.eye(n))
    curvature = levi_civita(frame).curvature
    assert curvature.weyl.is_zero is True
    assert curvature.scalar[()] == n * (n - 1)
    assert curvature.kretschmann[()] == 2 * n * (n - 1)

"""Quadrature: rules are exact where they should be, converge as they should, and admit failure."""

import numpy as np
import pytest

from geomtorsion.loops import Loop
from geomtorsion.loops.cells import DISK, SQUARE
from geomtorsion.loops.flux import ray_rule
from geomtorsion.loops.quadrature import Integrand, integrate, kronrod_rule, trapezoid

ROUNDED = 1e-14  # sums of some ten rounded terms

CIRCLE = Loop.circle([0, 0], 1).parts[0].arcs
TRIANGLE = Loop.polygon([[0, 0], [1, 0], [0, 1]], centre=[0, 0]).parts[0].arcs


def test_kronrod_is_exact_to_degree_22_and_gauss_to_13() -> None:
    """On powers over (0, 1)."""
    nodes, fine, coarse = kronrod_rule()
    for power in range(23):
        assert fine @ nodes**power == pytest.approx(1 / (power + 1), rel=ROUNDED)
    for power in range(14):
        assert coarse @ nodes**power == pytest.approx(1 / (power + 1), rel=ROUNDED)
    assert coarse @ nodes**14 != pytest.approx(1 / 15, rel=ROUNDED)


@pytest.mark.parametrize("points", [1, 4, 6, 16, 42])
def test_rays_are_exact_with_their_weight(points: int) -> None:
    """Gauss and Jacobi: integral of s * s^p to degree 2 points - 1."""
    s, w = ray_rule(points)
    for power in range(2 * points):
        assert w @ s**power == pytest.approx(1 / (power + 2), rel=1e-14)


@pytest.mark.parametrize("level", range(4))
def test_disk_and_square_are_exact_to_their_degree(level: int) -> None:
    """Monomials over the disk of radius 1 and the square of side 1, and areas by their rims."""
    disk, square = DISK.inside(level), SQUARE.inside(level)
    for p in range(0, 2 * level + 3, 2):
        for q in range(0, 2 * level + 4 - p, 2):
            x, y = disk.points
            exact = 2 * _gamma(p, q) / (p + q + 2)
            assert disk.weights @ (x**p * y**q) == pytest.approx(exact, rel=1e-13)
            x, y = square.points
            exact = 1 / ((p + 1) * (q + 1) * 2 ** (p + q))
            assert square.weights @ (x**p * y**q) == pytest.approx(exact, rel=1e-13)
    for cell in (DISK, SQUARE):
        rim = cell.rim(level)
        x, y = rim.points
        area = (rim.weights[1] @ x - rim.weights[0] @ y) / 2
        assert area == pytest.approx(cell.area, rel=ROUNDED)


def _gamma(p: int, q: int) -> float:
    """Half the integral of cos^p sin^q over a turn, p and q even."""
    from math import gamma

    return gamma((p + 1) / 2) * gamma((q + 1) / 2) / gamma((p + q) / 2 + 1)


def test_the_trapezoid_rule_is_spectral() -> None:
    """16 points for an entire function where Gauss would need 28."""
    found = trapezoid(CIRCLE[0], lambda x, v: np.exp(x[:1]) * np.ones_like(v[:1]), 1e-13, 0.0)
    assert found.converged
    assert found.points <= 41
    assert found.value[0] == pytest.approx(float(np.i0(1)), rel=ROUNDED)


@pytest.mark.parametrize("frequency", [16, 25, 32, 41, 48, 400, 1000])
def test_no_frequency_hides(frequency: int) -> None:
    """A wave that is constant on one rule's points is not on the next one's."""
    found = integrate(CIRCLE, lambda x, v: _wave(x, frequency), 1e-10, 1e-12)
    assert found.converged
    assert found.value[0] == pytest.approx(1, abs=1e-9)


def _wave(x: np.ndarray, frequency: int) -> np.ndarray:
    """1 + cos(n t) on the unit circle."""
    angle = np.arctan2(x[1], x[0])
    return 1 + np.cos(frequency * angle)[None]


def test_a_narrow_peak_goes_to_gauss_and_kronrod() -> None:
    """1 / (x^2 + d^2) on a circle: the trapezoid gives up, halving finds the peak."""
    d = 1e-5
    found = integrate(CIRCLE, lambda x, v: 1 / (x[:1] ** 2 + d**2), 1e-9)
    assert found.converged
    assert "Kronrod" in found.rule
    assert found.points < 5000
    assert found.value[0] == pytest.approx(1 / (d * np.sqrt(1 + d * d)), rel=1e-9)


@pytest.mark.parametrize("integrand", [lambda x, v: 1 / x[:1], lambda x, v: 1 / (x[:1] - 0.3) ** 2])
def test_poles_do_not_converge(integrand: Integrand) -> None:
    """It ends, and says where it was worst."""
    found = integrate(TRIANGLE, integrand, 1e-9, 0.0, 10**5)
    assert not found.converged
    assert found.worst is not None


def test_not_finite_values_never_count_as_converged() -> None:
    """Neither infinite nor missing values."""
    for bad in (np.inf, np.nan):
        found = integrate(CIRCLE, lambda x, v, bad=bad: np.full((1, x.shape[1]), bad), 1e-9, 0, 999)
        assert not found.converged

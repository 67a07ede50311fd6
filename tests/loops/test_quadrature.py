"""Quadrature: rules have their degree of exactness, converge, and admit failure."""

from math import gamma

import numpy as np
import pytest

from geomtorsion.loops import Loop, quadrature
from geomtorsion.loops.arcs import Ellipse
from geomtorsion.loops.chains import ClosedCurve, Square
from geomtorsion.loops.quadrature import Integrand, integrate, kronrod_rule, ray_rule, trapezoid
from tests.rounding import ROUNDED

CIRCLE = Loop.circle([0, 0], 1).parts[0].arcs
TRIANGLE = Loop.polygon([[0, 0], [1, 0], [0, 1]], centre=[0, 0]).parts[0].arcs


def test_kronrod_is_exact_to_degree_22_and_gauss_to_13() -> None:
    """Powers over (0, 1)."""
    rule = kronrod_rule()
    nodes, fine, coarse = rule.nodes, rule.fine, rule.coarse
    for power in range(23):
        assert fine @ nodes**power == pytest.approx(1 / (power + 1), rel=ROUNDED)
    for power in range(14):
        assert coarse @ nodes**power == pytest.approx(1 / (power + 1), rel=ROUNDED)
    assert coarse @ nodes**14 != pytest.approx(1 / 15, rel=ROUNDED)


@pytest.mark.parametrize("points", [1, 4, 6, 16, 42])
def test_rays_are_exact_with_their_weight(points: int) -> None:
    """Gauss-Jacobi rule: integral of s * s^p, exact to degree 2 points - 1."""
    s, w = ray_rule(points)
    for power in range(2 * points):
        assert w @ s**power == pytest.approx(1 / (power + 2), rel=ROUNDED)


@pytest.mark.parametrize("level", range(4))
def test_disk_and_square_are_exact_to_their_degree(level: int) -> None:
    """Monomials over the unit disk and the unit square, and areas from their rims."""
    disk, square = ClosedCurve(Ellipse((1.0, 0.0), (0.0, 1.0)), first=9), Square()
    for p in range(0, 2 * level + 3, 2):
        for q in range(0, 2 * level + 4 - p, 2):
            exact = 2 * _gamma(p, q) / (p + q + 2)
            x, y = disk.inside(level).points
            assert disk.inside(level).weights[0] @ (x**p * y**q) == pytest.approx(exact, rel=1e-13)
            exact = 1 / ((p + 1) * (q + 1) * 2 ** (p + q))
            x, y = square.inside(level).points
            found = square.inside(level).weights[0] @ (x**p * y**q)
            assert found == pytest.approx(exact, rel=1e-13)
    for shape, area in ((disk, np.pi), (square, 1.0)):
        rim = shape.rim(level)
        x, y = rim.points
        assert (rim.weights[1] @ x - rim.weights[0] @ y) / 2 == pytest.approx(area, rel=ROUNDED)


def _gamma(p: int, q: int) -> float:
    """Half the integral of cos^p sin^q over a turn, p and q even."""
    return gamma((p + 1) / 2) * gamma((q + 1) / 2) / gamma((p + q) / 2 + 1)


def test_the_trapezoid_rule_is_spectral() -> None:
    """17 points suffice for an entire function, where Gauss would need 28."""
    found = trapezoid(CIRCLE[0], lambda x, v: np.exp(x[:1]) * np.ones_like(v[:1]), 1e-13, 0.0)
    assert found.converged
    assert found.points == 17 + 25
    assert found.value[0] == pytest.approx(float(np.i0(1)), rel=ROUNDED)


@pytest.mark.parametrize("frequency", [16, 25, 32, 41, 48, 400, 1000])
def test_no_frequency_hides(frequency: int) -> None:
    """A wave that is constant on the points of one rule varies on the points of the next."""
    found = integrate(CIRCLE, lambda x, v: _wave(x, frequency), 1e-10, 1e-12)
    assert found.converged
    assert found.value[0] == pytest.approx(1, abs=1e-9)


def _wave(x: np.ndarray, frequency: int) -> np.ndarray:
    """1 + cos(n t) on the unit circle."""
    angle = np.arctan2(x[1], x[0])
    return 1 + np.cos(frequency * angle)[None]


def test_a_narrow_peak_goes_to_gauss_and_kronrod() -> None:
    """1 / (x^2 + d^2) on a circle: the trapezoid rule fails, and halving finds the peak."""
    d = 1e-5
    found = integrate(CIRCLE, lambda x, v: 1 / (x[:1] ** 2 + d**2), 1e-9)
    assert found.converged
    assert "Kronrod" in found.rule
    assert found.points < 5000
    assert found.value[0] == pytest.approx(1 / (d * np.sqrt(1 + d * d)), rel=1e-9)


@pytest.mark.parametrize(("d", "rule"), [(0.01, "trapezoid"), (0.005, "Gauss-Kronrod")])
def test_how_narrow_a_peak_the_trapezoid_rule_takes(d: float, rule: str) -> None:
    """The rule takes a peak that needs at most a hundred times its points; else halving."""
    found = integrate(CIRCLE, lambda x, v: 1 / (x[:1] ** 2 + d**2), 1e-9)
    assert found.converged
    assert found.rule.startswith(rule)
    assert found.value[0] == pytest.approx(1 / (d * np.sqrt(1 + d * d)), rel=1e-9)


@pytest.mark.parametrize(("noise", "settled"), [(2e-8, True), (1e-6, False)])
def test_rounding_is_recognized(noise: float, settled: bool) -> None:
    """If halving no longer helps, a difference in the second half of the digits is rounding."""

    def rough(x: np.ndarray, v: np.ndarray) -> np.ndarray:
        return 1 + noise * np.sin(1e15 * x[:1])

    found = integrate(TRIANGLE, rough, 1e-13, 0.0, 20000)
    assert found.converged == settled
    assert (found.points < 1000) == settled


@pytest.mark.parametrize("integrand", [lambda x, v: 1 / x[:1], lambda x, v: 1 / (x[:1] - 0.3) ** 2])
def test_poles_do_not_converge(integrand: Integrand) -> None:
    """The integration ends without convergence and names the worst place."""
    found = integrate(TRIANGLE, integrand, 1e-9, 0.0, 10**5)
    assert not found.converged
    assert found.worst is not None


def test_not_finite_values_never_count_as_converged() -> None:
    """An integral of infinite values or of nan never counts as converged."""
    for bad in (np.inf, np.nan):
        found = integrate(CIRCLE, lambda x, v, bad=bad: np.full((1, x.shape[1]), bad), 1e-9, 0, 999)
        assert not found.converged


@pytest.mark.parametrize("piece", [40, 2**20])
def test_pieces_decide_nothing(piece: int, monkeypatch: pytest.MonkeyPatch) -> None:
    """The number of points evaluated at once does not change the integral."""
    found = [integrate(arcs, lambda x, v: np.exp(9 * x), 1e-12) for arcs in (CIRCLE, TRIANGLE)]
    monkeypatch.setattr(quadrature, "PIECE", piece)
    again = [integrate(arcs, lambda x, v: np.exp(9 * x), 1e-12) for arcs in (CIRCLE, TRIANGLE)]
    for one, two in zip(found, again, strict=True):
        assert two.points == one.points
        assert two.value == pytest.approx(one.value, rel=ROUNDED)

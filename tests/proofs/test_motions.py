"""Motions with special functions: their integrals are proved, and agree with mpmath."""

import mpmath
import pytest
import sympy as sp
from flint import arb

import geomtorsion as gt
from geomtorsion.support.precision import ball_precision
from tests.rounding import ROUNDED

X = sp.Symbol("x", real=True)
PRIME = {"airyaiprime": lambda x: mpmath.airyai(x, derivative=1)}
THIRD = sp.Rational(1, 3)
# Functions with the start of the interval of length one over which they are integrated.
FUNCTIONS = [
    (sp.besselj(1, X), 1), (sp.besselj(0, X), -0.5), (sp.besselj(THIRD, X), 1),
    (sp.bessely(2, X), 1), (sp.besseli(0, X), -0.5), (sp.besselk(0, X), 1), (sp.gamma(X), 1),
    (sp.loggamma(X), 1), (sp.polygamma(1, X), 1), (sp.airyai(X), -0.5),
    (sp.airybi(X) + sp.airyaiprime(X), 0.25), (sp.LambertW(X), -0.25),
    (sp.LambertW(-X / 8, -1), 1), (sp.expint(2, X), 1), (sp.erf(X), -0.5), (sp.erfc(X), 0.5),
    (sp.erfi(X), 0.5), (sp.Si(X), 0.5), (sp.Ci(X), 1), (sp.Shi(X), 1), (sp.Chi(X), 1),
    (sp.li(X), 2), (sp.Ei(X), -2), (sp.uppergamma(THIRD, X), 1), (sp.lowergamma(THIRD, X), 1),
    (sp.beta(X, X + 1), 1),
]  # fmt: skip


@pytest.mark.parametrize(("function", "start"), FUNCTIONS, ids=str)
def test_integrals_of_special_functions(function, start):
    """y' = f(x) with x' = 1 is proved, and its ball contains the integral."""
    solution = gt.solve(gt.ODE.of({"x": 1, "y": function}, [start, 0]), 1.0)
    proof = gt.prove(solution)
    assert proof.holds is True
    with mpmath.workdps(30):
        truth = mpmath.quad(sp.lambdify(X, function, [PRIME, "mpmath"]), [start, start + 1])
        text = mpmath.nstr(truth, 25)
    with ball_precision(120):
        ball = proof.balls[-1][1]
        assert ball.overlaps(arb(arb(text).mid(), abs(arb(text)) * arb(10) ** -22))
        assert ball.rad() < ROUNDED


def test_a_geodesic_on_a_surface_of_bessel_functions():
    """ds^2 = dr^2 + (2 + J_1(r))^2 dphi^2: Clairaut's constant and the speed are kept."""
    r, phi = sp.symbols("r phi", real=True)
    frame = gt.Frame([r, phi], [[1, 0], [0, 2 + sp.besselj(1, r)]])
    problem = gt.geodesic(frame, [0.5, 0.0], frame_velocity=[0.6, 0.8])
    proof = gt.prove(gt.solve(problem, 2.0))
    assert proof.holds is True
    with ball_precision(120):
        at, _, ahead, across = proof.balls[-1]
        first = (2 + arb(0.5).bessel_j(1)) * arb(0.8)
        assert ((2 + at.bessel_j(1)) * across - first).contains(0)
        assert (ahead**2 + across**2 - arb(0.6) ** 2 - arb(0.8) ** 2).contains(0)

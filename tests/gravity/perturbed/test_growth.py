"""Growth of dust on a cosmos: published strengths of gravity."""

import pytest
import sympy as sp

from geomtorsion import gravity
from geomtorsion.errors import GravityError
from geomtorsion.gravity import perturbed
from tests.chosen import few
from tests.gravity.perturbed.test_scalar_waves import at

a, k, R, phi = sp.symbols("a k R phi")
f, F = sp.Function("f")(R), sp.Function("F")(phi)


def test_general_relativity() -> None:
    growth = perturbed.growth("R/2")
    assert (growth.G, growth.slip) == (1, 1)


def test_functions_of_curvature() -> None:
    """G = (1 + 4 k^2 m / a^2) / (f_R (1 + 3 k^2 m / a^2)), m = f_RR / f_R (Tsujikawa 2007)."""
    mass = k**2 * f.diff(R, 2) / f.diff(R) / a**2
    # L = f(R) / 2 in those units.
    wanted = (1 + 4 * mass) / (2 * f.diff(R) * (1 + 3 * mass))
    growth = perturbed.growth("f(R)")
    assert sp.simplify(growth.G - wanted) == 0
    assert sp.simplify(growth.slip - (1 + 2 * mass) / (1 + 4 * mass)) == 0


def test_massless_coupled_field() -> None:
    """G = (2 F + 4 F'^2) / (F (2 F + 3 F'^2)) (Boisseau et al. 2000)."""
    change = F.diff(phi) ** 2
    wanted = (2 * F + 4 * change) / (F * (2 * F + 3 * change))
    assert sp.simplify(perturbed.growth("F(phi)*R/2 - X/2", scalars="phi").G - wanted) == 0


def test_functions_of_torsion() -> None:
    """G = 1 / f_T where L = R/2 is -T/2 (Zheng and Huang 2011), and no slip."""
    T = sp.Symbol("T")
    slope = sp.Function("f")(T).diff(T)
    growth = perturbed.growth("f(T)", "teleparallel")
    assert sp.simplify(growth.G + 1 / (2 * slope)) == 0
    assert growth.slip == 1
    assert perturbed.growth("-T/2", "teleparallel").G == 1
    opposite = perturbed.growth(gravity.tegr).G
    assert opposite == -sp.Rational(1, 2)


def test_functions_of_nonmetricity() -> None:
    """G = 1 / f_Q where L = R/2 is -Q/2, and no slip (Jimenez et al. 2020)."""
    Q = sp.Symbol("Q")
    growth = perturbed.growth("f(Q)", "symmetric teleparallel")
    assert sp.simplify(growth.G + 1 / (2 * sp.Function("f")(Q).diff(Q))) == 0
    assert growth.slip == 1
    assert perturbed.growth("-Q/2", "symmetric teleparallel").G == 1


@pytest.mark.parametrize(
    ("lagrangian", "geometry"),
    [
        ("-T/2 - X/2 - V(phi)", "teleparallel"),
        ("-Q/2 + K(phi, X)", "symmetric teleparallel"),
        ("R/2 - X/2 - V(phi)", "riemannian"),
    ],
)
def test_a_field_that_couples_to_nothing_changes_nothing(lagrangian: str, geometry: str) -> None:
    """A minimally coupled field leaves G = 1 and no slip, in each of the three equivalents of R."""
    growth = perturbed.growth(lagrangian, geometry, scalars="phi")
    assert (growth.G, growth.slip) == (1, 1)


@pytest.mark.parametrize(
    "lagrangian",
    few(
        2,
        [
            "R/2 - X/2 + B(phi, X)*Box(phi)",
            "F(phi)*R/2 + K(X) + B(phi, X)*Box(phi)",
            "R/2 - X/2 + f(phi)*GB",
            "-X/2 + P(phi, X)*R - 2*Derivative(P(phi, X), X)*(Box(phi)**2 - hessian2)",
            # The same with a function that is known, which takes a fifth of the time.
            "-X/2 + (1/2 + phi*X**2/5)*R - 4*phi*X/5*(Box(phi)**2 - hessian2)",
        ],
    ),
)
def test_horndeski(lagrangian: str) -> None:
    """G and slip by alpha_B, alpha_M, alpha_T (Gleyzes, Langlois and Vernizzi 2014)."""
    growth = perturbed.growth(lagrangian, scalars="phi")
    scalar = perturbed.scalar_modes(lagrangian, scalars="phi")
    tensor = perturbed.tensor_modes(lagrangian, "riemannian", scalars="phi")
    t = sp.Symbol("t")
    H = sp.Function("H")(t)
    rate = {H.diff(t): scalar.background[1].rhs}

    def value(expression: sp.Expr) -> sp.Expr:
        return at(expression.xreplace(rate))

    mass, excess, running = map(value, (tensor.kinetic, tensor.alpha_T, tensor.alpha_M))
    # The lapse is zeta' / (H (1 + alpha_B)), and Q_s = M^2 alpha / (2 (1 + alpha_B)^2).
    braiding = 1 / value(H * scalar.lapse) - 1
    weight = 2 * value(scalar.kinetic) * (1 + braiding) ** 2 / mass * value(scalar.speed2)
    mixing = braiding * (1 + excess) + excess - running
    strength = 1 + excess + 2 * mixing**2 / weight
    assert value(growth.G) == strength / mass
    assert value(growth.slip) == (1 + 2 * braiding * mixing / weight) / strength


@pytest.mark.parametrize(
    ("call", "words"),
    [
        (lambda: perturbed.growth("f(Q) + Q1", "symmetric teleparallel"), "function of Q"),
        (
            lambda: perturbed.growth("f(T, phi) - X/2", "teleparallel", scalars="phi"),
            "contains phi and T",
        ),
        (lambda: perturbed.growth("T + axial2", "teleparallel"), "function of T"),
        (lambda: perturbed.growth("T", "poincare"), "riemannian"),
        (lambda: perturbed.growth("f(R, GB)"), "rates"),
        (lambda: perturbed.growth("GB"), "term of gravity"),
        (lambda: perturbed.growth("R/2 + a*R**2", constants="a"), "another name"),
    ],
)
def test_refusals(call, words: str) -> None:
    with pytest.raises(GravityError, match=words):
        call()

"""Growth of dust on a cosmos: published strengths of gravity."""

import pytest
import sympy as sp

from geomtorsion.errors import GravityError
from geomtorsion.gravity import perturbed

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


@pytest.mark.parametrize(
    ("call", "words"),
    [
        (lambda: perturbed.growth("f(T)", "teleparallel"), "riemannian"),
        (lambda: perturbed.growth("R/2 - X/2 + f(phi)*GB", scalars="phi"), "rates"),
        (lambda: perturbed.growth("f(R, GB)"), "rates"),
        (lambda: perturbed.growth("GB"), "term of gravity"),
        (lambda: perturbed.growth("R/2 + a*R**2", constants="a"), "another name"),
    ],
)
def test_refusals(call, words: str) -> None:
    with pytest.raises(GravityError, match=words):
        call()

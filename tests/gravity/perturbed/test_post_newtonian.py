"""Post-Newtonian numbers: gamma, beta and G as published."""

import pytest
import sympy as sp

from geomtorsion.errors import GeomtorsionError
from geomtorsion.gravity import perturbed
from tests.chosen import few

om, c, M, k, phi0 = sp.symbols("om c M k phi0")
F = sp.Function("F")(phi0)
F1, F2 = F.diff(phi0), F.diff(phi0, 2)

PUBLISHED = [
    ("R/2", "riemannian", "", 1, 1, 1),
    ("-T/2", "teleparallel", "", 1, 1, 1),
    ("-Q/2", "symmetric teleparallel", "", 1, 1, 1),
    # Ualikhanova and Hohmann (2019): every f(T) agrees with general relativity.
    ("-T/2 + c*T**2", "teleparallel", "", 1, 1, 1),
    ("-T/2 + c*axial2", "teleparallel", "", 1, 1, 1),
    # Brans and Dicke (1961), Will (1993).
    ("phi*R/2 - om*X/(2*phi)", "riemannian", "phi", (1 + om) / (2 + om), 1,
     (4 + 2 * om) / (3 + 2 * om) / phi0),
    # Damour and Esposito-Farese (1992).
    ("F(phi)*R/2 - X/2", "riemannian", "phi", (F + F1**2) / (F + 2 * F1**2),
     1 + F * F1**2 * (F1**2 - 2 * F * F2) / (4 * (2 * F + 3 * F1**2) * (F + 2 * F1**2) ** 2),
     (2 * F + 4 * F1**2) / (2 * F + 3 * F1**2) / F),
    # New general relativity, Hayashi and Shirafuji (1979).
    ("T + c*vector2", "teleparallel", "", (2 * c - 3) / (4 * c - 3),
     (7 * c - 6) / (2 * (4 * c - 3)), None),
]  # fmt: skip


@pytest.mark.parametrize(
    ("lagrangian", "geometry", "scalars", "gamma", "beta", "G"), few(4, PUBLISHED)
)
def test_published_parameters(
    lagrangian: str, geometry: str, scalars: str, gamma: sp.Expr, beta: sp.Expr, G: sp.Expr | None
) -> None:
    weak = perturbed.post_newtonian(lagrangian, geometry, scalars=scalars)
    assert sp.factor(weak.gamma - gamma) == 0
    assert sp.factor(weak.beta - beta) == 0
    assert G is None or sp.factor(weak.G - G) == 0


def test_unknown_functions() -> None:
    """f(T): 1, 1 (Ualikhanova and Hohmann 2019); f(R): a scalar of m^2 = f_R/(3 f_RR)."""
    weak = perturbed.post_newtonian("f(T)", "teleparallel")
    f_T = sp.Symbol("f_T")
    assert (weak.gamma, weak.beta) == (1, 1)
    assert sp.cancel(weak.G + 1 / (2 * f_T)) == 0
    assert "L = f(T)" in str(weak)
    massive = perturbed.post_newtonian("f(R)", "riemannian")
    with pytest.raises(GeomtorsionError, match=r"m\^2 = f_R/\(3\*f_RR\)"):
        _ = massive.gamma


def test_a_mass_makes_gamma_depend_on_the_distance() -> None:
    """R + R^2/(6 M^2): gamma = (1 - x/3)/(1 + x/3), G = 1 + x/3 with x = k^2/(k^2 + M^2)."""
    weak = perturbed.post_newtonian("R/2 + R**2/(12*M**2)", "riemannian", constants="M")
    x = k**2 / (k**2 + M**2)
    assert sp.factor(weak.gamma_of_k - (1 - x / 3) / (1 + x / 3)) == 0
    assert sp.factor(weak.G_of_k - 1 - x / 3) == 0
    for name in ("gamma", "beta", "G"):
        with pytest.raises(GeomtorsionError, match=r"m\^2 = M\*\*2"):
            getattr(weak, name)


def test_the_spectrum_has_the_same_mass() -> None:
    lagrangian = "R/2 + c*R**2"
    weak = perturbed.post_newtonian(lagrangian, "riemannian")
    (scalar,) = [
        x for x in perturbed.spectrum(lagrangian, "riemannian").particles if not x.is_massless
    ]
    assert scalar.mass2 is not None
    bottom = sp.denom(sp.factor(weak.G_of_k)).subs(k, sp.sqrt(-scalar.mass2))
    assert sp.simplify(bottom) == 0


def test_a_massive_scalar_with_a_value_far_away() -> None:
    """Brans and Dicke with a mass: gamma = (1 + om - y)/(2 + om ...) between both limits."""
    weak = perturbed.post_newtonian(
        "phi*R/2 - om*X/(2*phi) - m*(phi - 1)**2/2", "riemannian", scalars="phi", far={"phi": 1}
    )
    near, far = sp.limit(weak.gamma_of_k, k, sp.oo), weak.gamma_of_k.subs(k, 0)
    assert sp.factor(near - (1 + om) / (2 + om)) == 0
    assert far == 1


@pytest.mark.parametrize(
    ("call", "words"),
    [
        (lambda: perturbed.post_newtonian("R/2 + Lambda", "riemannian"), "flat space solves"),
        (lambda: perturbed.post_newtonian("R/2", "poincare"), "perturbed.spectrum"),
        (lambda: perturbed.post_newtonian("R/2 + k*R**2", "riemannian"), "another name"),
        (lambda: perturbed.post_newtonian("R", "teleparallel").gamma, "determine the field"),
        (
            lambda: perturbed.post_newtonian("R/2", "riemannian", far={"phi": 1}),
            "scalar field",
        ),
    ],
)
def test_refusals(call, words: str) -> None:
    with pytest.raises(GeomtorsionError, match=words):
        call()

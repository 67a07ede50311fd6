"""Gravitational waves on a cosmos: published speeds, frictions and Planck masses."""

import pytest
import sympy as sp

from geomtorsion import gravity
from geomtorsion.errors import GeomtorsionError
from geomtorsion.gravity import perturbed
from tests.chosen import few

t = sp.Symbol("t")
H, phi = sp.Function("H")(t), sp.Function("phi")(t)
speed = phi.diff(t)
f, F = sp.Function("f"), sp.Function("F")
R, S, Q = sp.symbols("R T Q")
# The value of an invariant on the cosmos, for derivatives by the time.
VALUES = {S: 6 * H**2, Q: 6 * H**2, R: 12 * H**2 + 6 * H.diff(t)}


@pytest.mark.parametrize(
    ("lagrangian", "geometry", "kinetic"),
    [
        ("R/2", "riemannian", 1),
        ("-T/2", "teleparallel", 1),
        ("-Q/2", "symmetric teleparallel", 1),
        # Einstein's waves: M^2 = 2 f'(R), -2 f'(T), -2 f'(Q).
        ("f(R)", "riemannian", 2 * f(R).diff(R)),
        ("f(T)", "teleparallel", -2 * f(S).diff(S)),
        ("f(Q)", "symmetric teleparallel", -2 * f(Q).diff(Q)),
    ],
)
def test_functions_of_one_invariant(lagrangian: str, geometry: str, kinetic: sp.Expr) -> None:
    """Waves move with the speed of light; the friction is 3 H + d ln f' / dt."""
    waves = perturbed.tensor_modes(lagrangian, geometry)
    assert waves.kinetic - kinetic == 0
    assert (waves.speed2, waves.alpha_T) == (1, 0)
    assert sp.simplify(waves.friction - 3 * H - H * waves.alpha_M) == 0


def test_torsion_scalar_beside_the_curvature_of_the_metric() -> None:
    """Functions of T and of the boundary term Rbar + T, or of Rbar (Farrugia et al. 2018).

    Only the derivative by T counts for the waves, and c_T = 1.
    """
    waves = perturbed.tensor_modes("f(T, Rbar + T)", "teleparallel")
    assert "M^2 = -2*f_T" in str(waves)
    assert waves.speed2 == 1
    explicit = perturbed.tensor_modes("-T/2 + c*(Rbar + T)**2", "teleparallel")
    assert (explicit.kinetic, explicit.friction) == (1, 3 * H)
    assert perturbed.tensor_modes("Rbar/2", "teleparallel").kinetic == 1


def test_running_of_the_planck_mass() -> None:
    """d ln f'/d ln a for f = R + c R^2, in numbers of a power law a = t^p."""
    c = sp.Symbol("c")
    waves = perturbed.tensor_modes("R/2 + c*R**2", "riemannian")
    slope = sp.Rational(1, 2) + 2 * c * VALUES[R]
    wanted = sp.diff(slope, t) / (slope * H)
    power = {H: sp.Rational(2, 3) / t}
    assert sp.simplify((waves.alpha_M - wanted).subs(power).doit()) == 0
    assert sp.simplify((waves.kinetic - 2 * slope).subs(power).doit()) == 0


# Horndeski (Kobayashi, Yamaguchi and Yokoyama 2011): M^2 = G_T, c_T^2 = F_T / G_T.
COUPLING = f(phi)
KINETIC = gravity.invariant("J", "G_ab phi^a phi^b")
HORNDESKI = [
    ("F(phi)*R - X/2", (), 2 * F(phi), 1),
    (
        "R/2 - X/2 + f(phi)*GB",
        (),
        1 + 8 * H * COUPLING.diff(t),
        (1 + 8 * COUPLING.diff(t, 2)) / (1 + 8 * H * COUPLING.diff(t)),
    ),
    (
        "R/2 - X/2 + kappa*J",
        KINETIC,
        1 - sp.Symbol("kappa") * speed**2,
        (1 + sp.Symbol("kappa") * speed**2) / (1 - sp.Symbol("kappa") * speed**2),
    ),
]


@pytest.mark.parametrize(("lagrangian", "invariants", "kinetic", "speed2"), few(3, HORNDESKI))
def test_scalar_tensor_theories(
    lagrangian: str, invariants: object, kinetic: sp.Expr, speed2: sp.Expr
) -> None:
    waves = perturbed.tensor_modes(
        lagrangian,
        "riemannian",
        scalars="phi",
        invariants=invariants,  # type: ignore[arg-type]
    )
    # An example of a function and a field decides: polynomials of t have no common zeros.
    example = {sp.Function("phi"): lambda s: 1 + s + s**3, sp.Function("H"): lambda s: 2 + s**2}

    def at(expression: sp.Expr) -> sp.Expr:
        named = expression.replace(lambda x: x == sp.Symbol("phi"), lambda _: phi)
        for one, value in ((f, lambda s: s**3 + s), (F, lambda s: 2 + s**2), *example.items()):
            named = named.replace(one, value).doit()
        return sp.simplify(named.subs(t, sp.Rational(3, 7)))

    assert at(waves.kinetic) == at(sp.S(kinetic))
    assert at(waves.speed2) == at(sp.S(speed2))
    assert at(waves.friction) == at(3 * H + H * waves.alpha_M)


def test_chern_simons_gravity_changes_the_amplitude() -> None:
    """M^2 = 1 + 16 c s k phi'/a, c_T = 1 (Alexander and Yunes 2009, alpha = 8 c, kappa = 1/2)."""
    c, s, k = sp.symbols("c helicity k")
    waves = perturbed.tensor_modes("R/2 - X/2 + c*phi*pontryagin", "riemannian", scalars="phi")
    assert waves.violates_parity
    assert waves.speed2 == 1
    scale = sp.Function("a")(t)
    assert sp.cancel(waves.kinetic - 1 - 16 * c * s * k * speed / scale) == 0
    growing = {scale.diff(t): H * scale}
    running = (waves.kinetic.diff(t) / waves.kinetic).subs(growing)
    assert sp.simplify(waves.friction - 3 * H - running) == 0
    assert sp.simplify(H * waves.alpha_M - running) == 0
    assert "parity is violated" in str(waves)


def test_nieh_yan_term_changes_the_speed() -> None:
    """k^2 c_T^2 = k^2 + 8 c s a phi' k, friction 3 H (Li, Rao and Zhao 2020, with 8 c for c)."""
    c, s, k = sp.symbols("c helicity k")
    waves = perturbed.tensor_modes("-T/2 - X/2 + c*phi*nieh_yan", "teleparallel", scalars="phi")
    assert (waves.kinetic, waves.friction, waves.alpha_M) == (1, 3 * H, 0)
    assert sp.cancel(waves.alpha_T - 8 * c * s * sp.Function("a")(t) * speed / k) == 0
    values = waves.over_time([1], a="t", phi="t", c="1/8", k=2, helicity=-1).values
    assert values["speed2"].tolist() == [0.5]


def test_a_constant_in_front_of_a_boundary_term_changes_nothing() -> None:
    for lagrangian, geometry in (
        ("R/2 + c*pontryagin", "riemannian"),
        ("-T/2 + c*nieh_yan", "teleparallel"),
    ):
        waves = perturbed.tensor_modes(lagrangian, geometry)
        assert not waves.violates_parity
        assert (waves.kinetic, waves.speed2, waves.friction) == (1, 1, 3 * H)


# Quadratic theories with second derivatives of the field. The second one is Einstein's with the
# metric (1 - X) g_ab, hence degenerate (Zumalacarregui and Garcia-Bellido 2014).
GRADIENT = gravity.invariant("Y", "phi^a phi_ab phi^bc phi_c")
HIGHER = [
    ("R/2 - X/2 + c*Box(phi)**2", {"a": 3, "phi": 4}, False),
    ("(1 - X)*R/2 + 3*Y/(1 - X) - X/2", {"a": 3, "phi": 4}, True),
    ("R/2 - X/2 + c*Y", {"a": 2, "phi": 4}, False),
    ("R/2 + c*R**2 - X/2", {"a": 4, "phi": 2}, False),
]


@pytest.mark.parametrize(("lagrangian", "orders", "degenerate"), HIGHER)
def test_higher_time_derivatives_are_reported(
    lagrangian: str, orders: dict[str, int], degenerate: bool
) -> None:
    """Tensor modes report the orders of the background; scalar modes refuse with this reason."""
    invariants = [GRADIENT] if "Y" in lagrangian else []
    waves = perturbed.tensor_modes(lagrangian, "riemannian", scalars="phi", invariants=invariants)
    assert waves.time_orders.orders == orders
    assert waves.time_orders.is_degenerate is degenerate
    assert waves.speed2 == 1
    kind = ", degenerate" if degenerate else "not degenerate"
    assert f"{kind}" in str(waves).splitlines()[-1]
    with pytest.raises(GeomtorsionError, match=f"second order in time.*{kind}"):
        perturbed.scalar_modes(lagrangian, invariants=invariants)


@pytest.mark.parametrize(
    ("lagrangian", "geometry"),
    [
        ("R/2 - X/2 + c*X*Box(phi)", "riemannian"),
        ("X*R - 2*(Box(phi)**2 - hessian2)", "riemannian"),
        ("R/2 - X/2 + f(phi)*GB", "riemannian"),
        ("f(T) - X/2", "teleparallel"),
        ("f(Q) - X/2", "symmetric teleparallel"),
    ],
)
def test_theories_of_second_order(lagrangian: str, geometry: str) -> None:
    """Horndeski's G3, G4 and G5, f(T) and f(Q) have no higher time derivatives."""
    waves = perturbed.tensor_modes(lagrangian, geometry, scalars="phi")
    assert str(waves.time_orders) == "second order"
    assert "higher" not in str(waves)


@pytest.mark.parametrize(
    ("term", "words"),
    [
        ("sqrt(X)", r"Write sqrt\(-X\)"),
        ("log(X)", r"log\(-X\)"),
        ("X**(3/2)", r"\(-X\)\*\*\(3/2\)"),
    ],
)
def test_roots_of_a_negative_number_are_refused(term: str, words: str) -> None:
    """X = -phi'^2: each report on a cosmos refuses sqrt(X) and offers sqrt(-X)."""
    lagrangian = f"R/2 + {term}"
    for report in (perturbed.tensor_modes, perturbed.scalar_modes, perturbed.growth):
        with pytest.raises(GeomtorsionError, match=words):
            report(lagrangian, "riemannian", scalars="phi")


@pytest.mark.parametrize(
    ("call", "words"),
    [
        (lambda: perturbed.tensor_modes("R/2", "poincare"), "perturbed.spectrum"),
        (lambda: perturbed.tensor_modes("R/2 + b*P1", "riemannian"), "second order"),
        (lambda: perturbed.tensor_modes("GB", "riemannian"), "got none for"),
        (lambda: perturbed.tensor_modes("0*R", "riemannian"), "got none for"),
        (lambda: perturbed.tensor_modes("R/2 - X/2", "riemannian"), "X"),
        (
            lambda: perturbed.tensor_modes(
                "R/2 - X/2 + k*phi*pontryagin", "riemannian", scalars="phi"
            ),
            "another name",
        ),
    ],
)
def test_refusals(call, words: str) -> None:
    with pytest.raises(GeomtorsionError, match=words):
        call()

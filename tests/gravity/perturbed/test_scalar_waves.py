"""Scalar waves on a cosmos: published kinetic factors, speeds and backgrounds."""

from dataclasses import dataclass, field

import pytest
import sympy as sp

from geomtorsion import gravity
from geomtorsion.errors import GeomtorsionError, GravityError
from geomtorsion.gravity import perturbed
from tests.chosen import few

p, x = sp.symbols("p x", positive=True)
time = sp.Symbol("t")
H, phi = sp.Function("H")(time), sp.Function("phi")(time)
speed = phi.diff(time)
HALF = sp.Rational(1, 2)
# Examples of functions, and numbers for the expansion and the field at one instant.
EXAMPLES = {
    "V": lambda s: 1 + s**3,
    "F": lambda s: 2 + s**2,
    "f": lambda s: s**5 / 7 + s / 3,
    "K": lambda s: -s + s**2 / 5 + s**3 / 11,
    "B": lambda s, y: s**2 * y - y**2 / 3,
    "P": lambda s, y: HALF + s * y**2 / 5 - y**3 / 13,
    "S": lambda s, y: s * y / 7 - y**2 / 17,
}
V, F, f, K, B, P, S = (EXAMPLES[name] for name in "VFfKBPS")
NUMBERS = {
    phi.diff(time, 3): sp.Rational(3, 11),
    phi.diff(time, 2): sp.Rational(-2, 5),
    speed: sp.Rational(3, 2),
    phi: sp.Rational(4, 3),
    H: sp.Rational(5, 7),
}


def at(expression: sp.Expr) -> sp.Expr:
    """The value of a result at the numbers, with the examples for its functions."""
    expression = sp.sympify(expression)
    for name, example in EXAMPLES.items():
        expression = expression.replace(sp.Function(name), example)
    names = {sp.Symbol("X"): -(speed**2), sp.Symbol("phi"): phi}
    expression = expression.doit().subs(names, simultaneous=True)
    return sp.expand(expression.xreplace(NUMBERS))


@dataclass(frozen=True)
class Horndeski:
    """L = G2 - G3 Box phi + G4 R + G4_x (...) + G5 G_ab phi^ab + ..., of p = phi, x = phi'^2/2.

    Kobayashi, Yamaguchi and Yokoyama (2011) for the background, tensor and scalar waves.
    """

    G2: sp.Expr = field(default=sp.S.Zero)
    G3: sp.Expr = field(default=sp.S.Zero)
    G4: sp.Expr = field(default=sp.S.Zero)
    G5: sp.Expr = field(default=sp.S.Zero)

    def __add__(self, other: "Horndeski") -> "Horndeski":
        pairs = ("G2", "G3", "G4", "G5")
        return Horndeski(*(getattr(self, k) + getattr(other, k) for k in pairs))

    @property
    def energy(self) -> sp.Expr:
        G2, G3, G4, G5, d = self.G2, self.G3, self.G4, self.G5, sp.diff
        return in_time(
            2 * x * d(G2, x) - G2 - 2 * x * d(G3, p) - 6 * H**2 * G4,
            6 * x * speed * H * d(G3, x) + 24 * H**2 * x * (d(G4, x) + x * d(G4, x, x)),
            -12 * H * x * speed * d(G4, p, x) - 6 * H * speed * d(G4, p),
            2 * H**3 * x * speed * (5 * d(G5, x) + 2 * x * d(G5, x, x)),
            -6 * H**2 * x * (3 * d(G5, p) + 2 * x * d(G5, p, x)),
        )

    @property
    def pressure(self) -> sp.Expr:
        G2, G3, G4, G5, d = self.G2, self.G3, self.G4, self.G5, sp.diff
        rate, second, change = H.diff(time), phi.diff(time, 2), speed * phi.diff(time, 2)
        return in_time(
            G2 - 2 * x * (d(G3, p) + second * d(G3, x)) + 2 * (3 * H**2 + 2 * rate) * G4,
            -(12 * H**2 * x + 4 * H * change + 8 * rate * x) * d(G4, x),
            -8 * H * x * change * d(G4, x, x) + 2 * (second + 2 * H * speed) * d(G4, p),
            4 * x * d(G4, p, p) + 4 * x * (second - 2 * H * speed) * d(G4, p, x),
            -2 * x * (2 * H**3 * speed + 2 * H * rate * speed + 3 * H**2 * second) * d(G5, x),
            -4 * H**2 * x**2 * second * d(G5, x, x) + 4 * H * x * (change - H * x) * d(G5, p, x),
            2 * (2 * (rate * x + H * change) + 3 * H**2 * x) * d(G5, p),
            4 * H * x * speed * d(G5, p, p),
        )

    @property
    def rate(self) -> sp.Expr:
        """H' from the sum of the two equations of the background."""
        (value,) = sp.solve(self.energy + self.pressure, H.diff(time))
        return value

    @property
    def tensor(self) -> tuple[sp.Expr, sp.Expr]:
        """F_T and G_T."""
        G4, G5, d = self.G4, self.G5, sp.diff
        return (
            in_time(2 * (G4 - x * (phi.diff(time, 2) * d(G5, x) + d(G5, p)))),
            in_time(2 * (G4 - 2 * x * d(G4, x) - x * (H * speed * d(G5, x) - d(G5, p)))),
        )

    @property
    def scalar(self) -> tuple[sp.Expr, sp.Expr]:
        """F_S and G_S."""
        G2, G3, G4, G5, d = self.G2, self.G3, self.G4, self.G5, sp.diff
        sigma = in_time(
            x * d(G2, x) + 2 * x**2 * d(G2, x, x) + 12 * H * speed * x * d(G3, x),
            6 * H * speed * x**2 * d(G3, x, x) - 2 * x * d(G3, p) - 2 * x**2 * d(G3, p, x),
            -6 * H**2 * G4,
            6 * H**2 * (7 * x * d(G4, x) + 16 * x**2 * d(G4, x, x) + 4 * x**3 * d(G4, x, x, x)),
            -6 * H * speed * (d(G4, p) + 5 * x * d(G4, p, x) + 2 * x**2 * d(G4, p, x, x)),
            30 * H**3 * speed * x * d(G5, x) + 26 * H**3 * speed * x**2 * d(G5, x, x),
            4 * H**3 * speed * x**3 * d(G5, x, x, x),
            -6 * H**2 * x * (6 * d(G5, p) + 9 * x * d(G5, p, x) + 2 * x**2 * d(G5, p, x, x)),
        )
        theta = in_time(
            -speed * x * d(G3, x) + 2 * H * G4 - 8 * H * x * d(G4, x) - 8 * H * x**2 * d(G4, x, x),
            speed * d(G4, p) + 2 * x * speed * d(G4, p, x),
            -(H**2) * speed * (5 * x * d(G5, x) + 2 * x**2 * d(G5, x, x)),
            2 * H * x * (3 * d(G5, p) + 2 * x * d(G5, p, x)),
        )
        F_T, G_T = self.tensor
        mixed = G_T**2 / theta
        return mixed.diff(time) + H * mixed - F_T, sigma * mixed / theta + 3 * G_T


def in_time(*terms: sp.Expr) -> sp.Expr:
    """A sum of terms, with phi(t) for p and phi'^2/2 for x."""
    return sp.Add(*terms).subs({x: speed**2 / 2, p: phi}, simultaneous=True)


KAPPA = sp.Rational(2, 9)
KINETIC = gravity.invariant("J", "G_ab phi^a phi^b")
CUBE = gravity.invariant(
    "Z", "phi_a^a phi_b^b phi_c^c - 3 phi_a^a phi_bc phi^bc + 2 phi_a^b phi_b^c phi_c^a"
)
EINSTEIN_HESSIAN = gravity.invariant("W", "G_ab phi^ab")
EINSTEIN = Horndeski(G4=HALF)
CANONICAL = Horndeski(G2=x)
# The X of a Lagrangian is g^ab phi_a phi_b = -2 x.
K_ESSENCE = Horndeski(G2=K(-2 * x))
GAUSS_BONNET = Horndeski(
    8 * sp.diff(f(p), p, 4) * x**2 * (3 - sp.log(x)),
    4 * sp.diff(f(p), p, 3) * x * (7 - 3 * sp.log(x)),
    4 * sp.diff(f(p), p, 2) * x * (2 - sp.log(x)),
    -4 * sp.diff(f(p), p) * sp.log(x),
)
THEORIES = [
    ("R/2 - X/2 - V(phi)", EINSTEIN + CANONICAL + Horndeski(G2=-V(p))),
    ("R/2 + K(X)", EINSTEIN + K_ESSENCE),
    ("F(phi)*R/2 - X/2 - V(phi)", Horndeski(x - V(p), G4=F(p) / 2)),
    ("R/2 - X/2 + f(phi)*GB", EINSTEIN + CANONICAL + GAUSS_BONNET),
    # A partial integration turns one form of this coupling into the other.
    ("R/2 - X/2 + 2*J/9", EINSTEIN + CANONICAL + Horndeski(G5=-KAPPA * p)),
    ("R/2 - X/2 + 2*J/9", EINSTEIN + CANONICAL + Horndeski(G4=KAPPA * x)),
    (
        "F(phi)*R/2 + K(X) - V(phi) + f(phi)*GB + 2*J/9",
        Horndeski(-V(p), G4=F(p) / 2 + KAPPA * x) + K_ESSENCE + GAUSS_BONNET,
    ),
    ("R/2 + K(X) + B(phi, X)*Box(phi)", EINSTEIN + K_ESSENCE + Horndeski(G3=-B(p, -2 * x))),
    (
        "-X/2 + P(phi, X)*R - 2*Derivative(P(phi, X), X)*(Box(phi)**2 - hessian2)",
        Horndeski(x, G4=P(p, -2 * x)),
    ),
    (
        "R/2 - X/2 - V(phi) + S(phi, X)*W + Derivative(S(phi, X), X)*Z/3",
        EINSTEIN + Horndeski(x - V(p), G5=S(p, -2 * x)),
    ),
    # The same with a function that is known, which takes a tenth of the time.
    ("R/2 - X/2 - V(phi) + phi*X*W + phi*Z/3", EINSTEIN + Horndeski(x - V(p), G5=-2 * p * x)),
]


@pytest.mark.parametrize(("lagrangian", "published"), few(3, THEORIES))
def test_horndeski(lagrangian: str, published: Horndeski) -> None:
    """Q_s = G_S, c_s^2 = F_S / G_S and the friction 3 H + d ln G_S / dt, in exact numbers."""
    invariants = [one for one in (KINETIC, EINSTEIN_HESSIAN, CUBE) if one.name in lagrangian]
    waves = perturbed.scalar_modes(lagrangian, scalars="phi", invariants=invariants)
    F_S, G_S = published.scalar
    rate = {H.diff(time): published.rate}
    assert at(waves.kinetic - G_S) == 0
    assert sp.expand(at(waves.speed2) * at(G_S) - at(F_S.subs(rate))) == 0
    friction = sp.expand((at(waves.friction) - at(3 * H)) * at(G_S))
    assert friction == at(G_S.diff(time).subs(rate))
    friedmann, change = waves.background
    assert sp.expand(at(friedmann.lhs) + at(published.energy)) == 0
    assert (change.lhs, sp.expand(at(change.rhs) - at(published.rate))) == (H.diff(time), 0)


@pytest.mark.parametrize(
    "lagrangian", ["R/2 - X/2 - V(phi)", "R/2 - X/2 - m**2*phi**2/2", "F(phi)*R/2 - X/2 - V(phi)"]
)
def test_canonical_fields_move_with_the_speed_of_light(lagrangian: str) -> None:
    assert perturbed.scalar_modes(lagrangian).speed2 == 1


def test_k_essence() -> None:
    """c_s^2 = K_X / (K_X + 2 X K_XX) (Garriga and Mukhanov 1999)."""
    one, X = sp.Function("K"), sp.Symbol("X")
    slope = one(X).diff(X)
    wanted = slope / (slope - 2 * speed**2 * one(X).diff(X, 2))
    waves = perturbed.scalar_modes("R/2 + K(X) - V(phi)")
    assert sp.simplify(waves.speed2 - wanted) == 0


def test_coupled_field_of_de_felice_and_tsujikawa() -> None:
    """Q_s = (phi'^2 + 3 F'^2 / (2 F)) / (2 (H + F' / (2 F))^2) with F' = dF/dt (2010)."""
    coupling = F(phi)
    change = coupling.diff(time)
    wanted = (speed**2 + 3 * change**2 / (2 * coupling)) / (2 * (H + change / (2 * coupling)) ** 2)
    assert at(perturbed.scalar_modes("F(phi)*R/2 - X/2 - V(phi)").kinetic - wanted) == 0


def test_ghost() -> None:
    """A field with the other sign of its kinetic term has a negative Q_s."""
    assert at(perturbed.scalar_modes("R/2 + X/2 - V(phi)").kinetic) < 0


def test_wave_equation_and_name_of_the_field() -> None:
    """A massless field with its own name: H' = -s'^2/2, and a stiff cosmos solves it."""
    waves = perturbed.scalar_modes("R/2 - X/2", scalars="s")
    s, zeta, a = sp.Function("s")(time), sp.Function("zeta")(time, sp.Symbol("z")), sp.Function("a")
    stiff = {H: 1 / (3 * time), s: sp.sqrt(sp.Rational(2, 3)) * sp.log(time)}
    for equation in waves.background:
        assert sp.simplify((equation.lhs - equation.rhs).subs(stiff).doit()) == 0
    wave = zeta.diff(time, 2) + zeta.diff(time) / time
    wave -= zeta.diff(sp.Symbol("z"), 2) / a(time) ** 2
    assert sp.simplify((waves.equation.lhs.subs(stiff).doit()) - wave) == 0


@pytest.mark.parametrize(
    ("call", "words"),
    [
        (lambda: perturbed.scalar_modes("R/2", scalars=""), "one scalar field, got 0"),
        (lambda: perturbed.scalar_modes("R/2"), "X or phi"),
        (lambda: perturbed.scalar_modes("R/2 - X/2", scalars="phi, s"), "got 2"),
        (lambda: perturbed.scalar_modes("R/2 - X/2", "poincare"), "riemannian"),
        (lambda: perturbed.scalar_modes("-T/2 - X/2", "teleparallel"), "riemannian"),
        (lambda: perturbed.scalar_modes("R/2 - X/2", "conformal"), "geometry"),
        (lambda: perturbed.scalar_modes("f(R) - X/2"), "second order"),
        (lambda: perturbed.scalar_modes("R/2 - X/2 + c*P1", constants="c"), "second order"),
        (lambda: perturbed.scalar_modes("R/2 - V(phi)"), "Add a kinetic term"),
        (lambda: perturbed.scalar_modes("-X/2"), "term of gravity"),
        (lambda: perturbed.scalar_modes("R/2 + mu*sqrt(-X) - V(phi)"), "cuscuton"),
        (lambda: perturbed.scalar_modes("R/2 + Box(phi)"), "Add a kinetic term"),
        (lambda: perturbed.scalar_modes("R/2 - X/2 + hessian2"), "second order"),
        (lambda: perturbed.scalar_modes("R/2 - X/2", scalars="N"), "Rename"),
        (lambda: perturbed.tensor_modes("R/2 - X/2", "riemannian", scalars="h"), "Rename"),
    ],
)
def test_refusals(call, words: str) -> None:
    with pytest.raises(GravityError, match=words):
        call()


def test_unknown_names_are_refused() -> None:
    with pytest.raises(GeomtorsionError, match="Y"):
        perturbed.scalar_modes("R/2 - Y/2")

"""Newman-Penrose: scalars of known spaces, and the Petrov type for different tetrads."""

import pytest
import sympy as sp

import geomtorsion as gt
from geomtorsion.gravity import NewmanPenrose, newman_penrose

t, r, theta, phi, M, Q, H = sp.symbols("t r theta phi M Q H", positive=True)
u, v, x, y = sp.symbols("u v x y", real=True)
MINUS = [[0, -1, 0, 0], [-1, 0, 0, 0], [0, 0, 0, 1], [0, 0, 1, 0]]
PLUS = [[-value for value in row] for row in MINUS]
ROOT = 1 / sp.sqrt(2)


def null_tetrad(symbols: list, coframe: sp.Matrix, signature: list = MINUS) -> gt.Frame:
    """The null tetrad l, n, m, m_bar from an orthonormal tetrad e0, e1, e2, e3."""
    # Rows are one-forms: e^l = (e^0 + e^1)/sqrt2 belongs to the leg l = (e_0 + e_1)/sqrt2.
    turn = sp.Matrix([[1, 1, 0, 0], [1, -1, 0, 0], [0, 0, 1, -sp.I], [0, 0, 1, sp.I]]) * ROOT
    return gt.Frame(symbols, turn * coframe, signature=signature, complex=True)


def static(f: sp.Expr, signature: list = MINUS) -> gt.Frame:
    """Static spherical null tetrad with f = -g_tt = 1/g_rr."""
    rows = sp.diag(sp.sqrt(f), 1 / sp.sqrt(f), r, r * sp.sin(theta))
    return null_tetrad([t, r, theta, phi], rows, signature)


def test_kerr() -> None:
    """Psi_2 = -M/(r - i a cos(theta))^3; all other scalars vanish."""
    frame = gt.spaces.load("kerr_kinnersley").frame
    kerr = newman_penrose(frame)
    radius, angle = frame.coordinates[1:3]
    mass, spin = frame.parameters
    assert [kerr.psi[k] for k in (0, 1, 3, 4)] == [0, 0, 0, 0]
    expected = -mass / (radius - sp.I * spin * sp.cos(angle)) ** 3
    assert frame.scalar(kerr.psi[2]) == expected
    assert set(kerr.phi.values()) == {0}
    assert kerr.curvature_scalar == 0
    assert str(kerr).startswith("Petrov type D\n  Psi_2 = ")


def test_spin_coefficients_of_kerr() -> None:
    """Kinnersley's tetrad as in Teukolsky (1973): rho = -1/(r - i a cos(theta)) and the others."""
    frame = gt.spaces.load("kerr_kinnersley").frame
    found = newman_penrose(frame).spin_coefficients
    radius, angle = frame.coordinates[1:3]
    mass, spin = frame.parameters
    rho = -1 / (radius - sp.I * spin * sp.cos(angle))
    star = -1 / (radius + sp.I * spin * sp.cos(angle))
    delta = radius**2 - 2 * mass * radius + spin**2
    slant = sp.I * spin * sp.sin(angle) / sp.sqrt(2)
    beta = -star * sp.cos(angle) / sp.sin(angle) / (2 * sp.sqrt(2))
    mu = rho**2 * star * delta / 2
    known = {
        "rho": rho, "beta": beta, "pi": slant * rho**2, "tau": -slant * rho * star, "mu": mu,
        "gamma": mu + rho * star * (radius - mass) / 2,
        "alpha": slant * rho**2 + rho * sp.cos(angle) / sp.sin(angle) / (2 * sp.sqrt(2)),
        "kappa": 0, "sigma": 0, "lambda": 0, "nu": 0, "epsilon": 0,
    }  # fmt: skip
    assert found.keys() == known.keys()
    for name, value in known.items():
        assert frame.scalar(found[name]) == value, name


def test_spin_coefficients_do_not_depend_on_the_signature() -> None:
    """Both signatures have the same coefficients; rho and mu measure the growth of spheres."""
    one, other = (newman_penrose(static(1 - 2 * M / r, x)) for x in (MINUS, PLUS))
    assert one.spin_coefficients == other.spin_coefficients
    slope = sp.sqrt(1 - 2 * M / r) / (sp.sqrt(2) * r)
    assert one.frame.scalar(one.spin_coefficients["rho"]) == -slope
    assert one.frame.scalar(one.spin_coefficients["mu"]) == -slope


@pytest.mark.parametrize("signature", [MINUS, PLUS])
def test_reissner_nordstrom_and_de_sitter(signature: list) -> None:
    """Psi_2 = (Q^2 - M r)/r^4, Phi_11 = Q^2/(2 r^4), Lambda = R/24 in either signature."""
    charged = newman_penrose(static(1 - 2 * M / r + Q**2 / r**2, signature))
    assert charged.frame.scalar(charged.psi[2]) == (Q**2 - M * r) / r**4
    assert charged.petrov_type == "D"
    assert {k: value for k, value in charged.phi.items() if value} == {"11": Q**2 / (2 * r**4)}
    empty = newman_penrose(static(1 - H**2 * r**2, signature))
    assert empty.petrov_type == "O"
    assert empty.curvature_scalar == H**2 / 2
    assert "Lambda = H**2/2" in str(empty)


def test_waves_and_universes() -> None:
    """A plane wave has type N; Kasner's universe has type I, and type D with two equal axes."""
    wave = (x**2 - y**2) * sp.Function("h")(u)
    rows = sp.Matrix(
        [[1, 0, 0, 0], [wave / 2, 1, 0, 0], [0, 0, ROOT, -sp.I * ROOT], [0, 0, ROOT, sp.I * ROOT]]
    )
    frame = gt.Frame([u, v, x, y], rows, signature=MINUS, complex=True)
    plane = newman_penrose(frame)
    assert plane.petrov_type == "N"
    assert sum(value != 0 for value in plane.psi) == 1
    assert set(plane.phi.values()) == {0}

    def kasner(*powers: sp.Rational) -> str:
        scales = sp.diag(1, *(t**power for power in powers))
        return newman_penrose(null_tetrad([t, u, x, y], scales)).petrov_type

    third, seventh = sp.Rational(1, 3), sp.Rational(1, 7)
    assert kasner(-third, 2 * third, 2 * third) == "D"
    assert kasner(-2 * seventh, 3 * seventh, 6 * seventh) == "I"


def test_type_does_not_depend_on_the_tetrad() -> None:
    """After a null rotation of Schwarzschild several Psi do not vanish, but the type stays D."""
    plain = static(1 - 2 * M / r)
    b = sp.Rational(1, 2) + sp.I / 3
    bar = sp.conjugate(b)
    # Dual one-forms of l, n + b_bar m + b m_bar + |b|^2 l, m + b l, m_bar + b_bar l.
    legs = [[1, b * bar, b, bar], [0, 1, 0, 0], [0, bar, 1, 0], [0, b, 0, 1]]
    coframe = plain.coframe.to_sympy().tomatrix()
    rotated = sp.Matrix(legs).inv() * coframe
    frame = gt.Frame(plain.coordinates, rotated, signature=MINUS, complex=True)
    assert frame.metric.nonzero().keys() == plain.metric.nonzero().keys()
    assert all(
        frame.scalar(plain.metric[k]) == value for k, value in frame.metric.nonzero().items()
    )
    found = newman_penrose(frame)
    assert found.petrov_type == "D"
    assert sum(value != 0 for value in found.psi) > 1


@pytest.mark.parametrize(
    ("roots", "kind"),
    [
        ((1, 2, 3, 5), "I"),
        ((1, 1, 2, 3), "II"),
        ((2, 2, 3, 3), "D"),
        ((1, 1, 1, 2), "III"),
        ((2, 2, 2, 2), "N"),
    ],
)
def test_roots_that_coincide(roots: tuple[int, ...], kind: str) -> None:
    """The type is the pattern of equal roots of the quartic of Psi; a common factor is allowed."""
    frame = gt.spaces.load("kerr_kinnersley").frame
    z = sp.Symbol("z")
    quartic = sp.Poly(sp.prod(z - root for root in roots), z).all_coeffs()
    values = [c / sp.binomial(4, k) * M for k, c in enumerate(quartic)]
    made = NewmanPenrose(frame)
    made.__dict__["_weyl"] = frame.read([("Psi", value) for value in values])
    assert made.petrov_type == kind

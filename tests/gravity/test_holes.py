"""Holes of the literature: horizons, where the flux of a charge enters, and Noether charges."""

import numpy as np
import pytest
import sympy as sp

import geomtorsion as gt
from geomtorsion import gravity
from tests.gravity.test_charges import (
    CHARGED,
    COSMIC,
    SPHERICAL,
    L,
    M,
    a,
    equal,
    positive,
    r,
    static,
    tangherlini,
)
from tests.rounding import ROUNDED, rounded

# -- holes of the literature -----------------------------------------------------------------------

REGULAR = "1 - 2*M*r**2/(r**2 + g**2)**(3/2)"
SLOPE = (r**2 - 2 * sp.Symbol("g", positive=True) ** 2) / (2 * r)
RINDLER = [["-x**2", 0, 0, 0], [0, 1, 0, 0], [0, 0, 1, 0], [0, 0, 0, 1]]
THIN = [["-2*k*r", 0, 0, 0], [0, "1/(2*k*r)", 0, 0], [0, 0, 1, 0], [0, 0, 0, 1]]
SHEET = {"y": (0, 1), "z": (0, 1)}
ISOTROPIC = gt.Frame.from_metric(
    SPHERICAL,
    [["-((2*r - M)/(2*r + M))**2", 0, 0, 0], [0, "(1 + M/(2*r))**4", 0, 0],
     [0, 0, "r**2*(1 + M/(2*r))**4", 0], [0, 0, 0, "r**2*sin(theta)**2*(1 + M/(2*r))**4"]],
    parameters="M", domain="M > 0, r > 0",
)  # fmt: skip


def test_regular_holes() -> None:
    """Bardeen (1968) and Hayward (2006): mass over radius, and kappa = f'/2."""
    g, el = sp.symbols("g l", positive=True)
    (hole,) = gravity.horizons(static(REGULAR, "M g"))
    (mass,) = hole.relation.values()
    assert equal(mass, (r**2 + g**2) ** sp.Rational(3, 2) / (2 * r**2))
    assert equal(hole.surface_gravity, SLOPE / (r**2 + g**2))
    (hole,) = gravity.horizons(static("1 - 2*M*r**2/(r**3 + 2*M*l**2)", "M l"))
    (mass,) = hole.relation.values()
    assert equal(mass, r**3 / (2 * (r**2 - el**2)))
    assert equal(hole.surface_gravity, (r**2 - 3 * el**2) / (2 * r**3))


@pytest.mark.parametrize(
    ("parameters", "put"), [("M g", {"M": 1, "g": "1/2"}), ("", {})], ids=["named", "typed"]
)
def test_roots_of_an_equation_with_radicals(parameters: str, put: dict[str, object]) -> None:
    """Bardeen's horizons, with named parameters and with numbers in the metric."""
    f = REGULAR if parameters else REGULAR.replace("M", "1").replace("g**2", "1/4")
    holes = gravity.horizons(static(f, parameters), parameters=put)
    roots = np.roots([1, 0, 0.75 - 4, 0, 3 / 16, 0, 1 / 64])
    truth = sorted(x.real for x in roots if abs(x.imag) < ROUNDED and x.real > 0)
    assert len(holes) == len(truth) == 2
    for hole, radius in zip(holes, truth, strict=True):
        kappa = abs(radius**2 - 0.5) / (2 * radius * (radius**2 + 0.25))
        assert hole.radius == pytest.approx(radius, rel=1e-12)
        assert hole.surface_gravity == pytest.approx(kappa, rel=1e-11)


def test_three_horizons() -> None:
    """Reissner, Nordstroem and de Sitter: kappa = |f'|/2 at each root of f."""
    f = "1 - 2*M/r + Q**2/r**2 - L*r**2/3"
    holes = gravity.horizons(static(f, "M Q L"), parameters={"M": 1, "Q": "1/2", "L": "1/20"})
    assert len(holes) == 3
    for hole in holes:
        x = float(hole.radius)
        assert 1 - 2 / x + 0.25 / x**2 == pytest.approx(x**2 / 60, rel=1e-11)
        slope = 2 / x**2 - 0.5 / x**3 - x / 30
        assert hole.surface_gravity == pytest.approx(abs(slope) / 2, rel=1e-11)


def test_numbers_in_the_metric() -> None:
    """Schwarzschild with M = 1 and an extremal hole, typed without parameters."""
    (hole,) = gravity.horizons(static("1 - 2/r", ""))
    assert (hole.radius, hole.surface_gravity) == (2, 0.25)
    (hole,) = gravity.horizons(static("1 - 2/r + 1/r**2", ""))
    assert (hole.radius, hole.temperature) == (1, 0)


def test_lapse_that_vanishes_where_the_radius_is_regular() -> None:
    """Rindler: 1, for the observer at distance 1, and k; isotropic coordinates: 1/(4M)."""
    (hole,) = gravity.horizons(gt.Frame.from_metric("t x y z", RINDLER), over=SHEET)
    assert (hole.radius, hole.surface_gravity, hole.area) == (0, 1, 1)
    (hole,) = gravity.horizons(gt.Frame.from_metric("t r y z", THIN, parameters="k"), over=SHEET)
    assert (hole.radius, str(hole.surface_gravity)) == (0, "k")
    (hole,) = gravity.horizons(ISOTROPIC)
    (mass,) = hole.relation.values()
    assert equal(positive(hole.surface_gravity) * 4 * positive(mass), 1)
    assert equal(hole.area, 16 * sp.pi * positive(mass) ** 2)


def cosmic_kerr() -> gt.Frame:
    """Kerr and de Sitter in Carter's coordinates."""
    delta = "((r**2 + a**2)*(1 - L*r**2/3) - 2*M*r)"
    part, size = "(1 + L*a**2*cos(theta)**2/3)", "(r**2 + a**2*cos(theta)**2)"
    bottom = f"({size}*(1 + L*a**2/3)**2)"
    tt = f"-({delta} - {part}*a**2*sin(theta)**2)/{bottom}"
    tp = f"-a*sin(theta)**2*({part}*(r**2 + a**2) - {delta})/{bottom}"
    pp = f"sin(theta)**2*({part}*(r**2 + a**2)**2 - {delta}*a**2*sin(theta)**2)/{bottom}"
    rows = [[tt, 0, 0, tp], [0, f"{size}/{delta}", 0, 0], [0, 0, f"{size}/{part}", 0],
            [tp, 0, 0, pp]]  # fmt: skip
    return gt.Frame.from_metric(SPHERICAL, rows, parameters="M a L")


def test_first_law_with_a_cosmological_constant() -> None:
    """dE = T dS + Omega dJ with E = M/Xi^2 (Gibbons, Perry, Pope 2005)."""
    frame = cosmic_kerr()
    (hole,) = gravity.horizons(frame)
    (mass,) = (positive(x) for x in hole.relation.values())
    xi = 1 + L * a**2 / 3
    spin = gravity.charge(frame, killing="phi")
    assert spin.is_closed
    assert equal(spin.value, M * a / xi**2)
    energy = gravity.charge(frame, "varied", vary="M")
    assert equal(energy.value, 1 / xi**2)
    # The time of an observer who does not turn; Carter's time is divided by Xi.
    turn = a * (1 - L * r**2 / 3) / (r**2 + a**2)
    heat, entropy = positive(hole.temperature) * xi, positive(hole.entropy)
    for x in (r, a):
        work = heat * entropy.diff(x) + turn * (mass * a / xi**2).diff(x)
        assert sp.simplify((mass / xi**2).diff(x) - work) == 0


# -- where the flux of a charge enters -------------------------------------------------------------

SLICES = [
    ("kerr", {}),
    ("kerr_newman", {}),
    (static(COSMIC, "M L"), {}),
    (static("1 - 2*M/r + q*r**3", "M q"), {"kind": "noether", "lagrangian": "R + c*R**2"}),
    (static(CHARGED, "M Q"), {"kind": "electric", "potential": ["-Q/r**2", 0, 0, 0]}),
    ("schwarzschild", {"kind": "teleparallel", "reference": {"M": 0}}),
    ("taub_nut", {}),
]


@pytest.mark.parametrize(("frame", "options"), SLICES)
def test_the_source_is_the_change_with_the_radius(frame: gt.Frame | str, options: dict) -> None:
    """Gauss: dQ/dr is the integral of the source, and of the flux along a string."""
    found = gravity.charge(frame, **options)
    theta, radius = sp.Symbol("theta"), sp.Symbol("r")

    def at(expression: sp.Expr) -> sp.Expr:
        return expression.xreplace({x: sp.Symbol(x.name) for x in expression.free_symbols})

    numbers = {"M": 1, "a": 0.5, "q": 0.25, "Q": 0.5, "L": 0.03, "c": 0.2, "l": 0.5, "r": 4}
    values = {sp.Symbol(x): value for x, value in numbers.items()}
    source, slope = at(found.source).subs(values), at(found.value).diff(radius).subs(values)
    strings = sum((at(x).subs(values) for x in found.leaks.values()), sp.S.Zero)
    f = sp.lambdify(theta, source, "math")
    nodes, weights = np.polynomial.legendre.leggauss(40)
    inside = sum(w * f(np.pi / 2 * (x + 1)) for x, w in zip(nodes, weights, strict=True))
    total = 2 * np.pi * (np.pi / 2 * inside + float(strings))
    assert total == pytest.approx(float(slope), rel=1e-10, abs=rounded(1.0))
    assert found.is_closed is (found.source == 0)
    assert found.conserved is (found.is_closed and not found.leaks)


def test_a_string_is_named() -> None:
    """The form is closed on Taub-NUT space, and its flux enters along the axis."""
    found = gravity.charge("taub_nut")
    assert found.is_closed
    assert not found.conserved
    assert [str(x) for x in found.leaks] == ["theta"]
    assert "string" in str(found)


def test_noether_charges() -> None:
    """M/2 and J in general relativity; T S at a horizon of R + c R^2 with a cosmos."""
    assert equal(gravity.charge("kerr", "noether").value, M / 2)
    assert equal(gravity.charge("kerr", "noether", killing="phi").value, M * a)
    frame, theory = static(COSMIC, "M L"), "R + c*R**2"
    (hole,) = gravity.horizons(frame, theory)
    ((symbol, mass),) = hole.relation.items()
    found = gravity.charge(frame, "noether", lagrangian=theory)
    at = found.value.subs(symbol, mass)
    assert equal(at, positive(hole.temperature) * positive(hole.entropy))


def test_noether_charge_of_gauss_and_bonnet() -> None:
    """T S at the horizon in five dimensions."""
    frame, theory = tangherlini("1 - m/r**2", "m"), "R + al*GB"
    (hole,) = gravity.horizons(frame, theory)
    ((symbol, mass),) = hole.relation.items()
    at = gravity.charge(frame, "noether", lagrangian=theory).value.subs(symbol, mass)
    assert equal(at, positive(hole.temperature) * positive(hole.entropy))


def test_the_divergence_of_a_noether_charge() -> None:
    """-(L - E_t^t)/(16 pi), for a metric that solves nothing."""
    frame, theory = static("1 - 2*M/r + q*r**3", "M q"), "R + c*R**2"
    system = gravity.equations(gt.levi_civita(frame), theory)
    truth = -(system.L[()] - system.E.in_coordinates()[0, 0]) / (16 * sp.pi)
    found = gravity.charge(frame, "noether", lagrangian=theory)
    _, radius, theta, _ = frame.coordinates
    assert sp.simplify(found.source / (radius**2 * sp.sin(theta)) - truth) == 0


def test_what_proves_a_charge() -> None:
    """A closed form, or a ball."""
    assert "closed form" in gravity.charge("kerr").proved_by
    options = {"surface": {"r": 10}, "parameters": {"M": 1, "a": "3/5"}}
    found = gravity.charge("kerr", "teleparallel", reference={"M": 0}, **options)  # type: ignore[arg-type]
    assert found.proved_by.startswith("ball arithmetic")
    assert found.to_json()["proved_by"] == found.proved_by

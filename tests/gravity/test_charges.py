"""Charges: masses, spins and charges of published holes, horizons, the first law, refusals."""

import json
from pathlib import Path

import numpy as np
import pytest
import sympy as sp

import geomtorsion as gt
from geomtorsion import gravity
from geomtorsion.errors import GeomtorsionError
from tests.cli import running
from tests.rounding import ROUNDED

SPHERICAL = "t r theta phi"
M, a, q, r = sp.symbols("M a q r", positive=True)


def static(f: str, parameters: str, sign: int = 1) -> gt.Frame:
    """The frame of -f dt^2 + dr^2/f + r^2 dOmega^2, with the other signature for sign = -1."""
    rows = [
        [f"-({f})*({sign})", 0, 0, 0],
        [0, f"{sign}/({f})", 0, 0],
        [0, 0, f"{sign}*r**2", 0],
        [0, 0, 0, f"{sign}*r**2*sin(theta)**2"],
    ]
    return gt.Frame.from_metric(SPHERICAL, rows, parameters=parameters)


CHARGED = "1 - 2*M/r + Q**2/r**2"
DYMNIKOVA = "1 - 2*M/r*(1 - exp(-r**3/(2*M*l**2)))"
COSMIC = "1 - 2*M/r - L*r**2/3"
BTZ = gt.Frame.from_metric(
    "t r phi",
    [["M - r**2/l**2", 0, "-J/2"], [0, "1/(r**2/l**2 - M + J**2/(4*r**2))", 0],
     ["-J/2", 0, "r**2"]],
    parameters="M J l", domain="M > 0, l > 0",
)  # fmt: skip


def positive(value: object) -> sp.Expr:
    """An expression in which all symbols are positive."""
    expression = sp.sympify(value)
    names = {x: sp.Symbol(x.name, positive=True) for x in expression.free_symbols}
    return expression.xreplace(names)


def equal(one: object, two: object) -> bool:
    return sp.simplify(positive(one) - positive(two)) == 0


# -- charges ---------------------------------------------------------------------------------------

Q, L, m, ll = sp.symbols("Q L m l", positive=True)
# Kerr-Newman: Cohen, de Felice (1984); Kerr: Komar (1959).
KERR_NEWMAN = M - q**2 / (2 * r) * (1 + (r**2 + a**2) / (a * r) * sp.atan(a / r))
FORMULAS = [
    ("schwarzschild", {}, M, True),
    ("kerr", {}, M, True),
    ("kerr", {"killing": "phi"}, M * a, True),
    ("kerr_newman", {}, KERR_NEWMAN, False),
    (static(CHARGED, "M Q"), {}, M - Q**2 / r, False),
    # One radius does not show whether others have the same charge.
    (static(CHARGED, "M Q"), {"surface": {"r": 3}}, M - Q**2 / 3, None),
    (static(CHARGED, "M Q"), {"kind": "electric", "potential": ["-Q/r", 0, 0, 0]}, Q, True),
    (static(CHARGED, "M Q", -1), {"kind": "electric", "potential": ["Q/r", 0, 0, 0]}, Q, True),
    (static(COSMIC, "M L"), {}, M - L * r**3 / 3, False),
    (static(COSMIC, "M L"), {"kind": "varied", "vary": "M"}, 1, True),
    (static("1 - 2*M/r", "M", -1), {}, M, True),
    (static("1 - 2*M/r", "M", -1), {"kind": "varied", "vary": "M"}, 1, True),
    (static("1 - 2*M/r", "M", -1), {"kind": "brown-york"}, r - sp.sqrt(r**2 - 2 * M * r), False),
    (static("1", ""), {}, 0, True),
    (static("1", ""), {"killing": "phi"}, 0, True),
    (static("1", ""), {"kind": "brown-york"}, 0, True),
    ("kerr", {"kind": "varied", "vary": "M"}, 1, True),
    ("kerr", {"kind": "varied", "vary": "a"}, 0, True),
    ("kerr", {"kind": "varied", "vary": "a", "killing": "phi"}, M, True),
    (BTZ, {"kind": "varied", "vary": "M"}, sp.Rational(1, 8), True),
    (BTZ, {"killing": "phi"}, sp.Symbol("J", positive=True) / 8, True),
    ("schwarzschild", {"kind": "adm", "reference": {"M": 0}}, M, None),
    ("kerr", {"kind": "adm", "reference": {"M": 0}}, M, None),
    ("schwarzschild", {"kind": "brown-york"}, r - sp.sqrt(r**2 - 2 * M * r), False),
    ("schwarzschild", {"kind": "teleparallel", "reference": {"M": 0}},
     r - sp.sqrt(r**2 - 2 * M * r), False),
]  # fmt: skip


@pytest.mark.parametrize(("frame", "options", "truth", "conserved"), FORMULAS)
def test_published_charges(
    frame: gt.Frame | str, options: dict[str, object], truth: sp.Expr, conserved: bool | None
) -> None:
    found = gravity.charge(frame, **options)  # type: ignore[arg-type]
    assert equal(found.value, truth)
    assert found.error == 0
    assert found.conserved is conserved
    assert found.outside == "larger r"


def proper(f: sp.Expr) -> gt.Frame:
    """Static tetrad whose legs are Cartesian without gravity."""
    t, radius, theta, phi = sp.symbols("t r theta phi", positive=True)
    n = sp.Matrix([sp.sin(theta) * sp.cos(phi), sp.sin(theta) * sp.sin(phi), sp.cos(theta)])
    space = sp.Matrix.hstack(n / sp.sqrt(f), radius * n.diff(theta), radius * n.diff(phi))
    rows = sp.diag(sp.sqrt(f), space)
    return gt.Frame([t, radius, theta, phi], rows, signature="-+++")


def test_energy_of_a_proper_tetrad() -> None:
    """r (1 - (1 - 2M/r)^(1/2)), without momentum; the quadratic theory adds 2 c T to dL/dT."""
    frame = proper(1 - 2 * M / r)
    found = gravity.charge(frame, "teleparallel")
    assert equal(found.value, r * (1 - sp.sqrt(1 - 2 * M / r)))
    for leg in (1, 2, 3):
        assert gravity.charge(frame, "teleparallel", leg=leg).value == 0
    assert "leg 0" in found.formula
    torsion = gt.cartan(frame).torsion.scalar[()]
    changed = gravity.charge(frame, "teleparallel", lagrangian="T + c*T**2")
    factor = 1 + 2 * sp.Symbol("c", positive=True) * positive(torsion)
    assert equal(changed.value, found.value * factor)


@pytest.mark.parametrize("radius", [2, 3, 10, 100])
def test_kerr_at_every_radius(radius: int) -> None:
    """M and J = M a, with a bound on the error."""
    numbers = {"surface": {"r": radius}, "parameters": {"M": 1, "a": "3/5"}}
    for killing, truth in (("t", 1.0), ("phi", 0.6)):
        found = gravity.charge("kerr", killing=killing, **numbers)  # type: ignore[arg-type]
        assert float(found) == truth


def test_a_number_where_there_is_no_closed_form() -> None:
    """The energy of Carter's tetrad: its bound contains a value of many digits."""
    options = {"surface": {"r": 10}, "parameters": {"M": 1, "a": "3/5"}}
    found = gravity.charge("kerr", "teleparallel", reference={"M": 0}, **options)  # type: ignore[arg-type]
    assert not found.is_exact
    assert 0 < found.error < 1e-14
    # Slow rotation changes the energy 1.0557... of Schwarzschild by less than a^2/r^2.
    assert abs(float(found) - 10 * (1 - 0.8**0.5)) < 0.36 / 100


@pytest.mark.parametrize("spin", ["3/5", "0.6", 0.6, "6e-1"])
def test_a_decimal_is_exact(spin: object) -> None:
    """Text and floats mean the decimal that they show."""
    found = gravity.charge("kerr", killing="phi", parameters={"M": 1, "a": spin})
    assert found.value == sp.Rational(3, 5)


def test_the_side_of_a_surface_is_chosen() -> None:
    other = gravity.charge("kerr", outside=-1)
    assert other.value == -gravity.charge("kerr").value
    assert other.outside == "smaller r"


def test_five_dimensions() -> None:
    """M = 3 pi m/8 of Tangherlini's hole (Myers, Perry 1986)."""
    assert equal(gravity.charge(tangherlini("1 - m/r**2", "m")).value, 3 * sp.pi * m / 8)


def tangherlini(f: str, parameters: str, domain: str | None = None) -> gt.Frame:
    """The static frame of f in five dimensions."""
    around = ["r**2", "r**2*sin(chi)**2", "r**2*sin(chi)**2*sin(theta)**2"]
    diagonal = [f"-({f})", f"1/({f})", *around]
    rows = [[x if i == j else 0 for j in range(5)] for i, x in enumerate(diagonal)]
    return gt.Frame.from_metric("t r chi theta phi", rows, parameters=parameters, domain=domain)


def test_equal_calls_are_equal() -> None:
    options = {"surface": {"r": 7}, "parameters": {"M": 1, "a": 0.3}, "reference": {"M": 0}}
    one, two = (
        gravity.charge("kerr", "teleparallel", **options)  # type: ignore[arg-type]
        for _ in range(2)
    )
    assert (one.value, one.error) == (two.value, two.error)


# -- horizons --------------------------------------------------------------------------------------


def test_first_law_of_kerr_newman() -> None:
    """dM = T dS + Omega dJ + Phi dQ along the horizon radius, a and q."""
    (hole,) = gravity.horizons("kerr_newman")
    (mass,) = (positive(x) for x in hole.relation.values())
    spin, entropy = mass * a, positive(hole.entropy)
    heat, turn = positive(hole.temperature), positive(hole.angular_velocity)
    potential = q * r / (r**2 + a**2)
    for x in (r, a, q):
        work = heat * entropy.diff(x) + turn * spin.diff(x) + potential * q.diff(x)
        assert sp.simplify(mass.diff(x) - work) == 0


def test_first_law_of_btz() -> None:
    (hole,) = gravity.horizons(BTZ)
    J = sp.Symbol("J", positive=True)
    (mass,) = (positive(x) / 8 for x in hole.relation.values())
    heat, turn = positive(hole.temperature), positive(hole.angular_velocity)
    for x in (r, J):
        work = heat * positive(hole.entropy).diff(x) + turn * (J / 8).diff(x)
        assert sp.simplify(mass.diff(x) - work) == 0


def test_entropy_of_other_theories() -> None:
    """f'(R) A/4; Gauss-Bonnet adds 12 alpha/r^2 of A/4 (Jacobson, Myers 1993)."""
    c = sp.Symbol("c", positive=True)
    (hole,) = gravity.horizons(static(COSMIC, "M L"), "R + c*R**2")
    assert equal(hole.entropy, positive(hole.area) / 4 * (1 + 8 * L * c))
    al = sp.Symbol("al", positive=True)
    f = "1 + r**2/(4*al)*(1 - sqrt(1 + 8*al*m/r**4))"
    frame = tangherlini(f, "m al", "m > 0, al > 0, r > 0")
    (hole,) = gravity.horizons(frame, "R + al*GB")
    assert equal(hole.entropy, positive(hole.area) / 4 * (1 + 12 * al / r**2))
    (mass,) = (positive(x) * 3 * sp.pi / 8 for x in hole.relation.values())
    heat = positive(hole.temperature) * positive(hole.entropy).diff(r)
    assert sp.simplify(mass.diff(r) - heat) == 0


def test_two_horizons_of_schwarzschild_de_sitter() -> None:
    """Roots of 1 - 2M/r - L r^2/3, by their trigonometric formula."""
    holes = gravity.horizons(static(COSMIC, "M L"), parameters={"M": "1/10", "L": 1})
    angle = sp.acos(-sp.Rational(3, 10)) / 3
    truth = sorted(float(2 * sp.cos(angle + k * 2 * sp.pi / 3)) for k in range(3))[1:]
    for hole, radius in zip(holes, truth, strict=True):
        kappa = abs(0.1 / radius**2 - radius / 3)
        assert hole.radius == pytest.approx(radius, rel=ROUNDED)
        assert hole.surface_gravity == pytest.approx(kappa, rel=1e-12)
        assert hole.error < 1e-15
    # A hole is hotter than the horizon around it.
    assert holes[0].temperature > holes[1].temperature  # type: ignore[operator]


def test_both_horizons_of_kerr() -> None:
    inner, outer = gravity.horizons("kerr", parameters={"M": 1, "a": "3/5"})
    assert (inner.radius, outer.radius) == (0.2, 1.8)
    assert outer.angular_velocity == pytest.approx(1 / 6, rel=ROUNDED)
    assert outer.temperature == pytest.approx(0.8 / (3.6 * 3.141592653589793 * 2), rel=ROUNDED)


SIGMA, DELTA = "(r^2 + 9/25*cos(theta)^2)", "(r^2 - 2 r + 9/25)"
# Kerr's own coordinates, regular at the horizon, where v and phi turn together.
INGOING = gt.Frame.from_metric(
    "v r theta phi",
    f"-(1 - 2 r/{SIGMA}) dv^2 + 2 dv dr + {SIGMA} dtheta^2 - 6/5*sin(theta)^2 dr dphi"
    f" + ((r^2 + 9/25)^2 - 9/25*{DELTA}*sin(theta)^2)/{SIGMA}*sin(theta)^2 dphi^2"
    f" - 12/5*r/{SIGMA}*sin(theta)^2 dv dphi",
)
KERR_NUMBERS = gt.spaces.load("kerr").frame.subs({"M": 1, "a": "3/5"})
KERR_ROOTS = gt.spaces.load("kerr").frame.subs({"M": 1, "a": "1/3"})


@pytest.mark.parametrize(
    ("frame", "spin"),
    [
        (KERR_NUMBERS, 0.6),
        (KERR_ROOTS, 1 / 3),
        (gt.Frame.from_metric(KERR_NUMBERS.coordinates, KERR_NUMBERS.metric[:, :]), 0.6),
        (gt.Frame(SPHERICAL, KERR_NUMBERS.coframe[:, :], "-+++"), 0.6),
        (INGOING, 0.6),
    ],
)
def test_kerr_typed_with_numbers(frame: gt.Frame, spin: float) -> None:
    """M = 1 and a in the frame itself: both horizons by the formulas of Kerr."""
    radii = (1 - (1 - spin**2) ** 0.5, 1 + (1 - spin**2) ** 0.5)
    for hole, radius in zip(gravity.horizons(frame), radii, strict=True):
        square = radius**2 + spin**2
        truth = (
            radius, 4 * np.pi * square, spin / square,
            abs(radius**2 - spin**2) / (2 * radius * square), hole.surface_gravity / (2 * np.pi),
            np.pi * square,
        )  # fmt: skip
        assert [getattr(hole, x) for x in hole.quantities] == pytest.approx(truth, rel=ROUNDED)


SMALL = "1 - 2/r*(1 - exp(-r**3))"


@pytest.mark.parametrize(
    ("frame", "options"),
    [
        (static(SMALL, ""), {}),
        (static("1 - 2*M/r*(1 - exp(-r**3/b**3))", "M b"), {"parameters": {"M": 1, "b": 1}}),
        (static(DYMNIKOVA, "M l"), {"parameters": {"M": 1, "l": "sqrt(1/2)"}}),
    ],
)
def test_a_regular_hole_of_exponentials(frame: gt.Frame, options: dict[str, object]) -> None:
    """Dymnikova's hole (1992): both roots of r = 2 (1 - exp(-r^3)), and kappa = f'/2."""
    for hole, start in zip(gravity.horizons(frame, **options), (0.8, 2), strict=True):  # type: ignore[arg-type]
        radius = start
        for _ in range(40):
            f = radius - 2 * (1 - np.exp(-(radius**3)))
            radius -= f / (1 - 6 * radius**2 * np.exp(-(radius**3)))
        kappa = abs((1 - 6 * radius**2 * np.exp(-(radius**3))) / (2 * radius))
        assert hole.radius == pytest.approx(radius, rel=ROUNDED)
        assert hole.surface_gravity == pytest.approx(kappa, rel=100 * ROUNDED)
        assert hole.entropy == pytest.approx(np.pi * radius**2, rel=ROUNDED)
        assert any("searched between" in x for x in hole.assumed)


def test_a_hole_without_horizon() -> None:
    """A light regular hole has none: the least mass of Dymnikova's hole is near 0.9 b."""
    frame = static("1 - 2*M/r*(1 - exp(-r**3/b**3))", "M b")
    with pytest.raises(GeomtorsionError, match="no root"):
        gravity.horizons(frame, parameters={"M": "1/2", "b": 1})


def test_first_law_of_kerr() -> None:
    """dM = T dS + Omega dJ by derivatives, with J from its own charge."""
    (hole,) = gravity.horizons("kerr")
    (mass,) = (positive(x) for x in hole.relation.values())
    spin = positive(gravity.charge("kerr", killing="phi").value).subs(M, mass)
    heat, turn = positive(hole.temperature), positive(hole.angular_velocity)
    for x in (r, a):
        work = heat * positive(hole.entropy).diff(x) + turn * spin.diff(x)
        assert sp.simplify(mass.diff(x) - work) == 0


def test_the_assumed_region_is_printed() -> None:
    """A frame without a domain: charges and horizons print the region they assume."""
    frame = static("1 - 2*M/r", "M")
    for one in (gravity.charge(frame), gravity.horizons(frame)[0]):
        assert any("r > 2*M" in x for x in one.assumed)
        assert "r > 2*M" in str(one)
    assert not any("r > " in x for x in gravity.charge("kerr").assumed)


INGOING = gt.Frame.from_metric(
    "v r theta phi",
    [["2*M*r/(r**2 + a**2*cos(theta)**2) - 1", 1, 0,
      "-2*M*a*r*sin(theta)**2/(r**2 + a**2*cos(theta)**2)"],
     [1, 0, 0, "-a*sin(theta)**2"],
     [0, 0, "r**2 + a**2*cos(theta)**2", 0],
     ["-2*M*a*r*sin(theta)**2/(r**2 + a**2*cos(theta)**2)", "-a*sin(theta)**2", 0,
      "(r**2 + a**2 + 2*M*r*a**2*sin(theta)**2/(r**2 + a**2*cos(theta)**2))*sin(theta)**2"]],
    parameters="M a", domain="M > a, a > 0, r > 2*M",
)  # fmt: skip
PAINLEVE = gt.Frame.from_metric(
    SPHERICAL,
    [["2*M/r - 1", "sqrt(2*M/r)", 0, 0], ["sqrt(2*M/r)", 1, 0, 0],
     [0, 0, "r**2", 0], [0, 0, 0, "r**2*sin(theta)**2"]],
    parameters="M",
)  # fmt: skip


@pytest.mark.parametrize(
    ("frame", "kappa"),
    [
        ("schwarzschild", 1 / (2 * r)),
        (static("1 - 2*M/r", "M", -1), 1 / (2 * r)),
        (PAINLEVE, 1 / (2 * r)),
        (INGOING, (r**2 - a**2) / (2 * r * (r**2 + a**2))),
        ("kerr", (r**2 - a**2) / (2 * r * (r**2 + a**2))),
        ("taub_nut", 1 / (2 * r)),
    ],
)
def test_one_surface_gravity_in_all_coordinates(frame: gt.Frame | str, kappa: sp.Expr) -> None:
    (hole,) = gravity.horizons(frame)
    assert equal(hole.surface_gravity, kappa)
    assert equal(hole.entropy, positive(hole.area) / 4)


def test_area_of_the_dilaton_hole() -> None:
    """Area 4 pi r (r - b), positive outside of b (Garfinkle, Horowitz, Strominger 1991)."""
    frame = gt.Frame.from_metric(
        SPHERICAL,
        [["2*M/r - 1", 0, 0, 0], [0, "1/(1 - 2*M/r)", 0, 0],
         [0, 0, "r*(r - b)", 0], [0, 0, 0, "r*(r - b)*sin(theta)**2"]],
        parameters="M b", domain="r > 2*M, M > 0, b > 0, b < M",
    )  # fmt: skip
    (hole,) = gravity.horizons(frame)
    b = sp.Symbol("b", positive=True)
    assert equal(hole.area, 4 * sp.pi * r * (r - b))


# -- refusals --------------------------------------------------------------------------------------

NUMBERS = {"M": 1, "a": "3/5"}
REFUSED = [
    (lambda: gravity.charge("schwarzschild", killing="r"), "expected a Killing vector"),
    (lambda: gravity.charge("frw"), "expected a Killing vector"),
    (lambda: gravity.charge("schwarzschild", killing=["t", 0, 0, 0]), "expected a Killing vector"),
    (lambda: gravity.charge("kerr", surface={"r": 1}, parameters=NUMBERS), "horizons"),
    (lambda: gravity.charge("kerr", surface="t theta"), "expected a closed surface"),
    (lambda: gravity.charge("kerr", over={"phi": (0, "pi")}), "expected a closed surface"),
    (lambda: gravity.charge("goedel"), "expected a closed surface"),
    (lambda: gravity.charge("schwarzschild_isotropic"), "expected a closed surface"),
    (lambda: gravity.charge(gt.cartan("schwarzschild")), "expected no torsion"),
    (lambda: gravity.charge("so3"), "expected a metric with one time"),
    (lambda: gravity.charge("s2"), "expected three dimensions or more"),
    (lambda: gravity.charge(BTZ), "expected four dimensions or more"),
    (lambda: gravity.charge("kerr", "brown-york"), "expected a sphere of constant curvature"),
    (lambda: gravity.charge("kerr", "adm"), "reference: expected"),
    (lambda: gravity.charge(static(COSMIC, "M L"), "adm", reference={"M": 0}), "with curvature"),
    (lambda: gravity.charge("kerr", "electric"), "potential: expected"),
    (lambda: gravity.charge("kerr", "electric", potential=["1/r"]), "expected 4 components"),
    (lambda: gravity.charge("kerr", "varied"), "vary: expected"),
    (lambda: gravity.charge("kerr", "mass"), "kind: expected one of"),
    (lambda: gravity.charge("kerr", surface={"x": 1}), "expected a coordinate"),
    (lambda: gravity.charge("kerr", parameters={"Q": 1}), "There are M, a"),
    (lambda: gravity.charge("kerr", parameters={"M": "b"}), "parameters"),
    (lambda: gravity.charge("kerr", outside=2), "outside: expected"),
    (lambda: gravity.charge("kerr", "teleparallel", reference={"M": 0}), "expected numbers"),
    (lambda: gravity.charge("schwarzschild", parameters={"M": -1}), "positive"),
    (lambda: float(gravity.charge("kerr")), "expected a value without symbols"),
    (lambda: gravity.charge("kerr").at({"b": 1}), "There are M"),
    (lambda: gravity.horizons(static("1", "")), "expected a factor"),
    (lambda: gravity.horizons(static("1 + r**2/l**2", "l")), "which has no root"),
    (lambda: gravity.horizons(static(DYMNIKOVA, "M l")), "determines no parameter"),
    (
        lambda: gravity.horizons(static("1 - 2*M*exp(-1/r)/r", "M"), parameters={"M": "E/2"}),
        "two horizons meet",
    ),
    (lambda: gravity.horizons(static("sin(r)", "")), "few horizons"),
    (lambda: gravity.charge("schwarzschild", "noether", lagrangian="T"), "T"),
    (lambda: gravity.horizons(throat()), "a throat"),
    (lambda: gravity.charge("kerr", surface={"r": -3}), "domain of the frame"),
    (lambda: gravity.charge(static("1 - 2*m(r)/r", ""), "brown-york"), "known functions"),
    (lambda: gravity.horizons("kerr", parameters={"M": 1, "a": 2}), "no root in the region"),
    (lambda: gravity.horizons("kerr", parameters={"M": 1}), "got none for a"),
    (lambda: gravity.horizons("kerr", surface={"r": 1}), "surface: expected"),
]


def throat() -> gt.Frame:
    """A wormhole, whose lapse is one everywhere."""
    rows = [[-1, 0, 0, 0], [0, "1/(1 - b/r)", 0, 0],
            [0, 0, "r**2", 0], [0, 0, 0, "r**2*sin(theta)**2"]]  # fmt: skip
    return gt.Frame.from_metric(SPHERICAL, rows, parameters="b")


@pytest.mark.parametrize(("call", "words"), REFUSED)
def test_refusals(call, words: str) -> None:
    with pytest.raises(GeomtorsionError, match=words):
        call()


# -- for users -------------------------------------------------------------------------------------


def test_command(tmp_path: Path) -> None:
    done = running.run("charge", "kerr", "--format", "json", "-o", str(tmp_path))
    assert json.loads(done.stdout)["value"] == "M"
    assert json.loads((tmp_path / "charge.json").read_text())["outside"] == "larger r"
    done = running.run(
        "charge", "schwarzschild", "-k", "brown-york", "--set", "M=1", "-o", str(tmp_path)
    )
    assert "outside: larger r" in done.stdout
    assert (tmp_path / "charge.png").exists() is gt.pictures.can_draw()
    done = running.run("charge", "kerr", "-k", "horizons", "--set", "M=1", "--set", "a=3/5")
    assert "horizon at 1.8" in done.stdout


def test_figure_and_notebook() -> None:
    one = gravity.charge("schwarzschild", "brown-york")
    assert "<pre>" in one._repr_html_()
    assert "horizon" in gravity.horizons("schwarzschild")[0]._repr_html_()
    if gt.pictures.can_draw():
        (line,) = one.plot(parameters={"M": 1}, radii=(4, 8)).axes[0].lines
        assert np.asarray(line.get_ydata())[0] == pytest.approx(4 - 8**0.5)
        with pytest.raises(GeomtorsionError, match="expected a number for M"):
            one.plot()

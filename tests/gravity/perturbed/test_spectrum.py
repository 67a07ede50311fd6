"""Particle spectra: published masses, energies and numbers of modes."""

import pytest
import sympy as sp

import geomtorsion as gt
from geomtorsion import gravity
from geomtorsion.errors import GeomtorsionError, GravityError
from geomtorsion.gravity import perturbed
from geomtorsion.gravity.perturbed.blocks import Waves
from geomtorsion.gravity.perturbed.geometries import Component

# Quadratic Poincare gauge theory in the couplings of Karananas (2014).
KARANANAS = (
    "lam*R + (r4 + r5)*R4 + (r4 - r5)*R5 + (r1/3 + r2/6)*R1 + (2*r1/3 - 2*r2/3)*R2"
    " + (r1/3 + r2/6 - r3)*R3"
    " - (lam/4 + t1/3 + t2/12)*T1 + (-lam/2 - t1/3 + t2/6)*T2 - (-lam - t1/3 + 2*t3/3)*T3"
)
COUPLINGS = "lam r1 r2 r3 r4 r5 t1 t2 t3"
lam, r1, r2, r3, r4, r5, t1, t2, t3 = sp.symbols(COUPLINGS)


@pytest.fixture(scope="module")
def poincare() -> perturbed.Spectrum:
    return perturbed.spectrum(KARANANAS, "poincare", constants=COUPLINGS)


# Lagrangian without a word on its geometry, and what authors mean by it.
MEANT = [
    ("R/2", "riemannian"),
    ("R/2 + c*P1", "riemannian"),
    ("0", "riemannian"),
    ("T", "teleparallel"),
    ("-T/2 + c*Rbar", "teleparallel"),
    ("Q", "symmetric teleparallel"),
    ("R/2 + c*axial2", "poincare"),
    ("R/2 + c*holst", "poincare"),
    ("R/2 + c*Q3", "metric-affine"),
    ("R/2 + c*R7", "metric-affine"),
]


@pytest.mark.parametrize(("lagrangian", "geometry"), MEANT)
def test_the_lagrangian_names_its_geometry(lagrangian: str, geometry: str) -> None:
    result = perturbed.spectrum(lagrangian)
    assert str(result).startswith(f"particles of L = {lagrangian} ({geometry})\n")
    assert str(result) == str(perturbed.spectrum(lagrangian, geometry))


def test_all_reports_read_the_same_geometry() -> None:
    """f(T) waves, grows and falls in the teleparallel geometry without being asked."""
    for report in (perturbed.tensor_modes, perturbed.growth, perturbed.post_newtonian):
        lagrangian = "T + c*T**2" if report is perturbed.post_newtonian else "f(T)"
        assert str(report(lagrangian)) == str(report(lagrangian, "teleparallel"))
    with pytest.raises(GeomtorsionError, match="got teleparallel"):
        perturbed.scalar_modes("T - X/2", scalars="phi")
    own = gravity.invariant("Y", "T_abc T^abc")
    assert perturbed.spectrum("R/2 + Y", invariants=own).geometry == "poincare"


# Lagrangian, geometry, gauge functions, massless helicities, massive spins and parities.
COUNTS = [
    ("R/2", "riemannian", 10, [2], []),
    ("-T/2", "teleparallel", 10, [2], []),
    ("R/2", "poincare", 10, [2], []),
    # The term of Holst mixes both mirror signs and changes nothing without torsion.
    ("R/2 + a*holst", "poincare", 10, [2], []),
    # Local Lorentz, translations, and the projective change of the connection.
    ("R/2", "metric-affine", 14, [2], []),
    ("-Q/2", "symmetric teleparallel", 10, [2], []),
    ("R/2 + c*R**2", "riemannian", 10, [2], [(0, 1)]),
    # Stelle: a massive ghost of spin 2.
    ("R/2 + c*R**2 + b*P1", "riemannian", 10, [2], [(0, 1), (2, 1)]),
    ("R/2 - F2/4", "riemannian", 11, [1, 2], []),
    # The antisymmetric part of the tetrad becomes a Kalb-Ramond field.
    ("-T/2 + c*axial2", "teleparallel", 7, [0, 2], []),
    # Without a trace of the curvature the Weyl rescaling is one more freedom.
    ("P1", "riemannian", 11, None, []),
    ("0*R", "riemannian", 16, [], []),
    ("R", "teleparallel", 16, [], []),
]


@pytest.mark.parametrize(("lagrangian", "geometry", "gauge", "massless", "massive"), COUNTS)
def test_modes_and_gauge_functions(
    lagrangian: str, geometry: str, gauge: int, massless: list[int] | None, massive: list
) -> None:
    vectors = int("F2" in lagrangian)
    spectrum = perturbed.spectrum(lagrangian, geometry, vectors=vectors)
    assert spectrum.gauge == gauge
    assert [(x.spin, x.parity) for x in spectrum.particles if not x.is_massless] == massive
    if massless is not None:
        assert [x.spin for x in spectrum.particles if x.is_massless] == massless


# Masses of Karananas (2014); signs of Hayashi and Shirafuji (1980), Sezgin and van Nieuwenhuizen.
MASSES = {
    (0, -1): -t2 / r2,
    (0, 1): lam * t3 / (2 * (t3 - lam) * (r1 - r3 + 2 * r4)),
    (1, 1): -3 * t1 * t2 / (2 * (t1 + t2) * (2 * r3 + r5)),
    (1, -1): -3 * t1 * t3 / (2 * (t1 + t3) * (r1 + r4 + r5)),
    (2, 1): -lam * t1 / (2 * (lam + t1) * (2 * r1 - 2 * r3 + r4)),
    (2, -1): -t1 / (2 * r1),
}


def test_all_masses_of_poincare_gauge_theory(poincare: perturbed.Spectrum) -> None:
    """Six massive particles and the graviton: 18 + 2 modes, 10 gauge functions."""
    masses = {(x.spin, x.parity): x.mass2 for x in poincare.particles if not x.is_massless}
    assert masses.keys() == MASSES.keys()
    for key, value in MASSES.items():
        assert sp.cancel(masses[key] - value) == 0
    assert (poincare.degrees_of_freedom, poincare.gauge) == (20, 10)


# Healthy where, from the papers above: for one spin.
@pytest.mark.parametrize(
    ("spin", "parity", "condition"),
    [(0, -1, (t2 > 0) & (r2 < 0)), (2, -1, (t1 > 0) & (r1 < 0))],
)
def test_energies_of_poincare_gauge_theory(
    poincare: perturbed.Spectrum, spin: int, parity: int, condition: sp.Basic
) -> None:
    (one,) = [x for x in poincare.particles if (x.spin, x.parity) == (spin, parity)]
    for values in ({t1: 1, t2: 2, r1: 3, r2: 5}, {t1: 1, t2: 2, r1: -3, r2: -5},
                   {t1: -1, t2: -2, r1: 3, r2: 5}, {t1: -1, t2: -2, r1: -3, r2: -5}):  # fmt: skip
        assert one.mass2 is not None
        assert one.energy is not None
        healthy = one.mass2.subs(values) > 0 and one.energy.subs(values) > 0
        assert healthy == bool(condition.subs(values))


def test_all_spins_together_are_never_healthy(poincare: perturbed.Spectrum) -> None:
    """No couplings make all six particles healthy (Sezgin and van Nieuwenhuizen 1980)."""
    assert poincare.healthy == sp.false


def test_a_singular_coupling_removes_a_mode(poincare: perturbed.Spectrum) -> None:
    """Without r2 the pseudoscalar does not move: fewer modes, and no infinite mass."""
    fewer = poincare.subs(r2=0)
    assert (0, -1) not in {(x.spin, x.parity) for x in fewer.particles}
    assert fewer.degrees_of_freedom == poincare.degrees_of_freedom - 1


def test_healthy_conditions_of_the_pseudoscalar() -> None:
    spectrum = perturbed.spectrum("R/2 + c*holst**2 + d*axial2", "poincare")
    c, d = sp.symbols("c d")
    (scalar,) = [x for x in spectrum.particles if not x.is_massless]
    assert (scalar.spin, scalar.parity) == (0, -1)
    assert set(spectrum.healthy.args) == {c > 0, 8 * d - 1 < 0}


def test_a_vector_in_the_connection() -> None:
    """R/2 + a R7 + b Q3: one vector of mass^2 2 b/a."""
    a, b = sp.symbols("a b")
    spectrum = perturbed.spectrum("R/2 + a*R7 + b*Q3", "metric-affine")
    (vector,) = [x for x in spectrum.particles if not x.is_massless]
    assert (vector.spin, vector.parity, vector.number) == (1, -1, 3)
    assert sp.cancel(vector.mass2 - 2 * b / a) == 0


@pytest.mark.parametrize(
    ("lagrangian", "mass2", "sign"),
    [
        ("R/2 - X/2 - mu*phi**2/2", "mu", 1),
        ("R/2 + X/2 + mu*phi**2/2", "mu", -1),
        ("R/2 - X/2 + mu*phi**2/2 - phi**4", "-mu", 1),
    ],
)
def test_scalar_fields(lagrangian: str, mass2: str, sign: int) -> None:
    spectrum = perturbed.spectrum(lagrangian, "riemannian", scalars="phi", constants="mu")
    (scalar,) = [x for x in spectrum.particles if not x.is_massless]
    assert scalar.mass2 == sp.Symbol("mu") * (-1 if mass2 == "-mu" else 1)
    assert scalar.energy == sign


def test_two_scalars_that_mix_have_the_roots_of_their_mass_matrix() -> None:
    lagrangian = "R/2 - X/2 - X_2/2 - a*phi**2/2 - b*phi_2**2/2 - c*phi*phi_2"
    spectrum = perturbed.spectrum(lagrangian, "riemannian", scalars=["phi", "phi_2"])
    a, b, c = sp.symbols("a b c")
    (both,) = [x for x in spectrum.particles if not x.is_massless]
    m2 = sp.Symbol("mass2")
    assert both.mass2 is None
    assert sp.expand(both.equation - sp.Matrix([[a - m2, c], [c, b - m2]]).det()) == 0
    positive = {a: 2, b: 3, c: 1}
    for values in (positive, {**positive, c: 3}, {a: -2, b: -3, c: 1}, {a: 2, b: -1, c: 0.5}):
        matrix = sp.Matrix([[a, c], [c, b]]).subs(values)
        assert bool(spectrum.healthy.subs(values)) == bool(matrix.is_positive_definite)
    numbers = {x.mass2 for x in spectrum.subs(a=2, b=3, c=1).particles if x.spin == 0}
    assert numbers == {*sp.Matrix([[2, 1], [1, 3]]).eigenvals()}


def test_a_vector_with_a_mass() -> None:
    square = gravity.invariant("A2", "A_a A^a")
    spectrum = perturbed.spectrum(
        "R/2 - F2/4 - mu*A2/2", "riemannian", vectors=1, constants="mu", invariants=square
    )
    (vector,) = [x for x in spectrum.particles if not x.is_massless]
    assert (vector.spin, vector.parity, vector.mass2) == (1, -1, sp.Symbol("mu"))
    assert spectrum.healthy == (sp.Symbol("mu") > 0)


# Scalar mass of a theory with unknown functions, from the values of these in flat space.
UNKNOWN = [
    # Sotiriou and Faraoni (2010).
    ("f(R)", "", "f_R/(3*f_RR)", {"f_0": 0}),
    ("R*f(R)", "", "f_0/(6*f_R)", {}),
    ("f(R, GB)", "", "f_R/(3*f_R_R)", {"f_0": 0}),
    # The Einstein frame: F V'' over F + 3 F'^2/2.
    ("F(phi)*R/2 - X/2 - V(phi)", "phi", "V_phi_phi/(1 + 3*F_phi**2/(2*F_0))",
     {"V_0": 0, "V_phi": 0}),
    ("R/2 + K(X, phi)", "phi", "K_phi_phi/(2*K_X)", {"K_0": 0, "K_phi": 0}),
]  # fmt: skip


@pytest.mark.parametrize(("lagrangian", "scalars", "mass2", "conditions"), UNKNOWN)
def test_unknown_functions_become_their_derivatives(
    lagrangian: str, scalars: str, mass2: str, conditions: dict[str, int]
) -> None:
    spectrum = perturbed.spectrum(lagrangian, "riemannian", scalars=scalars)
    (scalar,) = [x for x in spectrum.particles if not x.is_massless]
    assert sp.cancel(scalar.mass2 - sp.sympify(mass2)) == 0
    assert {x.name: y for x, y in spectrum.conditions.items()} == conditions
    assert all(f"{x} = {y}" in str(spectrum) for x, y in conditions.items())


def test_boundary_term_of_torsion() -> None:
    """f(T, B): a scalar of m^2 = -f_T/(3 f_BB) (Farrugia, Levi Said, Gakis, Saridakis 2018)."""
    spectrum = perturbed.spectrum("f(T, Rbar + T)", "teleparallel")
    (scalar,) = [x for x in spectrum.particles if not x.is_massless]
    f_T, f_BB = sp.symbols("f_T f_22")
    assert sp.cancel(scalar.mass2 + f_T / (3 * f_BB)) == 0
    assert spectrum.degrees_of_freedom == 3


def test_unknown_functions_with_values_are_the_explicit_theory() -> None:
    """f(R) with f_R = 1/2, f_RR = 2 c is R/2 + c R^2."""
    explicit = perturbed.spectrum("R/2 + c*R**2", "riemannian")
    given = perturbed.spectrum("f(R)", "riemannian").subs(f_R="1/2", f_RR=2 * sp.Symbol("c"))
    assert given.particles == explicit.particles


@pytest.mark.parametrize("name", ["symmetric-teleparallel", "Symmetric_Teleparallel"])
def test_names_of_geometries_as_people_type_them(name: str) -> None:
    assert perturbed.spectrum("-Q/2", name).geometry == "symmetric teleparallel"


def test_conformal_gravity_has_a_dipole() -> None:
    """Weyl^2: six massless modes, of which the gravitons make a double pole (Riegert 1984)."""
    for lagrangian in ("P1", "R4 - R**2/3", "R1 - 2*R4 + R**2/3"):
        spectrum = perturbed.spectrum(lagrangian, "riemannian")
        modes = {(x.spin, x.number): x.is_dipole for x in spectrum.particles}
        assert modes == {(1, 2): False, (2, 4): True}
        assert spectrum.gauge == 11
        assert spectrum.healthy == sp.false
    (dipole,) = [x for x in spectrum.particles if x.is_dipole]
    w, k = sp.symbols("w k")
    assert dipole.factor == w**2 - k**2
    assert "double pole (-k**2 + w**2)**2" in str(spectrum)
    assert dipole.to_json()["factor"] == "-k**2 + w**2"


def test_a_scalar_of_fourth_order_has_a_dipole() -> None:
    """Box(phi)^2: a double pole; with -X/2 it splits into a field and a ghost (Pais, Uhlenbeck)."""
    alone = perturbed.spectrum("R/2 + c*Box(phi)**2", "riemannian", scalars="phi")
    assert [(x.spin, x.number) for x in alone.particles if x.is_dipole] == [(0, 2)]
    split = perturbed.spectrum("R/2 - X/2 + c*Box(phi)**2", "riemannian", scalars="phi")
    (ghost,) = [x for x in split.particles if not x.is_massless]
    assert (ghost.mass2, ghost.energy) == (-1 / (2 * sp.Symbol("c")), -1)


def test_waves_with_a_preferred_time_are_named() -> None:
    """-X/2 + c (phi_t)^2/2 has waves with (1 + c) w^2 = k^2, which no particle has."""
    small = sp.Symbol("epsilon")
    frame = gt.Frame("t x y z", sp.eye(4).tolist(), "-+++", parameters=[small])
    component = Component("s_phi", ())
    function = component.function
    clock = gravity.invariant("D", "A^a phi_a")
    equations = gravity.equations(
        gt.levi_civita(frame.expanded(small, 1)),
        "-X/2 + c*D**2/2",
        [gravity.scalar_field(small * function), gravity.maxwell([1, 0, 0, 0])],
        invariants=clock,
    )
    waves = Waves.of(equations.operator([function]))
    spectrum = perturbed.Spectrum(equations.lagrangian, "riemannian", waves, (component,))
    c, w = sp.symbols("c w")
    assert spectrum.particles == ()
    assert [sp.expand(x - ((1 + c) * w**2 - 1)) for x in spectrum.lorentz_violating] == [0]
    assert "not Lorentz invariant" in str(spectrum)
    assert spectrum.healthy == sp.false
    invariant = spectrum.subs(c=0)
    assert invariant.lorentz_violating == ()
    assert invariant.degrees_of_freedom == 1


def test_massive_vector_with_a_compensator() -> None:
    """Stueckelberg: F^2 with mu (A - d phi)^2 has one vector of three modes and one more gauge."""
    invariants = [gravity.invariant("A2", "A_a A^a"), gravity.invariant("AD", "A^a phi_a")]
    spectrum = perturbed.spectrum(
        "R/2 - F2/4 - mu*(A2 - 2*AD + X)/2", "riemannian", vectors=1, scalars="phi",
        constants="mu", invariants=invariants,
    )  # fmt: skip
    (vector,) = [x for x in spectrum.particles if not x.is_massless]
    assert (vector.spin, vector.mass2, vector.number) == (1, sp.Symbol("mu"), 3)
    assert (spectrum.gauge, spectrum.degrees_of_freedom) == (11, 5)


def test_lee_and_wick() -> None:
    """-X/2 - m phi^2/2 + c Box(phi)^2: 2 c q^2 + q - m = 0, one root a ghost."""
    spectrum = perturbed.spectrum(
        "R/2 - X/2 - m*phi**2/2 + c*Box(phi)**2", "riemannian", scalars="phi", constants="m"
    )
    (both,) = [x for x in spectrum.particles if not x.is_massless]
    q, c, m = sp.symbols("mass2 c m")
    assert sp.expand(both.equation - (2 * c * q**2 + q - m)) == 0
    assert both.number == 2
    assert spectrum.healthy == sp.false


def test_brans_and_dicke_with_a_value_far_away() -> None:
    """(1 + phi) R/2 - om X/2: a massless scalar, healthy for om > -3/2."""
    spectrum = perturbed.spectrum("(1 + phi)*R/2 - om*X/2", "riemannian", scalars="phi")
    assert [(x.spin, x.mass2) for x in spectrum.particles] == [(0, 0), (2, 0)]
    assert spectrum.healthy == (2 * sp.Symbol("om") + 3 > 0)


def test_latex_of_a_spectrum() -> None:
    spectrum = perturbed.spectrum("R/2 + c*R**2", "riemannian")
    assert sp.latex(spectrum) == spectrum.to_latex()
    assert spectrum._repr_latex_() == rf"$\displaystyle {spectrum.to_latex()}$"
    assert r"0^{+} & m^2 = \frac{1}{12 c} & \text{energy positive} & 1" in spectrum.to_latex()
    empty = perturbed.spectrum("0*R", "riemannian")
    assert empty.to_latex() == r"\text{no particles}"


# -- laws ------------------------------------------------------------------------------------------


def particles(lagrangian: str, geometry: str, **options: object) -> tuple:
    return perturbed.spectrum(lagrangian, geometry, **options).particles  # type: ignore[arg-type]


@pytest.mark.parametrize(
    ("one", "two", "geometry"),
    [
        ("R/2 + c*R**2", "R/2 + c*R**2 + b*GB", "riemannian"),
        ("R/2 + c*R**2", "R/2 + c*R**2 + b*pontryagin", "riemannian"),
        ("R/2 + c*holst**2 + d*axial2", "R/2 + c*holst**2 + d*axial2 + b*nieh_yan", "poincare"),
        ("R/2 + c*holst**2 + d*axial2", "R/2 + c*holst**2 + d*axial2 + b*GB", "poincare"),
    ],
)
def test_boundary_terms_change_nothing(one: str, two: str, geometry: str) -> None:
    assert particles(one, geometry) == particles(two, geometry)


def test_torsion_scalar_and_curvature_scalar_have_one_spectrum() -> None:
    assert particles("R/2", "riemannian") == particles("-T/2", "teleparallel")


def test_a_linear_change_of_couplings_changes_only_the_formulas() -> None:
    u, v, a, b = sp.symbols("u v a b")
    one = particles("R/2 + a*R**2 + b*P1", "riemannian")
    two = particles("R/2 + (u + v)*R**2 + (u - v)*P1", "riemannian")
    for x, y in zip(one, two, strict=True):
        assert sp.cancel(x.mass2.subs({a: u + v, b: u - v}, simultaneous=True) - y.mass2) == 0


def test_each_particle_has_frequencies_along_z(poincare: perturbed.Spectrum) -> None:
    """Moving waves have as many modes as all particles: w^2 = 1 + m^2 for each helicity."""
    from geomtorsion.gravity.perturbed.sectors import helicities

    total = 0
    for sector in helicities(poincare.components):
        total += poincare.waves.block(sector, at_rest=False).divisor.degree() // 2
    assert total == poincare.degrees_of_freedom


# -- refusals --------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("call", "words"),
    [
        (lambda: perturbed.spectrum("R/2 + Lambda", "riemannian"), "solves the equations"),
        (lambda: perturbed.spectrum("f(R) - 2*Lambda", "riemannian"), "solves the equations"),
        (lambda: perturbed.spectrum("f(R) + f_R*R", "riemannian"), "Rename the constant"),
        (lambda: perturbed.spectrum("R/2 + mu**4/R", "riemannian"), "power series about flat"),
        (
            lambda: perturbed.spectrum("T**n", "teleparallel", constants="n"),
            "functions with a value",
        ),
        (
            lambda: perturbed.spectrum("phi*R/2 - om*X/(2*phi)", "riemannian", scalars="phi"),
            "Write 1 . phi",
        ),
        (lambda: perturbed.spectrum("R/2", "riemann"), "expected one of riemannian"),
        (lambda: perturbed.spectrum("R/2 + x*R**2", "riemannian"), "x, which is a coordinate"),
        (lambda: perturbed.spectrum("R/2 + c*Ric2", "riemannian"), "Ric2"),
        (lambda: perturbed.spectrum("R/2 - X/2", "riemannian"), "X"),
        (lambda: perturbed.spectrum(gravity.tegr, "riemannian"), "teleparallel"),
        (lambda: perturbed.spectrum("R/2 + c*R**2", "riemannian").subs(d=1), "expected"),
        (lambda: perturbed.spectrum("R/2", "riemannian", vectors=-1), "vectors"),
        (lambda: perturbed.spectrum("R/2 + sqrt(c)*R**2", "riemannian"), "rational functions"),
        (lambda: perturbed.spectrum("R/2 + c*R**2", "riemannian").subs(c=sp.sqrt(2)), "fractions"),
        (lambda: perturbed.spectrum("R/2 + c*R**2", "riemannian").subs(c="x"), "c: x is neither"),
        (lambda: gravity.equations(gt.levi_civita("schwarzschild"), "R").operator([]), "expanded"),
    ],
)
def test_refusals(call, words: str) -> None:
    with pytest.raises(GeomtorsionError, match=words):
        call()


def test_an_operator_needs_all_small_fields() -> None:
    t, x, small = sp.symbols("t x small")
    u, v = sp.Function("u")(t, x), sp.Function("v")(t, x)
    plane = gt.Frame([t, x], [[1, 0], [0, 1]], signature="-+", parameters=[small])
    matter = [gravity.scalar_field(small * u), gravity.scalar_field(small * v)]
    connection = gt.levi_civita(plane.expanded("small", 1))
    equations = gravity.equations(connection, "-X/2 - X_2/2 - phi*phi_2", matter)
    operator = equations.operator([u, v])
    assert operator.is_self_adjoint
    s, p = sp.symbols("s p")
    wave = p**2 - s**2
    assert operator.symbol({"t": s, "x": p}) == sp.Matrix([[wave, -1], [-1, wave]])
    with pytest.raises(GravityError, match="Name all small fields"):
        equations.operator([u])
    with pytest.raises(GravityError, match="none for x"):
        operator.symbol({"t": s})


@pytest.mark.parametrize(
    ("theory", "opposite"),
    [(gravity.tegr, "-T"), (gravity.stegr, "-Q"), (gravity.general_relativity, "-R")],
)
def test_the_sign_of_the_action_is_printed(theory: gravity.Lagrangian, opposite: str) -> None:
    """T and Q are -R up to a divergence: their gravitons have the opposite sign of energy."""
    geometry = {"T": "teleparallel", "Q": "symmetric teleparallel", "R": "riemannian"}[opposite[1]]
    one, two = perturbed.spectrum(theory), perturbed.spectrum(opposite, geometry)
    assert {one.healthy, two.healthy} == {sp.true, sp.false}
    assert (one.healthy_opposite, two.healthy_opposite) == (two.healthy, one.healthy)
    assert [x.energy for x in one.particles] == [-x.energy for x in two.particles if x.energy]
    for spectrum in (one, two):
        is_printed = "opposite action, L = -(" in str(spectrum)
        assert is_printed == (spectrum.healthy == sp.false)


def test_a_ghost_of_both_signs_has_no_better_action() -> None:
    """Stelle's ghost has the other sign than the graviton: neither action is healthy."""
    spectrum = perturbed.spectrum("R/2 + c*R4", "riemannian")
    assert spectrum.healthy_opposite == sp.false
    assert "opposite" not in str(spectrum)

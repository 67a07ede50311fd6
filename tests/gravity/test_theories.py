"""Theories: published solutions and equations, exact except where a number is compared."""

import mpmath
import pytest
import sympy as sp

import geomtorsion as gt
from geomtorsion import gravity as g
from geomtorsion.errors import GravityError

T, R, X, Y, Z = sp.symbols("t r x y z", real=True)
THETA, PHI = sp.symbols("theta phi", real=True)
C = sp.Symbol("c", positive=True)
LORENTZ = (-1, 1, 1, 1)
a = sp.Function("a")(T)
H = sp.diff(a, T) / a
f = sp.Function("f")


def spherical(N: sp.Expr, A: sp.Expr, B: sp.Expr, S: sp.Expr, turn: sp.Expr = sp.S.Zero) -> list:
    """A coframe that tends to the Cartesian one: lapse, radial, polar and azimuthal length."""
    s, c, u, v = sp.sin(THETA), sp.cos(THETA), sp.sin(PHI), sp.cos(PHI)
    return [
        [N, 0, 0, 0],
        [-S * turn * u, A * s * v, B * c * v, -S * u],
        [S * turn * v, A * s * u, B * c * u, S * v],
        [0, A * c, -B * s, 0],
    ]


def agree(tensor: gt.Tensor, index: tuple, value: sp.Expr) -> bool:
    """Whether a component equals an expression exactly."""
    return (tensor.frame.scalar(tensor[index]) - value).is_zero


def written(value: sp.Expr) -> tuple[sp.Expr, sp.Expr]:
    """f and its derivative at a value."""
    slot = sp.Symbol("s")
    return f(value), sp.Subs(sp.Derivative(f(slot), slot), slot, value)


@pytest.mark.parametrize(("name", "k"), [("frw_flat", 0), ("frw_closed", 1)])
def test_teleparallel_cosmology(name: str, k: int) -> None:
    """T = 6 (H^2 - k/a^2), E_0^0 = f - 12 H^2 f', E_[ij] = 0."""
    frame = gt.spaces.load(name).frame
    found = g.equations(gt.cartan(frame), g.f_of("T", f))
    assert found.scalar("T") == 6 * (H**2 - k / a**2)
    plain, slope = written(found.scalars["T"])
    assert agree(found.E, (0, 0), plain - 12 * H**2 * slope)
    assert found.antisymmetric.is_zero


def test_open_cosmology() -> None:
    """T = 6 (H - 1/a)^2, E_t^t = f - 12 H (H - 1/a) f' (Hohmann et al. 2019)."""
    frame = gt.spaces.load("frw_open").frame
    found = g.equations(gt.cartan(frame), g.f_of("T", f))
    assert found.scalar("T") == 6 * (H - 1 / a) ** 2
    plain, slope = written(found.scalars["T"])
    E = found.E.in_coordinates()
    assert agree(E, (0, 0), plain - 12 * H * (H - 1 / a) * slope)
    assert found.antisymmetric.is_zero


def test_a_bad_tetrad_of_flat_space() -> None:
    """The diagonal tetrad of flat FLRW in spherical coordinates: E_[ij] of f(T) is not zero."""
    frame = gt.Frame([T, R, THETA, PHI], sp.diag(1, a, a * R, a * R * sp.sin(THETA)), LORENTZ)
    assert not g.equations(gt.cartan(frame), g.f_of("T", f)).antisymmetric.is_zero
    assert g.equations(gt.cartan(frame), g.tegr).antisymmetric.is_zero


@pytest.mark.parametrize("name", ["kerr", "schwarzschild", "frw", "goedel"])
def test_tegr_is_general_relativity(name: str) -> None:
    """E = 2 G and M = G; new general relativity with (1/4, 1/2, -1) is TEGR."""
    frame = gt.spaces.load(name).frame
    einstein = gt.levi_civita(frame).curvature.einstein.in_frame()
    for theory in (g.tegr, g.new_gr(sp.Rational(1, 4), sp.Rational(1, 2), -1)):
        found = g.equations(gt.cartan(frame), theory)
        assert (found.E.lowered() - einstein * 2).is_zero
        assert (found.M - einstein).is_zero
    other = g.equations(gt.levi_civita(frame), g.general_relativity)
    assert (other.E.lowered() + einstein * 2).is_zero
    assert other.C.is_zero


def test_the_scalar_of_the_parts() -> None:
    """S by c1, c2, c3 equals its form by the squares of the parts, in dimensions three and four."""
    c1, c2, c3 = sp.symbols("c1 c2 c3")
    x, y, z, _ = q = sp.symbols("x y z w")
    for n in (3, 4):
        matrix = sp.Matrix([[1, y * z, 0, x], [0, 1, x, 0], [0, 0, 1, y], [0, 0, 0, 1]])[:n, :n]
        con = gt.cartan(gt.Frame(q[:n], matrix, (-1, *(1,) * (n - 1))))
        names = g.names
        parts = (c1 + c2 / 2) * names["tensor2"] + (c1 - c2) * names["axial2"]
        parts += ((2 * c1 + c2) / (n - 1) + c3) * names["T3"]
        found = g.equations(con, g.new_gr(c1, c2, c3).expression - parts)
        assert found.L.is_zero
        assert not g.equations(con, parts).L.is_zero


def test_nonmetricity_cosmology() -> None:
    """Q = 6 H^2/N^2, M_00 = 6 H^2 f'/N^2 - f/2; M = G for f = Q (Beltran Jimenez et al. 2018)."""
    N = sp.Function("N")(T)
    frame = gt.Frame([T, X, Y, Z], sp.diag(N, a, a, a), LORENTZ)
    flat = gt.from_coefficients(frame, [[[0] * 4] * 4] * 4)
    found = g.equations(flat, g.f_of("Q", f))
    assert found.scalar("Q") == 6 * H**2 / N**2
    plain, slope = written(found.scalars["Q"])
    assert agree(found.M, (0, 0), 6 * H**2 * slope / N**2 - plain / 2)
    einstein = gt.levi_civita(frame).curvature.einstein.in_frame()
    assert (g.equations(flat, g.stegr).M - einstein).is_zero


def test_symmetric_teleparallel_gravity_away_from_cosmology() -> None:
    """M = G for a metric without symmetries, in the coincident gauge."""
    x, y, z = q = sp.symbols("x y z")
    frame = gt.Frame(q, [[1 + y**2, x * z, 0], [0, 1, x * y], [z, 0, 1]], (-1, 1, 1))
    flat = gt.from_coefficients(frame, [[[0] * 3] * 3] * 3)
    einstein = gt.levi_civita(frame).curvature.einstein.in_frame()
    assert not einstein.is_zero
    assert (g.equations(flat, g.stegr).M - einstein).is_zero


def test_the_minisuperspace_has_the_same_equation() -> None:
    """E_0^0 of f(T) is the derivative of N a^3 f(6 H^2/N^2) with respect to N, over a^3."""
    lapse, rate, size = sp.symbols("N v a", positive=True)
    frame = gt.Frame([T, X, Y, Z], sp.diag(sp.Function("N")(T), a, a, a), LORENTZ)
    found = g.equations(gt.cartan(frame), "T + c*T**3")
    value = 6 * rate**2 / (size * lapse) ** 2
    reduced = sp.diff(lapse * size**3 * (value + sp.Symbol("c") * value**3), lapse) / size**3
    own = {rate: sp.diff(a, T), size: a, lapse: sp.Function("N")(T)}
    assert agree(found.E, (0, 0), reduced.subs(own))


def test_new_general_relativity_in_weak_fields() -> None:
    """gamma = c3 / (2 c1 + c2 + 2 c3) (Ualikhanova, Hohmann 2019)."""
    c1, c2, c3, small, gamma = sp.symbols("c1 c2 c3 epsilon gamma")
    U = sp.Function("U")(X, Y, Z)
    size = 1 + small * gamma * U
    frame = gt.Frame([T, X, Y, Z], sp.diag(1 - small * U, size, size, size), LORENTZ)
    found = g.equations(gt.cartan(frame), g.new_gr(c1, c2, c3))
    first = sp.diff(found.E[1, 2], small).subs(small, 0).doit()
    (solution,) = sp.solve(sp.simplify(first / sp.diff(U, X, Y)), gamma)
    assert sp.simplify(solution - c3 / (2 * c1 + c2 + 2 * c3)) == 0


def test_f_of_the_curvature() -> None:
    """E_ij = f g_ij - 2 f' R_ij + 2 D_i D_j f' - 2 g_ij box f'."""
    N = sp.Function("N")(R)
    frame = gt.Frame([T, R, THETA, PHI], sp.diag(N, 1 / N, R, R * sp.sin(THETA)), LORENTZ)
    bar = gt.levi_civita(frame)
    scalar = bar.curvature.scalar
    for function, value, slope in (
        (lambda x: x + C * x**2, scalar + C * scalar * scalar, scalar * 2 * C + 1),
        (lambda x: x**3, scalar * scalar * scalar, scalar * scalar * 3),
    ):
        found = g.equations(bar, g.f_of("R", function))
        second = bar.covariant_derivative(bar.covariant_derivative(slope))
        box = gt.contract("ab,ab->", second, frame.inverse_metric)
        wanted = frame.metric * value - bar.curvature.ricci * slope * 2
        wanted = wanted + second * 2 - frame.metric * box * 2
        assert (found.E.lowered().in_coordinates() - wanted).is_zero
        assert all(check.holds for check in found.identities())


def test_gauss_bonnet() -> None:
    """No equation in four dimensions; in five the equation of Boulware and Deser (1985).

    (r^2 (1 - F) + 2 alpha (1 - F)^2)' = 0
    """
    kerr = gt.spaces.load("frw").frame
    assert g.equations(gt.levi_civita(kerr), g.gauss_bonnet).E.is_zero
    F, alpha = sp.Function("F")(R), sp.Symbol("alpha")
    u, v, w = sp.symbols("u v w", real=True)
    sphere = (R, R * sp.sin(u), R * sp.sin(u) * sp.sin(v))
    frame = gt.Frame(
        [T, R, u, v, w], sp.diag(sp.sqrt(F), 1 / sp.sqrt(F), *sphere), (-1, 1, 1, 1, 1)
    )
    found = g.equations(gt.levi_civita(frame), "R + alpha*GB")
    wanted = 3 * sp.diff(R**2 * (1 - F) + 2 * alpha * (1 - F) ** 2, R) / R**3
    assert agree(found.E, (0, 0), wanted)
    assert not found.E.is_zero
    mass = sp.Symbol("m", positive=True)
    solved = 1 + R**2 / (4 * alpha) * (1 - sp.sqrt(1 + 8 * alpha * mass / R**4))
    vacuum = frame.subs({F: solved})
    assert g.equations(gt.levi_civita(vacuum), "R + alpha*GB").E.is_zero


def kerr_de_sitter() -> gt.Connection:
    """Kerr-de Sitter space with torsion (McCrea, Baekler, Guerses 1987)."""
    connection = gt.spaces.load("kerr_de_sitter_torsion").connection
    assert connection is not None
    return connection


def test_kerr_de_sitter_with_torsion() -> None:
    """E = C = 0 with all symbols free, if a + 2b = (4 Lambda/3)(w - p)."""
    connection = kerr_de_sitter()
    text = "a*(R - 2*Lambda) + b*(tensor2 - 2*vector2) + w*(P1 - P2 - P4) + p*P6"
    solved = text.replace("b*", "(2*Lambda*(w - p)/3 - a/2)*")
    found = g.equations(connection, solved)
    assert found.E.is_zero
    assert found.C.is_zero
    assert not connection.torsion.S.is_zero
    free = g.equations(connection, text)
    assert not free.E.is_zero
    assert not free.C.is_zero
    assert not g.equations(connection, solved.replace("P4", "P5")).C.is_zero


def test_a_connection_that_is_metric_by_its_numbers() -> None:
    """Kerr-de Sitter with torsion from bare coefficients has the same C = 0, antisymmetric."""
    made = kerr_de_sitter()
    bare = gt.from_coefficients(made.frame, made.coefficients)
    assert (made.kind, bare.kind) == ("metric", "general")
    text = "a*(R - 2*Lambda) + b*(tensor2 - 2*vector2) + w*(P1 - P2 - P4) + p*P6"
    solved = text.replace("b*", "(2*Lambda*(w - p)/3 - a/2)*")
    found = g.equations(bare, solved)
    assert found.E.is_zero
    assert found.C.is_zero
    assert found.tensors.keys() == {"E", "E_[ij]", "C"}
    free, wanted = g.equations(bare, text), g.equations(made, text)
    assert not free.C.is_zero
    assert (free.C - wanted.C).is_zero
    assert (free.E - wanted.E).is_zero
    # In metric-affine gravity the connection is varied freely, and C of R2 has a symmetric part.
    full = g.equations(bare, g.Lagrangian("R2", "metric-affine")).C.lowered(1)
    turned = gt.contract("nij->nji", full)
    part = g.equations(bare, "R2").C.lowered(1)
    assert (full - turned - part * 2).is_zero
    assert not (full + turned).is_zero
    # A Lagrangian with nonmetricity also belongs to that theory.
    mixed = g.equations(bare, "U1").C.lowered(1)
    assert not (mixed + gt.contract("nij->nji", mixed)).is_zero


def tensor_modes(order: int) -> gt.Frame:
    """Flat FLRW with a gravitational wave h(t, z), epsilon to some order."""
    small, h = sp.Symbol("epsilon"), sp.Function("h")(T, Z)
    stretch = sp.exp(small * h / 2)
    frame = gt.Frame([T, X, Y, Z], sp.diag(1, a * stretch, a / stretch, a), LORENTZ)
    return frame.expanded("epsilon", order)


def test_tensor_modes_of_any_f_of_T() -> None:
    """h'' + (3 H + T' f''/f') h' - h_zz/a^2 = 0 (Chen, Dent, Dutta, Saridakis 2011)."""
    frame = tensor_modes(2)
    found = g.equations(gt.cartan(frame), "f(T)")
    h, slot = sp.Function("h")(T, Z), sp.Symbol("s")
    value = 6 * H**2
    first, second = (sp.Subs(sp.Derivative(f(slot), (slot, k)), slot, value) for k in (1, 2))
    rate, wave = sp.diff(h, T), sp.diff(h, T, 2) - sp.diff(h, Z, 2) / a**2
    wanted = first * (wave + 3 * H * rate) + second * sp.diff(value, T) * rate
    linear = found.E.order(1)
    assert agree(linear, (1, 1), wanted)
    assert agree(linear, (2, 2), -wanted)
    assert set(linear.nonzero()) == {(1, 1), (2, 2)}
    text = str(found.written(linear.element(1, 1)))
    assert "Derivative(f(T_0), T_0)" in text
    assert "xi" not in text
    # L to second order: f + f' (h_z^2/a^2 - h'^2)/2, from which the linear equation follows.
    quadratic = first * (sp.diff(h, Z) ** 2 / a**2 - rate**2) / 2
    assert agree(found.L.order(2), (), quadratic)
    assert all(check.holds for check in found.identities())


SLOTS = sp.symbols("s1 s2")
ALPHA = sp.Symbol("alpha")


@pytest.mark.parametrize(
    ("text", "value"),
    [
        ("T + alpha*T**2", SLOTS[0] + ALPHA * SLOTS[0] ** 2),
        ("exp(alpha*T)", sp.exp(ALPHA * SLOTS[0])),
    ],
)
def test_an_expanded_function_is_the_function_expanded(text: str, value: sp.Expr) -> None:
    """f(T) to second order, with f inserted afterwards, equals the expansion of that theory."""
    frame = tensor_modes(2)
    general, special = (g.equations(gt.cartan(frame), x).E for x in ("f(T)", text))
    for order in range(3):
        one, two = general.order(order), special.order(order)
        for i in range(4):
            inserted = one[i, i].subs(f, sp.Lambda(SLOTS[0], value)).doit()
            assert agree(two, (i, i), inserted), (order, i)
    assert not special.order(2).is_zero


def test_functions_of_several_invariants_and_of_a_field_are_expanded() -> None:
    """f(T, X) V(phi) about a moving background: the identities hold to second order."""
    small, w = sp.Symbol("epsilon"), sp.Function("w")(T, Z)
    frame = tensor_modes(2)
    phi = sp.Function("u")(T) + small * w
    found = g.equations(gt.cartan(frame), "f(T, X) + T*V(phi)", g.scalar_field(phi))
    assert all(check.holds for check in found.identities())
    plain = g.equations(gt.cartan(frame), "T*X**2 + T*phi**3", g.scalar_field(phi))
    inserted = {
        f: sp.Lambda(SLOTS, SLOTS[0] * SLOTS[1] ** 2),
        sp.Function("V"): sp.Lambda(SLOTS[0], SLOTS[0] ** 3),
    }
    for order in range(3):
        one = found.matter_equations["phi"].order(order)[()]
        for name, value in inserted.items():
            one = one.subs(name, value).doit()
        assert agree(plain.matter_equations["phi"].order(order), (), one), order


def density(frame: gt.Frame) -> gt.Tensor:
    """e P_0^{tr} of TEGR."""
    P = g.equations(gt.cartan(frame), g.tegr).P
    mixed = gt.contract("abc,ma,nb->mnc", P, frame.legs, frame.legs)
    return frame.determinant * mixed[0, 1, 0]


def test_energy_in_a_sphere_of_schwarzschild() -> None:
    """E = r (1 - sqrt(1 - 2M/r)) in the frame that tends to the Cartesian one."""
    frame = gt.spaces.load("schwarzschild_cartesian").frame
    F = 1 - 2 * sp.Symbol("M", positive=True) / R
    energy = density(frame) * (-sp.Integer(1) / 2) / sp.sin(THETA)
    assert energy == R * (1 - sp.sqrt(F))


@pytest.mark.parametrize(
    ("spin", "energy"), [("0.5", "1.93246471912685501"), ("1", "1.45527037436770254")]
)
def test_energy_in_the_horizon_of_kerr(spin: str, energy: str) -> None:
    """Values of Maluf, da Rocha-Neto, Toribio, Castello-Branco (2002), 18 digits."""
    M, j = sp.symbols("M j", positive=True)
    S, D = R**2 + j**2 * sp.cos(THETA) ** 2, R**2 - 2 * M * R + j**2
    psi = (R**2 + j**2) ** 2 - D * j**2 * sp.sin(THETA) ** 2
    coframe = spherical(
        sp.sqrt(D * S / psi),
        sp.sqrt(S / D),
        sp.sqrt(S),
        sp.sqrt(psi / S) * sp.sin(THETA),
        -2 * M * j * R / psi,
    )
    domain = [R > 2 * M, THETA > 0, THETA < 3]
    frame = gt.Frame([T, R, THETA, PHI], coframe, LORENTZ, domain=domain)
    # At the horizon one root vanishes, but the density is finite.
    found = density(frame)[()]
    with mpmath.workdps(30):
        k = sp.Rational(spin)
        at_horizon = found.subs({R: 1 + sp.sqrt(1 - k**2), M: 1, j: k})
        value = sp.lambdify([THETA], at_horizon, "mpmath")
        whole = mpmath.quad(lambda x: -value(x) / 4, [0, mpmath.pi / 2, mpmath.pi])
        assert abs(whole - mpmath.mpf(energy)) < 1e-17


def test_poincare_is_its_text() -> None:
    """The preset equals the sum of its terms, and needs six factors of curvature."""
    connection = kerr_de_sitter()
    preset = g.poincare(
        "a", "Lambda", tensor="b", vector="d", axial=3, curvature=[0, 1, 0, 0, 0, "p"]
    )
    text = "a*(R - 2*Lambda) + b*tensor2 + d*vector2 + 3*axial2 + P2 + p*P6"
    assert (g.equations(connection, preset).L - g.equations(connection, text).L).is_zero
    with pytest.raises(GravityError, match="six factors"):
        g.poincare(curvature=[1])


def test_the_holst_term_changes_no_equation_without_torsion() -> None:
    """For a connection without torsion the Holst term has C = 0 and E = 0 (first Bianchi)."""
    frame = gt.spaces.load("frw").frame
    bar = gt.from_spin_connection(frame, gt.levi_civita(frame).spin_connection)
    assert bar.kind == "metric"
    found = g.equations(bar, g.holst())
    plain = g.equations(bar, "R")
    assert (found.E - plain.E).is_zero
    assert found.C.is_zero


COSMOS = gt.Frame([T, X, Y, Z], sp.diag(1, a, a, a), LORENTZ)


def test_both_indices_of_the_coframe_equation_down() -> None:
    """Einstein's G_ij of a wave: E_ij = -2 G_ij + ..., whose time rows a mixed sum would lose."""
    u = sp.Function("u")(T, Z)
    tilted = gt.Frame(
        [T, X, Y, Z], [[1, u, 0, 0], [0, 1, 0, 0], [0, 0, 1, 0], [0, 0, 0, 1]], LORENTZ
    )
    found = g.equations(gt.levi_civita(tilted), "R")
    einstein = gt.levi_civita(tilted).curvature.einstein.in_frame()
    assert (found.E_lower + 2 * einstein).is_zero
    assert (found.symmetric - found.E_lower).is_zero
    assert found.E_lower.slots == found.symmetric.slots == "DD"
    assert found.E[0, 1] + found.E[1, 0] == 0 != found.symmetric[0, 1]
    bent = g.equations(gt.cartan(tilted), "T1")
    assert (bent.symmetric + bent.antisymmetric - bent.E_lower).is_zero


def test_components_are_readable() -> None:
    """f(T) and f'(T) in names, also with both indices down, and for matter."""
    field = g.scalar_field("phi(t)")
    found = g.equations(gt.cartan(COSMOS), "f(T) + K(X)", field)
    slot = sp.Symbol("T")
    first = sp.Derivative(f(slot), slot)
    assert found.readable("P", 0, 1, 1) == 2 * H * first
    time = found.readable("E", 0, 0)
    assert sp.expand(found.readable("E_ij", 0, 0) + time) == 0
    assert sp.expand(found.readable("E_(ij)", 0, 0) + time) == 0
    assert time.coeff(first) == -12 * H**2
    for name, index in (("L", ()), ("phi", ()), ("E_[ij]", (0, 1)), ("E_ij", (1, 1))):
        assert "Subs" not in str(found.readable(name, *index))
    with pytest.raises(GravityError, match="name: expected"):
        found.readable("psi")


def test_the_first_order_about_a_solution_only() -> None:
    """Minkowski solves R, and does not solve R - 2 Lambda; a universe has its own conditions."""
    small, u = sp.Symbol("epsilon"), sp.Function("u")(T, Z)
    plane = sp.diag(1, 1 + small * u, 1 - small * u, 1)
    waves = gt.Frame([T, X, Y, Z], plane, LORENTZ).expanded("epsilon", 1)
    vacuum = g.equations(gt.levi_civita(waves), "R")
    assert vacuum.background == {}
    # The wave equation of a plane wave along z, in the plane across.
    first = vacuum.order(1)
    box = sp.diff(u, T, 2) - sp.diff(u, Z, 2)
    quotient = first["E"][1, 1] / box
    assert sp.simplify(quotient).is_Rational
    assert vacuum.order(0)["E"].is_zero
    dark = g.equations(gt.levi_civita(waves), "R - 2*Lambda")
    assert dark.background == {"E_1^1": sp.Symbol("Lambda")}
    assert not dark.order(0)["E"].is_zero
    with pytest.raises(GravityError, match=r"got E_1\^1 = Lambda at order 0"):
        dark.order(1)
    moving = g.equations(gt.levi_civita(tensor_modes(1)), "R")
    with pytest.raises(GravityError, match="Give a frame whose order 0 is a solution"):
        moving.order(1)
    assert not moving.E.order(1).is_zero
    with pytest.raises(GravityError, match="Expand it first"):
        _ = g.equations(gt.levi_civita(COSMOS), "R").background
    field = g.scalar_field(small * u)
    tense = g.equations(gt.levi_civita(waves), "R - X", field)
    assert set(tense.order(1)) == {"E", "phi"}
    assert sp.simplify(tense.order(1)["phi"][()] / box).is_Rational

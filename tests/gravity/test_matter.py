"""Matter: fields in the Lagrangian and fluids as sources, compared with known solutions."""

from itertools import product

import pytest
import sympy as sp

import geomtorsion as gt
from geomtorsion import gravity as g
from geomtorsion.errors import GravityError

T, R, X, Y, Z = sp.symbols("t r x y z", real=True)
THETA, PHI = sp.symbols("theta phi", real=True)
KAPPA, RHO, SPIN, MASS, CHARGE = sp.symbols("kappa rho0 s0 M q", positive=True)
LORENTZ = (-1, 1, 1, 1)


def cosmos(size: sp.Expr) -> gt.Frame:
    """Flat FLRW."""
    return gt.Frame([T, X, Y, Z], sp.diag(1, size, size, size), LORENTZ)


def test_weyssenhoff_dust_bounces() -> None:
    """a^3 = kappa s0^2/(4 rho0) + 3 kappa rho0 t^2/4 (Kopczynski 1972, Trautman 1973)."""
    volume = KAPPA * SPIN**2 / (4 * RHO) + 3 * KAPPA * RHO * T**2 / 4
    frame = cosmos(volume ** sp.Rational(1, 3))
    s = SPIN / volume
    spin = [[0] * 4, [0, 0, s, 0], [0, -s, 0, 0], [0] * 4]
    tau = [spin, *([[0] * 4] * 4 for _ in range(3))]
    torsion = g.torsion_from_spin(frame, tau, KAPPA)
    assert torsion[1, 2, 0] == sp.simplify(KAPPA * s)
    connection = gt.from_torsion(frame, torsion / 2)
    dust = g.weyssenhoff(RHO / volume, 0, [1, 0, 0, 0], spin)
    found = g.equations(connection, g.einstein_cartan, matter=dust)
    assert found.E.is_zero
    assert found.C.is_zero
    spinless = g.equations(connection, g.einstein_cartan, g.fluid(RHO / volume, 0, [1, 0, 0, 0]))
    assert not spinless.C.is_zero
    heavy = g.weyssenhoff(2 * RHO / volume, 0, [1, 0, 0, 0], spin)
    assert not g.equations(connection, g.einstein_cartan, heavy).E.is_zero


@pytest.mark.parametrize("n", [3, 4, 5])
def test_torsion_of_any_spin_density_solves_the_connection_equation(n: int) -> None:
    """C of R/(2 kappa) and of the spin density add up to zero, traces included."""
    q = sp.symbols("x0:5")[:n]
    frame = gt.Frame(q, sp.eye(n) + sp.diag(q[1] ** 2, *[0] * (n - 1)), (-1, *(1,) * (n - 1)))
    tau = sp.MutableDenseNDimArray.zeros(n, n, n)
    for k, (c, i, j) in enumerate([(0, 0, 1), (1, 1, 2), (2, 0, 2), (0, 1, 2), (1, 0, 1)]):
        tau[c, i, j], tau[c, j, i] = k + q[0], -k - q[0]
    torsion = g.torsion_from_spin(frame, tau.tolist())
    connection = gt.from_torsion(frame, torsion / 2)
    C = g.equations(connection, g.einstein_cartan).C.lowered(1)
    places = [place for place in product(range(n), repeat=3) if tau[place] != 0]
    given = gt.Tensor(frame, "UDD", {place: tau[place] for place in places})
    assert (C * 2 + given).is_zero


def test_a_perfect_fluid_in_general_relativity() -> None:
    """Dust and radiation: 3 H^2 = kappa rho, from R/(2 kappa) in either of two signatures."""
    for size, pressure in ((T ** sp.Rational(2, 3), 0), (sp.sqrt(T), sp.Rational(1, 3))):
        rho = 3 * (sp.diff(size, T) / size) ** 2 / KAPPA
        source = g.fluid(rho, pressure * rho, [1, 0, 0, 0])
        for signature, sign in ((LORENTZ, 1), ((1, -1, -1, -1), -1)):
            frame = gt.Frame([T, X, Y, Z], sp.diag(1, size, size, size), signature)
            text = "R/(2*kappa)" if sign > 0 else "-R/(2*kappa)"
            assert g.equations(gt.levi_civita(frame), text, source).E.is_zero


def test_a_moving_fluid_with_spin_has_the_identity_of_rotations() -> None:
    """E_[ji] + D_n C^n_[ij] = 0 along u for the sources; the momentum is not along the velocity."""
    frame = gt.Frame(
        [T, X, Y, Z], [[1 + X**2, 0, 0, 0], [0, 1, T, 0], [0, 0, 1, X], [0, 0, 0, 1]], LORENTZ
    )
    h = sp.Symbol("h", real=True) * X
    u = [sp.cosh(h), sp.sinh(h), 0, 0]
    # s_ij u^j = 0: in the plane of legs 2 and 3, and of leg 2 with the leg across u.
    across = [-sp.sinh(h), sp.cosh(h), 0, 0]
    spin = sp.zeros(4, 4)
    spin[2, 3], spin[3, 2] = Y, -Y
    for i, c in enumerate(across):
        spin[i, 2], spin[2, i] = spin[i, 2] + c * T, spin[2, i] - c * T
    connection = gt.cartan(frame)
    found = g.equations(connection, "0", g.weyssenhoff(RHO, X, u, spin.tolist()))
    twice = found.M - gt.contract("ab->ba", found.M)
    # Along u it holds by the choice of p_i; across u it is the equation of motion of the spin.
    velocity = gt.Tensor(frame, "U", {(i,): x for i, x in enumerate(u) if x != 0})
    assert not found.antisymmetric.is_zero
    assert gt.contract("ab,b->a", twice, velocity).is_zero


def test_a_scalar_field_with_a_potential() -> None:
    """3 H^2 = phi'^2/2 + V, phi'' + 3 H phi' + V' = 0, and the identity that connects them."""
    a, phi, V = sp.Function("a")(T), sp.Function("phi")(T), sp.Function("V")
    frame = cosmos(a)
    found = g.equations(gt.cartan(frame), "-T/2 - X/2 - V(phi)", g.scalar_field(phi))
    H, rate = sp.diff(a, T) / a, sp.diff(phi, T)
    slot = sp.Symbol("s")
    slope = sp.Subs(sp.Derivative(V(slot), slot), slot, phi)
    assert frame.scalar(found.E[0, 0]) == 3 * H**2 - rate**2 / 2 - V(phi)
    assert found.matter_equations["phi"] == -sp.diff(rate, T) - 3 * H * rate - slope
    assert all(check.holds for check in found.identities())


def test_reissner_and_nordstroem() -> None:
    """The charged black hole solves the equations of R - F2 and of -T - F2."""
    F = 1 - 2 * MASS / R + CHARGE**2 / R**2
    frame = gt.Frame(
        [T, R, THETA, PHI], sp.diag(sp.sqrt(F), 1 / sp.sqrt(F), R, R * sp.sin(THETA)), LORENTZ
    )
    field = g.maxwell([CHARGE / R, 0, 0, 0])
    for connection, text in ((gt.levi_civita(frame), "R - F2"), (gt.cartan(frame), "-T - F2")):
        found = g.equations(connection, text, field)
        assert found.E.is_zero
        assert found.matter_equations["A"].is_zero
        assert found.scalar("F2") == -2 * CHARGE**2 / R**4
    assert not g.equations(gt.levi_civita(frame), "R - 2*F2", field).E.is_zero


def test_matter_fields_keep_the_identities() -> None:
    """The identities hold off shell with matter, which couples to torsion in any way."""
    x, y, z = q = sp.symbols("x y z")
    frame = gt.Frame(q, [[1 + y**2, x * z, 0], [0, 1, x * y], [z, 0, 1]], (-1, 1, 1))
    matter = [g.scalar_field(x * y + z**2), g.maxwell([y * z, x**2, x * y])]
    for connection in (gt.cartan(frame), gt.levi_civita(frame)):
        name = "T" if connection.kind == "cartan" else "R"
        text = f"{name}*X + F2*X + phi**2*X + W(phi)*F2*{name}"
        found = g.equations(connection, text, matter)
        assert all(check.holds for check in found.identities())
        assert set(found.matter_equations) == {"phi", "A"}
        assert not any(one.is_zero for one in found.matter_equations.values())


def test_hypermomentum_of_spin_is_weyssenhoffs_fluid() -> None:
    """With s^i_j u^n/2 and -rho u_i u^n, a general source is dust with spin."""
    frame = gt.Frame([T, X, Y, Z], sp.diag(1, 1 + T**2, 1, 1), LORENTZ)
    spin = [[0] * 4, [0, 0, X, 0], [0, -X, 0, 0], [0] * 4]
    dust = g.weyssenhoff(RHO, 0, [1, 0, 0, 0], spin)
    zero = [[0] * 4] * 4
    half = [[value / 2 for value in row] for row in sp.Matrix(spin).tolist()]
    energy = [[-RHO, 0, 0, 0], [0] * 4, [0] * 4, [0] * 4]
    source = g.hypermomentum([half, zero, zero, zero], energy)
    one, other = (g.equations(gt.cartan(frame), "R + T1", x) for x in (dust, source))
    assert (one.E - other.E).is_zero
    assert (one.C - other.C).is_zero
    assert not one.C.is_zero
    # A shear turns nothing, so that it acts on general connections only.
    pressed = [[[0] * 4, [0, 0, X, 0], [0, X, 0, 0], [0] * 4], zero, zero, zero]
    bare = g.equations(gt.cartan(frame), "R + T1")
    pressed_source = g.hypermomentum(pressed)
    assert (g.equations(gt.cartan(frame), "R + T1", pressed_source).C - bare.C).is_zero
    free = g.Lagrangian("R + T1", "metric-affine")
    moved = g.equations(gt.cartan(frame), free, pressed_source).C
    assert (moved - g.equations(gt.cartan(frame), free).C)[0, 1, 2] == X


FLAT = gt.Frame([T, X, Y, Z], sp.eye(4), LORENTZ)
U, W = sp.Function("u")(T), sp.Function("w")(T)


def test_two_scalar_fields_have_two_names() -> None:
    """The energy of -X/2 - X_2/2 is (u'^2 + w'^2)/2, and each field has its own equation."""
    pair = [g.scalar_field("u(t)"), g.scalar_field("w(t)")]
    found = g.equations(gt.levi_civita(FLAT), "-X/2 - X_2/2 - 3*phi*phi_2**2", pair)
    potential = 3 * U * W**2
    assert FLAT.scalar(found.E[0, 0]) == -(sp.diff(U, T) ** 2 + sp.diff(W, T) ** 2) / 2 - potential
    assert found.matter_equations["phi"] == -sp.diff(U, T, 2) - 3 * W**2
    assert found.matter_equations["phi_2"] == -sp.diff(W, T, 2) - 6 * U * W
    assert found.scalar("X_2") == -(sp.diff(W, T) ** 2)
    named = g.equations(
        gt.levi_civita(FLAT),
        "-X/2 - X_2/2 - 3*phi*chi**2",
        [g.scalar_field("u(t)"), g.scalar_field("w(t)", name="chi")],
    )
    assert (named.E - found.E).is_zero
    assert set(named.matter_equations) == {"phi", "chi"}


def test_two_maxwell_fields_have_two_names() -> None:
    """A black hole with two charges: Q^2 = q^2 + p^2 with p of the second field."""
    other = sp.Symbol("p", positive=True)
    F = 1 - 2 * MASS / R + (CHARGE**2 + other**2) / R**2
    coframe = sp.diag(sp.sqrt(F), 1 / sp.sqrt(F), R, R * sp.sin(THETA))
    frame = gt.Frame([T, R, THETA, PHI], coframe, LORENTZ)
    # A magnetic second field: A_phi = -p cos(theta).
    pair = [g.maxwell([CHARGE / R, 0, 0, 0]), g.maxwell([0, 0, 0, -other * sp.cos(THETA)])]
    found = g.equations(gt.levi_civita(frame), "R - F2 - F2_2", pair)
    assert found.E.is_zero
    assert set(found.matter_equations) == {"A", "A_2"}
    assert all(one.is_zero for one in found.matter_equations.values())
    assert found.scalar("F2_2") == 2 * other**2 / R**4
    assert not g.equations(gt.levi_civita(frame), "R - F2 - 2*F2_2", pair).E.is_zero


def test_several_matter_fields_keep_the_identities() -> None:
    """Two fields of each kind off shell, with torsion and with products of their invariants."""
    x, y, z = q = sp.symbols("x y z")
    frame = gt.Frame(q, [[1 + y**2, x * z, 0], [0, 1, x * y], [z, 0, 1]], (-1, 1, 1))
    matter = [
        g.scalar_field(x * y + z**2),
        g.scalar_field(x - y * z, name="chi"),
        g.maxwell([y * z, x**2, x * y]),
        g.maxwell([z, x * y, 0]),
    ]
    text = "T1*X + F2*X_2 + chi*phi**2 + W(phi, chi)*F2_2*T2"
    found = g.equations(gt.cartan(frame), text, matter)
    assert all(check.holds for check in found.identities())
    assert set(found.matter_equations) == {"phi", "chi", "A", "A_2"}
    assert not any(one.is_zero for one in found.matter_equations.values())


def test_a_field_by_its_own_function() -> None:
    """phi(t) in the Lagrangian is the field: the potential stays in its equation."""
    names, square = g.names, sp.Function("phi")(T) ** 2 / 2
    field = g.scalar_field(sp.Function("phi")(T))
    found = [
        g.equations(gt.levi_civita(FLAT), lagrangian, field)
        for lagrangian in (
            names["R"] / 2 - names["X"] / 2 - square,
            "R/2 - X/2 - phi(t)**2/2",
            "R/2 - X/2 - phi**2/2",
        )
    ]
    phi = sp.Function("phi")(T)
    for one in found:
        assert one.matter_equations["phi"] == -sp.diff(phi, T, 2) - phi
        assert one.matter_equations["phi"][0] == one.matter_equations["phi"][()]
        assert all(check.holds for check in one.identities())
    other = g.equations(gt.levi_civita(FLAT), "-X/2 - u(t)**4", g.scalar_field("u(t)", name="chi"))
    assert other.matter_equations["chi"] == -sp.diff(U, T, 2) - 4 * U**3


def test_a_slope_of_the_potential() -> None:
    """V'(phi(t)) as sympy writes it is V'(phi)."""
    V, phi = sp.Function("V"), sp.Function("phi")(T)
    found = g.equations(
        gt.levi_civita(FLAT), -g.names["X"] / 2 - V(phi).diff(phi) * phi, g.scalar_field(phi)
    )
    cubic = {V: sp.Lambda(X, X**3)}
    equation = found.matter_equations["phi"][()].subs(cubic).doit()
    assert sp.simplify(equation + sp.diff(phi, T, 2) + 9 * phi**2) == 0


def test_the_name_of_a_scalar_field() -> None:
    """A black hole with an angle phi has a scalar field chi with a mass."""
    frame = gt.spaces.load("schwarzschild").frame
    chi = g.scalar_field("u(r)", name="chi")
    found = g.equations(gt.levi_civita(frame), "R/2 - X/2 - m**2*chi**2/2", chi)
    r = frame.coordinates[1]
    u, mass = sp.Function("u")(r), frame.parameters[0]
    box = sp.diff(r * (r - 2 * mass) * sp.diff(u, r), r) / r**2
    assert found.matter_equations["chi"] == box - sp.Symbol("m") ** 2 * u
    assert found.constants == ("m",)
    assert all(check.holds for check in found.identities())


PAIR = [g.scalar_field("u(t)"), g.scalar_field("w(t)")]
MATTER_REFUSED = {
    "shape of a density": ("0", g.hypermomentum([[1, 2]]), "density: expected 4 entries, got 1"),
    "rank of a density": (
        "0",
        g.hypermomentum(FLAT.metric),
        "density: expected a tensor with 3 indices",
    ),
    "shape of an energy": (
        "0",
        g.hypermomentum([[[0] * 4] * 4] * 4, [[0] * 4, [0] * 3, [0] * 4, [0] * 4]),
        "energy_momentum[1]: expected 4 entries, got 3",
    ),
    "second field": ("-X/2", PAIR, "expected a Lagrangian with X_2 or phi_2"),
    "second maxwell": (
        "-F2",
        [g.maxwell(["u(x)", 0, 0, 0])] * 2,
        "expected a Lagrangian with F2_2, got -F2. Add a term of the Maxwell field A_2",
    ),
    "no such second field": ("-X/2 - X_2/2", PAIR[:1], "X_2 belongs to another matter field"),
    "one name twice": (
        "-X/2 - X_2/2",
        [g.scalar_field("u(t)", name="chi"), g.scalar_field("w(t)", name="chi")],
        "got chi for two fields",
    ),
    "rate of the field": (
        "-X/2 + diff(u(t), t)**2",
        g.scalar_field("u(t)", name="chi"),
        "expected derivatives of a scalar field in X",
    ),
    "rate of a function of the field": (
        g.names["X"] + sp.Derivative(U**2, T),
        g.scalar_field(U),
        "expected derivatives of a scalar field in X",
    ),
    "part of the field": ("-X/2 - u(t)**2", g.scalar_field("2*u(t)"), "u(t), a part of phi"),
    "part of the potential": (
        "-F2 - u(x)**2",
        g.maxwell(["u(x)", 0, 0, 0]),
        "u(x), a part of A",
    ),
    "symbol and function": ("-X/2 - phi*phi(t)", g.scalar_field("phi(t)"), "one way to write phi"),
}


@pytest.mark.parametrize("case", MATTER_REFUSED)
def test_matter_that_is_refused(case: str) -> None:
    """A field that the Lagrangian does not vary, and two fields of one name, are refused."""
    lagrangian, matter, words = MATTER_REFUSED[case]
    with pytest.raises(GravityError) as refused:
        g.equations(gt.levi_civita(FLAT), lagrangian, matter)
    assert words in str(refused.value)

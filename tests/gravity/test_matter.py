"""Matter: fields in the Lagrangian and fluids as sources, compared with known solutions."""

from itertools import product

import pytest
import sympy as sp

import geomtorsion as gt
from geomtorsion import gravity as g

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

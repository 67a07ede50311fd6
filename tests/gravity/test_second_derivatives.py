"""Second derivatives of scalar fields: Lagrangians of galileons and of Horndeski."""

import re

import pytest
import sympy as sp

import geomtorsion as gt
from geomtorsion import gravity as g
from geomtorsion.errors import GeomtorsionError
from tests.gravity.samples import sample_connection, sample_frame

t, x, r, c = sp.symbols("t x r c", real=True)
GENERAL = "X*Box - hessian2/3 + hessian3/7 + 2*Y + W*phi"
COUPLED = [g.invariant("Y", "phi_ab phi^a phi^b"), g.invariant("W", "Rbar_ab phi^ab")]
MIXED = [g.invariant("Y", "T_abc phi^ab phi^c"), g.invariant("W", "R_ab phi^ab")]


def sample_field(frame: gt.Frame):
    """A polynomial scalar field of all coordinates."""
    q = frame.coordinates
    return g.scalar_field(q[0] ** 2 * q[1] + q[-1] ** 2 + q[0] - q[1] * q[-1])


def test_values_in_flat_space() -> None:
    """phi = r^2 has phi_ij = 2 g_ij, in any coordinates and for any connection."""
    frame = spherical()
    field = g.scalar_field(r**2)
    for connection in (gt.levi_civita(frame), gt.cartan(frame)):
        equations = g.equations(connection, "Box*hessian2*hessian3 + R", field)
        assert [equations.scalar(x)[()] for x in ("Box", "hessian2", "hessian3")] == [6, 12, 24]


def spherical() -> gt.Frame:
    """Flat space in spherical coordinates."""
    theta, psi = sp.symbols("theta psi", real=True)
    return gt.Frame([r, theta, psi], sp.diag(1, r, r * sp.sin(theta)), (1, 1, 1))


@pytest.mark.parametrize("n", [2, 3])
def test_identities_of_the_levi_civita_connection(n: int) -> None:
    """E is symmetric, and its divergence is the equation of the field times phi_i."""
    frame = sample_frame(n, 60 + n)
    equations = g.equations(gt.levi_civita(frame), GENERAL, sample_field(frame), invariants=COUPLED)
    assert all(one.holds for one in equations.identities())
    assert equations.antisymmetric.is_zero
    assert not equations.matter_equations["phi"].is_zero


@pytest.mark.parametrize("metric", [True, False])
def test_identities_of_other_connections(metric: bool) -> None:
    """Second derivatives belong to the metric; torsion and curvature multiply them."""
    frame = sample_frame(3, 64)
    connection = sample_connection(frame, 65, metric=metric)
    equations = g.equations(connection, GENERAL, sample_field(frame), invariants=MIXED)
    assert all(one.holds for one in equations.identities())
    assert not equations.C.is_zero


def test_equations_are_the_variation_of_the_action() -> None:
    """E and the matter equation agree with Euler's equations of e L in coordinates."""
    lagrangian, q = "X*Box + hessian2", (t, x)
    examples = (1 + x, t, sp.S.One, t**2 + x**3)
    orders = [(i, j) for i in range(3) for j in range(3 - i)]
    # Jets of the coframe and of the field as symbols.
    jets = [{k: sp.Symbol(f"{name}{k[0]}{k[1]}") for k in orders} for name in "ABDu"]
    values = {
        symbol: value.diff(t, k[0], x, k[1])
        for value, table in zip(examples, jets, strict=True)
        for k, symbol in table.items()
    }

    def slope(expression: sp.Expr, k: int) -> sp.Expr:
        moved = [
            (symbol, table[i + (k == 0), j + (k == 1)])
            for table in jets
            for (i, j), symbol in table.items()
            if i + j < 2
        ]
        return sum((expression.diff(symbol) * other for symbol, other in moved), sp.S.Zero)

    A, B, D, u = (table[0, 0] for table in jets)
    rows = sp.Matrix([[A, 0], [B, D]])
    metric = rows.T * sp.diag(-1, 1) * rows
    inverse = metric.inv()

    def symbol(k: int, m: int, n: int) -> sp.Expr:
        terms = [
            inverse[k, s]
            * (slope(metric[s, m], n) + slope(metric[s, n], m) - slope(metric[m, n], s))
            for s in (0, 1)
        ]
        return sum(terms) / 2

    gradient = sp.Matrix([slope(u, 0), slope(u, 1)])
    hessian = sp.Matrix(
        2,
        2,
        lambda m, n: slope(gradient[m], n) - sum(symbol(k, m, n) * gradient[k] for k in (0, 1)),
    )
    mixed = inverse * hessian
    scalars = {
        "phi": u,
        "X": (gradient.T * inverse * gradient)[0],
        "Box": mixed.trace(),
        "hessian2": (mixed**2).trace(),
        "hessian3": (mixed**3).trace(),
    }
    density = rows.det() * sp.sympify(lagrangian).subs(scalars)
    point = {t: sp.Rational(1, 3), x: sp.Rational(2, 5)}

    def euler(table: dict) -> sp.Expr:
        """The variation by a function: (-d)^k of the derivatives by its jets, at a point."""
        total = sp.S.Zero
        for (i, j), one in table.items():
            weight = density.diff(one).subs(values) * (-1) ** (i + j)
            total += weight.diff(t, i, x, j).subs(point)
        return sp.nsimplify(total)

    frame = gt.Frame(q, rows.subs(values), (-1, 1))
    equations = g.equations(gt.levi_civita(frame), lagrangian, g.scalar_field(examples[3]))
    legs, volume = (part.subs(values).subs(point) for part in (rows.inv(), rows.det()))
    E = sp.Matrix(2, 2, lambda i, n: equations.E[i, n].subs(point))
    # dS/d e^i_m = e E_i^n E_n^m.
    varied = volume * E * legs.T
    field = volume * equations.matter_equations["phi"][()].subs(point)
    assert [*map(euler, jets)] == [varied[0, 0], varied[1, 0], varied[1, 1], field]


def test_covariant_cubic_galileon() -> None:
    """X Box phi: (Box phi)^2 - phi_ab phi^ab - R_ab phi^a phi^b = 0 (Deffayet et al. 2009).

    R_ab is positive for spheres.
    """
    frame = sample_frame(3, 68)
    ricci = g.invariant("Y", "R_ab phi^a phi^b")
    text = "X*Box(phi)"
    equations = g.equations(gt.levi_civita(frame), text, sample_field(frame))
    values = g.equations(
        gt.levi_civita(frame), "Box**2 - hessian2 - Y", sample_field(frame), invariants=ricci
    )
    assert (equations.matter_equations["phi"] + 2 * values.L).is_zero
    assert not values.L.is_zero


def test_kinetic_gravity_braiding_on_a_cosmos() -> None:
    """Energy and current of K + G Box phi (Deffayet, Pujolas, Sawicki, Vikman 2010).

    Box phi has the other sign there, where the signature is +---.
    """
    a, phi = sp.Function("a")(t), sp.Function("phi")(t)
    frame = gt.Frame([t, *sp.symbols("x y z")], sp.diag(1, a, a, a), (-1, 1, 1, 1))
    equations = g.equations(gt.levi_civita(frame), "-X/2 - c*X**2*Box(phi)", g.scalar_field(phi))
    speed, H = phi.diff(t), a.diff(t) / a
    # G(x) = 4 c x^2 with x = phi'^2 / 2.
    slope = 4 * c * speed**2
    current = speed + 3 * H * slope * speed**2
    energy = speed**2 / 2 + 3 * H * slope * speed**3
    constant = sp.Symbol("c")
    E = equations.E[0, 0].subs(constant, c)
    field = equations.matter_equations["phi"][()].subs(constant, c)
    assert sp.simplify(E + energy) == 0
    assert sp.simplify(field * a**3 + (a**3 * current).diff(t)) == 0


def test_a_total_derivative_has_no_equations() -> None:
    """Box phi, and phi^2 Box phi + 2 phi X, have none."""
    frame = sample_frame(3, 69)
    for lagrangian in ("Box(phi)", "phi**2*Box(phi) + 2*phi*X"):
        equations = g.equations(gt.levi_civita(frame), lagrangian, sample_field(frame))
        assert equations.E.is_zero
        assert equations.matter_equations["phi"].is_zero


def test_ways_to_write_the_operator() -> None:
    """Text, sympy and an invariant with indices have one meaning."""
    frame, field = spherical(), g.scalar_field("u(r)")
    metric = gt.levi_civita(frame)
    u = sp.Function("u")(r)
    own = g.invariant("Y", "phi_a^a")
    E = g.equations(metric, "phi*Box", field).E
    symbol = g.names["phi"] * g.names["Box"]
    texts = ("phi*Box(phi)", "phi*box(u(r))", "phi*Box phi", "phi \u25a1phi", "phi*\u25a1(phi)")
    for lagrangian in (*texts, symbol, u * sp.Function("Box")(u)):
        assert g.equations(metric, lagrangian, field).E == E
    assert g.equations(metric, "phi*Y", field, invariants=own).E == E
    named = g.equations(metric, "chi*Box(chi)", g.scalar_field("u(r)", name="chi"))
    assert named.E == E


def test_two_fields() -> None:
    """Box(chi) is Box_2 of a second field chi."""
    frame = spherical()
    fields = [g.scalar_field(r**2), g.scalar_field(r**4, name="chi")]
    equations = g.equations(gt.levi_civita(frame), "X*Box(chi) + X_2*Box(phi)", fields)
    assert equations.scalars["Box_2"] == 20 * r**2
    assert equations.scalars["Box"] == 6
    mixed = g.invariant("Y", "phi_ab chi^ab")
    other = g.equations(gt.levi_civita(frame), "Y", fields, invariants=mixed)
    assert other.L[()] == sp.expand(2 * 20 * r**2)


METRIC = gt.levi_civita(spherical())
REFUSED = {
    "no field": (lambda: g.equations(METRIC, "R + Box"), "belongs to a matter field"),
    "no field in text": (lambda: g.equations(METRIC, "R + Box(phi)"), "belongs to a matter"),
    "not a field": (
        lambda: g.equations(METRIC, "X + Box(R)", g.scalar_field("u(r)")),
        "Box(phi), hessian2 and hessian3",
    ),
    "both": (
        lambda: g.equations(METRIC, "X*Box + Box(phi)", g.scalar_field("u(r)")),
        "expected one way to write Box",
    ),
    "two arguments": (
        lambda: g.equations(METRIC, "X*Box(phi, X)", g.scalar_field("u(r)")),
        "without derivatives",
    ),
    "without the field": (
        lambda: g.equations(METRIC, "Y", invariants=g.invariant("Y", "R_ab W^ab")),
        "W belongs to a matter field",
    ),
    "three indices": (lambda: g.invariant("Y", "phi_abc T^abc"), "expected a tensor"),
    "a constant": (lambda: g.equations(METRIC, "R + c", constants="Box"), "new name"),
}


@pytest.mark.parametrize("case", REFUSED)
def test_refusals(case: str) -> None:
    """Each refusal names the expectation or the remedy."""
    call, words = REFUSED[case]
    with pytest.raises(GeomtorsionError, match=re.escape(words)):
        call()

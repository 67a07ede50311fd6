"""Second derivatives of scalar fields: Lagrangians of galileons and of Horndeski."""

import pytest
import sympy as sp
from sympy.calculus.euler import euler_equations

import geomtorsion as gt
from geomtorsion import gravity as g
from geomtorsion.errors import GravityError
from tests.gravity.samples import sample_connection, sample_frame

t, x, r, c = sp.symbols("t x r c", real=True)
GENERAL = (
    "phi**2*Box(phi) + X*Box - hessian2/3 + X*hessian3 + 2*Y + W*phi + B(phi, X)*Box**2"
)
COUPLED = [g.invariant("Y", "phi_ab phi^a phi^b"), g.invariant("W", "Rbar_ab phi^ab")]
MIXED = [g.invariant("Y", "T_abc phi^ab phi^c"), g.invariant("W", "R_ab phi^ab")]


def sample_field(frame: gt.Frame) -> g.matter.ScalarField:
    """A polynomial scalar field of all coordinates."""
    q = frame.coordinates
    return g.scalar_field(q[0] ** 2 * q[1] + q[-1] ** 2 + q[0] - q[1] * q[-1])


def test_values_in_flat_space() -> None:
    """phi = r^2 has phi_ij = 2 g_ij, in any coordinates and for any connection."""
    frame = gt.spaces.load("euclid_spherical").frame if False else spherical()
    field = g.scalar_field(r**2)
    for connection in (gt.levi_civita(frame), gt.cartan(frame)):
        equations = g.equations(connection, "Box*hessian2*hessian3 + R", field)
        assert [equations.scalar(x)[()] for x in ("Box", "hessian2", "hessian3")] == [6, 12, 24]


def spherical() -> gt.Frame:
    """Flat space in spherical coordinates."""
    theta, phi = sp.symbols("theta phi", real=True)
    return gt.Frame([r, theta, phi], sp.diag(1, r, r * sp.sin(theta)), (1, 1, 1))


@pytest.mark.parametrize("n", [2, 3])
def test_identities_of_the_levi_civita_connection(n: int) -> None:
    """E is symmetric, and its divergence is the equation of the field times phi_i."""
    frame = sample_frame(n, 60 + n)
    equations = g.equations(
        gt.levi_civita(frame), GENERAL, sample_field(frame), invariants=COUPLED
    )
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


@pytest.mark.parametrize("lagrangian", ["X*Box", "hessian2", "phi*X*Box**2", "hessian3"])
def test_equations_are_the_variation_of_the_action(lagrangian: str) -> None:
    """E and the matter equation agree with Euler's equations of e L in coordinates."""
    q, names = (t, x), ("A", "B", "D", "u")
    A, B, D, u = functions = [sp.Function(name)(*q) for name in names]
    rows = sp.Matrix([[A, 0], [B, D]])
    metric = rows.T * sp.diag(-1, 1) * rows
    inverse = metric.inv()

    def symbol(k: int, m: int, n: int) -> sp.Expr:
        return sum(
            inverse[k, s]
            * (metric[s, m].diff(q[n]) + metric[s, n].diff(q[m]) - metric[m, n].diff(q[s]))
            for s in (0, 1)
        ) / 2

    hessian = sp.Matrix(
        2, 2, lambda m, n: u.diff(q[m], q[n]) - sum(symbol(k, m, n) * u.diff(q[k]) for k in (0, 1))
    )
    mixed = inverse * hessian
    slope = sp.Matrix([u.diff(k) for k in q])
    values = {
        "phi": u,
        "X": (slope.T * inverse * slope)[0],
        "Box": mixed.trace(),
        "hessian2": (mixed**2).trace(),
        "hessian3": (mixed**3).trace(),
    }
    density = rows.det() * sp.sympify(lagrangian).subs(values)
    examples = dict(
        zip(functions, (1 + x**2 + t, t * x, 2 + t**2, t**2 + x**3 + t * x), strict=True)
    )
    point = {t: sp.Rational(1, 3), x: sp.Rational(2, 5)}

    def at(expression: sp.Expr) -> sp.Expr:
        return expression.subs(examples).doit().subs(point)

    euler = [at(one.lhs) for one in euler_equations(density, functions, q)]
    frame = gt.Frame(q, rows.subs(examples), (-1, 1))
    equations = g.equations(gt.levi_civita(frame), lagrangian, g.scalar_field(examples[u]))
    legs, volume = at(rows.inv()), at(rows.det())
    E = sp.Matrix(2, 2, lambda i, n: equations.E[i, n].subs(point))
    # dS/d e^i_m = e E_i^n E_n^m.
    varied = volume * E * legs.T
    wanted = [varied[0, 0], varied[1, 0], varied[1, 1]]
    assert [sp.nsimplify(a - b) for a, b in zip(euler, wanted, strict=False)] == [0, 0, 0]
    assert euler[3] == volume * equations.matter_equations["phi"][()].subs(point)


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
    """Energy and current of K(X) + G(X) Box phi (Deffayet, Pujolas, Sawicki, Vikman 2010)."""
    a, phi = sp.Function("a")(t), sp.Function("phi")(t)
    frame = gt.Frame([t, *sp.symbols("x y z")], sp.diag(1, a, a, a), (-1, 1, 1, 1))
    equations = g.equations(gt.levi_civita(frame), "-X/2 + c*X**2*Box(phi)", g.scalar_field(phi))
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
    """Box phi alone, and phi^2 Box phi + 2 phi X."""
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
    wanted = g.equations(metric, "phi*Box", field).E
    symbol = g.names["phi"] * g.names["Box"]
    for lagrangian in ("phi*Box(phi)", "phi*box(u(r))", symbol, u * sp.Function("Box")(u)):
        assert g.equations(metric, lagrangian, field).E == wanted
    assert g.equations(metric, "phi*Y", field, invariants=own).E == wanted
    named = g.equations(metric, "chi*Box(chi)", g.scalar_field("u(r)", name="chi"))
    assert named.E == wanted


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
    with pytest.raises(GravityError) as caught:
        call()
    if case != "a constant":
        assert words in str(caught.value)

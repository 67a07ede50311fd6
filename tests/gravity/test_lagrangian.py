"""Lagrangian: valid texts and expressions, and refusals."""

# Bad input, and a property replaced to watch its calls.
# pyright: reportArgumentType=false, reportAttributeAccessIssue=false, reportOptionalCall=false

import pytest
import sympy as sp

import geomtorsion as gt
from geomtorsion import gravity as g
from geomtorsion.errors import GeomtorsionError, GravityError
from geomtorsion.exact import Element

X, Y, Z = sp.symbols("x y z")
FRAME = gt.Frame([X, Y, Z], [[1, Y * Z, 0], [0, 1, X], [0, 0, 1]], (-1, 1, 1))
OTHER = gt.Frame([X, Y, Z], [[1, Y, 0], [0, 1, 0], [0, 0, 1]])
FLAT = gt.Frame([X, Y], [[1, 0], [0, 1]])
CARTAN, BAR = gt.cartan(FRAME), gt.levi_civita(FRAME)
CURVED = gt.from_spin_connection(FRAME, [[[0, Y, 0], [Y, 0, 0], [0, 0, 0]]] + [[[0] * 3] * 3] * 2)
AFFINE = gt.from_coefficients(FRAME, [[[X] * 3] * 3] * 3)
SPIN = [[[0, 1, 0], [1, 0, 0], [0, 0, 0]]] + [[[0] * 3] * 3] * 2

REFUSED = {
    "unknown invariant": (lambda: g.equations(CARTAN, "T + R9"), "expected the name of an invar"),
    "near name": (lambda: g.equations(CARTAN, "tensor"), "Did you mean tensor2"),
    "case": (lambda: g.equations(CARTAN, "t1"), "Did you mean T1"),
    "four dimensions": (lambda: g.equations(CARTAN, "euler"), "exists in 4 dimensions only"),
    "index": (lambda: g.equations(CARTAN, "f(i)"), "expected invariants as arguments of f"),
    "indexed": (
        lambda: g.equations(CARTAN, sp.IndexedBase("T")[0] ** 2),
        "expected a scalar expression",
    ),
    "brackets": (lambda: g.equations(CARTAN, "T[0]"), "lagrangian"),
    "code": (lambda: g.equations(CARTAN, "__import__('os')"), "lagrangian"),
    "decimal": (lambda: g.equations(CARTAN, "0.5*T"), "decimal"),
    "empty": (lambda: g.equations(CARTAN, ""), "lagrangian"),
    "one connection": (lambda: g.equations(CARTAN, "T*Rbar"), "Give the other connection also"),
    "second connection": (lambda: g.equations(CARTAN, "T*R_2"), "Give the other connection also"),
    "curved": (lambda: g.equations(CURVED, g.tegr), "which is not flat"),
    "of the metric": (
        lambda: g.equations(BAR, g.f_of("T")),
        "not constructed as a flat connection",
    ),
    "not metric": (lambda: g.equations(AFFINE, g.poincare()), "expected a metric connection"),
    "torsion": (lambda: g.equations(CARTAN, g.stegr), "which has torsion"),
    "not Riemannian": (
        lambda: g.equations(CARTAN, g.gauss_bonnet),
        "is not the Levi-Civita connection of the metric",
    ),
    "unlike frames": (
        lambda: g.equations([CARTAN, gt.cartan(OTHER)], "T"),
        "expected connections over one frame",
    ),
    "no connection": (lambda: g.equations([], "T"), "expected a connection"),
    "a frame": (lambda: g.equations(FRAME, "T"), "Give cartan(frame)"),
    "a list of frames": (lambda: g.equations([FRAME], "T"), "connection"),
    "no lagrangian": (lambda: g.equations(CARTAN, None), "expected text such as"),
    "bytes": (lambda: g.equations(CARTAN, b"T"), "expected text such as"),
    "zero below": (g.equations(gt.cartan(FLAT), "1/T").L.element, "got 1/T at T = 0"),
    "geometry": (lambda: g.equations(CARTAN, g.Lagrangian("T", "flat")), "geometry"),
    "tau": (lambda: g.torsion_from_spin(FRAME, SPIN), "expected tau^a_ij antisymmetric"),
    "tau shape": (lambda: g.torsion_from_spin(FRAME, [1, 2]), "expected 3 entries, got 2"),
    "tau tensor": (
        lambda: g.torsion_from_spin(FRAME, gt.cartan(OTHER).torsion.T),
        "over this frame",
    ),
    "plane": (lambda: g.torsion_from_spin(FLAT, [[[0] * 2] * 2] * 2), "three or more dimensions"),
    "matter": (lambda: g.equations(CARTAN, "T", "dust"), "expected gravity.scalar_field"),
    "wrong matter": (lambda: g.equations(CARTAN, "T", [3]), "expected gravity.scalar_field"),
    "velocity": (lambda: g.equations(CARTAN, "T", g.fluid(1, 0, [1, 1, 0])), "expected u_i u^i"),
    "spin along": (
        lambda: g.equations(
            CARTAN, "T", g.weyssenhoff(1, 0, [1, 0, 0], [[0, 1, 0], [-1, 0, 0], [0, 0, 0]])
        ),
        "expected s_ij u^j = 0",
    ),
    "spin": (
        lambda: g.equations(
            CARTAN, "T", g.weyssenhoff(1, 0, [1, 0, 0], [[0, 0, 0], [0, 0, 1], [0, 1, 0]])
        ),
        "expected an antisymmetric matrix",
    ),
    "potential": (lambda: g.equations(CARTAN, "F2", g.maxwell([1])), "expected 3 entries"),
    "levi_civita twice": (
        lambda: g.equations([BAR, BAR], "R"),
        "expected the Levi-Civita connection once",
    ),
    "second connection of another dimension": (
        lambda: g.equations([CARTAN, CURVED], "euler_2"),
        "exists in 4 dimensions only",
    ),
    "only F2": (
        lambda: g.equations(CARTAN, "T + F2").L,
        "F2 belongs to a matter field, and none is given. Give matter=",
    ),
    "fluid": (
        lambda: g.equations(CARTAN, "T", g.fluid(1, 0, [1, 0, 0])).identities(),
        "Omit the fluid",
    ),
    "function": (lambda: g.f_of("T", 3), "expected the name of a function"),
    "value": (lambda: g.f_of("T", lambda T: "T"), "expected a sympy expression"),
    "name": (lambda: g.f_of("U"), "f_of"),
    "factor": (lambda: g.new_gr("a b", 1, 1), "expected a number"),
    "scalar": (lambda: g.equations(CARTAN, "T").scalar("euler"), "invariant"),
}


@pytest.mark.parametrize("case", REFUSED)
def test_bad_calls_are_refused(case: str) -> None:
    """Each refusal is an error of this package and names the expectation or the remedy."""
    call, words = REFUSED[case]
    with pytest.raises(GeomtorsionError) as refused:
        call()
    assert words in str(refused.value)


def test_a_name_with_two_meanings() -> None:
    """A charge Q of the frame is not the nonmetricity scalar; sympy symbols distinguish them."""
    charge = sp.Symbol("Q", positive=True)
    frame = gt.Frame([X, Y], [[1, 0], [0, 1 + charge * X]])
    assert g.equations(gt.cartan(frame), "T").L.is_zero
    with pytest.raises(GravityError, match="Q is an invariant and a symbol of the frame"):
        g.equations(gt.cartan(frame), "T + Q")
    assert g.equations(gt.cartan(frame), g.names["T1"] * charge).scalars.keys() == {"T1"}


def test_parameters_and_functions_are_new_names() -> None:
    """Unknown names become parameters, unknown functions stay unknown, pi is a number."""
    found = g.equations(CARTAN, "pi*T + c*T^2 + f(T) + sqrt(1 + T1)")
    assert all(check.holds for check in found.identities())
    assert sp.Symbol("c") in found.L[()].free_symbols
    assert sp.Function("f") in {
        one.func for one in found.L[()].atoms(sp.core.function.AppliedUndef)
    }


def test_a_function_of_the_frame_is_called() -> None:
    """In a Lagrangian a is a parameter, and a(t) is the function of the frame."""
    t = sp.Symbol("t")
    a = sp.Function("a")(t)
    frame = gt.Frame([t, X], sp.diag(1, a), (-1, 1))
    found = g.equations(gt.cartan(frame), "a*T1")
    value = found.scalar("T1")[()]
    assert (found.L - sp.Symbol("a") * value).is_zero
    found = g.equations(gt.cartan(frame), "f(a(t), T1)")
    assert (found.L - sp.Function("f")(a, value)).is_zero
    # A density is not a Lagrangian: there a is the function of the frame.
    dust = g.equations(gt.cartan(frame), "T1", g.fluid("rho/a", 0, [1, 0])).E[0, 0]
    plain = g.equations(gt.cartan(frame), "T1").E[0, 0]
    assert sp.simplify(plain - dust - sp.Symbol("rho") / a) == 0
    pair = [gt.cartan(frame), gt.levi_civita(frame)]
    assert all(check.holds for check in g.equations(pair, "T1 + a*T1*Rbar").identities())


def test_names_are_the_invariants() -> None:
    """A sympy expression in names gives the same Lagrangian as its text."""
    n = g.names
    text, given = "R1*T + T2**2/3", n["R1"] * n["T"] + n["T2"] ** 2 / 3
    assert g.equations(CURVED, given).L[()] == g.equations(CURVED, text).L
    assert not g.equations(CURVED, text).L.is_zero


def test_a_long_scalar_is_not_written_out() -> None:
    """Polynomials of invariants are not converted to text or to sympy."""
    kerr = gt.levi_civita(gt.spaces.load("kerr").frame)
    found = g.equations(kerr, "R1 + c*R1**2")
    written = []
    original = Element.sympy
    try:
        Element.sympy = property(lambda self: written.append(self) or original.fget(self))
        assert found.E.components.get((0, 0)).is_zero is False
    finally:
        Element.sympy = original
    assert not written


def test_a_scale_with_the_number_zero_is_a_parameter() -> None:
    """R0, T0 and R_0 are not invariants, because those are numbered from one."""
    found = g.equations(CARTAN, "T + T**2/T0 + R0*R_0*T1")
    assert {"T0", "R0", "R_0"} <= {symbol.name for symbol in found.L[()].free_symbols}

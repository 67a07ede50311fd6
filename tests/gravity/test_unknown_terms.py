"""Unknown terms: equations with an unknown f as sums, compared with equations of a known f."""

import pytest
import sympy as sp
from sympy.core.function import AppliedUndef

import geomtorsion as gt
from geomtorsion import gravity as g
from geomtorsion.errors import GeomtorsionError


def shipped(name: str) -> gt.Frame:
    """The frame of a shipped space."""
    return gt.spaces.load(name).frame


COSMOS, HOLE = shipped("frw_flat"), shipped("schwarzschild")
PAIR = [gt.cartan(COSMOS), gt.levi_civita(COSMOS)]
GRADIENT = g.invariant("Y", "Rbar^ab phi_a phi_b")
# Connections, Lagrangian with f, the same with a certain f, that f, matter, own invariants.
KNOWN = {
    "f(T)": (gt.cartan(COSMOS), "f(T)", "T + T**3", lambda x: x + x**3, (), ()),
    "polar": (gt.cartan(HOLE), "T + c*f(T)", "T + c*T**2", lambda x: x**2, (), ()),
    "f(R)": (gt.levi_civita(COSMOS), "f(R)", "R**3 - R", lambda x: x**3 - x, (), ()),
    "static": (gt.levi_civita(HOLE), "f(R1)", "R1**2", lambda x: x**2, (), ()),
    "two": (gt.levi_civita(COSMOS), "f(R, GB)", "R**2*GB", lambda x, y: x**2 * y, (), ()),
    "pair": (PAIR, "f(T, Rbar)/2", "T*Rbar**2/2", lambda x, y: x * y**2, (), ()),
    "sum": (PAIR, "f(2*T + Rbar)", "(2*T + Rbar)**3", lambda x: x**3, (), ()),
    "square": (gt.cartan(COSMOS), "T*f(T)**2", "T**5", lambda x: x**2, (), ()),
    "time": (gt.cartan(COSMOS), "f(a(t), T)", "a(t)*T**2", lambda x, y: x * y**2, (), ()),
    "field": (
        PAIR, "R*f(phi)*Y - f(X)".replace("R*", "Rbar*"), "Rbar*phi**2*Y - X**2",
        lambda x: x**2, g.scalar_field("u(t)"), GRADIENT,
    ),
    "galileon": (
        gt.levi_civita(COSMOS), "f(X)*Box(phi)", "X**3*Box", lambda x: x**3,
        g.scalar_field("u(t)"), (),
    ),
    "fluid": (
        gt.cartan(COSMOS), "f(T)", "T**2", lambda x: x**2, g.fluid("rho(t)", 0, [1, 0, 0, 0]), (),
    ),
}  # fmt: skip


@pytest.mark.parametrize("name", KNOWN)
def test_terms_add_up_to_the_equation(name: str) -> None:
    """With a certain f, the sum of functions times tensors is E of the Lagrangian with this f."""
    connections, unknown, certain, function, matter, own = KNOWN[name]
    equations = g.equations(connections, unknown, matter, invariants=own)
    other = g.equations(connections, certain, matter, invariants=own)
    frame = equations.frame
    assert len(equations.terms) > 1
    values = {x: equations.scalar(x)[()] for x in equations.scalars}
    derived = {sp.Function(x): value for x, value in values.items()}

    def inserted(expression: sp.Expr) -> sp.Expr:
        def known(one: sp.Expr) -> sp.Expr:
            return function(*one.args) if one.func == sp.Function("f") else one

        calls = expression.atoms(AppliedUndef, sp.Derivative, sp.Subs)
        made = {one: one.replace(lambda x: isinstance(x, AppliedUndef), known) for one in calls}
        expression = expression.xreplace(made).doit()
        rates = {
            one: derived[one.func] for one in expression.atoms(AppliedUndef) if one.func in derived
        }
        expression = expression.subs(rates).doit()
        return expression.subs({sp.Symbol(x): value for x, value in values.items()}).doit()

    n = frame.dimension
    for i, k in ((0, 0), (1, 1), (n - 1, n - 1), (0, 1), (1, 2)):
        total = frame.scalar(inserted(equations.readable("E", i, k)))
        assert total == frame.scalar(other.E[i, k]), (i, k)
    assert not other.E.is_zero


def test_equations_of_a_cosmos() -> None:
    """f - 12 H^2 f', and f''(T) times T' beside the terms of f': as in papers on f(T)."""
    equations = g.equations(gt.cartan(COSMOS), "f(T)")
    t, f, T = COSMOS.coordinates[0], sp.Function("f"), sp.Symbol("T")
    a = COSMOS.coframe[1, 1]
    H = sp.diff(a, t) / a
    assert set(equations.terms) == {
        f(T), f(T).diff(T), f(T).diff(T, 2) * sp.Function("T")(t).diff(t)
    }  # fmt: skip
    assert equations.readable("E", 0, 0) == f(T) - 12 * H**2 * f(T).diff(T)
    assert equations.terms[f(T).diff(T, 2) * sp.Function("T")(t).diff(t)][1, 1] == -4 * H


def test_equations_of_a_black_hole_are_short() -> None:
    """f(T) on Kerr: a tenth of the letters that it has with the value of T inserted."""
    equations = g.equations(gt.cartan(shipped("kerr")), "f(T)")
    short = sum(len(str(equations.readable("E", *i))) for i in equations.E.components.independent)
    long = sum(len(str(x)) for x in equations.E.nonzero().values())
    assert short < 2000
    assert long > 5 * short


def test_values_are_compared_exactly() -> None:
    """T with roots is recognized in f(T), however it is written."""
    equations = g.equations(gt.cartan(shipped("schwarzschild_cartesian")), "f(T)")
    for element in equations.E.components.independent.values():
        text = str(equations.written(element))
        assert "Subs" not in text
        assert "f(T)" in text or "Derivative(f(T), (T, 2))" in text


def test_without_unknown_functions() -> None:
    """A Lagrangian without f has one term, E itself, and other tensors are written as they are."""
    equations = g.equations(gt.levi_civita(HOLE), "R + c*R1")
    assert equations.terms == {1: equations.E}
    connection = gt.from_torsion(COSMOS, g.invariant_torsion(COSMOS))
    free = g.equations(connection, "R + f(T1)")
    assert free.readable("C", 0, 1, 1) == free.written(free.C.element(0, 1, 1))
    with pytest.raises(GeomtorsionError, match="name: expected one of E"):
        free.readable("W", 0, 0)


DISTINCT = [
    (
        gt.levi_civita(shipped("frw")), "R", (),
        {"E_1^1": "k + D(a,t)**2", "E_2^2": "k + 2*a*D(a,t,t) + D(a,t)**2"},
    ),
    (gt.cartan(COSMOS), "f(T)", (), {"E_1^1": "a**2*F - 12*D(a,t)**2*F1"}),
    (
        gt.levi_civita(COSMOS), "R/2 - X/2", g.scalar_field("u(t)"),
        {"phi": "a*D(u,t,t) + 3*D(a,t)*D(u,t)"},
    ),
    (gt.levi_civita(HOLE), "R + Lambda", (), {"E_1^1": "Lambda"}),
    (gt.levi_civita(HOLE), "R", (), {}),
]  # fmt: skip


@pytest.mark.parametrize(("connection", "lagrangian", "matter", "lines"), DISTINCT)
def test_equations_that_differ_are_written_once(
    connection: gt.Connection, lagrangian: str, matter: object, lines: dict
) -> None:
    """Numerators without common factors; E_2^2 = E_3^3 = E_4^4 is one of at most three."""
    t, T = sp.symbols("t T")
    a, u = (sp.Function(name)(t) for name in "au")
    f = sp.Function("f")(T)
    names = {"a": a, "u": u, "t": t, "D": sp.diff, "F": f, "F1": f.diff(T)}
    equations = g.equations(connection, lagrangian, matter)  # type: ignore[arg-type]
    assert len(equations.distinct) <= 3
    for label, line in lines.items():
        expected = sp.sympify(line, names | {"k": sp.Symbol("k"), "Lambda": sp.Symbol("Lambda")})
        value = equations.distinct[label]
        same = {str(x): x for x in value.free_symbols}
        assert sp.expand(value.xreplace({x: sp.Symbol(n) for n, x in same.items()}) - expected) == 0
    assert lines or not equations.distinct

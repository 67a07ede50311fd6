"""From field equations to numbers, compared with closed forms and with independent integrations."""

import math
from collections.abc import Callable, Sequence
from typing import Any

import numpy as np
import pytest
import sympy as sp
from scipy.integrate import quad, solve_ivp
from scipy.optimize import brentq

import geomtorsion as gt
from geomtorsion import gravity as g
from geomtorsion.errors import GeomtorsionError, GravityError, StartError
from geomtorsion.gravity.theory.fluids import Fluid

T, R, X, Y, Z, THETA, PHI = sp.symbols("t r x y z theta phi")
LORENTZ = (-1, 1, 1, 1)
AT_REST = [1, 0, 0, 0]
a, N = (sp.Function(name)(T) for name in "aN")
A, B, C = (sp.Function(name)(R) for name in "ABC")
COSMOS = gt.Frame([T, X, Y, Z], sp.diag(1, a, a, a), LORENTZ)
LAPSE = gt.Frame([T, X, Y, Z], sp.diag(N, a, a, a), LORENTZ)
STATIC = gt.Frame([T, R, THETA, PHI], sp.diag(A, B, R, R * sp.sin(THETA)), LORENTZ)
COINCIDENT = gt.from_coefficients(COSMOS, [[[0] * 4] * 4] * 4)
DUST = g.fluid("rho(t)", 0, AT_REST)
# Results are held to ten times the accuracy that is requested by default.
CLOSE = 1e-9


def universe(
    connection: gt.Connection,
    lagrangian: g.Lagrangian | str,
    matter: Sequence | Fluid = (),
    conditions: Sequence[str] = (),
) -> g.Reduction:
    """A theory on flat FLRW, reduced."""
    return g.equations(connection, lagrangian, matter).reduce("t", conditions)


def check(solution: gt.ode.Solution, name: str, exact: float) -> None:
    """The last value of a state is the exact one, and constraints drift no more than it errs."""
    assert solution.error <= solution.accuracy
    assert float(solution[name][-1]) == pytest.approx(exact, rel=CLOSE)
    for drift in solution.drift.values():
        assert drift <= solution.error


@pytest.mark.parametrize(
    ("connection", "lagrangian"),
    [
        (gt.levi_civita(COSMOS), "R/2 - Lambda"),
        (gt.cartan(COSMOS), "-T/2 - Lambda"),
        (COINCIDENT, "-Q/2 - Lambda"),
    ],
)
def test_a_universe_of_dust_and_a_cosmological_constant(
    connection: gt.Connection, lagrangian: str
) -> None:
    """a = (m/l)^(1/3) sinh^(2/3)(3 sqrt(l) t/2) with shares m, l, in three geometries."""
    matter, dark = 0.3, 0.7
    age = 2 / 3 / math.sqrt(dark) * math.asinh(math.sqrt(dark / matter))
    equations = g.equations(connection, lagrangian, DUST)
    start, parameters = {"a": 1, "rho": "9/10"}, {"Lambda": "21/10"}
    solution = g.solve(equations, "t", 2, start, parameters, near={"a_1": 1})
    exact = (matter / dark) ** (1 / 3) * math.sinh(1.5 * math.sqrt(dark) * (2 + age)) ** (2 / 3)
    check(solution, "a", exact)


@pytest.mark.parametrize(
    ("connection", "lagrangian"),
    [(gt.cartan(COSMOS), "-(T + c*T**2)/2"), (COINCIDENT, "-(Q + c*Q**2)/2")],
)
def test_dust_in_quadratic_teleparallel_theories(
    connection: gt.Connection, lagrangian: str
) -> None:
    """rho = 3 H^2 + 54 c H^4 for T = 6 H^2 and for Q = 6 H^2: t is an integral over a."""
    c = 0.01

    def rate(size: float) -> float:
        density = 3.54 / size**3
        return math.sqrt((-3 + math.sqrt(9 + 4 * 54 * c * density)) / (2 * 54 * c))

    reduced = universe(connection, lagrangian, DUST)
    ode = reduced.ode({"a": 1, "rho": "3.54"}, {"c": "1/100"}, near={"a_1": 1})
    solution = gt.solve(ode, 3.0)
    size = float(solution["a"][-1])
    age, _ = quad(lambda x: 1 / (x * rate(x)), 1, size, epsabs=1e-12, epsrel=1e-12)
    assert age == pytest.approx(3.0, rel=CLOSE)
    assert max(solution.drift.values()) <= solution.error


@pytest.mark.parametrize(
    ("function", "values"),
    [
        ("T + c*exp(T/b)", {"c": "-1/10", "b": 20}),
        ("T + c*T*log(T)", {"c": "1/10"}),
        ("T + c*T**n", {"c": "1/10", "n": "3/2"}),
    ],
)
def test_dust_in_other_functions_of_torsion(function: str, values: dict) -> None:
    """rho = T f'(T) - f(T)/2 for T = 6 H^2: t is an integral over a, by scipy."""
    T = sp.Symbol("T", positive=True)
    f = sp.sympify(function, {"T": T}).subs({name: sp.Rational(x) for name, x in values.items()})
    density = sp.lambdify(T, T * f.diff(T) - f / 2)
    first = density(6.0)

    def rate(size: float) -> float:
        return math.sqrt(brentq(lambda x: density(x) - first / size**3, 1e-3, 6.1, xtol=1e-15) / 6)

    connection = gt.cartan(gt.Frame([*"txyz"], sp.diag(1, *["a(t)"] * 3), LORENTZ))
    equations = g.equations(connection, f"-({function})/2", DUST, constants=" ".join(values))
    solution = g.solve(equations, "t", 1, {"a": 1, "rho": first}, values, near={"a_1": 1})
    size = float(solution["a"][-1])
    age, _ = quad(lambda x: 1 / (x * rate(x)), 1, size, epsabs=1e-12, epsrel=1e-12)
    assert age == pytest.approx(1.0, rel=CLOSE)


def test_one_frame_serves_several_theories() -> None:
    """A new constant does not disturb logarithms that the frame has from another theory."""
    one = universe(gt.cartan(COSMOS), "-(T + c*T*log(T))/2", DUST)
    assert one.states == ("rho", "a", "a_1")
    powers = g.equations(gt.levi_civita(COSMOS), "R**nu", constants="nu").reduce("t")
    assert powers.states == ("a", "a_1", "a_2")


def test_a_condition_names_an_invariant() -> None:
    """S(t) = R is the scalar curvature of the Lagrangian, whatever its value is."""
    connection = gt.levi_civita(COSMOS)
    value = 6 * (a * a.diff(T, 2) + a.diff(T) ** 2) / a**2
    one, two = (
        str(g.equations(connection, "R + c*R**2", DUST).reduce("t", [condition]))
        for condition in ("S(t) = R", sp.Eq(sp.Function("S")(T), value))
    )
    assert one == two
    assert "S' = S_1" in one


def test_starobinsky_inflation_of_fourth_order() -> None:
    """R + R^2/(6 M^2) against 3 H^2 F = (R F - f)/2 - 3 H F', integrated by scipy in H and R."""
    mass = 0.5

    def rates(_: float, y: np.ndarray) -> list[float]:
        _, rate, scalar = y
        f, slope, second = scalar + scalar**2 / (6 * mass**2), 1 + scalar / (3 * mass**2), 1 / 3
        change = ((scalar * slope - f) / 2 - 3 * rate**2 * slope) * mass**2
        return [y[0] * rate, scalar / 6 - 2 * rate**2, change / (3 * second * rate)]

    reduced = universe(gt.levi_civita(COSMOS), "(R + R**2/(6*M**2))/2")
    assert reduced.states == ("a", "a_1", "a_2", "a_3")
    start = {"a": 1, "a_1": 1, "a_2": "0.98"}
    ode = reduced.ode(start, {"M": "1/2"})
    solution = gt.solve(ode, 3.0)
    first = [1.0, 1.0, 6 * (0.98 + 1)]
    options = {"method": "DOP853", "rtol": 1e-12, "atol": 1e-12}
    check(solution, "a", solve_ivp(rates, (0, 3), first, **options).y[0, -1])


def test_power_law_inflation_of_a_scalar_field() -> None:
    """V = p (3 p - 1) exp(-phi sqrt(2/p)) has a = t^p, phi = sqrt(2 p) log t."""
    matter = g.scalar_field("phi(t)")
    power = 3
    equations = g.equations(
        gt.levi_civita(COSMOS), "R/2 - X/2 - V0*exp(-k*phi)", matter, constants="k V0"
    )
    start = {"a": 1, "phi": 0, "phi_1": sp.sqrt(6)}
    parameters = {"V0": 24, "k": sp.sqrt(sp.Rational(2, 3))}
    near = {"a_1": 3}
    solution = g.solve(equations, "t", 4, start, parameters, near=near, origin=1)
    check(solution, "a", 4**power)
    assert float(solution["phi"][-1]) == pytest.approx(math.sqrt(6) * math.log(4), rel=CLOSE)
    assert float(solution["t"][-1]) == 4


def test_dust_with_spin_bounces() -> None:
    """a^3 = kappa s0^2/(4 rho0) + 3 kappa rho0 t^2/4: torsion is unknown, and is eliminated."""
    tau = COSMOS.scalar(sp.Function("tau")(T))
    torsion = gt.Tensor(COSMOS, "DDU", {(1, 2, 0): tau.element(), (2, 1, 0): -tau.element()})
    spin = [[0] * 4, [0, 0, "sigma(t)", 0], [0, "-sigma(t)", 0, 0], [0] * 4]
    dust = g.weyssenhoff("rho(t)", 0, AT_REST, spin)
    reduced = universe(gt.from_torsion(COSMOS, torsion), g.einstein_cartan, dust)
    assert str(reduced.outputs["tau"]) == "kappa*sigma/2"
    third = sp.Rational(1, 4) ** sp.Rational(1, 3)
    start = {"a": third, "a_1": 0, "rho": 4, "sigma": 4}
    solution = gt.solve(reduced.ode(start, {"kappa": 1}), 2.0)
    check(solution, "a", (1 / 4 + 3) ** (1 / 3))
    assert float(solution["tau"][0]) == 2


def test_torsion_vanishes_without_spin() -> None:
    """The two torsion functions of a universe are zero in Einstein-Cartan theory with dust."""
    u, v = (COSMOS.scalar(sp.Function(name)(T)).element() for name in "uv")
    parts = {}
    for i, j, k in ((1, 2, 3), (2, 3, 1), (3, 1, 2)):
        parts |= {(0, i, i): u, (i, 0, i): -u, (i, j, k): v, (j, i, k): -v}
    connection = gt.from_torsion(COSMOS, gt.Tensor(COSMOS, "DDU", parts))
    assert universe(connection, "R/2", DUST).outputs == {"u": 0, "v": 0}


def test_a_proof_of_a_universe() -> None:
    """The end of a universe of dust is proved to twelve digits: a = (1 + 3 t/2)^(2/3)."""
    reduced = universe(gt.cartan(COSMOS), "-T/(2*kappa)", DUST)
    ode = reduced.ode({"a": 1, "rho": 3}, {"kappa": 1}, near={"a_1": 1})
    solution = gt.solve(ode, 10.0, 1e-13)
    check(solution, "a", 16 ** (2 / 3))
    assert gt.prove(solution, 12).holds


def test_radiation_by_an_equation_of_state() -> None:
    """p = rho/3 has a = sqrt(1 + 2 t); the pressure is an output."""
    gas = g.fluid("rho(t)", "p(t)", AT_REST)
    reduced = universe(gt.levi_civita(LAPSE), "R/2", gas, conditions=["p = rho/3", "N = 1"])
    solution = gt.solve(reduced.ode({"a": 1, "rho": 3}, near={"a_1": 1}), 4.0)
    check(solution, "a", 3)
    assert solution["p"][-1] == pytest.approx(float(solution["rho"][-1]) / 3)


@pytest.mark.parametrize(
    ("connection", "lagrangian"),
    [(gt.levi_civita(STATIC), "R - 2*Lambda"), (gt.cartan(STATIC), "T + 2*Lambda")],
)
def test_schwarzschild_and_de_sitter_follow_from_the_ansatz(
    connection: gt.Connection, lagrangian: str
) -> None:
    """A^2 = 1/B^2 = 1 - 2 M/r - Lambda r^2/3, from r = 3 to r = 5."""
    square = lambda r: 1 - 2 / sp.S(r) - sp.Rational(3, 100) * r**2 / 3  # noqa: E731
    start = {"A": sp.sqrt(square(3)), "B": 1 / sp.sqrt(square(3))}
    reduced = g.equations(connection, lagrangian).reduce("r")
    solution = gt.solve(reduced.ode(start, {"Lambda": "3/100"}, origin=3), 2.0)
    check(solution, "A", math.sqrt(square(5)))
    check(solution, "B", 1 / math.sqrt(square(5)))


def test_a_charge_has_its_field() -> None:
    """Reissner and Nordstrom: u' = q/r^2, A^2 = 1 - 2 M/r + q^2/(2 r^2) for R/2 - F^2/4."""
    fields = g.equations(gt.levi_civita(STATIC), "R/2 - F2/4", g.maxwell(["u(r)", 0, 0, 0]))
    square = lambda r: 1 - 2 / sp.S(r) + sp.Rational(1, 2) / sp.S(r) ** 2  # noqa: E731
    start = {"A": sp.sqrt(square(3)), "B": 1 / sp.sqrt(square(3)), "u": 0, "u_1": "1/9"}
    solution = g.solve(fields, "r", 6, start, origin=3)
    check(solution, "A", math.sqrt(square(6)))
    check(solution, "u", 1 / 3 - 1 / 6)


def test_a_constraint_completes_the_start() -> None:
    """The expansion rate follows from size and density; so does the density from the rate."""
    reduced = universe(gt.levi_civita(COSMOS), "R/2", DUST)
    assert reduced.complete({"a": 1, "rho": 3}, near={"a_1": 1})["a_1"] == 1
    assert reduced.complete({"a": 1, "rho": 3}, near={"a_1": -2})["a_1"] == -1
    assert reduced.complete({"a": 2, "a_1": 1})["rho"] == sp.Rational(3, 4)
    assert reduced.complete({"a": 1, "rho": 1}, near={"a_1": 1})["a_1"] == 1 / sp.sqrt(3)


def test_different_coordinates_on_which_nothing_depends_drop_out() -> None:
    """Friedmann's equations of a curved space in spherical coordinates do not contain r."""
    k = sp.Symbol("k")
    size = a / sp.sqrt(1 - k * R**2)
    frame = gt.Frame([T, R, THETA, PHI], sp.diag(1, size, a * R, a * R * sp.sin(THETA)), LORENTZ)
    reduced = universe(gt.levi_civita(frame), "R/2", DUST)
    assert reduced.parameters == ("k",)
    # A closed universe: a = sin^2 and t = eta - sin cos of eta/2, up to its largest size 1.
    ode = reduced.ode({"a": "1/2", "rho": 24}, {"k": 1}, near={"a_1": 1})
    assert ode.start[ode.states.index("a_1")] == 1


def test_two_fluids_are_conserved_separately() -> None:
    """Dust and radiation: rho a^3 and s a^4 are constant."""
    radiation = g.fluid("s(t)", "s(t)/3", AT_REST)
    reduced = universe(gt.levi_civita(COSMOS), "R/2", [DUST, radiation])
    ode = reduced.ode(
        {"a": 1, "rho": 1, "s": 2},
        near={"a_1": 1},
        outputs={"dust": "rho*a**3", "light": "s*a**4"},
    )
    solution = gt.solve(ode, 2.0)
    assert solution["dust"][-1] == pytest.approx(1, rel=CLOSE)
    assert solution["light"][-1] == pytest.approx(2, rel=CLOSE)


def test_a_constant_that_drops_out_may_have_a_value() -> None:
    """sqrt(T) changes no universe, because its part of L is a total derivative."""
    reduced = universe(gt.cartan(COSMOS), "-T/2 + c*sqrt(T)", DUST)
    assert reduced.parameters == ()
    assert reduced.complete({"a": 1, "rho": 3}, {"c": 1}, near={"a_1": 1})["a_1"] == 1


def test_a_reduction_is_written_as_equations() -> None:
    """Text, names and the short form."""
    reduced = universe(gt.levi_civita(COSMOS), "R/2", DUST)
    assert reduced.states == ("rho", "a", "a_1")
    assert "0 = a**2*rho - 3*a_1**2" in str(reduced)
    assert repr(reduced) == "reduction to rho, a, a_1 as functions of t, 1 constraint"
    assert r"\frac{d}{d t} a &= a_{1} \\" in reduced.latex
    assert r"0 &= a^{2} \rho - 3 a_{1}^{2}" in reduced._repr_latex_()


EINSTEIN = g.equations(gt.levi_civita(COSMOS), "R/2", DUST)
FLUID = g.fluid("rho(t)", "p(t)", AT_REST)
RADIAL = gt.Frame([T, R, THETA, PHI], sp.diag(A, B, C, C * sp.sin(THETA)), LORENTZ)
WAVE = gt.Frame([T, X, Y, Z], sp.diag(1, sp.Function("b")(T, X), 1, 1), LORENTZ)
BALL = gt.Frame([T, R, THETA, PHI], sp.diag(1, a, a * R, a * R * sp.sin(THETA)), LORENTZ)
REDUCTION = EINSTEIN.reduce("t")


def with_torsion() -> gt.Connection:
    """A metric connection with the trace of torsion."""
    u = COSMOS.scalar(sp.Function("u")(T)).element()
    entries = {(0, i, i): u for i in (1, 2, 3)} | {(i, 0, i): -u for i in (1, 2, 3)}
    return gt.from_torsion(COSMOS, gt.Tensor(COSMOS, "DDU", entries))


def circle() -> g.Reduction:
    """A theory with R^2 and torsion, with two conditions on its curvature."""
    equations = g.equations(with_torsion(), "(R + c*R**2)/2", DUST)
    return equations.reduce("t", ["S(t) = R", "S(t) = rho"])


# The size of a universe of dust in other units: an output with a constant that no rate has.
SCALED = EINSTEIN.reduce("t", ["S(t) = k*a"])
REFUSALS: dict[str, tuple[Callable[[], object], type[GeomtorsionError], str]] = {
    "a circle": (circle, GravityError, "refer to each other in a circle"),
    "free lapse": (
        lambda: g.equations(gt.levi_civita(LAPSE), "R/2", DUST).reduce("t"),
        GravityError,
        "the lapse is free",
    ),
    "free radius": (
        lambda: g.equations(gt.levi_civita(RADIAL), "R").reduce("r"),
        GravityError,
        "radial gauge is free",
    ),
    "no equation of state": (
        lambda: g.equations(gt.levi_civita(COSMOS), "R/2", FLUID).reduce("t"),
        GravityError,
        "no equation of state",
    ),
    "a static universe of constant density": (
        lambda: g.equations(gt.levi_civita(COSMOS), "R/2", g.fluid(1, 0, AT_REST)).reduce("t"),
        GravityError,
        "expected equations that have a solution",
    ),
    "a wrong tetrad": (
        lambda: g.equations(gt.cartan(BALL), "T + T**2", DUST).reduce("t"),
        GravityError,
        "Check the matter, the conditions and the ansatz",
    ),
    "two variables": (
        lambda: g.equations(gt.levi_civita(WAVE), "R").reduce("t"),
        GravityError,
        "expected functions of t",
    ),
    "no function": (
        lambda: g.equations(gt.cartan("schwarzschild"), "T").reduce("r"),
        GravityError,
        "expected an unknown function of r",
    ),
    "unknown f": (
        lambda: g.equations(gt.cartan(COSMOS), "f(T)").reduce("t"),
        GravityError,
        "Choose this function",
    ),
    "wrong variable": (lambda: EINSTEIN.reduce("tau"), GravityError, "There are t"),
    "condition without equality": (
        lambda: EINSTEIN.reduce("t", ["rho"]),
        GravityError,
        "one sign of equality",
    ),
    "contradictory condition": (
        lambda: EINSTEIN.reduce("t", ["rho = 1"]),
        GravityError,
        "expected equations that have a solution",
    ),
    "a branch that is undecided": (
        lambda: universe(isotropic(bar=True), "(R + c*R**2)/2", DUST, ["rho = 1"]),
        GravityError,
        "The case is undecided where v - w ",
    ),
    "nothing to solve": (
        lambda: EINSTEIN.reduce("t", ["rho = 0", "a = 1"]),
        GravityError,
        "nothing to solve",
    ),
    "two roots": (
        lambda: REDUCTION.complete({"a": 1, "rho": 3}),
        StartError,
        "a_1 = -1 or 1",
    ),
    "no root": (
        lambda: REDUCTION.complete({"a": 1, "rho": -3}),
        StartError,
        "there is none",
    ),
    "too few": (lambda: REDUCTION.complete({"a": 1}), StartError, "got none for rho, a_1"),
    "violated": (
        lambda: REDUCTION.complete({"a": 1, "rho": 3, "a_1": 2}),
        StartError,
        "Omit one of the values",
    ),
    "singular": (
        lambda: REDUCTION.complete({"a": 0, "rho": 3, "a_1": 0}),
        StartError,
        "leading coefficient",
    ),
    "unknown state": (lambda: REDUCTION.complete({"b": 1}), StartError, "b"),
    "not a number": (lambda: REDUCTION.complete({"a": "one"}), GeomtorsionError, "one"),
    "missing parameter": (
        lambda: g.equations(gt.cartan(COSMOS), "T/kappa", DUST).reduce("t").ode({"a": 1}),
        StartError,
        "kappa",
    ),
    "missing parameter of an output": (
        lambda: SCALED.ode({"a": 1, "rho": 3}, near={"a_1": 1}),
        StartError,
        "got none for k",
    ),
    "missing parameter of an output between two places": (
        lambda: g.shoot(
            SCALED, "t", 1, {"a": 1, "rho": 3}, near={"a_1": 1}, free=["rho"], boundary={"a": 2}
        ),
        StartError,
        "got none for k",
    ),
}


def test_an_output_has_a_constant_of_its_own() -> None:
    """S = k a: at t = 2/3 dust with a = (1 + 3 t/2)^(2/3) has S = k 2^(2/3)."""
    ode = SCALED.ode({"a": 1, "rho": 3}, {"k": "3/2"}, near={"a_1": 1})
    solution = gt.solve(ode, 2 / 3)
    assert float(solution["S"][-1]) == pytest.approx(1.5 * 2 ** (2 / 3), rel=CLOSE)


@pytest.mark.parametrize("name", REFUSALS)
def test_refusals(name: str) -> None:
    """Each case raises an error of its kind with these words."""
    call, error, words = REFUSALS[name]
    with pytest.raises(error) as refusal:
        call()
    assert words in str(refusal.value)


def test_sympy_solves_equations_with_a_closed_form() -> None:
    """B^-2 = 1 + C/r - Lambda r^2/3; the flat universe with Lambda grows as an exponential."""
    reduced = g.equations(gt.levi_civita(STATIC), "R - 2*Lambda").reduce("r")
    equation = reduced.differential_equations["B"]
    Lambda, mass = sp.symbols("Lambda C1")
    solutions = [one.rhs for one in sp.dsolve(equation, B)]
    assert len(solutions) == 2
    for one in solutions:
        assert sp.checkodesol(equation, sp.Eq(B, one))[0]
        expected = 1 - Lambda * R**2 / 3 + mass / (3 * R)
        assert sp.simplify(one**-2 - expected) == 0
    second = universe(gt.levi_civita(COSMOS), "R - 2*Lambda").differential_equations["a"]
    growth = sp.exp(sp.sqrt(Lambda / 3) * T)
    assert sp.simplify((second.lhs - second.rhs).subs(a, growth).doit()) == 0


def isotropic(bar: bool) -> gt.Connection:
    """The symmetric connection of a flat universe; bar: as a sum with the Levi-Civita one."""
    u, v, w = (sp.Function(name)(T) for name in "uvw")
    rate, size = (a.diff(T) / a, a**2) if bar else (sp.S.Zero, sp.S.One)
    entries = [[[sp.S.Zero] * 4 for _ in range(4)] for _ in range(4)]
    entries[0][0][0] = u
    for i in (1, 2, 3):
        entries[0][i][i] = entries[i][0][i] = v + rate
        entries[i][i][0] = size * w + a**2 * rate
    return gt.from_coefficients(COSMOS, entries)


@pytest.mark.parametrize(
    ("connection", "conditions", "name", "factor"),
    [
        (isotropic(bar=True), [], "w", 1),
        (g.invariant_connection(COSMOS), ["u2 = 0"], "u4", 1),
        # Torsion: a symmetric connection but for a multiple of the identity, which is free.
        (with_torsion(), [], "u", -sp.Rational(1, 2)),
    ],
)
def test_the_other_factor_of_a_product_is_tried(
    connection: gt.Connection, conditions: Sequence[str], name: str, factor: sp.Rational
) -> None:
    """Palatini R + c R^2 with dust: R = rho, and the connection belongs to f'(R) times the metric.

    The connection equation is a product with f'(R), which vanishes in no universe of dust.
    6 (1 - c rho)^2 H^2 = (2 rho + c rho^2) (1 + 2 c rho) is Einstein's equation of f' g, and
    w is the rate of log f', halved.
    """
    reduced = universe(connection, "(R + c*R**2)/2", DUST, conditions)
    assert reduced.states == ("rho", "a", "a_1", name)
    c, size, rho = sp.Rational(1, 10), sp.Rational(3, 2), sp.Rational(2)
    rate = sp.sqrt((2 * rho + c * rho**2) * (1 + 2 * c * rho) / 6) / (1 - c * rho)
    change = -3 * c * rate * rho / (1 + 2 * c * rho)
    symbols = dict(zip(reduced.states, (rho, size, size * rate, factor * change), strict=True))
    place = {sp.Symbol(key, real=True): value for key, value in symbols.items()}
    place[sp.Symbol("c")] = c
    assert [sp.simplify(one.subs(place)) for one in reduced.constraints] == [0, 0]
    density = sp.Symbol("rho")
    square = (2 * density + c * density**2) * (1 + 2 * c * density) / (6 * (1 - c * density) ** 2)
    second = size * (rate**2 - sp.Rational(3, 2) * rho * square.diff(density).subs(density, rho))
    assert sp.simplify(reduced.rates["a_1"].subs(place) - second) == 0


def test_a_connection_that_is_not_a_difference_does_not_vanish() -> None:
    """Coefficients of the connection itself: R with dust has the Levi-Civita connection."""
    reduced = universe(isotropic(bar=False), "R/2", DUST)
    outputs = {"rho": "3*a_1**2/a**2", "u": "0", "v": "a_1/a", "w": "a*a_1"}
    assert {name: str(one) for name, one in reduced.outputs.items()} == outputs
    assert {name: str(one) for name, one in reduced.rates.items()} == {
        "a": "a_1",
        "a_1": "-a_1**2/(2*a)",
    }


h = sp.Function("h")(R)
LAPSE_AND_ROOT = A * sp.sqrt(h), 1 / sp.sqrt(h)


def hole(time: sp.Expr, radius: sp.Expr, dimension: int = 4) -> gt.Connection:
    """A static sphere in four or five dimensions."""
    angles = [R, R * sp.sin(THETA), R * sp.sin(THETA) * sp.sin(PHI)][: dimension - 2]
    names = [T, R, THETA, PHI, sp.Symbol("psi")][:dimension]
    signature = (-1, *[1] * (dimension - 1))
    return gt.levi_civita(gt.Frame(names, sp.diag(time, radius, *angles), signature))


@pytest.mark.parametrize("legs", [LAPSE_AND_ROOT, (sp.sqrt(h), 1 / sp.sqrt(h))])
def test_gauss_and_bonnet_in_five_dimensions(legs: tuple[sp.Expr, sp.Expr]) -> None:
    """Boulware and Deser: h = 1 - r^2 p with p + 2 alpha p^2 = m/r^4."""
    reduced = g.equations(hole(*legs, 5), "R + alpha*GB").reduce("r")
    alpha, mass = sp.Rational(1, 2), sp.Rational(3, 4)

    def exact(r: sp.Rational) -> sp.Expr:
        return 1 + r**2 / (4 * alpha) * (1 - sp.sqrt(1 + 8 * alpha * mass / r**4))

    states = {"h": exact(sp.Integer(1)), "A": 2}
    start = {name: x for name, x in states.items() if name in reduced.states}
    solution = gt.solve(reduced.ode(start, {"alpha": alpha}, origin=1), 4.0)
    check(solution, "h", float(exact(sp.Integer(5))))
    assert reduced.rates.get("A", 0) == 0
    assert len(reduced.branches) == 1


def test_gauss_and_bonnet_with_other_legs() -> None:
    """The same hole by two functions A and B: h = 1/B^2, and A B is constant."""
    reduced = g.equations(hole(A, B, 5), "R + alpha*GB").reduce("r")
    ode = reduced.ode({"A": 1, "B": 2}, {"alpha": "1/2"}, origin=1)
    solution = gt.solve(ode, 4.0)
    # p = 3/4 at r = 1, so that m = 21/16.
    exact = 1 + 25 / 2 * (1 - math.sqrt(1 + 21 / 4 / 625))
    check(solution, "B", exact**-0.5)
    check(solution, "A", 2 * exact**0.5)


def test_the_field_of_born_and_infeld() -> None:
    """E = q/sqrt(r^4 + q^2/b^2), and r (1 - h) grows with the energy b^2 (sqrt(1 + ...) - 1)."""
    field = g.maxwell([sp.Function("U")(R), 0, 0, 0])
    theory = "R/2 + b**2*(1 - sqrt(1 + F2/(2*b**2)))"
    equations = g.equations(hole(*LAPSE_AND_ROOT), theory, field, constants="b")
    reduced = equations.reduce("r")
    assert reduced.rates["A"] == 0
    assert reduced.constraints == ()
    charge, scale = 2.0, 3.0

    def strength(r: float) -> float:
        return charge / math.sqrt(r**4 + charge**2 / scale**2)

    def energy(r: float) -> float:
        return r**2 * scale**2 * (math.sqrt(1 + charge**2 / (scale**2 * r**4)) - 1)

    start = {"h": 1, "A": 1, "U": 0, "U_1": strength(1.0)}
    solution = gt.solve(reduced.ode(start, {"b": 3}, origin=1), 2.0)
    check(solution, "U_1", strength(3.0))
    inside, _ = quad(energy, 1, 3, epsabs=1e-12, epsrel=1e-12)
    check(solution, "h", 1 - inside / 3)


def test_all_branches_of_a_product() -> None:
    """T + c T^2 without matter: a constant rate of expansion, or a universe at rest."""
    reduced = universe(gt.cartan(COSMOS), "T + c*T**2")
    first, second = reduced.branches
    assert str(first) == str(reduced)
    assert first.vanishing == ()
    assert (second.vanishing, second.rates) == (("a_1",), {"a": 0})
    assert (reduced.open_factors, second.branches[0].vanishing) == ((), ())
    # Each factor vanishes with T = 6 H^2: E_0^0 is (T + c T^2) - 2 T (1 + 2 c T).
    H, c = sp.symbols("H c")
    value = -(6 * H**2) - 3 * c * (6 * H**2) ** 2
    (constraint,) = first.constraints
    places = {sp.Symbol("a", real=True): 1, sp.Symbol("a_1", real=True): H}
    quotient = sp.cancel(value / constraint.subs(places).subs(sp.Symbol("c"), c))
    assert sp.cancel(quotient / H**2).is_Rational


def test_a_special_solution_of_the_first_branch_is_not_listed() -> None:
    """The universe at rest without dust belongs to the equations of the expanding one."""
    assert len(universe(gt.levi_civita(COSMOS), "R/2", DUST).branches) == 1


def test_a_branch_that_leaves_a_function_free_is_named() -> None:
    """Gauss and Bonnet only: h = 1 makes all equations hold for any A."""
    reduced = g.equations(hole(*LAPSE_AND_ROOT, 5), "GB").reduce("r")
    assert [one.vanishing for one in reduced.branches] == [()]
    assert reduced.open_factors == ("h - 1",)


def test_the_only_variable_may_be_omitted():
    """Functions of t are reduced over t; without functions the refusal names a coordinate."""
    matter = gt.gravity.fluid("rho(t)", "0")
    cosmos = gt.gravity.equations(gt.levi_civita("frw"), "R/2", matter)
    assert cosmos.reduce().rates == cosmos.reduce("t").rates
    hole = gt.gravity.equations(gt.levi_civita("schwarzschild"), "R/2")
    with pytest.raises(GravityError, match="expected an unknown function of t"):
        hole.reduce()
    frame: Any = gt.spaces.load("schwarzschild").frame
    with pytest.raises(GravityError, match=r"Give cartan\(frame\) or levi_civita\(frame\)"):
        gt.gravity.equations(frame, "R/2")

"""Stars from a metric ansatz and a fluid, from their centre to their surface."""

import math
from collections.abc import Sequence

import numpy as np
import pytest
import sympy as sp
from scipy.integrate import solve_ivp

import geomtorsion as gt
from geomtorsion import gravity as g
from geomtorsion.errors import GeomtorsionError
from tests.rounding import ROUNDED

T, R, THETA, PHI = sp.symbols("t r theta phi")
AT_REST = [1, 0, 0, 0]
A, B, C = (sp.Function(name)(R) for name in "ABC")
STATIC = gt.Frame([T, R, THETA, PHI], sp.diag(A, B, R, R * sp.sin(THETA)), (-1, 1, 1, 1))
# A tetrad whose spin connection vanishes: the radial leg turns with the sphere.
RADIAL = sp.Matrix([sp.sin(THETA) * sp.cos(PHI), sp.sin(THETA) * sp.sin(PHI), sp.cos(THETA)])
PROPER = gt.Frame(
    [T, R, THETA, PHI],
    sp.diag(A, sp.Matrix.hstack(B * RADIAL, R * RADIAL.diff(THETA), R * RADIAL.diff(PHI))),
    (-1, 1, 1, 1),
)
MASS = {"m": "r*(1 - 1/B**2)/2"}
SURFACE = [gt.When("p")]
CLOSE = 1e-9


def star(density: str) -> g.Reduction:
    """A star in general relativity, kappa = 8 pi."""
    fluid = g.fluid(density, "p(r)", AT_REST)
    return g.equations(gt.levi_civita(STATIC), "R/(16*pi)", fluid).reduce("r")


@pytest.mark.parametrize(
    ("connection", "lagrangian"),
    [(gt.levi_civita(STATIC), "R/(2*kappa)"), (gt.cartan(PROPER), "-T/(2*kappa)")],
)
def test_constant_density_is_schwarzschilds_interior(
    connection: gt.Connection, lagrangian: str
) -> None:
    """(1 + p)/(1 + 3 p) = sqrt(1 - rho R^2/3) at the surface, for kappa = rho = 1; m = R^3/6."""
    fluid = g.fluid("rho0", "p(r)", AT_REST)
    equations = g.equations(connection, lagrangian, fluid)
    solution = g.solve(
        equations,
        "r",
        5,
        {"p": "1/10", "A": 1},
        {"kappa": 1, "rho0": 1},
        near={"B": 1},
        outputs=MASS,
        events=SURFACE,
    )
    radius = math.sqrt(3 * (1 - (1.1 / 1.3) ** 2))
    assert solution.stopped_by == "p"
    assert solution.error <= solution.accuracy
    assert float(solution["r"][-1]) == pytest.approx(radius, rel=CLOSE)
    assert float(solution["m"][-1]) == pytest.approx(radius**3 / 6, rel=CLOSE)
    root = math.sqrt(1 - radius**2 / 3)
    assert float(solution["A"][-1]) == pytest.approx(2 * root / (3 * root - 1), rel=CLOSE)


@pytest.mark.parametrize("density", ["1e-12", "1e12"])
def test_stars_of_any_size(density: str) -> None:
    """The radius of a star of constant density scales with 1/sqrt(rho)."""
    pressure = sp.Rational(density) / 10
    start, numbers = {"p": pressure, "A": 1}, {"rho0": density}
    scale = float(density) ** -0.5
    solution = g.solve(star("rho0"), "r", 10 * scale, start, numbers, near={"B": 1}, events=SURFACE)
    radius = math.sqrt(3 * (1 - (1.1 / 1.3) ** 2) / (8 * math.pi))
    assert float(solution["r"][-1]) / scale == pytest.approx(radius, rel=1e-8)


def test_the_equations_of_tolman_oppenheimer_and_volkoff() -> None:
    """The pressure follows p' = - (rho + p) A'/A, from the Noether identity of the fluid."""
    reduced = star("rho0")
    rates = reduced.rates
    symbols = {x.name: x for x in rates["p"].free_symbols | rates["A"].free_symbols}
    p, rho, size = (symbols[name] for name in ("p", "rho0", "A"))
    assert sp.simplify(rates["p"] + (rho + p) * rates["A"] / size) == 0
    assert reduced.constraints == ()


def test_a_neutron_star_of_a_polytrope() -> None:
    """K = 100, Gamma = 2, central rest-mass density 1.28e-3: M = 1.400, R = 9.586 (Font 2002)."""
    reduced = star("sqrt(p(r)/K) + p(r)")
    pressure = 100 * 1.28e-3**2
    solution = g.solve(
        reduced, "r", 30, {"p": pressure, "A": 1}, {"K": 100}, near={"B": 1}, outputs=MASS,
        events=SURFACE,
    )  # fmt: skip
    mass, radius = float(solution["m"][-1]), float(solution["r"][-1])
    assert mass == pytest.approx(1.400, abs=1e-3)
    assert radius == pytest.approx(9.586, abs=1e-3)

    def rates(r: float, y: np.ndarray) -> list[float]:
        p, m = y
        density = math.sqrt(max(p, 0.0) / 100) + p
        slope = -(density + p) * (m + 4 * math.pi * r**3 * p) / (r * (r - 2 * m))
        return [slope, 4 * math.pi * r**2 * density]

    # Below the surface, where the square root of the pressure is smooth.
    inside, near = 8.0, 1e-3
    density = math.sqrt(pressure / 100) + pressure
    first = [pressure, 4 * math.pi * near**3 * density / 3]
    options = {"method": "DOP853", "rtol": 1e-11, "atol": 1e-16}
    other = solve_ivp(rates, (near, inside), first, **options).y[:, -1]
    here = solution.at(inside - float(solution["r"][0]))
    assert float(here["m"]) == pytest.approx(other[1], rel=1e-7)


def test_a_mass_has_a_largest_value() -> None:
    """Denser stars of one polytrope are smaller, and their mass has a maximum near 1.64."""
    reduced = star("sqrt(p(r)/K) + p(r)")
    masses, radii = [], []
    for density in (1e-3, 2e-3, 3.2e-3, 6e-3):
        solution = g.solve(
            reduced, "r", 40, {"p": 100 * density**2, "A": 1}, {"K": 100}, near={"B": 1},
            outputs=MASS, events=SURFACE, accuracy=1e-8,
        )  # fmt: skip
        masses.append(float(solution["m"][-1]))
        radii.append(float(solution["r"][-1]))
    assert radii == sorted(radii, reverse=True)
    assert max(masses) == masses[2] == pytest.approx(1.637, abs=2e-3)


def test_a_centre_of_flat_space_is_regular() -> None:
    """Without matter the regular solution with B(0) = 1 is flat."""
    flat = g.equations(gt.levi_civita(STATIC), "R").reduce("r")
    place, values = flat.begin({"A": 1}, near={"B": 1})
    assert place > 0
    assert values == {"A": 1, "B": 1}


# -- other theories --------------------------------------------------------------------------------

QUADRATIC_R = "(R + c*R**2)/(16*pi)"
QUADRATIC_T = "-(T + c*T**2)/(16*pi)"
PRESSURE, DENSITY = 1e-4, 1e-3
CENTRAL = {"A": 1, "p": "1e-4"}
INSIDE = 5.0


def quadratic(
    connection: gt.Connection, lagrangian: str, conditions: Sequence[sp.Eq] = ()
) -> g.Reduction:
    """A star of constant density in another theory."""
    fluid = g.fluid("rho0", "p(r)", AT_REST)
    return g.equations(connection, lagrangian, fluid).reduce("r", conditions)


@pytest.fixture(scope="module")
def curvature() -> g.Reduction:
    """A star in f(R), of fourth order."""
    return quadratic(gt.levi_civita(STATIC), QUADRATIC_R)


@pytest.fixture(scope="module")
def torsion() -> g.Reduction:
    """A star in f(T), with a tetrad whose spin connection vanishes."""
    return quadratic(gt.cartan(PROPER), QUADRATIC_T)


def inside(
    reduced: g.Reduction, c: str, start: dict | None = None, near: dict | None = None
) -> list[float]:
    """A, B and p at one radius inside of a star."""
    first, rough = CENTRAL | (start or {}), {"B": 1} | (near or {})
    solution = g.solve(reduced, "r", INSIDE, first, {"rho0": "1e-3", "c": c}, near=rough)
    assert solution.error <= solution.accuracy
    for drift in solution.drift.values():
        assert drift <= solution.accuracy
    return [float(solution[name][-1]) for name in "ABp"]


def interior(radius: float) -> list[float]:
    """A, B and p of Schwarzschild's interior solution with A = 1 at the centre."""
    root = math.sqrt(1 - 8 * math.pi * DENSITY * radius**2 / 3)
    share = (DENSITY + 3 * PRESSURE) / (DENSITY + PRESSURE)
    # (rho + p)/(rho + 3 p) falls with the root, and (rho + p) A is constant.
    ratio = root * share
    p = DENSITY * (ratio - 1) / (3 - ratio)
    return [(DENSITY + PRESSURE) / (DENSITY + p), 1 / root, p]


def test_the_identity_as_a_function_is_general_relativity(torsion: g.Reduction) -> None:
    """The power series for f(T) = T is the closed form."""
    place, values = torsion.begin(CENTRAL, {"rho0": "1e-3", "c": 0}, near={"B": 1})
    assert place >= sp.Rational(1, 2)
    assert [float(values[x]) for x in "ABp"] == pytest.approx(interior(float(place)), rel=1e-12)


def test_a_quadratic_function_of_torsion(torsion: g.Reduction) -> None:
    """An integration of Euler-Lagrange equations, T = -2 (B - 1)(B - 1 - 2 r A'/A)/(r B)^2."""
    c, r, A, u, B, p = (sp.Symbol(name, positive=True) for name in "crAuBp")
    slopes = up, Bp = sp.symbols("up Bp")
    T = -2 * (B - 1) * (B - 1 - 2 * r * u / A) / (r * B) ** 2
    action = -(T + c * T**2) * A * B * r**2 / (16 * sp.pi)
    rates = {r: 1, A: u, u: up, B: Bp, p: -(DENSITY + p) * u / A}

    def along(x: sp.Expr) -> sp.Expr:
        return sum(x.diff(symbol) * rate for symbol, rate in rates.items())

    radial = action.diff(B) + p * A * r**2
    timelike = action.diff(A) - along(action.diff(u)) - DENSITY * B * r**2
    solved = sp.linear_eq_to_matrix([along(radial), timelike], slopes)
    table = [sp.lambdify((c, r, A, u, B, p), x) for x in (*solved, radial, radial.diff(u))]

    for number in (1.0, 30.0):
        near = 0.05
        first = 4 * math.pi * (DENSITY + 3 * PRESSURE) / 3 * near
        one = 1 + first * near / 2
        p0 = PRESSURE - (DENSITY + PRESSURE) * first * near / 2
        B0 = 1 + 4 * math.pi * DENSITY * near**2 / 3
        for _ in range(5):
            here = number, near, one, first, B0, p0
            first -= table[2](*here) / table[3](*here)

        def rates_of(x: float, y: np.ndarray, number: float = number) -> list[float]:
            matrix, right = (one(number, x, *y) for one in table[:2])
            slope, other = np.linalg.solve(matrix, right)[:, 0]
            return [y[1], slope, other, -(DENSITY + y[3]) * y[1] / y[0]]

        options = {"method": "DOP853", "rtol": 1e-12, "atol": 1e-15}
        other = solve_ivp(rates_of, (near, INSIDE), [one, first, B0, p0], **options).y[:, -1]
        ours = inside(torsion, str(number))
        assert ours == pytest.approx([other[0], other[2], other[3]], rel=1e-8)
        assert abs(ours[1] / interior(INSIDE)[1] - 1) > 1e-6


def trace_of_curvature(function: sp.Expr, R0: float) -> tuple[list[float], float, float]:
    """A, B, p from the trace of f(R) gravity with S = R, and A'', B'' at the centre.

    function: of S. R0: the curvature at the centre.
    """
    radius, A, u, B, p, S, v = sp.symbols("r A u B p S v")
    slopes = up, Bp, vp = sp.symbols("up Bp vp")
    f, F, second, third = (function.diff(S, order) for order in range(4))
    value, weight, change = (float(x.subs(S, R0)) for x in (f, F, second))
    source = 8 * math.pi * (DENSITY - 3 * PRESSURE)
    bend = (2 * value - weight * R0 - source) / (18 * change)
    b = 8 * math.pi * DENSITY - (value - weight * R0) / 2 + 6 * change * bend
    b /= 6 * weight
    a = b - R0 / 12
    scalar = (
        -2 * up / (A * B**2)
        + 2 * u * Bp / (A * B**3)
        - 4 * u / (radius * A * B**2)
        + 4 * Bp / (radius * B**3)
        + 2 * (1 - 1 / B**2) / radius**2
    )
    box = second * (vp + v * (u / A - Bp / B + 2 / radius)) + third * v**2
    trace = 3 * box / B**2 + F * S - 2 * f + 8 * sp.pi * (DENSITY - 3 * p)
    energy = (1 - 1 / B**2) / radius**2 + 2 * Bp / (radius * B**3)
    timelike = F * energy - 8 * sp.pi * DENSITY + (f - F * S) / 2
    timelike += (second * v * u / A - box) / B**2
    solved = sp.linear_eq_to_matrix([scalar - S, trace, timelike], slopes)
    table = [sp.lambdify((radius, A, u, B, p, S, v), x) for x in solved]

    def rates(x: float, y: np.ndarray) -> list[float]:
        slope, other, last = np.linalg.solve(*(one(x, *y) for one in table))[:, 0]
        A, u, _, p, _, v = y
        return [u, slope, other, -(DENSITY + p) * u / A, v, last]

    near = 0.02
    first = [
        1 + a * near**2,
        2 * a * near,
        1 + b * near**2,
        PRESSURE - (DENSITY + PRESSURE) * a * near**2,
        R0 + bend * near**2,
        2 * bend * near,
    ]
    options = {"method": "DOP853", "rtol": 1e-11, "atol": 1e-15}
    last = solve_ivp(rates, (near, INSIDE), first, **options).y[:, -1]
    return [last[0], last[2], last[3]], 2 * a, 2 * b


def named_curvature(lagrangian: str) -> g.Reduction:
    """A star in f(R) with the curvature as an unknown function S."""
    scalar_curvature = STATIC.quantity("scalar_curvature")[()]
    condition = sp.Eq(sp.Function("S")(R), scalar_curvature)
    return quadratic(gt.levi_civita(STATIC), lagrangian, [condition])


def test_a_quadratic_function_of_curvature(curvature: g.Reduction) -> None:
    """An integration of the trace of the field equations, and both ways to give the curvature."""
    S = sp.Symbol("S")
    R0 = 8 * math.pi * (DENSITY - 3 * PRESSURE) * 1.1
    other, A_2, B_2 = trace_of_curvature(S - 2 * S**2, R0)
    ours = inside(curvature, "-2", {"A_2": A_2}, {"B_2": B_2})
    assert ours == pytest.approx(other, rel=1e-8)
    short = named_curvature(QUADRATIC_R)
    assert inside(short, "-2", {"S": R0}) == pytest.approx(ours, rel=CLOSE)
    assert abs(ours[1] / interior(INSIDE)[1] - 1) > 1e-4


@pytest.mark.slow
def test_a_root_of_curvature() -> None:
    """For R + c sqrt(1 + R) the rules replace equations without a power series."""
    S = sp.Symbol("S")
    reduced = named_curvature("(R + c*sqrt(1 + R))/(16*pi)")
    other, _, _ = trace_of_curvature(S + sp.sqrt(1 + S) / 10, 0.03)
    assert inside(reduced, "1/10", {"S": 0.03}) == pytest.approx(other, rel=1e-7)


def test_small_terms_are_small(curvature: g.Reduction, torsion: g.Reduction) -> None:
    """Stars approach the ones of general relativity as the coefficient of the square vanishes."""
    second = {"A_2": 4 * math.pi / 3 * (DENSITY + 3 * PRESSURE)}
    near = {"B_2": 8 * math.pi / 3 * DENSITY}
    for reduced, numbers, start, rough in (
        (curvature, ("-1/10", "-1/100"), second, near),
        (torsion, ("1/10", "1/100"), {}, {}),
    ):
        large, small = (
            np.abs(np.array(inside(reduced, c, start, rough)) / interior(INSIDE) - 1)
            for c in numbers
        )
        assert np.all(small < large / 5)
        assert np.all(small < 1e-2)


def test_nonmetricity_has_the_stars_of_torsion(torsion: g.Reduction) -> None:
    """The equation of a flat connection holds for isotropic flat coordinates; then f(Q) is f(T)."""
    X = sp.Function("X")(R)
    flat = gt.Frame(
        [T, R, THETA, PHI],
        sp.diag(1, (R * X).diff(R), R * X, R * X * sp.sin(THETA)),
        (-1, 1, 1, 1),
    )
    coefficients = gt.levi_civita(flat).coefficients
    axis = range(4)
    connection = gt.from_coefficients(
        STATIC, [[[coefficients[i, j, k] for k in axis] for j in axis] for i in axis]
    )
    isotropic = sp.Eq((R * X).diff(R), B * X)
    reduced = quadratic(connection, "-(Q + c*Q**2)/(16*pi)", [isotropic])
    ours = inside(reduced, "30", {"X": 1})
    assert ours == pytest.approx(inside(torsion, "30"), rel=CLOSE)


def test_a_density_that_is_not_even() -> None:
    """B^-2 = 1 - 2 m/r with m = 4 pi rho0 (r^3/3 - r^4/4), from a series with all powers."""
    reduced = star("rho0*(1 - r)")
    place, values = reduced.begin({"A": 1, "p": 1}, {"rho0": 1}, near={"B": 1})
    r = float(place)
    mass = 4 * math.pi * (r**3 / 3 - r**4 / 4)
    assert float(values["B"]) == pytest.approx((1 - 2 * mass / r) ** -0.5, rel=ROUNDED)


def test_a_centre_where_the_sphere_has_no_size() -> None:
    """In the proper radius the sphere C(r) vanishes at the centre: C(0) = 0, and C' = 1 follows."""
    frame = gt.Frame([T, R, THETA, PHI], sp.diag(A, 1, C, C * sp.sin(THETA)), (-1, 1, 1, 1))
    fluid = g.fluid("rho0", "p(r)", AT_REST)
    reduced = g.equations(gt.levi_civita(frame), "R/(16*pi)", fluid).reduce("r")
    start, numbers, near = {"A": 1, "p": "1e-3", "C": 0}, {"rho0": "1e-2"}, {"C_1": 1}
    assert reduced.complete(start, numbers, near=near)["A_1"] == 0
    solution = g.solve(reduced, "r", 10, start, numbers, near=near, events=SURFACE)
    radius = math.sqrt(3 * (1 - (1.1 / 1.3) ** 2) / (8 * math.pi * 1e-2))
    assert float(solution["C"][-1]) == pytest.approx(radius, rel=CLOSE)


@pytest.mark.parametrize(
    ("start", "near", "words"),
    [
        ({"B": 1}, {}, "leaves free at r = 0, got none for p_2, A_2, B_2"),
        ({"B": 1, "A_2": 1000}, {}, "got B_2 = -1000.* or 1000.*near="),
        ({"B": 1, "A_2": "1/1000", "B_2": 1}, {}, "without a power series"),
        ({"B": 1, "A_2": "1/1000"}, {}, "got values for which there is none"),
        ({"B": 1, "A_1": 1}, {}, "expected A_1 = 0, because the functions are even"),
        ({"B": 1, "C": 1}, {}, "C"),
    ],
)
def test_refusals_of_fourth_order(
    curvature: g.Reduction, start: dict, near: dict, words: str
) -> None:
    """One more value is free, and a quadratic equation has two roots or none."""
    with pytest.raises(GeomtorsionError, match=words):
        curvature.begin(CENTRAL | start, {"rho0": "1e-3", "c": "-2"}, near=near)


def test_an_exponential_of_torsion_ends_where_an_output_vanishes() -> None:
    """With S = T p follows without a derivative; for small c the star is Schwarzschild's."""
    fluid = g.fluid("rho0", "p(r)", AT_REST)
    theory = g.equations(gt.cartan(PROPER), "-(exp(c*T) - 1)/(16*pi*c)", fluid)
    reduced = theory.reduce("r", ["S(r) = T"])
    assert "p" in reduced.outputs
    numbers = {"rho0": "1e-3", "c": "1e-6"}
    solution = g.solve(reduced, "r", 10, CENTRAL, numbers, near={"B": 1, "S": 0}, events=SURFACE)
    share = (DENSITY + PRESSURE) / (DENSITY + 3 * PRESSURE)
    radius = math.sqrt(3 * (1 - share**2) / (8 * math.pi * DENSITY))
    assert solution.outcome == "stopped"
    # c T is below a millionth of a hundredth.
    assert float(solution["r"][-1]) == pytest.approx(radius, rel=1e-7)

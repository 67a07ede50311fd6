"""Values demanded at the end or at infinity, compared with closed forms and other integrations."""

import json
import math
from pathlib import Path

import numpy as np
import pytest
import sympy as sp
from scipy.integrate import solve_ivp
from scipy.optimize import brentq

import geomtorsion as gt
from geomtorsion import gravity as g
from geomtorsion.errors import ArgumentError, EndpointError, GeomtorsionError, GravityError
from geomtorsion.gravity.theory.fluids import Fluid

T, R, X, Y, Z, THETA, PHI = sp.symbols("t r x y z theta varphi")
LORENTZ = (-1, 1, 1, 1)
a = sp.Function("a")(T)
A, B, S = (sp.Function(name)(R) for name in "ABS")
COSMOS = gt.Frame([T, X, Y, Z], sp.diag(1, a, a, a), LORENTZ)
STATIC = gt.Frame([T, R, THETA, PHI], sp.diag(A, B, R, R * sp.sin(THETA)), LORENTZ)
DUST = g.fluid("rho(t)", 0, [1, 0, 0, 0])
MASS = {"M": "r*(1 - 1/B**2)/2"}


@pytest.fixture(scope="module")
def cosmos() -> g.Reduction:
    """Dust and a cosmological constant."""
    return g.equations(gt.levi_civita(COSMOS), "R/2 - Lambda", DUST).reduce("t")


@pytest.fixture(scope="module")
def vacuum() -> g.Reduction:
    """A static vacuum."""
    return g.equations(gt.levi_civita(STATIC), "R").reduce("r")


@pytest.fixture(scope="module")
def boson() -> g.Reduction:
    """A star of a complex scalar field, of two real fields; the frequency is one."""
    wave = [g.scalar_field(f"phi(r)*{x}(t)", name=x[0]) for x in ("cos", "sin")]
    lagrangian = "R/2 - (X + X_2)/2 - m**2*(c**2 + s**2)/2"
    return g.equations(gt.levi_civita(STATIC), lagrangian, wave).reduce("r")


def test_a_parameter_from_the_size_of_a_universe(cosmos: g.Reduction) -> None:
    """a = (m/l)^(1/3) sinh^(2/3)(3 sqrt(l) t/2), so that a(1) gives Lambda = 3 l."""
    matter, dark = 0.3, 0.7
    age = 2 / 3 / math.sqrt(dark) * math.asinh(math.sqrt(dark / matter))
    size = (matter / dark) ** (1 / 3) * math.sinh(1.5 * math.sqrt(dark) * (1 + age)) ** (2 / 3)
    answer = g.shoot(
        cosmos, "t", [0.5, 1], {"a": 1, "rho": "9/10"}, {"Lambda": 1}, near={"a_1": 1},
        free=["Lambda"], boundary={"a": size},
    )  # fmt: skip
    assert answer.solution.times.tolist() == [0.5, 1]
    assert abs(answer.values["Lambda"] - 2.1) < answer.errors["Lambda"] < 1e-8
    data = json.loads(json.dumps(answer.to_json(), allow_nan=False))
    free = data["free"]["Lambda"]
    assert abs(free["value"] - 2.1) < free["error"]
    assert list(data["boundary"]) == list(answer.misses)
    assert set(data["solution"]) == {"t", *cosmos.states}
    assert data["solution"]["a"][-1] == pytest.approx(size, rel=1e-8)


def test_two_conditions_and_two_numbers(cosmos: g.Reduction) -> None:
    """The numbers of a solution follow from an expression and a state at its end."""
    start, parameters = {"a": 1, "rho": 2}, {"Lambda": "3/2"}
    there = g.solve(cosmos, "t", 1, start, parameters, near={"a_1": 1})
    demands = {
        "a": float(there["a"][-1]),
        "a_1/a": float(there["a_1"][-1]) / float(there["a"][-1]),
    }
    answer = g.shoot(
        cosmos, "t", 1, {"a": 1, "rho": 3}, {"Lambda": 1}, near={"a_1": 1},
        free=["rho", "Lambda"], boundary=demands,
    )  # fmt: skip
    assert answer.values == pytest.approx({"rho": 2, "Lambda": 1.5}, rel=1e-8)


@pytest.mark.parametrize(("last", "bound"), [(30, 1e-2), (200, 1e-8)])
def test_a_limit_at_infinity(vacuum: g.Reduction, last: float, bound: float) -> None:
    """A = sqrt(1 - 2 M/r) for A(oo) = 1; the remainder covers the error of the extrapolation."""
    answer = g.shoot(
        vacuum, "r", last, {"A": 2, "B": "sqrt(5)/2"}, origin=10,
        free=["A"], boundary={"A(oo)": 1},
    )  # fmt: skip
    error = abs(answer.values["A"] - math.sqrt(0.8))
    assert error <= answer.errors["A"] < bound
    assert answer.remainders["A(oo) = 1"] < bound


def frequency(central: float, first: float, second: float, last: float) -> float:
    """A(0) of a boson star with omega = m = 1 and 8 pi G = 1, by scipy."""

    def rates(r: float, y: np.ndarray) -> list[float]:
        A, h, phi, slope = y
        density = phi**2 / A**2 + slope**2 * h + phi**2
        pressure = phi**2 / A**2 + slope**2 * h - phi**2
        change = -r * density / 2 + (1 - h) / r
        bend = r * pressure / (4 * h) + (1 - h) / (2 * r * h)
        force = (phi - phi / A**2) / h
        return [A * bend, change, slope, force - slope * (bend + change / (2 * h) + 2 / r)]

    def end(A0: float) -> float:
        near = 1e-3
        bend = (central - central / A0**2) / 3
        first = [A0, 1 - near**2 * (central**2 / A0**2 + central**2) / 6]
        first += [central + bend * near**2 / 2, bend * near]
        options = {"method": "DOP853", "rtol": 1e-11, "atol": 1e-13}
        return float(solve_ivp(rates, (near, last), first, **options).y[2, -1])

    return brentq(end, first, second, xtol=1e-12)


def test_a_boson_star(boson: g.Reduction) -> None:
    """The heaviest one, sqrt(4 pi G) phi(0) = 0.271, has M m = 0.633 and omega/m = 0.853."""
    central = math.sqrt(2) * 0.271
    outputs = {**MASS, "omega": "1/(A*B)"}
    near = g.shoot(
        boson, "r", 8, {"A": "0.8", "phi": central}, {"m": 1}, near={"B": 1},
        free=["A"], boundary={"phi": 0},
    )  # fmt: skip
    assert near.values["A"] == pytest.approx(frequency(central, 0.78, 0.82, 8), abs=1e-7)
    far = g.shoot(
        boson, "r", 20, {"A": near.values["A"], "phi": central}, {"m": 1}, near={"B": 1},
        free=["A"], boundary={"phi": 0}, outputs=outputs,
    )  # fmt: skip
    assert float(far.solution["M"][-1]) == pytest.approx(0.633, abs=5e-4)
    assert float(far.solution["omega"][-1]) == pytest.approx(0.853, abs=5e-4)
    # Conditions that a decaying wave fulfils need no place as far away.
    robin = g.shoot(
        boson, "r", 12, {"A": "0.8", "phi": central}, {"m": 1}, near={"B": 1},
        free=["A"], boundary={"phi_1 + (B*sqrt(m**2 - 1/A**2) + 1/r)*phi": 0},
    )  # fmt: skip
    cut = abs(near.values["A"] - far.values["A"])
    assert abs(robin.values["A"] - far.values["A"]) < cut / 10


def quadratic_star(c: float, last: float) -> tuple[float, float]:
    """S(0) of a star of constant density for R + c R^2 whose curvature S vanishes, and M there."""
    density, pressure, eight = 1e-3, 1e-4, 8 * math.pi
    A, u, B, p, S, v, rho, r = sp.symbols("A u B p S v rho r")
    up, Bp, vp = sp.symbols("up Bp vp")
    scalar = (
        -2 * up / (A * B**2) + 2 * u * Bp / (A * B**3) - 4 * u / (r * A * B**2)
        + 4 * Bp / (r * B**3) + 2 * (1 - 1 / B**2) / r**2
    )  # fmt: skip
    box = 2 * c * (vp + v * (u / A - Bp / B + 2 / r)) / B**2
    trace = 3 * box - S + eight * (rho - 3 * p)
    weight = 1 + 2 * c * S
    energy = (1 - 1 / B**2) / r**2 + 2 * Bp / (r * B**3)
    timelike = weight * energy - eight * rho - c * S**2 / 2 + 2 * c * v * u / (A * B**2) - box
    solved = sp.linear_eq_to_matrix([scalar - S, trace, timelike], [up, Bp, vp])
    table = [sp.lambdify((r, A, u, B, p, S, v, rho), x) for x in solved]
    near, options = 0.02, {"method": "DOP853", "rtol": 1e-10, "atol": 1e-14}

    def rates(x: float, y: np.ndarray, rho: float) -> list[float]:
        A, u, B, p, S, v = y
        slopes = np.linalg.solve(*(one(x, A, u, B, p if rho else 0.0, S, v, rho) for one in table))
        slope, other, last = slopes[:, 0]
        return [u, slope, other, -(rho + p) * u / A if rho else 0.0, v, last]

    def surface(_: float, y: np.ndarray, __: float) -> float:
        return y[3]

    surface.terminal = True  # type: ignore[attr-defined]  # as scipy wants it

    def end(S0: float) -> tuple[float, float]:
        bend = (S0 - eight * (density - 3 * pressure)) / (36 * c)
        b = (eight * density + c * S0**2 / 2 + 12 * c * bend) / (6 * (1 + 2 * c * S0))
        a = b - S0 / 12
        first = [1 + a * near**2, 2 * a * near, 1 + b * near**2]
        first += [pressure - (density + pressure) * a * near**2]
        first += [S0 + bend * near**2, 2 * bend * near]
        inside = solve_ivp(rates, (near, last), first, args=(density,), events=surface, **options)
        begin = inside.t[-1], last
        outside = solve_ivp(rates, begin, inside.y[:, -1], args=(0.0,), **options).y[:, -1]
        return float(outside[4]), last * (1 - 1 / outside[2] ** 2) / 2

    root = brentq(lambda S0: end(S0)[0], 0.010, 0.011, xtol=1e-13)
    return root, end(root)[1]


def star(equation: str, *matter: Fluid) -> g.Reduction:
    """A theory f(R) with the curvature as a function S."""
    condition = sp.Eq(S, STATIC.quantity("scalar_curvature")[()])
    equations = g.equations(gt.levi_civita(STATIC), equation, list(matter))
    return equations.reduce("r", [condition])


@pytest.mark.slow
def test_the_curvature_at_the_centre_of_a_star() -> None:
    """Outside of a star for R + 2 R^2 the curvature vanishes; an integration by scipy agrees."""
    inside = star("(R + c*R**2)/(16*pi)", g.fluid("rho0", "p(r)", [1, 0, 0, 0]))
    answer = g.shoot(
        inside, "r", 15, {"A": "0.77", "p": "1e-4", "S": "0.0104"}, {"rho0": "1e-3", "c": 2},
        near={"B": 1}, free=["S"], boundary={"S": 0}, outside=star("R + c*R**2"),
        events=[gt.When("p")], outputs=MASS,
    )  # fmt: skip
    root, mass = quadratic_star(2.0, 15.0)
    assert answer.values["S"] == pytest.approx(root, rel=1e-6)
    assert answer.outside is not None
    assert float(answer.outside["M"][-1]) == pytest.approx(mass, rel=1e-6)


def test_a_star_and_the_vacuum_around_it(vacuum: g.Reduction) -> None:
    """Schwarzschild's interior: A(0) = (3 A(R) - 1)/2 for A(oo) = 1, and its mass outside."""
    density, pressure = 1e-3, 1e-4
    fluid = g.fluid("rho0", "p(r)", [1, 0, 0, 0])
    inside = g.equations(gt.levi_civita(STATIC), "R/(16*pi)", fluid).reduce("r")
    answer = g.shoot(
        inside, "r", 100, {"A": 1, "p": "1e-4"}, {"rho0": "1e-3"}, near={"B": 1},
        free=["A"], boundary={"A(oo)": 1}, outside=vacuum, events=[gt.When("p")], outputs=MASS,
    )  # fmt: skip
    share = (density + pressure) / (density + 3 * pressure)
    assert answer.values["A"] == pytest.approx((3 * share - 1) / 2, rel=1e-8)
    radius = math.sqrt(3 * (1 - share**2) / (8 * math.pi * density))
    assert answer.outside is not None
    assert answer.outside["M"] == pytest.approx(4 / 3 * math.pi * density * radius**3, rel=1e-8)
    data = json.loads(json.dumps(answer.to_json(), allow_nan=False))
    # The vacuum begins where the pressure ends.
    assert data["solution"]["r"][-1] == pytest.approx(data["outside"]["solution"]["r"][0])
    assert not any(name.startswith("condition") for name in data["outside"]["solution"])


def test_equal_calls_give_equal_bits(vacuum: g.Reduction) -> None:
    """Numbers, errors and texts of two calls are the same."""
    one, two = (
        g.shoot(
            vacuum, "r", 50, {"A": 2, "B": 2}, origin=10, free=["A"], boundary={"A(oo)": 1}
        )
        for _ in range(2)
    )  # fmt: skip
    assert one.values == two.values
    assert one.errors == two.errors
    assert str(one).splitlines()[:3] == str(two).splitlines()[:3]
    assert "A(oo) = 1: missed by" in str(one)


@pytest.mark.parametrize(
    ("arguments", "error", "words"),
    [
        ({"free": ["rho", "Lambda"]}, GravityError, "got a = 2 for rho, Lambda. Add a condition"),
        ({"boundary": {"a": 2, "rho": 1}}, GravityError, "got a = 2, rho = 1 for rho. Free anoth"),
        ({"free": ["sigma"]}, GeomtorsionError, "free: expected names .* got 'sigma'"),
        ({"free": []}, GeomtorsionError, "free"),
        ({"outputs": {1: 2}}, GravityError, "outputs: expected names as keys, got 1"),
        ({"boundary": {"b": 2}}, GeomtorsionError, "boundary value b"),
        ({"boundary": {"a": "x"}}, GeomtorsionError, "boundary: a"),
        ({"boundary": {"a": 0.5}}, EndpointError, "for which a = 0.5 at t = 1, got none"),
        ({"boundary": {"a(oo)": 2}, "origin": 1, "last": 1.5}, EndpointError, "beyond t = 2.618"),
        ({"last": 0}, GeomtorsionError, "last"),
        ({"start": {"a": 1}}, GeomtorsionError, "rho"),
        ({"start": {"a": 1, "rho": -3}}, GeomtorsionError, "real a_1"),
        ({"accuracy": -1}, GeomtorsionError, "accuracy"),
        ({"last": float("nan")}, GeomtorsionError, "last"),
        ({"equations": "R/2"}, ArgumentError, "equations: expected field equations or their redu"),
        ({"outside": "R/2"}, ArgumentError, "outside: expected field equations or their reductio"),
    ],
)
def test_refusals(cosmos: g.Reduction, arguments: dict, error: type, words: str) -> None:
    """Too many or too few conditions, unknown names, and values that no solution has."""
    call = {
        "equations": cosmos, "variable": "t",
        "last": 1, "start": {"a": 1, "rho": 3}, "parameters": {"Lambda": 0},
        "near": {"a_1": 1}, "free": ["rho"], "boundary": {"a": 2}, **arguments,
    }  # fmt: skip
    with pytest.raises(error, match=words):
        g.shoot(**call)


def test_a_bare_lagrangian_is_refused() -> None:
    """`solve` expects field equations or their reduction."""
    with pytest.raises(ArgumentError, match=r"got 'R/2'. Give gravity.equations"):
        g.solve("R/2", "t", 1, {})  # type: ignore[arg-type]


def test_no_black_hole_has_a_scalar_charge(boson: g.Reduction) -> None:
    """A free scalar field around a static hole that vanishes at infinity is zero."""
    matter = g.scalar_field("psi(r)", name="psi")
    h = sp.Function("h")(R)
    frame = gt.Frame(
        [T, R, THETA, PHI], sp.diag(A * sp.sqrt(h), 1 / sp.sqrt(h), R, R * sp.sin(THETA)), LORENTZ
    )
    equations = g.equations(gt.levi_civita(frame), "R/2 - X/2 - m**2*psi**2/2", matter)
    reduced = equations.reduce("r")
    answer = g.shoot(
        reduced, "r", 6, {"A": 1, "h": 0, "psi": "1/10"}, {"m": 1}, near={"h_1": 1}, origin=1,
        free=["psi"], boundary={"psi": 0},
    )  # fmt: skip
    assert abs(answer.values["psi"]) < 1e-8


def test_a_file(tmp_path: Path) -> None:
    """Keys free and boundary of a theory in a tetrad file."""
    file = tmp_path / "static.toml"
    file.write_text(
        """
coordinates = ["t", "r", "theta", "varphi"]
coframe = [["A(r)", 0, 0, 0], [0, "B(r)", 0, 0], [0, 0, "r", 0], [0, 0, 0, "r*sin(theta)"]]
signature = [-1, 1, 1, 1]
functions = {A = ["r"], B = ["r"]}
[theory]
lagrangian = "R"
connection = "levi-civita"
start = {A = 1, B = "sqrt(5)/2"}
origin = 10
free = ["A"]
boundary = {"A(oo)" = 1}
"""
    )
    answer = g.read_model(file).shoot("r", 200)
    assert answer.values["A"] == pytest.approx(math.sqrt(0.8), abs=1e-9)

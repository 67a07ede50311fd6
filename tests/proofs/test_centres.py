"""Regular solutions at a pole of the rates: the start, and motions from there, in closed form."""

# pyright: reportArgumentType=false, reportOptionalMemberAccess=false

from dataclasses import replace

import pytest
import sympy as sp
from flint import arb

import geomtorsion as gt
from geomtorsion import gravity
from geomtorsion.errors import ProofError
from geomtorsion.ode import Centre
from geomtorsion.proofs.centres import RegularStart
from geomtorsion.support.precision import ball_precision

T, R, THETA, PHI = sp.symbols("t r theta phi")
A, B = (sp.Function(name)(R) for name in "AB")
STATIC = gt.Frame([T, R, THETA, PHI], sp.diag(A, B, R, R * sp.sin(THETA)), (-1, 1, 1, 1))


def beside(rates, values, place, parameters=None):
    """Equations with a pole at x = 0, and about the start of their regular solution there."""
    time = {"x": "(x_0 + s)"}
    moved = {name: rate.replace("x", time["x"]) for name, rate in rates.items()}
    problem = gt.ODE.of(
        moved, values, parameters={"x_0": place, **(parameters or {})}, time="s",
        outputs={"x": "x_0 + s"},
    )  # fmt: skip
    return replace(problem, centre=Centre(0, "x_0", values))


def lane_emden(power, place):
    """Lane and Emden's equation y'' + 2 y'/x + y^n = 0 with y(0) = 1."""
    rates = {"y": "v", "v": f"-2*v/x-{power}"}
    return beside(rates, {"y": 1, "v": 0}, place)


def quotient(x):
    """sin(x)/x and its derivative."""
    return x.sin() / x, x.cos() / x - x.sin() / x**2


def root(x):
    """(1 + x^2/3)^(-1/2) and its derivative."""
    base = 1 + x * x / 3
    return 1 / base.sqrt(), -x / 3 / base.sqrt() ** 3


def square(x):
    """1 - x^2/6 and its derivative."""
    return 1 - x * x / 6, -x / 3


CLOSED = [("1", square), ("y", quotient), ("y**5", root)]


@pytest.mark.parametrize("bits", [60, 150, 400])
@pytest.mark.parametrize("place", ["1/64", "1/5", "3/8"])
@pytest.mark.parametrize(("power", "form"), CLOSED)
def test_the_start(power, form, place, bits):
    """The balls of a series with its tail contain Lane and Emden's solutions for n = 0, 1, 5."""
    problem = lane_emden(power, place)
    regular = RegularStart.of(problem, {})
    with ball_precision(bits):
        boxes = regular.boxes()
    with ball_precision(3 * bits):
        x = sp.Rational(place)
        for box, truth in zip(boxes, form(arb(x.p) / x.q), strict=True):
            assert box.overlaps(truth)
            assert box.rad() < arb(2) ** (4 - bits)


@pytest.mark.parametrize(("rest", "truth"), [(0, 1), (2, 4)])
def test_bessel_functions(rest, truth):
    """x^2 y'' + x y' + x^2 y = 0 from a ball of parameters: J_0(k x) and its derivative."""
    problem = beside({"y": "v", "v": "-v/x-k*y"}, {"y": 1, "v": 0}, "1/4", {"k": 1})
    problem = replace(problem, parameters={**problem.parameters, "k": 1 + rest})
    k = arb(1 + rest, 1e-9)
    with ball_precision(80):
        y, _ = RegularStart.of(problem, {"k": k}).boxes()
        for value in (1 + rest, k.lower(), k.upper()):
            assert y.overlaps((arb(value).sqrt() / 4).bessel_j(0))
        assert y.rad() < 1e-9 * truth


@pytest.mark.parametrize(("power", "form"), CLOSED)
def test_motions(power, form):
    """Solved in floats from rounded numbers, proved from the pole to 20 digits."""
    problem = lane_emden(power, "1/4")
    with ball_precision(100):
        first = [float(x) for x in form(arb(1) / 4)]
    solution = gt.solve(replace(problem, start=tuple(first)), [1.0])
    proof = gt.prove(solution, 20)
    with ball_precision(150):
        for name, truth in zip(("y", "v"), form(arb(5) / 4), strict=True):
            ball = proof[name][-1]
            assert ball.overlaps(truth)
            assert ball.rad() < abs(truth) * arb(10) ** -19
        assert proof["x"][-1].overlaps(arb(5) / 4)
    assert proof.holds


def test_series_that_do_not_exist():
    """A resonance gives a logarithm; values that are not regular have no proof from the pole."""
    resonant = beside({"y": "y/x+1"}, {"y": 0}, "1/4")
    with ball_precision(80), pytest.raises(ProofError, match="order 1 at the pole"):
        RegularStart.of(resonant, {}).boxes()
    wrong = replace(lane_emden("y", "1/4"), centre=Centre(0, "x_0", {"y": 1, "v": 1}))
    assert RegularStart.of(wrong, {}) is None
    proof = gt.prove(gt.solve(wrong, [0.5]))
    assert any("beside the pole" in text for text in proof.assumes)
    # Other numbers begin at no pole that is known.
    assert wrong.with_start({"y": 2}).centre is None


def star(density, pressure, start, parameters):
    """A star in general relativity, from its centre to its surface, with its mass."""
    fluid = gravity.fluid(density, pressure, [1, 0, 0, 0])
    reduced = gravity.equations(gt.levi_civita(STATIC), "R/(16*pi)", fluid).reduce("r")
    (name,) = start
    return gravity.solve(
        reduced, "r", 100, {"A": 1, **start}, parameters, near={"B": 1},
        outputs={"m": "r*(1-1/B**2)/2"}, events=[gt.When(name)],
    )  # fmt: skip


def test_a_star_of_constant_density():
    """Schwarzschild's interior solution: radius, mass and A at the surface in closed form."""
    proof = gt.prove(star("rho0", "p(r)", {"p": "1/10000"}, {"rho0": "1/1000"}), 20)
    with ball_precision(200):
        # (rho + p)/(rho + 3 p) = sqrt(1 - 8 pi rho R^2/3), and A = (rho + p)/rho.
        radius = (3 * (1 - (arb(11) / 13) ** 2) / (8 * arb.pi()) * 1000).sqrt()
        mass = 4 * arb.pi() / 3 * radius**3 / 1000
        for name, truth in (("r", radius), ("m", mass), ("A", arb(11) / 10)):
            assert proof[name][-1].overlaps(truth)
            assert proof[name][-1].rad() < truth * arb(10) ** -15
    assert proof.holds
    assert "m = 0.826880" in str(proof)


def test_a_polytrope():
    """Font et al. 2002: p = 100 rho^2, central density 1.28e-3: M = 1.400, R = 9.586."""
    solution = star("q(r) + K*q(r)**2", "K*q(r)**2", {"q": "0.00128"}, {"K": 100})
    proof = gt.prove(solution)
    with ball_precision(100):
        assert abs(proof["m"][-1] - arb("1.400")) < 5e-4
        assert abs(proof["r"][-1] - arb("9.586")) < 5e-4
        assert proof["m"][-1].rad() < 1e-13
        # A (1 + 2 K q) is constant.
        assert proof["A"][-1].overlaps(arb("1.256"))
    with pytest.raises(ProofError, match="derivatives from a pole"):
        gt.prove(solution, derivatives=["K"])

"""Rates: read as they are written, with the values and slopes of the expressions."""

import numpy as np
import pytest
import sympy as sp

from geomtorsion.errors import ExpressionError, StuckError
from geomtorsion.exact import Field
from geomtorsion.ode import ODE, RungeKutta, Stiff, When, solve
from tests.ode.engines import every_engine, needs_heyoka
from tests.rounding import ROUNDED

RATES = {
    "w1": "(I2 - I3)/I1*w2*w3 + m*g*z*n2/I1 - c*w1**3",
    "w2": "(I3 - I1)/I2*w1*w3 - m*g*z*n1/I2 + 1/3*cos(t)**2",
    "w3": "(I1 - I2)/I3*w1*w2/(1 + w1**2)",
    "n1": "n2*w3 - n3*w2",
    "n2": "n3*w1 - n1*w3",
    "n3": "-(n2*w1 - n1*w2)/1",
}
NUMBERS = {"I1": 1.0, "I2": 1.1, "I3": 2.0, "m": 1, "g": 9.81, "z": 0.1, "c": 0.01}
START = [0.1, 0.2, 3, 0, 0.6, 0.8]


def both(**more):
    """The same ODE, of exact elements (multiplied out) and of unexpanded expressions."""
    names = sp.symbols("w1 w2 w3 n1 n2 n3 I1 I2 I3 m g z c t", real=True)
    field = Field(names)
    local = {name.name: name for name in names}
    elements = {name: field.read(sp.sympify(text, locals=local)) for name, text in RATES.items()}
    return [ODE.of(rates, START, parameters=NUMBERS, **more) for rates in (elements, RATES)]


@every_engine
def test_same_numbers(engine):
    """Rates, stop and solution agree."""
    one, two = both(events=[When("3 - t + w1/10")])
    first, second = (solve(made, 6.0, 1e-10, engine) for made in (one, two))
    assert first.outcome == second.outcome == "stopped"
    assert first.times == pytest.approx(second.times, abs=1e-9)
    assert first.states == pytest.approx(second.states, abs=1e-8)


def test_same_jacobian():
    """Derivatives of both forms agree with each other and with differences of the rates."""
    found = []
    place = [0.3, -0.2, 1.1, 0.5, -0.4, 0.77, 1e-12]
    for made in both():
        values = [float(x) for x in made.run_numbers(made.parameters)]
        found.append(made.system.jacobian(place, values))
        rates = made.system.scalar_function
        for k in range(6):
            up, down = ([x + h * (j == k) for j, x in enumerate(place)] for h in (1e-5, -1e-5))
            slope = (np.array(rates(*up, *values)) - np.array(rates(*down, *values))) / 2e-5
            assert found[-1][:, k] == pytest.approx(slope, rel=1e-8, abs=1e-8)
    assert found[1] == pytest.approx(found[0], rel=1e-12, abs=ROUNDED)


FUNCTIONS = (
    "sin(x) + cos(x) + tan(x) + exp(x) + log(x) + sinh(x) + cosh(x) + tanh(x)",
    "sqrt(x) + x**(5/2) + x**(-3/2) + 1/x**3 + cot(x) + sec(x) + csch(x) + 2**x",
    "asin(x) + acos(x) + atan(x) + asinh(x) + acosh(1 + x) + atanh(x) + atan2(x, y)",
    "(x**2 + y**2)**(1/3) + pi*x**5*y**4 - (x - y)**3 + x**y",
)


@pytest.mark.parametrize("text", FUNCTIONS)
def test_functions(text):
    """Every function has the value and the slope of sympy's expression."""
    made = ODE.of({"x": text, "y": 0}, [0.4, 0.9])
    x, y = (sp.Symbol(name, real=True) for name in "xy")
    rate, point = made.rates.expressions["x"], {x: 0.4, y: 0.9}
    values = [float(v) for v in made.run_numbers({})]
    found = made.system.scalar_rates(values)(0.0, np.array([0.4, 0.9]))[0]
    assert found == pytest.approx(float(rate.evalf(subs=point)), rel=1e-13)
    slopes = made.system.jacobian([0.4, 0.9], values)[0]
    exact = [float(rate.diff(s).evalf(subs=point)) for s in (x, y)]
    assert slopes == pytest.approx(exact, rel=1e-12)


@needs_heyoka
@pytest.mark.parametrize("text", FUNCTIONS)
def test_functions_in_series(text):
    """The Taylor engine agrees with Runge-Kutta on every function."""
    slow = ODE.of({"x": f"({text})/200", "y": 0}, [0.4, 0.9])
    one, two = solve(slow, 1.0, 1e-11), solve(slow, 1.0, 1e-11, RungeKutta())
    assert one.engine == "Taylor"
    assert one.states == pytest.approx(two.states, rel=1e-10)


@needs_heyoka
def test_powers_where_the_base_vanishes():
    """Series of powers pass through a zero of the base."""
    made = ODE.of({"x": "1", "y": "x**5*sqrt(1 + x**2)"}, [-1, 0])
    sol = solve(made, 2.0, 1e-10)
    assert sol.engine == "Taylor"
    assert sol["y"][-1] == pytest.approx(0, abs=1e-10)


def test_long_rates_are_not_expanded():
    """A product of sums stays a product: multiplied out it would have a thousand terms."""
    big = "*".join(f"(x{k} + {k + 1}*y + z/{k + 2} + 1)" for k in range(10))
    states = [f"x{k}" for k in range(10)]
    rates = dict.fromkeys([*states, "y"], 0) | {"z": f"({big})/sqrt(1 + z**2)"}
    made = ODE.of(rates, [0.1] * 11 + [0])
    assert len(made.system.rates.python_source()) < 3000


def test_steps_are_refused():
    """A rate with endless steps is refused with its name and a remedy."""
    x = sp.Symbol("x")
    for rate in (sp.floor(x), sp.ceiling(2 * x) * x):
        with pytest.raises(ExpressionError, match="rate of x: .* is not smooth"):
            ODE.of({"x": rate}, [1])


def test_stiff_roots():
    """Implicit engines use the exact derivatives."""
    k = 1e6
    made = ODE.of({"x": "-k*(sqrt(1 + x**2) - sqrt(1 + cos(t)**2))"}, [1.2], parameters={"k": k})
    sol = solve(made, 1.0, 1e-8, Stiff("LSODA"))
    # To first order in 1/k: x = cos t + sin t sqrt(1 + cos^2 t)/(k cos t).
    t = sol.times[-1]
    later = np.cos(t) + np.sin(t) * np.sqrt(1 + np.cos(t) ** 2) / (k * np.cos(t))
    assert sol["x"][-1] == pytest.approx(later, abs=1e-8)
    other = solve(made, 1.0, 1e-5, Stiff())
    assert other["x"] == pytest.approx(sol["x"], abs=1e-5)


def test_hundreds_of_storeys():
    """A tree 400 levels deep is refused; one of 31 levels is not."""
    tree = x = sp.Symbol("x")
    expected = 0.3
    for storey in range(400):
        tree = sp.sin(tree) + x
        expected = np.sin(expected) + 0.3
        if storey == 30:
            made = ODE.of({"x": tree}, [0.3])
            values = [float(v) for v in made.run_numbers({})]
            found = made.system.scalar_rates(values)(0.0, np.array([0.3]))[0]
            assert found == pytest.approx(expected, rel=1e-13)
    with pytest.raises(ExpressionError, match="nested too deeply"):
        ODE.of({"x": tree}, [0.3])


@every_engine
def test_roots_in_rates_end_motions(engine):
    """s = (1 - t)**2 ends at t = 1; the series of s would rise again, unlike sqrt(s)."""
    emptying = ODE.of({"s": "-2*sqrt(s)", "v": "0"}, [1, 1])
    with pytest.raises(StuckError, match="t = 1") as caught:
        solve(emptying, 3.0, engine=engine)
    reached = caught.value.solution
    assert reached["s"] == pytest.approx((1 - reached.times) ** 2, abs=1e-9)
    # A stop before this end ends the motion.
    level = ODE.of({"s": "-2*sqrt(s)"}, [1], events=[When("s - 1/4")])
    found = solve(level, 3.0, engine=engine)
    assert found.outcome == "stopped"
    assert found.times[-1] == pytest.approx(0.5, rel=1e-9)
    # A sum of squares has no guard, and neither has a constant.
    free = ODE.of({"x": "sqrt(1 + x**2)*sqrt(a)"}, [0], parameters={"a": 4})
    assert free.system.guard is None
    assert solve(free, 1.0, engine=engine)["x"][-1] == pytest.approx(np.sinh(2), rel=1e-9)

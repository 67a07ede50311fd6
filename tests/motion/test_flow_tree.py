"""Trees: rates that are not expanded give the same numbers as those read exactly."""

import numpy as np
import pytest
import sympy as sp

from geomtorsion.errors import ExpressionError
from geomtorsion.motion import RungeKutta, Stiff, flow, solve
from geomtorsion.motion.flows import law
from geomtorsion.motion.flows.tree import TreeSystem, is_plain
from geomtorsion.motion.flows.tree_reading import tree_line
from tests.motion.engines import every_engine, needs_heyoka

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


def both(monkeypatch, **more):
    """The same flow, read exactly and kept as trees."""
    made = []
    for plain in (True, False):
        law._system.cache_clear()
        monkeypatch.setattr(law, "is_plain", lambda terms, plain=plain: plain)
        made.append(flow(RATES, START, parameters=NUMBERS, **more))
        assert isinstance(made[-1].system, TreeSystem) is not plain
    law._system.cache_clear()
    return made


@every_engine
def test_same_numbers(engine, monkeypatch):
    """Rates, edge and solution agree."""
    one, two = both(monkeypatch, stop="3 - t + w1/10")
    first, second = (solve(made, 6.0, 1e-10, engine) for made in (one, two))
    assert first.outcome == second.outcome == "stopped"
    assert first.times == pytest.approx(second.times, abs=1e-9)
    assert first.states == pytest.approx(second.states, abs=1e-8)


def test_same_jacobian(monkeypatch):
    """Derivatives carried along agree with derivatives worked out."""
    one, two = both(monkeypatch)
    place = np.array([0.3, -0.2, 1.1, 0.5, -0.4, 0.77, 1e-12])
    values = [float(x) for x in one.numbers_of(one.parameters)]
    first = one.system.scalar_jacobian(values)(0.0, place)
    other = [float(x) for x in two.numbers_of(two.parameters)]
    assert two.system.scalar_jacobian(other)(0.0, place) == pytest.approx(first, rel=1e-12)


FUNCTIONS = (
    "sin(x) + cos(x) + tan(x) + exp(x) + log(x) + sinh(x) + cosh(x) + tanh(x)",
    "sqrt(x) + x**(5/2) + x**(-3/2) + 1/x**3 + cot(x) + sec(x) + csch(x) + 2**x",
    "asin(x) + acos(x) + atan(x) + asinh(x) + acosh(1 + x) + atanh(x) + atan2(x, y)",
    "(x**2 + y**2)**(1/3) + pi*x**5*y**4 - (x - y)**3 + x**y",
)


def as_tree(monkeypatch, rates, start):
    """A flow that is not read exactly."""
    law._system.cache_clear()
    monkeypatch.setattr(law, "is_plain", lambda terms: False)
    made = flow(rates, start)
    law._system.cache_clear()
    return made


@pytest.mark.parametrize("text", FUNCTIONS)
def test_functions(text, monkeypatch):
    """Every function has its value and its slope."""
    made = as_tree(monkeypatch, {"x": text, "y": 0}, [0.4, 0.9])
    assert isinstance(made.system, TreeSystem)
    x, y = (sp.Symbol(name, real=True) for name in "xy")
    rate, point = made.law.rates["x"], {x: 0.4, y: 0.9}
    values = [float(v) for v in made.numbers_of({})]
    found = made.system.scalar_rates(values)(0.0, np.array([0.4, 0.9]))[0]
    assert found == pytest.approx(float(rate.evalf(subs=point)), rel=1e-13)
    slopes = made.system.scalar_jacobian(values)(0.0, np.array([0.4, 0.9]))[0]
    exact = [float(rate.diff(s).evalf(subs=point)) for s in (x, y)]
    assert slopes == pytest.approx(exact, rel=1e-12)


@needs_heyoka
@pytest.mark.parametrize("text", FUNCTIONS)
def test_functions_in_series(text, monkeypatch):
    """The Taylor engine knows them as well."""
    slow = as_tree(monkeypatch, {"x": f"({text})/200", "y": 0}, [0.4, 0.9])
    one, two = solve(slow, 1.0, 1e-11), solve(slow, 1.0, 1e-11, RungeKutta())
    assert one.engine == "Taylor"
    assert one.states == pytest.approx(two.states, rel=1e-10)


@needs_heyoka
def test_powers_where_the_base_vanishes():
    """Series of powers go through zero."""
    made = flow({"x": "1", "y": "x**5*sqrt(1 + x**2)"}, [-1, 0])
    sol = solve(made, 2.0, 1e-10)
    assert sol.engine == "Taylor"
    assert sol["y"][-1] == pytest.approx(0, abs=1e-10)


def test_long_rates_are_not_expanded():
    """A product of sums that has a thousand terms when multiplied out stays a product."""
    big = "*".join(f"(x{k} + {k + 1}*y + z/{k + 2} + 1)" for k in range(10))
    states = [f"x{k}" for k in range(10)]
    rates = dict.fromkeys([*states, "y"], 0) | {"z": f"({big})/sqrt(1 + z**2)"}
    made = flow(rates, [0.1] * 11 + [0])
    assert isinstance(made.system, TreeSystem)
    assert len(made.system.code[0]) < 3000
    assert not is_plain([sp.sqrt(1 + sp.Symbol("x") ** 2)])
    assert is_plain([1 / (1 + sp.Symbol("x") ** 2)])


def test_kinks_are_refused():
    """What is not smooth is named with a remedy."""
    x = sp.Symbol("x")
    for rate in (sp.Abs(x), sp.sqrt(x**2), sp.Max(x, 0) * x):
        with pytest.raises(ExpressionError, match="rate of x: .* is not smooth"):
            flow({"x": rate}, [1])


def test_stiff_tree():
    """Implicit engines use the derivatives that are carried along."""
    k = 1e6
    made = flow({"x": "-k*(sqrt(1 + x**2) - sqrt(1 + cos(t)**2))"}, [1.2], parameters={"k": k})
    assert isinstance(made.system, TreeSystem)
    sol = solve(made, 1.0, 1e-8)
    assert sol.engine.startswith("Stiff")
    # To first order in 1/k: x = cos t + sin t sqrt(1 + cos^2 t)/(k cos t).
    t = sol.times[-1]
    later = np.cos(t) + np.sin(t) * np.sqrt(1 + np.cos(t) ** 2) / (k * np.cos(t))
    assert sol["x"][-1] == pytest.approx(later, abs=1e-8)
    other = solve(made, 1.0, 1e-5, Stiff())
    assert other["x"] == pytest.approx(sol["x"], abs=1e-5)


def test_too_long_to_shorten(monkeypatch):
    """Trees that are not shortened are written part by part, with the same values."""
    texts = {"x": FUNCTIONS[0], "y": FUNCTIONS[1], "z": FUNCTIONS[3]}
    short = as_tree(monkeypatch, texts, [0.4, 0.9, 0.2]).system
    assert short.line is not None
    monkeypatch.setattr("geomtorsion.motion.flows.tree.tree_line", lambda *_: None)
    plain = as_tree(monkeypatch, texts, [0.4, 0.9, 0.2]).system
    place = np.array([0.4, 0.9, 0.2])
    values = [1.0] * len(plain.parameters)
    assert plain.line is None
    found, expected = (system.scalar_rates(values)(0.0, place) for system in (short, plain))
    assert found == pytest.approx(expected, rel=1e-13)


def test_too_deep_to_shorten():
    """A tree of hundreds of storeys is refused, one of some is not."""
    tree = x = sp.Symbol("x")
    for storey in range(400):
        tree = sp.sin(tree) + x
        if storey == 30:
            assert tree_line(["x"], [tree], []) is not None
    assert tree_line(["x"], [tree], []) is None

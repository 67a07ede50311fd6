"""ODE.of: accepted input, how it is read, and when it is compiled again."""

from fractions import Fraction
from types import SimpleNamespace
from typing import Any

import mpmath
import numpy as np
import pytest
import sympy as sp

from geomtorsion.codegen import graph
from geomtorsion.errors import (
    CoordinateError,
    ExpressionError,
)
from geomtorsion.exact import Field
from geomtorsion.ode import ODE, At, RungeKutta, When, solve, solve_many
from geomtorsion.ode.rates import default_groups
from tests.rounding import ROUNDED


def swing(**more):
    """x'' = -k x."""
    options: dict[str, Any] = {
        "parameters": {"k": 4},
        "invariants": {"energy": "v**2 + k*x**2"},
    } | more
    return ODE.of({"x": "v", "v": "-k*x"}, {"x": 1, "v": 0}, **options)


def test_forms_of_input_are_equal():
    """Text, sympy, exact elements and numbers are the same rates; starts by name or in order."""
    x, v, k = sp.symbols("x v k")
    element = Field([x, v, k]).read(-k * x)
    same = [
        ODE.of({"x": "v", "v": "-k*x"}, [1, 0], parameters={"k": 4}),
        ODE.of({"x": v, "v": -k * x}, {"v": 0, "x": 1}, parameters={"k": 4}),
        ODE.of({"x": v, "v": element}, np.array([1.0, 0.0]), parameters={"k": 4.0}),
    ]
    assert len({made.system for made in same}) == 1
    assert all(made.text == "x' = v\nv' = -k*x" for made in same)
    assert same[0].size == 2
    assert same[0].states == ("x", "v")
    assert "\\dot{v} &= - k x" in same[0].latex
    still = solve(ODE.of({"x": 0, "y": 1.5}, [1, 2]), 2.0, engine=RungeKutta())
    assert still.states[-1] == pytest.approx([1, 5], abs=1e-12)


def test_anything_with_rates():
    """An object with rates and invariants, as equations of motion are, makes an ODE."""

    found = SimpleNamespace(rates={"x": "v", "v": "-x"}, invariants={"energy": "x**2 + v**2"})
    sol = solve(ODE.of(found, [1, 0]), 1.0, engine=RungeKutta())
    assert set(sol.drift) == {"energy"}
    assert sol["x"][-1] == pytest.approx(np.cos(1.0), abs=1e-10)


def test_decimals_are_exact():
    """0.1 in text is one tenth; in Python it is the exact value of the float."""
    text, number = ODE.of({"x": "0.1*x - 2.5e-3"}, [1]), ODE.of({"x": 0.1 * sp.Symbol("x")}, [1])
    assert str(text.rates.expressions["x"]) == "x/10 - 1/400"
    assert sorted(text.rates.numbers.exactly([])) == [Fraction(-1, 400), Fraction(1, 10)]
    assert number.rates.numbers.exactly([]) == [Fraction(0.1)]


def test_numbers_are_worked_out_before_the_run():
    """A combination of parameters is one number, exact until it is rounded once."""
    moments = {"I1": 1, "I2": 1, "I3": 1 + 1e-12}
    top = ODE.of(
        {"a": "(I2 - I3)/I1*b*c", "b": "(I3 - I1)/I2*a*c", "c": "(I1 - I2)/I3*a*b"},
        [1, 0, 1],
        parameters=moments,
    )
    numbers = top.run_numbers(top.parameters)
    assert len(numbers) == 3
    assert float(numbers[0]) == -(Fraction(1 + 1e-12) - 1)
    source = top.system.rates.python_source()
    assert "a3" in source
    assert "/" not in source


def test_equal_rates_share_one_system():
    """Other starts, parameters and decimals compile nothing; small integers are compiled in."""
    one = ODE.of({"x": "-9.81*x"}, [1])
    assert one.system is ODE.of({"x": "-1.62*x"}, [2]).system
    assert one.system is one.with_start(start=[3]).system
    assert one.system is not ODE.of({"x": "-2*x"}, [1]).system
    first = swing()
    moved = first.with_start(start={"v": 3}, parameters={"k": 9.5})
    assert moved.start == (1, 3)
    assert moved.parameters == {"k": 9.5}
    assert first.parameters == {"k": 4}
    assert moved.system is first.system


def test_numbers_put_back_give_the_value():
    """Rates with precomputed numbers have the values of the original expressions."""
    x, y, a, b = sp.symbols("x y a b", real=True)
    terms = [
        a * (b * x + 7 * y) / (a - b) + sp.sin(a * x) + x**a,
        sp.sqrt(x**2 + a**2) + sp.Rational(9, 1000) * x + sp.Float("0.3") * b * y,
        x**2.0 * y,
    ]
    point = {x: 0.7, y: -1.3, a: 2.1, b: 0.4}
    made = ODE.of(
        dict(zip(("x", "y", "z"), terms, strict=True)),
        [0.7, -1.3, 0],
        parameters={"a": 2.1, "b": 0.4},
    )
    system = made.system
    assert not {"a", "b"} & set(system.parameters)
    found = system.scalar_function(0.7, -1.3, 0, *map(float, made.run_numbers(made.parameters)))
    for value, term in zip(found, terms, strict=True):
        assert value == pytest.approx(float(term.evalf(subs=point)), rel=ROUNDED)
    assert "**2.0" not in system.rates.python_source()


def test_groups_of_states():
    """Names with trailing numbers, or axes, form groups; norm_groups groups the rest by name."""
    assert default_groups(["Omega1", "Omega2", "m", "x", "z", "vx", "vz"]) == (
        ("Omega1", "Omega2"), ("m",), ("x", "z"), ("vx", "vz"),
    )  # fmt: skip
    made = ODE.of(
        dict.fromkeys("abcd", 0), [1, 0, 0, 0], normalized=["ab"], norm_groups=[("c", "d")]
    )
    assert made.rates.norm_groups == (("a", "b"), ("c", "d"))


def test_graphs_on_every_kind_of_number():
    """One code runs on arrays, fractions and long numbers; sizes add up all terms."""
    x = sp.Symbol("x")
    terms = (x - x**3 / 3, sp.sin(x), sp.Max(x, 2), 1 / sp.sqrt(x), sp.Abs(-x), sp.cot(x))
    made = graph(("x",), terms, factor=False)
    values = made.numpy()(np.array([0.5, 3.0]))
    for value, term in zip(values, terms, strict=True):
        exact = [float(term.subs(x, at)) for at in (0.5, 3)]
        assert np.broadcast_to(value, 2) == pytest.approx(exact, rel=ROUNDED)
    long = made.exactly([Fraction(1, 2)])
    with mpmath.workdps(50):
        assert abs(long[1] - mpmath.sin(mpmath.mpf(1) / 2)) < mpmath.mpf(10) ** -50
    cubic = graph(("x",), (x - x**3 / 3,), factor=False)
    assert cubic.sizes(2.0) == [pytest.approx(2 + 8 / 3)]
    assert cubic.exactly([2]) == [Fraction(-2, 3)]


BAD_RATES = {
    "kk is neither": {"x": "-kk*x"},
    "Did you mean k": {"x": -sp.Symbol("kk") * sp.Symbol("x")},
    "floor is not smooth": {"x": "floor(x)"},
    "or a finite number, got": {"x": float("nan")},
    "expected text, a sympy expression": {"x": None},
    "expressions are not code": {"x": "__import__('os').system('true')"},
    "expected a name of letters": {"x y": 0},
    "at least one state": {},
    "expected one meaning, got": {"k": 0},
}


@pytest.mark.parametrize("message", BAD_RATES)
def test_bad_rates(message):
    """Rates that cannot be read are refused with a message that names the reason."""
    rates = BAD_RATES[message]
    with pytest.raises(ExpressionError, match=message):
        ODE.of(rates, [1] * len(rates), parameters={"k": 1})


def test_values_against_declarations():
    """Values must meet the assumptions of symbols in rates, outputs and events."""
    k, x = sp.Symbol("k", positive=True), sp.Symbol("x")
    said = "k: expected a value that is positive, nonnegative, as declared, got {}"
    rate, other = {"x": -sp.sqrt(k**2) * x}, {"x": "-k*x"}
    element = Field([k, x]).read(-k * x)
    places: list[tuple[Any, dict[str, Any]]] = [
        (rate, {}),
        ({"x": element}, {}),
        (other, {"outputs": {"many": [x, k * x]}}),
        (other, {"invariants": {"I": k * x}}),
        (other, {"events": [When(x + k)]}),
    ]
    for rates, more in places:
        with pytest.raises(CoordinateError, match=said.format(-1)):
            ODE.of(rates, [1], parameters={"k": -1}, **more)
    # Assumptions of a state, or of a symbol without any, do not matter.
    ODE.of(other, [1], parameters={"k": -1})
    ODE.of({"k": k}, [-1])
    decay = ODE.of(rate, [1], parameters={"k": 1})
    with pytest.raises(CoordinateError, match=said.format(-2)):
        decay.with_start(parameters={"k": -2})
    with pytest.raises(CoordinateError, match=said.format(-3)):
        decay.with_start(events=[At(1.0, {"k": -3})])
    with pytest.raises(CoordinateError, match=said.format(-3)):
        ODE.of(rate, [1], parameters={"k": 1}, events=[At(1.0, {"k": -3})])
    with pytest.raises(CoordinateError, match=said.format("-1.5")):
        solve_many(decay, {"k": [1, -1.5, -2]}, 1.0)
    assert solve_many(decay, {"k": [0, 1]}, 1.0)["x"][:, -1] == pytest.approx([1, np.exp(-1)])
    n = sp.Symbol("n", integer=True)
    with pytest.raises(
        CoordinateError, match="n: expected a value that is integer, as declared, got 1.5"
    ):
        solve_many(ODE.of({"x": n}, [0], parameters={"n": 1}), {"n": [1, 1.5, 2]}, 1.0)


def test_symbols_are_names():
    """Symbols of sympy name states, parameters, the time, outputs, changes and groups."""
    x, v, k, tau = sp.symbols("x v k tau")
    made = ODE.of(
        {x: v, v: -k * x},
        {x: 1, v: 0},
        parameters={k: 4},
        invariants={sp.Symbol("energy"): v**2 + k * x**2},
        outputs={sp.Symbol("late"): x + tau},
        time=tau,
        events=[At(2.0, {k: 1})],
        norm_groups=[(x, v)],
    )
    text = ODE.of(
        {"x": "v", "v": "-k*x"},
        {"x": 1, "v": 0},
        parameters={"k": 4},
        invariants={"energy": "v**2 + k*x**2"},
        outputs={"late": "x + tau"},
        time="tau",
        events=[At(2.0, {"k": 1})],
        norm_groups=[("x", "v")],
    )
    one, two = solve(made, 3.0), solve(text, 3.0)
    assert (one.states == two.states).all()
    assert (one["late"] == two["late"]).all()
    moved = made.with_start(start={x: 2}, parameters={k: 9})
    assert (moved.start, moved.parameters) == ((2, 0), {"k": 9})


@pytest.mark.parametrize(
    ("given", "words"),
    [
        (
            ({"t": "v", "v": "-t"}, [1, 0]),
            "t: expected one meaning, got a state and the time. .* time='tau'",
        ),
        (
            ({"tau": "t"}, [1], {"t": 2}),
            "t: expected one meaning, got a parameter and the time. .* time='s'",
        ),
        (
            ({"x": "v", "v": "x"}, [1, 0], {"v": 2}),
            "v: expected one meaning, got a state and a parameter. .* omit it from parameters",
        ),
    ],
)
def test_a_name_of_two_things_names_the_remedy(given, words):
    """The message contains a remedy, and the remedy with time= works."""
    rates, start, *parameters = given
    with pytest.raises(ExpressionError, match=words):
        ODE.of(rates, start, parameters=parameters[0] if parameters else None)
    if "time" in words:
        ODE.of({"t": "v", "v": "-t"}, [1, 0], time="tau")

"""Edges: motions end where functions in their equations or stops end."""

import math

import numpy as np
import pytest
import sympy as sp

from geomtorsion.errors import StuckError
from geomtorsion.ode import ODE, RungeKutta, Taylor, When, solve
from tests.ode.engines import every_engine, needs_heyoka

SWING = {"x": "v", "v": "-x"}
# x = cos(t - 1/2) reaches 1 at t = 1/2 and goes back.
TOUCHES = {"x": math.cos(0.5), "v": math.sin(0.5)}
# |t - 1/2| and the like never fall to zero, but their series beyond t = 1/2 do.
KINKED = [
    "acos(x) + 1/10",
    "sqrt(1 - x**2) + 1/10",
    "sqrt(1 - x) + 1/10",
    "(1 - x**2)**(3/2) + 1/10",
    "(1 - x)**p + 1/10",
    "acosh(2 - x) + 1/10",
    "2 - asin(x)",
]


@every_engine
@pytest.mark.parametrize("stop", KINKED)
def test_a_stop_is_not_followed_beyond_its_end(engine, stop):
    """acos(x) + 1/10 ends at t = 0.5; its series would stop at t = 0.6, where it is 0.2."""
    problem = ODE.of(SWING, TOUCHES, parameters={"p": 0.5}, events=[When(stop)])
    with pytest.raises(StuckError, match=r"t = 0\.(5|4999).*= 0") as caught:
        solve(problem, 5.0, 1e-9, engine=engine)
    found = caught.value.solution
    assert found["x"] == pytest.approx(np.cos(found.times - 0.5), abs=1e-9)


@pytest.mark.parametrize(
    "rate",
    ["acos(x)", "asin(x)", "acosh(2 - x)", "sqrt(1 - x)", "(1 - x)**p", "atanh(x)", "1/acos(x)"],
)
@needs_heyoka
def test_rates_are_not_followed_beyond_their_end(rate):
    """y' = acos(cos(t - 1/2)) = |t - 1/2| ends at t = 0.5, and so do the other functions."""
    problem = ODE.of(SWING | {"y": rate}, TOUCHES | {"y": 0}, parameters={"p": 0.5})
    with pytest.raises(StuckError, match=r"t = 0\.5, at x = 1.*= 0") as caught:
        solve(problem, 2.0, 1e-9, engine=Taylor())
    assert caught.value.solution.times[-1] <= 0.5 + 1e-6


@needs_heyoka
def test_the_tip_of_a_cone():
    """A motion in the potential sqrt(x**2 + y**2) ends at its tip; the series would continue."""
    rates = {"x": "u", "y": "w", "u": "-x/sqrt(x**2+y**2)", "w": "-y/sqrt(x**2+y**2)"}
    problem = ODE.of(rates, {"x": 1, "y": 0, "u": 0, "w": 0})
    with pytest.raises(StuckError, match=r"t = 1\.41421.*sqrt\(x\*\*2 \+ y\*\*2\) = 0"):
        solve(problem, 2.0, engine=Taylor())
    # Around the tip the motion is free; even functions of the root and poles need no guard.
    assert solve(problem.with_start({"w": 0.5}), 2.0, engine=Taylor()).outcome == "done"
    for free in ("cos(sqrt(x**2 + y**2))", "x*(x**2 + y**2)**(-3/2)", "sqrt(1 + x**2)"):
        assert ODE.of({"x": free, "y": 0}, [1, 1]).system.guard is None


@every_engine
@pytest.mark.parametrize(
    ("stop", "outcome"),
    [
        ("sqrt(x)", "stopped"),
        ("acos(1 - x)", "stopped"),
        ("sqrt(x) + x**2", "stopped"),
        ("sqrt(2*x) + 1/10", "stuck"),
        ("acos(1 - x) + 1/1000", "stuck"),
        ("x**p + 1", "stuck"),
    ],
)
def test_a_stop_that_vanishes_where_it_ends_is_a_stop(engine, stop, outcome):
    """x = (1 - t)/2; a stop that is still positive at t = 1 raises an error instead."""
    problem = ODE.of({"x": "-1/2"}, {"x": 0.5}, parameters={"p": 0.5}, events=[When(stop)])
    if outcome == "stopped":
        found = solve(problem, 2.0, 1e-9, engine=engine)
        assert found.outcome == "stopped"
        assert found.times[-1] == pytest.approx(1.0, abs=1e-12)
    else:
        # With accuracies 1e-9 and 1e-10 the series of x**p would reach t = 1.003 and t = 1.00002.
        for accuracy in (1e-6, 1e-9, 1e-10, 1e-12):
            with pytest.raises(StuckError, match="t = 1, at x = (0:|-?[0-9.]+e-1[5-9])"):
                solve(problem, 2.0, accuracy, engine=engine)


@needs_heyoka
def test_a_root_as_stop_in_quadruple_precision():
    """A stop at a root is found in quadruple precision as well."""
    problem = ODE.of({"x": "-1/2"}, {"x": 0.5}, events=[When("sqrt(x)")])
    found = solve(problem, 2.0, 1e-9, engine=Taylor(113))
    assert float(found.times[-1]) == pytest.approx(1.0, abs=1e-12)


def test_whole_exponents_have_no_end():
    """x**q with q = 2 given at run time has a guard, but ends nowhere."""
    problem = ODE.of({"x": "-1", "y": "x**q"}, {"x": 1, "y": 0}, parameters={"q": 2})
    found = solve(problem, 3.0, engine=RungeKutta())
    assert found["y"][-1] == pytest.approx(3.0, rel=1e-9)


def test_observed_kinks_have_no_false_zeros():
    """Zeros of an observed expression are zeros of its values, not of its series."""
    found = solve(ODE.of(SWING, TOUCHES), 5.0, 1e-8)
    # The computed x may pass 1 by its error, where acos(x) has no value.
    inside = f"acos(x*(1 - {10 * found.error!r}))"
    assert len(found.event_times(f"{inside} + 1/10")) == 0
    assert found.event_times(f"{inside} - 1/10") == pytest.approx([0.4, 0.6], abs=1e-8)


def test_each_function_adds_an_edge():
    """Each function adds one edge: the root of the expression that has to stay positive."""
    x, y = sp.symbols("x y", real=True)
    problem = ODE.of({"x": sp.acos(x) + sp.asin(x), "y": sp.log(y) + sp.asin(2)}, [0.1, 1])
    assert [str(edge) for edge in problem.rates.edges] == ["sqrt(1 - x**2)", "sqrt(y)"]

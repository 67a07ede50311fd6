"""Kinks: Abs, sign, Max, Min and Heaviside in rates and conditions are pieces of smooth ones."""

import math

import pytest
import sympy as sp

from geomtorsion.errors import ExpressionError, StuckError
from geomtorsion.ode import ODE, When, solve

t = sp.Symbol("t")
# Rate, and its integral from 0 to 4.
RATES = {
    "abs(t - 1)": 5.0,
    "Abs(t - 1)": 5.0,
    "sign(t - 1)": 2.0,
    "Heaviside(t - 1)": 3.0,
    "max(1, t, 3 - t)": 10.25,
    "Min(t, 2)": 6.0,
    "abs(abs(t - 2) - 1)": 2.0,
    "max(abs(t - 2), 1)": 5.0,
    "min(max(sin(t), -1/2), 1/2)": 1 - math.sqrt(0.75) + math.pi / 3 - (4 - 7 * math.pi / 6) / 2,
    "max(1, 2)*sign(-3)": -8.0,
    "abs(x)": 0.0,
}


@pytest.mark.parametrize("rate", RATES)
def test_integrals(rate):
    """Each rate is integrated across its kinks and jumps, within the reported error."""
    solution = solve(ODE.of({"x": rate}, [0]), 4.0)
    assert abs(solution["x"][-1] - RATES[rate]) <= solution.error
    assert solution.error < 1e-9


def test_expressions_of_sympy():
    """Functions of sympy are read as text is."""
    rate = sp.Max(sp.Abs(t - 2), 1)
    assert solve(ODE.of({"x": rate}, [0]), 4.0)["x"][-1] == pytest.approx(5)


def test_dry_friction():
    """Each half swing loses twice the friction; at rest the motion slides, with the reason."""
    swing = ODE.of({"x": "v", "v": "-x - mu*sign(v)"}, [1, 0], parameters={"mu": 0.1})
    solution = solve(swing, [math.pi, 2 * math.pi], derivatives=["mu"])
    assert solution["x"].tolist() == pytest.approx([-0.8, 0.6], abs=1e-9)
    assert solution["dx_dmu"].tolist() == pytest.approx([2, -4], abs=1e-8)
    with pytest.raises(StuckError, match="slides along v = 0"):
        solve(swing, 20.0)


def test_a_condition_with_a_kink():
    """A stop may contain them as well: |cos t| falls to 1/2 at pi/3."""
    swing = ODE.of({"x": "v", "v": "-x"}, [1, 0], events=[When("abs(x) - 1/2")])
    assert solve(swing, 4.0).times[-1] == pytest.approx(math.pi / 3)


def test_steps_without_end_are_refused():
    """floor has no finite number of pieces."""
    with pytest.raises(ExpressionError, match="rate of x: floor"):
        ODE.of({"x": "floor(t)"}, [0])

"""Error estimates: each of their thresholds, from both sides."""

# pyright: reportIncompatibleMethodOverride=false, reportAssignmentType=false, reportIncompatibleVariableOverride=false

from dataclasses import dataclass, field
from fractions import Fraction

import mpmath
import numpy as np
import pytest

from geomtorsion.errors import AccuracyError
from geomtorsion.ode import ODE, RungeKutta, Taylor, solve
from geomtorsion.ode.error_estimate import AIM, difference
from geomtorsion.ode.roundings import rounding
from geomtorsion.ode.trajectory import integrate
from tests.ode.engines import needs_heyoka

SWING = ODE.of({"x": "v", "v": "-sin(x)"}, [1.0, 0.0])


@dataclass(frozen=True)
class Counting(RungeKutta):
    """Runge-Kutta that records the evaluations of each of its runs."""

    runs: list[int] = field(default_factory=list)

    def run(self, *given, **more):
        """Run and record the number of evaluations."""
        found = super().run(*given, **more)
        self.runs.append(found.evaluations)
        return found


@pytest.mark.parametrize("steps", [1, 100, 10_000])
def test_roundings_add_up_at_random(steps):
    """The estimate for many steps is one to ten times the scatter of a sum of roundings."""
    halves = np.random.default_rng(steps).uniform(-0.5, 0.5, size=(400, steps)) * 2.0**-52
    scatter = halves.sum(axis=1).std()
    assert scatter < rounding(RungeKutta().precision, steps) < 10 * scatter


def test_a_start_is_known_to_about_a_rounding():
    """An angle of 1.4e9 is rounded by 1e-7; the estimate contains the error of this start."""
    angle = Fraction(10**10 + 1, 7)
    with mpmath.workdps(40):
        rate = float(mpmath.cos(mpmath.mpf(angle.numerator) / angle.denominator))
    found = solve(ODE.of({"a": "0", "q": "cos(a)"}, [angle, 0]), 1.0, 1e-3, RungeKutta())
    error = abs(found["q"][-1] / rate - 1)
    assert error > 1e-8
    assert 0.5 * error <= found.error <= 100 * error


def test_an_error_costs_one_more_run_and_roundings_another():
    """A third run is made only where steps may omit as little as roundings."""
    for accuracy, runs in ((1e-3, 2), (1e-4, 2), (1e-8, 3), (1e-10, 3)):
        engine = Counting()
        found = solve(ODE.of({"x": "v", "v": "-x"}, [1.0, 0.0]), 4.0, accuracy, engine)
        assert len(engine.runs) == runs
        assert found.error <= accuracy


def test_where_tolerances_aim(monkeypatch):
    """Tolerances aim at a tenth of the accuracy: more fails more often, far less costs more."""
    costs, tries = [], []
    for factor in (20, 1, 1e-4):
        monkeypatch.setattr("geomtorsion.ode.error_estimate.AIM", AIM * factor)
        engine = Counting()
        for accuracy in (1e-4, 1e-6, 1e-8):
            solve(SWING, 10.0, accuracy, engine)
        costs.append(sum(engine.runs))
        tries.append(len(engine.runs))
    assert tries[0] > tries[1]
    assert costs[1] < min(costs[0], costs[2])


@needs_heyoka
def test_cancelling_rates_are_taken_for_noise():
    """A rate whose terms of size one cancel is taken for noise; a rate of 1e-12 is not."""
    rates, start = {"p": "q", "q": "-p"}, {"p": 1, "q": 0, "rest": 0}
    found = solve(ODE.of(rates | {"rest": "p**2 + q**2 - 1"}, start), 10.0, 1e-6, Taylor())
    assert np.abs(found["rest"]).max() < 1e-13
    small = ODE.of(rates | {"rest": "p**2 + q**2 - (1 - 1e-12)"}, start)
    with pytest.raises(AccuracyError, match="Taylor gets to"):
        solve(small, 10.0, 1e-6, Taylor())


def test_what_begins_at_zero_with_rates_that_cancel():
    """A push that balances a spring: the rounding left of the first rates sets no step size."""
    pushed = ODE.of({"x": "v", "v": "-x + 1e-6*cos(t/2)"}, [1e-6, 0])
    found = solve(pushed, 100.0, 1e-9, RungeKutta())
    t = found.times
    exact = 1e-6 * (np.cos(t) + (np.cos(t / 2) - np.cos(t)) / 0.75)
    error = np.abs(found["x"] - exact).max() / exact.max()
    assert 1e-14 < error <= 1e-9
    assert 0.5 * error <= found.error <= 1e-9


def test_a_finer_run_that_ends_early_gives_no_difference():
    """Without a finer run for its last part, the difference of the answer is infinite."""
    stage, times = SWING.first_stage(53, 0.0), np.linspace(0, 1, 5)
    whole = integrate(stage, times, 1e-6, RungeKutta())
    part = integrate(stage, times[:3], 1e-8, RungeKutta())
    assert difference(SWING, whole, part) == np.inf
    assert 0 < difference(SWING, part, whole) < 1e-5

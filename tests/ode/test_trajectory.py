"""Trajectory: how many stages a motion may have, and when it is stuck."""

from dataclasses import replace

import numpy as np
import pytest

from geomtorsion.ode import ODE, RungeKutta, Stiff, When, solve
from geomtorsion.ode.system import Run
from geomtorsion.ode.trajectory import Event, close_times, integrate


def followed(runs, outcome):
    """A motion whose stages last for given times; each one is followed by another."""
    first = ODE.of({"x": "1"}, [1]).first_stage(53, 0.0)

    def stage(begin, _):
        """A stage that begins at this time and ends at its guard."""
        return replace(first, begin=begin, events=(Event(None, stage),))

    def runner(number, one, times):
        """A run that lasts for the given time, or to the end."""
        if number >= len(runs):
            return Run(times, np.ones((len(times), 1)), times[-1], np.ones(1), "done", 1, 1, 0, 0)
        end = one.begin + runs[number]
        return Run(times[:1], np.ones((1, 1)), end, np.ones(1), outcome, 1, 1, 0, 0)

    times = np.array([0.0, 1.0])
    return integrate(stage(0.0, first.start), times, 1e-6, RungeKutta(), runner=runner)


def test_how_many_events_a_motion_may_meet():
    """Ten thousand changes of stage are followed; one more ends the motion as stopped."""
    found = followed([1e-5] * 10_001, "edge")
    assert found.outcome == "stopped"
    assert len(found.segments) == 10_001


@pytest.mark.parametrize(("moved", "count"), [(0.7e-9, 3), (1.3e-9, 6)])
def test_stages_without_progress_are_stuck(moved, count):
    """Four stages that each advance by less than a billionth of the time end a motion as stuck."""
    found = followed([0.5, *[moved] * 4], "stuck")
    assert len(found.segments) == count
    assert (found.outcome == "done") == (count == 6)


def test_how_closely_steps_are_looked_at():
    """Eight samples in each step show a guard that falls and rises again."""
    dip = When("1 - 2*exp(-((t - 20.035)/0.008)**2)")
    swing = ODE.of({"x": "v", "v": "-x"}, [1, 0], events=[dip])
    found = solve(swing, 40.0, 1e-6, Stiff("LSODA"))
    assert found.outcome == "stopped"
    assert found.times[-1] == pytest.approx(20.035 - 0.008 * np.sqrt(np.log(2)), abs=1e-7)
    run = Run(np.zeros(1), np.zeros((1, 2)), 1.0, np.zeros(2), "done", 100, 150, 0, 0)
    assert len(close_times(0.0, 1.0, run)) == 801

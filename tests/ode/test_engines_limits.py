"""Limits of engines: where a motion ends, and numbers that decide about speed, not about results."""

import numpy as np
import pytest

from geomtorsion.errors import StuckError
from geomtorsion.ode import ODE, RungeKutta, Taylor, solve
from geomtorsion.ode.engines.protocol import WorkLimitError
from tests.ode.engines import needs_heyoka

SWING = ODE.of({"x": "v", "v": "-x"}, [1, 0])


class Crawling:
    """An integrator that gets on by the same time in all of its steps."""

    def __init__(self, length):
        """length: of two thousand steps."""
        self.length = length
        self.time = 0.0
        self.state = np.ones(1)

    def propagate_grid(self, grid, max_steps):
        """So many steps, none of which comes to a time that is asked for."""
        self.time += self.length
        result = type("Result", (), {"name": "step_limit"})()
        return result, 0, 0, max_steps, None, np.ones((1, 1))


@pytest.mark.parametrize(("length", "stuck"), [(0.7e-9, True), (1.4e-9, False)])
def test_what_moves_by_a_billionth_goes_on(length, stuck):
    """And what moves less in two thousand steps stands still."""
    call = Crawling(length), np.array([0.0, 1.0]), True, None, None
    if stuck:
        assert Taylor(max_steps=9_000)._propagated(*call)[1] == "stuck"
    else:
        with pytest.raises(WorkLimitError, match="more than 9000 steps"):
            Taylor(max_steps=9_000)._propagated(*call)


@needs_heyoka
@pytest.mark.parametrize("start", [0.0, 1e-9])
@pytest.mark.parametrize("accuracy", [1e-2, 1e-9])
def test_motions_from_rest_end_where_they_end(start, accuracy):
    """The tangent has its pole at a right angle, whether it begins at zero or not."""
    with pytest.raises(StuckError, match=r"at t = 1\.5708"):
        solve(ODE.of({"x": "1 + x**2"}, [start]), 3.0, accuracy, Taylor())


@pytest.mark.parametrize("least", [1e-13, 1e-15, 1e-17])
def test_steps_are_shortened_where_tolerances_end(least, monkeypatch):
    """Wherever that begins, the finest tolerances of Runge-Kutta leave rounding alone."""
    monkeypatch.setattr("geomtorsion.ode.engines.stepwise.LEAST", least)
    system, times = SWING.system, np.array([0.0, 8.0])
    coarse, fine = (RungeKutta().run(system, [1.0, 0.0], [], times, x) for x in (1e-12, 1e-17))
    assert np.abs(coarse.last - [np.cos(8), -np.sin(8)]).max() > 1e-13
    assert np.abs(fine.last - [np.cos(8), -np.sin(8)]).max() < 2e-15
    assert fine.steps / coarse.steps == pytest.approx(1e5 ** (1 / 8), rel=0.1)

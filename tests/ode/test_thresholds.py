"""Thresholds: what happens on either side of each constant of the solvers that decides."""

import numpy as np
import pytest

from geomtorsion.curves import log_map
from geomtorsion.errors import GeomtorsionError
from geomtorsion.geometry import levi_civita
from geomtorsion.ode import ODE, RungeKutta, Stiff, Taylor, solve
from geomtorsion.ode.roots import crossings
from geomtorsion.spaces import load
from tests.ode.engines import needs_heyoka

DECAY = ODE.of({"x": "-k*(x - cos(t))"}, [0], parameters={"k": 1})


@needs_heyoka
@pytest.mark.parametrize(("rate", "implicit"), [(2e4, False), (5e4, True)])
def test_how_fast_a_decay_makes_a_motion_stiff(rate, implicit):
    """A decay 30,000 times within the motion is left to an implicit engine, a slower one is not."""
    found = solve(DECAY.with_start(parameters={"k": rate}), 1.0, 1e-6)
    assert found.engine.startswith("Stiff") == implicit


@pytest.mark.parametrize(("reach", "seen"), [(0.25, True), (0.4, False)])
def test_how_near_to_zero_a_valley_is_looked_into(reach, seen):
    """The parabola through three places has its lowest point at this part of the middle one."""
    times = np.array([-1.0, 0.0, 1.0])
    bend = 8 * (1 - reach)

    def function(t):
        """A parabola, 1 at -1 and at 0, with a hole at its lowest point that no place shows."""
        return 1 + bend / 2 * (t + t**2) - np.exp(-(((t + 0.5) / 0.1) ** 2))

    assert len(crossings(function, times, function(times))) == (2 if seen else 0)


def test_series_have_an_order_of_at_least_six():
    """Accuracies that a lower order would give start alike; finer ones do not."""
    assert Taylor().first(1e-1) == Taylor().first(1e-3) == Taylor().first(5e-5)
    assert Taylor().first(1e-6) < Taylor().first(5e-5)


@pytest.mark.parametrize("engine", [RungeKutta(), Stiff()])
def test_finer_runs_are_two_orders_finer(engine):
    """Down to where only rounding is left."""
    assert engine.finer(1e-6) == pytest.approx(1e-8)
    assert engine.finer(2 * engine.finest) == engine.finest
    assert engine.finer(engine.finest) is None


def test_the_error_is_twice_the_difference():
    """Where no rounding counts: of exp(t) the true error is half of what is told."""
    grow = ODE.of({"x": "x"}, [1.0])
    found = solve(grow, np.linspace(0, 3, 40), 1e-6, RungeKutta())
    exact = np.exp(found.times)
    away = np.abs(found["x"] - exact).max() / exact.max()
    assert found.error / away == pytest.approx(2, rel=0.1)


@pytest.mark.parametrize(("short", "found"), [(1e-5, True), (5e-7, False)])
def test_how_near_to_a_conjugate_point_geodesics_are_found(short, found):
    """At the antipode of a sphere the end depends on one direction only; so near to it, no more."""
    start, end = [np.pi / 2, 0.0], [np.pi / 2, np.pi - short]
    call = {"parameters": {"R": 1}, "guess": [0.0, np.pi - 3 * short]}
    connection = levi_civita(load("s2").frame)
    if found:
        vector = log_map(connection, start, end, **call).vector
        assert np.abs(vector) == pytest.approx([0, np.pi - short], abs=1e-6)
    else:
        with pytest.raises(GeomtorsionError):
            log_map(connection, start, end, **call)

"""Limits of engines: where a motion ends, and numbers that affect only speed."""

from collections import OrderedDict

import numpy as np
import pytest

from geomtorsion.errors import StuckError
from geomtorsion.ode import ODE, RungeKutta, Taylor, solve
from geomtorsion.ode.engines import stepper
from geomtorsion.ode.engines.taylor import _limit_disk_cache
from geomtorsion.ode.system import STEPS_AT_ONCE, WorkLimitError
from tests.ode.engines import needs_heyoka
from tests.rounding import ROUNDED

SWING = ODE.of({"x": "v", "v": "-x"}, [1, 0])


class Crawling:
    """An integrator that advances by the same time in each call."""

    def __init__(self, length):
        """length: time covered by two thousand steps."""
        self.length = length
        self.time = 0.0
        self.state = np.ones(1)
        self.last_h = length

    def propagate_grid(self, grid, max_steps):
        """Take max_steps steps, none of which reaches a requested time."""
        self.time += self.length
        result = type("Result", (), {"name": "step_limit"})()
        return result, 0, 0, max_steps, None, np.ones((1, 1))


@pytest.mark.parametrize(("length", "stuck"), [(0.7e-9, True), (1.4e-9, False)])
def test_slow_motions_continue(length, stuck):
    """A run that moves less than a billionth of its time in two thousand steps is stuck."""
    call = Crawling(length), np.array([0.0, 1.0]), None, None
    if stuck:
        found = Taylor(max_steps=9_000)._propagated(*call)
        assert found[1] == "stuck"
    else:
        with pytest.raises(WorkLimitError, match="more than 9000 steps"):
            Taylor(max_steps=9_000)._propagated(*call)


@needs_heyoka
@pytest.mark.parametrize("start", [0.0, 1e-9])
@pytest.mark.parametrize("accuracy", [1e-2, 1e-9])
def test_motions_from_rest_end_where_they_end(start, accuracy):
    """The tangent has its pole at pi/2, whether the state begins at zero or not."""
    with pytest.raises(StuckError, match=r"at t = 1\.5708"):
        solve(ODE.of({"x": "1 + x**2"}, [start]), 3.0, accuracy, Taylor())


@needs_heyoka
def test_a_pole_behind_many_steps_is_found():
    """A swing takes more than five blocks of STEPS_AT_ONCE steps before the pole of tan."""
    hasty = ODE.of({"x": "50*v", "v": "-50*x", "y": "(1 + y**2)/100"}, [1, 0, 0])
    with pytest.raises(StuckError, match=r"at t = 157\.08") as caught:
        solve(hasty, 200.0, 1e-9, Taylor())
    assert caught.value.solution.cost.steps > 5 * STEPS_AT_ONCE


@pytest.mark.parametrize("least", [1e-13, 1e-15, 1e-17])
def test_steps_are_shortened_where_tolerances_end(least, monkeypatch):
    """Below LEAST the steps are shortened, so that the finest tolerance leaves only rounding."""
    monkeypatch.setattr("geomtorsion.ode.engines.stepwise.LEAST", least)
    system, times = SWING.system, np.array([0.0, 8.0])
    coarse, fine = (RungeKutta().run(system, [1.0, 0.0], [], times, x) for x in (1e-12, 1e-17))
    assert np.abs(np.asarray(coarse.last) - [np.cos(8), -np.sin(8)]).max() > 1e-13
    assert np.abs(np.asarray(fine.last) - [np.cos(8), -np.sin(8)]).max() < ROUNDED
    assert fine.steps / coarse.steps == pytest.approx(1e5 ** (1 / 8), rel=0.1)


@needs_heyoka
def test_the_clock_hides_no_small_states():
    """States of size 1e-6 keep their digits beside a clock state of a thousand."""
    pushed = ODE.of({"x": "v", "v": "-x + 1e-6*cos(t/2)"}, [1e-6, 0])
    found = solve(pushed, [1000.0], 1e-8, Taylor())
    exact = 1e-6 * (np.cos(1000) + (np.cos(500) - np.cos(1000)) / 0.75)
    assert abs(found["x"][-1] - exact) <= ROUNDED


def test_which_numbers_are_compiled_in():
    """Integers up to 64 over small powers of two are compiled in; other numbers are parameters."""
    made = {k: ODE.of({"x": f"-{k}*x"}, [1]) for k in ("2", "3", "64", "65", "67", "3/64", "3/128")}
    shared = [name for name, ode in made.items() if ode.system is made["65"].system]
    assert shared == ["65", "67", "3/128"]
    for k in ("64", "65"):
        found = solve(made[k], 0.1, 1e-12, RungeKutta())
        assert found["x"] == pytest.approx(np.exp(-int(k) * found.times), abs=1e-12)


def test_speed_changes_no_bit(monkeypatch):
    """Dense output at few or many times, and rates inlined or called, give the same states."""
    pendulum = ODE.of({"x": "v", "v": "-sin(x)"}, [1, 0])
    system, times = pendulum.system, np.linspace(0.0, 9.0, 50)
    found = RungeKutta().run(system, [1.0, 0.0], [], times, 1e-9, dense=True)
    assert found.dense is not None
    assert found.dense(times[:4]) == pytest.approx(found.dense(times)[:4], rel=ROUNDED)
    monkeypatch.setattr("geomtorsion.ode.engines.stepper.LONGEST_SOURCE", 0)
    stepper._made.cache_clear()
    called = RungeKutta().run(system, [1.0, 0.0], [], times, 1e-9)
    stepper._made.cache_clear()
    assert (called.states == found.states).all()


@needs_heyoka
def test_cached_and_unrolled_code_change_no_result(monkeypatch):
    """With one integrator kept at a time it is compiled again; code not unrolled agrees."""
    laws = [ODE.of({"x": "v", "v": f"-{k}*sin(x)"}, [1, 0]) for k in (2, 3)]
    first = [solve(law, 5.0, 1e-9, Taylor()) for law in laws]
    monkeypatch.setattr("geomtorsion.ode.engines.taylor._kept", OrderedDict())
    monkeypatch.setattr("geomtorsion.ode.engines.taylor.KEPT", 1)
    for law, before in [*zip(laws, first, strict=True)] * 2:
        again = solve(law, 5.0, 1e-9, Taylor())
        assert again.cost.compile_seconds > 0
        assert (again.states == before.states).all()
    monkeypatch.setattr("geomtorsion.ode.engines.taylor.LONGEST_UNROLLED", 0)
    again = solve(laws[0], 5.0, 1e-9, Taylor())
    assert again.cost.compile_seconds > 0
    assert again.states == pytest.approx(first[0].states, abs=1e-9)


@pytest.mark.parametrize("before", [2**20, 2**34])
def test_how_much_heyoka_leaves_on_the_disk(before):
    """A limit above a quarter of a gigabyte is lowered to it; a smaller one stays."""

    class State:
        """heyoka's settings of the disk cache."""

        limit = before
        get_diskcache_enabled = staticmethod(lambda: True)

        def get_diskcache_limit(self):
            """Limit in bytes."""
            return self.limit

        def set_diskcache_limit(self, value):
            """Set the limit in bytes."""
            self.limit = value

    state = State()
    _limit_disk_cache.__wrapped__(state)
    assert state.limit == min(before, 2**28)


@pytest.mark.parametrize("rate", ["1e200*x", "1e300*x"])
def test_infinite_rates_are_stuck(rate):
    """A motion whose rates have an infinite size is stuck at the start."""
    with pytest.raises(StuckError, match=r"cannot continue at t = 0.* too small"):
        solve(ODE.of({"x": rate}, [2]), [0, 1.0], 1e-9, RungeKutta())

"""At and When: parameters that change at exact times, jumps, stops."""

from fractions import Fraction
from typing import Any

import numpy as np
import pytest

from geomtorsion.errors import StartError, StuckError
from geomtorsion.ode import ODE, At, RungeKutta, Stiff, Taylor, When, solve
from geomtorsion.ode.engines.taylor import _quieten, heyoka
from tests.ode.engines import ENGINES, every_engine, needs_heyoka
from tests.rounding import ROUNDED


def fall(**more):
    """A stone from 20 m under g = 10: down after 2 s."""
    options: dict[str, Any] = {"parameters": {"g": 10}} | more
    return ODE.of({"z": "v", "v": "-g"}, {"z": 20, "v": 0}, **options)


@every_engine
def test_thrust_at_exact_times(engine):
    """A push of 1/7 s in a run of 1000 s changes the velocity by exactly a/7."""
    begin, length = 1 / 3, 1 / 7
    push = ODE.of(
        {"x": "v", "v": "a"},
        [0, 0],
        parameters={"a": 0},
        outputs={"force": "a"},
        events=[At(begin, {"a": 3}), At(begin + length, {"a": 0})],
    )
    sol = solve(push, 1000.0, 1e-12, engine)
    assert sol["v"][-1] == pytest.approx(3 * length, rel=ROUNDED)
    assert sol["x"][-1] == pytest.approx(3 * length * (1000 - begin - length / 2), rel=1e-12)
    inside = sol.at([begin - 1e-9, begin, begin + length / 2, begin + length, 1.0])
    assert inside["force"].tolist() == [0, 3, 3, 0, 0]
    assert inside["v"] == pytest.approx([0, 0, 3 * length / 2, 3 * length, 3 * length], abs=1e-12)


@every_engine
def test_milliseconds_in_a_long_run(engine):
    """A millisecond in a run of hours is not stepped over."""
    kick = ODE.of({"v": "-v/10000 + a"}, [0], parameters={"a": 0},
                events=[At(5000, {"a": 1e3}), At(5000.001, {"a": 0})])  # fmt: skip
    sol = solve(kick, 10000.0, 1e-10, engine)
    length = float(Fraction(5000.001) - 5000)
    after = 1e3 * 1e4 * -np.expm1(-length / 1e4) * np.exp(-(10000 - 5000.001) / 1e4)
    assert sol["v"][-1] == pytest.approx(after, rel=1e-9)


@every_engine
def test_jumps(engine):
    """A state jumps; the sample at the time of an event is the one after it."""
    hop = ODE.of(
        {"x": "v", "v": 0}, [0, 1], events=[At(1, {"v": -2}), At(1.0, {"x": 5}), At(0, {"x": 3})]
    )
    assert hop.events == (At(0.0, {"x": 3}), At(1.0, {"v": -2, "x": 5}))
    sol = solve(hop, [0.0, 0.5, 1.0, 2.0], 1e-12, engine)
    assert sol["x"] == pytest.approx([3, 3.5, 5, 3], abs=1e-12)
    assert sol["v"].tolist() == pytest.approx([1, 1, -2, -2])


def test_drift_between_events():
    """A push may change an invariant; the drift counts only changes between events."""
    kicked = ODE.of({"x": "v", "v": "-x"}, [1, 0], invariants={"energy": "x**2 + v**2"},
                  events=[At(2, {"v": 3})])  # fmt: skip
    assert solve(kicked, 5.0, 1e-10, RungeKutta()).drift["energy"] < 1e-9


def test_events_after_the_end_do_nothing():
    """Events after the end are kept for longer runs."""
    late = fall(events=[At(3, {"g": 0})])
    assert solve(late, 1.0, engine=RungeKutta())["v"][-1] == pytest.approx(-10)
    assert solve(late.with_start(events=[]), 4.0, engine=RungeKutta())["v"][-1] == pytest.approx(
        -40
    )
    assert solve(late, 4.0, engine=RungeKutta())["v"][-1] == pytest.approx(-30)


@every_engine
def test_stop(engine):
    """The motion ends where the condition falls through zero, and the sample there is exact."""
    sol = solve(fall(events=[When("z")], outputs={"speed": "-v"}), 5.0, 1e-11, engine)
    assert sol.outcome == "stopped"
    assert sol.complete
    assert sol.times[-1] == pytest.approx(2.0, abs=1e-11)
    assert sol["z"][-1] == pytest.approx(0.0, abs=1e-9)
    assert sol["speed"][-1] == pytest.approx(20, abs=1e-9)
    assert (np.diff(sol.times) > 0).all()
    assert float(sol.at(sol.times[-1])["v"]) == pytest.approx(-20, abs=1e-9)
    assert "where it stops" in str(sol)
    up = solve(fall(events=[When("z")]).with_start(start={"z": 0, "v": 30}), 20.0, 1e-11, engine)
    assert up.times[-1] == pytest.approx(6.0, abs=1e-10)


@pytest.mark.parametrize("engine", [*ENGINES, Stiff()], ids=lambda engine: engine.name)
def test_stop_into_the_past(engine):
    """A stop falls along the direction of the motion, also where times run backwards."""
    rising = ODE.of({"x": "1"}, {"x": 1}, events=[When("x")])
    found = solve(rising, -3.0, engine=engine)
    assert found.outcome == "stopped"
    assert found.times[-1] == pytest.approx(-1.0, abs=1e-12)
    # Forwards this stop never falls; a stop that falls forwards does not fall backwards.
    assert solve(rising, 3.0, engine=engine).outcome == "done"
    falling = ODE.of({"x": "-1"}, {"x": 1}, events=[When("x")])
    assert solve(falling, -3.0, engine=engine).outcome == "done"


@every_engine
def test_stop_with_time_and_after_an_event(engine):
    """The condition may contain the time; a jump beyond it ends the motion there."""
    assert solve(fall(events=[When("3/2 - t")]), 5.0, 1e-11, engine).times[-1] == pytest.approx(
        1.5, abs=1e-11
    )
    jump = solve(fall(events=[When("z"), At(1, {"z": -1})]), 5.0, 1e-11, engine)
    assert jump.outcome == "stopped"
    assert jump.times[-1] == 1.0
    assert jump["z"][-1] == pytest.approx(15, abs=1e-9)
    shorter = solve(fall(events=[When("z"), At(1, {"g": 1000})]), 5.0, 1e-11, engine)
    # From z = 15, v = -10: 15 = 10 s + 500 s^2.
    later = (-10 + np.sqrt(100 + 4 * 500 * 15)) / 1000
    assert shorter.times[-1] == pytest.approx(1 + later, abs=1e-10)


def test_stop_at_the_start():
    """A motion that begins beyond its stop is refused."""
    with pytest.raises(StartError, match="expected stop above zero at the start, got z = -1"):
        solve(fall(events=[When("z")]).with_start(start={"z": -1}), 1.0)


@every_engine
def test_grazing(engine):
    """A path that passes 1e-8 above zero continues; one that passes 1e-8 below it stops."""
    arc = {"x": 1, "z": "v", "v": 2}
    over = solve(ODE.of(arc, [0, 1 + 1e-8, -2], events=[When("z")]), 3.0, 1e-10, engine)
    assert over.outcome == "done"
    under = solve(ODE.of(arc, [0, 1 - 1e-8, -2], events=[When("z")]), 3.0, 1e-10, engine)
    # z = (t - 1)^2 - 1e-8.
    assert under.outcome == "stopped"
    assert under.times[-1] == pytest.approx(1 - 1e-4, abs=1e-9)


@every_engine
def test_a_stop_whose_series_have_no_value(engine):
    """A root ends within a step: its series is not finite there, which heyoka skips."""
    found = solve(ODE.of({"x": "-1"}, [1], events=[When("sqrt(x)")]), 3.0, 1e-9, engine)
    assert found.outcome == "stopped"
    assert found.times[-1] == pytest.approx(1.0, rel=1e-12)


@every_engine
def test_a_stop_that_overflows(engine, capfd):
    """A stop that overflows ends the motion, by an error or as stopped, without output."""
    problem = ODE.of({"x": "1"}, [0], events=[When("(2 - x)*exp(1000*x)")])
    try:
        found = solve(problem, 3.0, 1e-9, engine)
    except StuckError as error:
        found = error.solution
    assert found.times[-1] <= 0.72
    assert capfd.readouterr() == ("", "")


@needs_heyoka
def test_no_step_at_all():
    """A stop that is not smooth at the start raises our own error at once."""
    problem = ODE.of({"x": "1"}, [0], events=[When("sqrt(x) + 1")])
    with pytest.raises(StuckError, match="t = 0"):
        solve(problem, 3.0, 1e-9, Taylor())


@needs_heyoka
def test_heyoka_logs_only_errors(monkeypatch):
    """heyoka's logger is set to errors only, once."""
    said = []
    monkeypatch.setattr(heyoka(), "set_logger_level_error", lambda: said.append("error"))
    _quieten.cache_clear()
    heyoka()
    heyoka()
    assert said == ["error"]


@pytest.mark.parametrize("engine", [*ENGINES, Stiff(), Stiff("LSODA")], ids=lambda x: x.name)
@pytest.mark.parametrize(
    ("stop", "end"),
    [("1 - x", 1.0), ("2 - x", 2.0), ("sqrt(2 - x) - 1", 1.0), ("sqrt(3 - x)", 3.0)],
)
def test_the_time_of_a_stop_is_within_its_error(engine, stop, end):
    """With x' = 1 the time of the stop is its place: the guard's rounding moves neither."""
    solution = solve(ODE.of({"x": "1"}, [0], events=[When(stop)]), 5, engine=engine)
    assert solution.outcome == "stopped"
    assert abs(solution.times[-1] - end) <= solution.error * end
    assert abs(solution["x"][-1] - end) <= solution.error * end

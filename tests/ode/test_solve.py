"""solve: the accuracy of the result, engines, times, and the report of a solution."""

import math
import sys
from functools import cache

import mpmath
import numpy as np
import pytest

from geomtorsion.curves import autoparallel, distance_apart, geodesic
from geomtorsion.errors import (
    AccuracyError,
    ArgumentError,
    ChartEdgeError,
    LimitError,
    StuckError,
    TimeError,
    UnknownNameError,
)
from geomtorsion.geometry import cartan, levi_civita
from geomtorsion.geometry.connections import blend
from geomtorsion.ode import ODE, At, RungeKutta, Stiff, Taylor, solve, solve_many
from geomtorsion.ode.engines.taylor import is_available
from geomtorsion.prices import truth_of
from geomtorsion.spaces import load
from tests.chosen import one_in
from tests.ode.engines import every_engine, needs_heyoka


def problems():
    """One of each kind: group, kinetic metric, sphere, black hole, partial torsion."""
    so3, kerr, polar = load("so3").frame, load("kerr").frame, load("flat_polar").frame
    half = blend(levi_civita(polar), cartan(polar))
    return {
        "so3": autoparallel(cartan(so3), [0.3, 1.0, 0.2], [0.1, 0.5, -0.2]),
        "top": geodesic(so3, [0.3, 1.0, 0.2], [0.1, 0.5, -0.2], metric=[1.1, 2.2, 3.3]),
        "angles": geodesic(so3, [0.3, 1.0, 0.2], [0.1, 0.5, -0.2]).with_charts("so3"),
        "kerr": geodesic(
            kerr,
            [0, 8.0, 1.4, 0],
            frame_velocity=[1.2, 0.05, 0.2, 0.6],
            parameters={"M": 1, "a": 0.6},
        ),
        "blend": autoparallel(half, [1.0, 0.2], frame_velocity=[0.3, 0.8]),
    }


@cache
def truth(name, times):
    """The best known solution of a problem, computed once for all engines and accuracies."""
    return truth_of(problems()[name], np.array(times))


@every_engine
@pytest.mark.parametrize(("name", "accuracy"), one_in(2, list(problems()), [1e-6, 1e-9, 1e-12]))
def test_error_and_its_estimate(engine, name, accuracy):
    """The true error is below the accuracy; the estimate is between 0.1 and 100 times it."""
    problem = problems()[name]
    sol = solve(problem, 20.0, accuracy, engine)
    true = truth(name, tuple(sol.times.tolist())).error(sol)
    # Without quadruple precision the truth itself is known to about 1e-13.
    floor = 1e-15 if is_available() else 3e-13
    assert true <= accuracy
    assert sol.error <= accuracy
    assert sol.error >= 0.1 * true or true < floor
    assert sol.error <= 100 * true or sol.error < 1e-15 or true < floor


@every_engine
def test_drift_is_no_larger_than_the_error(engine):
    """Known invariants are named and change by less than the accuracy."""
    sol = solve(problems()["kerr"], 50.0, 1e-10, engine)
    assert set(sol.drift) == {"norm", "momentum of t", "momentum of phi"}
    assert max(sol.drift.values()) < 1e-10
    top = solve(problems()["top"], 50.0, 1e-10, engine)
    assert set(top.drift) == {"energy", "angular momentum squared", "unit"}
    assert max(top.drift.values()) < 1e-9


@needs_heyoka
@pytest.mark.parametrize(("accuracy", "engine"), [(1e-16, "Taylor(64)"), (1e-25, "Taylor(113)")])
def test_more_digits_than_doubles_have(accuracy, engine):
    """An accuracy beyond doubles is reached with long double or quadruple precision."""
    sol = solve(problems()["top"], 5.0, accuracy)
    assert sol.error <= accuracy
    assert sol.engine == engine or accuracy == 1e-16


@needs_heyoka
def test_quadruple_agrees_with_mpmath():
    """25 digits of a rotation around one axis agree with mpmath's own sine."""
    problem = autoparallel(cartan(load("so3").frame), [0, 1, 0], frame_velocity=[0, 1, 0])
    sol = solve(problem, [0.5], 1e-25)
    with mpmath.workdps(34):
        exact = mpmath.sin(mpmath.mpf(3) / 4)
        found = mpmath.mpf(str(sol.in_chart("quaternion")[-1][2]))
        assert abs(found - exact) < mpmath.mpf(10) ** -25


@every_engine
def test_times(engine):
    """Requested times are returned, forwards or backwards; dense output agrees in between."""
    problem = problems()["so3"]
    times = [0.5, 1.0, 7.0]
    sol = solve(problem, times, 1e-10, engine)
    assert sol.times.tolist() == times
    assert sol.coordinates.shape == sol.velocity.shape == sol.frame_velocity.shape == (3, 3)
    again = solve(problem, 7.0, 1e-10, engine)
    moment = again.at(np.array([7.0, 0.5, 1.0]))
    assert moment.coordinates == pytest.approx(sol.coordinates[[2, 0, 1]], abs=1e-9)
    back = solve(problem, -3.0, 1e-10, engine)
    there = problem.with_start(start=back.coordinates[-1], frame_velocity=back.frame_velocity[-1])
    home = solve(there, 3.0, 1e-10, engine).coordinates[-1]
    assert home == pytest.approx(np.array(problem.start), abs=1e-9)
    assert solve(problem, 0.0, engine=engine).coordinates == pytest.approx(
        np.array([[0.3, 1.0, 0.2]])
    )


@pytest.mark.parametrize(
    ("t", "message"),
    [
        ([1.0, 1.0], "expected different times, got 1 at"),
        ([2.0, 1.0], "expected sorted times"),
        ([-1.0, 1.0], "separately"),
        ([1.0, float("nan")], "finite"),
        (float("inf"), "finite"),
        ([], "shape"),
        ("soon", "number"),
    ],
)
def test_bad_times(t, message):
    """Each bad list of times is refused with its reason."""
    with pytest.raises(TimeError, match=message):
        solve(problems()["so3"], t)


@every_engine
def test_distance_apart(engine):
    """On r3xso3 an autoparallel and a geodesic part like t squared."""
    frame = load("r3xso3").frame
    start, velocity = [0.3, 1.0, 0.2, 0, 0, 0], [0.1, 0.5, -0.2, 1.0, 0, 0]
    screw = solve(autoparallel(cartan(frame), start, velocity), 1.0, engine=engine)
    flight = solve(geodesic(frame, start, velocity), 1.0, engine=engine)
    gaps = distance_apart(screw, flight)
    assert gaps[0] == 0
    assert gaps[32] / gaps[16] == pytest.approx(4, rel=0.1)
    with pytest.raises(TimeError, match="same time"):
        distance_apart(flight, solve(geodesic(frame, start, velocity), 0.5, engine=engine))


@every_engine
def test_single_chart_stops_cleanly(engine):
    """A loxodrome ends at the pole, with position, reason and partial solution."""
    problem = autoparallel(
        cartan(load("s2").frame), [1.0, 0.0], frame_velocity=[-1, 0.5], parameters={"R": 1}
    )
    with pytest.raises(ChartEdgeError, match=r"stops at t = 1.*theta = ") as caught:
        solve(problem, 2.0, 1e-8, engine)
    sol = caught.value.solution
    assert not sol.complete
    assert 0.9 < sol.times[-1] <= 1.0
    assert sol.coordinates[-1, 0] == pytest.approx(1 - sol.times[-1], abs=1e-7)


def test_stiff_engine_agrees():
    """Radau and LSODA give the same motion as the default engine."""
    problem = problems()["blend"]
    one = solve(problem, 3.0, 1e-7, Stiff()).coordinates
    assert one == pytest.approx(solve(problem, 3.0, 1e-10).coordinates, abs=1e-6)
    two = solve(problem, 3.0, 1e-6, Stiff("LSODA")).coordinates
    assert two == pytest.approx(one, abs=1e-5)


def test_the_reason_of_the_choice_is_reported():
    """The result names the chosen engine and the reason."""
    sol = solve(problems()["so3"], 1.0)
    assert ("heyoka is" in sol.reason) == (sol.engine in ("Taylor", "RungeKutta"))
    assert solve(problems()["so3"], 1.0, engine=RungeKutta()).reason == "as requested"
    assert "error below" in str(sol)


def test_columns():
    """Coordinates and velocities are columns by name."""
    sol = solve(problems()["so3"], 1.0)
    assert sol["phi2"][0] == pytest.approx(1.0)
    assert sol["u1"][0] == pytest.approx(sol.frame_velocity[0, 0])
    with pytest.raises(UnknownNameError, match="phi9"):
        sol["phi9"]


@needs_heyoka
def test_kept_integrators_are_compiled_once():
    """The second solve compiles nothing, and neither does another start."""
    problem = problems()["top"]
    solve(problem, 5.0, 1e-9, Taylor())
    again = solve(problem.with_start(frame_velocity=[1, 0.2, 0.1]), 5.0, 1e-9, Taylor())
    assert again.cost.compile_seconds == 0


@needs_heyoka
def test_all_digits_reach_the_user():
    """Coordinates, velocities and dense output keep 30 digits, also through the quaternion."""
    problem = geodesic(load("so3").frame, [0.3, 1.0, 0.2], frame_velocity=[0, 0.75, 0.5])
    sol = solve(problem, [1.0, 2.0], 1e-28)
    again = solve(problem, 2.0, 1e-26, Taylor(160))
    with mpmath.workprec(200):
        one, two = sol.coordinates[-1], again.at(2.0).coordinates
        for x, y in zip(one, two, strict=True):
            assert abs(mpmath.mpf(str(x)) - mpmath.mpf(str(y))) < mpmath.mpf(10) ** -26
    top = problems()["top"]
    fine, finer = solve(top, 2.0, 1e-25), solve(top, 2.0, 1e-30, Taylor(140))
    with mpmath.workprec(200):
        for t in (0.3, 2.0):
            one, two = fine.at(t).frame_velocity, finer.at(t).frame_velocity
            for x, y in zip(one, two, strict=True):
                assert abs(mpmath.mpf(str(x)) - mpmath.mpf(str(y))) < mpmath.mpf(10) ** -24


@needs_heyoka
def test_changes_of_charts_keep_all_digits():
    """s2 over the pole and into the other chart keeps 25 digits."""
    problem = geodesic(load("s2").frame, [1.0, 0.5], [-1.0, 0.25], parameters={"R": 1})
    sol = solve(problem, 3.0, 1e-25, Taylor(113))
    other = solve(problem.with_charts("s2_x", "s2"), 3.0, 1e-25, Taylor(160))
    assert set(sol.charts) == set(other.charts) == {"s2", "s2_x"}
    one, two = sol.trajectory.segments[-1], other.trajectory.segments[-1]
    assert one.label == two.label
    with mpmath.workprec(200):
        for x, y in zip(one.states[-1], two.states[-1], strict=True):
            assert abs(mpmath.mpf(str(x)) - mpmath.mpf(str(y))) < mpmath.mpf(10) ** -24


def test_a_missing_engine_is_reported(monkeypatch):
    """An accuracy that needs heyoka is refused without it, with a hint to install it."""
    monkeypatch.setitem(sys.modules, "heyoka", None)
    with pytest.raises(
        AccuracyError, match="no available engine gives two runs to compare. Install"
    ):
        solve(ODE.of({"x": "-x"}, [1]), 1.0, 1e-14)


def test_a_missing_comparison_is_reported(monkeypatch):
    """Without two runs to compare, the error names no number, and never "inf"."""
    module = sys.modules["geomtorsion.ode.solve"]
    real = module.verified

    def incomparable(*arguments, **options):
        return real(*arguments, **options)._replace(error=math.inf)

    monkeypatch.setattr(module, "verified", incomparable)
    with pytest.raises(AccuracyError, match="gives no two runs to compare") as caught:
        solve(ODE.of({"x": "-x"}, [1]), 1.0, engine=RungeKutta())
    assert "inf" not in str(caught.value)


@needs_heyoka
@pytest.mark.parametrize("engine", [None, RungeKutta()], ids=["default", "RungeKutta"])
def test_stiff_equations_are_refused_at_once(engine, blocks):
    """A stiff motion with too many steps left is refused early; an implicit engine solves it."""
    k = 1e9
    decay = ODE.of({"x": "-k*(x - cos(t))"}, [0], parameters={"k": k})
    kinetics = ODE.of(
        {"a": "-a/25 + 1e4*b*c", "b": "a/25 - 1e4*b*c - 3e7*b**2", "c": "3e7*b**2"}, [1, 0, 0]
    )
    for problem, end in ((decay, 1.0), (kinetics, 1e11)):
        with pytest.raises(LimitError, match=r"stiff at t = .*Use engine=Stiff\(\)\."):
            solve(problem, end, 1e-6, engine)
    assert len(blocks) <= 4
    found = solve(decay, 1.0, 1e-6, Stiff())
    assert found["x"][-1] == pytest.approx(np.cos(1.0) + np.sin(1.0) / k, abs=1e-6)


@needs_heyoka
@pytest.mark.parametrize(
    ("eccentricity", "end"), [(0.8, 2000.0), pytest.param(0.6, 1e4, marks=pytest.mark.slow)]
)
def test_a_long_conservative_motion_is_not_taken_for_stiff(eccentricity, end, blocks):
    """An orbit approaches some neighbours as fast as it leaves others: it is not stiff."""
    near = 1 - eccentricity
    orbit = ODE.of(
        {"x": "u", "y": "v", "u": "-x/(x*x + y*y)**(3/2)", "v": "-y/(x*x + y*y)**(3/2)"},
        {"x": near, "y": 0, "u": 0, "v": math.sqrt((1 + eccentricity) / near)},
    )
    found = solve(orbit, end, 1e-7)
    assert found.engine == "Taylor"
    # At most a hundred steps a turn, and ten runs: two attempts with their finer runs, and those
    # that are changed on the way.
    assert found.cost.steps <= 100 * end / math.tau
    assert len(blocks) <= 10 * math.ceil(found.cost.steps / 2000)


@needs_heyoka
@pytest.mark.parametrize("accuracy", [1e-3, 1e-4, 1e-5])
def test_stiff_steps_that_blow_up_are_called_stiff(accuracy):
    """Steps of a low order blow up at once; the reason is stiffness, not a singularity."""
    kinetics = ODE.of(
        {"a": "-a/25 + 1e4*b*c", "b": "a/25 - 1e4*b*c - 3e7*b**2", "c": "3e7*b**2"}, [1, 0, 0]
    )
    with pytest.raises(LimitError, match=r"stiff at t = .*Use engine=Stiff\(\)\."):
        solve(kinetics, 1e8, accuracy)


def test_hasattr_knows_what_a_motion_has():
    """An ODE has states and no coordinates, single and in an ensemble."""
    decay = ODE.of({"x": "-x"}, [1])
    for solution in (solve(decay, 1.0), solve(decay, 1.0).at(0.5), solve_many(decay, [[1]], 1.0)):
        assert hasattr(solution, "states")
        assert not hasattr(solution, "coordinates")


def test_progress_shows_a_bar(capsys):
    """True shows a bar, False nothing; anything else but a function is refused."""
    decay = ODE.of({"x": "-x"}, [1])
    solve(decay, 1.0, progress=True)
    assert "100 %" in capsys.readouterr().err
    solve(decay, 1.0, progress=False)
    assert capsys.readouterr().err == ""
    with pytest.raises(ArgumentError, match="progress: expected a function of the finished"):
        solve(decay, 1.0, progress=3)  # pyright: ignore[reportArgumentType]


def test_robertsons_problem():
    """Eleven powers of ten of time agree with values from the literature."""
    kinetics = ODE.of(
        {"a": "-a/25 + 1e4*b*c", "b": "a/25 - 1e4*b*c - 3e7*b**2", "c": "3e7*b**2"}, [1, 0, 0]
    )
    for end, exact in (
        (40.0, [0.7158270687193, 9.185534764557e-06, 0.2841637457458]),
        (1e11, [2.0833401500e-08, 8.3333607700e-14, 0.99999997916651]),
    ):
        found = solve(kinetics, end, 1e-6, Stiff())
        sizes = np.abs(found.states).max(axis=0)
        away = np.abs(found.states[-1] - exact)
        assert (away <= 1e-6 * sizes).all()
        assert (away <= found.error * sizes + 1e-8 * np.array(exact)).all()
        assert found.states[-1] == pytest.approx(exact, rel=2e-7)


def test_a_tiny_state_behind_a_switch():
    """A velocity of 1e-16 sets no scale of its own beside an acceleration of one."""
    swing = ODE.of(
        {"y": "v", "v": "-s*y"}, [1, 0], parameters={"s": 1}, events=[At(1, {"v": 1e-16, "s": 2})]
    )
    for engine in (None, RungeKutta()):
        found = solve(swing, 2.0, engine=engine)
        assert found["y"][-1] == pytest.approx(np.cos(1) * np.cos(np.sqrt(2)), abs=1e-10)
    pushed = ODE.of(
        {"y": "v", "v": "-pi**2*y + s"}, [1, 0], parameters={"s": 1},
        events=[At(k, {"s": (-1) ** k}) for k in range(1, 8)],
    )  # fmt: skip
    found = solve(pushed, 8.0, 1e-10, RungeKutta())
    # At whole times the velocity is zero, and y turns around s/pi**2 for each s in turn.
    height = 1.0
    for k in range(8):
        height = 2 * (1 if k == 0 else (-1) ** k) / np.pi**2 - height
    assert found["y"][-1] == pytest.approx(height, abs=1e-10)


@every_engine
def test_rates_that_end_where_the_motion_does(engine):
    """(1 - t)**(1/3) to t = 1, and roots that begin at 0, by an engine that can do it."""
    end = solve(ODE.of({"x": "(1 - t)**(1/3)"}, [0]), 1.0, 1e-8, engine)
    assert end["x"][-1] == pytest.approx(0.75, abs=1e-8)
    for rate, value in (("sqrt(t)", 2 / 3), ("t**(3/2)", 0.4)):
        found = solve(ODE.of({"x": rate}, [0]), 1.0, 1e-8)
        assert found.engine == "RungeKutta"
        assert found["x"][-1] == pytest.approx(value, abs=1e-8)
        assert abs(found["x"][-1] - value) <= found.error
    with pytest.raises(StuckError, match="t = 1"):
        solve(ODE.of({"x": "1/(1 - t)"}, [0]), 2.0, 1e-8)

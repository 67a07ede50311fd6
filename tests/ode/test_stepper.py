"""stepper: the generated DOP853 takes the steps of scipy's DOP853 and ends at the same time."""

import math

import numpy as np
import pytest
from scipy.integrate import DOP853

from geomtorsion.curves import geodesic
from geomtorsion.errors import LimitError, StuckError
from geomtorsion.geometry import levi_civita
from geomtorsion.ode import ODE, RungeKutta, solve
from geomtorsion.ode.engines.stepper import Steps
from geomtorsion.ode.engines.stepwise import Pace, Stepwise, limited
from geomtorsion.spaces import load
from tests.chosen import one_in
from tests.rounding import ROUNDED

MOST = 10**7


def posed(name):
    """A system with its start and the values of its parameters."""
    if name == "top":
        problem = geodesic(
            load("so3").frame, [0.3, 1.0, 0.2], frame_velocity=[0.9, 0.4, 0.7], metric=[1.1, 2.2, 3]
        )
    elif name == "angles":
        problem = geodesic(
            load("so3").frame, [0.3, 1.0, 0.2], frame_velocity=[0.9, 0.4, 0.7], metric=[1.1, 2.2, 3]
        ).with_charts("so3")
    else:
        problem = geodesic(
            levi_civita(load("kerr").frame),
            [0, 8.0, 1.4, 0],
            frame_velocity=[1.2, 0.05, 0.2, 0.6],
            parameters={"M": 1, "a": 0.6},
        )
    stage = problem.first_stage(53, 0.0)
    # Kerr's momenta are parameters of its own system; the chart's equations have the guard.
    system = stage.system if name == "kerr" else problem.equations(stage.label).system
    return system, stage.start, stage.parameters


@pytest.mark.parametrize(
    ("name", "tolerance", "t"),
    one_in(2, ["top", "angles", "kerr"], [1e-5, 1e-9, 1e-13], [20.0, -20.0]),
)
def test_the_steps_agree_with_scipy(name, tolerance, t):
    """Steps and evaluations are as many as scipy's, and states equal up to rounding."""
    system, start, values = posed(name)
    times = np.linspace(0.0, t, 33)
    one = Stepwise("generated", MOST).run(system.unguarded, start, values, times, tolerance)
    two = Stepwise("DOP853", MOST).run(system.unguarded, start, values, times, tolerance)
    assert one.outcome == two.outcome == "done"
    # scipy also counts the evaluations of the first step and of dense output.
    assert 12 * one.steps <= one.evaluations <= two.evaluations
    assert two.evaluations <= one.evaluations + 3 * 33 + 4
    assert one.states == pytest.approx(two.states, rel=1e-9, abs=1e-11)
    assert one.last == pytest.approx(one.states[-1], rel=ROUNDED)


SUDDEN = [("10000/(1 + 1000*(t - 3)**2)", 1e-3), ("exp(-25*(t - 8)**2)", 1.0)]


@pytest.mark.parametrize(("rate", "start"), SUDDEN, ids=["steps grow", "steps shrink"])
def test_how_fast_steps_grow_and_shrink(rate, start):
    """Steps grow tenfold or shrink to a fifth at most, with a safety factor, as in scipy."""
    law = ODE.of({"x": rate}, [start])
    system, begin = law.system, [start, 0.0]
    values = [float(x) for x in law.run_numbers({})]
    ours = Steps(system, values, begin, (0.0, 10.0), 1e-8, [1.0, 1.0], limited(math.inf), MOST)
    rates = system.scalar_rates(values)
    theirs = DOP853(rates, 0.0, np.array(begin), 10.0, rtol=1e-8, atol=1e-8)
    while ours.time != 10.0:
        assert ours.advance() is not None
        theirs.step()
        assert ours.time == pytest.approx(theirs.t, rel=1e-4)


def test_edges_stop_where_scipy_stops():
    """The time at which an edge is crossed agrees with scipy to rounding."""
    system, start, values = posed("angles")
    times = np.linspace(0.0, 40.0, 9)
    one = Stepwise("generated", MOST).run(system, start, values, times, 1e-10)
    two = Stepwise("DOP853", MOST).run(system, start, values, times, 1e-10)
    assert one.outcome == two.outcome == "edge"
    assert one.reached == pytest.approx(two.reached, abs=1e-12)
    assert one.last == pytest.approx(two.last, abs=1e-11)
    assert len(one.times) == len(two.times)


@pytest.mark.parametrize("t", [3.0, -3.0])
def test_dense_output(t):
    """Dense output between samples agrees with the exponential, forwards and backwards."""
    system = ODE.of({"x": "-x", "y": "2*y"}, [1, 1]).system
    times = np.array([0.0, t])
    run = Stepwise("generated", MOST).run(system, [1.0, 1.0], [], times, 1e-12, dense=True)
    assert run.dense is not None
    between = np.linspace(0.0, t, 101)
    exact = np.stack([np.exp(-between), np.exp(2 * between)], axis=1)
    assert run.dense(between) == pytest.approx(exact, rel=1e-9, abs=1e-11)


def test_errors_fall_with_the_eighth_power():
    """With steps of a fixed length the measured order is eight."""
    system = ODE.of({"x": "y", "y": "-x"}, [1, 0]).system
    errors = []
    for count in (4, 8, 16):
        even = Pace(np.linspace(0.0, 8.0, count + 1).tolist(), 1.0, 1.0)
        walk = Steps(system, [], [1.0, 0.0], (0.0, 8.0), 10.0, [1.0, 1.0], even, MOST)
        while walk.time != 8.0:
            # Every step has the largest allowed length.
            walk._size = 8 / count
            assert walk.advance() is not None
        errors.append(math.hypot(walk.state[0] - math.cos(8), walk.state[1] + math.sin(8)))
    assert math.log2(errors[0] / errors[1]) == pytest.approx(8, abs=1.0)
    assert math.log2(errors[1] / errors[2]) == pytest.approx(8, abs=0.6)


def test_where_rates_end():
    """A singularity ends the run as stuck, with its time; too many evaluations are an error."""
    blowing = ODE.of({"x": "x**2"}, [1]).system
    run = Stepwise("generated", MOST).run(blowing, [1.0], [], np.array([0.0, 0.5, 2.0]), 1e-9)
    assert run.outcome == "stuck"
    assert run.reached == pytest.approx(1.0, abs=1e-6)
    assert run.times.tolist() == [0.0, 0.5]
    assert run.states[1, 0] == pytest.approx(2.0, rel=1e-7)
    fast = ODE.of({"x": "1000*y", "y": "-1000*x"}, [1, 0])
    with pytest.raises(LimitError, match="more than 30000 evaluations"):
        Stepwise("generated", 30_000).run(fast.system, [1.0, 0.0], fast.run_numbers({}),
            np.array([0.0, 1e3]), 1e-9,
        )  # fmt: skip


def test_large_systems_are_left_to_scipy():
    """A system of thirty decays goes to scipy, with the same answer."""
    names = [f"x{k}" for k in range(30)]
    rates = {name: f"-{k + 1}*{name}/30" for k, name in enumerate(names)}
    row = ODE.of(rates, [1] * 30)
    run = RungeKutta().run(row.system, [1.0] * 30, row.run_numbers({}), np.array([0.0, 1.0]), 1e-10)
    assert run.states[-1] == pytest.approx(np.exp(-(np.arange(30) + 1) / 30), rel=1e-9)


@pytest.mark.parametrize(("rate", "start"), [("x**2", 1), ("-1/x", 1), ("1/(1-t)", 0)])
def test_a_motion_up_to_a_pole_names_the_reason(rate, start):
    """The error states why no step is possible, not only where."""
    with pytest.raises(StuckError, match="the steps became too small"):
        solve(ODE.of({"x": rate}, [start]), 2.0, 1e-6, RungeKutta())

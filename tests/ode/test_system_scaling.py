"""Scaling: a motion in lengths and times of any size equals the motion in units of one."""

import pickle

import numpy as np
import pytest
import sympy as sp

from geomtorsion.curves import geodesic, holonomy
from geomtorsion.errors import ChartEdgeError, LimitError, StuckError, TimeError
from geomtorsion.geometry import Frame, levi_civita
from geomtorsion.ode import ODE, RungeKutta, Stiff, Taylor, When, solve, solve_many
from geomtorsion.ode.engines.taylor import is_available
from geomtorsion.ode.system import units_of
from geomtorsion.spaces import load
from tests.ode.engines import every_engine, needs_heyoka
from tests.rounding import ROUNDED

R, PHI = sp.symbols("r phi", positive=True)
POLAR = Frame([R, PHI], [[1, 0], [0, R]], name="polar")
SIZES = [1e-30, 1e-15, 1.0, 1e15, 1e30]
ENGINES = [RungeKutta(), Stiff(), Stiff("LSODA"), *([Taylor()] if is_available() else [])]
all_engines = pytest.mark.parametrize("engine", ENGINES, ids=lambda engine: engine.name)


SCALES = [(1e-30, 1.0), (1e-15, 1e30), (1.0, 1e-30), (1e15, 1e-15), (1e30, 1e30)]


@all_engines
@pytest.mark.parametrize(("length", "time"), SCALES)
def test_a_straight_line_in_polar_coordinates(engine, length, time):
    """Lengths and angles side by side, at any scale of lengths and of times."""
    problem = geodesic(POLAR, [length, 0.3], [0.3 * length / time, 0.2 / time])
    found = solve(problem, 2 * time, 1e-9, engine)
    r, phi = found.coordinates.T / np.array([[length], [1.0]])
    t = found.times / time
    assert np.hypot(1 + 0.3 * t, 0.2 * t) == pytest.approx(r, rel=1e-9)
    assert 0.3 + np.arctan2(0.2 * t, 1 + 0.3 * t) == pytest.approx(phi, rel=1e-9)
    middle = found.at(0.7 * time)
    assert float(middle["r"]) / length == pytest.approx(np.hypot(1.21, 0.14), rel=1e-8)


@needs_heyoka
@pytest.mark.parametrize("length", SIZES)
def test_twelve_digits_at_every_length(length):
    """The reported error holds at every length and is below 1e-12."""
    found = solve(geodesic(POLAR, [length, 0.3], [0.3 * length, 0.2]), 2.0, 1e-12)
    r, phi = found.coordinates[-1] / [length, 1.0]
    assert found.error <= 1e-12
    assert abs(r / np.hypot(1.6, 0.4) - 1) <= found.error
    assert abs(phi - 0.3 - np.arctan2(0.4, 1.6)) <= 2 * found.error


@needs_heyoka
@pytest.mark.parametrize("precision", [64, 113, 200])
@pytest.mark.parametrize("length", [1e-30, 1e30])
def test_engines_of_more_digits(precision, length):
    """Numbers of more than 53 bits are also scaled without loss."""
    found = solve(
        geodesic(POLAR, [length, 0.3], [0.3 * length, 0.2]), 2.0, 1e-17, Taylor(precision)
    )
    assert found.error <= 1e-17
    assert float(found["r"][-1]) / length == pytest.approx(np.hypot(1.6, 0.4), rel=ROUNDED)


@all_engines
@pytest.mark.parametrize(("length", "time"), SCALES)
def test_a_swing_that_is_pushed(engine, length, time):
    """x'' = -rate**2 x + push cos(2 rate t), with a clock, from rest at zero, at any scale."""
    rate = 1 / time
    swing = ODE.of(
        {"x": "v", "v": "-w**2*x + push*cos(2*w*t)"}, [0, 0],
        parameters={"w": rate, "push": 3 * length * rate**2}, outputs={"part": "x/push*w**2"},
    )  # fmt: skip
    found = solve(swing, 5 / rate, 1e-8, engine)
    wanted = np.cos(5.0) - np.cos(10.0)
    assert found["x"][-1] / length == pytest.approx(wanted, abs=3e-8)
    assert found["part"][-1] == pytest.approx(wanted / 3, abs=1e-8)


@all_engines
@pytest.mark.parametrize("length", [1e-30, 1e30])
def test_a_stone_that_hits_the_ground(engine, length):
    """The times of the stop and of the highest point are right at any scale."""
    fall = ODE.of(
        {"z": "v", "v": "-g"}, [length, length], parameters={"g": 2 * length}, events=[When("z")]
    )
    found = solve(fall, 10.0, 1e-9, engine)
    assert found.outcome == "stopped"
    assert found.times[-1] == pytest.approx((1 + np.sqrt(5)) / 2, rel=1e-9)
    assert found.event_times("v") == pytest.approx([0.5], rel=1e-8)


@every_engine
def test_members_of_different_sizes_in_one_batch(engine):
    """Each member has its own units: lengths from 1e-30 to 1e30 in one batch."""
    sizes = np.array(SIZES)
    many = solve_many(
        geodesic(POLAR, [1.0, 0.3], [0.3, 0.2]), np.column_stack((sizes, np.full(5, 0.3))),
        [1.0, 2.0], 1e-9, engine, velocities=np.column_stack((0.3 * sizes, np.full(5, 0.2))),
    )  # fmt: skip
    assert many.finished.all()
    assert (many.errors <= 1e-9).all()
    for k, t in enumerate((1.0, 2.0)):
        assert many["r"][:, k] / sizes == pytest.approx(np.hypot(1 + 0.3 * t, 0.2 * t), rel=1e-8)
        assert many["phi"][:, k] == pytest.approx(0.3 + np.arctan2(0.2 * t, 1 + 0.3 * t), rel=1e-8)
    swing = ODE.of({"x": "v", "v": "-w**2*x + sin(t*w)*w**2"}, [1, 0], parameters={"w": 1})
    many = solve_many(
        swing, {"w": np.array([1e-9, 1.0]), "v": np.array([1e-9, 1.0])}, 3.0, 1e-9, engine
    )
    w = np.array([1e-9, 1.0])
    wanted = np.cos(3 * w) + np.sin(3 * w) + (np.sin(3 * w) - 3 * w * np.cos(3 * w)) / 2
    assert many["x"][:, -1] == pytest.approx(wanted, rel=1e-8)


def test_only_values_far_from_one_are_scaled():
    """Only values far from one are scaled: states, which may be zero, and times that matter."""
    swing = ODE.of({"x": "v", "v": "-x"}, [1, 0]).system
    assert units_of(swing, [2.0**20, 0.0], [], 1.0) is None
    assert units_of(swing, [0.0, 0.0], [], 1.0) is None
    # A long time does not matter where the motion itself is quick.
    assert units_of(swing, [1.0, 0.0], [], 1e9) is None
    found = units_of(swing, [2.0**21, 0.0], [], 1.0)
    assert found is not None
    assert found.sizes.tolist() == [2.0**21, 2.0**21]
    assert found.time == 1.0
    assert units_of(swing, [1.0, 0.0], [], 1e-9) is not None


LIMITED = [RungeKutta(max_evaluations=20_000), Stiff("LSODA", max_evaluations=20_000)]
LIMITED += [Taylor(max_steps=2_100)] if is_available() else []


def reached(problem, t, engine, name="t"):
    """The time that the error names."""
    with pytest.raises(LimitError, match="the solver needs more than .*; it reached") as caught:
        solve(problem, t, 1e-9, engine=engine)
    # The message survives the way to another process.
    assert str(pickle.loads(pickle.dumps(caught.value))) == str(caught.value)
    text = str(caught.value).split(f"it reached {name} = ")[1]
    return float(text.split()[0].rstrip("."))


@pytest.mark.parametrize("engine", LIMITED, ids=lambda engine: engine.name)
def test_scaled_runs(engine):
    """x'' = -k^2 x reaches the same k t with the same work, though the run has scaled units."""
    made = [ODE.of({"x": "v", "v": f"-{k}**2*x"}, [1, 0], time="s") for k in ("1", "(10**15)")]
    slow, fast = reached(made[0], 1e5, engine, "s"), reached(made[1], 1e-10, engine, "s")
    assert fast == pytest.approx(slow * 1e-15, rel=0.3)


@pytest.mark.parametrize("engine", LIMITED, ids=lambda engine: engine.name)
def test_curves_of_many_turns(engine):
    """At a thousand times the speed, a thousandth of the curve parameter is reached."""
    so3 = load("so3").frame
    slow = geodesic(so3, [0.3, 1.0, 0.2], [0.1, 0.5, -0.2])
    fast = geodesic(so3, [0.3, 1.0, 0.2], [100, 500, -200])
    one, two = reached(slow, 1e6, engine), reached(fast, 1e3, engine)
    assert two == pytest.approx(one / 1000, rel=0.3)


def test_the_time_is_called_as_it_is():
    """Errors of equations in s, and of paths in s, name s."""
    ending = ODE.of({"x": "-sqrt(x)"}, [1], time="s")
    with pytest.raises(StuckError, match="at s = 2, "):
        solve(ending, 5.0)
    swing = solve(ODE.of({"x": "v", "v": "-x"}, [1, 0], time="s"), 2.0)
    assert "to s = 2" in str(swing)
    with pytest.raises(TimeError, match="expected s from 0 to 2, .* got 3"):
        swing.at(3.0)
    s, x, y = sp.symbols("s x y")
    bar = levi_civita(Frame([x, y], [[1, 0], [0, 1 / sp.sqrt(1 - x)]]))
    with pytest.raises(ChartEdgeError, match=r"chart at s = 0\.5 \([^()]*(\([^()]*\))?[^()]*\)\."):
        holonomy(bar, [2 * s, s], 1.0)

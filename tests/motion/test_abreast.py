"""Runs side by side: the error that the lanes tell holds; where they cannot tell they say so."""

from __future__ import annotations

from fractions import Fraction

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from geomtorsion.errors import ChartEdgeError
from geomtorsion.motion import RungeKutta, Solution, Taylor, flow, geodesic, solve
from geomtorsion.motion.beside import solved_beside
from geomtorsion.motion.engines.abreast import LANES, run_abreast
from geomtorsion.motion.flows import beside as flow_beside
from geomtorsion.motion.journey import travel
from geomtorsion.motion.solving import learned
from geomtorsion.spaces import load

pytest.importorskip("heyoka")
GRID = np.linspace(0.0, 20.0, 65)


def top(spin, metric):
    """A top on the three-sphere."""
    weights = [Fraction(x) for x in metric]
    return geodesic(load("s3").frame, (0.7, 0.2, 0.3), frame_velocity=spin, metric=weights)


def truth(problem, solution):
    """Error against quadruple precision, block by block."""
    times = np.asarray(solution.times) * problem.speed
    ours, exact = (
        np.concatenate([segment.states for segment in journey.segments]).astype(float)
        for journey in (solution.journey, travel(problem, Taylor(113), 2.0**-116, times))
    )
    return max(
        float(np.abs(ours[:, block] - exact[:, block]).max() / np.abs(exact[:, block]).max())
        for block in map(list, solution.journey.segments[0].equations.system.blocks)
    )


@pytest.fixture
def told(monkeypatch):
    """What was told side by side, answer by answer; None where it could not be."""
    from geomtorsion.motion import solving
    from geomtorsion.motion.flows import solving as flow_solving

    found = []
    for module, function in ((solving, solved_beside), (flow_solving, flow_beside.solved_beside)):

        def noted(*args, function=function):
            found.append(function(*args))
            return found[-1]

        monkeypatch.setattr(module, "solved_beside", noted)
    return found


@pytest.mark.parametrize("accuracy", [1e-5, 1e-8, 1e-11])
@pytest.mark.parametrize("away", [1e-1, 2e-4, 1e-6])
def test_rounding_on_the_way_is_seen(away, accuracy, told):
    """Near the axis of the middle moment each turn over amplifies what was rounded on the way;
    a start that is moved shows less than half of it."""
    problem = top([0.5, away, 0.8 * away], (Fraction(3, 2), 1, 2))
    solution = solve(problem, 150.0, accuracy)
    error = truth(problem, solution)
    assert error <= accuracy
    assert solution.error >= 0.1 * error
    if solution.engine == "Taylor":
        assert solution.error <= 100 * max(error, 1e-15)
    assert told[0] is not None


@settings(max_examples=40, deadline=None)
@given(
    st.lists(st.floats(-2, 2), min_size=9, max_size=9),
    st.lists(st.floats(-3, 3), min_size=3, max_size=3).filter(lambda x: max(map(abs, x)) > 0.1),
    st.integers(4, 12),
)
def test_linear_flows(entries, start, digits):
    """x' = M x against the exponential of the matrix, at many digits."""
    import mpmath

    names = ["x", "y", "z"]
    matrix = np.array(entries).reshape(3, 3).round(2)
    rates = {
        name: " + ".join(f"({m})*{other}" for m, other in zip(row, names, strict=True))
        for name, row in zip(names, matrix.tolist(), strict=True)
    }
    law = flow(rates, dict(zip(names, start, strict=True)), blocks=[names])
    solution = solve(law, 3.0, 10.0**-digits)
    exact = mpmath.matrix([[mpmath.mpf(str(x)) for x in row] for row in matrix.tolist()])
    worst = size = 0.0
    for time, row in zip(solution.times[::16], solution.states[::16], strict=True):
        there = mpmath.expm(exact * time) * mpmath.matrix(start)
        worst = max([worst, *(float(abs(a - b)) for a, b in zip(row, there, strict=True))])
        size = max([size, *(float(abs(b)) for b in there)])
    assert worst <= 10.0**-digits * size
    assert solution.error >= 0.1 * worst / size


def test_neighbours_start_beside_the_answer():
    """The first lane is the answer itself: that of a single run to a few roundings."""
    law = flow({"x": "v", "v": "-sin(x)"}, [1.0, 0.0])
    lanes = run_abreast(
        Taylor(),
        law.system,
        np.tile([[1.0], [0.0]], LANES),
        np.zeros((0, 1)),
        GRID,
        1e-12,
        1e3,
        1.0,
    )
    alone = Taylor().run(law.system, [1.0, 0.0], [], GRID, 1e-12)
    assert lanes is not None
    assert np.abs(lanes.states[:, :, 0] - alone.states).max() < 1e-13
    gap = np.abs(lanes.states[:, :, 1] - alone.states).max()
    assert 1e-13 < gap < 1e-8
    assert lanes.steps[1] < lanes.steps[0]


def test_sizes_of_other_starts_do_not_matter():
    """A motion far out leaves no looser steps to one near by, of the same equations."""
    far = flow({"x": "v", "v": "-x"}, [1e9, 0.0])
    near = far.moved(start=[1.0, 0.0])
    assert solve(far, 10.0, 1e-10).error < 1e-10
    solution = solve(near, 10.0, 1e-13)
    assert solution.engine == "Taylor"
    assert np.abs(solution["x"] - np.cos(solution.times)).max() < 1e-13


def test_growing_states_are_measured_by_their_size(told):
    """States that grow a millionfold: the tolerance is relative to where they come to."""
    solution = solve(flow({"x": "x"}, [1.0]), 14.0, 1e-11)
    error = np.abs(solution["x"] - np.exp(solution.times)).max() / np.exp(14.0)
    assert told[0] is not None
    assert error <= 1e-11
    assert solution.error >= 0.1 * error


@pytest.mark.parametrize("accuracy", [1e-7, 1e-12])
def test_switches_jumps_clock_and_unit(accuracy, told):
    """All that a flow may have on its way, against long double precision."""
    rates = {"x": "a*cos(t)", "p": "w*q", "q": "-w*p"}
    law = flow(
        rates, {"x": 0, "p": 0.6, "q": 0.8}, parameters={"a": 1, "w": 2}, unit=[("p", "q")],
        switches=[(10.0, {"a": 0.5}), (25.0, {"x": 3, "w": 1})],
    )  # fmt: skip
    solution = solve(law, [5.0, 10.0, 20.0, 25.0, 40.0], accuracy)
    assert told[0] is not None
    half = np.sin(10) + 0.5 * (np.sin(20) - np.sin(10))
    exact = [np.sin(5), np.sin(10), half, 3.0, 3.0 + 0.5 * (np.sin(40) - np.sin(25))]
    assert np.abs(solution["x"] - exact).max() < 3 * accuracy
    angle = np.arctan2(0.6, 0.8) + np.where(solution.times < 25, 2 * solution.times, 0)
    angle += np.where(solution.times >= 25, 25 + solution.times, 0)
    assert np.abs(solution["p"] - np.sin(angle)).max() < accuracy
    assert np.abs(solution["q"] - np.cos(angle)).max() < accuracy


def test_backwards(told):
    """Negative times."""
    solution = solve(flow({"x": "v", "v": "-x"}, [1.0, 0.0]), -7.0, 1e-10)
    assert told[0] is not None
    assert np.abs(solution["x"] - np.cos(solution.times)).max() < 1e-10


def test_edges_are_left_to_single_runs(told):
    """A motion that leaves its only chart ends as it did: with place and reason."""
    problem = geodesic(load("flat_polar").frame, [1.0, 0.0], frame_velocity=[-1.0, 0.0])
    with pytest.raises(ChartEdgeError, match="stops at t = 1"):
        solve(problem.with_charts("flat_polar"), 3.0, 1e-8)
    assert told[0] is None


def test_series_without_value_are_left_to_single_runs(told):
    """x' = x^2 ends at t = 1."""
    from geomtorsion.errors import StuckError

    with pytest.raises(StuckError):
        solve(flow({"x": "x**2"}, [1.0]), 2.0, 1e-8)
    assert told[0] is None


@pytest.mark.parametrize("engine", [Taylor(), RungeKutta()], ids=lambda engine: engine.name)
def test_times_are_those_of_the_call(engine):
    """Whoever gave an array of times may write to it later."""
    times = np.linspace(0.0, 9.0, 10)
    motion = geodesic(load("s3").frame, (0.7, 0.2, 0.3), frame_velocity=[1.0, 0.0, 0.0])
    for problem in (flow({"x": "v", "v": "-x"}, [1.0, 0.0]), motion):
        solution = solve(problem, times, 1e-8, engine)
        there = solution.at(4.5)
        if isinstance(solution, Solution):
            assert not np.shares_memory(solution.times, solution.journey.segments[0].times)
        times *= 2
        assert solution.times[-1] == times[-1] / 2
        again = solve(problem, solution.times, 1e-8, engine)
        times /= 2
        for name in ("states",) if problem is not motion else ("coordinates", "velocity"):
            assert np.array_equal(getattr(again, name), getattr(solution, name))
            assert np.array_equal(getattr(again.at(4.5), name), getattr(there, name))


def test_tolerance_is_remembered():
    """The next motion of equal equations begins where this one came to."""
    problem = top([0.3, 0.4, 0.2], (1, 2, 1.5))
    first = solve(problem, 40.0, 1e-9)
    assert learned(problem)["Taylor", 1e-9, "abreast"] == first.journey.tolerance
    assert first.cost.check_seconds >= 0
    again = solve(problem, 40.0, 1e-9)
    assert again.cost.steps == first.cost.steps
    assert again.cost.check_seconds == 0


def test_beyond_double_precision(told):
    """Where rounding is all that is left, it is said after one look, and more digits are taken."""
    problem = top([0.5, 1e-5, 1e-5], (Fraction(3, 2), 1, 2))
    solution = solve(problem, 150.0, 1e-13)
    assert solution.engine != "Taylor"
    assert told[0] is not None
    assert told[0].error > 1e-13
    assert truth(problem, solution) < 1e-12


@pytest.mark.parametrize("start", [38.0, 42.0, 123.1977448486044])
def test_a_long_step_is_not_taken_for_rounding(start):
    """x'' = x - x^3 far out: a step that was too long tells lanes apart, which a second look shows;
    Taylor series alone reach what is asked."""
    law = flow({"x": "v", "v": "x - x**3"}, [start, 0.0])
    solution = solve(law, 150 / start**2, 1e-11, engine=Taylor())
    energy = solution["v"] ** 2 / 2 - solution["x"] ** 2 / 2 + solution["x"] ** 4 / 4
    assert solution.error <= 1e-11
    assert np.abs(energy / energy[0] - 1).max() < 1e-10


@pytest.mark.parametrize(("start", "limit", "end"), [(2.4e-5, 77491, 19.8), (1.6e-5, 808669, 24.2)])
def test_small_states_that_grow_need_steps_of_their_own(start, limit, end):
    """Logistic growth over ten powers of ten: what is lost where the state is small stays lost."""
    law = flow({"x": "x*(1 - x/K)"}, [start], parameters={"K": limit})
    solution = solve(law, end, 1e-12, engine=Taylor())
    exact = limit / (1 + (limit / start - 1) * np.exp(-solution.times))
    error = np.abs(solution["x"] - exact).max() / exact.max()
    assert error < 1e-12
    assert solution.error >= 0.1 * (error - 1e-14)


def test_history_does_not_decide_what_is_solved():
    """The finest tolerance, needed once, is no start for motions too short for lanes."""
    law = flow({"x": "v", "v": "-sin(x)"}, [3.1, 0.0])
    for start in (3.1, 3.14, 3.141, 3.1415, 3.14159):
        solve(law.moved(start=[start, 0.0]), 40.0, 1e-13)
    short = solve(law.moved(start=[1.0, 0.0]), 0.3, 1e-13, engine=Taylor())
    assert short.error <= 1e-13

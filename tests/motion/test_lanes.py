"""Lanes: what each of those beside an answer is there for."""

from __future__ import annotations

from fractions import Fraction

import numpy as np
import pytest

from geomtorsion.geometry import cartan
from geomtorsion.motion import Taylor, abreast, autoparallel, beside, flow, geodesic, solve
from geomtorsion.motion.abreast import CAUTION
from geomtorsion.motion.engines.abreast import LANES, extents, run_abreast
from geomtorsion.motion.flows import beside as flow_beside
from geomtorsion.motion.flows.travel import legs_of, travel
from geomtorsion.motion.journey import departure
from geomtorsion.motion.journey import travel as travel_space
from geomtorsion.spaces import load

pytest.importorskip("heyoka")


def test_what_lanes_tell():
    """Series from the second lane, rounding from the last two, each with its caution."""
    judged = abreast.judged
    # Both agree: the share of the difference, and what the last two tell.
    assert judged(1e-3, [1e-6, 1e-9, 3e-10]) == pytest.approx((CAUTION * 1e-9,) * 2)
    assert judged(1e-3, [1e-6, 3e-10, 1e-9]) == pytest.approx((CAUTION * 1e-9,) * 2)
    # The last two are nearer than the share says: series of entire functions.
    assert judged(1e-3, [1e-6, 1e-12, 3e-12]) == pytest.approx((CAUTION * 1.2e-11, CAUTION * 3e-12))
    # They are further apart: rounding, which may be less by chance than what it can be.
    assert judged(1e-6, [1e-6, 5e-9, 1e-9]) == pytest.approx((CAUTION * 1e-12, CAUTION * 1e-8))
    # Too far apart to tell anything.
    assert judged(1e-6, [0.1, 1e-9, 1e-9])[0] == np.inf


def test_gaps_of_lanes():
    """Each lane against the first, in the largest of each block; no number is no answer."""
    states = np.array([[[1.0, 1.5, 1.0, 1.0], [-8.0, -8.0, -8.0, -6.0], [2.0, 2.0, 2.5, 2.0]]])
    states = np.concatenate((states, 0.5 * states))
    found = extents(states)
    assert found == [[1.0, 8.0, 2.0], [0.5, 0.0, 0.0], [0.0, 0.0, 0.5], [0.0, 2.0, 0.0]]
    assert abreast.gaps(found, [[0, 1], [2]]) == [0.0625, 0.25, 0.25]
    assert abreast.gaps(found, [[0, 1], [2]], lambda *seen: seen == ([2], 0.25, 2.0)) == [
        0.0625, 0.0, 0.25
    ]  # fmt: skip
    for bad in (np.nan, np.inf):
        states[1, 1, 2] = bad
        assert abreast.gaps(extents(states), [[0, 1], [2]]) is None


@pytest.mark.parametrize("tolerance", [1e-8, 1e-10, 1e-12])
@pytest.mark.parametrize("span", [2.0, 6.0, 60.0])
def test_share_of_the_second_lane(tolerance, span):
    """By how much the first lane is better, against long double precision; short spans, too."""
    rates = {"x": "v", "y": "w", "v": "-x/(x**2+y**2)**(3/2)", "w": "-y/(x**2+y**2)**(3/2)"}
    law = flow(rates, [0.5, 0.0, 0.0, np.sqrt(3.0)])
    times, start = np.linspace(0.0, span, 65), np.array([law.start], dtype=float).T
    lanes = run_abreast(
        Taylor(), law.system, np.tile(start, LANES), np.zeros((0, 1)), times, tolerance, 1e3, 4.0
    )
    assert lanes is not None
    exact = Taylor(64).run(law.system, law.start, [], times, 2.0**-68).states.astype(float)
    errors = np.abs(lanes.states - exact[:, :, None]).max(axis=(0, 1))
    assert lanes.share == pytest.approx(errors[0] / errors[1], rel=8)
    assert lanes.share > 0.125 * errors[0] / errors[1]


def test_lanes_beside_start_moved():
    """By two units in the last place, the second by as much more as of it less is taken."""
    step = 2.0**-51
    parts = np.array([0.0, 1e3 * step, step, -step])
    law = flow({"x": "a*x", "y": "b*x"}, [3, -5], parameters={"a": Fraction(1, 3), "b": 0.5})
    (leg,) = legs_of(law, 1.0)
    starts, numbers = flow_beside._prepared(law, Taylor(), leg, None, abreast.moves(1e3))
    # Up and down by turns; of numbers those that are held exactly stay.
    for row, sign in ((starts[0] / 3, 1), (starts[1] / -5, -1), (numbers[0] * 3, 1)):
        assert np.abs(row - 1 - sign * parts).max() < 0.6 * step
    assert (numbers[1] == 0.5).all()
    problem = geodesic(
        load("s3").frame, (0.7, 0.2, 0.3), frame_velocity=[0.3, 0.4, 0.2],
        metric=[1, 2, Fraction(3, 2)],
    )  # fmt: skip
    _, _, vector, values = departure(problem, 53)
    opened = beside._opened(
        Taylor(), problem.equations(problem.charts[0]), vector, values, 1e3
    ).starts
    moved = np.abs(opened / opened[:, :1] - 1).max(axis=0)
    assert moved == pytest.approx(np.array([0, 2e3, 2.7, 2.7]) * step, rel=0.6)


def test_rounded_parameters_are_seen():
    """A third is no number of a computer: after a million radians all steps are off alike."""
    law = flow({"x": "w*v", "v": "-w*x"}, [1, 0], parameters={"w": Fraction(1, 3)})
    solution = solve(law, [1e6, 1e6 + 4.0], 1e-9)
    error = np.abs(solution["x"] - np.cos(solution.times.astype(np.longdouble) / 3)).max()
    assert error < 1e-9
    assert solution.error >= 0.1 * error


def test_legs_keep_what_lanes_are_apart():
    """What is left out before a switch grows after it."""
    law = flow({"x": "a*x"}, [1.0], parameters={"a": 1.0}, switches=[(5.0, {"a": -1.0})])
    unstable = flow(
        {"x": "a*(y - x)", "y": "x*(r - z) - y", "z": "x*y - 8*z/3"}, [1.0, 2.0, 20.0],
        parameters={"a": 10.0, "r": 28.0}, switches=[(t, {"r": 28.0}) for t in (1, 4, 7, 9.9)],
    )  # fmt: skip
    for one, end in ((law, 10.0), (unstable, 10.0)):
        solution = solve(one, end, 1e-8)
        legs = legs_of(one, end)
        exact = travel(one, Taylor(113), 2.0**-116, solution.recipe.grid, legs)
        found = solution.trip.states - exact.states.astype(float)
        size = np.abs(solution.trip.states).max(axis=0)
        error = (np.abs(found).max(axis=0) / size).max()
        assert error < 1e-8
        assert solution.error >= 0.2 * error


def test_edges_do_not_measure_steps():
    """Far from the hole the edge function is larger than any state; steps go by the states."""
    problem = autoparallel(
        cartan(load("kerr").frame), [0, 9, 1.1, 0.4], frame_velocity=[0.44, 2.5, 1.33, 0.4],
        parameters={"M": 1, "a": 0.6},
    )  # fmt: skip
    times = np.linspace(0.0, 11.4, 33)
    solution = solve(problem, times, 1e-9)
    exact = travel_space(problem, Taylor(64), 2.0**-68, times * problem.speed).segments[0].states
    found = solution.journey.segments[0].states
    size = max(np.abs(found[:, :4]).max(), 1.0)
    error = float(np.abs(found - exact)[:, :4].max()) / size
    assert error < 1e-9
    assert solution.error >= 0.1 * error
    system = problem.equations("kerr").system
    _, _, vector, numbers = departure(problem, 53)
    starts = np.tile(vector[:, None], LANES)
    lanes = run_abreast(Taylor(), system, starts, numbers[:, None], times, 1e-10, 1e3, 30.0)
    assert lanes is not None
    assert lanes.steps[1] < 0.75 * lanes.steps[0]


def test_lanes_of_equal_steps_tell_nothing():
    """x' = 1 needs one step, however it is measured."""
    law, start = flow({"x": "1"}, [1.0]), np.ones((1, LANES))
    numbers = np.zeros((0, 1))
    assert run_abreast(Taylor(), law.system, start, numbers, np.arange(3.0), 1e-9, 1e3, 1.0) is None


def test_lanes_at_an_edge_tell_nothing():
    """A motion that goes on beyond the edge of its chart is left to single runs."""
    problem = geodesic(load("s2").frame, [1.0, 0.0], [-1.0, 1e-3], parameters={"R": 1})
    _, _, vector, numbers = departure(problem, 53)
    system = problem.equations("s2").system
    starts = np.tile(vector[:, None], LANES)
    rest = Taylor(), system, starts, numbers[:, None]
    assert run_abreast(*rest, np.array([0.0, 0.5]), 1e-9, 1e3, 1.0) is not None
    assert run_abreast(*rest, np.array([0.0, 1.5]), 1e-9, 1e3, 1.0) is None


def test_too_many_steps_are_left_to_single_runs(monkeypatch):
    """Lanes that have not come to the end tell nothing."""
    from geomtorsion.motion.engines import abreast as lanes

    monkeypatch.setattr(lanes, "MOST_STEPS", 10)
    law = flow({"x": "v", "v": "-x"}, [1.0, 0.0])
    starts, numbers = np.tile([[1.0], [0.0]], LANES), np.zeros((0, 1))
    assert lanes.run_abreast(
        Taylor(), law.system, starts, numbers, np.array([0.0, 50.0]), 1e-9, 1e3, 1.0
    ) is None  # fmt: skip


def test_witness_is_a_looser_run():
    """What is between the samples is told by a run as good as the second lane."""
    problem = geodesic(load("s3").frame, (0.7, 0.2, 0.3), frame_velocity=[0.3, 0.4, 0.2])
    solution = solve(problem, [9.0, 18.0], 1e-7)
    assert solution.witness is not None
    assert solution.witness.tolerance > 100 * solution.journey.tolerance
    times = np.linspace(0.0, 18.0, 200)
    exact = travel_space(problem, Taylor(64), 2.0**-68, times * problem.speed).segments[0].states
    error = np.abs(solution.at(times).coordinates - exact[:, :3].astype(float)).max()
    assert error / np.abs(exact[:, :3]).max() < 10 * solution.error_between
    one, two = (x.segments[0].run.states for x in (solution.journey, solution.witness))
    blocks = solution.journey.segments[0].equations.system.blocks
    gap = max(np.abs(one - two)[:, b].max() / np.abs(one[:, b]).max() for b in map(list, blocks))
    assert gap > 0
    assert solution.error == pytest.approx(solution.share * gap)


def test_trips_are_answer_and_looser_run():
    """The error is a share of their difference, relative to the size of the flow from its start."""
    law = flow({"x": "v", "v": "-2.2*v - x"}, [1.0, 0.0], blocks=[("x", "v")])
    solution = solve(law, [6.0, 9.0], 1e-7)
    answer, check = solution.trips
    assert check.tolerance > 100 * answer.tolerance
    gap = np.abs(answer.states - check.states).max()
    assert gap > 0
    assert np.abs(solution.states).max() < 0.1
    assert solution.error == pytest.approx(solution.share * gap)


def test_jumps_of_states_of_length_one():
    """After a jump they are brought to length one, in each lane."""
    law = flow(
        {"p": "q", "q": "-p"}, {"p": 0, "q": 1}, unit=[("p", "q")], switches=[(8.0, {"p": 3})],
        blocks=[("p", "q")],
    )  # fmt: skip
    times = np.linspace(8.5, 20.0, 24)
    solution = solve(law, times, 1e-9)
    angle = np.arctan2(3.0, np.cos(8.0)) + times - 8.0
    assert solution.engine == "Taylor"
    assert np.abs(solution["p"] - np.sin(angle)).max() < 1e-9
    assert np.abs(solution["q"] - np.cos(angle)).max() < 1e-9
    (_, second) = solution.trips[0].pieces
    assert np.hypot(*second.start[:2]) == pytest.approx(1, abs=1e-15)


@pytest.mark.parametrize("end", [12.0, 25.0, 38.0])
def test_lanes_of_growing_states(end):
    """Sizes of steps go by where the states come to: lanes are apart as their tolerances are."""
    law = flow({"x": "x*cos(y)", "y": "z", "z": "-y"}, [1.0, 0.1, 0.0], blocks=[("x",), ("y", "z")])
    solution = solve(law, end, 1e-8)
    legs = legs_of(law, end)
    exact = travel(law, Taylor(113), 2.0**-116, solution.recipe.grid, legs).states.astype(float)
    gaps = np.abs(solution.states - exact).max(axis=0)
    error = max(gaps[0] / exact[:, 0].max(), gaps[1:].max() / 0.1)
    assert error < 1e-8
    assert 0.1 * error <= solution.error <= 100 * error


@pytest.mark.parametrize("stop", [None, "9 - x"], ids=["lanes", "single runs"])
def test_threads_share_an_integrator(stop):
    """Two threads that solve equal equations get what one gets."""
    import sys
    from concurrent.futures import ThreadPoolExecutor

    law = flow({"x": "v", "v": "-sin(x)"}, [1.0, 0.0], stop=stop)
    starts = np.linspace(0.1, 3.0, 240)

    def last(start):
        return solve(law.moved(start=[start, 0.0]), 30.0, 1e-9).states[-1]

    alone, before = [last(start) for start in starts], sys.getswitchinterval()
    sys.setswitchinterval(1e-5)
    try:
        with ThreadPoolExecutor(2) as pool:
            found = list(pool.map(last, starts))
    finally:
        sys.setswitchinterval(before)
    assert np.abs(np.array(found) - alone).max() < 1e-8


def test_smaller_systems_move_their_constants():
    """Momenta are constants there: those of each lane are of its own start."""
    frame = load("schwarzschild").frame
    problem = geodesic(frame, [0, 8, 1.5, 0], [1, 0, 0, 0.04], parameters={"M": 1})
    name, _, vector, values = departure(problem, 53)
    opened = beside._opened(Taylor(), problem.equations(name), vector, values, 1e3)
    assert opened.widths is not None
    for numbers in (opened.numbers, opened.widths):
        gaps = np.abs(numbers - numbers[:, :1]).max(axis=0)
        assert gaps[1] > 1e-13
        assert (gaps[2:] > 1e-16).all()


GROWING = [
    (
        [[-0.156, -0.662, 0.051], [-0.363, -2.282, -0.158], [1.252, 0.197, 0.484]],
        [-0.3971099294651292, -0.9990910626819414, 0.49343008615190687],
        1e-4,
        31.614600435833268,
    ),
    (
        [[-0.584, -0.64, -0.079], [-0.504, -1.757, 0.555], [-0.527, 1.251, 0.567]],
        [62.675550954521384, 422.5848617235808, -101.99884386824368],
        1e-5,
        20.388273768796285,
    ),
]


@pytest.mark.parametrize(("matrix", "start", "accuracy", "end"), GROWING)
def test_what_grows_out_of_all_proportion(matrix, start, accuracy, end):
    """Lanes have their first steps in common, whose errors grow with the solution."""
    names = "xyz"
    rates = {
        name: " + ".join(f"({value})*{other}" for value, other in zip(row, names, strict=True))
        for name, row in zip(names, matrix, strict=True)
    }
    made = flow(rates, dict(zip(names, start, strict=True)))
    sol = solve(made, end, accuracy, Taylor())
    trip = travel(made, Taylor(113), 1e-30, np.asarray(sol.times), legs_of(made, end))
    truth = trip.states.astype(float)
    gap = np.abs(sol.states - truth).max() / np.abs(truth).max()
    assert gap <= accuracy
    assert sol.error >= 0.4 * gap

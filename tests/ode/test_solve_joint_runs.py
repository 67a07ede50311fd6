"""Joint runs: an answer and its finer runs in one integrator, and where runs go one by one."""

import numpy as np
import pytest

from geomtorsion.ode import ODE, Taylor, When, solve
from geomtorsion.ode.solve import run_jointly
from geomtorsion.ode.system import STEPS_AT_ONCE

pytest.importorskip("heyoka", reason="joint runs are heyoka's batches")

SWING = {"x": "v", "v": "-k*x"}
TOLERANCES = [1e-8, 1e-12, 1e-10]


def swing(**more):
    """x = cos(2 t)."""
    return ODE.of(SWING, [1, 0], parameters={"k": 4}, **more)


def jointly(problem, end, size=1.0, parts=(0.0, 1e-6, -1e-6), times=65):
    """The runs of a problem in one batch, which start a little apart."""
    stages = [problem.first_stage(53, part) for part in parts]
    starts, numbers = [x.start for x in stages], [x.parameters for x in stages]
    grid = np.linspace(0.0, end, times)
    return run_jointly(Taylor(), stages[0].system, starts, numbers, grid, TOLERANCES, size)


def test_each_lane_has_its_start_and_its_tolerance():
    """Against the cosine: finer runs are nearer to it, and each begins where it was told to."""
    found = jointly(swing(), 10.0, parts=(0.0, 0.0, 0.0))
    errors = [np.abs(run.states[:, 0] - np.cos(2 * run.times)).max() for run in found]
    for error, tolerance in zip(errors, [*TOLERANCES, TOLERANCES[0]], strict=True):
        assert 1e-3 * tolerance < error < 10 * tolerance
    assert found[0].steps < found[2].steps < found[1].steps
    apart = jointly(swing(), 10.0, parts=(0.0, 1e-6, 1e-3))
    assert [run.states[0, 0] - 1 for run in apart] == pytest.approx([0.0, 1e-6, 1e-3, 0.0])


def test_the_answer_comes_again_just_before_its_samples():
    """By the same steps: between both is the slope of the series, that of cos(2 t)."""
    answer, *_, again = jointly(swing(), 10.0)
    assert again.steps == answer.steps
    assert again.states[0].tolist() == answer.states[0].tolist()
    spans = answer.times[1:] - again.times[1:]
    assert 0 < spans.min() <= spans.max() < 1e-3 * answer.times[1]
    slopes = (answer.states[1:, 0] - again.states[1:, 0]) / spans
    assert slopes == pytest.approx(answer.states[1:, 1], abs=1e-3)


def test_tolerances_are_relative_to_the_size():
    """Runs that are measured by a larger size leave out as much more."""
    gaps = [
        np.abs(run.states[:, 0] - np.cos(2 * run.times)).max()
        for size in (1.0, 1e4)
        for run in jointly(swing(), 10.0, size)[:1]
    ]
    assert 1e3 < gaps[1] / gaps[0] < 1e5


@pytest.mark.parametrize("end", [0.1, 0.2, 0.3])
def test_a_motion_of_one_step(end):
    """Runs of one order that take one step each would agree; the truth is x = tan t."""
    solution = solve(ODE.of({"x": "1 + x**2"}, [0]), end, 1e-3, Taylor())
    assert solution.cost.steps == 1
    gap = np.abs(solution["x"] - np.tan(solution.times)).max() / np.tan(end)
    assert gap > 1e-13
    assert 0.5 * gap < solution.error < 100 * gap


def test_where_runs_go_one_by_one():
    """A guard that is met, many steps, many times, states that grow far above their size."""
    stopped = swing(events=[When("x + 1/2")])
    assert jointly(stopped, 1.0)
    assert not jointly(stopped, 2.0)
    assert not jointly(swing(), 10.0, times=STEPS_AT_ONCE + 1)
    assert not jointly(swing(), 1e4)
    growth = ODE.of({"x": "x"}, [1])
    allowed = float(np.log(0.5 * TOLERANCES[0] / TOLERANCES[1]))
    assert jointly(growth, 0.9 * allowed)
    assert not jointly(growth, 1.1 * allowed)


@pytest.mark.parametrize(
    ("problem", "end", "true"),
    [
        (swing(), 10.0, lambda t: np.cos(2 * t)),
        (ODE.of({"x": "x"}, [1]), 30.0, np.exp),
        (ODE.of({"x": "w", "y": "x"}, [0, 1], parameters={"w": 3}), 100.0, lambda t: 3 * t),
        (swing(events=[When("x + 1/2")]), 2.0, lambda t: np.cos(2 * t)),
    ],
    ids=["jointly", "grows", "evenly", "stopped"],
)
def test_solutions_are_true_either_way(problem, end, true):
    """Whether its runs went side by side or not, an answer is as good as asked and as it says."""
    for accuracy in (1e-6, 1e-10):
        solution = solve(problem, end, accuracy, Taylor())
        size = np.abs(true(solution.times)).max()
        gap = np.abs(solution["x"] - true(solution.times)).max() / size
        assert gap <= accuracy
        assert gap <= 2 * solution.error


def test_one_compilation_for_an_answer_and_its_error():
    """The finer run costs no compilation of its own."""
    law = ODE.of({"x": "v", "v": "-sin(x) - x**3/11"}, [1, 0])
    solution = solve(law, 5.0, 1e-9, Taylor())
    assert solution.trajectory.compile_seconds > 0
    assert solution.reference is not None
    assert solution.reference.compile_seconds == 0

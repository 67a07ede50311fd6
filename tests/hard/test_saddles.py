"""Saddles: reported errors where a motion amplifies roundings far more than what steps omit."""

import math
from dataclasses import replace

import numpy as np
import pytest

import geomtorsion as gt
from geomtorsion.errors import AccuracyError
from geomtorsion.ode import ODE, RungeKutta, Taylor, integrate
from geomtorsion.ode.checkpoint import part_name
from geomtorsion.ode.error_estimate import difference
from tests.chosen import few
from tests.ode.engines import needs_heyoka

LORENZ = {"x": "10*(y - x)", "y": "x*(28 - z) - y", "z": "x*y - 8*z/3"}
TOP = {"w1": "-w2*w3", "w2": "w1*w3", "w3": "-w1*w2/3"}
CASES = {
    # Steps omit far less than the tolerance near a rest: roundings are the error.
    "top near its middle axis": (
        ODE.of(TOP, [1.0370409686981138e-05, 1, 0]), 77.48598928679364, 1.0343150791136168e-10,
    ),
    # Two runs agree by chance.
    "double well": (
        ODE.of({"x": "v", "v": "x - x**3"}, [5.667385433559342e-07, -1.909323855152521e-07]),
        27.35720342292524, 1.5094656512510867e-11,
    ),
    # One step dominates the errors of a run and of one two orders finer.
    "Lorenz": (
        ODE.of(LORENZ, [3.8251199424363023, 7.531123730701481, 26.03932054373712]),
        16.05385422234238, 4.299634206977186e-07,
    ),
    "a rest in the middle of the way": (
        ODE.of({"x": "v", "v": "-sin(x)"}, [0.0, 2.0 - 1e-9]), 40.0, 3e-8,
    ),
}  # fmt: skip


@needs_heyoka
@pytest.mark.parametrize("name", CASES)
def test_the_error_is_not_below_the_truth(name):
    """Against a run in 200 bits."""
    problem, end, accuracy = CASES[name]
    solution = gt.solve(problem, end, accuracy)
    truth = integrate(problem.first_stage(200, 0.0), solution.times, 1e-45, Taylor(200))
    assert difference(problem, solution.trajectory, truth) <= solution.error <= accuracy


@needs_heyoka
@pytest.mark.parametrize("count", few(1, [50, 200]))
def test_tops_near_their_middle_axis(count):
    """Tops against Jacobi's closed form."""
    random = np.random.default_rng(11)
    ratios = []
    for _ in range(count):
        tilt, end = 10 ** random.uniform(-5, -1.5), random.uniform(20, 90)
        accuracy = float(10 ** random.uniform(-11, -5))
        problem = ODE.of(TOP, [tilt, 1, 0], norm_groups=[list(TOP)])
        solution = gt.solve(problem, end, accuracy)
        exact = np.asarray(gt.rigid.free_top((1, 2, 3), (tilt, 1, 0)).omega(solution.times))
        gap = np.abs(solution.states - exact).max() / np.abs(exact).max()
        ratios.append((gap - 1e-14) / solution.error)
        assert solution.error <= accuracy
    assert max(ratios) <= 1


@needs_heyoka
def test_roundings_are_part_of_the_error_of_every_name():
    """Errors of single components and outputs contain what the motion makes of roundings."""
    random, below = np.random.default_rng(3), []
    for _ in range(40):
        tilt, end = 10 ** random.uniform(-7, -3), random.uniform(20, 60)
        problem = ODE.of(TOP, [tilt, 1, 0], outputs={"energy": "w1**2 + 2*w2**2 + 3*w3**2"})
        solution = gt.solve(problem, end, float(10 ** random.uniform(-10, -5)))
        start = problem.first_stage(150, 0.0)
        truth = integrate(start, solution.times, 1e-34, Taylor(150))
        exact = replace(solution, trajectory=truth, comparisons=())
        for name in (*TOP, "energy"):
            group = problem.together(name) or (name,)
            size = max(float(np.abs(exact[word].astype(float)).max()) for word in group)
            gap = float(np.abs(solution[name] - exact[name].astype(float)).max())
            if gap > max(solution.error_of(name), 4e-15) * size:
                below.append((name, solution))
    assert not below


@pytest.mark.parametrize("engine", [RungeKutta(), pytest.param(Taylor(), marks=needs_heyoka)])
def test_an_amplification_beyond_all_digits_is_refused(engine):
    """A rounding that grows to the size of the motion leaves no answer in doubles."""
    problem = ODE.of({"x": "v", "v": "-sin(x)"}, [math.pi, 0.0])
    with pytest.raises(AccuracyError, match="gets to"):
        gt.solve(problem, 80.0, 1e-3, engine)


@needs_heyoka
@pytest.mark.parametrize(("width", "accuracy"), [(0.01, 1e-4), (0.01, 1e-6), (0.003, 1e-6)])
def test_a_bump_that_steps_pass_over(width, accuracy):
    """A potential with a bump narrower than a step: shorter steps, not more digits."""
    force = f"-(z - 4) + (z - 5)/(50*{width}**2)*exp(-((z - 5)/{width})**2)"
    problem = ODE.of({"z": "v", "v": force}, {"z": 2.5, "v": 0})
    solution = gt.solve(problem, 20.0, accuracy)
    start = problem.first_stage(53, 0.0)
    truth = integrate(start, solution.times, 1e-14, Taylor(), longest=1e-4)
    assert difference(problem, solution.trajectory, truth) <= solution.error <= accuracy
    assert solution.engine in ("Taylor", "Taylor(64)")


@needs_heyoka
def test_a_bump_with_a_checkpoint(tmp_path):
    """Shorter parts have names of their own in the file; the result has the same bits."""
    names = {part_name(Taylor(), 1e-9, 0.0, 3, fineness=n) for n in (1, 8, 64)}
    assert len(names) == 3
    force = "-(z - 4) + 200*(z - 5)*exp(-(100*(z - 5))**2)"
    problem = ODE.of({"z": "v", "v": force}, {"z": 2.5, "v": 0})
    file = tmp_path / "part.npz"
    one, again = (gt.solve(problem, 20.0, 1e-4, checkpoint=file) for _ in range(2))
    assert one.error <= 1e-4
    assert np.array_equal(one.states, again.states)
    start = problem.first_stage(53, 0.0)
    truth = integrate(start, one.times, 1e-14, Taylor(), longest=1e-4)
    assert difference(problem, one.trajectory, truth) <= one.error

"""Far times: a solver gives the value or an error of our own, within few steps."""

import numpy as np
import pytest

from geomtorsion.errors import GeomtorsionError
from geomtorsion.ode import ODE, Engine, RungeKutta, solve, solve_many
from tests.chosen import few, one_in

# Blocks of steps after which engines look at their progress.
MOST_BLOCKS = 8
KEPLER = {"x": "u", "y": "v", "u": "-x/(x**2+y**2)**(3/2)", "v": "-y/(x**2+y**2)**(3/2)"}
SYSTEMS = {
    "oscillator": ODE.of({"x": "v", "v": "-x"}, [1, 0]),
    "ellipse": ODE.of(KEPLER, [1, 0, 0, 1.1]),
    "driven": ODE.of({"x": "sin(t)"}, [1], time="t"),
    "guarded": ODE.of({"x": "v", "v": "-sqrt(x + 3)*x"}, [1, 0]),
}
ENGINES: list[Engine | None] = [None, RungeKutta()]


@pytest.mark.parametrize("problem", SYSTEMS.values(), ids=SYSTEMS.keys())
@pytest.mark.parametrize("engine", ENGINES, ids=["chosen", "Runge-Kutta"])
@pytest.mark.parametrize("last", [1e308, -1e15])
def test_one_motion(problem: ODE, engine: Engine | None, last: float, blocks: list[int]):
    """A motion cannot reach such a time and raises an error within few steps."""
    with pytest.raises(GeomtorsionError):
        solve(problem, last, engine=engine)
    assert len(blocks) <= MOST_BLOCKS


@pytest.mark.parametrize(("name", "engine"), one_in(2, list(SYSTEMS), ENGINES[::-1]))
@pytest.mark.parametrize("times", few(1, [-1e308, [5e14, 1e15]]))
def test_many_motions(name: str, engine: Engine | None, times: object, blocks: list[int]):
    """A batch of five raises an error with the reason of its first member."""
    problem = SYSTEMS[name]
    starts = np.array([float(value) for value in problem.start]) * np.linspace(1, 1.1, 5)[:, None]
    with pytest.raises(GeomtorsionError, match=r"got none\. Member 0: "):
        solve_many(problem, starts, times, engine=engine)
    assert len(blocks) <= 5 * MOST_BLOCKS


def test_an_escape_arrives():
    """A hyperbola reaches any time, because its steps grow."""
    assert solve(ODE.of(KEPLER, [1, 0, 0, 2]), 1e308, engine=RungeKutta()).times[-1] == 1e308


def test_far_times_with_few_steps_are_reached():
    """A motion that needs few steps reaches a far time."""
    assert solve(ODE.of({"x": "1"}, [1]), 1e308).states[-1][0] == 1e308
    assert (
        solve_many(ODE.of({"x": "1"}, [1]), [[1], [2]], 1e308)["x"][:, -1].tolist() == [1e308] * 2
    )


def test_a_long_batch_arrives():
    """A batch with more steps than before its first check agrees with its members one by one."""
    problem = SYSTEMS["oscillator"]
    many = solve_many(problem, [[1, 0], [2, 0]], [2e4, 4e4], 1e-6)
    alone = solve(problem, [2e4, 4e4], 1e-6)
    assert np.abs(many["x"][0] - alone["x"]).max() < 1e-6
    assert np.abs(many["x"][1] - 2 * alone["x"]).max() < 2e-6

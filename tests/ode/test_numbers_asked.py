"""Limits of memory: a too large request is refused, with its size, before memory is taken."""

import numpy as np
import pytest

import geomtorsion as gt
from geomtorsion import scenes
from geomtorsion.errors import LimitError, TimeError
from geomtorsion.materials.fields import SampledFrame
from geomtorsion.ode import ODE, RungeKutta, solve, solve_many
from geomtorsion.support.checks import lists

SWING = ODE.of({"x": "v", "v": "-x"}, [1, 0])
PLANE = gt.Frame("x y", [[1, 0], [0, 1]])
LINE = np.linspace(0, 1, 20_000)


@pytest.mark.parametrize(
    ("call", "words"),
    [
        (lambda: solve_many(SWING, np.ones((2000, 2)), np.arange(40_000.0)),
         "2,000 members at 40,000 times of 2 states would take 2.56 GB"),
        (lambda: scenes.load("lagrange_cusp").with_values(samples=10**9),
         "1,000,000,000 times of 12"),
        (lambda: SampledFrame.from_frame(PLANE, [LINE, LINE]),
         "400,000,000 nodes would take 25.6 GB"),
        (lambda: gt.Loop.circle([0, 0], 1).points(10**9), "1,000,000,000 points would take 16 GB"),
    ],
    ids=["solve_many", "scene", "grid", "loop"],
)  # fmt: skip
def test_requests_beyond_the_memory_limit_are_refused(call, words):
    """The error names the size, the limit and the remedy."""
    with pytest.raises(LimitError, match=rf"{words}.*; the limit is 2 GB\. (Give|Ask|Solve)"):
        call()


def test_one_motion_at_many_times(monkeypatch):
    """A number of times on each side of the limit, which the test lowers to save time."""
    monkeypatch.setattr(lists, "LARGEST_ARRAYS", 3_200_000)
    times = np.linspace(0, 1, 100_000)
    assert len(solve(SWING, times, 1e-6, RungeKutta()).times) == 100_000
    with pytest.raises(LimitError, match="t: 100,002 times of 2 states would take 0.0032 GB"):
        solve(SWING, np.linspace(0, 1, 100_002), 1e-6, RungeKutta())


def test_times_that_only_look_small():
    """A view of one number, 10**10 times over, takes 8 bytes; its times take 80 GB."""
    with pytest.raises(LimitError, match="10,000,000,000 times"):
        solve(SWING, np.broadcast_to(np.float64(1), (10**10,)))


def test_a_range_is_counted_before_it_is_written_out():
    """A range of 10**9 numbers is refused; a short one is read like a list."""
    with pytest.raises(LimitError, match=r"t: 1,000,000,000 numbers would take 8 GB.* Give fewer"):
        solve(SWING, range(10**9))
    with pytest.raises(TimeError, match="or a list of numbers"):
        solve(SWING, range(10**30))
    short = solve(SWING, range(1, 9, 2), 1e-6, RungeKutta())
    assert short.times.tolist() == [1, 3, 5, 7]

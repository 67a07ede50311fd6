"""Fits of dislocations to circuits: b, position and width of a core, from noisy vectors."""

# A test passes bad input.
# pyright: reportArgumentType=false

import numpy as np
import pytest

import geomtorsion as gt
from geomtorsion.errors import AccuracyError, ShapeError, StartError, UnknownNameError
from tests.loops.test_slopes import CORE, VALUES

LOOPS = [gt.Loop.circle([x, y, 0], 0.5) for x in (-0.5, 0.1, 0.7) for y in (-0.4, 0.2, 0.8)]
GUESS = {"b": 0.4, "x0": 0.0, "y0": 0.0, "w": 0.5}
TRUTH = np.array([gt.burgers_vector(CORE, loop, parameters=VALUES).vector for loop in LOOPS])


@pytest.mark.parametrize("number", [1, pytest.param(30, marks=pytest.mark.slow)])
def test_b_position_and_width_of_a_core(number):
    """Over some seeds the deviations are as large as the errors."""
    pulls = []
    for seed in range(number):
        data = TRUTH + 2e-3 * np.random.default_rng(seed).normal(size=TRUTH.shape)
        fit = gt.fit_loops(CORE, LOOPS, data, 2e-3, list(GUESS), parameters=GUESS)
        assert not fit.warnings
        assert max(fit.errors.values()) < 0.05
        pulls += [(fit[name] - VALUES[name]) / fit.errors[name] for name in GUESS]
    # The mean of 4 k squares has the relative standard deviation 1 / sqrt(2 k).
    assert np.sqrt(np.mean(np.square(pulls))) == pytest.approx(1, abs=1.5 / np.sqrt(2 * number))


def test_circuits_around_a_point_do_not_show_its_position():
    """Around an ideal screw b is determined, and the position is not."""
    values = VALUES | {"w": 0.05}
    circles = [gt.Loop.circle([x, 0, 0], 2) for x in (-0.5, 0.0, 0.5)]
    data = [[0, 0, 0.51], [0, 0, 0.49], [0, 0, 0.5]]
    fit = gt.fit_loops(CORE, circles, data, 0.01, ["b", "x0"], parameters=values)
    assert fit["b"] == pytest.approx(0.5)
    assert fit.errors["b"] == pytest.approx(0.01 / np.sqrt(3), rel=1e-6)
    assert np.isinf(fit.errors["x0"])
    assert "do not determine x0" in fit.warnings[0]
    assert "number of the loop or point" in [axes.get_xlabel() for axes in fit.plot().axes]


ONE = [gt.Loop.circle([0, 0, 0], 1)]
REFUSALS = [
    (lambda: gt.fit_loops(CORE, ONE, [[0, 0, 1]], 1, ["q"], parameters=VALUES),
     UnknownNameError, "There are b, x0, y0, w"),
    (lambda: gt.fit_loops(CORE, ONE, [[0, 1]], 1, ["b"], parameters=VALUES), ShapeError, "shape"),
    (lambda: gt.fit_loops(CORE, ONE, [[0, 0, 1]] * 2, 1, ["b"], parameters=VALUES),
     ShapeError, "expected 1 finite"),
    (lambda: gt.fit_loops(CORE, ONE, [[0, 0, 1]], 1, ["b"], parameters={"w": 1}),
     StartError, "a value for b, got none. Add a first guess"),
    (lambda: gt.fit_loops(CORE, ONE, [[0, 0, 1]], -1, ["b"], parameters=VALUES),
     StartError, "expected positive"),
    (lambda: gt.fit_loops(CORE, ONE, [[0, 0, 1]], 1e-16, ["b"], parameters=VALUES),
     AccuracyError, "numerical errors of b"),
    (lambda: gt.fit_loops(CORE, [3], [[0, 0, 1]], 1, ["b"], parameters=VALUES),
     gt.GeomtorsionError, "loops"),
]  # fmt: skip


@pytest.mark.parametrize(("call", "error", "words"), REFUSALS)
def test_bad_requests_are_refused(call, error, words):
    """Names, shapes, noise and values."""
    with pytest.raises(error, match=words):
        call()

"""Fits of dislocations to a measured coframe: b and position from distortions with noise."""

import numpy as np
import pytest

import geomtorsion as gt
from geomtorsion.errors import ShapeError, SingularPointError, StartError, UnknownNameError

SQUARE = "((x - x0)**2 + (y - y0)**2)"
EDGE = gt.Frame(
    "x y",
    [[f"1 - b*(y - y0)/(2*pi*{SQUARE})", f"b*(x - x0)/(2*pi*{SQUARE})"], ["0", "1"]],
    parameters="b x0 y0",
)
TRUTH = {"b": 0.3, "x0": 0.2, "y0": -0.1}
GUESS = {"b": 0.25, "x0": 0.0, "y0": 0.0}
POINTS = np.stack(np.meshgrid(np.linspace(-4, 4, 9), np.linspace(-4, 4, 8)), -1).reshape(-1, 2)
EXACT = np.array([EDGE.coframe.at(dict(zip("xy", p, strict=True)) | TRUTH) for p in POINTS])


def test_b_and_position_of_an_edge():
    """Pulls over 60 seeds have rms one; b agrees with the circuit around it."""
    pulls, fits = [], []
    for seed in range(60):
        noise = 1e-3 * np.random.default_rng(seed).normal(size=EXACT.shape)
        fit = gt.fit_frame(EDGE, POINTS, EXACT + noise, 1e-3, list(GUESS), parameters=GUESS)
        assert not fit.warnings
        fits.append(fit)
        pulls.append([(fit[name] - x) / fit.errors[name] for name, x in TRUTH.items()])
    assert np.sqrt(np.mean(np.square(pulls), axis=0)) == pytest.approx([1] * 3, abs=0.25)
    assert np.sqrt(np.mean(np.square(pulls))) == pytest.approx(1, abs=0.15)
    loop = gt.Loop.circle([0, 0], 2)
    b = gt.burgers_vector(EDGE, loop, parameters=fits[-1].values)
    assert b.vector[0] == pytest.approx(fits[-1]["b"])


def test_components_that_were_not_measured():
    """Only e^1_2 is known, and only at half of the points."""
    data = np.full_like(EXACT, np.nan)
    data[::2, 0, 1] = EXACT[::2, 0, 1]
    sigma = np.full_like(EXACT, 1e-3)
    fit = gt.fit_frame(EDGE, POINTS, data, sigma, list(GUESS), parameters=GUESS)
    assert list(fit.values.values()) == pytest.approx(list(TRUTH.values()), abs=1e-6)
    assert fit.degrees == 36 - 3


ONE = [[1.0, 0.0]]
REFUSALS = [
    (lambda: gt.fit_frame(EDGE, ONE, [np.eye(2)], 1, ["q"], parameters=GUESS),
     UnknownNameError, "There are b, x0, y0"),
    (lambda: gt.fit_frame(EDGE, ONE, np.eye(2), 1, ["b"], parameters=GUESS), ShapeError, "coframe"),
    (lambda: gt.fit_frame(EDGE, ONE, [np.eye(2)], np.eye(3), ["b"], parameters=GUESS),
     ShapeError, "sigma"),
    (lambda: gt.fit_frame(EDGE, [[1, 2, 3]], [np.eye(2)], 1, ["b"], parameters=GUESS),
     ShapeError, "points"),
    (lambda: gt.fit_frame(EDGE, ONE, [np.eye(2)], 1, ["b"], parameters={"b": 1}),
     StartError, "a value for x0, y0"),
    (lambda: gt.fit_frame(EDGE, [[0, 0]], [np.eye(2)], 1, ["b"], parameters=GUESS),
     SingularPointError, "at point 0"),
    (lambda: gt.fit_frame(EDGE, ONE, [np.eye(2)], 0, ["b"], parameters=GUESS),
     StartError, "expected positive"),
]  # fmt: skip


@pytest.mark.parametrize(("call", "error", "words"), REFUSALS)
def test_bad_requests_are_refused(call, error, words):
    """Names, shapes, noise, and a point on the line."""
    with pytest.raises(error, match=words):
        call()

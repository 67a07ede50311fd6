"""Numbers of whole tensors: at points, at arrays of points, by a function of arrays."""

from fractions import Fraction

import numpy as np
import pytest
import sympy as sp

import geomtorsion as gt
from tests.rounding import ROUNDED

KERR = gt.spaces.load("kerr").frame
T, R, THETA, PHI = KERR.coordinates
M, A = KERR.parameters
POINTS = {R: np.array([3.0, 4.0, 5.5]), THETA: np.array([[0.5], [1.5]]), M: 1, A: 0.7}


def test_points_one_by_one():
    """Arrays give the same bits as their points; single numbers are broadcast."""
    tensor = KERR.quantity("torsion")
    found = tensor.at(POINTS)
    assert found.shape == (2, 3, 4, 4, 4)
    for i, j in np.ndindex(2, 3):
        point = {R: POINTS[R][j], THETA: POINTS[THETA][i, 0], M: 1, A: 0.7}
        assert (found[i, j] == tensor.at(point)).all()


def test_lists_names_digits_and_scalars():
    """Lists, names as keys, many digits, rank 0, and an empty array of points work."""
    metric = KERR.metric
    assert metric.at({"r": [3, 4], "theta": 1, "M": 1, "a": 0}).shape == (2, 4, 4)
    long = metric.at({"r": [Fraction(1, 3)], "theta": 1, "M": 1, "a": 0}, digits=40)
    assert abs(long[0, 2, 2] - sp.Rational(1, 9).evalf(50)) < 1e-39
    scalar = KERR.quantity("kretschmann")
    wanted = [48 / 3.0**6, 48 / 4.0**6]
    assert scalar.at({R: [3, 4], THETA: 1, M: 1, A: 0}).tolist() == pytest.approx(
        wanted, rel=ROUNDED
    )
    assert metric.at({R: [], THETA: 1, M: 1, A: 0}).shape == (0, 4, 4)


@pytest.mark.parametrize("name", ["metric", "torsion", "riemann", "kretschmann"])
def test_function_of_a_tensor(name):
    """One call gives all components, axes of the points first, with the numbers of `at`."""
    tensor = KERR.quantity(name)
    function = gt.numpy_function(tensor, [R, THETA, M, A])
    found = function(POINTS[R], POINTS[THETA], 1.0, 0.7)
    wanted = tensor.at(POINTS)
    assert found.shape == wanted.shape
    assert np.abs(found - wanted).max() <= 1e-11 * np.abs(wanted).max()
    assert "def values" in function.source  # type: ignore[attr-defined]


def test_function_of_complex_and_vanishing_tensors():
    """Null legs give complex numbers; a vanishing tensor gives zeros."""
    null = gt.spaces.load("kerr_kinnersley").frame
    r, theta = null.coordinates[1:3]
    found = gt.numpy_function(null.legs, [r, theta, *null.parameters])(4.0, 1.0, 1.0, 0.5)
    values = dict(zip([r, theta, *null.parameters], [4.0, 1.0, 1.0, 0.5], strict=True))
    assert found.dtype == complex
    assert np.allclose(found, null.legs.at(values), rtol=1e-13)
    assert not gt.numpy_function(KERR.quantity("ricci"), [R])([3.0, 4.0]).any()
    assert gt.numpy_function(KERR.quantity("ricci"), [R])([3.0, 4.0]).shape == (2, 4, 4)

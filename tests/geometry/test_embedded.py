"""Embedded: torsion by embedding, against surfaces, closed forms and flat parallel transport."""

from __future__ import annotations

import numpy as np
import pytest
import sympy as sp

import geomtorsion as gt
from geomtorsion.errors import CoframeError, ExpressionError, MetricError, ShapeError

x, y, k = sp.symbols("x y k", real=True)
theta, phi = sp.symbols("theta phi", real=True)
R = sp.Symbol("R", positive=True)
SURFACES = {
    "sphere": (
        [theta, phi],
        [
            R * sp.sin(theta) * sp.cos(phi),
            R * sp.sin(theta) * sp.sin(phi),
            R * sp.cos(theta),
        ],
        None,
    ),
    "saddle": ([x, y], [x, y, x * y], None),
    "torus in four dimensions": (
        [x, y],
        [sp.cos(x), sp.sin(x), 2 * sp.cos(y), 2 * sp.sin(y)],
        None,
    ),
    "helix": ([x], [sp.cos(x), sp.sin(x), k * x], None),
    "hyperboloid in Minkowski space": (
        [x, phi],
        [sp.cosh(x), sp.sinh(x) * sp.cos(phi), sp.sinh(x) * sp.sin(phi)],
        (-1, 1, 1),
    ),
}


@pytest.mark.parametrize("name", SURFACES)
def test_gradients_give_levi_civita(name):
    """Rows d x^i embed a surface: the induced metric, no torsion."""
    q, place, signs = SURFACES[name]
    surface = gt.embedded(q, [[part.diff(one) for one in q] for part in place], signs)
    assert surface.is_torsion_free is True
    assert (surface.coefficients - gt.levi_civita(surface.frame).coefficients).is_zero
    assert surface.metric_compatible is True


def test_sphere_has_its_curvature():
    """The embedded sphere of radius R has scalar curvature 2/R^2."""
    q, place, _ = SURFACES["sphere"]
    sphere = gt.embedded(q, [[part.diff(one) for one in q] for part in place])
    assert (sphere.curvature.scalar - 2 / R**2).is_zero


def test_ramp_in_closed_form():
    """eps = (dx, dy, k x dy): Gamma_xy^y = k^2 x / (1 + k^2 x^2), and no other coefficient."""
    ramp = gt.embedded([x, y], [[1, 0], [0, 1], [0, k * x]])
    expected = k**2 * x / (1 + k**2 * x**2)
    assert list(ramp.coefficients.nonzero()) == [(0, 1, 1)]
    assert sp.simplify(ramp[0, 1, 1] - expected) == 0
    assert sp.simplify(ramp.torsion.S[0, 1, 1] - expected / 2) == 0
    # Steps at constant x are straight: the force of a rise along x is not felt.
    assert ramp.metric_compatible is True
    assert ramp.kind == "metric"


def test_torsion_is_the_projected_curl():
    """T_abd = eps^i_d (d_a eps^i_b - d_b eps^i_a) with indices down, for rows with y in them."""
    rows = sp.Matrix([[1 + y**2, x], [0, 1], [y, x * y], [sp.sin(x), 2]])
    bent = gt.embedded([x, y], rows.tolist())
    curl = [sp.diff(rows[i, 1], x) - sp.diff(rows[i, 0], y) for i in range(4)]
    lower = bent.torsion.T.lowered(2)
    for d in range(2):
        expected = sum(rows[i, d] * curl[i] for i in range(4))
        assert (bent.frame.scalar(lower[0, 1, d]) - expected).is_zero
    assert bent.metric_compatible is True
    assert bent.is_torsion_free is False


def test_as_many_rows_as_columns_give_cartan():
    """A square matrix is a coframe: its Cartan connection."""
    rows = [[1, x * y], [y, 1 + x**2]]
    square = gt.embedded([x, y], rows)
    n = range(2)
    cartan = gt.cartan(gt.Frame([x, y], rows))
    for index in np.ndindex(2, 2, 2):
        assert sp.simplify(square[index] - cartan[index]) == 0
    assert square.is_flat is True
    assert square.frame.dimension == len(n)


def test_autoparallel_against_its_own_equations():
    """The ramp with k = 1: x'' = 0 and y'' = - x x' y' / (1 + x^2), integrated separately."""
    ramp = gt.embedded([x, y], [[1, 0], [0, 1], [0, x]])
    curve = gt.solve(gt.autoparallel(ramp, [0.2, 0], [1.0, 0.5]), 2.0, 1e-11).at(2.0)
    rates = {"x": "v", "y": "w", "v": 0, "w": "-x*v*w/(1 + x**2)"}
    own = gt.solve(gt.ODE.of(rates, {"x": 0.2, "y": 0, "v": 1.0, "w": 0.5}), 2.0, 1e-11)
    assert abs(curve.coordinates[0] - own["x"][-1]) < 1e-11
    assert abs(curve.coordinates[1] - own["y"][-1]) < 1e-11


@pytest.mark.parametrize(
    ("call", "error", "words"),
    [
        (lambda: gt.embedded([x, y], [[1, 0]]), CoframeError, "at least 2 rows for 2 columns"),
        (lambda: gt.embedded([x, y], [[1, 0], [0]]), CoframeError, r"one length, got lengths"),
        (lambda: gt.embedded([x, y], []), CoframeError, r"one length, got lengths \[\]"),
        (lambda: gt.embedded([x, y], 3), CoframeError, "rows: expected rows of entries, got 3"),
        (lambda: gt.embedded([x, y], [1, 2]), CoframeError, r"rows\[0\]: expected rows"),
        (lambda: gt.embedded([x, y], [["x", 0], [0, 1]]), ExpressionError, r"rows\[0, 0\]"),
        (
            lambda: gt.embedded([x], [[1, 0], [0, 1], [0, x]]),
            ShapeError,
            "one for each of 2",
        ),
        (lambda: gt.embedded([x, y], [[1, 1]] * 3), MetricError, "degenerate"),
        (
            lambda: gt.embedded([x, y], [[1, 0], [0, 1], [0, x]], (1, 1)),
            MetricError,
            "expected 3 signs",
        ),
        (
            lambda: gt.Frame([x, y], [[1, 0], [0, 1], [0, x]]),
            CoframeError,
            r"gt.embedded\(coordinates, rows\)",
        ),
    ],
)
def test_refusals(call, error, words):
    """Each message names the expected value."""
    with pytest.raises(error, match=words):
        call()


def test_only_tall_matrices_are_sent_here():
    """The message about a ragged or wide coframe does not name the function."""
    for rows in ([[1, 0], [0]], [[1, 0, 0], [0, 1, 0]]):
        with pytest.raises(CoframeError) as refusal:
            gt.Frame([x, y], rows)
        assert "embedded" not in str(refusal.value)

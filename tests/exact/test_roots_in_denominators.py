"""Radical denominators: values and written form are good, although conjugates clear the roots."""

import mpmath
import numpy as np
import pytest
import sympy as sp

from geomtorsion.curves import autoparallel, geodesic
from geomtorsion.exact import Field
from geomtorsion.geometry import Frame, cartan, levi_civita
from geomtorsion.geometry.numpy_functions import numpy_function
from geomtorsion.ode import RungeKutta, solve
from tests.rounding import ROUNDED

X, Z = sp.symbols("x z", real=True)
W = sp.sqrt(Z**2 + 1)


def test_inverses_that_share_a_norm():
    """det = w**2 + 12 w + 32 does not factor as a polynomial, yet each leg has its own factor."""
    frame = Frame([X, Z], [[W + 4, sp.sin(X) / 4], [0, W + 8]])
    vectors = frame.legs
    assert vectors[0, 0] == 1 / (W + 4)
    assert vectors[1, 1] == 1 / (W + 8)


@pytest.mark.parametrize(
    "root",
    [sp.sqrt(2 + sp.sin(Z)), sp.sqrt(1 + W), sp.sqrt(1 + W) + W, sp.sqrt(1 + sp.cos(2 * Z) / 3)],
    ids=["of a sine", "of a root", "two", "of two angles"],
)
def test_roots_of_norms_with_roots(root):
    """The norm of 1 + w contains a root, which is cleared again; the result shows none of that."""
    legs = Frame([X, Z], [[1 + root, X], [0, 1]]).legs
    assert sp.simplify(legs[0, 0] * (1 + root)) == 1
    assert sp.fraction(legs[0, 0])[0].is_number
    assert legs[0, 1] == -X * legs[0, 0]


def test_a_part_of_a_norm_below():
    """Coefficients are written over the determinant, not over its norm."""
    x, y = sp.symbols("x y", positive=True)
    rows = [[sp.sqrt(x) + 1, sp.sqrt(y)], [1, 2]]
    found = levi_civita(Frame([x, y], rows)).coefficients.to_sympy()
    for entry in sp.flatten(found):
        numerator, denominator = sp.fraction(entry)
        assert len(sp.Add.make_args(numerator)) <= 3
        assert denominator.count(sp.Add) <= 1
    # Curvilinear legs in the plane: Gamma = e^-1 de of the flat connection of x', y'.
    inverse = sp.Matrix(rows).inv()
    flat = inverse * sp.Matrix([[1 / (2 * sp.sqrt(x)), 0], [0, 0]])
    assert sp.simplify(found[0][0][0] - flat[0, 0]) == 0
    assert sp.simplify(found[0][0][1] - flat[1, 0]) == 0


@pytest.mark.parametrize("accuracy", [1e-6, 1e-10])
def test_motion_through_a_point_where_a_conjugate_vanishes(accuracy):
    """At z**2 = 15 the conjugate w - 4 and the norm are zero, but the frame is regular."""
    frame = Frame([X, Z], [[W + 4, sp.sin(X) / 4], [0, W + 8]])
    start = [0.1, float(sp.sqrt(15))]
    motion = autoparallel(cartan(frame), start, frame_velocity=[0.5, 1.0])
    solution = solve(motion, 10.0, accuracy, RungeKutta())
    # Along the second leg only, (z w + asinh z)/2 + 8 z grows as t.
    with mpmath.workdps(30):

        def grown(z):
            return (z * mpmath.sqrt(z**2 + 1) + mpmath.asinh(z)) / 2 + 8 * z

        begun = grown(mpmath.mpf(start[1]))
        exact = mpmath.findroot(lambda z: grown(z) - begun - 10, 4.5)
    assert abs(solution.coordinates[-1, 1] - float(exact)) < 5 * accuracy


def test_motion_through_the_zero_of_a_long_norm():
    """The norm of this determinant has 155 terms and is zero at t = 3.835; the frame is regular."""
    q1, q2, q3 = sp.symbols("q1:4", real=True)
    rows = [
        [3 * sp.sqrt(q3**2 + 1) / 4 + 3, 3 * sp.sqrt(q1**2 + 1) / 4, sp.sin(q2) / 4],
        [0, 3 * sp.sqrt(q3**2 + 1) / 8 + 3, 0],
        [5 * sp.sin(q3) / 2, 0, 3 * sp.tanh(q2) / 2 + 3],
    ]
    frame = Frame([q1, q2, q3], rows)
    solution = solve(geodesic(frame, [0.06, 0.42, -0.41], [-0.04, -0.71, -0.16]), 5.0, 1e-12)
    # By extrapolation in long double, from the rows and their derivatives.
    exact = [-0.488729892279124906, -1.811172568086939743, -5.332518932108212963]
    assert np.abs(solution.coordinates[-1] - exact).max() < 5e-12


@pytest.mark.parametrize(
    ("entry", "far", "value"),
    [
        (3 + 3 * sp.tanh(Z), 20.0, 1 / 6),
        (3 + 3 * sp.tanh(Z), 200.0, 1 / 6),
        (sp.sqrt(Z**2 + 1) + Z, 1e9, 5e-10),
        (sp.sqrt(Z**2 + 1) + sp.sqrt(Z**2 + 2), 1e9, 5e-10),
    ],
    ids=["wall", "far wall", "root", "two roots"],
)
def test_inverses_far_out(entry, far, value):
    """1/(A + B w) with a norm of one, as doubles: A - B w has no correct digit there."""
    frame = Frame([X, Z], [[entry, 0], [0, 1]])
    numbers = numpy_function(frame.quantity("legs"), [X, Z])(0.1, np.array([far]))
    assert np.asarray(numbers).ravel()[0] == pytest.approx(value, rel=ROUNDED)
    motion = autoparallel(cartan(frame), [0.1, far], frame_velocity=[1 / value, 1e-12])
    solution = solve(motion, 10.0, 1e-10, RungeKutta())
    assert solution.coordinates[-1, 0] == pytest.approx(10.1, rel=1e-9)


def test_forms_without_cancellation_are_preferred():
    """A quotient of two possible forms is written in the form whose terms do not cancel."""
    x = sp.Symbol("x", positive=True)
    frame = Frame([x, Z], [[1 / (sp.sqrt(x + 1) - sp.sqrt(x)), 0], [0, 1]])
    assert frame.coframe[0, 0] == sp.sqrt(x) + sp.sqrt(x + 1)
    assert frame.legs[0, 0] == 1 / (sp.sqrt(x) + sp.sqrt(x + 1))


@pytest.mark.parametrize("power", [2, 3, 4])
@pytest.mark.parametrize(
    "root",
    [W + X + 2, X * W + sp.sqrt(X**2 + 2) + 1, sp.sqrt(1 + W) + X],
    ids=["one root", "two roots", "a nested root"],
)
def test_a_power_of_which_only_the_square_was_inverted(root, power):
    """A power of 1/det is written as a power of det, also if only det**2 was inverted."""
    field = Field([X, Z])
    base = field.read(root)
    inverse = (base * base).inverse()
    if power > 2:
        inverse = inverse * inverse * (base if power == 3 else field.one)
    shown = inverse.sympy
    assert (field.read(shown) - inverse).is_zero
    assert shown.as_base_exp() == (base.sympy, -power)

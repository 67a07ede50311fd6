"""Arithmetic: a tensor of rank 0 acts as an expression; other tensors keep their indices."""

from fractions import Fraction
from typing import Any

import numpy as np
import pytest
import sympy as sp

import geomtorsion as gt
from geomtorsion.errors import ExpressionError, TensorIndexError

R, PHI, X = sp.symbols("r phi x", positive=True)
POLAR = gt.Frame([R, PHI], [[1, 0], [0, R]])


@pytest.fixture(scope="module")
def curvature():
    """Curvature scalar of the rotations: three halves."""
    return gt.levi_civita(gt.spaces.load("so3").frame).curvature.scalar


def test_scalar_equals_its_expression(curvature):
    """A scalar equals its expression from both sides, in each exact form, and has its hash."""
    for same in (sp.Rational(3, 2), Fraction(3, 2), 1.5, sp.Integer(3) / 2):
        assert curvature == same
        assert same == curvature or isinstance(same, float)
    assert hash(curvature) == hash(sp.Rational(3, 2))
    assert {sp.Rational(3, 2): 1}[curvature] == 1
    for other in (2, sp.pi, X, "3/2", None, [1.5]):
        assert curvature != other


def test_scalar_is_decided_by_mathematics():
    """Equality is decided mathematically: sin^2 + cos^2 is one."""
    assert POLAR.scalar(sp.sin(PHI) ** 2 + sp.cos(PHI) ** 2) == 1
    assert POLAR.scalar(R**2) == (R + 1) ** 2 - 2 * R - 1
    assert POLAR.scalar(R) != R + 1


def test_arithmetic_of_scalars(curvature):
    """Each operation of a scalar with numbers, expressions and scalars, from both sides."""
    half = sp.Rational(1, 2)
    assert curvature + 1 == 1 + curvature == 5 * half
    assert curvature - 1 == half
    assert 1 - curvature == -half
    assert 2 * curvature == curvature * 2 == 3
    assert curvature / 3 == half
    assert 3 / curvature == 2
    assert curvature**2 == 9 * half**2
    assert curvature**-1 == 2 / sp.Integer(3)
    assert curvature * curvature == 9 * half**2
    assert -curvature == -3 * half
    assert float(curvature) == 1.5
    assert POLAR.scalar(R) ** half == sp.sqrt(R)


def test_expressions_in_front_of_tensors():
    """Lambda * g is g * Lambda for any expression; a sum with an expression is refused."""
    constant, ball = sp.Symbol("Lambda"), gt.Frame([R, PHI], [[1, 0], [0, sp.sin(R)]])
    metric = ball.metric
    for factor in (constant, sp.Rational(1, 2), sp.pi, constant + X, sp.Function("f")(X)):
        product = factor * metric
        assert product.slots == "dd"
        assert product == metric * factor
    ricci = gt.levi_civita(ball).curvature.ricci
    assert (ricci - sp.Integer(1) * metric).is_zero
    with pytest.raises(TensorIndexError, match="expected a tensor to add, got Lambda"):
        _ = constant + metric
    with pytest.raises(TensorIndexError, match="expected a scalar for a power"):
        _ = constant / metric


def test_scalars_in_sympy(curvature):
    """sympy treats a scalar as its expression."""
    assert sp.sympify(curvature) == sp.Rational(3, 2)
    assert X + curvature == X + sp.Rational(3, 2)
    assert sp.diff(sp.sympify(POLAR.scalar(R**2)), R) == 2 * R
    assert sp.Matrix([[POLAR.scalar(R)]])[0, 0] == R
    assert sp.simplify(X * curvature - 3 * X / 2) == 0


def test_scalar_times_tensor():
    """A scalar scales a tensor; two tensors with indices need letters."""
    scaled = POLAR.scalar(R) * POLAR.metric
    assert scaled == POLAR.metric * POLAR.scalar(R) == POLAR.metric * R
    assert POLAR.metric / POLAR.scalar(R) == POLAR.metric / R
    with pytest.raises(TensorIndexError, match="expected letters for the summed indices"):
        _ = POLAR.metric * POLAR.metric
    with pytest.raises(TensorIndexError, match="expected a scalar divisor"):
        _ = POLAR.metric / POLAR.metric


def test_scalar_of_an_expression():
    """A frame makes scalars from numbers, expressions and text about its symbols."""
    scalar = POLAR.scalar(R**2, "h", "height")
    assert "height h" in repr(scalar)
    assert POLAR.scalar(3)[()] == 3
    assert POLAR.scalar("r**2")[()] == R**2
    with pytest.raises(ExpressionError, match="scalar: q is neither a coordinate"):
        POLAR.scalar("q")


def test_indices_of_other_kinds():
    """Whole numbers of sympy and NumPy are valid indices; truth values and others are refused."""
    assert POLAR.legs[sp.Integer(1), 1] == POLAR.legs[np.int64(1), 1] == 1 / R
    assert POLAR.metric.raised(sp.Integer(0)).slots == "ud"
    assert POLAR.metric.element(sp.Integer(1), np.int8(1)).sympy == R**2
    bads: list[Any] = [-3, 2, True, 1.0, "0", sp.Rational(1, 2), sp.Symbol("z")]
    for bad in bads:
        with pytest.raises(TensorIndexError, match="expected up to 2 indices, each a whole number"):
            POLAR.legs[bad, 0]
        with pytest.raises(TensorIndexError, match="expected the number of an index from 0 to 1"):
            POLAR.metric.raised(bad)

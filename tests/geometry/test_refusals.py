"""Refusals of geometry: each call, the class of its error, and words of its message."""

# Calls that a checker of types refuses as well.
# pyright: reportArgumentType=false

from collections.abc import Callable
from typing import Any

import pytest
import sympy as sp

import geomtorsion as gt
from geomtorsion.errors import (
    CoframeError,
    CoordinateError,
    ExpressionError,
    MissingValueError,
    ShapeError,
    SignatureError,
    SingularPointError,
    StructureConstantError,
    TensorIndexError,
    UnknownNameError,
)
from geomtorsion.geometry import Frame, Tensor
from geomtorsion.geometry.from_arrays import tensor_from_array
from tests.geometry.test_groups import constants

# Without types, for calls that are wrong on purpose.
wrong: Any = gt
x, y, z, r = sp.symbols("x y z r", positive=True)
ONES, ZEROS = [[1, 0], [0, 1]], [[[0, 0], [0, 0]], [[0, 0], [0, 0]]]
POLAR = gt.spaces.load("flat_polar").frame
OTHER = gt.Frame([x, y], ONES)
PLANE = gt.Frame([x, y], [[1, 0], [0, sp.exp(x)]], signature=(-1, 1))
CURVATURE = gt.levi_civita(gt.spaces.load("so3").frame).curvature.scalar
KERR = gt.spaces.load("kerr").frame
AT = {"theta": 1, "M": 1, "a": 0}
GROUP = wrong.Frame.from_structure_constants
# C_01^0 = 1 without C_10^0 = -1.
ONE_SIDED = [[[0, 0], [1, 0]], [[0, 0], [0, 0]]]

SCALARS = [
    (lambda: float(POLAR.scalar(r)), MissingValueError, r"got an expression in r\. Give values"),
    (lambda: float(wrong.Frame([x], [[1]]).metric), TypeError, "got a tensor with indices"),
    (lambda: 1 / POLAR.scalar(0), ZeroDivisionError, "exactly zero"),
    (lambda: POLAR.metric**2, TensorIndexError, "expected a scalar for a power"),
    (lambda: POLAR.metric + 1, TensorIndexError, "expected a tensor to add"),
    (lambda: CURVATURE + "1", TensorIndexError, "expected a tensor to add"),
    (lambda: POLAR.metric * CURVATURE, TensorIndexError, "expected a tensor over this frame"),
]
CONNECTIONS = [
    (lambda: gt.from_contortion(PLANE, [[[0, 0], [0, x]], ZEROS[1]]),
     TensorIndexError, r"\[0, 1, 1\]"),
    (lambda: gt.from_coefficients(PLANE, [ZEROS] * 3), ShapeError, "expected 2 entries"),
    (lambda: gt.from_coefficients(PLANE, gt.cartan(OTHER).coefficients),
     ShapeError, "another frame"),
    (lambda: gt.from_coefficients(PLANE, gt.cartan(PLANE).torsion.T.lowered(2)),
     TensorIndexError, "expected slots 'ddu', got 'ddd'"),
    (lambda: gt.blend(gt.cartan(PLANE), gt.cartan(OTHER)),
     ShapeError, "second: expected a connection over this"),
    (lambda: gt.cartan(PLANE).covariant_derivative(OTHER.metric), ShapeError, "another frame"),
    (lambda: gt.from_torsion(POLAR, [[[1, 0], [0, 0]], ZEROS[0]]),
     TensorIndexError, "torsion: S_ab.c must be antisymmetric"),
    (lambda: gt.from_torsion(POLAR, [1]), ShapeError, "torsion: expected 2 entries"),
    (lambda: gt.from_torsion(POLAR, gt.cartan(OTHER).torsion), ShapeError, "another frame"),
    (lambda: gt.from_torsion(POLAR, POLAR.metric), TensorIndexError, "slots"),
]  # fmt: skip
FRAMES = [
    (lambda: wrong.Frame([x, y], None), CoframeError, "coframe: expected rows of entries"),
    (lambda: Frame([x, y, z], [[1, x, 0], [0, 1, y], [1, x + 2, 2 * y]]),
     CoframeError, "Row 2 equals .*row 0.*row 1"),
    (lambda: Frame([x, y], [[1, 0], [0, sp.sin(x) ** 2 + sp.cos(x) ** 2 - 1]]),
     CoframeError, "Row 1 is zero"),
    (lambda: Frame.from_frame([x, y], [[1, 1], [1, 1]]), CoframeError, "matrix of legs"),
    (lambda: Frame([x, y], [[1, 0], [1]]), CoframeError, "row 1 has 1"),
    (lambda: wrong.Frame([x, y], [1, 2]), CoframeError, "not square"),
    (lambda: Frame([x], ONES), ShapeError, "coordinates: expected one for each of 2 .*, got 1"),
    (lambda: Frame([x, y], ONES, signature=(1, 1, 1)),
     SignatureError, "signature: expected one for each of 2 .*, got 3"),
    (lambda: Frame([x, y], ONES, signature=[[1, 1], [1, 1]]), SignatureError, "degenerate"),
    (lambda: setattr(OTHER, "name", "other"), AttributeError, "name"),
    (lambda: POLAR.plan("ricii"), UnknownNameError, "Did you mean ricci"),
    (lambda: POLAR.quantity("entropy"), UnknownNameError, "There are"),
]  # fmt: skip
GROUPS = [
    (lambda: GROUP(constants(3, _01_1=1, _12_0=1)),
     StructureConstantError, r"i, j, k = 0, 1, 2 and component 0 .* 1"),
    (lambda: GROUP(ONE_SIDED), StructureConstantError, r"C\[0, 1, 0\] = 1, C\[1, 0, 0\] = 0"),
    (lambda: GROUP([[1, 2], [3, 4]]), StructureConstantError, "shape"),
    (lambda: GROUP(constants(3, _01_2=0.5)), ExpressionError, "structure constants"),
    (lambda: GROUP(constants(3), "x y"), ShapeError, "one for each of 3 .*, got 2"),
    (lambda: GROUP(constants(4, _30_1=1, _31_2=1, _32_0=1, _32_1=1)),
     StructureConstantError, "degree 3"),
]  # fmt: skip
POINTS = [
    (lambda: KERR.metric.at({**AT, "theta": [1, 1, 1], "r": [3, 4]}),
     ShapeError, r"got the shapes \(3,\), \(2,\)"),
    (lambda: KERR.metric.at({**AT, "r": [3, "4"]}),
     CoordinateError, "point: r: expected a number, got "),
    (lambda: KERR.metric.at({**AT, "r": [3, float("nan")]}),
     CoordinateError, "point: r: expected a finite number, got "),
    (lambda: KERR.metric.at({**AT, "r": [[3], [4, 5]]}),
     CoordinateError, "point: r: expected a number, got "),
    (lambda: KERR.metric.at({**AT, "r": [3, 0], "theta": sp.pi / 2}),
     SingularPointError, "no finite real value"),
]  # fmt: skip
ARRAYS = [
    (lambda: tensor_from_array(POLAR, "du", [[0, 1], [0]], "v"), ShapeError, r"v\[1\]"),
    (lambda: tensor_from_array(POLAR, "u", 3, "v"), ShapeError, "single value"),
    (lambda: Tensor(POLAR, "dx", {}), TensorIndexError, "slots"),
]


@pytest.mark.parametrize(
    ("call", "error", "words"), SCALARS + CONNECTIONS + FRAMES + GROUPS + POINTS + ARRAYS
)
def test_bad_calls_are_refused(
    call: Callable[[], object], error: type[Exception], words: str
) -> None:
    """Each bad argument has an error of its own class, which names the mistake."""
    with pytest.raises(error, match=words):
        call()

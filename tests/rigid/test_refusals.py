"""Refusals of rigid bodies: each call, the class of its error, and words of its message."""

from collections.abc import Callable
from math import inf, nan
from typing import Any

import numpy as np
import pytest

from geomtorsion.errors import ShapeError, StartError, TimeError, UnknownNameError
from geomtorsion.rigid import attitude as att
from geomtorsion.rigid import free_top, se3

ONE = (1, 0, 0, 0)
# Without types, for calls that are wrong on purpose.
top: Any = free_top

REFUSALS = [
    (lambda: att.checked_quaternion([0, 0, 0, 0]),
     StartError, "quaternion: expected length 1, got 0"),
    (lambda: att.checked_quaternion([2, 0, 0, 0]),
     StartError, r"expected length 1, got 2. Divide by it: \(1, 0, 0, 0\)"),
    (lambda: att.checked_quaternion([nan, 0, 0, 0]), StartError, "nan is not finite"),
    (lambda: att.checked_matrix(-np.eye(3)), StartError, "reflection"),
    (lambda: att.checked_matrix(np.diag([1.1, 1, 1])),
     StartError, r"R\^T R - 1 of size 0\.21"),
    (lambda: att.checked_matrix([[1, 2], [3, 4]]), StartError, "3 x 3 numbers"),
    (lambda: att.euler_from_quaternion(ONE, "zzy"), UnknownNameError, "'zzy'.*Did you mean"),
    (lambda: att.matrix_from_quaternion([1, 0, 0]),
     ShapeError, r"expected shape .*, got \(3,\)"),
    (lambda: att.rotation_vector_from_quaternion([0, 0, 0, 0]),
     StartError, "quaternion: expected finite numbers, not all 0"),
    (lambda: att.rotation_vector_from_matrix(np.full((3, 3), nan)),
     StartError, "expected a rotation"),
    (lambda: att.rotation_vector_from_matrix(-np.eye(3)), StartError, "reflection"),
    (lambda: se3.exp([1, 2, 3]), ShapeError, r"twist: expected shape \(..., 6\), got \(3,\)"),
    (lambda: se3.exp([nan] * 6), StartError, r"twist\[0\] = nan is not finite"),
    (lambda: se3.log(2 * np.eye(4)), StartError, r"expected \(0, 0, 0, 1\) as last row"),
    (lambda: se3.log(np.diag([1, 1, -1, 1])), StartError, "reflection"),
    (lambda: se3.adjoint(np.diag([2, 1, 1, 1])), StartError, "expected a rotation"),
    (lambda: se3.pose(np.eye(3), [1, 2]), ShapeError, "position: expected shape"),
    (lambda: top((1, 2, 0), (1, 0, 0), ONE),
     StartError, r"moments\[2\]: expected a positive moment of inertia, got 0.0"),
    (lambda: top((1, 2, -1), (1, 0, 0), ONE),
     StartError, r"moments\[2\]: expected a positive moment"),
    (lambda: top((1, 2), (1, 0, 0), ONE), ShapeError, "expected 3 numbers, got 2"),
    (lambda: top((1, 2, 3), (1, 0, inf), ONE), StartError, r"omega\[2\]: expected a finite number"),
    (lambda: top((1, 2, 3), (1, 0, 0), (0, 0, 0, 0)), StartError, "length 0"),
    (lambda: top((1, 2, 3), (1, 0, 0), (1, 1, 0, 0)), StartError, "Divide it by its length"),
    (lambda: top((1, 2, 3), (0.1, 1, 0.2)).omega([0.0, nan]), TimeError, "not finite"),
    (lambda: top((1, 2, 3), (0.1, 1, 0.2)).omega(1e17),
     TimeError, "A double has too few digits"),
]  # fmt: skip


@pytest.mark.parametrize(("call", "error", "words"), REFUSALS)
def test_bad_calls_are_refused(
    call: Callable[[], object], error: type[Exception], words: str
) -> None:
    """Each bad argument has an error of its own class, which names the expected input."""
    with pytest.raises(error, match=words):
        call()

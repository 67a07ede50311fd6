"""Attitude: quaternions from and to matrices, Euler angles and rotation vectors.

Quaternions are (q0, q1, q2, q3), scalar first; q and the matrix R map body to space. Arrays may
have any leading shape. Euler angles come in 24 conventions, named as in scipy: three small letters
turn about space axes in the order written, three capitals about body axes. The paper's angles
(phi1, phi2, phi3), R = Rz(phi3) Ry(phi2) Rz(phi1), are "zyz".
"""

from __future__ import annotations

from collections.abc import Sequence
from itertools import product as choices
from typing import Any

import numpy as np
import sympy as sp
from numpy.typing import ArrayLike, NDArray

from geomtorsion.errors import ShapeError, StartError, UnknownNameError
from geomtorsion.support import checks
from geomtorsion.support.precision import EPS, PRINTED

Array = NDArray[np.float64]
# One component of a quaternion: a number, an array of them, or an expression.
Component = Any

PAPER = "zyz"
_SMALL = tuple(
    "".join(letters) for letters in choices("xyz", repeat=3)
    if letters[0] != letters[1] != letters[2]
)  # fmt: skip
CONVENTIONS: tuple[str, ...] = (*_SMALL, *(name.upper() for name in _SMALL))
# Two components of a quaternion that are this small, relative to the other two, hold no angle any
# more: they are sums of terms of size 1 that were rounded some dozens of times on the way.
LOCKED = 64 * EPS


def checked_convention(name: object) -> str:
    """One of the 24 names; "paper" is "zyz".

    Examples
    --------
    >>> checked_convention("paper"), len(CONVENTIONS)
    ('zyz', 24)
    """
    if isinstance(name, str):
        if name == "paper":
            return PAPER
        if name in CONVENTIONS:
            return name
    # Three letters are near each other only by a low measure.
    near = checks.close_names(str(name), CONVENTIONS, cutoff=0.3)
    hint = f"Did you mean {near[0]!r}? " if near else ""
    raise UnknownNameError(
        f"Euler angles: expected the name of a convention, got {name!r}. {hint}Three letters name "
        'the axes: small for space axes in the order of the angles ("zyz", as in the paper), '
        "capitals for body axes."
    )


def hamilton_product(p: Sequence[Component], q: Sequence[Component]) -> list[Component]:
    """Product p q of quaternions given by components: the turn q, then the turn p.

    Examples
    --------
    >>> a, b = sp.symbols("a b")
    >>> hamilton_product((a, 0, 0, b), (0, 1, 0, 0))
    [0, a, b, 0]
    """
    p0, p1, p2, p3 = p
    q0, q1, q2, q3 = q
    return [
        p0 * q0 - p1 * q1 - p2 * q2 - p3 * q3,
        p0 * q1 + p1 * q0 + p2 * q3 - p3 * q2,
        p0 * q2 - p1 * q3 + p2 * q0 + p3 * q1,
        p0 * q3 + p1 * q2 - p2 * q1 + p3 * q0,
    ]


def rotation_rows(q: Sequence[Component]) -> list[list[Component]]:
    """Rows of the rotation matrix, body to space, times the square of the quaternion's length.

    Examples
    --------
    >>> w, x, y, z = sp.symbols("w x y z")
    >>> rotation_rows((w, x, y, z))[2]
    [-2*w*y + 2*x*z, 2*w*x + 2*y*z, w**2 - x**2 - y**2 + z**2]
    """
    w, x, y, z = q
    return [
        [w * w + x * x - y * y - z * z, 2 * (x * y - w * z), 2 * (x * z + w * y)],
        [2 * (x * y + w * z), w * w - x * x + y * y - z * z, 2 * (y * z - w * x)],
        [2 * (x * z - w * y), 2 * (y * z + w * x), w * w - x * x - y * y + z * z],
    ]


def quaternion_rates(q: Sequence[sp.Expr], omega: Sequence[sp.Expr]) -> list[sp.Expr]:
    """Rates of the quaternion of a body with angular velocity omega (body axes), in symbols.

    Equation
    --------
    q' = q (0, omega) / 2
    """
    return [rate / 2 for rate in hamilton_product(q, (sp.S.Zero, *omega))]


def product(p: ArrayLike, q: ArrayLike) -> Array:
    """Product p q of quaternions, shape (..., 4): the turn q, then the turn p.

    Examples
    --------
    >>> product([0, 1, 0, 0], [0, 0, 1, 0]).tolist()
    [0.0, 0.0, 0.0, 1.0]
    """
    left = np.moveaxis(_array(p, (4,), "quaternion"), -1, 0)
    right = np.moveaxis(_array(q, (4,), "quaternion"), -1, 0)
    return np.stack(hamilton_product(list(left), list(right)), -1)


def rotated(quaternion: ArrayLike, vector: ArrayLike) -> Array:
    """R(q) v: a vector of the body as space sees it, shape (..., 3), for a unit quaternion.

    Examples
    --------
    >>> rotated([0, 0, 0, 1], [1, 2, 3]).tolist()
    [-1.0, -2.0, 3.0]
    """
    q, v = _array(quaternion, (4,), "quaternion"), _array(vector, (3,), "vector")
    scalar, axis = q[..., :1], q[..., 1:]
    across = np.cross(axis, v)
    return v + 2 * (scalar * across + np.cross(axis, across))


def matrix_from_quaternion(quaternion: ArrayLike) -> Array:
    """R of shape (..., 3, 3) from q of shape (..., 4), of any length but 0.

    Examples
    --------
    >>> matrix_from_quaternion([1, 0, 0, 0]).tolist()
    [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]]
    """
    q = _array(quaternion, (4,), "quaternion")
    rows = rotation_rows(list(np.moveaxis(q / np.linalg.norm(q, axis=-1, keepdims=True), -1, 0)))
    return np.stack([np.stack(row, -1) for row in rows], -2)


def quaternion_from_matrix(matrix: ArrayLike) -> Array:
    """q of shape (..., 4), q0 >= 0, from R of shape (..., 3, 3).

    The largest of the four components is found first, so that no sum cancels.

    Examples
    --------
    >>> quaternion_from_matrix([[0, -1, 0], [1, 0, 0], [0, 0, 1]]).round(12).tolist()
    [0.707106781187, 0.0, 0.0, 0.707106781187]
    """
    r = _array(matrix, (3, 3), "matrix")
    d0, d1, d2 = r[..., 0, 0], r[..., 1, 1], r[..., 2, 2]
    plus = {(i, j): r[..., i, j] + r[..., j, i] for i, j in ((0, 1), (0, 2), (1, 2))}
    x, y, z = (
        r[..., 2, 1] - r[..., 1, 2], r[..., 0, 2] - r[..., 2, 0], r[..., 1, 0] - r[..., 0, 1]
    )  # fmt: skip
    # Row k of the symmetric matrix 4 q q^T is proportional to q; the longest is the safest.
    table = np.stack(
        [
            np.stack([1 + d0 + d1 + d2, x, y, z], -1),
            np.stack([x, 1 + d0 - d1 - d2, plus[0, 1], plus[0, 2]], -1),
            np.stack([y, plus[0, 1], 1 - d0 + d1 - d2, plus[1, 2]], -1),
            np.stack([z, plus[0, 2], plus[1, 2], 1 - d0 - d1 + d2], -1),
        ],
        -2,
    )
    best = np.argmax(np.diagonal(table, axis1=-2, axis2=-1), axis=-1)
    q = np.take_along_axis(table, best[..., None, None], axis=-2)[..., 0, :]
    q = q / np.linalg.norm(q, axis=-1, keepdims=True)
    return np.where(q[..., :1] < 0, -q, q) + 0.0


def quaternion_from_rotation_vector(vector: ArrayLike) -> Array:
    """q of shape (..., 4) of the turn about v, shape (..., 3), by the angle |v|, rad.

    Examples
    --------
    >>> quaternion_from_rotation_vector([0, 0, np.pi / 2]).round(6).tolist()
    [0.707107, 0.0, 0.0, 0.707107]
    """
    v = _array(vector, (3,), "rotation vector")
    half = np.linalg.norm(v, axis=-1, keepdims=True) / 2
    # numpy's sinc(x) is sin(pi x) / (pi x), and 1 at 0: small turns lose nothing.
    return np.concatenate([np.cos(half), np.sinc(half / np.pi) * v / 2], axis=-1)


def rotation_vector_from_quaternion(quaternion: ArrayLike) -> Array:
    """Rotation vector v of shape (..., 3): axis times angle, rad, with 0 <= angle <= pi.

    Each component is accurate to a few roundings of |v|, for tiny angles and near pi. Half a turn
    has two rotation vectors, v and -v; q0 >= 0 (or the vector part, where q0 = 0) decides.

    Parameters
    ----------
    quaternion
        q of shape (..., 4), of any length but 0; q and -q give the same vector.

    Raises
    ------
    StartError
        A quaternion is 0 or not finite.

    Examples
    --------
    >>> rotation_vector_from_quaternion([0, 0, 0, 1]).round(6).tolist()
    [0.0, 0.0, 3.141593]
    """
    q = _array(quaternion, (4,), "quaternion")
    largest = np.abs(q).max(axis=-1, keepdims=True)
    if not (np.isfinite(largest) & (largest > 0)).all():
        raise StartError(
            "quaternion: expected finite numbers, not all 0, got a quaternion without a "
            "direction. Use (1, 0, 0, 0) for no rotation."
        )
    # Division by a power of two is exact, and squares do not overflow.
    q = np.ldexp(q, -np.frexp(largest)[1])
    q = np.where(q[..., :1] < 0, -q, q)
    scalar, part = q[..., :1], q[..., 1:]
    # Squares of tiny vector parts would underflow: their length is computed from a scaled copy.
    most = np.abs(part).max(axis=-1, keepdims=True)
    unit = part / np.where(most > 0, most, 1.0)
    norm = np.linalg.norm(unit, axis=-1, keepdims=True)
    # The arc tangent of both lengths loses nothing at either end, where an arc cosine loses half.
    return 2 * np.arctan2(most * norm, scalar) * unit / np.where(norm > 0, norm, 1.0) + 0.0


def rotation_vector_from_matrix(matrix: ArrayLike) -> Array:
    """Rotation vector v of shape (..., 3), rad, |v| <= pi, of R of shape (..., 3, 3).

    Near pi the axis is read off the symmetric part of R, so that no digits are lost.

    Raises
    ------
    StartError
        A matrix is not a rotation.

    Examples
    --------
    >>> rotation_vector_from_matrix([[0, -1, 0], [1, 0, 0], [0, 0, 1]]).round(6).tolist()
    [0.0, 0.0, 1.570796]
    """
    return rotation_vector_from_quaternion(quaternion_from_matrix(checked_rotations(matrix)))


def checked_rotations(matrix: ArrayLike) -> Array:
    """Matrices of shape (..., 3, 3), each found to be a rotation.

    Raises
    ------
    StartError
        The columns of one are not finite or not orthonormal, or it is a reflection.

    Examples
    --------
    >>> checked_rotations(np.diag([1, -1, -1])).shape
    (3, 3)
    """
    r = _array(matrix, (3, 3), "matrix")
    with np.errstate(all="ignore"):
        excess = np.abs(np.swapaxes(r, -1, -2) @ r - np.eye(3)).max(initial=0.0)
    if not excess <= PRINTED:
        raise StartError(
            "attitude matrix: expected a rotation, got a matrix with R^T R - 1 of size "
            f"{excess:.3g}. Give orthogonal columns of length 1, the body axes in space."
        )
    if (np.linalg.det(r) < 0).any():
        raise StartError(
            "attitude matrix: expected a rotation, got a reflection (determinant -1). Change the "
            "sign of a column so that the body axes are right-handed."
        )
    return r


def quaternion_from_euler(angles: ArrayLike, convention: str = PAPER) -> Array:
    """q of shape (..., 4) from angles of shape (..., 3), rad.

    Examples
    --------
    >>> quaternion_from_euler([0, 0.2, 0]).round(6).tolist()  # phi2 tilts about y
    [0.995004, 0.0, 0.099833, 0.0]
    """
    name = checked_convention(convention)
    turns = _array(angles, (3,), "angles")
    # Each step turns about space axes, so that body axes are taken in reverse order.
    order = [0, 1, 2] if name.islower() else [2, 1, 0]
    q = np.zeros((*turns.shape[:-1], 4))
    q[..., 0] = 1.0
    for k in order:
        step = np.zeros_like(q)
        step[..., 0] = np.cos(turns[..., k] / 2)
        step[..., 1 + "xyz".index(name.lower()[k])] = np.sin(turns[..., k] / 2)
        q = product(step, q)
    return q


def euler_from_quaternion(
    quaternion: ArrayLike, convention: str = PAPER, *, continuous: bool = False
) -> Array:
    """Angles of shape (..., 3), rad, from q of shape (..., 4); accurate at gimbal lock too.

    The middle angle is in [0, pi] ("zyz" and its like) or [-pi/2, pi/2] ("xyz" and its like), the
    others in (-pi, pi]. Where they are locked, only their sum or difference means something: they
    keep the part that is lost from the attitude before (or after) in the array, else the third
    angle is 0.

    Equation
    --------
    phi2 = 2 atan2(|(q1, q2)|, |(q0, q3)|), phi3 + phi1 = 2 atan2(q3, q0), and likewise in the
    other conventions (Bernardes and Viollet 2022)

    Parameters
    ----------
    continuous
        first and third angle continue beyond pi along the first axis, without jumps by 2 pi.

    Examples
    --------
    >>> euler_from_quaternion(quaternion_from_euler([0.1, 1e-9, 0.2])).round(12).tolist()
    [0.1, 1e-09, 0.2]
    """
    name = checked_convention(convention)
    q = _array(quaternion, (4,), "quaternion")
    # Turns about space axes in one order are those about body axes in the other.
    i, j, k = ("xyz".index(c) for c in (name if name.islower() else name[::-1].lower()))
    proper = i == k
    k = 3 - i - j if proper else k
    # 1 for axes that follow each other cyclically, -1 else: the permutation symbol.
    sign = (i - j) * (j - k) * (k - i) // 2
    w, x, y, z = q[..., 0], q[..., 1 + i], q[..., 1 + j], sign * q[..., 1 + k]
    a, b, c, d = (w, x, y, z) if proper else (w - y, x + z, y + w, z - x)
    # Arc tangents of both lengths lose nothing at either lock, where an arc cosine loses half.
    near, far = np.hypot(a, b), np.hypot(c, d)
    middle = 2 * np.arctan2(far, near)
    size = LOCKED * np.hypot(near, far)
    half_sum = _kept(np.arctan2(b, a), near <= size)
    half_difference = _kept(np.arctan2(d, c), far <= size)
    # Capitals come out in the reverse order: their third angle is `first` here.
    other = -1 if name.islower() else 1
    half_sum = np.where(np.isnan(half_sum), other * half_difference, half_sum)
    half_difference = np.where(np.isnan(half_difference), other * half_sum, half_difference)
    first, third = half_sum - half_difference, half_sum + half_difference
    if not proper:
        third, middle = sign * third, middle - np.pi / 2
    # -pi and rounding beyond it count as pi.
    first, third = (np.pi - np.mod(np.pi - angle, 2 * np.pi) for angle in (first, third))
    if continuous and q.ndim > 1:
        first, third = np.unwrap(first, axis=0), np.unwrap(third, axis=0)
    angles = (first, middle, third) if name.islower() else (third, middle, first)
    return np.stack(angles, -1) + 0.0


def checked_quaternion(quaternion: object) -> Array:
    """A unit quaternion, shape (4,); rounding in the input is taken out.

    Raises
    ------
    StartError
        it is 0, not finite, or not of unit length.
    """
    q = _numbers(quaternion, (4,), "quaternion", "four numbers, scalar first")
    length = float(np.linalg.norm(q))
    if length == 0:
        raise StartError("quaternion: expected length 1, got 0. Use (1, 0, 0, 0) for no rotation.")
    if abs(length - 1) > PRINTED:
        shown = ", ".join(f"{x:.9g}" for x in q / length)
        raise StartError(
            f"quaternion: expected length 1, got {length:.9g}. Divide by it: ({shown})."
        )
    return q / length


def checked_matrix(matrix: object) -> Array:
    """The unit quaternion, shape (4,), of a rotation matrix; rounding is taken out.

    Raises
    ------
    StartError
        its columns are not orthonormal, or it is a reflection.
    """
    r = checked_rotations(_numbers(matrix, (3, 3), "matrix", "3 x 3 numbers, body to space"))
    # The nearest rotation: the polar factor, without any stretch.
    left, _, right = np.linalg.svd(r)
    return quaternion_from_matrix(left @ right)


def _kept(angles: Array, lost: NDArray[np.bool_]) -> Array:
    """Angles, lost ones replaced by the one before (else after) along the first axis, else nan."""
    angles = np.where(lost, np.nan, angles)
    if angles.ndim != 1 or not lost.any() or lost.all():
        return angles
    indices = np.flatnonzero(~lost)
    before = np.searchsorted(indices, np.arange(len(angles)), "right") - 1
    return angles[indices[np.maximum(before, 0)]]


def _array(values: ArrayLike, shape: tuple[int, ...], name: str) -> Array:
    """An array of floats that ends in this shape."""
    form = (..., *shape)
    return checks.array(values, name, StartError, shape=form, shape_error=ShapeError, infinite=None)


def _numbers(values: object, shape: tuple[int, ...], name: str, wanted: str) -> Array:
    """Finite numbers of this shape, as part of a start."""
    return checks.array(values, name, StartError, shape=shape, expected=wanted)

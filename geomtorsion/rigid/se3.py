"""SE(3): rigid displacements as 4 x 4 matrices, with exponential, logarithm and adjoint.

A pose [[R, x], [0, 1]] maps body to space: X = R Y + x. A twist is (omega, v), rotation first, as
the frame of r3xso3 orders (phi, x). Arrays may have any leading shape.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

from geomtorsion.errors import ShapeError, StartError
from geomtorsion.rigid.attitude import (
    Array,
    checked_rotations,
    matrix_from_quaternion,
    quaternion_from_rotation_vector,
    rotation_vector_from_matrix,
)
from geomtorsion.support import checks
from geomtorsion.support.precision import PRINTED


def exp(twist: ArrayLike) -> Array:
    """Pose, shape (..., 4, 4), after unit time at a constant twist, shape (..., 6): a screw.

    Equation
    --------
    R = exp(omega^),  x = (1 + (1 - cos a)/a n^ + (1 - sin(a)/a) n^ n^) v,  omega = a n

    Raises
    ------
    StartError
        A number is not finite.

    Examples
    --------
    >>> exp([0, 0, np.pi, 1, 0, 0]).round(6).tolist()[1]
    [0.0, -1.0, 0.0, 0.63662]
    """
    omega, v = _twists(twist)
    angle, axis = _angle_and_axis(omega)
    half = angle / 2
    # numpy's sinc(x) is sin(pi x) / (pi x); with it no quotient is 0 / 0 at small angles.
    once = np.sin(half) * np.sinc(half / np.pi)
    twice = 1 - np.sinc(angle / np.pi)
    across = np.cross(axis, v)
    rotation = matrix_from_quaternion(quaternion_from_rotation_vector(omega))
    return pose(rotation, v + once * across + twice * np.cross(axis, across))


def log(pose: ArrayLike) -> Array:
    """Twist (omega, v), shape (..., 6), whose `exp` is a pose, shape (..., 4, 4); |omega| <= pi.

    Raises
    ------
    StartError
        A pose has no rotation matrix, is not finite, or its last row is not (0, 0, 0, 1).

    Examples
    --------
    >>> log(exp([0.1, 0.2, 3.0, 1, 2, 3])).round(12).tolist()
    [0.1, 0.2, 3.0, 1.0, 2.0, 3.0]
    """
    rotation, x = _parts(pose)
    omega = rotation_vector_from_matrix(rotation)
    angle, axis = _angle_and_axis(omega)
    half = angle / 2
    twice = 1 - np.cos(half) / np.sinc(half / np.pi)
    across = np.cross(axis, x)
    v = x - half * across + twice * np.cross(axis, across)
    return np.concatenate([omega, v], axis=-1)


def adjoint(pose: ArrayLike) -> Array:
    """Ad_g of shape (..., 6, 6): the twist of a body as space sees it, (omega, v) -> g (.) g^-1.

    Equation
    --------
    Ad_g = [[R, 0], [x^ R, R]]

    Raises
    ------
    StartError
        As for `log`.

    Examples
    --------
    >>> moved = [[1, 0, 0, 2], [0, 1, 0, 0], [0, 0, 1, 0], [0, 0, 0, 1]]
    >>> (adjoint(moved) @ [0, 0, 1, 0, 0, 0]).tolist()
    [0.0, 0.0, 1.0, 0.0, -2.0, 0.0]
    """
    rotation, x = _parts(pose)
    matrix = np.zeros((*rotation.shape[:-2], 6, 6))
    matrix[..., :3, :3] = matrix[..., 3:, 3:] = rotation
    # Column by column x cross R_j.
    matrix[..., 3:, :3] = np.cross(x[..., :, None], rotation, axis=-2)
    return matrix


def pose(rotation: ArrayLike, position: ArrayLike) -> Array:
    """Pose [[R, x], [0, 1]], shape (..., 4, 4), of a rotation matrix and a position.

    Raises
    ------
    StartError
        The matrix is not a rotation.

    Examples
    --------
    >>> pose(np.eye(3), [1, 2, 3]).tolist()[0]
    [1.0, 0.0, 0.0, 1.0]
    """
    r, x = checked_rotations(rotation), _finite(position, (3,), "position")
    shape = np.broadcast_shapes(r.shape[:-2], x.shape[:-1])
    matrix = np.zeros((*shape, 4, 4))
    matrix[..., :3, :3], matrix[..., :3, 3], matrix[..., 3, 3] = r, x, 1.0
    return matrix


def _angle_and_axis(omega: Array) -> tuple[Array, Array]:
    """|omega| and the unit vector along it, 0 where nothing turns."""
    most = np.abs(omega).max(axis=-1, keepdims=True)
    scaled = omega / np.where(most > 0, most, 1.0)
    norm = np.linalg.norm(scaled, axis=-1, keepdims=True)
    return most * norm, scaled / np.where(norm > 0, norm, 1.0)


def _twists(twist: ArrayLike) -> tuple[Array, Array]:
    """omega and v of twists."""
    values = _finite(twist, (6,), "twist")
    return values[..., :3], values[..., 3:]


def _parts(pose: ArrayLike) -> tuple[Array, Array]:
    """R and x of poses."""
    values = _finite(pose, (4, 4), "pose")
    if np.abs(values[..., 3, :] - np.array([0, 0, 0, 1])).max(initial=0.0) > PRINTED:
        raise StartError(
            "pose: expected (0, 0, 0, 1) as last row, got "
            f"{checks.shown(values[..., 3, :].tolist())}. A pose is [[R, x], [0, 1]]."
        )
    return checked_rotations(values[..., :3, :3]), values[..., :3, 3]


def _finite(values: ArrayLike, shape: tuple[int, ...], name: str) -> Array:
    """Finite numbers in an array that ends in this shape."""
    return checks.array(values, name, StartError, shape=(..., *shape), shape_error=ShapeError)

"""Body angles: those of an axis, and vectors in axes that tilt but do not spin with the body."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

from geomtorsion.rigid.attitude import euler_from_quaternion


def nutation(vertical: ArrayLike) -> np.ndarray:
    """phi2, the angle between the third body axis and the vertical n, shape (m,), rad.

    Equation
    --------
    phi2 = atan2(|(n1, n2)|, n3): as accurate at 0 and pi as elsewhere

    Examples
    --------
    >>> nutation([[1e-9, 0, 1.0]]).tolist()
    [1e-09]
    """
    n = np.asarray(vertical, dtype=float)
    return np.arctan2(np.hypot(n[..., 0], n[..., 1]), n[..., 2])


def spin(vertical: ArrayLike) -> np.ndarray:
    """phi1, the angle of rotation about the third body axis, without jumps, shape (m,), rad.

    Equation
    --------
    n = (-sin phi2 cos phi1, sin phi2 sin phi1, cos phi2)

    Examples
    --------
    >>> spin([[-1.0, 0.0, 0.0], [0.0, 1.0, 0.0]]).round(6).tolist()
    [0.0, 1.570796]
    """
    n = np.asarray(vertical, dtype=float)
    # Adding 0.0 turns -0.0 into 0.0, whose angle is 0 and not pi.
    return np.unwrap(np.arctan2(n[..., 1], -n[..., 0] + 0.0), axis=0)


def precession(quaternion: ArrayLike) -> np.ndarray:
    """phi3, the angle of the third body axis about the vertical, without jumps, shape (m,), rad."""
    return euler_from_quaternion(quaternion, continuous=True)[..., 2]


def unspun(vectors: ArrayLike) -> np.ndarray:
    """Components along the line of the tilt, the line of nodes and the third body axis.

    These axes follow the third body axis without spinning with it: Rz(phi3) Ry(phi2) of the
    paper's angles. Where it is vertical, phi1 counts as 0.

    Parameters
    ----------
    vectors
        shape (m, 6): a vector in body axes and the vertical n in body axes.

    Returns
    -------
    Array, shape (m, 3): Rz(phi1) v.

    Examples
    --------
    >>> unspun([[1.0, 0.0, 5.0, 0.0, 1.0, 0.0]]).round(12).tolist()  # phi1 is a right angle
    [[0.0, 1.0, 5.0]]
    """
    table = np.asarray(vectors, dtype=float)
    v, n = table[..., :3], table[..., 3:]
    size = np.hypot(n[..., 0], n[..., 1])
    # Upright, phi1 has no meaning by itself; 0 keeps the vector as it is.
    upright = size == 0
    safe = np.where(upright, 1.0, size)
    cos, sin = np.where(upright, 1.0, -n[..., 0] / safe), n[..., 1] / safe
    rows = (cos * v[..., 0] - sin * v[..., 1], sin * v[..., 0] + cos * v[..., 1], v[..., 2])
    return np.stack(rows, -1) + 0.0

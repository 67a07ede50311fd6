"""A rigid body integrated by brute force: the matrix R and SciPy, without any code of scenes."""

from __future__ import annotations

import numpy as np
from scipy.integrate import solve_ivp


def hat(v):
    return np.array([[0, -v[2], v[1]], [v[2], 0, -v[0]], [-v[1], v[0], 0]])


def zyz(phi1, phi2, phi3):
    def rz(a):
        return np.array([[np.cos(a), -np.sin(a), 0], [np.sin(a), np.cos(a), 0], [0, 0, 1]])

    ry = np.array([[np.cos(phi2), 0, np.sin(phi2)], [0, 1, 0], [-np.sin(phi2), 0, np.cos(phi2)]])
    return rz(phi3) @ ry @ rz(phi1)


def motion(
    inertia, omega, matrix, times, moment, position=(0, 0, 0), velocity=(0, 0, 0), accel=None
):
    """omega (m, 3), R (m, 3, 3), x and v (m, 3): I omega' = M - omega x I omega, R' = R [omega].

    moment(t, omega, R, x, v) in body axes about the reference point of `inertia`; accel likewise.
    """
    inertia = np.asarray(inertia, dtype=float)
    inverse = np.linalg.inv(inertia)

    def rates(t, y):
        w, r, x, v = y[:3], y[3:12].reshape(3, 3), y[12:15], y[15:]
        turn = inverse @ (moment(t, w, r, x, v) - np.cross(w, inertia @ w))
        push = accel(t, w, r, x, v) if accel else np.zeros(3)
        return np.concatenate([turn, (r @ hat(w)).ravel(), v, push])

    start = np.concatenate([omega, np.asarray(matrix).ravel(), position, velocity])
    run = solve_ivp(
        rates, (0, times[-1]), start, method="DOP853", t_eval=times, rtol=3e-13, atol=1e-14
    )
    assert run.success
    y = run.y.T
    return y[:, :3], y[:, 3:12].reshape(-1, 3, 3), y[:, 12:15], y[:, 15:]

"""Samples: random frames with random connections, polynomial in the coordinates."""

from __future__ import annotations

import random

import numpy as np
import sympy as sp

import geomtorsion as gt

COORDINATES = sp.symbols("x0 x1 x2 x3 x4", real=True)


def sample_frame(n: int, seed: int) -> gt.Frame:
    """A random coframe, polynomial in the coordinates, in a signature with one minus."""
    chosen = random.Random(seed)
    q = COORDINATES[:n]
    matrix = sp.eye(n)
    for i in range(n):
        for j in range(i + 1, n):
            if chosen.random() < (0.6 if n == 3 else 0.3):
                matrix[i, j] = chosen.choice(q) * chosen.choice([1, -1, 2])
    matrix[0, 0] = 1 + q[1] ** 2
    matrix[n - 1, 0] = q[0]
    return gt.Frame(q, matrix, (-1,) + (1,) * (n - 1))


def sample_connection(frame: gt.Frame, seed: int, *, metric: bool) -> gt.Connection:
    """A connection from a random spin connection, antisymmetric or general."""
    chosen = random.Random(seed)
    n, q = frame.dimension, frame.coordinates
    lower = sp.MutableDenseNDimArray.zeros(n, n, n)
    share = {2: 0.6, 3: 0.5, 4: 0.25, 5: 0.12}[n]
    for place in np.ndindex(n, n, n):
        if chosen.random() < share:
            lower[place] = chosen.choice(q) * chosen.choice([1, -1, 2]) + chosen.randint(-1, 1)
    if metric:
        lower = lower - sp.permutedims(lower, (0, 2, 1))
    eta = [frame.eta[i, i] for i in range(n)]
    omega = [[[lower[a, i, j] * eta[j] for j in range(n)] for i in range(n)] for a in range(n)]
    return gt.from_spin_connection(frame, omega)

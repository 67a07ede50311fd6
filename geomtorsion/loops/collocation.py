"""Steps: path-ordered products over short stretches, by Gauss-Legendre collocation."""

from __future__ import annotations

from functools import cache

import numpy as np


@cache
def collocation(stages: int) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Nodes and weights of Gauss on (0, 1), integrals of the node polynomials up to each node."""
    x, w = np.polynomial.legendre.leggauss(stages)
    # Integrals of Lagrange polynomials through their expansion in Legendre polynomials.
    values = np.polynomial.legendre.legvander(x, stages)
    k = np.arange(stages)
    expansion = values[:, :stages].T * w * (2 * k[:, None] + 1) / 2
    integrals = np.empty((stages, stages))
    integrals[:, 0] = x + 1
    integrals[:, 1:] = (values[:, 2:] - values[:, :-2]) / (2 * k[1:] + 1)
    return (x + 1) / 2, w / 2, integrals @ expansion / 2


def inner_turns(omega: np.ndarray, weights: np.ndarray) -> np.ndarray:
    """Y - 1 at the nodes for Y' = Y omega, Y = 1 at the start; shapes (m, stages, n, n).

    weights: the integrals of `collocation`.
    """

    # Matrices as rows: a product of weights with all stretches at once, much faster than einsum.
    flat = (*omega.shape[:2], -1)
    first = (weights @ omega.reshape(flat)).reshape(omega.shape)
    found, before = first, np.inf
    while True:
        after = first + (weights @ (found @ omega).reshape(flat)).reshape(omega.shape)
        change = np.abs(after - found).max(initial=0.0)
        found = after
        if change <= np.finfo(float).eps / 4 * np.abs(found).max(initial=0.0):
            return found
        # Where a sweep no longer halves the change, one linear system is cheaper.
        if not change < before / 2:
            return _solved(omega, weights)
        before = change


def _solved(omega: np.ndarray, weights: np.ndarray) -> np.ndarray:
    """The same by one linear system for each stretch, where the fixed point is too far."""
    m, stages, n, _ = omega.shape
    system = np.eye(stages * n) - np.einsum("kl,mlij->mkjli", weights, omega).reshape(
        m, stages * n, stages * n
    )
    first = np.einsum("kl,mlij->mkji", weights, omega).reshape(m, stages * n, n)
    found = np.linalg.solve(system, first)
    return found.reshape(m, stages, n, n).transpose(0, 1, 3, 2)


def increments(omega: np.ndarray, theta: np.ndarray) -> np.ndarray:
    """G - 1 over stretches for G' = G [[omega, theta], [0, 0]], shape (m, n + 1, n + 1).

    Order 2 * stages; quadratic invariants (lengths) are kept.

    Parameters
    ----------
    omega, theta
        Values at the nodes times the width of the stretch, shapes (m, stages, n, n) and
        (m, stages, n).
    """

    m, stages, n = theta.shape
    _, weights, integrals = collocation(stages)
    result = np.zeros((m, n + 1, n + 1), dtype=np.result_type(omega, theta))
    result[:, :n, n] = np.einsum("l,mli->mi", weights, theta)
    if omega.any():
        inner = inner_turns(omega, integrals)
        result[:, :n, :n] = np.einsum("l,mlij->mij", weights, omega + inner @ omega)
        result[:, :n, n] += np.einsum("l,mlij,mlj->mi", weights, inner, theta)
    return result


def product(increments: np.ndarray, errors: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Ordered product of 1 + increments, minus 1, and the error carried along.

    Parameters
    ----------
    increments
        Shape (m, n + 1, n + 1), in the order of the path.
    errors
        Errors of the rotation and of the translation of each, shape (m, 2).
    """

    while len(increments) > 1:
        odd = len(increments) % 2
        last, last_error = increments[-1:], errors[-1:]
        end = len(increments) - odd
        one, two = increments[0:end:2], increments[1:end:2]
        size = np.linalg.norm(one[:, :-1, :-1] + np.eye(one.shape[1] - 1), 2, axis=(1, 2))
        other = np.linalg.norm(two[:, :-1, :-1] + np.eye(one.shape[1] - 1), 2, axis=(1, 2))
        shift = np.linalg.norm(two[:, :-1, -1], axis=1)
        a, b = errors[0:end:2], errors[1:end:2]
        turn = a[:, 0] * other + size * b[:, 0]
        errors = np.stack([turn, a[:, 1] + a[:, 0] * shift + size * b[:, 1]], axis=1)
        increments = one + two + one @ two
        if odd:
            increments = np.concatenate([increments, last])
            errors = np.concatenate([errors, last_error])
    return increments[0], errors[0]

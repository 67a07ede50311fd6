"""Petrov: the algebraic type of the Weyl tensor of a space-time at a generic point."""

from __future__ import annotations

from itertools import islice, permutations

import mpmath
import numpy as np

from geomtorsion.same.invariant_values import Array, Evaluation
from geomtorsion.same.invariants import Invariants
from geomtorsion.same.matching import DIGITS
from geomtorsion.support.precision import working_digits

# Matrices whose entries are smaller than half of the digits vanish.
ZERO = DIGITS // 2


def petrov_type(metric: Invariants) -> str:
    """The type I, II, D, III, N or O at a generic point of four dimensions with one time.

    Equation
    --------
    Q_ij = C_0i0j + (i/2) epsilon_ikl C_kl0j. Type N: Q^2 = 0; III: Q^3 = 0; D: with
    x = tr Q^2, y = tr Q^3, x^2 Q^2 = x y Q + 2 y^2; II: x^3 = 6 y^2; I: none of these
                                                                [Stephani2003], section 4.2
    """
    evaluation = Evaluation(metric, 0)
    points = islice(metric.frame.region.points(), DIGITS)
    values = next((v for p in points if (v := evaluation.at(p, DIGITS)) is not None), None)
    if values is None:
        return ""
    with working_digits(DIGITS):
        return _type(_weyl(values.orders[0][0], values.signs), values.signs)


def _weyl(riemann: Array, signs: tuple[int, ...]) -> Array:
    """The trace-free part of R_abcd in an orthonormal basis of four dimensions."""
    eta = np.diag(np.array([mpmath.mpf(s) for s in signs], dtype=object))
    # R_bc = eta^ad R_abcd, with the traces that vanish for the Weyl tensor.
    ricci = np.einsum("ad,abcd->bc", eta, riemann)
    scalar = np.einsum("ab,ab->", eta, ricci)
    share = ricci / 2 - eta * (scalar / 12)
    rules = ("ad,bc->abcd", "bd,ac->abcd", "ac,bd->abcd", "bc,ad->abcd")
    rest = [np.einsum(rule, eta, share) for rule in rules]
    return riemann - rest[0] + rest[1] + rest[2] - rest[3]


def _type(weyl: Array, signs: tuple[int, ...]) -> str:
    time = next(k for k in range(4) if signs.count(signs[k]) == 1)
    space = [k for k in range(4) if k != time]
    q = np.array([[mpmath.mpc(weyl[time, i, time, j]) for j in space] for i in space], dtype=object)
    for i, k, m in permutations(range(3)):
        sign = (k - i) * (m - i) * (m - k) // 2
        for j in range(3):
            q[i, j] += mpmath.mpc(0, sign) * weyl[space[k], space[m], time, space[j]] / 2
    size = max(abs(x) for x in q.ravel())
    if not size:
        return "O"
    q = q / size
    square = q @ q
    x, y = np.trace(square), np.trace(square @ q)

    def vanishes(matrix: Array) -> bool:
        return max(abs(entry) for entry in np.ravel(matrix)) < mpmath.mpf(10) ** -ZERO

    if vanishes(square):
        return "N"
    if vanishes(square @ q):
        return "III"
    if not vanishes(np.array([x**3 - 6 * y**2])):
        return "I"
    rest = x**2 * square - x * y * q - 2 * y**2 * np.eye(3, dtype=int)
    return "D" if vanishes(rest) else "II"

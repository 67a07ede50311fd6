"""Action: e L of polynomial fields in coordinates, with numpy only, and its variation.

It shares nothing with the package: torsion, curvature and nonmetricity come from the coframe and
the spin connection, the variation from a complex step and a fourth-order difference.
"""

# Complex arrays.
# pyright: reportAttributeAccessIssue=false

from __future__ import annotations

from collections.abc import Callable
from itertools import permutations, product

import numpy as np

# A complex step has no cancellation; a difference of polynomials of low degree has an error of
# fourth order.
STEP, SPACING = 1e-30, 1e-3


def fields(eta: np.ndarray, e: np.ndarray, de: np.ndarray, w: np.ndarray, dw: np.ndarray) -> dict:
    """Fields in the frame, from e[i, m], de[a, i, m] = d_a e^i_m, w[a, i, j] = omega_ai^j and dw.

    All have a first axis, over which they are computed together.
    """
    legs = np.linalg.inv(e)
    # T^k_ab = d_a e^k_b - d_b e^k_a + w_ai^k e^i_b - w_bi^k e^i_a
    torsion = np.einsum("xakb->xabk", de) + np.einsum("xaik,xib->xabk", w, e)
    torsion = torsion - np.swapaxes(torsion, 1, 2)
    curvature = dw + np.einsum("xbij,xajk->xabik", w, w)
    curvature = curvature - np.swapaxes(curvature, 1, 2)
    lowered = np.einsum("xaij,jk->xaik", w, eta)
    nonmetricity = -lowered - np.swapaxes(lowered, 2, 3)
    return {
        "T": np.einsum("xabk,xai,xbj,kl->xijl", torsion, legs, legs, eta, optimize=True),
        "R": np.einsum("xabkl,xai,xbj,lm->xijkm", curvature, legs, legs, eta, optimize=True),
        "Q": np.einsum("xajk,xai->xijk", nonmetricity, legs),
        "e": np.linalg.det(e),
    }


def invariants(eta: np.ndarray, known: dict) -> dict[str, np.ndarray]:
    """The invariants of the fields, by their definitions."""
    T, R, Q = known["T"], known["R"], known["Q"]
    up = np.linalg.inv(eta)
    n = len(eta)

    def square(one: np.ndarray, other: np.ndarray) -> np.ndarray:
        for axis in range(1, one.ndim):
            one = np.moveaxis(np.tensordot(one, up, (axis, 0)), -1, axis)
        return (one * other).reshape(len(one), -1).sum(1)

    v = np.einsum("xabc,bc->xa", T, up)
    ricci = np.einsum("xabcd,ad->xbc", R, up)
    scalar = np.einsum("xbc,bc->x", ricci, up)
    long, short = np.einsum("xabc,bc->xa", Q, up), np.einsum("xabc,ab->xc", Q, up)
    found = {
        "T1": square(T, T),
        "T2": square(T, np.einsum("xabc->xcba", T)),
        "T3": square(v, v),
        "R": scalar,
        "R1": square(R, R),
        "R2": square(R, np.einsum("xabcd->xacbd", R)),
        "R3": square(R, np.einsum("xabcd->xcdab", R)),
        "R4": square(ricci, ricci),
        "R5": square(ricci, np.swapaxes(ricci, 1, 2)),
        "R6": scalar**2,
        "Q1": square(Q, Q),
        "Q2": square(Q, np.swapaxes(Q, 1, 2)),
        "Q3": square(long, long),
        "Q4": square(short, short),
        "Q5": square(long, short),
        "U1": square(T, Q),
        "U2": square(v, long),
        "U3": square(v, short),
    }
    homothetic = np.einsum("xabcd,cd->xab", R, up)
    found["R7"] = square(homothetic, homothetic)
    turning = (R - np.swapaxes(R, 3, 4)) / 2
    cyclic = turning + np.einsum("xabcd->xbcad", turning) + np.einsum("xabcd->xcabd", turning)
    # The cyclic sum of X_abc with two more signed orders is X_[abcd].
    pairs = cyclic + np.einsum("xabcd->xdcba", cyclic)
    found["P3"] = square(turning, pairs + np.einsum("xabcd->xbadc", pairs)) / 12
    if n == 4:
        epsilon = np.zeros((4, 4, 4, 4))
        for order in permutations(range(4)):
            epsilon[order] = np.linalg.det(np.eye(4)[list(order)])
        raised = np.einsum("abcd,ae,bf,cg,dh->efgh", epsilon, up, up, up, up)
        found["holst"] = np.einsum("abcd,xabcd->x", raised, R)
    return found


def _alternating(field: np.ndarray) -> np.ndarray:
    """X_[abcd]."""
    total = np.zeros_like(field)
    for order in permutations(range(4)):
        sign = np.linalg.det(np.eye(4)[list(order)])
        total = total + sign * np.moveaxis(field, [k + 1 for k in order], [1, 2, 3, 4])
    return total / 24


Polynomial = Callable[[np.ndarray], tuple[np.ndarray, np.ndarray]]
Density = Callable[[np.ndarray, np.ndarray, np.ndarray, np.ndarray], np.ndarray]


def variation(
    density: Density, e: Polynomial, w: Polynomial, point: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """d(density)/de^i_m and d(density)/dw_ai^j at a point, by Euler and Lagrange.

    density: function of arrays e, de, w, dw with a first axis. e, w: point -> (values, derivatives
    with the direction first).
    """
    n = len(point)
    shapes = (n, n), (n, n, n)
    found = []
    for which, shape in enumerate(shapes):
        places = list(product(*map(range, shape)))

        def slopes(at: np.ndarray, along: int | None, which=which, places=places) -> np.ndarray:
            """d(density)/d(field) or, for a direction, d(density)/d(derivative of the field)."""
            arrays = [np.array(x, complex) for pair in (e(at), w(at)) for x in pair]
            batch = [np.repeat(x[None], len(places), 0) for x in arrays]
            for k, place in enumerate(places):
                if along is None:
                    batch[2 * which][(k, *place)] += 1j * STEP
                else:
                    batch[2 * which + 1][(k, along, *place)] += 1j * STEP
            return density(*batch).imag / STEP

        total = slopes(point, None)
        for m in range(n):
            step = np.eye(n)[m] * SPACING
            near = [slopes(point + k * step, m) for k in (-2, -1, 1, 2)]
            total = total - (near[0] - 8 * near[1] + 8 * near[2] - near[3]) / (12 * SPACING)
        found.append(total.reshape(shape))
    return found[0], found[1]

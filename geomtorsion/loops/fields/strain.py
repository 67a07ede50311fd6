"""Strain: distortions from a strain and a rotation, as diffraction and image correlation give."""

from __future__ import annotations

import numpy as np

from geomtorsion.errors import GridError
from geomtorsion.loops.fields.grid import REGULAR, numbers


def strain_and_rotation(strain: object, rotation: object) -> np.ndarray:
    """beta = strain + rotation, d_j u_i = e_ij + w_ij, shape (n, n, grid...)."""
    e = numbers(strain, "strain")
    if e.ndim < 3 or e.shape[0] != e.shape[1] or e.shape[0] not in (2, 3):
        raise GridError(
            f"strain: shape (2, 2, grid...) or (3, 3, grid...) was needed, but {e.shape} came."
        )
    _check_turned(e, 1, "strain", "symmetric")
    return e + skew(rotation, len(e), e.shape[2:])


def skew(rotation: object, n: int, shape: tuple[int, ...]) -> np.ndarray:
    """A rotation as w_ij = (d_j u_i - d_i u_j) / 2, from that, from its vector or its angle.

    The vector w turns as u = w x r does: w_ij = - eps_ijk w_k; an angle is w_3.
    """
    w = numbers(rotation, "rotation")
    if w.shape == (n, n, *shape):
        _check_turned(w, -1, "rotation", "antisymmetric")
        return w
    found = np.zeros((n, n, *shape))
    if n == 2 and w.shape == shape:
        found[1, 0], found[0, 1] = w, -w
        return found
    if n == 3 and w.shape == (3, *shape):
        for i, j, k in ((0, 1, 2), (1, 2, 0), (2, 0, 1)):
            found[j, i], found[i, j] = w[k], -w[k]
        return found
    other = f"{shape} (angle)" if n == 2 else f"{(3, *shape)} (vector)"
    raise GridError(
        f"rotation: shape {(n, n, *shape)} (matrix) or {other} was needed, but {w.shape} came."
    )


def _check_turned(values: np.ndarray, sign: int, name: str, word: str) -> None:
    """Refuse a matrix that is not symmetric, or not antisymmetric."""
    with np.errstate(invalid="ignore"):
        # Tables are rounded as axes are.
        away = np.abs(values - sign * np.swapaxes(values, 0, 1))
        bad = np.argwhere(away > REGULAR * np.nanmax(np.abs(values), initial=0.0))
    if len(bad):
        i, j, *node = bad[0].tolist()
        raise GridError(
            f"{name}: {word} matrices were needed, but at node {tuple(node)} [{i}, {j}] is "
            f"{values[(i, j, *node)]:.6g} and [{j}, {i}] is {values[(j, i, *node)]:.6g}. "
            "For a distortion use from_distortion."
        )

"""Metrics: orthonormal coframes of a metric on a grid, of any signature."""

from __future__ import annotations

import numpy as np

from geomtorsion.errors import GridError, SignatureError
from geomtorsion.materials.fields.grid import mask_of, numbers, signs_of
from geomtorsion.materials.fields.samples import check_turned

SIGNS = {-1: "-", 1: "+"}


def orthonormal_coframe(
    metric: object, signature: object, mask: object = None
) -> tuple[np.ndarray, str]:
    """A smooth coframe with g = e^T eta e by completing squares, and the signs of its rows.

    Nodes with NaN stay unknown. The squares are completed in one order of the coordinates at all
    nodes, so that the coframe has no jumps.
    """
    g = numbers(metric, "metric")
    n = len(g)
    if g.ndim < 3 or g.shape[1] != n:
        raise GridError(f"metric: expected shape (n, n, grid...), got {g.shape}.")
    check_turned(g, 1, "metric", "symmetric")
    known = ~np.isnan(g).any(axis=(0, 1)) & ~mask_of(mask, g.shape[2:])
    if not known.any():
        raise GridError(
            "metric: expected values at some nodes, got none: every node is masked or has a NaN."
        )
    columns = g[:, :, known]
    columns = (columns + np.swapaxes(columns, 0, 1)) / 2
    squares = _squares(columns)
    if squares is None:
        # Coordinates that are null somewhere: the axes of the mean metric are not.
        axes = np.linalg.eigh(columns.mean(axis=2))[1]
        squares = _squares(np.einsum("ai,abk,bj->ijk", axes, columns, axes))
        if squares is None:
            node = tuple(np.argwhere(known)[0].tolist())
            raise GridError(
                "metric: expected one signature and one order of the coordinates in which squares "
                f"can be completed at all nodes, as at node {node}, got none. Mask the nodes where "
                "the metric is degenerate, or use other coordinates."
            )
        squares = np.einsum("iak,ba->ibk", squares[0], axes), squares[1]
    rows, signs = squares
    text = _checked(signature, signs)
    order = _order(signs, signs_of(text, n))
    coframe = np.full(g.shape, np.nan)
    coframe[:, :, known] = rows[order]
    return coframe, text


def _squares(metric: np.ndarray) -> tuple[np.ndarray, list[int]] | None:
    """Rows of the coframe, shape (n, n, nodes), and their signs; None where a square vanishes."""
    n, left = len(metric), metric.copy()
    rows, signs = np.zeros_like(metric), [0] * n
    rest = set(range(n))
    while rest:
        spread = {k: _spread(left[k, k]) for k in sorted(rest)}
        k = max(spread, key=lambda x: spread[x])
        if not spread[k] > 0:
            return None
        pivot = left[k, k].copy()
        signs[k] = 1 if pivot[0] > 0 else -1
        row = left[k] / pivot
        rows[k] = row * np.sqrt(np.abs(pivot))
        left -= row[:, None] * row[None] * pivot
        left[k], left[:, k] = 0.0, 0.0
        rest.remove(k)
    return rows, signs


def _spread(values: np.ndarray) -> float:
    """Smallest over largest size of values of one sign; 0 for two signs."""
    low, high = float(values.min()), float(values.max())
    if low <= 0 <= high:
        return 0.0
    return min(abs(low), abs(high)) / max(abs(low), abs(high))


def _checked(signature: object, signs: list[int]) -> str:
    """The requested order of signs, or negative ones first, if the metric has them."""
    own = "".join(SIGNS[x] for x in sorted(signs))
    if not signature:
        return own
    text = "".join(SIGNS[x] for x in signs_of(signature, len(signs)))
    if sorted(text) != sorted(own):
        raise SignatureError(
            f"signature: expected the signs of the metric, {own}, got {text}. Omit the signature, "
            "or give the metric with the other sign."
        )
    return text


def _order(signs: list[int], target: tuple[int, ...]) -> list[int]:
    """Which row comes at each place, so that the signs are in the requested order."""
    places = {sign: [k for k, x in enumerate(signs) if x == sign] for sign in (-1, 1)}
    return [places[sign].pop(0) for sign in target]

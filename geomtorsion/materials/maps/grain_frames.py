"""Grain frames: the coframe of a grain on the nodes of a square grid, from any map."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from geomtorsion.materials.fields import SampledFrame


def frame_of_grain(
    coframe: np.ndarray,
    mine: np.ndarray,
    steps: Sequence[float],
    shift: float,
    order: int,
    sigma: float,
    unit: str,
) -> SampledFrame:
    """The coframe of a grain; pixels of other grains are holes.

    On a hexagonal grid, the coframe is interpolated along each row to the columns halfway between
    even and odd rows, by cubic polynomials, or by quadratic ones beside holes. All rows are then a
    quarter of a step away from their pixels, so that errors do not alternate.

    coframe: in axes of the crystal, shape (rows, columns, 2, 3). mine: pixels of the grain. shift:
    of every second row, in steps.
    """
    values, first = np.where(mine[..., None, None], coframe, np.nan), 0
    if shift:
        values, first = _halfway(values, shift), 1
    rows, columns = values.shape[:2]
    axes = [steps[0] * (first + shift / 2 + np.arange(columns)), steps[1] * np.arange(rows)]
    values = values.transpose(2, 3, 1, 0)
    return SampledFrame(axes, values, order, ("x", "y"), sigma=sigma, unit=unit)


def _halfway(values: np.ndarray, shift: float) -> np.ndarray:
    """Values halfway between the columns of even and odd rows, from the second column on."""
    count = values.shape[1]
    padded = np.pad(values, ((0, 0), (2, 2), (0, 0), (0, 0)), constant_values=np.nan)
    result = np.full((len(values), count - 2, *values.shape[2:]), np.nan)
    for parity in (0, 1):
        # Position of the target in steps from the pixel of the same number.
        ahead = shift / 2 - shift * parity
        base = int(np.floor(ahead))
        nodes = np.array([-1.0, 0.0, 1.0, 2.0])
        row = padded[parity::2]
        # With the two outer pixels, without one of them.
        for used in ([0, 1, 2, 3], [0, 1, 2], [1, 2, 3]):
            weights = _weights(nodes[used], ahead - base)
            parts = [row[:, 3 + base + int(nodes[k]) :][:, : count - 2] for k in used]
            found = sum(weight * part for weight, part in zip(weights, parts, strict=True))
            mine = result[parity::2]
            result[parity::2] = np.where(np.isnan(mine), found, mine)
    return result


def _weights(nodes: np.ndarray, place: float) -> list[float]:
    """Lagrange's weights of values at the nodes, for a polynomial at a place."""
    return [
        float(np.prod((place - np.delete(nodes, k)) / (node - np.delete(nodes, k))))
        for k, node in enumerate(nodes)
    ]

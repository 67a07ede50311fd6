"""Grid intake: axes and values of a sampled frame, checked once."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from geomtorsion.errors import GridError

# Steps of an axis may differ by this share: coordinates are often stored as 32-bit floats.
REGULAR = 1e-4


def numbers(values: Any, where: str) -> np.ndarray:
    """An array of real numbers."""

    try:
        result = np.asarray(values)
    except ValueError:
        raise GridError(
            f"{where}: an array was needed, but rows of different lengths came."
        ) from None
    if not (np.issubdtype(result.dtype, np.floating) or np.issubdtype(result.dtype, np.integer)):
        raise GridError(f"{where}: real numbers were needed, but {result.dtype} came.")
    return result.astype(float)


def regular_axis(values: Any, name: str) -> np.ndarray:
    """A regular axis."""

    axis = numbers(values, f"axis {name}")
    if axis.ndim != 1 or len(axis) < 2:
        raise GridError(f"axis {name}: a list of coordinates was needed, shape {axis.shape} came.")
    if not np.isfinite(axis).all():
        raise GridError(
            f"axis {name}: finite numbers were needed; entry "
            f"{int(np.flatnonzero(~np.isfinite(axis))[0])} is none."
        )
    step = (axis[-1] - axis[0]) / (len(axis) - 1)
    worst = int(np.abs(np.diff(axis) - step).argmax())
    if step == 0 or abs(axis[worst + 1] - axis[worst] - step) > REGULAR * abs(step):
        raise GridError(
            f"axis {name}: equal steps were needed, but step {worst} is "
            f"{axis[worst + 1] - axis[worst]:.6g} where the mean is {step:.6g}. Resample the data."
        )
    return axis


def check_shape(
    values: np.ndarray, axes: Sequence[np.ndarray], names: Sequence[str], needed: int, order: int
) -> None:
    """Refuse values that do not fit the axes, and axes too short for the order."""
    shape = tuple(len(axis) for axis in axes)
    if values.ndim != 2 + len(axes) or values.shape[1:] != (len(axes), *shape):
        raise GridError(
            f"coframe: shape (rows, {len(axes)}, {', '.join(map(str, shape))}) was needed "
            f"(frame index, coordinate index, grid), but {values.shape} came."
        )
    for name, count in zip(names, shape, strict=True):
        if count < needed:
            raise GridError(
                f"axis {name}: {needed} points or more are needed for order {order} with its error "
                f"estimate, but there are {count}. Choose a lower order."
            )


def check_finite(values: np.ndarray, axes: Sequence[np.ndarray], names: Sequence[str]) -> None:
    """Refuse values that are not finite; the message names the first."""

    bad = np.argwhere(~np.isfinite(values))
    if len(bad):
        i, mu, *place = bad[0].tolist()
        where = ", ".join(
            f"{name} = {axis[k]:.6g}" for name, axis, k in zip(names, axes, place, strict=True)
        )
        raise GridError(
            f"coframe[{i}, {mu}] is not finite at {where} (and at {len(bad) - 1} more entries). "
            "Cut those nodes out or fill them; a singular line must lie between nodes."
        )


def check_names(axes: Sequence[Any], names: Sequence[str]) -> None:
    """Refuse a grid with less than two axes, or without a name for each."""
    if len(names) != len(axes) or len(axes) < 2:
        raise GridError(
            f"a grid needs two axes or more, and a name for each, but {len(axes)} axes "
            f"and {len(names)} names came."
        )

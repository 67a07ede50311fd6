"""Rows: arrays of whole numbers and of values that come from a user, checked once."""

from __future__ import annotations

from typing import Any

import numpy as np

from geomtorsion import checks
from geomtorsion.errors import LimitError, NetworkError

# Sums of whole numbers up to this size are exact in 64 bits, with a bit to spare.
LARGEST_WHOLE = np.iinfo(np.int64).max // 2


def whole(values: object, subject: str, columns: int | None = None) -> np.ndarray:
    """An array of whole numbers with two axes, as int64.

    Raises
    ------
    NetworkError
        It is none, or has another number of columns.
    """
    try:
        found = np.asarray(values)
    except (TypeError, ValueError):
        found = np.empty(0, dtype=object)
    if not found.size and found.dtype.kind == "f":
        found = found.reshape(len(found), columns or 0).astype(np.int64)
    fits = found.ndim == 2 and columns in (None, found.shape[-1])
    if not fits or found.dtype.kind not in "iu":
        wanted = "any" if columns is None else columns
        raise NetworkError(
            f"{subject}: whole numbers of shape (any, {wanted}) were needed, but "
            f"{found.dtype} of shape {found.shape} came."
        )
    return found.astype(np.int64, copy=False)


def listed(values: object, subject: str) -> list[Any]:
    """The entries of a list, tuple, array or text."""
    return (
        list(values) if isinstance(values, str) else checks.entries(values, subject, NetworkError)
    )


def value_rows(values: object, name: str, count: int) -> np.ndarray:
    """Rows of whole numbers or of finite floats."""
    message = "{subject}: an array of real numbers was needed, but {value} came."
    found = values if isinstance(values, np.ndarray) else None
    if found is None or found.dtype.kind not in "iuf":
        try:
            found = np.asarray(values)
        except (TypeError, ValueError):
            found = np.array(None)
        if found.dtype.kind not in "iu":
            found = checks.array(values, "values", NetworkError, message=message)
    if found.ndim == 1:
        found = found[:, None]
    if found.ndim != 2 or len(found) != count:
        raise NetworkError(
            f"values: one row for each {name}, shape ({count}, n), was needed, but {found.shape} "
            "came."
        )
    if found.dtype.kind in "iu":
        check_sums(largest(found) * max(count, 1))
        return found.astype(np.int64, copy=False)
    bad = np.argwhere(~np.isfinite(found))
    if len(bad):
        k, i = bad[0].tolist()
        raise NetworkError(
            f"{name} {k}: finite values were needed, but {found[k, i]} came as component {i}. "
            f"Leave the {name} out."
        )
    return found.astype(float, copy=False)


def largest(values: np.ndarray) -> float:
    """The largest magnitude, as a double: that of the least int64 is no int64."""
    return float(np.abs(values.astype(float)).max(initial=0.0))


def check_sums(size: float) -> None:
    """Refuse sums of whole numbers that may leave 64 bits, and would be wrong without a word."""
    if size >= LARGEST_WHOLE:
        raise LimitError(
            f"sums of these whole numbers may come to {size:.2g}, beyond 64 bits. Give larger "
            "units, or floats."
        )

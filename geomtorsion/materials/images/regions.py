"""Regions: parts of an image, as rectangles or as truth values by pixel."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from geomtorsion.errors import ImageError
from geomtorsion.support import checks

# A rectangle, ((x0, x1), (y0, y1)), or truth values by pixel, [x, y].
Region = Sequence[Sequence[float]] | np.ndarray


def pixels_of(
    given: Region, sizes: tuple[int, ...], step: float, unit: str, least: float
) -> np.ndarray:
    """The pixels of a region, as truth values [x, y].

    sizes: pixels along x and y. least: width below which a region is too narrow, in units.

    Raises
    ------
    ImageError
        The region is outside the image, is too narrow, or has another shape.
    """
    if isinstance(given, np.ndarray) and given.dtype == bool:
        if given.shape != sizes:
            raise ImageError(
                f"reference: expected truth values of shape {sizes}, [x, y], got {given.shape}. "
                "Convert an array of rows by [::-1].T."
            )
        return given.copy()
    ends = checks.array(given, "reference", ImageError, shape=(2, 2))
    most = step * (np.array(sizes) - 1)
    narrow = float(np.diff(ends, axis=1).min())
    if (ends < 0).any() or (ends > most[:, None]).any() or narrow < least:
        raise ImageError(
            f"reference: expected ((x0, x1), (y0, y1)) within 0 to {most[0]:.6g} and {most[1]:.6g} "
            f"{unit}, wider than the resolution of {least:.3g}, got {checks.shown(ends.tolist())}. "
            "Choose another region."
        )
    inside = [
        (step * np.arange(n) >= low) & (step * np.arange(n) <= high)
        for n, (low, high) in zip(sizes, ends.tolist(), strict=True)
    ]
    return np.logical_and.outer(*inside)

"""Pixels: their size, as an image file states it, and the pixels of a region of an image."""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from geomtorsion.errors import ImageError
from geomtorsion.support import checks

# Unit of a file in lower case -> our unit, and its size in this unit.
UNITS = {
    "pm": ("pm", 1.0),
    "a": ("angstrom", 1.0), "å": ("angstrom", 1.0), "ang": ("angstrom", 1.0),
    "angstrom": ("angstrom", 1.0), "angstroms": ("angstrom", 1.0),
    "nm": ("nm", 1.0), "nanometer": ("nm", 1.0), "nanometers": ("nm", 1.0),
    **dict.fromkeys(("um", "µm", "μm", "micron", "microns", "\\u00b5m"), ("um", 1.0)),
    "mm": ("mm", 1.0), "cm": ("mm", 10.0), "inch": ("mm", 25.4), "in": ("mm", 25.4),
    "m": ("nm", 1e9),
}  # fmt: skip
# The unit of lengths in images whose pixels have no known size.
UNSIZED = "px"
# Units of the resolution tags of TIFF.
_TAG_UNITS = {2: "inch", 3: "cm"}
# Programs write resolution tags below this number of pixels per inch for screens, printers and
# scanners by default.
PRINTED = 10_000
_OME = re.compile(r"<(?:\w+:)?Pixels\b[^>]*>")
_ATTRIBUTE = re.compile(r'\b(PhysicalSize[XY](?:Unit)?)\s*=\s*"([^"]*)"')
# A rectangle, ((x0, x1), (y0, y1)), or truth values by pixel, [x, y].
Region = Sequence[Sequence[float]] | np.ndarray


@dataclass(frozen=True)
class PixelSize:
    """Size of a pixel: `step` in `unit`."""

    step: float
    unit: str


def of_size(step: float, unit: str) -> str:
    """Size of pixels in the description of an image.

    Examples
    --------
    >>> of_size(0.05, "nm"), of_size(1.0, "px")
    (' of 0.05 nm', ', pixel size unknown')
    """
    return ", pixel size unknown" if unit == UNSIZED else f" of {step:.6g} {unit}"


def pixel_size(path: Path, steps: Sequence[object], units: Sequence[object]) -> PixelSize | None:
    """Size of a square pixel; None unless step and unit are stated along both axes.

    Raises
    ------
    ImageError
        The pixels are not square.
    """
    sizes = []
    for step, unit in zip(steps, units, strict=True):
        known_unit = UNITS.get(str(unit).strip().lower()) if isinstance(unit, str) else None
        if known_unit is None or not isinstance(step, int | float | np.number):
            return None
        length = abs(float(step)) * known_unit[1]
        if not 0 < length < np.inf:
            return None
        sizes.append((length, known_unit[0]))
    (one, unit), (other, second) = sizes
    if unit != second or abs(one - other) > 1e-3 * one:
        raise ImageError(
            f"{path.name}: expected square pixels, got {one:.6g} {unit} by {other:.6g} {second}. "
            "Resample the image, or give step and unit of a pixel."
        )
    return PixelSize(one, unit)


def size_in_tiff(path: Path, file: Any, page: Any) -> PixelSize | None:
    """Size of a pixel from OME metadata, ImageJ metadata or the resolution tags of a page."""
    ome = _OME.search(file.ome_metadata or "") if file.is_ome else None
    if ome is not None:
        stated = dict(_ATTRIBUTE.findall(ome[0]))
        steps = [_number(stated.get(f"PhysicalSize{axis}")) for axis in "XY"]
        # The unit of OME is um by default.
        units = [stated.get(f"PhysicalSize{axis}Unit", "um") for axis in "XY"]
        return pixel_size(path, steps, units)
    counts = [_ratio(page.tags.get(f"{axis}Resolution")) for axis in "XY"]
    if counts[0] is None or counts[1] is None:
        return None
    steps = [1 / counts[0], 1 / counts[1]]
    imagej: Mapping[str, Any] = (file.imagej_metadata or {}) if file.is_imagej else {}
    if imagej.get("unit"):
        return pixel_size(path, steps, [imagej["unit"]] * 2)
    tag = page.tags.get("ResolutionUnit")
    unit = _TAG_UNITS.get(2 if tag is None else int(tag.value))
    if unit is None or counts[0] < PRINTED * UNITS[unit][1] / UNITS["inch"][1]:
        return None
    size = pixel_size(path, steps, [unit] * 2)
    return None if size is None else PixelSize(size.step * 1e6, "nm")


def size_of_axes(path: Path, axes: Sequence[Mapping[str, Any]]) -> PixelSize | None:
    """Size of a pixel from the last two axes of a signal of rosettasciio."""
    last = list(axes)[-2:]
    if len(last) < 2:
        return None
    return pixel_size(path, [x.get("scale") for x in last], [x.get("units") for x in last])


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


def _ratio(tag: Any) -> float | None:
    """Value of a resolution tag, a ratio of whole numbers; None without one above 0."""
    if tag is None or len(np.atleast_1d(tag.value)) != 2:
        return None
    top, bottom = (int(x) for x in tag.value)
    return top / bottom if top > 0 and bottom > 0 else None


def _number(text: str | None) -> float | None:
    """A number of an attribute."""
    try:
        return None if text is None else float(text)
    except ValueError:
        return None

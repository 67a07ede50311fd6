"""raster: values on a grid as a coloured picture, and the scale that says what its colours mean."""

from __future__ import annotations

import base64
import struct
import zlib

import numpy as np

from geomtorsion.lab.plot import INK, words
from geomtorsion.pictures.style import number

# From dark to bright, so that grey prints and all kinds of colour vision see the same order: the
# scale viridis (Smith and van der Walt, public domain) at equal steps, red, green and blue.
COLOURS = np.array(
    [(68, 1, 84), (71, 45, 123), (59, 82, 139), (44, 114, 142), (33, 145, 140), (40, 174, 128),
     (94, 201, 98), (173, 220, 48), (253, 231, 37)]
)  # fmt: skip
UNKNOWN = (205, 208, 213)


def colours(values: np.ndarray, most: float) -> np.ndarray:
    """Red, green and blue of values between 0 and `most`; grey where nothing is known.

    Examples
    --------
    >>> colours(np.array([0.0, 2.0, np.nan]), 2.0).tolist()
    [[68, 1, 84], [253, 231, 37], [205, 208, 213]]
    """
    known = np.isfinite(values)
    share = np.where(known, values, 0.0) / (most or 1.0)
    place = np.clip(share, 0, 1) * (len(COLOURS) - 1)
    steps = np.arange(len(COLOURS))
    parts = [np.interp(place, steps, COLOURS[:, k]) for k in range(3)]
    found = np.rint(np.stack(parts, axis=-1)).astype(np.uint8)
    found[~known] = UNKNOWN
    return found


def png(pixels: np.ndarray) -> bytes:
    """Red, green and blue, shape (rows, columns, 3), as a PNG file (W3C, second edition).

    Examples
    --------
    >>> png(np.zeros((2, 3, 3), np.uint8))[:8]
    b'\\x89PNG\\r\\n\\x1a\\n'
    """
    rows, columns = pixels.shape[:2]
    # Each line begins with the number of its filter: none.
    lines = np.zeros((rows, 1 + 3 * columns), np.uint8)
    lines[:, 1:] = pixels.reshape(rows, -1)
    head = struct.pack(">IIBBBBB", columns, rows, 8, 2, 0, 0, 0)
    parts = [(b"IHDR", head), (b"IDAT", zlib.compress(lines.tobytes())), (b"IEND", b"")]
    return b"\x89PNG\r\n\x1a\n" + b"".join(
        struct.pack(">I", len(data)) + name + data + struct.pack(">I", zlib.crc32(name + data))
        for name, data in parts
    )


def address(picture: bytes) -> str:
    """A PNG file as an address that holds it."""
    return f"data:image/png;base64,{base64.b64encode(picture).decode()}"


def scale(most: float, unit: str) -> str:
    """What the colours mean, as an svg element: a strip from 0 to `most`, and grey.

    Examples
    --------
    >>> scale(2.0, "1/um").count("<text")
    3
    """
    strip = address(png(colours(np.linspace(0, 1, 64)[None], 1.0)))
    end = f"{number(float(f'{most:.3g}'))} {unit}".strip()
    grey = "rgb({},{},{})".format(*UNKNOWN)
    return (
        '<svg class="plot" viewBox="0 0 520 44" role="img" aria-label="scale of colours" '
        'xmlns="http://www.w3.org/2000/svg" font-family="system-ui, sans-serif">'
        '<rect width="520" height="44" fill="#fff"/>'
        f'<image x="66" y="4" width="260" height="16" preserveAspectRatio="none" href="{strip}"/>'
        f"{words(66, 38, '0', 'start', 13, INK)}"
        f"{words(326, 38, end, 'end', 13, INK)}"
        f'<rect x="362" y="4" width="16" height="16" fill="{grey}"/>'
        f"{words(384, 17, 'hole, boundary or edge', 'start', 13, INK)}</svg>"
    )

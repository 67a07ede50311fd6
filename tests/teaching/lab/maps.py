"""Maps for tests of the page: file contents with known Burgers vectors, and damaged files."""

from __future__ import annotations

import io
import zipfile
from pathlib import Path

import numpy as np
import tifffile
from PIL import Image

from geomtorsion import SampledFrame
from tests.materials.images.atoms import crystal

# b per area of the twisted map, and the angle between the halves of the wall, degrees.
TWIST, TILT = 2.0, 4.0
STEP = 0.5


def twisted(shape: tuple[int, int] = (24, 20), hole: bool = False) -> SampledFrame:
    """A coframe of even torsion: b of each circuit is TWIST times its area."""
    axes = [STEP * np.arange(n) - 1.0 for n in shape]
    x, y = np.meshgrid(*axes, indexing="ij")
    values = TWIST / 2 * np.array([[-y, x]])
    if hole:
        values[..., 3:6, 3:5] = np.nan
    return SampledFrame(axes, values, unit="um")


def saved(frame: SampledFrame, folder: Path, end: str) -> bytes:
    """Content of a file of the frame."""
    path = folder / f"map{end}"
    frame.save(path)
    return path.read_bytes()


def wall_ctf(rows: int = 20, columns: int = 24) -> bytes:
    """A symmetric tilt wall in the middle column, 1 um a step, cubic, as a .ctf file."""
    lines = [
        "Channel Text File", "Prj\twall", "Author\tnobody", "JobMode\tGrid",
        f"XCells\t{columns}", f"YCells\t{rows}", "XStep\t1.0", "YStep\t1.0",
        "AcqE1\t0", "AcqE2\t0", "AcqE3\t0",
        "Euler angles refer to Sample Coordinate system (CS0)!\tMag\t1\tCoverage\t100",
        "Phases\t1", "3.5;3.5;3.5\t90;90;90\tNickel\t11\t225",
        "Phase\tX\tY\tBands\tError\tEuler1\tEuler2\tEuler3\tMAD\tBC\tBS",
    ]  # fmt: skip
    for y in range(rows):
        for x in range(columns):
            angle = TILT / 2 if x >= columns // 2 else 90 - TILT / 2
            lines.append(f"1\t{x:.1f}\t{y:.1f}\t8\t0\t{angle:.6f}\t0\t0\t0.5\t100\t100")
    return "\r\n".join(lines).encode() + b"\r\n"


def bomb() -> bytes:
    """A small archive that unpacks to a large array of zeros."""
    stream = io.BytesIO()
    with zipfile.ZipFile(stream, "w", zipfile.ZIP_DEFLATED) as archive:
        archive.writestr("coframe.npy", bytes(100_000_000))
    return stream.getvalue()


def atoms(end: str) -> bytes:
    """Atoms 8 pixels apart around an edge dislocation in the middle, as an image of 256 x 256."""
    values = crystal(256, "square", turned=0.0).noisy(0.3, 1)
    grey = np.rint(np.interp(values, (values.min(), values.max()), (0, 255))).astype(np.uint8)
    stream = io.BytesIO()
    if end == ".npy":
        np.save(stream, values)
    elif end == ".png":
        Image.fromarray(grey).save(stream, "PNG")
    else:
        tifffile.imwrite(stream, grey)
    return stream.getvalue()

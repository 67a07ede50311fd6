"""Opening: the measured field that a file holds, by the end of its name and by its first bytes."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from importlib import import_module
from pathlib import Path
from typing import Any

import numpy as np

from geomtorsion import checks
from geomtorsion.checks import shown
from geomtorsion.errors import (
    FileFormatError,
    GridError,
    ImageError,
    OrientationError,
)
from geomtorsion.hdf5 import check_hdf5
from geomtorsion.materials.fields import SampledFrame
from geomtorsion.materials.fields.grid_files import FORMATS
from geomtorsion.materials.images import LatticeImage
from geomtorsion.materials.images.image_files import KINDS as PICTURES
from geomtorsion.materials.maps import OrientationMap
from geomtorsion.materials.maps.map_files import CTF
from geomtorsion.materials.maps.map_formats import FORMATS as MAPS
from geomtorsion.materials.maps.slip import FAMILIES as SLIP
from geomtorsion.materials.measured.fields import CrystalField, LatticeField, SampledField
from geomtorsion.materials.measured.results import Measured

# HDF5 files hold grids or maps: their content says which.
ORIENTATIONS = tuple(end for end in MAPS if end not in FORMATS)
IMAGES = tuple(PICTURES)
SUFFIXES = (*FORMATS, *ORIENTATIONS, *IMAGES, ".zarr")
# Kind of a file -> the options that it takes, what it is called, and its errors.
OPTIONS = {
    "grid": ("sigma", "order"),
    "map": ("threshold", "laue", "sigma", "slip"),
    "image": ("pixel", "spots", "resolution"),
}
KINDS = {
    "grid": "sampled frames",
    "map": f"orientation maps ({', '.join(ORIENTATIONS)})",
    "image": f"lattice images ({', '.join(IMAGES)})",
}
KIND = {"grid": "a sampled frame", "map": "an orientation map", "image": "an image"}
ERRORS = {"grid": GridError, "map": OrientationError, "image": ImageError}
# First bytes -> what such files end in. Text (CSV, .ang) has no bytes of its own.
BEGINNINGS: dict[bytes, tuple[str, ...]] = {
    CTF.encode(): (".ctf",),
    b"PK\x03\x04": (".npz",),
    b"\x89HDF\r\n\x1a\n": (".h5", ".hdf5", ".nc", ".netcdf"),
    b"CDF\x01": (".nc", ".cdf", ".netcdf"),
    b"CDF\x02": (".nc", ".cdf", ".netcdf"),
    b"# vtk DataFile": (".vtk",),
    b"\x89PNG": (".png",),
    b"II*\x00": (".tif", ".tiff"),
    b"MM\x00*": (".tif", ".tiff"),
    b"\x93NUMPY": (".npy",),
}
LONGEST = max(map(len, BEGINNINGS))


def is_measured(source: str | Path) -> bool:
    """Whether a name, or what the file begins with, is that of a measured field.

    Examples
    --------
    >>> is_measured("map.CTF"), is_measured("field.npz"), is_measured("so3"), is_measured("a.toml")
    (True, True, False, False)
    """
    path = Path(source)
    return path.suffix.lower() in SUFFIXES or bool(_ends(path))


def is_array(path: Path) -> bool:
    """Whether a file is an array that is only read in parts: Zarr, or .npy of four axes or more."""
    if path.suffix.lower() == ".zarr":
        return True
    if path.suffix.lower() != ".npy" or not path.is_file():
        return False
    try:
        return np.load(path, mmap_mode="r", allow_pickle=False).ndim > 3
    except (OSError, ValueError, EOFError):
        return False


def open_measured(
    path: str | Path,
    *,
    sigma: float | str | None = None,
    threshold: float | None = None,
    order: int | None = None,
    laue: Mapping[int, str] | None = None,
    slip: str | None = None,
    pixel: tuple[float, str] | None = None,
    spots: Sequence[Sequence[float]] | None = None,
    resolution: float | None = None,
) -> Measured:
    """The measured field in a file.

    Parameters
    ----------
    sigma
        Standard deviation of the noise: of each value of a sampled frame; of an orientation in
        degrees. Without it that of the file, or else "estimate", from the data.
    threshold
        Degrees, of orientation maps: neighbours that differ by less belong to one grain.
    order
        Of interpolation, of sampled frames.
    laue
        Of orientation maps: number of a phase -> name of its Laue group.
    slip
        Of orientation maps: the structure whose slip systems make up b, see `slip_families`.
    pixel
        Of images: size of a pixel, and the unit in which it is given.
    spots, resolution
        Of images: see `LatticeImage.phases`.

    Raises
    ------
    FileFormatError
        The file is missing or damaged, or its content is of another kind than its name says.
    GridError, OrientationError, ImageError
        An option does not belong to this kind of file, or has no such value.
    """
    path = checks.file_name(path)
    suffix, ends = path.suffix.lower(), _ends(path)
    if ends and suffix not in ends:
        raise FileFormatError(
            f"{path.name}: its content is that of a file ending in {' or '.join(ends)}, but its "
            f"name ends in {shown(path.suffix)}. Rename it."
        )
    if suffix not in SUFFIXES:
        raise FileFormatError(
            f"{path.name}: a name ending in {', '.join(SUFFIXES)} was needed, but "
            f"{shown(path.suffix)} came. Rename or export the file."
        )
    if is_array(path):
        raise GridError(
            f"{path.name}: it holds a field as an array, of which maps are made in blocks: "
            "geomtorsion map FILE -o DIR. For single circuits save it by SampledFrame.save."
        )
    kind = _kind(path)
    options = {
        "sigma": sigma, "threshold": threshold, "order": order, "laue": laue or None, "slip": slip,
        "pixel": pixel, "spots": spots, "resolution": resolution,
    }  # fmt: skip
    given = {name: value for name, value in options.items() if value is not None}
    for name in given:
        if name not in OPTIONS[kind]:
            owner = next(k for k, names in OPTIONS.items() if name in names)
            raise ERRORS[kind](
                f"{name}: it belongs to {KINDS[owner]}, but {path.name} holds {KIND[kind]}. Leave "
                "it out."
            )
    if kind == "image":
        return _image(path, pixel, spots, resolution)
    if kind == "map":
        return _orientations(path, given)
    frame = SampledFrame.read(path, 4 if order is None else order)
    if sigma is not None:
        frame = replace(frame, sigma=sigma)
    elif frame.sigma is None:
        frame = replace(frame, sigma="estimate")
    return SampledField(frame)


def _kind(path: Path) -> str:
    """What a file holds, by the end of its name; of HDF5 by what is in it."""
    suffix = path.suffix.lower()
    if suffix in IMAGES:
        return "image"
    if suffix in FORMATS and suffix in MAPS and path.is_file() and not _has_grid(path):
        return "map"
    return "map" if suffix in ORIENTATIONS else "grid"


def _has_grid(path: Path) -> bool:
    """Whether an HDF5 file may hold a sampled frame; without a library its reader says so."""
    try:
        h5py = import_module("h5py")
    except ImportError:
        return True
    return not {"coframe", "distortion"}.isdisjoint(check_hdf5(path, h5py))


def _ends(path: Path) -> tuple[str, ...]:
    """What files that begin like this one end in; nothing where its beginning is not known."""
    if not path.is_file():
        return ()
    with path.open("rb") as file:
        first = file.read(LONGEST)
    found = [ends for mark, ends in BEGINNINGS.items() if first.startswith(mark)]
    return found[0] if found else ()


def _orientations(path: Path, given: dict[str, Any]) -> Measured:
    """An orientation map."""
    sigma = given.get("sigma")
    if isinstance(sigma, str):
        checks.choice(sigma, ["estimate"], "sigma", OrientationError)
        given = {**given, "sigma": None}
    slip = given.pop("slip", "")
    if slip:
        checks.known_name(slip, SLIP, "slip", OrientationError)
    return CrystalField(OrientationMap.read(path, **given), slip)


def _image(
    path: Path,
    pixel: tuple[float, str] | None,
    spots: Sequence[Sequence[float]] | None,
    resolution: float | None,
) -> Measured:
    """A picture of a lattice, with its phases."""
    given = (1.0, "px") if pixel is None else checks.entries(pixel, "pixel", ImageError)
    if len(given) != 2:
        raise ImageError(
            f"pixel: a size and its unit were needed, such as (0.02, 'nm'), but {shown(pixel)} "
            "came."
        )
    step, unit = given
    image = LatticeImage.read(path, step, unit)
    return LatticeField(image, image.phases(spots, resolution))

"""Opening: the measured field that a file holds, by the end of its name and by its first bytes."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path

from geomtorsion import checks
from geomtorsion.checks import shown
from geomtorsion.errors import FileFormatError, GridError, OrientationError
from geomtorsion.loops import SampledFrame
from geomtorsion.loops.grid_files import FORMATS
from geomtorsion.measured.crystal_field import CrystalField
from geomtorsion.measured.results import Measured
from geomtorsion.measured.sampled_field import SampledField
from geomtorsion.orientations import OrientationMap

ORIENTATIONS = (".ctf", ".ang")
SUFFIXES = (*FORMATS, *ORIENTATIONS)
# First bytes -> what such files end in. Text (CSV, .ang) has no bytes of its own.
BEGINNINGS: dict[bytes, tuple[str, ...]] = {
    b"Channel Text File": (".ctf",),
    b"PK\x03\x04": (".npz",),
    b"\x89HDF\r\n\x1a\n": (".h5", ".hdf5", ".nc", ".netcdf"),
    b"CDF\x01": (".nc", ".cdf", ".netcdf"),
    b"CDF\x02": (".nc", ".cdf", ".netcdf"),
    b"# vtk DataFile": (".vtk",),
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


def open_measured(
    path: str | Path,
    *,
    sigma: float | str | None = None,
    threshold: float | None = None,
    order: int | None = None,
    laue: Mapping[int, str] | None = None,
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

    Raises
    ------
    FileFormatError
        The file is missing or damaged, or its content is of another kind than its name says.
    GridError, OrientationError
        An option does not belong to this kind of file, or has no such value.
    """
    path = Path(path)
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
    if suffix in ORIENTATIONS:
        return _orientations(path, sigma, threshold, order, laue)
    if threshold is not None or laue:
        name = "laue" if threshold is None else "threshold"
        raise GridError(
            f"{name}: it belongs to orientation maps (.ctf, .ang), but {path.name} holds a "
            "sampled frame. Leave it out."
        )
    frame = SampledFrame.read(path, 4 if order is None else order)
    if sigma is not None:
        frame = replace(frame, sigma=sigma)
    elif frame.sigma is None:
        frame = replace(frame, sigma="estimate")
    return SampledField(frame)


def _ends(path: Path) -> tuple[str, ...]:
    """What files that begin like this one end in; nothing where its beginning is not known."""
    if not path.is_file():
        return ()
    with path.open("rb") as file:
        first = file.read(LONGEST)
    found = [ends for mark, ends in BEGINNINGS.items() if first.startswith(mark)]
    return found[0] if found else ()


def _orientations(
    path: Path,
    sigma: float | str | None,
    threshold: float | None,
    order: int | None,
    laue: Mapping[int, str] | None,
) -> Measured:
    """An orientation map."""
    if order is not None:
        raise OrientationError(
            f"order: it belongs to sampled frames, but {path.name} holds an orientation map, whose "
            "circuits run from pixel to pixel. Leave it out."
        )
    if isinstance(sigma, str):
        checks.choice(sigma, ["estimate"], "sigma", OrientationError)
        sigma = None
    if threshold is None:
        return CrystalField(OrientationMap.read(path, laue=laue, sigma=sigma))
    return CrystalField(OrientationMap.read(path, laue=laue, sigma=sigma, threshold=threshold))

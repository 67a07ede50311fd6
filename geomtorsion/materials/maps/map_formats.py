"""Map formats: file formats of orientation maps, and their readers."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from pathlib import Path

from geomtorsion.errors import FileFormatError, OrientationError
from geomtorsion.materials.columns import checked_columns
from geomtorsion.materials.maps.channel5 import read_channel5
from geomtorsion.materials.maps.map_files import CTF, read_text_map
from geomtorsion.materials.maps.map_hdf5 import read_hdf5_map
from geomtorsion.materials.maps.map_points import MapFile
from geomtorsion.materials.maps.map_tables import (
    QUANTITIES,
    map_quantity,
    read_map_table,
    seems_table,
)
from geomtorsion.support.file_kinds import naming_other_kinds
from geomtorsion.support.files import ending
from geomtorsion.support.hdf5 import HDF5


@dataclass(frozen=True)
class MapFormat:
    """A format of orientation maps.

    read: reads the map from a path, with Laue groups of phases. seems: whether bytes look like such
    a file; None for binary files, which the page does not accept. begins: possible first bytes;
    none for text files that may begin with anything.
    """

    read: Callable[[Path, Mapping[int, str] | None], MapFile]
    seems: Callable[[bytes], bool] | None = None
    begins: tuple[bytes, ...] = ()


def _seems_ctf(content: bytes) -> bool:
    """Whether a text begins like a .ctf file of Oxford Instruments."""
    return content.removeprefix(b"\xef\xbb\xbf").startswith(CTF.encode())


def _seems_ang(content: bytes) -> bool:
    """Whether a text has a header of comments before rows of angles, x, y, quality and phase."""
    lines = content.removeprefix(b"\xef\xbb\xbf").splitlines()
    row = next((line for line in lines if line.strip() and not line.startswith(b"#")), b"")
    return bool(lines) and lines[0].startswith(b"#") and b"," not in row and len(row.split()) >= 8


# File endings of HDF5.
HDF5_MAPS = (".h5", ".hdf5", ".h5oina", ".oh5", ".h5ebsd", ".dream3d")
# File ending -> format. To add a format, add a line here.
FORMATS: dict[str, MapFormat] = {
    ".ctf": MapFormat(read_text_map, _seems_ctf, (CTF.encode(),)),
    ".ang": MapFormat(read_text_map, _seems_ang),
    **dict.fromkeys(HDF5_MAPS, MapFormat(read_hdf5_map, begins=(HDF5,))),
    ".cpr": MapFormat(read_channel5),
    ".crc": MapFormat(read_channel5),
    ".txt": MapFormat(read_map_table, seems_table),
    ".csv": MapFormat(read_map_table, seems_table),
}

# File endings of tables, whose columns the user may name.
TABLES = (".txt", ".csv", ".ang")


@naming_other_kinds("a map")
def read_map_file(
    path: str | Path,
    laue: Mapping[int, str] | None = None,
    columns: Mapping[str, int | str] | None = None,
    part: int | str | None = None,
) -> MapFile:
    """Read an orientation map from a file in the format of its file ending.

    laue: number of a phase (0: all other phases) -> name of its Laue group, which overrides the
    group in the file.
    columns: quantity (phi1, Phi, phi2, x, y, phase) -> column of a table, or data set of HDF5.
    part: number or name of one of several maps in HDF5.

    Raises
    ------
    OrientationError
        A column is not in the file, or the file is not a table.
    FileFormatError
        The file is truncated, or has wrong columns, mixed steps or an unknown phase; the message
        names file, line and remedy.
    """
    path = Path(path)
    suffix = ending(path)
    if suffix not in FORMATS:
        raise FileFormatError(
            f"{path.name}: expected the name of a map to end in one of {', '.join(FORMATS)}, got "
            f"{suffix or 'no ending'!r}. Export the map as .ctf or .ang."
        )
    chosen = checked_columns(columns, map_quantity, OrientationError, QUANTITIES)
    if suffix in HDF5_MAPS:
        return read_hdf5_map(path, laue, chosen, part)
    if part is not None:
        raise OrientationError(
            f"slice: expected an HDF5 file with several maps, got {path.name}. Omit slice."
        )
    if not chosen:
        return FORMATS[suffix].read(path, laue)
    if suffix not in TABLES:
        raise OrientationError(
            f"columns: expected a table ({', '.join(TABLES)}) or HDF5, got {path.name}, whose "
            "columns are fixed. Omit columns."
        )
    return read_map_table(path, laue, chosen)

"""uploads: bytes of an uploaded file, recognised by their content, and read."""

from __future__ import annotations

import io
import zipfile
import zlib
from functools import lru_cache
from pathlib import Path
from tempfile import TemporaryDirectory

from geomtorsion.errors import FileFormatError, GeomtorsionError, GridError, LimitError
from geomtorsion.materials.fields import SampledFrame
from geomtorsion.materials.images import LatticeImage, LatticePhases
from geomtorsion.materials.images.image_files import read_pixels
from geomtorsion.materials.maps import OrientationMap
from geomtorsion.materials.readers import IMAGE, MAP, READERS, suffixes_of
from geomtorsion.materials.readers import kind_of as content_of
from geomtorsion.teaching.lab.settings import PAGE

# First bytes of other formats -> names of the formats.
_OTHERS: dict[bytes, str] = {
    b"\xff\xd8\xff": "a JPEG image, whose compression loses details",
    b"\x89HDF": "HDF5 or NetCDF",
    b"CDF": "NetCDF",
    b"\x80": "a pickle, which could run code",
}
# Text that the page recognises by its content, and ends of images.
TEXT_MAPS = tuple(reader.suffix for reader in READERS if reader.seems is not None)
IMAGES = tuple(reader.suffix for reader in READERS if reader.kind is IMAGE)
EXPECTED = (
    "expected a sampled frame (NPZ or CSV, as SampledFrame.save writes it), an orientation map "
    f"({' or '.join(TEXT_MAPS)}) or a lattice image (PNG, TIFF, NPY)"
)
# Name of the file while it is read; messages replace it by the name that its owner gave.
_STEM = "given-map"


def kind_of(content: bytes) -> str:
    """The suffix for a file of this content; the name of the file has no effect.

    Raises
    ------
    FileFormatError
        The page does not read this format; the message names the format if it is known.

    Examples
    --------
    >>> kind_of(b"x,y,e_0_0,e_0_1\\n"), kind_of(b"Channel Text File\\n"), kind_of(b"PK\\x03\\x04")
    ('.csv', '.ctf', '.npz')
    >>> kind_of(b"# GRID: SqrGrid\\n 1.0 2.0 3.0 0.0 0.0 90.0 0.9 0\\n")
    '.ang'
    """
    if content.startswith((b"PK\x03\x04", b"PK\x05\x06")):
        return ".npz"
    for end in suffixes_of(content):
        if end in IMAGES:
            return end
    for begin, what in _OTHERS.items():
        if content.startswith(begin):
            raise FileFormatError(f"{EXPECTED}, got {what}. Save the map in one of these formats.")
    if not content.strip():
        raise FileFormatError(f"{EXPECTED}, got an empty file. Choose another file.")
    for reader in READERS:
        if reader.seems is not None and reader.seems(content):
            return reader.suffix
    lines = content.splitlines()
    row = next((line for line in lines if line.strip() and not line.startswith(b"#")), b"")
    if b"," in row:
        return ".csv"
    raise FileFormatError(
        f"{EXPECTED}, got a file without a header of columns and without a header of an "
        "orientation map. Choose another file."
    )


def title_of(name: str) -> str:
    """The name of a file in a form for messages: no folders, no odd letters, not long.

    Examples
    --------
    >>> title_of("C:\\\\maps\\\\grain.ctf"), title_of("\\x1b[31m.csv"), title_of("")
    ('grain.ctf', '[31m.csv', 'the file')
    """
    last = name.replace("\\", "/").rpartition("/")[2]
    seen = "".join(letter for letter in last if letter.isprintable())
    return seen[: PAGE.title] or "the file"


@lru_cache(maxsize=2)
def read_map(
    content: bytes, title: str, threshold: float | None = None, laue: tuple[str, int] | None = None
) -> SampledFrame | OrientationMap | LatticePhases:
    """The map in a file; the last two are cached, since a slider requests the same map again.

    threshold: of grains, degrees. laue: a Laue group that replaces the one in the file, and the
    number of its phase, 0 for all. Both apply to orientation maps only.

    Raises
    ------
    GeomtorsionError
        The file is damaged, or holds something else or too much; the message names it by its title.
    """
    kind = kind_of(content)
    if kind == ".npz":
        _check_unpacked(content)
    with TemporaryDirectory() as folder:
        path = Path(folder, _STEM + kind)
        path.write_bytes(content)
        try:
            content_kind = content_of(path)
            if content_kind is IMAGE:
                return _lattice(path)
            is_map = content_kind is MAP
            data = _orientations(path, threshold, laue) if is_map else _frame(path)
        except GeomtorsionError as error:
            text = str(error).replace(str(path), title).replace(path.name, title)
            # The error keeps its class: a LimitError stays a LimitError.
            raise type(error)(text) from None
    shape = data.shape if isinstance(data, OrientationMap) else tuple(map(len, data.axes))
    count = 1
    for length in shape:
        count *= length
    if count > PAGE.nodes:
        raise LimitError(
            f"{title}: expected a map of at most {PAGE.nodes:,} nodes, got {count:,}. Cut out a "
            "smaller map, or read the file in Python."
        )
    if len(shape) < 2:
        raise GridError(
            f"{title}: expected a map with at least two axes, got one. Choose another file."
        )
    return data


def _lattice(path: Path) -> LatticePhases:
    """The phases of a picture of a lattice; sizes are in pixels."""
    return LatticeImage(read_pixels(path, most=PAGE.pixels, sized=False).values).phases()


def _orientations(
    path: Path, threshold: float | None, laue: tuple[str, int] | None
) -> OrientationMap:
    """An orientation map."""
    # 0 means all phases, both on the page and in OrientationMap.read.
    groups = {} if laue is None else {laue[1]: laue[0]}
    if threshold is None:
        return OrientationMap.read(path, laue=groups)
    return OrientationMap.read(path, laue=groups, threshold=threshold)


def _frame(path: Path) -> SampledFrame:
    """A sampled frame, with its noise, estimated from the data if the file does not state it."""
    frame = SampledFrame.read(path)
    if frame.sigma is not None:
        return frame
    try:
        return SampledFrame(
            frame.axes, frame.coframe, frame.order, frame.names, mask=frame.mask, sigma="estimate",
            periodic=frame.periodic, unit=frame.unit, vector_unit=frame.vector_unit,
            source=frame.source,
        )  # fmt: skip
    except GridError:
        # A small map has too few differences; its noise is then unknown.
        return frame


def _check_unpacked(content: bytes) -> None:
    """Refuse an archive whose stated size exceeds the limit of the page.

    Raises
    ------
    FileFormatError, LimitError
        It is damaged, or too large.
    """
    try:
        with zipfile.ZipFile(io.BytesIO(content)) as archive:
            size = sum(member.file_size for member in archive.infolist())
    except (zipfile.BadZipFile, zlib.error, ValueError, OSError, RuntimeError, EOFError) as error:
        raise FileFormatError(
            f"{EXPECTED}, got an archive that cannot be read ({error}). Check that the file is "
            "complete, or save it again."
        ) from None
    if size > PAGE.unpacked:
        raise LimitError(
            f"expected an archive of at most {PAGE.unpacked:,} unpacked bytes, got {size:,}. Cut "
            "out a smaller map, or read the file in Python."
        )

"""uploads: bytes of a file that somebody gives, recognised by what is in them, read."""

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
from geomtorsion.materials.readers import IMAGE, READERS, suffixes_of
from geomtorsion.teaching.lab.settings import PAGE

# First bytes of formats that are something else -> what they are.
_OTHERS: dict[bytes, str] = {
    b"\xff\xd8\xff": "a picture whose details were thrown away (JPEG)",
    b"\x89HDF": "HDF5 or NetCDF",
    b"CDF": "NetCDF",
    b"\x80": "a pickle, which nobody here opens",
}
# Text that the page recognises by its content, and ends of images.
TEXT_MAPS = tuple(reader.suffix for reader in READERS if reader.seems is not None)
IMAGES = tuple(reader.suffix for reader in READERS if reader.kind is IMAGE)
NEEDED = (
    "a sampled frame (NPZ or CSV, as SampledFrame.save writes them), an orientation map "
    f"({' or '.join(TEXT_MAPS)}) or a picture of a lattice (PNG, TIFF, NPY) was needed"
)
# What a file is called while it is read: messages name it as its owner does.
_STEM = "given-map"


def kind_of(content: bytes) -> str:
    """How a file of such a content would end; its own name decides nothing.

    Raises
    ------
    FileFormatError
        It is nothing that the page reads; the message says what it seems to be.

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
            raise FileFormatError(f"{NEEDED}, but the file is {what}. Save the map in one of them.")
    if not content.strip():
        raise FileFormatError(f"{NEEDED}, but the file is empty. Choose another.")
    for reader in READERS:
        if reader.seems is not None and reader.seems(content):
            return reader.suffix
    lines = content.splitlines()
    row = next((line for line in lines if line.strip() and not line.startswith(b"#")), b"")
    if b"," in row:
        return ".csv"
    raise FileFormatError(
        f"{NEEDED}, but neither a header of columns nor that of an orientation map was found in "
        "the file. Choose another."
    )


def title_of(name: str) -> str:
    """The name of a file as it may stand in a sentence: no folders, no odd letters, not long.

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
    """The map in a file; the last two stay, since a slider asks for the same one again.

    threshold: of grains, degrees. laue: a Laue group instead of what the file says, and the number
    of the phase that has it, 0 for all. Both are about orientation maps alone.

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
            if kind in IMAGES:
                return _lattice(path)
            found = _orientations(path, threshold, laue) if kind in TEXT_MAPS else _frame(path)
        except GeomtorsionError as error:
            said = str(error).replace(str(path), title).replace(path.name, title)
            # Of the same class: a limit stays a limit.
            raise type(error)(said) from None
    shape = found.shape if isinstance(found, OrientationMap) else tuple(map(len, found.axes))
    count = 1
    for length in shape:
        count *= length
    if count > PAGE.nodes:
        raise LimitError(
            f"{title}: the map has {count:,} nodes; the page takes up to {PAGE.nodes:,}. Cut a "
            "smaller map out of it, or use it in Python."
        )
    if len(shape) < 2:
        raise GridError(f"{title}: two axes or more were needed, but the map has one.")
    return found


def _lattice(path: Path) -> LatticePhases:
    """The phases of a picture of a lattice; sizes are in pixels."""
    return LatticeImage(read_pixels(path, most=PAGE.pixels)).phases()


def _orientations(
    path: Path, threshold: float | None, laue: tuple[str, int] | None
) -> OrientationMap:
    """An orientation map."""
    # 0 stands for all phases, on the page and for who reads maps.
    groups = {} if laue is None else {laue[1]: laue[0]}
    if threshold is None:
        return OrientationMap.read(path, laue=groups)
    return OrientationMap.read(path, laue=groups, threshold=threshold)


def _frame(path: Path) -> SampledFrame:
    """A sampled frame, with its noise, estimated from the data where the file does not tell it."""
    found = SampledFrame.read(path)
    if found.sigma is not None:
        return found
    try:
        return SampledFrame(
            found.axes, found.coframe, found.order, found.names, mask=found.mask, sigma="estimate",
            periodic=found.periodic, unit=found.unit, vector_unit=found.vector_unit,
            source=found.source,
        )  # fmt: skip
    except GridError:
        # A small map has too few differences; then nothing is known of its noise.
        return found


def _check_unpacked(content: bytes) -> None:
    """Refuse an archive that says it holds more than the page unpacks.

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
            f"{NEEDED}, but the archive cannot be read ({error}). Is it complete? Save it again."
        ) from None
    if size > PAGE.unpacked:
        raise LimitError(
            f"the archive holds {size:,} bytes; the page unpacks up to {PAGE.unpacked:,}. Cut a "
            "smaller map out of it, or use it in Python."
        )

"""VTU blocks: decompressed size of the arrays of a VTU file, checked before reading."""

from __future__ import annotations

import base64
import re
import struct
import zlib
from collections.abc import Iterator
from lzma import LZMADecompressor
from pathlib import Path
from typing import Any
from xml.etree import ElementTree as ET

from geomtorsion.errors import FileFormatError, LimitError
from geomtorsion.support.files import BOUNDS
from geomtorsion.support.npz import most_unpacked, unpacked_size

UNPACKERS: dict[str, Any] = {
    "vtkZLibDataCompressor": zlib.decompressobj,
    "vtkLZMADataCompressor": LZMADecompressor,
}
# The tag after which meshio expects raw bytes instead of XML.
_RAW = re.compile(rb'<AppendedData[^>]+">')


def check_vtu(path: Path) -> None:
    """Refuse a VTU file whose arrays together decompress to more than a file may hold.

    Raises
    ------
    LimitError
        The decompressed size is too large, or there are too many arrays.
    FileFormatError
        The file is not XML.
    """
    content = path.read_bytes()
    root, appended = _parsed(path, content)
    arrays = list(root.iter("DataArray"))
    if len(arrays) > BOUNDS.arrays:
        raise LimitError(
            f"{path}: expected at most {BOUNDS.arrays:,} arrays, got {len(arrays):,}. Export only "
            "the values of the frame."
        )
    unpacker = UNPACKERS.get(root.get("compressor", ""))
    if unpacker is None:
        return
    most = left = most_unpacked(len(content))
    for array in arrays:
        kind = array.get("format")
        data: bytes | str = (array.text or "").strip() if kind == "binary" else ""
        if kind == "appended":
            offset = array.get("offset", "")
            data = appended[int(offset) :] if offset.isdecimal() and len(offset) < 19 else ""
        for block in _blocks(data, root):
            left -= unpacked_size(unpacker(), block, left)
            if left < 0:
                raise LimitError(
                    f"{path}: expected arrays of at most {most:,} bytes, for a file of "
                    f"{len(content):,}, got more. Export the file without compression."
                )


def _parsed(path: Path, content: bytes) -> tuple[ET.Element, bytes | str]:
    """The XML of a file, and its appended data: text in base 64, or raw bytes."""
    try:
        root = ET.fromstring(content)
    except ET.ParseError:
        match = _RAW.search(content)
        try:
            if match is None:
                raise ValueError
            root = ET.fromstring(content[: match.end()] + b"</AppendedData></VTKFile>")
        except (ET.ParseError, ValueError):
            raise FileFormatError(
                f"{path}: expected a VTU file, got one that is truncated or has another format. "
                "Export it again."
            ) from None
        return root, content[match.end() :].partition(b"_")[2]
    text = next((part.text or "" for part in root.iter("AppendedData")), "")
    return root, text.strip()[1:]


def _blocks(data: bytes | str, root: ET.Element) -> Iterator[bytes]:
    """The compressed blocks of an array; none if its header does not fit the data.

    Readers report such a header. It contains the number of blocks, the size of a block, the size of
    the last block, and the compressed sizes.
    """
    width = 8 if root.get("header_type") == "UInt64" else 4
    order = ">" if root.get("byte_order") == "BigEndian" else "<"

    def head(count: int) -> tuple[int, ...]:
        size = count * width
        first = data[:size] if isinstance(data, bytes) else _decoded(data[: _letters(size)])[:size]
        whole = len(first) // width
        return struct.unpack(f"{order}{whole}{'Q' if width == 8 else 'I'}", first[: whole * width])

    (blocks, *_) = head(1) or (0,)
    size = (3 + blocks) * width
    if size > len(data):
        return
    sizes = head(3 + blocks)[3:]
    if isinstance(data, str):
        start = _letters(size)
        data = _decoded(data[start : start + _letters(sum(sizes))])
    else:
        data = data[size : size + sum(sizes)]
    place = 0
    for count in sizes:
        yield data[place : place + count]
        place += count


def _letters(size: int) -> int:
    """Number of base-64 letters for a number of bytes."""
    return 4 * -(-size // 3)


def _decoded(text: str) -> bytes:
    """Bytes from base 64; none if the text is not base 64, which readers report."""
    try:
        return base64.b64decode(text)
    except ValueError:
        return b""

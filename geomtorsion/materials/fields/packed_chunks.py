"""Packed chunks: decompressed sizes of the chunks of a Zarr array, checked before reading."""

from __future__ import annotations

import bz2
import lzma
import struct
import zlib
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any, BinaryIO

from geomtorsion.errors import FileFormatError, LimitError
from geomtorsion.support.files import BOUNDS
from geomtorsion.support.npz import DENSEST, unpacked_size

# Codecs whose decompressed size must be counted, and their decompressors.
_COUNTED = {
    "gzip": lambda: zlib.decompressobj(wbits=31),
    "zlib": zlib.decompressobj,
    "bz2": bz2.BZ2Decompressor,
    "lzma": lzma.LZMADecompressor,
}
# Codecs that write the decompressed size at the beginning.
_WRITTEN = ("blosc", "zstd", "lz4")


def check_packed(path: Path, said: Mapping[str, Any], size: int, inner: int) -> None:
    """Refuse an array with a chunk that unpacks to more than its size.

    `said`: the description of the array. size: bytes of a decompressed chunk. inner: chunks in a
    shard.

    Raises
    ------
    LimitError
        A chunk unpacks to more than its size.
    FileFormatError
        Chunks are compressed twice, or the shards have an unsupported format.
    """
    codecs = [*(said.get("codecs") or []), said.get("compressor"), *(said.get("filters") or [])]
    named = {_name(one): one for one in codecs if one}
    sharding = named.get("sharding_indexed")
    if sharding:
        configuration = sharding.get("configuration") or {}
        named = {_name(one): one for one in configuration.get("codecs") or []}
        _check_index(path, configuration)
    packings = [name for name in named if name in _COUNTED or name in _WRITTEN]
    if len(packings) > 1 or "sharding_indexed" in named:
        raise FileFormatError(
            f"{path}: expected chunks compressed once, got {', '.join(named)}. Write the array "
            "again with one compressor."
        )
    if not packings:
        return
    for file in path.rglob("*"):
        if not file.is_file() or file.name.startswith(".z") or file.name == "zarr.json":
            continue
        with file.open("rb") as stream:
            length = file.stat().st_size
            parts = _parts(stream, length, inner, sharding) if sharding else [(0, length)]
            for start, count in parts:
                stream.seek(start)
                if (unpacked_bytes := _unpacked(stream, packings[0], count, size)) > size:
                    raise LimitError(
                        f"{file}: expected a chunk of {size:,} bytes, got one that unpacks to "
                        f"{unpacked_bytes:,} or more. Write the array again."
                    )


def _name(codec: Any) -> str:
    """The name of a codec, in both versions of Zarr."""
    return str(codec.get("id") or codec.get("name")) if isinstance(codec, Mapping) else ""


def _check_index(path: Path, configuration: Mapping[str, Any]) -> None:
    """Refuse shards whose index is not plain numbers with a checksum."""
    codecs = configuration.get("index_codecs") or []
    names = [_name(one) for one in codecs]
    order = (codecs[0].get("configuration") or {}).get("endian", "little") if codecs else ""
    if names not in (["bytes"], ["bytes", "crc32c"]) or order != "little":
        raise FileFormatError(
            f"{path}: expected an index of shards with the codecs bytes and crc32c, got "
            f"{', '.join(names)}. Write the array again, or without shards."
        )


def _parts(
    stream: BinaryIO, length: int, inner: int, sharding: Mapping[str, Any]
) -> Iterator[tuple[int, int]]:
    """Positions and lengths in bytes of the chunks in a shard."""
    configuration = sharding["configuration"]
    size = 16 * inner
    checked = 4 * (len(configuration["index_codecs"]) - 1)
    at_start = configuration.get("index_location") == "start"
    stream.seek(0 if at_start else max(0, length - size - checked))
    index = stream.read(size)
    for start, count in struct.iter_unpack("<QQ", index[: len(index) // 16 * 16]):
        # Both numbers are 2**64 - 1 for a chunk that is not in the shard.
        if start < length:
            yield start, min(count, length - start)


def _unpacked(stream: BinaryIO, packing: str, count: int, most: int) -> int:
    """Decompressed bytes of a chunk, or more than `most`; its reader refuses a damaged chunk."""
    if packing in _COUNTED:
        # A chunk that cannot unpack to a large size is not counted.
        if packing in ("gzip", "zlib") and count * DENSEST <= BOUNDS.unpacked:
            return 0
        return unpacked_size(_COUNTED[packing](), stream.read(count), most)
    # The longest header, in Zstandard frames, has 18 bytes.
    head = stream.read(min(count, 18))
    if packing == "zstd":
        return _of_zstd(head, most)
    place = 4 if packing == "blosc" else 0
    written = head[place : place + 4]
    return int.from_bytes(written, "little") if len(written) == 4 else 0


def _of_zstd(head: bytes, most: int) -> int:
    """The size in the header of a Zstandard frame [RFC 8878]; too large if there is no size."""
    if len(head) < 6 or head[:4] != b"\x28\xb5\x2f\xfd":
        return 0
    kind, single, named = head[4] >> 6, head[4] >> 5 & 1, head[4] & 3
    place = 5 + (not single) + (0, 1, 2, 4)[named]
    width = (single, 2, 4, 8)[kind]
    if not width:
        return most + 1
    return int.from_bytes(head[place : place + width], "little") + 256 * (width == 2)

"""NPZ: arrays from outside, each checked against its form before memory is allocated."""

from __future__ import annotations

import struct
import zipfile
import zlib
from collections.abc import Mapping
from dataclasses import dataclass
from math import prod
from os import PathLike
from pathlib import Path
from stat import S_ISREG
from tokenize import TokenError
from types import EllipsisType
from typing import TYPE_CHECKING, Any

from geomtorsion.errors import FileFormatError, LimitError
from geomtorsion.support.checks import LARGEST_ARRAYS, ErrorClass, cut, file_name
from geomtorsion.support.files import BOUNDS, LARGEST_TEXT, conforming, read_json_text
from geomtorsion.support.outgoing import quiet_libraries

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import ArrayLike


_FOREIGN = (
    ArithmeticError, EOFError, LookupError, MemoryError, OSError, RuntimeError, TypeError,
    SyntaxError, TokenError, ValueError, struct.error, zipfile.BadZipFile, zlib.error,
)  # fmt: skip


@dataclass(frozen=True)
class ArrayForm:
    """Required form of an array in an NPZ file.

    shape: one entry per axis: a length, None for any, or a letter, equal letters meaning equal
    lengths throughout the file; dots at the end for any further axes; shape None: any.
    kinds: NumPy's letters of dtypes: "f" floats, "i" and "u" whole numbers, "U" text, "b" truth
    values. optional: whether it may be missing.
    """

    shape: tuple[int | str | EllipsisType | None, ...] | None = None
    kinds: str = "fiu"
    optional: bool = False


TEXT_FORM = ArrayForm((), "U")


def most_unpacked(size: int) -> int:
    """Bytes to which a packed file of a size may unpack.

    Examples
    --------
    >>> most_unpacked(1_000_000), most_unpacked(10**9) == LARGEST_ARRAYS
    (300000000, True)
    """
    return min(LARGEST_ARRAYS, BOUNDS.unpacked + BOUNDS.unpacked_each * size)


def read_npz(
    path: str | PathLike[str],
    forms: Mapping[str, ArrayForm],
    *,
    error: ErrorClass = FileFormatError,
    message: str = "{path}: it cannot be read ({reason}). Write it again.",
    largest: int = LARGEST_ARRAYS,
) -> dict[str, np.ndarray]:
    """Arrays of an NPZ file, each checked against its form before memory is allocated.

    forms: name -> form; a name that ends in a star matches all names with this beginning.
    Arrays without a form are not read. message: the text of the error, with {path} and {reason}.

    Examples
    --------
    >>> import numpy as np
    >>> from tempfile import TemporaryDirectory
    >>> with TemporaryDirectory() as folder:
    ...     file = Path(folder, "a.npz")
    ...     np.savez(file, times=np.zeros(3), states=np.ones((3, 2)))
    ...     forms = {"times": ArrayForm(("m",)), "states": ArrayForm(("m", "n"))}
    ...     sorted(read_npz(file, forms))
    ['states', 'times']
    """
    path = file_name(path)
    lengths: dict[str, int] = {}
    arrays: dict[str, np.ndarray] = {}
    try:
        if not S_ISREG(path.stat().st_mode):
            raise ValueError("this is not a regular file")
        with path.open("rb") as stream, zipfile.ZipFile(stream) as archive:
            members = {m.filename.removesuffix(".npy"): m for m in archive.infolist()}
            if len(members) != len(archive.infolist()):
                raise ValueError("it contains a name twice")
            left = largest
            for name, form in forms.items():
                stem = name.removesuffix("*")
                wanted = (
                    [key for key in members if key.startswith(stem)]
                    if name.endswith("*")
                    else [name] * (name in members or not form.optional)
                )
                for key in wanted:
                    if key not in members:
                        raise KeyError(f"{key} is not a file in the archive")
                    array = _array(archive, members[key], form, lengths, left)
                    arrays[key], left = array, left - array.nbytes
    except _FOREIGN as reason:
        said = cut(str(reason)) or type(reason).__name__
        raise error(message.format(path=path, reason=said)) from None
    return arrays


def _array(
    archive: zipfile.ZipFile,
    member: zipfile.ZipInfo,
    form: ArrayForm,
    lengths: dict[str, int],
    left: int,
) -> np.ndarray:
    """One array; foreign errors, and ValueError for a wrong form."""
    # numpy takes 0.09 s to load, which reading a TOML file does not need.
    from numpy.lib import format as npy

    name = member.filename.removesuffix(".npy")
    with archive.open(member) as stream, quiet_libraries():
        version = npy.read_magic(stream)
        header = npy.read_array_header_1_0 if version == (1, 0) else npy.read_array_header_2_0
        shape, _, dtype = header(stream)
    if dtype.kind not in form.kinds or dtype.hasobject:
        raise ValueError(f"{name} holds {dtype}, which does not fit")
    _check_shape(name, shape, form, lengths)
    size = prod(shape) * dtype.itemsize
    # A single text is parsed later, which takes many times its size.
    left = min(left, 4 * LARGEST_TEXT) if form == TEXT_FORM else left
    if size > min(left, member.file_size):
        raise ValueError(f"{name} would take {size:,} bytes, more than can be in this file")
    with archive.open(member) as stream, quiet_libraries():
        array = npy.read_array(stream, allow_pickle=False)
        # Reading to the end compares the checksum.
        if stream.read(1):
            raise ValueError(f"{name} holds more numbers than {cut(str(shape))}")
    return array.astype(dtype.newbyteorder("="), copy=False)


def mapped_npy(path: Path) -> np.ndarray:
    """The memory map of an NPY file, without unpickling; ValueError for a damaged header."""
    # As above.
    import numpy as np

    try:
        return np.load(path, mmap_mode="r", allow_pickle=False)
    except (SyntaxError, TokenError) as error:
        # NumPy reads headers as Python does.
        raise ValueError(f"the header is damaged: {error}") from None


def _check_shape(
    name: str, shape: tuple[int, ...], form: ArrayForm, lengths: dict[str, int]
) -> None:
    """Refuse a shape that does not fit the form or the arrays before it."""
    if form.shape is None:
        return
    axes = [n for n in form.shape if not isinstance(n, EllipsisType)]
    fits = len(shape) >= len(axes) if ... in form.shape else len(shape) == len(axes)
    for wanted, came in zip(axes, shape, strict=False):
        expected = lengths.setdefault(wanted, came) if isinstance(wanted, str) else wanted
        fits = fits and expected in (None, came)
    if not fits:
        known = [str(lengths.get(n, n) if isinstance(n, str) else n) for n in axes]
        needed = ", ".join("any" if n == "None" else n for n in known)
        more = ", ..." if ... in form.shape else ""
        came = cut(str(shape))
        raise ValueError(f"{name}: expected shape ({needed}{more}), got {came}")


def write_npz(path: Path, arrays: Mapping[str, ArrayLike], *, packed: bool = True) -> None:
    """Write arrays by name as an NPZ file; within `written` whole or not at all.

    packed: smaller and slower.

    Examples
    --------
    >>> from tempfile import TemporaryDirectory
    >>> with TemporaryDirectory() as folder:
    ...     file = Path(folder, "a.npz")
    ...     write_npz(file, {"times": [1.0, 2.0]})
    ...     read_npz(file, {"times": ArrayForm((2,))})["times"].tolist()
    [1.0, 2.0]
    """
    # As above.
    import numpy as np

    write: Any = np.savez_compressed if packed else np.savez
    # Given a name, NumPy would add an ending to it.
    with path.open("wb") as stream:
        write(stream, **arrays)


def text_of(array: np.ndarray) -> str:
    """The text in an array without axes, as `TEXT_FORM` requires."""
    return str(array[()])


def json_in(
    arrays: Mapping[str, np.ndarray],
    key: str,
    form: Any,
    *,
    path: str | PathLike[str],
    error: ErrorClass = FileFormatError,
    message: str,
) -> Any:
    """The JSON in one array of an NPZ file, of a given form; errors are worded as by
    `read_npz`.
    """
    try:
        return conforming(read_json_text(text_of(arrays[key]), key), form, key)
    except (FileFormatError, LimitError) as reason:
        said = str(reason).removesuffix(".")
        raise error(message.format(path=path, reason=said)) from None

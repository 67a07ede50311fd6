"""Files: TOML and JSON from outside, read within limits; nothing in them is executed.

Each reader turns every way in which a file can be damaged into one error that names the file and,
where there is one, the line or the part.
"""

from __future__ import annotations

import bz2
import errno
import gzip
import hashlib
import io
import json
import math
import os
import re
import tomllib
import zlib
from collections.abc import Iterable, Iterator, Mapping, Sequence
from contextlib import ExitStack, contextmanager, suppress
from dataclasses import dataclass
from os import PathLike
from pathlib import Path
from stat import S_ISREG
from typing import Any, BinaryIO, NoReturn

from geomtorsion.errors import CheckpointError, FileFormatError, GeomtorsionError, LimitError
from geomtorsion.support import checks
from geomtorsion.support.checks import ErrorClass, cut, did_you_mean, shown

LARGEST_TEXT = 10_000_000
Key = tuple[str | int, ...]


@dataclass(frozen=True)
class Bounds:
    """Limits on declarations in a file, besides those from its length: each with its reason.

    key_parts: of a dotted key in TOML. tomllib keeps a tuple for each beginning of a key, so that
    memory and time grow with the square; no file of this package has more than five.
    parallel: lines between the same two nodes of a network. Each is compared with the others to
    find its description from the other node.
    phases: of an orientation map; programs number them by one byte.
    groups: of HDF5 inside one another; files of microscopes have up to ten.
    unpacked, unpacked_each: bytes to which any packed file may unpack, and more for each of its
    bytes: a frame on a regular grid packs to a tenth, equal values everywhere to a hundredth.
    unpacked_row: bytes that a row of text takes in memory besides its own, counted for each row of
        a packed file: a million empty rows pack to a thousand bytes.
    portion: bytes that are unpacked at once while sizes are compared.
    beginning: bytes in which a text file shows its format: headers of maps have some hundred lines.
    """

    key_parts: int = 32
    parallel: int = 100
    phases: int = 255
    groups: int = 50
    unpacked: int = 200_000_000
    unpacked_each: int = 100
    unpacked_row: int = 100
    portion: int = 2**20
    beginning: int = 2**17


BOUNDS = Bounds()

_HEADER = re.compile(r"\s*(\[\[?)([^\[\]#]+)\]\]?\s*(?:#.*)?$")
_WORD = r"(?:[A-Za-z0-9_-]+|\"[^\"]*\"|'[^']*')"
_PART = r"(?:[A-Za-z0-9_-]+|\"(?:[^\"\\\n]|\\.)*\"|'[^'\n]*')"
_ASSIGNED = re.compile(rf"\s*({_WORD}(?:\s*\.\s*{_WORD})*)\s*=")
# What a TOML file consists of beside signs: long texts, comments, and words, also with dots between
# them. Each is taken whole, so that looking through a file takes time in proportion to its length.
_TOKEN = re.compile(
    rf"\"\"\"(?:[^\\]|\\.)*?\"\"\"|'''.*?'''|#[^\n]*|(?P<key>{_PART}(?:[ \t]*\.[ \t]*{_PART})*)",
    re.DOTALL,
)
_QUOTE = re.compile(r"\"\"\"|'''|\"(?:[^\"\\]|\\.)*\"|'[^']*'|#.*|[\[\]{}]")
_PLACE = re.compile(r"\(at line ([0-9]+), column ([0-9]+)\)")


# A number without its sign, as programs write it.
UNSIGNED = r"(?:[0-9]+\.?[0-9]*|\.[0-9]+)(?:[eE][+-]?[0-9]+)?"
_NUMBER = re.compile(rf"[+-]?{UNSIGNED}")


def finite_number(word: str) -> float | None:
    """The finite number that a word of a file is, or None.

    Python's own reader takes more: 1_000, nan, and digits of other scripts.

    Examples
    --------
    >>> finite_number("-.5e3"), finite_number("1_000"), finite_number("1e999")
    (-500.0, None, None)
    """
    value = float(word) if _NUMBER.fullmatch(word) else math.inf
    return value if math.isfinite(value) else None


def plain_float(word: str) -> float:
    """The float of a word, which may be nan or inf; ValueError for 1_000 and foreign digits.

    Examples
    --------
    >>> plain_float(" 1e-3"), plain_float("-inf")
    (0.001, -inf)
    """
    if "_" in word or not word.isascii():
        raise ValueError(f"could not convert string to float: {word!r}")
    return float(word)


# First bytes of packed files -> function that unpacks them, and the endings of their names.
_PACKED = {b"\x1f\x8b": gzip.open, b"BZh": bz2.open}
_PACKED_ENDS = (".gz", ".bz2")
# Packed files that are not read, and the program that unpacks each.
_FOREIGN_PACKED = {b"\x28\xb5\x2f\xfd": "zstd -d", b"\xfd7zXZ\x00": "xz -d"}


def ending(path: object) -> str:
    """End of the name of a file in small letters, without the ending of a packed file.

    Raises
    ------
    ArgumentError
        It is not a name of a file.

    Examples
    --------
    >>> ending("map.CTF"), ending("run.dump.gz"), ending("POSCAR")
    ('.ctf', '.dump', '')
    """
    name = checks.file_name(path)
    packed = name.suffix.lower() in _PACKED_ENDS
    return Path(name.stem if packed else name.name).suffix.lower()


class _Unpacked(io.RawIOBase):
    """Bytes of a packed file, counted while they are unpacked; most: of them and of their rows."""

    def __init__(self, name: str, source: BinaryIO, most: int) -> None:
        self.name, self.source, self.most = name, source, most
        self.taken = self.rows = 0

    def readable(self) -> bool:
        return True

    def readinto(self, buffer: Any) -> int:
        try:
            content = self.source.read(min(len(buffer), BOUNDS.portion))
        except (OSError, EOFError, zlib.error):
            raise FileFormatError(
                f"{self.name}: expected a whole packed file, got one that is damaged or truncated. "
                "Copy it again."
            ) from None
        self.taken += len(content)
        self.rows += content.count(b"\n")
        memory = self.taken + BOUNDS.unpacked_row * self.rows
        if self.taken > checks.LARGEST_ARRAYS or memory > self.most:
            most = min(self.most, checks.LARGEST_ARRAYS)
            raise LimitError(
                f"{self.name}: expected at most {most:,} bytes when it is unpacked, got more in "
                f"{self.rows:,} rows. Unpack it, then read that."
            )
        buffer[: len(content)] = content
        return len(content)


def check_file(path: Path) -> None:
    """Refuse a path that names a folder, or nothing."""
    if path.is_dir():
        raise FileFormatError(f"{path}: expected a file, got a folder. Give one of its files.")
    if not path.is_file():
        raise FileFormatError(f"{path}: there is no such file.")


@contextmanager
def opened(path: str | PathLike[str]) -> Iterator[BinaryIO]:
    """The bytes of a file, unpacked where it is packed by gzip or bzip2.

    Unpacked bytes are counted as they come, against a limit in proportion to the packed ones.

    Raises
    ------
    FileFormatError
        There is no such file, it is a pipe or a device, packed otherwise, or damaged.
    LimitError
        It unpacks to more.
    """
    path = checks.file_name(path)
    try:
        # A pipe or a device would never end.
        if not S_ISREG(path.stat().st_mode):
            raise OSError(0, "this is not a regular file")
        file = path.open("rb")
    except OSError as error:
        reason = error.strerror or type(error).__name__
        raise FileFormatError(f"{path}: the file cannot be read: {reason}.") from None
    except ValueError:
        raise FileFormatError(f"{shown(str(path))}: this is not the name of a file.") from None
    with file:
        first = file.peek(6)
        for mark, program in _FOREIGN_PACKED.items():
            if first.startswith(mark):
                raise FileFormatError(
                    f"{path.name}: expected a file that is plain or packed by gzip or bzip2, got "
                    f"one packed otherwise. Unpack it: {program} {path.name}"
                )
        unpack = next((u for mark, u in _PACKED.items() if first.startswith(mark)), None)
        if unpack is None:
            yield file
            return
        bound = BOUNDS.unpacked + BOUNDS.unpacked_each * path.stat().st_size
        with unpack(file) as source:
            yield io.BufferedReader(_Unpacked(path.name, source, bound))


def _read(file: BinaryIO, most: int) -> bytes:
    """The bytes of a file, up to so many; a single call would allocate all of them before."""
    portions, left = [], most
    while left and (portion := file.read(min(left, BOUNDS.portion))):
        portions.append(portion)
        left -= len(portion)
    return b"".join(portions)


def read_text(
    path: str | PathLike[str], largest: int = LARGEST_TEXT, *, otherwise: str | None = None
) -> str:
    """The text of a file (UTF-8), up to a limit in bytes.

    otherwise: the encoding of files that are not UTF-8, such as "latin-1" (every byte is valid).

    Raises
    ------
    FileFormatError
        There is no such file, it is a pipe or a device, or not UTF-8 text.
    LimitError
        It is longer.
    """
    path = checks.file_name(path)
    try:
        with opened(path) as file:
            content = _read(file, largest + 1)
    except OSError as error:
        reason = error.strerror or type(error).__name__
        raise FileFormatError(f"{path}: the file cannot be read: {reason}.") from None
    if len(content) > largest:
        raise LimitError(f"{path.name}: the file is longer than the limit of {largest:,} bytes.")
    try:
        return content.decode("utf-8-sig")
    except UnicodeDecodeError:
        if otherwise is not None:
            return content.decode(otherwise)
        raise FileFormatError(
            f"{path.name}: expected UTF-8 text, got other bytes. Save the file as UTF-8."
        ) from None


# Error codes of a full disk, or of a file that may not grow.
_FULL = frozenset({errno.ENOSPC, errno.EFBIG, getattr(errno, "EDQUOT", errno.ENOSPC)})


@contextmanager
def written(path: object, *, is_folder: bool = False) -> Iterator[Path]:
    """A path to write a file to, or a folder that is made.

    The file is written beside its place under another name with the same ending, and moved there
    at the end: it is whole, or as it was before, and an error leaves nothing behind.

    Raises
    ------
    ArgumentError
        It is not a name.
    FileFormatError
        The system refuses to write there; the message gives the reason.

    Examples
    --------
    >>> with written("/nowhere/a.txt") as file:
    ...     _ = file.write_text("a")
    Traceback (most recent call last):
    geomtorsion.errors.FileFormatError: /nowhere/a.txt: the file cannot be written: No such file \
or directory. Name a file in a folder that exists.
    """
    found = checks.file_name(path)
    if "\0" in str(found) or not (found.name or is_folder):
        raise FileFormatError(f"{shown(str(path))}: this is not the name of a file.")
    try:
        if is_folder:
            found.mkdir(parents=True, exist_ok=True)
            yield found
        else:
            with _beside(found) as part:
                yield part
    except OSError as error:
        if isinstance(error, GeomtorsionError):
            raise
        remedy = "Name another folder" if is_folder else "Name a file in a folder that exists"
        # On a full disk NumPy reports only that an element was not written.
        if error.errno is None or error.errno in _FULL:
            remedy = "Free space on this disk, or name another one"
        raise FileFormatError(
            f"{cut(str(found))}: the file cannot be written: {error.strerror or error}. {remedy}."
        ) from None


def make_folder(path: object) -> Path:
    """Make a folder, with the folders that hold it; nothing if it exists.

    Raises
    ------
    FileFormatError
        The system does not allow it, or a file has this name.
    """
    with written(path, is_folder=True) as folder:
        return folder


@contextmanager
def _beside(path: Path) -> Iterator[Path]:
    """A temporary file beside a file, which it replaces when the block ends without an error."""
    place = path.resolve() if path.is_symlink() else path
    if place.exists() and not place.is_file():
        # A device or a pipe is written to, never replaced. A folder is refused by the system.
        yield place
        return
    part = place.with_name(f".{place.stem}.{os.getpid()}.part{place.suffix}")
    try:
        yield part
        part.replace(place)
    except GeomtorsionError as error:
        # The writer knows only the temporary name.
        error.args = tuple(str(said).replace(str(part), str(path)) for said in error.args)
        raise
    finally:
        with suppress(OSError):
            part.unlink(missing_ok=True)


def digest_of(path: Path) -> str:
    """SHA-256 of the bytes of a file; of a folder, of its files with their names.

    A file of the same name and size may hold something else, such as the next frame.

    Raises
    ------
    FileFormatError
        There is no such file.
    """
    if path.is_dir():
        files = sorted(one for one in path.rglob("*") if one.is_file())
        listed = [f"{one.relative_to(path).as_posix()} {digest_of(one)}" for one in files]
        return hashlib.sha256("\n".join(listed).encode()).hexdigest()
    if not path.is_file():
        raise FileFormatError(f"{path}: expected a file, got none. Check the name.")
    with path.open("rb") as stream:
        return hashlib.file_digest(stream, "sha256").hexdigest()


def check_resumption(
    where: Path,
    run: str,
    *,
    begun: bool,
    resume: bool,
    overwrite: bool,
    options: str = "--resume",
) -> None:
    """Refuse to overwrite a stopped run without `--overwrite`, or to resume where there is none.

    where: the directory or file. run: the kind of run. begun: whether a stopped run is there.
    options: those that ask for it, in messages.

    Raises
    ------
    CheckpointError
        Both options are set, or they do not fit the state of the directory.

    Examples
    --------
    >>> check_resumption(Path("out"), "map", begun=True, resume=False, overwrite=False)
    Traceback (most recent call last):
    geomtorsion.errors.CheckpointError: out holds a stopped map. Give --resume to continue it, or \
--overwrite to start again.
    """
    if resume and overwrite:
        raise CheckpointError(f"expected {options} or --overwrite, got both. Give one of them.")
    if begun and not (resume or overwrite):
        raise CheckpointError(
            f"{where} holds a stopped {run}. Give --resume to continue it, or --overwrite to start "
            "again."
        )
    if resume and not begun:
        raise CheckpointError(f"{where}: expected a stopped {run}, got none. Omit {options}.")


def write_text(path: str | PathLike[str], text: str) -> None:
    """Write a file of UTF-8 text, whole or not at all; see `written`.

    Raises
    ------
    FileFormatError
        The system does not allow writing there.
    """
    with written(path) as file:
        file.write_text(text, "utf-8", newline="\n")


def write_texts(directory: str | PathLike[str], texts: Mapping[str, str]) -> tuple[Path, ...]:
    """Write files of UTF-8 text into a folder, which is made: all of them or none.

    texts: name, which may begin with folders -> text.

    Raises
    ------
    FileFormatError
        The system does not allow writing there.

    Examples
    --------
    >>> from tempfile import TemporaryDirectory
    >>> with TemporaryDirectory() as folder:
    ...     [path.read_text() for path in write_texts(folder, {"a.txt": "a", "b/c.txt": "c"})]
    ['a', 'c']
    """
    with written(directory, is_folder=True) as folder, ExitStack() as stack:
        paths = tuple(folder / name for name in texts)
        for path, text in zip(paths, texts.values(), strict=True):
            stack.enter_context(written(path.parent, is_folder=True))
            # The files get their names after the last one is on the disk.
            part = stack.enter_context(written(path))
            part.write_text(text, "utf-8", newline="\n")
    return paths


# -- TOML -----------------------------------------------------------------------------------------


class Decimal(str):
    """A decimal number as written in a file, so that messages can offer its exact value."""

    __slots__ = ()


@dataclass(frozen=True)
class TomlFile:
    """The content of a TOML file, with the line of each key.

    name: of the file, for messages. data: the result of tomllib. lines: key -> line, from 1.
    """

    name: str
    data: Mapping[str, Any]
    lines: Mapping[Key, int]

    def line(self, key: Sequence[str | int]) -> int:
        """Line of a key, or of the nearest thing above it.

        Examples
        --------
        >>> file = read_toml_text("t = 1\\n[body]\\nmoments = [1, 2]", "a.toml")
        >>> file.line(("body", "moments", 1)), file.line(("body", "mass")), file.line(("x",))
        (3, 2, 0)
        """
        path = tuple(key)
        while path and path not in self.lines:
            path = path[:-1]
        return self.lines.get(path, 0)

    def fail(self, key: Sequence[str | int], message: str) -> NoReturn:
        """Refuse the value of a key; the message names the file and the line."""
        line = self.line(key)
        where = f"{self.name}: line {line}: " if line else f"{self.name}: "
        raise FileFormatError(f"{where}{message}")

    def unknown(self, key: Sequence[str | int], known: Sequence[str], what: str) -> NoReturn:
        """Refuse a key or a word that is not known, naming the nearest."""
        hint = did_you_mean(str(key[-1]), known)
        self.fail(key, f"{what}. {hint}Known are {', '.join(known)}.")


def read_toml(
    path: str | PathLike[str],
    *,
    advice: str = "Put texts in quotes.",
    decimals: bool = False,
    largest: int = LARGEST_TEXT,
) -> TomlFile:
    """Read a TOML file and record the lines of its keys.

    advice: last sentence of the message for bad TOML. decimals: keep 0.1 as the text `Decimal`.

    Raises
    ------
    FileFormatError
        The file cannot be read, is not UTF-8 text or not TOML; the message names the line.
    LimitError
        The file is too long or too deep, or has a number of very many digits.
    """
    text = read_text(path, largest)
    return read_toml_text(text, Path(path).name, advice=advice, decimals=decimals)


def read_toml_text(
    text: str, name: str, *, advice: str = "Put texts in quotes.", decimals: bool = False
) -> TomlFile:
    """Read the text of a TOML file; see `read_toml`.

    Examples
    --------
    >>> file = read_toml_text("t = 1\\n\\n[[effects]]\\nkind = 'spin'\\n", "top.toml")
    >>> file.data["effects"], file.line(("effects", 0, "kind"))
    ([{'kind': 'spin'}], 4)
    """
    _check_keys(text, name)
    try:
        data = tomllib.loads(text, parse_float=Decimal if decimals else float)
        # Python writes no whole number of many thousand digits, which hexadecimal ones may have.
        _ = repr(data)
    except RecursionError:
        raise LimitError(f"{name}: lists are nested too deeply to be read.") from None
    except tomllib.TOMLDecodeError as error:
        raise _bad_toml(name, text, str(error), advice) from None
    except ValueError:
        raise LimitError(
            f"{name}: a number has more digits than can be read. Write a shorter one."
        ) from None
    return TomlFile(name, data, _lines(text))


def _check_keys(text: str, name: str) -> None:
    """Refuse a dotted key of very many parts before tomllib takes memory for it."""
    for found in _TOKEN.finditer(text):
        key = found["key"] or ""
        count = 0 if key.count(".") < BOUNDS.key_parts else len(_words(key))
        if count > BOUNDS.key_parts:
            raise LimitError(
                f"{name}: line {text.count(chr(10), 0, found.start()) + 1}: expected a key of at "
                f"most {BOUNDS.key_parts} parts, got {count:,}: {cut(key, 60)}. Shorten the key."
            )


def _bad_toml(name: str, text: str, reason: str, advice: str) -> FileFormatError:
    """The error for a text that tomllib refuses, with the refused line."""
    found = _PLACE.search(reason)
    if found is None:
        return FileFormatError(f"{name}: expected TOML, got an error: {cut(reason)}. {advice}")
    line, column = int(found[1]), int(found[2])
    row = text.replace("\r\n", "\n").split("\n")[line - 1]
    # Show only the part of a long line before the mark.
    first = max(0, column - 1 - 150)
    return FileFormatError(
        f"{name}: line {line}, column {column}: expected TOML, got an error: "
        f"{cut(reason[: found.start()].strip())}.\n    {row[first : first + 200]}\n"
        f"    {' ' * (column - 1 - first)}^\n{advice}"
    )


def _lines(text: str) -> dict[Key, int]:
    """Key -> line of everything that is assigned or begins a table.

    The text is TOML already: only where things begin is looked for.
    """
    lines: dict[Key, int] = {}
    counts: dict[Key, int] = {}
    table: Key = ()
    depth, until = 0, ""
    for number, row in enumerate(text.splitlines(), start=1):
        if not depth and not until:
            header, assigned = _HEADER.match(row), _ASSIGNED.match(row)
            if header is not None:
                table = _words(header[2])
                if header[1] == "[[":
                    counts[table] = counts.get(table, -1) + 1
                    lines.setdefault(table, number)
                    table = (*table, counts[table])
                elif table[:1] in counts:
                    table = (table[0], counts[table[:1]], *table[1:])
                lines[table] = number
                continue
            if assigned is not None:
                lines[(*table, *_words(assigned[1]))] = number
        depth, until = _inside(row, depth, until)
    return lines


def _words(dotted: str) -> Key:
    """The parts of a dotted key without their quotes."""
    return tuple(word.strip("\"'") for word in re.findall(_WORD, dotted))


def _inside(row: str, depth: int, until: str) -> tuple[int, str]:
    """Open brackets after a row, and the quotes of a text that continues."""
    place = 0
    if until:
        end = row.find(until)
        if end < 0:
            return depth, until
        place = end + 3
    while (found := _QUOTE.search(row, place)) is not None:
        mark, place = found[0], found.end()
        if mark in ('"""', "'''"):
            end = row.find(mark, place)
            if end < 0:
                return depth, mark
            place = end + 3
        elif mark[0] == "#":
            break
        elif mark in "[{":
            depth += 1
        elif mark in "]}":
            depth -= 1
    return depth, ""


# -- JSON -----------------------------------------------------------------------------------------


def read_json_text(text: str, name: str) -> Any:
    """The content of JSON text; nan and infinity, which JSON does not know, are refused.

    Raises
    ------
    FileFormatError
        The text is not JSON; the message names the line.
    LimitError
        Lists are nested too deeply, or a number has too many digits.

    Examples
    --------
    >>> read_json_text('{"a": [1, 2]}', "a.json")
    {'a': [1, 2]}
    """

    def refuse(word: str) -> NoReturn:
        raise FileFormatError(f"{name}: {word} is not a number in JSON.")

    try:
        return json.loads(text, parse_constant=refuse)
    except json.JSONDecodeError as error:
        raise FileFormatError(
            f"{name}: line {error.lineno}, column {error.colno}: expected JSON, got an error: "
            f"{error.msg}. Check that the file is complete."
        ) from None
    except RecursionError:
        raise LimitError(f"{name}: lists are nested too deeply to be read.") from None
    except FileFormatError:
        raise
    except ValueError:
        raise LimitError(
            f"{name}: a number has more digits than can be read. Write a shorter one."
        ) from None


def conforming(value: Any, form: Any, where: str, error: ErrorClass = FileFormatError) -> Any:
    """A value of JSON that has a given form, unchanged.

    A form is a type (``float`` takes every finite number, ``int`` no truth values), a tuple of
    forms of which one fits, ``[form]`` for a list, ``{str: form}`` for a table with any keys,
    ``{"key": form, ...}`` for a table that has these keys (and perhaps more), a range of whole
    numbers, a frozenset of words, or None. A key that ends in a question mark may be missing.

    Examples
    --------
    >>> conforming({"steps": 3, "names": ["x"]}, {"steps": int, "names": [str]}, "a.npz")
    {'steps': 3, 'names': ['x']}
    >>> conforming({"steps": "3"}, {"steps": int}, "a.npz")
    Traceback (most recent call last):
    geomtorsion.errors.FileFormatError: a.npz: steps: expected a whole number, got '3'.
    """
    reason = _differs(value, form, "")
    if reason:
        raise error(f"{where}: {reason}")
    return value


def _differs(value: Any, form: Any, where: str) -> str:
    """The first error in a value, or nothing."""
    if isinstance(form, tuple):
        reasons = [_differs(value, part, where) for part in form]
        return "" if "" in reasons else reasons[0]
    if isinstance(form, list) and isinstance(value, list):
        return _first(_differs(x, form[0], f"{where}[{k}]") for k, x in enumerate(value))
    if isinstance(form, dict) and isinstance(value, dict):
        return _table_differs(value, form, where)
    wanted = _wanted(value, form)
    return f"{_place(where)}expected {wanted}, got {shown(value)}." if wanted else ""


def _table_differs(value: dict[str, Any], form: dict[Any, Any], where: str) -> str:
    """The first error in a table: of any keys, or of the keys that the form names."""
    dot = f"{where}." if where else ""
    if str in form:
        return _first(_differs(x, form[str], f"{dot}{cut(k, 60)}") for k, x in value.items())
    needed = {key.removesuffix("?"): (part, key[-1:] == "?") for key, part in form.items()}
    return _first(
        _differs(value[name], part, f"{dot}{name}")
        if name in value
        else ("" if may_be_missing else f"{_place(where)}{name} is missing.")
        for name, (part, may_be_missing) in needed.items()
    )


def _wanted(value: Any, form: Any) -> str:
    """What a value without parts should be, in words; nothing if it is that."""
    whole = isinstance(value, int) and not isinstance(value, bool)
    if isinstance(form, frozenset):
        fits = isinstance(value, str) and value in form
        return "" if fits else f"one of {', '.join(sorted(form))}"
    if isinstance(form, range):
        words = f"a whole number from {form.start:,} to {form.stop - 1:,}"
        return "" if whole and value in form else words
    kinds: dict[Any, tuple[bool, str]] = {
        list: (False, "a list"),
        dict: (False, "a table"),
        None: (value is None, "nothing"),
        float: (whole or (isinstance(value, float) and math.isfinite(value)), "a finite number"),
        int: (whole, "a whole number"),
        str: (isinstance(value, str), "text"),
        bool: (isinstance(value, bool), "true or false"),
    }
    fits, words = kinds[type(form) if isinstance(form, list | dict) else form]
    return "" if fits else words


def _first(reasons: Iterable[str]) -> str:
    """The first reason that is not empty, or an empty one."""
    return next((reason for reason in reasons if reason), "")


def _place(where: str) -> str:
    """The beginning of a message about a place."""
    return f"{where}: " if where else ""

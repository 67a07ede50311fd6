"""Places: a TOML file with the line on which each of its keys stands."""

from __future__ import annotations

import re
import tomllib
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any, NoReturn

from geomtorsion.errors import FileFormatError, LimitError
from geomtorsion.exact.names import near_names

LARGEST_FILE = 10_000_000
Key = tuple[str | int, ...]

_HEADER = re.compile(r"\s*(\[\[?)([^\[\]#]+)\]\]?\s*(?:#.*)?$")
_WORD = r"(?:[A-Za-z0-9_-]+|\"[^\"]*\"|'[^']*')"
_ASSIGNED = re.compile(rf"\s*({_WORD}(?:\s*\.\s*{_WORD})*)\s*=")
_QUOTE = re.compile(r"\"\"\"|'''|\"(?:[^\"\\]|\\.)*\"|'[^']*'|#.*|[\[\]{}]")


@dataclass(frozen=True)
class TomlFile:
    """The content of a TOML file that can say where it stands.

    name: of the file, for messages. data: what tomllib reads. lines: key -> line, from 1.
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
        """Refuse what stands at a key, saying the file and the line."""
        line = self.line(key)
        where = f"{self.name}: line {line}: " if line else f"{self.name}: "
        raise FileFormatError(f"{where}{message}")

    def unknown(self, key: Sequence[str | int], known: Sequence[str], what: str) -> NoReturn:
        """Refuse a key or a word that is not known, naming the nearest."""
        near = near_names(str(key[-1]), known)
        hint = f"Did you mean {near}? " if near else ""
        self.fail(key, f"{what}. {hint}Known are {', '.join(known)}.")


def read_toml(path: Path) -> TomlFile:
    """Read a TOML file and note where its keys stand.

    Raises
    ------
    FileFormatError
        The file cannot be read, is no UTF-8 text or no TOML; the message names the line.
    LimitError
        The file is too long or too deep.
    """
    try:
        with path.open("rb") as file:
            content = file.read(LARGEST_FILE + 1)
        if len(content) > LARGEST_FILE:
            raise LimitError(
                f"{path.name}: the file is longer than the limit of {LARGEST_FILE:,} bytes."
            )
        return read_toml_text(content.decode("utf-8"), path.name)
    except OSError as error:
        reason = error.strerror or type(error).__name__
        raise FileFormatError(f"{path}: the file cannot be read: {reason}.") from None
    except UnicodeDecodeError:
        raise FileFormatError(
            f"{path.name}: the file is no UTF-8 text. Save it as UTF-8."
        ) from None


def read_toml_text(text: str, name: str) -> TomlFile:
    """Read the text of a TOML file.

    Raises
    ------
    FileFormatError
        The text is no TOML; the message shows the line.

    Examples
    --------
    >>> file = read_toml_text("t = 1\\n\\n[[effects]]\\nkind = 'spin'\\n", "top.toml")
    >>> file.data["effects"], file.line(("effects", 0, "kind"))
    ([{'kind': 'spin'}], 4)
    """
    try:
        data = tomllib.loads(text)
    except RecursionError:
        raise LimitError(f"{name}: lists are nested too deeply to be read.") from None
    except ValueError as error:
        raise _bad_toml(name, text, error) from None
    return TomlFile(name, data, _lines(text))


def _bad_toml(name: str, text: str, error: ValueError) -> FileFormatError:
    """The error for what tomllib refuses, with the line it refuses."""
    found = re.search(r"\(at line ([0-9]+), column ([0-9]+)\)", str(error))
    if found is None:
        return FileFormatError(f"{name}: this is no TOML file: {error}.")
    line, column = int(found[1]), int(found[2])
    reason = str(error)[: found.start()].strip()
    shown = text.splitlines()[line - 1][:200]
    return FileFormatError(
        f"{name}: line {line}, column {column}: this is no TOML: {reason}.\n    {shown}\n"
        f"    {' ' * (column - 1)}^\n"
        'Expressions and numbers with units stand in quotes, as in "9.81 m/s^2".'
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
    """Brackets that are open behind a row, and the quotes of a text that goes on."""
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

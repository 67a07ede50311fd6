"""Error location: the line of a scene file that an error speaks of."""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator, Mapping
from contextlib import contextmanager

from geomtorsion.errors import FileFormatError, GeomtorsionError
from geomtorsion.files import Key, TomlFile

_WORD = re.compile(r"[^\W0-9]\w*")
_QUOTED = re.compile(r"'([^']*)'")
# What an effect says of its own fields begins like this, with its key: thrust2.force[2].
_FIELD = re.compile(r"(\w+)(?:\.(\w+)(?:\[(\d+)\])?|:)")


@contextmanager
def placed(file: TomlFile, key: Key, what: str, known: Iterable[str] = ()) -> Iterator[None]:
    """Say file and line of what goes wrong inside: that of the first key that is spoken of.

    Parameters
    ----------
    key
        Where it is read; it is named if the message speaks of nothing below it.
    what
        Put before the message.
    known
        Keys below this one.

    Raises
    ------
    FileFormatError
        Something went wrong inside.

    Examples
    --------
    >>> from geomtorsion.errors import SceneError
    >>> from geomtorsion.files import read_toml_text
    >>> file = read_toml_text("[body]\\nmass = 1\\nmoments = [1, 2, 4]", "a.toml")
    >>> with placed(file, ("body",), "body: ", ["mass", "moments"]):
    ...     raise SceneError("moments cannot be.")
    Traceback (most recent call last):
    geomtorsion.errors.FileFormatError: a.toml: line 3: body: moments cannot be.
    """
    try:
        yield
    except FileFormatError:
        raise
    except GeomtorsionError as error:
        text = str(error)
        # Errors come from deep inside and know no file: the key is found by what they speak of.
        named = _of_effect(file.data, text)
        # `t = 1` speaks of t more surely than a word in passing.
        words = sorted(_WORD.finditer(text), key=lambda w: not re.match(r" =|\[", text[w.end() :]))
        named += [(*key, word[0]) for word in words if word[0] in known]
        named += [path for word in _QUOTED.findall(text) for path in _leaves(file.data, word)]
        there = next((path for path in named if file.line(path) and path[: len(key)] == key), key)
        # A message that begins with the name of its part does not get it twice.
        spoken = what.rstrip(": ")
        prefix = "" if spoken and re.match(rf"{re.escape(spoken)}\b", text) else what
        file.fail(there, f"{prefix}{text}")


def _of_effect(data: Mapping[str, object], text: str) -> list[Key]:
    """The field of an effect that a message begins with; a second spring is spring2."""
    said, tables = _FIELD.match(text), data.get("effects")
    count: dict[object, int] = {}
    for number, table in enumerate(tables if isinstance(tables, list) and said else ()):
        kind = table.get("kind") if isinstance(table, dict) else None
        count[kind] = count.get(kind, 0) + 1
        if said and said[1] == f"{kind}{count[kind] if count[kind] > 1 else ''}":
            field: Key = ("effects", number, said[2] or "kind")
            return [(*field, int(said[3])) if said[3] else field]
    return []


def _leaves(value: object, text: str, path: Key = ()) -> Iterator[Key]:
    """Where a text stands in the content of a file."""
    if isinstance(value, dict):
        for key, inside in value.items():
            yield from _leaves(inside, text, (*path, key))
    elif isinstance(value, list):
        for number, inside in enumerate(value):
            yield from _leaves(inside, text, (*path, number))
    elif value == text:
        yield path

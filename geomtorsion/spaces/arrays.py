"""Arrays: nested lists and sparse tables of a tetrad file, with every entry read."""

from __future__ import annotations

import re
from collections.abc import Mapping
from typing import Any

import sympy

from geomtorsion.checks import cut, shown
from geomtorsion.errors import FileFormatError
from geomtorsion.spaces.symbols import Vocabulary

# Three digits are more than any frame has coordinates; a longer number would fill the memory.
# Lists of lists, as deep as the array has indices.
Nested = list[Any]

_INDEX = re.compile(r"\s*[0-9]{1,3}\s*(,\s*[0-9]{1,3}\s*){0,9}")


def dimension_of(file: str, key: str, value: object) -> int:
    """Number of rows of a nested list, or one more than the largest index of a sparse table."""
    if isinstance(value, list):
        return len(value)
    if isinstance(value, dict) and value:
        return 1 + max(max(_index(file, key, text)) for text in value)
    raise FileFormatError(
        f"{file}: {key}: a list of rows was needed, but {shown(value)} came. "
        f'Write {key} = [["1", "0"], ["0", "r"]] or a table of the entries that do not vanish.'
    )


def array(words: Vocabulary, key: str, value: object, rank: int, dimension: int) -> Nested:
    """Nested lists of expressions with rank levels, each with dimension entries.

    A sparse table names the entries that do not vanish by their indices, counted from 0:
    ``"0,1,2" = "1/r"``.

    Raises
    ------
    FileFormatError
        A level has not as many entries as there are coordinates, or an index is wrong.
    ExpressionError
        An entry cannot be read; the message names it.
    """
    if isinstance(value, dict):
        return _dense(_sparse(words, key, value, rank, dimension), (), rank, dimension)
    return _nested(words, key, value, (), rank, dimension)


def antisymmetric_array(words: Vocabulary, key: str, value: object, dimension: int) -> Nested:
    """Like `array` with three indices; a sparse table may name one order of the first two."""
    if not isinstance(value, dict):
        return array(words, key, value, 3, dimension)
    entries = _sparse(words, key, value, 3, dimension)
    for (i, j, k), entry in list(entries.items()):
        entries.setdefault((j, i, k), -entry)
    return _dense(entries, (), 3, dimension)


def _nested(
    words: Vocabulary, key: str, value: object, index: tuple[int, ...], rank: int, dimension: int
) -> Nested | sympy.Expr:
    """One level of nested lists."""
    place = f"{key}[{', '.join(map(str, index))}]" if index else key
    if len(index) == rank:
        return words.expression(value, place)
    if not isinstance(value, list) or len(value) != dimension:
        came = f"{len(value)} came" if isinstance(value, list) else f"{shown(value)} came"
        raise FileFormatError(
            f"{words.file}: {place}: a list of {dimension} entries was needed, one for each "
            f"coordinate, but {came}. {_levels(key, rank)}"
        )
    return [_nested(words, key, part, (*index, k), rank, dimension) for k, part in enumerate(value)]


def _sparse(
    words: Vocabulary, key: str, table: Mapping[str, object], rank: int, dimension: int
) -> dict[tuple[int, ...], sympy.Expr]:
    """Entries of a table, by index."""
    entries: dict[tuple[int, ...], sympy.Expr] = {}
    for text, value in table.items():
        index = _index(words.file, key, text)
        if len(index) != rank or max(index) >= dimension:
            raise FileFormatError(
                f'{words.file}: {key}: "{cut(text)}" is no index here: {rank} numbers from 0 to '
                f"{dimension - 1} were needed, separated by commas."
            )
        if index in entries:
            raise FileFormatError(
                f'{words.file}: {key}: "{cut(text)}" stands there twice. Remove one.'
            )
        entries[index] = words.expression(value, f"{key}[{', '.join(map(str, index))}]")
    return entries


def _dense(
    entries: Mapping[tuple[int, ...], sympy.Expr], index: tuple[int, ...], rank: int, dimension: int
) -> Nested | sympy.Expr:
    """Nested lists from entries by index."""
    if len(index) == rank:
        return entries.get(index, sympy.Integer(0))
    return [_dense(entries, (*index, k), rank, dimension) for k in range(dimension)]


def _index(file: str, key: str, text: str) -> tuple[int, ...]:
    """Numbers of an index such as "0,1,2"."""
    if not _INDEX.fullmatch(text):
        raise FileFormatError(
            f'{file}: {key}: "{cut(text)}" is no index. Write the numbers of the entry, counted '
            'from 0, separated by commas: "0,1,2".'
        )
    return tuple(int(number) for number in text.split(","))


def _levels(key: str, rank: int) -> str:
    """How the array has to be written."""
    if rank == 2:
        return f"{key} is a list of rows, each a list."
    return f'{key} is a list of lists of lists, or a table such as {{"0,1,2" = "1/r"}}.'

"""Vocabulary: the names a tetrad file declares, and expressions and tables written with them."""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from functools import partial
from typing import Any

import sympy

from geomtorsion.errors import FileFormatError
from geomtorsion.exact import parse_expression
from geomtorsion.geometry.relations import relations_in
from geomtorsion.support.checks import cut, known_name, shown

ASSUMPTIONS = (
    "real", "positive", "negative", "nonnegative", "nonpositive", "nonzero", "integer", "complex",
)  # fmt: skip
_NAME = re.compile(r"[^\W0-9]\w*")

# What errors advise about a name that a file does not declare.
DECLARE = 'Otherwise declare it in the file: parameters = ["{name}"].'

# As TOML writes them.
FLAG = "true or false"


@dataclass(frozen=True)
class Vocabulary:
    """Names that may occur in the expressions of one file.

    file: its name, for messages. coordinates, parameters: symbols. functions: name -> a(t).
    """

    file: str
    coordinates: tuple[sympy.Symbol, ...]
    parameters: tuple[sympy.Symbol, ...]
    functions: Mapping[str, sympy.Expr]

    @property
    def symbols(self) -> dict[str, sympy.Symbol]:
        """Name -> symbol."""
        return {symbol.name: symbol for symbol in (*self.coordinates, *self.parameters)}

    def expression(self, value: object, place: str) -> sympy.Expr:
        """An entry of the file as a sympy expression: an integer, or text; an expression is itself.

        Raises
        ------
        FileFormatError
            The entry is neither.
        ExpressionError
            The text cannot be read; the message names the entry and the part.
        """
        if isinstance(value, int) and not isinstance(value, bool):
            return sympy.Integer(value)
        if isinstance(value, str):
            where = f"{self.file}: {place}"
            return parse_expression(
                value, self.symbols, self.functions, where=where, unknown=DECLARE
            )
        if isinstance(value, sympy.Expr):
            return value
        raise FileFormatError(
            f"{self.file}: {place}: expected an integer or an expression in quotes, got "
            f'{_kind(value)}. Write for instance "r*sin(theta)".'
        )

    def with_forms(self, text: str, place: str, forms: Sequence[sympy.Symbol]) -> sympy.Expr:
        """A text that may contain the differentials of the coordinates."""
        return replace(self, parameters=(*self.parameters, *forms)).expression(text, place)

    def relations(self, value: object, place: str) -> list[sympy.Rel]:
        """Inequalities such as "0 < theta < pi" as sympy relations."""
        relations: list[sympy.Rel] = []
        for number, text in enumerate(texts(self.file, value, place)):
            where = f"{place}[{number}]"
            read = partial(self.expression, place=where)
            relations += relations_in(text, read, f"{self.file}: {where}", FileFormatError)
        return relations


def vocabulary(file: str, data: Mapping[str, object], dimension: int) -> Vocabulary:
    """Symbols and functions from the keys coordinates, parameters and functions.

    Raises
    ------
    FileFormatError
        A name is invalid or declared twice, an assumption is unknown, or an argument of a function
        is neither coordinate nor parameter.
    """
    if "coordinates" not in data and "structure_constants" not in data:
        raise FileFormatError(
            f"{file}: coordinates are missing. Name one for each column, in their order: "
            'coordinates = ["t", "r"].'
        )
    default = [f"x{k + 1}" for k in range(dimension)]
    names = texts(file, data.get("coordinates", default), "coordinates")
    coordinates = tuple(sympy.Symbol(_name(file, name, "coordinates"), real=True) for name in names)
    table = _table(file, data, "parameters")
    parameters = tuple(
        sympy.Symbol(_name(file, name, "parameters"), **_assumptions(file, name, entry))
        for name, entry in table.items()
    )
    symbols = {symbol.name: symbol for symbol in (*coordinates, *parameters)}
    functions: dict[str, sympy.Expr] = {}
    for name, entry in _table(file, data, "functions").items():
        arguments = texts(file, entry, f"functions.{name}")
        subject, kind = f"{file}: functions.{name}", "a coordinate or a declared parameter"
        for argument in arguments:
            known_name(argument, symbols, subject, FileFormatError, expected=kind)
        function = sympy.Function(_name(file, name, "functions"))
        functions[name] = function(*(symbols[argument] for argument in arguments))
    declared = [*names, *table, *functions]
    for name in declared:
        if declared.count(name) > 1:
            raise FileFormatError(
                f"{file}: {name}: expected one declaration among coordinates, parameters and "
                f"functions, got {declared.count(name)}. Give each its own name."
            )
    return Vocabulary(file, coordinates, parameters, functions)


def texts(file: str, value: object, place: str) -> list[str]:
    """A list of strings; a single string counts as a list of one."""
    items = [value] if isinstance(value, str) else value
    if not isinstance(items, list) or not all(isinstance(item, str) for item in items):
        raise FileFormatError(
            f"{file}: {place}: expected a list of strings, got {_kind(value)}. "
            f'Write {place} = ["..."].'
        )
    return items


def _name(file: str, name: str, place: str) -> str:
    if not _NAME.fullmatch(name):
        raise FileFormatError(
            f"{file}: {place}: expected a name, got {shown(name)}. Use a letter followed by "
            "letters, digits or underscores."
        )
    return name


def _assumptions(file: str, name: str, given: object) -> dict[str, bool]:
    """Assumptions of a parameter; real unless complex is among them."""
    words = [word for text in texts(file, given, f"parameters.{name}") for word in text.split()]
    subject = f"{file}: parameters.{name}"
    for word in words:
        known_name(word, ASSUMPTIONS, subject, FileFormatError, expected="an assumption")
    assumptions = dict.fromkeys(words, True)
    return assumptions if "complex" in words else assumptions | {"real": True}


def _table(file: str, data: Mapping[str, object], key: str) -> Mapping[str, object]:
    value = data.get(key, {})
    if key == "parameters" and isinstance(value, list):
        return dict.fromkeys(texts(file, value, key), "real")
    if not isinstance(value, dict):
        example = {"parameters": 'M = "positive"', "functions": 'a = ["t"]'}[key]
        raise FileFormatError(
            f"{file}: {key}: expected a table, got {_kind(value)}. "
            f"Write [{key}] and below it {example}."
        )
    return value


def _kind(value: object) -> str:
    """What a value of a TOML file is, in words."""
    names: Sequence[tuple[type, str]] = (
        (bool, "true or false"), (str, "text"), (int, "an integer"), (list, "a list"),
        (dict, "a table"),
    )  # fmt: skip
    return next((word for kind, word in names if isinstance(value, kind)), cut(f"{value}"))


# Lists of lists, as deep as the array has indices.
Nested = list[Any]

# Three digits are more than any frame has coordinates; a longer number would fill the memory.
_INDEX = re.compile(r"\s*[0-9]{1,3}\s*(,\s*[0-9]{1,3}\s*){0,9}")


def dimension_of(file: str, key: str, value: object) -> int:
    """Number of rows of a nested list, or one more than the largest index of a sparse table."""
    if isinstance(value, list):
        return len(value)
    if isinstance(value, dict) and value:
        return 1 + max(max(_index(file, key, text)) for text in value)
    raise FileFormatError(
        f"{file}: {key}: expected a list of rows, got {shown(value)}. "
        f'Write {key} = [["1", "0"], ["0", "r"]] or a table of the entries that do not vanish.'
    )


def array(words: Vocabulary, key: str, value: object, rank: int, dimension: int) -> Nested:
    """Nested lists of expressions with rank levels, each with dimension entries.

    A sparse table names the entries that do not vanish by their indices, counted from 0:
    ``"0,1,2" = "1/r"``.

    Raises
    ------
    FileFormatError
        The number of entries of a level differs from the dimension, or an index is wrong.
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
        came = len(value) if isinstance(value, list) else shown(value)
        raise FileFormatError(
            f"{words.file}: {place}: expected a list of {dimension} entries, one for each "
            f"coordinate, got {came}. {_levels(key, rank)}"
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
                f'{words.file}: {key}: "{cut(text)}" is not an index here; '
                f"expected {rank} numbers from 0 to {dimension - 1}, separated by commas."
            )
        if index in entries:
            raise FileFormatError(
                f'{words.file}: {key}: expected each index once, got "{cut(text)}" twice. Remove '
                "one."
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
            f'{file}: {key}: "{cut(text)}" is not an index. Write the numbers of the entry, '
            'counted from 0, separated by commas: "0,1,2".'
        )
    return tuple(int(number) for number in text.split(","))


def _levels(key: str, rank: int) -> str:
    """How the array has to be written."""
    if rank == 2:
        return f"{key} is a list of rows, each a list."
    return f'{key} is a list of lists of lists, or a table such as {{"0,1,2" = "1/r"}}.'

"""Text rows: words and numbers in the rows of a text file; a refusal names line and column."""

from __future__ import annotations

import re
from collections.abc import Iterator, Sequence
from typing import NoReturn

import numpy as np

from geomtorsion.errors import FileFormatError
from geomtorsion.support.checks import cut, shown
from geomtorsion.support.files import finite_number, plain_float

# Characters of plain decimal numbers; Python also reads 1_000 and digits of other scripts.
_PLAIN = b"0123456789eE.+-"
_WHOLE = re.compile(r"[+-]?[0-9]{1,18}")


def lines_of(text: str) -> list[str]:
    """Lines of a text with the line ends of any system.

    Examples
    --------
    >>> lines_of("a\\r\\nb\\rc\\n")
    ['a', 'b', 'c', '']
    """
    return text.replace("\r\n", "\n").replace("\r", "\n").split("\n")


class TextRows:
    """Reader of the rows of a text, as words, one row after another.

    name: of the file, for messages. line: number of the last row, from 1. A refusal names both.
    comment: sign that begins a comment. With a comment sign, rows without words are skipped.

    Examples
    --------
    >>> rows = TextRows("a.txt", ["# title", "3 atoms"], "#")
    >>> rows.whole(rows.next("a number of atoms")[0], "atoms"), rows.line
    (3, 2)
    """

    def __init__(
        self, name: object, lines: Sequence[str] = (), comment: str = "", *, line: int = 0
    ) -> None:
        self.name, self.lines, self.line = name, lines, line
        self._left = self._words(comment)

    def _words(self, comment: str) -> Iterator[list[str]]:
        for number, row in enumerate(self.lines, 1):
            words = (row.partition(comment)[0] if comment and comment in row else row).split()
            if words or not comment:
                self.line = number
                yield words

    def more(self) -> list[str] | None:
        """Words of the next row, or None at the end."""
        return next(self._left, None)

    def next(self, what: str) -> list[str]:
        """Words of the next row."""
        for words in self._left:
            return words
        self.fail(f"expected {what}, got the end of the file. Is the file complete?")

    def fail(self, message: str) -> NoReturn:
        """Refuse the current row; line 0 is the whole file."""
        where = f"{self.name}: line {self.line}" if self.line else f"{self.name}"
        raise FileFormatError(f"{where}: {message}")

    def number(self, word: str, what: str) -> float:
        """Finite number in a word."""
        value = finite_number(word)
        if value is None:
            self.fail(f"{what}: expected a finite number, got {shown(cut(word, 60))}. Correct it.")
        return value

    def numbers(
        self, words: Sequence[str], count: int, what: str, *, more: bool = False
    ) -> list[float]:
        """Finite numbers in all words of a row; more: or at its beginning."""
        if len(words) < count or (len(words) > count and not more):
            plural = "s" * (count != 1)
            self.fail(
                f"{what}: expected {count} number{plural}, got {len(words)}. Is the row complete?"
            )
        return [self.number(word, what) for word in words[:count]]

    def whole(self, word: str, what: str, least: int = 0, below: int = 10**18) -> int:
        """Whole number from `least` to below a limit."""
        if not _WHOLE.fullmatch(word):
            self.fail(f"{what}: expected a whole number, got {shown(cut(word, 60))}. Correct it.")
        value = int(word)
        if not least <= value < below:
            limit = f"a whole number below {below:,}" if value >= below else f"{least} or more"
            self.fail(f"{what}: expected {limit}, got {word}. Is the file complete?")
        return value

    def array(
        self, words: Sequence[str], lines: Sequence[int], width: int, what: str
    ) -> np.ndarray:
        """Finite numbers in the words of several rows, shape (rows, width).

        lines: the number of each row in the file.
        """
        try:
            values = np.fromiter(map(float, words), float, len(words))
            odd = "".join(words).encode().translate(None, _PLAIN)
        except ValueError:
            values, odd = np.array([np.nan]), b""
        if odd or not np.isfinite(values).all():
            for k, word in enumerate(words):
                self.line = lines[k // width]
                self.number(word, what)
        return values.reshape(len(lines), width)


def number_table(
    name: object,
    lines: Sequence[int],
    rows: Sequence[str],
    width: int,
    columns: Sequence[int] | None = None,
    words: Sequence[int] = (),
    *,
    split: str | None = None,
    finite: bool = False,
) -> tuple[np.ndarray, list[list[str]]]:
    """Numbers in some columns of rows, shape (rows, columns), and the words in others.

    Parameters
    ----------
    name
        Of the file, for messages.
    lines
        The number of each row in the file, from 1.
    width
        How many columns there are.
    columns, words
        The columns to read, from 0; by default numbers are in all columns.
    split
        Sign between the fields, blanks if not given. An empty field is NaN; a row may end in a
        sign, and rows with tabs may also have blanks between their fields.
    finite
        Whether NaN and infinity are refused.

    Raises
    ------
    FileFormatError
        A row has another number of columns, or a word for a number; the message names line and
        column.

    Examples
    --------
    >>> number_table("a.txt", [1, 2], ["1 a 2", "3 b nan"], 3, [0, 2], [1])
    (array([[ 1.,  2.],
           [ 3., nan]]), [['a', 'b']])
    """
    columns = range(width) if columns is None else columns
    # Other columns are read as single letters, which checks their number in each row.
    kinds = ["U1"] * width
    for k in columns:
        kinds[k] = "f8"
    for k in words:
        kinds[k] = "O"
    form = np.dtype([(f"f{k}", kind) for k, kind in enumerate(kinds)])
    if split is not None:
        rows = _filled(rows, width, split)

    def parsed(some: Sequence[str]) -> np.ndarray | None:
        if not any(map(str.strip, some)):
            return None if some else np.zeros(0, dtype=form)
        for mark in (split, None) if split == "\t" else (split,):
            try:
                table = np.loadtxt(some, dtype=form, comments=None, delimiter=mark, ndmin=1)
            except ValueError:
                continue
            # Empty rows are skipped.
            return table if len(table) == len(some) else None
        return None

    table = parsed(rows)
    if table is None and not words:
        # Words for missing values, and exponents as Fortran writes them.
        rows = _plain_rows(rows)
        table = parsed(rows)
    if table is None:
        good, bad = 0, len(rows)
        while bad - good > 1:
            middle = (good + bad) // 2
            good, bad = (good, middle) if parsed(rows[good:middle]) is None else (middle, bad)
        refuse_row(name, lines[good], rows[good], width, columns, split, finite=finite)
    values = np.array([table[f"f{k}"] for k in columns]).reshape(len(columns), -1).T
    if finite and not np.isfinite(values).all():
        k = int(np.isfinite(values).all(axis=1).argmin())
        refuse_row(name, lines[k], rows[k], width, columns, split, finite=True)
    return np.ascontiguousarray(values), [table[f"f{k}"].tolist() for k in words]


# What programs write where no number is known.
_MISSING = re.compile(
    r"(?i)(?<![^\s,;])(?:#?n/?a|null|none|missing|no ?data|[-+]?nan(?:\(\w*\))?|-?1\.#\w+"
    r"|#\w+(?:/\w+)?[!?]|-+|\*+)"
    r"(?![^\s,;])"
)
# Fortran writes 1.5D+03, and 1.5+103 without the letter before three digits.
_FORTRAN = re.compile(
    r"(?<![^\s,;])([+-]?(?:\d+\.?\d*|\.\d+))(?:[dD](?=[+-]?\d{1,3}(?!\d))|(?=[+-]\d{3}(?!\d)))"
    r"([+-]?\d{1,3})(?![^\s,;])"
)
# A comment behind the numbers, with blanks around its sign.
_BEHIND = re.compile(r"\s(?:#|//|!|%)\s.*$")


def _plain_rows(rows: Sequence[str]) -> list[str]:
    """Rows with nan for missing values and plain exponents, without quotes and comments."""
    bare = [_BEHIND.sub("", row.replace('"', "")) for row in rows]
    return [_FORTRAN.sub(r"\1e\2", _MISSING.sub("nan", row)) for row in bare]


def _filled(rows: Sequence[str], width: int, split: str) -> list[str]:
    """Rows with nan in empty fields, and without a sign after the last field."""
    if all(row.count(split) == width for row in rows):
        # Some programs write a separator after the last field as well.
        rows = [row.rstrip(" ").removesuffix(split) for row in rows]
    ends = rf"(?m)(?:^|(?<={re.escape(split)}))[ ]*(?={re.escape(split)}|$)"
    return re.sub(ends, "nan", "\n".join(rows)).split("\n") if rows else []


def refuse_row(
    name: object,
    line: int,
    row: str,
    width: int,
    columns: Sequence[int],
    split: str | None = None,
    *,
    finite: bool = True,
) -> NoReturn:
    """Refuse a row that has another width, or a word in one of the columns of numbers."""
    words = [word.strip() for word in row.split(split)]
    if len(words) != width and split == "\t":
        words = row.split()
    where = f"{name}: line {line}"
    for k in columns if len(words) == width else ():
        if not _is_number(words[k], finite):
            raise FileFormatError(
                f"{where}: expected a number in column {k + 1}, got {shown(cut(words[k], 60))} in "
                f"{shown(cut(' '.join(words), 80))}. Correct it, or export the file again."
            )
    raise FileFormatError(
        f"{where}: expected {width} column{'s' * (width != 1)}, got {len(words)} in "
        f"{shown(cut(row.strip(), 80))}. Is the file complete?"
    )


def _is_number(word: str, finite: bool) -> bool:
    """Whether a word is a number in plain digits; also nan and inf if these may be there."""
    try:
        value = plain_float(word)
    except ValueError:
        return False
    return bool(np.isfinite(value)) or not finite

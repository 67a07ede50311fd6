"""Text rows: the numbers below the header of a text file, one row for each line."""

from __future__ import annotations

import io
from collections.abc import Sequence

import numpy as np

from geomtorsion.errors import FileFormatError
from geomtorsion.support.checks import cut, shown
from geomtorsion.support.files import finite_number

MISSING = ("", "nan")


def lines_of(text: str) -> list[str]:
    """Lines of a text with the line ends of any system.

    Examples
    --------
    >>> lines_of("a\\r\\nb\\rc\\n")
    ['a', 'b', 'c', '']
    """
    return text.replace("\r\n", "\n").replace("\r", "\n").split("\n")


def number_rows(
    name: object,
    rows: Sequence[str],
    numbers: Sequence[int],
    width: int,
    split: str | None,
    *,
    has_words: bool = False,
) -> np.ndarray:
    """The numbers in rows of text, shape (rows, width); NaN for empty fields.

    name: of the file, for messages. numbers: of the lines of the rows, from 0. split: between the
    fields; None: blanks. has_words: whether a word, such as the name of a phase, counts as empty.

    Raises
    ------
    FileFormatError
        A row has another number of fields, or a field is not a number.

    Examples
    --------
    >>> number_rows("a.txt", ["1 2", "3 nan"], [4, 5], 2, None).tolist()
    [[1.0, 2.0], [3.0, nan]]
    """
    if not rows:
        return np.zeros((0, width))
    if split is not None and all(row.count(split) == width for row in rows):
        # Some programs write a separator after the last field as well.
        rows = [row.rstrip().removesuffix(split) for row in rows]
    # Some programs write blanks between some columns and tabs between others.
    for mark in (split, None) if split == "\t" else (split,):
        text = io.StringIO("\n".join(rows))
        try:
            entries = np.loadtxt(text, delimiter=mark, ndmin=2, comments=None)
        except ValueError:
            continue
        if entries.shape == (len(rows), width):
            return entries
    values = []
    for number, row in zip(numbers, rows, strict=True):
        words = [word.strip() for word in row.split(split)]
        if len(words) != width and split == "\t":
            words = row.split()
        if len(words) != width:
            raise FileFormatError(
                f"{name}: line {number + 1}: expected {width} fields, one for each column of the "
                f"header, got {len(words)}. Is the file complete?"
            )
        entries = [finite_number(word) for word in words]
        wrong = [w for w, x in zip(words, entries, strict=True) if x is None]
        if not has_words and any(word.lower() not in MISSING for word in wrong):
            raise FileFormatError(
                f"{name}: line {number + 1}: expected numbers, got {shown(cut(row.strip(), 80))}. "
                "Correct the row, or leave the field empty."
            )
        values.append([np.nan if x is None else x for x in entries])
    return np.array(values)

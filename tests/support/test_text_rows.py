"""Text rows: words and numbers of text files, and refusals with line and column."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest

from geomtorsion.errors import FileFormatError
from geomtorsion.support.text_rows import TextRows, number_table

TEXT = ["# a comment", "", "3 atoms # of iron", "1 2 x"]


def at(line: int) -> TextRows:
    """The rows of TEXT after a number of rows with words."""
    rows = TextRows("a.txt", TEXT, "#")
    for _ in range(line):
        rows.next("a row")
    return rows


def test_rows():
    """Comments and empty rows are skipped only where a comment sign is given."""
    rows = at(0)
    assert (rows.more(), rows.line) == (["3", "atoms"], 3)
    assert (rows.next("a row"), rows.line) == (["1", "2", "x"], 4)
    assert rows.more() is None
    plain = TextRows("a.txt", TEXT)
    assert (plain.more(), plain.more()) == (["#", "a", "comment"], [])
    assert rows.whole("-7", "number", -10) == -7
    assert rows.array(["1", "-2e3"], [3], 2, "places").tolist() == [[1, -2000]]


# Calls, and words of their refusals.
REFUSED: list[tuple[Callable[[], object], str]] = [
    (lambda: at(2).next("a row"), "a.txt: line 4: expected a row, got the end of the file"),
    (lambda: at(1).whole("3.0", "atoms"), "line 3: atoms: expected a whole number, got '3.0'"),
    (lambda: at(1).whole("0", "atoms", 1), "line 3: atoms: expected 1 or more, got 0"),
    (lambda: at(1).whole("9", "atoms", 0, 9), "expected a whole number below 9, got 9"),
    (lambda: at(1).number("1_0", "size"), "line 3: size: expected a finite number, got '1_0'"),
    (lambda: at(1).numbers(["1"], 2, "size"), "line 3: size: expected 2 numbers, got 1"),
    (lambda: at(0).fail("expected atoms"), "a.txt: expected atoms"),
    (
        lambda: at(2).array(["1", "2", "3", "inf"], [5, 8], 2, "places"),
        "line 8: places: expected a finite number, got 'inf'",
    ),
    (
        lambda: number_table("a.txt", [5, 8, 9], ["1 2", "3 x", "4"], 2),
        "a.txt: line 8: expected a number in column 2, got 'x'",
    ),
    (lambda: number_table("a.txt", [5], ["1 2 3"], 2), "line 5: expected 2 columns, got 3"),
    (lambda: number_table("a.txt", [5, 6], ["1", ""], 1), "line 6: expected 1 column, got 0"),
    (lambda: number_table("a.txt", [5], ["1,1_0"], 2, split=","), "in column 2, got '1_0'"),
    (lambda: number_table("a.txt", [5], ["1 nan"], 2, finite=True), "in column 2, got 'nan'"),
]


@pytest.mark.parametrize(("read", "words"), REFUSED)
def test_refusals(read: Callable[[], object], words: str):
    """Each refusal names the file, the line, the column or quantity, and the word."""
    with pytest.raises(FileFormatError, match=words):
        read()


@pytest.mark.parametrize(
    ("rows", "split"),
    [
        (["1 2 3", "4 nan 6"], None),
        (["1,2,3", "4,,6"], ","),
        (["1, 2, 3,", "4, , 6,"], ","),
        (["1\t2\t3", "4\t\t6"], "\t"),
        (["1 2\t3", "4 nan\t6"], "\t"),
    ],
)
def test_tables(rows: list[str], split: str | None):
    """Empty fields, separators at the end of rows, and blanks mixed with tabs are read."""
    table, _ = number_table("a.txt", [1, 2], rows, 3, split=split)
    assert np.array_equal(table, [[1, 2, 3], [4, np.nan, 6]], equal_nan=True)

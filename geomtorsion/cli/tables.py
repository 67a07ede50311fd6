"""tables: a few rows of many, in columns."""

from __future__ import annotations

from collections.abc import Iterable

import numpy as np

# Rows that fit below each other with what stands around them.
ROWS = 9


def some_rows(count: int) -> list[int]:
    """Rows that are shown of so many, evenly spread from the first to the last.

    Examples
    --------
    >>> some_rows(401)
    [0, 50, 100, 150, 200, 250, 300, 350, 400]
    >>> some_rows(3)
    [0, 1, 2]
    """
    shown = np.linspace(0, count - 1, min(ROWS, count))
    return np.unique(shown.round().astype(int)).tolist()


def right_aligned(cells: Iterable[str], width: int) -> str:
    """Cells of one width in a line."""
    return "".join(cell.rjust(width) for cell in cells)

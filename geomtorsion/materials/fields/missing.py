"""Missing values: the numbers that files hold where nothing is known, as holes."""

from __future__ import annotations

from collections.abc import Iterable, Sequence

import numpy as np

from geomtorsion.errors import GridError
from geomtorsion.support import checks
from geomtorsion.support.checks import shown

# Least distance of a mark from all other values, in units of their spread; no noise reaches so far.
# Where they are all equal, the least size of a mark, which then is a whole number such as 999.
APART = 99


def checked_missing(missing: object) -> tuple[float, ...]:
    """Declared marks of missing values: one number or several.

    Raises
    ------
    GridError
        One of them is not a number.
    """
    items = missing if isinstance(missing, Iterable) and not isinstance(missing, str) else [missing]
    marks = [None if item is None else checks.real(item) for item in items]
    if missing is not None and None in marks:
        raise GridError(
            f"missing: expected a number, or a list of numbers, got {shown(missing)}. Write "
            "missing=-9999."
        )
    return tuple(mark for mark in marks if mark is not None)


def with_holes(
    values: np.ndarray, grid: Sequence[int], missing: object = None
) -> tuple[np.ndarray, str]:
    """Values with NaN at missing nodes, and a sentence that reports them, or an empty text.

    Parameters
    ----------
    values
        shape (components..., grid...).
    grid
        the shape of the grid, or (n,) for scattered points.
    missing
        declared marks: a number or several. Without any, a value that all failed nodes share, and
        that is much farther from the others than these are from each other, is a mark.

    Examples
    --------
    >>> u = np.append(np.linspace(0.9, 1.1, 20), [-9999, -9999])
    >>> holes, report = with_holes(u[None], (22,))
    >>> int(np.isnan(holes).sum()), report
    (2, '2 nodes with the value -9999 are treated as missing')
    """
    declared = checked_missing(missing)
    if values.shape[values.ndim - len(grid) :] != tuple(grid):
        # The frame refuses it in its own words.
        return values, ""
    flat = values.reshape(-1, int(np.prod(grid)))
    marks = declared or sorted({mark for row in flat for mark in _marks(row)})
    reports = []
    hidden = np.zeros(flat.shape[1], dtype=bool)
    for mark in marks:
        nodes = (flat == mark).any(axis=0)
        hidden |= nodes
        count = int(nodes.sum())
        if count:
            which = f"{count} node{'s' * (count != 1)} with the value {mark:.10g}"
            reports.append(f"{which} {'is' if count == 1 else 'are'} treated as missing")
    if not reports:
        return values, ""
    holes = np.where(hidden, np.nan, flat).reshape(values.shape)
    return holes, "; ".join(reports)


def _marks(row: np.ndarray) -> list[float]:
    """The marks among the values of one component: at most one below and one above the others."""
    known = row[np.isfinite(row)]
    found = []
    for extreme in (known.min, known.max) if len(known) else ():
        mark = float(extreme())
        others = known[known != mark]
        # Two values have no spread to compare with.
        if len(others) < 3:
            continue
        low, high = float(others.min()), float(others.max())
        gap = max(low - mark, mark - high)
        is_number_of_a_mark = mark.is_integer() and abs(mark) >= APART
        if gap > APART * (high - low) and (high > low or is_number_of_a_mark):
            found.append(mark)
            known = others
    return found

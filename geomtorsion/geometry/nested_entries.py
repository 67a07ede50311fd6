"""Nested entries: nested lists and arrays of expressions, by index."""

from __future__ import annotations

from collections.abc import Iterator

import sympy as sp

from geomtorsion.errors import ShapeError
from geomtorsion.geometry.components import Index
from geomtorsion.support.checks import rows


def nested_entries(values: object, rank: int, n: int, name: str) -> dict[Index, object]:
    """Index and value of each entry of an array, shape (n, ..., n), that is not plainly zero.

    Raises
    ------
    ShapeError
        The lists do not have one level per index, or a level not n entries.

    Examples
    --------
    >>> nested_entries([[0, "x"], [1, 0]], 2, 2, "t")
    {(0, 1): 'x', (1, 0): 1}
    """
    return dict(_entries(rows(values), (), rank, n, name))


def _entries(
    values: object, index: Index, depth: int, n: int, name: str
) -> Iterator[tuple[Index, object]]:
    """Index and value of each entry of nested lists that is not plainly zero."""
    if depth == 0:
        if not (isinstance(values, int | float | sp.Expr) and values == 0):
            yield index, values
        return
    listed = list(values) if isinstance(values, list | tuple) else None
    size = None if listed is None else len(listed)
    if listed is None or size != n:
        raise ShapeError(
            f"{name}{list(index) or ''}: expected {n} entries, got "
            f"{'a single value' if size is None else size}. Give nested lists, one level for each "
            f"index, each with {n} entries."
        )
    for k in range(n):
        yield from _entries(listed[k], (*index, k), depth - 1, n, name)

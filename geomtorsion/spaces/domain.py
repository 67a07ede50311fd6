"""domain: the open box in which the coordinates and parameters of a space lie."""

from __future__ import annotations

from collections.abc import Mapping

from sympy import Basic, Expr, Symbol

from geomtorsion.checks import expression


def box(ranges: Mapping[Symbol, tuple[Expr | int, Expr | int]]) -> tuple[Basic, ...]:
    """Relations low < symbol < high of all symbols; bounds at infinity say nothing.

    Examples
    --------
    >>> from sympy import oo, symbols
    >>> r, M = symbols("r M", positive=True)
    >>> box({r: (2 * M, oo)})
    (r > 2*M,)
    """
    relations: list[Basic] = []
    for symbol, (low, high) in ranges.items():
        if expression(low).is_finite is not False:
            relations.append(symbol > low)
        if expression(high).is_finite is not False:
            relations.append(symbol < high)
    return tuple(relations)

"""Patterns: index tables of known answers written once per independent component."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from itertools import permutations

import sympy
from sympy import Expr, Integer
from sympy.combinatorics.permutations import Permutation

from geomtorsion.checks import expression

Index = tuple[int, ...]
Table = dict[Index, sympy.Expr]


def alternating(components: Mapping[Index, Expr | int]) -> Table:
    """All index orders of a totally antisymmetric tensor, from one order of each.

    Examples
    --------
    >>> alternating({(0, 1, 2): 5})[0, 2, 1]
    -5
    """
    table: Table = {}
    for index, value in components.items():
        for order in permutations(range(len(index))):
            sign = Integer(Permutation(order).signature())
            table[tuple(index[place] for place in order)] = sign * expression(value)
    return table


def antisymmetric(components: Mapping[Index, Expr | int]) -> Table:
    """Both orders of the first two indices, the second with the opposite sign.

    Examples
    --------
    >>> antisymmetric({(0, 1, 2): 5})
    {(0, 1, 2): 5, (1, 0, 2): -5}
    """
    table: Table = {}
    for (first, second, *rest), value in components.items():
        table[first, second, *rest] = expression(value)
        table[second, first, *rest] = -expression(value)
    return table


def symmetric(components: Mapping[Index, Expr | int]) -> Table:
    """Both orders of the first two indices, with the same value.

    Examples
    --------
    >>> symmetric({(0, 1, 2): 5})
    {(0, 1, 2): 5, (1, 0, 2): 5}
    """
    table: Table = {}
    for (first, second, *rest), value in components.items():
        table[first, second, *rest] = expression(value)
        table[second, first, *rest] = expression(value)
    return table


def diagonal(values: Sequence[Expr | int]) -> Table:
    """The diagonal of a tensor with two indices; zeros are left out.

    Examples
    --------
    >>> diagonal([1, 0, 2])
    {(0, 0): 1, (2, 2): 2}
    """
    return {(k, k): expression(value) for k, value in enumerate(values) if value != 0}


def matrix(rows: Sequence[Sequence[Expr | int]]) -> Table:
    """The nonzero entries of a matrix.

    Examples
    --------
    >>> matrix([[0, 3], [1, 0]])
    {(0, 1): 3, (1, 0): 1}
    """
    return {
        (i, j): expression(value)
        for i, row in enumerate(rows)
        for j, value in enumerate(row)
        if value != 0
    }

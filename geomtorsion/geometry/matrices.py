"""Matrices: determinant, inverse and linear dependence of sparse matrices of exact elements."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Mapping, Sequence
from itertools import combinations
from typing import Any

from geomtorsion.exact import Element, Field

Entries = Mapping[Any, Element]
Pair = tuple[int, int, Element]


def blocks(entries: Entries, n: int) -> list[tuple[list[int], list[int]]]:
    """Independent blocks of a matrix up to permutation: pairs (rows, columns)."""
    columns_of: dict[int, list[int]] = defaultdict(list)
    rows_of: dict[int, list[int]] = defaultdict(list)
    for i, j in entries:
        columns_of[i].append(j)
        rows_of[j].append(i)
    found = []
    seen: set[int] = set()
    for start in range(n):
        if start in seen:
            continue
        rows, columns, waiting = {start}, set(), [start]
        while waiting:
            for j in columns_of[waiting.pop()]:
                if j not in columns:
                    columns.add(j)
                    new = set(rows_of[j]) - rows
                    rows |= new
                    waiting.extend(new)
        seen |= rows
        found.append((sorted(rows), sorted(columns)))
    return found


def _minors(
    field: Field, entries: Entries, rows: Sequence[int], columns: Sequence[int]
) -> dict[int, Element]:
    """Minors of all given rows, by the bit mask of their columns (Laplace, row by row)."""
    # Minors of the first rows are shared by all that follow: 2^n products, not n!.
    minors = {0: field.one}
    for row in rows:
        collected: dict[int, list] = defaultdict(list)
        for mask, minor in minors.items():
            for place, column in enumerate(columns):
                bit = 1 << place
                entry = entries.get((row, column))
                if mask & bit or entry is None:
                    continue
                sign = -1 if (mask >> place).bit_count() % 2 else 1
                collected[mask | bit].append((sign, minor, entry))
        summed = {mask: field.sum(terms) for mask, terms in collected.items()}
        minors = {mask: value for mask, value in summed.items() if not value.is_zero}
    return minors


def _is_odd(order: Sequence[int]) -> bool:
    """Whether a permutation, given as a list of distinct numbers, is odd."""
    inversions = sum(
        order[i] > order[j] for i in range(len(order)) for j in range(i + 1, len(order))
    )
    return inversions % 2 == 1


def determinant(field: Field, entries: Entries, n: int) -> Element:
    """Determinant, block by block."""
    result = field.one
    row_order: list[int] = []
    column_order: list[int] = []
    for rows, columns in blocks(entries, n):
        if len(rows) != len(columns):
            return field.zero
        minor = _minors(field, entries, rows, columns).get((1 << len(rows)) - 1)
        if minor is None:
            return field.zero
        result = result * minor
        row_order += rows
        column_order += columns
    return -result if _is_odd(row_order) != _is_odd(column_order) else result


def inverse(field: Field, entries: Entries, n: int) -> dict[tuple[int, int], Element]:
    """Inverse of a regular matrix, block by block, by cofactors."""
    found: dict[tuple[int, int], Element] = {}
    for rows, columns in blocks(entries, n):
        size = len(rows)
        if size == 1:
            i, j = rows[0], columns[0]
            found[j, i] = field.inverse(entries[i, j], briefly=True)
            continue
        everything = (1 << size) - 1
        cofactors: dict[tuple[int, int], Element] = {}
        for r, row in enumerate(rows):
            others = rows[:r] + rows[r + 1 :]
            for mask, minor in _minors(field, entries, others, columns).items():
                c = (everything ^ mask).bit_length() - 1
                cofactors[row, columns[c]] = -minor if (r + c) % 2 else minor
        # The determinant along the first row costs nothing more: its cofactors are there.
        first = rows[0]
        det = field.sum(
            [
                (1, entries[first, j], cofactors[first, j])
                for j in columns
                if (first, j) in cofactors and (first, j) in entries
            ]
        )
        reciprocal = field.inverse(det, briefly=True)
        for (i, j), cofactor in cofactors.items():
            found[j, i] = cofactor * reciprocal
    return found


def pairs_of_inverse(
    field: Field, entries: Entries, inverted: Entries, n: int
) -> dict[tuple[int, int], tuple[Element, list[Pair]]]:
    """E_i^a E_j^b - E_i^b E_j^a of the inverse E[a, i], for i < j: a factor, (a, b, value), a < b.

    Such a minor of the inverse is, up to its sign, the minor of all other rows and columns over the
    determinant (Jacobi): no square of the determinant is left that would cancel. The factor is
    1 over the determinant of a block; the values are to be multiplied by it.
    """
    found: dict[tuple[int, int], tuple[Element, list[Pair]]] = {}
    single: list[list[tuple[int, int, Element]]] = []
    for rows, columns in blocks(entries, n):
        everything = (1 << len(rows)) - 1
        whole = _minors(field, entries, rows, columns)[everything]
        reciprocal = field.inverse(whole, briefly=True) if len(rows) > 1 else field.one
        for r, s in combinations(range(len(rows)), 2):
            others = [row for k, row in enumerate(rows) if k not in (r, s)]
            minors: list[Pair] = []
            for mask, minor in _minors(field, entries, others, columns).items():
                c, d = (k for k in range(len(rows)) if not mask >> k & 1)
                value = -minor if (r + s + c + d) % 2 else minor
                minors.append((columns[c], columns[d], value))
            found[rows[r], rows[s]] = (reciprocal, minors)
        own = [(i, a) for i in rows for a in columns if (a, i) in inverted]
        single.append([(i, a, inverted[a, i]) for i, a in own])
    for one, two in combinations(single, 2):
        for i, a, first in one:
            for j, b, second in two:
                sign = 1 if (i < j) == (a < b) else -1
                place = (min(i, j), max(i, j))
                value = field.sum([(sign, first, second)])
                products = found.setdefault(place, (field.one, []))[1]
                products.append((min(a, b), max(a, b), value))
    return found


def dependence(field: Field, entries: Entries, n: int) -> dict[int, Element] | None:
    """Coefficients c_i with sum_i c_i row_i = 0, the last of them 1; None for a regular matrix."""
    done: list[tuple[int, dict[int, Element], dict[int, Element]]] = []
    for i in range(n):
        row = {j: entries[i, j] for j in range(n) if (i, j) in entries}
        combination = {i: field.one}
        for pivot, other, others in done:
            if pivot not in row:
                continue
            factor = row[pivot] / other[pivot]
            row = _minus(field, row, other, factor)
            combination = _minus(field, combination, others, factor)
        if not row:
            return combination
        done.append((min(row), row, combination))
    return None


def _minus(
    field: Field, first: Mapping[int, Element], second: Mapping[int, Element], factor: Element
) -> dict[int, Element]:
    """first - factor * second, without zeros."""
    found = {}
    for key in {**first, **second}:
        terms = []
        if key in first:
            terms.append((1, first[key]))
        if key in second:
            terms.append((-1, factor, second[key]))
        value = field.sum(terms)
        if not value.is_zero:
            found[key] = value
    return found

"""Kinetic: a constant kinetic metric G_ij, and rates u'^l = G^lk C_kj^i G_im u^j u^m."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from fractions import Fraction
from typing import TYPE_CHECKING, Any

import sympy as sp

from geomtorsion.codegen import Products
from geomtorsion.geometry.components import inverse
from geomtorsion.ode.rates import SMALL

if TYPE_CHECKING:
    from geomtorsion.exact import Element
    from geomtorsion.geometry import Frame


def weighted(
    frame: Frame,
    metric: Sequence[Sequence[Fraction]],
    twist: Mapping,
    names: Sequence[str],
) -> tuple[tuple[Products, ...], dict[str, Fraction]]:
    """Rates of u^l, equal coefficients added up exactly, and the exact constants in them.

    twist: C_kj^i of the frame by (k, j, i); names: of the velocities.
    """
    raised, n = _inverted(metric), frame.dimension
    table: dict[tuple[int, int, int], dict[Element, Fraction]] = {}
    for (k, j, i), value in twist.items():
        if value.is_rational:
            number, element = value.as_fraction(), frame.field.one
        else:
            number, element = Fraction(1), value
        for row in range(n):
            for m in range(n):
                weight = raised[row][k] * number * metric[i][m]
                if weight:
                    group = table.setdefault((row, min(j, m), max(j, m)), {})
                    if -element in group:
                        group[-element] -= weight
                    else:
                        group[element] = group.get(element, Fraction(0)) + weight
    constants: dict[Fraction, str] = {}
    rates: list[list[Any]] = [[] for _ in range(n)]
    for (row, j, m), group in sorted(table.items(), key=lambda item: item[0]):
        for element, weight in group.items():
            pair = (names[j], names[m])
            if not weight:
                continue
            if _is_short(weight):
                rates[row].append((element * weight, pair))
            else:
                name = constants.setdefault(weight, f"{names[0][0]}_weight{len(constants)}")
                rates[row].append((element, (name, *pair)))
    named = {name: value for value, name in constants.items()}
    return tuple(map(tuple, rates)), named


def lowered(frame: Frame, metric: Any) -> list[list[tuple[int, Element]]]:
    """Rows of G_ij as elements: pairs (j, element)."""
    if metric is None:
        return [list(row) for row in frame.eta.components.rows]
    rational, read = frame.field.rational, frame.field.read
    return [
        [(j, rational(x) if isinstance(x, Fraction) else read(x)) for j, x in enumerate(row) if x]
        for row in metric
    ]


def raising(frame: Frame, metric: Any = None) -> list[list[tuple[int, Element]]]:
    """Rows of the inverse of G_ij (of eta_ij if None) as elements: pairs (j, element)."""
    if metric is None:
        return [list(row) for row in frame.inverse_eta.components.rows]
    n, lower = frame.dimension, lowered(frame, metric)
    entries = {(i, j): value for i, row in enumerate(lower) for j, value in row}
    raised = sorted(inverse(frame.field, entries, n).items(), key=lambda item: item[0])
    return [[(i, value) for (i, j), value in raised if j == k] for k in range(n)]


def fractions_of(metric: Sequence[Sequence[Fraction | sp.Expr]]) -> list[list[Fraction]]:
    """The entries of a metric if all are fractions; otherwise an empty list."""
    rows = [[x for x in row if isinstance(x, Fraction)] for row in metric]
    return rows if all(len(row) == len(rows) for row in rows) else []


def _is_short(weight: Fraction) -> bool:
    """Whether a weight is compiled in."""
    return max(abs(weight.numerator), weight.denominator) <= SMALL


def _inverted(matrix: Sequence[Sequence[Fraction]]) -> list[list[Fraction]]:
    """Inverse of a matrix of fractions (Gauss and Jordan)."""
    n = len(matrix)
    rows = [[*row, *(Fraction(int(i == j)) for j in range(n))] for i, row in enumerate(matrix)]
    for c in range(n):
        pivot = next((r for r in range(c, n) if rows[r][c]), None)
        if pivot is None:
            raise ZeroDivisionError("singular matrix")
        rows[c], rows[pivot] = rows[pivot], rows[c]
        scale = rows[c][c]
        rows[c] = [x / scale for x in rows[c]]
        for r in range(n):
            if r != c and rows[r][c]:
                factor = rows[r][c]
                rows[r] = [x - factor * y for x, y in zip(rows[r], rows[c], strict=True)]
    return [row[n:] for row in rows]

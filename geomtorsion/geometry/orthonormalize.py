"""Orthonormalize: an orthonormal coframe of a metric by completing squares (Lagrange, LDL)."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from itertools import islice
from typing import Any

import sympy as sp

from geomtorsion.errors import MetricError, SignatureError
from geomtorsion.exact import Element, Field
from geomtorsion.exact.generic_point import TRIES
from geomtorsion.geometry.components import Entries
from geomtorsion.geometry.validation import with_functions
from geomtorsion.support.checks import fraction, shown

Elements = dict[tuple[int, int], Element]
Row = dict[int, Element]


def orthonormal_rows(
    field: Field,
    metric: Elements,
    n: int,
    points: Iterable[Mapping[sp.Expr, Any]],
    signature: tuple[int, ...] | None,
) -> tuple[Elements, Elements, Elements]:
    """Rows theta^i, squares q_i (diagonal) and eta with g = sum q_i theta^i theta^i.

    The orthonormal coframe is sqrt|q_i| theta^i, with no root taken before it is needed. Signs are
    taken at a point of the domain; a requested signature orders the rows.
    """
    forms = completed_squares(field, metric, n)
    signs = _signs(field, forms, points, signature, n)
    order = _row_order(signs, signature, n)
    rows = {(order[i], mu): x for i, (_, form) in forms.items() for mu, x in form.items()}
    squares = {(order[i], order[i]): square for i, (square, _) in forms.items()}
    eta = {(order[i], order[i]): field.rational(sign) for i, sign in signs.items()}
    return rows, squares, eta


def completed_squares(
    field: Field, metric: Entries, n: int, leading: int | None = None
) -> dict[int, tuple[Element, Row]]:
    """g = sum of q theta^2 over n one-forms: row -> (q, theta), theta(w) = 1, q = g(w, w).

    leading: only as many squares, whose vectors w span as many of the first given vectors; the
        metric must be regular on these.
    """
    count = n if leading is None else leading
    rest = dict(metric)
    squares: dict[int, tuple[Element, Row]] = {}
    for _ in range(count):
        direction = _direction(rest, count, n)
        if direction is None:
            where = "" if leading is None else " on the permitted velocities"
            raise MetricError(
                f"metric is degenerate{where}: its determinant vanishes identically. "
                "Drop a coordinate, or correct the entries."
            )
        form = _added_rows(field, [_row(rest, i, n) for i in direction])
        square = field.sum([(1, form[i]) for i in direction if i in form])
        reciprocal = square.inverse()
        theta = {j: value * reciprocal for j, value in form.items()}
        for i, first in form.items():
            for j, second in theta.items():
                terms: list = [(-1, first, second)]
                if (i, j) in rest:
                    terms.append((1, rest[i, j]))
                value = field.sum(terms)
                rest[i, j] = value
                if value.is_zero:
                    del rest[i, j]
        place = next(i for i in (*direction, *range(n)) if i not in squares)
        squares[place] = (square, theta)
    return squares


def _direction(rest: Entries, candidates: int, n: int) -> tuple[int, ...] | None:
    """A vector of non-zero length among the first ones: the sparsest, or the sum of two."""
    diagonal = [i for i in range(candidates) if (i, i) in rest]
    if diagonal:
        return (min(diagonal, key=lambda i: (len(_row(rest, i, n)), i)),)
    # All coordinate vectors may be null; the sum of two that are not orthogonal is not.
    return min((pair for pair in rest if max(pair) < candidates), default=None)


def _row(entries: Entries, i: int, n: int) -> Row:
    """One row of a sparse matrix."""
    return {j: entries[i, j] for j in range(n) if (i, j) in entries}


def _added_rows(field: Field, rows: list[Row]) -> Row:
    """Sum of sparse rows, without zeros."""
    total = {}
    for j in sorted(set().union(*rows)):
        value = field.sum([(1, row[j]) for row in rows if j in row])
        if not value.is_zero:
            total[j] = value
    return total


def requested_signs(signature: Sequence[object] | None, n: int) -> tuple[int, ...] | None:
    """The requested signature, as whole numbers."""
    if signature is None:
        return None
    signs = [fraction(sign) for sign in signature]
    if len(signs) != n or any(sign not in (1, -1) for sign in signs):
        raise SignatureError(
            f"signature: expected {n} signs (1 or -1), one for each row of the frame, got "
            f"{shown(tuple(signature))}."
        )
    return tuple(1 if sign == 1 else -1 for sign in signs)


def _signs(
    field: Field,
    forms: dict[int, tuple[Element, Row]],
    points: Iterable[Mapping[sp.Expr, Any]],
    signature: tuple[int, ...] | None,
    n: int,
) -> dict[int, int]:
    """Signs of the squares at the first point where they are finite and as requested."""
    others: list[dict[int, int]] = []
    for point in islice(points, TRIES):
        signs = _signs_at(forms, point)
        if signs is None:
            continue
        if signature is None or sorted(signs.values()) == sorted(signature):
            return signs
        others.append(signs)
    if not others:
        reason = field.sample.places.refusal()
        raise MetricError(f"the signature of the metric cannot be determined: {reason}")
    own_signs = tuple(others[0][i] for i in range(n))
    raise MetricError(
        f"expected a metric of signature {signature}, got one of signature {own_signs} in its "
        "domain. Give as many minus signs as the metric has, or state the domain."
    )


def _signs_at(
    forms: dict[int, tuple[Element, Row]], point: Mapping[sp.Expr, Any]
) -> dict[int, int] | None:
    """Signs of all squares at a point, or None where one is not finite, real and non-zero."""
    signs = {}
    for place, (square, _) in forms.items():
        try:
            value = complex(square.evaluate(with_functions(square, point)))
        except ArithmeticError:
            return None
        # So near a zero or a pole the sign of a double is rounding.
        if value.imag or not 1e-14 < abs(value.real) < 1e14:
            return None
        signs[place] = 1 if value.real > 0 else -1
    return signs


def _row_order(signs: dict[int, int], signature: tuple[int, ...] | None, n: int) -> dict[int, int]:
    """New position of each row, so that the signs have the requested order."""
    if signature is None or all(signs[i] == signature[i] for i in range(n)):
        return {i: i for i in range(n)}
    free = {sign: [i for i in range(n) if signature[i] == sign] for sign in (1, -1)}
    return {i: free[signs[i]].pop(0) for i in range(n)}

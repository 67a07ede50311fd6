"""Differentials: line elements and one-forms as text, dr^2 + r^2 dtheta^2 and cos(theta)*dy."""

from __future__ import annotations

import re
from collections.abc import Callable, Iterable, Sequence
from itertools import combinations_with_replacement

import sympy as sp

from geomtorsion.errors import CoframeError, MetricError
from geomtorsion.support.checks import ErrorClass, refuse
from geomtorsion.support.typed_text import ANGLES, SPHERE, separated

# Text, its place in messages, and the symbols dq^mu that it may contain.
Reader = Callable[[str, str, Sequence[sp.Symbol]], sp.Expr]
# One entry of a matrix, as opposed to a row.
_ENTRY = (int, str, sp.Expr)
_LEFT_SIDE = re.compile(r"\s*ds\s*(\^|\*\*)\s*2\s*=")


def differentials(
    coordinates: Sequence[sp.Symbol], taken: Iterable[str], where: str, error: ErrorClass
) -> list[sp.Symbol]:
    """The symbols dq^mu; none of them may have the name of another symbol.

    Examples
    --------
    >>> differentials(sp.symbols("r theta"), ["r", "theta"], "metric", MetricError)
    [dr, dtheta]
    """
    names = [f"d{symbol.name}" for symbol in coordinates]
    if not set(names).isdisjoint(taken):
        raise error(
            f"{where}: expected a differential for each coordinate, got a frame that uses one of "
            f"the names {', '.join(names)} otherwise. Give lists of components."
        )
    return [sp.Symbol(name, real=True) for name in names]


def is_flat(values: object) -> bool:
    """Whether a matrix is given as one text, or as a list of entries instead of rows.

    Examples
    --------
    >>> is_flat("dr^2"), is_flat(["dr", "r dphi"]), is_flat([[1]]), is_flat([])
    (True, True, False, False)
    """
    listed = values if isinstance(values, list | tuple) else ()
    return isinstance(values, str) or bool(listed and all(isinstance(x, _ENTRY) for x in listed))


def written_out(
    values: object, kind: str, coordinates: Sequence[sp.Symbol], taken: Iterable[str], read: Reader
) -> object:
    """Rows of a metric from a line element or its diagonal, of a coframe from one-forms.

    values: as in `is_flat`; others are returned as they are.
    kind: "metric", "coframe" or "legs".

    Raises
    ------
    MetricError, CoframeError
        The text is not quadratic, or not linear, in the differentials.
    ExpressionError
        The text cannot be read.

    Examples
    --------
    >>> from geomtorsion.exact import parse_expression
    >>> names = {name: sp.Symbol(name) for name in ("t", "x")}
    >>> def read(text, where, forms):
    ...     return parse_expression(text, names | {form.name: form for form in forms}, where=where)
    >>> written_out("ds^2 = -dt^2 + 2 t dt dx", "metric", list(names.values()), names, read)
    [[-1, t], [t, 0]]
    >>> written_out(["dt", "t*dx"], "coframe", list(names.values()), names, read)
    [[1, 0], [0, t]]
    >>> written_out("dt, t*dx", "coframe", list(names.values()), names, read)
    [[1, 0], [0, t]]
    >>> written_out([-1, "t"], "metric", list(names.values()), names, read)
    [[-1, 0], [0, 't']]
    """
    if kind == "metric" and isinstance(values, str):
        forms = differentials(coordinates, taken, kind, MetricError)
        text = _with_sphere(_LEFT_SIDE.sub("", values, count=1), coordinates)
        value = read(text, kind, forms)
        return _coefficients(value, forms, 2, kind, values, MetricError)
    if kind == "coframe" and isinstance(values, str):
        values = separated(values)
    listed = values if is_flat(values) and isinstance(values, list | tuple) else ()
    if kind == "metric" and len(listed) > 1:
        return [[x if mu == nu else 0 for nu in range(len(listed))] for mu, x in enumerate(listed)]
    if kind != "coframe" or not all(isinstance(text, str) for text in listed):
        return values
    forms = differentials(coordinates, taken, kind, CoframeError)
    rows: list[object] = []
    for i, text in enumerate(listed):
        where = f"{kind}[{i}]"
        value = read(text, where, forms)
        # In one dimension a text may also be the only component.
        is_form = len(listed) > 1 or value.has(*forms)
        row = _coefficients(value, forms, 1, where, text, CoframeError) if is_form else [[value]]
        rows += row
    return rows or values


def _with_sphere(text: str, coordinates: Sequence[sp.Symbol]) -> str:
    """A line element in which dOmega^2 is written out in the two angles."""
    names = [symbol.name for symbol in coordinates]
    for theta, phi in ANGLES:
        if theta in names and phi in names:
            return SPHERE.sub(f"(d{theta}^2 + sin({theta})^2 d{phi}^2)", text)
    return text


def _coefficients(
    value: sp.Expr,
    forms: Sequence[sp.Symbol],
    degree: int,
    where: str,
    text: str,
    error: ErrorClass,
) -> list[list[sp.Expr]]:
    """Rows of coefficients of a homogeneous polynomial in the differentials of degree 1 or 2."""
    zero = dict.fromkeys(forms, 0)
    lower = [value] if degree == 1 else [value, *(value.diff(form) for form in forms)]
    n = len(forms)
    indices = combinations_with_replacement(range(n), degree)
    parts = {index: value.diff(*(forms[mu] for mu in index)) / degree for index in indices}
    parts = {index: sp.expand(part) if part.has(*forms) else part for index, part in parts.items()}
    if any(part.has(*forms) for part in parts.values()) or any(
        sp.expand(part.subs(zero)) != 0 for part in lower
    ):
        power = "linear" if degree == 1 else "quadratic"
        example = "cos(theta) dr" if degree == 1 else "dr^2 + r^2 dtheta^2"
        refuse(
            error,
            where,
            f"a sum that is {power} in {', '.join(map(str, forms))}",
            text,
            f'Write for instance "{example}".',
        )
    if degree == 1:
        return [[parts[mu,] for mu in range(n)]]
    return [[parts[min(mu, nu), max(mu, nu)] for nu in range(n)] for mu in range(n)]

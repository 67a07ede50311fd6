"""Equations: the rates that follow from equations of motion."""

from __future__ import annotations

import re
from dataclasses import replace
from typing import TYPE_CHECKING

import sympy

from geomtorsion.errors import ExpressionError, LimitError
from geomtorsion.teaching.exercises.domain import Domain
from geomtorsion.teaching.exercises.entries import SEPARATOR, check_length, kind, split_outside
from geomtorsion.teaching.exercises.expressions import expression
from geomtorsion.teaching.exercises.limits import MOST, check_weight
from geomtorsion.teaching.exercises.question import plain_name, shown_name

if TYPE_CHECKING:
    from geomtorsion.exact import Element
    from geomtorsion.teaching.exercises.compare import Index
    from geomtorsion.teaching.exercises.question import Question

# Functions that equations may contain if they are not solved for their rates.
_PLAIN = (
    sympy.sin, sympy.cos, sympy.tan, sympy.cot, sympy.sinh, sympy.cosh, sympy.tanh, sympy.exp,
)  # fmt: skip


def equations(question: Question, given: object, where: str) -> dict[Index, sympy.Expr]:
    """The rates that follow from equations, as index of the unknown -> expression.

    Equations are a text ``Omega1' = ...; Omega2' = ...`` (semicolons or lines), a list of such, or
    a table unknown -> expression. They may be multiplied, exchanged and combined at will.

    Raises
    ------
    ExpressionError
        They cannot be read, are not linear in the unknowns, or do not determine them.
    LimitError
        They are too large.
    """
    unknowns = [sympy.Symbol(plain_name(name), real=True) for name in question.unknowns]
    wide = replace(
        question, domain=Domain((*question.domain.symbols, *unknowns), question.domain.relations)
    )
    residuals = []
    for number, (left, right) in enumerate(_sides(given, where)):
        place = f"{where}, equation {number + 1}"
        sides = [expression(wide, side, place) for side in (left, right)]
        residuals.append((place, sides[0] - sides[1]))
    if len(residuals) != len(unknowns):
        raise ExpressionError(
            f"{where}: expected {len(unknowns)} equations, got {len(residuals)}. Write one "
            f"equation for each of {', '.join(question.unknowns)}."
        )
    # Equations that are solved for their rates are not multiplied out.
    return _explicit(residuals, unknowns) or _solved(wide.domain, residuals, unknowns, where)


def _sides(given: object, where: str) -> list[tuple[object, object]]:
    """Pairs (left, right) of all equations."""
    if isinstance(given, dict):
        pairs = list(given.items())
    else:
        texts: list[str] = []
        for text in given if isinstance(given, list) else [given]:
            if not isinstance(text, str):
                raise ExpressionError(
                    f"{where}: expected equations in quotes, got {kind(text)}. Write left = right."
                )
            texts.append(text)
        check_length("".join(texts), where)
        pairs = []
        for line in (line for text in texts for line in _lines(text)):
            left, sign, right = line.partition("=")
            if not sign or "=" in right:
                raise ExpressionError(
                    f"{where}: expected left = right, got {line.strip()[:60]!r}. Separate "
                    "equations by semicolons."
                )
            pairs.append((left, right))
    if len(pairs) > MOST.equations:
        raise LimitError(
            f"{where}: expected at most {MOST.equations} equations, got {len(pairs)}. Write one "
            "equation for each rate."
        )
    return pairs


def _lines(text: str) -> list[str]:
    """Equations between semicolons, line ends, commas or "and", without numbers before them."""
    text = text.replace("==", "=").replace("\\\\", "\n").replace("\\;", " ").replace("\\,", " ")
    lines = [line for part in SEPARATOR.split(text) for line in split_outside(part, ",")]
    return [re.sub(r"^\s*(?:\(?[0-9][.)]\s)", "", line) for line in lines if line.strip()]


def _explicit(
    residuals: list[tuple[str, sympy.Expr]], unknowns: list[sympy.Symbol]
) -> dict[Index, sympy.Expr] | None:
    """The rates if each equation is unknown = expression, in any order; otherwise None."""
    rates: dict[Index, sympy.Expr] = {}
    for _, residual in residuals:
        inside = [k for k, unknown in enumerate(unknowns) if residual.has(unknown)]
        if len(inside) != 1 or (inside[0],) in rates:
            return None
        rest = unknowns[inside[0]] - residual
        if rest.has(*unknowns):
            return None
        rates[inside[0],] = rest
    return rates


def _solved(
    domain: Domain,
    residuals: list[tuple[str, sympy.Expr]],
    unknowns: list[sympy.Symbol],
    where: str,
) -> dict[Index, sympy.Expr]:
    """The rates by elimination in the exact field."""
    for place, residual in residuals:
        check_weight(residual, place, MOST.equation_terms)
        _check_plain(residual, place)
    field = domain.field()
    rows: list[list[Element]] = []
    for place, residual in residuals:
        element = field.read(residual, place)
        slopes = [element.diff(unknown) for unknown in unknowns]
        if any(not slope.free_of(unknown) for slope in slopes for unknown in unknowns):
            names = shown_name(", ".join(map(str, unknowns)))
            raise ExpressionError(
                f"{place}: expected an equation that is linear in {names}, got one that is not. "
                "Solve it for a rate."
            )
        for slope, unknown in zip(slopes, unknowns, strict=True):
            element = element - slope * field.symbol(unknown)
        rows.append([*slopes, -element])
    for k in range(len(unknowns)):
        pivot = next((r for r in range(k, len(rows)) if not rows[r][k].is_zero), None)
        if pivot is None:
            raise ExpressionError(
                f"{where}: expected equations that determine {shown_name(str(unknowns[k]))}, got "
                "some that follow from the others. Write one equation for each rate."
            )
        rows[k], rows[pivot] = rows[pivot], rows[k]
        scale = rows[k][k].inverse()
        rows[k] = [entry * scale for entry in rows[k]]
        for r, row in enumerate(rows):
            if r != k and not row[k].is_zero:
                factor = row[k]
                rows[r] = [x - factor * y for x, y in zip(row, rows[k], strict=True)]
    return {(k,): rows[k][-1].sympy for k in range(len(unknowns))}


def _check_plain(residual: sympy.Expr, place: str) -> None:
    """Refuse to solve equations with functions that no equation of motion contains."""
    for part in sympy.preorder_traversal(residual):
        is_plain = not part.args or part.is_Add or part.is_Mul or isinstance(part, _PLAIN)
        is_power = part.is_Pow and part.exp.is_Rational
        if not (is_plain or is_power):
            raise ExpressionError(
                f"{place}: expected sums, products, powers, and functions such as sin, got "
                f"{str(part)[:40]}. Write each equation as rate = expression."
            )

"""Equations: answers that are solved for their rates before they are compared."""

from __future__ import annotations

import re
from dataclasses import replace
from typing import TYPE_CHECKING

import sympy

from geomtorsion.errors import ExpressionError, LimitError
from geomtorsion.exercises.answers import expression
from geomtorsion.exercises.domain import Domain
from geomtorsion.exercises.entries import split_outside
from geomtorsion.exercises.limits import MOST, check_weight
from geomtorsion.exercises.question import plain_name, shown_name

if TYPE_CHECKING:
    from geomtorsion.exact import Element
    from geomtorsion.exercises.compare import Index
    from geomtorsion.exercises.question import Question

_PLAIN = (
    sympy.sin, sympy.cos, sympy.tan, sympy.cot, sympy.sinh, sympy.cosh, sympy.tanh, sympy.exp,
)  # fmt: skip


def equations(question: Question, given: object, where: str) -> dict[Index, sympy.Expr]:
    """The rates that follow from equations: as index of the unknown -> expression.

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
            f"{where}: {len(unknowns)} equations were needed, for {', '.join(question.unknowns)}, "
            f"but {len(residuals)} came."
        )
    # Solved rates need no elimination, which multiplies out.
    explicit = _explicit(residuals, unknowns)
    return explicit or _solved(wide.domain, residuals, unknowns, where)


def _sides(given: object, where: str) -> list[tuple[object, object]]:
    """Pairs (left, right) of all equations."""
    if isinstance(given, dict):
        pairs = list(given.items())
    else:
        given_texts = given if isinstance(given, list) else [given]
        texts = [text for text in given_texts if isinstance(text, str)]
        if len(texts) < len(given_texts):
            raise ExpressionError(f"{where}: equations in quotes were needed.")
        if sum(map(len, texts)) > MOST.characters:
            raise LimitError(
                f"{where}: more than {MOST.characters:,} characters. Write it shorter."
            )
        lines = [line for text in texts for line in _lines(text)]
        pairs = []
        for line in lines:
            left, sign, right = line.partition("=")
            if not sign or "=" in right:
                raise ExpressionError(
                    f"{where}: {line.strip()[:60]!r} is no equation. Write left = right, separated "
                    "by semicolons."
                )
            pairs.append((left, right))
    if len(pairs) > MOST.equations:
        raise LimitError(f"{where}: {len(pairs)} equations; the limit is {MOST.equations}.")
    return pairs


def _lines(text: str) -> list[str]:
    """Equations with semicolons, line ends, commas or a word between; numbers before them go."""
    text = text.replace("==", "=").replace("\\\\", ";")
    parts = re.split(r"[;\n]|\band\b", text)
    lines = [line for part in parts for line in split_outside(part, ",")]
    return [re.sub(r"^\s*(?:\(?[0-9][.)]\s)", "", line) for line in lines if line.strip()]


def _explicit(
    residuals: list[tuple[str, sympy.Expr]], unknowns: list[sympy.Symbol]
) -> dict[Index, sympy.Expr] | None:
    """The rates where each equation is unknown = expression, in whatever order."""
    found: dict[Index, sympy.Expr] = {}
    for _, residual in residuals:
        inside = [k for k, unknown in enumerate(unknowns) if residual.has(unknown)]
        if len(inside) != 1 or (inside[0],) in found:
            return None
        rest = unknowns[inside[0]] - residual
        if rest.has(*unknowns):
            return None
        found[inside[0],] = rest
    return found


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
            raise ExpressionError(f"{place}: not linear in {', '.join(map(str, unknowns))}.")
        known = element
        for slope, unknown in zip(slopes, unknowns, strict=True):
            known = known - slope * field.symbol(unknown)
        rows.append([*slopes, -known])
    for k in range(len(unknowns)):
        pivot = next((r for r in range(k, len(rows)) if not rows[r][k].is_zero), None)
        if pivot is None:
            raise ExpressionError(
                f"{where}: the equations do not determine {shown_name(str(unknowns[k]))}: some of "
                "them follow from the others."
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
    """Refuse to solve what no equation of motion contains."""
    for part in sympy.preorder_traversal(residual):
        known = not part.args or part.is_Add or part.is_Mul or isinstance(part, _PLAIN)
        power = part.is_Pow and part.exp.is_Rational
        if not (known or power):
            raise ExpressionError(
                f"{place}: {str(part)[:40]} is more than is solved for here. Write each equation "
                "as rate = expression."
            )

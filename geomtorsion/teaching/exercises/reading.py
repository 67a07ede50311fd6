"""Reading: an answer of a student as expressions or numbers, by index."""

from __future__ import annotations

import math
import re
from collections.abc import Mapping
from typing import TYPE_CHECKING

import sympy

from geomtorsion import errors
from geomtorsion.codegen import graph
from geomtorsion.codegen.balls import BallCode, float_values
from geomtorsion.errors import ExpressionError, LimitError
from geomtorsion.exact.units import scale_of, unit
from geomtorsion.support.checks import close_names, cut
from geomtorsion.teaching.exercises.entries import flat, index, kind, table_or_list
from geomtorsion.teaching.exercises.equations import equations
from geomtorsion.teaching.exercises.expressions import expression
from geomtorsion.teaching.exercises.limits import MOST
from geomtorsion.teaching.exercises.question import example

if TYPE_CHECKING:
    from geomtorsion.teaching.exercises.compare import Index, Value
    from geomtorsion.teaching.exercises.question import Question

_UNIT = re.compile(r"^(.*?(?:[\d.)]|pi|π))\s*([A-Za-z°%]+(?:/s)?|1/s)\s*$", re.DOTALL)


class UnitError(ExpressionError):
    """The unit of an answer belongs to another quantity than the question."""


def read(question: Question, given: object) -> Value:
    """An answer as index -> expression or number.

    Raises
    ------
    ExpressionError
        It cannot be read.
    LimitError
        It is too large.
    """
    name = question.name
    if question.kind == "expression":
        return {(): expression(question, given, name)}
    if question.kind == "equations":
        return equations(question, given, name)
    if question.kind == "number":
        return numbers(question, given, name)
    if question.kind == "choice":
        return {(): _chosen(question, given)}
    return components(question, given, name)


def components(question: Question, given: object, where: str) -> dict[Index, sympy.Expr]:
    """Components by their indices, from a table, nested lists, or a text of one of these forms.

    A table or text names components: ``{"1,2,1" = "1/r"}`` or ``1,2,1 = 1/r; 2,1,1 = 0``; indices
    are counted from 1 or named by coordinates; a component that is not listed is zero. A list gives
    all components: ``[[1, 0], [0, "r"]]``.

    Raises
    ------
    ExpressionError
        An index or an expression cannot be read.
    LimitError
        There are more entries than components, or an expression is too large.
    """
    if isinstance(given, str):
        given = table_or_list(question, given, where)
    if isinstance(given, int) and not isinstance(given, bool) and given == 0:
        return {}
    if isinstance(given, Mapping):
        pairs = [(index(question, key, where), value) for key, value in given.items()]
    elif isinstance(given, list):
        pairs = flat(given, question.shape, where)
    elif question.shape in ((), (1,)):
        pairs = [((0,) * len(question.shape), given)]
    else:
        raise ExpressionError(
            f"{where}: expected components, got {kind(given)}. Write for instance "
            f'"{example(question)}", or a list of lists.'
        )
    if len(pairs) > MOST.entries:
        raise LimitError(
            f"{where}: expected at most {MOST.entries} entries, got {len(pairs)}. Write only the "
            "components that are not zero."
        )
    values: dict[Index, sympy.Expr] = {}
    for key, value in pairs:
        name = f"{where}[{','.join(str(k + 1) for k in key)}]"
        if key in values:
            raise ExpressionError(
                f"{where}: expected each component once, got {name} twice. Remove one of them."
            )
        values[key] = expression(question, value, name)
    return values


def numbers(question: Question, given: object, where: str) -> dict[Index, float]:
    """Numbers by their indices, in the unit of the question.

    Raises
    ------
    ExpressionError
        It is not a number.
    UnitError
        Its unit belongs to another quantity.
    """
    text, factor = given, 1.0
    if isinstance(given, str):
        text, factor = _without_unit(question, given, where)
        comma = re.fullmatch(r"\s*([-+]?[0-9]+),([0-9]+)\s*", str(text)[:100])
        if comma and not question.shape:
            raise ExpressionError(
                f"{where}: expected a number with a decimal point, got {comma[0].strip()}. Write "
                f"{comma[1]}.{comma[2]}."
            )
    if not question.shape:
        return {(): factor * _float(expression(question, text, where), where)}
    values = components(question, text, where)
    return {key: factor * _float(value, f"{where}[{key[0] + 1}]") for key, value in values.items()}


def _without_unit(question: Question, text: str, where: str) -> tuple[str, float]:
    """The text before the unit, and the size of that unit in units of the question."""
    # Cut before it is matched: a pattern with a lazy part is slow on long texts.
    match = _UNIT.match(text.strip()[:2000])
    if match is None:
        return text, 1.0
    if match[2] == "%" and not question.unit:
        return match[1], 1e-2
    try:
        return match[1], scale_of(unit(match[2]), question.unit)
    except errors.UnitError as error:
        if match[2] in ("pi", "π", "E", "i", "I"):
            return text, 1.0
        raise UnitError(f"{where}: {error}") from None


def _float(expr: sympy.Expr, where: str) -> float:
    """An expression without symbols as a number."""
    [value] = float_values(BallCode(graph([], [expr])), [])
    number = math.nan if value is None or complex(value).imag else complex(value).real
    if not math.isfinite(number):
        raise ExpressionError(
            f"{where}: expected a finite real number, got {cut(str(expr), 40)}. Write for instance "
            "0.25 or pi/4."
        )
    return number


def _chosen(question: Question, given: object) -> str:
    """The key of the chosen option."""
    text = _letters(_TRUTH.get(given, str(given)) if isinstance(given, bool) else str(given))
    text = _SYNONYMS.get(text, text)
    for key, option in question.options.items():
        # The first clause of an explanation is enough, but not less: a "not" may follow.
        clause = re.split(r"[,(:]", option)[0]
        if text in (_letters(key), _letters(option), _letters(clause)):
            return key
    near = close_names(text, tuple(question.options))
    remedy = f"Did you mean {near[0]}?" if near else "Write one of these words."
    raise ExpressionError(
        f"{question.name}: expected one of {', '.join(question.options)}, got {kind(given)}. "
        f"{remedy}"
    )


def _letters(text: str) -> str:
    """Letters, digits and single spaces of an option, in lower case."""
    words = re.sub(r"[^\w≠]+|_", " ", text[:200].lower().replace("≠", " ≠ "))
    return " ".join(words.split())


# Synonyms of options that many exercises offer.
_TRUTH = {True: "yes", False: "no"}
_SYNONYMS = {"0": "zero", "vanishes": "zero", "nonzero": "not zero", "non zero": "not zero",
             "≠ 0": "not zero", "not 0": "not zero", "true": "yes", "false": "no"}  # fmt: skip

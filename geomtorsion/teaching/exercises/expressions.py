"""Expressions: an expression of an answer, over the symbols of its question."""

from __future__ import annotations

import re
from collections.abc import Mapping
from typing import TYPE_CHECKING

import sympy

from geomtorsion.errors import ExpressionError, LimitError
from geomtorsion.teaching.exercises.entries import kind
from geomtorsion.teaching.exercises.limits import ANSWER
from geomtorsion.teaching.exercises.notation import read_typed
from geomtorsion.teaching.exercises.question import advice

if TYPE_CHECKING:
    from geomtorsion.teaching.exercises.question import Question


def expression(question: Question, given: object, where: str) -> sympy.Expr:
    """One expression over the symbols of a question.

    Raises
    ------
    ExpressionError
        It is not text, or cannot be read; the message shows the position.
    LimitError
        It is longer, deeper or has larger numbers than an answer may.
    """
    if isinstance(given, int) and not isinstance(given, bool):
        given = str(given) if abs(given) < 10**ANSWER.digits else "1" * (ANSWER.digits + 1)
    if isinstance(given, float):
        given = repr(given)
    if not isinstance(given, str):
        raise ExpressionError(
            f"{where}: expected an expression in quotes, got {kind(given)}. Write for instance "
            '"sin(x)/2".'
        )
    names = question.domain.names
    try:
        return read_typed(without_label(given, names), names, where, ANSWER)
    except (ExpressionError, LimitError) as error:
        raise type(error)(advice(question, str(error), given)) from None


def without_label(text: str, names: Mapping[str, object]) -> str:
    """A text without its label: "lambda = w" and "= w" are w.

    Examples
    --------
    >>> without_label("Gamma_12^1 = cot(x)", {"x": None}), without_label("x = 2", {"x": None})
    ('cot(x)', 'x = 2')
    """
    text = re.sub(r"^\s*[=≈≃]\s*", "", text.replace("==", "="))
    label, sign, value = text.partition("=")
    head = re.match(r"\s*(\\?[^\W\d]+)", label)
    is_label = head is not None and not re.search(r"[-+*/]", label) and label.strip() not in names
    text = value.strip() if sign and is_label and "=" not in value else text
    return re.sub(r"(?<=[\w)\]}])\s*[.,;]\s*$", "", text)

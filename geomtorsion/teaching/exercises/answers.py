"""Answers: solutions as texts that `Exercise.check` reads."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any

from geomtorsion.pictures.text import expression_text
from geomtorsion.support import checks
from geomtorsion.support.precision import CALCULATED
from geomtorsion.teaching.exercises.question import shown_name

if TYPE_CHECKING:
    from geomtorsion.teaching.exercises.compare import Index, Value
    from geomtorsion.teaching.exercises.question import Question

# Digits of a number in a solution's text.
DIGITS = round(-math.log10(CALCULATED))


def answer_text(question: Question, value: Value) -> str:
    """A value as text that `Exercise.check` reads back.

    Examples
    --------
    >>> import sympy
    >>> from geomtorsion.teaching.exercises import load
    >>> question = load("1.1").questions[0]
    >>> answer_text(question, {(0, 0): sympy.Integer(1), (1, 1): 1 / sympy.Symbol("r")})
    '1,1 = 1; 2,2 = 1/r'
    """
    if question.kind == "choice":
        return str(value[()])
    if question.kind == "equations":
        return "; ".join(
            f"{name} = {component_text(value.get((k,), 0))}"
            for k, name in enumerate(question.unknowns)
        )
    if not question.shape:
        text = component_text(value.get((), 0))
        return f"{text} {question.unit}".strip()
    if question.kind == "number":
        components = without_rounding(value)
        parts = [component_text(components.get((k,), 0)) for k in range(question.shape[0])]
        return f"[{', '.join(parts)}]"
    pairs = [f"{','.join(str(k + 1) for k in key)} = {component_text(x)}" for key, x in
             sorted(value.items())]  # fmt: skip
    return "; ".join(pairs) or "0"


def without_rounding(value: Value) -> dict[Index, Any]:
    """Numbers without those that are rounding errors compared with the largest.

    Examples
    --------
    >>> without_rounding({(0,): 0.5, (1,): 1e-17})
    {(0,): 0.5}
    """
    largest = max((abs(float(x)) for x in value.values()), default=0.0)
    return {key: x for key, x in value.items() if abs(float(x)) > CALCULATED * largest}


def component_text(value: object) -> str:
    """One expression or number as text without Greek letters."""
    if isinstance(value, float):
        return f"{value:.{DIGITS}g}"
    return shown_name(expression_text(checks.expression(value), greek=False))

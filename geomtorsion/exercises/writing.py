"""Writing: values as texts that a student could have given as an answer."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import sympy

from geomtorsion.exercises.reading import shown_name
from geomtorsion.pictures.text import expression_text

if TYPE_CHECKING:
    from geomtorsion.exercises.compare import Value
    from geomtorsion.exercises.question import Question

DIGITS = 12


def answer_text(question: Question, value: Value) -> str:
    """A value as text that `Exercise.check` reads back.

    Examples
    --------
    >>> from geomtorsion.exercises import load
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
        largest = max((abs(float(x)) for x in value.values()), default=0.0)
        kept = {key: x for key, x in value.items() if abs(float(x)) > 10**-DIGITS * largest}
        parts = [component_text(kept.get((k,), 0)) for k in range(question.shape[0])]
        return f"[{', '.join(parts)}]"
    pairs = [f"{','.join(str(k + 1) for k in key)} = {component_text(x)}" for key, x in
             sorted(value.items())]  # fmt: skip
    return "; ".join(pairs) or "0"


def component_text(value: Any) -> str:
    """One expression or number as text without Greek letters."""
    if isinstance(value, float):
        return f"{value:.{DIGITS}g}"
    return shown_name(expression_text(sympy.sympify(value), greek=False))

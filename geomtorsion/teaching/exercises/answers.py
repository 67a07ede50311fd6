"""answers: answers of students, read by the whitelist parser, and solutions in the same form."""

from __future__ import annotations

import math
import re
from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

import sympy

from geomtorsion import checks
from geomtorsion.errors import ExpressionError, LimitError
from geomtorsion.pictures.text import expression_text
from geomtorsion.precision import CALCULATED
from geomtorsion.teaching.exercises.entries import flat, index, kind, table_or_list
from geomtorsion.teaching.exercises.limits import ANSWER, MOST
from geomtorsion.teaching.exercises.notation import read_typed
from geomtorsion.teaching.exercises.question import advice, example, shown_name

if TYPE_CHECKING:
    from geomtorsion.teaching.exercises.compare import Index, Value
    from geomtorsion.teaching.exercises.question import Question

# Digits of a number in a solution's text.
DIGITS = round(-math.log10(CALCULATED))


def expression(question: Question, given: object, where: str) -> sympy.Expr:
    """One expression over the symbols of a question.

    Raises
    ------
    ExpressionError
        It is not a text, or cannot be read; the message shows the position.
    LimitError
        It is longer, deeper or has larger numbers than an answer may.
    """
    if isinstance(given, int) and not isinstance(given, bool):
        given = str(given) if abs(given) < 10**ANSWER.digits else "1" * (ANSWER.digits + 1)
    if isinstance(given, float):
        given = repr(given)
    if not isinstance(given, str):
        raise ExpressionError(
            f"{where}: an expression in quotes was needed, but {kind(given)} came. Write for "
            'instance "sin(x)/2".'
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
            f"{where}: components were needed, but {kind(given)} came. Write for instance "
            f'"{example(question)}", or a list of lists.'
        )
    if len(pairs) > MOST.entries:
        raise LimitError(f"{where}: {len(pairs)} entries; the limit is {MOST.entries}.")
    found: dict[Index, sympy.Expr] = {}
    for key, value in pairs:
        name = f"{where}[{','.join(str(k + 1) for k in key)}]"
        if key in found:
            raise ExpressionError(f"{name} is given twice. Give it once.")
        found[key] = expression(question, value, name)
    return found


def completed(given: Value, symmetry: str) -> dict[Index, Any]:
    """The components, completed by exchanging the first two indices of each given component.

    Examples
    --------
    >>> completed({(0, 1): 5}, "antisymmetric")
    {(0, 1): 5, (1, 0): -5}
    """
    found = dict(given)
    sign = {"antisymmetric": -1, "symmetric": 1}.get(symmetry)
    for key, value in given.items() if sign else ():
        found.setdefault((key[1], key[0], *key[2:]), sign * value)
    return found


def answer_text(question: Question, value: Value) -> str:
    """A value as text that `Exercise.check` reads back.

    Examples
    --------
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
        kept = without_rounding(value)
        parts = [component_text(kept.get((k,), 0)) for k in range(question.shape[0])]
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

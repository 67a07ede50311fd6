"""Checking: an answer (equations solved for rates) against the solution; the likely mistake."""

from __future__ import annotations

import math
import re
from collections.abc import Mapping
from dataclasses import replace
from typing import TYPE_CHECKING

import sympy

from geomtorsion import errors
from geomtorsion.checks import close_names, cut
from geomtorsion.codegen import graph
from geomtorsion.codegen.balls import float_values
from geomtorsion.errors import ExpressionError, GeomtorsionError, LimitError
from geomtorsion.teaching.exercises.answers import answer_text, completed, components, expression
from geomtorsion.teaching.exercises.compare import EQUAL, PARTLY, agreement, agrees, has_root
from geomtorsion.teaching.exercises.domain import Domain
from geomtorsion.teaching.exercises.entries import split_outside
from geomtorsion.teaching.exercises.limits import MOST, check_weight
from geomtorsion.teaching.exercises.question import HALF, plain_name, scaled, shown_name
from geomtorsion.teaching.exercises.verdict import MESSAGES, QuestionVerdict, message_of
from geomtorsion.units import scale_of, unit

if TYPE_CHECKING:
    from geomtorsion.exact import Element
    from geomtorsion.teaching.exercises.compare import Index
    from geomtorsion.teaching.exercises.question import Question


_UNIT = re.compile(r"^(.*?(?:[\d.)]|pi|π))\s*([A-Za-z°%]+(?:/s)?|1/s)\s*$", re.DOTALL)
# Rounding to two digits changes a number by no more than this share: 1.05 is written as 1.1.
ROUNDED = 0.05


# Messages about single answers that are wrong without a recognised mistake.
_NOT_RIGHT = {
    "choice": "That is not it.",
    "number": "The number is not right.",
    "expression": "That is not equal to the solution.",
}


class UnitError(ExpressionError):
    """The unit of an answer measures another quantity than the question."""


def numbers(question: Question, given: object, where: str) -> dict[Index, float]:
    """Numbers by their indices, in the unit of the question.

    Raises
    ------
    ExpressionError
        It is not a number.
    UnitError
        Its unit measures another quantity.
    """
    text, factor = given, 1.0
    if isinstance(given, str):
        text, factor = _without_unit(question, given, where)
        comma = re.fullmatch(r"\s*([-+]?[0-9]+),([0-9]+)\s*", str(text)[:100])
        if comma and not question.shape:
            raise ExpressionError(
                f"{where}: a number was needed, but {comma[0].strip()} has a comma. Write "
                f"{comma[1]}.{comma[2]} with a point."
            )
    if not question.shape:
        return {(): factor * _float(expression(question, text, where), where)}
    found = components(question, text, where)
    return {key: factor * _float(value, f"{where}[{key[0] + 1}]") for key, value in found.items()}


def _without_unit(question: Question, text: str, where: str) -> tuple[str, float]:
    """The text before the unit, and how many units of the question it is worth."""
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
    [value] = float_values(graph([], [expr]), [])
    number = math.nan if value is None or complex(value).imag else complex(value).real
    if not math.isfinite(number):
        raise ExpressionError(f"{where}: this has no finite real value. Give a number.")
    return number


if TYPE_CHECKING:
    from geomtorsion.teaching.exercises.compare import Index, Value
    from geomtorsion.teaching.exercises.question import Mistake, Question


def check_question(question: Question, given: object) -> QuestionVerdict:
    """The verdict on an answer; no input of a student raises an error."""
    if given is None or (isinstance(given, str) and not given.strip()):
        return _wrong(question, "empty", "No answer was given.")
    try:
        value = read(question, given)
        return replace(_checked(question, value), read_as=preview(question, value))
    except UnitError as error:
        return _wrong(question, "unit", str(error))
    except LimitError as error:
        return _wrong(question, "too large", str(error))
    except (GeomtorsionError, ArithmeticError, ValueError, RecursionError) as error:
        return _wrong(question, "unreadable", str(error) or type(error).__name__)


def preview(question: Question, value: Value) -> str:
    """A value as a student may write it, cut if it is long."""
    try:
        return cut(answer_text(question, value), MOST.preview)
    except GeomtorsionError:
        return ""


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
        return without_zeros({(): expression(question, given, name)})
    if question.kind == "equations":
        return without_zeros(equations(question, given, name))
    if question.kind == "number":
        return numbers(question, given, name)
    if question.kind == "choice":
        return {(): _chosen(question, given)}
    # A zero that is written is an answer of its own: it is dropped after symmetry has been used.
    return components(question, given, name)


def without_zeros(value: Value) -> Value:
    """Without the components that are zero."""
    return {key: x for key, x in value.items() if x != 0}


def _chosen(question: Question, given: object) -> str:
    """The key of the option that was meant."""
    text = _letters(_SAID.get(given, str(given)) if isinstance(given, bool) else str(given))
    text = _MEANT.get(text, text)
    for key, option in question.options.items():
        # The first clause of an explanation is enough, but not less: a "not" may follow.
        clause = re.split(r"[,(]", option)[0]
        if text in (_letters(key), _letters(option), _letters(clause)):
            return key
    known = ", ".join(question.options)
    near = close_names(text, tuple(question.options))
    hint = f" Did you mean {near[0]}?" if near else ""
    raise LookupErrorInAnswer(f"{question.name}: one of {known} was needed.{hint}")


def _letters(text: str) -> str:
    """The parts that distinguish options: letters, digits and single spaces, without capitals."""
    words = re.sub(r"[^\w≠]+|_", " ", text[:200].lower().replace("≠", " ≠ "))
    return " ".join(words.split())


# Synonyms of options that many exercises offer.
_SAID = {True: "yes", False: "no"}
_MEANT = {"0": "zero", "vanishes": "zero", "nonzero": "not zero", "non zero": "not zero",
          "≠ 0": "not zero", "not 0": "not zero", "true": "yes", "false": "no"}  # fmt: skip


class LookupErrorInAnswer(GeomtorsionError, ValueError):
    """A choice that is not one of the options."""


def _checked(question: Question, value: Value) -> QuestionVerdict:
    """The verdict on an answer that was read: right, a likely mistake, or the wrong components."""
    right, completed = question.solution, _completed(question, value)
    states = agreement(question, completed, right)
    if all(state == EQUAL for state in states.values()):
        return _right(question)
    # A mistake may lack the symmetry of the solution; then it is compared as written.
    written = without_zeros(value)
    answers = (completed, written) if len(written) < len(completed) else (completed,)
    mistakes = [
        mistake
        for mistake in question.mistakes
        if any(agrees(question, answer, mistake.value) for answer in answers)
    ]
    if mistakes:
        return _diagnosed(question, mistakes)
    # A recognised mistake takes precedence over "rounded too early": it is more specific.
    if question.kind == "number" and agrees(replace(question, tolerance=ROUNDED), value, right):
        return _wrong(question, "rounded", MESSAGES["rounded"])
    if any(k == -1 for key in value for k in key):
        return _counted_from_zero(question, completed)
    if all(state in (EQUAL, PARTLY) for state in states.values()):
        root = any(has_root(completed.get(key, 0) - right.get(key, 0)) for key in states)
        return _wrong(question, "domain", MESSAGES["domain" if root else "branch"])
    if question.shape or question.kind == "equations":
        return _by_component(question, states, completed)
    return _wrong(question, "", _NOT_RIGHT[question.kind])


def _completed(question: Question, value: Value) -> Value:
    """An answer with the components that follow by symmetry, and without zeros if it is exact."""
    if question.kind == "number":
        return value
    return without_zeros(completed(value, question.symmetry))


def _counted_from_zero(question: Question, value: Value) -> QuestionVerdict:
    """The verdict on indices that start at 0."""
    moved = {tuple(k + 1 for k in key): x for key, x in value.items()}
    inside = all(k < n for key in moved for k, n in zip(key, question.shape, strict=True))
    is_solution = inside and agrees(question, moved, question.solution)
    reason = "" if is_solution else "An index is 0: "
    return _wrong(question, "counted", reason + MESSAGES["counted"])


def _by_component(question: Question, states: Mapping[Index, str], value: Value) -> QuestionVerdict:
    """The share of right components; the mistake that all wrong components have in common."""
    wrong = [key for key, state in states.items() if state != EQUAL]
    names = ", ".join(_label(question, key) for key in wrong[: MOST.named])
    more = f" and {len(wrong) - MOST.named} more" if len(wrong) > MOST.named else ""
    score = round(1 - len(wrong) / len(states), 3)
    text = f"{len(states) - len(wrong)} of {len(states)} right. Look again at {names}{more}."
    code = _common(question, wrong, value)
    if code:
        text = f"{text} {message_of(code, question.remarks)}"
    return QuestionVerdict(
        question.name, False, score, text, code or "incomplete", (), question.points
    )


def _common(question: Question, wrong: list[Index], value: Value) -> str:
    """The code of a sign or a factor 2 by which all wrong components are off; or empty."""
    given = {key: value[key] for key in wrong if key in value}
    right = {key: question.solution[key] for key in wrong if key in question.solution}
    for code, factor in (("sign", -1), ("factor", 2), ("factor", HALF)):
        if code in question.generic and agrees(question, given, scaled(right, factor)):
            return code
    return ""


def _label(question: Question, key: Index) -> str:
    """A component as a student names it."""
    if question.unknowns:
        return question.unknowns[key[0]]
    return f"{question.label or question.name}[{','.join(str(k + 1) for k in key)}]"


def _diagnosed(question: Question, mistakes: list[Mistake]) -> QuestionVerdict:
    """The verdict on an answer that is one of the expected mistakes."""
    codes = list(dict.fromkeys(mistake.code for mistake in mistakes))
    texts = (m.message or message_of(m.code, question.remarks) for m in mistakes)
    message = " Or: ".join(list(dict.fromkeys(texts))[:2])
    return QuestionVerdict(
        question.name, False, 0.0, message, codes[0], tuple(codes[1:]), question.points
    )


def _right(question: Question) -> QuestionVerdict:
    return QuestionVerdict(question.name, True, 1.0, "Right.", points=question.points)


def _wrong(question: Question, code: str, message: str) -> QuestionVerdict:
    return QuestionVerdict(question.name, False, 0.0, message, code, (), question.points)


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
    text = text.replace("==", "=").replace("\\\\", "\n").replace("\\;", " ").replace("\\,", " ")
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
    """Refuse to solve equations that no equation of motion contains."""
    for part in sympy.preorder_traversal(residual):
        known = not part.args or part.is_Add or part.is_Mul or isinstance(part, _PLAIN)
        power = part.is_Pow and part.exp.is_Rational
        if not (known or power):
            raise ExpressionError(
                f"{place}: {str(part)[:40]} is more than is solved for here. Write each equation "
                "as rate = expression."
            )

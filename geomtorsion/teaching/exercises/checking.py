"""Checking: the verdict on an answer, with the likely mistake."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from typing import TYPE_CHECKING

from geomtorsion.errors import GeomtorsionError, LimitError
from geomtorsion.support.checks import cut
from geomtorsion.teaching.exercises.answers import answer_text
from geomtorsion.teaching.exercises.compare import EQUAL, PARTLY, agreement, agrees, has_root
from geomtorsion.teaching.exercises.limits import MOST
from geomtorsion.teaching.exercises.question import HALF, scaled
from geomtorsion.teaching.exercises.reading import UnitError, read
from geomtorsion.teaching.exercises.verdict import MESSAGES, QuestionVerdict, message_of
from geomtorsion.teaching.messages import in_language
from geomtorsion.teaching.texts import Texts, texts

if TYPE_CHECKING:
    from geomtorsion.teaching.exercises.compare import Index, Value
    from geomtorsion.teaching.exercises.question import Mistake, Question

# Rounding to two digits changes a number by no more than this share: 1.05 is written as 1.1.
ROUNDED = 0.05


def _texts(question: Question) -> Texts:
    """Sentences about the check of an answer, in the language of the question."""
    return texts("feedback", "checking", question.language)


def check_question(question: Question, given: object) -> QuestionVerdict:
    """The verdict on an answer; no input of a student raises an error."""
    if given is None or (isinstance(given, str) and not given.strip()):
        return _wrong(question, "empty", _texts(question)("empty"))
    try:
        value = read(question, given)
        return replace(_checked(question, value), read_as=_preview(question, value))
    except UnitError as error:
        code, message = "unit", str(error)
    except LimitError as error:
        code, message = "too large", str(error)
    except (GeomtorsionError, ArithmeticError, ValueError, RecursionError) as error:
        code, message = "unreadable", str(error) or type(error).__name__
    return _wrong(question, code, in_language(message, question.language, question.name))


def _message(question: Question, code: str) -> str:
    return MESSAGES.of(question.language)[code]


def _preview(question: Question, value: Value) -> str:
    """The answer in the notation of solutions, cut if it is long."""
    try:
        return cut(answer_text(question, value), MOST.preview)
    except GeomtorsionError:
        return ""


def _checked(question: Question, value: Value) -> QuestionVerdict:
    """The verdict on an answer that was read: right, a likely mistake, or the wrong components."""
    right, completed = question.solution, _completed(question, value)
    states = agreement(question, completed, right)
    if all(state == EQUAL for state in states.values()):
        return _right(question)
    # A mistake may lack the symmetry of the solution; then it is compared as written.
    written = _without_zeros(value)
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
        return _wrong(question, "rounded", _message(question, "rounded"))
    if any(k == -1 for key in value for k in key):
        return _counted_from_zero(question, completed)
    if all(state in (EQUAL, PARTLY) for state in states.values()):
        root = any(has_root(completed.get(key, 0) - right.get(key, 0)) for key in states)
        return _wrong(question, "domain", _message(question, "domain" if root else "branch"))
    if question.shape or question.kind == "equations":
        return _by_component(question, states, completed)
    text = _texts(question)
    kinds = {"choice": text("choice"), "number": text("number"), "expression": text("expression")}
    return _wrong(question, "", kinds[question.kind])


def _completed(question: Question, value: Value) -> Value:
    """An answer with the components that follow by symmetry, and without zeros if it is exact."""
    if question.kind == "number":
        return value
    sign = {"antisymmetric": -1, "symmetric": 1}.get(question.symmetry, 0)
    exchanged = {(k[1], k[0], *k[2:]): sign * x for k, x in value.items()} if sign else {}
    # A zero that is written is a component that was not omitted: it is dropped only now.
    return _without_zeros({**exchanged, **value})


def _without_zeros(value: Value) -> Value:
    return {key: x for key, x in value.items() if x != 0}


def _counted_from_zero(question: Question, value: Value) -> QuestionVerdict:
    """The verdict on indices that start at 0."""
    moved = {tuple(k + 1 for k in key): x for key, x in value.items()}
    inside = all(k < n for key in moved for k, n in zip(key, question.shape, strict=True))
    is_solution = inside and agrees(question, moved, question.solution)
    reason = "" if is_solution else f"{_texts(question)('index')} "
    return _wrong(question, "counted", reason + _message(question, "counted"))


def _by_component(question: Question, states: Mapping[Index, str], value: Value) -> QuestionVerdict:
    """The share of right components; the mistake that all wrong components have in common."""
    wrong = [key for key, state in states.items() if state != EQUAL]
    names = ", ".join(_label(question, key) for key in wrong[: MOST.named])
    say = _texts(question)
    if len(wrong) > MOST.named:
        names = say("more", names=names, count=len(wrong) - MOST.named)
    score = round(1 - len(wrong) / len(states), 3)
    text = say("components", right=len(states) - len(wrong), count=len(states), names=names)
    code = _common(question, wrong, value)
    if code:
        text = f"{text} {message_of(code, question.remarks, question.language)}"
    return QuestionVerdict(
        question.name, False, score, text, code or "incomplete", (), question.points
    )


def _common(question: Question, wrong: list[Index], value: Value) -> str:
    """The code of a sign or a factor 2 by which all wrong components are off; or empty."""
    components = {key: value[key] for key in wrong if key in value}
    right = {key: question.solution[key] for key in wrong if key in question.solution}
    for code, factor in (("sign", -1), ("factor", 2), ("factor", HALF)):
        if code in question.generic and agrees(question, components, scaled(right, factor)):
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
    messages = dict.fromkeys(
        m.message or message_of(m.code, question.remarks, question.language) for m in mistakes
    )
    message = f" {_texts(question)('or')} ".join(list(messages)[:2])
    return QuestionVerdict(
        question.name, False, 0.0, message, codes[0], tuple(codes[1:]), question.points
    )


def _right(question: Question) -> QuestionVerdict:
    return QuestionVerdict(
        question.name, True, 1.0, _texts(question)("right"), points=question.points
    )


def _wrong(question: Question, code: str, message: str) -> QuestionVerdict:
    return QuestionVerdict(question.name, False, 0.0, message, code, (), question.points)

"""problems: exercises in the form of the page, and feedback on answers."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from html import escape
from typing import TYPE_CHECKING

from geomtorsion.errors import LimitError
from geomtorsion.teaching import exercises
from geomtorsion.teaching.exercises.prose import html_of, latex_of
from geomtorsion.teaching.exercises.question import example, precision_text, symbol_names
from geomtorsion.teaching.exercises.worker_pool import Json
from geomtorsion.teaching.lab import views
from geomtorsion.teaching.lab.settings import PAGE
from geomtorsion.teaching.texts import ENGLISH, TextTable, texts

if TYPE_CHECKING:
    from geomtorsion.teaching.exercises import Question


def how(question: Question) -> str:
    """Instructions for the answer to a question, with the names that may occur.

    Examples
    --------
    >>> from geomtorsion.teaching import exercises
    >>> how(exercises.load("3.2").questions[0])
    'an expression, such as sin(phi2)/2. Available names: phi1, phi2'
    >>> how(exercises.load("1.1").questions[0]).partition(";")[0]
    'index = value, such as 1,1 = ...'
    """
    text = texts("lab", "how", question.language)
    if question.kind == "choice":
        return text("choice")
    if question.kind == "number":
        return text("number", precision=precision_text(question))
    if question.kind == "components":
        key = "symmetric" if question.symmetry else "components"
        form = text(key, example=example(question))
    else:
        form = text("equations") if question.kind == "equations" else text("expression")
    names = ", ".join(symbol_names(question))
    return text("names", form=form, names=names) if names else text("no_names", form=form)


def listing(language: str = ENGLISH, chapter: str | None = None) -> Json:
    """All exercises by chapter. chapter: the folder of a teacher's chapter, which comes last.

    Examples
    --------
    >>> list(listing()["chapters"])[0]
    '1. Frames and anholonomy'
    """
    titles = exercises.titles(language, chapter)
    return {
        "chapters": {
            f"{number}. {title}": {
                name: what for name, what in titles.items() if name.partition(".")[0] == number
            }
            for number, title in exercises.chapters(language, chapter).items()
        }
    }


def statement(
    number: str, seed: int = 0, language: str = ENGLISH, chapter: str | None = None
) -> Json:
    """An exercise without its solution; statement and prompts as HTML, formulas as MathML.

    Examples
    --------
    >>> found = statement("1.1")
    >>> found["title"], [question["name"] for question in found["questions"]], found["hints"]
    ('The legs of a coframe', ['legs'], 3)
    """
    exercise = exercises.load(number, seed, language, chapter)
    asked = [question.prompt for question in exercise.questions]
    return {
        "number": exercise.number,
        "title": exercise.title,
        "chapter": exercise.chapter,
        "level": exercise.level_name,
        "seed": exercise.seed,
        "note": exercise.note,
        "statement": html_of(exercise.statement),
        "copy": _copy_button([exercise.statement, *asked], "statement", language),
        "questions": [
            {
                "name": question.name,
                "kind": question.kind,
                "prompt": html_of(question.prompt),
                "unit": question.unit,
                "options": dict(question.options),
                "how": how(question),
            }
            for question in exercise.questions
        ],
        "hints": len(exercise.hints),
    }


def hints(
    number: str, seed: int, count: int, language: str = ENGLISH, chapter: str | None = None
) -> Json:
    """The first hints of an exercise, as HTML.

    Examples
    --------
    >>> len(hints("1.1", 0, 2)["hints"])
    2
    """
    taken = exercises.load(number, seed, language, chapter).hints[:count]
    return {
        "hints": [html_of(hint) for hint in taken],
        "copy": _copy_button(taken, "hints", language),
    }


def _copy_button(pieces: Sequence[str], what: str, language: str) -> str:
    """A button that copies texts as LaTeX; empty if they contain no formula.

    what: the name of a question, or the key of a label.
    """
    if not any("$" in text for text in pieces):
        return ""
    text = texts("figures", "figure", language)
    name = text(what) if what in ("statement", "hints") else what
    return views.copy_button("\n\n".join(map(latex_of, pieces)), name, language)


def _message(text: str) -> str:
    """A message as HTML; one with an excerpt of the answer keeps its lines."""
    return f"<pre>{escape(text)}</pre>" if "\n    " in text else html_of(text)


def answer(
    number: str,
    seed: int,
    answers: Mapping[str, str],
    language: str = ENGLISH,
    chapter: str | None = None,
) -> Json:
    """The verdict on answers, question by question, as HTML; an empty answer is skipped.

    Raises
    ------
    LimitError
        An answer is longer than the limit.

    Examples
    --------
    >>> answer("2.1", 0, {"connection": "1,2,2 = 1/r"})["right"]
    True
    >>> answer("2.1", 0, {"connection": "2,1,2 = 1/r"})["questions"][0]["diagnosis"]
    'permuted'
    """
    typed = {name: text for name, text in answers.items() if text.strip()}
    for name, text in typed.items():
        if len(text) > PAGE.answer:
            raise LimitError(
                f"{name}: expected an answer of at most {PAGE.answer:,} characters, got "
                f"{len(text):,}. Shorten it: {PAGE.answer:,} are enough for every exercise."
            )
    verdict = exercises.load(number, seed, language, chapter).check(typed)
    states = TextTable("feedback", "states", language)
    return {
        "right": verdict.right,
        "points": verdict.points_text,
        "notes": list(verdict.notes),
        "questions": [
            {
                "name": one.name,
                "right": one.right,
                "state": one.state,
                "label": states[one.state],
                "read_as": one.read_as,
                "score": one.score,
                "message": _message(one.message),
                "copy": _copy_button([one.message], one.name, language),
                "diagnosis": one.diagnosis,
            }
            for one in verdict.questions
            if one.name in typed
        ],
    }

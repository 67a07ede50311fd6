"""Sheets: a chapter as a web page and a notebook for students, solutions apart for the teacher."""

from __future__ import annotations

import json
from collections.abc import Callable, Sequence
from html import escape
from os import PathLike
from pathlib import Path

from geomtorsion.errors import UnknownNameError
from geomtorsion.pictures.formula import FONT_SOURCE, mathml
from geomtorsion.pictures.latex import latex_name, latex_text
from geomtorsion.pictures.report import stylesheet
from geomtorsion.pictures.text import greek_name
from geomtorsion.support import checks
from geomtorsion.support.files import write_texts, written
from geomtorsion.teaching.exercises.answers import answer_text
from geomtorsion.teaching.exercises.cells import code_cell, markdown_cell, notebook
from geomtorsion.teaching.exercises.exercise import Exercise
from geomtorsion.teaching.exercises.limits import MOST
from geomtorsion.teaching.exercises.prose import html_of, text_of
from geomtorsion.teaching.exercises.question import Question, how_to_answer
from geomtorsion.teaching.exercises.registry import Own, chapters, load, names
from geomtorsion.teaching.exercises.verdict import TITLES, message_of
from geomtorsion.teaching.exercises.worker_pool import Json
from geomtorsion.teaching.texts import (
    ENGLISH,
    Language,
    Texts,
    argument_of,
    code_of,
    language_name,
    texts,
)


def notebook_of(title: str, exercises: Sequence[Exercise]) -> Json:
    """A notebook as JSON-ready data (nbformat 4.5): statements, space to work, checks, hints.

    Examples
    --------
    >>> from geomtorsion.teaching.exercises import load
    >>> found = notebook_of("1. Frames and anholonomy", [load("1.1")])
    >>> found["nbformat"], [cell["cell_type"] for cell in found["cells"]][:3]
    (4, ['markdown', 'code', 'markdown'])
    """
    cells = [
        markdown_cell(
            "title",
            f"# {title}\n\n{_text(exercises)('conventions')}",
        ),
        code_cell("imports", "import geomtorsion as gt"),
    ]
    for exercise in exercises:
        cells += _cells(exercise)
    return notebook(cells)


def _cells(exercise: Exercise) -> list[Json]:
    """Statement, questions, space to work, check, hints."""
    key = exercise.number.replace(".", "-")
    text = _text([exercise])
    hows = [text("answer", how=how_to_answer(question)) for question in exercise.questions]
    asked = [
        f"- `{question.name}`: {question.prompt}\n  *{how}.*"
        for question, how in zip(exercise.questions, hows, strict=True)
    ]
    heading = f"## {exercise.number} {exercise.title}"
    note = f"*{exercise.note}*\n\n" if exercise.note else ""
    stated = f"{heading}\n\n{note}{exercise.statement}\n\n" + "\n".join(asked)
    empty = "\n".join(f'    "{question.name}": "",' for question in exercise.questions)
    check = f"exercise = {load_line(exercise)}\nprint(exercise.check({{\n{empty}\n}}))"
    ask = f"{comment(text('more_hints'))}\nprint({load_line(exercise)}.hints[0])"
    return [
        markdown_cell(f"statement-{key}", stated),
        code_cell(f"work-{key}", comment(text("work"))),
        code_cell(f"check-{key}", check),
        code_cell(f"hint-{key}", ask),
    ]


def load_line(exercise: Exercise) -> str:
    """The expression of Python that loads an exercise.

    Examples
    --------
    >>> load_line(load("1.1", 3))
    'gt.exercises.load("1.1", seed=3)'
    """
    more = argument_of(exercise.language)
    # A notebook finds the folder of the chapter beside itself.
    more += f", chapter={Path(exercise.folder).name!r}" if exercise.folder else ""
    return f'gt.exercises.load("{exercise.number}", seed={exercise.seed}{more})'


def comment(text: str) -> str:
    """A text as one line of comment in Python.

    Examples
    --------
    >>> comment("Space for your work.")
    '# Space for your work.'
    """
    return f"# {' '.join(text.split())}"


def _text(exercises: Sequence[Exercise]) -> Texts:
    """Words around exercises, in their language."""
    return texts("sheets", "sheet", exercises[0].language)


_MORE = """
.question {
  border-left: 3px solid var(--accent); padding: 0.1rem 0 0.1rem 0.9rem; margin: 0.8rem 0;
}
.card h2 { margin: 0.2rem 0 0.7rem; border: 0; padding: 0; }
.answer { font-family: ui-monospace, monospace; overflow-wrap: anywhere; }
.wide { display: block; overflow-x: auto; overflow-y: hidden; padding: 0.3rem 0; }
main p, main li { overflow-x: auto; overflow-y: hidden; padding-bottom: 1px; }
main ul { list-style-position: inside; padding-left: 0.4rem; }
code { font-size: 0.95em; overflow-wrap: anywhere; }
.mistakes li { margin-bottom: 0.6rem; }
.steps li { margin-bottom: 0.5rem; } .steps p { margin: 0.1rem 0; }
.mistakes p { margin: 0.1rem 0; }
"""
Progress = Callable[[str], object]


def write_sheet(
    chapter: str,
    directory: str | PathLike[str],
    seed: int = 0,
    progress: Progress = lambda _: None,
    language: Language = ENGLISH,
    own: Own = None,
) -> tuple[Path, ...]:
    """Write a chapter: page, notebook and form for students, solutions in `teacher/`.

    Parameters
    ----------
    chapter
        its number, "1" to "7".
    directory
        created if it is missing.
    seed
        the variant.
    progress
        called with the name of each step before it begins.
    language
        "en", "de", or a folder with translated texts.
    own
        the folder of a teacher's chapter; see `load_folder`.

    Returns
    -------
    The files written.

    Raises
    ------
    UnknownNameError
        There is no such chapter or language.
    """
    language = language_name(language)
    titles = chapters(language, own)
    if not isinstance(chapter, str) or chapter not in titles:
        known = ", ".join(f"{number} ({name})" for number, name in titles.items())
        raise UnknownNameError(
            f"expected the number of a chapter, got {checks.shown(chapter)}. The chapters are "
            f"{known}."
        )
    title = titles[chapter]
    exercises = [
        load(number, seed, language, own)
        for number in names(own)
        if number.startswith(f"{chapter}.")
    ]
    # Refused before any exercise is solved.
    with written(directory, is_folder=True) as folder:
        pass
    stem = f"chapter{chapter}" + (f"-seed{seed}" if seed else "")
    heading = f"{chapter}. {title}"
    progress("sheet")
    cells = json.dumps(notebook_of(heading, exercises), indent=1, ensure_ascii=False)
    solved = []
    for exercise in exercises:
        progress(f"solving {exercise.number}")
        solved.append(_card(exercise, solution=True))
    files = {
        f"{stem}.html": page_of(heading, seed, [_card(e) for e in exercises], language),
        f"{stem}.ipynb": cells + "\n",
        f"{stem}-answers.toml": form_of(exercises, seed),
        f"teacher/{stem}-solutions.html": page_of(
            _text(exercises)("solutions", title=heading), seed, solved, language
        ),
    }
    return write_texts(folder, files)


def page_of(title: str, seed: int, cards: Sequence[str], language: str = ENGLISH) -> str:
    """A web page that needs no script and no network."""
    text = texts("sheets", "sheet", language)
    note = text("variant", seed=seed) if seed else text("paper")
    return (
        f'<!doctype html>\n<html lang="{escape(code_of(language))}"><head><meta charset="utf-8">'
        '<meta name="viewport" content="width=device-width, initial-scale=1">'
        '<meta http-equiv="Content-Security-Policy" '
        f"content=\"default-src 'none'; style-src 'unsafe-inline'; {FONT_SOURCE}\">"
        f"<title>{escape(title)}</title><style>{stylesheet()}{_MORE}</style></head>\n<body><header>"
        f'<p class="name">geomtorsion, exercises</p><h1>{escape(title)}</h1>'
        f'<p class="story">{escape(note)} {escape(text_of(text("conventions")))}</p></header>\n'
        f"<main>{''.join(cards)}</main></body></html>\n"
    )


def _card(exercise: Exercise, *, solution: bool = False) -> str:
    """One exercise; with folded hints, or with its solution and the mistakes to expect."""
    head = (
        f'<section class="card" id="e{exercise.number}"><div class="head"><h2>{exercise.number} '
        f"{escape(exercise.title)}</h2>"
        f'<span class="note">{escape(exercise.level_name)}</span></div>'
    )
    text = _text([exercise])
    note = f'<p class="note">{escape(exercise.note)}</p>' * bool(exercise.note)
    parts = [head, note, html_of(exercise.statement)]
    for question in exercise.questions:
        points = text(
            "points" if question.points > 1 else "point",
            question=question.name,
            points=question.points,
        )
        answer = text("answer", how=how_to_answer(question))
        parts.append(
            f'<div class="question"><p class="name">{escape(points)}</p>'
            f"{html_of(question.prompt)}"
            f'<div class="note">{html_of(answer)}</div>'
        )
        if solution:
            parts.append(_solution(question, text))
        parts.append("</div>")
    if solution:
        parts.append(_worked(exercise))
    else:
        steps = "".join(
            f"<details><summary>{escape(text('hint', number=k))}</summary>{html_of(hint)}</details>"
            for k, hint in enumerate(exercise.hints, 1)
        )
        parts.append(steps)
    return "".join(parts) + "</section>"


def _worked(exercise: Exercise) -> str:
    """The solution step by step."""
    text = _text([exercise])
    items = []
    for step in exercise.worked:
        note = html_of(text("step", question=step.question)) if step.question else ""
        marked = note.replace("<p>", '<p class="note">', 1)
        items.append(f"<li>{html_of(step.text)}{marked}</li>")
    return (
        f"<details open><summary>{escape(text('steps'))}</summary>"
        f'<ol class="steps">{"".join(items)}</ol></details>'
    )


def _solution(question: Question, text: Texts) -> str:
    """The solution, and the meaning of some wrong answers."""
    value = question.solution
    shown = _typeset(question)
    rows = []
    for mistake in question.mistakes[: MOST.mistakes]:
        message = mistake.message or message_of(mistake.code, question.remarks, question.language)
        typed = escape(_short(answer_text(question, mistake.value)))
        title = escape(TITLES.of(question.language)[mistake.code])
        rows.append(f"<li>{title}: <code>{typed}</code>{html_of(message)}</li>")
    table = (
        f"<details><summary>{escape(text('mistakes'))}</summary>"
        f'<ul class="mistakes">{"".join(rows)}</ul></details>'
        if rows
        else ""
    )
    return (
        f'<p class="answer"><strong>{escape(answer_text(question, value))}</strong></p>{shown}'
        f"{table}"
    )


def _typeset(question: Question) -> str:
    """The solution as mathematics."""
    if question.kind in ("choice", "number") or not question.solution:
        return ""
    pieces = []
    for key, value in sorted(question.solution.items()):
        formula = mathml(f"{_left_side(question, key)}{latex_text(value)}")
        pieces.append(f'<div class="scroll">{formula}</div>')
    return f'<div class="components two">{"".join(pieces)}</div>'


def _left_side(question: Question, key: tuple[int, ...]) -> str:
    """The text before the sign of equality, in LaTeX; empty for a single expression."""
    if question.unknowns:
        name, prime, more = question.unknowns[key[0]].partition("'")
        return f"{latex_name(name)}{prime}{more} = "
    if not key:
        return ""
    places = ", ".join(str(k + 1) for k in key)
    return rf"\text{{{greek_name(question.label or question.name)}}}_{{{places}}} = "


def _short(text: str) -> str:
    return text if len(text) <= 160 else text[:157] + "..."


def form_of(exercises: Sequence[Exercise], seed: int) -> str:
    """A file of answers to be filled in.

    Examples
    --------
    >>> print(form_of([load("1.1")], 7).splitlines()[-2])
    legs = ""
    """
    lines = ['student = ""', f"seed = {seed}", ""]
    for exercise in exercises:
        lines.append(f'[answers."{exercise.number}"]  # {exercise.title}')
        for question in exercise.questions:
            lines += [f"# {how_to_answer(question).replace('`', '')}", f'{question.name} = ""']
        lines.append("")
    return "\n".join(lines) + "\n"

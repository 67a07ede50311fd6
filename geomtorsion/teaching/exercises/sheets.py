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
from geomtorsion.teaching.exercises.prose import html_of
from geomtorsion.teaching.exercises.question import Question, how_to_answer
from geomtorsion.teaching.exercises.registry import CHAPTERS, load, names
from geomtorsion.teaching.exercises.verdict import TITLES, message_of
from geomtorsion.teaching.exercises.worker_pool import Json


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
            f"# {title}\n\nIndices are counted from 1; the first lower index of a connection is "
            "the direction of differentiation; $S = T/2$.",
        ),
        code_cell("imports", "import geomtorsion as gt"),
    ]
    for exercise in exercises:
        cells += _cells(exercise)
    return notebook(cells)


def _cells(exercise: Exercise) -> list[Json]:
    """Statement, questions, space to work, check, hints."""
    key = exercise.number.replace(".", "-")
    asked = [
        f"- `{question.name}`: {question.prompt}\n  *Answer: {how_to_answer(question)}.*"
        for question in exercise.questions
    ]
    heading = f"## {exercise.number} {exercise.title}"
    text = f"{heading}\n\n{exercise.statement}\n\n" + "\n".join(asked)
    empty = "\n".join(f'    "{question.name}": "",' for question in exercise.questions)
    check = (
        f'exercise = gt.exercises.load("{exercise.number}", seed={exercise.seed})\n'
        f"print(exercise.check({{\n{empty}\n}}))"
    )
    ask = (
        "# The next hints are hints[1], hints[2], ...\n"
        f'print(gt.exercises.load("{exercise.number}", seed={exercise.seed}).hints[0])'
    )
    return [
        markdown_cell(f"statement-{key}", text),
        code_cell(f"work-{key}", "# Space for your work."),
        code_cell(f"check-{key}", check),
        code_cell(f"hint-{key}", ask),
    ]


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

    Returns
    -------
    The files written.

    Raises
    ------
    UnknownNameError
        There is no such chapter.
    """
    titles = dict(CHAPTERS)
    if not isinstance(chapter, str) or chapter not in titles:
        chapters = ", ".join(f"{number} ({name})" for number, name in CHAPTERS)
        raise UnknownNameError(
            f"expected the number of a chapter, got {checks.shown(chapter)}. The chapters are "
            f"{chapters}."
        )
    title = titles[chapter]
    exercises = [load(number, seed) for number in names() if number.startswith(f"{chapter}.")]
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
        f"{stem}.html": page_of(heading, seed, [_card(e) for e in exercises]),
        f"{stem}.ipynb": cells + "\n",
        f"{stem}-answers.toml": form_of(exercises, seed),
        f"teacher/{stem}-solutions.html": page_of(f"{heading}: solutions", seed, solved),
    }
    return write_texts(folder, files)


def page_of(title: str, seed: int, cards: Sequence[str]) -> str:
    """A web page that needs no script and no network."""
    note = f"Variant {seed}." if seed else "The variant of the paper."
    return (
        '<!doctype html>\n<html lang="en"><head><meta charset="utf-8">'
        '<meta name="viewport" content="width=device-width, initial-scale=1">'
        '<meta http-equiv="Content-Security-Policy" '
        f"content=\"default-src 'none'; style-src 'unsafe-inline'; {FONT_SOURCE}\">"
        f"<title>{escape(title)}</title><style>{stylesheet()}{_MORE}</style></head>\n<body><header>"
        f'<p class="name">geomtorsion, exercises</p><h1>{escape(title)}</h1>'
        f'<p class="story">{note} Indices are counted from 1; the first lower index of a '
        "connection is the direction of differentiation; S = T/2.</p></header>\n"
        f"<main>{''.join(cards)}</main></body></html>\n"
    )


def _card(exercise: Exercise, *, solution: bool = False) -> str:
    """One exercise; with folded hints, or with its solution and the mistakes to expect."""
    head = (
        f'<section class="card" id="e{exercise.number}"><div class="head"><h2>{exercise.number} '
        f'{escape(exercise.title)}</h2><span class="note">{exercise.level}</span></div>'
    )
    parts = [head, html_of(exercise.statement)]
    for question in exercise.questions:
        parts.append(
            f'<div class="question"><p class="name">{question.name} '
            f"({question.points} point{'s' * (question.points > 1)})</p>"
            f"{html_of(question.prompt)}"
            f'<div class="note">{html_of("Answer: " + how_to_answer(question))}</div>'
        )
        if solution:
            parts.append(_solution(question))
        parts.append("</div>")
    if solution:
        parts.append(_worked(exercise))
    else:
        steps = "".join(
            f"<details><summary>Hint {k}</summary>{html_of(hint)}</details>"
            for k, hint in enumerate(exercise.hints, 1)
        )
        parts.append(steps)
    return "".join(parts) + "</section>"


def _worked(exercise: Exercise) -> str:
    """The solution step by step."""
    items = "".join(
        f"<li>{html_of(step.text)}"
        + (
            f'<p class="note">This step answers <code>{step.question}</code>.</p>'
            if step.question
            else ""
        )
        + "</li>"
        for step in exercise.worked
    )
    return f'<details open><summary>Step by step</summary><ol class="steps">{items}</ol></details>'


def _solution(question: Question) -> str:
    """The solution, and the meaning of some wrong answers."""
    value = question.solution
    shown = _typeset(question)
    rows = []
    for mistake in question.mistakes[: MOST.mistakes]:
        text = mistake.message or message_of(mistake.code, question.remarks)
        typed = escape(_short(answer_text(question, mistake.value)))
        rows.append(f"<li>{escape(TITLES[mistake.code])}: <code>{typed}</code>{html_of(text)}</li>")
    table = (
        "<details><summary>Mistakes that are recognised</summary>"
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

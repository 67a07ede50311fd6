"""Notebook: a chapter as a Jupyter notebook for students."""

from __future__ import annotations

from collections.abc import Sequence

from geomtorsion.exercises.exercise import Exercise
from geomtorsion.exercises.prompts import how_to_answer
from geomtorsion.exercises.worker_pool import Json


def notebook_of(title: str, exercises: Sequence[Exercise]) -> Json:
    """A notebook as JSON-ready data (nbformat 4.5): statements, room to work, checks, hints.

    Examples
    --------
    >>> from geomtorsion.exercises import load
    >>> notebook = notebook_of("1. Frames and anholonomy", [load("1.1")])
    >>> notebook["nbformat"], [cell["cell_type"] for cell in notebook["cells"]][:3]
    (4, ['markdown', 'code', 'markdown'])
    """
    cells = [
        _markdown("title", f"# {title}\n\nIndices are counted from 1; the first lower index of a "
                  "connection is the direction of differentiation; $S = T/2$."),
        _code("imports", "import geomtorsion as gt"),
    ]  # fmt: skip
    for exercise in exercises:
        cells += _cells(exercise)
    return {
        "cells": cells,
        "metadata": {
            "kernelspec": {
                "display_name": "Python 3",
                "language": "python",
                "name": "python3",
            },
            "language_info": {"name": "python"},
        },
        "nbformat": 4,
        "nbformat_minor": 5,
    }


def _cells(exercise: Exercise) -> list[Json]:
    """Statement, questions, room to work, check, hints."""
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
        "# One hint after the other: hints[0], hints[1], ...\n"
        f'print(gt.exercises.load("{exercise.number}", seed={exercise.seed}).hints[0])'
    )
    return [
        _markdown(f"statement-{key}", text),
        _code(f"work-{key}", "# Room to work."),
        _code(f"check-{key}", check),
        _code(f"hint-{key}", ask),
    ]


def _markdown(key: str, text: str) -> Json:
    return {"cell_type": "markdown", "id": key, "metadata": {}, "source": _lines(text)}


def _code(key: str, text: str) -> Json:
    return {
        "cell_type": "code",
        "execution_count": None,
        "id": key,
        "metadata": {},
        "outputs": [],
        "source": _lines(text),
    }


def _lines(text: str) -> list[str]:
    return text.splitlines(keepends=True)

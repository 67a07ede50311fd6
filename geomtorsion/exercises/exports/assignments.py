"""assignments: chapters as notebooks for teachers, with solutions and hidden tests.

What stands in them is the same for all systems; how a system finds solutions and tests is not.
"""

from __future__ import annotations

import json
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass

from geomtorsion.exercises.answers import answer_text
from geomtorsion.exercises.cells import code_cell, markdown_cell, notebook
from geomtorsion.exercises.exercise import Exercise
from geomtorsion.exercises.exports.tasks import Task
from geomtorsion.exercises.question import Question, how_to_answer
from geomtorsion.exercises.worker_pool import Json


@dataclass(frozen=True)
class Asked:
    """A question of an exercise, as a notebook asks it."""

    exercise: Exercise
    question: Question

    @property
    def key(self) -> str:
        """What ends the ids of its cells."""
        return f"{self.exercise.number.replace('.', '-')}-{self.question.name}"

    @property
    def name(self) -> str:
        """The variable that holds the answer."""
        return f"{self.question.name}_{self.exercise.number.replace('.', '_')}"

    @property
    def prompt(self) -> str:
        """What is asked and how it is answered: Markdown with LaTeX."""
        how = how_to_answer(self.question)
        return f"{self.question.prompt}\n\n*Answer: `{self.name} =` {how}, in quotes.*"

    @property
    def solved(self) -> str:
        """The line of Python with the solution."""
        answer = answer_text(self.question, self.question.solution)
        return f"{self.name} = {json.dumps(answer, ensure_ascii=False)}"

    @property
    def graded(self) -> str:
        """Lines of Python that grade the answer; what is said about it is in `verdict`."""
        name, exercise = self.question.name, self.exercise
        return (
            f'answers = {{"{name}": {self.name}}}\n'
            f'verdict = gt.exercises.check("{exercise.number}", answers, seed={exercise.seed})\n'
            f'verdict = verdict["{name}"]\n'
        )


@dataclass(frozen=True)
class Marking:
    """How a system tells cells apart.

    locked: id -> metadata of a cell that students leave alone. opening: name of the assignment ->
    cells before all others. question: a question and the cell that asks it -> that cell, the one
    for the answer, and what grades it.
    """

    locked: Callable[[str], Json]
    opening: Callable[[str], Sequence[Json]]
    question: Callable[[Asked, Json], Iterator[Json]]


def notebooks(tasks: Sequence[Task], marking: Marking) -> dict[str, str]:
    """Name -> text of a notebook: one for each chapter and variant.

    Examples
    --------
    >>> from geomtorsion.exercises.exports.tasks import tasks
    >>> bare = Marking(lambda key: {}, lambda name: (), lambda asked, prompt: iter([prompt]))
    >>> list(notebooks(tasks(["3.1", "3.2"], [0, 5]), bare))
    ['chapter3', 'chapter3-seed5']
    """
    chapters: dict[str, list[Exercise]] = {}
    titles: dict[str, str] = {}
    for task in tasks:
        for exercise in task.variants:
            name = f"chapter{task.number.partition('.')[0]}"
            name += f"-seed{exercise.seed}" if exercise.seed else ""
            chapters.setdefault(name, []).append(exercise)
            titles[name] = task.chapter
    found = {}
    for name, exercises in chapters.items():
        cells = [*marking.opening(name), *_cells(titles[name], exercises, marking)]
        found[name] = json.dumps(notebook(cells), indent=1, ensure_ascii=False) + "\n"
    return found


def _cells(title: str, exercises: Sequence[Exercise], marking: Marking) -> Iterator[Json]:
    """Title, import, and each exercise with its questions."""

    def text(key: str, content: str) -> Json:
        return markdown_cell(key, content, marking.locked(key))

    yield text(
        "title",
        f'# {title}\n\nEach answer is a text in quotes, such as `"2*sin(r)"`. Indices are counted '
        "from 1; the first lower index of a connection is the direction of differentiation; "
        "$S = T/2$.",
    )
    yield code_cell("imports", "import geomtorsion as gt", marking.locked("imports"))
    for exercise in exercises:
        key = exercise.number.replace(".", "-")
        heading = f"## {exercise.number} {exercise.title}"
        yield text(f"statement-{key}", f"{heading}\n\n{exercise.statement}")
        for question in exercise.questions:
            asked = Asked(exercise, question)
            yield from marking.question(asked, text(f"asked-{asked.key}", asked.prompt))

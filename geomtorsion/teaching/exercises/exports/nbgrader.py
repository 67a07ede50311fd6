"""nbgrader: a course of assignments, which generate_assignment and autograde take."""

from __future__ import annotations

import json
from collections.abc import Iterator, Sequence

from geomtorsion.teaching.exercises.answers import answer_text
from geomtorsion.teaching.exercises.cells import code_cell, markdown_cell, notebook
from geomtorsion.teaching.exercises.exercise import Exercise
from geomtorsion.teaching.exercises.exports.tasks import Task
from geomtorsion.teaching.exercises.question import Question, how_to_answer
from geomtorsion.teaching.exercises.worker_pool import Json
from geomtorsion.teaching.texts import argument_of, texts

_CONFIG = """\
c = get_config()
c.CourseDirectory.course_id = "geomtorsion"
"""

# Begins the message about an answer that could not be read.
UNREAD = "Not graded yet: this answer could not be read, so your teacher sets the points."


def course_files(tasks: Sequence[Task]) -> dict[str, str]:
    """Path -> text: nbgrader_config.py, and a notebook for each chapter and variant in source/.

    In the teacher's version the solution is between BEGIN SOLUTION and END SOLUTION, and a test
    that grades with the library between BEGIN HIDDEN TESTS and END HIDDEN TESTS; `nbgrader
    generate_assignment` removes both. The test returns the points earned and prints the message
    for a recognised mistake. nbgrader has no mark for an answer that could not be read: it gives
    0 points, and the message asks the teacher to read the answer.

    Examples
    --------
    >>> from geomtorsion.teaching.exercises.exports.tasks import tasks
    >>> list(course_files(tasks(["3.1", "3.2"], [0])))
    ['nbgrader_config.py', 'source/chapter3/chapter3.ipynb']
    """
    chapters: dict[str, list[Exercise]] = {}
    titles: dict[str, str] = {}
    for task in tasks:
        for exercise in task.variants:
            name = f"chapter{task.number.partition('.')[0]}"
            name += f"-seed{exercise.seed}" if exercise.seed else ""
            chapters.setdefault(name, []).append(exercise)
            titles[name] = task.chapter
    files = {"nbgrader_config.py": _CONFIG}
    for name, exercises in chapters.items():
        document = notebook(list(_cells(titles[name], exercises)))
        text = json.dumps(document, indent=1, ensure_ascii=False) + "\n"
        files[f"source/{name}/{name}.ipynb"] = text
    return files


def _cells(title: str, exercises: Sequence[Exercise]) -> Iterator[Json]:
    """Title, import, and each exercise with its questions."""
    language = exercises[0].language
    conventions = texts("sheets", "sheet", language)("conventions")
    about = texts("sheets", "nbgrader", language)("about", conventions=conventions)
    yield _text(
        "title",
        f"# {title}\n\n{about}",
    )
    yield code_cell("imports", "import geomtorsion as gt", _marked("imports", locked=True))
    for exercise in exercises:
        key = exercise.number.replace(".", "-")
        heading = f"## {exercise.number} {exercise.title}"
        note = f"*{exercise.note}*\n\n" if exercise.note else ""
        yield _text(f"statement-{key}", f"{heading}\n\n{note}{exercise.statement}")
        for question in exercise.questions:
            yield from _question(exercise, question)


def _question(exercise: Exercise, question: Question) -> Iterator[Json]:
    """The prompt, the cell for the answer, and the test that grades it."""
    key = f"{exercise.number.replace('.', '-')}-{question.name}"
    variable = f"{question.name}_{exercise.number.replace('.', '_')}"
    text = texts("sheets", "nbgrader", exercise.language)
    how = text("answer", variable=variable, how=how_to_answer(question))
    yield _text(f"asked-{key}", f"{question.prompt}\n\n*{how}*")
    more = argument_of(exercise.language)
    # Students never see hidden tests, which run on the machine of the teacher.
    more += f", chapter={exercise.folder!r}" if exercise.folder else ""
    arguments = f'"{exercise.number}", answers, seed={exercise.seed}{more}'
    answer = json.dumps(answer_text(question, question.solution), ensure_ascii=False)
    yield code_cell(
        f"answer-{key}",
        f"### BEGIN SOLUTION\n{variable} = {answer}\n### END SOLUTION",
        _marked(f"answer-{key}", solution=True),
    )
    yield code_cell(
        f"test-{key}",
        f"# {variable} is checked when the notebook is graded.\n"
        "### BEGIN HIDDEN TESTS\n"
        f'answers = {{"{question.name}": {variable}}}\n'
        f"verdict = gt.exercises.check({arguments})\n"
        f'verdict = verdict["{question.name}"]\n'
        f'assert verdict.was_read, "{UNREAD} " + verdict.message\n'
        "assert verdict.score > 0, verdict.message\n"
        "print(verdict.message)\n"
        "verdict.points * verdict.score\n"
        "### END HIDDEN TESTS",
        _marked(f"test-{key}", grade=True, locked=True, points=question.points),
    )


def _text(key: str, content: str) -> Json:
    """A cell of text that students do not change."""
    return markdown_cell(key, content, _marked(key, locked=True))


def _marked(
    key: str,
    *,
    grade: bool = False,
    solution: bool = False,
    locked: bool = False,
    points: int | None = None,
) -> Json:
    """Metadata of nbgrader, version 3."""
    marks = {
        "grade": grade,
        "grade_id": key,
        "locked": locked,
        "schema_version": 3,
        "solution": solution,
        "task": False,
    }
    return {"nbgrader": marks | ({} if points is None else {"points": points})}

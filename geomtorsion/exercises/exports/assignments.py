"""assignments: chapters as assignments of nbgrader, notebooks with solutions and hidden tests."""

from __future__ import annotations

import json
from collections.abc import Iterator, Sequence

from geomtorsion.exercises.answers import answer_text
from geomtorsion.exercises.cells import code_cell, markdown_cell, notebook
from geomtorsion.exercises.exercise import Exercise
from geomtorsion.exercises.exports.tasks import Task
from geomtorsion.exercises.question import Question, how_to_answer
from geomtorsion.exercises.worker_pool import Json

_CONFIG = """\
c = get_config()
c.CourseDirectory.course_id = "geomtorsion"
"""


def assignment_files(tasks: Sequence[Task]) -> dict[str, str]:
    """Path -> text: nbgrader_config.py, and a notebook for each chapter and variant in source/.

    In the teacher's version a solution stands between BEGIN SOLUTION and END SOLUTION, and a test
    that grades with the library between BEGIN HIDDEN TESTS and END HIDDEN TESTS; `nbgrader
    generate_assignment` takes both out. A test gives the share of the points that was earned, and
    says what the likely mistake is.

    Examples
    --------
    >>> from geomtorsion.exercises.exports.tasks import tasks
    >>> list(assignment_files(tasks(["3.1", "3.2"], [0])))
    ['nbgrader_config.py', 'source/chapter3/chapter3.ipynb']
    """
    files = {"nbgrader_config.py": _CONFIG}
    chapters: dict[str, list[Exercise]] = {}
    titles: dict[str, str] = {}
    for task in tasks:
        for exercise in task.variants:
            name = f"chapter{task.number.partition('.')[0]}"
            name += f"-seed{exercise.seed}" if exercise.seed else ""
            chapters.setdefault(name, []).append(exercise)
            titles[name] = task.chapter
    for name, exercises in chapters.items():
        found = notebook(list(_cells(titles[name], exercises)))
        text = json.dumps(found, indent=1, ensure_ascii=False)
        files[f"source/{name}/{name}.ipynb"] = text + "\n"
    return files


def _cells(title: str, exercises: Sequence[Exercise]) -> Iterator[Json]:
    """Title, import, and each exercise with a field and a test for each question."""
    yield markdown_cell(
        "title",
        f'# {title}\n\nEach answer is a text in quotes, such as `"2*sin(r)"`. Indices are counted '
        "from 1; the first lower index of a connection is the direction of differentiation; "
        "$S = T/2$.",
        _locked("title"),
    )
    yield code_cell("imports", "import geomtorsion as gt", _locked("imports"))
    for exercise in exercises:
        key = exercise.number.replace(".", "-")
        heading = f"## {exercise.number} {exercise.title}"
        yield markdown_cell(
            f"statement-{key}", f"{heading}\n\n{exercise.statement}", _locked(f"statement-{key}")
        )
        for question in exercise.questions:
            yield from _asked(exercise, question)


def _asked(exercise: Exercise, question: Question) -> Iterator[Json]:
    """What is asked, the cell for the answer, and the test that grades it."""
    key = f"{exercise.number.replace('.', '-')}-{question.name}"
    name = f"{question.name}_{exercise.number.replace('.', '_')}"
    asked = f"{question.prompt}\n\n*Answer: `{name} =` {how_to_answer(question)}, in quotes.*"
    yield markdown_cell(f"asked-{key}", asked, _locked(f"asked-{key}"))
    answer = json.dumps(answer_text(question, question.solution), ensure_ascii=False)
    yield code_cell(
        f"answer-{key}",
        f"### BEGIN SOLUTION\n{name} = {answer}\n### END SOLUTION",
        _nbgrader(f"answer-{key}", solution=True),
    )
    yield code_cell(
        f"test-{key}",
        f"# {name} is checked when the notebook is graded.\n"
        "### BEGIN HIDDEN TESTS\n"
        f'answers = {{"{question.name}": {name}}}\n'
        f'verdict = gt.exercises.check("{exercise.number}", answers, seed={exercise.seed})\n'
        f'verdict = verdict["{question.name}"]\n'
        "assert verdict.score > 0, verdict.message\n"
        "print(verdict.message)\n"
        "verdict.points * verdict.score\n"
        "### END HIDDEN TESTS",
        _nbgrader(f"test-{key}", grade=True, locked=True, points=question.points),
    )


def _locked(key: str) -> Json:
    """Metadata of a cell that students do not change."""
    return _nbgrader(key, locked=True)


def _nbgrader(
    key: str,
    *,
    grade: bool = False,
    solution: bool = False,
    locked: bool = False,
    points: int | None = None,
) -> Json:
    """Metadata of nbgrader, version 3."""
    found = {
        "grade": grade,
        "grade_id": key,
        "locked": locked,
        "schema_version": 3,
        "solution": solution,
        "task": False,
    }
    return {"nbgrader": found | ({} if points is None else {"points": points})}

"""nbgrader: a course of assignments, which generate_assignment and autograde take."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from geomtorsion.exercises.cells import code_cell
from geomtorsion.exercises.exports.assignments import Asked, Marking, notebooks
from geomtorsion.exercises.exports.tasks import Task
from geomtorsion.exercises.worker_pool import Json

_CONFIG = """\
c = get_config()
c.CourseDirectory.course_id = "geomtorsion"
"""


def course_files(tasks: Sequence[Task]) -> dict[str, str]:
    """Path -> text: nbgrader_config.py, and a notebook for each chapter and variant in source/.

    In the teacher's version a solution stands between BEGIN SOLUTION and END SOLUTION, and a test
    that grades with the library between BEGIN HIDDEN TESTS and END HIDDEN TESTS; `nbgrader
    generate_assignment` takes both out. A test gives the share of the points that was earned, and
    says what the likely mistake is.

    Examples
    --------
    >>> from geomtorsion.exercises.exports.tasks import tasks
    >>> list(course_files(tasks(["3.1", "3.2"], [0])))
    ['nbgrader_config.py', 'source/chapter3/chapter3.ipynb']
    """
    written = notebooks(tasks, Marking(_locked, lambda _: (), _question))
    files = {f"source/{name}/{name}.ipynb": text for name, text in written.items()}
    return {"nbgrader_config.py": _CONFIG, **files}


def _question(asked: Asked, prompt: Json) -> Iterator[Json]:
    """The prompt, the cell for the answer, and the test that grades it."""
    yield prompt
    yield code_cell(
        f"answer-{asked.key}",
        f"### BEGIN SOLUTION\n{asked.solved}\n### END SOLUTION",
        _marked(f"answer-{asked.key}", solution=True),
    )
    yield code_cell(
        f"test-{asked.key}",
        f"# {asked.name} is checked when the notebook is graded.\n"
        f"### BEGIN HIDDEN TESTS\n{asked.graded}"
        "assert verdict.score > 0, verdict.message\n"
        "print(verdict.message)\n"
        "verdict.points * verdict.score\n"
        "### END HIDDEN TESTS",
        _marked(f"test-{asked.key}", grade=True, locked=True, points=asked.question.points),
    )


def _locked(key: str) -> Json:
    """Metadata of a cell that students do not change."""
    return _marked(key, locked=True)


def _marked(
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

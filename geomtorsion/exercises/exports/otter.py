"""otter: notebooks for otter assign, which makes the students' ones and what grades them."""

from __future__ import annotations

import json
from collections.abc import Iterator, Sequence
from textwrap import indent

from geomtorsion.exercises.cells import code_cell, raw_cell
from geomtorsion.exercises.exports.assignments import Asked, Marking, notebooks
from geomtorsion.exercises.exports.tasks import Task
from geomtorsion.exercises.worker_pool import Json


def assign_files(tasks: Sequence[Task]) -> dict[str, str]:
    """Path -> text: a notebook for each chapter and variant, in the format of Otter Assign.

    Raw cells say where a question, its solution and its tests begin and end; `otter assign` takes
    solutions and tests out. A test of Otter passes or fails, so that a question with m components
    has m of them, of which as many pass as the share of the points that was earned holds m-ths.

    Examples
    --------
    >>> from geomtorsion.exercises.exports.tasks import tasks
    >>> list(assign_files(tasks(["3.1", "3.2"], [0])))
    ['chapter3.ipynb']
    """
    written = notebooks(tasks, Marking(lambda _: {}, _opening, _question))
    return {f"{name}.ipynb": text for name, text in written.items()}


def _opening(name: str) -> Sequence[Json]:
    """What Otter is told of the assignment: all its tests are hidden, so that none run before."""
    config = {
        "name": name,
        "requirements": ["geomtorsion"],
        "init_cell": False,
        "export_cell": False,
        "tests": {"ok_format": False},
    }
    return [_raw("config", "ASSIGNMENT CONFIG", config)]


def _question(asked: Asked, prompt: Json) -> Iterator[Json]:
    """The prompt, the cell for the answer, and the tests that grade it, each in its block."""
    points = asked.question.points
    config = {"name": asked.name, "points": points, "check_cell": False}
    yield _raw(f"begin-{asked.key}", "BEGIN QUESTION", config)
    yield prompt
    yield _raw(f"solution-{asked.key}", "BEGIN SOLUTION")
    yield code_cell(f"answer-{asked.key}", f"{asked.solved}  # SOLUTION")
    yield _raw(f"solved-{asked.key}", "END SOLUTION")
    yield _raw(f"tests-{asked.key}", "BEGIN TESTS")
    parts = max(len(asked.question.solution), 1)
    for part in range(1, parts + 1):
        yield code_cell(
            f"test-{asked.key}-{part}",
            f"# HIDDEN\ndef test_{part}({asked.name}):\n"
            + indent(
                f"import geomtorsion as gt\n{asked.graded}"
                f"assert round(verdict.score * {parts}, 2) >= {part}, verdict.message",
                "    ",
            ),
        )
    yield _raw(f"tested-{asked.key}", "END TESTS")
    yield _raw(f"end-{asked.key}", "END QUESTION")


def _raw(key: str, mark: str, config: Json | None = None) -> Json:
    """A raw cell with a mark and what is said of it: YAML, of which JSON is a part."""
    lines = [f"{name}: {json.dumps(value)}" for name, value in (config or {}).items()]
    return raw_cell(key, "\n".join([f"# {mark}", *lines]))

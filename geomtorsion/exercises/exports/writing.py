"""writing: exercises as files in one of the formats that teachers' systems take."""

from __future__ import annotations

import io
import zipfile
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from os import PathLike
from pathlib import Path
from types import MappingProxyType

from geomtorsion import checks
from geomtorsion.errors import ArgumentError
from geomtorsion.exercises.exports.nbgrader import course_files
from geomtorsion.exercises.exports.otter import assign_files
from geomtorsion.exercises.exports.prairielearn import question_files
from geomtorsion.exercises.exports.qti import DECIDED, item_files
from geomtorsion.exercises.exports.stack import stack_quiz
from geomtorsion.exercises.exports.tasks import Task, tasks
from geomtorsion.files import written

Files = dict[str, str | bytes]
Progress = Callable[[str], object]


@dataclass(frozen=True)
class Export:
    """What was exported.

    files: those written. notes: what to do with them, and what the system cannot grade.
    """

    files: tuple[Path, ...]
    notes: tuple[str, ...]


def _stack(found: Sequence[Task]) -> tuple[Files, str]:
    note = (
        "Import geomtorsion-stack.xml into a question bank of Moodle as Moodle XML. Seeds are "
        "deployed systematically: STACK must know stack_seed. Each part is right or wrong as a "
        "whole."
    )
    return {"geomtorsion-stack.xml": stack_quiz(found)}, note


def _prairielearn(found: Sequence[Task]) -> tuple[Files, str]:
    note = (
        "Copy the folder geomtorsion into questions/ of the course, and install the library where "
        "server.py finds it: pip install --target serverFilesCourse geomtorsion."
    )
    files: Files = {
        f"geomtorsion/{task.slug}/{name}": text
        for task in found
        for name, text in question_files(task).items()
    }
    return files, note


def _nbgrader(found: Sequence[Task]) -> tuple[Files, str]:
    note = (
        "The folder is a course of nbgrader: nbgrader generate_assignment makes what students get, "
        "nbgrader autograde grades it. Both need geomtorsion in their kernel."
    )
    return {**course_files(found)}, note


def _otter(found: Sequence[Task]) -> tuple[Files, str]:
    files: Files = {**assign_files(found)}
    first = next(iter(files)).removesuffix(".ipynb")
    note = (
        f"otter assign {first}.ipynb {first} makes of a notebook what students get, in "
        f"{first}/student, and in {first}/autograder the ZIP file that grades it: for Gradescope, "
        "otter grade or otter run. Where it grades, geomtorsion has to be installed."
    )
    return files, note


def _qti(found: Sequence[Task]) -> tuple[Files, str]:
    files: Files = {**item_files(found)}
    packed = io.BytesIO()
    with zipfile.ZipFile(packed, "w", zipfile.ZIP_DEFLATED) as package:
        for name, text in files.items():
            # With the first date that the format knows, equal exports have equal bits.
            package.writestr(zipfile.ZipInfo(name), text, zipfile.ZIP_DEFLATED)
    files["geomtorsion-qti21.zip"] = packed.getvalue()
    asked = [question for task in found for exercise in task.variants
             for question in exercise.questions]  # fmt: skip
    decided = sum(question.kind in DECIDED for question in asked)
    note = (
        f"QTI 2.1 grades {decided} of {len(asked)} questions in full: numbers and choices. Of the "
        f"other {len(asked) - decided}, formulas, it knows the spelling of the solution and of the "
        "recognised mistakes; what is spelled otherwise is left to a person, or to geomtorsion "
        "exercises check."
    )
    return files, note


@dataclass(frozen=True)
class Format:
    """A format: what makes the files, and what they need.

    seeds: the variants if none are asked for; several where the system gives each student one.
    worked: whether the files hold the solutions step by step, which take their time.
    """

    make: Callable[[Sequence[Task]], tuple[Files, str]]
    seeds: tuple[int, ...]
    worked: bool = False


FORMATS: Mapping[str, Format] = MappingProxyType(
    {
        "stack": Format(_stack, (0, 1, 2), worked=True),
        "prairielearn": Format(_prairielearn, (0, 1, 2)),
        "nbgrader": Format(_nbgrader, (0,)),
        "otter": Format(_otter, (0,)),
        "qti": Format(_qti, (0,)),
    }
)


def export(
    to: str,
    directory: str | PathLike[str],
    numbers: Sequence[str] | None = None,
    seeds: Sequence[int] | None = None,
    progress: Progress = lambda _: None,
) -> Export:
    """Write exercises in a format that teachers' systems take.

    Parameters
    ----------
    to
        "stack" (Moodle XML), "prairielearn" (question folders), "nbgrader" (a course with
        notebooks), "otter" (notebooks for Otter Assign) or "qti" (a content package of QTI 2.1,
        as folder and as ZIP file).
    directory
        made if it is missing; files in it that have the same names are replaced.
    numbers
        of the exercises, such as ["3.1", "3.2"]; all if None.
    seeds
        the variants; None: 0, 1 and 2 for stack and prairielearn, 0 for the others.
    progress
        called with the number of each exercise before it is solved.

    Returns
    -------
    The files that were written, and what to do with them.

    Raises
    ------
    ArgumentError
        There is no such format; an exercise or a seed is given twice.
    UnknownNameError
        There is no such exercise, or no such seed.

    Examples
    --------
    >>> from tempfile import TemporaryDirectory
    >>> with TemporaryDirectory() as folder:
    ...     found = export("nbgrader", folder, ["3.2"])
    ...     [path.name for path in found.files]
    ['nbgrader_config.py', 'chapter3.ipynb']
    """
    directory = checks.file_name(directory, "directory")
    chosen = FORMATS[checks.choice(to, tuple(FORMATS), "to", ArgumentError)]
    found = tasks(numbers, chosen.seeds if seeds is None else seeds)
    for task in found:
        progress(task.number)
        # Kept by the exercise: the files are written at once afterwards.
        for exercise in task.variants:
            _ = exercise.solution(), exercise.worked if chosen.worked else ()
    files, note = chosen.make(found)
    paths = []
    with written(directory, is_folder=True) as folder:
        for name, content in files.items():
            path = folder / name
            path.parent.mkdir(parents=True, exist_ok=True)
            path.write_bytes(content.encode() if isinstance(content, str) else content)
            paths.append(path)
    return Export(tuple(paths), (note,))

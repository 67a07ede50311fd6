"""writing: exercises as files in one of the formats that teachers' systems take."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from os import PathLike
from pathlib import Path
from types import MappingProxyType

from geomtorsion.errors import ArgumentError
from geomtorsion.support import checks
from geomtorsion.support.files import write_texts
from geomtorsion.teaching.exercises.exports.nbgrader import UNREAD, course_files
from geomtorsion.teaching.exercises.exports.stack import stack_quiz
from geomtorsion.teaching.exercises.exports.tasks import Task, tasks
from geomtorsion.teaching.exercises.registry import Own
from geomtorsion.teaching.texts import ENGLISH, Language

Files = dict[str, str]
Progress = Callable[[str], object]


@dataclass(frozen=True)
class Export:
    """The result of an export.

    files: the written files. notes: what to do with them, and what the system cannot grade.
    """

    files: tuple[Path, ...]
    notes: tuple[str, ...]


def _stack(found: Sequence[Task]) -> tuple[Files, str]:
    note = (
        "Import geomtorsion-stack.xml into a question bank of Moodle as Moodle XML. The variants "
        "use stack_seed, which your version of STACK must support. Each part is graded as a whole: "
        "single components earn no points."
    )
    return {"geomtorsion-stack.xml": stack_quiz(found)}, note


def _nbgrader(found: Sequence[Task]) -> tuple[Files, str]:
    note = (
        "The folder is an nbgrader course. nbgrader generate_assignment writes the notebooks for "
        "students, and nbgrader autograde grades them. Both need geomtorsion in their kernel. "
        "nbgrader gives 0 points to an answer that cannot be read, and the message below it begins "
        f'with "{UNREAD.partition(":")[0]}". Read it, and set its points in formgrader.'
    )
    return course_files(found), note


@dataclass(frozen=True)
class Format:
    """A format: the function that writes its files, and their requirements.

    seeds: default variants; several if the system gives each student one.
    worked: whether the files contain worked solutions, which take time to compute.
    """

    make: Callable[[Sequence[Task]], tuple[Files, str]]
    seeds: tuple[int, ...]
    worked: bool = False


FORMATS: Mapping[str, Format] = MappingProxyType(
    {
        "stack": Format(_stack, (0, 1, 2), worked=True),
        "nbgrader": Format(_nbgrader, (0,)),
    }
)


def export(
    to: str,
    directory: str | PathLike[str],
    numbers: Sequence[str] | None = None,
    seeds: Sequence[int] | None = None,
    progress: Progress = lambda _: None,
    language: Language = ENGLISH,
    chapter: Own = None,
) -> Export:
    """Write exercises in a format that teachers' systems import.

    Parameters
    ----------
    to
        "stack" (Moodle XML) or "nbgrader" (a course with notebooks).
    directory
        created if it is missing; files in it with the same names are replaced.
    numbers
        of the exercises, such as ["3.1", "3.2"]; None: all, or with a chapter its exercises.
    seeds
        the variants; None: 0, 1 and 2 for stack, 0 for nbgrader.
    progress
        called with the number of each exercise before it is solved.
    language
        "en", "de", or a folder with translated texts.
    chapter
        the folder of a teacher's chapter; see `load_folder`. The tests of nbgrader contain
        its path, so that autograde runs on this machine.

    Returns
    -------
    The written files, and what to do with them.

    Raises
    ------
    ArgumentError
        There is no such format; an exercise or a seed is given twice.
    UnknownNameError
        There is no such exercise, seed or language.

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
    task_list = tasks(numbers, chosen.seeds if seeds is None else seeds, language, chapter)
    for task in task_list:
        progress(task.number)
        # The exercise caches them; the files are written immediately afterwards.
        for exercise in task.variants:
            _ = exercise.solution(), exercise.worked if chosen.worked else ()
    files, note = chosen.make(task_list)
    return Export(write_texts(directory, files), (note,))

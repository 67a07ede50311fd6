"""Exercises: problems that check their answers and name the likely mistake."""

from typing import TYPE_CHECKING

from geomtorsion.teaching.exercises.chapter_folder import Chapter, load_folder
from geomtorsion.teaching.exercises.exercise import Exercise
from geomtorsion.teaching.exercises.exports import export
from geomtorsion.teaching.exercises.question import Question
from geomtorsion.teaching.exercises.registry import chapters, check, load, names, titles
from geomtorsion.teaching.exercises.verdict import QuestionVerdict, Verdict

__all__ = [
    "CHAPTERS",
    "Chapter",
    "Exercise",
    "Question",
    "QuestionVerdict",
    "Verdict",
    "chapters",
    "check",
    "export",
    "load",
    "load_folder",
    "names",
    "titles",
]

if TYPE_CHECKING:
    CHAPTERS: tuple[tuple[str, str], ...]


def __getattr__(name: str) -> object:
    """The chapters, whose titles are read on first use."""
    if name != "CHAPTERS":
        raise AttributeError(f"module 'geomtorsion.teaching.exercises' has no attribute {name!r}")
    return tuple(chapters().items())


def __dir__() -> list[str]:
    """All public names."""
    return [*__all__]

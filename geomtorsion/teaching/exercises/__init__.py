"""Exercises: problems that check their answers and name the likely mistake."""

from geomtorsion.teaching.exercises.exercise import Exercise
from geomtorsion.teaching.exercises.exports import export
from geomtorsion.teaching.exercises.question import Question
from geomtorsion.teaching.exercises.registry import CHAPTERS, check, load, names, titles
from geomtorsion.teaching.exercises.verdict import QuestionVerdict, Verdict

__all__ = [
    "CHAPTERS",
    "Exercise",
    "Question",
    "QuestionVerdict",
    "Verdict",
    "check",
    "export",
    "load",
    "names",
    "titles",
]


def __dir__() -> list[str]:
    """All public names."""
    return [*__all__]

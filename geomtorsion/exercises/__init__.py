"""Exercises: problems that check their answers and name the likely mistake."""

from geomtorsion.exercises.exercise import Exercise
from geomtorsion.exercises.exports import export
from geomtorsion.exercises.question import Question
from geomtorsion.exercises.registry import CHAPTERS, check, load, names, titles
from geomtorsion.exercises.verdict import QuestionVerdict, Verdict

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

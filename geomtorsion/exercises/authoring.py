"""authoring: what the file of an exercise is written with."""

from geomtorsion.exercises import tex
from geomtorsion.exercises.domain import Domain
from geomtorsion.exercises.exercise import Variant, steps
from geomtorsion.exercises.question import Mistake, Question, normal, reordered, scaled

__all__ = [
    "Domain",
    "Mistake",
    "Question",
    "Variant",
    "normal",
    "reordered",
    "scaled",
    "steps",
    "tex",
]

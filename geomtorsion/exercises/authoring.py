"""authoring: what the file of an exercise is written with."""

from geomtorsion.exercises import tex
from geomtorsion.exercises.diagnoses import CONNECTION, TORSION
from geomtorsion.exercises.domain import Domain
from geomtorsion.exercises.exercise import Variant, steps
from geomtorsion.exercises.question import Mistake, Question, normal, reordered, scaled

__all__ = [
    "CONNECTION",
    "TORSION",
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

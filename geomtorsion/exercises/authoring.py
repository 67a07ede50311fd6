"""authoring: what the file of an exercise is written with."""

from geomtorsion.exercises import tex
from geomtorsion.exercises import working as by_hand
from geomtorsion.exercises.domain import Domain
from geomtorsion.exercises.exercise import Variant, steps
from geomtorsion.exercises.question import Mistake, Question, normal, reordered, scaled
from geomtorsion.exercises.verdict import CONNECTION, TORSION
from geomtorsion.exercises.working import Step

__all__ = [
    "CONNECTION",
    "TORSION",
    "Domain",
    "Mistake",
    "Question",
    "Step",
    "Variant",
    "by_hand",
    "normal",
    "reordered",
    "scaled",
    "steps",
    "tex",
]

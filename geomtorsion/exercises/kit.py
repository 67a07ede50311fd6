"""kit: what the file of an exercise is written with."""

from geomtorsion.exercises import tex
from geomtorsion.exercises.exercise import Posed, steps
from geomtorsion.exercises.ground import Ground
from geomtorsion.exercises.mistakes import reordered, scaled
from geomtorsion.exercises.question import Mistake, Question, normal

__all__ = [
    "Ground",
    "Mistake",
    "Posed",
    "Question",
    "normal",
    "reordered",
    "scaled",
    "steps",
    "tex",
]

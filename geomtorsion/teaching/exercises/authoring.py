"""authoring: the names that the file of an exercise imports."""

from geomtorsion.teaching.exercises import tex
from geomtorsion.teaching.exercises import working as by_hand
from geomtorsion.teaching.exercises.domain import Domain
from geomtorsion.teaching.exercises.draw import Draw
from geomtorsion.teaching.exercises.exercise import Variant
from geomtorsion.teaching.exercises.question import Mistake, Question, normal, reordered, scaled
from geomtorsion.teaching.exercises.verdict import CONNECTION, TORSION
from geomtorsion.teaching.exercises.working import Step
from geomtorsion.teaching.texts import Texts, texts_of

__all__ = [
    "CONNECTION",
    "TORSION",
    "Domain",
    "Draw",
    "Mistake",
    "Question",
    "Step",
    "Texts",
    "Variant",
    "by_hand",
    "normal",
    "reordered",
    "scaled",
    "tex",
    "texts_of",
]

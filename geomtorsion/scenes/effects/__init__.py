"""Effects: what acts on a body, one small class each; the tuple below lists them."""

from geomtorsion.scenes.effects.drift import Drift
from geomtorsion.scenes.effects.gravity import Gravity
from geomtorsion.scenes.effects.pivot import Pivot
from geomtorsion.scenes.effects.protocol import Constraint, Contribution, Effect, unit
from geomtorsion.scenes.effects.spin import Spin

# A new effect is one file, and one line here.
EFFECTS: tuple[type[Effect], ...] = (
    Spin,
    Drift,
    Gravity,
    Pivot,
)

__all__ = [
    "EFFECTS",
    "Constraint",
    "Contribution",
    "Drift",
    "Effect",
    "Gravity",
    "Pivot",
    "Spin",
    "unit",
]

"""Effects: forces, torques and constraints of a body, one class each.

EFFECTS: the classes of all effects, in order; `key` of a class is its name in scene files.
"""

from geomtorsion.scenes.effects.angular_damping import AngularDamping
from geomtorsion.scenes.effects.custom import Custom
from geomtorsion.scenes.effects.drag import LinearDrag, QuadraticDrag
from geomtorsion.scenes.effects.drift import Drift
from geomtorsion.scenes.effects.gravity import Gravity
from geomtorsion.scenes.effects.gravity_gradient import GravityGradient
from geomtorsion.scenes.effects.knife_edge import KnifeEdge
from geomtorsion.scenes.effects.magnet import Magnet
from geomtorsion.scenes.effects.pivot import Pivot
from geomtorsion.scenes.effects.protocol import Constraint, Contribution, Effect, Typical, unit
from geomtorsion.scenes.effects.rolling import Rolling
from geomtorsion.scenes.effects.rotor import Rotor
from geomtorsion.scenes.effects.spin import Spin
from geomtorsion.scenes.effects.spring import Spring
from geomtorsion.scenes.effects.surroundings import Surroundings
from geomtorsion.scenes.effects.thrust import BodyMoment, Thrust
from geomtorsion.scenes.effects.torsion import Naive, Torsion

# A new effect is one file, and one line here.
EFFECTS: tuple[type[Effect], ...] = (
    Spin,
    Drift,
    Gravity,
    Pivot,
    GravityGradient,
    Spring,
    LinearDrag,
    QuadraticDrag,
    AngularDamping,
    Thrust,
    BodyMoment,
    Magnet,
    Rotor,
    Rolling,
    KnifeEdge,
    Torsion,
    Naive,
    Custom,
)

__all__ = [
    "EFFECTS",
    "AngularDamping",
    "BodyMoment",
    "Constraint",
    "Contribution",
    "Custom",
    "Drift",
    "Effect",
    "Gravity",
    "GravityGradient",
    "KnifeEdge",
    "LinearDrag",
    "Magnet",
    "Naive",
    "Pivot",
    "QuadraticDrag",
    "Rolling",
    "Rotor",
    "Spin",
    "Spring",
    "Surroundings",
    "Thrust",
    "Torsion",
    "Typical",
    "unit",
]


def __dir__() -> list[str]:
    """All public names."""
    return [*__all__]

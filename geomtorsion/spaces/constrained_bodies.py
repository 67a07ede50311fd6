"""constrained bodies: a sleigh, a rolling disc and a wheeled robot, with their connections."""

from sympy import Rational, cos, diag, sin, sqrt, symbols

from geomtorsion.geometry import Connection, Frame, constrained
from geomtorsion.spaces.embedding import Embedding
from geomtorsion.spaces.space import FirstMotion, KnownAnswer, Space, Table, antisymmetric

x, y, theta, phi = symbols("x y theta phi", real=True)
HALF = Rational(1, 2)
# The blade, or the axle, permits no velocity to the side.
NO_SLIDING = "cos(theta)*dy - sin(theta)*dx"
NOTES = (
    "The kinetic energy is g(v, v)/2. The constrained body follows the "
    "autoparallel, the free body the geodesic; start with a velocity that the constraints permit."
)


def space(name: str) -> Space:
    """The body of this name."""
    return {
        "chaplygin_sleigh": _sleigh,
        "rolling_disc": _disc,
        "wheeled_robot": _robot,
    }[name](name)


def _sleigh(name: str) -> Space:
    """A board on a blade, whose centre of mass is a distance a in front of the blade."""
    m, inertia, a = symbols("m I a", positive=True)
    side, ahead, whole = -m * a * sin(theta), m * a * cos(theta), inertia + m * a**2
    metric = [[m, 0, side], [0, m, ahead], [side, ahead, whole]]
    energy = Frame.from_metric([x, y, theta], metric, parameters=[m, inertia, a], name=name)
    torsion = {
        (0, 1, 2): sqrt(inertia) / (2 * whole),
        (0, 2, 2): -a * sqrt(m) / (2 * whole),
        (1, 2, 0): sqrt(inertia) / (2 * whole),
    }
    return _space(
        name,
        constrained(energy, [NO_SLIDING]),
        antisymmetric(torsion),
        story=(
            "A sledge on one blade: it slides forward and turns, and never moves to the side.\n"
            "The torsion along the forbidden leg does not vanish: it can still reach every place."
        ),
        source="S. A. Chaplygin, On the theory of motion of nonholonomic systems, Mat. Sb. 28 "
        "(1911) 303",
        motion=FirstMotion((0.0, 0.0, 0.0), (1.0, 2.0, 0.0), 6.0, {"m": 1.0, "I": 0.5, "a": 0.3}),
    )


def _disc(name: str) -> Space:
    """An upright disc: phi is the angle of rolling, theta the direction of its track."""
    m, steering, rolling, radius = symbols("m J I R", positive=True)
    energy = Frame.from_metric(
        [x, y, theta, phi],
        diag(m, m, steering, rolling).tolist(),
        parameters=[m, steering, rolling, radius],
        name=name,
    )
    bound = constrained(energy, ["cos(theta)*dx + sin(theta)*dy - R*dphi", NO_SLIDING])
    twist = radius * sqrt(m) / (sqrt(steering) * sqrt(rolling + m * radius**2))
    torsion = {(0, 1, 3): HALF * twist, (1, 3, 0): HALF * twist}
    return _space(
        name,
        bound,
        antisymmetric(torsion),
        story=(
            "A coin that rolls upright on a table without slipping: steer it, and it rolls on.\n"
            "The torsion R sqrt(m/(J (I + m R^2))) measures how steering while rolling drifts."
        ),
        source="Ju. I. Neimark, N. A. Fufaev, Dynamics of nonholonomic systems (AMS, 1972), "
        "chapter I",
        motion=FirstMotion(
            (0.0, 0.0, 0.0, 0.0), (1.2, 0.4, 0.0, 0.0), 10.0,
            {"m": 1.0, "J": 0.25, "I": 0.5, "R": 1.0},
        ),
    )  # fmt: skip


def _robot(name: str) -> Space:
    """A robot with two wheels on one axle: it drives along theta and turns in place."""
    energy = Frame((x, y, theta), [[1, 0, 0], [0, 1, 0], [0, 0, 1]], name=name)
    torsion = {(0, 1, 2): HALF, (1, 2, 0): HALF}
    return _space(
        name,
        constrained(energy, [NO_SLIDING]),
        antisymmetric(torsion),
        story=(
            "A robot drives and turns. Forward, turn, back, turn back: it ends to one side.\n"
            "That sideways step is a Burgers vector, and torsion 1 is its amount per unit of area."
        ),
        source="R. M. Murray, S. S. Sastry, Nonholonomic motion planning, IEEE Trans. Autom. "
        "Control 38 (1993) 700",
        motion=FirstMotion((0.0, 0.0, 0.0), (1.0, 0.5, 0.0), 6.0),
    )


def _space(
    name: str,
    bound: Connection,
    torsion: Table,
    story: str,
    source: str,
    motion: FirstMotion,
) -> Space:
    return Space(
        name,
        story=story,
        source=source,
        frame=bound.frame,
        known=(
            KnownAnswer("connection_torsion", torsion, basis="frame"),
            KnownAnswer("connection_nonmetricity", {}),
            # In coordinates of the centre of mass the kinetic energy has constant coefficients.
            KnownAnswer("riemann", {}),
        ),
        connection=bound,
        notes=NOTES,
        motion=motion,
        embedding=_track,
        group="bodies with constraints",
    )


def _track(frame: Frame) -> Embedding:
    """The track on the ground, and the direction of the blade or the wheels."""
    return Embedding(
        frame.coordinates,
        place=(x, y),
        axes=("x", "y"),
        heading=(cos(theta), sin(theta)),
        isometric=False,
        title="the track on the ground",
    )

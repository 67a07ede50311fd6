"""so3_quaternion: rotations by three components of a unit quaternion."""

from collections.abc import Sequence
from functools import partial

from sympy import Expr, Symbol, eye, sqrt, symbols

from geomtorsion.curves.atlas import MapFunctions
from geomtorsion.geometry import Frame
from geomtorsion.spaces.embedding import Embedding
from geomtorsion.spaces.rotations import (
    BODY_FIXED,
    QUATERNION,
    QuaternionMap,
    quaternion_atlas,
    rotation,
)
from geomtorsion.spaces.space import FirstMotion, KnownAnswer, Space


def space(name: str) -> Space:
    """q = q0 + i q1 + j q2 + k q3 with q0 = sqrt(1 - q1^2 - q2^2 - q3^2); 2 Im(q* dq)."""
    q1, q2, q3 = q = symbols("q1 q2 q3", real=True)
    q0 = sqrt(1 - q1**2 - q2**2 - q3**2)
    turn = [[0, q3, -q2], [-q3, 0, q1], [q2, -q1, 0]]
    unit = eye(3)
    frame = Frame(
        q,
        [
            [2 * (q0 * unit[i, j] + q[i] * q[j] / q0 + turn[i][j]) for j in range(3)]
            for i in range(3)
        ],
        domain=q1**2 + q2**2 + q3**2 < 1,
        name=name,
    )
    metric = {(i, j): 4 * (unit[i, j] + q[i] * q[j] / q0**2) for i in range(3) for j in range(3)}
    return Space(
        name,
        story=(
            "Half of the unit quaternions as a chart: free of gimbal lock up to a half turn.\n"
            "It has neither angles nor sines; the frame has the torsion of so3."
        ),
        source="M. D. Shuster, A survey of attitude representations, "
        "J. Astronaut. Sci. 41 (1993) 439",
        frame=frame,
        known=(
            KnownAnswer("metric", metric),
            KnownAnswer("determinant", 8 / q0),
            *BODY_FIXED,
        ),
        atlas=partial(quaternion_atlas, _map),
        embedding=_embedding,
        motion=FirstMotion((-0.09, 0.23, -0.27), (0.802, 0.535, 0.267)),
        group="rotations",
        notes="q0 > 0 is the branch; rotations by a half turn (q0 = 0) are the edge of the chart.",
    )


def _map(q: Sequence[Symbol]) -> QuaternionMap:
    """q1, q2, q3 of the quaternion with a positive scalar part."""
    scalar = sqrt(1 - sum(x**2 for x in q))
    return QuaternionMap([scalar, *q], list(QUATERNION[1:]), scalar, (), _positive)


def _positive(f: MapFunctions, q: Sequence[Expr], _: object) -> list[Expr]:
    """A quaternion and its negative are the same rotation: choose the one with q0 > 0."""
    return [f.choose(q[0] < 0, -x, x) for x in q[1:]]


def _embedding(frame: Frame) -> Embedding:
    """The attitude."""
    q = frame.coordinates
    return Embedding(q, attitude=rotation([sqrt(1 - sum(x**2 for x in q)), *q]))

"""so3_rodrigues: rotations by the Rodrigues (Gibbs) vector, a rational chart."""

from collections.abc import Sequence
from functools import partial

from sympy import S, Symbol, eye, sqrt, symbols

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
    """g = axis * tan(angle / 2); coframe 2 (1 - [g]x) / (1 + g.g)."""
    g1, g2, g3 = g = symbols("g1 g2 g3", real=True)
    square = g1**2 + g2**2 + g3**2
    turn = [[0, g3, -g2], [-g3, 0, g1], [g2, -g1, 0]]
    unit = eye(3)
    frame = Frame(
        g,
        [[2 * (unit[i, j] + turn[i][j]) / (1 + square) for j in range(3)] for i in range(3)],
        name=name,
    )
    metric = {
        (i, j): 4 * (unit[i, j] * (1 + square) - g[i] * g[j]) / (1 + square) ** 2
        for i in range(3)
        for j in range(3)
    }
    return Space(
        name,
        story=(
            "Cayley's map from vectors to rotations: a chart in which everything is rational.\n"
            "Rotations by a half turn are at infinity; the frame has the torsion of so3."
        ),
        source="M. D. Shuster, A survey of attitude representations, "
        "J. Astronaut. Sci. 41 (1993) 439",
        frame=frame,
        known=(
            KnownAnswer("metric", metric),
            KnownAnswer("determinant", 8 / (1 + square) ** 2),
            *BODY_FIXED,
        ),
        atlas=partial(quaternion_atlas, _map),
        embedding=_embedding,
        motion=FirstMotion((-0.17, 0.45, -0.54), (0.802, 0.535, 0.267)),
        group="rotations",
    )


def _map(g: Sequence[Symbol]) -> QuaternionMap:
    """Ratios of the quaternion's components."""
    square = 1 + sum(x**2 for x in g)
    scalar, *vector = QUATERNION
    return QuaternionMap(
        [x / sqrt(square) for x in (S.One, *g)], [x / scalar for x in vector], 1 / square
    )


def _embedding(frame: Frame) -> Embedding:
    """The attitude."""
    g = frame.coordinates
    return Embedding(g, attitude=rotation([S.One, *g]) / (1 + sum(x**2 for x in g)))

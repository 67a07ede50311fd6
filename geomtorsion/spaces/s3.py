"""s3: the unit three-sphere in Hopf coordinates with its left-invariant frame."""

from collections.abc import Sequence
from functools import partial

from sympy import S, Symbol, atan2, cos, pi, sin, symbols

from geomtorsion.geometry import Frame
from geomtorsion.spaces.coordinates import length
from geomtorsion.spaces.embedding import Embedding
from geomtorsion.spaces.rotations import QUATERNION, QuaternionMap, quaternion_atlas
from geomtorsion.spaces.space import FirstMotion, KnownAnswer, Space, alternating, box, diagonal


def space(name: str) -> Space:
    """q = exp(i xi1) cos(eta) + j exp(-i xi2) sin(eta); coframe: the i, j, k parts of q* dq."""
    eta, xi1, xi2 = symbols("eta xi1 xi2", real=True)
    turn = xi1 - xi2
    across = sin(eta) * cos(eta)
    frame = Frame(
        (eta, xi1, xi2),
        [
            [0, cos(eta) ** 2, -(sin(eta) ** 2)],
            [cos(turn), across * sin(turn), across * sin(turn)],
            [-sin(turn), across * cos(turn), across * cos(turn)],
        ],
        domain=box({eta: (0, pi / 2), xi1: (0, 2 * pi), xi2: (0, 2 * pi)}),
        name=name,
    )
    return Space(
        name,
        story=(
            "The unit quaternions: twice around a rotation, with circles of Hopf as coordinates.\n"
            "Parallel lines here are Clifford's: equidistant great circles that wind about another."
        ),
        source="J. Milnor, Curvatures of left invariant metrics on Lie groups, "
        "Adv. Math. 21 (1976) 293, section 4",
        frame=frame,
        known=(
            KnownAnswer("metric", diagonal([1, cos(eta) ** 2, sin(eta) ** 2])),
            KnownAnswer("torsion", alternating({(0, 1, 2): -1}), basis="frame"),
            KnownAnswer("torsion_scalar", -6),
            KnownAnswer("cartan_curvature", {}),
            KnownAnswer("ricci", diagonal([2, 2, 2]), basis="frame"),
            KnownAnswer("scalar_curvature", 6),
            KnownAnswer("kretschmann", 12),
            KnownAnswer("weyl", {}),
        ),
        # Velocities in the frame are not halved on the three-sphere.
        atlas=partial(quaternion_atlas, _map, share=S.One),
        embedding=_embedding,
        motion=FirstMotion((0.5, 0.0, 0.0), (0.5, 1.0, 0.3), 5.0),
        group="spheres",
        notes="The circles eta = 0 and eta = pi/2 are the edges of the chart.",
    )


def _map(q: Sequence[Symbol]) -> QuaternionMap:
    """Two radii and two angles."""
    eta, xi1, xi2 = q
    c, s = cos(eta), sin(eta)
    a, b, x, y = QUATERNION
    return QuaternionMap(
        [c * cos(xi1), c * sin(xi1), s * cos(xi2), s * sin(xi2)],
        [atan2(length(x, y), length(a, b)), atan2(b, a), atan2(y, x)],
        2 * s * c,
        (1, 2),
    )


def _embedding(frame: Frame) -> Embedding:
    """Stereographic projection of cos(eta) exp(i xi1), sin(eta) exp(i xi2) from the last axis."""
    eta, xi1, xi2 = frame.coordinates
    c, s = cos(eta), sin(eta)
    scale = 1 / (1 - s * sin(xi2))
    return Embedding(
        frame.coordinates,
        place=(c * cos(xi1) * scale, c * sin(xi1) * scale, s * cos(xi2) * scale),
        axes=("X", "Y", "Z"),
        isometric=False,
        title="in stereographic projection",
    )

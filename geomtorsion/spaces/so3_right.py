"""so3_right: rotations in z-y-z Euler angles with the space-fixed frame."""

from functools import partial

from sympy import Rational, cos, pi, sin, symbols

from geomtorsion.geometry import Frame
from geomtorsion.spaces.rotations import ZYZ, angle_atlas, angle_embedding
from geomtorsion.spaces.space import KnownAnswer, Space, alternating, box, diagonal, matrix


def space(name: str) -> Space:
    """The attitude of so3; coframe: the angular velocity seen from space."""
    phi1, phi2, phi3 = symbols("phi1 phi2 phi3", real=True)
    c2, s2, c3, s3 = cos(phi2), sin(phi2), cos(phi3), sin(phi3)
    half = Rational(1, 2)
    frame = Frame(
        (phi1, phi2, phi3),
        [[c3 * s2, -s3, 0], [s3 * s2, c3, 0], [c2, 0, 1]],
        domain=box({phi1: (0, 2 * pi), phi2: (0, pi), phi3: (0, 2 * pi)}),
        name=name,
    )
    return Space(
        name,
        story=(
            "The same rotations and the same metric as so3, but legs that stay fixed in space.\n"
            "The torsion has the opposite sign: right-invariant fields have opposite commutators."
        ),
        source="H. Goldstein, Classical Mechanics, section 4.9 (angular velocity, space axes)",
        frame=frame,
        known=(
            KnownAnswer("metric", matrix([[1, 0, c2], [0, 1, 0], [c2, 0, 1]])),
            KnownAnswer("torsion", alternating({(0, 1, 2): half}), basis="frame"),
            KnownAnswer("torsion_scalar", -3 * half),
            KnownAnswer("cartan_curvature", {}),
            KnownAnswer("ricci", diagonal([half] * 3), basis="frame"),
            KnownAnswer("scalar_curvature", 3 * half),
        ),
        atlas=partial(angle_atlas, ZYZ, space_fixed=True),
        embedding=partial(angle_embedding, ZYZ),
        group="rotations",
        notes="The chart ends where sin(phi2) = 0.",
    )

"""so3: rotations in z-y-z Euler angles with the body-fixed frame, the paper's example."""

from functools import partial

from sympy import Rational, cos, pi, sin, symbols

from geomtorsion.geometry import Frame
from geomtorsion.spaces.rotations import ZYZ, angle_atlas, angle_embedding
from geomtorsion.spaces.space import (
    FirstMotion,
    KnownAnswer,
    Space,
    alternating,
    antisymmetric,
    box,
    diagonal,
    matrix,
    symmetric,
)


def space(name: str) -> Space:
    """Attitude Rz(phi3) Ry(phi2) Rz(phi1), body to space; coframe: the body's angular velocity."""
    phi1, phi2, phi3 = symbols("phi1 phi2 phi3", real=True)
    c1, s1, c2, s2 = cos(phi1), sin(phi1), cos(phi2), sin(phi2)
    half = Rational(1, 2)
    frame = Frame(
        (phi1, phi2, phi3),
        [[0, s1, -c1 * s2], [0, c1, s1 * s2], [1, 0, c2]],
        domain=box({phi1: (0, 2 * pi), phi2: (0, pi), phi3: (0, 2 * pi)}),
        name=name,
    )
    connection = {(0, 1, 0): c2 / s2, (1, 2, 2): c2 / s2, (0, 2, 1): s2}
    connection |= {(0, 1, 2): -1 / s2, (1, 2, 0): -1 / s2}
    halved = {index: value / 2 for index, value in connection.items()}
    answers = (
        KnownAnswer("metric", matrix([[1, 0, c2], [0, 1, 0], [c2, 0, 1]]), source="eq. (9), left"),
        KnownAnswer(
            "inverse_metric",
            matrix([[1 / s2**2, 0, -c2 / s2**2], [0, 1, 0], [-c2 / s2**2, 0, 1 / s2**2]]),
            source="eq. (9), right, with the factor 1/|g| that the print lost",
        ),
        KnownAnswer("determinant", s2),
        KnownAnswer("cartan_connection", connection, source="eq. (10)"),
        KnownAnswer("christoffel", symmetric(halved), source="below eq. (9), index raised"),
        KnownAnswer("torsion", antisymmetric(halved), source="eq. (10), antisymmetrised"),
        KnownAnswer(
            "torsion", alternating({(0, 1, 2): -half}), basis="frame", source="eq. (12), halved"
        ),
        KnownAnswer("torsion_vector", {}),
        KnownAnswer("torsion_axial", alternating({(0, 1, 2): -1}), basis="frame"),
        KnownAnswer("torsion_tensor", {}),
        KnownAnswer("torsion_scalar", -3 * half),
        KnownAnswer("cartan_curvature", {}),
        KnownAnswer("ricci", diagonal([half] * 3), basis="frame"),
        KnownAnswer("scalar_curvature", 3 * half),
        KnownAnswer("kretschmann", 3 * half**2),
        KnownAnswer("weyl", {}),
    )
    return Space(
        name,
        story=(
            "A rigid body turning about a fixed point: the coframe is its angular velocity.\n"
            "Its torsion is the gyroscopic term of Euler's equations; its metric is a sphere S^3."
        ),
        source="P. Fiziev, H. Kleinert, FUB-HEP/94-5 (1994), section 2, eqs. (6) to (12)",
        frame=frame,
        known=answers,
        atlas=partial(angle_atlas, ZYZ),
        embedding=partial(angle_embedding, ZYZ),
        motion=FirstMotion((0.3, 1.0, 0.2), (0.4, 0.3, 1.0), 5.0),
        group="rotations",
        notes="The chart ends where sin(phi2) = 0 (gimbal lock).",
    )

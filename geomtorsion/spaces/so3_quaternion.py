"""so3_quaternion: rotations by three components of a unit quaternion."""

from sympy import Rational, eye, sqrt, symbols

from geomtorsion.geometry import Frame
from geomtorsion.spaces.space import KnownAnswer, Space, alternating, diagonal


def space(name: str, title: str) -> Space:
    """q = q0 + i q1 + j q2 + k q3 with q0 = sqrt(1 - q1^2 - q2^2 - q3^2); 2 Im(q* dq)."""
    q1, q2, q3 = q = symbols("q1 q2 q3", real=True)
    q0 = sqrt(1 - q1**2 - q2**2 - q3**2)
    turn = [[0, q3, -q2], [-q3, 0, q1], [q2, -q1, 0]]
    unit = eye(3)
    half = Rational(1, 2)
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
        title,
        story=(
            "Half of the unit quaternions as a chart: free of gimbal lock up to a half turn.\n"
            "No angle and no sine is left; the torsion in the frame is that of so3 all the same."
        ),
        source="M. D. Shuster, A survey of attitude representations, "
        "J. Astronaut. Sci. 41 (1993) 439",
        frame=frame,
        known=(
            KnownAnswer("metric", metric),
            KnownAnswer("determinant", 8 / q0),
            KnownAnswer("torsion", alternating({(0, 1, 2): -half}), basis="frame"),
            KnownAnswer("torsion_scalar", -3 * half),
            KnownAnswer("cartan_curvature", {}),
            KnownAnswer("ricci", diagonal([half] * 3), basis="frame"),
            KnownAnswer("scalar_curvature", 3 * half),
        ),
        group="rotations",
        notes="q0 > 0 is the branch; rotations by a half turn (q0 = 0) are the edge of the chart.",
    )

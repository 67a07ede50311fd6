"""kerr: the rotating black hole in Carter's tetrad."""

from sympy import Rational, cos, oo, pi, sin, sqrt, symbols

from geomtorsion.geometry import Frame
from geomtorsion.spaces.space import KnownAnswer, Space, antisymmetric, box, matrix


def space(name: str, title: str) -> Space:
    """Carter's tetrad in Boyer-Lindquist coordinates."""
    t, r, theta, phi = symbols("t r theta phi", real=True)
    mass, a = symbols("M a", positive=True)
    c, s = cos(theta), sin(theta)
    sigma = r**2 + a**2 * c**2
    delta = r**2 - 2 * mass * r + a**2
    slow, long = sqrt(delta) / sqrt(sigma), sqrt(sigma)
    frame = Frame(
        (t, r, theta, phi),
        [
            [slow, 0, 0, -a * s**2 * slow],
            [0, 1 / slow, 0, 0],
            [0, 0, long, 0],
            [-a * s / long, 0, 0, (r**2 + a**2) * s / long],
        ],
        signature=(-1, 1, 1, 1),
        parameters=(mass, a),
        # Outside the outer horizon, r = M + sqrt(M^2 - a^2).
        domain=[delta > 0, *box({r: (mass, oo), theta: (0, pi), phi: (0, 2 * pi)})],
        name=name,
    )
    drag = -2 * mass * r * a * s**2 / sigma
    half = Rational(1, 2)
    return Space(
        name,
        title,
        story=(
            "The rotating black hole, seen by observers for whom light goes in and out evenly.\n"
            "Ricci flat for every mass and spin: a zero that is hard to see and easy to get wrong."
        ),
        source="B. Carter, Commun. Math. Phys. 10 (1968) 280",
        frame=frame,
        known=(
            KnownAnswer(
                "metric",
                matrix(
                    [
                        [-(1 - 2 * mass * r / sigma), 0, 0, drag],
                        [0, sigma / delta, 0, 0],
                        [0, 0, sigma, 0],
                        [drag, 0, 0, (r**2 + a**2 - a * drag) * s**2],
                    ]
                ),
            ),
            KnownAnswer("determinant", sigma * s),
            KnownAnswer(
                "torsion",
                antisymmetric(
                    {
                        (1, 2, 1): half * a**2 * s * c / long**3,
                        (1, 2, 2): half * r * sqrt(delta) / long**3,
                        (1, 3, 3): half * r * sqrt(delta) / long**3,
                        (2, 3, 0): -a * c * sqrt(delta) / long**3,
                        (0, 1, 3): -a * r * s / long**3,
                    }
                ),
                basis="frame",
                complete=False,
            ),
            KnownAnswer("cartan_curvature", {}),
            KnownAnswer("ricci", {}),
            KnownAnswer("scalar_curvature", 0),
            KnownAnswer(
                "kretschmann",
                48
                * mass**2
                * (r**2 - a**2 * c**2)
                * (sigma**2 - 16 * r**2 * a**2 * c**2)
                / sigma**6,
            ),
        ),
        group="gravity",
        notes="Signature (-, +, +, +), G = c = 1. The domain is the outside of the outer horizon, "
        "where the tetrad ends.",
    )

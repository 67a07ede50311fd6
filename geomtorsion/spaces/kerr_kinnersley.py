"""kerr_kinnersley: the rotating black hole in Kinnersley's null tetrad."""

from sympy import I, Rational, cos, oo, pi, sin, sqrt, symbols

from geomtorsion.geometry import Frame
from geomtorsion.spaces.kerr import boyer_lindquist
from geomtorsion.spaces.space import KnownAnswer, Space, antisymmetric, box


def space(name: str) -> Space:
    """Legs (l, n, m, conjugate m) with l.n = -1, m.m* = 1; coframe: their dual one-forms."""
    t, r, theta, phi = symbols("t r theta phi", real=True)
    mass, a = symbols("M a", positive=True)
    c, s = cos(theta), sin(theta)
    sigma = r**2 + a**2 * c**2
    delta = r**2 - 2 * mass * r + a**2
    plus, minus = sqrt(2) * (r + I * a * c), sqrt(2) * (r - I * a * c)
    inward = delta / (2 * sigma)
    frame = Frame(
        (t, r, theta, phi),
        [
            [inward, Rational(1, 2), 0, -inward * a * s**2],
            [1, -sigma / delta, 0, -a * s**2],
            [I * a * s / minus, 0, sigma / minus, -I * (r**2 + a**2) * s / minus],
            [-I * a * s / plus, 0, sigma / plus, I * (r**2 + a**2) * s / plus],
        ],
        signature=((0, -1, 0, 0), (-1, 0, 0, 0), (0, 0, 0, 1), (0, 0, 1, 0)),
        parameters=(mass, a),
        # Outside the outer horizon, r = M + sqrt(M^2 - a^2).
        domain=[delta > 0, *box({r: (mass, oo), theta: (0, pi), phi: (0, 2 * pi)})],
        complex=True,
        name=name,
    )
    # Psi_2 = -M / (r - i a cos(theta))^3; the order of the last two indices is opposite here.
    psi2 = -mass / (r - I * a * c) ** 3
    return Space(
        name,
        story=(
            "Kerr along its two families of principal light rays: the frame of wave equations.\n"
            "Complex legs and an off-diagonal eta; all of the curvature is one number, Psi_2."
        ),
        source="W. Kinnersley, J. Math. Phys. 10 (1969) 1195; "
        "S. A. Teukolsky, Astrophys. J. 185 (1973) 635, eq. (4.4)",
        frame=frame,
        known=(
            KnownAnswer("metric", boyer_lindquist(mass, a, r, theta)),
            KnownAnswer(
                "legs",
                {
                    (0, 0): (r**2 + a**2) / delta,
                    (1, 0): 1,
                    (3, 0): a / delta,
                    (0, 1): (r**2 + a**2) / (2 * sigma),
                    (1, 1): -inward,
                    (3, 1): a / (2 * sigma),
                    (0, 2): I * a * s / plus,
                    (2, 2): 1 / plus,
                    (3, 2): I / (s * plus),
                    (0, 3): -I * a * s / minus,
                    (2, 3): 1 / minus,
                    (3, 3): -I / (s * minus),
                },
                basis="natural",
            ),
            KnownAnswer(
                "torsion",
                antisymmetric(
                    {
                        # The twist of the two congruences of light rays ...
                        (2, 3, 1): I * a * c / sigma,
                        (2, 3, 0): I * a * c * inward / sigma,
                        # ... and the acceleration of n along itself, for l is geodesic.
                        (0, 1, 0): ((r - mass) * sigma - r * delta) / (2 * sigma**2),
                        (0, 1, 1): 0,
                    }
                ),
                basis="frame",
                complete=False,
            ),
            KnownAnswer("cartan_curvature", {}),
            KnownAnswer("ricci", {}),
            KnownAnswer("weyl", {(0, 2, 3, 1): -psi2}, basis="frame", complete=False),
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
        notes="Signature (-, +, +, +): the signs of the covectors are opposite to Teukolsky's, "
        "the legs are the same.",
    )

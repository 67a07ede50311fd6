"""kerr_newman: the charged rotating black hole in Carter's tetrad."""

from sympy import cos, sin, sqrt, symbols

from geomtorsion.spaces.kerr import carter
from geomtorsion.spaces.space import (
    FirstMotion,
    KnownAnswer,
    Space,
    antisymmetric,
    diagonal,
)


def space(name: str) -> Space:
    """Carter's tetrad in Boyer-Lindquist coordinates."""
    t, r, theta, phi = symbols("t r theta phi", real=True)
    mass, a, charge = symbols("M a q", positive=True)
    c, s = cos(theta), sin(theta)
    sigma = r**2 + a**2 * c**2
    delta = r**2 - 2 * mass * r + a**2 + charge**2
    frame = carter((t, r, theta, phi), delta, a, (mass, a, charge), name)
    slow = sqrt(delta) / sqrt(sigma)
    energy = charge**2 / sigma**2
    return Space(
        name,
        story=(
            "The most general black hole of Einstein and Maxwell: mass, spin and charge.\n"
            "In Carter's legs its field has the energy of two parallel plates, q^2/Sigma^2."
        ),
        source="E. T. Newman et al., J. Math. Phys. 6 (1965) 918; "
        "B. Carter, Commun. Math. Phys. 10 (1968) 280",
        frame=frame,
        known=(
            KnownAnswer(
                "torsion",
                antisymmetric({(2, 3, 0): -a * c * slow / sigma}),
                basis="frame",
                complete=False,
            ),
            KnownAnswer("determinant", sigma * s),
            KnownAnswer("scalar_curvature", 0),
            KnownAnswer("einstein", diagonal([energy, -energy, energy, energy]), basis="frame"),
        ),
        motion=FirstMotion(
            (0.0, 8.0, 1.2, 0.3),
            (1.25, 0.5, 0.25, 0.5),
            parameters={"M": 1.0, "a": 0.5, "q": 0.5},
        ),
        group="gravity",
        notes="Signature (-, +, +, +), G = c = 1. Potential A = -q r/Sigma (dt - a sin^2 dphi).",
    )

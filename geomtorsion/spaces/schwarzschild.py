"""schwarzschild: the black hole in Schwarzschild's coordinates with the static diagonal tetrad."""

from sympy import Rational, Symbol, cos, oo, pi, sin, sqrt, symbols

from geomtorsion.geometry import Frame
from geomtorsion.spaces.space import KnownAnswer, Space, antisymmetric, box, diagonal


def space(name: str, title: str) -> Space:
    """Coframe (sqrt(f) dt, dr/sqrt(f), r dtheta, r sin(theta) dphi), f = 1 - 2 M / r."""
    t, r, theta, phi = symbols("t r theta phi", real=True)
    mass = Symbol("M", positive=True)
    f = 1 - 2 * mass / r
    root = sqrt(f)
    half = Rational(1, 2)
    frame = Frame(
        (t, r, theta, phi),
        [[root, 0, 0, 0], [0, 1 / root, 0, 0], [0, 0, r, 0], [0, 0, 0, r * sin(theta)]],
        signature=(-1, 1, 1, 1),
        parameters=(mass,),
        domain=box({r: (2 * mass, oo), theta: (0, pi), phi: (0, 2 * pi)}),
        name=name,
    )
    torsion = {
        (0, 1, 0): -half * mass / (r**2 * root),
        (1, 2, 2): half * root / r,
        (1, 3, 3): half * root / r,
        (2, 3, 3): half * cos(theta) / (r * sin(theta)),
    }
    return Space(
        name,
        title,
        story=(
            "The field outside a round star, with the rods and clocks of those who stand still.\n"
            "Ricci flat: what is left of gravity is tide; the torsion T_10^0 is the weight felt."
        ),
        source="C. W. Misner, K. S. Thorne, J. A. Wheeler, Gravitation (1973), chapter 31",
        frame=frame,
        known=(
            KnownAnswer("metric", diagonal([-f, 1 / f, r**2, r**2 * sin(theta) ** 2])),
            KnownAnswer("determinant", r**2 * sin(theta)),
            KnownAnswer("torsion", antisymmetric(torsion), basis="frame"),
            KnownAnswer("torsion_axial", {}),
            KnownAnswer("torsion_scalar", -2 / r**2),
            KnownAnswer("cartan_curvature", {}),
            KnownAnswer("ricci", {}),
            KnownAnswer("einstein", {}),
            KnownAnswer("scalar_curvature", 0),
            KnownAnswer("kretschmann", 48 * mass**2 / r**6),
        ),
        group="gravity",
        notes="Signature (-, +, +, +), G = c = 1. The chart covers the outside, r > 2 M.",
    )

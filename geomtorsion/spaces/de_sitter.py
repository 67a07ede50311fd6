"""de_sitter: the static patch of de Sitter space."""

from sympy import Rational, Symbol, cos, pi, sin, sqrt, symbols

from geomtorsion.geometry import Frame
from geomtorsion.spaces.space import KnownAnswer, Space, antisymmetric, box, diagonal


def space(name: str, title: str) -> Space:
    """Coframe (sqrt(f) dt, dr/sqrt(f), r dtheta, r sin(theta) dphi), f = 1 - r^2 / L^2."""
    t, r, theta, phi = symbols("t r theta phi", real=True)
    length = Symbol("L", positive=True)
    f = 1 - r**2 / length**2
    root = sqrt(f)
    half = Rational(1, 2)
    frame = Frame(
        (t, r, theta, phi),
        [[root, 0, 0, 0], [0, 1 / root, 0, 0], [0, 0, r, 0], [0, 0, 0, r * sin(theta)]],
        signature=(-1, 1, 1, 1),
        parameters=(length,),
        domain=box({r: (0, length), theta: (0, pi), phi: (0, 2 * pi)}),
        name=name,
    )
    torsion = {
        (0, 1, 0): half * r / (length**2 * root),
        (1, 2, 2): half * root / r,
        (1, 3, 3): half * root / r,
        (2, 3, 3): half * cos(theta) / (r * sin(theta)),
    }
    return Space(
        name,
        title,
        story=(
            "What one observer can see of an empty universe that expands for ever.\n"
            "Constant curvature 1/L^2; who stands still at r is pushed outwards: that is T_01^0."
        ),
        source="S. W. Hawking, G. F. R. Ellis, The Large Scale Structure of Space-Time (1973), "
        "section 5.2",
        frame=frame,
        known=(
            KnownAnswer("metric", diagonal([-f, 1 / f, r**2, r**2 * sin(theta) ** 2])),
            KnownAnswer("torsion", antisymmetric(torsion), basis="frame"),
            KnownAnswer("torsion_axial", {}),
            KnownAnswer("torsion_scalar", 6 / length**2 - 2 / r**2),
            KnownAnswer("cartan_curvature", {}),
            KnownAnswer("ricci", diagonal([-3 / length**2, *[3 / length**2] * 3]), basis="frame"),
            KnownAnswer("scalar_curvature", 12 / length**2),
            KnownAnswer("weyl", {}),
            KnownAnswer("kretschmann", 24 / length**4),
        ),
        group="gravity",
        notes="Signature (-, +, +, +). The horizon r = L is the edge of the patch.",
    )

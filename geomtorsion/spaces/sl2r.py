"""sl2r: the group SL(2,R) with a left-invariant frame, Riemannian and as anti-de Sitter space."""

from sympy import Rational, cos, oo, pi, sin, symbols

from geomtorsion.geometry import Frame
from geomtorsion.spaces.space import KnownAnswer, Space, alternating, antisymmetric, box, diagonal

HALF = Rational(1, 2)


def space(name: str) -> Space:
    """Iwasawa coordinates: [[1, x], [0, 1]] diag(sqrt(y), 1/sqrt(y)) rotation(-phi / 2)."""
    x, y, phi = symbols("x y phi", real=True)
    frame = Frame(
        (x, y, phi),
        [
            [cos(phi) / y, sin(phi) / y, 0],
            [-sin(phi) / y, cos(phi) / y, 0],
            [1 / y, 0, 1],
        ],
        signature=(1, 1, -1) if name == "ads3" else None,
        domain=box({y: (0, oo), phi: (0, 2 * pi)}),
        name=name,
    )
    shared = (
        KnownAnswer(
            "torsion",
            antisymmetric({(0, 1, 2): HALF, (1, 2, 0): -HALF, (2, 0, 1): -HALF}),
            basis="frame",
        ),
        KnownAnswer("torsion_vector", {}),
        KnownAnswer("cartan_curvature", {}),
    )
    if name == "ads3":
        return Space(
            name,
            story=(
                "Anti-de Sitter space in three dimensions: a group with its Killing form.\n"
                "Torsion and curvature are as on so3, with one sign of the metric turned over."
            ),
            source="M. Banados, M. Henneaux, C. Teitelboim, J. Zanelli, "
            "Phys. Rev. D 48 (1993) 1506",
            frame=frame,
            known=(
                *shared,
                KnownAnswer("torsion_axial", alternating({(0, 1, 2): -1}), basis="frame"),
                KnownAnswer("torsion_tensor", {}),
                KnownAnswer("torsion_scalar", 3 * HALF),
                KnownAnswer("ricci", diagonal([-HALF, -HALF, HALF]), basis="frame"),
                KnownAnswer("scalar_curvature", -3 * HALF),
                KnownAnswer("kretschmann", 3 * HALF**2),
            ),
            group="homogeneous spaces",
            notes="Signature (+, +, -): phi is time. The radius is 2.",
        )
    return Space(
        name,
        story=(
            "Unit tangent vectors of the hyperbolic plane: where you are and where you look.\n"
            "A loop in the plane turns the view by its area: that is the torsion along phi."
        ),
        source="J. Milnor, Curvatures of left invariant metrics on Lie groups, "
        "Adv. Math. 21 (1976) 293, section 4",
        frame=frame,
        known=(
            *shared,
            KnownAnswer("torsion_scalar", 5 * HALF),
            KnownAnswer("ricci", diagonal([-3 * HALF, -3 * HALF, HALF]), basis="frame"),
            KnownAnswer("scalar_curvature", -5 * HALF),
        ),
        group="homogeneous spaces",
    )

"""goedel: Goedel's rotating universe."""

from sympy import Symbol, exp, sqrt, symbols

from geomtorsion.geometry import Frame
from geomtorsion.spaces.space import KnownAnswer, Space, antisymmetric


def space(name: str) -> Space:
    """Coframe a (dt + exp(x) dy), a dx, a exp(x) dy / sqrt(2), a dz."""
    t, x, y, z = symbols("t x y z", real=True)
    a = Symbol("a", positive=True)
    frame = Frame(
        (t, x, y, z),
        [[a, 0, a * exp(x), 0], [0, a, 0, 0], [0, 0, a * exp(x) / sqrt(2), 0], [0, 0, 0, a]],
        signature=(-1, 1, 1, 1),
        parameters=(a,),
        name=name,
    )
    return Space(
        name,
        story=(
            "A universe of dust that turns about every one of its points, with loops in time.\n"
            "A group manifold: in this frame its torsion and its curvature are constant numbers."
        ),
        source="K. Goedel, Rev. Mod. Phys. 21 (1949) 447",
        frame=frame,
        known=(
            KnownAnswer(
                "torsion",
                antisymmetric({(1, 2, 0): 1 / (sqrt(2) * a), (1, 2, 2): 1 / (2 * a)}),
                basis="frame",
            ),
            KnownAnswer("torsion_scalar", -1 / a**2),
            KnownAnswer("cartan_curvature", {}),
            KnownAnswer("ricci", {(0, 0): 1 / a**2}, basis="frame"),
            KnownAnswer("scalar_curvature", -1 / a**2),
            KnownAnswer("kretschmann", 3 / a**4),
        ),
        group="gravity",
        notes="Signature (-, +, +, +); the vorticity is 1 / (sqrt(2) a).",
    )

"""heisenberg: the Heisenberg group with its left-invariant frame (Thurston's Nil)."""

from sympy import Rational, symbols

from geomtorsion.geometry import Frame
from geomtorsion.spaces.space import FirstMotion, KnownAnswer, Space, antisymmetric, diagonal


def space(name: str) -> Space:
    """Coframe (dx, dy, dz - x dy)."""
    x, y, z = symbols("x y z", real=True)
    half = Rational(1, 2)
    frame = Frame((x, y, z), [[1, 0, 0], [0, 1, 0], [0, -x, 1]], name=name)
    return Space(
        name,
        story=(
            "Position, momentum and phase: walks around loops in the plane end higher or lower.\n"
            "A constant density of screw dislocations: the torsion is uniform and points along z."
        ),
        source="P. Scott, The geometries of 3-manifolds, Bull. London Math. Soc. 15 (1983) 401, "
        "section 4",
        frame=frame,
        known=(
            KnownAnswer("determinant", 1),
            KnownAnswer("torsion", antisymmetric({(0, 1, 2): -half}), basis="frame"),
            KnownAnswer("torsion_vector", {}),
            KnownAnswer("torsion_scalar", half),
            KnownAnswer("cartan_curvature", {}),
            KnownAnswer("ricci", diagonal([-half, -half, half]), basis="frame"),
            KnownAnswer("scalar_curvature", -half),
        ),
        motion=FirstMotion((0.0, 0.0, 0.0), (1.0, 0.3, 1.0), 9.0),
        group="homogeneous spaces",
    )

"""sol: the solvable group of Thurston's eighth geometry."""

from sympy import Rational, exp, symbols

from geomtorsion.geometry import Frame
from geomtorsion.spaces.space import KnownAnswer, Space, antisymmetric, diagonal


def space(name: str) -> Space:
    """Coframe (exp(z) dx, exp(-z) dy, dz)."""
    x, y, z = symbols("x y z", real=True)
    half = Rational(1, 2)
    frame = Frame((x, y, z), [[exp(z), 0, 0], [0, exp(-z), 0], [0, 0, 1]], name=name)
    return Space(
        name,
        story=(
            "Going up stretches one direction and squeezes the other: the least symmetric of the\n"
            "eight geometries. Its torsion is a shear, without vector and without axial part."
        ),
        source="P. Scott, The geometries of 3-manifolds, Bull. London Math. Soc. 15 (1983) 401, "
        "section 4",
        frame=frame,
        known=(
            KnownAnswer("determinant", 1),
            KnownAnswer(
                "torsion", antisymmetric({(2, 0, 0): half, (2, 1, 1): -half}), basis="frame"
            ),
            KnownAnswer("torsion_vector", {}),
            KnownAnswer("torsion_axial", {}),
            KnownAnswer("torsion_scalar", 2),
            KnownAnswer("cartan_curvature", {}),
            KnownAnswer("ricci", diagonal([0, 0, -2]), basis="frame"),
            KnownAnswer("scalar_curvature", -2),
        ),
        group="homogeneous spaces",
    )

"""edge_dislocation: a straight edge dislocation along z, topological and in elastic equilibrium."""

from sympy import Rational, Symbol, pi, symbols

from geomtorsion.geometry import Frame
from geomtorsion.spaces.space import FirstMotion, KnownAnswer, Space, box, matrix


def space(name: str) -> Space:
    """Coframe dx^i + du^i with the displacement u of a Burgers vector b along x."""
    x, y, z = symbols("x y z", real=True)
    b = Symbol("b", positive=True)
    nu = Symbol("nu", positive=True)
    square = x**2 + y**2
    scale = b / (2 * pi)
    shared = (KnownAnswer("torsion", {}), KnownAnswer("riemann", {}))
    if name == "edge_dislocation":
        f = scale / square
        return Space(
            name,
            story=(
                "An extra half plane of atoms ends on the z axis: walks around it miss b along x.\n"
                "Torsion vanishes off the axis, and yet no loop around it closes."
            ),
            source="R. A. Puntigam, H. H. Soleng, Class. Quantum Grav. 14 (1997) 1129 "
            "(Volterra distortions)",
            frame=Frame(
                (x, y, z),
                [[1 - f * y, f * x, 0], [0, 1, 0], [0, 0, 1]],
                parameters=(b,),
                # Outside of the circle on which the coframe is singular; it goes through the axis.
                domain=2 * pi * square > b * y,
                name=name,
            ),
            known=(
                KnownAnswer("determinant", 1 - f * y),
                KnownAnswer(
                    "metric",
                    matrix(
                        [
                            [(1 - f * y) ** 2, (1 - f * y) * f * x, 0],
                            [(1 - f * y) * f * x, 1 + f**2 * x**2, 0],
                            [0, 0, 1],
                        ]
                    ),
                ),
                *shared,
            ),
            motion=FirstMotion((4.14, -1.36, -1.07), (0.802, 0.535, 0.267), parameters={"b": 0.48}),
            group="defects in crystals",
            notes="The displacement u_x = b phi / (2 pi) is multivalued, its differential is not. "
            "The coframe is singular on the axis and on the circle x^2 + y^2 = b y / (2 pi). The "
            "domain is outside of this circle: a loop that enters it is refused. Make loops around "
            "the axis wider than b / (2 pi).",
        )
    w = scale / (2 * (1 - nu) * square**2)
    distortion = [
        [
            -scale * y / square + w * y * (y**2 - x**2),
            scale * x / square + w * x * (x**2 - y**2),
        ],
        [
            -w * x * ((1 - 2 * nu) * square + 2 * y**2),
            -w * y * ((1 - 2 * nu) * square - 2 * x**2),
        ],
    ]
    (xx, xy), (yx, yy) = distortion
    return Space(
        name,
        story=(
            "The edge dislocation as an isotropic elastic body carries it, Poisson ratio nu.\n"
            "A loop sees the same b as the topological one: stress moves atoms, not the count."
        ),
        source="J. P. Hirth, J. Lothe, Theory of Dislocations, 2nd ed., chapter 3 "
        "(displacements of an edge dislocation)",
        frame=Frame(
            (x, y, z),
            [[1 + xx, xy, 0], [yx, 1 + yy, 0], [0, 0, 1]],
            parameters=(b, nu),
            domain=[square > 0, *box({nu: (0, Rational(1, 2))})],
            name=name,
        ),
        known=(KnownAnswer("determinant", (1 + xx) * (1 + yy) - xy * yx), *shared),
        motion=FirstMotion(
            (4.14, -1.36, -1.07), (0.802, 0.535, 0.267), parameters={"b": 0.48, "nu": 0.16}
        ),
        group="defects in crystals",
        notes="The distortion is the gradient of a multivalued displacement; near the axis, "
        "within a few b, the coframe becomes singular and linear elasticity means nothing.",
    )

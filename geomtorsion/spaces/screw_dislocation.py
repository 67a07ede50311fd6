"""screw_dislocation: a straight screw dislocation along z, as a line and with a smooth core."""

from sympy import Symbol, pi, symbols

from geomtorsion.geometry import Frame
from geomtorsion.spaces.space import FirstMotion, KnownAnswer, Space, antisymmetric, matrix

SOURCE = "H. Kleinert, Gauge Fields in Condensed Matter, vol. II: Stresses and Defects (1989)"


def space(name: str) -> Space:
    """Coframe (dx, dy, dz + f (x dy - y dx)), f = b / (2 pi (x^2 + y^2 + core^2))."""
    x, y, z = symbols("x y z", real=True)
    b = Symbol("b", positive=True)
    core = Symbol("c", positive=True)
    smooth = name == "screw_core"
    square = x**2 + y**2 + (core**2 if smooth else 0)
    f = b / (2 * pi * square)
    frame = Frame(
        (x, y, z),
        [[1, 0, 0], [0, 1, 0], [-f * y, f * x, 1]],
        parameters=(b, core) if smooth else (b,),
        domain=None if smooth else x**2 + y**2 > 0,
        name=name,
    )
    metric = matrix(
        [
            [1 + f**2 * y**2, -(f**2) * x * y, -f * y],
            [-(f**2) * x * y, 1 + f**2 * x**2, f * x],
            [-f * y, f * x, 1],
        ]
    )
    shared = (
        KnownAnswer("metric", metric),
        KnownAnswer("determinant", 1),
        KnownAnswer("cartan_curvature", {}),
    )
    if smooth:
        density = b * core**2 / (pi * square**2)
        return Space(
            name,
            story=(
                "A screw dislocation whose Burgers vector is spread over a core of radius c.\n"
                "Smooth everywhere: loop integral and flux of torsion can both be taken, and agree."
            ),
            source=SOURCE,
            frame=frame,
            known=(
                *shared,
                KnownAnswer("torsion", antisymmetric({(0, 1, 2): density / 2}), basis="frame"),
                KnownAnswer("torsion_vector", {}),
                KnownAnswer("torsion_scalar", density**2 / 2),
                KnownAnswer("scalar_curvature", -(density**2) / 2),
            ),
            group="defects in crystals",
            notes="A loop of radius r about the axis has b3 = b r^2 / (r^2 + c^2).",
        )
    return Space(
        name,
        story=(
            "A walk once around the axis ends one step b higher: a spiral staircase.\n"
            "Torsion and curvature vanish off the axis; all of the Burgers vector sits on the line."
        ),
        source=SOURCE,
        frame=frame,
        known=(*shared, KnownAnswer("torsion", {}), KnownAnswer("riemann", {})),
        motion=FirstMotion((4.14, 2.27, -1.07), (0.802, 0.535, 0.267), parameters={"b": 0.48}),
        group="defects in crystals",
        notes="The coframe is single-valued but closed without being exact: its potential "
        "z + b phi / (2 pi) is multivalued. The axis x = y = 0 is cut out of the domain.",
    )

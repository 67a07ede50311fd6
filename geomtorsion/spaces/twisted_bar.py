"""twisted_bar: a crystal whose lattice turns steadily about z, in flat space."""

from sympy import Symbol, cos, sin, symbols

from geomtorsion.geometry import Frame
from geomtorsion.spaces.space import KnownAnswer, Space, alternating, antisymmetric, diagonal


def space(name: str) -> Space:
    """The Cartesian coframe turned about z by the angle kappa z."""
    x, y, z = symbols("x y z", real=True)
    kappa = Symbol("kappa", positive=True)
    c, s = cos(kappa * z), sin(kappa * z)
    frame = Frame((x, y, z), [[c, s, 0], [-s, c, 0], [0, 0, 1]], parameters=(kappa,), name=name)
    return Space(
        name,
        story=(
            "A twisted whisker or a cholesteric: lattice planes that turn as one climbs.\n"
            "Space stays flat; the torsion counts the screw dislocations that the twist needs."
        ),
        source="J. F. Nye, Some geometrical relations in dislocated crystals, "
        "Acta Metall. 1 (1953) 153",
        frame=frame,
        known=(
            KnownAnswer("metric", diagonal([1, 1, 1])),
            KnownAnswer(
                "torsion",
                antisymmetric({(1, 2, 0): -kappa / 2, (2, 0, 1): -kappa / 2}),
                basis="frame",
            ),
            KnownAnswer("torsion_vector", {}),
            KnownAnswer("torsion_axial", alternating({(0, 1, 2): -2 * kappa / 3}), basis="frame"),
            KnownAnswer("torsion_scalar", 0),
            KnownAnswer("cartan_curvature", {}),
            KnownAnswer("riemann", {}),
        ),
        group="defects in crystals",
    )

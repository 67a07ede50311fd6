"""ax_plus_b: the group of maps x -> a x + b with its left-invariant frame."""

from sympy import Rational, oo, symbols

from geomtorsion.geometry import Frame
from geomtorsion.spaces.space import KnownAnswer, Space, antisymmetric, box, diagonal


def space(name: str) -> Space:
    """Coframe (da/a, db/a), a > 0."""
    a, b = symbols("a b", real=True)
    half = Rational(1, 2)
    frame = Frame((a, b), [[1 / a, 0], [0, 1 / a]], domain=box({a: (0, oo)}), name=name)
    return Space(
        name,
        story=(
            "Zoom and shift: the smallest group that does not commute, home of wavelets.\n"
            "Its metric is the hyperbolic plane; its torsion expresses [zoom, shift] = shift."
        ),
        source="J. Milnor, Curvatures of left invariant metrics on Lie groups, "
        "Adv. Math. 21 (1976) 293 (groups of constant negative curvature)",
        frame=frame,
        known=(
            KnownAnswer("metric", diagonal([1 / a**2, 1 / a**2])),
            KnownAnswer("torsion", antisymmetric({(0, 1, 1): -half}), basis="frame"),
            KnownAnswer("torsion_vector", {(0,): -1}, basis="frame"),
            KnownAnswer("torsion_scalar", 0),
            KnownAnswer("cartan_curvature", {}),
            KnownAnswer("ricci", diagonal([-1, -1]), basis="frame"),
            KnownAnswer("scalar_curvature", -2),
        ),
        group="homogeneous spaces",
    )

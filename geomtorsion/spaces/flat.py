"""flat: flat space in the orthonormal frames of curvilinear coordinates."""

from __future__ import annotations

from sympy import Expr, Symbol, cos, oo, pi, sin, symbols

from geomtorsion.geometry import Frame
from geomtorsion.spaces.space import KnownAnswer, Space, antisymmetric, box, diagonal

STORIES = {
    "flat_polar": (
        "The plane with legs that point outwards and around: the smallest frame with torsion.\n"
        "The metric is flat; the torsion only says that the legs turn against the plane."
    ),
    "flat_cylindrical": (
        "Flat space with the legs of cylindrical coordinates, as used along wires and pipes.\n"
        "Parallel in this frame means parallel to the coordinate lines: torsion without curvature."
    ),
    "flat_spherical": (
        "Flat space with the legs of spherical coordinates, as used around a centre.\n"
        "Both curvatures vanish, the torsion does not: a frame may turn where nothing is bent."
    ),
}


def space(name: str, title: str) -> Space:
    """The frame (scale_k dq_k) of the coordinates of this name."""
    coordinates, scales, domain, torsion, scalar = _table(name)
    frame = Frame(
        coordinates,
        [[scale if i == k else 0 for i in range(len(scales))] for k, scale in enumerate(scales)],
        domain=box(domain),
        name=name,
    )
    halved = {index: value / 2 for index, value in torsion.items()}
    return Space(
        name,
        title,
        story=STORIES[name],
        source="P. M. Morse, H. Feshbach, Methods of Theoretical Physics I, section 1.3 "
        "(scale factors)",
        frame=frame,
        known=(
            KnownAnswer("metric", diagonal([scale**2 for scale in scales])),
            KnownAnswer("torsion", antisymmetric(halved), basis="frame"),
            KnownAnswer("torsion_axial", {}),
            KnownAnswer("torsion_scalar", scalar),
            KnownAnswer("cartan_curvature", {}),
            KnownAnswer("riemann", {}),
            KnownAnswer("scalar_curvature", 0),
        ),
        group="flat space",
        notes="The axis is cut out of the domain: there the legs have no direction.",
    )


def _table(
    name: str,
) -> tuple[
    tuple[Symbol, ...],
    list[Expr | int],
    dict[Symbol, tuple[Expr | int, Expr | int]],
    dict[tuple[int, ...], Expr],
    Expr | int,
]:
    """Coordinates, scale factors, domain, 2 S_ij^k with i < j in the frame, torsion scalar."""
    r, theta, phi, z = symbols("r theta phi z", real=True)
    around = {phi: (0, 2 * pi)}
    if name == "flat_polar":
        return (r, phi), [1, r], {r: (0, oo), **around}, {(0, 1, 1): 1 / r}, 0
    if name == "flat_cylindrical":
        return (r, phi, z), [1, r, 1], {r: (0, oo), **around}, {(0, 1, 1): 1 / r}, 0
    return (
        (r, theta, phi),
        [1, r, r * sin(theta)],
        {r: (0, oo), theta: (0, pi), **around},
        {(0, 1, 1): 1 / r, (0, 2, 2): 1 / r, (1, 2, 2): cos(theta) / (r * sin(theta))},
        -2 / r**2,
    )

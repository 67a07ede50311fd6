"""flat: flat space in the orthonormal frames of curvilinear coordinates."""

from __future__ import annotations

from sympy import Expr, Symbol, atan2, cos, eye, oo, pi, sin, symbols

from geomtorsion.curves.atlas import Atlas, Chart, TransitionMap
from geomtorsion.geometry import Frame
from geomtorsion.spaces.coordinates import AXIS, length, spherical
from geomtorsion.spaces.embedding import Embedding
from geomtorsion.spaces.space import FirstMotion, KnownAnswer, Space, antisymmetric, box, diagonal

STORIES = {
    "flat_polar": (
        "The plane with legs that point outwards and around: the smallest frame with torsion.\n"
        "The metric is flat; the torsion only shows that the legs rotate against the plane."
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

MOTIONS = {
    "flat_polar": FirstMotion((1.0, 0.0), (0.3, 1.0), 8.0),
    "flat_cylindrical": FirstMotion((1.0, 0.0, 0.0), (0.1, 1.0, 0.2), 9.0),
    "flat_spherical": FirstMotion((2.0, 1.9, 0.0), (0.1, -0.3, 1.0), 9.0),
}


def space(name: str) -> Space:
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
        atlas=_atlas,
        embedding=_embedding,
        motion=MOTIONS[name],
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


def _place(frame: Frame) -> tuple[Expr, ...]:
    """Cartesian coordinates of a point."""
    if frame.name == "flat_spherical":
        return spherical(*frame.coordinates)
    r, phi, *height = frame.coordinates
    return (r * cos(phi), r * sin(phi), *height)


def _atlas(frame: Frame) -> Atlas:
    """Cartesian coordinates and the chart of the frame."""
    home, q = frame.name, frame.coordinates
    x, y, z = symbols("x_ y_ z_", real=True)
    plain = (x, y, z)[: frame.dimension]
    if home == "flat_spherical":
        back, angle, edge = (
            (length(*plain), atan2(length(x, y), z), atan2(y, x)),
            2,
            q[0] * sin(q[1]),
        )
    else:
        back, angle, edge = (length(x, y), atan2(y, x), *plain[2:]), 1, q[0]
    unit = Frame(plain, eye(len(plain)).tolist(), name="cartesian")
    makers = {
        "cartesian": lambda: Chart.of(unit, keeps_frame=False),
        home: lambda: Chart.of(frame, edge=edge, margin=AXIS),
    }
    maps = (
        TransitionMap(home, "cartesian", q, _place(frame)),
        TransitionMap("cartesian", home, plain, back, angles=(angle,)),
    )
    return Atlas(home, makers, lambda: maps)


def _embedding(frame: Frame) -> Embedding:
    """The plane, or space."""
    place = _place(frame)
    title = "in the plane" if len(place) == 2 else "in space"
    return Embedding(
        frame.coordinates, place=place, axes=("x", "y", "z")[: len(place)], title=title
    )

"""de_sitter: the static patch of de Sitter space."""

import sympy as sp
from sympy import Rational, Symbol, cos, pi, sin, sqrt, symbols

from geomtorsion.curves.atlas import Atlas, Chart, TransitionMap
from geomtorsion.geometry import Frame
from geomtorsion.spaces.coordinates import length, spherical
from geomtorsion.spaces.embedding import orbit_embedding
from geomtorsion.spaces.space import KnownAnswer, Space, antisymmetric, box, diagonal


def space(name: str) -> Space:
    """Coframe (sqrt(f) dt, dr/sqrt(f), r dtheta, r sin(theta) dphi), f = 1 - r^2 / L^2."""
    t, r, theta, phi = symbols("t r theta phi", real=True)
    length = Symbol("L", positive=True)
    f = 1 - r**2 / length**2
    root = sqrt(f)
    half = Rational(1, 2)
    frame = Frame(
        (t, r, theta, phi),
        [[root, 0, 0, 0], [0, 1 / root, 0, 0], [0, 0, r, 0], [0, 0, 0, r * sin(theta)]],
        signature=(-1, 1, 1, 1),
        parameters=(length,),
        domain=box({r: (0, length), theta: (0, pi), phi: (0, 2 * pi)}),
        name=name,
    )
    torsion = {
        (0, 1, 0): half * r / (length**2 * root),
        (1, 2, 2): half * root / r,
        (1, 3, 3): half * root / r,
        (2, 3, 3): half * cos(theta) / (r * sin(theta)),
    }
    return Space(
        name,
        story=(
            "The visible part of an empty universe that expands for ever.\n"
            "Constant curvature 1/L^2; an observer at rest at r is pushed outwards by T_01^0."
        ),
        source="S. W. Hawking, G. F. R. Ellis, The Large Scale Structure of Space-Time (1973), "
        "section 5.2",
        frame=frame,
        known=(
            KnownAnswer("metric", diagonal([-f, 1 / f, r**2, r**2 * sin(theta) ** 2])),
            KnownAnswer("torsion", antisymmetric(torsion), basis="frame"),
            KnownAnswer("torsion_axial", {}),
            KnownAnswer("torsion_scalar", 6 / length**2 - 2 / r**2),
            KnownAnswer("cartan_curvature", {}),
            KnownAnswer("ricci", diagonal([-3 / length**2, *[3 / length**2] * 3]), basis="frame"),
            KnownAnswer("scalar_curvature", 12 / length**2),
            KnownAnswer("weyl", {}),
            KnownAnswer("kretschmann", 24 / length**4),
        ),
        atlas=_atlas,
        embedding=orbit_embedding,
        group="gravity",
        notes="Signature (-, +, +, +). The horizon r = L is the edge of the patch.",
    )


def _atlas(frame: Frame) -> Atlas:
    """-dT^2 + (dx - x dT / L)^2 in T = t + (L / 2) log(1 - r^2 / L^2): out through the horizon."""
    t, r, theta, phi = frame.coordinates
    (scale,) = frame.parameters
    time, *place = inner = sp.symbols("T x_ y_ z_", real=True)
    radius = length(*place)

    def flowing() -> Chart:
        rows = [[sp.S.One, 0, 0, 0]]
        rows += [[-x / scale, *(sp.Integer(x == y) for y in place)] for x in place]
        painleve = Frame(inner, rows, signature=(-1, 1, 1, 1), parameters=(scale,), name="painleve")
        return Chart.of(painleve, keeps_frame=False)

    advance = scale / 2 * sp.log(1 - r**2 / scale**2)
    there = (t + advance, *spherical(r, theta, phi))
    polar = sp.atan2(length(place[0], place[1]), place[2])
    back = (time - advance.subs(r, radius), radius, polar, sp.atan2(place[1], place[0]))
    edge = (1 - r**2 / scale**2) * r * sp.sin(theta) / scale
    # The rates in the flowing frame take two fifths of the operations: geodesics begin there.
    makers = {
        "painleve": flowing,
        "de_sitter": lambda: Chart.of(frame, edge=edge, margin=0.1),
    }
    inside = {scale: 9, r: 5, t: 0, theta: 1, phi: 1}
    here = dict(zip(inner, (0, 3, 3, 3), strict=True)) | {scale: 9}
    maps = (
        TransitionMap("de_sitter", "painleve", frame.coordinates, there, (scale,), (), inside),
        TransitionMap("painleve", "de_sitter", inner, back, (scale,), (3,), here),
    )
    return Atlas("de_sitter", makers, lambda: maps)

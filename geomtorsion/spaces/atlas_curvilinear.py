"""atlas_curvilinear: second charts for the sphere and for flat space."""

from __future__ import annotations

from collections.abc import Sequence

import sympy as sp

from geomtorsion.curves.atlas import Atlas, Chart, TransitionMap
from geomtorsion.geometry import Frame

# Motions leave a compass when the sine of the colatitude falls below this.
MARGIN = 0.25
# Motions leave polar coordinates this near to the axis, if another chart is allowed.
NEAR = 0.1


def _length(one: sp.Expr, two: sp.Expr) -> sp.Expr:
    return sp.sqrt(one**2 + two**2)


def sphere(frame: Frame) -> Atlas:
    """A second compass whose pole lies on the first one's equator."""
    theta, phi = frame.coordinates
    (radius,) = frame.parameters
    other = sp.symbols("theta_x phi_x", real=True)
    turned = Frame(
        other, [[radius, 0], [0, radius * sp.sin(other[0])]], parameters=(radius,), name="s2_x"
    )
    n = [sp.sin(theta) * sp.cos(phi), sp.sin(theta) * sp.sin(phi), sp.cos(theta)]
    m = [sp.cos(other[0]), sp.sin(other[0]) * sp.cos(other[1]), sp.sin(other[0]) * sp.sin(other[1])]
    there = (sp.atan2(_length(n[1], n[2]), n[0]), sp.atan2(n[2], n[1]))
    back = (sp.atan2(_length(m[0], m[1]), m[2]), sp.atan2(m[1], m[0]))
    makers = {
        "s2": lambda: Chart.of(frame, edge=sp.sin(theta), margin=MARGIN),
        "s2_x": lambda: Chart.of(turned, edge=sp.sin(other[0]), margin=MARGIN, keeps_frame=False),
    }
    maps = (
        TransitionMap("s2", "s2_x", (theta, phi), there, angles=(1,)),
        TransitionMap("s2_x", "s2", other, back, angles=(1,)),
    )
    return Atlas("s2", makers, lambda: maps)


def seven_sphere(frame: Frame) -> Atlas:
    """A second stereographic chart, about the antipode: x / x.x is an isometry."""
    x = frame.coordinates
    y = sp.symbols("y1:8", real=True)

    def turned() -> Chart:
        rows = frame.coframe.to_sympy().subs(dict(zip(x, y, strict=True)), simultaneous=True)
        other = Frame(y, rows.tolist(), name="s7_far")
        return Chart.of(other, edge=_nearness(y), margin=MARGIN, keeps_frame=False)

    makers = {"s7": lambda: Chart.of(frame, edge=_nearness(x), margin=MARGIN), "s7_far": turned}
    maps = tuple(
        TransitionMap(one, other, q, tuple(k / sum(c**2 for c in q) for k in q))
        for one, other, q in (("s7", "s7_far", x), ("s7_far", "s7", y))
    )
    return Atlas("s7", makers, lambda: maps)


def _nearness(x: Sequence[sp.Symbol]) -> sp.Expr:
    """One half plus half of the cosine of the angle from the origin of a stereographic chart."""
    return 1 / (1 + sum(k**2 for k in x))


def cartesian(frame: Frame) -> Atlas:
    """Cartesian coordinates for the flat spaces."""
    x, y, z = sp.symbols("x_ y_ z_", real=True)
    home, q = frame.name, frame.coordinates
    ways = {
        "flat_polar": (
            (x, y),
            lambda r, phi: (r * sp.cos(phi), r * sp.sin(phi)),
            (_length(x, y), sp.atan2(y, x)),
            (1,),
            lambda r, phi: r,
        ),
        "flat_cylindrical": (
            (x, y, z),
            lambda r, phi, height: (r * sp.cos(phi), r * sp.sin(phi), height),
            (_length(x, y), sp.atan2(y, x), z),
            (1,),
            lambda r, phi, height: r,
        ),
        "flat_spherical": (
            (x, y, z),
            spherical,
            (sp.sqrt(x**2 + y**2 + z**2), sp.atan2(_length(x, y), z), sp.atan2(y, x)),
            (2,),
            lambda r, theta, phi: r * sp.sin(theta),
        ),
    }
    plain, there, back, angles, edge = ways[home]
    unit = Frame(plain, sp.eye(len(plain)).tolist(), name="cartesian")
    makers = {
        "cartesian": lambda: Chart.of(unit, keeps_frame=False),
        home: lambda: Chart.of(frame, edge=edge(*q), margin=NEAR),
    }
    maps = (
        TransitionMap(home, "cartesian", q, there(*q)),
        TransitionMap("cartesian", home, plain, back, angles=angles),
    )
    return Atlas(home, makers, lambda: maps)


def spherical(r: sp.Expr, theta: sp.Expr, phi: sp.Expr) -> tuple[sp.Expr, ...]:
    """Cartesian coordinates of spherical ones."""
    return (
        r * sp.sin(theta) * sp.cos(phi),
        r * sp.sin(theta) * sp.sin(phi),
        r * sp.cos(theta),
    )

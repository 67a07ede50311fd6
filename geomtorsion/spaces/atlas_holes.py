"""atlas_holes: a chart of Schwarzschild's space through the horizon and the poles."""

from __future__ import annotations

import sympy as sp

from geomtorsion.curves.atlas import Atlas, Chart, TransitionMap
from geomtorsion.geometry import Frame
from geomtorsion.spaces.atlas_curvilinear import spherical


def _length(one: sp.Expr, two: sp.Expr) -> sp.Expr:
    return sp.sqrt(one**2 + two**2)


def schwarzschild(frame: Frame) -> Atlas:
    """Ingoing Kerr-Schild coordinates: through the horizon and the poles."""
    t, r, theta, phi = frame.coordinates
    (mass,) = frame.parameters
    inner = sp.symbols("T x_ y_ z_", real=True)
    radius = sp.sqrt(sum(x**2 for x in inner[1:]))
    lower = [sp.S.One, *(x / radius for x in inner[1:])]
    upper = [-sp.S.One, *lower[1:]]
    entries = [
        [sp.Integer(a == b) + mass / radius * upper[a] * lower[b] for b in range(4)]
        for a in range(4)
    ]

    def far() -> Chart:
        frame_ = Frame(
            inner, entries, signature=(-1, 1, 1, 1), parameters=(mass,), name="kerr_schild"
        )
        return Chart.of(frame_, keeps_frame=False)

    delay = 2 * mass * sp.log(r / (2 * mass) - 1)
    there = (t + delay, *spherical(r, theta, phi))
    back = (
        inner[0] - delay.subs(r, radius),
        radius,
        sp.atan2(_length(inner[1], inner[2]), inner[3]),
        sp.atan2(inner[2], inner[1]),
    )
    outside = {mass: 1, r: 5, t: 0, theta: 1, phi: 1}
    beyond = dict(zip(inner, (0, 3, 3, 3), strict=True)) | {mass: 1}
    edge = (1 - 2 * mass / r) * sp.sin(theta)
    makers = {
        "schwarzschild": lambda: Chart.of(frame, edge=edge, margin=0.1),
        "kerr_schild": far,
    }
    maps = (
        TransitionMap(
            "schwarzschild", "kerr_schild", (t, r, theta, phi), there, (mass,), (), outside
        ),
        TransitionMap("kerr_schild", "schwarzschild", inner, back, (mass,), (3,), beyond),
    )
    return Atlas("schwarzschild", makers, lambda: maps)

"""atlas_holes: charts through the horizons, and over the poles, of static spaces."""

from __future__ import annotations

from collections.abc import Mapping

import sympy as sp

from geomtorsion.curves.atlas import Atlas, Chart, TransitionMap
from geomtorsion.geometry import Frame
from geomtorsion.spaces.atlas_curvilinear import spherical

INNER = sp.symbols("T x_ y_ z_", real=True)


def _length(one: sp.Expr, two: sp.Expr) -> sp.Expr:
    return sp.sqrt(one**2 + two**2)


def schwarzschild(frame: Frame) -> Atlas:
    """Ingoing Kerr-Schild coordinates: through the horizon and the poles."""
    t, r, theta, phi = frame.coordinates
    (mass,) = frame.parameters
    radius = _radius()
    delay = 2 * mass * sp.log(r / (2 * mass) - 1)
    there = (t + delay, *spherical(r, theta, phi))
    back = (
        INNER[0] - delay.subs(r, radius),
        radius,
        sp.atan2(_length(INNER[1], INNER[2]), INNER[3]),
        sp.atan2(INNER[2], INNER[1]),
    )
    outside = {mass: 1, r: 5, t: 0, theta: 1, phi: 1}
    edge = (1 - 2 * mass / r) * sp.sin(theta)
    return _through_the_horizon(frame, mass, there, back, outside, edge, (3,))


def isotropic(frame: Frame) -> Atlas:
    """The same chart for isotropic coordinates, r = s (1 + M / 2s)^2."""
    t, *place = frame.coordinates
    (mass,) = frame.parameters
    s = sp.sqrt(sum(x**2 for x in place))
    stretch = (1 + mass / (2 * s)) ** 2
    delay = 2 * mass * sp.log((s - mass / 2) ** 2 / (2 * mass * s))
    radius = _radius()
    own = (radius - mass + sp.sqrt(radius**2 - 2 * mass * radius)) / 2
    there = (t + delay, *(x * stretch for x in place))
    back = (
        INNER[0] - 2 * mass * sp.log(radius / (2 * mass) - 1),
        *(x * own / radius for x in INNER[1:]),
    )
    outside = {mass: 1, t: 0, **dict.fromkeys(place, 3)}
    edge = 1 - mass / (2 * s)
    return _through_the_horizon(frame, mass, there, back, outside, edge, ())


def _radius() -> sp.Expr:
    return sp.sqrt(sum(x**2 for x in INNER[1:]))


def _through_the_horizon(
    frame: Frame,
    mass: sp.Symbol,
    there: tuple[sp.Expr, ...],
    back: tuple[sp.Expr, ...],
    outside: Mapping[sp.Symbol, int],
    edge: sp.Expr,
    angles: tuple[int, ...],
) -> Atlas:
    """Home and g = eta + (2 M / r) l l with l = dT + dr."""
    home, radius = frame.name, _radius()
    lower = [sp.S.One, *(x / radius for x in INNER[1:])]
    upper = [-sp.S.One, *lower[1:]]
    entries = [
        [sp.Integer(a == b) + mass / radius * upper[a] * lower[b] for b in range(4)]
        for a in range(4)
    ]

    def far() -> Chart:
        frame_ = Frame(
            INNER, entries, signature=(-1, 1, 1, 1), parameters=(mass,), name="kerr_schild"
        )
        return Chart.of(frame_, keeps_frame=False)

    makers = {
        home: lambda: Chart.of(frame, edge=edge, margin=0.1),
        "kerr_schild": far,
    }
    beyond = dict(zip(INNER, (0, 3, 3, 3), strict=True)) | {mass: 1}
    maps = (
        TransitionMap(home, "kerr_schild", frame.coordinates, there, (mass,), (), outside),
        TransitionMap("kerr_schild", home, INNER, back, (mass,), angles, beyond),
    )
    return Atlas(home, makers, lambda: maps)


def de_sitter(frame: Frame) -> Atlas:
    """-dT^2 + (dx - x dT / L)^2 in T = t + (L / 2) log(1 - r^2 / L^2): out through the horizon."""
    t, r, theta, phi = frame.coordinates
    (length,) = frame.parameters
    time, *place = INNER
    radius = _radius()

    def flowing() -> Chart:
        rows = [[sp.S.One, 0, 0, 0]]
        rows += [[-x / length, *(sp.Integer(x == y) for y in place)] for x in place]
        other = Frame(INNER, rows, signature=(-1, 1, 1, 1), parameters=(length,), name="painleve")
        return Chart.of(other, keeps_frame=False)

    advance = length / 2 * sp.log(1 - r**2 / length**2)
    there = (t + advance, *spherical(r, theta, phi))
    polar = sp.atan2(_length(place[0], place[1]), place[2])
    back = (time - advance.subs(r, radius), radius, polar, sp.atan2(place[1], place[0]))
    edge = (1 - r**2 / length**2) * r * sp.sin(theta) / length
    makers = {
        "de_sitter": lambda: Chart.of(frame, edge=edge, margin=0.1),
        "painleve": flowing,
    }
    inside = {length: 9, r: 5, t: 0, theta: 1, phi: 1}
    here = dict(zip(INNER, (0, 3, 3, 3), strict=True)) | {length: 9}
    maps = (
        TransitionMap("de_sitter", "painleve", frame.coordinates, there, (length,), (), inside),
        TransitionMap("painleve", "de_sitter", INNER, back, (length,), (3,), here),
    )
    return Atlas("de_sitter", makers, lambda: maps)

"""atlas_holes: horizon-penetrating charts of black holes."""

from __future__ import annotations

from collections.abc import Callable

import sympy as sp

from geomtorsion.curves.atlas import Atlas, Chart, TransitionMap
from geomtorsion.geometry import Frame
from geomtorsion.spaces.atlas_curvilinear import spherical

# Ingoing coordinates are left for Cartesian ones where the sine of the colatitude is below this.
AXIS = 0.1


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


def kerr(frame: Frame) -> Atlas:
    """Ingoing Kerr coordinates: through the horizon; Kerr-Schild: through the axis, too."""
    t, r, theta, phi = frame.coordinates
    mass, a = frame.parameters
    inner = sp.symbols("v r_in theta_in phi_in", real=True)
    _, radius, polar, _ = inner
    s, c = sp.sin(polar), sp.cos(polar)
    sigma = radius**2 + a**2 * c**2
    delta = radius**2 - 2 * mass * radius + a**2
    # -Delta/Sigma w^2 + 2 w dr = f1^2 - f0^2 with w = dv - a sin^2 dphi.
    w = [1, 0, 0, -a * s**2]
    other = [-delta / (2 * sigma) * x for x in w]
    other[1] += 1
    turn = [-a * s / sp.sqrt(sigma), 0, 0, (radius**2 + a**2) * s / sp.sqrt(sigma)]
    half = sp.Rational(1, 2)
    entries = [
        [half * x - y for x, y in zip(w, other, strict=True)],
        [half * x + y for x, y in zip(w, other, strict=True)],
        [0, 0, sp.sqrt(sigma), 0],
        turn,
    ]

    def through() -> Chart:
        frame_ = Frame(
            inner, entries, signature=(-1, 1, 1, 1), parameters=(mass, a), name="ingoing"
        )
        return Chart.of(frame_, keeps_frame=False, edge=s, margin=AXIS)

    gap = sp.sqrt(mass**2 - a**2)
    outer, cauchy = mass + gap, mass - gap

    def delay(x: sp.Expr) -> sp.Expr:
        terms = outer * sp.log(x - outer) - cauchy * sp.log(x - cauchy)
        return x + mass / gap * terms

    def lag(x: sp.Expr) -> sp.Expr:
        return a / (2 * gap) * (sp.log(x - outer) - sp.log(x - cauchy))

    there = (t + delay(r), r, theta, phi + lag(r))
    back = (inner[0] - delay(radius), radius, polar, inner[3] - lag(radius))
    values = (0, 5, 1, 1)
    numbers = {mass: 1, a: sp.Rational(1, 2)}
    samples = [dict(zip(q, values, strict=True)) | numbers for q in (frame.coordinates, inner)]
    edge = (1 - 2 * mass / r + a**2 / r**2) * sp.sin(theta)
    everywhere, around, inwards = _kerr_schild(mass, a, inner)
    makers = {
        "kerr": lambda: Chart.of(frame, edge=edge, margin=0.05),
        "ingoing": through,
        "kerr_schild": everywhere,
    }
    maps = (
        TransitionMap("kerr", "ingoing", frame.coordinates, there, (mass, a), (), samples[0]),
        TransitionMap("ingoing", "kerr", inner, back, (mass, a), (3,), samples[1]),
        around,
        inwards,
    )
    return Atlas("kerr", makers, lambda: maps)


def _kerr_schild(
    mass: sp.Symbol, a: sp.Symbol, ingoing: tuple[sp.Symbol, ...]
) -> tuple[Callable[[], Chart], TransitionMap, TransitionMap]:
    """g = eta + 2 H l l in T = v - r and x + i y = (r + i a) sin(theta) exp(i phi_in).

    It ends nowhere but on the ring r = 0. The maps lead from ingoing coordinates and back.
    """
    cartesian = T, x, y, z = sp.symbols("T x_ y_ z_", real=True)
    excess = x**2 + y**2 + z**2 - a**2
    root = sp.sqrt(excess**2 + 4 * a**2 * z**2)
    radius = sp.sqrt((excess + root) / 2)
    across = radius**2 + a**2
    lower = [sp.S.One, (radius * x + a * y) / across, (radius * y - a * x) / across, z / radius]
    upper = [-sp.S.One, *lower[1:]]
    entries = [
        [sp.Integer(i == j) + mass * radius / root * upper[i] * lower[j] for j in range(4)]
        for i in range(4)
    ]

    def everywhere() -> Chart:
        frame = Frame(
            cartesian, entries, signature=(-1, 1, 1, 1), parameters=(mass, a), name="kerr_schild"
        )
        return Chart.of(frame, keeps_frame=False)

    v, r, theta, phi = ingoing
    s = sp.sin(theta)
    out = (
        v - r,
        s * (r * sp.cos(phi) - a * sp.sin(phi)),
        s * (r * sp.sin(phi) + a * sp.cos(phi)),
        r * sp.cos(theta),
    )
    polar = sp.atan2(_length(x, y) / sp.sqrt(across), z / radius)
    back = (T + radius, radius, polar, sp.atan2(y, x) - sp.atan2(a, radius))
    numbers = {mass: 1, a: sp.Rational(1, 2)}
    here = dict(zip(cartesian, (0, 3, 2, 3), strict=True)) | numbers
    there = dict(zip(ingoing, (0, 5, 1, 1), strict=True)) | numbers
    return (
        everywhere,
        TransitionMap("ingoing", "kerr_schild", ingoing, out, (a,), (), there),
        TransitionMap("kerr_schild", "ingoing", cartesian, back, (a,), (3,), here),
    )

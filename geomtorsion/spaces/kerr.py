"""kerr: the rotating black hole in Carter's tetrad, with charts through horizons and axis."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from functools import partial
from typing import Any

import sympy as sp
from sympy import Rational, cos, oo, pi, sin, sqrt, symbols

from geomtorsion.curves.atlas import GAIN, Atlas, Chart, MapFunctions, TransitionMap, Written
from geomtorsion.geometry import Frame
from geomtorsion.spaces.coordinates import AXIS
from geomtorsion.spaces.embedding import orbit_embedding
from geomtorsion.spaces.space import FirstMotion, KnownAnswer, Space, antisymmetric, box, matrix

# Either stereographic chart may be entered at the equator, where its edge is at one.
FAR = 1 / (2 * GAIN)
# Where motions in ingoing coordinates end, though the coordinates are good there for others.
OUTWARDS = (
    "Ingoing coordinates end at the ring r = 0, theta = pi/2, and they grow without bound where a "
    "motion leaves through a horizon outwards. "
)

INWARDS = (
    "Outgoing coordinates end at the ring r = 0, theta = pi/2, and they grow without bound where a "
    "motion, followed into its past, leaves through a horizon outwards. "
)

# Names of the charts, and of the coordinates of each.
INGOING = sp.symbols("v r_in theta_in phi_in", real=True)
NORTH = sp.symbols("v_n r_n x_n y_n", real=True)
SOUTH = sp.symbols("v_s r_s x_s y_s", real=True)
OUTGOING = sp.symbols("u r_out theta_out phi_out", real=True)
NORTH_OUT = sp.symbols("u_n r_on x_on y_on", real=True)
SOUTH_OUT = sp.symbols("u_s r_os x_os y_os", real=True)
CARTESIAN = sp.symbols("T x_ y_ z_", real=True)

Values = Sequence[Any]
Coordinates = tuple[sp.Symbol, ...]
Numbers = Mapping[str, Any]


def space(name: str, title: str) -> Space:
    """Carter's tetrad in Boyer-Lindquist coordinates."""
    t, r, theta, phi = symbols("t r theta phi", real=True)
    mass, a = symbols("M a", positive=True)
    c, s = cos(theta), sin(theta)
    sigma = r**2 + a**2 * c**2
    delta = r**2 - 2 * mass * r + a**2
    slow, long = sqrt(delta) / sqrt(sigma), sqrt(sigma)
    frame = Frame(
        (t, r, theta, phi),
        [
            [slow, 0, 0, -a * s**2 * slow],
            [0, 1 / slow, 0, 0],
            [0, 0, long, 0],
            [-a * s / long, 0, 0, (r**2 + a**2) * s / long],
        ],
        signature=(-1, 1, 1, 1),
        parameters=(mass, a),
        # Outside the outer horizon, r = M + sqrt(M^2 - a^2).
        domain=[delta > 0, *box({r: (mass, oo), theta: (0, pi), phi: (0, 2 * pi)})],
        name=name,
    )
    drag = -2 * mass * r * a * s**2 / sigma
    half = Rational(1, 2)
    return Space(
        name,
        title,
        story=(
            "The rotating black hole, seen by observers for whom light goes in and out evenly.\n"
            "Ricci flat for every mass and spin: a zero that is hard to see and easy to get wrong."
        ),
        source="B. Carter, Commun. Math. Phys. 10 (1968) 280",
        frame=frame,
        known=(
            KnownAnswer(
                "metric",
                matrix(
                    [
                        [-(1 - 2 * mass * r / sigma), 0, 0, drag],
                        [0, sigma / delta, 0, 0],
                        [0, 0, sigma, 0],
                        [drag, 0, 0, (r**2 + a**2 - a * drag) * s**2],
                    ]
                ),
            ),
            KnownAnswer("determinant", sigma * s),
            KnownAnswer(
                "torsion",
                antisymmetric(
                    {
                        (1, 2, 1): half * a**2 * s * c / long**3,
                        (1, 2, 2): half * r * sqrt(delta) / long**3,
                        (1, 3, 3): half * r * sqrt(delta) / long**3,
                        (2, 3, 0): -a * c * sqrt(delta) / long**3,
                        (0, 1, 3): -a * r * s / long**3,
                    }
                ),
                basis="frame",
                complete=False,
            ),
            KnownAnswer("cartan_curvature", {}),
            KnownAnswer("ricci", {}),
            KnownAnswer("scalar_curvature", 0),
            KnownAnswer(
                "kretschmann",
                48
                * mass**2
                * (r**2 - a**2 * c**2)
                * (sigma**2 - 16 * r**2 * a**2 * c**2)
                / sigma**6,
            ),
        ),
        atlas=_atlas,
        embedding=orbit_embedding,
        motion=FirstMotion(
            (0.0, 10.0, math.pi / 2, 0.0), (1.0284, 0.0, 0.0, 0.24), 700.0, {"M": 1.0, "a": 0.9}
        ),
        group="gravity",
        notes="Signature (-, +, +, +), G = c = 1. The domain is the outside of the outer horizon, "
        "where the tetrad ends.",
    )


def _atlas(frame: Frame) -> Atlas:
    """Ingoing Kerr coordinates: through the horizons; with stereographic angles over the axis, too.

    Outgoing ones are those of time reversed, v -> -u, phi_in -> -phi_out: in them a motion that
    comes out of the outer horizon can be followed into its past.
    Kerr-Schild coordinates are for reading: their square roots cancel near the axis, so that no
    motion is followed in them unless they are named.
    """
    mass, a = frame.parameters
    makers = {
        "kerr": partial(Chart.of, frame, edge=_home_edge(frame), margin=AXIS / 2),
        "ingoing": partial(_radial, mass, a, INGOING, 1, "ingoing"),
        "ingoing_north": partial(_stereographic, mass, a, NORTH, 1, "ingoing_north"),
        "ingoing_south": partial(_stereographic, mass, a, SOUTH, -1, "ingoing_south"),
        "outgoing": partial(_radial, mass, a, OUTGOING, -1, "outgoing"),
        "outgoing_north": partial(_stereographic, mass, a, NORTH_OUT, 1, "outgoing_north", -1),
        "outgoing_south": partial(_stereographic, mass, a, SOUTH_OUT, -1, "outgoing_south", -1),
        "kerr_schild": partial(_kerr_schild, mass, a),
    }

    def maps() -> tuple[TransitionMap, ...]:
        return (
            *_to_and_from(frame, "ingoing", INGOING, 1),
            *_over_the_axis(a),
            *_to_and_from_cartesian(a),
            *_to_and_from(frame, "outgoing", OUTGOING, -1),
            *_over_the_axis_outgoing(),
        )

    followed = (
        *("kerr", "ingoing", "ingoing_north", "ingoing_south"),
        *("outgoing", "outgoing_north", "outgoing_south"),
    )
    return Atlas("kerr", makers, maps, followed)


# -- charts ----------------------------------------------------------------------------------------


def _home_edge(frame: Frame) -> sp.Expr:
    _, r, theta, _ = frame.coordinates
    mass, a = frame.parameters
    return (1 - 2 * mass / r + a**2 / r**2) * sp.sin(theta)


def _null_pair(
    mass: sp.Symbol, a: sp.Symbol, r: sp.Expr, sigma: sp.Expr, w: Sequence[sp.Expr]
) -> list[list[sp.Expr]]:
    """Rows f0, f1 with f1^2 - f0^2 = -Delta/Sigma w^2 + 2 w dr for w = dv - a sin^2 dphi."""
    delta = r**2 - 2 * mass * r + a**2
    other = [-delta / (2 * sigma) * x for x in w]
    other[1] += 1
    half = sp.Rational(1, 2)
    return [
        [half * x - y for x, y in zip(w, other, strict=True)],
        [half * x + y for x, y in zip(w, other, strict=True)],
    ]


def _radial(
    mass: sp.Symbol, a: sp.Symbol, q: tuple[sp.Symbol, ...], sense: int, name: str
) -> Chart:
    """Kerr coordinates along ingoing light (v, sense 1), or along outgoing light (u, sense -1)."""
    _, r, theta, _ = q
    s = sp.sin(theta)
    sigma = r**2 + a**2 * sp.cos(theta) ** 2
    long = sp.sqrt(sigma)
    entries = [
        *_null_pair(mass, a, r, sigma, [sp.S.One, sp.S.Zero, sp.S.Zero, -a * s**2]),
        [0, 0, long, 0],
        [-a * s / long, 0, 0, (r**2 + a**2) * s / long],
    ]
    # Time reversed, both the time and the angle change their signs.
    entries = [[sense * row[0], row[1], row[2], sense * row[3]] for row in entries]
    frame = Frame(q, entries, signature=(-1, 1, 1, 1), parameters=(mass, a), name=name)
    end = OUTWARDS if sense > 0 else INWARDS
    return Chart.of(frame, keeps_frame=False, edge=s, margin=AXIS, end=end)


def _stereographic(
    mass: sp.Symbol,
    a: sp.Symbol,
    q: tuple[sp.Symbol, ...],
    side: int,
    name: str,
    sense: int = 1,
) -> Chart:
    """Ingoing coordinates with x + i y = tan(theta/2) exp(i phi), or its cotangent in the south.

    Outgoing ones (sense -1) have u for -v and -y for y.

    With h = 1 + x^2 + y^2 the sphere is 4 (dx^2 + dy^2) / h^2 and sin^2 dphi is
    4 (x dy - y dx) / h^2: all is rational but the length of the legs, and nothing ends at the pole.
    """
    _, r, x, y = q
    y = sense * y
    h = 1 + x**2 + y**2
    cosine = side * (2 - h) / h
    sigma = r**2 + a**2 * cosine**2
    w = [sp.S.One, sp.S.Zero, 4 * a * y / h**2, -4 * a * x / h**2]
    scale = 2 * sp.sqrt(sigma) / h
    along = [scale * a * y / sigma * k for k in w]
    across = [-scale * a * x / sigma * k for k in w]
    along[2] += scale
    across[3] += scale
    entries = [*_null_pair(mass, a, r, sigma, w), along, across]
    frame = Frame(
        q,
        [[sense * row[0], row[1], row[2], sense * row[3]] for row in entries],
        signature=(-1, 1, 1, 1),
        parameters=(mass, a),
        name=name,
    )
    end = OUTWARDS if sense > 0 else INWARDS
    return Chart.of(frame, keeps_frame=False, edge=2 / h, margin=FAR, end=end)


def _kerr_schild(mass: sp.Symbol, a: sp.Symbol) -> Chart:
    """g = eta + 2 H l l in T = v - r and x + i y = (r + i a) sin(theta) exp(i phi_in)."""
    _, x, y, z = CARTESIAN
    radius, root = _spheroid(a)
    across = radius**2 + a**2
    lower = [sp.S.One, (radius * x + a * y) / across, (radius * y - a * x) / across, z / radius]
    upper = [-sp.S.One, *lower[1:]]
    entries = [
        [sp.Integer(i == j) + mass * radius / root * upper[i] * lower[j] for j in range(4)]
        for i in range(4)
    ]
    frame = Frame(
        CARTESIAN, entries, signature=(-1, 1, 1, 1), parameters=(mass, a), name="kerr_schild"
    )
    return Chart.of(frame, keeps_frame=False, end=OUTWARDS)


def _spheroid(a: sp.Symbol) -> tuple[sp.Expr, sp.Expr]:
    """r and r^2 + a^2 cos^2(theta) over Kerr-Schild coordinates."""
    _, x, y, z = CARTESIAN
    excess = x**2 + y**2 + z**2 - a**2
    root = sp.sqrt(excess**2 + 4 * a**2 * z**2)
    return sp.sqrt((excess + root) / 2), root


# -- Boyer-Lindquist and ingoing -------------------------------------------------------------------


def _to_and_from(
    frame: Frame, name: str, charted: tuple[sp.Symbol, ...], sense: int
) -> tuple[TransitionMap, TransitionMap]:
    """v = t + r*, phi_in = phi + r#, outside the outer horizon; for u with the other sense."""
    t, r, theta, phi = frame.coordinates
    mass, a = frame.parameters
    v, radius, polar, turned = charted
    gap = sp.sqrt(mass**2 - a**2)
    outer, cauchy = mass + gap, mass - gap

    def delay(x: sp.Expr) -> sp.Expr:
        terms = outer * sp.log(x - outer) - cauchy * sp.log(x - cauchy)
        return x + mass / gap * terms

    def lag(x: sp.Expr) -> sp.Expr:
        return a / (2 * gap) * (sp.log(x - outer) - sp.log(x - cauchy))

    there = (t + sense * delay(r), r, theta, phi + sense * lag(r))
    back = (v - sense * delay(radius), radius, polar, turned - sense * lag(radius))
    numbers = {mass: 1, a: sp.Rational(1, 2)}
    samples = [
        dict(zip(q, (0, 5, 1, 1), strict=True)) | numbers for q in (frame.coordinates, charted)
    ]

    def inwards(f: MapFunctions, q: Values, p: Numbers) -> Values:
        delayed, lagged = _tortoise(f, q[1], p[mass.name], p[a.name])
        return q[0] + sense * delayed, q[1], q[2], q[3] + sense * lagged

    def outwards(f: MapFunctions, q: Values, p: Numbers) -> Values:
        delayed, lagged = _tortoise(f, q[1], p[mass.name], p[a.name])
        return q[0] - sense * delayed, q[1], q[2], q[3] - sense * lagged

    both = mass, a
    return (
        TransitionMap("kerr", name, frame.coordinates, there, both, (), samples[0], inwards),
        TransitionMap(name, "kerr", charted, back, both, (3,), samples[1], outwards),
    )


def _tortoise(f: MapFunctions, r: Any, mass: Any, a: Any) -> tuple[Any, Any]:
    """r* = r + M log(Delta) - 2 M^2 A and r# = -a A, A = artanh(g / (r - M)) / g.

    g = sqrt(M^2 - a^2). The logarithms of r - r_+ and r - r_- with weights r_+ / g and r_- / g
    are the same, but cancel where the horizons are near each other; here A tends to 1 / (r - M).
    """
    gap = f.sqrt((mass - a) * (mass + a))
    depth = r - mass
    shell = f.log(depth - gap) + f.log(depth + gap)
    area = 1 / depth if gap == 0 else f.atanh(gap / depth) / gap
    return r + mass * shell - 2 * mass * mass * area, -a * area


# -- over the axis ---------------------------------------------------------------------------------


def _over_the_axis(a: sp.Symbol) -> tuple[TransitionMap, ...]:
    """Between ingoing angles, the two stereographic charts and Kerr-Schild coordinates."""
    found = []
    numbers = {a: sp.Rational(1, 2)}
    charts = ("ingoing_north", NORTH, 1), ("ingoing_south", SOUTH, -1)
    for name, q, side in charts:
        w, radius, x, y = q
        square = x**2 + y**2
        h = 1 + square
        cartesian = (
            w - radius,
            2 * (radius * x - a * y) / h,
            2 * (radius * y + a * x) / h,
            side * radius * (1 - square) / h,
        )
        found += _angles_and_back("ingoing", INGOING, name, q, side)
        found.append(
            TransitionMap(name, "kerr_schild", q, cartesian, (a,), (), _inside(q) | numbers)
        )
    return *found, *_over_the_equator(charts)


def _over_the_axis_outgoing() -> tuple[TransitionMap, ...]:
    """The same between outgoing angles and their two stereographic charts."""
    charts = ("outgoing_north", NORTH_OUT, 1), ("outgoing_south", SOUTH_OUT, -1)
    found = [_angles_and_back("outgoing", OUTGOING, name, q, side) for name, q, side in charts]
    return *found[0], *found[1], *_over_the_equator(charts)


def _angles_and_back(
    angles: str, names: Coordinates, name: str, q: Coordinates, side: int
) -> tuple[TransitionMap, TransitionMap]:
    """From angles to x + i y = tan(theta/2) exp(i phi), or its cotangent in the south, and back."""
    time, r, theta, phi = names
    share = sp.sin(theta) / (1 + side * sp.cos(theta))
    there = (time, r, share * sp.cos(phi), share * sp.sin(phi))
    w, radius, x, y = q
    square = x**2 + y**2
    polar = sp.atan2(2 * sp.sqrt(square), side * (1 - square))
    back = (w, radius, polar, sp.atan2(y, x))
    inside = dict(zip(names, (0, 5, 1, 1), strict=True))
    return (
        TransitionMap(angles, name, names, there, (), (), inside, _half_angle(side)),
        TransitionMap(name, angles, q, back, (), (3,), _inside(q)),
    )


def _inside(q: Coordinates) -> dict[sp.Symbol, sp.Expr | int]:
    """A point of a stereographic chart."""
    return dict(zip(q, (0, 5, sp.Rational(1, 2), sp.Rational(1, 3)), strict=True))


def _over_the_equator(
    charts: tuple[tuple[str, Coordinates, int], ...],
) -> tuple[TransitionMap, ...]:
    """From each of two stereographic charts to the other."""
    found = []
    for (one, q, _), (other, _, _) in (charts, charts[::-1]):
        w, radius, x, y = q
        turned = (w, radius, x / (x**2 + y**2), y / (x**2 + y**2))
        found.append(TransitionMap(one, other, q, turned))
    return tuple(found)


def _half_angle(side: int) -> Written:
    """From ingoing angles to x + i y = tan(theta/2) exp(i phi), or its cotangent in the south."""

    def written(f: MapFunctions, q: Values, _: Numbers) -> Values:
        v, r, theta, phi = q
        s, c = f.sin(theta / 2), f.cos(theta / 2)
        share = s / c if side > 0 else c / s
        return v, r, share * f.cos(phi), share * f.sin(phi)

    return written


def _to_and_from_cartesian(a: sp.Symbol) -> tuple[TransitionMap, TransitionMap]:
    """Between ingoing angles and Kerr-Schild coordinates."""
    v, r, theta, phi = INGOING
    T, x, y, z = CARTESIAN
    s = sp.sin(theta)
    out = (
        v - r,
        s * (r * sp.cos(phi) - a * sp.sin(phi)),
        s * (r * sp.sin(phi) + a * sp.cos(phi)),
        r * sp.cos(theta),
    )
    radius, _ = _spheroid(a)
    distance = sp.sqrt(x**2 + y**2)
    polar = sp.atan2(distance / sp.sqrt(radius**2 + a**2), z / radius)
    back = (T + radius, radius, polar, sp.atan2(y, x) - sp.atan2(a, radius))
    numbers = {a: sp.Rational(1, 2)}
    here = dict(zip(CARTESIAN, (0, 3, 2, 3), strict=True)) | numbers
    there = dict(zip(INGOING, (0, 5, 1, 1), strict=True)) | numbers

    def written(f: MapFunctions, q: Values, p: Numbers) -> Values:
        return _spheroidal(f, q, p[a.name])

    return (
        TransitionMap("ingoing", "kerr_schild", INGOING, out, (a,), (), there),
        TransitionMap("kerr_schild", "ingoing", CARTESIAN, back, (a,), (3,), here, written),
    )


def _spheroidal(f: MapFunctions, q: Values, a: Any) -> Values:
    """v, r, theta, phi over T, x, y, z: oblate spheroids about the ring of radius a.

    The distances d, d' from the ring's far and near side have d d' = Sigma and
    (d + d') / 2 = sqrt(r^2 + a^2). Of r^2 and (a cos)^2, whose difference is known, the larger one
    is a sum; the other one follows from their product (a z)^2.
    """
    time, x, y, z = q
    distance = f.hypot(x, y)
    far, near = f.hypot(distance + a, z), f.hypot(distance - a, z)
    excess = (distance - a) * (distance + a) + z * z
    outside = excess >= 0
    larger = f.sqrt((far * near + f.choose(outside, excess, -excess)) / 2)
    smaller = a * z / f.choose(larger == 0, 1, larger)
    r = f.choose(outside, larger, f.choose(z < 0, -smaller, smaller))
    # a cos(theta) is z a / r outside, and the larger one with the sign of z inside.
    scaled = f.choose(outside, z, f.choose(z < 0, -larger, larger))
    unit = f.choose(outside, f.choose(outside, larger, 1), a)
    cosine = scaled / f.choose(unit == 0, 1, unit)
    polar = f.atan2(2 * distance / (far + near), cosine)
    return time + r, r, polar, f.atan2(y, x) - f.atan2(a, r)

"""kerr: the rotating black hole in Carter's tetrad, with charts through horizons and axis."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from functools import partial
from typing import Any

import sympy as sp
from sympy import Rational, cos, oo, pi, sin, sqrt, symbols

from geomtorsion.curves.atlas import GAIN, Atlas, Chart, MapFunctions, TransitionMap
from geomtorsion.geometry import Frame
from geomtorsion.spaces.coordinates import AXIS
from geomtorsion.spaces.embedding import orbit_embedding
from geomtorsion.spaces.space import (
    FirstMotion,
    KnownAnswer,
    Space,
    Table,
    antisymmetric,
    box,
    matrix,
)

# The chart over the axis may be entered at the poles, where its edge is at one.
FAR = 1 / (2 * GAIN)
# Where motions in ingoing coordinates end, though the coordinates are good there for others.
OUTWARDS = (
    "Ingoing coordinates end at the ring r = 0, theta = pi/2, and they grow without bound where a "
    "motion leaves through a horizon outwards. "
)

INWARDS = (
    "Outgoing coordinates end at the axis and at the ring r = 0, theta = pi/2, and they grow "
    "without bound where a motion, followed into its past, leaves through a horizon outwards. "
)

# Names of the charts, and of the coordinates of each.
INGOING = sp.symbols("v r_in theta_in phi_in", real=True)
OVER_AXIS = sp.symbols("v_ax r_ax y_ax z_ax", real=True)
OUTGOING = sp.symbols("u r_out theta_out phi_out", real=True)

Values = Sequence[Any]
Numbers = Mapping[str, Any]


def boyer_lindquist(mass: sp.Expr, a: sp.Expr, r: sp.Expr, theta: sp.Expr) -> Table:
    """Components of the metric of Kerr in t, r, theta, phi."""
    sigma = r**2 + a**2 * cos(theta) ** 2
    delta = r**2 - 2 * mass * r + a**2
    drag = -2 * mass * r * a * sin(theta) ** 2 / sigma
    return matrix(
        [
            [-(1 - 2 * mass * r / sigma), 0, 0, drag],
            [0, sigma / delta, 0, 0],
            [0, 0, sigma, 0],
            [drag, 0, 0, (r**2 + a**2 - a * drag) * sin(theta) ** 2],
        ]
    )


def carter(
    place: Sequence[sp.Symbol],
    delta: sp.Expr,
    a: sp.Symbol,
    parameters: Sequence[sp.Symbol],
    name: str,
) -> Frame:
    """Carter's tetrad in t, r, theta, phi; delta: (r - r+)(r - r-); first parameter: the mass."""
    _, r, theta, phi = place
    c, s = cos(theta), sin(theta)
    sigma = r**2 + a**2 * c**2
    slow, long = sqrt(delta) / sqrt(sigma), sqrt(sigma)
    return Frame(
        place,
        [
            [slow, 0, 0, -a * s**2 * slow],
            [0, 1 / slow, 0, 0],
            [0, 0, long, 0],
            [-a * s / long, 0, 0, (r**2 + a**2) * s / long],
        ],
        signature=(-1, 1, 1, 1),
        parameters=parameters,
        # Outside the outer horizon, the larger zero of delta, which is beyond r = M.
        domain=[delta > 0, *box({r: (parameters[0], oo), theta: (0, pi), phi: (0, 2 * pi)})],
        name=name,
    )


def space(name: str) -> Space:
    """Carter's tetrad in Boyer-Lindquist coordinates."""
    t, r, theta, phi = symbols("t r theta phi", real=True)
    mass, a = symbols("M a", positive=True)
    c, s = cos(theta), sin(theta)
    sigma = r**2 + a**2 * c**2
    long = sqrt(sigma)
    delta = r**2 - 2 * mass * r + a**2
    frame = carter((t, r, theta, phi), delta, a, (mass, a), name)
    half = Rational(1, 2)
    return Space(
        name,
        story=(
            "The rotating black hole, seen by observers for whom light goes in and out evenly.\n"
            "Ricci flat for every mass and spin: a zero that is hard to see and easy to get wrong."
        ),
        source="B. Carter, Commun. Math. Phys. 10 (1968) 280",
        frame=frame,
        known=(
            KnownAnswer("metric", boyer_lindquist(mass, a, r, theta)),
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
    """Ingoing Kerr coordinates through the horizons, and a chart over both poles.

    Outgoing coordinates follow by time reversal, v -> -u, phi_in -> -phi_out: in them a motion that
    comes out of the outer horizon can be followed into its past.
    """
    mass, a = frame.parameters
    makers = {
        "kerr": partial(Chart.of, frame, edge=_home_edge(frame), margin=AXIS / 2),
        "ingoing": partial(_radial, mass, a, INGOING, 1, "ingoing"),
        "axis": partial(_over_the_axis, mass, a),
        "outgoing": partial(_radial, mass, a, OUTGOING, -1, "outgoing"),
    }

    def maps() -> tuple[TransitionMap, ...]:
        return (
            *_to_and_from(frame, "ingoing", INGOING, 1),
            *_to_and_from_axis(),
            *_to_and_from(frame, "outgoing", OUTGOING, -1),
        )

    return Atlas("kerr", makers, maps)


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


def _over_the_axis(mass: sp.Symbol, a: sp.Symbol) -> Chart:
    """Ingoing coordinates with the direction n in the plane: y = n_y / (1 + n_x), z likewise.

    This is the stereographic projection from the point n_x = -1 of the equator, so that one chart
    holds at both poles. With h = 1 + y^2 + z^2 the sphere is 4 (dy^2 + dz^2) / h^2, cos(theta) is
    2 z / h, and a turn around the axis moves (y, z) along k = ((1 + y^2 - z^2) / 2, y z); so
    sin^2 dphi is 4 (k_y dy + k_z dz) / h^2. All is rational but the length of the legs.
    """
    _, r, y, z = OVER_AXIS
    h = 1 + y**2 + z**2
    turn = (1 + y**2 - z**2) / 2, y * z
    sigma = r**2 + (2 * a * z / h) ** 2
    w = [sp.S.One, sp.S.Zero, *(-4 * a * k / h**2 for k in turn)]
    scale = 2 * sp.sqrt(sigma) / h
    across = [[-scale * a * k / sigma * x for x in w] for k in turn]
    for row, place in zip(across, (2, 3), strict=True):
        row[place] += scale
    frame = Frame(
        OVER_AXIS,
        [*_null_pair(mass, a, r, sigma, w), *across],
        signature=(-1, 1, 1, 1),
        parameters=(mass, a),
        name="axis",
    )
    return Chart.of(frame, keeps_frame=False, edge=2 / h, margin=FAR, end=OUTWARDS)


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


def _to_and_from_axis() -> tuple[TransitionMap, TransitionMap]:
    """Between ingoing angles and the plane onto which the sphere is projected."""
    v, r, theta, phi = INGOING
    beside = 1 + sp.sin(theta) * sp.cos(phi)
    there = (v, r, sp.sin(theta) * sp.sin(phi) / beside, sp.cos(theta) / beside)
    w, radius, y, z = OVER_AXIS
    x = (1 - y**2 - z**2) / 2
    back = (w, radius, sp.atan2(sp.sqrt(x**2 + y**2), z), sp.atan2(y, x))
    inside = dict(zip(INGOING, (0, 5, 1, 1), strict=True))
    plane = dict(zip(OVER_AXIS, (0, 5, sp.Rational(1, 2), sp.Rational(1, 3)), strict=True))

    def angles(f: MapFunctions, q: Values, _: Numbers) -> Values:
        y, z = q[2:]
        x = ((1 - z) * (1 + z) - y * y) / 2
        return q[0], q[1], f.atan2(f.hypot(x, y), z), f.atan2(y, x)

    return (
        TransitionMap("ingoing", "axis", INGOING, there, (), (), inside),
        TransitionMap("axis", "ingoing", OVER_AXIS, back, (), (3,), plane, angles),
    )

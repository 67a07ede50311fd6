"""schwarzschild: the black hole in Schwarzschild's coordinates with the static diagonal tetrad."""

import math
from collections.abc import Mapping
from functools import partial

import sympy as sp
from sympy import Rational, Symbol, cos, oo, pi, sin, sqrt, symbols

from geomtorsion.curves.atlas import Atlas, Chart, TransitionMap
from geomtorsion.geometry import Frame
from geomtorsion.spaces.coordinates import length, spherical
from geomtorsion.spaces.embedding import orbit_embedding
from geomtorsion.spaces.space import FirstMotion, KnownAnswer, Space, antisymmetric, box, diagonal

INNER = sp.symbols("T x_ y_ z_", real=True)


def space(name: str) -> Space:
    """Coframe (sqrt(f) dt, dr/sqrt(f), r dtheta, r sin(theta) dphi), f = 1 - 2 M / r."""
    t, r, theta, phi = symbols("t r theta phi", real=True)
    mass = Symbol("M", positive=True)
    f = 1 - 2 * mass / r
    root = sqrt(f)
    half = Rational(1, 2)
    frame = Frame(
        (t, r, theta, phi),
        [[root, 0, 0, 0], [0, 1 / root, 0, 0], [0, 0, r, 0], [0, 0, 0, r * sin(theta)]],
        signature=(-1, 1, 1, 1),
        parameters=(mass,),
        domain=box({r: (2 * mass, oo), theta: (0, pi), phi: (0, 2 * pi)}),
        name=name,
    )
    torsion = {
        (0, 1, 0): -half * mass / (r**2 * root),
        (1, 2, 2): half * root / r,
        (1, 3, 3): half * root / r,
        (2, 3, 3): half * cos(theta) / (r * sin(theta)),
    }
    return Space(
        name,
        story=(
            "The field outside a spherical star, with rods and clocks at rest.\n"
            "Ricci flat: curvature causes only tides; the torsion T_10^0 is the felt weight."
        ),
        source="C. W. Misner, K. S. Thorne, J. A. Wheeler, Gravitation (1973), chapter 31",
        frame=frame,
        known=(
            KnownAnswer("metric", diagonal([-f, 1 / f, r**2, r**2 * sin(theta) ** 2])),
            KnownAnswer("determinant", r**2 * sin(theta)),
            KnownAnswer("torsion", antisymmetric(torsion), basis="frame"),
            KnownAnswer("torsion_axial", {}),
            KnownAnswer("torsion_scalar", -2 / r**2),
            KnownAnswer("cartan_curvature", {}),
            KnownAnswer("ricci", {}),
            KnownAnswer("einstein", {}),
            KnownAnswer("scalar_curvature", 0),
            KnownAnswer("kretschmann", 48 * mass**2 / r**6),
        ),
        atlas=around_the_centre,
        embedding=orbit_embedding,
        motion=FirstMotion(
            (0.0, 10.0, math.pi / 2, 0.0), (1.0628, 0.0, 0.0, 0.36), 700.0, {"M": 1.0}
        ),
        group="gravity",
        notes="Signature (-, +, +, +), G = c = 1. The chart covers the outside, r > 2 M.",
    )


def around_the_centre(frame: Frame, legs: Frame | None = None) -> Atlas:
    """Ingoing Kerr-Schild coordinates beside t, r, theta, phi: through the horizon and the poles.

    legs: a frame of the same metric in the same coordinates, which geodesics follow first.
    """
    t, r, theta, phi = frame.coordinates
    (mass,) = frame.parameters
    radius = length(*INNER[1:])
    delay = 2 * mass * sp.log(r / (2 * mass) - 1)
    there = (t + delay, *spherical(r, theta, phi))
    back = (
        INNER[0] - delay.subs(r, radius),
        radius,
        sp.atan2(length(INNER[1], INNER[2]), INNER[3]),
        sp.atan2(INNER[2], INNER[1]),
    )
    outside = {mass: 1, r: 5, t: 0, theta: 1, phi: 1}
    edge = (1 - 2 * mass / r) * sp.sin(theta)
    return through_the_horizon(frame, mass, there, back, outside, edge, (3,), legs)


def through_the_horizon(
    frame: Frame,
    mass: sp.Symbol,
    there: tuple[sp.Expr, ...],
    back: tuple[sp.Expr, ...],
    outside: Mapping[sp.Symbol, int],
    edge: sp.Expr,
    angles: tuple[int, ...],
    legs: Frame | None = None,
) -> Atlas:
    """The chart of the frame, and g = eta + (2 M / r) l l with l = dT + dr.

    legs: a frame of the same metric in the same coordinates, which geodesics follow first.
    """
    home, radius = frame.name, length(*INNER[1:])
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
    same = ()
    if legs is not None:
        first = partial(Chart.of, legs, edge=edge, margin=0.1, keeps_frame=False)
        makers = {legs.name: first} | makers
        pairs = ((home, legs.name), (legs.name, home))
        same = tuple(TransitionMap(*pair, frame.coordinates, frame.coordinates) for pair in pairs)
    beyond = dict(zip(INNER, (0, 3, 3, 3), strict=True)) | {mass: 1}
    maps = (
        TransitionMap(home, "kerr_schild", frame.coordinates, there, (mass,), (), outside),
        TransitionMap("kerr_schild", home, INNER, back, (mass,), angles, beyond),
        *same,
    )
    return Atlas(home, makers, lambda: maps)

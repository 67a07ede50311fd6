"""schwarzschild_isotropic: the black hole in isotropic coordinates, legs along x, y, z."""

import sympy as sp
from sympy import Symbol, sqrt, symbols

from geomtorsion.curves.atlas import Atlas
from geomtorsion.geometry import Frame
from geomtorsion.spaces.coordinates import length
from geomtorsion.spaces.schwarzschild import INNER, through_the_horizon
from geomtorsion.spaces.space import FirstMotion, KnownAnswer, Space, antisymmetric, diagonal


def space(name: str) -> Space:
    """Coframe (h dt, w dx, w dy, w dz), w = (1 + M/2s)^2, h = (1 - M/2s)/(1 + M/2s)."""
    t, x, y, z = symbols("t x y z", real=True)
    place = (x, y, z)
    mass = Symbol("M", positive=True)
    s = sqrt(x**2 + y**2 + z**2)
    inner, outer = 1 - mass / (2 * s), 1 + mass / (2 * s)
    height, width = inner / outer, outer**2
    frame = Frame(
        (t, x, y, z),
        [[height, 0, 0, 0], [0, width, 0, 0], [0, 0, width, 0], [0, 0, 0, width]],
        signature=(-1, 1, 1, 1),
        parameters=(mass,),
        # Outside the horizon s = M/2.
        domain=4 * (x**2 + y**2 + z**2) > mass**2,
        name=name,
    )
    torsion = {}
    for k, along in enumerate(place, start=1):
        torsion[k, 0, 0] = mass * along / (2 * s**3 * outer**3 * inner)
        for j in range(1, 4):
            if j != k:
                torsion[k, j, j] = -mass * along / (2 * s**3 * outer**3)
    return Space(
        name,
        story=(
            "The same black hole with legs along x, y, z, which agree with flat space far away.\n"
            "A proper tetrad: gravity causes all of its torsion, which vanishes with the mass."
        ),
        source="C. W. Misner, K. S. Thorne, J. A. Wheeler, Gravitation (1973), chapter 31 "
        "(isotropic coordinates)",
        frame=frame,
        known=(
            KnownAnswer("metric", diagonal([-(height**2), width**2, width**2, width**2])),
            KnownAnswer("determinant", inner * outer**5),
            KnownAnswer("torsion", antisymmetric(torsion), basis="frame"),
            KnownAnswer("torsion_axial", {}),
            KnownAnswer("ricci", {}),
            KnownAnswer("kretschmann", 48 * mass**2 / (s * outer**2) ** 6),
        ),
        atlas=_atlas,
        motion=FirstMotion(
            (-1.72, 0.63, 0.73, 0.93), (1.25, 0.5, 0.25, 0.5), parameters={"M": 0.43}
        ),
        group="gravity",
        notes="Signature (-, +, +, +), G = c = 1; s > M/2 is the outside.",
    )


def _atlas(frame: Frame) -> Atlas:
    """Ingoing Kerr-Schild coordinates, r = s (1 + M / 2s)^2."""
    t, *place = frame.coordinates
    (mass,) = frame.parameters
    s = length(*place)
    stretch = (1 + mass / (2 * s)) ** 2
    delay = 2 * mass * sp.log((s - mass / 2) ** 2 / (2 * mass * s))
    radius = length(*INNER[1:])
    own = (radius - mass + sp.sqrt(radius**2 - 2 * mass * radius)) / 2
    there = (t + delay, *(x * stretch for x in place))
    back = (
        INNER[0] - 2 * mass * sp.log(radius / (2 * mass) - 1),
        *(x * own / radius for x in INNER[1:]),
    )
    outside = {mass: 1, t: 0, **dict.fromkeys(place, 3)}
    edge = 1 - mass / (2 * s)
    return through_the_horizon(frame, mass, there, back, outside, edge, ())

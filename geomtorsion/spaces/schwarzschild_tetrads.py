"""schwarzschild_tetrads: the black hole in two more tetrads, tending to Cartesian and falling."""

from sympy import Rational, cos, oo, pi, sin, sqrt, symbols

from geomtorsion.curves.atlas import Atlas
from geomtorsion.geometry import Frame
from geomtorsion.spaces.schwarzschild import around_the_centre
from geomtorsion.spaces.space import (
    FirstMotion,
    KnownAnswer,
    Space,
    antisymmetric,
    box,
    diagonal,
    matrix,
)

T, R, THETA, PHI = COORDINATES = symbols("t r theta phi", real=True)
MASS = symbols("M", positive=True)
HALF = Rational(1, 2)
KRETSCHMANN = 48 * MASS**2 / R**6


def space(name: str) -> Space:
    """Legs along x, y, z over spherical coordinates, or legs that fall from rest at infinity."""
    return _cartesian(name) if name == "schwarzschild_cartesian" else _falling(name)


def _cartesian(name: str) -> Space:
    """Coframe (h dt, n^a dr/h + r dn^a), h = sqrt(1 - 2M/r), n the direction from the centre."""
    h = sqrt(1 - 2 * MASS / R)
    n = (sin(THETA) * cos(PHI), sin(THETA) * sin(PHI), cos(THETA))
    rows = [[0, x / h, R * x.diff(THETA), R * x.diff(PHI)] for x in n]
    frame = Frame(
        COORDINATES,
        [[h, 0, 0, 0], *rows],
        signature=(-1, 1, 1, 1),
        parameters=(MASS,),
        domain=box({R: (2 * MASS, oo), THETA: (0, pi), PHI: (0, 2 * pi)}),
        name=name,
    )
    torsion = {(b + 1, 0, 0): HALF * MASS * n[b] / (R**2 * h) for b in range(3)}
    for b in range(3):
        for c in range(3):
            if b != c:
                torsion[b + 1, c + 1, c + 1] = HALF * (h - 1) / R * n[b]
    return Space(
        name,
        story=(
            "The black hole with legs that tend to those along x, y, z, in spherical coordinates.\n"
            "In this frame the energy of Moeller and Maluf in a sphere is r (1 - sqrt(1 - 2M/r))."
        ),
        source="J. W. Maluf, Ann. Phys. (Berlin) 525 (2013) 339",
        frame=frame,
        known=(
            KnownAnswer("metric", diagonal([-(h**2), 1 / h**2, R**2, (R * sin(THETA)) ** 2])),
            KnownAnswer("determinant", R**2 * sin(THETA)),
            KnownAnswer("torsion", antisymmetric(torsion), basis="frame"),
            KnownAnswer("torsion_axial", {}),
            KnownAnswer("ricci", {}),
            KnownAnswer("kretschmann", KRETSCHMANN),
        ),
        atlas=_with_diagonal_legs,
        motion=FirstMotion((0.0, 8.0, 1.2, 0.3), (1.25, 0.5, 0.25, 0.5), parameters={"M": 1.0}),
        group="gravity",
        notes="Signature (-, +, +, +), G = c = 1.",
    )


def _with_diagonal_legs(frame: Frame) -> Atlas:
    """Geodesics follow the legs along dt, dr, dtheta, dphi, whose rates have half the terms."""
    h = sqrt(1 - 2 * MASS / R)
    rows = [[0] * k + [x] + [0] * (3 - k) for k, x in enumerate((h, 1 / h, R, R * sin(THETA)))]
    legs = Frame(
        COORDINATES,
        rows,
        signature=(-1, 1, 1, 1),
        parameters=(MASS,),
        domain=frame.domain,
        name="diagonal",
    )
    return around_the_centre(frame, legs)


def _falling(name: str) -> Space:
    """Coframe (dt, dr + w dt, r dtheta, r sin(theta) dphi), w = sqrt(2M/r)."""
    w = sqrt(2 * MASS / R)
    frame = Frame(
        COORDINATES,
        [[1, 0, 0, 0], [w, 1, 0, 0], [0, 0, R, 0], [0, 0, 0, R * sin(THETA)]],
        signature=(-1, 1, 1, 1),
        parameters=(MASS,),
        domain=box({R: (0, oo), THETA: (0, pi), PHI: (0, 2 * pi)}),
        name=name,
    )
    torsion = {(0, 1, 1): w / (4 * R), (2, 3, 3): HALF * cos(THETA) / (R * sin(THETA))}
    for k in (2, 3):
        torsion |= {(1, k, k): HALF / R, (0, k, k): -HALF * w / R}
    return Space(
        name,
        story=(
            "The black hole of observers who fall from rest: Painleve's and Gullstrand's time.\n"
            "Nothing happens at the horizon, and every slice of constant time is flat space."
        ),
        source="K. Martel, E. Poisson, Am. J. Phys. 69 (2001) 476",
        frame=frame,
        known=(
            KnownAnswer(
                "metric",
                matrix(
                    [
                        [-(1 - 2 * MASS / R), w, 0, 0],
                        [w, 1, 0, 0],
                        [0, 0, R**2, 0],
                        [0, 0, 0, (R * sin(THETA)) ** 2],
                    ]
                ),
            ),
            KnownAnswer("determinant", R**2 * sin(THETA)),
            KnownAnswer("torsion", antisymmetric(torsion), basis="frame"),
            KnownAnswer("torsion_axial", {}),
            KnownAnswer("ricci", {}),
            KnownAnswer("kretschmann", KRETSCHMANN),
        ),
        motion=FirstMotion((0.0, 8.0, 1.2, 0.3), (1.25, 0.5, 0.25, 0.5), parameters={"M": 1.0}),
        group="gravity",
        notes="Signature (-, +, +, +), G = c = 1. The chart ends at r = 0.",
    )

"""atlas_quaternions: the unit quaternion as a chart where others of its sphere end."""

from __future__ import annotations

from collections.abc import Callable, Sequence

import sympy as sp

from geomtorsion.curves.atlas import Atlas, Chart, TransitionMap, Written
from geomtorsion.curves.map_functions import MapFunctions
from geomtorsion.geometry import Frame
from geomtorsion.spaces.atlas_rotations import MARGIN, QUATERNION, quaternion_chart

Q0, Q1, Q2, Q3 = QUATERNION
# Coordinates -> unit quaternion, quaternion -> coordinates, which are angles, edge, written back.
Row = tuple[list[sp.Expr], list[sp.Expr], tuple[int, ...], sp.Expr, Written | None]


def _length(*values: sp.Expr) -> sp.Expr:
    return sp.sqrt(sum(x**2 for x in values))


def _three_components(q: Sequence[sp.Symbol]) -> Row:
    """q1, q2, q3 of the quaternion whose q0 is positive."""
    scalar = sp.sqrt(1 - sum(x**2 for x in q))
    return [scalar, *q], [Q1, Q2, Q3], (), scalar, _upper_half


def _upper_half(f: MapFunctions, q: Sequence[sp.Expr], _: object) -> list[sp.Expr]:
    """A quaternion and its negative are the same rotation: the one with q0 > 0 is meant."""
    return [f.choose(q[0] < 0, -x, x) for x in q[1:]]


def _rodrigues(g: Sequence[sp.Symbol]) -> Row:
    square = 1 + sum(x**2 for x in g)
    there = [x / sp.sqrt(square) for x in (sp.S.One, *g)]
    return there, [Q1 / Q0, Q2 / Q0, Q3 / Q0], (), 1 / square, None


def _axis_angle(q: Sequence[sp.Symbol]) -> Row:
    chi, theta, phi = q
    s = sp.sin(chi / 2)
    across = s * sp.sin(theta)
    there = [sp.cos(chi / 2), across * sp.cos(phi), across * sp.sin(phi), s * sp.cos(theta)]
    back = [
        2 * sp.atan2(_length(Q1, Q2, Q3), Q0),
        sp.atan2(_length(Q1, Q2), Q3),
        sp.atan2(Q2, Q1),
    ]
    return there, back, (2,), across, None


def _hopf(q: Sequence[sp.Symbol]) -> Row:
    eta, one, two = q
    c, s = sp.cos(eta), sp.sin(eta)
    there = [c * sp.cos(one), c * sp.sin(one), s * sp.cos(two), s * sp.sin(two)]
    back = [
        sp.atan2(_length(Q2, Q3), _length(Q0, Q1)),
        sp.atan2(Q1, Q0),
        sp.atan2(Q3, Q2),
    ]
    return there, back, (1, 2), 2 * s * c, None


ROWS: dict[str, Callable[[Sequence[sp.Symbol]], Row]] = {
    "so3_quaternion": _three_components,
    "so3_rodrigues": _rodrigues,
    "so3_axis_angle": _axis_angle,
    "s3": _hopf,
}


def quaternions(frame: Frame) -> Atlas:
    """The unit quaternion, which never ends, and the home chart."""
    home, q = frame.name, frame.coordinates
    there, back, angles, edge, written = ROWS[home](q)
    # Velocities in the frame are those of the body; on the three-sphere they are not halved.
    share = sp.S.One if home == "s3" else sp.S.Half
    makers = {
        "quaternion": lambda: quaternion_chart(share=share),
        home: lambda: Chart.of(frame, edge=edge, margin=MARGIN),
    }
    one, half = sp.Rational(1, 2), sp.Rational(1, 4)
    sample = dict(zip(QUATERNION, (one, half, half, half), strict=True))
    here = dict(zip(q, (half, sp.Rational(1, 3), sp.Rational(1, 5)), strict=True))
    maps = (
        TransitionMap(home, "quaternion", q, tuple(there), sample=here),
        TransitionMap("quaternion", home, QUATERNION, tuple(back), (), angles, sample, written),
    )
    # Angles of the three-sphere hold nearly everywhere; its motions begin in them.
    order = (home, "quaternion") if home == "s3" else ()
    return Atlas(home, makers, lambda: maps, order)

"""rotations: charts of spaces of rotations, and the attitudes of their points."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import cache
from typing import NamedTuple

import sympy as sp

from geomtorsion.curves.atlas import Atlas, Chart, TransitionMap, Written
from geomtorsion.geometry import Frame
from geomtorsion.rigid.attitude import hamilton_product, rotation_rows
from geomtorsion.spaces.coordinates import MARGIN, length
from geomtorsion.spaces.embedding import Embedding
from geomtorsion.spaces.registry import load
from geomtorsion.spaces.space import KnownAnswer, alternating, diagonal

QUATERNION = sp.symbols("Q0 Q1 Q2 Q3", real=True)
AXES = {"x": 1, "y": 2, "z": 3}
# Known answers of each left-invariant frame of rotations, e^i = body-fixed angular velocity.
BODY_FIXED = (
    KnownAnswer("torsion", alternating({(0, 1, 2): -sp.Rational(1, 2)}), basis="frame"),
    KnownAnswer("torsion_scalar", -sp.Rational(3, 2)),
    KnownAnswer("cartan_curvature", {}),
    KnownAnswer("ricci", diagonal([sp.Rational(1, 2)] * 3), basis="frame"),
    KnownAnswer("scalar_curvature", sp.Rational(3, 2)),
)


@dataclass(frozen=True)
class Angles:
    """Three angles about named axes.

    axes: R_axis1(angle1) R_axis2(angle2) R_axis3(angle3) turns body into space.
    order: number of the coordinate that is angle1, angle2, angle3.
    edge: the chart ends where this function of the middle coordinate vanishes.
    """

    axes: str
    order: tuple[int, int, int]
    edge: Callable[[sp.Expr], sp.Expr]


ZYZ = Angles("zyz", (2, 1, 0), sp.sin)
ZXZ = Angles("zxz", (0, 1, 2), sp.sin)
XYZ = Angles("xyz", (0, 1, 2), sp.cos)
ZYX = Angles("zyx", (0, 1, 2), sp.cos)


def from_angles(axes: str, angles: Sequence[sp.Expr]) -> list[sp.Expr]:
    """Unit quaternion of R_axis1(angle1) R_axis2(angle2) R_axis3(angle3)."""
    result: list[sp.Expr] = [sp.S.One, sp.S.Zero, sp.S.Zero, sp.S.Zero]
    for axis, angle in zip(axes, angles, strict=True):
        turn = [sp.cos(angle / 2), sp.S.Zero, sp.S.Zero, sp.S.Zero]
        turn[AXES[axis]] = sp.sin(angle / 2)
        result = hamilton_product(result, turn)
    return result


def rotation(q: Sequence[sp.Expr]) -> sp.Matrix:
    """Rotation matrix of a quaternion, times its length squared."""
    return sp.Matrix(rotation_rows(q))


def to_angles(axes: str, r: sp.Matrix) -> list[sp.Expr]:
    """The three angles of a rotation matrix, or of any positive multiple of it."""
    if axes == "zyz":
        middle = sp.atan2(length(r[0, 2], r[1, 2]), r[2, 2])
        return [sp.atan2(r[1, 2], r[0, 2]), middle, sp.atan2(r[2, 1], -r[2, 0])]
    if axes == "zxz":
        middle = sp.atan2(length(r[0, 2], r[1, 2]), r[2, 2])
        return [sp.atan2(r[0, 2], -r[1, 2]), middle, sp.atan2(r[2, 0], r[2, 1])]
    if axes == "xyz":
        middle = sp.atan2(r[0, 2], length(r[0, 0], r[0, 1]))
        return [sp.atan2(-r[1, 2], r[2, 2]), middle, sp.atan2(-r[0, 1], r[0, 0])]
    # The last of the four: zyx.
    middle = sp.atan2(-r[2, 0], length(r[0, 0], r[1, 0]))
    return [sp.atan2(r[1, 0], r[0, 0]), middle, sp.atan2(r[2, 1], r[2, 2])]


def quaternion_chart(
    space_fixed: bool = False, places: Sequence[sp.Symbol] = (), share: sp.Expr = sp.S.Half
) -> Chart:
    """Unit quaternions, q' = share q u (body) or share u q (space); and x' = R V, if there are x.

    share: one half where u is the angular velocity.
    """
    rows: list[list[sp.Expr]] = []
    for k in range(3):
        unit = [sp.Integer(j == k + 1) for j in range(4)]
        factors = (unit, QUATERNION) if space_fixed else (QUATERNION, unit)
        column = hamilton_product(*factors)
        rows.append([x * share for x in column])
    legs = [[rows[k][mu] for k in range(3)] for mu in range(4)]
    square = sum(x**2 for x in QUATERNION)
    if places:
        turn = rotation(QUATERNION)
        legs = [[*row, 0, 0, 0] for row in legs]
        legs += [[0, 0, 0, *turn.row(k)] for k in range(3)]
    # A quaternion and its negative are the same rotation, but not the same point of a sphere.
    antipodal = (0, 1, 2, 3) if share == sp.S.Half else ()
    return Chart.redundant("quaternion", (*QUATERNION, *places), legs, square, antipodal=antipodal)


def angle_atlas(angles: Angles, frame: Frame, *, space_fixed: bool = False) -> Atlas:
    """The angles of the frame and the unit quaternion, which has no edge.

    Spaces of pure rotations with a body-fixed frame also have angles with another edge.
    """
    home, places = frame.name, frame.coordinates[3:]
    makers = {
        "quaternion": lambda: quaternion_chart(space_fixed, places),
        home: lambda: _angle_chart(angles, frame),
    }
    if places or space_fixed:
        return Atlas(home, makers, lambda: _to_and_from_quaternion(angles, frame))
    second, others = ("so3", ZYZ) if angles == XYZ else ("so3_xyz", XYZ)

    def changes() -> tuple[TransitionMap, ...]:
        back = _to_and_from_quaternion(others, _frame_of(second))
        return (*_to_and_from_quaternion(angles, frame), *back)

    makers[second] = lambda: _angle_chart(others, _frame_of(second))
    return Atlas(home, makers, changes)


def _angle_chart(angles: Angles, frame: Frame) -> Chart:
    return Chart.of(frame, edge=angles.edge(frame.coordinates[1]), margin=MARGIN)


@cache
def _frame_of(name: str) -> Frame:
    """The frame of a second set of angles."""
    return load(name).frame


def _to_and_from_quaternion(angles: Angles, frame: Frame) -> tuple[TransitionMap, TransitionMap]:
    name, coordinates, places = frame.name, frame.coordinates[:3], frame.coordinates[3:]
    own, hub = (*coordinates, *places), (*QUATERNION, *places)
    there = (*from_angles(angles.axes, [coordinates[k] for k in angles.order]), *places)
    back: list[sp.Expr] = [sp.S.Zero] * 3
    for k, angle in zip(angles.order, to_angles(angles.axes, rotation(QUATERNION)), strict=True):
        back[k] = angle
    return (
        TransitionMap(name, "quaternion", own, there),
        TransitionMap("quaternion", name, hub, (*back, *places), angles=(0, 1, 2)),
    )


def angle_embedding(angles: Angles, frame: Frame) -> Embedding:
    """The attitude; coordinates after the three angles are the place of the body."""
    coordinates, place = frame.coordinates[:3], frame.coordinates[3:]
    return Embedding(
        frame.coordinates,
        place=place,
        axes=tuple(symbol.name for symbol in place),
        attitude=rotation(from_angles(angles.axes, [coordinates[k] for k in angles.order])),
        title="path of the body in space" if place else "",
    )


class QuaternionMap(NamedTuple):
    """Three coordinates as functions of a unit quaternion, and back.

    there: the quaternion over the coordinates. back: the coordinates over `QUATERNION`.
    edge: the chart ends where this expression in the coordinates vanishes.
    angles: numbers of coordinates that are angles. written: `back` without cancellation.
    """

    there: list[sp.Expr]
    back: list[sp.Expr]
    edge: sp.Expr
    angles: tuple[int, ...] = ()
    written: Written | None = None


def quaternion_atlas(
    mapping: Callable[[Sequence[sp.Symbol]], QuaternionMap],
    frame: Frame,
    *,
    share: sp.Expr = sp.S.Half,
) -> Atlas:
    """The unit quaternion, which has no edge, and the chart of the frame.

    mapping: coordinates -> how they follow from the quaternion. share: as in `quaternion_chart`.
    """
    home, q = frame.name, frame.coordinates
    there, back, edge, angles, written = mapping(q)
    makers = {
        "quaternion": lambda: quaternion_chart(share=share),
        home: lambda: Chart.of(frame, edge=edge, margin=MARGIN),
    }
    half, quarter = sp.Rational(1, 2), sp.Rational(1, 4)
    sample = dict(zip(QUATERNION, (half, quarter, quarter, quarter), strict=True))
    here = dict(zip(q, (quarter, sp.Rational(1, 3), sp.Rational(1, 5)), strict=True))
    maps = (
        TransitionMap(home, "quaternion", q, tuple(there), sample=here),
        TransitionMap("quaternion", home, QUATERNION, tuple(back), (), angles, sample, written),
    )
    return Atlas(home, makers, lambda: maps)

"""atlas_rotations: sets of Euler angles and the unit quaternion."""

from __future__ import annotations

from collections.abc import Callable, Sequence

import sympy as sp

from geomtorsion.curves.atlas import Atlas, Chart, TransitionMap
from geomtorsion.geometry import Frame
from geomtorsion.rigid.attitude import hamilton_product, rotation_rows
from geomtorsion.spaces.registry import load

# Motions leave a chart of angles when the sine in its determinant falls below this.
MARGIN = 0.25

QUATERNION = sp.symbols("Q0 Q1 Q2 Q3", real=True)
AXES = {"x": 1, "y": 2, "z": 3}


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


def _length(one: sp.Expr, two: sp.Expr) -> sp.Expr:
    return sp.sqrt(one**2 + two**2)


def to_angles(axes: str, r: sp.Matrix) -> list[sp.Expr]:
    """The three angles of a rotation matrix (any positive multiple will do)."""
    if axes == "zyz":
        middle = sp.atan2(_length(r[0, 2], r[1, 2]), r[2, 2])
        return [sp.atan2(r[1, 2], r[0, 2]), middle, sp.atan2(r[2, 1], -r[2, 0])]
    if axes == "zxz":
        middle = sp.atan2(_length(r[0, 2], r[1, 2]), r[2, 2])
        return [sp.atan2(r[0, 2], -r[1, 2]), middle, sp.atan2(r[2, 0], r[2, 1])]
    if axes == "xyz":
        middle = sp.atan2(r[0, 2], _length(r[0, 0], r[0, 1]))
        return [sp.atan2(-r[1, 2], r[2, 2]), middle, sp.atan2(-r[0, 1], r[0, 0])]
    middle = sp.atan2(-r[2, 0], _length(r[0, 0], r[1, 0]))
    return [sp.atan2(r[1, 0], r[0, 0]), middle, sp.atan2(r[2, 1], r[2, 2])]


def quaternion_chart(
    space_fixed: bool = False, places: Sequence[sp.Symbol] = (), share: sp.Expr = sp.S.Half
) -> Chart:
    """Unit quaternions, q' = q u / 2 (body) or u q / 2 (space); and x' = R V, if there are x.

    share: in the place of the half.
    """
    rows: list[list[sp.Expr]] = []
    for k in range(3):
        unit = [sp.Integer(j == k + 1) for j in range(4)]
        factors = (unit, QUATERNION) if space_fixed else (QUATERNION, unit)
        column = hamilton_product(*factors)
        rows.append([x * share for x in column])
    legs = [[rows[k][mu] for k in range(3)] for mu in range(4)]
    kept = sum(x**2 for x in QUATERNION)
    if places:
        turn = rotation(QUATERNION)
        legs = [[*row, 0, 0, 0] for row in legs]
        legs += [[0, 0, 0, *turn.row(k)] for k in range(3)]
    return Chart.redundant("quaternion", (*QUATERNION, *places), legs, kept)


# name -> axes, order of the coordinates in the product of rotations, edge
EULER: dict[str, tuple[str, tuple[int, int, int], Callable[[sp.Expr], sp.Expr]]] = {
    "so3": ("zyz", (2, 1, 0), sp.sin),
    "so3_right": ("zyz", (2, 1, 0), sp.sin),
    "r3xso3": ("zyz", (2, 1, 0), sp.sin),
    "so3_zxz": ("zxz", (0, 1, 2), sp.sin),
    "so3_xyz": ("xyz", (0, 1, 2), sp.cos),
    "so3_zyx": ("zyx", (0, 1, 2), sp.cos),
    "bianchi_ix": ("xyz", (0, 1, 2), sp.cos),
}


def _euler_changes(
    name: str, coordinates: Sequence[sp.Symbol], places: Sequence[sp.Symbol] = ()
) -> tuple[TransitionMap, ...]:
    """Between one set of angles and the quaternion."""
    axes, order, _ = EULER[name]
    own, hub = (*coordinates, *places), (*QUATERNION, *places)
    there = (*from_angles(axes, [coordinates[k] for k in order]), *places)
    angles = to_angles(axes, rotation(QUATERNION))
    back: list[sp.Expr] = [sp.S.Zero] * 3
    for place, angle in zip(order, angles, strict=True):
        back[place] = angle
    return (
        TransitionMap(name, "quaternion", own, there),
        TransitionMap("quaternion", name, hub, (*back, *places), angles=(0, 1, 2)),
    )


def rotations(frame: Frame) -> Atlas:
    """Home angles, a second set of angles whose edge lies elsewhere, and the quaternion."""
    home = frame.name
    second = "so3" if EULER[home][0] == "xyz" else "so3_xyz"
    _, _, edge = EULER[home]
    places = frame.coordinates[3:]

    def own() -> Chart:
        return Chart.of(frame, edge=edge(frame.coordinates[1]), margin=MARGIN)

    def other() -> Chart:
        there = load(second).frame
        function = EULER[second][2]
        return Chart.of(there, edge=function(there.coordinates[1]), margin=MARGIN)

    makers = {"quaternion": lambda: quaternion_chart(home == "so3_right", places), home: own}
    if places or home == "so3_right":
        return Atlas(home, makers, lambda: _euler_changes(home, frame.coordinates[:3], places))

    def changes() -> tuple[TransitionMap, ...]:
        there = load(second).frame.coordinates
        return (*_euler_changes(home, frame.coordinates), *_euler_changes(second, there))

    return Atlas(home, makers | {second: other}, changes)

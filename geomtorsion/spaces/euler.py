"""euler: the rotation group in other Euler conventions, always with the body-fixed frame."""

from __future__ import annotations

from dataclasses import dataclass
from functools import partial

from sympy import Expr, Symbol, cos, pi, sin, symbols

from geomtorsion.geometry import Frame
from geomtorsion.spaces.rotations import (
    BODY_FIXED,
    XYZ,
    ZXZ,
    ZYX,
    Angles,
    angle_atlas,
    angle_embedding,
)
from geomtorsion.spaces.space import KnownAnswer, Space, box


@dataclass(frozen=True)
class Convention:
    """One row of the table: what differs between two sets of Euler angles."""

    angles: Angles
    coordinates: tuple[Symbol, ...]
    coframe: list[list[Expr | int]]
    domain: dict[Symbol, tuple[Expr | int, Expr | int]]
    determinant: Expr
    story: str
    source: str


def _zxz() -> Convention:
    """Attitude Rz(phi) Rx(theta) Rz(psi)."""
    phi, theta, psi = symbols("phi theta psi", real=True)
    return Convention(
        angles=ZXZ,
        coordinates=(phi, theta, psi),
        coframe=[
            [sin(theta) * sin(psi), cos(psi), 0],
            [sin(theta) * cos(psi), -sin(psi), 0],
            [cos(theta), 0, 1],
        ],
        domain={phi: (0, 2 * pi), theta: (0, pi), psi: (0, 2 * pi)},
        determinant=-sin(theta),
        story=(
            "Precession, nutation and spin: the angles in which tops are taught and solved.\n"
            "Another chart of so3: the torsion in the frame does not know which angles were used."
        ),
        source="L. D. Landau, E. M. Lifshitz, Mechanics, section 35, eq. (35.1)",
    )


def _xyz() -> Convention:
    """Attitude Rx(a) Ry(b) Rz(c): Cardan angles, each axis once."""
    a, b, c = symbols("a b c", real=True)
    return Convention(
        angles=XYZ,
        coordinates=(a, b, c),
        coframe=[
            [cos(b) * cos(c), sin(c), 0],
            [-cos(b) * sin(c), cos(c), 0],
            [sin(b), 0, 1],
        ],
        domain={a: (0, 2 * pi), b: (-pi / 2, pi / 2), c: (0, 2 * pi)},
        determinant=cos(b),
        story=(
            "Cardan angles, the axes of a gimbal: each axis once; the identity is regular.\n"
            "The chart ends at b = pi/2 instead of at the origin; the frame has the torsion of so3."
        ),
        source="M. D. Shuster, A survey of attitude representations, "
        "J. Astronaut. Sci. 41 (1993) 439",
    )


def _zyx() -> Convention:
    """Attitude Rz(yaw) Ry(pitch) Rx(roll)."""
    yaw, pitch, roll = symbols("yaw pitch roll", real=True)
    return Convention(
        angles=ZYX,
        coordinates=(yaw, pitch, roll),
        coframe=[
            [-sin(pitch), 0, 1],
            [cos(pitch) * sin(roll), cos(roll), 0],
            [cos(pitch) * cos(roll), -sin(roll), 0],
        ],
        domain={yaw: (0, 2 * pi), pitch: (-pi / 2, pi / 2), roll: (0, 2 * pi)},
        determinant=-cos(pitch),
        story=(
            "Yaw, pitch and roll, the angles of ships and aircraft, and the rates of the body.\n"
            "The chart ends when the nose points straight up; the frame has the torsion of so3."
        ),
        source="M. D. Shuster, A survey of attitude representations, "
        "J. Astronaut. Sci. 41 (1993) 439",
    )


CONVENTIONS = {"so3_zxz": _zxz, "so3_xyz": _xyz, "so3_zyx": _zyx}


def space(name: str) -> Space:
    """The convention of this name, with the answers that all of them share."""
    convention = CONVENTIONS[name]()
    frame = Frame(
        convention.coordinates, convention.coframe, domain=box(convention.domain), name=name
    )
    return Space(
        name,
        story=convention.story,
        source=convention.source,
        frame=frame,
        known=(
            KnownAnswer("determinant", convention.determinant),
            *BODY_FIXED,
        ),
        atlas=partial(angle_atlas, convention.angles),
        embedding=partial(angle_embedding, convention.angles),
        group="rotations",
        notes="The chart ends where the determinant vanishes.",
    )

"""atlases: further charts of the shipped spaces, and the maps between them."""

from __future__ import annotations

from collections.abc import Callable, Sequence

import sympy as sp

from geomtorsion.geometry import Frame
from geomtorsion.motion.charts import Atlas, Change, Chart, single
from geomtorsion.spaces.space import Space

# Motions leave a chart of angles when the sine in its determinant falls below this.
MARGIN = 0.25


def attach(space: Space) -> Space:
    """The space, its frame knowing the charts of the space; they are made when they are needed.

    Examples
    --------
    >>> from geomtorsion.motion.charts import atlas_of
    >>> from geomtorsion.spaces.so3 import space
    >>> atlas_of(attach(space("so3", "")).frame).names
    ('quaternion', 'so3', 'so3_xyz')
    """
    frame = space.frame
    if frame.name in ATLASES:
        frame.derived("atlas", lambda: ATLASES[frame.name](frame))
    else:
        frame.derived("atlas", lambda: single(frame))
    return space


# -- rotations ----------------------------------------------------------------------------------

QUATERNION = sp.symbols("Q0 Q1 Q2 Q3", real=True)
AXES = {"x": 1, "y": 2, "z": 3}


def product(p: Sequence[sp.Expr], q: Sequence[sp.Expr]) -> list[sp.Expr]:
    """Product of two quaternions."""
    return [
        p[0] * q[0] - p[1] * q[1] - p[2] * q[2] - p[3] * q[3],
        p[0] * q[1] + p[1] * q[0] + p[2] * q[3] - p[3] * q[2],
        p[0] * q[2] - p[1] * q[3] + p[2] * q[0] + p[3] * q[1],
        p[0] * q[3] + p[1] * q[2] - p[2] * q[1] + p[3] * q[0],
    ]


def from_angles(axes: str, angles: Sequence[sp.Expr]) -> list[sp.Expr]:
    """Unit quaternion of R_axis1(angle1) R_axis2(angle2) R_axis3(angle3)."""
    result: list[sp.Expr] = [sp.S.One, sp.S.Zero, sp.S.Zero, sp.S.Zero]
    for axis, angle in zip(axes, angles, strict=True):
        turn = [sp.cos(angle / 2), sp.S.Zero, sp.S.Zero, sp.S.Zero]
        turn[AXES[axis]] = sp.sin(angle / 2)
        result = product(result, turn)
    return result


def rotation(q: Sequence[sp.Expr]) -> sp.Matrix:
    """Rotation matrix of a quaternion, times its length squared."""
    a, b, c, d = q
    return sp.Matrix(
        [
            [a**2 + b**2 - c**2 - d**2, 2 * (b * c - a * d), 2 * (b * d + a * c)],
            [2 * (b * c + a * d), a**2 - b**2 + c**2 - d**2, 2 * (c * d - a * b)],
            [2 * (b * d - a * c), 2 * (c * d + a * b), a**2 - b**2 - c**2 + d**2],
        ]
    )


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


def quaternion_chart(space_fixed: bool = False, places: Sequence[sp.Symbol] = ()) -> Chart:
    """Unit quaternions, q' = q u / 2 (body) or u q / 2 (space); and x' = R V, if there are x."""
    rows: list[list[sp.Expr]] = []
    for k in range(3):
        unit = [sp.S(int(j == k + 1)) for j in range(4)]
        column = product(unit, QUATERNION) if space_fixed else product(QUATERNION, unit)
        rows.append([x / 2 for x in column])
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
}


def _euler_changes(
    name: str, coordinates: Sequence[sp.Symbol], places: Sequence[sp.Symbol] = ()
) -> tuple[Change, ...]:
    """Between one set of angles and the quaternion."""
    axes, order, _ = EULER[name]
    own, hub = (*coordinates, *places), (*QUATERNION, *places)
    there = (*from_angles(axes, [coordinates[k] for k in order]), *places)
    angles = to_angles(axes, rotation(QUATERNION))
    back: list[sp.Expr] = [sp.S.Zero] * 3
    for place, angle in zip(order, angles, strict=True):
        back[place] = angle
    return (
        Change(name, "quaternion", own, there),
        Change("quaternion", name, hub, (*back, *places), angles=(0, 1, 2)),
    )


def rotations(frame: Frame) -> Atlas:
    """Home angles, a second set of angles whose edge lies elsewhere, and the quaternion."""
    from geomtorsion.spaces.registry import load

    home = frame.name
    second = "so3" if home == "so3_xyz" else "so3_xyz"
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

    def changes() -> tuple[Change, ...]:
        there = load(second).frame.coordinates
        return (*_euler_changes(home, frame.coordinates), *_euler_changes(second, there))

    return Atlas(home, makers | {second: other}, changes)


# -- spheres and flat spaces --------------------------------------------------------------------


def sphere(frame: Frame) -> Atlas:
    """A second compass whose pole lies on the first one's equator."""
    theta, phi = frame.coordinates
    (radius,) = frame.parameters
    other = sp.symbols("theta_x phi_x", real=True)
    turned = Frame(
        other, [[radius, 0], [0, radius * sp.sin(other[0])]], parameters=(radius,), name="s2_x"
    )
    n = [sp.sin(theta) * sp.cos(phi), sp.sin(theta) * sp.sin(phi), sp.cos(theta)]
    m = [sp.cos(other[0]), sp.sin(other[0]) * sp.cos(other[1]), sp.sin(other[0]) * sp.sin(other[1])]
    there = (sp.atan2(_length(n[1], n[2]), n[0]), sp.atan2(n[2], n[1]))
    back = (sp.atan2(_length(m[0], m[1]), m[2]), sp.atan2(m[1], m[0]))
    makers = {
        "s2": lambda: Chart.of(frame, edge=sp.sin(theta), margin=MARGIN),
        "s2_x": lambda: Chart.of(turned, edge=sp.sin(other[0]), margin=MARGIN, keeps_frame=False),
    }
    maps = (
        Change("s2", "s2_x", (theta, phi), there, angles=(1,)),
        Change("s2_x", "s2", other, back, angles=(1,)),
    )
    return Atlas("s2", makers, lambda: maps)


def cartesian(frame: Frame) -> Atlas:
    """Cartesian coordinates for the flat spaces."""
    x, y, z = sp.symbols("x_ y_ z_", real=True)
    home, q = frame.name, frame.coordinates
    ways = {
        "flat_polar": (
            (x, y),
            lambda r, phi: (r * sp.cos(phi), r * sp.sin(phi)),
            (_length(x, y), sp.atan2(y, x)),
            (1,),
        ),
        "flat_cylindrical": (
            (x, y, z),
            lambda r, phi, height: (r * sp.cos(phi), r * sp.sin(phi), height),
            (_length(x, y), sp.atan2(y, x), z),
            (1,),
        ),
        "flat_spherical": (
            (x, y, z),
            spherical,
            (sp.sqrt(x**2 + y**2 + z**2), sp.atan2(_length(x, y), z), sp.atan2(y, x)),
            (2,),
        ),
    }
    plain, there, back, angles = ways[home]
    unit = Frame(plain, sp.eye(len(plain)).tolist(), name="cartesian")
    makers = {
        "cartesian": lambda: Chart.of(unit, keeps_frame=False),
        home: lambda: Chart.of(frame),
    }
    maps = (
        Change(home, "cartesian", q, there(*q)),
        Change("cartesian", home, plain, back, angles=angles),
    )
    return Atlas(home, makers, lambda: maps)


def spherical(r: sp.Expr, theta: sp.Expr, phi: sp.Expr) -> tuple[sp.Expr, ...]:
    """Cartesian coordinates of spherical ones."""
    return (
        r * sp.sin(theta) * sp.cos(phi),
        r * sp.sin(theta) * sp.sin(phi),
        r * sp.cos(theta),
    )


# -- black holes --------------------------------------------------------------------------------


def schwarzschild(frame: Frame) -> Atlas:
    """Ingoing Kerr-Schild coordinates: through the horizon and the poles."""
    t, r, theta, phi = frame.coordinates
    (mass,) = frame.parameters
    inner = sp.symbols("T x_ y_ z_", real=True)
    radius = sp.sqrt(sum(x**2 for x in inner[1:]))
    lower = [sp.S.One, *(x / radius for x in inner[1:])]
    upper = [-sp.S.One, *lower[1:]]
    entries = [
        [sp.S(int(a == b)) + mass / radius * upper[a] * lower[b] for b in range(4)]
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
        Change("schwarzschild", "kerr_schild", (t, r, theta, phi), there, (mass,), (), outside),
        Change("kerr_schild", "schwarzschild", inner, back, (mass,), (3,), beyond),
    )
    return Atlas("schwarzschild", makers, lambda: maps)


def kerr(frame: Frame) -> Atlas:
    """Ingoing Kerr coordinates: through the horizon."""
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
        return Chart.of(frame_, keeps_frame=False)

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
    edge = 1 - 2 * mass / r + a**2 / r**2
    makers = {
        "kerr": lambda: Chart.of(frame, edge=edge, margin=0.05),
        "ingoing": through,
    }
    maps = (
        Change("kerr", "ingoing", frame.coordinates, there, (mass, a), (), samples[0]),
        Change("ingoing", "kerr", inner, back, (mass, a), (3,), samples[1]),
    )
    return Atlas("kerr", makers, lambda: maps)


ATLASES: dict[str, Callable[[Frame], Atlas]] = {
    **dict.fromkeys(EULER, rotations),
    "s2": sphere,
    **dict.fromkeys(("flat_polar", "flat_cylindrical", "flat_spherical"), cartesian),
    "schwarzschild": schwarzschild,
    "kerr": kerr,
}

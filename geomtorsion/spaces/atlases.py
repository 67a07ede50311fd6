"""atlases: further charts of the shipped spaces, and the maps between them."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from functools import cache

import sympy as sp

from geomtorsion.curves.atlas import Atlas, Chart, MapFunctions, TransitionMap, Written, single
from geomtorsion.geometry import Frame
from geomtorsion.rigid.attitude import hamilton_product, rotation_rows
from geomtorsion.spaces.atlas_kerr import AXIS, kerr
from geomtorsion.spaces.space import Space

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


def _length(*values: sp.Expr) -> sp.Expr:
    return sp.sqrt(sum(x**2 for x in values))


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
    # zyx: the one that is left.
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
    # A quaternion and its negative are the same rotation, but not the same point of a sphere.
    antipodal = (0, 1, 2, 3) if share == sp.S.Half else ()
    return Chart.redundant("quaternion", (*QUATERNION, *places), legs, kept, antipodal=antipodal)


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


@cache
def _frame_of(name: str) -> Frame:
    """The frame of a second set of angles."""
    # Loading a space imports no other.
    from geomtorsion.spaces import euler, so3

    return (so3 if name == "so3" else euler).space(name, "").frame


def rotations(frame: Frame) -> Atlas:
    """Home angles, a second set of angles whose edge lies elsewhere, and the quaternion."""
    home = frame.name
    second = "so3" if EULER[home][0] == "xyz" else "so3_xyz"
    _, _, edge = EULER[home]
    places = frame.coordinates[3:]

    def own() -> Chart:
        return Chart.of(frame, edge=edge(frame.coordinates[1]), margin=MARGIN)

    def other() -> Chart:
        there = _frame_of(second)
        function = EULER[second][2]
        return Chart.of(there, edge=function(there.coordinates[1]), margin=MARGIN)

    makers = {"quaternion": lambda: quaternion_chart(home == "so3_right", places), home: own}
    if places or home == "so3_right":
        return Atlas(home, makers, lambda: _euler_changes(home, frame.coordinates[:3], places))

    def changes() -> tuple[TransitionMap, ...]:
        there = _frame_of(second).coordinates
        return (*_euler_changes(home, frame.coordinates), *_euler_changes(second, there))

    return Atlas(home, makers | {second: other}, changes)


Q0, Q1, Q2, Q3 = QUATERNION
# Coordinates -> unit quaternion, quaternion -> coordinates, which are angles, edge, written back.
Row = tuple[list[sp.Expr], list[sp.Expr], tuple[int, ...], sp.Expr, Written | None]


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
    return Atlas(home, makers, lambda: maps)


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
        TransitionMap("s2", "s2_x", (theta, phi), there, angles=(1,)),
        TransitionMap("s2_x", "s2", other, back, angles=(1,)),
    )
    return Atlas("s2", makers, lambda: maps)


def seven_sphere(frame: Frame) -> Atlas:
    """A second stereographic chart, about the antipode: x / x.x is an isometry."""
    x = frame.coordinates
    y = sp.symbols("y1:8", real=True)

    def turned() -> Chart:
        rows = frame.coframe.to_sympy().subs(dict(zip(x, y, strict=True)), simultaneous=True)
        other = Frame(y, rows.tolist(), name="s7_far")
        return Chart.of(other, edge=_nearness(y), margin=MARGIN, keeps_frame=False)

    makers = {"s7": lambda: Chart.of(frame, edge=_nearness(x), margin=MARGIN), "s7_far": turned}
    maps = tuple(
        TransitionMap(one, other, q, tuple(k / sum(c**2 for c in q) for k in q))
        for one, other, q in (("s7", "s7_far", x), ("s7_far", "s7", y))
    )
    return Atlas("s7", makers, lambda: maps)


def _nearness(x: Sequence[sp.Symbol]) -> sp.Expr:
    """One half plus half of the cosine of the angle from the origin of a stereographic chart."""
    return 1 / (1 + sum(k**2 for k in x))


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
            lambda r, phi: r,
        ),
        "flat_cylindrical": (
            (x, y, z),
            lambda r, phi, height: (r * sp.cos(phi), r * sp.sin(phi), height),
            (_length(x, y), sp.atan2(y, x), z),
            (1,),
            lambda r, phi, height: r,
        ),
        "flat_spherical": (
            (x, y, z),
            spherical,
            (sp.sqrt(x**2 + y**2 + z**2), sp.atan2(_length(x, y), z), sp.atan2(y, x)),
            (2,),
            lambda r, theta, phi: r * sp.sin(theta),
        ),
    }
    plain, there, back, angles, edge = ways[home]
    unit = Frame(plain, sp.eye(len(plain)).tolist(), name="cartesian")
    makers = {
        "cartesian": lambda: Chart.of(unit, keeps_frame=False),
        home: lambda: Chart.of(frame, edge=edge(*q), margin=AXIS),
    }
    maps = (
        TransitionMap(home, "cartesian", q, there(*q)),
        TransitionMap("cartesian", home, plain, back, angles=angles),
    )
    return Atlas(home, makers, lambda: maps)


def spherical(r: sp.Expr, theta: sp.Expr, phi: sp.Expr) -> tuple[sp.Expr, ...]:
    """Cartesian coordinates of spherical ones."""
    return (
        r * sp.sin(theta) * sp.cos(phi),
        r * sp.sin(theta) * sp.sin(phi),
        r * sp.cos(theta),
    )


INNER = sp.symbols("T x_ y_ z_", real=True)


def schwarzschild(frame: Frame) -> Atlas:
    """Ingoing Kerr-Schild coordinates: through the horizon and the poles."""
    t, r, theta, phi = frame.coordinates
    (mass,) = frame.parameters
    radius = _radius()
    delay = 2 * mass * sp.log(r / (2 * mass) - 1)
    there = (t + delay, *spherical(r, theta, phi))
    back = (
        INNER[0] - delay.subs(r, radius),
        radius,
        sp.atan2(_length(INNER[1], INNER[2]), INNER[3]),
        sp.atan2(INNER[2], INNER[1]),
    )
    outside = {mass: 1, r: 5, t: 0, theta: 1, phi: 1}
    edge = (1 - 2 * mass / r) * sp.sin(theta)
    return _through_the_horizon(frame, mass, there, back, outside, edge, (3,))


def isotropic(frame: Frame) -> Atlas:
    """The same chart for isotropic coordinates, r = s (1 + M / 2s)^2."""
    t, *place = frame.coordinates
    (mass,) = frame.parameters
    s = sp.sqrt(sum(x**2 for x in place))
    stretch = (1 + mass / (2 * s)) ** 2
    delay = 2 * mass * sp.log((s - mass / 2) ** 2 / (2 * mass * s))
    radius = _radius()
    own = (radius - mass + sp.sqrt(radius**2 - 2 * mass * radius)) / 2
    there = (t + delay, *(x * stretch for x in place))
    back = (
        INNER[0] - 2 * mass * sp.log(radius / (2 * mass) - 1),
        *(x * own / radius for x in INNER[1:]),
    )
    outside = {mass: 1, t: 0, **dict.fromkeys(place, 3)}
    edge = 1 - mass / (2 * s)
    return _through_the_horizon(frame, mass, there, back, outside, edge, ())


def _radius() -> sp.Expr:
    return sp.sqrt(sum(x**2 for x in INNER[1:]))


def _through_the_horizon(
    frame: Frame,
    mass: sp.Symbol,
    there: tuple[sp.Expr, ...],
    back: tuple[sp.Expr, ...],
    outside: Mapping[sp.Symbol, int],
    edge: sp.Expr,
    angles: tuple[int, ...],
) -> Atlas:
    """Home and g = eta + (2 M / r) l l with l = dT + dr."""
    home, radius = frame.name, _radius()
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
    beyond = dict(zip(INNER, (0, 3, 3, 3), strict=True)) | {mass: 1}
    maps = (
        TransitionMap(home, "kerr_schild", frame.coordinates, there, (mass,), (), outside),
        TransitionMap("kerr_schild", home, INNER, back, (mass,), angles, beyond),
    )
    return Atlas(home, makers, lambda: maps)


def de_sitter(frame: Frame) -> Atlas:
    """-dT^2 + (dx - x dT / L)^2 in T = t + (L / 2) log(1 - r^2 / L^2): out through the horizon."""
    t, r, theta, phi = frame.coordinates
    (length,) = frame.parameters
    time, *place = INNER
    radius = _radius()

    def flowing() -> Chart:
        rows = [[sp.S.One, 0, 0, 0]]
        rows += [[-x / length, *(sp.Integer(x == y) for y in place)] for x in place]
        other = Frame(INNER, rows, signature=(-1, 1, 1, 1), parameters=(length,), name="painleve")
        return Chart.of(other, keeps_frame=False)

    advance = length / 2 * sp.log(1 - r**2 / length**2)
    there = (t + advance, *spherical(r, theta, phi))
    polar = sp.atan2(_length(place[0], place[1]), place[2])
    back = (time - advance.subs(r, radius), radius, polar, sp.atan2(place[1], place[0]))
    edge = (1 - r**2 / length**2) * r * sp.sin(theta) / length
    makers = {
        "de_sitter": lambda: Chart.of(frame, edge=edge, margin=0.1),
        "painleve": flowing,
    }
    inside = {length: 9, r: 5, t: 0, theta: 1, phi: 1}
    here = dict(zip(INNER, (0, 3, 3, 3), strict=True)) | {length: 9}
    maps = (
        TransitionMap("de_sitter", "painleve", frame.coordinates, there, (length,), (), inside),
        TransitionMap("painleve", "de_sitter", INNER, back, (length,), (3,), here),
    )
    return Atlas("de_sitter", makers, lambda: maps)


def attach(space: Space) -> Space:
    """The space, its frame knowing the charts of the space; they are made when they are needed.

    Examples
    --------
    >>> from geomtorsion.curves.atlas import atlas_of
    >>> from geomtorsion.spaces.so3 import space
    >>> atlas_of(attach(space("so3", "")).frame).names
    ('quaternion', 'so3', 'so3_xyz')
    """
    frame = space.frame
    make = ATLASES.get(frame.name, single)
    frame.derived("atlas", lambda: replace(make(frame), origin=(make, frame)))
    return space


ATLASES: dict[str, Callable[[Frame], Atlas]] = {
    **dict.fromkeys(EULER, rotations),
    **dict.fromkeys(ROWS, quaternions),
    "s2": sphere,
    "s7": seven_sphere,
    **dict.fromkeys(("flat_polar", "flat_cylindrical", "flat_spherical"), cartesian),
    "schwarzschild": schwarzschild,
    "schwarzschild_isotropic": isotropic,
    "de_sitter": de_sitter,
    "kerr": kerr,
}

"""Variants: families of frames from which a seed takes one."""

from __future__ import annotations

from collections.abc import Mapping
from functools import lru_cache
from random import Random
from types import MappingProxyType

import sympy as sp

from geomtorsion.geometry import Frame, Tensor
from geomtorsion.spaces import load

# Body-fixed frame -> the turns of its attitude from left to right: axis, number of the angle.
ANGLES: Mapping[str, tuple[tuple[str, int], ...]] = MappingProxyType(
    {
        "so3": (("z", 2), ("y", 1), ("z", 0)),
        "so3_zxz": (("z", 0), ("x", 1), ("z", 2)),
        "so3_xyz": (("x", 0), ("y", 1), ("z", 2)),
        "so3_zyx": (("z", 0), ("y", 1), ("x", 2)),
    }
)


def turned_plane(draw: Random, seed: int) -> Frame:
    """Two forms that turn from place to place: dx and dy in polar coordinates for seed 0."""
    r, phi = sp.symbols("r phi", real=True)
    times = 1 if seed == 0 else draw.choice((1, 2, 3))
    stretch = 1 if seed == 0 else draw.choice((1, 2, 3))
    angle = times * phi
    if seed and draw.random() < 0.5:
        rows = [[sp.cosh(angle), r * sp.sinh(angle)], [sp.sinh(angle), r * sp.cosh(angle)]]
    else:
        rows = [[sp.cos(angle), -r * sp.sin(angle)], [sp.sin(angle), r * sp.cos(angle)]]
    rows[0] = [stretch * x for x in rows[0]]
    return Frame((r, phi), rows, domain=(r > 0, phi > 0, phi < 2 * sp.pi), name="a turning frame")


def rotations(draw: Random, seed: int) -> Frame:
    """The body-fixed frame of the paper; other seeds: other angles, one form stretched."""
    if seed == 0:
        return load("so3").frame
    frame = load(draw.choice(sorted(ANGLES))).frame
    return stretched(frame, draw.randrange(3), draw.choice((2, 3)))


def stretched(frame: Frame, which: int, factor: int) -> Frame:
    """A frame with one of its forms multiplied by a number."""
    rows = matrix_of(frame.coframe).tolist()
    rows[which] = [factor * x for x in rows[which]]
    name = f"{frame.name}, form {which + 1} times {factor}"
    return Frame(frame.coordinates, rows, domain=frame.domain, name=name)


def group(draw: Random, seed: int) -> Frame:
    """Left-invariant forms of a three-dimensional group: Heisenberg's for seed 0."""
    if seed == 0:
        return load("heisenberg").frame
    x, y, z = q = sp.symbols("x y z", real=True)
    a, b = draw.choice((1, 2, 3)), draw.choice((-3, -2, -1, 2))
    kind = draw.choice(("shear", "stretch", "turn", "scale"))
    if kind == "shear":
        rows = [[1, 0, 0], [0, 1, 0], [b * y, a * x, 1]]
        if a == b:
            rows[2][0] = (b + 1) * y
    elif kind == "stretch":
        rows = [[sp.exp(a * z), 0, 0], [0, sp.exp(b * z), 0], [0, 0, 1]]
    elif kind == "turn":
        cosine, sine = sp.cos(a * z), sp.sin(a * z)
        rows = [[cosine, sine, 0], [-sine, cosine, 0], [0, 0, 1]]
    else:
        rows = [[1, 0, 0], [a * x, sp.exp(b * x), 0], [0, 0, sp.exp(a * x)]]
    return Frame(q, rows, name=f"a group ({kind} {a}, {b})")


def matrix_of(tensor: Tensor) -> sp.Matrix:
    """A tensor with two indices as a sympy matrix."""
    n = range(tensor.frame.dimension)
    return sp.Matrix([[tensor[i, j] for j in n] for i in n])


def turn(axis: str, angle: sp.Expr) -> sp.Matrix:
    """The right-handed turn about an axis, as a matrix that acts on vectors."""
    c, s = sp.cos(angle), sp.sin(angle)
    rows = {
        "x": [[1, 0, 0], [0, c, -s], [0, s, c]],
        "y": [[c, 0, s], [0, 1, 0], [-s, 0, c]],
        "z": [[c, -s, 0], [s, c, 0], [0, 0, 1]],
    }
    return sp.Matrix(rows[axis])


def attitude(name: str) -> sp.Matrix:
    """The rotation from body to space in the angles of a shipped space."""
    angles = load(name).frame.coordinates
    product = sp.eye(3)
    for axis, k in ANGLES[name]:
        product = product * turn(axis, angles[k])
    return product


@lru_cache(maxsize=len(ANGLES))
def seen_from_space(name: str) -> Frame:
    """The space-fixed frame in the angles of a shipped body-fixed one: omega = R Omega."""
    frame = load(name).frame
    turned = (attitude(name) * matrix_of(frame.coframe)).tolist()
    return Frame(frame.coordinates, turned, domain=frame.domain, name=f"{name}, space-fixed")


def profile(draw: Random, x: sp.Symbol) -> sp.Expr:
    """How long, over 2 pi, the circles of a surface are: positive for 0 < x < 1 at least."""
    k = draw.choice((2, 3, 4, 5))
    choices = (
        sp.sinh(k * x), sp.exp(k * x), sp.cosh(x / k), x**k, sp.sin(x / k), 1 + k * x**2,
        sp.exp(-k * x), x * sp.exp(k * x), 1 / (k + x), k * x + x**2, sp.tanh(k * x), sp.cos(x / k),
    )  # fmt: skip
    return draw.choice(choices)


def circles(draw: Random, seed: int) -> Frame:
    """The legs along and across the circles of a surface, (dr, f(r) dphi)."""
    r, phi = sp.symbols("r phi", real=True)
    f = profile(draw, r) if seed else r
    domain = (r > 0, r < 1 if seed else r < 2, phi > 0, phi < 2 * sp.pi)
    return Frame((r, phi), [[1, 0], [0, f]], domain=domain, name=f"circles of length 2 pi {f}")

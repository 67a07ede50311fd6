"""Variants: families of frames from which a seed takes one."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cache
from itertools import chain, product, zip_longest
from typing import TypeVar

import sympy as sp

from geomtorsion.geometry import Frame, Tensor
from geomtorsion.spaces import load
from geomtorsion.support.caching import cached_property

Option = TypeVar("Option")
# Axes of the turns from left to right -> the shipped body-fixed frame; "" where none is shipped.
SHIPPED = {
    "zyz": "so3", "zxz": "so3_zxz", "xyz": "so3_xyz", "zyx": "so3_zyx",
    "xyx": "", "yzy": "", "xzx": "", "yxy": "", "xzy": "", "yzx": "", "yxz": "", "zxy": "",
}  # fmt: skip
# A form and the factor by which it is stretched: none first.
STRETCHES = ((0, 1), *product(range(3), (2, 3)))


@dataclass(frozen=True)
class Body:
    """A body whose attitude is a product of three turns; one of its forms may be stretched.

    axes: of the turns from left to right. times: the turn about each axis, in units of its angle.
    stretch: number of the stretched form, and its factor.
    """

    axes: str
    times: tuple[int, int, int] = (1, 1, 1)
    stretch: tuple[int, int] = (0, 1)

    @property
    def rigid(self) -> bool:
        """Whether no form is stretched."""
        return self.stretch[1] == 1

    @cached_property
    def turns(self) -> tuple[tuple[str, sp.Symbol, int], ...]:
        """Axis, angle and its multiple of each turn, from left to right."""
        name = SHIPPED[self.axes]
        angles = load(name).frame.coordinates if name else sp.symbols("phi theta psi", real=True)
        # The paper counts its angles from the right.
        ordered = angles[::-1] if name == "so3" else angles
        return tuple(zip(self.axes, ordered, self.times, strict=True))

    @property
    def angles(self) -> tuple[sp.Symbol, ...]:
        """The coordinates."""
        angles = tuple(angle for _, angle, _ in self.turns)
        return angles[::-1] if SHIPPED[self.axes] == "so3" else angles

    def rotation(self, begin: int = 0, end: int = 3) -> sp.Matrix:
        """The product of the turns from begin to end; of all of them: from body to space."""
        whole = sp.eye(3)
        for axis, angle, times in self.turns[begin:end]:
            whole = whole * turn(axis, times * angle)
        return whole

    @cached_property
    def frame(self) -> Frame:
        """The body-fixed frame, whose forms are the angular velocity along the body's axes."""
        if SHIPPED[self.axes] and self.times == (1, 1, 1) and self.rigid:
            return load(SHIPPED[self.axes]).frame
        # The later turns carry the axis of a turn along.
        return self._frame([self.rotation(k + 1).T for k in range(3)], "fixed in a body")

    @cached_property
    def space_frame(self) -> Frame:
        """The space-fixed frame, with the same form stretched."""
        return self._frame([self.rotation(0, k) for k in range(3)], "fixed in space")

    def _frame(self, seen: Sequence[sp.Matrix], name: str) -> Frame:
        """The frame in which the axis of each turn is seen through a rotation."""
        columns = {
            angle: times * matrix[:, "xyz".index(axis)]
            for (axis, angle, times), matrix in zip(self.turns, seen, strict=True)
        }
        rows = sp.Matrix.hstack(*(columns[angle] for angle in self.angles)).tolist()
        which, factor = self.stretch
        rows[which] = [factor * x for x in rows[which]]
        return Frame(self.angles, rows, domain=self._domain(), name=f"{self.axes}, {name}")

    def _domain(self) -> tuple[sp.Basic, ...]:
        """Full turns of the outer angles; between the poles, the inner one."""
        first, middle, last = (angle for _, angle, _ in self.turns)
        end = sp.pi / self.times[1]
        low, high = (0, end) if self.axes[0] == self.axes[2] else (-end / 2, end / 2)
        outer = (first > 0, first < 2 * sp.pi, last > 0, last < 2 * sp.pi)
        return (*outer, middle > low, middle < high)


@cache
def bodies() -> tuple[Body, ...]:
    """Body-fixed frames: the paper's first, then other axes and stretched forms."""
    axes = tuple(SHIPPED)
    # 12 and 7 have no common factor: every pair comes once, and neighbours differ in both.
    pairs = ((k % len(axes), k % len(STRETCHES)) for k in range(len(axes) * len(STRETCHES)))
    return tuple(Body(axes[i], stretch=STRETCHES[j]) for i, j in pairs)


@cache
def planes() -> tuple[Frame, ...]:
    """Two forms that are rotated, or boosted, with position; first dx and dy in polar
    coordinates."""
    r, phi = sp.symbols("r phi", real=True)
    stretches = ((0, 1), *product((0, 1), (2, 3, 4, 5)))
    frames = []
    for (which, stretch), times, boosted in product(stretches, (1, 2, 3, 4), (False, True)):
        angle = times * phi
        if boosted:
            rows = [[sp.cosh(angle), r * sp.sinh(angle)], [sp.sinh(angle), r * sp.cosh(angle)]]
        else:
            rows = [[sp.cos(angle), -r * sp.sin(angle)], [sp.sin(angle), r * sp.cos(angle)]]
        rows[which] = [stretch * x for x in rows[which]]
        domain = (r > 0, phi > 0, phi < 2 * sp.pi)
        frames.append(Frame((r, phi), rows, domain=domain, name="a turning frame"))
    return tuple(frames)


@cache
def groups(*, curved: bool = False) -> tuple[Frame, ...]:
    """Left-invariant forms of three-dimensional groups: Heisenberg's first.

    curved: omit the rotations of the plane, whose metric is flat.
    """
    x, y, z = q = sp.symbols("x y z", real=True)
    kinds = (
        [[[1, 0, 0], [0, 1, 0], [b * y, a * x, 1]]
         for a, b in product((-1, 1, 2, 3), (0, -2, -3, 4))],
        [[[sp.exp(a * z), 0, 0], [0, sp.exp(b * z), 0], [0, 0, 1]]
         for a, b in product((1, 2, 3, 4), (-1, -2, -3, 2))],
        [] if curved else
        [[[sp.cos(a * z), sp.sin(a * z), 0], [-sp.sin(a * z), sp.cos(a * z), 0], [0, 0, b]]
         for a, b in product((1, 2, 3, 5), (1, 2, 3, 4))],
        [[[1, 0, 0], [a * x, sp.exp(b * x), 0], [0, 0, sp.exp(a * x)]]
         for a, b in product((1, 2, 3, 4), (-1, -2, -3, 2))],
    )  # fmt: skip
    return tuple(Frame(q, rows, name="a group") for rows in mixed(*kinds))


def profiles(x: sp.Symbol) -> tuple[sp.Expr, ...]:
    """Lengths over 2 pi of the circles of surfaces; all are positive at least for 0 < x < 1.

    The first is the plane, the only flat surface of the family.
    """
    curved = (
        (sp.sinh(k * x), sp.exp(k * x), sp.cosh(x / k), x**k, sp.sin(x / k), 1 + k * x**2,
         sp.exp(-k * x), x * sp.exp(k * x), 1 / (k + x), k * x + x**2, sp.tanh(k * x),
         sp.cos(x / k))
        for k in (2, 3, 4, 5, 6)
    )  # fmt: skip
    return (x, *chain.from_iterable(curved))


@cache
def circles() -> tuple[Frame, ...]:
    """The legs along and across the circles of a surface, (dr, f(r) dphi): the plane's first."""
    r, phi = sp.symbols("r phi", real=True)
    domain = (r > 0, r < 1, phi > 0, phi < 2 * sp.pi)
    return tuple(
        Frame((r, phi), [[1, 0], [0, f]], domain=domain, name=f"circles of length 2 pi {f}")
        for f in profiles(r)
    )


def mixed(*families: Sequence[Option]) -> tuple[Option, ...]:
    """All members of several families, by turns."""
    rows = zip_longest(*families)
    return tuple(member for row in rows for member in row if member is not None)


def frame_of(member: Body | Frame) -> Frame:
    """The frame of a member of a mixed family."""
    return member.frame if isinstance(member, Body) else member


def vectors() -> tuple[tuple[int, ...], ...]:
    """Vectors of small whole numbers with a zero among them, the zero vector first."""
    every = product((0, 1, 2, -1, -2), repeat=3)
    return tuple(vector for vector in every if 0 in vector)


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

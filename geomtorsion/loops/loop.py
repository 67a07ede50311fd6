"""Loop: closed paths; centre and offsets are kept apart, so that tiny ones lose nothing."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any

import numpy as np

from geomtorsion.errors import LoopError
from geomtorsion.loops.making import Makers, Plane
from geomtorsion.loops.sides import Side

if TYPE_CHECKING:
    import sympy as sp

# Two loops share a base point if they miss each other by less than this share of their size.
SAME_POINT = 1e-12


@dataclass(frozen=True)
class Part:
    """One closed path, run through `times` times: q(s) = centre + size * offset(s).

    centre: coordinates q0^mu, shape (n,).
    size: how large it is, in coordinates; offsets are of order one.
    sides: smooth arcs in the order in which they are run through, s from 0 to 1 on each.
    times: how often; negative: backwards.
    given: centre and size as the user gave them, for exact integrals.
    """

    centre: tuple[float, ...]
    size: float
    sides: tuple[Side, ...]
    times: int = 1
    given: tuple[tuple[Any, ...], Any] | None = None

    def points(self, side: Side, s: Any) -> tuple[np.ndarray, np.ndarray]:
        """Coordinates and their derivatives by s on a side, shape (n, k) each."""

        offsets, slopes = side.shape(np.atleast_1d(np.asarray(s, dtype=float)))
        return np.array(self.centre)[:, None] + self.size * offsets, self.size * slopes

    @property
    def base_offset(self) -> np.ndarray:
        """Where it starts and ends, as offset, shape (n,)."""

        return self.sides[0].shape(np.zeros(1))[0][:, 0]

    @property
    def base(self) -> np.ndarray:
        """Where it starts and ends, as coordinates, shape (n,)."""

        return np.array(self.centre) + self.size * self.base_offset


@dataclass(frozen=True)
class Loop(Makers):
    """A closed path in coordinates: one part, or several run through one after the other.

    parts: closed paths from one common base point, in order.
    name: what it is called in messages and pictures.

    Examples
    --------
    >>> loop = Loop.circle(centre=[0.3, 1.0, 0.2], radius=1e-8, plane=(0, 1))
    >>> loop.dimension, loop.size, loop.times(3).winding([0.3, 1.0, 0.2])
    (3, 1e-08, 3)
    >>> there_and_back = loop.then(loop.reversed())
    >>> float(abs(there_and_back.area).max())
    0.0
    """

    parts: tuple[Part, ...]
    name: str = ""

    # -- algebra --------------------------------------------------------------------------------

    def then(self, other: Loop) -> Loop:
        """This loop, then the other, both from their common base point.

        Raises
        ------
        LoopError
            They start at different points; the message names the gap.
        """

        if other.dimension != self.dimension:
            raise LoopError(
                f"{self.name} lies in {self.dimension} dimensions, {other.name} in "
                f"{other.dimension}: only loops in the same space can follow each other."
            )
        one, two = self.parts[0], other.parts[0]
        apart = np.array(one.centre) - np.array(two.centre)
        gap = apart + one.size * one.base_offset - two.size * two.base_offset
        rounding = 4 * np.finfo(float).eps * max(np.abs(one.centre).max(), np.abs(two.centre).max())
        allowed = SAME_POINT * max(one.size, two.size) + (rounding if apart.any() else 0)
        if np.abs(gap).max() > allowed:
            raise LoopError(
                f"{self.name} starts at {shown(one.base)}, {other.name} at {shown(two.base)}: "
                f"they miss each other by {shown(gap)}. Loops are run through one after the other "
                "from one base point; give them the same one, for instance by polygons."
            )
        return Loop(self.parts + other.parts, f"{self.name} then {other.name}")

    def reversed(self) -> Loop:
        """The same loop backwards."""
        parts = tuple(replace(part, times=-part.times) for part in reversed(self.parts))
        return Loop(parts, f"{self.name} backwards")

    def times(self, count: int) -> Loop:
        """The loop run through several times; negative: backwards.

        Raises
        ------
        LoopError
            The count is not a whole number other than zero.
        """
        if not isinstance(count, int) or isinstance(count, bool) or count == 0:
            raise LoopError(f"a whole number of turns other than 0 was needed, but {count!r} came.")
        if count < 0:
            return self.reversed().times(-count)
        name = f"{self.name} {count} times" if count > 1 else self.name
        if len(self.parts) == 1:
            part = self.parts[0]
            return Loop((replace(part, times=count * part.times),), name)
        return Loop(self.parts * count, name)

    @property
    def symbols(self) -> frozenset[sp.Symbol]:
        """Symbols other than the curve parameter: they need values before numbers can come."""
        found = [getattr(side, "symbols", frozenset()) for p in self.parts for side in p.sides]
        return frozenset().union(*found)

    def at(self, values: Mapping[Any, Any]) -> Loop:
        """The loop with numbers for its symbols, {symbol or name: number}.

        Raises
        ------
        MissingValueError
            A symbol has no value.

        Examples
        --------
        >>> import sympy as sp
        >>> R = sp.Symbol("R", positive=True)
        >>> float(Loop.circle([0, 0], R).at({R: 1}).area[0, 1].round(12))
        3.14159265359
        """
        from geomtorsion.loops.curves import filled

        parts = tuple(filled(part, values) if self.symbols else part for part in self.parts)
        return Loop(parts, self.name)

    # -- what it is -----------------------------------------------------------------------------

    @property
    def dimension(self) -> int:
        """Number of coordinates."""
        return len(self.parts[0].centre)

    @property
    def centre(self) -> tuple[float, ...]:
        """Centre of the first part."""
        return self.parts[0].centre

    @property
    def size(self) -> float:
        """Size of the largest part, in coordinates."""
        return max(part.size for part in self.parts)

    @property
    def base(self) -> np.ndarray:
        """Coordinates of the point where it starts and ends, shape (n,)."""
        return self.parts[0].base

    def walk(self) -> Iterator[tuple[Part, Side, bool]]:
        """The sides in the order in which they are run through: (part, side, backwards)."""
        for part in self.parts:
            sides = part.sides if part.times > 0 else tuple(reversed(part.sides))
            for _ in range(abs(part.times)):
                for side in sides:
                    yield part, side, part.times < 0

    def points(self, count: int = 400) -> np.ndarray:
        """Coordinates of points along it for pictures, shape (n, about count), both ends in."""

        stretches = list(self.walk())
        each = max(2, -(-count // len(stretches)))
        s = np.linspace(0, 1, each + 1)
        pieces = [
            part.points(side, s[::-1] if backwards else s)[0] for part, side, backwards in stretches
        ]
        return np.concatenate([piece[:, :-1] for piece in pieces] + [pieces[-1][:, -1:]], axis=1)

    @property
    def area(self) -> np.ndarray:
        """Signed area in each coordinate plane, A^{mn} = (1/2) loop integral (x^m dx^n - x^n dx^m).

        Shape (n, n), antisymmetric; a small loop has b^i = S_{mn}^i A^{mn}.
        """
        from geomtorsion.loops.measure import area

        return area(self)

    @property
    def length(self) -> float:
        """Length in the Euclidean sense of the coordinates."""
        from geomtorsion.loops.measure import length

        return length(self)

    def winding(self, axis: Sequence[float], plane: Plane = (0, 1)) -> int:
        """How often it turns round an axis, counted from the first direction to the second.

        Parameters
        ----------
        axis
            A point q^mu on the axis, shape (n,).
        plane
            Two coordinates, or two covectors of shape (n,): the axis is where both are constant.

        Raises
        ------
        LoopError
            The loop meets the axis; the message names the point.

        Examples
        --------
        >>> Loop.circle([0, 0, 0], 1).reversed().winding([0.5, 0, 0])
        -1
        """
        from geomtorsion.loops.measure import winding

        return winding(self, axis, plane)


def shown(vector: Any) -> str:
    """A vector in messages."""
    return "(" + ", ".join(f"{float(x):.6g}" for x in vector) + ")"

"""Loop: closed paths; the centre does not enter the offsets, so that tiny ones lose nothing."""

from __future__ import annotations

from collections.abc import Hashable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING, ClassVar, Self

import numpy as np

from geomtorsion.errors import LoopError, MissingValueError
from geomtorsion.loops import constructors, validation
from geomtorsion.loops.arcs import Arc, Number, Parameters, Part, Plane, Point, shown
from geomtorsion.loops.chains import pairs_of
from geomtorsion.loops.quadrature import integrate
from geomtorsion.loops.validation import VALUES
from geomtorsion.loops.winding import turns_round
from geomtorsion.support import checks
from geomtorsion.support.displays import Plot, drawn_by, figure_by
from geomtorsion.support.hints import attribute_hints
from geomtorsion.support.precision import CALCULATED

if TYPE_CHECKING:
    import networkx as nx
    import sympy as sp


@attribute_hints(
    curve="gt.Loop.parametric", square="gt.Loop.plaquette", rectangle="gt.Loop.plaquette"
)
@dataclass(frozen=True, repr=False)
class Loop:
    """Closed path in coordinates: one part, or several in succession.

    parts: closed paths from one common base point, in order.
    name: name in messages and figures; it does not count when loops are compared.

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
    name: str = field(default="", compare=False)

    def __repr__(self) -> str:
        places = [f"{shown(part.centre)}, size {part.size:.6g}" for part in self.parts]
        turns = [f", {part.times} times" if part.times != 1 else "" for part in self.parts]
        every = "; ".join(map("".join, zip(places, turns, strict=True)))
        return f"Loop {self.name!r} at {every}"

    _repr_html_ = drawn_by("notebook_pictures", "loop_html")
    plot: ClassVar[Plot] = figure_by("loops", "draw_loop")

    # -- constructors ---------------------------------------------------------------------------

    @classmethod
    def circle(
        cls, centre: Point, radius: Number, plane: Plane = (0, 1), name: str = "circle"
    ) -> Self:
        """Circle about a point, from the first direction of the plane towards the second.

        Parameters
        ----------
        centre
            q0^mu, shape (n,).
        radius
            In coordinates, positive.
        plane
            Two coordinates (counted from 0), or two vectors of shape (n,), which are made
            orthonormal in the coordinates.

        Raises
        ------
        LoopError
            The radius is not positive, a number is not finite, or the plane is invalid.

        Examples
        --------
        >>> Loop.circle([0, 0], 2).area[0, 1].round(12)
        np.float64(12.566370614359)
        """
        return cls((constructors.circle(centre, radius, plane),), name)

    @classmethod
    def ellipse(
        cls,
        centre: Point,
        axes: Sequence[Number],
        plane: Plane = (0, 1),
        name: str = "ellipse",
    ) -> Self:
        """Ellipse with two semi-axes along the directions of a plane (vectors are not normalized).

        Raises
        ------
        LoopError
            A semi-axis is not positive, a number is not finite, or the plane is invalid.

        Examples
        --------
        >>> float(Loop.ellipse([0, 0], (2, 1)).area[0, 1].round(12))
        6.28318530718
        """
        return cls((constructors.ellipse(centre, axes, plane),), name)

    @classmethod
    def polygon(
        cls,
        vertices: Sequence[Point] | np.ndarray,
        centre: Point | None = None,
        size: Number = 1,
        name: str = "polygon",
    ) -> Self:
        """Polygon with sides that are straight in the coordinates.

        Parameters
        ----------
        vertices
            Shape (k, n), at least three; the last is joined to the first. Without a centre these
            are coordinates; with one they are offsets from it, in units of `size`.
        centre, size
            Position and size of a tiny polygon.

        Raises
        ------
        LoopError
            Fewer than three vertices, two neighbours that coincide, or a number that is not
            finite.

        Examples
        --------
        >>> triangle = [[0, 0], [1, 0], [0, 1]]
        >>> float(Loop.polygon(triangle).area[0, 1])
        0.5
        >>> tiny = Loop.polygon(triangle, centre=[7, 7], size=1e-12)
        >>> float(tiny.area[0, 1])
        5e-25
        """
        return cls((constructors.polygon(vertices, centre, size),), name)

    @classmethod
    def plaquette(
        cls,
        corner: Point,
        steps: Sequence[Number],
        plane: Plane = (0, 1),
        name: str = "plaquette",
    ) -> Self:
        """Parallelogram from a corner; its first side is along the first direction of the plane.

        Raises
        ------
        LoopError
            A step is zero, a number is not finite, or the plane is invalid.

        Examples
        --------
        >>> float(Loop.plaquette([0, 0], (2, 3)).area[0, 1])
        6.0
        """
        return cls((constructors.plaquette(corner, steps, plane),), name)

    @classmethod
    def parametric(
        cls,
        expressions: Sequence[Number | str],
        parameter: str | sp.Symbol = "s",
        interval: Sequence[Number | str] = (0, 1),
        centre: Point | None = None,
        size: Number = 1,
        symbols: Mapping[str, sp.Symbol] | None = None,
        name: str = "curve",
        *,
        periods: Mapping[int, Number | str] | None = None,
    ) -> Self:
        """Closed curve from exact expressions in a parameter.

        Parameters
        ----------
        expressions
            q^mu(s), shape (n,): sympy expressions, or text that is read by a whitelist. With a
            centre they are offsets from it, in units of `size`.
        parameter
            The symbol, or its name.
        interval
            Exact bounds of the parameter, such as (0, 2*pi) or text.
        symbols
            Names that the text may use in addition to the parameter.
        periods
            {coordinate, counted from 0: period} where coordinates are angles: the curve may end
            whole periods from where it starts. The frame must also have these periods. Turns of
            2 pi need not be given for coordinates whose domain in the frame is one turn.

        Raises
        ------
        LoopError
            The curve does not close (the message names the gap), has no length, or is not finite.
        ExpressionError
            An expression cannot be read, or is not smooth.

        Examples
        --------
        >>> curve = Loop.parametric(["cos(s)", "sin(2*s)/2"], interval=(0, "2*pi"))
        >>> float(abs(curve.area).max()) < 1e-15
        True
        >>> Loop.parametric(["2 + cos(3*s)/4", "s"], interval=(0, "2*pi"), periods={1: "2*pi"}).gap
        array([0.        , 6.28318531])
        """
        part = constructors.parametric(
            expressions, parameter, interval, centre, size, symbols, periods
        )
        return cls((part,), name)

    @classmethod
    def spline(
        cls,
        points: Sequence[Point] | np.ndarray,
        centre: Point | None = None,
        size: Number = 1,
        name: str = "spline",
    ) -> Self:
        """Smooth closed curve through points: the periodic cubic spline over the chord length.

        Points are given as the vertices of a polygon are.

        Raises
        ------
        LoopError
            Fewer than three points, two neighbours that coincide, or a number that is not finite.

        Examples
        --------
        >>> Loop.spline([[1, 0], [0, 1], [-1, 0], [0, -1]]).area[0, 1].round(3)
        np.float64(3.05)
        """
        return cls((constructors.spline(points, centre, size),), name)

    @classmethod
    def from_cycle(
        cls,
        graph: nx.Graph[Hashable],
        cycle: Sequence[Hashable],
        position: str = "position",
        name: str = "cycle",
    ) -> Self:
        """Polygon along a cycle of a networkx graph whose nodes have positions.

        Parameters
        ----------
        graph
            Its nodes carry coordinates q^mu under the key `position`.
        cycle
            Nodes in order, as `networkx.cycle_basis` gives them; edges must join neighbours.

        Raises
        ------
        LoopError
            A node or an edge is not in the graph, or a node has no position.

        Examples
        --------
        >>> import networkx as nx
        >>> graph = nx.cycle_graph(4)
        >>> corners = {0: (0, 0), 1: (1, 0), 2: (1, 1), 3: (0, 1)}
        >>> nx.set_node_attributes(graph, corners, "position")
        >>> float(Loop.from_cycle(graph, [0, 1, 2, 3]).area[0, 1])
        1.0
        """
        return cls((constructors.cycle(graph, cycle, position),), name)

    # -- algebra --------------------------------------------------------------------------------

    def then(self, other: Loop) -> Loop:
        """This loop, then the other, both from their common base point.

        Raises
        ------
        LoopError
            They start at different points; the message names the gap.
        """
        if checks.instance(other, Loop, "other").dimension != self.dimension:
            raise LoopError(
                f"{self.name} has {self.dimension} dimensions, {other.name} has "
                f"{other.dimension}: only loops in the same space can follow each other."
            )
        one, two = self.parts[0], other.parts[0]
        shift = np.array(one.centre) - np.array(two.centre)
        gap = shift + one.size * one.base_offset - two.size * two.base_offset
        rounding = 4 * np.finfo(float).eps * max(np.abs(one.centre).max(), np.abs(two.centre).max())
        allowed = CALCULATED * max(one.size, two.size) + (rounding if shift.any() else 0)
        if np.abs(gap).max() > allowed:
            raise LoopError(
                f"{self.name} starts at {shown(one.base)}, {other.name} at {shown(two.base)}: "
                f"the gap is {shown(gap)}. Consecutive loops need a common base point: give both "
                "the same base point, for instance as polygons."
            )
        return Loop(self.parts + other.parts, f"{self.name} then {other.name}")

    def __neg__(self) -> Loop:
        return self.reversed()

    def reversed(self) -> Loop:
        """The same loop backwards."""
        parts = tuple(replace(part, times=-part.times) for part in reversed(self.parts))
        return Loop(parts, f"{self.name} backwards")

    def times(self, count: int) -> Loop:
        """This loop repeated; a negative number reverses it.

        Raises
        ------
        LoopError
            The count is not a whole number other than zero.
        """
        turns = checks.whole(count)
        if not turns:
            checks.refuse(LoopError, "count", "a whole number of turns other than 0", count)
        if turns < 0:
            return self.reversed().times(-turns)
        name = f"{self.name} {turns} times" if turns > 1 else self.name
        if len(self.parts) == 1:
            part = self.parts[0]
            return Loop((replace(part, times=turns * part.times),), name)
        return Loop(self.parts * turns, name)

    @property
    def symbols(self) -> frozenset[sp.Symbol]:
        """Symbols other than the curve parameter; a numerical result needs values for them."""
        symbol_sets = [getattr(arc, "symbols", frozenset()) for p in self.parts for arc in p.arcs]
        return frozenset().union(*symbol_sets)

    def at(self, values: Parameters) -> Loop:
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
        loop = filled(self, values)
        names = sorted(symbol.name for symbol in loop.symbols)
        checks.check_values(names, (), "loop", MissingValueError, VALUES)
        return loop

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

    @property
    def gap(self) -> np.ndarray:
        """Whole periods from its start to its end, shape (n,): zero if it closes without them."""
        total = np.zeros(self.dimension)
        for part in self.parts:
            if part.gap:
                total += part.times * part.size * np.array(part.gap)
        return total

    def arcs(self) -> Iterator[tuple[Part, Arc, bool]]:
        """The arcs in the order in which they are run through: (part, arc, backwards)."""
        for part in self.parts:
            arcs = part.arcs if part.times > 0 else tuple(reversed(part.arcs))
            for _ in range(abs(part.times)):
                for arc in arcs:
                    yield part, arc, part.times < 0

    def points(self, count: int = 400) -> np.ndarray:
        """Coordinates of points along the loop, shape (n, about count), with both ends."""
        stretches = list(self.arcs())
        number = checks.count(count, "count", LoopError, 1)
        checks.check_room(number * self.dimension, f"count: {number:,} points", "Give fewer.")
        each = max(2, -(-number // len(stretches)))
        s = np.linspace(0, 1, each + 1)
        pieces = [
            part.points(arc, s[::-1] if backwards else s)[0] for part, arc, backwards in stretches
        ]
        return np.concatenate([piece[:, :-1] for piece in pieces] + [pieces[-1][:, -1:]], axis=1)

    @property
    def area(self) -> np.ndarray:
        """Signed area in each coordinate plane, A^{mn} = (1/2) loop integral (x^m dx^n - x^n dx^m).

        Shape (n, n), antisymmetric; a small loop has b^i = S_{mn}^i A^{mn}.
        """
        total = np.zeros((self.dimension, self.dimension))
        a, b = pairs_of(self.dimension)
        for part in self.parts:
            integral = integrate(part.arcs, lambda x, v: (x[a] * v[b] - x[b] * v[a]) / 2, 1e-14)
            total[a, b] += part.times * part.size * (part.size * integral.value)
        return total - total.T

    @property
    def length(self) -> float:
        """Length in the Euclidean sense of the coordinates."""
        total = 0.0
        for part in self.parts:
            integral = integrate(part.arcs, lambda x, v: np.sqrt((v * v).sum(axis=0))[None], 1e-10)
            total += abs(part.times) * part.size * float(integral.value[0])
        return total

    def winding(self, axis: Sequence[float], plane: Plane = (0, 1)) -> int:
        """Winding number around an axis, positive from the first direction to the second.

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
        place = validation.vector(axis, "axis", self.dimension)
        rows = np.array(validation.rows(plane, self.dimension))
        return turns_round(self.parts, place, rows, "axis", LoopError)


def check_loop(loop: object, dimension: int) -> None:
    """Refuse values that are not loops in this number of coordinates.

    Raises
    ------
    ArgumentError
        It is not a loop.
    LoopError
        The loop has another dimension than the frame.

    Examples
    --------
    >>> check_loop(Loop.circle([0, 0], 1), 2)
    """
    curve = checks.instance(loop, Loop, "loop")
    if curve.dimension != dimension:
        raise LoopError(
            f"the loop has {curve.dimension} coordinates, the frame {dimension}: "
            "give a loop in the coordinates of the frame."
        )


def filled(loop: Loop, values: Parameters) -> Loop:
    """A loop with numbers for its symbols that have a value; the others stay."""
    if not loop.symbols:
        return loop
    return Loop(tuple(constructors.filled(part, values) for part in loop.parts), loop.name)

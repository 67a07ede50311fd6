"""Making: the ways to make a loop."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any, Self

if TYPE_CHECKING:
    import networkx as nx
    import sympy as sp

    from geomtorsion.loops.loop import Part

Plane = tuple[Any, Any]


class Makers:
    """Class methods of `Loop` that make one; they say what may be given."""

    if TYPE_CHECKING:

        def __init__(self, parts: tuple[Part, ...], name: str = "") -> None: ...

    @classmethod
    def circle(
        cls, centre: Sequence[Any], radius: Any, plane: Plane = (0, 1), name: str = "circle"
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
            The radius is not positive, a number is not finite, or the plane is none.

        Examples
        --------
        >>> from geomtorsion.loops import Loop
        >>> Loop.circle([0, 0], 2).area[0, 1].round(12)
        np.float64(12.566370614359)
        """
        from geomtorsion.loops import shapes

        return cls((shapes.circle(centre, radius, plane),), name)

    @classmethod
    def ellipse(
        cls,
        centre: Sequence[Any],
        axes: tuple[Any, Any],
        plane: Plane = (0, 1),
        name: str = "ellipse",
    ) -> Self:
        """Ellipse with two semi-axes along the directions of a plane (vectors count as given).

        Raises
        ------
        LoopError
            A semi-axis is not positive, a number is not finite, or the plane is none.

        Examples
        --------
        >>> from geomtorsion.loops import Loop
        >>> float(Loop.ellipse([0, 0], (2, 1)).area[0, 1].round(12))
        6.28318530718
        """
        from geomtorsion.loops import shapes

        return cls((shapes.ellipse(centre, axes, plane),), name)

    @classmethod
    def polygon(
        cls,
        vertices: Sequence[Sequence[Any]],
        centre: Sequence[Any] | None = None,
        size: Any = 1,
        name: str = "polygon",
    ) -> Self:
        """Polygon with sides that are straight in the coordinates.

        Parameters
        ----------
        vertices
            Shape (k, n), at least three; the last is joined to the first. Without a centre these
            are coordinates; with one they are offsets from it, in units of `size`.
        centre, size
            Where a tiny polygon lies, and how large it is.

        Raises
        ------
        LoopError
            Fewer than three vertices, two neighbours that coincide, or a number that is not
            finite.

        Examples
        --------
        >>> from geomtorsion.loops import Loop
        >>> triangle = [[0, 0], [1, 0], [0, 1]]
        >>> float(Loop.polygon(triangle).area[0, 1])
        0.5
        >>> tiny = Loop.polygon(triangle, centre=[7, 7], size=1e-12)
        >>> float(tiny.area[0, 1])
        5e-25
        """
        from geomtorsion.loops import shapes

        return cls((shapes.polygon(vertices, centre, size),), name)

    @classmethod
    def plaquette(
        cls,
        corner: Sequence[Any],
        steps: tuple[Any, Any],
        plane: Plane = (0, 1),
        name: str = "plaquette",
    ) -> Self:
        """Parallelogram from a corner, one step along the first direction of a plane at first.

        Raises
        ------
        LoopError
            A step is zero, a number is not finite, or the plane is none.

        Examples
        --------
        >>> from geomtorsion.loops import Loop
        >>> float(Loop.plaquette([0, 0], (2, 3)).area[0, 1])
        6.0
        """
        from geomtorsion.loops import shapes

        return cls((shapes.plaquette(corner, steps, plane),), name)

    @classmethod
    def parametric(
        cls,
        expressions: Sequence[Any],
        parameter: Any = "s",
        interval: tuple[Any, Any] = (0, 1),
        centre: Sequence[Any] | None = None,
        size: Any = 1,
        symbols: Mapping[str, sp.Symbol] | None = None,
        name: str = "curve",
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
            Names that the text may use beside the parameter.

        Raises
        ------
        LoopError
            The curve does not close (the message names the gap), has no length, or is not finite.
        ExpressionError
            An expression cannot be read, or is not smooth.

        Examples
        --------
        >>> from geomtorsion.loops import Loop
        >>> curve = Loop.parametric(["cos(s)", "sin(2*s)/2"], interval=(0, "2*pi"))
        >>> float(abs(curve.area).max()) < 1e-15
        True
        """
        from geomtorsion.loops import curves

        part = curves.parametric(expressions, parameter, interval, centre, size, symbols)
        return cls((part,), name)

    @classmethod
    def spline(
        cls,
        points: Sequence[Sequence[Any]],
        centre: Sequence[Any] | None = None,
        size: Any = 1,
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
        >>> from geomtorsion.loops import Loop
        >>> Loop.spline([[1, 0], [0, 1], [-1, 0], [0, -1]]).area[0, 1].round(3)
        np.float64(3.05)
        """
        from geomtorsion.loops import shapes

        return cls((shapes.spline(points, centre, size),), name)

    @classmethod
    def from_cycle(
        cls,
        graph: nx.Graph,
        cycle: Sequence[Any],
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
        >>> from geomtorsion.loops import Loop
        >>> import networkx as nx
        >>> graph = nx.cycle_graph(4)
        >>> corners = {0: (0, 0), 1: (1, 0), 2: (1, 1), 3: (0, 1)}
        >>> nx.set_node_attributes(graph, corners, "position")
        >>> float(Loop.from_cycle(graph, [0, 1, 2, 3]).area[0, 1])
        1.0
        """
        from geomtorsion.loops import shapes

        return cls((shapes.cycle(graph, cycle, position),), name)

"""Atlas: charts of a space, maps between them, and a moving point carried from one to another."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import partial
from typing import TYPE_CHECKING, Any, NamedTuple

import mpmath
import numpy as np
import sympy as sp

from geomtorsion.codegen import Graph, graph, numpy_function
from geomtorsion.curves.edges import edges_of
from geomtorsion.errors import (
    ArgumentError,
    ChartEdgeError,
    ShapeError,
    UnknownNameError,
)
from geomtorsion.exact import Element, Field
from geomtorsion.exact.tower import Tower
from geomtorsion.geometry.domain_edges import Edge
from geomtorsion.ode.numbers import Numbers, Real, mpf
from geomtorsion.support import checks
from geomtorsion.support.caching import cached_property
from geomtorsion.support.copies import ByContent, comparable, only_fields
from geomtorsion.support.precision import working_precision

if TYPE_CHECKING:
    from geomtorsion.geometry import Frame

Rows = tuple[tuple[tuple[int, Element], ...], ...]


@dataclass(frozen=True)
class MapFunctions:
    """Functions of double precision arrays, or of mpmath numbers at the precision that is set.

    choose: (condition, value where it holds, value where it does not).

    Examples
    --------
    >>> float(FLOATS.sqrt(2.0)) == float(DIGITS.sqrt(2.0))
    True
    """

    sqrt: Callable[[Any], Any]
    log: Callable[[Any], Any]
    atanh: Callable[[Any], Any]
    atan2: Callable[[Any, Any], Any]
    hypot: Callable[[Any, Any], Any]
    sin: Callable[[Any], Any]
    cos: Callable[[Any], Any]
    choose: Callable[[Any, Any, Any], Any]


FLOATS = MapFunctions(
    np.sqrt, np.log, np.arctanh, np.arctan2, np.hypot, np.sin, np.cos, np.where
)  # fmt: skip
DIGITS = MapFunctions(
    mpmath.sqrt, mpmath.log, mpmath.atanh, mpmath.atan2, mpmath.hypot, mpmath.sin, mpmath.cos,
    lambda condition, one, other: one if condition else other,
)  # fmt: skip
# (functions, coordinates of the source, parameters by name) -> coordinates of the target
Written = Callable[[MapFunctions, Sequence[Any], Mapping[str, Any]], Sequence[Any]]


@dataclass(frozen=True, eq=False)
class ElementMatrix:
    """A matrix of which only the entries that do not vanish are kept.

    entries: (row, column) -> element; shape: (rows, columns).
    """

    entries: Mapping[tuple[int, ...], Element]
    shape: tuple[int, int]

    @cached_property
    def _graph(self) -> Graph:
        # A common factor that cancels may bring in symbols on which the value does not depend.
        symbols = {s.name for element in self.entries.values() for s in element.field.symbols}
        return graph(sorted(symbols), list(self.entries.values()), factor=False)

    def values(self, point: Mapping[str, Real | np.ndarray]) -> np.ndarray:
        """The entries at one point or many, shape (entries, ...)."""
        numbers = [point.get(name, np.nan) for name in self._graph.arguments]
        columns = [x if isinstance(x, np.ndarray) else float(x) for x in numbers]
        return self._graph.numpy()(*columns)

    def at(self, point: Mapping[str, Real]) -> np.ndarray:
        """The matrix at one point."""
        matrix = np.zeros(self.shape)
        for index, number in zip(self.entries, self.values(point), strict=True):
            matrix[index] = number
        return matrix

    def applied(self, point: Mapping[str, Real | np.ndarray], vectors: np.ndarray) -> np.ndarray:
        """The matrix at points times a vector at each: shapes (columns, ...), (rows, ...)."""
        result = np.zeros((self.shape[0], *vectors.shape[1:]))
        # Entries are infinite where a chart ends; the caller checks the result.
        with np.errstate(all="ignore"):
            for (i, j), number in zip(self.entries, self.values(point), strict=True):
                result[i] += number * vectors[j]
        return result

    def precisely(self, point: Mapping[str, Real], vector: Numbers, bits: int) -> list[Real]:
        """The matrix at one point times a vector, in numbers of the given precision."""
        numbers = {name: mpf(x, bits) for name, x in point.items()}
        factors = [mpf(x, bits) for x in vector]
        shared: dict[str, object] = {}
        with working_precision(bits):
            total: list[Real] = [mpmath.mpf(0)] * self.shape[0]
            for (i, j), element in self.entries.items():
                total[i] += element.evaluate(numbers, bits, shared) * factors[j]
        return total


@dataclass(frozen=True, eq=False)
class Chart:
    """Coordinate system in which a motion is computed.

    name: its name in the atlas.
    coordinates: symbols; more than the dimension of the space in a redundant chart.
    legs: for each coordinate the pairs (i, E[mu, i]) that do not vanish: q'^mu = E[mu, i] u^i.
    frame: the frame written in these coordinates; None for a redundant chart.
    keeps_frame: whether its legs are the fields of the home chart's frame.
    edge: an element that vanishes where the chart ends; None if the frame itself defines its edges.
    margin: below this value of |edge| the solver changes the chart.
    kept: an element that equals one everywhere (redundant charts).
    antipodal: indices of coordinates whose common sign does not change the point.
    edges_of_law: where the formulas of a law, such as a force, end.
    end: where a motion ends before it reaches the edge, in words.
    """

    name: str
    coordinates: tuple[sp.Symbol, ...]
    legs: Rows
    frame: Frame | None = None
    keeps_frame: bool = True
    edge: Element | None = None
    margin: float = 0.0
    kept: Element | None = None
    end: str = ""
    antipodal: tuple[int, ...] = ()
    edges_of_law: tuple[Edge, ...] = ()

    def __eq__(self, other: object) -> bool:
        return self._plain == other._plain if isinstance(other, Chart) else NotImplemented

    def __hash__(self) -> int:
        return hash((self.name, self.coordinates))

    @cached_property
    def _plain(self) -> tuple[object, ...]:
        """What counts when charts are compared: expressions instead of elements."""
        legs = [[(i, x.sympy) for i, x in row] for row in self.legs] if self.frame is None else []
        edge, kept = (None if x is None else x.sympy for x in (self.edge, self.kept))
        words = tuple(one.condition for one in self.edges_of_law)
        margin = self.keeps_frame, self.margin, self.antipodal, words
        return self.name, self.coordinates, self.frame, legs, edge, kept, margin

    def __getstate__(self) -> dict[str, object]:
        return only_fields(self)

    @cached_property
    def groups(self) -> tuple[tuple[int, ...], ...]:
        """Groups of coordinates with a common size in error estimates: all except time.

        Time grows without bound. It belongs to the only leg whose square has the other sign.
        """
        places = tuple(range(len(self.coordinates)))
        if self.frame is None:
            return (places,)
        signs = [self.frame.eta.element(i, i) for i in places]
        # In two dimensions it is the negative one.
        by_sign = [[i for i in places if signs[i] == sign] for sign in (-1, 1)]
        times = next((few for few in by_sign if len(few) == 1), [])
        if not times or len(places) == 1:
            return (places,)
        return (times[0],), tuple(i for i in places if i != times[0])

    @cached_property
    def edges(self) -> tuple[Edge, ...]:
        """Quantities that are positive inside the chart, shape (edges,).

        First the edge of the chart, or else the edges of its frame; then the edges of the law.
        """
        if self.edge is not None:
            own = (Edge(self.edge, f"{self.edge.sympy} = 0", f"{self.edge.sympy} > 0"),)
        else:
            own = () if self.frame is None else edges_of(self.frame)
        return (*own, *self.edges_of_law)

    @property
    def field(self) -> Tower:
        """Field of the exact elements of the chart."""
        if self.frame is not None:
            return self.frame.field
        return next(value for row in self.legs for _, value in row).field

    @property
    def names(self) -> tuple[str, ...]:
        """Names of the coordinates."""
        return tuple(symbol.name for symbol in self.coordinates)

    @cached_property
    def frame_vectors(self) -> ElementMatrix:
        """Legs E_i^mu as E[mu, i], shape (coordinates, dimension)."""
        entries = {(mu, i): x for mu, row in enumerate(self.legs) for i, x in row}
        n = 1 + max((i for _, i in entries), default=0)
        if self.frame is not None:
            n = self.frame.dimension
        return ElementMatrix(entries, (len(self.coordinates), n))

    @cached_property
    def coframe(self) -> ElementMatrix:
        """e[i, mu], shape (n, n), of a chart that has a frame."""
        assert self.frame is not None
        n = self.frame.dimension
        return ElementMatrix(self.frame.coframe.components.nonzero, (n, n))

    @cached_property
    def _edge_graph(self) -> Graph:
        """The edges over their own symbols."""
        names = sorted({symbol.name for edge in self.edges for symbol in edge.element.symbols})
        return graph(names, [edge.element for edge in self.edges], factor=False)

    def at_edges(self, point: Mapping[str, float]) -> np.ndarray:
        """The values of all edges at a point, by names of coordinates and parameters."""
        return self._edge_graph.numpy()(*(point[name] for name in self._edge_graph.arguments))

    @cached_property
    def _edge_slopes(self) -> ElementMatrix:
        """d edge / d coordinate, shape (edges, coordinates)."""
        entries = {
            (k, mu): slope
            for k, edge in enumerate(self.edges)
            for mu, symbol in enumerate(self.coordinates)
            if not (slope := edge.element.diff(symbol)).is_zero
        }
        return ElementMatrix(entries, (len(self.edges), len(self.coordinates)))

    @cached_property
    def _edges_with_slopes(self) -> ElementMatrix:
        """The edges in a column behind their slopes: both in one evaluation."""
        edges = {(k, len(self.coordinates)): edge.element for k, edge in enumerate(self.edges)}
        shape = (len(edges), len(self.coordinates) + 1)
        return ElementMatrix({**edges, **self._edge_slopes.entries}, shape)

    def edge_rates(self, point: Mapping[str, float], velocities: Numbers) -> np.ndarray:
        """How fast the values of all edges change along a motion with frame velocities u^i."""
        column = np.array([[float(u)] for u in velocities])
        speeds = self.frame_vectors.applied(point, column)
        return self._edge_slopes.applied(point, speeds)[:, 0]

    def edge_distances(
        self, point: Mapping[str, Real | np.ndarray], changes: np.ndarray
    ) -> tuple[np.ndarray, np.ndarray]:
        """Values of all edges at many points, and how changes of coordinates, (n,), change them."""
        values, count = self._edges_with_slopes.values(point), len(self.edges)
        reach = np.zeros((count, *values.shape[1:]))
        for (k, mu), slope in zip(self._edge_slopes.entries, np.abs(values[count:]), strict=True):
            reach[k] += slope * changes[mu]
        return values[:count], reach

    def distance(self, point: Mapping[str, float]) -> float:
        """Value of the edge at a point, in units of its margin; infinite without an edge."""
        if self.edge is None or not self.margin:
            return float("inf")
        return float(self.at_edges(point)[0]) / self.margin

    @classmethod
    def of(
        cls,
        frame: Frame,
        name: str = "",
        *,
        edge: Any = None,
        margin: float = 0.0,
        keeps_frame: bool = True,
        end: str = "",
    ) -> Chart:
        """The chart of a frame.

        Examples
        --------
        >>> from geomtorsion.spaces import load
        >>> Chart.of(load("s2").frame).names
        ('theta', 'phi')
        """
        rows = frame.legs.components.rows
        element = None if edge is None else frame.field.read(edge, "edge of the chart")
        name = name or frame.name or "home"
        return cls(name, frame.coordinates, rows, frame, keeps_frame, element, margin, end=end)

    @classmethod
    def redundant(
        cls,
        name: str,
        coordinates: Sequence[sp.Symbol],
        legs: Sequence[Sequence[Any]],
        kept: Any = None,
        parameters: Sequence[sp.Symbol] = (),
        antipodal: Sequence[int] = (),
    ) -> Chart:
        """A chart with more coordinates than dimensions, such as a unit quaternion.

        legs: E[mu, i], one row per coordinate; kept: an expression that stays equal to one;
        antipodal: indices of coordinates that give the same point with opposite signs.

        Examples
        --------
        >>> import sympy as sp
        >>> x, y = sp.symbols("x y")
        >>> Chart.redundant("circle", [x, y], [[-y], [x]], kept=x**2 + y**2).names
        ('x', 'y')
        """
        field = Field((*coordinates, *parameters))
        rows = tuple(
            tuple((i, field.read(x, f"legs[{mu}, {i}]")) for i, x in enumerate(row) if x != 0)
            for mu, row in enumerate(legs)
        )
        constant = None if kept is None else field.read(kept, "kept")
        return cls(name, tuple(coordinates), rows, kept=constant, antipodal=tuple(antipodal))


@dataclass(frozen=True, eq=False)
class TransitionMap(ByContent):
    """An exact map from one chart into another.

    source, target: names of charts.
    coordinates: symbols of the source.
    expressions: the coordinates of the target, in symbols of the source and parameters.
    angles: indices of target coordinates that count modulo 2 pi.
    sample: values of symbols where the map is defined, to choose branches of roots and logs.
    written: numerically stable form of the map; None: use `expressions`.
    """

    source: str
    target: str
    coordinates: tuple[sp.Symbol, ...]
    expressions: tuple[Any, ...]
    parameters: tuple[sp.Symbol, ...] = ()
    angles: tuple[int, ...] = ()
    sample: Mapping[sp.Symbol, Any] | None = None
    written: Written | None = None

    def __post_init__(self) -> None:
        for name in ("source", "target"):
            checks.text(getattr(self, name), name, ArgumentError)
        for name in ("coordinates", "parameters"):
            for k, symbol in enumerate(checks.entries(getattr(self, name), name)):
                checks.instance(symbol, sp.Symbol, f"{name}[{k}]")
        size = len(checks.entries(self.expressions, "expressions"))
        for k, index in enumerate(checks.entries(self.angles, "angles")):
            checks.count(index, f"angles[{k}]", ArgumentError, 0, size - 1)

    @cached_property
    def elements(self) -> list[Element]:
        """The map, read exactly."""
        field = Field((*self.coordinates, *self.parameters), sample=self.sample)
        where = f"change from {self.source} to {self.target}"
        return field.read_all([(f"{where}[{k}]", x) for k, x in enumerate(self.expressions)])

    @cached_property
    def _function(self) -> Callable[..., Any]:
        return numpy_function(self.elements, (*self.coordinates, *self.parameters), check=False)

    @cached_property
    def slopes(self) -> ElementMatrix:
        """d target / d source, shape (target coordinates, source coordinates)."""
        entries = {
            (k, j): slope
            for k, x in enumerate(self.elements)
            for j, symbol in enumerate(self.coordinates)
            if not (slope := x.diff(symbol)).is_zero
        }
        return ElementMatrix(entries, (len(self.elements), len(self.coordinates)))

    def __call__(self, coordinates: Any, parameters: Mapping[Any, Real]) -> np.ndarray:
        """Target coordinates of points with shape (size, ...); not finite where there are none.

        Raises
        ------
        ShapeError
            There is not one number, or one array, for each coordinate.
        ArgumentError
            A coordinate is not a real number, or a parameter is not among the values.
        """
        numbers = {name: float(x) for name, x in self._numbers(parameters).items()}
        place = self._places(coordinates)
        if self.written is None:
            return self._function(*place, *numbers.values())
        place = [checks.array(x, "coordinates", ArgumentError, infinite=None) for x in place]
        # The map has no values outside the source chart; the caller checks the result.
        with np.errstate(all="ignore"):
            return np.array(np.broadcast_arrays(*self.written(FLOATS, place, numbers)))

    def _places(self, coordinates: Any) -> list[Any]:
        """One entry for each coordinate."""
        is_array = isinstance(coordinates, np.ndarray) and coordinates.ndim > 0
        # Arrays of points stay arrays.
        places = (
            list(coordinates)
            if is_array
            else checks.entries(coordinates, "coordinates", ShapeError)
        )
        names = ", ".join(symbol.name for symbol in self.coordinates)
        count = len(self.coordinates)
        checks.check_one_each(places, count, f"names {names}", "coordinates", ShapeError)
        return places

    def _numbers(self, parameters: Mapping[Any, Real]) -> dict[str, Real]:
        """The values of the parameters; others are omitted."""
        by_name = checks.by_name(parameters, "parameters")
        names = [p.name for p in self.parameters]
        remedy = "Give parameters={'{missing}': ...}."
        checks.check_values(names, by_name, "parameters", ArgumentError, remedy)
        return {
            name: checks.exact_number(by_name[name], f"parameter {name}", ArgumentError)
            for name in names
        }

    def precisely(
        self, values: Numbers, parameters: Mapping[Any, Real], bits: int
    ) -> list[mpmath.mpf]:
        """Target coordinates of one point as mpmath numbers of a precision; see `__call__`."""
        checks.count(bits, "bits", ArgumentError, 2)
        place = checks.numbers(self._places(values), None, "coordinates", ArgumentError)
        names = [symbol.name for symbol in self.coordinates]
        point = {name: mpf(x, bits) for name, x in zip(names, place, strict=True)}
        numbers = {name: mpf(x, bits) for name, x in self._numbers(parameters).items()}
        if self.written is not None:
            with working_precision(2 * bits):
                image = self.written(DIGITS, list(point.values()), numbers)
            if any(isinstance(x, mpmath.mpc) for x in image):
                raise ArithmeticError(f"no point of chart {self.target!r} corresponds")
            return [mpf(x, bits) for x in image]
        point |= numbers
        levels: dict[int, Any] = {}
        return [element.evaluate(point, max(bits, 54), levels) for element in self.elements]


# A chart is worth moving to if it is this much further from its edge, in units of its margin.
GAIN = 1.5


class MovingPoint(NamedTuple):
    """Coordinates, velocities u^i in units of the speed, and carried quantities."""

    coordinates: Numbers
    velocities: Numbers
    carried: list[Real]

    @property
    def has_value(self) -> bool:
        """Whether a motion can begin here."""
        return all(math.isfinite(float(x)) for row in self for x in row)


@dataclass(frozen=True, eq=False)
class Atlas:
    """Charts of a space and the maps between them, created on first use.

    home: name of the chart of the frame that the user works with.
    makers: name -> function without arguments that makes the chart.
    changes: function without arguments that makes the maps.
    order: charts by preference; the first in which a law can be stated is used to start.
    origin: a function and the frame from which it makes this atlas, except its order; copies and
        pickles use it. Without it they contain every chart.
    """

    home: str
    makers: Mapping[str, Callable[[], Chart]]
    changes: Callable[[], tuple[TransitionMap, ...]]
    order: tuple[str, ...] = ()
    origin: tuple[Callable[[Frame], Atlas], Frame] | None = None

    def __eq__(self, other: object) -> bool:
        """Equal charts in an equal order, and equal maps."""
        if not isinstance(other, Atlas):
            return NotImplemented
        if self is other:
            return True
        if (self.home, self.names) != (other.home, other.names):
            return False
        if self.origin is not None and comparable(self.origin) == comparable(other.origin):
            return True
        charts = all(self.chart(name) == other.chart(name) for name in self.names)
        return charts and self._table == other._table

    def __hash__(self) -> int:
        return hash((self.home, self.names))

    def __reduce__(self) -> tuple[object, ...]:
        if self.origin is not None:
            return _of_origin, (*self.origin, self.order)
        charts = {name: partial(_same, self.chart(name)) for name in self.makers}
        changes = partial(_same, tuple(self._table.values()))
        return type(self), (self.home, charts, changes, self.order)

    @cached_property
    def _charts(self) -> dict[str, Chart]:
        return {}

    @cached_property
    def checked_for(self) -> set[Frame]:
        """Frames for which the maps were verified; see `check_atlas`."""
        return set()

    @cached_property
    def _table(self) -> dict[tuple[str, str], TransitionMap]:
        return {(change.source, change.target): change for change in self.changes()}

    def chart(self, name: str) -> Chart:
        """The chart of a name.

        Raises
        ------
        UnknownNameError
            The atlas has no such chart.
        """
        kind = "a chart of this space"
        checks.known_name(name, self.makers, "", UnknownNameError, expected=kind)
        if name not in self._charts:
            self._charts[name] = self.makers[name]()
        return self._charts[name]

    @property
    def names(self) -> tuple[str, ...]:
        """Names of all charts, in order of preference."""
        return self.order or tuple(self.makers)

    def only(self, *names: str) -> Atlas:
        """This atlas restricted to some charts."""
        for name in names:
            if name not in self.makers:
                self.chart(name)
        return replace(self, order=tuple(names))

    def route(self, source: str, target: str) -> list[TransitionMap]:
        """The maps that lead from one chart to another, in order."""
        if source == target:
            return []
        paths: list[list[TransitionMap]] = [[]]
        seen = {source}
        while paths:
            path = paths.pop(0)
            place = path[-1].target if path else source
            for (start, end), change in self._table.items():
                if start == place and end not in seen:
                    if end == target:
                        return [*path, change]
                    seen.add(end)
                    paths.append([*path, change])
        raise UnknownNameError(
            f"expected a map from chart {source!r} to chart {target!r}, got none. Add one to the "
            "atlas."
        )

    def angles(self, sources: Iterable[str], target: str) -> list[int]:
        """Coordinates of the target that maps from the source charts give up to full turns."""
        routes = [self.route(source, target) for source in sources]
        return sorted({k for route in routes if route for k in route[-1].angles})

    def same_frame(self, source: str, target: str) -> bool:
        """Whether two charts have the same frame vectors."""
        return self.chart(source).keeps_frame and self.chart(target).keeps_frame

    def moved(
        self,
        source: str,
        target: str,
        point: MovingPoint,
        parameters: Mapping[str, Real],
        bits: int,
    ) -> MovingPoint:
        """Position and velocity in another chart, as mpmath numbers above 53 bits.

        Up to 53 bits coordinates and velocities may be arrays of many points, shapes
        (coordinates, m) and (n, m).

        Raises
        ------
        ChartEdgeError
            The other chart does not reach the point.
        """
        if source == target:
            return point
        q, u, carried = point
        numbers = dict(parameters)
        if bits <= 53:
            q, u = (np.asarray(row, dtype=float) for row in (q, u))
        turning = not self.same_frame(source, target)

        def turned(matrix: ElementMatrix, chart: str) -> Numbers:
            place = dict(zip(self.chart(chart).names, q, strict=True)) | numbers
            if bits <= 53:
                return matrix.applied(place, np.asarray(u))
            return matrix.precisely(place, u, bits)

        if turning:
            u = turned(self.chart(source).frame_vectors, source)
        for change in self.route(source, target):
            if turning:
                u = turned(change.slopes, change.source)
            q = change(q, numbers) if bits <= 53 else change.precisely(q, numbers, bits)
        finite = np.isfinite(np.asarray(q, dtype=float)).all(axis=0)
        if not finite.all():
            places = np.asarray(point.coordinates, dtype=float)
            raise not_covered(places.reshape(len(places), -1)[:, np.argmin(finite)], source, target)
        if turning:
            u = turned(self.chart(target).coframe, target)
        return MovingPoint(q, u, carried)

    def best_chart(
        self,
        charts: Sequence[str],
        source: str,
        point: MovingPoint,
        parameters: Mapping[str, Real],
        bits: int,
        *,
        starting: bool = False,
    ) -> str | None:
        """The first chart in which the point is far from the edge, or else where it is furthest.

        A chart is skipped if the motion is much faster in it than in another chart far from its
        edge: behind a horizon, ingoing coordinates run away from outgoing motions, and outgoing
        ones from infalling motions. If a motion starts in the first chart, far from its edge, the
        other charts are not made.
        """
        numbers = {key: float(value) for key, value in parameters.items()}

        def distance_in(name: str, there: MovingPoint) -> float:
            chart = self.chart(name)
            place = dict(zip(chart.names, map(float, there.coordinates), strict=True))
            return chart.distance(place | numbers)

        if starting and source == charts[0] and distance_in(source, point) >= 2 * GAIN:
            return source
        best, score = None, 0.0
        far: list[tuple[str, float]] = []
        for name in charts:
            if name == source and not starting:
                continue
            try:
                there = self.moved(source, name, point, parameters, bits)
            except (ChartEdgeError, ArithmeticError, ValueError):
                continue
            if not there.has_value:
                continue
            distance = distance_in(name, there)
            if distance >= 2 * GAIN:
                far.append((name, math.hypot(*map(float, there.velocities))))
            if distance > score:
                best, score = name, distance
        if far:
            slowest = min(speed for _, speed in far)
            return next(name for name, speed in far if speed <= 2 * GAIN * slowest)
        return best if starting or score > GAIN else None


def not_covered(place: Iterable[Real], source: str, target: str) -> ChartEdgeError:
    """The error for a place that a chart does not reach."""
    numbers = ", ".join(f"{float(x):.6g}" for x in place)
    return ChartEdgeError(
        f"the motion passes ({numbers}) in chart {source!r}, which chart {target!r} does not "
        f"reach. Use solution.in_chart({source!r})."
    )


def _same(value: Any) -> Any:
    """The given object: a maker for an object that exists already."""
    return value


def _of_origin(make: Callable[[Frame], Atlas], frame: Frame, order: tuple[str, ...]) -> Atlas:
    """An atlas from the plain data that `Atlas.__reduce__` gives."""
    return replace(make(frame), order=order, origin=(make, frame))


def single(frame: Frame) -> Atlas:
    """The atlas of a frame that has one chart only."""
    name = frame.name or "home"
    return Atlas(name, {name: lambda: Chart.of(frame, name)}, tuple, origin=(single, frame))


def atlas_of(frame: Frame) -> Atlas:
    """The atlas that came with a frame, or its one chart."""
    if "atlas" not in frame.attached:
        frame.attached["atlas"] = single(frame)
    return frame.attached["atlas"]

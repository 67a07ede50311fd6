"""Maps: the Burgers vectors of very many small loops in one call."""

from __future__ import annotations

import time
from collections.abc import Sequence
from dataclasses import dataclass
from functools import lru_cache
from typing import Any, ClassVar

import numpy as np

from geomtorsion.errors import ChartEdgeError, LoopError, SingularPointError, WorkerError
from geomtorsion.geometry import Frame
from geomtorsion.geometry.connections import FrameLike, as_frame
from geomtorsion.loops import validation
from geomtorsion.loops.arcs import Ellipse, Parameters, Plane, Point
from geomtorsion.loops.burgers import burgers_vector
from geomtorsion.loops.chains import ClosedCurve, Shape, Square
from geomtorsion.loops.defects import find_defects
from geomtorsion.loops.domain import edge_values
from geomtorsion.loops.forms import Forms, forms
from geomtorsion.loops.integrals import Places, agreement, by_levels
from geomtorsion.loops.loop import Loop
from geomtorsion.loops.poles import steep
from geomtorsion.loops.quadrature import PIECE
from geomtorsion.support import checks
from geomtorsion.support.displays import Plot, drawn_by, figure_by
from geomtorsion.support.executors import Executor, checked_executor, each_done
from geomtorsion.support.hints import argument_hints, attribute_hints
from geomtorsion.support.progress import PATIENCE, bar

# Number of loops that are treated together: the points of each need a few pieces.
TOGETHER = PIECE // 32
# Points of the first level on a circle, and on the side of a cell: most are so small that half as
# many are enough as for one loop.
FIRST, FIRST_ON_SIDE = ClosedCurve.first // 2, Square.first // 2


@attribute_hints(
    shape="map.areas.shape", to_pandas="pandas.DataFrame(map.vectors.T)", b="map.vectors"
)
@dataclass(frozen=True, eq=False, repr=False)
class BurgersMap:
    """Burgers vectors of many loops of one shape in parallel planes.

    frame: their frame.
    plane: the two directions of the plane, shape (2, n).
    centres: q^mu, shape (n, *shape); shape: of the map, as (rows, columns) of a grid.
    areas: signed area of each loop in the coordinates of the plane, shape (*shape).
    vectors: b^i in the frame, shape (n, *shape); NaN where a loop is unfinished or singular.
    density: b^i per area, shape (n, *shape): it does not underflow.
    errors: bound on the error of the largest component, shape (*shape).
    expected: 2 S_{mn}^i A^{mn} at the centre, the limit of a small loop, shape (n, *shape).
    enclosed: where line and flux differ because a defect is inside, shape (*shape).
    done: number of finished loops; after Ctrl-C it is smaller than the number of loops.
    evaluations: points at which coframe or curl were evaluated; seconds: wall time.
    """

    frame: Frame
    plane: np.ndarray
    centres: np.ndarray
    areas: np.ndarray
    vectors: np.ndarray
    density: np.ndarray
    errors: np.ndarray
    expected: np.ndarray
    enclosed: np.ndarray
    accuracy: float
    done: int
    evaluations: int
    seconds: float

    @property
    def complete(self) -> bool:
        """Whether all loops were finished."""
        return self.done == self.areas.size

    @property
    def reached(self) -> np.ndarray:
        """Whether each loop reached the requested relative error, shape (*shape)."""
        return self.errors <= self.accuracy * np.abs(self.vectors).max(axis=0)

    @property
    def total(self) -> np.ndarray:
        """Sum of all finished vectors, shape (n,): on a grid, b of the loop around all of it."""
        return np.nansum(self.vectors.reshape(len(self.vectors), -1), axis=1)

    _repr_html_ = drawn_by("notebook_pictures", "map_html")
    plot: ClassVar[Plot] = figure_by("loops", "draw_map")

    def __array__(self, dtype: Any = None, copy: bool | None = None) -> np.ndarray:
        """The vectors, shape (n, *shape)."""
        return np.array(self.vectors, dtype=dtype)

    def __repr__(self) -> str:
        text = f"BurgersMap({self.done} of {self.areas.size} loops, {self.seconds:.2g} s"
        if self.enclosed.any():
            text += f", {int(np.count_nonzero(self.enclosed))} enclose a defect"
        return text + ")"


def burgers_vectors(
    frame: FrameLike,
    centres: Sequence[Point] | np.ndarray,
    radius: float | Sequence[float] | np.ndarray,
    plane: Plane = (0, 1),
    accuracy: float = 1e-10,
    *,
    parameters: Parameters | None = None,
    executor: Executor | None = None,
) -> BurgersMap:
    """Burgers vectors of many circles in parallel planes.

    Parameters
    ----------
    centres
        q^mu, shape (k, n).
    radius
        One radius, or one for each circle, shape (k,).
    plane
        Two coordinates, or two vectors, which are made orthonormal in the coordinates.
    accuracy
        Requested relative error of each vector.
    executor
        Takes the loops in blocks: a pool of `concurrent.futures`, or a `dask.distributed.Client`.
        The result has the same bits for any number of workers.

    Raises
    ------
    LoopError
        A number is missing or not finite, or a radius is not positive.
    MissingValueError
        A parameter of the frame has no value.
    WorkerError
        A worker ended without a result; its `partial` has the loops that others finished.

    Examples
    --------
    >>> import sympy as sp
    >>> from geomtorsion.geometry import Frame
    >>> x, y, z = sp.symbols("x y z")
    >>> frame = Frame([x, y, z], [[1, 0, 0], [0, 1, 0], [-y, x, 1]])
    >>> found = burgers_vectors(frame, [[0, 0, 0], [1, 2, 3]], [1e-6, 1.0])
    >>> found.vectors[2] / found.areas
    array([2., 2.])
    """
    frame = as_frame(frame)
    places = _array(centres, "centres", 2)
    radii = np.broadcast_to(_array(radius, "radius"), places.shape[:1])
    if not (radii > 0).all():
        first = int(np.argmin(radii > 0))
        raise LoopError(f"radius: circle {first} has radius {radii[first]}; give positive ones.")
    _check_dimension(frame, places.shape[1])
    directions = np.array(
        validation.orthonormal(*validation.rows(plane, frame.dimension, _names(frame)))
    )
    axes = np.stack([radii, radii])
    circle = ClosedCurve(Ellipse((1.0, 0.0), (0.0, 1.0)), first=FIRST)
    centres = places.T
    return _map(frame, circle, np.pi, centres, axes, directions, accuracy, parameters, executor)


def _names(frame: Frame) -> list[str]:
    """Names of the coordinates."""
    return [symbol.name for symbol in frame.coordinates]


@argument_hints()
def burgers_map(
    frame: FrameLike,
    edges: Sequence[Sequence[float] | np.ndarray],
    plane: Plane = (0, 1),
    at: Sequence[float] | None = None,
    accuracy: float = 1e-10,
    *,
    parameters: Parameters | None = None,
    executor: Executor | None = None,
) -> BurgersMap:
    """Burgers vectors of all plaquettes of a grid: the density of dislocations over a surface.

    Parameters
    ----------
    edges
        Positions of the lines of the grid along both directions of the plane: two increasing arrays
        of k + 1 and m + 1 numbers, counted from the point `at`.
    plane
        Two coordinates, or two vectors of shape (n,), taken as given.
    at
        Coordinates of the point from which the edges count; the origin if not given.
    executor
        See `burgers_vectors`.

    Returns
    -------
    BurgersMap of shape (k, m).

    Raises
    ------
    LoopError
        The edges do not increase, or a number is missing or not finite.
    MissingValueError
        A parameter of the frame has no value.

    Examples
    --------
    >>> import numpy as np
    >>> from geomtorsion.spaces import load
    >>> grid = np.linspace(-1, 1, 12)
    >>> found = burgers_map(load("screw_dislocation").frame, (grid, grid), parameters={"b": 3})
    >>> found.areas.shape, found.enclosed.sum(), abs(found.total).round(9)
    ((11, 11), np.int64(1), array([0., 0., 3.]))
    """
    frame = as_frame(frame)
    two = "two arrays, one for each direction of the plane"
    sides = checks.entries(edges, "edges", LoopError, 2, expected=two)
    lines = [_array(side, f"edges[{k}]", 1) for k, side in enumerate(sides)]
    for k, side in enumerate(lines):
        if len(side) < 2 or not (np.diff(side) > 0).all():
            raise LoopError(f"edges[{k}]: expected at least two increasing numbers.")
    n = frame.dimension
    place = np.zeros(n) if at is None else np.array(validation.vector(at, "at", n))
    directions = np.array(validation.rows(plane, n, _names(frame)))
    middles = np.meshgrid(*((side[1:] + side[:-1]) / 2 for side in lines), indexing="ij")
    steps = np.stack(np.meshgrid(*(np.diff(side) for side in lines), indexing="ij"))
    centres = place[:, None, None] + np.einsum("an,akm->nkm", directions, np.stack(middles))
    square = Square(FIRST_ON_SIDE)
    return _map(frame, square, 1.0, centres, steps, directions, accuracy, parameters, executor)


@dataclass(frozen=True, eq=False)
class _Family:
    """What all loops of a map have in common.

    frame, accuracy, parameters, plane: as the user gave them.
    shape: of every loop; area: of the shape itself.
    forms: the forms of the frame along the plane.
    """

    frame: Frame
    shape: Shape
    area: float
    plane: np.ndarray
    accuracy: float
    parameters: Parameters | None
    forms: Forms

    def measured(self, centres: np.ndarray, axes: np.ndarray) -> tuple[_Values, int]:
        """All loops with these centres, shape (n, k), and axes, (2, k), and points evaluated."""
        sizes = axes.max(axis=0)
        places = Places(centres, sizes, axes / sizes, self.plane)
        line, flux = (
            by_levels(self.forms, self.shape, places, self.accuracy, degree) for degree in (1, 2)
        )
        assert line is not None
        assert flux is not None
        agree, by_flux = agreement(line, flux, sizes)
        areas = self.area * axes[0] * axes[1]
        with np.errstate(all="ignore"):
            value = np.where(by_flux, sizes * flux.values, line.values)
            error = np.where(by_flux, sizes * flux.error, line.error)
            # Where areas underflow, shares of them do not.
            shares = self.area * axes.min(axis=0) / sizes
            density = np.where(by_flux, flux.values, line.values / sizes) / shares
        result = _Values(
            value * sizes,
            density,
            error * sizes,
            self._expected(centres) * areas,
            ~agree & np.isfinite(line.error) & np.isfinite(flux.error),
        )
        largest = np.abs(value).max(axis=0)
        unsettled = ~(error <= self.accuracy * largest) & ~(largest <= error)
        unsettled |= ~np.isfinite(flux.error) | self._near_poles(places) | self._outside(places)
        unsettled |= by_flux & self._near_lines(places)
        points = line.points + flux.points
        for k in np.flatnonzero(unsettled):
            points += self._alone(result, int(k), centres[:, k], axes[:, k])
        return result, points

    def _expected(self, centres: np.ndarray) -> np.ndarray:
        """Twice the torsion in the plane at the centres, shape (n, k)."""
        form = self.forms.curl
        if form is None:
            return np.zeros_like(centres)
        places = Places(centres, np.ones(centres.shape[1]), None, self.plane)
        return places.projection(form, self.forms.pairs)[:, 0] @ form.values(centres)

    def _near_poles(self, places: Places) -> np.ndarray:
        """Loops on which a denominator of the coframe comes close to zero, shape (k,)."""
        if self.forms.poles is None:
            return np.zeros(len(places.sizes), dtype=bool)
        return steep(self.forms.poles, places.points(self.shape.rim(2).points))

    def _near_lines(self, places: Places) -> np.ndarray:
        """Loops that may surround a singular line, shape (k,)."""
        near = np.zeros(len(places.sizes), dtype=bool)
        for line in find_defects(self.frame) if self.forms.poles is not None else ():
            if line.across is not None:
                place = line.place(self.parameters)
                across = np.array(validation.rows(line.across, len(place)))
                apart = np.abs(across @ (places.centres - np.array(place)[:, None]))
                reach = 2 * np.abs(across).sum(axis=1)[:, None] * places.sizes
                near |= (apart <= reach).all(axis=0)
        return near

    def _outside(self, places: Places) -> np.ndarray:
        """Loops with a point outside the domain of the frame, shape (k,)."""
        edges = edge_values(self.frame, self.parameters)
        count = len(places.sizes)
        if edges is None:
            return np.zeros(count, dtype=bool)
        points = places.points(self.shape.rim(2).points)
        inside = np.real(edges.values(points.reshape(len(points), -1))) > 0
        return np.asarray(~inside.reshape(len(inside), count, -1).all(axis=(0, 2)))

    def _alone(self, result: _Values, k: int, centre: np.ndarray, axes: np.ndarray) -> int:
        """One loop that the rules for many could not settle, and points evaluated."""
        try:
            loop = self._loop(centre, axes)
            b = burgers_vector(self.frame, loop, self.accuracy, parameters=self.parameters)
        except (SingularPointError, ChartEdgeError, LoopError):
            # A map shows where there is no vector.
            result.vectors[:, k], result.density[:, k] = np.nan, np.nan
            result.errors[k], result.enclosed[k] = np.inf, False
            return 0
        result.vectors[:, k], result.errors[k] = b.vector, b.error
        result.density[:, k] = b.reduced * b.size ** (b.power - 1) / (self.area * axes.min())
        result.enclosed[k] = b.check.agrees is False
        return b.evaluations

    def _loop(self, centre: np.ndarray, axes: np.ndarray) -> Loop:
        """A loop of the map as a loop of its own."""
        first, second = self.plane.tolist()
        if isinstance(self.shape, ClosedCurve):
            return Loop.circle(centre.tolist(), float(axes[0]), (first, second))
        a, b = (axes / axes.max()).tolist()
        corners = [(-a / 2, -b / 2), (a / 2, -b / 2), (a / 2, b / 2), (-a / 2, b / 2)]
        vertices = [[x * u + y * v for u, v in zip(first, second, strict=True)] for x, y in corners]
        return Loop.polygon(vertices, centre=centre.tolist(), size=float(axes.max()))


@dataclass(frozen=True, eq=False)
class _Values:
    """Results of several loops, arrays that are filled block by block.

    vectors, density, expected: shape (n, k); errors, enclosed: shape (k,).
    """

    vectors: np.ndarray
    density: np.ndarray
    errors: np.ndarray
    expected: np.ndarray
    enclosed: np.ndarray

    def fill(self, chosen: slice, block: _Values) -> None:
        """Put the results of a block in their place."""
        for name in ("vectors", "density", "errors", "expected", "enclosed"):
            getattr(self, name)[..., chosen] = getattr(block, name)


def _map(
    frame: Frame,
    shape: Shape,
    area: float,
    centres: np.ndarray,
    axes: np.ndarray,
    plane: np.ndarray,
    accuracy: float,
    parameters: Parameters | None,
    executor: Executor | None,
) -> BurgersMap:
    """Do all loops block by block; on Ctrl-C keep the finished blocks."""
    start = time.perf_counter()
    pool = checked_executor(executor)
    validation.check_accuracy(accuracy, 1e-14)
    columns = tuple(np.flatnonzero(plane.any(axis=0)).tolist())
    # What the frame refuses is refused here, before anything is sent.
    forms(frame, parameters, columns)
    grid, n = centres.shape[1:], frame.dimension
    places, sizes = centres.reshape(n, -1), axes.reshape(2, -1)
    count = sizes.shape[1]
    empty = np.full((n, count), np.nan, dtype=complex if frame.complex else float)
    values = _Values(
        empty, empty.copy(), np.full(count, np.inf), empty.copy(), np.zeros(count, bool)
    )
    done = points = 0
    failure: WorkerError | None = None
    blocks = [slice(k, min(k + TOGETHER, count)) for k in range(0, count, TOGETHER)]
    family = frame, shape, area, plane, accuracy, parameters, columns
    work = ((*family, places[:, block], sizes[:, block]) for block in blocks)
    try:
        with bar(f"{count} loops", count, patience=PATIENCE) as show:
            for k, (block, more) in each_done(pool, _sent if pool else _block, work):
                values.fill(blocks[k], block)
                done, points = done + blocks[k].stop - blocks[k].start, points + more
                if show is not None:
                    show(done)
    except KeyboardInterrupt:
        # Finished blocks are returned; `complete` records the interruption.
        pass
    except WorkerError as error:
        failure = error
    result = BurgersMap(
        frame=frame,
        plane=plane,
        centres=centres,
        areas=(area * sizes[0] * sizes[1]).reshape(grid),
        vectors=values.vectors.reshape(n, *grid),
        density=values.density.reshape(n, *grid),
        errors=values.errors.reshape(grid),
        expected=values.expected.reshape(n, *grid),
        enclosed=values.enclosed.reshape(grid),
        accuracy=accuracy,
        done=done,
        evaluations=points,
        seconds=time.perf_counter() - start,
    )
    if failure is not None:
        block = blocks[failure.part]
        raise WorkerError(
            f"expected results from all workers, got none for loops {block.start} to "
            f"{block.stop - 1}: {failure}. The finished loops are in the error's `partial`. Start "
            "new workers, and compute the others.",
            partial=result,
        )
    return result


@lru_cache(maxsize=8)
def _first_equal(frame: Frame) -> Frame:
    """The first of equal frames: a worker compiles it once, and receives a copy with each block."""
    return frame


def _block(
    frame: Frame,
    shape: Shape,
    area: float,
    plane: np.ndarray,
    accuracy: float,
    parameters: Parameters | None,
    columns: tuple[int, ...],
    centres: np.ndarray,
    axes: np.ndarray,
) -> tuple[_Values, int]:
    """Some of the loops, in this process."""
    compiled = forms(frame, parameters, columns)
    family = _Family(frame, shape, area, plane, accuracy, parameters, compiled)
    return family.measured(centres, axes)


def _sent(frame: Frame, *rest: Any) -> tuple[_Values, int]:
    """Some of the loops, in a worker."""
    return _block(_first_equal(frame), *rest)


def _array(values: object, where: str, rank: int | None = None) -> np.ndarray:
    """An array of finite floats of a given rank; without one, a number or a list of them."""
    result = checks.array(values, where, LoopError)
    if rank is not None and result.ndim != rank:
        raise LoopError(f"{where}: expected {rank} axes, got shape {result.shape}.")
    if rank is None and result.ndim > 1:
        raise LoopError(
            f"{where}: expected one number, or one for each loop, got shape {result.shape}."
        )
    return result


def _check_dimension(frame: Frame, dimension: int) -> None:
    """Refuse points in another number of coordinates than the frame has."""
    if dimension != frame.dimension:
        raise LoopError(
            f"centres have {dimension} coordinates, the frame {frame.dimension}: "
            "give an array of shape (loops, coordinates)."
        )

"""Equation values: field equations at points, in balls, without an expression of them."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from itertools import product
from types import MappingProxyType
from typing import Any, Protocol, TypeVar

import numpy as np

from geomtorsion.codegen import balls
from geomtorsion.errors import CoordinateError, GravityError, MissingValueError, ShapeError
from geomtorsion.exact import TruncatedField
from geomtorsion.geometry import Connection, Frame, Tensor, cartan, levi_civita
from geomtorsion.geometry.numeric.frames import numeric_frame
from geomtorsion.geometry.numeric.numeric_field import NumericField
from geomtorsion.geometry.numeric.power_series import PowerSeries
from geomtorsion.support import checks
from geomtorsion.support.caching import cached_property
from geomtorsion.support.exclusive import exclusive
from geomtorsion.support.precision import EPS, EXACT_BITS, ball_precision


class Equations(Protocol):
    """Field equations, as far as their evaluation needs them."""

    @property
    def connections(self) -> tuple[Connection, ...]:
        """The connections over one frame."""
        ...

    @property
    def frame(self) -> Frame:
        """The frame of all connections."""
        ...

    @property
    def constants(self) -> tuple[str, ...]:
        """Names of the constants of the Lagrangian."""
        ...

    @property
    def tensors(self) -> Mapping[str, Tensor]:
        """Equations by their names."""
        ...

    @property
    def matter_equations(self) -> Mapping[str, Tensor]:
        """Equations of matter fields."""
        ...

    @property
    def L(self) -> Tensor:
        """The Lagrangian."""
        ...

    def scalar(self, name: str) -> Tensor:
        """An invariant by its name."""
        ...

    def is_metric(self, number: int) -> bool:
        """Whether a connection is metric and varied among metric connections only."""
        ...

    @property
    def invariant_names(self) -> tuple[str, ...]:
        """Names of the invariants in the Lagrangian."""
        ...


# Points that are evaluated at once: their series of all components take some 100 MB of memory.
TOGETHER = 32

E = TypeVar("E", bound=Equations)


@dataclass(frozen=True, eq=False, repr=False)
class EquationValues:
    """Numbers of field equations at a point, or at points whose shape comes first.

    tensors: E, E_[ij], and C and M where they are varied; leg indices in the order of the tensors
        of the same names of `FieldEquations`, here all axes of arrays.
    matter: the equation of each matter field, by its name.
    scalars: L and the invariants in it.
    errors: for each of these names bounds of the errors, of the same shapes: rounding is enclosed
        by ball arithmetic. On a grid they are estimates from twice the step, and NaN is unknown.

    Examples
    --------
    >>> import geomtorsion as gt
    >>> hole = gt.spaces.load("schwarzschild").frame
    >>> values = gt.gravity.equations(gt.cartan(hole), "T").at(
    ...     {"t": 0, "r": 5, "theta": 1, "phi": 0, "M": 1}
    ... )
    >>> values.E.shape, values.largest < 1e-15, values.error < 1e-15
    ((4, 4), True, True)
    """

    tensors: Mapping[str, np.ndarray]
    matter: Mapping[str, np.ndarray]
    scalars: Mapping[str, np.ndarray]
    errors: Mapping[str, np.ndarray]

    @property
    def E(self) -> np.ndarray:
        """E_i^n, axes (i, n) last."""
        return self.tensors["E"]

    @property
    def C(self) -> np.ndarray:
        """C^{ni}_j, axes (n, i, j) last.

        Raises
        ------
        GravityError
            The connection is not varied on its own.
        """
        return self._tensor("C")

    @property
    def M(self) -> np.ndarray:
        """M_ij, axes (i, j) last.

        Raises
        ------
        GravityError
            All connections are metric.
        """
        return self._tensor("M")

    def _tensor(self, name: str) -> np.ndarray:
        if name not in self.tensors:
            raise GravityError(
                f"{name}: expected one of {', '.join(self.tensors)}, got {name}, which these "
                "connections do not have. Use E."
            )
        return self.tensors[name]

    @property
    def L(self) -> np.ndarray:
        """The Lagrangian."""
        return self.scalars["L"]

    @cached_property
    def largest(self) -> float:
        """Largest size of all components of the equations: 0 on a solution."""
        every = {**self.tensors, **self.matter}
        return max(float(np.nanmax(np.abs(x))) for x in every.values())

    @cached_property
    def error(self) -> float:
        """Largest error bound of all components of the equations."""
        names = (*self.tensors, *self.matter)
        return max(float(np.nanmax(self.errors[name])) for name in names)

    def __repr__(self) -> str:
        names = ", ".join((*self.tensors, *self.matter))
        sizes = f"largest {self.largest:.3g}, error below {self.error:.1g}"
        return f"field equations in numbers ({names}): {sizes}"

    def __str__(self) -> str:
        """Components of the equations at one point with their errors; otherwise the sizes."""
        lines = [repr(self)]
        for name, array in {**self.tensors, **self.matter}.items() if not self.L.ndim else ():
            lines += [
                f"  {name}{list(index)} = {value:.12g} +- {self.errors[name][index]:.1g}"
                for index, value in np.ndenumerate(array)
                if value
            ]
        return "\n".join(lines)


# -- numeric frames and connections ----------------------------------------------------------------


def evaluated_frame(frame: Frame, field: NumericField) -> Frame:
    """An exact frame in numbers."""
    places = [(name, index) for name, matrix in frame.given.items() for index in matrix]
    values = field.evaluated([frame.given[name][index] for name, index in places])
    matrices: dict[str, dict] = {name: {} for name in frame.given}
    for (name, index), value in zip(places, values, strict=True):
        matrices[name][index] = value
    return numeric_frame(frame, field, matrices)


def evaluated_connection(connection: Connection, frame: Frame, is_metric: bool) -> Connection:
    """A connection over the frame in numbers."""
    if connection.kind == "cartan":
        return cartan(frame)
    if connection.kind == "levi-civita":
        return levi_civita(frame)
    get, n = connection.coefficients.components.get, frame.dimension
    places = list(product(range(n), repeat=3))
    field: Any = frame.field
    values = field.evaluated([get(index) for index in places])
    coefficients = Tensor(
        frame, "ddu", dict(zip(places, values, strict=True)), (), "\\Gamma", "", anchored=(1, 2)
    )
    kind = "metric" if is_metric else "general"
    return Connection(frame, coefficients, connection.name, kind, None, connection.allowed)


def in_numbers(equations: E, field: NumericField) -> E:
    """Field equations over a numeric field."""
    frame = evaluated_frame(equations.frame, field)
    connections = tuple(
        evaluated_connection(one, frame, equations.is_metric(k))
        for k, one in enumerate(equations.connections)
    )
    return replace(equations, connections=connections)  # type: ignore[type-var]


# -- at points -------------------------------------------------------------------------------------


@exclusive
def equations_at(equations: Equations, point: Mapping[Any, Any]) -> EquationValues:
    """See FieldEquations.at."""
    frame = equations.frame
    if isinstance(frame.field, TruncatedField):
        raise GravityError(
            f"at: expected the equations of an exact frame, got {frame!r}, a series in a small "
            "parameter. Take equations.order(k), or the frame that was expanded."
        )
    if frame.complex:
        raise GravityError("at: expected a real frame, got a complex one. Give a real tetrad.")
    values = _values(equations, point)
    several = {name: x for name, x in values.items() if np.ndim(x)}
    if not several:
        return _joined([_at_points(equations, values)], [[0]], ())
    try:
        arrays = np.broadcast_arrays(*(np.array(x, dtype=object) for x in several.values()))
    except ValueError:
        shapes = ", ".join(str(np.shape(x)) for x in several.values())
        raise ShapeError(
            f"point: expected values of one shape, got the shapes {shapes}. Give lists of equal "
            "length, or single numbers."
        ) from None
    if not arrays[0].size:
        raise ShapeError("point: expected at least one point, got none.")
    flat = dict(zip(several, (x.ravel() for x in arrays), strict=True))
    blocks = list(_blocks(equations, flat))
    points = [_at_points(equations, values | one) for _, one in blocks]
    return _joined(points, [places for places, _ in blocks], arrays[0].shape)


def _blocks(
    equations: Equations, flat: Mapping[str, np.ndarray]
) -> Iterator[tuple[list[int], dict[str, Any]]]:
    """Points that are evaluated together: their numbers, and the values of all that varies.

    Points of one block share the constants, which may be exponents.
    """
    axes = {x.name for x in equations.frame.coordinates}
    constants = [name for name in flat if name not in axes]
    sizes = len(next(iter(flat.values())))
    groups: dict[tuple[Any, ...], list[int]] = {}
    for k in range(sizes):
        groups.setdefault(tuple(flat[name][k] for name in constants), []).append(k)
    for shared, members in groups.items():
        for start in range(0, len(members), TOGETHER):
            places = members[start : start + TOGETHER]
            moving = {name: x[places] for name, x in flat.items() if name in axes}
            yield places, dict(zip(constants, shared, strict=True)) | moving


def _values(equations: Equations, point: Mapping[Any, Any]) -> dict[str, Any]:
    """Name -> number of each coordinate, parameter and constant."""
    frame = equations.frame
    named = checks.by_name(point, "point", CoordinateError)
    names = [x.name for x in (*frame.coordinates, *frame.parameters)]
    names += [x for x in equations.constants if x not in names]
    # Symbols that a connection or a matter field brought into the field.
    names += [x.name for x in frame.field.symbols if x.name not in names and x.name in named]
    kind = "coordinates, parameters and constants of these equations"
    for name, value in named.items():
        checks.known_name(name, names, "point", CoordinateError, expected=kind)
        if not np.ndim(value):
            checks.number(value, f"point: {name}", CoordinateError)
        symbol = next((x for x in frame.parameters if x.name == name), None)
        if symbol is not None and not np.ndim(value):
            checks.check_declared(symbol, value)
    missing = [x.name for x in frame.coordinates if x.name not in named]
    if missing:
        raise MissingValueError(
            f"point: expected a value of each coordinate, got none for {', '.join(missing)}. Add "
            "it to the values."
        )
    return named


# Numbers with a ball each: tensors, matter, scalars.
Groups = tuple[dict[str, np.ndarray], dict[str, np.ndarray], dict[str, np.ndarray]]


def _at_points(equations: Equations, values: Mapping[str, Any]) -> Groups:
    """All equations at a point, or at several that come first, as arrays of finite balls."""
    order = 2
    with ball_precision(EXACT_BITS):
        groups, depth = _evaluated(equations, values, order)
        if depth > order:
            groups, _ = _evaluated(equations, values, depth)
    every = [x for group in groups for array in group.values() for x in np.ravel(array)]
    if not all(x.is_finite() for x in every):
        raise CoordinateError(
            "point: expected a point where the equations have finite values, got one where they "
            "have none. Choose another point."
        )
    return groups


def _ball(value: Any) -> Any:
    """A number as a ball, or an array of numbers as an array of balls."""
    if np.ndim(value):
        return np.array([_ball(x) for x in value], dtype=object)
    checks.number(value, "point", CoordinateError)
    return balls.exact_ball(checks.plain(value))


def _evaluated(equations: Equations, values: Mapping[str, Any], order: int) -> tuple[Groups, int]:
    coordinates = equations.frame.coordinates
    series = PowerSeries(len(coordinates), order)
    given: dict[str, Any] = {name: _ball(x) for name, x in values.items()}
    shape = np.broadcast_shapes(*(np.shape(x) for x in given.values()))
    for mu, symbol in enumerate(coordinates):
        given[symbol.name] = series.variable(mu, given[symbol.name])
    field = NumericField(coordinates, series, given, in_balls=True)
    numeric = in_numbers(equations, field)
    scalars = {"L": numeric.L} | {x: numeric.scalar(x) for x in equations.invariant_names}
    groups = (numeric.tensors, numeric.matter_equations, scalars)
    depth = 0
    arrays: list[dict[str, np.ndarray]] = []
    for group in groups:
        made = {}
        for name, tensor in group.items():
            elements = dict(leading(tensor))
            depth = max([depth, *(x.depth for x in elements.values())])
            sizes = (tensor.frame.dimension,) * len(tensor.slots)
            array = np.empty(shape + sizes, dtype=object)
            for index, x in elements.items():
                array[(..., *index)] = x.value if x.is_constant else x.value[..., 0]
            made[name] = array
        arrays.append(made)
    return (arrays[0], arrays[1], arrays[2]), depth


def leading(tensor: Tensor) -> Iterator[tuple[tuple[int, ...], Any]]:
    """Each index of a tensor with its element."""
    for index in product(range(tensor.frame.dimension), repeat=len(tensor.slots)):
        yield index, tensor.components.get(index)


def _joined(
    blocks: Sequence[Groups], places: Sequence[Sequence[int]], shape: tuple[int, ...]
) -> EquationValues:
    """Floats with bounds of their errors, from balls at the points of each block.

    A ball that contains zero becomes zero, with a bound of the whole ball.
    """
    errors: dict[str, np.ndarray] = {}
    floats: list[Mapping[str, np.ndarray]] = []
    order = np.argsort(np.concatenate(places))
    middle = np.frompyfunc(lambda x: 0.0 if x.contains(0) else float(x.mid()), 1, 1)
    radius = np.frompyfunc(lambda x: float(abs(x).upper() if x.contains(0) else x.rad()), 1, 1)
    for number in range(3):
        group = {}
        for name in blocks[0][number]:
            arrays = [np.asarray(one[number][name]) for one in blocks]
            joined = np.concatenate(arrays)[order] if shape else arrays[0]
            joined = joined.reshape(shape + joined.shape[1:]) if shape else joined
            values = np.asarray(middle(joined), dtype=float)
            group[name] = values
            # The middle is rounded to a float.
            error = np.asarray(radius(joined), dtype=float) + EPS * np.abs(values)
            # A matter field and its equation have one name.
            errors[name] = np.maximum(error, errors.get(name, 0.0))
        floats.append(MappingProxyType(group))
    return EquationValues(floats[0], floats[1], floats[2], MappingProxyType(errors))

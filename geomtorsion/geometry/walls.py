"""Walls: what vanishes or becomes infinite at the edges of a region, and points around them."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from fractions import Fraction
from typing import TYPE_CHECKING, Any

import numpy as np
import sympy as sp

from geomtorsion.codegen.balls import BallCode
from geomtorsion.codegen.expression_graph import graph
from geomtorsion.errors import GeomtorsionError
from geomtorsion.exact import Element
from geomtorsion.geometry.real_points import (
    BATCHES,
    NEAR,
    RealPoints,
    Table,
    numbers_of,
    replaced,
    side,
)
from geomtorsion.geometry.region_words import Condition
from geomtorsion.support import checks
from geomtorsion.support.caching import cached_property

if TYPE_CHECKING:
    from geomtorsion.geometry.frame import Frame
    from geomtorsion.geometry.regions import Region

Array = np.ndarray

# Points of each straight line that are checked against walls.
STATIONS = 24
# Halvings of a line on which a wall is met, until it is as near as a wall may be.
HALVINGS = math.ceil(-math.log2(NEAR))


class Walls:
    """The walls of one frame: what vanishes or becomes infinite there, and candidates around."""

    def __init__(self, frame: Frame) -> None:
        self.frame = frame
        self._balls: BallCode | None = None
        self.source = _source(frame)
        self.symbols = self.source.symbols
        self.candidates = self.source.candidates
        self.arguments = (*self.symbols, *self.source.unknown)
        self.elements = {str(x): x for x in wall_elements(frame)}
        self.expressions = _with_simple_zeros([x.sympy for x in self.elements.values()])
        if frame.complex:
            # An element that is not real vanishes at no wall of a real region.
            values = self.source.numbers(self.expressions)(self.start())[:, 0]
            pairs = zip(self.expressions, values, strict=True)
            self.expressions = [x for x, value in pairs if abs(value.imag) <= NEAR * abs(value)]
        self.numbers = self.source.numbers(self.expressions)
        self.sides = self.source.numbers([side(relation) for relation in self.source.relations])

    @cached_property
    def table(self) -> Table:
        """Candidates among which regions are compared: enough of them to see all."""
        first = self.source.table
        return first if first.size >= BATCHES[1] else self.source.batch(BATCHES[1])

    def balls(self, expressions: Sequence[sp.Expr]) -> BallCode | None:
        """Walls as functions of balls; None where a function has no ball."""
        if self._balls is None:
            names = {s: sp.Symbol(f"x{k}") for k, s in enumerate(self.arguments)}
            plain = [replaced(x, names) for x in expressions]
            try:
                self._balls = BallCode(graph([x.name for x in names.values()], plain))
            except GeomtorsionError:
                return None
        return self._balls

    def start(self) -> Array:
        """The generic point of the frame, as a column."""
        values = self.frame.field.exact.sample.values
        if all(s in values for s in self.arguments):
            return np.array([[float(values[s])] for s in self.arguments])
        return self.table.values[:, self.table.groups[0].numbers[:1]]

    def extremes(self) -> list[Array]:
        """Columns near the origin of the coordinates, far from it, and the origin itself."""
        count, columns = len(self.source.coordinates), list[Array]()
        for scale in (NEAR**0.5, NEAR**-0.5):
            column = self.table.values[:, : BATCHES[0]].copy()
            column[:count] *= scale
            columns.append(column)
        # There sums of squares vanish.
        origin = self.start()
        origin[:count] = 0
        return [*columns, origin]

    def first_point(self) -> dict[sp.Expr, Any]:
        """The generic point of the frame; the values of unknown functions are in it."""
        values = self.frame.field.exact.sample.values
        if all(s in values for s in self.arguments):
            return {s: sp.Rational(values[s]) for s in self.arguments}
        return self.candidates.exact(self.table.groups[0].numbers[0])

    def holds(self, columns: Array, signs: Array, conditions: Sequence[Condition] = ()) -> Array:
        """Whether the walls have these signs at columns, and the conditions and the domain hold."""
        shape = columns.shape[1:]
        flat = columns.reshape(len(columns), -1)
        with np.errstate(all="ignore"):
            good = np.all(np.sign(np.real(self.numbers(flat))) == signs[:, None], axis=0)
            good &= np.all(np.real(self.sides(flat)) > 0, axis=0)
            for condition in conditions:
                good &= condition.holds(flat)
        return good.reshape(shape)

    def reach(
        self, center: Array, columns: Array, signs: Array, conditions: Sequence[Condition] = ()
    ) -> Array:
        """How far each straight line from a point to a column stays inside: from 0 to 1."""
        shares = np.linspace(0, 1, STATIONS + 1)[1:]
        lines = center[:, :, None] + (columns - center)[:, :, None] * shares
        inside = np.logical_and.accumulate(self.holds(lines, signs, conditions), axis=1)
        reach = inside.sum(axis=1) / STATIONS
        step = np.where(reach < 1, 0.5 / STATIONS, 0)
        for _ in range(HALVINGS):
            trial = reach + step
            at = center + (columns - center) * trial
            reach = np.where(self.holds(at, signs, conditions), trial, reach)
            step = step / 2
        return np.minimum(reach, 1)

    def beyond(self, center: Array, columns: Array, signs: Array) -> Array:
        """Columns behind the first wall on each straight line from a point."""
        reach = self.reach(center, columns, signs)
        behind = reach < 1
        step = reach[behind] * (1 + NEAR**0.5)
        return center + (columns - center)[:, behind] * step

    def seen(self, center: Array, columns: Array, region: Region) -> Array:
        """As `reach`, inside a region."""
        return self.reach(center, columns, self.signs_of(region), self.sides_of(region))

    def signs_of(self, region: Region) -> Array:
        """The signs of all walls in a region, in their order."""
        return np.array([region.signs[x] for x in self.expressions], dtype=int)

    def sides_of(self, region: Region) -> list[Condition]:
        """The relations of a region as conditions on candidates."""
        return [Condition((r,), self.arguments) for r in region.relations]

    def members(self, region: Region) -> Iterator[list[int]]:
        """Numbers of the candidates inside a region, batch by batch."""
        center = self.center(region)
        for size in BATCHES:
            table = self.source.batch(size)
            inside = np.flatnonzero(self._inside(region, table.values))
            columns = table.values[:, inside]
            seen = self.seen(center, columns, region) >= 1
            yield [int(k) for k in inside[seen]]

    def _inside(self, region: Region, columns: Array) -> Array:
        """Whether columns have the signs of a region, without asking how they are connected."""
        return self.holds(columns, self.signs_of(region), self.sides_of(region))

    def center(self, region: Region) -> Array:
        """The point of a region as a column; unknown functions have their generic values."""
        point = {**self.first_point(), **region.point}
        return np.array([[float(point[s])] for s in self.arguments])

    def element(self, expression: object) -> Element:
        """An expression in the symbols of the frame as an element."""
        if isinstance(expression, Element):
            return expression
        (element,) = self.frame.read([("expression", checks.plain(expression))])
        return element

    def extreme_points(self, region: Region, element: Element) -> Iterator[dict[sp.Expr, Fraction]]:
        """The points of a region where doubles give an element its largest and least value."""
        columns = self._spread(region)
        with np.errstate(all="ignore"):
            values = np.real(numbers_of([element.sympy], self.arguments)(columns)[0])
        values = np.where(np.isfinite(values), values, 0)
        if values.min() < 0 < values.max():
            for k in (values.argmin(), values.argmax()):
                numbers = map(Fraction, map(float, columns[:, k]))
                yield dict(zip(self.arguments, numbers, strict=True))

    def _spread(self, region: Region) -> Array:
        """Columns of points all over a region, and close to its walls."""
        center = self.center(region)
        # Along each axis: from one wall to the other.
        far = abs(center) * NEAR**-0.5
        axes = [center + sign * np.diag(far[:, 0]) for sign in (1, -1)]
        columns = np.concatenate([self.table.values, *self.extremes(), *axes], axis=1)
        reach = self.seen(center, columns, region)
        lines = (columns - center)[:, :, None] * (reach[:, None] * np.linspace(0.25, 1, 4))
        spread = (center[:, :, None] + lines).reshape(len(center), -1)
        return np.concatenate([center, spread], axis=1)


def wall_elements(frame: Frame) -> Iterator[Element]:
    """Irreducible elements that must not vanish where a frame is real, finite and regular."""
    field = frame.field.exact
    seen: set[str] = set()
    for x in _must_not_vanish(frame):
        if x.is_rational:
            continue
        parts = [x]
        if not x.is_kept:
            parts = [field.polynomial(f) for f, _ in field.factored(field.lift(x))[1]]
            parts += [field.polynomial(field.factors[i]) for i, _ in x._den]
        for part in parts:
            shown = str(part)
            wall = part.sympy
            # Exponentials, x**p among them, never vanish.
            if shown not in seen and not isinstance(wall, sp.exp) and not _is_power(wall):
                seen.add(shown)
                yield part


def _is_power(wall: sp.Expr) -> bool:
    """Whether it is a power with an exponent that varies."""
    return isinstance(wall, sp.Pow) and not wall.exp.is_number


def _with_simple_zeros(walls: Sequence[sp.Expr]) -> list[sp.Expr]:
    """Walls that change their sign where they vanish, instead of cos(x) - 1 and cos(x) + 1."""
    ends = {x: end for x in walls if (end := _end_of_angle(x)) is not None}
    shown = list[sp.Expr]()
    for wall in walls:
        angle, side_of_one = ends.get(wall, (None, 0))
        if angle is None:
            shown.append(wall)
        elif isinstance(angle, sp.cosh):
            shown.append(sp.sinh(angle.args[0]) if side_of_one < 0 else wall)
        elif (angle, -side_of_one) in ends.values():
            shown.append(sp.sin(angle.args[0]))
        else:
            half = angle.args[0] / 2
            shown.append(sp.sin(half) if side_of_one < 0 else sp.cos(half))
    return list(dict.fromkeys(shown))


def _end_of_angle(wall: sp.Expr) -> tuple[sp.Expr, int] | None:
    """(cos(x), -1) of cos(x) - 1 and its multiples, (cos(x), 1) of cos(x) + 1, also of cosh."""
    rest, term = wall.as_independent(sp.cos, sp.cosh, as_Add=True)
    number, function = term.as_coeff_Mul()
    if not isinstance(function, sp.cos | sp.cosh) or abs(rest) != abs(number):
        return None
    return function, 1 if rest == number else -1


def _must_not_vanish(frame: Frame) -> Iterator[Element]:
    """Determinant or squares, denominators, radicands, arguments of logs, branches."""
    field = frame.field.exact
    given = frame.given
    squares = [given["squares"][i, i] for i in range(frame.dimension)] if "squares" in given else []
    entries = [
        x for name in ("coframe", "legs", "metric", "rows") for x in given.get(name, {}).values()
    ]
    yield from squares
    if not squares:
        yield frame.determinant.element()
    waiting, names = [*entries, *squares], set[str]()
    while waiting:
        x = waiting.pop(0)
        yield from (field.polynomial(field.factors[i]) for i, _ in getattr(x, "_den", ()))
        for generator in field.generators_of(x):
            if generator.name in names:
                continue
            names.add(generator.name)
            inner = {"root": generator.tail, "log": generator.argument}.get(generator.kind)
            if generator.kind == "primitive":
                name, (inside, *_) = type(generator.shown).__name__, generator.argument
                inner = inside - 1 if name == "acosh" else None
                inner = 1 - inside * inside if name in ("asin", "acos", "atanh") else inner
            if inner is not None:
                yield inner
                waiting.append(inner)
    yield from (branch.holds for branch in frame.branches if branch.holds is not None)


def _source(frame: Frame) -> RealPoints:
    """The real points of a frame: of its field, or of its matrices."""
    source: Any = frame.field.exact.sample.places
    is_own = isinstance(source, RealPoints) and source.kind
    if is_own and (source.coordinates, source.parameters, source.relations) == (
        frame.coordinates,
        frame.parameters,
        frame.domain,
    ):
        return source
    shape = frame.shape
    entries = {index: x.sympy for index, x in frame.given[shape].items()}
    eta: Any = {index: x.sympy for index, x in frame.given["eta"].items()}
    if shape == "metric":
        eta = tuple(int(eta[i, i]) for i in range(frame.dimension))
    return RealPoints(
        frame.coordinates, frame.parameters, frame.domain, shape, entries, eta, frame.complex
    )

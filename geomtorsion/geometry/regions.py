"""Regions: where a frame is real, finite and regular, in words, with points and signs inside."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from fractions import Fraction
from itertools import count
from typing import TYPE_CHECKING, Any

import numpy as np
import sympy as sp
from flint import arb
from sympy.core.function import AppliedUndef

from geomtorsion.codegen.balls import BallCode
from geomtorsion.codegen.expression_graph import graph
from geomtorsion.errors import CoordinateError, GeomtorsionError
from geomtorsion.exact import Element, TruncatedField
from geomtorsion.exact.candidates import Candidates
from geomtorsion.geometry.derived import derived
from geomtorsion.geometry.real_points import (
    BATCHES,
    NEAR,
    RealPoints,
    Table,
    numbers_of,
    replaced,
    side,
)
from geomtorsion.geometry.region_words import Condition, conditions_of, fewest, in_words
from geomtorsion.support import checks
from geomtorsion.support.caching import cached_property
from geomtorsion.support.displays import latex_of

if TYPE_CHECKING:
    from geomtorsion.geometry.frame import Frame

Array = np.ndarray

# Points of each straight line that are checked against walls.
STATIONS = 24
# Halvings of a line on which a wall is met, down to the sixth digit.
HALVINGS = 20
# Of the width of a box relative to its middle: from a half down to the resolution of the points.
WIDTHS = 14
# Regions that are reported: more come from formulas with very many walls.
MOST = 12


@dataclass(frozen=True, eq=False, repr=False)
class Region:
    """A connected region where a coframe is real, finite and regular.

    point: symbol -> rational number, of coordinates and parameters; generic: no accidental relation
        between the numbers.
    relations: the fewest relations that describe the region; `str` gives them in words.
    signs: expression that vanishes at a wall -> its sign in the region, +1 or -1.
    box: bounds of each symbol around the point, between which no wall lies.
    signature: signs of the metric, in the order of the rows of the frame.
    assumed: whether the region was chosen here; False where it is the declared domain.

    Examples
    --------
    >>> from geomtorsion.geometry import Frame
    >>> frame = Frame.from_metric(
    ...     "t r theta phi",
    ...     [["2*M/r - 1", 0, 0, 0], [0, "1/(1 - 2*M/r)", 0, 0],
    ...      [0, 0, "r**2", 0], [0, 0, 0, "r**2*sin(theta)**2"]],
    ...     parameters="M",
    ... )
    >>> print(frame.region)
    M > 0, r > 2*M, 0 < theta < pi
    >>> frame.region.sign("r - M"), frame.region.sign("r - 3*M"), frame.region.assumed
    (1, None, True)
    """

    point: Mapping[sp.Symbol, sp.Rational]
    relations: tuple[sp.Basic, ...]
    signs: Mapping[sp.Expr, int]
    box: tuple[sp.Basic, ...]
    signature: tuple[int, ...]
    assumed: bool
    _walls: Walls = field(repr=False)

    def __str__(self) -> str:
        return in_words(self.relations) or "everywhere"

    def __repr__(self) -> str:
        return f"Region({self})"

    def __reduce__(self) -> tuple[object, ...]:
        frame = self._walls.frame
        return _again, (frame, regions(frame).index(self))

    def _repr_latex_(self) -> str:
        return (
            "$" + ",\\; ".join(map(latex_of, self.relations)) + "$" if self.relations else str(self)
        )

    def __eq__(self, other: object) -> bool:
        """Equal points, relations, signs and boxes."""
        return self._content == other._content if isinstance(other, Region) else NotImplemented

    def __hash__(self) -> int:
        return hash(self._content)

    @property
    def _content(self) -> tuple[object, ...]:
        pairs = tuple(self.point.items()), tuple(self.signs.items())
        return *pairs, self.relations, self.box, self.signature, self.assumed

    @property
    def assumption(self) -> str:
        """The region as a remark beside an answer; empty where the domain was declared.

        Examples
        --------
        >>> from geomtorsion.geometry import Frame
        >>> Frame("t r", [["sqrt(1 - r)", 0], [0, "1/sqrt(1 - r)"]]).region.assumption
        'for r < 1, assumed; declare domain=[...] for another region'
        """
        return f"for {self}, assumed; declare domain=[...] for another region" * self.assumed

    def points(self) -> Iterator[dict[sp.Symbol, sp.Rational]]:
        """Generic rational points inside the region, without end, the same at every call.

        The first one is `point`; parameters vary as coordinates do.

        Examples
        --------
        >>> from itertools import islice
        >>> from geomtorsion.geometry import Frame
        >>> frame = Frame("x y", [["sqrt(x - y)", 0], [0, 1]])
        >>> all(p[sym] > 0 for p in islice(frame.region.points(), 5) for sym in p)
        True
        """
        yield dict(self.point)
        seen, walls = {tuple(self.point.values())}, self._walls
        for numbers in walls.members(self):
            for number in numbers:
                inside = walls.candidates.exact(number)
                point = {s: inside[s] for s in walls.symbols}
                if tuple(point.values()) not in seen:
                    seen.add(tuple(point.values()))
                    yield point
        bounds = {s: (_fraction(low.lts), _fraction(high.gts)) for s, low, high in self._sides}
        within = Candidates(walls.symbols, len(walls.symbols), bounds)
        for number in count():
            yield within.exact(number)

    @property
    def _sides(self) -> Iterator[tuple[sp.Symbol, Any, Any]]:
        pairs: Any = zip(self.point, self.box[::2], self.box[1::2], strict=True)
        return pairs

    def sign(self, expression: object) -> int | None:
        """The sign of an expression in the region: +1 or -1; None where both occur, or for zero.

        It is read at many points of the region, some of them close to each wall. Unknown functions
        that the frame does not contain have no sign.

        Parameters
        ----------
        expression
            an exact element, a sympy expression, a number or text in the symbols of the frame.

        Raises
        ------
        ExpressionError
            The text or expression cannot be read.

        Examples
        --------
        >>> from geomtorsion.geometry import Frame
        >>> region = Frame("theta phi", [[1, 0], [0, "sin(theta)"]]).region
        >>> region.sign("sin(theta)"), region.sign("cos(theta)")
        (1, None)
        """
        return self._walls.sign(self, expression)


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

    def seen(self, center: Array, columns: Array, region: Region) -> Array:
        """How far each straight line from a point to a column stays inside: from 0 to 1."""
        signs, conditions = region._walls.signs_of(region), region._walls.sides_of(region)
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

    def sign(self, region: Region, expression: object) -> int | None:
        """See `Region.sign`."""
        if isinstance(expression, Element):
            element = expression
        else:
            (element,) = self.frame.read([("expression", checks.plain(expression))])
        if element.is_zero:
            return None
        if not element.symbols and element.is_rational:
            return 1 if element.as_fraction() > 0 else -1
        values = np.real(numbers_of([element.sympy], self.arguments)(self._spread(region))[0])
        values = values[np.isfinite(values)]
        signs = set(np.sign(values[values != 0]).astype(int))
        return int(signs.pop()) if len(signs) == 1 else None

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


@derived
def regions(frame: Frame) -> tuple[Region, ...]:
    """See Frame.regions.

    Raises
    ------
    CoordinateError
        No point was found where the frame is real, finite and regular.
    """
    if isinstance(frame.field, TruncatedField):
        whole: Any = frame._plain[1]
        return regions(whole[0])
    walls = Walls(frame)
    if not walls.source.table.groups:
        raise CoordinateError(
            f"expected a region where the frame is real and regular, got none: "
            f"{walls.source.refusal()}"
        )
    table = walls.table
    values = np.concatenate([walls.start(), table.values, *walls.extremes()], axis=1)
    with np.errstate(all="ignore"):
        numbers = walls.numbers(values)
    signs = np.where(np.isfinite(numbers), np.sign(np.real(numbers)), 0).astype(int)
    order = [0, *(1 + k for group in table.groups for k in group.numbers)]
    split = [s for s in walls.source.parameters if s.is_positive is None and s.is_negative is None]
    rows = [walls.symbols.index(s) for s in split]
    first: dict[tuple[int, ...], int] = {}
    for k in order:
        key = tuple(map(int, signs[:, k])), tuple(map(int, np.sign(values[rows, k])))
        if all(key[0]):
            first.setdefault(key[0], k)
    found = []
    for key, k in list(first.items())[:MOST]:
        point = walls.first_point() if k == 0 else walls.candidates.exact(k - 1)
        found.append(_region(walls, point, np.array(key, dtype=int), values, signs))
    return tuple(found)


def _again(frame: Frame, number: int) -> Region:
    """A region of a frame by its number."""
    return regions(frame)[number]


def _region(
    walls: Walls, point: dict[sp.Expr, Any], own: Array, values: Array, signs: Array
) -> Region:
    """The region of a point with given signs of all walls."""
    finite = signs != 0
    finite[:, -1] = True
    within = np.ones(values.shape[1], dtype=bool)
    domain = tuple(walls.source.relations)
    with np.errstate(all="ignore"):
        within &= np.all(np.real(walls.sides(values)) > 0, axis=0)
    varied = [
        (expression, int(sign))
        for expression, sign, row, ok in zip(walls.expressions, own, signs, finite, strict=True)
        if len(set(row[ok & within])) > 1 and not (domain and expression.has(AppliedUndef))
    ]
    conditions = conditions_of(varied, point, walls.symbols, walls.source, walls.arguments)
    words = fewest(conditions, values[:, within])
    relations = (*domain, *(r for one in words for r in one.relations))
    eta = tuple(int(walls.frame.eta.at({})[i, i].real) for i in range(walls.frame.dimension))
    return Region(
        {s: point[s] for s in walls.symbols},
        relations,
        dict(zip(walls.expressions, map(int, own), strict=True)),
        _box(walls, point, own),
        eta,
        bool(words),
        walls,
    )


def _box(walls: Walls, point: dict[sp.Expr, Any], own: Array) -> tuple[sp.Basic, ...]:
    """Bounds of each symbol between which balls prove that no wall lies."""
    center = {s: _fraction(value) for s, value in point.items()}
    names = {s: sp.Symbol(f"x{k}") for k, s in enumerate(walls.arguments)}
    sides = [side(relation) for relation in walls.source.relations]
    width = Fraction(1, 2)
    ends: dict[sp.Expr, list[Fraction]] = {}
    for _ in range(WIDTHS):
        ends = {s: sorted((x * (1 - width), x * (1 + width))) for s, x in center.items()}
        balls = [_ball(*ends[s]) if s in walls.symbols else _ball(center[s]) for s in names]
        if _is_clear(walls, [*walls.expressions, *sides], [*own, *(1 for _ in sides)], balls):
            break
        width /= 2
    bounds = (
        (s, *(sp.Rational(x.numerator, x.denominator) for x in ends[s])) for s in walls.symbols
    )
    return tuple(r for s, low, high in bounds for r in (s > low, s < high))


def _is_clear(
    walls: Walls, expressions: Sequence[sp.Expr], signs: Sequence[int], balls: list[arb]
) -> bool:
    """Whether all expressions keep their signs on balls, as is proved by ball arithmetic."""
    code = walls.balls(expressions)
    if code is None:
        return True
    return all(
        isinstance(value, arb) and (value > 0 if sign > 0 else value < 0)
        for value, sign in zip(code.real(balls), signs, strict=True)
    )


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
    """The real points of a frame: those of its field, or of its matrices."""
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


def _fraction(value: Any) -> Fraction:
    return Fraction(int(value.p), int(value.q))


def _rational(value: Fraction) -> sp.Rational:
    return sp.Rational(value.numerator, value.denominator)


def _ball(low: Fraction, high: Fraction | None = None) -> arb:
    """The ball over an interval."""
    high = low if high is None else high
    middle, radius = (low + high) / 2, (high - low) / 2
    number = arb(middle.numerator) / middle.denominator
    return number + arb(0, arb(radius.numerator) / radius.denominator) if radius else number

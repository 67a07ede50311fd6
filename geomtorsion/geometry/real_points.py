"""Real points: where the matrices of a frame are real, finite and regular, found by numbers."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from itertools import chain
from typing import Any

import numpy as np
import sympy as sp
from sympy.core.function import AppliedUndef

from geomtorsion.codegen.expression_graph import graph
from geomtorsion.errors import CoordinateError, GeomtorsionError
from geomtorsion.exact.candidates import SCALES, Candidates, interval
from geomtorsion.support.caching import cached_property
from geomtorsion.support.checks import expression

Array = np.ndarray
RationalPoint = dict[sp.Symbol, sp.Rational]

# Numbers of candidates: more are tried where the ones before have no real point.
BATCHES = (96, 384, 3072)
# A wall nearer than this is met, relative to its median over the candidates: rounding of doubles.
NEAR = 1e-6
# A number beyond the usual scales counts as one with a unit.
WIDE = max(SCALES)
# Names of the coordinate that should be timelike; without one it is the first.
TIMES = ("t", "T", "tau", "time")


@dataclass(frozen=True)
class Group:
    """Candidates with equal signs.

    numbers: of its candidates, the preferred one first.
    signature: signs of the metric.
    is_preferred: whether the first is positive, with a time coordinate where there is a time.
    """

    numbers: tuple[int, ...]
    signature: tuple[int, ...]
    is_preferred: bool = True


class RealPoints:
    """Points where a matrix is real, finite and regular, the preferred region first.

    coordinates, parameters, relations: of the frame.
    kind: "coframe", "legs", "metric", or empty for entries outside of a matrix.
    entries: the matrix as expressions, (row, column) -> expression.
    eta: of a coframe or of legs: the frame metric; of a metric: requested signs or None.
    twins: symbols that count as another of the same name.
    """

    def __init__(
        self,
        coordinates: Sequence[sp.Symbol],
        parameters: Sequence[sp.Symbol],
        relations: Iterable[sp.Basic] = (),
        kind: str = "coframe",
        entries: Mapping[tuple[int, int], Any] | None = None,
        eta: Any = None,
        complex_: bool = False,
        twins: Mapping[sp.Basic, sp.Symbol] | None = None,
    ) -> None:
        self.coordinates, self.parameters = tuple(coordinates), tuple(parameters)
        self.relations = tuple(x for x in relations if x != sp.true)
        self.is_declared = bool(self.relations)
        self.kind, self._entries, self._eta = kind, dict(entries or {}), eta
        self._complex, self._twins = complex_, dict(twins or {})
        self._made: dict[int, Table] = {}

    # -- formulas ----------------------------------------------------------------------------------

    @property
    def symbols(self) -> tuple[sp.Symbol, ...]:
        """Coordinates and parameters."""
        return (*self.coordinates, *self.parameters)

    @cached_property
    def unknown(self) -> tuple[sp.Expr, ...]:
        """Unknown functions and their derivatives in the entries."""
        return tuple(dict.fromkeys(part for x in self._expressions for part in _unknown(x)))

    @cached_property
    def _expressions(self) -> list[sp.Expr]:
        return [expression(x).xreplace(self._twins) for x in self._entries.values()]

    @cached_property
    def walls(self) -> tuple[tuple[sp.Expr, ...], tuple[sp.Expr, ...]]:
        """(positive, nonzero): radicands and arguments of logs; denominators."""
        positive, nonzero = dict[sp.Expr, None](), dict[sp.Expr, None]()
        for part in _parts(self._expressions):
            if isinstance(part, sp.Pow) and part.base.free_symbols:
                if not part.exp.is_integer:
                    positive[part.base] = None
                elif part.exp.is_negative:
                    nonzero[part.base] = None
            elif isinstance(part, sp.log) and part.free_symbols:
                positive[part.args[0]] = None
        return tuple(positive), tuple(nonzero)

    @cached_property
    def candidates(self) -> Candidates:
        """The points that are tried."""
        bounds = {symbol: interval(symbol, self.relations) for symbol in self.symbols}
        return Candidates(
            (*self.symbols, *self.unknown),
            len(self.coordinates),
            bounds,
            self.angles,
            _scales([*self._expressions, *self.relations]),
        )

    @cached_property
    def angles(self) -> frozenset[sp.Symbol]:
        """Coordinates that occur only in sin, cos and their kind."""
        inside, bare = set[sp.Basic](), set[sp.Basic]()
        waiting = list(self._expressions)
        seen = set[sp.Basic]()
        while waiting:
            part = waiting.pop()
            if part in seen:
                continue
            seen.add(part)
            if isinstance(part, sp.Function | sp.Pow | sp.Mul | sp.Add):
                if isinstance(part, sp.sin | sp.cos | sp.tan | sp.cot | sp.sec | sp.csc):
                    inside |= part.free_symbols
                else:
                    waiting += part.args
            else:
                bare |= part.free_symbols
        return frozenset(s for s in self.coordinates if s in inside - bare)

    def numbers(self, expressions: Sequence[sp.Expr]) -> Callable[[Array], Array]:
        """Expressions as a function of columns of candidates; nan where there is no real value."""
        return numbers_of(expressions, (*self.symbols, *self.unknown), self._complex)

    # -- search ------------------------------------------------------------------------------------

    @cached_property
    def table(self) -> Table:
        """The first candidates with real points of the preferred kind, else with any, in groups."""
        # Far from one, a region of the preferred signs is met later than another one.
        for preferred in (True, False):
            for table in self._tables():
                if table.groups and (table.groups[0].is_preferred or not preferred):
                    return table
        return self.batch(BATCHES[-1])

    def _tables(self) -> Iterator[Table]:
        # In a declared domain few points are enough.
        return map(self.batch, (BATCHES[0] // 4, *BATCHES) if self.is_declared else BATCHES)

    def batch(self, size: int) -> Table:
        """The first candidates, in a number given by the size."""
        if size not in self._made:
            self._made[size] = Table(self, size)
        return self._made[size]

    def points(self) -> Iterator[dict[sp.Expr, sp.Rational]]:
        """Values of symbols and unknown functions: real points, the preferred one first.

        Where there is none, points that satisfy the relations: a root read at them is refused
        with its own reason.
        """
        seen = set[int]()
        for table in chain([self.table], self._tables()):
            for number in (k for group in table.groups for k in group.numbers):
                if number not in seen:
                    seen.add(number)
                    yield self.candidates.exact(number)
        if not seen:
            yield from map(self.candidates.exact, self.table.allowed)

    @property
    def is_met(self) -> bool:
        """Whether some candidate satisfies all relations."""
        ranges = [interval(symbol, self.relations) for symbol in self.symbols]
        if any(low is not None and high is not None and low >= high for low, high in ranges):
            return False
        return all(map(_is_bound, self.relations)) or bool(self.table.allowed)

    def metrics(self, entries: Array) -> tuple[Array, Array]:
        """Metrics of candidates from the values of entries, and how regular each matrix is."""
        n = len(self.coordinates)
        count = entries.shape[1]
        matrices = np.zeros((count, n, n), dtype=entries.dtype)
        for (i, j), values in zip(self._entries, entries, strict=True):
            matrices[:, i, j] = values
        finite = np.isfinite(matrices).all(axis=(1, 2))
        matrices[~finite] = np.eye(n)
        lengths = np.prod(np.linalg.norm(matrices, axis=2), axis=1)
        regular = np.where(finite & (lengths > 0), abs(np.linalg.det(matrices)), 0)
        regular = regular / np.where(lengths > 0, lengths, 1)
        if self.kind == "metric":
            return matrices, regular
        matrices[regular == 0] = np.eye(n)
        if self.kind == "legs":
            matrices = np.linalg.inv(matrices)
        return np.swapaxes(matrices, 1, 2) @ self._eta_numbers @ matrices, regular

    @cached_property
    def _eta_numbers(self) -> Array:
        """The frame metric of a coframe."""
        n = len(self.coordinates)
        eta = np.eye(n)
        if self._eta is not None:
            eta = np.zeros((n, n))
            for (i, j), value in self._eta.items():
                entry = expression(value)
                # A refused entry of the frame metric has its own message.
                eta[i, j] = float(entry) if entry.is_number and entry.is_real else float(i == j)
        return eta

    def preference(self, metrics: Array) -> tuple[Array, Array]:
        """(rank, signs of the metric) of each candidate; a lower rank is preferred."""
        n = metrics.shape[1]
        symmetric = np.real(metrics + np.swapaxes(metrics, 1, 2)) / 2
        signs = np.sign(np.linalg.eigvalsh(symmetric)).astype(int)
        negative = (signs < 0).sum(axis=1)
        if self._complex:
            return np.zeros(len(metrics), dtype=int), signs
        names = [symbol.name for symbol in self.coordinates]
        time = next((names.index(name) for name in TIMES if name in names), 0)
        first = np.sign(symmetric[:, time, time])
        rank = np.full(len(metrics), 2)
        # Unknown functions may have any size: none makes -1 + epsilon*h a positive metric.
        rank[negative == 0] = 1 if self.unknown else 0
        rank[(negative == 1) & (first < 0)] = 1
        rank[(n > 2) & (negative == n - 1) & (first > 0)] = 1
        if self.kind == "metric" and self._eta is not None:
            wanted = tuple(int(x) for x in self._eta)
            counted = negative == sum(x < 0 for x in wanted)
            ordered = first == wanted[time]
            rank = np.where(counted, np.where(ordered, 0, 1), 3)
        return rank, signs

    def refusal(self) -> str:
        """Which conditions exclude each other, for an error."""
        for symbol in self.symbols:
            low, high = interval(symbol, self.relations)
            if low is not None and high is not None and low >= high:
                own = [str(x) for x in self.relations if x.free_symbols == {symbol}]
                return f"{' and '.join(own)} exclude each other. Correct one of them."
        return self.table.refusal()


class Table:
    """Values of the walls at the candidates, and the groups of real points among them."""

    def __init__(self, points: RealPoints, size: int) -> None:
        self._points, self.size = points, size
        self.values = np.array(points.candidates.floats(0, size)).reshape(size, -1).T
        positive, nonzero = points.walls
        sides = [side(relation) for relation in points.relations]
        entries = points._expressions
        every = [*entries, *positive, *nonzero, *sides]
        function = points.numbers(every)
        with np.errstate(all="ignore"):
            values = function(self.values)
        ends = np.cumsum([len(entries), len(positive), len(nonzero)])
        entry, above, below, held = np.split(values, ends)
        pairs = zip(points.relations, held, strict=True)
        self._radicands = [np.real(row) > 0 for row in above]
        self._related = [_holds(relation, np.real(row)) for relation, row in pairs]
        inside = np.ones(size, dtype=bool)
        for holds in self._related:
            inside &= holds
        self.inside = inside
        self.allowed = [int(k) for k in np.flatnonzero(inside)]
        if not entries or not points.kind:
            real = inside & np.isfinite(values).all(axis=0)
            numbers = map(int, np.flatnonzero(real))
            ranked = sorted(numbers, key=lambda k: ((self.values[:, k] < 0).sum(), k))
            self.groups = [Group(tuple(ranked), ())] if ranked else []
            return
        with np.errstate(all="ignore"):
            metrics, regular = points.metrics(entry)
        walls = np.concatenate([below, above]) if not points._complex else below
        room, far = _room(abs(walls))
        good = inside & (regular > NEAR) & far & np.isfinite(entry).all(axis=0)
        if not points._complex:
            for row in above:
                good &= row > 0
        rank, signs = points.preference(metrics)
        good &= rank < 3
        self.good = good
        # Unknown functions are positive if they can be: -a**2, and E, F, G of a surface.
        functions = [isinstance(x, AppliedUndef) for x in (*points.symbols, *points.unknown)]
        reversed_functions = (self.values[functions] < 0).sum(axis=0)
        members: dict[tuple[Any, ...], list[int]] = {}
        for k in map(int, np.flatnonzero(good)):
            walls_here = map(int, np.sign(np.real(below[:, k])))
            key = (int(reversed_functions[k]), int(rank[k]), *map(int, signs[k]), *walls_here)
            members.setdefault(key, []).append(k)
        symbols = self.values[: len(points.symbols)]
        negative = (symbols < 0).sum(axis=0)
        with np.errstate(divide="ignore"):
            sizes = abs(np.log(abs(symbols))).max(axis=0, initial=0)
        worth = np.minimum(np.minimum(room, regular), 0.2) - 0.1 * sizes

        own, part = np.flatnonzero(good), slice(len(entries), ends[-1])
        opens = self._opens(function, own, part, SCALES[1])
        # Parameters with horizons, as a < M, where a formula has walls farther in.
        bare = self._opens(function, own, part, 1 / SCALES[1]) * bool(points.parameters)

        def order(k: int) -> tuple[float, ...]:
            return (negative[k], -opens[k], bare[k], -worth[k], k)

        ranked = [(key, sorted(some, key=order)) for key, some in members.items()]
        ranked.sort(key=lambda pair: (*pair[0][:2], negative[pair[1][0]], -len(pair[1])))
        n = len(points.coordinates)
        self.groups = [
            Group(tuple(some), tuple(key[2 : n + 2]), key[1] < 2 and not negative[some[0]])
            for key, some in ranked
        ]

    @property
    def conditions(self) -> list[tuple[str, Array]]:
        """Texts of all conditions, and where they hold; they are written for messages only."""
        positive = (f"{x} > 0" for x in self._points.walls[0])
        radicands = zip(positive, self._radicands, strict=True)
        return [*radicands, *zip(map(str, self._points.relations), self._related, strict=True)]

    def _opens(
        self, function: Callable[[Array], Array], numbers: Array, walls: slice, factor: float
    ) -> Array:
        """Along how many coordinates each candidate meets no wall, in steps of a factor."""
        opens, columns = np.zeros(self.size), self.values[:, numbers]
        with np.errstate(all="ignore"):
            here = np.sign(np.real(function(columns)[walls]))
            for k in range(len(self._points.coordinates)):
                moved, is_open = columns.copy(), np.ones(len(numbers), dtype=bool)
                for _ in SCALES:
                    moved[k] *= factor
                    there = np.sign(np.real(function(moved)[walls]))
                    is_open &= np.all((there == here) | ~np.isfinite(there), axis=0)
                opens[numbers] += is_open
        return opens

    def refusal(self) -> str:
        """The conditions that hold nowhere among the candidates, each by itself or in pairs."""
        conditions = self.conditions
        declared = {str(relation) for relation in self._points.relations}
        for k, (one, first) in enumerate(conditions):
            if not first.any():
                remedy = "Correct it" if one in declared else f'Declare domain="{one}"'
                return (
                    f"{one} holds at no point that was tried. {remedy}, with numerical bounds of "
                    "its symbols if it holds only far from the origin."
                )
            for two, second in conditions[:k]:
                if not (first & second).any():
                    return (
                        f"{two} and {one} exclude each other at every point that was tried. "
                        f'Correct one of them, or declare where both hold: domain="{two}, {one}" '
                        "with numerical bounds."
                    )
        texts = [text for text, _ in conditions if text not in declared]
        name = self._points.coordinates[0]
        example = ", ".join(texts) or f"1 < {name}, {name} < 2"
        return (
            "the matrix is real, finite and regular at no point that was tried. Declare the "
            f'inequalities that hold where it is: domain="{example}".'
        )


def numbers_of(
    expressions: Sequence[sp.Expr], symbols: Sequence[sp.Expr], complex_: bool = False
) -> Callable[[Array], Array]:
    """Expressions as a function of an array (symbols, points); nan where no value is real."""
    names = {s: sp.Symbol(f"x{k}") for k, s in enumerate(symbols)}
    plain = [replaced(x, names) for x in expressions]
    arguments = [names[s].name for s in symbols]
    try:
        inner = graph(arguments, plain, factor=False).numpy()
    except GeomtorsionError:
        return lambda values: _one_by_one(plain, list(names.values()), values)

    def function(values: Array) -> Array:
        count = values.shape[1]
        if not plain:
            return np.zeros((0, count))
        with np.errstate(all="ignore"):
            table = np.broadcast_to(
                np.asarray(inner(*values)).reshape(len(plain), -1), (len(plain), count)
            )
        if np.iscomplexobj(table) and not complex_:
            # A real value whose parts are complex has rounding as its imaginary part.
            table = np.where(abs(np.imag(table)) <= NEAR * abs(table), np.real(table), np.nan)
        return table

    return function


def _one_by_one(expressions: list[sp.Expr], symbols: list[sp.Symbol], values: Array) -> Array:
    """Values of functions without a compiled form."""
    table = np.full((len(expressions), values.shape[1]), np.nan)
    # Each takes sympy a millisecond.
    for k, column in enumerate(values.T[: BATCHES[0]]):
        point = dict(zip(symbols, map(float, column), strict=True))
        for i, entry in enumerate(expressions):
            number = sp.N(entry.subs(point))
            if number.is_real and number.is_finite:
                table[i, k] = float(number)
    return table


def replaced(expression: sp.Expr, names: Mapping[sp.Expr, sp.Symbol]) -> sp.Expr:
    """An expression with unknown functions, then symbols, as arguments."""
    functions = {s: name for s, name in names.items() if not s.is_Symbol}
    # Derivatives hold their functions, which must not be replaced inside.
    derivatives = {s: x for s, x in functions.items() if not isinstance(s, AppliedUndef)}
    for table in (derivatives, functions):
        if table:
            expression = expression.xreplace(table)
    return expression.xreplace({s: x for s, x in names.items() if s.is_Symbol})


def _parts(expressions: Iterable[sp.Basic]) -> Iterator[sp.Basic]:
    """All parts of expressions, each once, without the insides of unknown functions."""
    seen, waiting = set[sp.Basic](), list(expressions)
    while waiting:
        part = waiting.pop(0)
        if part in seen:
            continue
        seen.add(part)
        yield part
        if not isinstance(part, AppliedUndef | sp.Derivative | sp.Subs):
            waiting += part.args


def _unknown(expression: sp.Expr) -> Iterator[sp.Expr]:
    """Unknown functions and their derivatives in an expression."""
    if not expression.has(AppliedUndef):
        return
    for part in _parts([expression]):
        if isinstance(part, AppliedUndef | sp.Derivative | sp.Subs):
            yield part


def _scales(expressions: Iterable[sp.Basic]) -> list[float]:
    """Sizes far from one that numbers in the expressions suggest, such as the radius of a body."""
    sizes = set[float]()
    for part in _parts(expressions):
        if part.is_Number and part.is_finite and part:
            size = abs(float(part))
            if not 1 / WIDE <= size <= WIDE and size < 1e150:
                sizes |= {size, size**0.5}
    return sorted(sizes)


def _room(walls: Array) -> tuple[Array, Array]:
    """How far each candidate is from the walls, from 0 to 1, and whether it is off all of them."""
    count = walls.shape[1]
    room, far = np.ones(count), np.ones(count, dtype=bool)
    for row in walls:
        finite = row[np.isfinite(row) & (row > 0)]
        middle = float(np.median(finite)) if finite.size else 1.0
        # Without units: relative to its usual size.
        size = np.where(np.isfinite(row), row, 0) / middle
        room, far = np.minimum(room, size / (1 + size)), far & (size > NEAR)
    return room, far


def side(relation: Any) -> sp.Expr:
    """The difference that is positive inside."""
    if hasattr(relation, "gts"):
        return relation.gts - relation.lts
    return relation.lhs - relation.rhs


def _holds(relation: Any, values: Array) -> Array:
    """Where a relation holds, from the values of its difference."""
    if isinstance(relation, sp.Eq):
        return abs(values) < NEAR
    return values != 0 if isinstance(relation, sp.Ne) else values > 0


def _is_bound(relation: Any) -> bool:
    """Whether it bounds one symbol by a number: r > 2, but not r**2 > 4."""
    less, greater = getattr(relation, "lts", None), getattr(relation, "gts", None)
    return any(
        one is not None and one.is_Symbol and other is not None and other.is_number
        for one, other in ((less, greater), (greater, less))
    )


def check_met(points: RealPoints) -> None:
    """Refuse a domain without a candidate inside.

    Raises
    ------
    CoordinateError
        There is none.
    """
    if points.is_declared and not points.is_met:
        relations = ", ".join(map(str, points.relations))
        raise CoordinateError(
            f"expected a point inside the domain {relations}, got none among those tried: "
            f"{points.refusal()}"
        )

"""Validation: input of a frame, checked once, and points inside its domain."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from fractions import Fraction
from functools import partial
from itertools import combinations
from typing import Any

import sympy as sp

from geomtorsion.errors import (
    ArgumentError,
    CoframeError,
    CoordinateError,
    MetricError,
    ShapeError,
    SignatureError,
    UndecidedError,
)
from geomtorsion.exact import Element, Field, parse_expression
from geomtorsion.exact.reading import counted_as
from geomtorsion.geometry.components import dependence, determinant
from geomtorsion.geometry.relations import relations_in
from geomtorsion.support import checks
from geomtorsion.support.precision import EPS

Matrix = dict[tuple[int, int], Any]
Coordinates = Sequence[sp.Symbol] | Sequence[str] | str

# Number of points tried, in ranges that widen by a factor of ten.
TRIES = 400
# As fine as doubles: at small fractions two symbols may coincide, and with them two expressions
# that differ everywhere else.
FINE = round(1 / EPS)
# Fractional parts of multiples of their square roots fill a cube evenly.
PRIMES = (2, 3, 5, 7, 11, 13, 17, 19, 23, 29, 31, 37, 41, 43, 47, 53, 59, 61, 67, 71)

RationalPoint = dict[sp.Symbol, sp.Rational]


@dataclass(frozen=True)
class Opened:
    """Symbols, domain and field of a frame, before its matrices are read."""

    coordinates: tuple[sp.Symbol, ...]
    parameters: tuple[sp.Symbol, ...]
    domain: tuple[sp.Basic, ...]
    complex: bool
    field: Field

    def points(self) -> Iterator[RationalPoint]:
        """Points inside the domain, to read signs off."""
        return candidate_points(self.coordinates, self.parameters, self.domain)


def opened(
    coordinates: object,
    n: int,
    entries: Matrix,
    parameters: Iterable[sp.Symbol | str] | None,
    domain: object,
    complex_: bool,
    branches: Mapping[sp.Expr, sp.Expr] | None,
) -> Opened:
    """Check symbols and domain, and open a field over them."""
    checks.flag(complex_, "complex")
    chosen = {
        checks.expression(root, "branches"): checks.expression(value, f"branches[{root}]")
        for root, value in checks.table(branches, "branches").items()
    }
    words = partial(names_of, coordinates, parameters, entries.values())
    relations = domain_relations(domain, words)
    free = free_symbols([*entries.values(), *relations, *chosen, *chosen.values()])
    symbols = coordinate_symbols(coordinates, n, free)
    constants = parameter_symbols(parameters, symbols, free)
    twins = counted_as(free, (*symbols, *constants))
    relations = tuple(relation.xreplace(twins) for relation in relations)
    chosen = {root.xreplace(twins): value.xreplace(twins) for root, value in chosen.items()}
    # The same generic point decides every sign that a root leaves open.
    # Without a domain the field looks for a point where its radicands are positive.
    inside = partial(candidate_points, symbols, constants, relations, fineness=FINE)
    sample = next(inside(), None) if relations else None
    if sample is None and relations:
        raise CoordinateError(
            f"expected a point inside the domain {', '.join(map(str, relations))}, got none among "
            "those tried. Give consistent relations, for instance numerical bounds of each "
            "coordinate."
        )
    field = Field(
        (*symbols, *constants),
        complex=complex_,
        sample=sample,
        inside=inside if relations else None,
        branches=chosen,
    )
    return Opened(symbols, constants, relations, complex_, field)


SIGNS = {"+": 1, "-": -1, "−": -1}
REFUSALS = {"metric": MetricError, "signature": SignatureError}


def typed_entries(
    values: object, name: str, coordinates: object, parameters: object
) -> tuple[int, Matrix]:
    """As `matrix_entries`, with entries that may be text in coordinates and parameters."""
    n, entries = matrix_entries(values, name)
    typed = {index: x for index, x in entries.items() if isinstance(x, str)}
    if not typed:
        return n, entries
    names = names_of(coordinates, parameters, entries.values())
    for index, text in typed.items():
        entries[index] = parse_expression(text, names, where=f"{name}{list(index)}")
    return n, {index: x for index, x in entries.items() if not _is_plain_zero(x)}


def names_of(coordinates: object, parameters: object, values: Iterable) -> dict[str, sp.Symbol]:
    """The names that a text may use: of coordinates, parameters, and symbols in other values."""
    free = free_symbols(values)
    named = named_symbols(() if parameters is None else parameters, free, "parameter")
    return {symbol.name: symbol for symbol in (*free, *named, *named_symbols(coordinates, free))}


def matrix_entries(values: object, name: str) -> tuple[int, Matrix]:
    """Size and non-zero entries of a square matrix given as nested lists or a sympy matrix."""
    refusal = REFUSALS.get(name, CoframeError)
    kind, remedy = "rows of entries", "Give nested lists."
    entries = partial(checks.entries, error=refusal, expected=kind, remedy=remedy)
    rows = [
        entries(row, f"{name}[{i}]")
        if isinstance(row, Iterable)
        and not isinstance(row, str | sp.Basic)
        # A tensor of rank 0 is one expression.
        and getattr(row, "ndim", 1) > 0
        else [row]
        for i, row in enumerate(entries(values, name))
    ]
    n = len(rows)
    for i, row in enumerate(rows):
        if len(row) != n:
            more = name == "coframe" and {len(one) for one in rows} == {len(row)} and len(row) < n
            raise refusal(
                f"{name} is not square: it has {n} rows, but row {i} has {len(row)} entries. "
                "Give as many rows as columns, one column for each coordinate."
                + " For more rows than columns use gt.embedded(coordinates, rows)."
                * more
            )
    if n == 0:
        raise refusal(f"{name} is empty. Give at least one coordinate and one row.")
    return n, {
        (i, j): x for i, row in enumerate(rows) for j, x in enumerate(row) if not _is_plain_zero(x)
    }


def _is_plain_zero(value: object) -> bool:
    """Whether an entry is the number zero; other entries are checked when they are read."""
    return isinstance(value, int | float | sp.Expr) and value == 0


def coordinate_symbols(
    coordinates: object, n: int, free: Iterable[sp.Symbol]
) -> tuple[sp.Symbol, ...]:
    """Coordinates as distinct symbols, as many as the matrix has columns.

    Names given as text become the symbol of that name that occurs in the entries.
    """
    symbols = named_symbols(coordinates, free)
    checks.check_one_each(symbols, n, "columns of the matrix", "coordinates", ShapeError)
    names = [symbol.name for symbol in symbols]
    repeated = sorted({name for name in names if names.count(name) > 1})
    if repeated:
        raise CoordinateError(
            f"coordinate {', '.join(repeated)} is repeated. Each coordinate must occur once."
        )
    return tuple(symbols)


def named_symbols(
    names: object, known: Iterable[sp.Symbol] = (), what: str = "coordinate"
) -> list[sp.Symbol]:
    """Symbols from symbols or names, a text holding several; a known name is its symbol."""
    by_name: dict[str, set[sp.Symbol]] = {}
    for symbol in known:
        by_name.setdefault(symbol.name, set()).add(symbol)
    listed = names.replace(",", " ").split() if isinstance(names, str) else names
    symbols = []
    for item in checks.entries(listed, f"{what}s", CoordinateError, expected="symbols or names"):
        symbol: Any = item
        if isinstance(item, str):
            candidates = by_name.get(item, {sp.Symbol(item)})
            counted_as(candidates)
            (symbol,) = candidates
        if not isinstance(symbol, sp.Symbol):
            checks.refuse(CoordinateError, what, "a symbol", item, "Give sympy symbols or names.")
        symbols.append(symbol)
    return symbols


def parameter_symbols(
    parameters: Iterable[sp.Symbol | str] | None,
    coordinates: Sequence[sp.Symbol],
    free: Iterable[sp.Symbol],
) -> tuple[sp.Symbol, ...]:
    """The given parameters, then the remaining free symbols by name."""
    free = set(free)
    named = []
    for symbol in named_symbols(() if parameters is None else parameters, free, "parameter"):
        if symbol.name in {c.name for c in coordinates}:
            raise CoordinateError(
                f"{symbol.name} is a coordinate and a parameter at once. Rename one of them."
            )
        named.append(symbol)
    declared = (*coordinates, *named)
    new = free - set(declared) - set(counted_as(free, declared))
    return tuple(dict.fromkeys(named + sorted(new, key=lambda symbol: symbol.name)))


def free_symbols(values: Iterable[Any]) -> set[sp.Symbol]:
    """All symbols in the entries that are sympy expressions."""
    symbols: set[sp.Symbol] = set()
    seen: set[Any] = set()
    # sympy's own way is a call deeper for each bracket.
    waiting = [value for value in values if hasattr(type(value), "free_symbols")]
    while waiting:
        part = waiting.pop()
        if part in seen:
            continue
        seen.add(part)
        if isinstance(part, sp.Add | sp.Mul | sp.Pow | sp.Function):
            waiting += part.args
        else:
            symbols |= {s for s in part.free_symbols if isinstance(s, sp.Symbol)}
    return symbols


def signs_or_rows(signature: object) -> list[Any]:
    """A signature as a list, of signs or of rows of a matrix; "-+++" is a list of signs."""
    if isinstance(signature, str) and signature and not set(signature) - set(SIGNS):
        return [SIGNS[sign] for sign in signature]
    kind, remedy = "signs or a matrix", 'Write (-1, 1, 1, 1), "-+++", or a symmetric matrix.'
    return checks.entries(signature, "signature", SignatureError, expected=kind, remedy=remedy)


def signature_entries(signature: object, n: int) -> Matrix:
    """Non-zero entries of eta from None, a tuple of signs or a constant symmetric matrix."""
    if signature is None:
        return {(i, i): sp.S.One for i in range(n)}
    rows = signs_or_rows(signature)
    if any(isinstance(row, (list, tuple)) for row in rows):
        size, entries = matrix_entries(rows, "signature")
    else:
        if any(checks.fraction(x) not in (1, -1) for x in rows):
            raise SignatureError(
                f"signature: expected entries 1 and -1, got {checks.shown(tuple(rows))}. Give "
                "signs, or a constant symmetric matrix."
            )
        size, entries = len(rows), {(i, i): checks.expression(x) for i, x in enumerate(rows)}
    checks.check_one_each(range(size), n, "rows of the frame", "signature", SignatureError)
    for i, j in combinations(range(n), 2):
        if entries.get((i, j), 0) != entries.get((j, i), 0):
            raise SignatureError(
                f"signature is not symmetric: entry [{i}, {j}] is {entries.get((i, j), 0)}, "
                f"entry [{j}, {i}] is {entries.get((j, i), 0)}. Make them equal."
            )
    varying = free_symbols(entries.values())
    if varying:
        raise SignatureError(
            "signature: expected a constant matrix, got one that depends on "
            f"{', '.join(sorted(map(str, varying)))}. Write the variable factors in the coframe."
        )
    return entries


def read_matrix(field: Field, entries: Matrix, name: str) -> dict[tuple[int, int], Element]:
    """Exact elements of a matrix, read together; zeros are dropped."""
    named = [(f"{name}[{i}, {j}]", value) for (i, j), value in entries.items()]
    elements = field.read_all(named)
    pairs = zip(entries, elements, strict=True)
    return {index: element for index, element in pairs if not element.is_zero}


def check_regular(field: Field, entries: dict[tuple[int, int], Element], n: int, name: str) -> None:
    """Refuse a matrix whose determinant vanishes; the message names the dependent rows."""
    det = determinant(field, entries, n)
    if det.is_zero is None:
        raise UndecidedError(
            f"whether the determinant of the {name} vanishes cannot be decided: it is {det}, which "
            f"is zero or too small to distinguish from zero. {checks.KNOWN_IDENTITIES}"
        )
    if not det.is_zero:
        return
    coefficients = dependence(field, entries, n)
    relation = "the rows are dependent" if coefficients is None else _relation(coefficients)
    raise CoframeError(
        f"{name} is singular: its determinant vanishes identically. {relation} "
        "Give independent rows, or drop a coordinate."
    )


def _relation(coefficients: dict[int, Element]) -> str:
    """The dependence of rows as a sentence; rows counted from 0."""
    last = max(coefficients)
    others = {i: (-x).sympy for i, x in coefficients.items() if i != last}
    if not others:
        return f"Row {last} is zero."
    terms = " + ".join(
        f"row {i}" if factor == 1 else f"({factor}) * row {i}" for i, factor in others.items()
    )
    return f"Row {last} equals {terms} (rows counted from 0)."


def read_signature(field: Field, signature: object, n: int) -> dict[tuple[int, int], Element]:
    """Exact elements of eta; an error if it is degenerate."""
    entries = signature_entries(signature, n)
    signs = {sp.S.One: field.one, sp.S.NegativeOne: -field.one}
    if len(entries) == n and all(
        i == j and isinstance(x, sp.Integer) and x in signs for (i, j), x in entries.items()
    ):
        return {index: signs[x] for index, x in entries.items()}
    eta = read_matrix(field, entries, "signature")
    if determinant(field, eta, n).is_zero:
        raise SignatureError(
            "signature is degenerate: the determinant of eta is zero. Give a regular matrix."
        )
    return eta


def check_symmetric(entries: dict[tuple[int, int], Element], n: int) -> None:
    """Refuse a metric that is not symmetric; the message names the pair."""
    for i, j in combinations(range(n), 2):
        upper, lower = entries.get((i, j)), entries.get((j, i))
        if upper != lower:
            shown = ["0" if x is None else str(x) for x in (upper, lower)]
            raise MetricError(
                f"metric is not symmetric: entry [{i}, {j}] is {shown[0]}, "
                f"entry [{j}, {i}] is {shown[1]}. Make them equal."
            )


def read_more(field: Field, entries: Sequence[tuple[str, object]]) -> list[Element]:
    """Exact elements of pairs (where, expression, text or element); new symbols are declared.

    Names in a text must be symbols of the field.
    """
    for entry in checks.entries(entries, "entries"):
        if not isinstance(entry, tuple) or len(entry) != 2:
            raise ArgumentError(
                "entries: expected pairs (name in messages, expression), got "
                f"{checks.shown(entry)}."
            )
    names = {symbol.name: symbol for symbol in field.symbols}
    entries = [
        (where, parse_expression(x, names, where=where) if isinstance(x, str) else x)
        for where, x in entries
    ]
    plain = [value for _, value in entries if not isinstance(value, Element)]
    free = free_symbols(plain)
    new = free - set(field.symbols) - set(counted_as(free, field.symbols))
    field.declare(sorted(new, key=lambda symbol: symbol.name))
    read = iter(field.read_all([(where, x) for where, x in entries if not isinstance(x, Element)]))
    return [value if isinstance(value, Element) else next(read) for _, value in entries]


def domain_relations(
    domain: object, names: Callable[[], Mapping[str, sp.Symbol]] = dict
) -> tuple[sp.Basic, ...]:
    """A domain as relations that all hold: one, And(...), several, or text such as "r > 0"."""
    if domain is None:
        return ()
    if isinstance(domain, str):
        domain = domain.split(",")
    kind, remedy, error = "relations", "Give r > 2*M, 0 < theta.", CoordinateError
    items = (
        [domain]
        if isinstance(domain, sp.Basic | bool)
        else checks.entries(domain, "domain", error, expected=kind, remedy=remedy)
    )
    conditions: list[sp.Basic] = []
    item: Any
    for item in items:
        if isinstance(item, str):
            read = partial(parse_expression, symbols=names(), where="domain")
            conditions += relations_in(item, read, "domain", CoordinateError)
            continue
        parts = item.args if isinstance(item, sp.And) else (item,)
        for part in parts:
            if part is True or part == sp.true:
                continue
            if not isinstance(part, sp.core.relational.Relational):
                checks.refuse(CoordinateError, "domain", "a relation", part, remedy)
            conditions.append(part)
    return tuple(conditions)


def candidate_points(
    coordinates: Sequence[sp.Symbol],
    parameters: Sequence[sp.Symbol],
    relations: Iterable[sp.Basic],
    fineness: int = 97,
) -> Iterator[RationalPoint]:
    """Points that satisfy the relations and the assumptions of the symbols, in a fixed order."""
    relations = tuple(relations)
    symbols = [*coordinates, *parameters]
    ranges = {symbol: _interval(symbol, relations) for symbol in symbols}
    if any(low is not None and high is not None and low >= high for low, high in ranges.values()):
        return
    whole = {symbol for symbol in symbols if symbol.is_integer}
    others = [x for x in relations if whole & x.free_symbols or not _is_bound(x)]
    # Domains far from the origin are reached by wider and wider ranges, at last by far wider ones.
    near = [1 + 10 * number // TRIES for number in range(TRIES)]
    far = [10 * 2 ** (1 + 20 * number // TRIES) for number in range(TRIES if others else 0)]
    has_point = False
    for number, stretch in enumerate([*near, *far]):
        if has_point and number >= TRIES:
            return
        point = {}
        for k, symbol in enumerate(symbols):
            root = math.sqrt(PRIMES[k % len(PRIMES)]) * (number + 1 + k // len(PRIMES))
            share = Fraction(int((root % 1) * fineness) + 1, fineness + 2)
            low, high = _finite(ranges[symbol], symbol in parameters, stretch)
            value = low + (high - low) * share
            if symbol.is_integer:
                # The next one on the side where zero is not.
                is_bounded = ranges[symbol][0] is not None
                value = Fraction(math.floor(value) + is_bounded)
                if (symbol.is_even and value % 2) or (symbol.is_odd and not value % 2):
                    value += 1 if is_bounded else -1
            point[symbol] = sp.Rational(value.numerator, value.denominator)
        if all(relation.subs(point) == sp.true for relation in others):
            has_point = True
            yield point


def with_functions(element: Element, point: RationalPoint) -> dict[Any, Any]:
    """A point, with unknown functions set to one and their derivatives to zero."""
    values: dict[Any, Any] = dict(point)
    for generator in element.field.generators:
        if generator.kind == "jet":
            values[generator.shown] = 0 if isinstance(generator.shown, sp.Derivative) else 1
    return values


def with_generic_functions(element: Element, point: RationalPoint) -> dict[Any, Any]:
    """A point, with unknown functions as they are where the signs of roots were read."""
    field = element.field
    jets = [generator for generator in field.generators if generator.kind == "jet"]
    return {**point, **{g.shown: field.sample.value(field.generator_element(g)) for g in jets}}


def _is_bound(relation: sp.Basic) -> bool:
    """Whether it bounds one symbol by a number: r > 2, but not r**2 > 4."""
    less, greater = (getattr(relation, name, None) for name in ("lts", "gts"))
    return any(
        one in relation.free_symbols and other is not None and other.is_number and other.is_finite
        for one, other in ((less, greater), (greater, less))
    )


def _interval(
    symbol: sp.Symbol, relations: Iterable[sp.Basic]
) -> tuple[Fraction | None, Fraction | None]:
    """Bounds of a symbol from its assumptions and from relations to numbers."""
    low = Fraction(0) if symbol.is_nonnegative else None
    high = Fraction(0) if symbol.is_nonpositive else None
    for relation in relations:
        if relation.free_symbols != {symbol}:
            continue
        less, greater = (relation.lts, relation.gts) if hasattr(relation, "lts") else (None, None)
        if less == symbol and greater is not None and greater.is_finite:
            bound = Fraction(float(greater)).limit_denominator(10**6)
            high = bound if high is None else min(high, bound)
        elif greater == symbol and less is not None and less.is_finite:
            bound = Fraction(float(less)).limit_denominator(10**6)
            low = bound if low is None else max(low, bound)
    return low, high


def _finite(
    bounds: tuple[Fraction | None, Fraction | None], parameter: bool, stretch: int
) -> tuple[Fraction, Fraction]:
    """A finite range: coordinates reach further out than parameters."""
    low, high = bounds
    width = Fraction(3, 4) if parameter else Fraction(4)
    width *= stretch
    if low is None and high is None:
        return -width / 2, width / 2
    if low is None:
        assert high is not None
        return high - width, high
    return low, low + width if high is None else high

"""Validation: input of a frame, checked once, and points inside its domain."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass
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
from geomtorsion.geometry.differentials import is_flat, written_out
from geomtorsion.geometry.real_points import RealPoints, check_met
from geomtorsion.geometry.relations import relations_in
from geomtorsion.support import checks

Matrix = dict[tuple[int, int], Any]
Coordinates = Sequence[sp.Symbol] | Sequence[str] | str


@dataclass(frozen=True)
class Opened:
    """Symbols, domain and field of a frame, before its matrices are read."""

    coordinates: tuple[sp.Symbol, ...]
    parameters: tuple[sp.Symbol, ...]
    domain: tuple[sp.Basic, ...]
    complex: bool
    field: Field


def opened(
    coordinates: object,
    n: int,
    entries: Matrix,
    parameters: Iterable[sp.Symbol | str] | None,
    domain: object,
    complex_: bool,
    branches: Mapping[sp.Expr, sp.Expr] | None,
    kind: str = "",
    eta: object = None,
) -> Opened:
    """Check symbols and domain, and open a field over them.

    kind: what the entries are: "coframe", "legs", "metric" or no matrix; eta: see `RealPoints`.
    """
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
    points = RealPoints(symbols, constants, relations, kind, entries, eta, complex_, twins)
    check_met(points)
    field = Field((*symbols, *constants), complex=complex_, sample=points, branches=chosen)
    return Opened(symbols, constants, relations, complex_, field)


SIGNS = {"+": 1, "-": -1, "−": -1}
REFUSALS = {"metric": MetricError, "signature": SignatureError}


def typed_entries(
    values: object, name: str, coordinates: object, parameters: object
) -> tuple[int, Matrix]:
    """As `matrix_entries`, with text: entries, a line element, one-forms."""
    unknown = 'Otherwise declare it: parameters=["{name}"].'

    def read(text: str, where: str, forms: Sequence[sp.Symbol]) -> sp.Expr:
        known = names_of(coordinates, parameters, ()) | {form.name: form for form in forms}
        return parse_expression(text, known, where=where, unknown=unknown)

    if is_flat(values):
        taken = names_of(coordinates, parameters, ())
        values = written_out(values, name, named_symbols(coordinates), taken, read)
    n, entries = matrix_entries(values, name)
    typed = {index: x for index, x in entries.items() if isinstance(x, str)}
    if not typed:
        return n, entries
    names = names_of(coordinates, parameters, entries.values())
    for index, text in typed.items():
        where = f"{name}{list(index)}"
        entries[index] = parse_expression(text, names, where=where, unknown=unknown)
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
    if name == "metric":
        remedy = 'Give nested lists, a list of the diagonal, or text: "dr^2 + r^2 dphi^2".'
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


def read_signature(field: Field, entries: Matrix, n: int) -> dict[tuple[int, int], Element]:
    """Exact elements of eta from `signature_entries`; an error if it is degenerate."""
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


def with_functions(element: Element, point: Mapping[Any, Any]) -> dict[Any, Any]:
    """A point, with unknown functions as they are where the signs of roots were read."""
    jets = [one.shown for one in element.field.generators if one.kind == "jet"]
    sample = element.field.sample
    return {**{shown: sample.number_of(shown) for shown in jets}, **point}

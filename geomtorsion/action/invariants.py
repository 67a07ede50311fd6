"""Invariants: what a motion keeps, each proved by exact zero."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from fractions import Fraction
from itertools import combinations_with_replacement, product
from math import lcm
from typing import TYPE_CHECKING, Any

import sympy as sp
from flint import fmpq, fmpq_mat

from geomtorsion.action.hamel import Hamel
from geomtorsion.checks import expression
from geomtorsion.errors import GeomtorsionError
from geomtorsion.geometry.derived import derived
from geomtorsion.geometry.groups import exponential

if TYPE_CHECKING:
    from geomtorsion.exact import Element, Field
    from geomtorsion.geometry import Frame

Row = dict[int, Fraction]


def relations(field: Field, vectors: Sequence[Sequence[Element]]) -> list[Row]:
    """All independent {j: q_j} with sum_j q_j vectors[j] = 0, each with one q_j = 1 of its own.

    Over a common denominator the monomials of a field are independent, so this is linear
    algebra over the rationals; parameters count as unknowns, not as numbers.

    Examples
    --------
    >>> import sympy as sp
    >>> from geomtorsion.exact import Field
    >>> x = sp.Symbol("x")
    >>> field = Field([x])
    >>> values = [sp.sin(x) ** 2, sp.cos(x) ** 2, x, sp.Integer(2)]
    >>> relations(field, [[field.read(value)] for value in values])
    [{0: Fraction(2, 1), 1: Fraction(2, 1), 3: Fraction(-1, 1)}]
    """
    columns = _coordinates(field, vectors)
    keys = sorted({key for column in columns for key in column})
    if not keys:
        return [{j: Fraction(1)} for j in range(len(vectors))]
    zero = fmpq(0)
    entries = [column.get(key, zero) for key in keys for column in columns]
    reduced, rank = fmpq_mat(len(keys), len(columns), entries).rref()
    pivots = [next(j for j in range(len(columns)) if reduced[r, j] != 0) for r in range(rank)]
    found = []
    for free in sorted(set(range(len(columns))) - set(pivots)):
        row: Row = {free: Fraction(1)}
        for r, pivot in enumerate(pivots):
            if reduced[r, free] != 0:
                row[pivot] = -_fraction(reduced[r, free])
        found.append(_whole(row))
    return found


def depends(field: Field, element: Element, known: Sequence[Element]) -> bool:
    """Whether an element is a rational combination of others."""
    every = relations(field, [[value] for value in (*known, element)])
    return any(len(known) in row for row in every)


def _coordinates(field: Field, vectors: Sequence[Sequence[Element]]) -> list[dict[Any, fmpq]]:
    """For each vector its coefficients, by row and monomial."""
    columns: list[dict[Any, fmpq]] = [{} for _ in vectors]
    for row in range(len(vectors[0]) if vectors else 0):
        common: Any = ()
        for vector in vectors:
            common = field.lcm(common, vector[row]._den)
        for column, vector in zip(columns, vectors, strict=True):
            entry = vector[row]
            poly = field.reduced(field.lift(entry) * field.cofactor(common, entry._den))
            for monomial, value in poly.to_dict().items():
                column[row, tuple(monomial)] = value
    return columns


def _fraction(value: fmpq) -> Fraction:
    return Fraction(int(value.p), int(value.q))


def _whole(row: Row) -> Row:
    """The same relation in whole numbers, the first one positive."""
    scale = lcm(*(value.denominator for value in row.values()))
    sign = 1 if row[min(row)] > 0 else -1
    return {j: row[j] * scale * sign for j in sorted(row)}


@dataclass(frozen=True, eq=False)
class Candidate:
    """A function f(q, u, t) with df/du^l = la^k M_kl.

    Then df/dt = (its change at fixed u) - la^k (rest of equation k): no acceleration is needed.

    weights: la^k by k, over all velocities.
    """

    name: str
    value: Element
    weights: Mapping[int, Element]

    def change(self, hamel: Hamel) -> Element:
        """df/dt along the motion; under constraints up to the factor of `Hamel.derivative`."""
        if hamel.fixed:
            return hamel.derivative(self.value)
        terms: list[Any] = [(1, hamel.bundle.change(self.value, hamel.rates))]
        terms += [(-1, weight, hamel.rest[k]) for k, weight in self.weights.items()]
        return hamel.bundle.field.sum(terms)

    def is_sound(self, hamel: Hamel) -> bool:
        """Whether df/du^l = la^k M_kl holds exactly."""
        exact, terms = hamel.bundle.field, {i: [] for i in hamel.free}
        for (k, column), value in hamel.whole_matrix.items():
            if k in self.weights:
                terms[hamel.free[column]].append((-1, self.weights[k], value))
        symbols = hamel.bundle.symbols.velocities
        slopes = ((i, self.value.diff(symbols[i])) for i in hamel.free)
        return all(exact.sum([(1, slope), *terms[i]]).is_zero is True for i, slope in slopes)


def combined(hamel: Hamel, name: str, parts: Iterable[tuple[Any, Candidate]]) -> Candidate:
    """A rational combination."""
    exact, parts = hamel.bundle.field, list(parts)
    weights: dict[int, list] = {}
    for q, part in parts:
        for k, weight in part.weights.items():
            weights.setdefault(k, []).append((q, weight))
    value = exact.sum([(q, part.value) for q, part in parts])
    return Candidate(name, value, {k: exact.sum(terms) for k, terms in weights.items()})


def _along(hamel: Hamel, name: str, components: Mapping[int, Element]) -> Candidate:
    """p_i xi^i."""
    terms = [(1, value, hamel.momenta[i]) for i, value in components.items()]
    return Candidate(name, hamel.bundle.field.sum(terms), components)


def energies(hamel: Hamel) -> Iterator[Candidate]:
    """p_i u^i - L over all velocities, and over those that move (others may be driven)."""
    everything = range(hamel.bundle.dimension)
    for name, moving in (("energy", everything), ("jacobi integral", hamel.free)):
        weights = {i: hamel.velocities[i] for i in moving}
        terms = [(1, hamel.momenta[i], value) for i, value in weights.items()]
        value = hamel.bundle.field.sum([*terms, (-1, hamel.lagrangian)])
        yield Candidate(name, value, weights)


def momenta(hamel: Hamel, frame: Frame, base: Frame) -> Iterator[Candidate]:
    """p_i xi^i along coordinate lines, legs and right-invariant fields.

    frame: as the user gave it. base: the same over the field of the equations.
    """
    exact, adapted = hamel.bundle.field, hamel.bundle.frame
    for mu, symbol in enumerate(frame.coordinates):
        column = dict(adapted.coframe.components.columns[mu])
        yield _along(hamel, f"momentum of {symbol}", column)
    for i in range(hamel.bundle.dimension):
        yield _along(hamel, f"body momentum {i + 1}", {i: exact.one})
    for number, row in enumerate(right_invariant(frame) or (), 1):
        components = exact.read_all([("field", value) for value in row])
        # The fields are found in the frame that was given; the momenta are those of the other.
        if adapted is not base:
            components = _turned(components, base, adapted)
        yield _along(hamel, f"space momentum {number}", dict(enumerate(components)))


def _turned(components: Sequence[Element], base: Frame, adapted: Frame) -> list[Element]:
    """Components of a field in another frame over the same coordinates."""
    exact = base.field
    legs, forms = base.legs.components.rows, adapted.coframe.components.rows
    lines = [exact.sum([(1, value, components[i]) for i, value in row]) for row in legs]
    return [exact.sum([(1, value, lines[mu]) for mu, value in row]) for row in forms]


def ansatz(hamel: Hamel) -> Iterator[Candidate]:
    """p_k f(q) for a few functions."""
    frame = hamel.bundle.frame
    entries = [hamel.lagrangian.sympy, *frame.coframe.nonzero().values()]
    for function in ansatz_functions(frame, entries):
        value = hamel.bundle.field.read(function)
        for k in hamel.free:
            yield _along(hamel, f"{function}*p{k + 1}", {k: value})


def casimirs(hamel: Hamel) -> Iterator[Candidate]:
    """c^kl p_k p_l that commute with all p_j: C_jk^i p_i c^kl p_l = 0, for constant C_ij^k.

    Examples: L.L for rotations; P.P and L.P for rotations with translations.
    """
    exact, n = hamel.bundle.field, hamel.bundle.dimension
    coefficients = hamel.bundle.frame.anholonomy.components.nonzero
    if not coefficients or any(not value.is_rational for value in coefficients.values()):
        return
    # Any n independent symbols can stand for the momenta here.
    u = hamel.bundle.velocities
    operator = {(j, k): exact.zero for j in range(n) for k in range(n)}
    for (j, k, i), value in coefficients.items():
        operator[j, k] = operator[j, k] + value * u[i]
    pairs = list(combinations_with_replacement(range(n), 2))
    vectors = []
    for k, m in pairs:
        changes = ([(1, operator[j, k], u[m]), (1, u[k], operator[j, m])] for j in range(n))
        vectors.append([exact.sum(terms) for terms in changes])
    p = hamel.momenta
    for number, row in enumerate(relations(exact, vectors), 1):
        terms, weights = [], {k: [] for k in range(n)}
        for place, q in row.items():
            k, m = pairs[place]
            terms.append((q, p[k], p[m]))
            weights[k].append((q, p[m]))
            weights[m].append((q, p[k]))
        summed = {k: exact.sum(parts) for k, parts in weights.items()}
        yield Candidate(f"casimir {number}", exact.sum(terms), summed)


# More candidates than this take seconds.
_MOST = 160
_LINE = sp.Symbol("_along")


@derived
def right_invariant(frame: Frame) -> list[list[sp.Expr]] | None:
    """Components xi^i in the frame of n fields that commute with all legs of a Lie group.

    Equation
    --------
    [E_k, xi] = 0:  d_mu xi^i = e^k_mu C_kj^i xi^j

    solved along the coordinate lines from the origin, one after the other, in an order in which
    the matrix on the right is constant up to a factor. None where C_ij^k depends on coordinates
    or no such order exists.

    Examples
    --------
    >>> from geomtorsion.spaces import load
    >>> right_invariant(load("ax_plus_b").frame)
    [[1, b/a], [0, 1/a]]
    """
    table = frame.anholonomy.components.nonzero
    if any(value.symbols & set(frame.coordinates) for value in table.values()):
        return None
    n, q = frame.dimension, frame.coordinates
    coefficients = {index: value.sympy for index, value in table.items()}
    columns = [[frame.coframe[k, mu] for k in range(n)] for mu in range(n)]
    left, order = set(range(n)), []
    while left:
        ready = [
            mu
            for mu in sorted(left, reverse=True)
            if all(not entry.has(q[nu]) for entry in columns[mu] for nu in set(order))
        ]
        if not ready:
            return None
        # Those on which others depend must wait: they are moved last.
        mu = max(ready, key=lambda m: sum(e.has(q[nu]) for e in columns[m] for nu in left - {m}))
        order.append(mu)
        left.discard(mu)
    whole = sp.eye(n)
    for place, mu in enumerate(order):
        still = {q[nu]: _base(columns, q[nu]) for nu in order[place + 1 :]}
        column = [expression(entry).xreplace(still) for entry in columns[mu]]
        step = _step(column, coefficients, n, q[mu], _base(columns, q[mu]))
        if step is None:
            return None
        whole = step * whole
    return [[sp.expand(whole[i, a]) for i in range(n)] for a in range(n)]


def _base(columns: Sequence[Sequence[sp.Expr]], symbol: sp.Symbol) -> sp.Expr:
    """Where a coordinate line begins: at zero, or at one where the coframe ends at zero."""
    entries = [expression(entry).subs(symbol, 0) for column in columns for entry in column]
    singular = any(entry.has(sp.zoo, sp.oo, sp.nan) for entry in entries)
    return sp.Integer(1 if singular else 0)


def _step(
    column: Sequence[sp.Expr],
    coefficients: Mapping[tuple[int, ...], sp.Expr],
    n: int,
    symbol: sp.Symbol,
    base: sp.Expr,
) -> sp.Matrix | None:
    """exp of the integral of e^k C_kj^i along one line, from the base to the coordinate."""
    forms = [entry for entry in column if entry != 0]
    if not forms:
        return sp.eye(n)
    shape = forms[0]
    ratios = [sp.cancel(entry / shape) for entry in column]
    if any(ratio.free_symbols for ratio in ratios):
        return None
    matrix = sp.zeros(n, n)
    for (k, j, i), value in coefficients.items():
        matrix[i, j] += value * ratios[k]
    length = _length(shape, symbol, base)
    if length is None:
        return None
    try:
        found = exponential(matrix, _LINE)
    except GeomtorsionError:
        return None
    return found.xreplace({_LINE: length}).applyfunc(sp.powsimp)


def _length(shape: sp.Expr, symbol: sp.Symbol, base: sp.Expr) -> sp.Expr | None:
    """The integral of a constant, a power or an exponential from the base."""
    if not shape.has(symbol):
        return shape * (symbol - base)
    factor, rest = shape.as_independent(symbol)
    power = rest.as_base_exp()
    if power[0] == symbol and power[1] == -1:
        return factor * sp.log(symbol)
    if power[0] == symbol and power[1].is_Integer:
        more = power[1] + 1
        return factor * (symbol**more - base**more) / more
    slope = sp.diff(rest, symbol) / rest
    if isinstance(rest, sp.exp) and not slope.has(symbol):
        return factor * (rest - rest.subs(symbol, base)) / slope
    return None


def ansatz_functions(frame: Frame, entries: Sequence[sp.Expr]) -> list[sp.Expr]:
    """Functions f(q) for an ansatz xi = sum c f E_k: products of those that fit each coordinate.

    An angle has 1, cos, sin; a coordinate that occurs nowhere also itself; other ones 1 and q.
    None at all where there would be too many.

    Examples
    --------
    >>> from geomtorsion.spaces import load
    >>> frame = load("flat_polar").frame
    >>> ansatz_functions(frame, [frame.coframe[1, 1]])
    [1, phi, cos(phi), sin(phi), r, phi*r, r*cos(phi), r*sin(phi)]
    """
    choices = []
    for symbol in frame.coordinates:
        one, inside = sp.S.One, [entry for entry in entries if entry.has(symbol)]
        angles = {a for e in inside for a in e.atoms(sp.sin, sp.cos) if a.has(symbol)}
        waves = [sp.cos(symbol), sp.sin(symbol)]
        if not inside:
            choices.append([one, symbol, *waves])
        elif angles:
            choices.append([one, *waves])
        else:
            choices.append([one, symbol])
    count = 1
    for row in choices:
        count *= len(row)
    if count * frame.dimension > _MOST:
        return []
    return [sp.Mul(*factors) for factors in product(*choices)]


@dataclass
class _Found:
    """What is kept so far; a candidate that adds nothing new is passed over."""

    hamel: Hamel
    kept: dict[str, Element] = field(default_factory=dict)

    def add(self, one: Candidate, *, squares: bool = False) -> bool:
        """Keep a value if its derivative is exactly zero and others do not make it up.

        squares: whether squares of momenta that contain no coordinate make up others.
        """
        value = one.value
        if value.is_rational or one.change(self.hamel).is_zero is not True:
            return False
        if not (self.hamel.fixed or one.is_sound(self.hamel)):
            return False
        known = list(self.kept.values())
        if squares:
            # L.L of a body is no news where each component of L is kept.
            inside = set(self.hamel.bundle.frame.coordinates)
            known += [x * x for x in known if not x.symbols & inside]
        if not (
            any(self._proportional(value, x) for x in known)
            or depends(self.hamel.bundle.field, value, [*known, value.field.one])
        ):
            self.kept[one.name] = value
        return True

    def _proportional(self, one: Element, two: Element) -> bool:
        """Whether the ratio of two values contains nothing but parameters."""
        symbols = self.hamel.bundle.symbols
        moving = {*symbols.coordinates, *symbols.velocities, symbols.time}
        inside = one.symbols & moving
        if inside != two.symbols & moving:
            return False
        exact = self.hamel.bundle.field
        return all(
            exact.sum([(1, one.diff(s), two), (-1, one, two.diff(s))]).is_zero is True
            for s in sorted(inside, key=str)
        )


def conserved(hamel: Hamel, frame: Frame, base: Frame) -> dict[str, sp.Expr]:
    """Name -> f(q, u, t) that does not change along the motion.

    Tried are: the energy p_i u^i - L, of driven systems also without what is driven; momenta
    p_i xi^i along coordinate lines, along legs, along right-invariant fields of a Lie group, and,
    elsewhere, along f(q) E_k for a few functions f; rational combinations of these; and the
    quadratic Casimirs of the legs.

    frame: as the user gave it. base: the same over the field of the equations.
    """
    found = _Found(hamel)
    for one in energies(hamel):
        found.add(one)
    rest = [one for one in momenta(hamel, frame, base) if not found.add(one)]
    _combine(found, rest, "momentum")
    # On a group the fields are known; elsewhere a few functions are tried, which costs seconds.
    if right_invariant(frame) is None:
        _combine(found, ansatz(hamel), "killing")
    for one in casimirs(hamel):
        found.add(one, squares=True)
    return {name: value.sympy for name, value in found.kept.items()}


def _combine(found: _Found, tried: Iterable[Candidate], stem: str) -> None:
    """Keep the rational combinations of candidates that do not change."""
    hamel, every = found.hamel, list(tried)
    number = 1
    for row in relations(hamel.bundle.field, [[one.change(hamel)] for one in every]):
        parts = [(q, every[j]) for j, q in row.items()]
        found.add(combined(hamel, f"{stem} {number}", parts))
        number = 1 + sum(name.removeprefix(f"{stem} ").isdigit() for name in found.kept)

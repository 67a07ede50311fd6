"""Invariants: constants of a motion, each proved by exact zero."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from fractions import Fraction
from itertools import combinations_with_replacement
from math import lcm
from typing import TYPE_CHECKING, Any

import sympy as sp

from geomtorsion.action.ansatz import (
    ansatz_functions,
    fitting_functions,
    listed,
    powers,
    right_invariant,
    separable_functions,
)
from geomtorsion.action.hamel import Hamel
from geomtorsion.exact import vanishing_sums

if TYPE_CHECKING:
    from geomtorsion.exact import Element
    from geomtorsion.geometry import Frame

ENERGIES = ("energy", "jacobi integral")
Row = dict[int, Fraction]


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


class ConservedQuantities(Mapping[str, sp.Expr]):
    """Conserved quantities f(q, u, t) by name, each proved by exact zero, and the search.

    ansatz: the families of functions that were searched, one line for each. All linear
        combinations of a family with rational coefficients that the motion keeps are found; the
        motion may keep others.
    """

    def __init__(self, values: Mapping[str, sp.Expr], ansatz: Sequence[str]) -> None:
        self._values = dict(values)
        self.ansatz = tuple(ansatz)

    def __getitem__(self, name: str) -> sp.Expr:
        return self._values[name]

    def __iter__(self) -> Iterator[str]:
        return iter(self._values)

    def __len__(self) -> int:
        return len(self._values)

    def __repr__(self) -> str:
        lines = [f"{name}: {value}" for name, value in self.items()] or ["nothing was found"]
        return "\n".join([*lines, "searched:", *(f"  {line}" for line in self.ansatz)])


def conserved(hamel: Hamel, frame: Frame, base: Frame) -> ConservedQuantities:
    """Name -> f(q, u, t) that does not change along the motion.

    Candidates: the energy p_i u^i - L, for driven systems also without the driven part; momenta
    p_i xi^i along coordinate lines, along legs, along right-invariant fields of a Lie group, and
    along f(q) E_k and f(q) d_mu for a few functions f; rational combinations of these; the
    quadratic Casimirs of the legs; and, without constraints, f(q) p_k p_l for the terms f of which
    the coframe is made.

    frame: as the user gave it. base: the same over the field of the equations.
    """
    basis, ansatz = _Found(hamel), ["energy p_k u^k - L"]
    for trial in energies(hamel):
        basis.add(trial)
    tried = list(momenta(hamel, frame, base))
    _combine(basis, [trial for trial in tried if not basis.add(trial)], "momentum")
    group = right_invariant(frame) is not None
    fields = "coordinates, legs and right-invariant fields" if group else "coordinates and legs"
    ansatz.append(f"sums of c*p(xi), the momenta along {fields}")
    entries = [hamel.lagrangian.sympy, *frame.coframe.nonzero().values()]
    functions, words = ansatz_functions(frame, fitting_functions(frame, entries))
    _combine(basis, killing_candidates(hamel, functions), "killing")
    ansatz.append(f"sums of c*f(q)*p_k, f {words}")
    functions, words = powers(frame)
    _combine(basis, coordinate_candidates(hamel, functions), "killing")
    ansatz.append(f"sums of c*f(q)*p(q), the momenta of coordinates, f {words}")
    # L.L of a body adds nothing where each component of L is kept.
    inside = set(hamel.bundle.frame.coordinates)
    squares = [x * x for x in basis.kept.values() if not x.symbols & inside]
    constant = list(casimirs(hamel))
    for trial in constant:
        basis.add(trial, squares)
    if constant:
        ansatz.append("sums of c*p_k*p_l that commute with all p_j (Casimirs)")
    if not hamel.fixed:
        linear = [value for name, value in basis.kept.items() if name not in ENERGIES]
        linear += [trial.value for trial in tried if trial.change(hamel).is_zero is True]
        products = [x * y for x, y in combinations_with_replacement(linear, 2)]
        tensors = separable_functions(frame)
        _combine(basis, tensor_candidates(hamel, tensors), "killing tensor", products)
        ansatz.append(f"sums of c*f(q)*p_k*p_l, f one of ({listed(tensors)})")
    values = {name: value.sympy for name, value in basis.kept.items()}
    return ConservedQuantities(values, ansatz)


def energies(hamel: Hamel) -> Iterator[Candidate]:
    """p_i u^i - L over all velocities, and over the changing ones (others may be driven)."""
    everything = range(hamel.bundle.dimension)
    for name, moving in zip(ENERGIES, (everything, hamel.free), strict=True):
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
        # The fields are found in the given frame; the momenta belong to the adapted one.
        if adapted is not base:
            components = _turned(components, base, adapted)
        yield _along(hamel, f"space momentum {number}", dict(enumerate(components)))


def killing_candidates(hamel: Hamel, functions: Sequence[sp.Expr]) -> Iterator[Candidate]:
    """p_k f(q) for a few functions."""
    for function in functions:
        value = hamel.bundle.field.read(function)
        for k in hamel.free:
            yield _along(hamel, f"{function}*p{k + 1}", {k: value})


def coordinate_candidates(hamel: Hamel, functions: Sequence[sp.Expr]) -> Iterator[Candidate]:
    """f(q) times the momenta of coordinates, for a few functions."""
    columns = hamel.bundle.frame.coframe.components.columns
    for function in functions:
        value = hamel.bundle.field.read(function)
        for mu, column in enumerate(columns):
            name = f"{function}*p({hamel.bundle.frame.coordinates[mu]})"
            yield _along(hamel, name, {k: value * entry for k, entry in column})


def tensor_candidates(hamel: Hamel, functions: Sequence[sp.Expr]) -> Iterator[Candidate]:
    """f(q) p_k p_l for a few functions."""
    p = hamel.momenta
    for function in functions:
        value = hamel.bundle.field.read(function)
        for k, m in combinations_with_replacement(range(hamel.bundle.dimension), 2):
            weights = {k: value * p[m]}
            weights[m] = value * p[k] * 2 if k == m else value * p[k]
            yield Candidate(f"{function}*p{k + 1}*p{m + 1}", value * p[k] * p[m], weights)


def casimirs(hamel: Hamel) -> Iterator[Candidate]:
    """c^kl p_k p_l that commute with all p_j: C_jk^i p_i c^kl p_l = 0, for constant C_ij^k.

    Examples: L.L for rotations; P.P and L.P for rotations with translations.
    """
    exact, n = hamel.bundle.field, hamel.bundle.dimension
    coefficients = hamel.bundle.frame.anholonomy.components.nonzero
    if not coefficients or any(not value.is_rational for value in coefficients.values()):
        return
    # Any n independent symbols can represent the momenta here.
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
    for number, row in enumerate(relations(vectors), 1):
        terms, weights = [], {k: [] for k in range(n)}
        for place, q in row.items():
            k, m = pairs[place]
            terms.append((q, p[k], p[m]))
            weights[k].append((q, p[m]))
            weights[m].append((q, p[k]))
        summed = {k: exact.sum(parts) for k, parts in weights.items()}
        yield Candidate(f"casimir {number}", exact.sum(terms), summed)


def combined(hamel: Hamel, name: str, parts: Iterable[tuple[Any, Candidate]]) -> Candidate:
    """A rational combination."""
    exact, parts = hamel.bundle.field, list(parts)
    weights: dict[int, list] = {}
    for q, part in parts:
        for k, weight in part.weights.items():
            weights.setdefault(k, []).append((q, weight))
    value = exact.sum([(q, part.value) for q, part in parts])
    return Candidate(name, value, {k: exact.sum(terms) for k, terms in weights.items()})


def relations(vectors: Sequence[Sequence[Element]]) -> list[Row]:
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
    >>> relations([[field.read(value)] for value in values])
    [{0: Fraction(2, 1), 1: Fraction(2, 1), 3: Fraction(-1, 1)}]
    """
    equations = list(zip(*vectors, strict=True))
    return [
        _whole({j: q for j, q in enumerate(row) if q})
        for row in vanishing_sums(equations, len(vectors))
    ]


def depends(element: Element, known: Sequence[Element]) -> bool:
    """Whether an element is a rational combination of others."""
    every = relations([[value] for value in (*known, element)])
    return any(len(known) in row for row in every)


@dataclass
class _Found:
    """Invariants kept so far; a candidate that adds nothing new is skipped."""

    hamel: Hamel
    kept: dict[str, Element] = field(default_factory=dict)

    def add(self, one: Candidate, products: Sequence[Element] = ()) -> bool:
        """Keep a value if its derivative is exactly zero and others do not make it up.

        products: of kept values, of which others may consist.
        """
        value = one.value
        if value.is_rational or one.change(self.hamel).is_zero is not True:
            return False
        if not (self.hamel.fixed or one.is_sound(self.hamel)):
            return False
        earlier = [*self.kept.values(), *products]
        if not (
            any(self._proportional(value, x) for x in earlier)
            or depends(value, [*earlier, value.field.one])
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


def _combine(
    found: _Found, tried: Iterable[Candidate], stem: str, products: Sequence[Element] = ()
) -> None:
    """Keep the rational combinations of candidates that do not change."""
    hamel, every = found.hamel, list(tried)

    def number() -> int:
        return 1 + sum(name.removeprefix(f"{stem} ").isdigit() for name in found.kept)

    for row in relations([[one.change(hamel)] for one in every]):
        parts = [(q, every[j]) for j, q in row.items()]
        found.add(combined(hamel, f"{stem} {number()}", parts), products)


def _along(hamel: Hamel, name: str, components: Mapping[int, Element]) -> Candidate:
    """p_i xi^i."""
    terms = [(1, value, hamel.momenta[i]) for i, value in components.items()]
    return Candidate(name, hamel.bundle.field.sum(terms), components)


def _turned(components: Sequence[Element], base: Frame, adapted: Frame) -> list[Element]:
    """Components of a field in another frame over the same coordinates."""
    exact = base.field
    legs, forms = base.legs.components.rows, adapted.coframe.components.rows
    lines = [exact.sum([(1, value, components[i]) for i, value in row]) for row in legs]
    return [exact.sum([(1, value, lines[mu]) for mu, value in row]) for row in forms]


def _whole(row: Row) -> Row:
    """The same relation in whole numbers, the first one positive."""
    scale = lcm(*(value.denominator for value in row.values()))
    sign = 1 if row[min(row)] > 0 else -1
    return {j: row[j] * scale * sign for j in sorted(row)}

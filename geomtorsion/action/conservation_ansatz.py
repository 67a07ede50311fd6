"""Conservation ansatz: quantities that may be kept, each with the equations behind it."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from itertools import combinations_with_replacement
from typing import TYPE_CHECKING, Any

from geomtorsion.action import killing_ansatz
from geomtorsion.action.hamel import Hamel
from geomtorsion.action.relations import relations

if TYPE_CHECKING:
    from geomtorsion.exact import Element
    from geomtorsion.geometry import Frame


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
    for number, row in enumerate(killing_ansatz.right_invariant(frame) or (), 1):
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
    for function in killing_ansatz.ansatz_functions(frame, entries):
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

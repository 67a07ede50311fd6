"""Invariants: what a motion keeps, each proved by exact zero."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass, field
from itertools import combinations_with_replacement
from typing import TYPE_CHECKING

import sympy as sp

from geomtorsion.action import fields
from geomtorsion.action.hamel import Hamel
from geomtorsion.action.relations import depends, relations

if TYPE_CHECKING:
    from geomtorsion.exact import Element
    from geomtorsion.geometry import Frame

Candidate = tuple[str, "Element"]


@dataclass
class _Found:
    """What is kept so far; a candidate that adds nothing new is passed over."""

    hamel: Hamel
    kept: dict[str, Element] = field(default_factory=dict)

    def add(self, name: str, value: Element, *, squares: bool = False) -> bool:
        """Keep a value if its derivative is exactly zero and others do not make it up.

        squares: whether squares of momenta that contain no coordinate make up others.
        """
        if value.is_rational or self.hamel.derivative(value).is_zero is not True:
            return False
        known = list(self.kept.values())
        if squares:
            inside = set(self.hamel.phase.frame.coordinates)
            known += [x * x for x in known if not x.symbols & inside]
        if not (
            any(self._proportional(value, x) for x in known)
            or depends(self.hamel.phase.field, value, [*known, value.field.one])
        ):
            self.kept[name] = value
        return True

    def _proportional(self, one: Element, two: Element) -> bool:
        """Whether the ratio of two values contains nothing but parameters."""
        letters = self.hamel.phase.letters
        moving = {*letters.coordinates, *letters.velocities, letters.time}
        inside = one.symbols & moving
        if inside != two.symbols & moving:
            return False
        exact = self.hamel.phase.field
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
    found.add("energy", energy(hamel, range(hamel.phase.dimension)))
    found.add("jacobi integral", energy(hamel, hamel.free))
    rest = [one for one in momenta(hamel, frame, base) if not found.add(*one)]
    _combine(found, rest, "momentum")
    if fields.right_invariant(frame) is None:
        _combine(found, list(_tried(hamel)), "killing")
    for number, value in enumerate(casimirs(hamel), 1):
        found.add(f"casimir {number}", value, squares=True)
    return {name: value.sympy for name, value in found.kept.items()}


def energy(hamel: Hamel, moving: Iterable[int]) -> Element:
    """p_i u^i - L over all velocities, or over those that move (others may be driven)."""
    terms = [(1, hamel.momenta[i], hamel.velocities[i]) for i in moving]
    return hamel.phase.field.sum([*terms, (-1, hamel.lagrangian)])


def momenta(hamel: Hamel, frame: Frame, base: Frame) -> Iterator[Candidate]:
    """p_i xi^i along coordinate lines, legs and right-invariant fields."""
    exact, adapted, p = hamel.phase.field, hamel.phase.frame, hamel.momenta
    for mu, symbol in enumerate(frame.coordinates):
        column = adapted.coframe.components.columns[mu]
        yield f"momentum of {symbol}", exact.sum([(1, value, p[i]) for i, value in column])
    for i, value in enumerate(p):
        yield f"body momentum {i + 1}", value
    for number, row in enumerate(fields.right_invariant(frame) or (), 1):
        components = exact.read_all([("field", value) for value in row])
        if adapted is not base:
            components = _turned(components, base, adapted)
        pairs = zip(components, p, strict=True)
        yield f"space momentum {number}", exact.sum([(1, value, one) for value, one in pairs])


def _turned(components: Sequence[Element], base: Frame, adapted: Frame) -> list[Element]:
    """Components of a field in another frame over the same coordinates."""
    exact = base.field
    legs, forms = base.legs.components.rows, adapted.coframe.components.rows
    lines = [exact.sum([(1, value, components[i]) for i, value in row]) for row in legs]
    return [exact.sum([(1, value, lines[mu]) for mu, value in row]) for row in forms]


def _tried(hamel: Hamel) -> Iterator[Candidate]:
    """p_k f(q) for the functions of an ansatz."""
    frame = hamel.phase.frame
    entries = [hamel.lagrangian.sympy, *frame.coframe.nonzero().values()]
    for function in fields.ansatz_functions(frame, entries):
        value = hamel.phase.field.read(function)
        for k in hamel.free:
            yield f"{function}*p{k + 1}", value * hamel.momenta[k]


def _combine(found: _Found, candidates: Iterable[Candidate], stem: str) -> None:
    """Keep the rational combinations of candidates that do not change."""
    values = [value for _, value in candidates]
    if not values:
        return
    exact = found.hamel.phase.field
    changes = [[found.hamel.derivative(value)] for value in values]
    number = 0
    for row in relations(exact, changes):
        if found.add(f"{stem} {number + 1}", exact.sum([(q, values[j]) for j, q in row.items()])):
            number = sum(name.startswith(f"{stem} ") for name in found.kept)


def casimirs(hamel: Hamel) -> list[Element]:
    """c^kl p_k p_l that commute with all p_j: C_jk^i p_i c^kl p_l = 0, for constant C_ij^k.

    Examples: L.L for rotations; P.P and L.P for rotations with translations.
    """
    exact, n = hamel.phase.field, hamel.phase.dimension
    twist = hamel.phase.frame.anholonomy.components.nonzero
    if not twist or any(not value.is_rational for value in twist.values()):
        return []
    # Any n independent symbols can stand for the momenta here.
    u = hamel.phase.velocities
    turned = {(j, k): exact.zero for j in range(n) for k in range(n)}
    for (j, k, i), value in twist.items():
        turned[j, k] = turned[j, k] + value * u[i]
    pairs = list(combinations_with_replacement(range(n), 2))
    vectors = []
    for k, m in pairs:
        changes = ([(1, turned[j, k], u[m]), (1, u[k], turned[j, m])] for j in range(n))
        vectors.append([exact.sum(terms) for terms in changes])
    p = hamel.momenta
    return [
        exact.sum([(q, p[pairs[c][0]], p[pairs[c][1]]) for c, q in row.items()])
        for row in relations(exact, vectors)
    ]

"""Invariants: what a motion keeps, each proved by exact zero."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass, field
from typing import TYPE_CHECKING

import sympy as sp

from geomtorsion.action import conservation_ansatz, killing_ansatz
from geomtorsion.action.conservation_ansatz import Candidate, combined
from geomtorsion.action.hamel import Hamel
from geomtorsion.action.relations import depends, relations

if TYPE_CHECKING:
    from geomtorsion.exact import Element
    from geomtorsion.geometry import Frame


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
    for one in conservation_ansatz.energies(hamel):
        found.add(one)
    rest = [one for one in conservation_ansatz.momenta(hamel, frame, base) if not found.add(one)]
    _combine(found, rest, "momentum")
    # On a group the fields are known; elsewhere a few functions are tried, which costs seconds.
    if killing_ansatz.right_invariant(frame) is None:
        _combine(found, conservation_ansatz.ansatz(hamel), "killing")
    for one in conservation_ansatz.casimirs(hamel):
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

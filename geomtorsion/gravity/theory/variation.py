"""Variation: what the derivatives of a Lagrangian by its invariants contribute to the equations."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

from geomtorsion.exact import Element
from geomtorsion.geometry import Connection, Frame, Tensor, levi_civita
from geomtorsion.gravity.theory.content import Content
from geomtorsion.gravity.theory.fields import FrameFields, Index, Terms
from geomtorsion.gravity.theory.momenta import Momenta
from geomtorsion.support.caching import cached_property
from geomtorsion.support.exclusive import exclusive


@exclusive
@dataclass(frozen=True, eq=False)
class Variation:
    """The part of the equations that is linear in the derivatives of a Lagrangian.

    content: the tensors of the theory.
    slopes: name of an invariant -> dL/dI, any functions of the coordinates.
    """

    content: Content
    slopes: Mapping[str, Element]

    @property
    def connections(self) -> tuple[Connection, ...]:
        """The connections, the first one leading."""
        return self.content.catalogue.connections

    @property
    def frame(self) -> Frame:
        """The frame of all connections."""
        return self.content.catalogue.frame

    @property
    def riemannian(self) -> FrameFields:
        """The Levi-Civita connection of the frame."""
        return self._riemannian

    @cached_property
    def _riemannian(self) -> FrameFields:
        for one in self.content.geometry:
            if one.is_riemannian:
                return one
        return FrameFields(levi_civita(self.frame))

    def slope(self, name: str) -> Element:
        """dL/dI of a name in the Lagrangian, zero where it does not occur."""
        return self.slopes.get(name, self.frame.field.zero)

    def tensor(self, name: str) -> Tensor:
        """A tensor of matter by its name, all indices down: phi_a, A_a, F_ab."""
        return self.content.matter[name]

    def momentum(self, name: str) -> Tensor:
        """dL/d(tensor) of a tensor of matter, all indices up: of phi_a, A_a, F_ab."""
        return self._momenta_of_matter[name]

    @cached_property
    def _momenta_of_matter(self) -> dict[str, Tensor]:
        return self.content.momenta_of_matter(self.slopes)

    @cached_property
    def momenta(self) -> tuple[Momenta, ...]:
        """P = dL/dT, Z = dL/dR, N = dL/dQ of each connection."""
        numbers = range(len(self.connections))
        return tuple(self.content.momenta(number, self.slopes) for number in numbers)

    @property
    def matter_equations(self) -> dict[str, Tensor]:
        """(1/e) d(eL)/d(field) of each matter field, by its name."""
        return self._matter_equations

    @cached_property
    def _matter_equations(self) -> dict[str, Tensor]:
        return {one.symbol: one.equation(self) for one in self.content.catalogue.matter}

    @cached_property
    def coframe(self) -> Tensor:
        """E_i^n without L and without fluids, slots DU."""
        frame, field = self.frame, self.frame.field
        divergences = [
            one.fields.divergence(one.P, paired=True).components.get for one in self.momenta
        ]
        moved = [
            one.moved.lowered().components.get for one in self.momenta if one.fields.is_riemannian
        ]
        matter = [one.coframe(self).components.get for one in self.content.catalogue.matter]

        def rule(index: Index) -> Element:
            i, n = index
            terms: Terms = []
            for one, divergence in zip(self.momenta, divergences, strict=True):
                terms += one.coframe_terms(i, n)
                terms.append((-2, divergence((n, i))))
            terms += [(1, get(index)) for get in matter]
            return field.sum(terms)

        def lower(index: Index) -> Element:
            i, n = index
            terms: Terms = [(1, own((i, n)))]
            return field.sum(terms + [(1, get((n, i))) for get in moved])

        bare = Tensor(frame, "DU", rule)
        if not moved:
            return bare
        own = bare.lowered().components.get
        return Tensor(frame, "DD", lower).raised(1)

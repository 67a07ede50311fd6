"""Content: the tensors of a theory, with the values and derivatives of all names in it."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace

from geomtorsion.exact import Element
from geomtorsion.geometry import Tensor, antisymmetric, symmetric
from geomtorsion.gravity.theory.catalogue import TURNING, Catalogue
from geomtorsion.gravity.theory.contractions import Contractions
from geomtorsion.gravity.theory.fields import FrameFields
from geomtorsion.gravity.theory.momenta import Momenta
from geomtorsion.gravity.theory.products import Factor
from geomtorsion.support.caching import cached_property
from geomtorsion.support.exclusive import exclusive


@exclusive
@dataclass(frozen=True, eq=False)
class Content:
    """The tensors by which a Lagrangian is varied, and its derivatives.

    catalogue: the names that the Lagrangian may use.
    metric: for each connection, whether it is varied among metric connections only.
    """

    catalogue: Catalogue
    metric: tuple[bool, ...]

    @cached_property
    def geometry(self) -> tuple[FrameFields, ...]:
        """Torsion, curvature and nonmetricity of each connection."""
        return tuple(map(FrameFields, self.catalogue.connections, self.metric))

    @cached_property
    def matter(self) -> dict[str, Tensor]:
        """Tensors of matter by their names, all indices down in the frame."""
        frame = self.catalogue.frame
        return {name: x for one in self.catalogue.matter for name, x in one.tensors(frame).items()}

    @cached_property
    def _scalars(self) -> dict[str, Element]:
        frame = self.catalogue.frame
        return {name: x for one in self.catalogue.matter for name, x in one.scalars(frame).items()}

    @cached_property
    def _contractions(self) -> Contractions:
        return Contractions(self.catalogue.frame, self._tensor)

    def _tensor(self, factor: Factor) -> Tensor:
        """The tensor of a factor, all indices down in the frame."""
        if not factor.suffix:
            return self.matter[factor.name]
        fields = self.geometry[int(factor.suffix)]
        if factor.name == "T":
            return fields.torsion.lowered(2)
        if factor.name == "Q":
            return fields.nonmetricity
        return fields.rotation_curvature if factor.name == TURNING else fields.curvature

    def value(self, name: str) -> Element:
        """The value of a name in the Lagrangian."""
        if name in self._scalars:
            return self._scalars[name]
        return self._contractions.value(self.catalogue.products(name))

    def momenta(self, number: int, slopes: Mapping[str, Element]) -> Momenta:
        """Derivatives of the Lagrangian by the tensors of a connection; slopes: dL/dI by name."""

        def derivative(name: str, rank: int, symmetry: tuple) -> Tensor:
            factor = Factor(name, tuple(range(rank)), str(number))
            return self._derivative(factor, symmetry, slopes)

        fields = self.geometry[number]
        curvature = derivative("R", 4, fields.curvature_symmetry)
        turning = derivative(TURNING, 4, antisymmetric(4) + antisymmetric(4, 2, 3))
        if turning.source:
            curvature = replace(curvature + turning, symmetry=fields.curvature_symmetry)
        return Momenta(
            fields,
            derivative("T", 3, antisymmetric(3)),
            curvature,
            derivative("Q", 3, symmetric(3, 1, 2)),
        )

    def momenta_of_matter(self, slopes: Mapping[str, Element]) -> dict[str, Tensor]:
        """Derivatives of the Lagrangian by the tensors of matter, all indices up."""
        return {
            name: self._derivative(
                Factor(name, tuple(range(rank))), self.matter[name].symmetry, slopes
            ).raised()
            for one in self.catalogue.matter
            for name, rank in one.ranks.items()
        }

    def _derivative(self, factor: Factor, symmetry: tuple, slopes: Mapping[str, Element]) -> Tensor:
        weighted = [
            (slope, product)
            for name, slope in slopes.items()
            for product in self.catalogue.products(name)
        ]
        return self._contractions.derivative(weighted, factor, symmetry)

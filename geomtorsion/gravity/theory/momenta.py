"""Momenta: derivatives of a Lagrangian by torsion, curvature and nonmetricity."""

from __future__ import annotations

from dataclasses import dataclass
from itertools import product

from geomtorsion.exact import Element
from geomtorsion.geometry import Tensor, antisymmetric
from geomtorsion.gravity.theory.fields import HALF, FrameFields, Index, Terms
from geomtorsion.support.caching import cached_property
from geomtorsion.support.exclusive import exclusive


@exclusive
@dataclass(frozen=True, eq=False)
class Momenta:
    """Derivatives of the Lagrangian by the fields of one connection, all components counted.

    fields: the fields of the connection.
    torsion, curvature, nonmetricity: the derivatives, all indices down.
    """

    fields: FrameFields
    torsion: Tensor
    curvature: Tensor
    nonmetricity: Tensor

    @cached_property
    def P(self) -> Tensor:
        """dL/dT_ab^c, slots UUD."""
        return self.torsion.raised(0).raised(1)

    @cached_property
    def Z(self) -> Tensor:
        """dL/dR_abi^j, slots UUUD."""
        return self.curvature.raised(0).raised(1).raised(2)

    @cached_property
    def N(self) -> Tensor:
        """dL/dQ_aij, slots UUU."""
        return self.nonmetricity.raised()

    @cached_property
    def C(self) -> Tensor:
        """(1/e) d(eL)/d omega_ni^j = 2 P^{ni}_j - 2 N^{ni}_j - (2/e) D_m(e Z^{mni}_j), slots UUD.

        Its part antisymmetric in ij where the connection stays metric.
        """
        frame = self.fields.frame
        p, q = self.P.lowered().components.get, self.N.lowered().components.get
        z = self.fields.divergence(self.Z, paired=True).lowered().components.get

        def whole(index: Index) -> Terms:
            return [(2, p(index)), (-2, q(index)), (-2, z(index))]

        def rule(index: Index) -> Element:
            if not self.fields.is_metric:
                return frame.field.sum(whole(index))
            n, i, j = index
            terms = [(HALF * term[0], *term[1:]) for term in whole(index)]
            terms += [(-HALF * term[0], *term[1:]) for term in whole((n, j, i))]
            return frame.field.sum(terms)

        symmetry = antisymmetric(3, 1, 2) if self.fields.is_metric else ()
        return Tensor(frame, "DDD", rule, symmetry).raised(0).raised(1)

    def coframe_terms(self, i: int, n: int) -> Terms:
        """Terms of E_i^n except L and the divergence of P."""
        fields, dimension = self.fields, range(self.fields.frame.dimension)
        p, t = self.P.components.get, fields.torsion.components.get
        z, r = self.Z.components.get, self._curvature.components.get
        q, m = fields.nonmetricity.components.get, self.N.components.get
        terms: Terms = [(-2, p((n, b, j)), t((i, b, j))) for b in dimension for j in dimension]
        for j, k in product(dimension, repeat=2):
            terms.append((-1, m((n, j, k)), q((i, j, k))))
            terms += [(-2, z((n, b, k, j)), r((i, b, k, j))) for b in dimension]
        return terms

    @cached_property
    def _curvature(self) -> Tensor:
        """R_abi^j, slots DDDU."""
        return self.fields.curvature.raised(3)

    @cached_property
    def moved(self) -> Tensor:
        """D_bar_a(C^{abc} - C^{bac} - C^{cab}) at (b, c), slots UD, for metric connections.

        The coframe determines that connection, so that its equation becomes part of E.
        """
        frame = self.fields.frame
        c = self.C.lowered().components.get

        def rule(index: Index) -> Element:
            i, j, k = index
            return frame.field.sum([(1, c((i, j, k))), (-1, c((j, i, k))), (-1, c((k, i, j)))])

        turned = Tensor(frame, "DDD", rule, antisymmetric(3)).raised(0).raised(1)
        return self.fields.divergence(turned, paired=True)

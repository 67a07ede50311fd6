"""Two-forms: the field of Kalb and Ramond, as matter of a Lagrangian."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from itertools import combinations

import sympy as sp

from geomtorsion.errors import GravityError
from geomtorsion.exact import Element
from geomtorsion.geometry import Frame, Tensor, antisymmetric
from geomtorsion.gravity.theory.fields import Index, Terms
from geomtorsion.gravity.theory.lagrangian import scalar_of
from geomtorsion.gravity.theory.matter import MatterField, Varied, square
from geomtorsion.gravity.theory.products import Product
from geomtorsion.support import checks


@dataclass(frozen=True, eq=False)
class KalbRamond(MatterField):
    """A two-form B with H = dB; the Lagrangian has H2 = H_abc H^abc and B2 = B_ab B^ab.

    potential: B_mn for m < n, in the order (0, 1), (0, 2), ..., (1, 2), ...
    number: its number among two-forms: H2, H2_2, ...
    """

    potential: Sequence[sp.Expr | str]
    number: int = 1
    kind = "two-form"

    @property
    def symbol(self) -> str:
        """The name of the field, which formulas with indices do not use."""
        return self.numbered_name("two_form")

    @property
    def strength(self) -> str:
        """The name of H."""
        return self.numbered_name("two_form_strength")

    @property
    def names(self) -> tuple[str, ...]:
        """H2 and B2, or H2_2 and B2_2."""
        return self.numbered_name("H2"), self.numbered_name("B2")

    def elements(self, frame: Frame) -> Sequence[Element]:
        """B_mn for m < n."""
        return [scalar_of(frame, x, f"potential[{k}]") for k, x in enumerate(self.potential)]

    def check(self, frame: Frame) -> None:
        """Read the potential."""
        entries = checks.entries(self.potential, "potential", GravityError)
        n = frame.dimension
        if len(entries) != n * (n - 1) // 2:
            raise GravityError(
                f"potential: expected {n * (n - 1) // 2} entries B_mn with m < n, got "
                f"{len(entries)}. Give B_01, B_02, ..., B_12, ... in this order."
            )
        self.elements(frame)

    @property
    def ranks(self) -> Mapping[str, int]:
        """B_ab and H_abc."""
        return {self.symbol: 2, self.strength: 3}

    def tensors(self, frame: Frame) -> dict[str, Tensor]:
        """B_ij, slots DD, and H_ijk = d_i B_jk + d_j B_ki + d_k B_ij, slots DDD, along the legs."""
        pairs = combinations(range(frame.dimension), 2)
        own: dict[Index, Element] = dict(zip(pairs, self.elements(frame), strict=True))
        potential = Tensor(frame, "dd", lambda index: own[index], antisymmetric(2), "B")
        get, q = potential.components.get, frame.coordinates

        def rule(index: Index) -> Element:
            a, b, c = index
            turns = ((a, b, c), (b, c, a), (c, a, b))
            return frame.field.sum([(1, get((y, z)).diff(q[x])) for x, y, z in turns])

        strength = Tensor(frame, "ddd", rule, antisymmetric(3), "H")
        return {self.symbol: potential.in_frame(), self.strength: strength.in_frame()}

    @property
    def products(self) -> Mapping[str, tuple[Product, ...]]:
        """H2 = H_abc H^abc and B2 = B_ab B^ab."""
        return dict(
            zip(self.names, (square(self.strength, 3), square(self.symbol, 2)), strict=True)
        )

    def coframe(self, equations: Varied) -> Tensor:
        """- 3 dL/dH_nbc H_ibc - 2 dL/dB_nb B_ib, slots DU."""
        legs = range(equations.frame.dimension)
        of_strength, strength, of_field, field = (
            read(name).components.get
            for name in (self.strength, self.symbol)
            for read in (equations.momentum, equations.tensor)
        )

        def rule(index: Index) -> Element:
            i, n = index
            terms: Terms = [
                (-3, of_strength((n, b, c)), strength((i, b, c))) for b in legs for c in legs
            ]
            terms += [(-2, of_field((n, b)), field((i, b))) for b in legs]
            return equations.frame.field.sum(terms)

        return Tensor(equations.frame, "DU", rule)

    def equation(self, equations: Varied) -> Tensor:
        """dL/dB_mn - (3/e) d_a(e dL/dH_amn), slots UU, antisymmetric."""
        field = equations.frame.field
        flow = equations.riemannian.divergence(equations.momentum(self.strength)).components.get
        own = equations.momentum(self.symbol).components.get
        return Tensor(
            equations.frame, "UU", lambda i: field.sum([(1, own(i)), (-3, flow(i))]),
            antisymmetric(2), "J", "two-form equation",
        )  # fmt: skip

    def noether_terms(self, equations: Varied, i: int) -> Terms:
        """- H_imn J^mn + 2 B_in d_m(e J^mn)/e with J = (d(eL)/dB)/e."""
        current = equations.matter_equations[self.symbol]
        legs = range(equations.frame.dimension)
        strength, get = equations.tensor(self.strength).components.get, current.components.get
        terms: Terms = [(-1, strength((i, m, n)), get((m, n))) for m in legs for n in legs]
        if equations.momentum(self.symbol).is_zero:
            return terms
        flow = equations.riemannian.divergence(current).components.get
        own = equations.tensor(self.symbol).components.get
        return [*terms, *((2, own((i, n)), flow((n,))) for n in legs)]


def kalb_ramond(potential: Sequence[sp.Expr | str]) -> KalbRamond:
    """A two-form B of Kalb and Ramond: the Lagrangian may name H2 = H_abc H^abc, H = dB, and B2.

    B2 = B_ab B^ab is a mass term. A second two-form of one theory has the names H2_2 and B2_2.

    Parameters
    ----------
    potential
        B_mn for m < n in coordinates, n(n - 1)/2 expressions: B_01, B_02, ..., B_12, ...

    Raises
    ------
    GravityError
        (from `equations`) The number of entries does not fit the frame.

    Examples
    --------
    >>> kalb_ramond(["0", "0", "b(t)"]).names
    ('H2', 'B2')
    """
    return KalbRamond(potential)

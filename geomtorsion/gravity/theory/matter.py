"""Matter: fields that enter a Lagrangian by their invariants."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from fractions import Fraction
from typing import ClassVar, Protocol, Self

import sympy as sp
from sympy.core.function import AppliedUndef

from geomtorsion.errors import GravityError
from geomtorsion.exact import Element, unknown_functions
from geomtorsion.geometry import Connection, Frame, Tensor, antisymmetric, levi_civita, symmetric
from geomtorsion.gravity.theory.fields import FrameFields, Index, Terms, along
from geomtorsion.gravity.theory.invariants import new_name
from geomtorsion.gravity.theory.lagrangian import scalar_of
from geomtorsion.gravity.theory.products import TENSORS, Factor, Product, hessian_name
from geomtorsion.support import checks

# Names of the traces of powers of phi_ab.
SECOND = ("Box", "hessian2", "hessian3")


class Varied(Protocol):
    """Field equations, as far as matter needs them."""

    @property
    def frame(self) -> Frame:
        """The frame of all connections."""
        ...

    @property
    def connections(self) -> tuple[Connection, ...]:
        """The connections, the first one leading."""
        ...

    @property
    def riemannian(self) -> FrameFields:
        """The Levi-Civita connection of the frame."""
        ...

    @property
    def matter_equations(self) -> Mapping[str, Tensor]:
        """(1/e) d(eL)/d(field) of each matter field, by its name."""
        ...

    def slope(self, name: str) -> Element:
        """dL/dI of a name in the Lagrangian."""
        ...

    def tensor(self, name: str) -> Tensor:
        """A tensor of matter, all indices down in the frame."""
        ...

    def momentum(self, name: str) -> Tensor:
        """dL/d(tensor) of a tensor of matter, all indices up in the frame."""
        ...


class MatterField(ABC):
    """A field with its own invariants in the Lagrangian.

    kind: the kind of field, in words.
    number: its number among fields of its kind, from 1.
    """

    kind: ClassVar[str]
    number: int

    @property
    @abstractmethod
    def symbol(self) -> str:
        """The name of the field."""

    @property
    @abstractmethod
    def names(self) -> tuple[str, ...]:
        """Its names in the Lagrangian."""

    def numbered_name(self, name: str) -> str:
        """X for the first field of its kind, X_2 for the second."""
        return name if self.number == 1 else f"{name}_{self.number}"

    def with_number(self, number: int) -> Self:
        """The field with another number."""
        return replace(self, number=number)  # type: ignore[type-var]

    @abstractmethod
    def elements(self, frame: Frame) -> Sequence[Element]:
        """The expressions of which the field is made."""

    def function(self, frame: Frame) -> AppliedUndef | None:
        """The unknown function that the field is, if it is one."""
        return None

    def parts(self, frame: Frame) -> set[AppliedUndef]:
        """The unknown functions of which the field is made, without functions of the frame."""
        functions = unknown_functions(self.elements(frame))
        coframe = frame.coframe.components.nonzero.values() if functions else ()
        return set(functions).difference(unknown_functions(coframe))

    @abstractmethod
    def check(self, frame: Frame) -> None:
        """Refuse a field that does not fit the frame."""

    @property
    @abstractmethod
    def ranks(self) -> Mapping[str, int]:
        """Its tensors, and the number of indices of each."""

    @abstractmethod
    def tensors(self, frame: Frame) -> dict[str, Tensor]:
        """Its tensors by their names, all indices down in the frame."""

    @property
    @abstractmethod
    def products(self) -> Mapping[str, tuple[Product, ...]]:
        """Its names that are products of its tensors."""

    def scalars(self, frame: Frame) -> dict[str, Element]:
        """Names of the field itself, with their values."""
        return {}

    @abstractmethod
    def coframe(self, equations: Varied) -> Tensor:
        """Its part of E_i^n, except L itself, slots DU."""

    @abstractmethod
    def equation(self, equations: Varied) -> Tensor:
        """(1/e) d(eL)/d(field)."""

    @abstractmethod
    def noether_terms(self, equations: Varied, i: int) -> Terms:
        """Minus its part of the right side of the identity of translations."""


@dataclass(frozen=True, eq=False)
class ScalarField(MatterField):
    """A scalar field; the Lagrangian has phi, X = g^ij d_i phi d_j phi and second derivatives.

    Second derivatives phi_ij belong to the Levi-Civita connection of the frame; their names are
    Box = phi_i^i, hessian2 = phi_ij phi^ij and hessian3 = phi_i^j phi_j^k phi_k^i.

    phi: expression in the coordinates.
    name: in the Lagrangian, or None: phi, phi_2, ...
    number: its number among scalar fields: X, X_2, ...
    """

    phi: sp.Expr | str
    name: str | None = None
    number: int = 1
    kind = "scalar field"

    @property
    def symbol(self) -> str:
        """The name of the field."""
        return self.numbered_name("phi") if self.name is None else self.name

    @property
    def names(self) -> tuple[str, ...]:
        """X, phi, Box, hessian2 and hessian3, or X_2, phi_2, ..."""
        further = (self.numbered_name(name) for name in SECOND)
        return self.numbered_name("X"), self.symbol, *further

    @property
    def box(self) -> str:
        """Box, or Box_2."""
        return self.numbered_name(SECOND[0])

    @property
    def hessian(self) -> str:
        """The name of the tensor phi_ab."""
        return hessian_name(self.symbol)

    def check(self, frame: Frame) -> None:
        """Read phi."""
        self._element(frame)

    def elements(self, frame: Frame) -> Sequence[Element]:
        """The expression of the field."""
        return [self._element(frame)]

    def function(self, frame: Frame) -> AppliedUndef | None:
        """The unknown function that the field is, if it is one."""
        expression = self._element(frame).sympy
        return expression if isinstance(expression, AppliedUndef) else None

    def _element(self, frame: Frame) -> Element:
        return scalar_of(frame, self.phi, "phi")

    @property
    def ranks(self) -> Mapping[str, int]:
        """The gradient phi_a and the second derivatives phi_ab."""
        return {self.symbol: 1, self.hessian: 2}

    def tensors(self, frame: Frame) -> dict[str, Tensor]:
        """phi_i, slots D, and phi_ij = E_i(phi_j) - omega_ij^k phi_k, slots DD."""
        phi, legs = self._element(frame), range(frame.dimension)
        gradient = Tensor(frame, "D", lambda i: frame.field.sum(along(frame, i[0], phi)))
        slope = gradient.components.get
        omega = FrameFields(levi_civita(frame)).omega.components.get

        def rule(index: Index) -> Element:
            i, j = index
            terms = along(frame, i, slope((j,)))
            return frame.field.sum([*terms, *((-1, omega((i, j, k)), slope((k,))) for k in legs)])

        return {self.symbol: gradient, self.hessian: Tensor(frame, "DD", rule, symmetric(2))}

    @property
    def products(self) -> Mapping[str, tuple[Product, ...]]:
        """X = phi_a phi^a, and traces of powers of phi_ab."""
        powers = enumerate(SECOND, 1)
        traces = {self.numbered_name(name): _trace(self.hessian, k) for k, name in powers}
        return {self.names[0]: square(self.symbol, 1), **traces}

    def scalars(self, frame: Frame) -> dict[str, Element]:
        """phi."""
        return {self.symbol: self._element(frame)}

    def coframe(self, equations: Varied) -> Tensor:
        """- J^n phi_i - W^nb phi_ib + D_a(W^a_i phi^n - W^n_i phi^a), W = dL/dphi_ab, slots DU.

        The last two terms come from phi_ab = E_a(phi_b) - omega_ab^c phi_c, whose connection the
        coframe determines.
        """
        frame, field = equations.frame, equations.frame.field
        flow = self._flow(equations).components.get
        slope = equations.tensor(self.symbol).components.get
        second = equations.momentum(self.hessian)

        def first(index: Index) -> Element:
            i, n = index
            return field.sum([(-1, flow((n,)), slope((i,)))])

        if second.is_zero:
            return Tensor(frame, "DU", first)
        lower, upper = equations.tensor(self.hessian).components.get, second.components.get
        turned = self._turned(equations).components.get

        def rule(index: Index) -> Element:
            i, n = index
            terms = [(-1, upper((n, b)), lower((i, b))) for b in range(frame.dimension)]
            return field.sum([(1, first(index)), (1, turned((n, i))), *terms])

        return Tensor(frame, "DU", rule)

    def _flow(self, equations: Varied) -> Tensor:
        """J^n = dL/dphi_n - (1/e) D_a(e dL/dphi_an), slots U."""
        first, second = equations.momentum(self.symbol), equations.momentum(self.hessian)
        return first if second.is_zero else first - equations.riemannian.divergence(second)

    def _turned(self, equations: Varied) -> Tensor:
        """D_a(W^a_i phi^n - W^n_i phi^a), slots UD for n, i."""
        frame = equations.frame
        lower = equations.momentum(self.hessian).lowered(1).components.get
        slope = equations.tensor(self.symbol).raised().components.get

        def rule(index: Index) -> Element:
            a, n, i = index
            return frame.field.sum(
                [(1, lower((a, i)), slope((n,))), (-1, lower((n, i)), slope((a,)))]
            )

        turned = Tensor(frame, "UUD", rule, antisymmetric(3))
        return equations.riemannian.divergence(turned, paired=True)

    def equation(self, equations: Varied) -> Tensor:
        """dL/dphi - (1/e) d_m(e J^m) with J^m = dL/dphi_m - (1/e) D_a(e dL/dphi_am), rank 0."""
        frame = equations.frame

        def rule() -> Element:
            divergence = equations.riemannian.divergence(self._flow(equations)).element()
            return frame.field.sum([(1, equations.slope(self.symbol)), (-1, divergence)])

        return frame.scalar(rule, self.symbol, "scalar field equation")

    def noether_terms(self, equations: Varied, i: int) -> Terms:
        """- (d(eL)/dphi)/e d_i phi."""
        slope = equations.tensor(self.symbol).components.get((i,))
        return [(-1, equations.matter_equations[self.symbol].element(), slope)]


@dataclass(frozen=True, eq=False)
class Maxwell(MatterField):
    """An electromagnetic field; the Lagrangian has F2 = F_ab F^ab.

    potential: A_mu, one expression for each coordinate.
    number: its number among Maxwell fields: F2, F2_2, ...
    """

    potential: Sequence[sp.Expr | str]
    number: int = 1
    kind = "Maxwell field"

    @property
    def symbol(self) -> str:
        """A, or A_2."""
        return self.numbered_name("A")

    @property
    def names(self) -> tuple[str, ...]:
        """F2, or F2_2."""
        return (self.numbered_name("F2"),)

    def elements(self, frame: Frame) -> Sequence[Element]:
        """A_mu."""
        return [scalar_of(frame, x, f"potential[{k}]") for k, x in enumerate(self.potential)]

    def check(self, frame: Frame) -> None:
        """Read the potential."""
        entries = checks.entries(self.potential, "potential", GravityError)
        if len(entries) != frame.dimension:
            raise GravityError(
                f"potential: expected {frame.dimension} entries A_mu, got {len(entries)}. Give "
                "one expression for each coordinate."
            )
        self.strength(frame)

    def strength(self, frame: Frame) -> Tensor:
        """F_ij = E_i^m E_j^n (d_m A_n - d_n A_m), slots DD."""
        q = frame.coordinates
        potential = self.elements(frame)

        def rule(index: Index) -> Element:
            m, n = index
            return potential[n].diff(q[m]) - potential[m].diff(q[n])

        return Tensor(frame, "dd", rule, antisymmetric(2), "F").in_frame()

    @property
    def ranks(self) -> Mapping[str, int]:
        """A_a and F_ab."""
        return {self.symbol: 1, self.numbered_name("F"): 2}

    def tensors(self, frame: Frame) -> dict[str, Tensor]:
        """A_i, slots D, and F_ij, slots DD."""
        elements = self.elements(frame)
        potential = Tensor(frame, "d", lambda index: elements[index[0]]).in_frame()
        return {self.symbol: potential, self.numbered_name("F"): self.strength(frame)}

    @property
    def products(self) -> Mapping[str, tuple[Product, ...]]:
        """F2 = F_ab F^ab."""
        return {self.names[0]: square(self.numbered_name("F"), 2)}

    def coframe(self, equations: Varied) -> Tensor:
        """- 2 dL/dF_nb F_ib - dL/dA_n A_i, slots DU."""
        strength, legs = self.numbered_name("F"), range(equations.frame.dimension)
        lower = equations.tensor(strength).components.get
        upper = equations.momentum(strength).components.get
        potential = equations.tensor(self.symbol).components.get
        current = equations.momentum(self.symbol).components.get

        def rule(index: Index) -> Element:
            i, n = index
            terms: Terms = [(-2, upper((n, b)), lower((i, b))) for b in legs]
            return equations.frame.field.sum([*terms, (-1, current((n,)), potential((i,)))])

        return Tensor(equations.frame, "DU", rule)

    def equation(self, equations: Varied) -> Tensor:
        """dL/dA_n - (2/e) d_m(e dL/dF_mn), slots U."""
        field = equations.frame.field
        fields = FrameFields(equations.connections[0])
        upper = equations.momentum(self.numbered_name("F"))
        flow = fields.divergence(upper, paired=True).components.get
        own = equations.momentum(self.symbol).components.get
        return Tensor(equations.frame, "U", lambda i: field.sum([(1, own(i)), (-2, flow(i))]))

    def noether_terms(self, equations: Varied, i: int) -> Terms:
        """- F_in J^n + A_i d_n(e J^n)/e with J = (d(eL)/dA)/e.

        The second term vanishes where the Lagrangian does not contain A itself.
        """
        lower = equations.tensor(self.numbered_name("F")).components.get
        current = equations.matter_equations[self.symbol]
        get, legs = current.components.get, range(equations.frame.dimension)
        terms: Terms = [(-1, lower((i, n)), get((n,))) for n in legs]
        if equations.momentum(self.symbol).is_zero:
            return terms
        flow = FrameFields(equations.connections[0]).divergence(current).element()
        return [*terms, (1, equations.tensor(self.symbol).components.get((i,)), flow)]


def square(name: str, rank: int) -> tuple[Product, ...]:
    """A tensor contracted with itself."""
    factor = Factor(name, tuple(range(1, rank + 1)))
    return (Product(Fraction(1), (factor, factor)),)


def _trace(name: str, power: int) -> tuple[Product, ...]:
    """The trace of a power of a tensor with two indices."""
    places = range(1, power + 1)
    factors = tuple(Factor(name, (k, k % power + 1)) for k in places)
    return (Product(Fraction(1), factors),)


def numbered(matter: Iterable[object]) -> tuple[object, ...]:
    """Matter with numbers for fields of one kind, by which their names differ."""
    counts: dict[str, int] = {}
    owners: dict[str, str] = {}
    result: list[object] = []
    for one in matter:
        if isinstance(one, MatterField):
            counts[one.kind] = counts.get(one.kind, 0) + 1
            one = one.with_number(counts[one.kind])
            for name in dict.fromkeys((*one.names, one.symbol)):
                if name in owners:
                    raise GravityError(
                        f"matter: expected different names, got {name} for two fields. Give "
                        "another: scalar_field(..., name='chi')."
                    )
                owners[name] = one.kind
        result.append(one)
    return tuple(result)


def scalar_field(phi: sp.Expr | str, name: str | None = None) -> ScalarField:
    """A scalar field phi: the Lagrangian may name X = g^ij d_i phi d_j phi, and phi.

    Second derivatives are Box(phi), or Box, with hessian2 = phi_ij phi^ij and hessian3 =
    phi_i^j phi_j^k phi_k^i, all of the Levi-Civita connection. A second field of one theory has the
    names X_2 and phi_2.

    Parameters
    ----------
    phi
        Expression in the coordinates.
    name
        Another name than phi in the Lagrangian, as for a frame with an angle phi.

    Raises
    ------
    GravityError
        The name is not a new name of one word.

    Examples
    --------
    >>> scalar_field("phi(t)").names
    ('X', 'phi', 'Box', 'hessian2', 'hessian3')
    >>> scalar_field("u(t)", name="chi").names[:2]
    ('X', 'chi')
    """
    if name is not None:
        name = new_name(name, "name")
        if name in TENSORS:
            raise GravityError(
                f"name: expected a new name, got {name}, which is a tensor in formulas with "
                "indices. Give another name."
            )
    return ScalarField(phi, name)


def maxwell(potential: Sequence[sp.Expr | str]) -> Maxwell:
    """An electromagnetic field with potential A_mu: the Lagrangian may name F2 = F_ab F^ab.

    A second field of one theory has the name F2_2.

    Examples
    --------
    >>> maxwell(["q/r", 0, 0, 0]).names
    ('F2',)
    """
    return Maxwell(potential)

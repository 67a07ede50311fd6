"""Matter: fields that enter a Lagrangian by their invariants."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace
from typing import ClassVar, Protocol

import sympy as sp
from sympy.core.function import AppliedUndef

from geomtorsion import checks
from geomtorsion.errors import GravityError
from geomtorsion.exact import Element, unknown_functions
from geomtorsion.geometry import Connection, Frame, Tensor, antisymmetric
from geomtorsion.gravity.fields import FrameFields, Index, Terms, along
from geomtorsion.gravity.fluids import Fluid
from geomtorsion.gravity.lagrangian import scalar_of
from geomtorsion.gravity.vocabulary import new_name


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

    def slope(self, name: str) -> Element:
        """dL/dI of a name in the Lagrangian."""
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

    @abstractmethod
    def value(self, frame: Frame, name: str) -> Element:
        """The value of one of its names."""

    @abstractmethod
    def coframe_terms(self, equations: Varied, i: int, n: int) -> Terms:
        """Terms of E_i^n from its invariants, except L itself."""

    @abstractmethod
    def equation(self, equations: Varied) -> Tensor:
        """(1/e) d(eL)/d(field)."""

    @abstractmethod
    def noether_terms(self, equations: Varied, i: int) -> Terms:
        """Minus its part of the right side of the identity of translations."""


@dataclass(frozen=True, eq=False)
class ScalarField(MatterField):
    """A scalar field; the Lagrangian has X = g^ij d_i phi d_j phi and phi.

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
        """X and phi, or X_2 and phi_2."""
        return self.numbered_name("X"), self.symbol

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

    def _slope(self, frame: Frame) -> Tensor:
        """d_i phi along the legs, slots D."""
        phi = self._element(frame)
        return Tensor(frame, "D", lambda i: frame.field.sum(along(frame, i[0], phi)))

    def value(self, frame: Frame, name: str) -> Element:
        """The value of X or of phi."""
        if name == self.symbol:
            return self._element(frame)
        slope = self._slope(frame)
        return (slope @ slope.raised()).element()

    def coframe_terms(self, equations: Varied, i: int, n: int) -> Terms:
        """- 2 dL/dX d_i phi d^n phi."""
        slope = self._slope(equations.frame)
        lower, upper = slope.components.get, slope.raised().components.get
        return [(-2, equations.slope(self.names[0]), lower((i,)), upper((n,)))]

    def equation(self, equations: Varied) -> Tensor:
        """dL/dphi - (1/e) d_m(2 e dL/dX d^m phi), rank 0."""
        frame = equations.frame
        weight, upper = equations.slope(self.names[0]), self._slope(frame).raised().components.get
        flow = Tensor(frame, "U", lambda i: frame.field.sum([(2, weight, upper(i))]))
        fields = FrameFields(equations.connections[0])

        def rule() -> Element:
            divergence = fields.divergence(flow).element()
            return frame.field.sum([(1, equations.slope(self.symbol)), (-1, divergence)])

        return frame.scalar(rule, self.symbol, "scalar field equation")

    def noether_terms(self, equations: Varied, i: int) -> Terms:
        """- (d(eL)/dphi)/e d_i phi."""
        slope = self._slope(equations.frame).components.get((i,))
        return [(-1, self.equation(equations).element(), slope)]


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

    def value(self, frame: Frame, name: str) -> Element:
        """The value of F2."""
        strength = self.strength(frame)
        upper = strength.raised().components.nonzero
        get = strength.components.get
        return frame.field.sum([(1, x, get(index)) for index, x in upper.items()])

    def coframe_terms(self, equations: Varied, i: int, n: int) -> Terms:
        """- 4 dL/dF2 F_ib F^nb."""
        strength, weight = self.strength(equations.frame), equations.slope(self.names[0])
        lower, upper = strength.components.get, strength.raised().components.get
        legs = range(equations.frame.dimension)
        return [(-4, weight, lower((i, b)), upper((n, b))) for b in legs]

    def equation(self, equations: Varied) -> Tensor:
        """- (4/e) d_m(e dL/dF2 F^mn), slots U."""
        frame, weight = equations.frame, equations.slope(self.names[0])
        upper = self.strength(frame).raised().components.get
        flow = Tensor(frame, "UU", lambda i: frame.field.sum([(-4, weight, upper(i))]))
        fields = FrameFields(equations.connections[0])
        return fields.divergence(flow, paired=True)

    def noether_terms(self, equations: Varied, i: int) -> Terms:
        """- F_in (d(eL)/dA_n)/e."""
        lower = self.strength(equations.frame).components.get
        current = self.equation(equations).components.get
        return [(-1, lower((i, n)), current((n,))) for n in range(equations.frame.dimension)]


def numbered(matter: Iterable[MatterField | Fluid]) -> tuple[MatterField | Fluid, ...]:
    """Matter with numbers for fields of one kind, by which their names differ."""
    counts: dict[str, int] = {}
    owners: dict[str, str] = {}
    result: list[MatterField | Fluid] = []
    for one in matter:
        if isinstance(one, ScalarField | Maxwell):
            counts[one.kind] = counts.get(one.kind, 0) + 1
            one = replace(one, number=counts[one.kind])
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

    A second field of one theory has the names X_2 and phi_2.

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
    >>> scalar_field("phi(t)").names, scalar_field("u(t)", name="chi").names
    (('X', 'phi'), ('X', 'chi'))
    """
    if name is not None:
        name = new_name(name, "name")
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

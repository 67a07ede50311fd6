"""Residuals: everything that vanishes on a solution of field equations, with what it determines."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import sympy as sp
from sympy.core.function import AppliedUndef
from sympy.core.relational import Equality

from geomtorsion.errors import GravityError
from geomtorsion.exact import Element, unknown_functions
from geomtorsion.geometry import Connection, Frame, Tensor, levi_civita
from geomtorsion.gravity.theory.fields import HALF, FrameFields, Index
from geomtorsion.gravity.theory.fluids import Fluid
from geomtorsion.gravity.theory.hypermomentum import Source
from geomtorsion.gravity.theory.identities import rotation_terms, translation_terms
from geomtorsion.gravity.theory.lagrangian import scalar_of
from geomtorsion.gravity.theory.matter import MatterField
from geomtorsion.support import checks


def names_of_inner(inner: Sequence[str], variable: str) -> tuple[str, ...]:
    """Conditions that name invariants inside of functions, such as S(r) = T for exp(T)."""
    return tuple(f"S{k or ''}({variable}) = {name}" for k, name in enumerate(inner))


@dataclass(frozen=True, eq=False)
class Sources:
    """Field equations with the unknown functions of each of their parts.

    connections, matter: of the field equations.
    fields: torsion and curvature of the first connection.
    scalars: values of invariants, which a condition may name.
    coframe_equation, metric_equation, connection_equations, matter_equations: E, M, C and others.
    inner: names of invariants inside of functions in the Lagrangian.
    """

    connections: tuple[Connection, ...]
    matter: tuple[MatterField | Source, ...]
    fields: FrameFields
    scalars: Mapping[str, sp.Expr]
    coframe_equation: Tensor
    metric_equation: Tensor
    connection_equations: tuple[Tensor, ...]
    matter_equations: Mapping[str, Tensor]
    inner: tuple[str, ...] = ()

    @property
    def frame(self) -> Frame:
        """The frame of the equations."""
        return self.fields.frame

    @property
    def coframe(self) -> frozenset[AppliedUndef]:
        """The unknown functions of the coframe."""
        return _functions(self.frame.coframe.components.nonzero.values())

    @property
    def nonzero(self) -> frozenset[AppliedUndef]:
        """The functions that vanish nowhere.

        They are factors of the determinant of the coframe, or of denominators in connections.
        """
        entries = [sp.fraction(x.sympy)[1] for x in self._coefficients(self.connections)]
        factors = sp.Mul.make_args(sp.Mul(self.frame.determinant.element().sympy, *entries))
        bases = {one.base if one.is_Pow else one for one in factors}
        return frozenset(one for one in bases if isinstance(one, AppliedUndef))

    @property
    def fluids(self) -> list[Fluid]:
        """The fluids among the matter."""
        return [one for one in self.matter if isinstance(one, Fluid)]

    @property
    def fluid(self) -> frozenset[AppliedUndef]:
        """The unknown functions of fluids."""
        parts: set[AppliedUndef] = set()
        for one in self.fluids:
            parts |= _functions(one.elements(self.frame))
        return frozenset(parts - self.coframe)

    @property
    def field(self) -> frozenset[AppliedUndef]:
        """The unknown functions of matter fields."""
        fields = [one for one in self.matter if isinstance(one, MatterField)]
        return frozenset().union(*(one.parts(self.frame) for one in fields))

    @property
    def connection(self) -> frozenset[AppliedUndef]:
        """The unknown functions of the connections that occur nowhere else."""
        entries = self._coefficients(self.connections)
        return _functions(entries) - self.coframe - self.fluid - self.field

    @property
    def algebraic(self) -> frozenset[AppliedUndef]:
        """Unknown functions of connections with an equation of their own, such as torsion."""
        varied = self._coefficients(filter(_is_varied, self.connections))
        return _functions(varied) & self.connection

    @property
    def vanishing(self) -> frozenset[AppliedUndef]:
        """Algebraic functions, if the Levi-Civita connection remains where all of them vanish."""
        functions = self.algebraic - self.nonzero
        if functions != self.algebraic:
            return frozenset()
        bar, zeros = levi_civita(self.frame).coefficients, dict.fromkeys(functions, sp.S.Zero)
        rest = (
            self.frame.field.read(x.sympy.subs(zeros).doit())
            for one in filter(_is_varied, self.connections)
            for x in (one.coefficients - bar).components.nonzero.values()
        )
        return functions if all(x.is_zero for x in rest) else frozenset()

    @staticmethod
    def _coefficients(connections: Iterable[Connection]) -> list[Element]:
        """The coefficients of connections that are not zero."""
        return [x for one in connections for x in one.coefficients.components.nonzero.values()]

    def residuals(
        self, conditions: Iterable[tuple[object, object]]
    ) -> Iterator[tuple[Element, frozenset[AppliedUndef]]]:
        """Elements that vanish, each with the functions that it is meant to determine.

        conditions: pairs of sides, such as ("p", "rho/3").
        """
        for left, right in conditions:
            sides = left, right
            one, two = (scalar_of(self.frame, x, "condition", self.scalars) for x in sides)
            yield one - two, _functions([one])
        for number, connection in enumerate(self.connections):
            if _is_varied(connection):
                equation = self.connection_equations[number]
                yield from _nonzero(equation, self.connection)
        equation = (
            self.metric_equation if self._is_symmetric_teleparallel else self.coframe_equation
        )
        yield from _nonzero(equation, self.coframe)
        for tensor in self.matter_equations.values():
            yield from _nonzero(tensor, self.field)
        for one in self.fluids:
            yield from ((element, self.fluid) for element in self._conservation(one))

    @property
    def _is_symmetric_teleparallel(self) -> bool:
        """Whether the metric is varied while the connection stays flat and is not metric."""
        flat = [one for one in self.connections if one.kind == "general"]
        return any(one.is_flat and not one.metric_compatible for one in flat)

    def _conservation(self, fluid: Fluid) -> Iterator[Element]:
        """Laws of motion of a fluid: its part of the identities of both symmetries.

        They hold for each fluid by itself, because fluids act on each other by gravity only.
        """
        frame, connection = self.frame, self.connections[0]
        coframe, spin = fluid.coframe_source(connection), fluid.connection_source(connection)
        fields = self.fields
        turned = fields.divergence(spin)
        lower, moved = coframe.lowered(1).components.get, turned.lowered().components.get

        def rule(index: Index) -> Element:
            return frame.field.sum([(HALF, lower(index[::-1])), (HALF, moved(index))])

        metric = Tensor(frame, "DD", rule)
        translation = translation_terms(coframe, metric, [(fields, spin, turned)], lambda _: [])
        for indices, value in (translation, rotation_terms(metric)):
            yield from map(value, indices)


def conditions_of(conditions: object) -> list[tuple[object, object]]:
    """Pairs of sides from texts with one sign of equality, from sympy equations, or expressions.

    Examples
    --------
    >>> conditions_of("p = rho/3")
    [('p ', ' rho/3')]
    """
    single = isinstance(conditions, str | sp.Basic)
    pairs: list[tuple[object, object]] = []
    every: list[Any] = (
        [conditions] if single else checks.entries(conditions, "conditions", GravityError)
    )
    for one in every:
        sides: list[object] = [one, 0]
        if isinstance(one, str):
            sides = list(one.split("="))
        elif isinstance(one, Equality):
            sides = [one.lhs, one.rhs]
        if len(sides) != 2:
            raise GravityError(
                f"conditions: expected text with one sign of equality, got {checks.shown(one)}. "
                "Write a condition such as 'p = rho/3'."
            )
        pairs.append((sides[0], sides[1]))
    return pairs


def _is_varied(connection: Connection) -> bool:
    """Whether a connection has an equation of its own."""
    return connection.kind not in ("cartan", "levi-civita") and not connection.is_flat


def _nonzero(
    tensor: Tensor, functions: frozenset[AppliedUndef]
) -> Iterator[tuple[Element, frozenset[AppliedUndef]]]:
    """The components that do not vanish identically."""
    return ((element, functions) for element in tensor.components.nonzero.values())


def _functions(elements: Iterable[Element]) -> frozenset[AppliedUndef]:
    return frozenset(unknown_functions(elements))

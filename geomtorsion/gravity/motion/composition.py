"""Composition: terms of a Lagrangian and sources as effects, and the equations without some."""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from itertools import chain, combinations
from typing import Any

import sympy as sp

from geomtorsion.errors import GravityError, StartError
from geomtorsion.exact import unknown_functions
from geomtorsion.gravity.reduced.beginning import Beginning, Start
from geomtorsion.gravity.reduced.reduction import Reduction
from geomtorsion.gravity.reduced.requests import Request
from geomtorsion.gravity.theory.field_equations import FieldEquations
from geomtorsion.gravity.theory.fluids import Fluid
from geomtorsion.gravity.theory.hypermomentum import Source
from geomtorsion.gravity.theory.matter import MatterField, numbered
from geomtorsion.gravity.theory.residuals import conditions_of
from geomtorsion.ode import ODE
from geomtorsion.support import checks
from geomtorsion.support.caching import cached_property
from geomtorsion.support.copies import only_fields

TERM = "term of the Lagrangian"
_NAME = re.compile(r"[^\W\d]\w*")


@dataclass(frozen=True, eq=False)
class Composition:
    """A theory with its start: what made an ODE, and makes it without some of its terms.

    equations: of the theory. variable: on which the unknown functions depend.
    start: its values, the most important first: a theory with fewer unknowns follows the first
        numbers, and its constraints determine the last ones.
    conditions: as for `gravity.solve`. request: what a solution holds, and how it is solved.
    """

    equations: FieldEquations
    variable: str
    start: Start
    conditions: object
    request: Request
    _parts: dict[frozenset[str], Composition] = field(default_factory=dict, repr=False, init=False)

    def __getstate__(self) -> dict[str, object]:
        return only_fields(self)

    @cached_property
    def terms(self) -> Mapping[str, sp.Expr]:
        """The terms of the Lagrangian, by their text."""
        terms = sp.Add.make_args(sp.expand_mul(self.equations.expression))
        return {str(term): term for term in sorted(terms, key=str)}

    @cached_property
    def sources(self) -> Mapping[str, Source]:
        """Fluids and other sources, by names; a second one of a name is counted."""
        table: dict[str, Source] = {}
        for one in self.equations.matter:
            if isinstance(one, MatterField):
                continue
            stem = f"fluid {one.density}" if isinstance(one, Fluid) else "hypermomentum"
            name, count = stem, 1
            while name in table:
                count += 1
                name = f"{stem} ({count})"
            table[name] = one
        return table

    @property
    def title(self) -> str:
        """The Lagrangian."""
        return f"L = {self.equations.expression}"

    @property
    def effects(self) -> Mapping[str, str]:
        """Terms of the Lagrangian, and sources."""
        sources = {
            name: "source of gravity: perfect fluid" if isinstance(one, Fluid) else "source of spin"
            for name, one in self.sources.items()
        }
        return {**dict.fromkeys(self.terms, TERM), **sources}

    @cached_property
    def reduction(self) -> Reduction:
        """The first-order equations."""
        return self.equations.reduce(self.variable, self.conditions)

    @property
    def watch(self) -> tuple[str, ...]:
        """The unknown functions of the coframe; all of them where it has none."""
        reduction = self.reduction
        coframe = unknown_functions(self.equations.frame.coframe.components.nonzero.values())
        every = {x: reduction.jets.symbol(x, 0).name for x in reduction.eliminated.rules}
        return tuple(name for x, name in every.items() if x in coframe) or tuple(every.values())

    @cached_property
    def beginning(self) -> Beginning:
        """The start with its numbers read."""
        return self.reduction.beginning(self.start)

    @property
    def place(self) -> sp.Expr:
        """The value of the variable where numbers start."""
        return self.beginning.first[0]

    @cached_property
    def ode(self) -> ODE:
        """The equations with the start."""
        ode = self.reduction.ode_of(self.beginning, self.request)
        return replace(ode, maker=self)

    def without(self, ode: ODE, effects: frozenset[str]) -> ODE:
        """The equations of the theory without some terms and sources.

        Raises
        ------
        GravityError, StartError
            the rest does not determine the functions, starts elsewhere, or numbers of the ODE were
            changed.
        """
        own = self.ode
        if ode != own:
            raise StartError(
                "expected equations with the numbers of gravity.solve, got changed ones. Solve "
                "the theory with these numbers first."
            )
        if effects not in self._parts:
            self._parts[effects] = self._part(effects)
        part = self._parts[effects]
        if part.place != self.place:
            raise GravityError(
                f"expected a solution from {self.variable} = {self.place}, got one from "
                f"{part.place}, because its power series is another one. Omit other effects."
            )
        return part.ode

    def moved(self, ode: ODE, part: float) -> ODE:
        """The theory from other numbers, which its constraints complete near the former ones."""
        known = {name: float(x) for name, x in zip(ode.states, ode.start, strict=True)}
        values = {
            name: float(x) * (1 + (-1) ** k * part)
            for k, (name, x) in enumerate(_named(self.start.values).items())
        }
        near = {name: x for name, x in known.items() if name not in values}
        return self._from(values, near).ode

    def _from(self, values: Mapping[str, object], near: Mapping[str, object]) -> Composition:
        """The same theory from other numbers of states."""
        other = replace(self, start=replace(self.start, values=values, near=near))
        # The equations are the same.
        vars(other)["reduction"] = self.reduction
        return other

    def _part(self, effects: frozenset[str]) -> Composition:
        """The theory without some effects, with as many numbers of its start as it needs."""
        equations = self.equations
        expression = sp.Add(*(x for name, x in self.terms.items() if name not in effects))
        omitted = [one for name, one in self.sources.items() if name in effects]
        used = {symbol.name for symbol in expression.free_symbols}
        # A field without a term in the Lagrangian does not belong to the theory.
        matter = [
            one
            for one, field in zip(equations.matter, numbered(equations.matter), strict=True)
            if one not in omitted
            and (not isinstance(field, MatterField) or used & {*field.names, field.symbol})
        ]
        theory = replace(equations.lagrangian, expression=expression)
        rest = FieldEquations(equations.connections, theory, tuple(matter))
        rest.check_names()
        part = replace(self, equations=rest, conditions=self._conditions(omitted, matter))
        lost = {*self.reduction.states} - {*part.reduction.states}
        start, near = (
            {name: x for name, x in _named(table).items() if name not in lost}
            for table in (self.start.values, self.start.near)
        )
        return part._begun(start, near)

    def _begun(self, start: dict[str, object], near: dict[str, object]) -> Composition:
        """The theory with as many numbers of a start as it takes; the others are near its own."""
        refused: GravityError | StartError | None = None
        # As few numbers as possible are left to the constraints, the last ones first.
        sizes = range(len(start) + 1)
        for names in chain.from_iterable(combinations(reversed(start), k) for k in sizes):
            left = {name: x for name, x in start.items() if name not in names}
            trial = self._from(left, near | {name: start[name] for name in names})
            try:
                _ = trial.beginning.first
            except (GravityError, StartError) as error:
                refused = refused or error
            else:
                return trial
        assert refused is not None
        raise refused

    def _conditions(self, omitted: Sequence[Source], matter: Sequence[Any]) -> object:
        """The conditions that do not name a function of omitted sources only."""
        frame = self.equations.frame
        coframe = unknown_functions(frame.coframe.components.nonzero.values())
        rest = [x for one in matter for x in one.elements(frame)]
        gone = {*unknown_functions(x for one in omitted for x in one.elements(frame))}
        words = {str(x.func) for x in gone - {*coframe, *unknown_functions(rest)}}
        return [
            sp.Eq(*pair, evaluate=False)
            if isinstance(pair[0], sp.Basic)
            else "=".join(map(str, pair))
            for pair in conditions_of(self.conditions)
            if not words & {word for side in pair for word in _NAME.findall(str(side))}
        ]


def _named(values: Mapping[str, object]) -> dict[str, Any]:
    """Numbers of states by name."""
    return checks.by_name(values, "start", StartError)

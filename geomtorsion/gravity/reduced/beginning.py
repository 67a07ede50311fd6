"""Beginning: the numbers from which solutions of reduced equations start, read once."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field

import sympy as sp

from geomtorsion.gravity.reduced.centre import Centre
from geomtorsion.gravity.reduced.starts import completed
from geomtorsion.support.caching import cached_property


@dataclass(frozen=True, eq=False)
class Start:
    """Numbers at the origin of a solution, as a user gives them.

    values: state -> number. parameters: name -> number. near: state -> rough number, where a
    constraint has several solutions. origin: the value of the variable.
    """

    values: Mapping[str, object]
    parameters: Mapping[str, object] = field(default_factory=dict)
    near: Mapping[str, object] = field(default_factory=dict)
    origin: object = 0

    @classmethod
    def of(
        cls,
        values: Mapping[str, object],
        parameters: Mapping[str, object] | None,
        near: Mapping[str, object] | None,
        origin: object = 0,
    ) -> Start:
        """A start without parameters or rough numbers where they are None."""
        return cls(values, parameters or {}, near or {}, origin)


@dataclass(frozen=True, eq=False)
class Beginning:
    """A start of reduced equations: its exact numbers, completed by the constraints.

    Made by `Reduction.beginning`.

    rates: state -> its derivative. constraints: expressions that vanish.
    values, near: numbers and rough numbers of states. parameters: numbers by name; written: the
    same as they were given.
    variable: its name; place: its value at the origin. centre: regular solutions about the place
    if the rates have a pole there, or None.
    """

    rates: Mapping[str, sp.Expr]
    constraints: Sequence[sp.Expr]
    values: Mapping[str, sp.Expr]
    parameters: Mapping[str, sp.Expr]
    written: Mapping[str, object]
    near: Mapping[str, sp.Expr]
    variable: str
    place: sp.Expr
    centre: Centre | None

    @cached_property
    def states(self) -> dict[str, sp.Expr]:
        """A number for each state at the origin.

        Raises
        ------
        StartError
            numbers are missing, a constraint does not hold or has several solutions.
        """
        if self.centre is not None:
            return self.centre.states(self.values, self.parameters, self.near)
        numbers = {**self.parameters, self.variable: self.place}
        return completed(self.rates, self.constraints, self.values, numbers, self.near)

    @cached_property
    def first(self) -> tuple[sp.Expr, dict[str, sp.Expr]]:
        """The value of the variable where the integration starts, and all states there.

        Raises
        ------
        StartError, GravityError
            as for `states`, or a regular solution has no power series at the origin.
        """
        return self.within(None)

    def within(self, reach: sp.Expr | None) -> tuple[sp.Expr, dict[str, sp.Expr]]:
        """The same as `first`, at most at the distance `reach` from the origin."""
        if self.centre is None:
            return self.place, self.states
        return self.centre.beside(self.values, self.parameters, self.near, reach)

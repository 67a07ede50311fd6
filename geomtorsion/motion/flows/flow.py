"""Flow: named states with rates, a start, and what is to be known about them."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any

import sympy as sp

from geomtorsion.motion.flows.law import Law
from geomtorsion.motion.flows.tape import Tape
from geomtorsion.motion.system import System

Switch = tuple[float, Mapping[str, Any]]
# An output is one expression, or several that make a vector.
Terms = sp.Expr | tuple[sp.Expr, ...]


@dataclass(frozen=True, eq=False)
class Flow:
    """First-order equations with a start; made by `flow`.

    law: the rates.
    start: numbers in the order of the states, at t = 0.
    parameters: name -> number.
    invariants, outputs: name -> expression, or expressions that make a vector.
    switches: (time, name -> new value), in order of time; parameters change, states jump.
    unit: groups of states that have length one together.
    name: what it is called.

    Examples
    --------
    >>> from geomtorsion.motion import flow, solve
    >>> swing = flow({"x": "v", "v": "-k*x"}, {"x": 1, "v": 0}, parameters={"k": 4},
    ...              invariants={"energy": "v**2/2 + k*x**2/2"})
    >>> print(swing)
    flow of x, v
    >>> sol = solve(swing, 1.0)
    >>> round(float(sol["x"][-1]), 9)
    -0.416146837
    """

    law: Law
    start: tuple[Any, ...]
    parameters: Mapping[str, Any]
    invariants: Mapping[str, Terms]
    outputs: Mapping[str, Terms]
    switches: tuple[Switch, ...] = ()
    unit: tuple[tuple[str, ...], ...] = ()
    name: str = ""

    @property
    def states(self) -> tuple[str, ...]:
        """Names of the states."""
        return self.law.states

    @cached_property
    def size(self) -> int:
        """Number of states."""
        return len(self.law.states)

    @property
    def system(self) -> System:
        """What engines integrate: the states, and a clock where the time stands in the rates."""
        return self.law.system

    @cached_property
    def unit_places(self) -> tuple[list[int], ...]:
        """Places of the states that have length one."""
        return tuple([self.states.index(name) for name in group] for group in self.unit)

    @cached_property
    def tape(self) -> Tape:
        """Everything that is read off the states: outputs first, then invariants."""
        terms = [*self.outputs.values(), *self.invariants.values()]
        flat = [part for term in terms for part in (term if isinstance(term, tuple) else (term,))]
        return Tape((*self.states, *self.law.parameters, self.law.time), tuple(flat))

    @cached_property
    def rate_tape(self) -> Tape:
        """The rates, over states, parameters and time."""
        names = (*self.states, *self.law.parameters, self.law.time)
        return Tape(names, tuple(self.law.rates.values()))

    def room(self, time: float, states: Sequence[Any], parameters: Mapping[str, Any]) -> float:
        """How far the motion is from where it stops; below zero it is there."""
        if self.law.stop is None:
            return math.inf
        values = [*states, *(parameters[name] for name in self.law.parameters), time]
        return self._stop_tape.floats([float(x) for x in values])[0]

    @cached_property
    def _stop_tape(self) -> Tape:
        return Tape((*self.states, *self.law.parameters, self.law.time), (self.law.stop,))

    def moved(
        self,
        start: Any = None,
        parameters: Mapping[str, Any] | None = None,
        switches: Any = None,
    ) -> Flow:
        """The same law from another start or with other numbers; nothing is compiled anew.

        Parameters
        ----------
        start
            name -> number for the states that change, or all numbers in order.
        parameters
            name -> number for the parameters that change.
        switches
            all switches anew.

        Examples
        --------
        >>> from geomtorsion.motion import flow
        >>> fall = flow({"z": "v", "v": "-g"}, [0, 1], parameters={"g": 9.81})
        >>> fall.moved(start={"v": 5}, parameters={"g": 1.6}).start
        (0, 5)
        """
        from geomtorsion.motion.flows import intake

        made = self
        if start is not None:
            made = replace(made, start=intake.start_numbers(self.states, start, self.start))
        if parameters is not None:
            numbers = intake.parameter_numbers(self.law.parameters, parameters)
            made = replace(made, parameters=dict(self.parameters) | numbers)
        if switches is not None:
            known = (*self.states, *self.law.parameters)
            made = replace(made, switches=intake.switch_list(known, switches))
        intake.check_unit(made)
        return made

    # -- showing --------------------------------------------------------------------------------

    @property
    def text(self) -> str:
        """The equations, line by line."""
        return "\n".join(f"{name}' = {rate}" for name, rate in self.law.rates.items())

    @property
    def latex(self) -> str:
        """The equations in LaTeX."""
        lines = [
            f"\\dot{{{sp.latex(sp.Symbol(name))}}} &= {sp.latex(rate)}"
            for name, rate in self.law.rates.items()
        ]
        return "\\begin{aligned}\n" + " \\\\\n".join(lines) + "\n\\end{aligned}"

    def _repr_latex_(self) -> str:
        return f"$${self.latex}$$"

    def __str__(self) -> str:
        return f"{self.name or 'flow'} of {', '.join(self.states)}"

    def __repr__(self) -> str:
        return str(self)

    # -- numbers --------------------------------------------------------------------------------

    def numbers_of(self, parameters: Mapping[str, Any]) -> list[Any]:
        """The run-time numbers of the system for values of the parameters."""
        if parameters is self.parameters or parameters == self.parameters:
            return self._own_numbers
        return self._exactly(parameters)

    @cached_property
    def _own_numbers(self) -> list[Any]:
        return self._exactly(self.parameters)

    def floats_of(self, numbers: Sequence[Any]) -> Any:
        """These numbers as floats; those of the flow itself are turned once."""
        return self._own_floats if numbers is self._own_numbers else [float(x) for x in numbers]

    @cached_property
    def _own_floats(self) -> Any:
        import numpy as np

        found = np.array([float(x) for x in self._own_numbers])
        found.flags.writeable = False
        return found

    @cached_property
    def start_floats(self) -> tuple[float, ...]:
        """The start as floats."""
        return tuple([float(x) for x in self.start])

    def _exactly(self, parameters: Mapping[str, Any]) -> list[Any]:
        return self.law.numbers.exactly([parameters[name] for name in self.law.parameters])

    def shapes(self, which: Mapping[str, Terms]) -> Sequence[tuple[str, int]]:
        """(name, components) of outputs or invariants; 0 components: one number."""
        return [(k, len(v) if isinstance(v, tuple) else 0) for k, v in which.items()]

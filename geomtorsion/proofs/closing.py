"""Closing: the equations that a closed orbit solves, in as many unknown numbers."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import sympy as sp
from flint import arb, arb_mat

from geomtorsion.codegen import Graph, graph
from geomtorsion.codegen.balls import BallCode, exact_ball
from geomtorsion.curves import CurveProblem
from geomtorsion.errors import ArgumentError, ProofError, UnknownNameError
from geomtorsion.exact import Field
from geomtorsion.ode import ODE, When
from geomtorsion.ode.terms import expression, symbol_table
from geomtorsion.support import checks
from geomtorsion.support.caching import cached_property

Exprs = Mapping[str, sp.Expr]


def real(name: str) -> sp.Symbol:
    """The symbol of a state or parameter."""
    return sp.Symbol(name, real=True)


def vanishes(term: sp.Expr) -> bool:
    """Whether an expression is zero, decided exactly; False where it is not decided."""
    symbols = sorted(term.free_symbols, key=str)
    return bool(Field(symbols).read(term).is_zero)


def as_ode(problem: object) -> ODE:
    """The first-order equations of a motion; a curve is written in its home chart.

    Constant velocities are parameters.

    Raises
    ------
    ArgumentError
        It is neither an ODE nor a curve with a start, or its equations change or depend on time.
    """
    if isinstance(problem, ODE):
        changes = problem.events or problem.is_switched or problem.rates.stops
        if changes or problem.normalized:
            raise ArgumentError(
                "problem: expected equations without events and without states of length one, got "
                f"{problem}. Restrict it to other states, problem.restricted([...]), or write it "
                "without them."
            )
        if problem.rates.has_clock:
            raise ArgumentError(
                f"problem: expected rates without the time {problem.rates.time}, got {problem.text}"
                ". Make the phase of the driving force a state."
            )
        return problem
    if not isinstance(problem, CurveProblem) or problem.start is None or problem.carried:
        raise ArgumentError(
            "problem: expected an ODE, or a curve with a start and without vectors carried along, "
            f"got {checks.shown(problem)}."
        )
    equations = problem.equations()
    if equations.clock:
        raise ArgumentError(
            "problem: expected a law without the curve parameter, got one with it. Make the phase "
            "of the force a coordinate."
        )
    return problem.to_ode(time="curve_parameter")


def density_of(problem: object) -> sp.Expr:
    """The density of the volume that a motion may keep: of phase space over q and u for a curve."""
    if not isinstance(problem, CurveProblem) or not problem.equations().moves:
        return sp.S.One
    frame = problem.frame
    matrix = sp.zeros(frame.dimension)
    for (i, mu), value in frame.coframe.components.nonzero.items():
        matrix[i, mu] = value.sympy
    return _real(matrix.det())


def _real(term: sp.Expr) -> sp.Expr:
    return term.xreplace({s: real(s.name) for s in term.free_symbols if isinstance(s, sp.Symbol)})


@dataclass(frozen=True, eq=False)
class Closing:
    """Conditions on a start x and a period T under which a motion is closed.

    problem: the equations; near: about the start, exact numbers.
    sections: expressions that vanish at the start.
    conserved: expressions that do not change, with the value that each has, or None for the value
        at `near`.
    mirrored: state -> value at its mirror; empty without a reversing symmetry.
    shift: state -> by how much it grows in one period; None where this is free.
    density: of a volume that the motion may keep.

    Without a symmetry, x(T) = x + shift, and a multiplier l of each conserved quantity I makes the
    equations as many as the unknowns: x' = f + sum l grad I [Galan, Munoz-Almaraz, Freire,
    Doedel, Vanderbauwhede 2003]. Along a closed motion I cannot grow, so that l = 0. With a
    symmetry, the start and the point at T/2 are their own mirror images.
    """

    problem: ODE
    near: tuple[Any, ...]
    sections: tuple[sp.Expr, ...]
    conserved: Mapping[sp.Expr, Any]
    mirrored: Exprs
    shift: Mapping[str, sp.Expr | None]
    density: sp.Expr = sp.S.One

    # -- names -----------------------------------------------------------------------------------

    @property
    def states(self) -> tuple[str, ...]:
        """All states."""
        return self.problem.states

    @property
    def closed(self) -> tuple[str, ...]:
        """States that have to return."""
        return tuple(x for x in self.states if x not in self.shift or self.shift[x] is not None)

    @property
    def free(self) -> tuple[str, ...]:
        """States whose start is unknown."""
        return tuple(name for name in self.closed if name not in self.mirrored)

    @cached_property
    def period_name(self) -> str:
        """A free name of the period."""
        return self._fresh("period")

    @cached_property
    def multiplier_names(self) -> tuple[str, ...]:
        """Free names of the multipliers of conserved quantities."""
        count = 0 if self.mirrored else len(self.conserved)
        return tuple(self._fresh(f"multiplier{k + 1}") for k in range(count))

    def _fresh(self, word: str) -> str:
        while word in self.problem.rates.names:
            word += "_"
        return word

    @property
    def unknowns(self) -> tuple[str, ...]:
        """Names of the unknown numbers."""
        return (*self.free, self.period_name, *self.multiplier_names)

    @cached_property
    def scaled(self) -> ODE:
        """The equations from time 0 to 1: one period, or half of it with a symmetry."""
        rates = self.problem.rates.expressions
        time = real(self.period_name) / (2 if self.mirrored else 1)
        added: dict[str, sp.Expr] = dict.fromkeys(rates, sp.S.Zero)
        for name, quantity in zip(self.multiplier_names, self.conserved, strict=False):
            for state in rates:
                added[state] += real(name) * sp.diff(quantity, real(state))
        parameters = {**self.problem.parameters, self.period_name: 1}
        parameters |= dict.fromkeys(self.multiplier_names, 0)
        return ODE.of(
            {name: time * (rate + added[name]) for name, rate in rates.items()},
            dict(zip(self.states, self.near, strict=True)), parameters=parameters,
            time=self._fresh("share"),
        )  # fmt: skip

    # -- checks ----------------------------------------------------------------------------------

    def check(self) -> None:
        """Refuse conditions that are not as many as the unknowns, or do not hold exactly.

        Raises
        ------
        ArgumentError
            A quantity is not conserved, equations have no such symmetry or period in a state, or
            conditions are too few or too many.
        """
        rates = self.problem.rates.expressions
        for quantity in self.conserved:
            change = sp.Add(*(sp.diff(quantity, real(x)) * rate for x, rate in rates.items()))
            if not vanishes(change):
                raise ArgumentError(
                    f"conserved: expected a quantity that is proved not to change, got {quantity}. "
                    "Drop it."
                )
        self._check_shift()
        self._check_mirror()
        equations = len(self.mirrored or self.closed) + len(self.sections) + len(self.conserved)
        missing = len(self.unknowns) - equations
        if missing:
            kind = "few" if missing > 0 else "many"
            remedy = (
                "Add a section that fixes the start, or a conserved quantity"
                if missing > 0
                else "Drop a section or a conserved quantity"
            )
            raise ArgumentError(
                f"section: expected {len(self.unknowns)} conditions for the unknowns "
                f"{', '.join(self.unknowns)}, got {equations}, which is too {kind}. {remedy}."
            )

    def _check_shift(self) -> None:
        rates = self.problem.rates.expressions
        loose = {name for name, x in self.shift.items() if x is None}
        terms = [*rates.values(), *self.conserved, *self.sections]
        bound = loose & {s.name for x in terms for s in x.free_symbols}
        if bound:
            raise ArgumentError(
                f"shift: expected a state on which nothing depends for None, got {min(bound)}. "
                "Give the number by which it grows in one period."
            )
        moved = {real(name): real(name) + x for name, x in self.shift.items() if x is not None}
        for term in [*rates.values(), *self.conserved]:
            if moved and not vanishes(term.xreplace(moved) - term):
                raise ArgumentError(
                    f"shift: expected a period of all rates and conserved quantities, got another "
                    f"value of {term}. Give a multiple of its period."
                )

    def _check_mirror(self) -> None:
        if not self.mirrored:
            return
        rates = self.problem.rates.expressions
        image = {real(x): 2 * value - real(x) for x, value in self.mirrored.items()}
        loose = {name for name, x in self.shift.items() if x is None}
        both = sorted(loose & self.mirrored.keys())
        if both:
            raise ArgumentError(
                f"symmetry: expected states that return, got {both[0]}, which need not return. "
                "Drop it from symmetry."
            )
        for name, rate in rates.items():
            # A state that need not return grows by the same amount in both halves.
            sign = -1 if name in self.mirrored or name in loose else 1
            if not vanishes(rate.xreplace(image) + sign * rate):
                raise ArgumentError(
                    "symmetry: expected states whose change of sign reverses the motion, got "
                    f"{', '.join(self.mirrored)}: {name}' = {rate} is not reversed. Give others, "
                    "or none."
                )

    @cached_property
    def keeps_volume(self) -> bool:
        """Whether the volume of the states that return is the same after one period.

        It is where div(density f) = 0, and the density is the same there.
        """
        rates, term = self.problem.rates.expressions, self.density
        moved = {real(name): real(name) + x for name, x in self.shift.items() if x is not None}
        if {s.name for s in term.free_symbols} - {*self.closed, *self.problem.parameters}:
            return False
        change = sp.Add(*(sp.diff(term * rates[x], real(x)) for x in self.closed))
        return vanishes(term.xreplace(moved) - term) and vanishes(change)

    # -- in balls --------------------------------------------------------------------------------

    def start(self, unknown: Sequence[arb]) -> tuple[Any, ...]:
        """The start of all states."""
        table: dict[str, Any] = dict(zip(self.free, unknown, strict=False))
        known = dict(zip(self.states, self.near, strict=True))
        return tuple(table.get(x, self.mirrored.get(x, known[x])) for x in self.states)

    def parameters(self, unknown: Sequence[arb]) -> dict[str, arb]:
        """The period, and the multipliers of conserved quantities."""
        names = (self.period_name, *self.multiplier_names)
        return dict(zip(names, unknown[len(self.free) :], strict=True))

    @cached_property
    def _conditions(self) -> tuple[Graph, Graph]:
        """Sections and conserved quantities over states and parameters, and their slopes."""
        arguments = (*self.states, *self.problem.rates.parameters)
        terms = [*self.sections, *self.conserved]
        values = graph(arguments, terms, factor=False)
        return values, values.derivative(self.free)

    def _arguments(self, start: Sequence[Any]) -> list[arb]:
        numbers = self.problem.parameters
        names = self.problem.rates.parameters
        return [exact_ball(x) for x in (*start, *(numbers[name] for name in names))]

    def gaps(self, unknown: Sequence[arb], end: Sequence[arb]) -> list[arb]:
        """By how much each condition fails, where the motion ends at `end`."""
        start = [exact_ball(x) for x in self.start(unknown)]
        at = {name: k for k, name in enumerate(self.states)}
        gaps = []
        for name in self.mirrored or self.closed:
            shift = exact_ball(self.shift.get(name) or 0)
            if self.mirrored:
                shift = shift / 2
            gaps.append(end[at[name]] - start[at[name]] - shift)
        values = BallCode(self._conditions[0]).real(self._arguments(start))
        gaps += values[: len(self.sections)]
        known = self._arguments(self.near)
        for k, value in enumerate(self.conserved.values(), len(self.sections)):
            target = BallCode(self._conditions[0]).real(known)[k] if value is None else value
            gaps.append(values[k] - exact_ball(target))
        return gaps

    def slopes(self, unknown: Sequence[arb], columns: Mapping[str, Sequence[arb]]) -> arb_mat:
        """The derivative of the gaps by the unknowns.

        columns: of the end, by each start and parameter.
        """
        at = {name: k for k, name in enumerate(self.states)}
        rows = [
            [columns[by][at[name]] - int(by == name) for by in self.unknowns]
            for name in self.mirrored or self.closed
        ]
        flat = BallCode(self._conditions[1]).real(self._arguments(self.start(unknown)))
        n = len(self.free)
        rest = [arb(0)] * (len(self.unknowns) - n)
        rows += [[*flat[k : k + n], *rest] for k in range(0, len(flat), n)]
        return arb_mat(rows)


def closing_of(
    problem: ODE,
    near: tuple[Any, ...],
    section: object,
    symmetry: object,
    conserved: object,
    shift: object,
) -> Closing:
    """The conditions from what users give, checked."""
    states = problem.states
    mirrored = _values(symmetry, "symmetry", states)
    loose = dict(shift) if isinstance(shift, Mapping) else {}
    if shift is not None and not isinstance(shift, Mapping):
        raise ArgumentError(f"shift: expected state -> number or None, got {checks.shown(shift)}.")
    moved = _values({k: x for k, x in loose.items() if x is not None}, "shift", states)
    free = {k: None for k, x in loose.items() if x is None}
    for name in free:
        checks.known_name(name, states, "shift", UnknownNameError, expected="a state")
    quantities = _conserved(problem, conserved)
    sections = sections_of(problem, section)
    closing = Closing(problem, near, sections, quantities, mirrored, {**moved, **free})
    if section is None and not mirrored:
        closing = Closing(
            problem, near, (_across(problem, near, closing.closed),), quantities, mirrored,
            closing.shift,
        )  # fmt: skip
    closing.check()
    return closing


def _values(given: object, subject: str, states: Sequence[str]) -> dict[str, sp.Expr]:
    """State -> exact number; a list of names gives each the value zero."""
    if given is None:
        return {}
    if not isinstance(given, Mapping):
        names = checks.entries(given, subject, ArgumentError)
        given = dict.fromkeys(names, 0)
    table = {}
    for name, value in given.items():
        checks.known_name(name, states, subject, UnknownNameError, expected="a state")
        table[str(name)] = expression(value, f"{subject}: {name}", {})
    return table


def _read(problem: ODE, entries: Sequence[object], subject: str) -> list[sp.Expr]:
    """Expressions over the states and parameters of a problem."""
    symbols = symbol_table((*problem.states, *problem.rates.parameters))
    return [expression(entry, subject, symbols) for entry in entries]


def sections_of(problem: ODE, section: object) -> tuple[sp.Expr, ...]:
    """Expressions that vanish on a surface, from text, expressions or When."""
    if section is None:
        return ()
    entries = section if isinstance(section, list | tuple) else [section]
    falls = [entry.falls if isinstance(entry, When) else entry for entry in entries]
    return tuple(_read(problem, falls, "section"))


def _conserved(problem: ODE, conserved: object) -> dict[sp.Expr, Any]:
    """Quantity -> its value, or None for the value near the start."""
    if isinstance(conserved, Mapping):
        names = list(conserved)
        values = list(conserved.values())
    else:
        entries = [conserved] if isinstance(conserved, str | sp.Expr) else conserved
        names = list(checks.entries(entries, "conserved", ArgumentError))
        values = [None] * len(names)
    terms = [problem.invariants.get(name, name) if isinstance(name, str) else name
             for name in names]  # fmt: skip
    read = _read(problem, terms, "conserved")
    numbers = [x if x is None else expression(x, "conserved", {}) for x in values]
    return dict(zip(read, numbers, strict=True))


def _across(problem: ODE, near: Sequence[Any], closed: Sequence[str]) -> sp.Expr:
    """The plane through a point at right angles to the motion there.

    Raises
    ------
    ProofError
        Nothing moves at the point.
    """
    values = dict(zip(map(real, problem.states), map(sp.Rational, near), strict=True))
    values |= {real(name): sp.Rational(x) for name, x in problem.parameters.items()}
    rates = {
        name: sp.Rational(float(problem.rates.expressions[name].xreplace(values)))
        for name in closed
    }
    if not any(rates.values()):
        raise ProofError(
            "expected a start near a closed orbit, got an equilibrium: nothing moves there. Start "
            "elsewhere."
        )
    return sp.Add(*(rate * (real(x) - values[real(x)]) for x, rate in rates.items()))

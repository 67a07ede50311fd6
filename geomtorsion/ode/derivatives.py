"""Derivatives: of a motion with respect to its parameters and its start, as further states."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
import sympy as sp

from geomtorsion.codegen import Graph, graph
from geomtorsion.errors import ExpressionError, StartError, UnknownNameError
from geomtorsion.ode.numbers import Real
from geomtorsion.ode.rates import Rates
from geomtorsion.ode.terms import At, Terms
from geomtorsion.support import checks
from geomtorsion.support.copies import ByContent

# What sympy writes where it knows no smooth derivative.
_UNSMOOTH = (sp.Derivative, sp.Subs, sp.DiracDelta)


def derivative_name(name: str, by: str) -> str:
    """The state that is the derivative of a state or output; r' is written rdot.

    Examples
    --------
    >>> derivative_name("r", "M"), derivative_name("r", "phi'")
    ('dr_dM', 'dr_dphidot')
    """
    return f"d{name}_d{by}".replace("'", "dot")


def checked_by(by: object, names: Sequence[str], what: str) -> tuple[str, ...]:
    """Different names of parameters and states, in the requested order.

    Raises
    ------
    UnknownNameError, StartError
        a name is unknown or repeated, or there is none.
    """
    entries = checks.entries(by, what, StartError)
    words = tuple(x.name if isinstance(x, sp.Symbol) else x for x in entries)
    kind = "names of parameters and of numbers at the start"
    for word in words:
        checks.known_name(word, names, what, UnknownNameError, expected=kind)
    if not words or len(set(words)) < len(words):
        raise StartError(
            f"{what}: expected different names, got {checks.shown(entries)}. Name each of them "
            "once."
        )
    return words


def derivative(term: sp.Expr, rows: Mapping[sp.Symbol, sp.Expr], where: str) -> sp.Expr:
    """Derivative of an expression along changes of its symbols: symbol -> its change.

    Raises
    ------
    ExpressionError
        it has none, as at a jump.
    """
    slopes = [sp.diff(term, symbol) * change for symbol, change in rows.items()]
    total = sp.Add(*slopes)
    if total.has(*_UNSMOOTH):
        raise ExpressionError(
            f"derivative of {where}: expected a smooth expression, got {term}. Write it without "
            "jumps, or omit the derivatives."
        )
    return total


@dataclass(frozen=True, eq=False)
class EventDerivative(ByContent):
    """How the times of events depend on a parameter, or on a number at the start.

    times: of the events, shape (m,). values: dt/dp of each, shape (m,). error: estimate of the
    largest error of the values. It is an array of the values for NumPy.
    """

    times: np.ndarray
    values: np.ndarray
    error: float

    def __array__(self, dtype: Any = None, copy: bool | None = None) -> np.ndarray:
        return np.array(self.values, dtype=dtype)


def term_slopes(
    term: sp.Expr, rates: Mapping[str, sp.Expr], by: str, clock: str, parameters: Sequence[str]
) -> tuple[sp.Expr, sp.Expr]:
    """Derivatives of a term by a parameter at a fixed time, and by the time.

    rates: state -> rate, of a motion with derivatives. parameters: those that occur in the term.

    Raises
    ------
    UnknownNameError
        The motion was solved without the derivatives.
    """
    symbols = {name: sp.Symbol(name, real=True) for name in (*rates, clock, by)}
    used = {symbol.name for symbol in term.free_symbols}
    across: dict[sp.Symbol, sp.Expr] = {symbols[by]: sp.S.One} if by in parameters else {}
    switch = f"acts_{by}"
    if across and switch in parameters:
        across[symbols[by]] = sp.Symbol(switch, real=True)
    for name in sorted(used & set(rates)):
        if derivative_name(name, by) not in rates:
            raise UnknownNameError(
                f"by: expected a motion with derivatives by {checks.shown(by)}, got one without a "
                f"derivative of {name}. Solve it with derivatives=[{by!r}]."
            )
        across[symbols[name]] = symbols[derivative_name(name, by)]
    along = {symbols[name]: rates[name] for name in rates if name in used}
    if clock not in rates:
        # A coordinate of that name is meant otherwise.
        along[symbols[clock]] = sp.S.One
    return derivative(term, across, "the term"), derivative(term, along, "the term")


@dataclass(frozen=True, eq=False)
class Motion:
    """Equations with a start; the fields are named as in `ODE`.

    variables: names of parameters and starts that may vary.
    """

    rates: Rates
    start: tuple[Real, ...]
    parameters: Mapping[str, Real]
    outputs: Mapping[str, Terms]
    events: tuple[At, ...]
    variables: tuple[str, ...]

    def derivatives(self, by: object) -> dict[str, Any]:
        """Fields with a state for the derivative of each state, and outputs for outputs.

        Equation
        --------
        (dx/dp)' = (df/dx) (dx/dp) + df/dp, with dx/dp = 1 at the start for p the start of x
        """
        rates = self.rates
        words = checked_by(by, self.variables, "derivatives")
        columns = [_Column(self, word) for word in words]
        self._check_new(columns)
        expressions, groups = dict(rates.expressions), list(rates.norm_groups)
        start, outputs, events = list(self.start), dict(self.outputs), self.events
        parameters: dict[str, Real] = dict(self.parameters)
        for column in columns:
            groups += [tuple(column.name(x) for x in group) for group in rates.norm_groups]
            start += [int(name == column.by) for name in rates.states]
            if column.switch:
                parameters[column.switch] = 1
            expressions |= column.rates()
            outputs |= column.outputs()
            events = tuple(column.event(event) for event in events)
        wide = Rates(
            expressions, tuple(parameters), rates.time, rates.stops, tuple(groups), rates.declared,
            domain=rates.domain,
        )  # fmt: skip
        fields = {"rates": wide, "start": tuple(start), "parameters": parameters}
        return {**fields, "outputs": outputs, "events": events, "varied": words}

    def _check_new(self, columns: Sequence[_Column]) -> None:
        """Refuse a derivative whose name is taken, as on a second call."""
        seen = {*self.rates.names, *self.outputs}
        for column in columns:
            names = [column.name(x) for x in (*self.rates.states, *self.outputs)]
            for name in [*names, *([column.switch] if column.switch else [])]:
                if name in seen:
                    raise ExpressionError(
                        f"derivatives: expected {name} to be free for a derivative, got a quantity "
                        "of this name. Rename it, or request all derivatives at once."
                    )
                seen.add(name)


class _Column:
    """Derivatives of everything by one parameter, or by one number at the start."""

    def __init__(self, problem: Motion, by: str) -> None:
        self.problem, self.by = problem, by
        changed = [event for event in problem.events if by in event.changes]
        # From such an event on the parameter has another value, which does not change with it.
        self.is_parameter = by in problem.rates.parameters
        self.switch = f"acts_{by}" if self.is_parameter and changed else ""
        self.rows: dict[sp.Symbol, sp.Expr] = {
            sp.Symbol(name, real=True): sp.Symbol(self.name(name), real=True)
            for name in problem.rates.states
        }
        if self.is_parameter:
            one = sp.Symbol(self.switch, real=True) if self.switch else sp.S.One
            self.rows[sp.Symbol(by, real=True)] = one

    def name(self, state: str) -> str:
        """The derivative of a state."""
        return derivative_name(state, self.by)

    def rates(self) -> dict[str, sp.Expr]:
        """Rates of the derivatives of all states."""
        return {
            self.name(state): derivative(rate, self.rows, f"the rate of {state}")
            for state, rate in self.problem.rates.expressions.items()
        }

    def outputs(self) -> dict[str, Terms]:
        """Derivatives of all outputs that are smooth."""
        table: dict[str, Terms] = {}
        for name, term in self.problem.outputs.items():
            parts = term if isinstance(term, tuple) else (term,)
            try:
                slopes = tuple(derivative(x, self.rows, name) for x in parts)
            except ExpressionError:
                continue
            table[self.name(name)] = slopes if isinstance(term, tuple) else slopes[0]
        return table

    def event(self, event: At) -> At:
        """The event with its effect on derivatives: a state with a new number has none."""
        more: dict[str, Real] = {
            self.name(name): 0
            for name, change in event.changes.items()
            if name in self.problem.rates.states and not isinstance(change, sp.Expr)
        }
        if self.switch and self.by in event.changes:
            more[self.switch] = 0
        return At(event.time, {**event.changes, **more})


def along(term: sp.Expr, rates: Mapping[str, sp.Expr], time: sp.Symbol) -> sp.Expr:
    """Rate of an expression along a motion: from the rates of the states, and the time.

    Examples
    --------
    >>> x, t = sp.symbols("x t", real=True)
    >>> along(t * x**2, {"x": -x}, t)
    -2*t*x**2 + x**2
    """
    total = sp.diff(term, time)
    for name, rate in rates.items():
        slope = sp.diff(term, sp.Symbol(name, real=True))
        if slope != 0:
            total += slope * rate
    return total


@dataclass(frozen=True, eq=False)
class Jump:
    """Effect of a change on states, parameters and derivatives of the states.

    Equation
    --------
    dx+/dp = dR/dp + (R' - f+) dt/dp with x+ = R(x-, p, t), R' along the motion before it, and
    dt/dp = -(dg/dp)/g' where g falls through zero (the saltation matrix); or the derivative of the
    time of the change.

    names: of states, parameters and the time. size: number of states without derivatives.
    fixed: name -> its new number. changed_names, changes: new values that depend on the motion.
    slopes: graph of all derivatives, over names and the rates of the states before and after.
    """

    names: tuple[str, ...]
    states: tuple[str, ...]
    size: int
    fixed: Mapping[str, Real]
    changed_names: tuple[str, ...]
    changes: Graph
    slopes: Graph | None

    @classmethod
    def of(
        cls,
        rates: Rates,
        varied: Sequence[str],
        changes: Mapping[str, Any],
        term: sp.Expr | None,
        level: sp.Expr | None,
    ) -> Jump:
        """Changes where a term reaches a level; without a term, the level is their time."""
        size = len(rates.states) // (1 + len(varied))
        own, derived = rates.states[:size], {*rates.states[size:]}
        changes = {name: x for name, x in changes.items() if name not in derived}
        moving = {name: x for name, x in changes.items() if isinstance(x, sp.Expr)}
        fixed = {name: x for name, x in changes.items() if name not in moving}
        made = graph(rates.names, list(moving.values()), factor=False)
        slopes = _slopes(rates, varied, own, changes, term, level) if varied else None
        return cls(rates.names, rates.states, size, fixed, tuple(moving), made, slopes)

    def changed(
        self, states: Sequence[Real], parameters: dict[str, Real], arguments: list[Real], bits: int
    ) -> tuple[list[Real], dict[str, Real]]:
        """New states and parameters, from all values just before."""
        new = dict(self.fixed)
        if self.changed_names:
            new |= zip(self.changed_names, self.changes.exactly(arguments, bits), strict=True)
        rows = [new.get(name, x) for name, x in zip(self.states, states, strict=True)]
        return rows, parameters | {name: x for name, x in new.items() if name in parameters}

    def derivatives(
        self,
        states: Sequence[Real],
        arguments: list[Real],
        before: Sequence[Real],
        after: Sequence[Real],
        bits: int,
    ) -> list[Real]:
        """New states with the derivatives behind the change.

        before, after: rates of the states on both sides, shape (size,).
        """
        assert self.slopes is not None
        slopes = self.slopes.exactly([*arguments, *before, *after], bits)
        return [*states[: self.size], *slopes]


def _slopes(
    rates: Rates,
    varied: Sequence[str],
    own: Sequence[str],
    changes: Mapping[str, Any],
    term: sp.Expr | None,
    level: sp.Expr | None,
) -> Graph:
    """Derivatives of all states behind a change, column after column."""
    time = sp.Symbol(rates.time, real=True)
    before = {name: sp.Symbol(f"before {name}", real=True) for name in own}
    after = {name: sp.Symbol(f"after {name}", real=True) for name in own}
    rows = []
    for by in varied:
        across = {
            sp.Symbol(name, real=True): sp.Symbol(derivative_name(name, by), real=True)
            for name in own
        }
        if by in rates.parameters:
            switch = f"acts_{by}"
            acts = sp.Symbol(switch, real=True) if switch in rates.parameters else sp.S.One
            across[sp.Symbol(by, real=True)] = acts
        shift: sp.Expr = sp.S.Zero
        if level is not None:
            shift = derivative(level, across, "the time of a change")
        if term is not None:
            gap = derivative(term, across, "a condition") - shift
            shift = -gap / along(term, before, time)
        for name in own:
            new = changes.get(name, sp.Symbol(name, real=True))
            if not isinstance(new, sp.Expr):
                new = sp.S.Zero
            moved = derivative(new, across, f"the change of {name}")
            rows.append(moved + (along(new, before, time) - after[name]) * shift)
    names = (*rates.names, *(f"before {x}" for x in own), *(f"after {x}" for x in own))
    return graph(names, rows, factor=False)

"""Derivatives: of a motion with respect to its parameters and its start, as further states."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
import sympy as sp

from geomtorsion.errors import ExpressionError, StartError, UnknownNameError
from geomtorsion.ode.numbers import Real
from geomtorsion.ode.rates import Rates
from geomtorsion.ode.terms import At, Terms
from geomtorsion.support import checks
from geomtorsion.support.copies import content_hash, equal_content

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
class EventDerivative:
    """How the times of events depend on a parameter, or on a number at the start.

    times: of the events, shape (m,). values: dt/dp of each, shape (m,). error: estimate of the
    largest error of the values. It is an array of the values for NumPy.
    """

    times: np.ndarray
    values: np.ndarray
    error: float

    def __eq__(self, other: object) -> bool:
        return equal_content(self, other)

    def __hash__(self) -> int:
        return content_hash(self)

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
            expressions, tuple(parameters), rates.time, rates.stop, tuple(groups), rates.declared
        )
        fields = {"rates": wide, "start": tuple(start), "parameters": parameters}
        return {**fields, "outputs": outputs, "events": events}

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
        """The event with what it does to derivatives: a state with a new value has none."""
        more: dict[str, Real] = {
            self.name(name): 0 for name in event.changes if name in self.problem.rates.states
        }
        if self.switch and self.by in event.changes:
            more[self.switch] = 0
        return At(event.time, {**event.changes, **more})

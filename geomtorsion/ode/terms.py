"""Terms: what users give as rates, outputs and events, as expressions over known names."""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from fractions import Fraction
from typing import Any, TypeAlias

import sympy as sp

from geomtorsion.codegen import graph
from geomtorsion.errors import ExpressionError, StartError, TimeError
from geomtorsion.exact import parse_expression
from geomtorsion.exact.element import Element
from geomtorsion.ode.numbers import Real
from geomtorsion.ode.pieces import FUNCTIONS, without_kinks, without_piecewise
from geomtorsion.support import checks

# An output is one expression, or several that make a vector.
Terms: TypeAlias = sp.Expr | tuple[sp.Expr, ...]
# Functions with kinks or jumps: pieces in rates and conditions. Only outputs may have steps too.
KINKED = {name: getattr(sp, name) for name in ("Abs", "sign", "Max", "Min", "Heaviside")}
KINKED |= {"abs": sp.Abs, "max": sp.Max, "min": sp.Min}
STEPS = {name: getattr(sp, name) for name in ("floor", "ceiling")}


def symbol_table(names: Iterable[str]) -> dict[str, sp.Symbol]:
    """A real symbol for every name.

    Raises
    ------
    ExpressionError
        a name occurs twice, or is invalid.
    """
    table: dict[str, sp.Symbol] = {}
    for name in names:
        if not isinstance(name, str) or not name.isidentifier():
            raise ExpressionError(
                f"expected a name of letters, digits and _, got {checks.shown(name)}."
            )
        if name in table:
            raise ExpressionError(
                f"{name}: expected different names of states, parameters and time, got it twice. "
                "Rename one of them."
            )
        table[name] = sp.Symbol(name, real=True)
    return table


def expression(
    entry: object,
    where: str,
    symbols: Mapping[str, sp.Symbol],
    *,
    smooth: bool = True,
    functions: Mapping[str, type[sp.Function]] | None = None,
) -> sp.Expr:
    """Text, a sympy expression, an exact element or a number, over the known symbols.

    smooth: whether Abs, sign, Max, Min and Heaviside become `pieces`, and floor and ceiling are
        refused in text.
    functions: further functions by name.

    Raises
    ------
    ExpressionError
        it is none of these, not finite, or contains a name that is not known.
    """
    if isinstance(entry, str):
        functions = {**FUNCTIONS, **KINKED, **({} if smooth else STEPS), **(functions or {})}
        parsed = parse_expression(entry, symbols, functions, where=where, decimals=True)
        return without_kinks(parsed) if smooth else parsed
    if isinstance(entry, Element):
        entry = entry.sympy
    if isinstance(entry, sp.Expr):
        whole = without_piecewise(_renamed(entry, where, symbols), where)
        return without_kinks(whole) if smooth else whole
    fraction = checks.fraction(entry)
    if fraction is None:
        raise ExpressionError(
            f"{where}: expected text, a sympy expression or a finite number, got "
            f"{checks.shown(entry)}."
        )
    return sp.Rational(fraction.numerator, fraction.denominator)


def _renamed(entry: sp.Expr, where: str, symbols: Mapping[str, sp.Symbol]) -> sp.Expr:
    """The expression over our own symbols, by name."""
    if entry.has(sp.nan, sp.zoo, sp.oo, -sp.oo):
        raise ExpressionError(f"{where}: expected a finite value, got {entry}.")
    checks.check_constant(entry)
    table = {}
    for symbol in entry.free_symbols:
        name = getattr(symbol, "name", str(symbol))
        kind, remedy = "a state, a parameter or the time", f"Give parameters={{{name!r}: ...}}."
        checks.known_name(name, symbols, where, ExpressionError, expected=kind, remedy=remedy)
        if symbols[name] != symbol:
            table[symbol] = symbols[name]
    return entry.xreplace(table) if table else entry


def number(value: Any, what: str) -> Real:
    """A finite real number, kept exact where it is.

    Raises
    ------
    StartError
        it is not a finite real number.
    """
    if isinstance(value, str):
        value = expression(value, what, {})
    if isinstance(value, Element):
        value = value.sympy
    if isinstance(value, sp.Rational):
        value = Fraction(int(value.p), int(value.q))
    return checks.exact_number(value, what, StartError)


@dataclass(frozen=True)
class At:
    """A change at a time: a parameter gets a new value, or a state is set to a new value.

    time: at which the change happens, 0 or later; a number, or an expression in the parameters,
        so that derivatives by these include the shift of the change.
    changes: name of a parameter or state -> its new number, or an expression (text or sympy) in the
        states, the parameters and the time just before the change.

    Examples
    --------
    >>> from geomtorsion.ode import ODE, solve
    >>> burn = ODE.of({"v": "a"}, [0], parameters={"a": 2, "T": 1}, events=[At("T", {"a": 0})])
    >>> solution = solve(burn, 3.0, derivatives=["T"])
    >>> solution["v"][-1].item(), solution["dv_dT"][-1].item()
    (2.0, 2.0)
    """

    time: Any
    changes: Mapping[str, Any] = field(default_factory=dict, hash=False)


@dataclass(frozen=True)
class When:
    """A condition: an expression changes from positive to negative.

    falls: the expression, text or sympy, in the states, the parameters and the time.
    changes: what happens then: name of a parameter or state -> its new number, or an expression in
        the states, the parameters and the time just before. Without changes the motion ends.

    A change that carries the expression from positive to negative also counts as a fall. The
    expression has to rise above zero again before it can fall again.

    Examples
    --------
    >>> from geomtorsion.ode import ODE, solve
    >>> fall = ODE.of({"z": "v", "v": "-g"}, {"z": 20, "v": 0}, parameters={"g": 10},
    ...               events=[When("z")])
    >>> solution = solve(fall, 5.0)
    >>> solution.outcome, round(float(solution.times[-1]), 9)
    ('stopped', 2.0)

    A ball that keeps half of its speed:

    >>> ball = ODE.of({"z": "v", "v": "-10"}, [20, 0], events=[When("z", {"v": "-v/2"})])
    >>> round(float(solve(ball, 3.0)["z"][-1]), 9)
    5.0
    """

    falls: Any
    changes: Mapping[str, Any] = field(default_factory=dict, hash=False)


def moments(events: Sequence[At], parameters: Mapping[str, Real]) -> list[tuple[At, int]]:
    """Events with their times as numbers, in order of time, each with its place in the list.

    Raises
    ------
    TimeError
        a time is not a number of 0 or more.
    """
    rows = []
    for k, event in enumerate(events):
        at = event.time
        if isinstance(at, sp.Expr):
            value = graph(tuple(parameters), [at]).exactly(list(parameters.values()), 73)[0]
            at = float(value) if not hasattr(value, "imag") or value.imag == 0 else math.nan
            if not (math.isfinite(at) and at >= 0):
                raise TimeError(
                    f"event: expected a time of 0 or later, got {event.time} = {at}. Give other "
                    "parameters."
                )
        rows.append((At(at, event.changes), k))
    return sorted(rows, key=lambda row: row[0].time)

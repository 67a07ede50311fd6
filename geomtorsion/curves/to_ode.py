"""To ODE: a curve in its home chart as first-order equations, with pieces, tables and events."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from typing import Any

import sympy as sp
from sympy.core.function import AppliedUndef

from geomtorsion.curves.equations import Equations
from geomtorsion.curves.forces import TIMES
from geomtorsion.ode.constructor import table_functions
from geomtorsion.ode.numbers import Real
from geomtorsion.ode.pieces import FUNCTIONS
from geomtorsion.ode.problem import ODE
from geomtorsion.ode.terms import At, When


def ode_of(
    equations: Equations,
    start: Mapping[str, Real],
    speeds: Mapping[str, Real],
    parameters: Mapping[str, Any],
    events: Iterable[At | When] = (),
    tables: Mapping[str, object] | None = None,
    time: str = "",
) -> ODE:
    """The equations of a curve as an ODE; see `CurveProblem.to_ode`.

    start, speeds: coordinate or frame velocity -> its number at the start.
    """
    functions = {**FUNCTIONS, **table_functions(tables, {})}
    rates = {name: _read(rate, functions) for name, rate in equations.expressions.items()}
    if equations.moves:
        start = {**start, **speeds}
    else:
        parameters = {**parameters, **speeds}
        for name in speeds:
            rates.pop(name, None)
    invariants = {
        name.replace(" ", "_"): sp.Add(
            *(
                sp.Mul(_read(c.sympy, functions), *(sp.Symbol(x, real=True) for x in names))
                for c, names in products
            )
        )
        for name, products in equations.invariants.items()
    }
    terms = [*rates.values(), *invariants.values()]
    used = {symbol.name for term in terms for symbol in term.free_symbols}
    listed = list(events)
    # Events may contain parameters that the equations do not.
    own = {name: x for name, x in parameters.items() if name in used or listed}
    names = {*rates, *own}
    clock = time or equations.clock or next(x for x in TIMES if x not in names)
    return ODE.of(
        rates, {name: start[name] for name in rates},
        parameters=own, invariants=invariants, time=clock, events=listed,
    )  # fmt: skip


def _read(term: sp.Expr, functions: Mapping[str, type[sp.Function]]) -> sp.Expr:
    """A term over real symbols, with pieces and tables for functions of their names."""

    def is_known(part: sp.Basic) -> bool:
        return isinstance(part, AppliedUndef) and part.func.__name__ in functions

    def slope(part: sp.Derivative) -> sp.Expr:
        # The exact field writes partial derivatives by the argument that is this symbol.
        symbol, order = part.variable_count[0]
        place, unknown = part.expr.args.index(symbol), sp.Dummy(real=True)
        arguments = [unknown if k == place else x for k, x in enumerate(part.expr.args)]
        made = functions[part.expr.func.__name__](*arguments)
        return sp.diff(made, unknown, order).xreplace({unknown: symbol})

    term = term.replace(lambda x: isinstance(x, sp.Derivative) and is_known(x.expr), slope)
    term = term.replace(is_known, lambda x: functions[x.func.__name__](*x.args))
    term = term.doit() if term.has(sp.Subs) else term
    symbols = {s for s in term.free_symbols if isinstance(s, sp.Symbol)}
    return term.xreplace({s: sp.Symbol(s.name, real=True) for s in symbols})

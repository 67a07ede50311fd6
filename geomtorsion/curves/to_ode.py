"""To ODE: a curve in its home chart as first-order equations, with pieces, tables and events."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import replace
from typing import Any

import sympy as sp
from sympy.core.function import AppliedUndef

from geomtorsion.curves.equations import Equations
from geomtorsion.curves.forces import TIMES
from geomtorsion.geometry.domain_edges import Edge
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
    edges: Iterable[Edge] = (),
) -> ODE:
    """The equations of a curve as an ODE; see `CurveProblem.to_ode`.

    start, speeds: coordinate or frame velocity -> its number at the start. edges: of the chart.
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
    domain = [(_read(edge.element.sympy, functions), edge.words) for edge in edges]
    terms = [*rates.values(), *invariants.values(), *(term for term, _ in domain)]
    used = {symbol.name for term in terms for symbol in term.free_symbols}
    listed = list(events)
    # Events may contain parameters that the equations do not.
    own = {name: x for name, x in parameters.items() if name in used or listed}
    names = {*rates, *own}
    clock = time or equations.clock or next(x for x in TIMES if x not in names)
    ode = ODE.of(
        rates, {name: start[name] for name in rates},
        parameters=own, invariants=invariants, time=clock, events=listed,
    )  # fmt: skip
    return replace(ode, rates=replace(ode.rates, domain=tuple(domain)))


def without_values(name: str) -> str:
    """The words to refuse a function in a force where a curve itself is solved."""
    if name in FUNCTIONS:
        return (
            "force: expected a smooth expression, got one in pieces, as with abs, max, sign or a "
            "table. The curve as first-order equations takes it: gt.solve(curve.to_ode(), t)."
        )
    return (
        f"force: expected an expression with values, got the function {name}. Give its rows: "
        f"table = gt.Table.of([(0, 0), (1, 2)]); gt.solve(curve.to_ode(tables={{{name!r}: table}}),"
        " t)."
    )


def _read(term: sp.Expr, functions: Mapping[str, type[sp.Function]]) -> sp.Expr:
    """A term over real symbols, with pieces and tables for functions of their names."""
    read = _with_functions(term, functions)
    symbols = {s for s in read.free_symbols if isinstance(s, sp.Symbol)}
    return read.xreplace({s: sp.Symbol(s.name, real=True) for s in symbols})


def _with_functions(part: sp.Basic, functions: Mapping[str, type[sp.Function]]) -> Any:
    """A part of a term with pieces and tables for functions of their names."""
    if not part.has(AppliedUndef):
        return part
    if isinstance(part, sp.Subs):
        places = [_with_functions(x, functions) for x in part.point]
        inner = _with_functions(part.expr, functions)
        return inner.xreplace(dict(zip(part.variables, places, strict=True)))
    if isinstance(part, sp.Derivative) and type(part.expr).__name__ in functions:
        # The exact field writes partial derivatives by the argument that is this symbol.
        symbol, order = part.variable_count[0]
        place, unknown = part.expr.args.index(symbol), sp.Dummy(real=True)
        arguments = [_with_functions(x, functions) for x in part.expr.args]
        arguments[place] = unknown
        made = functions[type(part.expr).__name__](*arguments)
        return sp.diff(made, unknown, order).xreplace({unknown: symbol})
    arguments = [_with_functions(x, functions) for x in part.args]
    if isinstance(part, AppliedUndef) and type(part).__name__ in functions:
        return functions[type(part).__name__](*arguments)
    return part.func(*arguments)

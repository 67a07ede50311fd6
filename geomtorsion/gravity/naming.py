"""Naming: unknown functions of invariants by the names of the invariants, f(T)."""

from __future__ import annotations

from collections.abc import Collection, Mapping

import sympy as sp
from sympy.core.function import AppliedUndef


def with_names(
    expression: sp.Expr, values: Mapping[str, sp.Expr], functions: Collection[object]
) -> sp.Expr:
    """The expression with names for values that are arguments of these unknown functions.

    Examples
    --------
    >>> x, T = sp.symbols("x T")
    >>> f = sp.Function("f")
    >>> with_names(x**2 * f(x**2).diff(x), {"T": x**2}, {f})
    2*x**3*Derivative(f(T), T)
    """
    listed = list(values.values())
    names = {
        value: sp.Symbol(name)
        for name, value in values.items()
        if listed.count(value) == 1 and not value.is_Symbol
    }

    def named(one: sp.Expr) -> sp.Expr:
        if isinstance(one, sp.Subs):
            points = [names.get(point, point) for point in one.point]
            inner = named(one.expr)
            # f(T, T) would not show which of its arguments a derivative is about.
            if inner.free_symbols.intersection(points) or len(set(points)) < len(points):
                return one
            return inner.subs(list(zip(one.variables, points, strict=True)))
        if isinstance(one, sp.Derivative):
            return one.func(named(one.expr), *one.variable_count)
        if one.func not in functions:
            return one
        return one.func(*(names.get(argument, argument) for argument in one.args))

    applied = expression.atoms(sp.Subs, AppliedUndef)
    return expression.xreplace({one: named(one) for one in applied})

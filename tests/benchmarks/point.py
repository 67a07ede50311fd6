"""Point: thirty digits of the Kretschmann scalar by a method that no contestant uses."""

from __future__ import annotations

from itertools import product

import sympy as sp
from sympy.core.function import AppliedUndef

from tests.benchmarks.cases import Case

_VALUES = {"r": sp.Integer(5), "M": sp.Integer(1), "mu": sp.Integer(2), "a": sp.Rational(1, 2)}
_DIGITS = 30


def _value(symbol: sp.Symbol) -> sp.Rational:
    """A value in every case's domain, from the name only: contestants make their own symbols."""
    spread = sum(map(ord, symbol.name)) % 17
    return _VALUES.get(symbol.name, sp.Rational(7 + spread, 19))


def _concrete(function: AppliedUndef) -> sp.Expr:
    """A polynomial without symmetries that replaces an unknown function."""
    rank = ord(function.func.__name__[0]) % 7
    quadratic = sum((k + 2) * q**2 for k, q in enumerate(function.args))
    return rank + 2 + quadratic / sp.Integer(11) + sp.prod(function.args) / sp.Integer(rank + 3)


def at_point(expression: sp.Expr) -> sp.Expr:
    """Value of an expression at the point; unknown functions are replaced."""
    functions = {f: _concrete(f) for f in expression.atoms(AppliedUndef)}
    closed = expression.subs(functions).doit()
    return closed.subs({s: _value(s) for s in closed.free_symbols}).evalf(_DIGITS)


def kretschmann_at_point(case: Case) -> sp.Expr:
    """R_abcd R^abcd from numbers only: g, dg and ddg at the point, then the definitions."""
    n, q = case.dimension, case.coordinates

    def number(matrix: sp.ImmutableMatrix) -> sp.Matrix:
        return matrix.applyfunc(at_point).as_mutable()

    g = number(case.metric)
    inverse = g.inv()
    dg = [number(case.metric.diff(a)) for a in q]
    ddg = [[number(case.metric.diff(a, b)) for b in q] for a in q]

    def first_kind(a: int, b: int, c: int) -> sp.Expr:
        return (dg[a][b, c] + dg[b][a, c] - dg[c][a, b]) / 2

    kind = [[[first_kind(a, b, c) for c in range(n)] for b in range(n)] for a in range(n)]

    def lower(a: int, b: int, c: int, d: int) -> sp.Expr:
        bent = (ddg[b][c][a, d] + ddg[a][d][b, c] - ddg[a][c][b, d] - ddg[b][d][a, c]) / 2
        for e, f in product(range(n), repeat=2):
            bent += inverse[e, f] * kind[b][c][e] * kind[a][d][f]
            bent -= inverse[e, f] * kind[b][d][e] * kind[a][c][f]
        return bent

    indices = list(product(range(n), repeat=4))
    down = {i: lower(*i) for i in indices}
    up = dict(down)
    for k in range(4):
        up = {
            i: sum(inverse[i[k], m] * up[(*i[:k], m, *i[k + 1 :])] for m in range(n))
            for i in indices
        }
    return sp.Add(*(down[i] * up[i] for i in indices)).evalf(_DIGITS)

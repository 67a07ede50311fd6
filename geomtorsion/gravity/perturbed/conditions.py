"""Conditions: signs of products as the fewest inequalities."""

from __future__ import annotations

from collections.abc import Iterable

import sympy as sp
from sympy.solvers.simplex import lpmax


def all_positive(expressions: Iterable[sp.Expr]) -> sp.Basic:
    """The condition that all expressions are positive, as the fewest inequalities.

    The signs of irreducible factors are unknowns of linear equations modulo two.

    Examples
    --------
    >>> t, r = sp.symbols("t r")
    >>> all_positive([-t / r, 1 / t])
    (t > 0) & (r < 0)
    >>> all_positive([t, -t])
    False
    """
    # Each equation: a set of factors whose signs multiply to + (False) or - (True).
    equations: list[tuple[frozenset[sp.Expr], bool]] = []
    for expression in expressions:
        factors, negative = _signs(expression)
        for pivot, others, turned in _pivots(equations):
            if pivot in factors:
                factors, negative = factors ^ others, negative ^ turned
        if not factors:
            if negative:
                return sp.false
            continue
        equations.append((factors, negative))
        equations.sort(key=lambda one: (len(one[0]), sp.default_sort_key(sp.Mul(*one[0]))))
        equations = _reduced(equations)
    if not _is_possible(equations):
        return sp.false
    return sp.And(*(_inequality(*one) for one in equations), evaluate=False)


def positive_roots(poly: sp.Poly, weight: sp.Expr) -> list[sp.Expr]:
    """Expressions that are positive where all roots are positive and so is a weight at each.

    Hermite: the traces of weight x^(i+j) and of weight x^(i+j+1) form positive definite matrices.

    Examples
    --------
    >>> x, b, c = sp.symbols("x b c")
    >>> [sp.factor(e) for e in positive_roots(sp.Poly(x**2 - b * x + c, x), sp.S.One)]
    [2, b**2 - 4*c, b, c*(b**2 - 4*c)]
    """
    x, n = poly.gen, poly.degree()
    companion = sp.zeros(n, n)
    for k in range(n):
        companion[k, n - 1] = -poly.nth(k) / poly.nth(n)
        if k:
            companion[k, k - 1] = 1
    powers = [sp.eye(n)]
    for _ in range(2 * n):
        powers.append((powers[-1] * companion).applyfunc(sp.cancel))
    top = sp.Poly(weight, x)
    value = sp.zeros(n, n)
    for (k,), c in top.terms():
        value += c * powers[k]
    traces = [sp.cancel((value * power).trace()) for power in powers]
    expressions = []
    for shift in (0, 1):
        for size in range(1, n + 1):
            form = sp.Matrix(size, size, lambda i, j, s=shift: traces[i + j + s])
            expressions.append(sp.factor(form.det()))
    return expressions


def positive_part(expression: sp.Expr) -> sp.Expr:
    """The shortest product that has the sign of an expression."""
    factors, negative = _signs(expression)
    whole = sp.Mul(*sorted(factors, key=sp.default_sort_key))
    return -whole if negative else whole


def _signs(expression: sp.Expr) -> tuple[frozenset[sp.Expr], bool]:
    """Factors to an odd power, whose first coefficient is positive, and whether a sign is left."""
    top, bottom = sp.fraction(sp.together(expression))
    odd: frozenset[sp.Expr] = frozenset()
    negative = False
    for part in (top, bottom):
        number, powers = sp.factor_list(part)
        negative ^= bool(number < 0)
        for factor, exponent in powers:
            if exponent % 2:
                odd ^= {factor}
    return odd, negative


def _is_possible(equations: list[tuple[frozenset[sp.Expr], bool]]) -> bool:
    """Whether the inequalities between single linear factors have a common solution."""
    rows = []
    for factors, negative in equations:
        if len(factors) == 1:
            (factor,) = factors
            if factor.is_polynomial() and sp.Poly(factor).total_degree() == 1:
                rows.append(-factor if negative else factor)
    if len(rows) < 2:
        return True
    least = sp.Dummy("least")
    best, _ = lpmax(least, [*(row >= least for row in rows), least <= 1])
    return best > 0


def _pivots(
    equations: list[tuple[frozenset[sp.Expr], bool]],
) -> list[tuple[sp.Expr, frozenset[sp.Expr], bool]]:
    """One factor of each equation that no other equation has, the longest one."""
    rows = []
    for factors, negative in equations:
        own = [f for f in factors if sum(f in other for other, _ in equations) == 1]
        longest = max(own or factors, key=lambda f: (sp.count_ops(f), sp.default_sort_key(f)))
        rows.append((longest, factors, negative))
    return rows


def _reduced(
    equations: list[tuple[frozenset[sp.Expr], bool]],
) -> list[tuple[frozenset[sp.Expr], bool]]:
    """Equations of which each has a factor that occurs in no other."""
    result = list(equations)
    for k in range(len(result)):
        factors, _ = result[k]
        pivot = max(factors, key=lambda f: (-sp.count_ops(f), str(f)))
        for j in range(len(result)):
            if j != k and pivot in result[j][0]:
                result[j] = (result[j][0] ^ factors, result[j][1] ^ result[k][1])
    return result


def _inequality(factors: frozenset[sp.Expr], negative: bool) -> sp.Basic:
    whole = sp.Mul(*sorted(factors, key=sp.default_sort_key))
    return sp.StrictLessThan(whole, 0) if negative else sp.StrictGreaterThan(whole, 0)

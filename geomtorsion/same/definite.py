"""Definite: a proof that an expression has one sign in a whole region, by positive symbols."""

from __future__ import annotations

from typing import Any

import sympy as sp

from geomtorsion.geometry.regions import Region


def definite_sign(expression: sp.Expr, region: Region) -> int | None:
    """The sign of an expression if it is proved for the whole region; None: not proved.

    A symbol between bounds is written with a positive symbol, such as r = 2 M + p. A polynomial
    with coefficients of one sign, in positive symbols and squares of others, has this sign.
    """
    shifted = _in_positive_symbols(expression, region)
    if shifted is None:
        return None
    number, factors = sp.factor_list(sp.fraction(sp.together(shifted))[0])
    below, divisors = sp.factor_list(sp.fraction(sp.together(shifted))[1])
    if not (number.is_real and below.is_real):
        return None
    sign = 1 if number * below > 0 else -1
    for factor, power in (*factors, *divisors):
        own = _sign(factor)
        if own is None and power % 2:
            return None
        sign *= 1 if power % 2 == 0 or own is None else own
    return sign


def _in_positive_symbols(expression: sp.Expr, region: Region) -> sp.Expr | None:
    """The expression with positive and real symbols, by the bounds of the region."""
    symbols = list(region.point)
    bounds = {s: _bounds(s, region) for s in symbols}
    for s in symbols:
        if bounds[s] == (0, sp.pi):
            expression = expression.subs(sp.sin(s), sp.Dummy("s", positive=True))
            expression = expression.subs(sp.cos(s), sp.Dummy("c", real=True))
    # A bound may contain a symbol that was replaced before.
    for _ in symbols:
        for s in symbols:
            if not expression.has(s):
                continue
            low, high = bounds[s]
            above = sp.Dummy("p", positive=True)
            if low is None and high is None:
                value: Any = sp.Dummy("x", positive=True) if s.is_positive else None
                value = value or sp.Dummy("x", real=True)
            elif high is None:
                value = low + above
            elif low is None:
                value = high - above
            else:
                value = low + (high - low) / (1 + above)
            expression = expression.subs(s, value)
    return None if expression.free_symbols & set(symbols) else expression


def _bounds(symbol: sp.Symbol, region: Region) -> tuple[Any, Any]:
    """The lower and the upper bound that relations of the region state for a symbol."""
    low = high = None
    for relation in region.relations:
        less, greater = getattr(relation, "lts", symbol), getattr(relation, "gts", symbol)
        if greater == symbol and not less.has(symbol):
            low = less if low is None else low
        elif less == symbol and not greater.has(symbol):
            high = greater if high is None else high
    return (0 if low is None and symbol.is_positive else low), high


def _sign(factor: sp.Expr) -> int | None:
    """The sign of a polynomial in positive symbols and squares of real ones."""
    polynomial = sp.Poly(factor)
    positive = [g.is_positive is True for g in polynomial.gens]
    if not all(g.is_real for g in polynomial.gens):
        return None
    signs = set[int]()
    for powers, number in polynomial.terms():
        squares = all(ok or power % 2 == 0 for ok, power in zip(positive, powers, strict=True))
        if not squares or not number.is_real:
            return None
        # A square may vanish, a product of positive symbols may not.
        signs.add(1 if number > 0 else -1)
    return signs.pop() if len(signs) == 1 else None

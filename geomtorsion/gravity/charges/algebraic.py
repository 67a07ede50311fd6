"""Algebraic: real roots of expressions with radicals, and expressions that vanish there."""

from __future__ import annotations

from dataclasses import dataclass

import sympy as sp
from flint import arb

from geomtorsion.codegen import balls, graph
from geomtorsion.support.precision import CONSTANT_BITS, ball_precision


@dataclass(frozen=True)
class Root:
    """An algebraic number, the value of a symbol.

    symbol: the symbol. value: a rational number, radicals, or a `CRootOf`. polynomial: its minimal
    polynomial. assumed: none, because all roots are known.
    """

    symbol: sp.Symbol
    value: sp.Expr
    polynomial: sp.Poly
    assumed: tuple[str, ...] = ()

    @property
    def ball(self) -> arb:
        """The root as a ball, in the precision of the context."""
        if not isinstance(self.value, sp.CRootOf):
            return balls.exact_ball(self.value)
        width = sp.Rational(1, 2**CONSTANT_BITS)
        return balls.exact_ball(self.value.eval_rational(width)) + arb(0, balls.exact_ball(width))

    def remainder(self, expression: sp.Expr) -> sp.Expr:
        """A polynomial in the symbol, without multiples of the one that vanishes."""
        return sp.rem(expression, self.polynomial.as_expr(), self.symbol)

    def vanishes(self, expression: sp.Expr) -> bool:
        """Whether an expression in the symbol vanishes at the root.

        The polynomial of all conjugates of its radicals must vanish; a ball then excludes the other
        conjugates.
        """
        above = sp.fraction(sp.together(expression))[0]
        if self.symbol not in above.free_symbols:
            return sp.simplify(above) == 0
        if self.value.is_Rational:
            return sp.simplify(above.subs(self.symbol, self.value)) == 0
        norm = polynomial_of(above, self.symbol)
        if norm is None or not norm.rem(self.polynomial).is_zero:
            return False
        if above.is_polynomial(self.symbol):
            return True
        code = balls.BallCode(graph([self.symbol.name], [above], factor=False))
        with ball_precision(CONSTANT_BITS):
            return bool(code.real([self.ball])[0].contains(0))


def centre(symbol: sp.Symbol) -> Root:
    """Zero, as the value of a symbol."""
    return Root(symbol, sp.S.Zero, sp.Poly(symbol, symbol))


def polynomial_of(expression: sp.Expr, symbol: sp.Symbol) -> sp.Poly | None:
    """A rational polynomial that vanishes where an expression does.

    Each radical w = P^(p/q) becomes a symbol, which the resultant with w^q - P eliminates. None for
    functions that are not algebraic, or further symbols.
    """
    relations: list[tuple[sp.Dummy, sp.Expr]] = []
    known: dict[sp.Expr, sp.Dummy] = {}

    def flat(part: sp.Expr) -> sp.Expr:
        if isinstance(part, sp.Pow) and part.exp.is_Rational and not part.exp.is_Integer:
            base = flat(part.base)
            key = base ** sp.Rational(1, part.exp.q)
            if key not in known:
                known[key] = sp.Dummy("w")
                relations.append((known[key], known[key] ** part.exp.q - base))
            return known[key] ** part.exp.p
        return part.func(*map(flat, part.args)) if part.args else part

    whole = sp.fraction(sp.together(flat(expression)))[0]
    for w, relation in reversed(relations):
        whole = sp.resultant(sp.fraction(sp.together(relation))[0], whole, w)
    if not whole.is_polynomial(symbol) or whole.free_symbols - {symbol} or whole == 0:
        return None
    polynomial = sp.Poly(whole, symbol)
    return polynomial if polynomial.domain in (sp.ZZ, sp.QQ) else None


def real_roots(expression: sp.Expr, symbol: sp.Symbol, *, positive: bool) -> list[Root] | None:
    """The real values of a symbol at which an expression vanishes, sorted; positive: only these.

    None for an expression that is not algebraic.
    """
    norm = polynomial_of(expression, symbol)
    if norm is None:
        return None
    roots = [
        Root(symbol, value, part)
        for part, _ in norm.factor_list()[1]
        for value in part.real_roots()
        if value.evalf() > 0 or not positive
    ]
    return sorted((x for x in roots if x.vanishes(expression)), key=lambda x: x.value.evalf())

"""Enclosed roots: positive real roots of expressions that are not algebraic, in balls."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from fractions import Fraction

import sympy as sp
from flint import arb

from geomtorsion.codegen import balls, graph
from geomtorsion.errors import GravityError
from geomtorsion.support import checks
from geomtorsion.support.allowance import check_limits
from geomtorsion.support.caching import cached_property
from geomtorsion.support.precision import CONSTANT_BITS, HALF, ball_precision

# Roots are searched between 2^-SPAN and 2^SPAN, where a ball has bits for a cube of the radius.
SPAN = CONSTANT_BITS // 4
# A root is separated after about CONSTANT_BITS halvings; a function with more roots oscillates.
MOST_PARTS = CONSTANT_BITS**2


@dataclass(frozen=True)
class EnclosedRoot:
    """A simple root of an expression, the value of a symbol.

    symbol: the symbol. expression: it vanishes at the root. low, high: the only root between them;
    the slope has one sign there.
    """

    symbol: sp.Symbol
    expression: sp.Expr
    low: Fraction
    high: Fraction

    @cached_property
    def _code(self) -> balls.BallCode:
        return _code(self.symbol, self.expression)

    @property
    def assumed(self) -> tuple[str, ...]:
        """Where roots were searched, in words."""
        return (f"horizons are searched between {self.symbol} = 2^-{SPAN} and 2^{SPAN}",)

    @property
    def value(self) -> sp.Expr:
        """A rational number near the root."""
        with ball_precision(CONSTANT_BITS):
            return sp.Rational(_fraction(self.ball))

    @property
    def ball(self) -> arb:
        """The root as a ball, in the precision of the context, by interval Newton."""
        root = balls.exact_ball(self.low).union(balls.exact_ball(self.high))
        while True:
            middle = root.mid()
            value, slope = self._code.real([middle])[0], self._code.real([root])[1]
            moved = (middle - value / slope).intersection(root)
            # Rounding: the ball is not halved any more.
            if not moved.rad() < root.rad() / 2:
                return moved
            root = moved

    def remainder(self, expression: sp.Expr) -> sp.Expr:
        """A polynomial in functions of the symbol, without multiples of the one that vanishes."""
        relation = sp.Poly(sp.fraction(sp.together(self.expression))[0])
        names = [x for x in relation.gens if x != self.symbol] or [self.symbol]
        main = min(names, key=lambda x: (relation.degree(x), str(x)))
        return sp.rem(expression, relation.as_expr(), main)

    def vanishes(self, expression: sp.Expr) -> bool:
        """Whether an expression in the symbol vanishes at the root.

        Raises
        ------
        GravityError
            It is not decided: a ball contains zero, and no multiple of the relation is found.
        """
        above = sp.fraction(sp.together(expression))[0]
        if self.symbol not in above.free_symbols:
            return sp.simplify(above) == 0
        with ball_precision(CONSTANT_BITS):
            if _has_sign(_code(self.symbol, above).real([self.ball])[0]):
                return False
        try:
            if self.remainder(above) == 0:
                return True
        except sp.PolynomialError:
            pass
        raise GravityError(
            f"horizons: expected values that are decided at {self.symbol} = "
            f"{float(self.value):.6g}, got {checks.cut(str(above))}, which may vanish there. Write "
            "the metric with a parameter instead of a number, and give parameters={...}."
        )


def _code(symbol: sp.Symbol, expression: sp.Expr) -> balls.BallCode:
    """The expression and its derivative in balls."""
    return balls.BallCode(graph([symbol.name], [expression, expression.diff(symbol)], factor=False))


def enclosed_roots(expression: sp.Expr, symbol: sp.Symbol) -> list[EnclosedRoot]:
    """The simple roots of an expression between 2^-SPAN and 2^SPAN, sorted.

    A ball of the expression without zero holds no root; a ball of its slope without zero holds one
    where the signs at both ends differ. Other parts are halved. Divided by its exponentials the
    expression has narrow balls where they are large.

    Raises
    ------
    GravityError
        Two roots cannot be separated, or the expression has no finite values.
    """
    above = sp.fraction(sp.together(expression))[0]
    codes = {form: _code(symbol, form) for form in _forms(above)}
    found: list[EnclosedRoot] = []
    count = 0
    with ball_precision(CONSTANT_BITS):
        parts = [(arb(2) ** (-SPAN), arb(2) ** SPAN)]
        while parts:
            check_limits()
            low, high = parts.pop()
            balls_of = {form: code.real([low.union(high)]) for form, code in codes.items()}
            if any(_has_sign(value) for value, _ in balls_of.values()):
                continue
            steep = {x: codes[x] for x, (_, slope) in balls_of.items() if _has_sign(slope)}
            monotonic = _monotonic(steep, low, high)
            if monotonic is not None:
                form, differ = monotonic
                if differ:
                    found.append(EnclosedRoot(symbol, form, _fraction(low), _fraction(high)))
                continue
            count += 1
            if count > MOST_PARTS:
                raise GravityError(
                    f"parameters: expected few horizons, got more than {len(found)} roots of "
                    f"{checks.cut(str(above))}, or values that vary too fast to separate them. "
                    "Give other numbers, or omit parameters for formulas in the radius."
                )
            if high < low * (1 + HALF):
                raise GravityError(
                    f"parameters: expected horizons at separate radii, got {symbol} = "
                    f"{float(low):.6g}, where two horizons meet or the metric has no value. Give "
                    "other numbers."
                )
            middle = (low * high).sqrt().mid()
            parts += [(middle, high), (low, middle)]
    return [x for x in found if _is_regular(x, expression)]


def _forms(above: sp.Expr) -> list[sp.Expr]:
    """An expression, and the same without its growing exponentials, if it has any."""
    if not above.has(sp.exp):
        return [above]
    whole = sp.Poly(above)
    powers = [x ** whole.degree(x) for x in whole.gens if x.has(sp.exp)]
    return [above, sp.expand(above / sp.Mul(*powers))]


def _monotonic(
    steep: Mapping[sp.Expr, balls.BallCode], low: arb, high: arb
) -> tuple[sp.Expr, bool] | None:
    """The first monotonic form with signs at both ends, and whether they differ; None without."""
    for form, code in steep.items():
        first, last = (code.real([x])[0] for x in (low, high))
        if _has_sign(first) and _has_sign(last):
            return form, (first > 0) != (last > 0)
    return None


def _has_sign(ball: arb) -> bool:
    """Whether a ball is on one side of zero."""
    return bool(ball.is_finite() and not ball.contains(0))


def _is_regular(root: EnclosedRoot, expression: sp.Expr) -> bool:
    """Whether the denominator of an expression has a value that is not zero at a root."""
    below = sp.fraction(sp.together(expression))[1]
    return root.symbol not in below.free_symbols or not root.vanishes(below)


def _fraction(value: arb) -> Fraction:
    mantissa, exponent = value.mid().man_exp()
    return Fraction(int(mantissa)) * Fraction(2) ** int(exponent)

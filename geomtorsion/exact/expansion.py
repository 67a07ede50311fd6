"""Expansion: limits and series of exact expressions, from their derivatives at a point."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from itertools import pairwise
from math import factorial, lcm
from typing import TYPE_CHECKING

import sympy
from sympy.core.function import AppliedUndef

from geomtorsion.errors import GeomtorsionError, SingularPointError, UndecidedError
from geomtorsion.support import checks
from geomtorsion.support.caching import cached_property
from geomtorsion.support.exclusive import exclusive

if TYPE_CHECKING:
    from collections.abc import Sequence

    from geomtorsion.exact.element import Element
    from geomtorsion.exact.field import Field

# Point for signs of roots and for checks of limits by sympy: so near that nothing else is as small,
# and far from the 1e-90 at which values lose all digits by cancellation.
NEAR = tuple(sympy.Rational(1, 10**digits) for digits in (30, 20, 10))


class _NotAnalyticError(Exception):
    """A derivative at the point has no finite value."""


@dataclass(frozen=True)
class Approach:
    """A symbol on its way to a point.

    symbol: what moves; point: where to, an expression without it, oo or -oo.
    side: 1 where it comes from above, -1 from below; at infinity that is the sign of the point.
    """

    symbol: sympy.Symbol
    point: sympy.Expr
    side: int

    @property
    def at_infinity(self) -> bool:
        """Whether the point is oo or -oo."""
        return bool(self.point.is_infinite)

    def place(self, distance: sympy.Expr) -> sympy.Expr:
        """Where the symbol is at a distance from the point; at infinity at one over it."""
        return self.side / distance if self.at_infinity else self.point + self.side * distance

    @property
    def distance(self) -> sympy.Expr:
        """The distance, or at infinity one over the symbol, as an expression of the symbol."""
        if self.at_infinity:
            return self.side / self.symbol
        return self.side * (self.symbol - self.point)

    def __str__(self) -> str:
        sides = {1: " from above", -1: " from below"}
        return f"{self.symbol} -> {self.point}{'' if self.at_infinity else sides[self.side]}"


@exclusive
class Expansion:
    """One expression near a point: a quotient of two sums of powers of the distance.

    field: in which the expression lives; it stays as it is.
    expression: to be expanded; name: what it is called in messages.
    approach: what moves, and where to.

    Examples
    --------
    >>> from geomtorsion.exact import Field
    >>> r, M = sympy.symbols("r M", positive=True)
    >>> far = Approach(r, sympy.oo, 1)
    >>> Expansion(Field([r, M]), sympy.sqrt(1 - 2 * M / r), far).series(2)
    -M**2/(2*r**2) - M/r + 1
    >>> Expansion(Field([r]), sympy.sin(r) / r, Approach(r, sympy.S.Zero, 1)).limit()
    1
    """

    def __init__(
        self, field: Field, expression: sympy.Expr, approach: Approach, name: str = ""
    ) -> None:
        self.expression = expression
        self.approach = approach
        self.name: str = f"{name} = {expression}" if name else str(expression)
        name, taken = "w", {symbol.name for symbol in field.symbols}
        while name in taken:
            name += "_"
        self._w = sympy.Symbol(name, positive=True)
        self._own, self._field = field, field.with_symbol(self._w, NEAR[0])
        # Coefficients are read apart: else a root of them may be written with a root that holds w.
        self._free = field.with_symbol(self._w, NEAR[0])

    @cached_property
    def _local(self) -> tuple[sympy.Expr, int]:
        """The expression in w, and the power of w that is the distance: with roots of it, none."""
        w = self._w
        place = self.approach.place(w)
        placed = self.expression.xreplace({self.approach.symbol: place})
        local = self._read(placed).sympy
        powers = [power.exp for power in local.atoms(sympy.Pow) if power.base == w]
        root = lcm(*(int(x.q) for x in powers if x.is_Rational))
        return (self._read(local.xreplace({w: w**root})).sympy if root > 1 else local), root

    def _parts(self) -> tuple[sympy.Expr, sympy.Expr]:
        """Numerator and denominator in w."""
        return sympy.fraction(sympy.together(self._local[0]))

    def _read(self, expression: sympy.Expr) -> Element:
        return self._field.read(expression)

    def _at_zero(self, element: Element) -> sympy.Expr:
        """The value of an element at w = 0."""
        # Not xreplace: the derivative of an unknown function is taken first.
        value = element.sympy.subs(self._w, 0)
        bad = value.has(sympy.zoo, sympy.nan, sympy.oo, -sympy.oo, sympy.AccumBounds)
        if bad or any(power.base == 0 for power in value.atoms(sympy.Pow)):
            raise _NotAnalyticError
        return value

    def _coefficients(self, expression: sympy.Expr) -> Iterator[Element]:
        """Coefficients of 1, w, w**2, ... of an expression that is analytic at w = 0."""
        element, order = self._read(expression), 0
        while True:
            yield self._free.read(self._at_zero(element) / factorial(order))
            element, order = element.diff(self._w), order + 1

    def _leading(self, expression: sympy.Expr) -> tuple[int, Element, Iterator[Element]]:
        """Order and value of the first coefficient that does not vanish, and all after it."""
        # A function that does not vanish has finitely many vanishing coefficients before it.
        coefficients = self._coefficients(expression)
        for order, coefficient in enumerate(coefficients):
            if coefficient.is_zero is None:
                raise UndecidedError(
                    f"whether {coefficient} vanishes cannot be decided, so the limit "
                    f"{self.approach} is not known. {checks.KNOWN_IDENTITIES}"
                )
            if not coefficient.is_zero:
                return order, coefficient, coefficients
        raise AssertionError("coefficients do not end")

    def limit(self) -> sympy.Expr:
        """The limit.

        Raises
        ------
        SingularPointError
            There is no limit: the expression grows without bound, or oscillates.
        UndecidedError
            It cannot be computed.
        """
        expression, _ = self._local
        if self._read(expression).is_zero:
            return sympy.S.Zero
        try:
            above, below = (self._leading(part)[:2] for part in self._parts())
        except _NotAnalyticError:
            return self._by_growth(expression)
        if above[0] < below[0]:
            raise self._grows()
        return (above[1] / below[1]).sympy if above[0] == below[0] else sympy.S.Zero

    def series(self, order: int) -> sympy.Expr:
        """The powers of the distance (of one over the symbol at infinity) up to an order.

        Raises
        ------
        SingularPointError
            The expression has no such series.
        """
        expression, root = self._local
        if self._read(expression).is_zero:
            return sympy.S.Zero
        try:
            above, below = (self._leading(part) for part in self._parts())
            return self._quotient(above, below, order * root, root)
        except _NotAnalyticError:
            raise SingularPointError(
                f"{self.name} has no series in powers at {self.approach}: derivatives grow "
                "without bound there. Expand at another point, or compute the limit."
            ) from None

    def _quotient(
        self,
        above: tuple[int, Element, Iterator[Element]],
        below: tuple[int, Element, Iterator[Element]],
        order: int,
        root: int,
    ) -> sympy.Expr:
        """The quotient of two power series, from its first power up to an order in w."""
        first, count = above[0] - below[0], order - (above[0] - below[0]) + 1
        tops, bottoms, coefficients = [above[1]], [below[1]], []
        terms = []
        for k in range(max(count, 0)):
            if k:
                tops.append(next(above[2]))
                bottoms.append(next(below[2]))
            rest = [(-1, bottoms[j], coefficients[k - j]) for j in range(1, k + 1)]
            coefficients.append(self._free.sum([(1, tops[k]), *rest]) / bottoms[0])
            power = self.approach.distance ** sympy.Rational(first + k, root)
            terms.append(coefficients[k].sympy * power)
        return sympy.Add(*terms)

    def _grows(self) -> SingularPointError:
        return SingularPointError(
            f"{self.name} grows without bound as {self.approach}: it has no limit. "
            "A series shows how it grows."
        )

    def _by_growth(self, expression: sympy.Expr) -> sympy.Expr:
        """The limit by comparing growths (Gruntz 1996), as sympy does it; checked by numbers."""
        undecided = UndecidedError(
            f"the limit of {self.name} as {self.approach} cannot be computed. Declare the "
            "domain of the frame, or take a simpler expression."
        )
        try:
            value = sympy.limit(expression, self._w, 0, "+")
        # sympy raises these if it finds no limit.
        except (NotImplementedError, ValueError, TypeError, sympy.PoleError):
            raise undecided from None
        if value.has(sympy.AccumBounds):
            raise SingularPointError(
                f"{self.name} does not settle as {self.approach}: it has no limit."
            )
        far = (sympy.oo, -sympy.oo, sympy.zoo)
        # An unknown function at infinity is not known to be large.
        if any(function.has(*far) for function in value.atoms(AppliedUndef)):
            raise undecided
        if value.has(*far):
            raise self._grows()
        if value.has(sympy.Limit, sympy.nan) or value.has(self._w):
            raise undecided
        try:
            gaps = [self._gap(expression, value, near) for near in reversed(NEAR)]
        except (GeomtorsionError, ArithmeticError, ValueError):
            raise undecided from None
        if not all(later < sooner or not later for sooner, later in pairwise(gaps)):
            raise undecided
        return self._free.read(value).sympy

    def _gap(self, expression: sympy.Expr, limit: sympy.Expr, near: sympy.Rational) -> sympy.Expr:
        """By how much an expression differs from its limit, near it."""
        field = self._own.with_symbol(self._w, near)
        return abs(field.sample.value(field.read(expression - limit)))


def limit(
    field: Field, expression: sympy.Expr, ways: Sequence[Approach], name: str = ""
) -> sympy.Expr:
    """The limit of an expression on every way to a point, if it is the same on all.

    Raises
    ------
    SingularPointError
        There is no limit, or it differs between ways.
    UndecidedError
        It cannot be computed.

    Examples
    --------
    >>> from geomtorsion.exact import Field
    >>> x = sympy.Symbol("x")
    >>> limit(Field([x]), (1 - sympy.cos(x)) / x**2, [Approach(x, sympy.S.Zero, 1)])
    1/2
    """
    if not expression.has(ways[0].symbol):
        return expression
    first, *others = (Expansion(field, expression, way, name).limit() for way in ways)
    for way, other in zip(ways[1:], others, strict=True):
        if field.read(first - other).is_zero is not True:
            raise SingularPointError(
                f"{name or 'the expression'} = {expression} has two limits: {first} as {ways[0]}, "
                f"{other} as {way}. Give the side, '+' or '-'."
            )
    return first

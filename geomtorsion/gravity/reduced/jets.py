"""Jets: unknown functions of one variable and their derivatives, as symbols of an exact field."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from fractions import Fraction

import sympy as sp
from sympy.core.function import AppliedUndef

from geomtorsion.errors import GravityError
from geomtorsion.exact import Element, Field
from geomtorsion.support import checks


@dataclass(frozen=True)
class Place:
    """A derivative of an unknown function. order: 0 for the function; symbol: its name."""

    function: AppliedUndef
    order: int
    symbol: sp.Symbol


class Jets:
    """Unknown functions of one variable with their derivatives, each a symbol.

    The function a(t) is the symbol a, its derivatives are a_1, a_2, ...

    variable: the coordinate on which the functions depend.
    functions: such as a(t).
    others: further symbols: parameters and the other coordinates.
    highest: the largest order of derivatives.

    Examples
    --------
    >>> t = sp.Symbol("t")
    >>> a = sp.Function("a")(t)
    >>> jets = Jets(t, [a], [], 2)
    >>> square = jets.read(a.diff(t) ** 2)
    >>> jets.derivative(square)
    Element(2*a_1*a_2)
    """

    def __init__(
        self,
        variable: sp.Symbol,
        functions: Sequence[AppliedUndef],
        others: Sequence[sp.Symbol],
        highest: int,
    ) -> None:
        self.variable = variable
        self.highest = highest
        self._places: dict[sp.Symbol, Place] = {}
        self._symbols: dict[tuple[AppliedUndef, int], sp.Symbol] = {}
        taken = {one.name for one in (variable, *others)}
        for function in functions:
            for order in range(highest + 1):
                name = jet_name(function, order)
                if name in taken:
                    raise GravityError(
                        f"{name}: expected one meaning, got a name and a derivative of {function}. "
                        "Rename the parameter or the function."
                    )
                taken.add(name)
                symbol = sp.Symbol(name, real=True)
                self._places[symbol] = Place(function, order, symbol)
                self._symbols[function, order] = symbol
        self.symbols = frozenset(self._places)
        self.field = Field([variable, *self._places, *others])

    def symbol(self, function: AppliedUndef, order: int) -> sp.Symbol:
        """The symbol of a derivative."""
        if order > self.highest:
            raise GravityError(
                f"reduce: expected equations that determine {function}, got none after {order} "
                f"derivatives. Give a condition, such as '{function} = 1'."
            )
        return self._symbols[function, order]

    def element(self, function: AppliedUndef, order: int) -> Element:
        """A derivative as an element."""
        return self.field.read(self.symbol(function, order))

    def places(self, element: Element) -> list[Place]:
        """The derivatives in an element, in the order of the functions."""
        symbols = element.symbols
        return [place for symbol, place in self._places.items() if symbol in symbols]

    def read(self, expression: sp.Expr) -> Element:
        """An expression in the unknown functions, over their symbols."""
        table: dict[sp.Expr, sp.Expr] = {}
        for (function, order), symbol in self._symbols.items():
            shown = sp.Derivative(function, (self.variable, order)) if order else function
            table[shown] = symbol
        written = expression.xreplace(table)
        left = written.atoms(AppliedUndef, sp.Derivative, sp.Subs)
        if left:
            name = min(map(str, left))
            raise GravityError(
                f"reduce: expected functions of {self.variable} only, got {name}. Choose this "
                "function, or make it depend on this variable only."
            )
        return self.field.read(written)

    def whole(self, element: Element) -> Element:
        """An element multiplied out."""
        return self.field.whole(element) if element.is_kept else element

    def derivative(self, element: Element) -> Element:
        """The total derivative with respect to the variable."""
        total = element.diff(self.variable)
        for place in self.places(element):
            slope = element.diff(place.symbol)
            total = total + slope * self.element(place.function, place.order + 1)
        return total

    def replaced(self, element: Element, values: Mapping[sp.Symbol, Element]) -> Element:
        """An element with values for symbols."""
        table = {symbol: value.sympy for symbol, value in values.items()}
        written = element.sympy.xreplace(table)
        if written.has(sp.zoo, sp.nan):
            raise GravityError(
                "reduce: expected equations that determine their highest derivatives, got ones "
                f"by which a leading coefficient vanishes, as in {checks.cut(str(element))}. Check "
                "the ansatz: a tetrad may need a spin connection, and conditions may contradict "
                "the equations."
            )
        return self.field.read(written)

    def coefficients(self, element: Element, symbol: sp.Symbol) -> list[Element] | None:
        """The coefficients of the powers of a symbol; None if there are other functions of it."""
        if not element.sympy.is_polynomial(symbol):
            return None
        parts, slope, factorial = list[Element](), element, 1
        while symbol in slope.symbols:
            parts.append(self.replaced(slope, {symbol: self.field.zero}) * Fraction(1, factorial))
            factorial *= len(parts)
            slope = slope.diff(symbol)
        return parts if slope.is_zero else [*parts, slope * Fraction(1, factorial)]


def jet_name(function: AppliedUndef, order: int) -> str:
    """a for a(t), a_1 for its derivative."""
    name = function.func.__name__
    if not name.isidentifier():
        raise GravityError(f"expected a function with a name, got {checks.shown(name)}. Rename it.")
    return f"{name}_{order}" if order else name

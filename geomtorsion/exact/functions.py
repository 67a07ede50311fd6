"""Functions: f(r) with its partial derivatives, and functions known only by name.

The partial derivatives of an unknown function are independent: each is a generator (a jet).
An opaque function, such as erf, has a derivative in the field but no relation that is known.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import sympy
from sympy.core.function import AppliedUndef

from geomtorsion.errors import ExpressionError
from geomtorsion.exact.generators import Generator
from geomtorsion.exact.special import NAMED

if TYPE_CHECKING:
    from collections.abc import Iterable, Sequence

    from geomtorsion.exact.element import Element
    from geomtorsion.exact.tower import Tower


def unknown_functions(elements: Iterable[Element]) -> list[AppliedUndef]:
    """The unknown functions that occur in elements, in the order of their text.

    Examples
    --------
    >>> from geomtorsion.exact import Field
    >>> t = sympy.Symbol("t")
    >>> unknown_functions([Field([t]).read(sympy.Function("a")(t).diff(t))])
    [a(t)]
    """
    functions = {f for element in elements for f in element.sympy.atoms(AppliedUndef)}
    return sorted(functions, key=str)


def smooth_form(expr: sympy.Expr) -> sympy.Expr | None:
    """A function rewritten by ones that are read, None if opaque.

    Raises
    ------
    ExpressionError
        the function has no derivative that sympy knows.
    """
    name = type(expr).__name__
    if name in ("asec", "acsc", "asech", "acsch"):
        partner = {"asec": sympy.acos, "acsc": sympy.asin, "asech": sympy.acosh,
                   "acsch": sympy.asinh}[name]  # fmt: skip
        return partner(1 / expr.args[0])
    if name == "sinc":
        return sympy.sin(expr.args[0]) / expr.args[0]
    for symbol in () if name in NAMED else expr.free_symbols:
        slope = expr.diff(symbol)
        if slope.has(sympy.Derivative, sympy.Subs) and not expr.has(sympy.Derivative, sympy.Subs):
            raise ExpressionError(f"{expr} has no derivative that is known exactly")
    return None


def jet(
    field: Tower,
    function: sympy.FunctionClass,
    orders: tuple[int, ...],
    arguments: tuple[Element, ...],
) -> Element:
    """The partial derivative of given orders of an unknown function at its arguments."""
    depends: frozenset[sympy.Symbol] | None = None
    for generator in field.generators:
        if generator.kind == "jet":
            other, old_orders, places = generator.argument
            if other.__name__ == function.__name__ and (other, places) == (function, arguments):
                if old_orders == orders:
                    return field.generator_element(generator)
                depends = generator.depends
    if depends is None:
        depends = frozenset().union(*(argument.symbols for argument in arguments))
    shown = _shown(function, orders, [argument.sympy for argument in arguments])
    name = field.next_name("jet")
    generator = Generator("jet", name, shown, depends, argument=(function, orders, arguments))
    return field.add(generator)


def _shown(
    function: sympy.FunctionClass, orders: tuple[int, ...], places: list[sympy.Expr]
) -> sympy.Expr:
    """The jet as sympy writes it: Derivative, within Subs where an argument is composite."""
    if not any(orders):
        return function(*places)
    variables, values = [], []
    slots: list[sympy.Expr] = []
    for k, place in enumerate(places):
        # f(x, x) has two derivatives: a slot that is not a lone symbol is named afresh.
        plain = place.is_Symbol and places.count(place) == 1
        slot = place if plain or not orders[k] else _fresh(f"xi_{k + 1}", places)
        if slot is not place:
            variables.append(slot)
            values.append(place)
        slots.append(slot)
    counts = [(slot, n) for slot, n in zip(slots, orders, strict=True) if n]
    # In the order into which diff puts symbols: equal ones are alike, without its search.
    counts.sort(key=lambda count: sympy.default_sort_key(count[0]))
    derivative = sympy.Derivative(function(*slots), *counts)
    return sympy.Subs(derivative, tuple(variables), tuple(values)) if variables else derivative


def _fresh(name: str, places: list[sympy.Expr]) -> sympy.Symbol:
    """A symbol that occurs in none of the places."""
    taken = {str(symbol) for place in places for symbol in place.free_symbols}
    while name in taken:
        name += "_"
    return sympy.Symbol(name)


def opaque(field: Tower, shown: sympy.Expr, arguments: Sequence[Element]) -> Element:
    """A generator with a value and a derivative only."""
    for generator in field.generators:
        if generator.kind == "opaque" and generator.shown == shown:
            return field.generator_element(generator)
    depends: frozenset[sympy.Symbol] = frozenset()
    for argument in arguments:
        depends |= argument.symbols
    name = field.next_name("opaque")
    return field.add(
        Generator("opaque", name, shown, depends, argument=tuple(arguments), sure=False)
    )

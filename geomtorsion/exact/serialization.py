"""Serialization: elements as JSON-ready mappings and back, through the whitelist parser."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import sympy

from geomtorsion.exact.functions import jet
from geomtorsion.exact.parsing import parse_expression

if TYPE_CHECKING:
    from collections.abc import Iterable, Mapping

    from geomtorsion.exact.element import Element
    from geomtorsion.exact.tower import Tower


def to_json(element: Element) -> dict[str, Any]:
    """The expression as text; jets at composite places are named apart."""
    field = element.field
    taken = {str(symbol) for symbol in field.symbols}
    shown, jets = element.sympy, {}
    for generator in field.generators_of(element):
        if generator.kind == "jet" and isinstance(generator.shown, sympy.Subs):
            function, orders, arguments = generator.argument
            name = f"jet_{len(jets) + 1}"
            while name in taken:
                name += "_"
            shown = shown.xreplace({generator.shown: sympy.Symbol(name)})
            jets[name] = {
                "function": str(function),
                "orders": list(orders),
                "arguments": [to_json(argument)["expression"] for argument in arguments],
            }
    return {"expression": str(shown), "jets": jets} if jets else {"expression": str(shown)}


def from_json(field: Tower, data: Mapping[str, Any], functions: Iterable[str]) -> Element:
    """The element that `to_json` wrote.

    Raises
    ------
    ExpressionError
        the text is not an expression in the symbols of the field and the functions named.
    """
    symbols = {str(symbol): symbol for symbol in field.symbols}
    table = {name: sympy.Function(name) for name in functions}
    places = {}
    for name, entry in data.get("jets", {}).items():
        head = table.setdefault(entry["function"], sympy.Function(entry["function"]))
        arguments = [
            field.read(parse_expression(text, symbols, table)) for text in entry["arguments"]
        ]
        element = jet(field, head, tuple(entry["orders"]), tuple(arguments))
        places[sympy.Symbol(name)] = element.sympy
    names = {**symbols, **{str(symbol): symbol for symbol in places}}
    shown = parse_expression(data["expression"], names, table)
    return field.read(shown.xreplace(places))

"""Opaque: smooth functions known only by name and derivative, and unproved constants."""

from __future__ import annotations

from typing import TYPE_CHECKING

from geomtorsion.exact.generators import Generator

if TYPE_CHECKING:
    from collections.abc import Sequence

    import sympy

    from geomtorsion.exact.element import Element
    from geomtorsion.exact.field import Field


def opaque(field: Field, shown: sympy.Expr, arguments: Sequence[Element]) -> Element:
    """A generator of which nothing is known but its value and its derivative."""
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

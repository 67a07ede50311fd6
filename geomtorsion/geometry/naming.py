"""Naming: the quantities of a frame that are printed by names, such as Sigma in Kerr's metric."""

from __future__ import annotations

from collections.abc import Mapping
from functools import partial

import sympy as sp

from geomtorsion.errors import ArgumentError, UndecidedError, UnknownNameError
from geomtorsion.exact import Field, Generator, parse_expression
from geomtorsion.exact.generators import Name, Names
from geomtorsion.exact.names import CONSTANTS, FUNCTIONS
from geomtorsion.exact.reading import counted_as
from geomtorsion.support import checks

Meanings = Mapping[sp.Symbol, sp.Expr]


def meanings(
    field: Field, before: Meanings, given: Mapping[str, object]
) -> dict[sp.Symbol, sp.Expr]:
    """Meaning of each name in coordinates and parameters, earlier names included."""
    taken = {s.name for s in field.symbols} | set(FUNCTIONS) | set(CONSTANTS)
    taken |= {str(g.argument[0]) for g in field.generators if g.kind == "jet"}
    quantities = dict(before)
    for name, value in given.items():
        if not name.isidentifier() or name in taken | {s.name for s in quantities}:
            raise ArgumentError(
                f"{name}: expected a new name, got one that is a coordinate, parameter or "
                "function, occurs twice, or is not a word. Choose another name."
            )
        symbols = {s.name: s for s in (*field.symbols, *quantities)}
        read = checks.expression(value, name, read=partial(_read, symbols, name))
        read = read.xreplace(counted_as(read.free_symbols, symbols.values()))
        others = sorted(str(s) for s in read.free_symbols - set(symbols.values()))
        if others:
            raise UnknownNameError(
                f"{name} = {read}: expected coordinates, parameters and earlier names, got "
                f"{', '.join(others)}. Known are {', '.join(symbols)}."
            )
        quantities[sp.Symbol(name)] = read.xreplace(quantities)
    return quantities


def _read(known: Mapping[str, sp.Symbol], name: str, text: str) -> sp.Expr:
    """A quantity that was given as text."""
    return parse_expression(text, known, where=name)


def names(field: Field, found: Meanings) -> Names:
    """The names as they are written, with exact elements.

    Raises
    ------
    ArgumentError
        A quantity is a number, such as zero, or too long to be multiplied out.
    UndecidedError
        Whether a quantity vanishes cannot be decided.
    """
    read = field.read_all((symbol.name, value) for symbol, value in found.items())
    written_names = []
    for symbol, element in zip(found, read, strict=True):
        whole = field.brief(element)
        if element.is_zero is None:
            raise UndecidedError(
                f"whether {symbol} = {found[symbol]} vanishes cannot be decided. "
                f"{checks.KNOWN_IDENTITIES}"
            )
        if whole is None or element.is_zero or not whole.symbols:
            raise ArgumentError(
                f"{symbol} = {checks.cut(str(found[symbol]))}: expected a short expression that "
                "depends on a coordinate or parameter, got a number or a long one. Write numbers "
                "directly."
            )
        generator = Generator("symbol", symbol.name, symbol, frozenset(whole.symbols))
        written_names.append(Name(generator, whole))
    return tuple(written_names)

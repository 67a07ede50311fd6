"""Twins: different symbols of one name, such as r and r with positive=True."""

from __future__ import annotations

from collections.abc import Iterable

import sympy

from geomtorsion.checks import ErrorClass, cut
from geomtorsion.errors import CoordinateError


def counted_as(
    symbols: Iterable[sympy.Basic],
    declared: Iterable[sympy.Symbol] = (),
    error: ErrorClass = CoordinateError,
) -> dict[sympy.Basic, sympy.Symbol]:
    """Which declared symbol each other one of its name counts as: {twin: declared symbol}.

    In one frame a name means one thing, whatever was assumed of it where it was written. Of two
    twins neither of which is declared, nobody knows which is meant: they are refused.

    Raises
    ------
    CoordinateError
        Two symbols share a name that is not declared, or is declared twice.

    Examples
    --------
    >>> r, twin = sympy.Symbol("r"), sympy.Symbol("r", positive=True)
    >>> counted_as([r, twin], declared=[r]) == {twin: r}
    True
    >>> counted_as([r, twin])
    Traceback (most recent call last):
    geomtorsion.errors.CoordinateError: two different symbols are called r: Symbol('r') and \
Symbol('r', positive=True). Create the symbol once and use it everywhere.
    """
    known = _by_name(declared, error)
    found: dict[sympy.Basic, sympy.Symbol] = {}
    others = []
    for symbol in symbols:
        if not isinstance(symbol, sympy.Symbol):
            continue
        own = known.get(symbol.name)
        if own is None:
            others.append(symbol)
        elif own != symbol:
            found[symbol] = own
    _by_name(others, error)
    return found


def _by_name(symbols: Iterable[sympy.Symbol], error: ErrorClass) -> dict[str, sympy.Symbol]:
    """Symbols by their names, each of which belongs to one only."""
    given = set(symbols)
    found = {symbol.name: symbol for symbol in given}
    if len(found) == len(given):
        return found
    found = {}
    # In an order that does not depend on where symbols lie in memory.
    for symbol in sorted(given, key=sympy.srepr):
        twin = found.setdefault(symbol.name, symbol)
        if twin != symbol:
            both = " and ".join(cut(sympy.srepr(one)) for one in (twin, symbol))
            raise error(
                f"two different symbols are called {cut(symbol.name)}: {both}. "
                "Create the symbol once and use it everywhere."
            )
    return found

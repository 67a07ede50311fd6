"""Entries: expressions as they are given, of parts that can be read, in symbols of one meaning."""

from __future__ import annotations

from collections.abc import Iterable
from fractions import Fraction
from typing import Any

import sympy

from geomtorsion.checks import ErrorClass, cut, plain, shown
from geomtorsion.errors import CoordinateError, ExpressionError

_NOT_SMOOTH = (
    "Abs", "sign", "floor", "ceiling", "frac", "Piecewise", "Max", "Min", "Heaviside",
    "DiracDelta", "re", "im", "arg", "conjugate", "Mod", "KroneckerDelta", "SingularityFunction",
)  # fmt: skip
_OPERATIONS = frozenset((sympy.Add, sympy.Mul, sympy.Pow))
_INFINITE = frozenset((sympy.oo, -sympy.oo, sympy.zoo, sympy.nan))
_REMEDIES = {
    "Abs": "choose the sign that holds in your domain (declare the symbol positive, or write x)",
    "Piecewise": "give one frame for each piece",
}


def checked(where: str, value: Any, declared: Iterable[sympy.Symbol] | None = None) -> sympy.Expr:
    """A sympy expression that consists of readable parts only.

    declared: symbols that it is written in, where it has others of the same names.

    Raises
    ------
    ExpressionError
        a part is a float, not smooth, infinite or no scalar; the message names it.
    CoordinateError
        two symbols share a name that is not declared.
    """
    if isinstance(value, bool) or value is None:
        raise ExpressionError(f"{where}: {shown(value)} is not an expression")
    if isinstance(value, Fraction):
        return sympy.Rational(value.numerator, value.denominator)
    if isinstance(value, int):
        return sympy.Integer(value)
    if isinstance(value, complex):
        raise ExpressionError(
            f"{where}: {value} is a complex floating-point number; write it exactly with sympy.I, "
            "and declare the frame with complex=True"
        )
    if isinstance(value, float):
        value = sympy.Float(value)
    if isinstance(value, str):
        raise ExpressionError(
            f"{where}: {shown(value)} is text; read text with geomtorsion.parse_expression first"
        )
    inner = plain(value)
    if inner is not value:
        return checked(where, inner, declared)
    if not isinstance(value, sympy.Expr):
        kind = "a relation" if isinstance(value, sympy.logic.boolalg.Boolean) else "no scalar"
        raise ExpressionError(f"{where}: {cut(str(value))} is {kind}; give one sympy expression")
    seen: set[sympy.Basic] = set()
    stack: list[sympy.Basic] = [value]
    while stack:
        part = stack.pop()
        if part in seen:
            continue
        seen.add(part)
        reason = _reason(part)
        if reason:
            of = "" if part == value else f" in {cut(str(value), 60)}"
            raise ExpressionError(f"{where}: {cut(str(part), 60)}{of} {reason}")
        stack.extend(part.args)
    if declared is None or not {part for part in seen if part.is_Symbol}.difference(declared):
        return value
    # Some of these may be bound, as in a derivative at a place.
    return value.xreplace(counted_as(value.free_symbols.difference(declared), declared))


def _reason(part: sympy.Basic) -> str:
    """Why a part cannot be read, or nothing."""
    if part.is_Rational or type(part) in _OPERATIONS:
        return ""
    if part.is_Float:
        exact = sympy.nsimplify(part, rational=True)
        return f"is a floating-point number; write it exactly, for example {exact}"
    if part in _INFINITE:
        return "is not a finite number"
    if isinstance(part, sympy.Integral | sympy.Sum | sympy.Product | sympy.Limit):
        return "is unevaluated; work it out, or use an unknown function with its derivative"
    if getattr(part, "is_Matrix", False) or isinstance(part, sympy.MatrixExpr):
        return "is a matrix; give its entries one by one"
    name = type(part).__name__
    if name in _NOT_SMOOTH:
        remedy = _REMEDIES.get(name, "replace it with a smooth expression valid in your domain")
        return f"is not smooth; {remedy}"
    if isinstance(part, sympy.Symbol) and part.is_commutative is False:
        return "does not commute; coordinates and parameters are numbers"
    return ""


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

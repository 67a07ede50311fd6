"""Terms: what users give as rates and outputs, as sympy expressions over known names."""

from __future__ import annotations

import math
import re
from collections.abc import Iterable, Mapping
from fractions import Fraction
from typing import Any

import sympy as sp

from geomtorsion.errors import ExpressionError, StartError
from geomtorsion.exact import parse_expression
from geomtorsion.exact.element import Element
from geomtorsion.exact.names import near_names

# Rationals p/q with smaller p and q are compiled in where q is a power of two: they are held
# exactly. All other numbers are given at run time: a check can tell what rounding them does.
SMALL = 64
# What may stand in outputs, but not in rates.
_KINKED = {name: getattr(sp, name) for name in ("Abs", "sign", "Max", "Min", "floor", "ceiling")}
_KINKED["abs"] = sp.Abs
_DECIMAL = re.compile(r"(?<![\w.])(\d+\.\d*|\.\d+|\d+(?=[eE][+-]?\d))(?:[eE]([+-]?\d+))?(?![\w.])")


def symbol_table(names: Iterable[str]) -> dict[str, sp.Symbol]:
    """A real symbol for every name.

    Raises
    ------
    ExpressionError
        a name occurs twice, or is none.
    """
    table: dict[str, sp.Symbol] = {}
    for name in names:
        if not isinstance(name, str) or not name.isidentifier():
            raise ExpressionError(f"{name!r} is no name; letters, digits and _ make one.")
        if name in table:
            raise ExpressionError(f"{name} is named twice: states, parameters and time differ.")
        table[name] = sp.Symbol(name, real=True)
    return table


def expression(
    entry: Any, where: str, symbols: Mapping[str, sp.Symbol], *, smooth: bool = True
) -> sp.Expr:
    """Text, a sympy expression, an exact element or a number, over the known symbols.

    smooth: whether Abs, sign, Max, Min, floor and ceiling are refused in text.

    Raises
    ------
    ExpressionError
        it is none of these, not finite, or contains a name that is not known.
    """
    if isinstance(entry, str):
        text = _DECIMAL.sub(_as_fraction, entry)
        return parse_expression(text, symbols, {} if smooth else _KINKED, where=where)
    if isinstance(entry, Element):
        entry = entry.sympy
    if isinstance(entry, sp.Expr):
        return _renamed(entry, where, symbols)
    if isinstance(entry, bool) or entry is None:
        raise ExpressionError(f"{where}: {entry!r} is no expression; give text, sympy or a number.")
    try:
        return sp.Rational(Fraction(entry.item() if hasattr(entry, "item") else entry))
    except (TypeError, ValueError, OverflowError):
        raise ExpressionError(
            f"{where}: {entry!r} is no expression and no finite number; give text, sympy or a "
            "number."
        ) from None


def _as_fraction(found: re.Match[str]) -> str:
    """A decimal number as the fraction that it is."""
    digits, exponent = found.group(1), int(found.group(2) or 0)
    whole, _, part = digits.partition(".")
    exponent -= len(part)
    if abs(exponent) > 400:
        return found.group(0)
    number = (whole + part).lstrip("0") or "0"
    return f"({number}*10**{exponent})" if exponent >= 0 else f"({number}/10**{-exponent})"


def _renamed(entry: sp.Expr, where: str, symbols: Mapping[str, sp.Symbol]) -> sp.Expr:
    """The expression over our own symbols, by name."""
    if entry.has(sp.nan, sp.zoo, sp.oo, -sp.oo):
        raise ExpressionError(f"{where}: {entry} is not finite.")
    table = {}
    for symbol in entry.free_symbols:
        name = getattr(symbol, "name", str(symbol))
        if name not in symbols:
            near = near_names(name, symbols)
            hint = f"Did you mean {near}? " if near else ""
            raise ExpressionError(
                f"{where}: {name} is no state, no parameter and not the time. {hint}"
                f"Known are {', '.join(symbols)}; give parameters={{{name!r}: ...}} for a number."
            )
        if symbols[name] != symbol:
            table[symbol] = symbols[name]
    return entry.xreplace(table) if table else entry


def number(value: Any, what: str) -> Any:
    """A finite real number, kept exact where it is.

    Raises
    ------
    StartError
        it is none.
    """
    if isinstance(value, str):
        value = expression(value, what, {})
    if (
        hasattr(value, "item")
        and not isinstance(value, sp.Basic)
        and getattr(value, "ndim", 0) == 0
    ):
        value = value.item()
    if isinstance(value, Element):
        value = value.sympy
    if isinstance(value, sp.Rational):
        value = Fraction(int(value.p), int(value.q))
    try:
        size = float(value)
    except (TypeError, ValueError, OverflowError):
        raise StartError(f"{what} = {value!r} is no number; give a finite real number.") from None
    if isinstance(value, bool) or not math.isfinite(size):
        raise StartError(f"{what} = {value!r} is not finite; give a finite real number.")
    return value


class Folding:
    """Puts everything that depends on parameters alone into numbers given at run time.

    What is left depends on the states; small fractions stay. The numbers are worked out exactly
    and rounded once, and one compiled integrator does for all of them.
    """

    def __init__(self, states: Iterable[sp.Symbol]) -> None:
        self.states = frozenset(states)
        self.names: dict[sp.Expr, sp.Symbol] = {}
        self._free: dict[sp.Basic, bool] = {}
        self._done: dict[sp.Expr, sp.Expr] = {}

    @property
    def definitions(self) -> tuple[sp.Expr, ...]:
        """What the numbers are, in order."""
        return tuple(self.names)

    def folded(self, expr: sp.Expr) -> sp.Expr:
        """The expression with its numbers named."""
        found = self._done.get(expr)
        if found is None:
            found = self._done[expr] = self._fold(expr)
        return found

    def _is_free(self, expr: Any) -> bool:
        """Whether no state occurs; each part is looked at once."""
        found = self._free.get(expr)
        if found is None:
            inside = all(self._is_free(arg) for arg in expr.args)
            found = self._free[expr] = inside and expr not in self.states
        return found

    def _fold(self, expr: Any) -> Any:
        if self._is_free(expr):
            return self._number(expr)
        if expr.is_Symbol:
            return expr
        if expr.is_Add or expr.is_Mul:
            free = [arg for arg in expr.args if self._is_free(arg)]
            bound = [self.folded(arg) for arg in expr.args if not self._is_free(arg)]
            if free:
                bound.append(self._number(expr.func(*free)))
            return expr.func(*bound)
        if expr.is_Pow:
            exponent = expr.exp
            if exponent.is_Float:
                exponent = sp.Rational(exponent)
            if exponent.is_Rational and abs(exponent.p) <= SMALL and exponent.q <= SMALL:
                return self.folded(expr.base) ** exponent
        return expr.func(*(self.folded(arg) for arg in expr.args))

    def _number(self, expr: Any) -> Any:
        value = sp.Rational(expr) if expr.is_Float else expr
        if value.is_Rational and abs(value.p) <= SMALL and value.q in (1, 2, 4, 8, 16, 32, 64):
            return value
        if value not in self.names:
            # With a blank in it no user can have given this name.
            self.names[value] = sp.Symbol(f"number {len(self.names) + 1}", real=True)
        return self.names[value]

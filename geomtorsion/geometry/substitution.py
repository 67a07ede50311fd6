"""Substitution: values for parameters and unknown functions, and the paths of a limit."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import partial
from typing import cast

import sympy as sp
from sympy.core.function import AppliedUndef, UndefinedFunction

from geomtorsion.errors import ArgumentError, CoordinateError, SingularPointError, UnknownNameError
from geomtorsion.exact import Field, parse_expression
from geomtorsion.exact.expansion import NEAR, Approach
from geomtorsion.exact.reading import checked, counted_as
from geomtorsion.support import checks

Value = sp.Expr | float | str
Values = Mapping[sp.Expr, Value] | Mapping[str, Value]
# Also as sympy's `subs` takes them: pairs, or one name before its value.
Replaced = Values | Sequence[tuple[sp.Expr | str, Value]] | sp.Expr | type[sp.Function] | str
INFINITE = (sp.oo, -sp.oo, sp.zoo, sp.nan)
_BY_NAME = {"oo": sp.oo, "+oo": sp.oo, "-oo": -sp.oo}
_SIDES: Mapping[object, tuple[int, ...]] = {None: (1, -1), "+": (1,), "-": (-1,)}


@dataclass(frozen=True)
class Substitution:
    """Replacements of symbols and functions by expressions.

    symbols: parameter -> value.
    functions: unknown function -> its value as a function of its arguments.
    """

    symbols: Mapping[sp.Symbol, sp.Expr]
    functions: Mapping[UndefinedFunction, sp.Lambda]

    def __call__(self, expression: sp.Basic) -> sp.Basic:
        """An expression or relation with the values in place, all at once."""
        replaced = expression.xreplace(dict(self.symbols))
        if self.functions:
            # One pass for all: a replacement may contain another symbol, which stays there.
            replaced = replaced.replace(
                lambda one: isinstance(one, AppliedUndef) and one.func in self.functions,
                lambda one: self.functions[one.func](*one.args),
            )
            # Derivatives of functions that were unknown before can be taken now.
            replaced = replaced.replace(_is_derivative, lambda one: one.doit())
        return replaced

    def value(self, expression: sp.Expr, where: str) -> sp.Expr:
        """An entry or component after the replacements.

        Raises
        ------
        SingularPointError
            It has no finite value then.
        """
        replaced = self(expression)
        if not isinstance(replaced, sp.Expr) or replaced.has(*INFINITE):
            raise SingularPointError(
                f"{where} = {expression} has no finite value with {self}. Give other values, or "
                "compute a limit: tensor.limit(symbol, value)."
            )
        return replaced

    def __hash__(self) -> int:
        return hash(frozenset([*self.symbols.items(), *self.functions.items()]))

    def __str__(self) -> str:
        pairs = [f"{symbol} = {value}" for symbol, value in self.symbols.items()]
        pairs += [f"{f}({v.signature}) = {v.expr}" for f, v in self.functions.items()]
        return ", ".join(pairs)


def replacements(values: Replaced, value: Value | None = None) -> Values:
    """Values by name, from a mapping, a list of pairs, or one name and its value.

    Examples
    --------
    >>> replacements("M", 2), replacements([("M", 2), ("a", 0)])
    ({'M': 2}, {'M': 2, 'a': 0})
    """
    if value is not None:
        return {cast("str", values): value}
    if isinstance(values, list | tuple) and all(
        isinstance(pair, list | tuple) and len(pair) == 2 for pair in values
    ):
        return cast("Values", dict(values))
    return cast("Values", values)


def _is_derivative(expression: sp.Basic) -> bool:
    return isinstance(expression, sp.Derivative | sp.Subs)


def substitution(values: Values, coordinates: Sequence[sp.Symbol], exact: Field) -> Substitution:
    """A checked substitution for everything in a field (see Frame.subs)."""
    parameters = [symbol for symbol in exact.symbols if symbol not in coordinates]
    functions = {g.argument[0] for g in exact.generators if g.kind == "jet"}
    names = {symbol.name: symbol for symbol in exact.symbols}
    constant: dict[sp.Symbol, sp.Expr] = {}
    lambdas: dict[UndefinedFunction, sp.Lambda] = {}
    for item, value in checks.table(values, "values").items():
        applied = _function_named(item, names, exact)
        # A name that is not in the field is refused below, as a parameter or function.
        key = _read(item, names, "values", free=True) if applied is None else applied
        name = f"the value of {checks.shown(item)}"
        put = _read(value, names, name, free=True)
        if put.has(*INFINITE):
            raise ArgumentError(
                f"{name}: expected a finite value, got {put}. For infinity compute a limit: "
                f"tensor.limit({key}, {put})."
            )
        checked(name, put)
        if isinstance(key, AppliedUndef):
            twins = counted_as([*key.free_symbols, *put.free_symbols], exact.symbols)
            applied = key.xreplace(twins)
            lambdas[key.func] = _function(applied, put.xreplace(twins), functions, coordinates)
        else:
            symbol = _parameter(key, item, parameters, coordinates)
            constant[symbol] = _constant(symbol, put, coordinates, exact.symbols)
    return Substitution(constant, lambdas)


def _function_named(
    given: object, names: Mapping[str, sp.Symbol], exact: Field
) -> AppliedUndef | None:
    """The unknown function, with its arguments, that its bare name refers to."""
    name = given.strip() if isinstance(given, str) else getattr(given, "__name__", None)
    if not isinstance(given, str | UndefinedFunction) or name in names:
        return None
    jets = [g.shown for g in exact.generators if g.kind == "jet"]
    unknown_functions = {
        one
        for shown in jets
        for one in shown.atoms(AppliedUndef)
        if str(one.func) == name and all(isinstance(x, sp.Symbol) for x in one.args)
    }
    if len(unknown_functions) > 1:
        listed = ", ".join(sorted(map(str, unknown_functions)))
        raise ArgumentError(
            f"values: expected one function with the name {name}, got {listed}. Write it with its "
            "arguments."
        )
    return unknown_functions.pop() if unknown_functions else None


def _read(
    value: object, names: Mapping[str, sp.Symbol], where: str, *, free: bool = False
) -> sp.Expr:
    """An expression, or text that this package's reader reads.

    free: whether other names in text are new parameters.
    """
    read = partial(parse_expression, symbols=names, where=where, free=free)
    return checks.expression(value, where, ArgumentError, read=read)


def _parameter(
    key: sp.Expr, given: object, parameters: Sequence[sp.Symbol], coordinates: Sequence[sp.Symbol]
) -> sp.Symbol:
    """The parameter that is meant."""
    if not isinstance(key, sp.Symbol):
        kind = "a parameter or an unknown function such as a(t) as a key"
        checks.refuse(ArgumentError, "values", kind, given)
    symbol = counted_as([key], [*coordinates, *parameters]).get(key, key)
    if symbol in coordinates:
        raise CoordinateError(
            f"values: expected parameters and functions, got the coordinate {symbol}. For values "
            f"at a point use tensor.at(...), for exact ones tensor.to_sympy().subs({symbol}, ...), "
            f"for a limit tensor.limit({symbol}, ...)."
        )
    if symbol not in parameters:
        others = [one.name for one in parameters if one.name != symbol.name]
        checks.known_name(symbol, others, "values", UnknownNameError, expected="a parameter")
    return symbol


def _constant(
    symbol: sp.Symbol, value: sp.Expr, coordinates: Sequence[sp.Symbol], known: Sequence[sp.Symbol]
) -> sp.Expr:
    """A value that a parameter can have."""
    value = value.xreplace(counted_as(value.free_symbols, known))
    varying = [str(one) for one in coordinates if one in value.free_symbols]
    varying += sorted(str(one) for one in value.atoms(AppliedUndef))
    if varying:
        raise CoordinateError(
            f"{symbol}: expected a value without coordinates for this parameter, got {value}, "
            f"which depends on {', '.join(varying)}. Make a new frame with the changed entries."
        )
    checks.check_declared(symbol, value)
    return value


def _function(
    key: AppliedUndef,
    value: sp.Expr,
    known: set[UndefinedFunction],
    coordinates: Sequence[sp.Symbol],
) -> sp.Lambda:
    """Value of an unknown function in terms of its arguments."""
    arguments = key.args
    if key.func not in known:
        names, kind = sorted(str(one) for one in known), "an unknown function of this tensor"
        checks.known_name(str(key.func), names, "values", UnknownNameError, expected=kind)
    if len(set(arguments)) < len(arguments) or not all(isinstance(x, sp.Symbol) for x in arguments):
        raise ArgumentError(
            f"values: expected different symbols as arguments, got {key}. Write it as a(t)."
        )
    others = [str(one) for one in coordinates if one in value.free_symbols - set(arguments)]
    if others:
        raise CoordinateError(
            f"{key}: expected a function of its own arguments, got {value}, which also depends on "
            f"{', '.join(others)}."
        )
    return sp.Lambda(arguments, value)


def approaches(
    symbol: object,
    point: object,
    side: object,
    domain: Sequence[sp.Basic],
    exact: Field,
) -> tuple[Approach, ...]:
    """The ways on which a symbol can go to a point (see Tensor.limit).

    Without a side both, except those outside of the domain or of the declared signs.
    """
    names = {one.name: one for one in exact.symbols}
    key = _read(symbol, names, "symbol")
    kind = "a coordinate or a parameter"
    if not isinstance(key, sp.Symbol):
        checks.refuse(ArgumentError, "symbol", kind, symbol)
    moving = counted_as([key], exact.symbols).get(key, key)
    if moving not in exact.symbols:
        others = [name for name in names if name != moving.name]
        checks.known_name(moving, others, "symbol", UnknownNameError, expected=kind)
    if not isinstance(side, str | None) or side not in _SIDES:
        sides = "'+' (from above), '-' (from below) or None"
        checks.refuse(ArgumentError, "side", sides, side)
    target = _target(point, names)
    target = target.xreplace(counted_as(target.free_symbols, exact.symbols))
    if moving in target.free_symbols or target.has(sp.nan, sp.zoo):
        raise ArgumentError(
            f"point: expected a limit of {moving} (a number, an expression without {moving}, oo or "
            f"-oo), got {target}."
        )
    if target in (sp.oo, -sp.oo):
        ways = [Approach(moving, target, 1 if target == sp.oo else -1)]
    else:
        checked("point", target)
        ways = [Approach(moving, target, one) for one in _SIDES[side]]
    inside = tuple(way for way in ways if _is_inside(way, domain))
    if not inside:
        raise CoordinateError(
            f"{ways[0]} leads out of the domain, or contradicts the assumptions on {moving}. Give "
            "another point or side."
        )
    return inside


def _target(point: object, names: Mapping[str, sp.Symbol]) -> sp.Expr:
    """Limit point of a symbol: an expression, or infinity by name or as a float."""
    if isinstance(point, str) and point.strip() in _BY_NAME:
        return _BY_NAME[point.strip()]
    if isinstance(point, float) and math.isinf(point):
        return sp.oo if point > 0 else -sp.oo
    return _read(point, names, "point")


def _is_inside(way: Approach, domain: Sequence[sp.Basic]) -> bool:
    """Whether a position next to the point may be in the domain and have the declared sign."""
    place = way.place(NEAR[0])
    inside = all(x.xreplace({way.symbol: place}) != sp.false for x in domain)
    return inside and not checks.against(way.symbol, place)

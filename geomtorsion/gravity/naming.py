"""Naming: unknown functions of invariants by the names of the invariants, f(T) and f'(T)."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass

import sympy as sp
from sympy.core.function import AppliedUndef

from geomtorsion.exact import Element, Field, Generator, Truncated, TruncatedField
from geomtorsion.gravity.lagrangian import Reading


@dataclass(frozen=True)
class Call:
    """A call of an unknown function in a Lagrangian.

    function: the function.
    names: its arguments as they are written, T or T_0.
    values: the same as exact elements.
    """

    function: object
    names: tuple[sp.Expr, ...]
    values: tuple[Element, ...]


def jet_names(generators: Iterable[Generator], calls: Sequence[Call]) -> dict[sp.Basic, sp.Expr]:
    """Unknown functions at the values of invariants, as sympy writes them -> by their names.

    Values are compared exactly. An argument that is a number or a symbol keeps its value, and so
    does one that occurs twice, because f(T, T) would not show which derivative is meant.
    """
    result: dict[sp.Basic, sp.Expr] = {}
    for generator in generators:
        if generator.kind != "jet":
            continue
        function, orders, places = generator.argument
        for call in calls:
            if call.function != function or call.values != places:
                continue
            arguments = [
                name if value.symbols and places.count(value) == 1 else value.sympy
                for name, value in zip(call.names, places, strict=True)
            ]
            slopes = [(x, k) for x, k in zip(arguments, orders, strict=True) if k]
            if all(x.is_Symbol for x, _ in slopes):
                applied = call.function(*arguments)  # type: ignore[operator]
                result[generator.shown] = sp.Derivative(applied, *slopes) if slopes else applied
                break
    return result


def calls_of(reading: Reading, field: Field | TruncatedField) -> list[Call]:
    """Calls of unknown functions; in a series they are taken at order zero, f(T_0)."""
    calls = []
    for one in sorted(reading.expression.atoms(AppliedUndef), key=str):
        names, values = one.args, tuple(map(reading.element, one.args))
        if isinstance(field, TruncatedField):
            zero = {x: sp.Symbol(f"{x.name}_0") for x in reading.symbols}
            names = tuple(x.xreplace(zero) for x in names)
            values = tuple(x.parts[0] for x in values if isinstance(x, Truncated))
        calls.append(Call(one.func, names, values))
    return calls

"""Validation: user input for equations of motion, checked once and read exactly."""

from __future__ import annotations

import re
from collections.abc import Iterable, Mapping, Sequence
from typing import Any

import sympy as sp
from sympy.core.function import AppliedUndef

from geomtorsion.action.tangent_bundle import MotionSymbols, symbols_of
from geomtorsion.errors import ConstraintError, LagrangianError, ShapeError
from geomtorsion.exact import parse_expression
from geomtorsion.exact.reading import counted_as
from geomtorsion.geometry import Connection, Frame
from geomtorsion.geometry.connections import ConnectionLike, FrameLike, as_connection, as_frame
from geomtorsion.geometry.homes import over_frame
from geomtorsion.geometry.validation import free_symbols, named_symbols
from geomtorsion.support import checks
from geomtorsion.support.checks import near_names

Named = list[tuple[str, object]]


def force_entries(forces: object, n: int) -> Named:
    """F_k as n named entries, from a sequence of n or a mapping k -> F_k; none are zero.

    Raises
    ------
    ShapeError
        There are not n of them, or a number in the mapping is not among 0 ... n - 1.
    """
    if forces is None:
        table: Mapping[object, object] = {}
    elif isinstance(forces, Mapping):
        table = forces
    else:
        values = _listed(forces, "forces")
        remedy = f"Give {n}, or a mapping such as {{0: 'M1'}}."
        checks.check_one_each(values, n, "forms of the frame", "forces", ShapeError, remedy)
        table = dict(enumerate(values))
    wrong = [key for key in table if key not in range(n)]
    if wrong:
        raise ShapeError(
            f"forces: expected components from 0 to {n - 1}, one for each form of the frame, got "
            f"{checks.shown(wrong[0])}."
        )
    return [(f"forces[{k}]", table.get(k, 0)) for k in range(n)]


def constraint_entries(constraints: object, n: int) -> Named:
    """The constraints, each an expression that stays zero, named for messages.

    Raises
    ------
    ConstraintError
        There are as many as velocities, or more: nothing would move.
    """
    values = [] if constraints is None else _listed(constraints, "constraints")
    if len(values) >= n:
        raise ConstraintError(
            f"constraints: expected fewer than the {n} velocities, got {len(values)}, so that "
            "nothing could move. Omit some."
        )
    return [(f"constraints[{r}]", value) for r, value in enumerate(values)]


def _listed(values: object, what: str) -> list[Any]:
    rows = checks.entries(values, what, ShapeError)
    return [row[0] if isinstance(row, list) and len(row) == 1 else row for row in rows]


def checked_frame(
    frame: FrameLike, connection: ConnectionLike | None, *, complex_too: bool = False
) -> tuple[Frame, Connection | None]:
    """Frame and connection; refuses a connection of another frame, and complex frames."""
    frame = as_frame(frame)
    home = None
    if connection is not None:
        home = over_frame(frame, as_connection(connection), "connection", ShapeError)
    if frame.complex and not complex_too:
        raise LagrangianError(
            f"expected a real frame for mechanics, got {frame.name or 'one'}, which is complex (a "
            "null tetrad). Use a real frame of the same metric."
        )
    return frame, home


def expressions(
    frame: Frame,
    entries: Sequence[tuple[str, object]],
    parameters: Iterable[sp.Symbol | str] | None,
) -> list[sp.Expr]:
    """Texts, numbers or sympy expressions in q, u, t and parameters as sympy expressions.

    Symbols are known by their names. In a sympy expression every other symbol is a parameter
    unless parameters are listed; in a text it must be listed, or occur in such an expression.

    Raises
    ------
    LagrangianError
        A symbol is none of these, or cannot be one (u7 where there are three velocities).
    ExpressionError
        A text is not an expression.
    """
    symbols = symbols_of(frame)
    own = (*frame.coordinates, *frame.parameters, symbols.time, *symbols.velocities)
    table = {symbol.name: symbol for symbol in own}
    listed = named_symbols(() if parameters is None else parameters, what="parameter")
    for symbol in listed:
        if symbol.name in {s.name for s in (*symbols.rates, *symbols.accelerations)}:
            _check_parameter("parameters", symbol.name, symbols, table, True)
        table.setdefault(symbol.name, symbol)
    read: dict[str, sp.Expr] = {}
    counted_as(free_symbols([x for _, x in entries]), table.values(), LagrangianError)
    for where, value in entries:
        if not isinstance(value, str):
            expression = read[where] = _sympified(where, value)
            for symbol in sorted(expression.free_symbols, key=str):
                if symbol.name not in table:
                    _check_parameter(where, symbol.name, symbols, table, parameters is not None)
                    table[symbol.name] = symbol
            renamed = {symbol: table[symbol.name] for symbol in expression.free_symbols}
            read[where] = expression.xreplace(renamed)
            _check_functions(where, expression, table)
    for where, value in entries:
        if isinstance(value, str):
            read[where] = parse_expression(value, table, where=where)
    return [read[where] for where, _ in entries]


def _sympified(where: str, value: object) -> sp.Expr:
    """A number, element or expression of sympy; never a text."""
    kind, remedy = "an expression", "Give text, a number or a sympy expression."
    return checks.expression(value, where, LagrangianError, expected=kind, remedy=remedy)


def _check_functions(where: str, expression: sp.Expr, table: Mapping[str, sp.Symbol]) -> None:
    """Refuse phi1(t) for the coordinate phi1: it would count as a given function of the time."""
    for function in sorted(expression.atoms(AppliedUndef), key=str):
        name = type(function).__name__
        if name in table:
            raise LagrangianError(
                f"{where}: expected the symbol {name}, got the function {function}. Write {name}, "
                "and instead of derivatives the velocities u^i = e^i_mu q'^mu."
            )


def _check_parameter(
    where: str, name: str, symbols: MotionSymbols, table: Mapping[str, sp.Symbol], listed: bool
) -> None:
    """Refuse a symbol that cannot be a parameter."""
    stem = symbols.velocities[0].name.rstrip("0123456789")
    velocity = bool(re.fullmatch(rf"{stem}\d+", name))
    rate = any(name == s.name for s in (*symbols.rates, *symbols.accelerations))
    if not (listed or velocity or rate):
        return
    near = near_names(name, table)
    hint = f" Did you mean {near}?" if near else ""
    u = [symbol.name for symbol in symbols.velocities]
    span = u[0] if len(u) == 1 else f"{u[0]} ... {u[-1]}"
    remedy = f"Velocities are {span}: u^i = e^i_mu q'^mu, one for each form of the frame."
    if listed and not (velocity or rate):
        remedy = f"List {name} among the parameters, if it is one."
    raise LagrangianError(
        f"{where}: expected a coordinate, a velocity, the time or a parameter, got {name}.{hint} "
        f"{remedy}"
    )

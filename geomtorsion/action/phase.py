"""Phase: a frame with room for velocities, time and parameters, where mechanics is worked out."""

from __future__ import annotations

import re
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING, Any

import sympy as sp
from sympy.core.function import AppliedUndef

from geomtorsion import checks
from geomtorsion.action.letters import Letters, letters_of
from geomtorsion.errors import LagrangianError
from geomtorsion.exact import Element, parse_expression
from geomtorsion.exact.names import near_names
from geomtorsion.geometry import Frame

if TYPE_CHECKING:
    from geomtorsion.exact import Field


@dataclass(frozen=True, eq=False)
class Phase:
    """The frame once more, over a field that also holds u^i, t and the parameters.

    The frame that a user gave keeps its own field: mechanics adds nothing to it.

    frame: coordinates q^mu and coframe e^i_mu of the given frame; all else is a parameter of it.
    letters: the symbols of velocities and time.
    """

    frame: Frame
    letters: Letters

    @property
    def field(self) -> Field:
        """The exact field of everything below."""
        return self.frame.field

    @property
    def dimension(self) -> int:
        """Number of coordinates, and of quasi-velocities."""
        return self.frame.dimension

    @cached_property
    def velocities(self) -> tuple[Element, ...]:
        """u^i as elements."""
        return tuple(self.field.symbol(symbol) for symbol in self.letters.velocities)

    def over(self, frame: Frame) -> Phase:
        """The same symbols and field, over another frame in that field."""
        return Phase(frame, self.letters)

    def rates(self, velocities: Sequence[Element]) -> list[Element]:
        """q'^mu = E_i^mu u^i."""
        rows = self.frame.legs.components.rows
        return [self.field.sum([(1, value, velocities[i]) for i, value in row]) for row in rows]

    def along(self, leg: int, element: Element) -> Element:
        """E_i(f) = E_i^mu d_mu f: the derivative along one leg."""
        columns = self.frame.legs.components.columns[leg]
        pairs = [(value, element.diff(self.frame.coordinates[mu])) for mu, value in columns]
        return self.field.sum([(1, value, slope) for value, slope in pairs])

    def change(self, element: Element, rates: Sequence[Element]) -> Element:
        """d_t f + q'^mu d_mu f: what f(q, u, t) changes by while the velocities stay."""
        pairs = zip(self.frame.coordinates, rates, strict=True)
        terms = [(1, rate, element.diff(symbol)) for symbol, rate in pairs]
        return self.field.sum([(1, element.diff(self.letters.time)), *terms])


def opened(frame: Frame, expressions: Sequence[sp.Expr]) -> Phase:
    """A phase over a frame whose field has a symbol for everything in the expressions."""
    letters = letters_of(frame)
    known = {*frame.coordinates, *letters.velocities, letters.time}
    free: set[Any] = set().union(*(value.free_symbols for value in expressions))
    extra = sorted(free - known - set(frame.parameters), key=str)
    own = Frame(
        frame.coordinates,
        frame.coframe.to_sympy(),
        parameters=frame.parameters,
        domain=frame.domain,
        complex=frame.complex,
        name=frame.name,
        branches=frame.field.chosen,
    )
    # Later than the frame: the domain then fixes no velocity at which roots are looked at.
    own.field.declare((*extra, letters.time, *letters.velocities))
    return Phase(own, letters)


def expressions(
    frame: Frame,
    entries: Sequence[tuple[str, Any]],
    parameters: Iterable[Any] | None,
) -> list[sp.Expr]:
    """Texts, numbers or sympy expressions in q, u, t and parameters as sympy expressions.

    Symbols are known by their names. In a sympy expression every other symbol is a parameter
    unless parameters are listed; in a text it must be listed, or stand in such an expression.

    Raises
    ------
    LagrangianError
        A symbol is none of these, or cannot be one (u7 where there are three velocities).
    ExpressionError
        A text is no expression.
    """
    letters = letters_of(frame)
    own = (*frame.coordinates, *frame.parameters, letters.time, *letters.velocities)
    table = {symbol.name: symbol for symbol in own}
    listed = parameters.replace(",", " ").split() if isinstance(parameters, str) else parameters
    for item in listed or ():
        symbol = sp.Symbol(item) if isinstance(item, str) else item
        if symbol.name in {s.name for s in (*letters.rates, *letters.accelerations)}:
            _check_parameter("parameters", symbol.name, letters, table, True)
        table.setdefault(symbol.name, symbol)
    found: dict[str, sp.Expr] = {}
    for where, value in entries:
        if not isinstance(value, str):
            expression = found[where] = _sympified(where, value)
            for symbol in sorted(expression.free_symbols, key=str):
                if symbol.name not in table:
                    _check_parameter(where, symbol.name, letters, table, parameters is not None)
                    table[symbol.name] = symbol
            renamed = {symbol: table[symbol.name] for symbol in expression.free_symbols}
            found[where] = expression.xreplace(renamed)
            _check_functions(where, expression, table)
    for where, value in entries:
        if isinstance(value, str):
            found[where] = parse_expression(value, table, where=where)
    return [found[where] for where, _ in entries]


def _sympified(where: str, value: Any) -> sp.Expr:
    """A number, element or expression of sympy; never a text."""
    message = (
        f"{{subject}}: an expression was needed, {type(value).__name__} came: {{value}}. "
        "Give text, a number or a sympy expression."
    )
    return checks.expression(value, where, LagrangianError, message=message)


def _check_functions(where: str, expression: sp.Expr, table: Mapping[str, Any]) -> None:
    """Refuse phi1(t) for the coordinate phi1: it would count as a given function of the time."""
    for function in sorted(expression.atoms(AppliedUndef), key=str):
        name = type(function).__name__
        if name in table:
            raise LagrangianError(
                f"{where}: {function} is a function, but {name} is a symbol here. Write {name}, "
                "and velocities as u^i = e^i_mu q'^mu in place of derivatives."
            )


def _check_parameter(
    where: str, name: str, letters: Letters, table: Mapping[str, Any], listed: bool
) -> None:
    """Refuse a symbol that can be no parameter."""
    stem = letters.velocities[0].name.rstrip("0123456789")
    velocity = bool(re.fullmatch(rf"{stem}\d+", name))
    rate = any(name == s.name for s in (*letters.rates, *letters.accelerations))
    if not (listed or velocity or rate):
        return
    near = near_names(name, table)
    hint = f" Did you mean {near}?" if near else ""
    u = [symbol.name for symbol in letters.velocities]
    span = u[0] if len(u) == 1 else f"{u[0]} ... {u[-1]}"
    remedy = f"Velocities are {span}: u^i = e^i_mu q'^mu, one for each form of the frame."
    if listed and not (velocity or rate):
        remedy = f"List {name} among the parameters, if it is one."
    raise LagrangianError(
        f"{where}: {name} is neither a coordinate, a velocity, the time nor a parameter."
        f"{hint} {remedy}"
    )

"""Fields: numbers, vectors and expressions of effects, checked and read."""

from __future__ import annotations

import keyword
import re
from collections.abc import Mapping, Sequence

import sympy as sp

from geomtorsion.errors import ExpressionError, SceneError
from geomtorsion.exact import parse_expression
from geomtorsion.exact.units import in_unit
from geomtorsion.ode import pieces
from geomtorsion.scenes.body import Expression, Number, exact
from geomtorsion.scenes.context import GROUPS, Context
from geomtorsion.scenes.effects.protocol import Effect, Switch, symbols_in
from geomtorsion.support import checks
from geomtorsion.support.checks import did_you_mean

_STATE = frozenset(symbol.name for group in GROUPS.values() for symbol in group)
_SHORT = "t, Omega1..3, n1..3, R11..R23, q0..q3, x, y, z, vx, vy, vz"
# Sign -> the converter of such numbers, and its words.
SIGNS = {
    "positive": (checks.positive, "a number > 0"),
    "not negative": (checks.not_negative, "a number >= 0"),
    "any": (checks.number, "a finite number"),
}


def check_numbers(effect: Effect, *names: str, sign: str = "any") -> None:
    """Check fields that have to be finite numbers, of a given sign; texts with a unit are read.

    Raises
    ------
    SceneError
        One is not; the message names effect, field and unit.

    Examples
    --------
    >>> from geomtorsion.scenes.effects import Gravity
    >>> check_numbers(Gravity(9.81), "g")
    >>> Gravity("981 cm/s^2").g
    9.81
    >>> check_numbers(Gravity(-1), "g", sign="positive")
    Traceback (most recent call last):
    geomtorsion.errors.SceneError: gravity.g: expected a number > 0 (m/s^2), got -1.
    """
    for name in names:
        value = getattr(effect, name)
        measured = f" ({u})" if (u := effect.units().get(name)) else ""
        subject, (convert, kind) = f"{effect.key}.{name}", SIGNS[sign]
        if isinstance(value, str):
            value = in_unit(value, u or "", subject, SceneError)
            object.__setattr__(effect, name, value)
        convert(value, subject, SceneError, expected=f"{kind}{measured}")


def check_vectors(effect: Effect, *names: str) -> None:
    """Fields that have to be three components; they are kept as tuples.

    Raises
    ------
    SceneError
        A vector does not have three components.

    Examples
    --------
    >>> from geomtorsion.scenes.effects import Spring
    >>> Spring(stiffness=1, anchor=[0, 1, 2]).anchor
    (0, 1, 2)
    >>> Spring(stiffness=1, anchor=[0, 1])
    Traceback (most recent call last):
    geomtorsion.errors.SceneError: spring.anchor: expected three components (m), got [0, 1].
    """
    for name in names:
        value = getattr(effect, name)
        measured = f" ({u})" if (u := effect.units().get(name)) else ""
        wanted = f"three components{measured}"
        parts = checks.entries(value, f"{effect.key}.{name}", SceneError, 3, expected=wanted)
        object.__setattr__(effect, name, tuple(parts))


def check_axis(effect: Effect, name: str) -> None:
    """A field that has to be a direction: three numbers, not all of them zero."""
    check_vectors(effect, name)
    values = getattr(effect, name)
    numbers = [exact(value, f"{effect.key}.{name}[{k}]") for k, value in enumerate(values)]
    if not any(numbers):
        raise SceneError(
            f"{effect.key}.{name}: expected a direction, got {values!r}. Give one that is not 0."
        )


def unit_axis(context: Context, name: str, values: Sequence[Number]) -> sp.Matrix:
    """A direction as a column of length one: an axis of the body exactly, others as symbols."""
    column = sp.Matrix([exact(value, name) for value in values])
    length = sp.sqrt(column.dot(column))
    return context.vector(name, [x / length for x in column])


def known_names(context: Context) -> dict[str, sp.Expr]:
    """Name -> symbol of everything that expressions of users may contain."""
    symbols = {symbol.name: symbol for group in GROUPS.values() for symbol in group}
    return symbols | {name: sp.Symbol(name) for name in context.values}


def read(
    value: Expression,
    context: Context,
    name: str,
    where: str,
    names: Mapping[str, sp.Expr] | None = None,
    functions: Mapping[str, type[sp.Function]] | None = None,
) -> sp.Expr:
    """An expression of time and state: text through the whitelist, a number as a parameter.

    Parameters
    ----------
    value
        Text such as "20*exp(-t)" or "-3*vx", a number, or a sympy expression. It may contain t,
        Omega1..3, n1..3 (upwards, seen from the body), R11..R23, q0..q3, x, y, z, vx, vy, vz, m
        and the moments of inertia I1..3.
    name
        How the parameter is called if the value is a number.
    where
        How errors call the expression.
    names
        Further names that it may contain.
    functions
        Further functions by name, such as tables.

    Raises
    ------
    ExpressionError
        The text is not an expression, holds an unknown name, or code.

    Examples
    --------
    >>> from geomtorsion.scenes import Body
    >>> from geomtorsion.scenes.context import Context
    >>> context = Context(Body(moments=(1, 2, 3)))
    >>> read("0.5*t - vx", context, "F1", "thrust.force[0]"), read(2, context, "F2", "")
    (t/2 - vx, F2)
    """
    symbols = {**known_names(context), **(names or {})}
    if isinstance(value, str):
        try:
            known = {**pieces.FUNCTIONS, **(functions or {})}
            return parse_expression(value, symbols, known, where=where, decimals=True)
        # The parser knows no states; a wrong name is better explained here.
        except ExpressionError:
            _check_names(value, symbols, where)
            raise
    own = sorted(symbols_in(value), key=str)
    if own:
        _check_names(" ".join(symbol.name for symbol in own), symbols, where)
        # Symbols with other assumptions (real, positive) are replaced by known ones of their name.
        own_value = sp.Expr.subs(value, {symbol: symbols[symbol.name] for symbol in own})
        return pieces.without_piecewise(own_value, where)
    return context.parameter(name, value)


def _check_names(text: str, known: Mapping[str, sp.Expr], where: str) -> None:
    """Refuse a name that nothing gives, naming near ones; functions are left to the parser."""
    for name in re.findall(r"(?<![\w.])[^\W\d]\w*(?![\w.]|\s*\()", text):
        if name not in known and name not in ("pi", "E") and not keyword.iskeyword(name):
            hint = did_you_mean(name, known)
            own = [k for k in known if k not in _STATE]
            raise ExpressionError(
                f"{where}: expected a known name, got {name!r}. {hint}There are {_SHORT}, and "
                f"{', '.join(own)}.\n    {text}"
            )


def read_three(
    values: Sequence[Expression],
    context: Context,
    name: str,
    where: str,
    names: Mapping[str, sp.Expr] | None = None,
    functions: Mapping[str, type[sp.Function]] | None = None,
) -> sp.Matrix:
    """Three expressions as a column."""
    expressions = [
        read(value, context, f"{name}{k + 1}", f"{where}[{k}]", names, functions)
        for k, value in enumerate(values)
    ]
    return sp.Matrix(expressions)


def between(
    context: Context, name: str, start: Number | None, end: Number | None
) -> tuple[sp.Expr, tuple[Switch, ...]]:
    """A factor that is 1 from start to end and 0 outside, with the switches that make it so.

    The times are exact: the integration restarts there, so that no step passes over them.

    Raises
    ------
    SceneError
        It ends before it begins.

    Examples
    --------
    >>> from geomtorsion.scenes import Body
    >>> from geomtorsion.scenes.context import Context
    >>> between(Context(Body(moments=(1, 2, 3))), "burn", 0, 2)
    (burn, ((2, {'burn': 0}),))
    """
    # On from before the beginning is on from the beginning: no switch is needed for it.
    if start is not None and exact(start, "start") <= 0:
        start = None
    if start is None and end is None:
        return sp.S.One, ()
    if end is not None and exact(end, "end") <= exact(start or 0, "start"):
        raise SceneError(
            f"{context.key or name}: expected an end after the start at {start or 0} s, got {end} "
            "s. Exchange them."
        )
    factor = context.switchable(name, 0 if start is not None else 1)
    switches = () if start is None else ((start, {factor.name: 1}),)
    return factor, switches if end is None else (*switches, (end, {factor.name: 0}))

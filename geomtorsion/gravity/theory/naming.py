"""Naming: unknown functions of invariants by the names of the invariants, f(T) and f'(T)."""

from __future__ import annotations

from collections.abc import Collection, Iterable, Sequence
from dataclasses import dataclass

import sympy as sp
from sympy.core.function import AppliedUndef

from geomtorsion.exact import Element, Field, Generator, Truncated, TruncatedField
from geomtorsion.gravity.theory.lagrangian import Reading


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

    Values are compared exactly. An argument that is a number keeps its value, and so does one that
    occurs twice, because f(T, T) would not show which derivative is meant.
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
            result[generator.shown] = _applied(call.function, arguments, orders)
            break
    return result


def _applied(function: object, arguments: Sequence[sp.Expr], orders: Sequence[int]) -> sp.Expr:
    """A derivative of an unknown function at its arguments, which may be sums such as T + B."""
    taken = {x for one in arguments for x in one.free_symbols}
    slots = [
        x if x.is_Symbol else next(y for y in sp.numbered_symbols("xi_", start=1) if y not in taken)
        for x in arguments
    ]
    value = function(*slots)  # type: ignore[operator]
    steps = [(x, k) for x, k in zip(slots, orders, strict=True) if k]
    if steps:
        value = sp.Derivative(value, *steps)
    places = [(x, y) for x, y in zip(slots, arguments, strict=True) if x != y]
    if any(x in dict(steps) for x, _ in places):
        return sp.Subs(value, [x for x, _ in places], [y for _, y in places])
    return value.xreplace(dict(places))


def shorthand(
    expression: sp.Expr, coordinates: Collection[sp.Expr], time: sp.Symbol | None = None
) -> sp.Expr:
    r"""An expression as readers write it: f_T for df/dT, and H, Hdot for functions of the time.

    The new symbols print as such in text and in LaTeX. A name that has another meaning in the
    expression is not used: the derivative then stays as it is.

    coordinates: derivatives by these stay as they are, except for functions of the time.
    time: functions of it and of other coordinates are written without arguments.

    Examples
    --------
    >>> T, t = sp.symbols("T t")
    >>> f, H = sp.Function("f"), sp.Function("H")(t)
    >>> shorthand(f(T) - 12 * H**2 * f(T).diff(T, 2) + H.diff(t), [t], t)
    -12*H**2*f_TT + Hdot + f(T)
    >>> sp.latex(shorthand(H.diff(t, 2) * f(T).diff(T), [t], t))
    '\\ddot{H} f_{T}'
    """
    shown: dict[sp.Basic, sp.Basic] = {}
    for part in expression.atoms(sp.Derivative, sp.Subs, AppliedUndef):
        name = _short_name(part, frozenset(coordinates), time)
        if name is not None:
            shown[part] = name
    taken = {x.name for x in expression.free_symbols}
    # A function that keeps its argument, such as f(T), may not share its name with a symbol.
    taken |= {x.func.__name__ for x in expression.atoms(AppliedUndef) if x not in shown}
    return expression.xreplace({x: y for x, y in shown.items() if str(y) not in taken})


# Marks of derivatives by the time, which sympy prints as dots in LaTeX.
DOTS = ("", "dot", "ddot", "dddot", "ddddot")


def _short_name(
    part: sp.Basic, coordinates: frozenset[sp.Expr], time: sp.Symbol | None
) -> sp.Expr | None:
    """The name of a function or of its derivative; None where it has no short one."""
    if isinstance(part, sp.Subs):
        inner = part.expr
        if not isinstance(inner, sp.Derivative) or not isinstance(inner.expr, AppliedUndef):
            return None
        if len(inner.expr.args) > 1:
            # A sum among several arguments is known by its number: f_T2 of f(T, R + T).
            numbers = {x: str(k) for k, x in enumerate(inner.expr.args, start=1)}
            names = {x: sp.Symbol(numbers[x]) for x in part.variables}
            return _slope(inner.expr.func.__name__, inner.xreplace(names).variable_count)
        primes = "'" * int(inner.derivative_count)
        return sp.Function(f"{inner.expr.func.__name__}{primes}")(*part.point)
    if isinstance(part, AppliedUndef):
        in_time = time is not None and coordinates >= set(part.args) and time in part.args
        return sp.Symbol(part.func.__name__) if in_time else None
    function = part.expr
    if not isinstance(function, AppliedUndef):
        return None
    steps = part.variable_count
    name, in_coordinates = function.func.__name__, coordinates & set(part.variables)
    if in_coordinates and (time not in function.args or not coordinates >= set(function.args)):
        return None
    if [x for x, _ in steps] == [time] and steps[0][1] < len(DOTS):
        return sp.Symbol(name + DOTS[int(steps[0][1])])
    return _slope(name, steps)


def _slope(name: str, steps: Iterable[tuple[sp.Basic, sp.Basic]]) -> sp.Symbol:
    """The symbol of a derivative: f_TT, or F_phi_phi where a name has more than one letter."""
    marks = [str(x).removesuffix("_0") for x, k in steps for _ in range(int(k))]
    gap = "" if all(len(x) == 1 for x in marks) else "_"
    return sp.Symbol(f"{name}_{gap.join(marks)}")


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

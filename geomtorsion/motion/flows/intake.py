"""Intake: flows from what users give, checked once at the door."""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping, Sequence
from typing import TYPE_CHECKING, Any

from geomtorsion.errors import ExpressionError, ShapeError, StartError, TimeError, UnknownNameError
from geomtorsion.exact.names import near_names
from geomtorsion.motion.flows.flow import Flow, Switch, Terms
from geomtorsion.motion.flows.law import Law, default_blocks
from geomtorsion.motion.flows.terms import expression, number, symbol_table

if TYPE_CHECKING:
    import sympy as sp

# A start that should have length one may miss it by this much, and is then made so.
NEARLY_UNIT = 1e-6


def flow(
    rates: Any,
    start: Any,
    *,
    parameters: Mapping[str, Any] | None = None,
    invariants: Mapping[str, Any] | None = None,
    outputs: Mapping[str, Any] | None = None,
    time: str = "t",
    switches: Iterable[tuple[Any, Mapping[str, Any]]] = (),
    stop: Any = None,
    blocks: Sequence[Sequence[str]] | None = None,
    unit: Sequence[Sequence[str]] = (),
    name: str = "",
) -> Flow:
    """First-order equations x' = f(x, parameters, t) of any kind, ready to be solved.

    Parameters
    ----------
    rates
        state -> expression (text, sympy, exact element or number) over states, parameters and
        the time; or an object with such `rates`, and `invariants` if it knows some.
    start
        state -> number at t = 0, or numbers in the order of the rates.
    parameters
        name -> number; other numbers later need no new compilation.
    invariants
        name -> expression (or expressions) that should not change; a solution gives their drift.
    outputs
        name -> expression, or expressions that make a vector; they are read off a solution.
    time
        the name of the time in all these.
    switches
        (time, name -> value): from exactly this time on a parameter has a new value, or a state
        starts from a new one.
    stop
        an expression; where it falls through zero the motion ends.
    blocks
        groups of states whose errors are measured against their common size; by default those
        whose names differ in a number or in x, y, z at the end.
    unit
        groups of states of length one together, such as a quaternion: their length is kept.
    name
        what the flow is called.

    Raises
    ------
    ExpressionError
        an expression cannot be read, or contains a name that is not known.
    StartError, ShapeError, UnknownNameError
        numbers are missing, too many or not finite, or names are unknown.
    TimeError
        a switch has no time, or one before the start.

    Examples
    --------
    >>> top = flow(
    ...     {"Omega1": "-Omega2*Omega3", "Omega2": "Omega1*Omega3", "Omega3": 0},
    ...     [1, 0, 2],
    ...     invariants={"energy": "Omega1**2 + Omega2**2 + Omega3**2"},
    ... )
    >>> print(top.text)
    Omega1' = -Omega2*Omega3
    Omega2' = Omega1*Omega3
    Omega3' = 0
    """
    given = rates
    if not isinstance(rates, Mapping):
        rates = getattr(given, "rates", None)
        if not isinstance(rates, Mapping):
            raise ExpressionError(
                f"rates: a mapping from states to expressions was needed, {given!r} came."
            )
        known = getattr(given, "invariants", None)
        if invariants is None and isinstance(known, Mapping):
            invariants = known
    if not rates:
        raise ExpressionError("rates: at least one state was needed, none came.")
    states = tuple(rates)
    numbers = {key: number(value, key) for key, value in (parameters or {}).items()}
    symbols = symbol_table((*states, *numbers, time))
    read = {key: expression(value, f"rate of {key}", symbols) for key, value in rates.items()}
    law = Law(
        read,
        tuple(numbers),
        time,
        None if stop is None else expression(stop, "stop", symbols),
        _block_list(states, blocks, unit),
    )
    made = Flow(
        law,
        start_numbers(states, start),
        numbers,
        _read_terms(invariants or {}, "invariant", symbols),
        _read_terms(outputs or {}, "output", symbols),
        switch_list((*states, *numbers), switches),
        tuple(tuple(group) for group in unit),
        name,
    )
    for key in made.outputs:
        if key in symbols:
            raise ExpressionError(f"output {key} has the name of a state, parameter or the time.")
    check_unit(made)
    # Read now, so that what cannot be read is told here.
    _ = law.system
    return made


def _read_terms(
    terms: Mapping[str, Any], what: str, symbols: Mapping[str, sp.Symbol]
) -> dict[str, Terms]:
    """Expressions, or tuples of them."""
    found: dict[str, Terms] = {}
    for key, value in terms.items():
        where = f"{what} {key}"
        if isinstance(value, list | tuple):
            parts = [
                expression(x, f"{where}[{k}]", symbols, smooth=False) for k, x in enumerate(value)
            ]
            found[key] = tuple(parts)
        else:
            found[key] = expression(value, where, symbols, smooth=False)
    return found


def start_numbers(
    states: Sequence[str], start: Any, known: Sequence[Any] | None = None
) -> tuple[Any, ...]:
    """A number for each state; those of a mapping may change some of the known ones only."""
    if isinstance(start, Mapping):
        for name in start:
            if name not in states:
                raise UnknownNameError(f"start: {name} is no state. {_hint(name, states)}")
        table = dict(zip(states, known, strict=True)) if known is not None else {}
        table |= {name: number(value, f"start of {name}") for name, value in start.items()}
        missing = [name for name in states if name not in table]
        if missing:
            raise StartError(f"start: {', '.join(missing)} has no number; give one for each state.")
        return tuple(table[name] for name in states)
    try:
        values = list(start)
    except TypeError:
        raise StartError(f"start = {start!r}: a mapping or a list of numbers was needed.") from None
    if len(values) != len(states):
        raise ShapeError(
            f"start: {len(states)} numbers were needed ({', '.join(states)}), {len(values)} came."
        )
    pairs = zip(states, values, strict=True)
    return tuple(number(value, f"start of {name}") for name, value in pairs)


def parameter_numbers(names: Sequence[str], parameters: Mapping[str, Any]) -> dict[str, Any]:
    """Numbers for some of the parameters."""
    for name in parameters:
        if name not in names:
            raise UnknownNameError(f"{name} is no parameter. {_hint(name, names)}")
    return {name: number(value, name) for name, value in parameters.items()}


def switch_list(names: Sequence[str], switches: Any) -> tuple[Switch, ...]:
    """Switches in order of time, those of one time put together."""
    table: dict[float, dict[str, Any]] = {}
    for entry in switches:
        try:
            when, values = entry
            at, values = float(when), dict(values)
        except (TypeError, ValueError):
            raise TimeError(f"switch {entry!r}: (time, {{name: value}}) was needed.") from None
        if not (math.isfinite(at) and at >= 0):
            raise TimeError(f"switch at t = {at}: a time from the start at 0 on was needed.")
        for name in values:
            if name not in names:
                raise UnknownNameError(
                    f"switch at t = {at:.6g}: {name} is no parameter and no state. "
                    + _hint(name, names)
                )
        new = {name: number(value, f"{name} at t = {at:.6g}") for name, value in values.items()}
        table.setdefault(at, {}).update(new)
    return tuple(sorted(table.items(), key=lambda item: item[0]))


def _block_list(
    states: Sequence[str], blocks: Any, unit: Sequence[Sequence[str]]
) -> tuple[tuple[str, ...], ...]:
    """Every state in one block; those of length one make a block of their own."""
    groups = [tuple(group) for group in (*unit, *(blocks or ()))]
    seen: set[str] = set()
    found = []
    for group in groups:
        for name in group:
            if name not in states:
                raise UnknownNameError(f"block: {name} is no state. {_hint(name, states)}")
        fresh = tuple(name for name in group if name not in seen)
        if len(set(group)) != len(group):
            raise StartError(f"block {group}: a state is named twice.")
        seen |= set(fresh)
        found += [fresh] if fresh else []
    rest = [name for name in states if name not in seen]
    return (*found, *default_blocks(rest))


def check_unit(made: Flow) -> None:
    """Refuse a start whose length is not one where it should be."""
    for places, names in zip(made.unit_places, made.unit, strict=True):
        length = math.hypot(*(float(made.start[k]) for k in places))
        if abs(length - 1) > NEARLY_UNIT:
            raise StartError(
                f"{', '.join(names)} should have length 1 together; the start has {length:.9g}. "
                "Divide them by that."
            )


def _hint(name: str, known: Sequence[str]) -> str:
    near = near_names(name, known)
    listed = f"There are {', '.join(known)}." if known else "There are none."
    return f"Did you mean {near}? {listed}" if near else listed

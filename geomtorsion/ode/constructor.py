"""Constructor: equations from what users give, checked once."""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping, Sequence
from typing import Any, cast

import numpy as np
import sympy as sp

from geomtorsion.errors import ExpressionError, ShapeError, StartError, TimeError, UnknownNameError
from geomtorsion.exact import Element
from geomtorsion.ode.numbers import Numbers, Real, event_list
from geomtorsion.ode.rates import Rates, default_groups
from geomtorsion.ode.tables import Table
from geomtorsion.ode.terms import At, Terms, When, expression, number, symbol_table
from geomtorsion.support import checks
from geomtorsion.support.precision import PRINTED

Given = tuple[
    Rates, tuple[Real, ...], dict[str, Real], dict[str, Terms], dict[str, Terms], tuple[At, ...],
    tuple[When, ...], tuple[str, ...],
]  # fmt: skip


def read(
    rates: object,
    start: Mapping[str, object] | Numbers,
    parameters: Mapping[str, object] | None,
    invariants: Mapping[str, object] | None,
    outputs: Mapping[str, object] | None,
    time: str,
    events: Iterable[At | When],
    norm_groups: Sequence[Sequence[str]] | None,
    normalized: Sequence[Sequence[str]],
    tables: Mapping[str, object] | None,
) -> Given:
    """Read and check the arguments of `ODE.of`."""
    rates, invariants = _rates_and_invariants(rates, invariants)
    states = tuple(rates)
    given_numbers = checks.by_name(parameters or {}, "parameters", StartError)
    numbers = {key: number(value, key) for key, value in given_numbers.items()}
    invariants, outputs = (
        checks.by_name(terms or {}, what, ExpressionError)
        for terms, what in ((invariants, "invariants"), (outputs, "outputs"))
    )
    _check_names(states, tuple(numbers), time)
    symbols = symbol_table((*states, *numbers, time))
    functions = table_functions(tables, symbols)
    expressions = {
        key: expression(x, f"rate of {key}", symbols, functions=functions)
        for key, x in rates.items()
    }
    names, listed = (*states, *numbers), event_list(events)
    conditions = [event for event in listed if isinstance(event, When)]
    stops, switches = _stops_and_switches(conditions, names, symbols, functions)
    read_outputs = _read_terms(outputs, "output", symbols, functions)
    _check_outputs(read_outputs, symbols)
    groups = _group_list(states, norm_groups, normalized)
    read_invariants = _read_terms(invariants, "invariant", symbols, functions)
    terms = (rates, invariants, outputs)
    falls = [event.falls for event in conditions]
    declared = _declared([*(x for each in terms for x in each.values()), *falls], numbers)
    timed = timed_events(names, [x for x in listed if not isinstance(x, When)], symbols)
    for values in (numbers, *map(numbers_in, timed)):
        check_declared(declared, values)
    numbers_at_start = start_numbers(states, start)
    # A parameter that a condition or an expression changes is a state that rests in between.
    resting = resting_names(timed, switches, numbers)
    expressions |= dict.fromkeys(resting, sp.S.Zero)
    numbers_at_start += tuple(numbers.pop(name) for name in resting)
    groups += default_groups(resting)
    for event in timed:
        _check_time(event, numbers)
    return (
        Rates(expressions, tuple(numbers), time, stops, groups, declared),
        numbers_at_start,
        numbers,
        read_invariants,
        read_outputs,
        timed,
        switches,
        resting,
    )


def _rates_and_invariants(
    rates: object, invariants: Mapping[str, object] | None
) -> tuple[dict[str, Any], Mapping[str, object] | None]:
    """Rates by state, and invariants; an object such as equations may contribute both."""
    source = rates
    if not isinstance(rates, Mapping):
        rates = getattr(source, "rates", None)
        if not isinstance(rates, Mapping):
            raise ExpressionError(
                f"rates: expected a mapping from states to expressions, got {checks.shown(source)}."
            )
        own_invariants = getattr(source, "invariants", None)
        if invariants is None and isinstance(own_invariants, Mapping):
            invariants = own_invariants
    if not rates:
        raise ExpressionError("rates: expected at least one state, got none.")
    return checks.by_name(rates, "rates", ExpressionError), invariants


def _stops_and_switches(
    conditions: Sequence[When],
    names: Sequence[str],
    symbols: Mapping[str, sp.Symbol],
    functions: Mapping[str, type[sp.Function]],
) -> tuple[tuple[sp.Expr, ...], tuple[When, ...]]:
    """Conditions that end the motion, as expressions, and those that change states."""
    for event in conditions:
        checks.instance(
            event.changes, Mapping, "When", ExpressionError, expected="changes {name: value}"
        )
    stops = [
        expression(event.falls, "stop", symbols, functions=functions)
        for event in conditions
        if not event.changes
    ]
    switches = [_switch(event, names, symbols) for event in conditions if event.changes]
    return tuple(stops), tuple(switches)


def _check_outputs(outputs: Iterable[str], symbols: Mapping[str, sp.Symbol]) -> None:
    """Refuse outputs with the name of a state, a parameter or the time."""
    for key in outputs:
        if key in symbols:
            raise ExpressionError(
                f"outputs: expected new names, got {key}, the name of a state, a parameter or the "
                "time. Rename the output."
            )


def numbers_in(event: At) -> dict[str, Real]:
    """The changes of an event that are numbers."""
    return {name: x for name, x in event.changes.items() if not isinstance(x, sp.Expr)}


def table_functions(
    tables: Mapping[str, object] | None, symbols: Mapping[str, sp.Symbol]
) -> dict[str, type[sp.Function]]:
    """Functions of sympy for tables by name."""
    functions: dict[str, type[sp.Function]] = {}
    for name, table in checks.by_name(tables or {}, "tables", ExpressionError).items():
        if name in symbols or not name.isidentifier():
            raise ExpressionError(
                f"tables: expected a name that nothing else has, got {checks.shown(name)}. Rename "
                "the table."
            )
        functions[name] = checks.instance(table, Table, f"tables: {name}", ExpressionError).function
    return functions


def resting_names(
    timed: Iterable[At], switches: Iterable[When], parameters: Iterable[str]
) -> tuple[str, ...]:
    """Parameters whose changes depend on the motion."""
    names = [name for switch in switches for name in switch.changes]
    names += [x for one in timed for x, y in one.changes.items() if isinstance(y, sp.Expr)]
    return tuple(name for name in parameters if name in names)


def _switch(event: When, names: Sequence[str], symbols: Mapping[str, sp.Symbol]) -> When:
    """A condition with changes, as expressions and numbers."""
    subject = f"When({checks.shown(event.falls)})"
    changes = _changes(event.changes, subject, names, symbols)
    return When(expression(event.falls, "event", symbols), changes)


def _changes(
    changes: object, subject: str, names: Sequence[str], symbols: Mapping[str, sp.Symbol]
) -> dict[str, Any]:
    """New values of states and parameters: numbers, or expressions in the values before."""
    if not isinstance(changes, Mapping):
        raise ExpressionError(
            f"{subject}: expected changes {{name: value}}, got {checks.shown(changes)}."
        )
    read: dict[str, Any] = {}
    for name, value in checks.by_name(changes, subject, StartError).items():
        kind = "a parameter or a state"
        checks.known_name(name, names, subject, UnknownNameError, expected=kind)
        term: Any = value
        if isinstance(value, str | sp.Expr | Element):
            term = expression(value, f"{name} in {subject}", symbols)
        depends = isinstance(term, sp.Expr) and bool(term.free_symbols)
        read[name] = term if depends else number(value, f"{name} in {subject}")
    return read


def _check_time(event: At, parameters: Mapping[str, object]) -> None:
    """Refuse the time of a change that depends on more than parameters."""
    if isinstance(event.time, sp.Expr):
        for symbol in event.time.free_symbols:
            if symbol.name not in parameters:
                raise TimeError(
                    f"event: expected a time in the parameters, got {event.time}, in which "
                    f"{symbol.name} changes during the motion. Write a condition: When(...)."
                )


def named(name: str | sp.Symbol) -> str:
    """The name of a symbol; anything else as it is.

    Examples
    --------
    >>> named(sp.Symbol("x")), named("y")
    ('x', 'y')
    """
    return str(name) if isinstance(name, sp.Symbol) else name


def _check_names(states: Sequence[str], parameters: Sequence[str], time: str) -> None:
    """Refuse a name with two meanings, and suggest how to rename one of them."""
    for name in parameters:
        if name in states:
            raise ExpressionError(
                f"{name}: expected one meaning, got a state and a parameter. Rename one of them, "
                "or omit it from parameters if the state is meant."
            )
    if time in states or time in parameters:
        what = "state" if time in states else "parameter"
        proposal = next(x for x in ("tau", "s", "time") if x not in (*states, *parameters))
        raise ExpressionError(
            f"{time}: expected one meaning, got a {what} and the time. Give the time another name: "
            f"time={proposal!r}."
        )


def _declared(entries: Iterable[Any], names: Iterable[str]) -> tuple[sp.Symbol, ...]:
    """The parameters that occur in the input, with their assumptions."""
    allowed, symbols = set(names), set[sp.Symbol]()
    for entry in entries:
        for part in entry if isinstance(entry, list | tuple) else (entry,):
            if isinstance(part, Element):
                symbols |= part.symbols
            elif isinstance(part, sp.Expr):
                symbols |= part.atoms(sp.Symbol)
    return tuple(sorted((x for x in symbols if x.name in allowed), key=sp.srepr))


def declarations(declared: Iterable[sp.Symbol]) -> dict[str, list[str]]:
    """The assumptions of parameters as words: name -> words, if there are any.

    Examples
    --------
    >>> declarations([sp.Symbol("k", integer=True), sp.Symbol("m")])
    {'k': ['real', 'integer']}
    """
    assumptions = {
        symbol.name: [word for word in checks.DECLARED if getattr(symbol, f"is_{word}")]
        for symbol in declared
    }
    return {name: words for name, words in assumptions.items() if words}


def declared_symbols(words: Mapping[str, Sequence[str]]) -> tuple[sp.Symbol, ...]:
    """Parameters as `declarations` wrote them down."""
    return tuple(sp.Symbol(name, **dict.fromkeys(traits, True)) for name, traits in words.items())


def check_declared(declared: Iterable[sp.Symbol], values: Mapping[str, object]) -> None:
    """Refuse values of parameters, numbers or arrays, that contradict their assumptions."""
    for symbol in declared:
        entry = values.get(symbol.name)
        if isinstance(entry, np.ndarray):
            # The ends show the signs: only where these are wrong all values are gone through.
            ends = (entry.min(), entry.max())
            if symbol.is_integer or any(checks.against(symbol, checks.expression(x)) for x in ends):
                for value in entry.ravel().tolist():
                    checks.check_declared(symbol, value)
        elif entry is not None:
            checks.check_declared(symbol, entry)


def term(outputs: Mapping[str, Terms], names: Sequence[str], entry: object) -> sp.Expr:
    """One output, or an expression over states, parameters and time."""
    if isinstance(entry, str) and entry in outputs:
        output = outputs[entry]
        if isinstance(output, tuple):
            raise UnknownNameError(
                f"{entry}: expected one number, got {len(output)} components. Give an expression "
                "of one number."
            )
        return output
    return expression(entry, "event_times", symbol_table(names), smooth=False)


def _read_terms(
    terms: Mapping[str, object],
    what: str,
    symbols: Mapping[str, sp.Symbol],
    functions: Mapping[str, type[sp.Function]],
) -> dict[str, Terms]:
    """Expressions, or tuples of them."""
    expressions: dict[str, Terms] = {}
    for key, value in terms.items():
        where = f"{what} {key}"
        if isinstance(value, list | tuple):
            expressions[key] = tuple(
                expression(x, f"{where}[{k}]", symbols, smooth=False, functions=functions)
                for k, x in enumerate(value)
            )
        else:
            expressions[key] = expression(value, where, symbols, smooth=False, functions=functions)
    return expressions


def start_numbers(
    states: Sequence[str], start: object, known: Sequence[Real] | None = None
) -> tuple[Real, ...]:
    """A number for each state; a mapping may change some of the known numbers."""
    labelled = checks.labelled(start)
    if labelled is not None:
        named = checks.by_name(labelled, "start", StartError)
        for name in named:
            checks.known_name(name, states, "start", UnknownNameError, expected="a state")
        table = dict(zip(states, known, strict=True)) if known is not None else {}
        table |= {name: number(value, f"start of {name}") for name, value in named.items()}
        checks.check_values(states, table, "start", StartError, "Give a number for each state.")
        return tuple(table[name] for name in states)
    try:
        # Other values are refused below.
        values = list(cast("Iterable[object]", start))
    except TypeError:
        raise StartError(
            f"start = {checks.shown(start)}: expected a mapping or a list of numbers."
        ) from None
    if len(values) != len(states):
        raise ShapeError(
            f"start: expected {len(states)} numbers ({', '.join(states)}), got {len(values)}."
        )
    pairs = zip(states, values, strict=True)
    return tuple(number(value, f"start of {name}") for name, value in pairs)


def parameter_numbers(names: Sequence[str], parameters: Mapping[str, object]) -> dict[str, Real]:
    """Numbers for some of the parameters."""
    parameters = checks.by_name(parameters, "parameters", StartError)
    for name in parameters:
        checks.known_name(name, names, "parameters", UnknownNameError, expected="a parameter")
    return {name: number(value, name) for name, value in parameters.items()}


def timed_events(
    names: Sequence[str],
    events: Iterable[object],
    symbols: Mapping[str, sp.Symbol] | None = None,
) -> tuple[At, ...]:
    """Changes in order of time, joined if they have the same time; then those at expressions.

    symbols: what changes may depend on.
    """
    table: dict[float, dict[str, Any]] = {}
    later: list[At] = []
    symbols = symbol_table(names) if symbols is None else symbols
    for entry in event_list(events):
        if not isinstance(entry, At) or not isinstance(entry.changes, Mapping):
            raise TimeError(
                f"event: expected At(time, {{name: value}}) or When(expression), got "
                f"{checks.shown(entry)}."
            )
        at: Any = checks.real(entry.time)
        if at is None and isinstance(entry.time, str | sp.Expr | Element):
            read = expression(entry.time, "time of an event", symbols)
            at = read if read.free_symbols else float(read)
        if at is None:
            raise TimeError(
                f"event: expected At(time, {{name: value}}), got {checks.shown(entry)}."
            )
        if isinstance(at, sp.Expr):
            later.append(At(at, _changes(entry.changes, f"event at t = {at}", names, symbols)))
            continue
        if not (math.isfinite(at) and at >= 0):
            raise TimeError(f"event: expected a time of 0 or later, got t = {at}.")
        new = _changes(entry.changes, f"event at t = {at:.6g}", names, symbols)
        table.setdefault(at, {}).update(new)
    timed = [At(at, changes) for at, changes in sorted(table.items(), key=lambda x: x[0])]
    return (*timed, *later)


def _group_list(
    states: Sequence[str],
    norm_groups: Sequence[Sequence[str]] | None,
    normalized: Sequence[Sequence[str]],
) -> tuple[tuple[str, ...], ...]:
    """Every state in one group; normalized states form a separate group."""
    groups = [tuple(group) for group in (*normalized, *(norm_groups or ()))]
    seen: set[str] = set()
    disjoint = []
    for group in groups:
        for name in group:
            checks.known_name(name, states, "norm group", UnknownNameError, expected="states")
        fresh = tuple(name for name in group if name not in seen)
        if len(set(group)) != len(group):
            raise StartError(
                f"norm group {group}: expected different states, got one of them twice."
            )
        seen |= set(fresh)
        disjoint += [fresh] if fresh else []
    rest = [name for name in states if name not in seen]
    return (*disjoint, *default_groups(rest))


def check_lengths(
    states: Sequence[str], start: Sequence[Real], normalized: Sequence[Sequence[str]]
) -> None:
    """Raise an error if a normalized group does not have length one at the start."""
    for names in normalized:
        length = math.hypot(*(float(start[states.index(name)]) for name in names))
        if abs(length - 1) > PRINTED:
            raise StartError(
                f"start: expected {', '.join(names)} of length 1 together, got length "
                f"{length:.9g}. Divide them by it."
            )


def start_columns(
    states: Sequence[str], start: Sequence[Real], parameters: Sequence[str], starts: object
) -> tuple[np.ndarray, dict[str, np.ndarray]]:
    """States of members (number, size), and those parameters that are given: (number,)."""
    named = checks.labelled(starts)
    if named is None:
        rows = _array("starts", starts)
        if rows.ndim != 2 or rows.shape[1] != len(states) or not len(rows):
            raise ShapeError(f"starts: expected shape (number, {len(states)}), got {rows.shape}.")
        return rows, {}
    names = (*states, *parameters)
    arrays = {}
    for name, values in checks.by_name(named, "starts", StartError).items():
        kind = "a state or a parameter"
        checks.known_name(name, names, "starts", UnknownNameError, expected=kind)
        arrays[name] = _array(f"starts of {name}", values)
    lengths = {name: array.shape for name, array in arrays.items() if array.ndim}
    if len(set(lengths.values())) != 1 or len(next(iter(lengths.values()))) != 1:
        raise ShapeError(f"starts: expected lists of one common length, got {lengths}.")
    (number_of,) = next(iter(lengths.values()))
    if not number_of:
        raise StartError("starts: expected one number for each motion, got empty lists.")
    rows = np.tile([float(x) for x in start], (number_of, 1))
    for name in arrays.keys() & set(states):
        rows[:, states.index(name)] = arrays[name]
    return rows, {name: np.array(x) for name, x in arrays.items() if name not in states}


def check_many_lengths(
    states: Sequence[str], rows: np.ndarray, normalized: Sequence[Sequence[str]]
) -> None:
    """Refuse starts whose length is not one where it should be."""
    for names in normalized:
        places = [states.index(name) for name in names]
        lengths = np.sqrt((rows[:, places] ** 2).sum(axis=1))
        if (np.abs(lengths - 1) > PRINTED).any():
            k = int(np.argmax(np.abs(lengths - 1)))
            raise StartError(
                f"starts[{k}]: expected {', '.join(names)} of length 1 together, got length "
                f"{lengths[k]:.9g}. Divide them by it."
            )


def _array(what: str, values: object) -> np.ndarray:
    """Finite numbers."""
    return checks.array(values, what, StartError, shape_error=ShapeError)

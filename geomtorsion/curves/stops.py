"""Stops: conditions at which a curve ends, in the coordinates of each chart that can state them."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, TypeAlias

import numpy as np
import sympy as sp

from geomtorsion.codegen import graph
from geomtorsion.errors import ExpressionError, StartError
from geomtorsion.ode.numbers import floats
from geomtorsion.ode.rates import TINY, check_smooth
from geomtorsion.ode.terms import When, expression, symbol_table
from geomtorsion.support import checks
from geomtorsion.support.precision import HALF

if TYPE_CHECKING:
    from collections.abc import Mapping

    from geomtorsion.curves.atlas import Atlas
    from geomtorsion.curves.equations import Equations
    from geomtorsion.ode.numbers import Real
    from geomtorsion.ode.system import System
    from geomtorsion.ode.trajectory import State

Stops: TypeAlias = "str | sp.Basic | When | Sequence[str | sp.Basic | When]"
# Functions without a jump: with any other one a condition may fall where the motion does not.
_STEADY = (sp.sin, sp.cos, sp.exp, sp.sinh, sp.cosh)


@dataclass(frozen=True)
class Stop:
    """A condition that ends a curve where it falls through zero.

    text: as it was given.
    term: the same over coordinates and frame velocities of the home chart; parameters have values.
    """

    text: str
    term: sp.Expr


def read_stops(
    stop: object,
    coordinates: Sequence[str],
    velocities: Sequence[str],
    parameters: Mapping[str, Real],
) -> tuple[Stop, ...]:
    """Conditions from text, sympy, `When`, or a list of these.

    Raises
    ------
    ExpressionError
        One cannot be read, has a kink, or contains a name that is not known.
    """
    entries = list(stop) if isinstance(stop, list | tuple) else [stop]
    names = tuple(dict.fromkeys((*coordinates, *velocities, *parameters)))
    table = symbol_table(names)
    values = {table[name]: _exact(value) for name, value in parameters.items()}
    stops = []
    for k, entry in enumerate(entries):
        where = "stop" if len(entries) == 1 else f"stop[{k}]"
        term = entry.falls if isinstance(entry, When) else entry
        read = expression(term, where, table, smooth=False)
        parts = _smooth_parts(read)
        check_smooth(parts, [where] * len(parts))
        moving = {table[name] for name in (*coordinates, *velocities)}
        if not read.free_symbols & moving:
            raise ExpressionError(
                f"{where}: expected an expression that changes along the curve, got {read}. "
                f"Use {', '.join(names)}."
            )
        text = term.strip() if isinstance(term, str) else str(read)
        stops += [Stop(text, part.xreplace(values)) for part in parts]
    return tuple(stops)


def _smooth_parts(term: sp.Expr) -> list[sp.Expr]:
    """Expressions of which the smallest is a condition, as 3 - x and 3 + x of 3 - Abs(x)."""
    for kink in sorted(term.atoms(sp.Abs, sp.Max, sp.Min), key=sp.default_sort_key):
        factor = term.coeff(kink)
        rest = term - factor * kink
        is_least = factor.is_positive if isinstance(kink, sp.Min) else factor.is_negative
        if is_least and not rest.has(kink):
            sides = (kink.args[0], -kink.args[0]) if isinstance(kink, sp.Abs) else kink.args
            return [part for x in sides for part in _smooth_parts(rest + factor * x)]
    return [term]


def _exact(value: Real) -> sp.Expr:
    """A number, exactly."""
    fraction = checks.fraction(value)
    if fraction is None:
        return sp.Rational(str(value))
    return sp.Rational(fraction.numerator, fraction.denominator)


def in_chart(stop: Stop, atlas: Atlas, chart: str, velocities: Sequence[str]) -> sp.Expr | None:
    """A condition over the coordinates of a chart; None where they do not state it.

    A coordinate that jumps there, as an angle does that counts modulo a turn, states nothing.
    """
    used = {symbol.name: symbol for symbol in stop.term.free_symbols}
    if chart == atlas.home:
        return stop.term
    if used.keys() & set(velocities) and not atlas.same_frame(atlas.home, chart):
        return None
    term = stop.term
    home = atlas.chart(atlas.home).names
    for change in reversed(atlas.route(chart, atlas.home)):
        target = atlas.chart(change.target).names if change.target != atlas.home else home
        table = dict(zip(target, change.expressions, strict=True))
        used = {symbol.name: symbol for symbol in term.free_symbols}
        term = term.xreplace({used[name]: table[name] for name in used.keys() & table.keys()})
    functions = term.atoms(sp.Function)
    if all(isinstance(function, _STEADY) for function in functions):
        return term
    return None


def with_stops(
    system: System,
    equations: Equations,
    stops: Sequence[Stop],
    atlas: Atlas,
    chart: str,
    unit: float,
    *,
    single: bool,
) -> System:
    """Equations in a chart whose guard has the conditions after the edges of the chart.

    unit: frame velocities are states in units of it.
    single: whether the atlas has one chart only, so that the motion runs up to its edge.
    """
    margin, end = equations.guard_terms
    terms = [term + TINY for term in terms_in_chart(stops, atlas, chart, equations, unit)]
    arguments = (*equations.states, *equations.parameters)
    guard = graph(arguments, [*(end if single else margin), *terms], equations.parameters)
    first = len(end if single else margin)
    places = tuple(range(first, first + len(terms)))
    return replace(system, guard=guard, end=None, stops=places)


def terms_in_chart(
    stops: Sequence[Stop], atlas: Atlas, chart: str, equations: Equations, unit: float
) -> list[sp.Expr]:
    """Conditions over the states of a chart; frame velocities are states in a unit."""
    terms = []
    for stop in stops:
        term = in_chart(stop, atlas, chart, equations.velocities) if chart else stop.term
        assert term is not None
        scaled = {
            symbol: symbol * sp.Rational(unit)
            for symbol in term.free_symbols
            if symbol.name in equations.velocities
        }
        terms.append(term.xreplace(scaled))
    return terms


def stopped(
    stops: Sequence[Stop], system: System, start: State, numbers: State, last: State
) -> str | None:
    """The condition that has ended a stage, None where an edge of the chart has.

    system: from `with_stops`; start, last: states between which the stage ran.
    """
    assert system.guard is not None
    here, before = (
        np.array(system.guard.numpy()(*floats(list(row)), *floats(list(numbers))))
        for row in (last, start)
    )
    # A condition may be zero at the start up to rounding; then no share of it can remain.
    left = np.abs(here) / np.maximum(before, HALF)
    place = int(np.argmin(np.nan_to_num(left, nan=0.0))) - (len(here) - len(stops))
    return stops[place].text if place >= 0 else None


def check_stops(stops: Sequence[Stop], point: Mapping[str, float | np.ndarray]) -> None:
    """Refuse starts at which a condition has fallen already; point: of one or of all members.

    Raises
    ------
    StartError
        One is below zero.
    """
    for stop in stops:
        names = sorted(symbol.name for symbol in stop.term.free_symbols)
        room = graph(names, [stop.term], factor=False).numpy()(*(point[x] for x in names))[0]
        bad = np.flatnonzero(~(np.atleast_1d(room) >= 0))
        if len(bad):
            which = f" for member {bad[0]}" if np.ndim(room) else ""
            raise StartError(
                f"stop: expected {stop.text} above zero at the start, got "
                f"{float(np.atleast_1d(room)[bad[0]]):.6g}{which}. A curve ends where the "
                f"expression decreases through zero; write -({stop.text}) to stop where it "
                "increases."
            )

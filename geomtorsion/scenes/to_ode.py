"""To ODE: a scene as first-order equations with what they conserve, and read back."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from fractions import Fraction
from functools import lru_cache
from random import Random
from typing import TYPE_CHECKING

import numpy as np
import sympy as sp

from geomtorsion.codegen import Graph, graph
from geomtorsion.errors import GeomtorsionError, SceneError, StartError
from geomtorsion.ode import ODE, At, When, pieces
from geomtorsion.rigid import attitude
from geomtorsion.scenes.assembly import WORK, Assembly, by_quaternion
from geomtorsion.scenes.context import (
    ATTITUDE,
    OMEGA,
    POSITION,
    QUATERNION,
    TIME,
    VELOCITY,
    VERTICAL,
    Number,
)
from geomtorsion.support.checks import expression as expression_of
from geomtorsion.support.precision import EXACT_BITS, PRINTED, working_precision

if TYPE_CHECKING:
    from geomtorsion.scenes.selection import StateSelection
    from geomtorsion.scenes.state import State


# -- a scene as equations -------------------------------------------------------------------------


def pruned_rates(selection: StateSelection) -> dict[str, sp.Expr]:
    """State -> rate, of the states that are needed and in the attitude states that were chosen."""
    assembly, rates = selection.assembly, {}
    turning = dict(
        zip(QUATERNION, attitude.quaternion_rates(QUATERNION, assembly.omega), strict=True)
    )
    chosen = attitude_states(selection)
    for symbol in selection.symbols:
        if symbol in turning:
            rate = turning[symbol]
        elif symbol in VERTICAL:
            rate = assembly.turning(symbol)
        else:
            rate = assembly.rates[symbol]
        rates[symbol.name] = rate.xreplace(chosen)
    return rates


def attitude_states(selection: StateSelection) -> Mapping[sp.Symbol, sp.Expr]:
    """Elements of R by the quaternion, where the whole attitude is followed."""
    return by_quaternion() if selection.uses_quaternion else {}


def ode_of(selection: StateSelection, start: State, correct: Assembly, name: str) -> ODE:
    """The equations of a scene: one compiled integrator serves all scenes with equal equations.

    correct: the equations without wrong laws, for conserved quantities.
    """
    chosen = attitude_states(selection)
    assembly = selection.assembly
    unit = [
        tuple(s.name for s in group)
        for group in (QUATERNION, VERTICAL)
        if group[0] in selection.symbols
    ]
    outputs = {
        f"watch {item.name}": [expression_of(x).xreplace(chosen) for x in item.made_of(assembly)]
        for item in selection.watch
    }
    parts = [part for key, part in assembly.parts.items() if key in selection.effects]
    stops = [part.stop for part in parts if part.stop is not None]
    events: list[At | When] = []
    for part in parts:
        # Times are numbers of any kind; `ODE.of` checks them.
        events += [At(time, changes) for time, changes in part.switches]  # type: ignore[arg-type]
    events += [When(assembly.constrained(stop).xreplace(chosen)) for stop in stops]
    numbers, parameters = start_of(selection, start), parameters_of(selection, start)
    form = _Form(
        *_laws(selection, correct),
        _entries(outputs),
        tuple(map(expression_of, stops)),
        tuple(unit),
        tuple(parameters),
        name,
        (numbers, parameters, events),
    )
    return _ode_of_form(form).with_start(
        numbers, parameters, [event for event in events if isinstance(event, At)]
    )


@lru_cache
def _laws(selection: StateSelection, correct: Assembly) -> tuple[Entries, Entries]:
    """Rates and invariants, which scenes with other starts share."""
    kept = invariants(selection, correct, attitude_states(selection))
    return _entries(pruned_rates(selection)), _entries(kept)


# Name -> expression or expressions.
Entries = tuple[tuple[str, tuple[sp.Expr, ...]], ...]


def _entries(table: Mapping[str, sp.Expr | Sequence[sp.Expr]]) -> Entries:
    """A table of expressions as a key; a sequence differs from its only element."""
    return tuple(
        (name, (*value, sp.Tuple()) if isinstance(value, list) else (value,))
        for name, value in table.items()
    )


def _table(entries: Entries) -> dict[str, sp.Expr | list[sp.Expr]]:
    """The table of a key."""
    return {
        name: list(value[:-1]) if value[-1] == sp.Tuple() else value[0] for name, value in entries
    }


@dataclass(frozen=True)
class _Form:
    """Equations of a scene without their numbers; equal ones share everything that is compiled.

    numbers: start, parameters and events of the scene that came first, in which the equations are
        checked; no part of equality.
    """

    rates: Entries
    invariants: Entries
    outputs: Entries
    stops: tuple[sp.Expr, ...]
    normalized: tuple[tuple[str, ...], ...]
    parameters: tuple[str, ...]
    name: str
    numbers: tuple[Mapping[str, Number], Mapping[str, Number], Sequence[At | When]] = field(
        compare=False
    )


@lru_cache
def _ode_of_form(form: _Form) -> ODE:
    """The equations with the numbers of the scene that came first."""
    start, parameters, events = form.numbers
    ode = ODE.of(
        _table(form.rates),
        start,
        parameters=parameters,
        invariants=_table(form.invariants),
        outputs=_table(form.outputs),
        events=events,
        normalized=form.normalized,
        name=form.name,
    )
    # Made before it is shared.
    _ = ode.term_graphs
    return ode


def parameters_of(selection: StateSelection, start: State) -> dict[str, Number]:
    """Parameter -> number, exact where it is; velocities that do not change are among them."""
    velocity = dict(zip(VELOCITY, start.velocity or (0, 0, 0), strict=True))
    return {**selection.assembly.values, **{s.name: velocity[s] for s in selection.constants}}


def start_of(selection: StateSelection, start: State) -> dict[str, Number]:
    """State -> number at the start.

    Raises
    ------
    StartError
        the start lacks an angular velocity or an attitude that is needed.
    SceneError
        the start contradicts a constraint.
    """
    assembly = selection.assembly
    table: dict[sp.Symbol, Number] = {sp.Symbol(name): x for name, x in assembly.start.items()}
    if any(s in selection.symbols for s in OMEGA) and start.omega is None:
        raise StartError(
            "start: expected an angular velocity, got none. Give State(omega=(0, 0, 1), ...), "
            "rad/s in body axes."
        )
    table |= dict(zip(OMEGA, start.omega or (0, 0, 0), strict=True))
    q = start.attitude
    if q is None and {QUATERNION[0], VERTICAL[0]} & set(selection.symbols):
        raise _missing_attitude(selection)
    if q is not None:
        matrix = attitude.matrix_from_quaternion(q)
        table |= {s: float(x) for s, x in zip(QUATERNION, q, strict=True)}
        table |= {ATTITUDE[i, j]: float(matrix[i, j]) for i in range(3) for j in range(3)}
    table |= dict(zip(POSITION, start.position or (0, 0, 0), strict=True))
    table |= dict(zip(VELOCITY, start.velocity or (0, 0, 0), strict=True))
    _check_constrained(selection, start, table)
    return {symbol.name: table[symbol] for symbol in selection.symbols}


def _missing_attitude(selection: StateSelection) -> StartError:
    """The error for a start without attitude."""
    groups = ("attitude", "vertical")
    who = [row.reason for row in selection.rows if row.inside and row.name in groups]
    return StartError(
        f"the start has no attitude, which is needed ({'; '.join(who)}). "
        "Give State(..., euler=(0, 0, 0)), a quaternion or a matrix."
    )


def _check_constrained(
    selection: StateSelection, start: State, table: Mapping[sp.Symbol, Number]
) -> None:
    """Refuse a start that a constraint does not allow."""
    assembly = selection.assembly
    for name, symbols in (("omega", OMEGA), ("velocity", VELOCITY), ("position", POSITION)):
        vector = getattr(start, name)
        if vector is None or not any(s in assembly.substitutions for s in symbols):
            continue
        values = dict(assembly.values) | {s.name: v for s, v in table.items()}
        allowed = []
        for symbol in symbols:
            tie = assembly.substitutions.get(symbol, symbol)
            if any(s.name not in values for s in tie.free_symbols):
                return
            allowed.append(float(tie.subs({s: values[s.name] for s in tie.free_symbols})))
        size = max(1e-300, *(abs(float(x)) for x in (*vector, *allowed)))
        if any(abs(a - float(b)) > PRINTED * size for a, b in zip(allowed, vector, strict=True)):
            shown = ", ".join(f"{x:.6g}" for x in allowed)
            raise SceneError(
                f"start: expected {name} = ({shown}) as the constraint requires, got "
                f"{tuple(vector)}. Omit {name}, or give it this value."
            )


# -- states read back -----------------------------------------------------------------------------


def observed(
    ode: ODE, selection: StateSelection, times: np.ndarray, states: np.ndarray
) -> dict[str, np.ndarray]:
    """The outputs by name, from states of shape (m, size) at these times.

    Raises
    ------
    SceneError
        a value is not finite, such as an energy beyond all doubles.
    """
    outputs = ode.read_outputs(times, states)
    values = {}
    for item in selection.watch:
        value = outputs[f"watch {item.name}"]
        if item.finish is not None:
            value = item.finish(value)
        finite = np.isfinite(value).all(axis=tuple(range(1, value.ndim)))
        if not finite.all():
            raise SceneError(
                f"{item.name}: expected finite values, got one that is not finite at t = "
                f"{float(times[~finite][0]):.6g}. Use other units, or do not watch it."
            )
        values[item.name] = value if item.labels or value.ndim == 1 else value[:, 0]
    return values


# With fractions a rate is zero exactly; with roots and functions a rate that is below its terms by
# half of the bits that are worked out counts as zero.
NOTHING = 0.5 ** (EXACT_BITS // 2)


def invariants(
    selection: StateSelection, correct: Assembly, chosen: Mapping[sp.Symbol, sp.Expr]
) -> dict[str, sp.Expr | list[sp.Expr]]:
    """Name -> expression (or several) that does not change, over the states that are solved for.

    A quantity is taken for conserved if its rate vanishes, exactly or to 60 digits, at random
    states of motion.

    correct: the equations by which a quantity is to be conserved.
    chosen: elements of R -> expressions in the states that are solved for.
    """
    assembly = selection.assembly
    here = {*selection.symbols, *selection.constants, TIME}
    if selection.uses_quaternion:
        here |= set(ATTITUDE)
    parameters = {sp.Symbol(name) for name in assembly.values}
    switched = {
        name for part in assembly.parts.values() for _, values in part.switches for name in values
    }
    constants: dict[str, sp.Expr | list[sp.Expr]] = {}
    for name, parts in _candidates(assembly).items():
        # If the energy is conserved, the balance adds nothing.
        if name == "energy_balance" and "energy" in constants:
            continue
        free = {symbol for part in parts for symbol in part.free_symbols} - parameters
        # It may contain only solved states, and nothing that a switch changes.
        if not free or not free <= here or {s.name for s in free} & switched:
            continue
        if all(is_constant(correct, part) for part in parts):
            expressions = [part.xreplace(dict(chosen)) for part in parts]
            constants[name] = expressions if len(expressions) > 1 else expressions[0]
    return constants


def _candidates(assembly: Assembly) -> dict[str, tuple[sp.Expr, ...]]:
    """What may be conserved, most useful first; conserved momenta are not states at all."""
    energy = assembly.kinetic_energy + assembly.potential_energy
    momentum = assembly.angular_momentum
    return {
        "energy": (energy,),
        "energy_balance": (energy - assembly.constrained(WORK),),
        "rotational_energy": (assembly.rotational_energy,),
        "angular_momentum_space": tuple(ATTITUDE * momentum),
        "angular_momentum_squared": (momentum.dot(momentum),),
        "vertical_angular_momentum": (sp.Matrix(VERTICAL).dot(momentum),),
        "axial_angular_momentum": (momentum[2],),
    }


def is_constant(assembly: Assembly, quantity: sp.Expr) -> bool:
    """Whether the rate of a quantity vanishes at random states; False where it has no value.

    Examples
    --------
    >>> from geomtorsion.scenes import Body
    >>> from geomtorsion.scenes.assembly import assemble
    >>> free = assemble(Body(moments=(1, 2, 3)), {})
    >>> is_constant(free, free.kinetic_energy), is_constant(free, free.context.Omega[0])
    (True, False)
    """
    symbols = sorted(quantity.free_symbols, key=str)
    rates = tuple((symbol, assembly.rate_of(symbol)) for symbol in symbols)
    _, made_of = _change(quantity, rates)
    if made_of is None:
        return True
    moving = {symbol.name for symbol in assembly.context.switched}
    values = {name: x for name, x in assembly.values.items() if name not in moving}
    # Digits show nothing new about a rate that vanishes for all values of the parameters.
    exactly = not _vanishes(quantity, rates)
    chance = Random(20)
    # One place could be a zero of the rate by accident, three are none. A rate that vanishes for
    # all values needs one, at which it has a value.
    places = range(3 if exactly else 1)
    return all(_is_zero(quantity, rates, values, chance, exactly=exactly) for _ in places)


# A state and its rate.
Rate = tuple[sp.Basic, sp.Expr]


@lru_cache
def _vanishes(quantity: sp.Expr, rates: tuple[Rate, ...]) -> bool:
    """Whether the rate of a quantity vanishes for random values of the parameters."""
    chance = Random(21)
    return all(_is_zero(quantity, rates, {}, chance, exactly=True) for _ in range(3))


def _is_zero(
    quantity: sp.Expr,
    rates: tuple[Rate, ...],
    values: Mapping[str, Number],
    chance: Random,
    *,
    exactly: bool,
) -> bool:
    """Whether the rate of a quantity vanishes at a random place, in doubles or to 60 digits."""
    names, made_of = _change(quantity, rates)
    assert made_of is not None
    place = {**values, **_rotation(chance)}
    here = [place.get(name, _number(chance)) for name in names]
    try:
        rough = made_of.numpy()(*[float(x) for x in here]).tolist()
        # More digits of exp(exp(exp(...))) would take for ever.
        if not all(map(math.isfinite, rough)):
            return False
        # Where doubles see a rate, it need not be worked out exactly.
        if abs(math.fsum(rough)) > PRINTED * max(map(abs, rough)):
            return False
        if not exactly:
            return True
        terms = made_of.exactly(here)
        with working_precision(EXACT_BITS):
            return bool(abs(sum(terms[1:], terms[0])) <= NOTHING * max(map(abs, terms)))
    # A root or a logarithm that has no real value at that place proves nothing.
    except (ArithmeticError, ValueError, TypeError, GeomtorsionError):
        return False


@lru_cache
def _change(quantity: sp.Expr, rates: tuple[Rate, ...]) -> tuple[list[str], Graph | None]:
    """Terms of the rate of a quantity, with the names in them; None where there are no terms."""
    terms = [sp.diff(quantity, symbol) * rate for symbol, rate in rates]
    # What vanishes in one piece may not in another: pieces count as further unknowns.
    parts = pieces.all_pieces(terms)
    unknown = {part: sp.Symbol(f"piece {k}", real=True) for k, part in enumerate(parts)}
    terms = [term.xreplace(unknown) for term in terms if term != 0]
    names = sorted({symbol.name for term in terms for symbol in term.free_symbols})
    return names, graph(names, terms, factor=False) if terms else None


def _rotation(chance: Random) -> dict[str, Number]:
    """Elements of a random rotation R, exact."""
    q = [chance.randint(1, 9) for _ in QUATERNION]
    size, rows = sum(x * x for x in q), attitude.rotation_rows(q)
    elements = (Fraction(element, size) for row in rows for element in row)
    return dict(zip((symbol.name for symbol in ATTITUDE), elements, strict=True))


def _number(chance: Random) -> Fraction:
    """A fraction that no special relation suggests."""
    return Fraction(chance.randint(101, 997), chance.choice((107, 211, 307)))

"""To ODE: a scene as first-order equations with start, numbers and invariants, and read back."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING

import numpy as np
import sympy as sp

from geomtorsion.checks import expression as expression_of
from geomtorsion.errors import SceneError, StartError
from geomtorsion.ode import ODE, At, When
from geomtorsion.precision import PRINTED
from geomtorsion.rigid import attitude
from geomtorsion.scenes.assembly import by_quaternion
from geomtorsion.scenes.conserved import invariants
from geomtorsion.scenes.context import (
    ATTITUDE,
    OMEGA,
    POSITION,
    QUATERNION,
    VELOCITY,
    VERTICAL,
    Number,
)

if TYPE_CHECKING:
    from geomtorsion.scenes.scene import Scene
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


def attitude_states(selection: StateSelection) -> dict[sp.Symbol, sp.Expr]:
    """Elements of R by the quaternion, where the whole attitude is followed."""
    return by_quaternion() if selection.uses_quaternion else {}


def ode_of(scene: Scene) -> ODE:
    """The equations of a scene: one compiled integrator serves all scenes with equal equations."""
    selection = scene.selection
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
    if len(stops) > 1:
        raise SceneError("two effects stop the motion. Keep one of them.")
    events: list[At | When] = []
    for part in parts:
        # Times are numbers of any kind; `ODE.of` checks them.
        events += [At(time, changes) for time, changes in part.switches]  # type: ignore[arg-type]
    if stops:
        events.append(When(assembly.constrained(stops[0]).xreplace(chosen)))
    return ODE.of(
        pruned_rates(selection),
        start_of(selection, scene.start),
        parameters=parameters_of(selection, scene.start),
        invariants=invariants(selection, scene.correct_assembly, chosen),
        outputs=outputs,
        events=events,
        normalized=unit,
        name=scene.title or scene.name,
    )


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
            "the start has no angular velocity, which is needed. "
            "Give State(omega=(0, 0, 1), ...), rad/s in body axes."
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
    """The error that the start says nothing of the attitude."""
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
        given = getattr(start, name)
        if given is None or not any(s in assembly.substitutions for s in symbols):
            continue
        values = dict(assembly.values) | {s.name: v for s, v in table.items()}
        allowed = []
        for symbol in symbols:
            tie = assembly.substitutions.get(symbol, symbol)
            if any(s.name not in values for s in tie.free_symbols):
                return
            allowed.append(float(tie.subs({s: values[s.name] for s in tie.free_symbols})))
        size = max(1e-300, *(abs(float(x)) for x in (*given, *allowed)))
        if any(abs(a - float(b)) > PRINTED * size for a, b in zip(allowed, given, strict=True)):
            shown = ", ".join(f"{x:.6g}" for x in allowed)
            raise SceneError(
                f"the start has {name} = {tuple(given)}, but the constraint makes it ({shown}). "
                f"Leave {name} out of the start, or give it this value."
            )


# -- states read back -----------------------------------------------------------------------------


def observed(
    ode: ODE, selection: StateSelection, times: np.ndarray, states: np.ndarray
) -> dict[str, np.ndarray]:
    """What is watched, by name, of states of shape (m, size) at these times."""
    found = ode.read_outputs(times, states)
    values = {}
    for item in selection.watch:
        value = found[f"watch {item.name}"]
        if item.finish is not None:
            value = item.finish(value)
        values[item.name] = value if item.labels or value.ndim == 1 else value[:, 0]
    return values

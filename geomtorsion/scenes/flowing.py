"""Flowing: the equations that a plan leaves, as a flow with start, numbers and invariants."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

import sympy as sp

from geomtorsion.errors import SceneError, StartError
from geomtorsion.motion.flows import flow
from geomtorsion.rigid import attitude
from geomtorsion.scenes.assembly import by_quaternion
from geomtorsion.scenes.conserved import invariants
from geomtorsion.scenes.context import ATTITUDE, OMEGA, POSITION, QUATERNION, VELOCITY, VERTICAL
from geomtorsion.scenes.intake import missing_attitude

if TYPE_CHECKING:
    from geomtorsion.motion.flows import Flow
    from geomtorsion.scenes.plan import ScenePlan
    from geomtorsion.scenes.scene import Scene

# A start that contradicts a constraint by less than this (relative) is taken for rounded.
ROUNDED = 1e-9


def pruned_rates(plan: ScenePlan) -> dict[str, Any]:
    """State -> rate, in the attitude states that the plan chose."""
    made, rates = plan.assembly, {}
    turning = dict(zip(QUATERNION, attitude.quaternion_rates(QUATERNION, made.omega), strict=True))
    chosen = attitude_states(plan)
    for symbol in plan.symbols:
        if symbol in turning:
            rate = turning[symbol]
        elif symbol in VERTICAL:
            rate = made.turning(symbol)
        else:
            rate = made.rates[symbol]
        rates[symbol.name] = rate.xreplace(chosen)
    return rates


def attitude_states(plan: ScenePlan) -> dict[Any, Any]:
    """Elements of R by the quaternion, where the whole attitude is followed."""
    return by_quaternion() if plan.uses_quaternion else {}


def flow_of(scene: Scene) -> Flow:
    """The flow of a scene: one compiled integrator serves all scenes with equal equations."""
    plan = scene.plan()
    chosen = attitude_states(plan)
    unit = [
        tuple(s.name for s in group) for group in (QUATERNION, VERTICAL) if group[0] in plan.symbols
    ]
    outputs = {
        f"watch {item.name}": [sp.sympify(x).xreplace(chosen) for x in item.made_of(plan.assembly)]
        for item in plan.watch
    }
    parts = [part for key, part in plan.assembly.parts.items() if key in plan.effects]
    stops = [part.stop for part in parts if part.stop is not None]
    if len(stops) > 1:
        raise SceneError("two effects stop the motion. Keep one of them.")
    stop = plan.assembly.tied(stops[0]).xreplace(chosen) if stops else None
    return flow(
        pruned_rates(plan),
        start_of(scene),
        parameters=parameters_of(scene),
        invariants=invariants(plan, scene.lawful, chosen),
        outputs=outputs,
        switches=[switch for part in parts for switch in part.switches],
        stop=stop,
        unit=unit,
        name=scene.title or scene.name,
    )


def parameters_of(scene: Scene) -> dict[str, Any]:
    """Parameter -> number, exact where it is; velocities that do not change are among them."""
    plan = scene.plan()
    velocity = dict(zip(VELOCITY, _start(scene).velocity or (0, 0, 0), strict=True))
    return {**plan.assembly.values, **{s.name: velocity[s] for s in plan.constants}}


def start_of(scene: Scene) -> dict[str, Any]:
    """State -> number at the start.

    Raises
    ------
    StartError
        the start lacks an angular velocity or an attitude that is needed.
    SceneError
        the start contradicts a constraint.
    """
    plan, state = scene.plan(), _start(scene)
    made = plan.assembly
    table: dict[Any, Any] = {sp.Symbol(name): value for name, value in made.start.items()}
    if any(s in plan.symbols for s in OMEGA) and state.omega is None:
        raise StartError(
            "the start has no angular velocity, which is needed. "
            "Give State(omega=(0, 0, 1), ...), rad/s in body axes."
        )
    table |= dict(zip(OMEGA, state.omega or (0, 0, 0), strict=True))
    q = state.attitude
    if q is None and {QUATERNION[0], VERTICAL[0]} & set(plan.symbols):
        raise missing_attitude(plan)
    if q is not None:
        matrix = attitude.matrix_from_quaternion(q)
        table |= {s: float(x) for s, x in zip(QUATERNION, q, strict=True)}
        table |= {ATTITUDE[i, j]: float(matrix[i, j]) for i in range(3) for j in range(3)}
    table |= dict(zip(POSITION, state.position or (0, 0, 0), strict=True))
    table |= dict(zip(VELOCITY, state.velocity or (0, 0, 0), strict=True))
    _check_ties(scene, table)
    return {symbol.name: table[symbol] for symbol in plan.symbols}


def _check_ties(scene: Scene, table: Mapping[Any, Any]) -> None:
    """Refuse a start that a constraint does not allow."""
    state, made = _start(scene), scene.plan().assembly
    for name, symbols in (("omega", OMEGA), ("velocity", VELOCITY), ("position", POSITION)):
        given = getattr(state, name)
        if given is None or not any(s in made.ties for s in symbols):
            continue
        values = dict(made.values) | {s.name: v for s, v in table.items()}
        allowed = []
        for symbol in symbols:
            tie = made.ties.get(symbol, symbol)
            if any(s.name not in values for s in tie.free_symbols):
                return
            allowed.append(float(tie.subs({s: values[s.name] for s in tie.free_symbols})))
        size = max(1e-300, *(abs(float(x)) for x in (*given, *allowed)))
        if any(abs(a - float(b)) > ROUNDED * size for a, b in zip(allowed, given, strict=True)):
            shown = ", ".join(f"{x:.6g}" for x in allowed)
            raise SceneError(
                f"the start has {name} = {tuple(given)}, but the constraint makes it ({shown}). "
                f"Leave {name} out of the start, or give it this value."
            )


def _start(scene: Scene) -> Any:
    return scene.start

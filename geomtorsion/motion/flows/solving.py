"""Solving flows: to the accuracy asked for, or an error that says what can be had."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Sequence
from pathlib import Path
from typing import Any

from geomtorsion.errors import AccuracyError, StartError, StuckError
from geomtorsion.motion.checking import Checked, checked
from geomtorsion.motion.engines.protocol import Engine
from geomtorsion.motion.engines.rungekutta import RungeKutta, Stiff
from geomtorsion.motion.engines.taylor import Taylor
from geomtorsion.motion.flows.adjust import unit_rows
from geomtorsion.motion.flows.beside import solved_beside
from geomtorsion.motion.flows.checkpoint import LEGS, Checkpoint, Keeper, fingerprint, steady
from geomtorsion.motion.flows.compare import difference
from geomtorsion.motion.flows.flow import Flow
from geomtorsion.motion.flows.law import CLOCK
from geomtorsion.motion.flows.reading import arguments
from geomtorsion.motion.flows.solution import FlowSolution
from geomtorsion.motion.flows.travel import Leg, Recipe, Trip, cut_legs, travel
from geomtorsion.motion.in_turn import told_in_turn
from geomtorsion.motion.solution import Cost
from geomtorsion.motion.solving import (
    ROUNDINGS,
    STIFF,
    checked_accuracy,
    checked_times,
    choices,
    remedy,
)

Progress = Callable[[float], None]
Engines = Iterator[tuple[Engine, str]]
Travel = Callable[[Engine, float, float], Trip]


def solve_flow(
    flow: Flow,
    t: Any,
    accuracy: float = 1e-10,
    engine: Engine | None = None,
    checkpoint: str | Path | None = None,
    progress: Progress | None = None,
    *,
    overwrite: bool = False,
) -> FlowSolution:
    """Solve a flow; see `solve`."""
    accuracy = checked_accuracy(accuracy)
    times, grid = checked_times(t)
    room = flow.room(0.0, flow.start, flow.parameters)
    if not room >= 0:
        raise StartError(
            f"stop = {flow.law.stop} is {room:.6g} at the start already. Start where it is above "
            "zero; the motion ends where it falls through it."
        )
    end = float(grid[-1])
    if checkpoint is None and progress is None:
        legs = cut_legs(flow, end, 1)
        learned = flow.system.__dict__.setdefault("_learned", {})
        return _solved(flow, times, grid, legs, accuracy, engine, learned, None)
    legs = cut_legs(flow, end, LEGS)
    kept = None
    if checkpoint is not None:
        kept = Checkpoint(
            checkpoint, fingerprint(flow, times, accuracy, engine), overwrite=overwrite
        )
    keeper = Keeper(flow, kept, len(legs), progress)
    try:
        # What other runs have taught is left aside: this one must end the same in any company.
        solution = _solved(flow, times, grid, legs, accuracy, engine, {}, keeper)
    finally:
        if kept is not None:
            kept.write()
    keeper.tell(1.0)
    return solution


def engines(flow: Flow, legs: Sequence[Leg], accuracy: float, engine: Engine | None) -> Engines:
    """Engines in the order in which to try them, each with the reason."""
    for candidate, why in choices(lambda: is_stiff(flow, legs), accuracy, engine):
        if engine is None and isinstance(candidate, Stiff):
            # Of higher order than Radau, and as good between its steps as at them.
            yield Stiff("LSODA"), why
        yield candidate, why


def _solved(
    flow: Flow,
    times: Any,
    grid: Any,
    legs: Sequence[Leg],
    accuracy: float,
    engine: Engine | None,
    learned: dict[Any, float],
    keeper: Keeper | None,
) -> FlowSolution:
    """The answer of the first engine and tolerance that are good enough."""

    made: dict[tuple[Engine, float, float], Trip] = {}

    def go(solver: Engine, tolerance: float, moved: float) -> Trip:
        key = solver, tolerance, moved
        if key not in made:
            made[key] = travel(flow, solver, tolerance, grid, legs, keeper, moved=moved)
        return made[key]

    spent: list[Trip] = []
    best = math.inf
    for candidate, why in engines(flow, legs, accuracy, engine):
        if keeper is not None:
            candidate = steady(candidate)
        found = None
        if keeper is None and isinstance(candidate, Taylor) and candidate.precision == 53:
            found = solved_beside(flow, candidate, grid, legs, accuracy, learned)
        if keeper is None and isinstance(candidate, RungeKutta):
            found = _in_turn(go, candidate, accuracy, learned)
        if found is None:
            found = _refined(flow, go, candidate, accuracy, learned)
        spent += found.spent
        best = min(best, found.error)
        if found.error <= accuracy or found.answer.outcome == "stuck":
            cuts = 1 if keeper is None else LEGS
            recipe = Recipe(candidate, found.answer.tolerance, grid, cuts)
            solution = _solution(flow, times, accuracy, why, found, spent, recipe)
            if not solution.complete:
                raise StuckError(_stuck(solution), solution)
            return solution
    names = dict.fromkeys(trip.engine.name for trip in spent)
    raise AccuracyError(
        f"accuracy {accuracy:.3g} was asked for; {', then '.join(names) or 'no engine at hand'} "
        f"gets to {best:.2g}. " + remedy(engine)
    )


def _in_turn(
    go: Travel, engine: RungeKutta, accuracy: float, learned: dict[Any, float]
) -> Checked[Trip] | None:
    """Answer, check and error; None where a finer run has to tell."""
    return told_in_turn(
        engine,
        accuracy,
        learned,
        lambda tolerance: go(engine, tolerance, 0.0),
        lambda tolerance, part: go(engine, tolerance, ROUNDINGS * part),
        difference,
    )


def _refined(
    flow: Flow, go: Travel, engine: Engine, accuracy: float, learned: dict[Any, float]
) -> Checked[Trip]:
    """Answer, check and error of the first tolerance that is good enough, or of the last."""
    key = (engine.name, accuracy)
    found = checked(
        engine,
        accuracy,
        learned.get(key) or engine.first(accuracy),
        lambda tolerance: go(engine, tolerance, 0.0),
        difference,
        lambda trip: trip.outcome == "stuck",
        # Near separatrices rounding grows without end, which a coarser run does not show.
        coarse=False,
        disturbed=lambda tolerance, part: go(engine, tolerance, part),
    )
    if found.error <= accuracy:
        learned[key] = found.answer.tolerance
    return found


def is_stiff(flow: Flow, legs: Sequence[Leg]) -> bool:
    """Whether some direction decays much faster than the motion lasts; False if unknown."""
    return any(
        decay_rate(flow, leg, STIFF / abs(leg.end - leg.begin)) * abs(leg.end - leg.begin) > STIFF
        for k, leg in enumerate(legs)
        if (k == 0 or leg.numbers is not legs[k - 1].numbers) and leg.end != leg.begin
    )


def decay_rate(flow: Flow, leg: Leg, least: float = 0.0) -> float:
    """The largest rate at which a neighbouring motion decays towards this one, at the start.

    Rates that are surely not above the least one are not worked out, and given as zero.
    """
    import numpy as np

    values = [float(x) for x in leg.numbers]
    state = [float(x) for x in flow.start] + ([leg.begin / CLOCK] if flow.law.clock else [])
    try:
        matrix = flow.system.scalar_jacobian(values)(0.0, np.array(state))
        matrix = matrix[: flow.size, : flow.size]
    except (ArithmeticError, ValueError):
        return 0.0
    if not np.isfinite(matrix).all() or np.abs(matrix).sum(axis=1).max() <= least:
        return 0.0
    return float(-np.linalg.eigvals(matrix).real.min())


def _solution(
    flow: Flow,
    times: Any,
    accuracy: float,
    why: str,
    found: Checked[Trip],
    spent: list[Trip],
    recipe: Recipe,
) -> FlowSolution:
    """The answer with what is known about it."""
    import numpy as np

    answer = found.answer

    rows = np.asarray(answer.states)
    if accuracy >= 2.0**-53:
        rows = rows.astype(float)
    skip = 1 if times[0] != 0 and len(rows) else 0
    rows, reached = rows[skip:], times[: max(len(rows) - skip, 0)]
    if answer.outcome == "stopped" and (not len(reached) or reached[-1] != answer.reached):
        last = np.asarray(answer.pieces[-1].run.last)[None, : flow.size].astype(rows.dtype)
        rows = np.concatenate((rows, last))
        reached = np.concatenate((reached, [answer.reached]))
    if rows.dtype == float:
        rows = unit_rows(flow, rows)
    run_seconds = answer.run_seconds
    cost = Cost(
        answer.steps,
        answer.evaluations,
        sum([trip.compile_seconds for trip in spent]),
        run_seconds,
        sum([trip.run_seconds for trip in spent]) - run_seconds,
    )
    return FlowSolution(
        flow,
        reached,
        rows,
        accuracy,
        found.error,
        answer.engine.name,
        why,
        cost,
        answer.outcome,
        answer.reason,
        recipe,
        answer,
        found.against,
        found.share,
    )


def _stuck(solution: FlowSolution) -> str:
    """Where a motion got stuck, why, and what can be done."""
    trip, names = solution.trip, solution.flow.states
    last = [float(x) for x in list(trip.pieces[-1].run.last)[: len(names)]]
    pairs = zip(names, last, strict=True)
    place = ", ".join(f"{name} = {x:.6g}" for name, x in pairs if math.isfinite(x))
    rates = zip(names, _rates(solution, last), strict=True)
    bad = [f"{name}' = {x:.3g}" for name, x in rates if not math.isfinite(x)]
    why = f"{trip.reason}; {', '.join(bad)}" if bad else trip.reason
    return (
        f"the motion cannot go on at t = {trip.reached:.6g}, at {place}: {why}. Stop "
        "earlier, or give stop=... for where it ends. What was computed is in the error's "
        "`solution`."
    )


def _rates(solution: FlowSolution, last: Sequence[float]) -> list[float]:
    """Rates where a motion got stuck."""
    import numpy as np

    flow, reached = solution.flow, float(solution.trip.reached)
    row = arguments(flow, np.array([reached]), np.array([last]))
    return [float(np.ravel(x)[0]) for x in flow.rate_tape.arrays(row)]

"""Abreast: a motion and the runs that tell its error, side by side in the lanes of one integrator.

A processor adds four pairs of numbers as fast as one. So the answer runs in the first lane of
heyoka's batch mode, and beside it, nearly for nothing, the same motion with longer steps, and two
more whose steps and starts differ a little: how far these come apart shows how rounding grows.
"""

from __future__ import annotations

import math
import time
from typing import TYPE_CHECKING, Any, NamedTuple

from geomtorsion.motion.engines.protocol import Run
from geomtorsion.motion.engines.store import order_of, ready, tolerance_of

if TYPE_CHECKING:
    from geomtorsion.motion.engines.taylor import Taylor
    from geomtorsion.motion.system import System

# The second lane may leave out so many times as much of its series: four orders' worth ...
LOOSER = math.exp(8.0)
# ... but not so much that its error is above this, where two runs say nothing about each other.
VISIBLE = 1e-3
LEAST_LOOSER = 30.0
# Lanes that round differently leave out so many times as much, one more than the other. (Less
# would be no less where states are small: heyoka takes no size below one.)
OTHERWISE = 1.5
# The answer, longer steps, and two that round differently.
LANES = 4
# Runs of more steps than this are left to one lane, which looks whether it gets anywhere.
MOST_STEPS = 30_000
# Steps that a share can be told by.
FEW_STEPS = 8


class Abreast(NamedTuple):
    """The runs of all lanes, complete; the first is the answer.

    states: shape (m, size, lanes).
    extents: how large states are in the first lane, and how far from it in others (see `extents`).
    steps: of each lane.
    share: error of the answer over that of the second lane.
    """

    times: Any
    states: Any
    extents: list[list[float]]
    steps: tuple[int, ...]
    order: int
    share: float
    compile_seconds: float
    run_seconds: float

    def run(self, lane: int, states: Any = None) -> Run:
        """One lane as a run of its own; states: others in their place."""
        rows = self.states[:, :, lane] if states is None else states
        steps, answer = self.steps[lane], lane == 0
        return Run(
            self.times,
            rows,
            float(self.times[-1]),
            rows[-1],
            "done",
            steps,
            steps * (self.order + 1),
            self.compile_seconds if answer else 0.0,
            self.run_seconds if answer else 0.0,
        )


def looseness(accuracy: float) -> float:
    """By how much the second lane leaves out more, for an accuracy of the result."""
    return min(LOOSER, max(LEAST_LOOSER, VISIBLE / accuracy))


def run_abreast(
    engine: Taylor,
    system: System,
    starts: Any,
    parameters: Any,
    times: Any,
    tolerance: float,
    looser: float,
    size: float,
) -> Abreast | None:
    """Integrate lanes through times; None where that tells nothing.

    Where one of them does not come to the end, or all take the same steps.

    starts, parameters: shapes (size of the system, LANES) and (parameters, LANES) or one for all.
    looser: see `looseness`.
    size: what the tolerance is relative to; larger than any state.
    """
    order = order_of(tolerance)
    compiled, compiling = ready(
        system, order, 53, LANES, engine.optimised, engine.number, abreast=True
    )
    integrator = compiled.integrator
    with compiled.lock:
        began = time.perf_counter()
        integrator.set_time(float(times[0]))
        state = integrator.state
        state[:-1] = starts
        # heyoka measures what it leaves out by the largest state: here that is one of our own.
        state[-1] = size, looser * size, OTHERWISE * size, OTHERWISE**2 * size
        if system.parameters:
            integrator.pars[:] = parameters
        touched: set[int] = set()
        if system.edge is not None:
            integrator.reset_cooldowns()
            touched = integrator.nt_events[0].callback.lanes
            touched.clear()
        grid = times.repeat(LANES).reshape(-1, LANES)
        rows = integrator.propagate_grid(grid, max_steps=MOST_STEPS)[1]
        results, at_edge = integrator.propagate_res, bool(touched)
    ended = time.perf_counter()
    compiled.used += ended - began
    arrived = type(results[0][0]).time_limit
    if at_edge or [x[0] for x in results] != [arrived] * LANES:
        return None
    if results[2] == results[0] or results[3] == results[0]:
        # Lanes that take the same steps tell nothing.
        return None
    steps = tuple([result[3] for result in results])
    states = rows[:, :-1]
    share = _share(steps, order, looser)
    return Abreast(times, states, extents(states), steps, order, share, compiling, ended - began)


def extents(states: Any) -> list[list[float]]:
    """For each lane a number for each state, the largest at any time, without sign.

    In the first lane of the state itself, in others of its difference to the first lane.

    states: shape (m, size, lanes).
    """
    import numpy as np

    # One state of one lane after the other: numbers in a row are worked through the fastest.
    rows = states.T.copy()
    others = rows[1:]
    others -= rows[0]
    return np.maximum.reduce(np.abs(rows, rows), 2).tolist()


def _share(steps: tuple[int, ...], order: int, looser: float) -> float:
    """Error of the first lane over that of the second.

    What a series of this order leaves out adds up to the step to the power of the order.
    """
    if min(steps[:2]) < FEW_STEPS:
        return 1.0 / looser
    return (steps[1] / steps[0]) ** order


def tolerance_of_second(tolerance: float, looser: float) -> float:
    """The tolerance of a run by itself that is about as good as the second lane."""
    return tolerance_of(max(order_of(tolerance * looser), 2))

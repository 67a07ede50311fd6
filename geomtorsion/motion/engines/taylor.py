"""Taylor: adaptive Taylor series, compiled by heyoka; any precision."""

from __future__ import annotations

import math
import time
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cache, lru_cache
from typing import Any

from geomtorsion.errors import LimitError
from geomtorsion.motion.engines.last_place import last_regular
from geomtorsion.motion.engines.protocol import Effort, Run
from geomtorsion.motion.engines.record import Record
from geomtorsion.motion.engines.store import (
    Compiled,
    heyoka,
    is_available,
    order_of,
    ready,
    tolerance_of,
)
from geomtorsion.motion.system import System, mpf

__all__ = ["Taylor", "heyoka", "is_available"]

# Between looks at whether a run still gets anywhere: by this part of its time at least.
STANDSTILL = 1e-8
STEPS_AT_ONCE = 2_000
# Orders of which the error is told by a run of lower order: from here on, ...
LOWEST_CHECKED = 6
# ... as far as rounding, so many units in the last place a step, leaves room.
ROUNDING = 10.0


@cache
def _highest_checked(precision: int) -> int:
    """Above this order rounding is more than a few times what the series leaves out."""
    return int(0.5 * math.log(2 / ROUNDING * 2.0**precision)) - 1


@lru_cache(maxsize=256)
def _coarser(tolerance: float, precision: int) -> float | None:
    order = order_of(tolerance)
    if not LOWEST_CHECKED <= order <= _highest_checked(precision):
        return None
    return tolerance_of(order - 4 if order >= LOWEST_CHECKED + 2 else order - 2)


@lru_cache(maxsize=256)
def _shrinks(fine: float, coarse: float, precision: int) -> float | None:
    """Error of a fine run over that of a coarse one.

    Steps are 1/e^2 of the radius of convergence: each order is worth a factor e^2. What rounding
    adds to the fine run is told by how much the error of the coarse one has grown.
    """
    low, high = order_of(coarse), order_of(fine)
    if high - low not in (2, 4) or high > _highest_checked(precision) or low < LOWEST_CHECKED - 2:
        return None
    return math.exp(2 * (low - high)) + ROUNDING * 2.0**-precision * math.exp(2 * low + 2)


@dataclass(frozen=True)
class Taylor:
    """Adaptive Taylor series by heyoka (extra `fast`).

    precision: bits of the mantissa: 53 (double), 64 (long double), 113 (quadruple) or more.
    optimised: whether to compile for speed at once; None: at once for small equations, for
        large ones when they have run for a second.
    max_steps: after so many steps a run is given up.

    Examples
    --------
    >>> Taylor(precision=113).name
    'Taylor(113)'
    """

    precision: int = 53
    optimised: bool | None = None
    max_steps: int = 5_000_000

    @property
    def name(self) -> str:
        """How it is called in tables."""
        return "Taylor" if self.precision == 53 else f"Taylor({self.precision})"

    @property
    def finest(self) -> float:
        """A tolerance at which only rounding is left."""
        return 2.0 ** -(self.precision + 6)

    def first(self, accuracy: float) -> float:
        """See `Engine.first`: the error of a motion is near the tolerance of its series."""
        return tolerance_of(max(order_of(max(accuracy, self.finest)), LOWEST_CHECKED))

    def rung(self, tolerance: float) -> float:
        """See `Engine.rung`: one rung per order of the series."""
        return tolerance_of(order_of(tolerance))

    def finer(self, tolerance: float) -> float | None:
        """See `Engine.finer`: two orders more."""
        order, last = order_of(tolerance), order_of(self.finest)
        return tolerance_of(min(order + 2, last)) if order < last else None

    def coarser(self, tolerance: float) -> float | None:
        """See `Engine.coarser`: four orders less, as long as rounding plays no part."""
        return _coarser(tolerance, self.precision)

    def shrinks(self, fine: Effort, coarse: Effort) -> float | None:
        """See `Engine.shrinks`."""
        return _shrinks(fine.tolerance, coarse.tolerance, self.precision)

    def number(self, value: Any) -> Any:
        """A number in the type of this precision, correctly rounded."""
        if self.precision == 53:
            return float(value)
        import mpmath
        import numpy as np

        hy = heyoka()
        if type(value).__name__ in ("longdouble", "real128", "real"):
            text = str(value)
        else:
            digits = mpmath.nstr(mpf(value, self.precision + 20), int(self.precision * 0.302) + 6)
            text = str(digits)
        if self.precision == 64:
            return np.longdouble(text)
        if self.precision == 113:
            return hy.real128(text)
        return hy.real(text, self.precision)

    def array(self, values: Sequence[Any]) -> Any:
        """Numbers in the type of this precision."""
        import numpy as np

        if self.precision == 53:
            if isinstance(values, np.ndarray) and values.dtype == np.float64:
                return values
            return np.array([float(value) for value in values])
        kind = type(self.number(0))
        return np.array([self.number(value) for value in values], dtype=kind)

    def ready(self, system: System, tolerance: float, batch: int = 0) -> tuple[Compiled, float]:
        """The compiled integrator of a system, from the store or made now; seconds it took."""
        order = order_of(tolerance)
        return ready(system, order, self.precision, batch, self.optimised, self.number)

    def run(
        self,
        system: System,
        start: Sequence[Any],
        parameters: Sequence[Any],
        times: Any,
        tolerance: float,
        *,
        dense: bool = False,
    ) -> Run:
        """See `Engine.run`."""
        compiled, compiling = self.ready(system, tolerance)
        integrator, record = compiled.integrator, None
        # Nobody else may use the integrator meanwhile.
        with compiled.lock:
            began = time.perf_counter()
            state, grid, start = integrator.state, self.array(times), self.array(start)
            integrator.time = grid[0]
            state[:] = start
            if system.parameters:
                integrator.pars[:] = self.array(parameters)
            if system.edge is not None:
                integrator.reset_cooldowns()
            if dense:
                # The steps are the same with and without the grid, so this comes first.
                record = Record(integrator, grid[0])
                integrator.propagate_until(grid[-1], callback=record, write_tc=True)
                integrator.time = grid[0]
                state[:] = start
            states, outcome, steps, reason = self._propagated(integrator, grid)
            if outcome == "stuck":
                import numpy as np

                place = last_regular(integrator, grid[0], start, grid[-1], steps)
                integrator.time, state[:] = place
                lasted = abs(float(place[0] - grid[0]))
                states = states[np.abs((grid[: len(states)] - grid[0]).astype(float)) <= lasted]
            ended = time.perf_counter()
            compiled.used += ended - began
            return Run(
                grid[: len(states)],
                states,
                integrator.time,
                state.copy(),
                outcome,
                steps,
                steps * (integrator.order + 1),
                compiling,
                ended - began,
                record.dense() if record is not None else None,
                reason,
            )

    def _propagated(self, integrator: Any, grid: Any) -> tuple[Any, str, int, str]:
        """States on the grid, outcome, steps and reason; stops a run that gets nowhere."""
        if grid[0] == grid[-1]:
            return integrator.state.copy()[None, :], "done", 0, ""
        at_once = STEPS_AT_ONCE if self.precision <= 64 else STEPS_AT_ONCE // 4
        out = integrator.propagate_grid(grid, max_steps=at_once)
        if out[0] == type(out[0]).time_limit:
            return out[5], "done", out[3], ""
        import numpy as np

        rows, done, steps, before = [], 0, 0, grid[0]
        while True:
            code = int_of(out[0])
            steps += out[3]
            new = out[5][1:] if done else out[5]
            rows.append(new)
            done += len(new)
            if code == TIME_LIMIT:
                return (rows[0] if len(rows) == 1 else np.concatenate(rows)), "done", steps, ""
            if code != STEP_LIMIT:
                states = np.concatenate(rows)
                if code == NOT_FINITE:
                    good = np.isfinite(states.astype(float)).all(axis=1)
                    keep = len(states) if good.all() else int(np.argmin(good))
                    return states[:keep], "stuck", steps, NO_VALUE
                return states, "edge", steps, ""
            moved = abs(float(integrator.time - before))
            if moved < STANDSTILL * abs(float(grid[-1] - grid[0])):
                return np.concatenate(rows), "stuck", steps, "the steps became too small"
            if steps > self.max_steps:
                raise LimitError(
                    f"more than {self.max_steps} steps were needed by t = {integrator.time:.6g}. "
                    "Ask for less accuracy or time, use engine=Stiff(), or raise max_steps."
                )
            before = integrator.time
            rest = np.concatenate(([before], grid[done:]))
            out = integrator.propagate_grid(rest, max_steps=at_once)


NO_VALUE = "the series has no finite value"
TIME_LIMIT, STEP_LIMIT, NOT_FINITE = "time_limit", "step_limit", "err_nf_state"


def int_of(outcome: Any) -> str:
    """The name of heyoka's outcome; terminal events have none."""
    return str(getattr(outcome, "name", "event"))

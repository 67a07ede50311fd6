"""RungeKutta and Stiff: DOP853, Radau and LSODA on generated code."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

from geomtorsion.motion.engines.float_run import float_run
from geomtorsion.motion.engines.protocol import Effort, Run
from geomtorsion.motion.engines.scipy_run import FLOOR, scipy_run
from geomtorsion.motion.engines.stepper import LARGEST
from geomtorsion.motion.system import System

# The first tolerance is this much below the accuracy.
MARGIN = 0.1
# An answer is held against a run with a tolerance larger by this; its steps are 1.8 times as long.
COARSER = 100.0
# Fewer steps than this, or less than half the error gained, tell nothing.
FEW_STEPS, LITTLE_GAIN = 40, 0.5


@dataclass(frozen=True)
class RungeKutta:
    """Explicit Runge-Kutta of order 8 (DOP853) on generated code; needs no extra.

    Systems of few states step on plain floats, larger ones in scipy.

    max_evaluations: after so many evaluations of the rates the run is given up.

    Examples
    --------
    >>> RungeKutta().name
    'RungeKutta'
    """

    max_evaluations: int = 20_000_000

    name = "RungeKutta"
    precision = 53
    # Below scipy's own floor of 2.3e-14 the steps are shortened instead.
    finest = 1e-17

    def first(self, accuracy: float) -> float:
        """See `Engine.first`."""
        return max(self.rung(min(accuracy * MARGIN, 1e-3)), 3 * self.finest)

    def rung(self, tolerance: float) -> float:
        """See `Engine.rung`: four to a power of ten."""
        return 10.0 ** (math.floor(4 * math.log10(tolerance) + 1e-9) / 4)

    def finer(self, tolerance: float) -> float | None:
        """See `Engine.finer`."""
        return _finer(tolerance, self.finest)

    def coarser(self, tolerance: float) -> float | None:
        """See `Engine.coarser`: none near the rounding, nor where it would be too coarse."""
        coarse = tolerance * COARSER
        return coarse if tolerance > 5 * FLOOR and coarse <= 1.01e-3 else None

    def shrinks(self, fine: Effort, coarse: Effort) -> float | None:
        """See `Engine.shrinks`: the eighth power of the step length, seen from the steps taken."""
        wider = coarse.tolerance / fine.tolerance
        if not 0.99 * COARSER <= wider <= 1.01 * COARSER or fine.steps < FEW_STEPS:
            return None
        return shrunk(fine, coarse)

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
        if system.size <= LARGEST:
            return float_run(
                self.max_evaluations, system, start, parameters, times, tolerance, dense
            )
        return scipy_run(
            "DOP853", self.max_evaluations, system, start, parameters, times, tolerance, dense
        )


@dataclass(frozen=True)
class Stiff:
    """Implicit solvers (scipy Radau or LSODA) with the exact Jacobian.

    method: "Radau" or "LSODA".
    max_evaluations: after so many evaluations of the rates the run is given up.

    Examples
    --------
    >>> Stiff().name
    'Stiff(Radau)'
    """

    method: str = "Radau"
    max_evaluations: int = 5_000_000

    precision = 53
    finest = 3e-13

    @property
    def name(self) -> str:
        """How it is called in tables."""
        return f"Stiff({self.method})"

    def first(self, accuracy: float) -> float:
        """See `Engine.first`."""
        return max(self.rung(min(accuracy * MARGIN, 1e-3)), 3 * self.finest)

    def rung(self, tolerance: float) -> float:
        """See `Engine.rung`: four to a power of ten."""
        return 10.0 ** (math.floor(4 * math.log10(tolerance) + 1e-9) / 4)

    def finer(self, tolerance: float) -> float | None:
        """See `Engine.finer`."""
        return _finer(tolerance, self.finest)

    def coarser(self, tolerance: float) -> float | None:
        """See `Engine.coarser`: implicit steps are not bound to the error."""
        return None

    def shrinks(self, fine: Effort, coarse: Effort) -> float | None:
        """See `Engine.shrinks`: not known."""
        return None

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
        return scipy_run(
            self.method, self.max_evaluations, system, start, parameters, times, tolerance, dense
        )


def shrunk(fine: Effort, coarse: Effort) -> float | None:
    """Error of a fine run over its difference to a coarse one, by the eighth power of steps."""
    ratio = max((coarse.steps / fine.steps) ** 8, fine.tolerance / coarse.tolerance)
    return ratio / (1 - ratio) if ratio <= LITTLE_GAIN else None


def _finer(tolerance: float, finest: float) -> float | None:
    """A hundredth of a tolerance, down to the finest."""
    return None if tolerance <= finest * 1.01 else max(tolerance / COARSER, finest)

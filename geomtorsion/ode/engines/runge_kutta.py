"""RungeKutta and Stiff: DOP853, Radau and LSODA on generated code."""

from __future__ import annotations

import math
from abc import ABC, abstractmethod
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from geomtorsion.errors import ArgumentError
from geomtorsion.ode.engines.stacked import run_stacked
from geomtorsion.ode.engines.stepper import LARGEST
from geomtorsion.ode.engines.stepwise import Stepwise
from geomtorsion.ode.numbers import Real
from geomtorsion.ode.roundings import Changes
from geomtorsion.ode.system import Batch, Run, System, Watch
from geomtorsion.support import checks

# Each tolerance is this part of the last.
RUNG = 0.01
METHODS = ("Radau", "LSODA")


class _Ladder(ABC):
    """Tolerances of methods in double precision: four in each power of ten, down to the finest."""

    precision = 53
    finds_every_root = False
    changes_on_the_way = True
    finest: float

    def first(self, accuracy: float) -> float:
        """See `Engine.first`."""
        return max(_rung(min(accuracy, 1e-3)), 3 * self.finest)

    def rung(self, tolerance: float) -> float:
        """See `Engine.rung`."""
        return max(_rung(tolerance), self.finest)

    def finer(self, tolerance: float) -> float | None:
        """See `Engine.finer`."""
        return None if tolerance <= self.finest * 1.01 else max(tolerance * RUNG, self.finest)

    @abstractmethod
    def steps(self, system: System) -> Stepwise:
        """The integration step by step, for a system."""

    def run(
        self,
        system: System,
        start: Sequence[Real] | np.ndarray,
        parameters: Sequence[Real] | np.ndarray,
        times: np.ndarray,
        tolerance: float,
        *,
        dense: bool = False,
        watch: Watch | None = None,
        longest: float = math.inf,
        changes: Changes | None = None,
    ) -> Run:
        """See `Engine.run`."""
        return self.steps(system).run(
            system, start, parameters, times, tolerance, dense=dense, watch=watch, longest=longest,
            changes=changes,
        )  # fmt: skip


def _rung(tolerance: float) -> float:
    """The largest quarter power of ten that does not exceed the tolerance."""
    return 10.0 ** (math.floor(4 * math.log10(tolerance) + 1e-9) / 4)


@dataclass(frozen=True)
class RungeKutta(_Ladder):
    """Explicit Runge-Kutta of order 8 (DOP853) on generated code; needs no extra.

    Systems of few states step on plain floats, larger ones in scipy.

    max_evaluations: a run that needs more evaluations of the rates raises an error.

    Raises
    ------
    ArgumentError
        max_evaluations is not a positive integer.

    Examples
    --------
    >>> RungeKutta().name
    'RungeKutta'
    """

    max_evaluations: int = 20_000_000

    def __post_init__(self) -> None:
        """Refuse a number without sense."""
        checks.count(self.max_evaluations, "max_evaluations", ArgumentError, 1)

    name = "RungeKutta"
    finest = 1e-17

    def first(self, accuracy: float) -> float:
        """See `Engine.first`: half a rung finer, as errors of steps add up to ten tolerances."""
        return super().first(math.sqrt(RUNG) * accuracy)

    def steps(self, system: System) -> Stepwise:
        """Generated steps for few states, scipy's for many."""
        method = "generated" if system.size <= LARGEST else "DOP853"
        return Stepwise(method, self.max_evaluations)

    def batch(self, batch: Batch, tolerance: float) -> float:
        """See `Engine`: all members as one system."""
        run_stacked(batch, tolerance, self.max_evaluations)
        return 0.0


@dataclass(frozen=True)
class Stiff(_Ladder):
    """Implicit solvers (scipy Radau or LSODA) with the exact Jacobian.

    method: "Radau" or "LSODA".
    max_evaluations: a run that needs more evaluations of the rates raises an error.

    Raises
    ------
    ArgumentError
        The method is not "Radau" or "LSODA", or max_evaluations is not a positive integer.

    Examples
    --------
    >>> Stiff().name
    'Stiff(Radau)'
    """

    method: str = "Radau"
    max_evaluations: int = 5_000_000

    def __post_init__(self) -> None:
        """Refuse unknown methods and invalid numbers."""
        checks.choice(self.method, METHODS, "method", ArgumentError)
        checks.count(self.max_evaluations, "max_evaluations", ArgumentError, 1)

    finest = 3e-13

    @property
    def name(self) -> str:
        """Its name in tables."""
        return f"Stiff({self.method})"

    def steps(self, system: System) -> Stepwise:
        """Implicit steps of scipy."""
        return Stepwise(self.method, self.max_evaluations)

"""Protocol: what every engine offers, and what one run of it returns."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Protocol, TypeAlias

import numpy as np

from geomtorsion.errors import LimitError
from geomtorsion.ode.numbers import Real
from geomtorsion.ode.system import System

# Called now and then with the time that a run has reached; what it raises ends the run.
Watch: TypeAlias = Callable[[float], object]
# A motion that gets no further by this part of its time stands still.
STANDSTILL = 1e-9
# Steps between two looks at whether it does.
STEPS_AT_ONCE = 2_000

# Function of times that gives states, shape (m, size).
Dense: TypeAlias = Callable[[np.ndarray], np.ndarray]


# Frozen, it would take a microsecond to make, which short runs would notice.
@dataclass(eq=False, slots=True)
class Run:
    """What one integration gave, complete or not.

    times, states: where it was asked for and reached; shapes (m,) and (m, size).
    reached, last: time and state at which it ended.
    outcome: "done", "edge" (the guard fell through zero), "beyond" (it did so at a place that is
        still to be found) or "stuck" (steps became too small, or there was no number).
    steps, evaluations: counted; for Taylor series an evaluation is one order of one step.
    compile_seconds, run_seconds: what it cost.
    dense: states at any times; None if not asked for.
    reason: why it is stuck.
    longest_step: in time; infinite where that is not known.
    """

    times: np.ndarray
    states: np.ndarray
    reached: float
    last: Sequence[Real] | np.ndarray
    outcome: str
    steps: int
    evaluations: int
    compile_seconds: float
    run_seconds: float
    dense: Dense | None = None
    reason: str = ""
    longest_step: float = math.inf


class WorkLimitError(LimitError):
    """A run needs more work than it may do.

    args: what there was too much of, the time reached, what to do, the name of the time.
    """

    def __str__(self) -> str:
        work, reached, advice, name = self.args
        return f"more than {work} were needed by {name} = {reached:.6g}. {advice}"

    def counted(self, unit: float, name: str = "t") -> WorkLimitError:
        """The same in other units of time, whose name may be another one."""
        work, reached, advice, _ = self.args
        return WorkLimitError(work, reached * unit, advice, name)


class Engine(Protocol):
    """Integrates a system over given times, to a local tolerance."""

    @property
    def name(self) -> str:
        """How it is called in tables."""
        ...

    @property
    def precision(self) -> int:
        """Bits of the mantissa it works with."""
        ...

    @property
    def finds_every_root(self) -> bool:
        """Whether it sees a guard that falls and rises again within one step."""
        ...

    @property
    def follows_rounding(self) -> bool:
        """Whether its steps are short enough to follow what rounding makes of rates."""
        ...

    def first(self, accuracy: float) -> float:
        """The tolerance with which to try for an accuracy of the result."""
        ...

    def rung(self, tolerance: float) -> float:
        """The largest tolerance of its ladder that is no larger, so that few are compiled."""
        ...

    def finer(self, tolerance: float) -> float | None:
        """The next tolerance of its ladder, a hundred times finer; None where there is none."""
        ...

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
    ) -> Run:
        """Integrate from times[0] through all times (monotone); watching changes no bit of it."""
        ...

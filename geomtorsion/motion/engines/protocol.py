"""Protocol: what every engine offers and what a run of it returns."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any, Protocol

from geomtorsion.motion.system import System

Dense = Callable[[Any], Any]


# Frozen, it would take a microsecond to make, which some runs would notice.
@dataclass(eq=False, slots=True)
class Run:
    """What one integration gave, complete or not.

    times, states: where it was asked for and reached; shapes (m,) and (m, size).
    reached, last: time and state at which it stopped.
    outcome: "done", "edge" (left the chart) or "stuck" (steps became too small, or no number).
    steps, evaluations: counted; for Taylor series an evaluation is one order of one step.
    compile_seconds, run_seconds: apart.
    dense: function of times that gives states, shape (m, size); None if not asked for.
    """

    times: Any
    states: Any
    reached: float
    last: Any
    outcome: str
    steps: int
    evaluations: int
    compile_seconds: float
    run_seconds: float
    dense: Dense | None = None
    reason: str = ""


class Effort(Protocol):
    """What an engine is told about a run to say how two of them compare."""

    @property
    def tolerance(self) -> float:
        """Local tolerance asked for."""
        ...

    @property
    def steps(self) -> int:
        """Steps that were taken."""
        ...


class Engine(Protocol):
    """Integrates a system over given times, to a local tolerance.

    name: how it is called in tables.
    precision: bits of the mantissa it works with.
    finest: the smallest tolerance that still makes sense for it.
    """

    @property
    def name(self) -> str:
        """How it is called in tables."""
        ...

    @property
    def precision(self) -> int:
        """Bits of the mantissa."""
        ...

    @property
    def finest(self) -> float:
        """The smallest tolerance that makes sense."""
        ...

    def first(self, accuracy: float) -> float:
        """The tolerance with which to try for an accuracy of the result."""
        ...

    def rung(self, tolerance: float) -> float:
        """The nearest smaller tolerance of a fixed ladder, so that few are compiled."""
        ...

    def finer(self, tolerance: float) -> float | None:
        """The tolerance of a run that is far more accurate; None where there is none."""
        ...

    def coarser(self, tolerance: float) -> float | None:
        """The tolerance of a cheap run whose error tells that of this one, or None."""
        ...

    def shrinks(self, fine: Effort, coarse: Effort) -> float | None:
        """Error of a fine run over that of a coarse one; None where that is not known."""
        ...

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
        """Integrate from times[0] through all times (monotone)."""
        ...

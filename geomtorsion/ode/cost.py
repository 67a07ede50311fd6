"""Cost: what a solution took to compute."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from geomtorsion.ode.trajectory import Trajectory


@dataclass(frozen=True)
class Cost:
    """What a solution cost.

    steps, evaluations: of the answer, without the run that gave the error estimate.
    compile_seconds: compilation, of all runs; zero where everything was kept from before.
    run_seconds: integration of the answer.
    check_seconds: integration of everything else: finer runs, answers that were not good enough.
    """

    steps: int
    evaluations: int
    compile_seconds: float
    run_seconds: float
    check_seconds: float

    @classmethod
    def of(cls, answer: Trajectory, runs: Sequence[Trajectory]) -> Cost:
        """The cost of an answer among all runs that were made."""
        running = answer.run_seconds
        return cls(
            answer.steps,
            answer.evaluations,
            sum([run.compile_seconds for run in runs]),
            running,
            sum([run.run_seconds for run in runs]) - running,
        )

    def __str__(self) -> str:
        return (
            f"{self.steps} steps, {self.evaluations} evaluations, "
            f"compiled in {self.compile_seconds:.3g} s, ran in {self.run_seconds:.3g} s, "
            f"checked in {self.check_seconds:.3g} s"
        )

"""Singles: members of an ensemble that are followed by themselves."""

from __future__ import annotations

import math
import time
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from geomtorsion.errors import GeomtorsionError
from geomtorsion.ode.batch import Failure
from geomtorsion.ode.solution import Problem
from geomtorsion.ode.solve import verified_motion
from geomtorsion.ode.system import Engine
from geomtorsion.ode.trajectory import Trajectory


@dataclass(frozen=True, eq=False)
class Single:
    """One member solved by itself, or the reason without a solution; seconds of all its runs."""

    answer: Trajectory | None
    error: float
    reason: str
    compile_seconds: float
    check_seconds: float


def followed(problem: Problem, engine: Engine, accuracy: float, grid: np.ndarray) -> Single:
    """One motion with its error, in this process."""
    began = time.perf_counter()
    try:
        checked = verified_motion(problem, engine, accuracy, grid)
    except GeomtorsionError as error:
        return Single(None, math.inf, str(error), 0.0, 0.0)
    answer = checked.answer
    compiling = sum([run.compile_seconds for run in checked.runs])
    checking = time.perf_counter() - began - compiling - answer.run_seconds
    reason = f"{answer.reason or answer.outcome}."
    return Single(answer, checked.error, reason, compiling, checking)


def listed(index: Sequence[int] | np.ndarray, what: str = "That is so for") -> str:
    """Which members these are, in a few words."""
    first = ", ".join(str(int(k)) for k in index[:5])
    more = f" and {len(index) - 5} more" if len(index) > 5 else ""
    return f"{what} member{'s' if len(index) > 1 else ''} {first}{more}."


def unfinished_text(failure: Failure) -> str:
    """The message for members whose worker gave no result."""
    return (
        f"expected results from all workers, got none for {len(failure.members)} members: "
        f"{failure.reason}. {listed(failure.members)} The finished members are in the error's "
        "`partial`. Start new workers, and solve the others."
    )

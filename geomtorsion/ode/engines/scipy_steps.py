"""scipy_steps: the steps of scipy's solvers, with an early end for time that stands still."""

from __future__ import annotations

from collections.abc import Sequence
from functools import cached_property
from typing import Any

import numpy as np
from scipy.integrate import DOP853, LSODA, Radau

from geomtorsion.ode.engines.dop853 import STAGES
from geomtorsion.ode.engines.protocol import STEPS_AT_ONCE, WorkLimitError
from geomtorsion.ode.engines.stepper import too_many_evaluations
from geomtorsion.ode.system import ScalarRates, System
from geomtorsion.precision import EPS

METHODS = {"DOP853": DOP853, "Radau": Radau, "LSODA": LSODA}
# scipy accepts no smaller relative tolerance: it is its own rule.
FLOOR = 100 * EPS


class Piece:
    """Dense output of one step, worked out on first use: before the next step."""

    def __init__(self, solver: Any) -> None:
        self.t: float = float(solver.t_old)
        self.h: float = float(solver.t - solver.t_old)
        self.width: int = int(solver.n)
        self._solver: Any = solver

    @cached_property
    def _polynomial(self) -> Any:
        found = self._solver.dense_output()
        self._solver = None
        return found

    def __call__(self, times: np.ndarray) -> np.ndarray:
        """States at times within the step, shape (m, n)."""
        return self._polynomial(np.asarray(times)).T


class ScipySteps:
    """Steps of a solver of scipy from a start on; see `Steps`, which it can stand for."""

    def __init__(
        self,
        method: str,
        system: System,
        values: Sequence[float],
        y0: Sequence[float],
        span: tuple[float, float],
        tolerance: float,
        scales: Sequence[float],
        longest: float,
        most: int,
    ) -> None:
        rates = _counted(system.scalar_rates(values), most, abs(span[1] - span[0]))
        options: dict[str, Any] = {}
        if method != "DOP853":
            options["jac"] = lambda _, y: system.jacobian(y.tolist(), values)
        self.time: float
        self.time, end = span
        self.sign: float = 1.0 if end >= self.time else -1.0
        self.state: Sequence[float] = tuple(y0)
        self.count: int = 0
        self.stuck: str = ""
        floors = tolerance * np.asarray(scales)
        self._solver: Any = None
        try:
            with np.errstate(all="ignore"):
                self._solver = METHODS[method](
                    rates, self.time, np.array(y0), end, rtol=tolerance, atol=floors,
                    max_step=longest, **options,
                )  # fmt: skip
        except (ValueError, np.linalg.LinAlgError):
            self.stuck = NO_JACOBIAN

    @property
    def evaluations(self) -> int:
        """Evaluations of the rates."""
        return 0 if self._solver is None else int(self._solver.nfev)

    def advance(self) -> Piece | None:
        """One accepted step; None where none is: see `stuck`."""
        solver = self._solver
        if solver is None:
            return None
        try:
            with np.errstate(all="ignore"):
                message = solver.step()
        except WorkLimitError:
            # It is a ValueError, too.
            raise
        except (ValueError, np.linalg.LinAlgError):
            # scipy refuses to solve linear equations with what is no number.
            message = NO_JACOBIAN
        if solver.status == "failed" or message or not np.isfinite(solver.y).all():
            self.stuck = (message or "the states are no numbers any more").rstrip(".")
            return None
        self.time, self.state = float(solver.t), tuple(solver.y.tolist())
        self.count += 1
        return Piece(solver)


NO_JACOBIAN = "the Jacobian has no finite value"


def _counted(function: ScalarRates, most: int, duration: float) -> Any:
    """The rates, refusing to be called without end; no numbers any more where time stands still.

    scipy then gives up with what it has, as it does where the rates themselves end.
    """
    calls, mark, stalled = 0, float("-inf"), False

    def rates(t: float, y: np.ndarray) -> Sequence[float] | np.ndarray:
        nonlocal calls, mark, stalled
        calls += 1
        if calls % (STEPS_AT_ONCE * STAGES) == 0:
            stalled = stalled or abs(t - mark) < 1e-6 * duration
            mark = t
            if calls > most:
                raise too_many_evaluations(most, t)
        return y * float("nan") if stalled else function(t, y)

    return rates

"""Taylor: adaptive Taylor series, compiled by heyoka; any precision."""

from __future__ import annotations

import math
import re
import time
from collections import OrderedDict
from collections.abc import Sequence
from dataclasses import dataclass
from importlib import import_module
from typing import Any

from geomtorsion.errors import LimitError, MissingExtraError
from geomtorsion.motion.engines.last_place import last_regular
from geomtorsion.motion.engines.protocol import Run
from geomtorsion.motion.engines.record import Record
from geomtorsion.motion.engines.writer import SquaringWriter
from geomtorsion.motion.system import System, mpf

# Compiled integrators that are kept; each is some hundred kilobytes.
KEPT = 128
# Larger equations (characters of code, a call of a function counted as CALL, times order) are
# compiled without optimisation first: tenths of a second instead of several, at half the speed.
LARGE, CALL = 6000, 60
# Seconds of running after which optimising pays.
PROVEN = 1.0
# Code longer than this is not unrolled at all.
LONGEST_UNROLLED = 4000
# Bytes of compiled code that heyoka may leave on the disk; its own default is 21 gigabytes.
DISK = 2**30
# Between looks at whether a run still gets anywhere.
STEPS_AT_ONCE = 20_000


@dataclass
class _Compiled:
    """A compiled integrator, whether it is optimised, and for how long it has run."""

    integrator: Any
    optimised: bool
    used: float = 0.0


_kept: OrderedDict[tuple[Any, ...], _Compiled] = OrderedDict()


def heyoka() -> Any:
    """The heyoka module, or an error that names the extra."""
    try:
        module = import_module("heyoka")
    except ImportError:
        raise MissingExtraError(
            "the Taylor engine needs heyoka, which is not installed. "
            "Run `pip install geomtorsion[fast]` (Linux), or use engine=RungeKutta()."
        ) from None
    if module.llvm_state.get_diskcache_limit() > DISK:
        module.llvm_state.set_diskcache_limit(DISK)
    return module


def is_available() -> bool:
    """Whether heyoka can be imported."""
    from importlib.util import find_spec

    return find_spec("heyoka") is not None


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
            return np.array([float(value) for value in values])
        kind = type(self.number(0))
        return np.array([self.number(value) for value in values], dtype=kind)

    def integrator(self, system: System, tolerance: float, batch: int = 0) -> tuple[Any, float]:
        """The compiled integrator of a system, from the store or made now; seconds it took."""
        kept, seconds = self._ready(system, tolerance, batch)
        return kept.integrator, seconds

    def _ready(self, system: System, tolerance: float, batch: int) -> tuple[_Compiled, float]:
        """The compiled integrator with its history; optimised when that has come to pay."""
        key = (system.key, tolerance, self.precision, batch)
        found = _kept.get(key)
        if found is not None and (found.optimised or not self._wants_speed(found)):
            _kept.move_to_end(key)
            return found, 0.0
        began = time.perf_counter()
        if found is None:
            optimised = self.optimised
            if optimised is None:
                order = 1 - math.log(tolerance) / 2
                size = len(system.code[0]) + CALL * len(re.findall(r"[a-z](?=\()", system.code[0]))
                optimised = bool(batch) or size * order < LARGE
        else:
            optimised = True
        made = _Compiled(self._compiled(system, tolerance, batch, optimised), optimised)
        _kept[key] = made
        while len(_kept) > KEPT:
            _kept.popitem(last=False)
        return made, time.perf_counter() - began

    def _wants_speed(self, found: _Compiled) -> bool:
        """Whether an integrator that is not optimised should be."""
        if self.precision > 64 or self.optimised is False:
            return False
        return self.optimised is True or found.used > PROVEN

    def _compiled(self, system: System, tolerance: float, batch: int, optimised: bool) -> Any:
        import numpy as np

        hy = heyoka()
        variables = hy.make_vars(*(f"s{k}" for k in range(system.size)))
        if system.size == 1:
            variables = [variables] if not isinstance(variables, list) else variables
        known = dict(zip(system.states, variables, strict=True))
        known |= {name: hy.par[k] for k, name in enumerate(system.parameters)}
        writer = SquaringWriter(known, self._constant)
        equations = [
            (variable, writer.products(rate))
            for variable, rate in zip(variables, system.rates, strict=True)
        ]
        options: dict[str, Any] = {
            "tol": self.number(tolerance),
            "compact_mode": self.precision > 64 or len(system.code[0]) > LONGEST_UNROLLED,
            "opt_level": 3 if optimised and self.precision <= 64 else 0,
        }
        if batch:
            return hy.taylor_adaptive_batch(
                equations,
                np.zeros((system.size, batch)),
                pars=np.zeros((len(system.parameters), batch)),
                **options,
            )
        if self.precision != 53:
            options["fp_type"] = type(self.number(0))
            if self.precision > 113:
                options["prec"] = self.precision
        if system.edge is not None:
            kind = {53: hy.t_event, 64: hy.t_event_ldbl, 113: getattr(hy, "t_event_f128", None)}
            maker = kind.get(self.precision) or hy.t_event_real
            falling = hy.event_direction.negative
            options["t_events"] = [maker(writer.products(system.edge), direction=falling)]
        zeros = self.array([0] * system.size)
        return hy.taylor_adaptive(
            equations, zeros, pars=self.array([0] * len(system.parameters)), **options
        )

    def _constant(self, p: int, q: int) -> Any:
        """A rational number as a heyoka expression, rounded once."""
        from fractions import Fraction

        return heyoka().expression(self.number(Fraction(p, q)))

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
        import numpy as np

        compiled, compiling = self._ready(system, tolerance, 0)
        integrator = compiled.integrator
        began = time.perf_counter()
        grid = np.asarray(times, dtype=float) if self.precision == 53 else self.array(times)
        integrator.time = grid[0]
        integrator.state[:] = self.array(start)
        if len(system.parameters):
            integrator.pars[:] = self.array(parameters)
        if system.edge is not None:
            integrator.reset_cooldowns()
        record = None
        if dense:
            # The steps are the same with and without the grid, so this comes first.
            record = Record(integrator, grid[0])
            integrator.propagate_until(grid[-1], callback=record, write_tc=True)
            integrator.time = grid[0]
            integrator.state[:] = self.array(start)
        states, outcome, steps, reason = self._propagated(integrator, grid)
        if reason == NO_VALUE:
            place = last_regular(integrator, grid[0], self.array(start), grid[-1])
            integrator.time, integrator.state[:] = place
            lasted = abs(float(place[0] - grid[0]))
            states = states[np.abs((grid[: len(states)] - grid[0]).astype(float)) <= lasted]
        ended = time.perf_counter()
        compiled.used += ended - began
        return Run(
            grid[: len(states)],
            states,
            integrator.time,
            integrator.state.copy(),
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
        import numpy as np

        if grid[0] == grid[-1]:
            return integrator.state.copy()[None, :], "done", 0, ""
        rows, done, steps, before = [], 0, 0, grid[0]
        while True:
            rest = grid[done:] if not done else np.concatenate(([integrator.time], grid[done:]))
            out = integrator.propagate_grid(rest, max_steps=STEPS_AT_ONCE)
            code, taken, values = int_of(out[0]), out[3], out[5]
            steps += taken
            new = values if not done else values[1:]
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
            if moved < 1e-7 * abs(float(grid[-1] - grid[0])):
                return np.concatenate(rows), "stuck", steps, "the steps became too small"
            if steps > self.max_steps:
                raise LimitError(
                    f"more than {self.max_steps} steps were needed by t = {integrator.time:.6g}. "
                    "Ask for less accuracy or time, use engine=Stiff(), or raise max_steps."
                )
            before = integrator.time


NO_VALUE = "the series has no finite value"
TIME_LIMIT, STEP_LIMIT, NOT_FINITE = "time_limit", "step_limit", "err_nf_state"


def int_of(outcome: Any) -> str:
    """The name of heyoka's outcome; terminal events have none."""
    return str(getattr(outcome, "name", "event"))

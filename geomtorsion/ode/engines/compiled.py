"""Compiled: integrators compiled by heyoka, kept for equations that come again."""

from __future__ import annotations

import math
import time
from collections import OrderedDict
from collections.abc import Callable
from dataclasses import dataclass, field
from fractions import Fraction
from functools import lru_cache
from importlib import import_module
from importlib.util import find_spec
from threading import Lock, RLock
from typing import Any

import numpy as np

from geomtorsion.errors import MissingExtraError
from geomtorsion.ode.rates import KEPT
from geomtorsion.ode.system import System

# Equations of more values than this are not unrolled.
LONGEST_UNROLLED = 400
# Guards are watched at this part of their value: heyoka counts events among the states by whose
# size it measures its steps.
FAINT = Fraction(1, 2**30)
# Bytes of compiled code that heyoka may leave on the disk; its own default is 21 gigabytes.
DISK = 2**30


@dataclass
class Compiled:
    """A compiled integrator; `lock` is held while it runs, for threads share it."""

    integrator: Any
    lock: Any = field(default_factory=RLock)


class Crossed:
    """Callback of batches: notes the members whose guard has fallen through zero."""

    def __init__(self) -> None:
        self.members: set[int] = set()

    def __call__(self, _: Any, __: Any, ___: Any, member: int) -> None:
        """Note one member."""
        self.members.add(member)


_kept: OrderedDict[tuple[Any, ...], Compiled] = OrderedDict()
_kept_lock = Lock()


def heyoka() -> Any:
    """The heyoka module, or an error that names the extra."""
    try:
        # An extra, and half a second to load.
        found = import_module("heyoka")
    except ImportError:
        raise MissingExtraError(
            "the Taylor engine needs heyoka, which is not installed. "
            "Run `pip install 'geomtorsion[fast]'` (Linux), or use engine=RungeKutta()."
        ) from None
    _quieten(found)
    return found


@lru_cache(maxsize=1)
def _quieten(module: Any) -> None:
    """Errors only on the terminal: events whose series are not finite are looked at afterwards."""
    module.set_logger_level_error()


def is_available() -> bool:
    """Whether heyoka can be imported."""
    return find_spec("heyoka") is not None


@lru_cache(maxsize=256)
def order_of(tolerance: float) -> int:
    """The order of the series that heyoka takes for a tolerance; it depends on nothing else."""
    return max(2, math.ceil(1 - math.log(tolerance) / 2 - 1e-9))


def tolerance_of(order: int) -> float:
    """The tolerance of an order, a little above the smallest so that none rounds up."""
    return math.exp(-2 * (order - 1)) * (1 + 1e-6)


def compiled(
    system: System,
    order: int,
    precision: int,
    width: int,
    optimised: bool,
    measured: bool,
    number: Callable[[Any], Any],
    backward: bool = False,
) -> tuple[Compiled, float]:
    """A compiled integrator, kept or made now, and the seconds that it took.

    width: motions side by side in one batch; 0: one motion.
    optimised: this takes longer, and the code runs faster.
    measured: whether the last state is a constant of one's own by which steps are measured.
    number: makes numbers of the precision.
    backward: whether times run down, which changes what falls.
    """
    began = time.perf_counter()
    backward = backward and system.guard is not None
    key = (system.key, order, precision, width, optimised, measured, backward)
    with _kept_lock:
        found = _kept.get(key)
        if found is not None:
            _kept.move_to_end(key)
            return found, 0.0
    integrator = _integrator(system, order, precision, width, optimised, measured, number, backward)
    made = Compiled(integrator)
    with _kept_lock:
        _kept[key] = made
        while len(_kept) > KEPT:
            _kept.popitem(last=False)
    return made, time.perf_counter() - began


@lru_cache(maxsize=1)
def _limit_disk_cache(state: Any) -> None:
    """Keep compiled code on the disk small; without a home folder keep none.

    Done once: heyoka looks at every file to know its own limit, for a tenth of a second.
    """
    if not state.get_diskcache_enabled():
        return
    try:
        if state.get_diskcache_limit() > DISK:
            state.set_diskcache_limit(DISK)
    except ValueError:
        state.set_diskcache_enabled(False)


def _integrator(
    system: System,
    order: int,
    precision: int,
    width: int,
    optimised: bool,
    measured: bool,
    number: Callable[[Any], Any],
    backward: bool,
) -> Any:
    """heyoka's integrator of a system."""
    hy = heyoka()
    _limit_disk_cache(hy.llvm_state)
    variables = hy.make_vars(*(f"s{k}" for k in range(system.size)))
    if system.size == 1:
        variables = [variables] if not isinstance(variables, list) else variables
    known = dict(zip(system.states, variables, strict=True))
    known |= {name: hy.par[k] for k, name in enumerate(system.parameters)}
    if system.clock is not None and not width:
        # Members of a batch count from the start of their stage.
        name, unit = system.clock
        known[name] = hy.time * hy.expression(number(Fraction(1, unit)))

    def quotient(p: int, q: int) -> Any:
        return hy.expression(number(Fraction(p, q)))

    equations = list(zip(variables, system.rates.heyoka(known, quotient), strict=True))
    if measured:
        equations.append((hy.make_vars("size"), hy.expression(0.0)))
    options: dict[str, Any] = {
        "tol": number(tolerance_of(order)),
        "compact_mode": precision > 64 or len(system.rates.steps) > LONGEST_UNROLLED,
        "opt_level": (3 if width else 1) if optimised and precision <= 64 else 0,
    }
    guards = []
    if system.guard is not None:
        guards = [guard * number(FAINT) for guard in system.guard.heyoka(known, quotient)]
    # heyoka counts along rising times, wherever a run goes.
    falling = hy.event_direction.positive if backward else hy.event_direction.negative
    if width and measured:
        if guards:
            options["t_events"] = [hy.t_event_batch(guard, direction=falling) for guard in guards]
        zeros = np.zeros((len(equations), width))
        return hy.taylor_adaptive_batch(equations, zeros, **options)
    if width:
        if guards:
            crossed = Crossed()
            options["nt_events"] = [
                hy.nt_event_batch(guard, crossed, direction=falling) for guard in guards
            ]
        return hy.taylor_adaptive_batch(
            equations,
            np.zeros((len(equations), width)),
            **options,
        )
    kind = type(number(0))
    if precision != 53:
        options["fp_type"] = kind
        if precision > 113:
            options["prec"] = precision
    if guards:
        events = {53: hy.t_event, 64: hy.t_event_ldbl, 113: getattr(hy, "t_event_f128", None)}
        maker = events.get(precision) or hy.t_event_real
        options["t_events"] = [maker(guard, direction=falling) for guard in guards]
    zeros = np.array([number(0)] * system.size, dtype=kind)
    return hy.taylor_adaptive(equations, zeros, **options)

"""Store: integrators compiled by heyoka, kept for equations that come again."""

from __future__ import annotations

import math
import re
import time
from collections import OrderedDict
from collections.abc import Callable
from dataclasses import dataclass, field
from fractions import Fraction
from functools import lru_cache
from importlib import import_module
from threading import RLock
from typing import Any

from geomtorsion.errors import MissingExtraError
from geomtorsion.motion.system import System

# Compiled integrators that are kept; each is some hundred kilobytes.
KEPT = 128
# Larger equations (characters of code, a call of a function counted as CALL, times order) are
# compiled without optimisation first: a tenth of the time, at half the speed.
LARGE, CALL = 6000, 60
# Seconds of running after which optimising pays.
PROVEN = 1.0
# Code longer than this is not unrolled at all.
LONGEST_UNROLLED = 4000
# Edges are watched at this part of their value, far below the size of any state.
FAINT = Fraction(1, 2**30)
# Bytes of compiled code that heyoka may leave on the disk; its own default is 21 gigabytes.
DISK = 2**30


@dataclass
class Compiled:
    """A compiled integrator, whether it is optimised, and for how long it has run.

    lock: held while it runs, for threads that solve equal equations share it.
    """

    integrator: Any
    optimised: bool
    used: float = 0.0
    lock: Any = field(default_factory=RLock)


class Touched:
    """Callback of batches: notes which lanes have come to the edge of their chart."""

    def __init__(self) -> None:
        self.lanes: set[int] = set()

    def __call__(self, _: Any, __: Any, ___: Any, lane: int) -> None:
        """Note one lane."""
        self.lanes.add(lane)


kept: OrderedDict[tuple[Any, ...], Compiled] = OrderedDict()


def heyoka() -> Any:
    """The heyoka module, or an error that names the extra."""
    try:
        module = import_module("heyoka")
    except ImportError:
        raise MissingExtraError(
            "the Taylor engine needs heyoka, which is not installed. "
            "Run `pip install geomtorsion[fast]` (Linux), or use engine=RungeKutta()."
        ) from None
    return module


def is_available() -> bool:
    """Whether heyoka can be imported."""
    from importlib.util import find_spec

    return find_spec("heyoka") is not None


@lru_cache(maxsize=256)
def order_of(tolerance: float) -> int:
    """The order of the series that heyoka takes for a tolerance; it depends on nothing else."""
    return max(2, math.ceil(1 - math.log(tolerance) / 2 - 1e-9))


def tolerance_of(order: int) -> float:
    """The tolerance of an order, a little above the smallest so that none rounds up."""
    return math.exp(-2 * (order - 1)) * (1 + 1e-6)


def ready(
    system: System,
    order: int,
    precision: int,
    batch: int,
    wanted: bool | None,
    number: Callable[[Any], Any],
    *,
    abreast: bool = False,
) -> tuple[Compiled, float]:
    """A compiled integrator, from the store or made now, and the seconds that it took.

    wanted: whether to optimise at once; None: large equations when that has come to pay.
    number: makes numbers of the precision.
    abreast: whether the lanes of a batch are one motion: with a state of their own for the size
        by which each measures its steps, the time of the motion, and both compiled as one lane is.
    """
    key = (system.key, order, precision, batch, abreast)
    found = kept.get(key)
    if found is not None and (found.optimised or not _wants_speed(found, precision, wanted)):
        kept.move_to_end(key)
        return found, 0.0
    began = time.perf_counter()
    optimised = True
    if found is None:
        many = bool(batch) and not abreast
        optimised = wanted if wanted is not None else many or _is_small(system, order)
    integrator = _compiled(system, order, precision, batch, optimised, number, abreast)
    made = Compiled(integrator, optimised)
    kept[key] = made
    while len(kept) > KEPT:
        kept.popitem(last=False)
    return made, time.perf_counter() - began


def _is_small(system: System, order: int) -> bool:
    """Whether optimising is a matter of hundredths of a second."""
    code = system.code[0]
    return (len(code) + CALL * len(re.findall(r"[a-z](?=\()", code))) * order < LARGE


def _wants_speed(found: Compiled, precision: int, wanted: bool | None) -> bool:
    """Whether an integrator that is not optimised should be."""
    if precision > 64 or wanted is False:
        return False
    return wanted is True or found.used > PROVEN


def _limit_disk_cache(state: Any) -> None:
    """Keep compiled code on the disk small; without a home folder keep none."""
    if not state.get_diskcache_enabled():
        return
    try:
        if state.get_diskcache_limit() > DISK:
            state.set_diskcache_limit(DISK)
    except ValueError:
        state.set_diskcache_enabled(False)


def _compiled(
    system: System,
    order: int,
    precision: int,
    batch: int,
    optimised: bool,
    number: Callable[[Any], Any],
    abreast: bool,
) -> Any:
    """heyoka's integrator of a system."""
    import numpy as np

    hy = heyoka()
    _limit_disk_cache(hy.llvm_state)
    variables = hy.make_vars(*(f"s{k}" for k in range(system.size)))
    if system.size == 1:
        variables = [variables] if not isinstance(variables, list) else variables
    known = dict(zip(system.states, variables, strict=True))
    known |= {name: hy.par[k] for k, name in enumerate(system.parameters)}
    if system.clock is not None and (abreast or not batch):
        # Lanes of a batch count from the start of their leg.
        name, unit = system.clock
        known[name] = hy.time * hy.expression(number(Fraction(1, unit)))
    rates, edge = system.written(known, lambda p, q: hy.expression(number(Fraction(p, q))))
    equations = list(zip(variables, rates, strict=True))
    if edge is not None:
        # heyoka counts events among the states by whose size it measures its steps.
        edge *= number(FAINT)
    if abreast:
        equations.append((hy.make_vars(f"s{system.size}"), hy.expression(0.0)))
    options: dict[str, Any] = {
        "tol": number(tolerance_of(order)),
        "compact_mode": precision > 64 or len(system.code[0]) > LONGEST_UNROLLED,
        "opt_level": (3 if batch and not abreast else 1) if optimised and precision <= 64 else 0,
    }
    falling = hy.event_direction.negative
    if batch:
        if edge is not None:
            options["nt_events"] = [hy.nt_event_batch(edge, Touched(), direction=falling)]
        return hy.taylor_adaptive_batch(
            equations,
            np.zeros((len(equations), batch)),
            pars=np.zeros((len(system.parameters), batch)),
            **options,
        )
    kind = type(number(0))
    if precision != 53:
        options["fp_type"] = kind
        if precision > 113:
            options["prec"] = precision
    if edge is not None:
        events = {53: hy.t_event, 64: hy.t_event_ldbl, 113: getattr(hy, "t_event_f128", None)}
        maker = events.get(precision) or hy.t_event_real
        options["t_events"] = [maker(edge, direction=falling)]
    zeros, pars = ([number(0)] * size for size in (system.size, len(system.parameters)))
    return hy.taylor_adaptive(
        equations, np.array(zeros, dtype=kind), pars=np.array(pars, dtype=kind), **options
    )

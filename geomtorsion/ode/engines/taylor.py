"""Taylor: adaptive Taylor series of any precision, by integrators that heyoka compiles.

Integrators are kept for equations that occur again.
"""

from __future__ import annotations

import math
import time
from collections import OrderedDict
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import ExitStack, contextmanager
from dataclasses import dataclass, field, replace
from fractions import Fraction
from functools import lru_cache
from importlib import import_module
from importlib.util import find_spec
from threading import Lock, RLock
from types import MappingProxyType
from typing import Any

import mpmath
import numpy as np

from geomtorsion.errors import ArgumentError, MissingExtraError
from geomtorsion.ode.engines.registers import FEW, run_in_registers
from geomtorsion.ode.numbers import Real, mpf
from geomtorsion.ode.rates import KEPT
from geomtorsion.ode.roundings import Changes
from geomtorsion.ode.system import (
    STANDSTILL,
    STEPS_AT_ONCE,
    Batch,
    Dense,
    Hoisted,
    Run,
    System,
    Watch,
    WorkLimitError,
    refuse_stiff,
)
from geomtorsion.support import checks
from geomtorsion.support.allowance import check_limits
from geomtorsion.support.precision import EXACT_BITS

# Equations of more values than this are not unrolled.
LONGEST_UNROLLED = 400
# Guards are scaled by this factor, because heyoka includes events among the states whose size
# determines its steps.
FAINT = Fraction(1, 2**30)
# Bytes of optimised code that heyoka may leave on the disk. Its own default is 21 gigabytes; to
# open a cache takes 0.4 seconds for each gigabyte in it.
DISK = 2**28
# After this number of portions of steps a run continues in optimised code. Compiling it takes as
# long as it saves in 65,000 to 600,000 steps (tops, autoparallels, Kerr orbits).
LONG = 75


@dataclass(frozen=True, eq=False)
class _Shared:
    """heyoka's integrator of all systems of equal code, and the lock of the thread that uses it."""

    integrator: Any
    lock: Any = field(default_factory=RLock)


@dataclass(frozen=True, eq=False)
class Compiled:
    """The compiled integrator of one system; `ready` is the only way to run it."""

    engine: Taylor
    hoisted: Hoisted
    shared: _Shared

    @contextmanager
    def ready(self, *parameters: Sequence[Real] | np.ndarray) -> Iterator[Ready]:
        """Lock the integrator and set all its numbers, constants included.

        parameters: of the system, for one motion; for each of a few motions, in a few
            arguments; or for the members of a batch, in one array of shape (number, parameters).
        """
        bits = self.engine.precision
        numbers = [self.engine.array(self.hoisted.numbers(row, bits)) for row in parameters]
        with self.shared.lock:
            rows = numbers[0] if len(numbers) == 1 else np.array(numbers)
            yield Ready(self.shared.integrator, rows, self.engine.max_steps)


class Ready:
    """A locked integrator with the numbers of one motion, or of the members of a batch.

    The numbers of a batch are not a number until `choose` names the members.
    integrator: heyoka's. max_steps: of one run.
    """

    def __init__(self, integrator: Any, numbers: np.ndarray, max_steps: int) -> None:
        self.integrator = integrator
        self.max_steps = max_steps
        # heyoka omits the last parameters if they do not occur.
        self._columns = numbers.T[: len(integrator.pars)]
        integrator.pars[:] = self._columns if numbers.ndim == 1 else np.nan

    def choose(self, members: Sequence[int] | np.ndarray) -> None:
        """Set the numbers of the members that a batch integrates next, shape (width,)."""
        self.integrator.pars[:] = self._columns[:, members]


_kept: OrderedDict[tuple[Any, ...], _Shared] = OrderedDict()
_kept_lock = Lock()
# Held while heyoka's own switch of the cache on the disk is changed.
_disk_lock = Lock()


def heyoka() -> Any:
    """The heyoka module, or an error that names the extra."""
    try:
        # An extra, and half a second to load.
        module = import_module("heyoka")
    except ImportError:
        raise MissingExtraError(
            "the Taylor engine needs heyoka, which is not installed. "
            "Run `pip install 'geomtorsion[fast]'` (Linux), or use engine=RungeKutta()."
        ) from None
    _quieten(module)
    return module


@lru_cache(maxsize=1)
def _quieten(module: Any) -> None:
    """Errors only on the terminal: events whose series are not finite are looked at afterwards."""
    module.set_logger_level_error()


def is_available() -> bool:
    """Whether heyoka can be imported."""
    return find_spec("heyoka") is not None


@lru_cache(maxsize=256)
def order_of(tolerance: float) -> int:
    """Order of the series that heyoka chooses, from the tolerance only."""
    return max(2, math.ceil(1 - math.log(tolerance) / 2 - 1e-9))


def tolerance_of(order: int) -> float:
    """The tolerance of an order, a little above the smallest so that none rounds up."""
    return math.exp(-2 * (order - 1)) * (1 + 1e-6)


def _compiled(
    system: System,
    order: int,
    precision: int,
    width: int,
    number: Callable[[Any], Any],
    backward: bool = False,
    optimised: bool = False,
) -> tuple[_Shared, float]:
    """A compiled integrator, kept or made now, and the seconds that it took.

    width: motions side by side in one batch; 0: one motion.
    number: makes numbers of the precision.
    backward: whether times run down, which changes what falls.
    optimised: whether the code of one motion is optimised; the code of a batch always is.
    """
    began = time.perf_counter()
    backward = backward and system.guard is not None
    key = (system.key, order, precision, width, backward, optimised and not width)
    with _kept_lock:
        cached = _kept.get(key)
        if cached is not None:
            _kept.move_to_end(key)
            return cached, 0.0
    integrator = _integrator(system, order, precision, width, number, backward, optimised)
    fresh = _Shared(integrator)
    with _kept_lock:
        _kept[key] = fresh
        while len(_kept) > KEPT:
            _kept.popitem(last=False)
    return fresh, time.perf_counter() - began


@contextmanager
def _without_disk(state: Any) -> Iterator[None]:
    """Compile without the cache on the disk; opening it takes longer than to compile plain code."""
    with _disk_lock:
        before = state.get_diskcache_enabled()
        state.set_diskcache_enabled(False)
        try:
            yield
        finally:
            state.set_diskcache_enabled(before)


@lru_cache(maxsize=1)
def _limit_disk_cache(state: Any) -> None:
    """Keep optimised code on the disk small; without a home folder keep none."""
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
    number: Callable[[Any], Any],
    backward: bool,
    optimised: bool,
) -> Any:
    """heyoka's integrator of a system."""
    hy = heyoka()
    variables = hy.make_vars(*(f"s{k}" for k in range(system.size)))
    if system.size == 1:
        variables = [variables] if not isinstance(variables, list) else variables
    symbols = dict(zip(system.states, variables, strict=True))
    symbols |= {name: hy.par[k] for k, name in enumerate(system.parameters)}
    if system.clock is not None and not width:
        # Members of a batch count from the start of their stage.
        name, unit = system.clock
        symbols[name] = hy.time * hy.expression(number(Fraction(1, unit)))

    def quotient(p: int, q: int) -> Any:
        return hy.expression(number(Fraction(p, q)))

    equations = list(zip(variables, system.rates.heyoka(symbols, quotient), strict=True))
    options: dict[str, Any] = {
        "tol": number(tolerance_of(order)),
        "compact_mode": precision > 64 or len(system.rates.steps) > LONGEST_UNROLLED,
        # Levels above 1 give the same bits and are not faster for one motion. Level 0 has others.
        "opt_level": 3 if width else int(optimised),
    }
    guards = []
    if system.guard is not None:
        guards = [guard * number(FAINT) for guard in system.guard.heyoka(symbols, quotient)]
    # heyoka counts along rising times, wherever a run goes.
    falling = hy.event_direction.positive if backward else hy.event_direction.negative
    if width:
        with _disk_lock:
            _limit_disk_cache(hy.llvm_state)
        if guards:
            options["t_events"] = [hy.t_event_batch(guard, direction=falling) for guard in guards]
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
    with _without_disk(hy.llvm_state):
        return hy.taylor_adaptive(equations, zeros, **options)


__all__ = ["Taylor", "heyoka", "is_available"]

# Below this order, steps are no longer in proportion to the truncation error.
LOWEST_ORDER = 6
# Orders of a finer run: with two more, a single step near a pole may dominate the errors of both.
FINER = 3
NO_VALUE = "the series has no finite value"


@dataclass(frozen=True)
class Taylor:
    """Adaptive Taylor series by heyoka (extra `fast`).

    precision: bits of the mantissa: 53 (double), 64 (long double), 113 (quadruple) to 400.
    max_steps: a run that needs more steps raises an error.
    optimised: whether all steps run optimised code, which changes the last bits. Its compilation
        takes a few tenths of a second, so it pays after some hundred thousand steps of one or many
        motions. Without it, a run has optimised code after 150,000 steps (37,500 above 64 bits).

    Raises
    ------
    ArgumentError
        heyoka does not support this precision, or max_steps is not a positive integer.

    Examples
    --------
    >>> Taylor(precision=113).name, Taylor(optimised=True).name
    ('Taylor(113)', 'Taylor(optimised)')
    """

    precision: int = 53
    max_steps: int = 5_000_000
    optimised: bool = False

    def __post_init__(self) -> None:
        """Refuse numbers without sense, which would fail far from here."""
        if not isinstance(self.precision, int) or self.precision not in (53, 64):
            bits = f"53, 64 or a whole number from 113 to {EXACT_BITS:,}"
            checks.count(self.precision, "precision", ArgumentError, 113, EXACT_BITS, expected=bits)
        checks.count(self.max_steps, "max_steps", ArgumentError, 1)
        if not isinstance(self.optimised, bool):
            raise ArgumentError(
                f"optimised: expected True or False, got {checks.shown(self.optimised)}."
            )

    finds_every_root = True
    changes_on_the_way = True

    @property
    def name(self) -> str:
        """Its name in tables."""
        parts = [] if self.precision == 53 else [f"{self.precision}"]
        parts += ["optimised"] if self.optimised else []
        return f"Taylor({', '.join(parts)})" if parts else "Taylor"

    @property
    def finest(self) -> float:
        """A tolerance at which only rounding is left, four orders beyond where that begins."""
        return 2.0 ** -(self.precision + 15)

    def first(self, accuracy: float) -> float:
        """See `Engine.first`: one order finer than the accuracy, as errors grow on the way."""
        order = max(order_of(max(accuracy, self.finest)) + 1, LOWEST_ORDER)
        # The finest ones have no finer run with which to compare them.
        return tolerance_of(min(order, order_of(self.finest) - FINER))

    def rung(self, tolerance: float) -> float:
        """See `Engine.rung`: one rung for each order of the series, the nearest."""
        return tolerance_of(max(2, round(1 - math.log(max(tolerance, self.finest)) / 2)))

    def finer(self, tolerance: float) -> float | None:
        """See `Engine.finer`: four orders more, each worth a factor e^2."""
        order, last = order_of(tolerance), order_of(self.finest)
        return tolerance_of(order + FINER) if order + FINER <= last else None

    def number(self, value: Real) -> Any:  # of heyoka's own types
        """A number in the type of this precision, correctly rounded."""
        if self.precision == 53:
            return float(value)
        # Wider types hold every double, without the way through text.
        text: Any = value
        if type(value).__name__ in ("longdouble", "real128", "real"):
            text = str(value)
        elif not isinstance(value, float):
            digits = int(self.precision * 0.302) + 6
            text = str(mpmath.nstr(mpf(value, self.precision + 20), digits))
        if self.precision == 64:
            return np.longdouble(text)
        hy = heyoka()
        return hy.real128(text) if self.precision == 113 else hy.real(text, self.precision)

    def array(self, values: Sequence[Real] | np.ndarray) -> np.ndarray:
        """Numbers in the type of this precision."""
        if self.precision == 53:
            if isinstance(values, np.ndarray) and values.dtype == np.float64:
                return values
            return np.array([float(value) for value in values])
        kind = type(self.number(0.0))
        return np.array([self.number(value) for value in values], dtype=kind)

    def compiled(
        self,
        system: System,
        tolerance: float,
        *,
        width: int = 0,
        backward: bool = False,
    ) -> tuple[Compiled, float]:
        """The compiled integrator of a system, new or kept, and the seconds of compilation."""
        order, bits = order_of(tolerance), self.precision
        hoisted = system.hoisted
        shared, seconds = _compiled(
            hoisted.system, order, bits, width, self.number, backward, self.optimised
        )
        return Compiled(self, hoisted, shared), seconds

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
        backward = bool(times[-1] < times[0])
        compiled, compiling = self.compiled(system, tolerance, backward=backward)
        later: list[float] = []

        def optimised() -> Compiled:
            engine = replace(self, optimised=True)
            code, seconds = engine.compiled(system, tolerance, backward=backward)
            later.append(seconds)
            return code

        run = self._run(
            compiled, None if self.optimised else optimised, system, start, parameters, times,
            dense, watch, longest, changes,
        )  # fmt: skip
        run.compile_seconds = compiling + sum(later)
        run.run_seconds -= sum(later)
        return run

    def batch(self, batch: Batch, tolerance: float) -> float:
        """See `Engine`: several members in one vector instruction."""
        width = int(heyoka().recommended_simd_size()) * (2 if batch.states.shape[1] <= FEW else 1)
        backward = bool(batch.times[-1] < batch.times[0])
        compiled, compiling = self.compiled(batch.system, tolerance, width=width, backward=backward)
        with compiled.ready(batch.parameters) as ready:
            run_in_registers(ready.integrator, ready.choose, batch, width, self.max_steps)
        return compiling

    def _run(
        self,
        kept: Compiled,
        optimised: Callable[[], Compiled] | None,
        system: System,
        start: Sequence[Real] | np.ndarray,
        parameters: Sequence[Real] | np.ndarray,
        times: np.ndarray,
        dense: bool,
        watch: Watch | None,
        longest: float,
        changes: Changes | None,
    ) -> Run:
        """The run by one integrator, and by its optimised code after many steps."""
        began = time.perf_counter()
        with ExitStack() as stack:
            ready = stack.enter_context(kept.ready(parameters))
            used = [ready.integrator]
            integrator, record = ready.integrator, None
            grid, start = self.array(times), self.array(start)
            _place(integrator, grid[0], start)
            numbers = [float(x) for x in parameters]

            def room() -> float:
                return _room(system, numbers, used[-1])

            def refuse(pace: float, reached: float) -> None:
                # States of a motion that blows up may be beyond doubles.
                with np.errstate(over="ignore"):
                    state = used[-1].state.astype(float).tolist()
                left = float(grid[-1]) - reached
                refuse_stiff(system, state, numbers, pace, reached, abs(left), self.max_steps)

            step: dict[str, Any] = {}
            if longest != math.inf:
                step["max_delta_t"] = self.number(longest)
            if changes is not None:
                step["callback"] = _changing(changes, integrator.state, start)

            def faster() -> Any:
                assert optimised is not None
                if len(used) == 1:
                    used.append(stack.enter_context(optimised().ready(parameters)).integrator)
                _place(used[-1], integrator.time, integrator.state)
                if changes is not None and "callback" in step:
                    step["callback"] = _changing(changes, used[-1].state, start)
                return used[-1]

            states, outcome, steps, longest, reason = self._propagated(
                integrator, grid, watch, None if system.guard_is_entire else room, refuse, step,
                None if optimised is None else faster,
            )  # fmt: skip
            reached, last = used[-1].time, used[-1].state.copy()
            if outcome == "stuck":
                del used[1:]
                place = _last_regular(integrator, grid[0], start, grid[-1], steps)
                # An unstable step of stiff equations cannot be taken back either.
                _place(integrator, *place)
                integrator.propagate_until(grid[-1], max_steps=1)
                if np.isfinite(integrator.state.astype(float)).all():
                    refuse(abs(float(integrator.last_h)), float(place[0]))
                if not system.guard_is_entire:
                    _place(integrator, grid[0], start)
                    edge = _edge_ahead(integrator, place, grid[-1], room, room())
                    if edge is not None:
                        outcome, reason, place = "edge", "", edge
                _place(integrator, *place)
                reached, last = integrator.time, integrator.state.copy()
                lasted = abs(float(reached - grid[0]))
                states = states[np.abs((grid[: len(states)] - grid[0]).astype(float)) <= lasted]
            if dense and reached != grid[0]:
                step.pop("callback", None)
                # The steps are the same with and without the grid.
                _place(integrator, grid[0], start)
                record = _Record(integrator, grid[0])
                step |= {"callback": record, "write_tc": True}
                most = 0 if optimised is None else LONG * self._at_once
                out = integrator.propagate_until(reached, max_steps=most, **step)
                # An edge may end the steps before the time that was reached.
                if optimised is not None and _code(out) == "step_limit":
                    step.pop("callback")
                    faster().propagate_until(reached, callback=record, **step)
            return Run(
                grid[: len(states)],
                states,
                reached,
                last,
                outcome,
                steps,
                steps * (integrator.order + 1),
                0.0,
                time.perf_counter() - began,
                None if record is None else record.dense(),
                reason,
                longest,
            )

    @property
    def _at_once(self) -> int:
        """Steps in one portion."""
        return STEPS_AT_ONCE if self.precision <= 64 else STEPS_AT_ONCE // 4

    def _propagated(
        self,
        integrator: Any,
        grid: np.ndarray,
        watch: Watch | None,
        room: Callable[[], float] | None,
        refuse: Callable[[float, float], None] = lambda _pace, _reached: None,
        step: Mapping[str, object] = MappingProxyType({}),
        faster: Callable[[], Any] | None = None,
    ) -> tuple[np.ndarray, str, int, float, str]:
        """States on the grid, outcome, steps, the longest of them, and reason.

        A run without progress is ended.
        `room`: the guard, if it may have no series within a step, so that its zero is not detected.
        refuse: (mean step, time reached) -> an error where too many steps would follow.
        step: heyoka's options for the longest step and for a function called after each.
        faster: gives an integrator for the rest of a long run.
        """
        if grid[0] == grid[-1]:
            return integrator.state.copy()[None, :], "done", 0, 0.0, ""
        at_once = self._at_once
        rows: list[np.ndarray] = []
        done, steps, longest, before = 0, 0, 0.0, grid[0]
        rest = grid
        while True:
            check_limits()
            out = integrator.propagate_grid(rest, max_steps=at_once, **step)
            code = _code(out)
            steps += out[3]
            # The reported largest step does not include the last one, which ends with the grid.
            longest = max(longest, abs(float(out[2])), abs(float(integrator.last_h)))
            new = out[5][1:] if done else out[5]
            rows.append(new)
            done += len(new)
            # The last sample and the last allowed step may come together.
            if code == "time_limit" or (code == "step_limit" and done == len(grid)):
                states = rows[0] if len(rows) == 1 else np.concatenate(rows)
                return states, "done", steps, longest, ""
            if code != "step_limit":
                states = np.concatenate(rows)
                if code == "err_nf_state":
                    good = np.isfinite(states.astype(float)).all(axis=1)
                    keep = len(states) if good.all() else int(np.argmin(good))
                    return states[:keep], "stuck", steps, longest, NO_VALUE
                return states, "edge", steps, longest, ""
            if room is not None and room() < 0:
                return np.concatenate(rows), "beyond", steps, longest, ""
            moved = abs(float(integrator.time - before))
            refuse(moved / at_once, float(integrator.time))
            # Steps may also be too small to reach the next sample after the time has rounded to it.
            at_sample = integrator.time == grid[done]
            if at_sample or moved < STANDSTILL * abs(float(grid[-1] - grid[0])):
                return np.concatenate(rows), "stuck", steps, longest, "the steps became too small"
            if steps > self.max_steps:
                advice = "Request less accuracy or time, use engine=Stiff(), or raise max_steps."
                reached = float(integrator.time)
                raise WorkLimitError(f"{self.max_steps} steps", reached, advice, "t")
            if watch is not None:
                watch(float(integrator.time))
            if faster is not None and steps == LONG * at_once:
                integrator = faster()
            before = integrator.time
            rest = np.concatenate(([before], grid[done:]))


def _code(out: Sequence[Any]) -> str:
    """How heyoka's steps ended; "event" for one of ours."""
    return str(getattr(out[0], "name", "event"))


def _room(system: System, numbers: Sequence[float], integrator: Any) -> float:
    """The guard where an integrator has come to."""
    return system.guard_at(integrator.state.astype(float).tolist(), numbers)


def _place(integrator: Any, at: Any, state: np.ndarray) -> None:
    """Set an integrator to a time and a state."""
    integrator.time = at
    integrator.state[:] = state
    if integrator.with_events:
        integrator.reset_cooldowns()


def _changing(changes: Changes, state: np.ndarray, start: np.ndarray) -> Callable[[Any], bool]:
    """A callback that changes the state after some steps; called after each, so it is short.

    state: of the integrator; to ask it for a view takes as long as to change one.
    """
    made = changes.made

    def change(_integrator: Any) -> bool:
        changes.left -= 1
        if not changes.left:
            state[:] = made(state, start)
        return True

    return change


class _Record:
    """Callback that keeps the Taylor coefficients of every step."""

    def __init__(self, integrator: Any, start: Any) -> None:
        self.times = [start]
        self.coefficients: list[np.ndarray] = []
        self.kind = integrator.state.dtype

    def __call__(self, integrator: Any) -> bool:
        """Keep one step; True continues."""
        self.coefficients.append(integrator.tc.copy())
        self.times.append(integrator.time)
        return True

    def dense(self) -> Dense:
        """Function of times, by the polynomial of the step that contains each."""
        times = np.array(self.times, dtype=type(self.times[0]))
        table = np.array(self.coefficients, dtype=self.kind)
        sign = 1.0 if times[-1] >= times[0] else -1.0
        order = sign * times.astype(float)

        def values(t: np.ndarray) -> np.ndarray:
            t = np.asarray(t, dtype=times.dtype)
            place = np.searchsorted(order, sign * t.astype(float), "right") - 1
            place = np.clip(place, 0, len(table) - 1)
            h = (t - times[place])[..., None]
            rows = table[place]
            result = rows[..., -1]
            for k in range(rows.shape[-1] - 2, -1, -1):
                result = result * h + rows[..., k]
            return result

        return values


def _edge_ahead(
    integrator: Any,
    place: tuple[Any, np.ndarray],
    end: Any,
    room: Callable[[], float],
    first: float,
) -> tuple[Any, np.ndarray] | None:
    """Time and state at the edge that the next step leaps over; None where there is no edge.

    place: the last one that is regular; first: the guard at the start, of which at an edge no more
    than half of the digits of rounding is left.
    """
    if not first > 0:
        return None
    low, state = place
    high = end
    while True:
        middle = low + (high - low) / 2
        if middle in (low, high):
            break
        _place(integrator, low, state)
        # More steps would mean that steps shrink on the way.
        integrator.propagate_until(middle, max_steps=2)
        arrived = integrator.time == middle and np.isfinite(integrator.state.astype(float)).all()
        if arrived and room() > 0:
            low, state = middle, integrator.state.copy()
        else:
            high = middle
    _place(integrator, low, state)
    return (low, state) if room() <= first * math.sqrt(np.finfo(float).eps) else None


# A step that leads back to within this part of where it came from was a good one.
CLOSE = 1e-6


def _last_regular(
    integrator: Any, begin: Any, start: np.ndarray, end: Any, steps: int
) -> tuple[Any, np.ndarray]:
    """Time and state before the first step that cannot be taken back.

    A step over a singularity may give finite numbers, from which the series continues for a while
    before it fails; but the way back over the singularity does not lead to the same state.
    steps: how many were taken in all.
    """
    good = begin, start
    size: float | None = None
    # As many at once as fit into memory.
    for left in range(steps, 0, -STEPS_AT_ONCE):
        trail: list[tuple[Any, np.ndarray]] = []

        def keep(at: Any, trail: list[tuple[Any, np.ndarray]] = trail) -> bool:
            trail.append((at.time, at.state.copy()))
            return True

        _place(integrator, *good)
        integrator.propagate_until(end, callback=keep, max_steps=min(left, STEPS_AT_ONCE))
        if size is None:
            # What begins at zero is as large as its first step makes it.
            size = np.abs(trail[0][1].astype(float)).max()
        for at, state in trail:
            if not (np.isfinite(float(at)) and np.isfinite(state.astype(float)).all()):
                return good
            _place(integrator, at, state)
            integrator.propagate_until(good[0], max_steps=STEPS_AT_ONCE)
            gap = np.abs((integrator.state - good[1]).astype(float)).max()
            if not gap <= CLOSE * max(size, np.abs(good[1].astype(float)).max()):
                return good
            good, size = (at, state), 0.0
    return good

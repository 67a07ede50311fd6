"""Scaling: motions whose numbers are far from one are run in units of their own size.

Series underflow where lengths are 1e-30, and steps are measured by the largest of all states; both
are put right by powers of two, with which nothing is rounded.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import lru_cache
from typing import TypeAlias

import numpy as np

from geomtorsion.ode.engines.protocol import Dense, Engine, Run, Watch, WorkLimitError
from geomtorsion.ode.numbers import Real, divided, floats, multiplied
from geomtorsion.ode.system import System

# States (the largest of each group) and durations within this factor of one are run as they are.
# Coefficients of order n of a series are as its n-th power: those of the highest stay far within
# the range of floats; and steps measured by the largest of states that differ by it still have ten
# digits of the others.
FAR = 2.0**20
# For each group of states its size, and where that is zero the size of its rates.
Extents: TypeAlias = list[tuple[float, float]]


@dataclass(frozen=True, eq=False)
class Units:
    """Powers of two in which a run counts: sizes of its states, shape (size,), and of its times."""

    sizes: np.ndarray
    time: float

    @property
    def parameters(self) -> list[float]:
        """What the scaled system has besides: size of each state, and rate of each state."""
        return [*self.sizes.tolist(), *(self.time / self.sizes).tolist()]


def scaled_run(
    engine: Engine,
    system: System,
    start: Sequence[Real] | np.ndarray,
    parameters: Sequence[Real] | np.ndarray,
    times: np.ndarray,
    tolerance: float,
    *,
    extents: Extents | None = None,
    dense: bool = False,
    watch: Watch | None = None,
) -> Run:
    """See `Engine.run`: the same, in units of its own size where numbers are far from one.

    extents: those of the start, where they are known.
    """
    units = units_of(system, start, parameters, float(times[-1] - times[0]), extents)
    if units is None:
        return engine.run(system, start, parameters, times, tolerance, dense=dense, watch=watch)
    unit = units.time
    sizes = units.sizes.tolist()
    try:
        found = engine.run(
            scaled_system(system),
            [divided(x, size) for x, size in zip(start, sizes, strict=True)],
            [*parameters, *units.parameters],
            times / units.time,
            tolerance,
            dense=dense,
            watch=None if watch is None else lambda t: watch(t * unit),
        )
    except WorkLimitError as limit:
        raise limit.counted(unit) from None
    found.times = times[: len(found.times)]
    found.states = multiplied(found.states, units.sizes)
    found.last = multiplied(np.asarray(found.last)[None, :], units.sizes)[0]
    found.reached = found.reached * type(found.reached)(units.time)
    found.longest_step *= unit
    if found.dense is not None:
        found.dense = _unscaled(found.dense, units)
    return found


def member_units(
    system: System,
    states: np.ndarray,
    parameters: np.ndarray,
    durations: np.ndarray,
) -> tuple[np.ndarray, np.ndarray] | None:
    """Sizes (number, size) and times (number,) of members; None where all run as they are."""
    far = np.flatnonzero(~_run_as_they_are(system, states, parameters, np.abs(durations)))
    if not len(far):
        return None
    found: list[Units | None] = [None] * len(states)
    for k in far:
        found[k] = units_of(system, states[k], parameters[k], float(durations[k]))
    if all(units is None for units in found):
        return None
    plain = Units(np.ones(states.shape[1]), 1.0)
    if system.clock is not None:
        plain.sizes[system.states.index(system.clock[0])] = 1 / system.clock[1]
    units = [one or plain for one in found]
    return np.array([one.sizes for one in units]), np.array([one.time for one in units])


def _unscaled(dense: Dense, units: Units) -> Dense:
    """Dense output in the units of the problem."""
    return lambda t: multiplied(dense(np.asarray(t) / units.time), units.sizes)


def extents_of(
    system: System, start: Sequence[Real] | np.ndarray, parameters: Sequence[Real] | np.ndarray
) -> Extents:
    """Size of each group of states at a start; of what begins at zero, that of its rates."""
    # On lists: this is asked of every start.
    groups, sizes = system.groups_but_clock, [abs(float(x)) for x in start]
    tops = [max([sizes[k] for k in group]) for group in groups]
    if all(tops):
        return [(top, 0.0) for top in tops]
    rates = system.scalar_rates(floats(parameters))(0.0, np.array(floats(start)))
    return [
        (top, 0.0 if top else max([abs(rates[k]) for k in group]))
        for top, group in zip(tops, groups, strict=True)
    ]


def units_of(
    system: System,
    start: Sequence[Real] | np.ndarray,
    parameters: Sequence[Real] | np.ndarray,
    duration: float,
    extents: Extents | None = None,
) -> Units | None:
    """The units of a run; None where it can be run as it is."""
    duration = abs(duration)
    extents = extents or extents_of(system, start, parameters)
    # What begins at zero is soon as large as its rates make it.
    sizes = [top or rate * duration for top, rate in extents]
    if (not duration or _is_near(duration)) and all(not x or _is_near(x) for x in sizes):
        return None
    groups, parameters = system.groups_but_clock, floats(parameters)
    values = np.abs(floats(start))
    if not duration or not np.isfinite(values).all():
        return None
    jacobian = system.jacobian(floats(start), parameters)
    if not np.isfinite(jacobian).all():
        return None
    fastest = float(np.abs(np.linalg.eigvals(jacobian)).max())
    time = 1 / fastest if fastest * duration > 1 else duration
    largest = values
    # What a state has after that time, where no terms cancel; velocities come before coordinates.
    for _ in range(2):
        terms = np.abs(np.ravel(system.rates.sizes(*largest.tolist(), *parameters))) * time
        largest = np.maximum(largest, np.where(np.isfinite(terms), terms, 0.0))
    found = np.ones(len(values))
    for group in map(list, groups):
        top = float(largest[group].max())
        if top > 0:
            found[group] = np.where(largest[group] * FAR < top, largest[group], top)
            found[group] = np.where(found[group] > 0, found[group], top)
    if all(map(_is_near, (*found.tolist(), time))):
        return None
    found = 2.0 ** np.round(np.log2(found))
    time = float(2.0 ** np.round(np.log2(time)))
    if system.clock is not None:
        found[system.states.index(system.clock[0])] = time / system.clock[1]
    return Units(found, time)


def _run_as_they_are(
    system: System, states: np.ndarray, parameters: np.ndarray, durations: np.ndarray
) -> np.ndarray:
    """Which members have numbers near one: the first question of `units_of`, all at once."""
    near = (durations == 0) | _are_near(durations)
    for group in map(list, system.groups_but_clock):
        tops = np.abs(states[:, group]).max(axis=1)
        still = np.flatnonzero(tops == 0)
        if len(still):
            with np.errstate(all="ignore"):
                rates = system.array_function(*states[still].T, *parameters[still].T)
            shape = (system.size, len(still))
            tops[still] = np.abs(np.broadcast_to(rates, shape)[group]).max(axis=0)
            tops[still] *= durations[still]
        near &= (tops == 0) | _are_near(tops)
    return near


def _are_near(sizes: np.ndarray) -> np.ndarray:
    """Which of many sizes are near enough to one."""
    return (sizes >= 1 / FAR) & (sizes <= FAR)


def _is_near(size: float) -> bool:
    """Whether a size is near enough to one."""
    return 1 / FAR <= size <= FAR


@lru_cache(maxsize=256)
def scaled_system(system: System) -> System:
    """The same equations for states and a time in units that are parameters."""
    sizes = tuple(f"size of {name}" for name in system.states)
    rates = tuple(f"rate of {name}" for name in system.states)
    more = (*sizes, *rates)
    scaled = system.rates.with_factors(dict(zip(system.states, sizes, strict=True)), rates, more)
    guards = [
        None if guard is None
        else guard.with_factors(dict(zip(system.states, sizes, strict=True)), (), more)
        for guard in (system.guard, system.end)
    ]  # fmt: skip
    clock = None if system.clock is None else (system.clock[0], 1)
    return replace(
        system, parameters=(*system.parameters, *more), rates=scaled, guard=guards[0],
        end=guards[1], clock=clock,
    )  # fmt: skip

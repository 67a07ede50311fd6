"""Trajectory: one integration, stage by stage, across events."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import TypeAlias

import numpy as np

from geomtorsion.errors import StartError
from geomtorsion.ode.numbers import PARTS, Real, floats
from geomtorsion.ode.roots import crossing_beyond, crossings
from geomtorsion.ode.roundings import Roundings
from geomtorsion.ode.system import (
    PER_STEP,
    STANDSTILL,
    Dense,
    Engine,
    Extents,
    Run,
    System,
    Watch,
    extents_of,
    scaled_run,
)
from geomtorsion.support import checks
from geomtorsion.support.caching import cached_property
from geomtorsion.support.copies import only_fields

State: TypeAlias = Sequence[Real] | np.ndarray
# A motion with more events than this changes charts forever at an edge.
MOST_STAGES = 10_000


@dataclass(frozen=True, eq=False)
class Event:
    """The end of a stage, and the stage after it.

    when: a time; None: where the guard of the system falls through zero (or, if `then` can
        continue, where the engine cannot).
    then: (time, state) -> the next stage, or None where the motion ends; None: it ends here.
    ending: (time, state) -> outcome and reason where nothing comes after; None: it is "stopped".
    stop: state -> the condition that ends the motion although `then` could continue it, or None
        where something else than a condition has let the guard fall; None: there are no conditions.
    """

    when: float | None
    then: Callable[[float, State], Stage | None] | None = None
    ending: Callable[[float, State], tuple[str, str]] | None = None
    stop: Callable[[State], str | None] | None = None

    def __getstate__(self) -> Mapping[str, object]:
        # The next stage was determined when the trajectory was made.
        return only_fields(self) | {"then": None, "ending": None, "stop": None}


@dataclass(frozen=True, eq=False)
class Stage:
    """Equations with the state at which they begin, valid up to one of their events.

    label: name of the coordinates of the states; "" where there is one set only.
    system: the equations.
    start, parameters: numbers in the order of the states and parameters of the system; arrays in
        double precision.
    begin: the time at which it begins.
    events: at most one at a time in each direction, and at most one of the guard.
    groups: indices of states that are measured together.
    kept: a state where the stage is cut -> the state with lengths of one restored, or None.
    changes: how often conditions or pieces have changed the motion before it.
    """

    label: str
    system: System
    start: State
    parameters: State
    begin: float = 0.0
    events: tuple[Event, ...] = ()
    groups: tuple[tuple[int, ...], ...] = ()
    kept: Callable[[State], State] | None = None
    changes: int = 0

    def __getstate__(self) -> dict[str, object]:
        return only_fields(self)

    @cached_property
    def first(self) -> np.ndarray:
        """The state at the beginning, as floats."""
        return np.array([float(x) for x in self.start])

    @cached_property
    def extents(self) -> Extents:
        """Sizes of the states of the system at the beginning."""
        return extents_of(self.system, self.start, self.parameters)

    def timed(self, sign: float) -> Event | None:
        """The next event at a time, of a motion forwards (1) or backwards (-1)."""
        begin = float(self.begin)
        timed = ((x.when, x) for x in self.events if x.when is not None)
        return next((x for at, x in timed if (at > begin) == (sign > 0)), None)

    @cached_property
    def boundary(self) -> Event | None:
        """The event of the guard."""
        return next((event for event in self.events if event.when is None), None)


@dataclass(frozen=True, eq=False)
class Segment:
    """The computed part of one stage.

    head: 1 if its first sample is its beginning, which was not requested, else 0.
    count: number of requested samples.
    """

    stage: Stage
    run: Run
    head: int
    count: int

    def __getstate__(self) -> dict[str, object]:
        return only_fields(self)

    @property
    def label(self) -> str:
        """Name of the coordinates."""
        return self.stage.label

    @property
    def times(self) -> np.ndarray:
        """Times of the samples."""
        return self.run.times[self.head : self.head + self.count]

    def resampled(self, times: np.ndarray, states: np.ndarray) -> Segment:
        """The segment with other samples."""
        return Segment(self.stage, replace(self.run, times=times, states=states), 0, len(times))

    @property
    def states(self) -> np.ndarray:
        """States at the samples, shape (count, size)."""
        return self.run.states[self.head : self.head + self.count]

    @property
    def last(self) -> np.ndarray:
        """State where the segment ends."""
        return np.asarray(self.run.last)


@dataclass(frozen=True, eq=False)
class Trajectory:
    """Segments in order, in the time of the stages.

    outcome: "done"; "stopped" by an event that ends the motion; "stuck" where it cannot continue;
        "interrupted" where the computed part ends.
    reason: why it is stuck, or the condition that stopped it, where there are several.
    """

    engine: Engine
    tolerance: float
    segments: tuple[Segment, ...]
    outcome: str
    reason: str = ""
    _dense: dict[int, Dense] = field(default_factory=dict, repr=False, init=False)

    def __getstate__(self) -> dict[str, object]:
        return only_fields(self)

    @property
    def count(self) -> int:
        """Number of samples reached."""
        return sum([segment.count for segment in self.segments])

    @property
    def steps(self) -> int:
        """Steps of all segments."""
        return sum([segment.run.steps for segment in self.segments])

    @property
    def longest_step(self) -> float:
        """The longest step of all segments."""
        return max([segment.run.longest_step for segment in self.segments])

    @property
    def evaluations(self) -> int:
        """Evaluations of all segments."""
        return sum([segment.run.evaluations for segment in self.segments])

    @property
    def compile_seconds(self) -> float:
        """Time spent on compilation."""
        return sum([segment.run.compile_seconds for segment in self.segments])

    @property
    def run_seconds(self) -> float:
        """Time spent on integration."""
        return sum([segment.run.run_seconds for segment in self.segments])

    @property
    def reached(self) -> float:
        """The last time."""
        return float(self.segments[-1].run.reached)

    @property
    def labels(self) -> tuple[str, ...]:
        """Labels of the segments, in order."""
        return tuple([segment.label for segment in self.segments])

    def ending(self) -> Trajectory:
        """The trajectory with its end as its only sample."""
        last = self.segments[-1]
        end = last.resampled(np.array([float(last.run.reached)]), last.last[None, :])
        return replace(self, segments=(end,))

    def at(self, times: np.ndarray) -> list[tuple[Segment, np.ndarray, np.ndarray]]:
        """For each segment the states at the times within it, and their indices."""
        sign = -1.0 if self.reached < 0 else 1.0
        begins = [sign * float(segment.stage.begin) for segment in self.segments]
        place = np.clip(np.searchsorted(begins, sign * times, "right") - 1, 0, None)
        parts = []
        for k in np.unique(place).tolist():
            index = np.flatnonzero(place == k)
            states = np.asarray(self._dense_output(k)(times[index]))
            parts.append((self.segments[k], states, index))
        return parts

    def _dense_output(self, k: int) -> Dense:
        """States of one segment at any times: the same integration again, keeping every step."""
        if k not in self._dense:
            stage, run = self.segments[k].stage, self.segments[k].run
            ends = np.array([float(stage.begin), float(run.reached)])
            if ends[0] == ends[1]:
                last = np.asarray(run.last)
                self._dense[k] = lambda t: np.broadcast_to(last, (len(t), len(last)))
            else:
                again = scaled_run(
                    self.engine, stage.system.unguarded, stage.start, stage.parameters, ends,
                    self.tolerance, dense=True,
                )  # fmt: skip
                if again.dense is None:
                    raise StartError(without_dense(self.engine))
                self._dense[k] = again.dense
        return self._dense[k]


Runner: TypeAlias = Callable[[int, Stage, np.ndarray], Run]


def integrate(
    stage: Stage,
    times: np.ndarray,
    tolerance: float,
    engine: Engine,
    *,
    cuts: Sequence[float] = (),
    roundings: Roundings | None = None,
    longest: float = math.inf,
    runner: Runner | None = None,
    watch: Watch | None = None,
) -> Trajectory:
    """Follow a motion from its first stage through times, from event to event.

    Parameters
    ----------
    times
        monotone, from the beginning of the stage on, shape (m,).
    tolerance
        local tolerance for the engine.
    cuts
        times at which a stage ends and continues, so that a file can keep its parts.
    roundings
        changes of the state on the way, by engines that make them.
    longest
        the longest step in time.
    runner
        (number, stage, times) -> its run, instead of the engine.
    watch
        called now and then with the time that is reached.
    """
    segments: list[Segment] = []
    end = float(times[-1])
    sign = -1.0 if end < 0 else 1.0
    done, idle, waiting = 0, 0, list(cuts)
    while True:
        begin = float(stage.begin)
        while waiting and sign * waiting[0] <= sign * begin:
            waiting.pop(0)
        stop = _next_break(stage, waiting, sign, end)
        samples, head, count = _samples(times, done, stage.begin, stop, sign)
        if runner is None:
            run = run_stage(stage, samples, tolerance, engine, watch, longest, roundings)
        else:
            run = runner(len(segments), stage, samples)
            if watch is not None:
                watch(float(run.reached))
        count = max(min(len(run.times) - head, count), 0)
        done += count
        segments.append(Segment(stage, run, head, count))
        if run.outcome == "done":
            if stop is None:
                return Trajectory(engine, tolerance, tuple(segments), "done")
            event = stage.timed(sign)
            if event is None or event.when != stop:
                last = run.last if stage.kept is None else stage.kept(run.last)
                stage = replace(stage, start=last, begin=stop)
                continue
        else:
            event = stage.boundary
            ended = _ending(event, segments[-1])
            if event is None or ended is not None:
                return Trajectory(engine, tolerance, tuple(segments), *(ended or (run.outcome,)))
            # A motion that cannot continue in two stages in a row cannot continue at all. Engines
            # measure progress by the whole time, so that the same motion ends in every chart.
            moved = abs(float(run.reached) - begin) > STANDSTILL * abs(end)
            idle = idle + 1 if run.outcome == "stuck" and not moved else 0
        after = None
        if idle < 2 and len(segments) <= MOST_STAGES and event.then is not None:
            after = event.then(run.reached, segments[-1].last)
        if after is None:
            outcome, reason = "stopped", ""
            if event.ending is not None:
                outcome, reason = event.ending(float(run.reached), segments[-1].last)
            return Trajectory(engine, tolerance, tuple(segments), outcome, run.reason or reason)
        stage = after


def _ending(event: Event | None, segment: Segment) -> tuple[str, str] | None:
    """Outcome and reason of a motion that ends at the boundary of its stage; else None."""
    run = segment.run
    if event is None or (run.outcome == "stuck" and event.then is None):
        return run.outcome, run.reason
    stop = None if run.outcome == "stuck" else event.stop
    condition = None if stop is None else stop(segment.last)
    return None if condition is None else ("stopped", condition)


def _next_break(stage: Stage, cuts: Sequence[float], sign: float, end: float) -> float | None:
    """The next time before the end at which a run has to be ended."""
    event = stage.timed(sign)
    breaks = [cuts[0] if cuts else None, None if event is None else event.when]
    before = [at for at in breaks if at is not None and sign * at < sign * end]
    return min(before, key=lambda at: sign * at) if before else None


def _samples(
    times: np.ndarray, done: int, begin: float, stop: float | None, sign: float
) -> tuple[np.ndarray, int, int]:
    """Times for an engine, 1 if the first was not requested (else 0), and the requested number."""
    if stop is None:
        inside = times if done == 0 else times[done:]
    else:
        last = int(np.searchsorted(sign * times, sign * stop, "left"))
        inside = times[done:last]
    head = 0 if len(inside) and inside[0] == begin else 1
    samples = np.concatenate(([begin], inside)) if head else inside
    if stop is not None and samples[-1] != stop:
        samples = np.concatenate((samples, [stop]))
    return samples, head, len(inside)


def run_stage(
    stage: Stage,
    times: np.ndarray,
    tolerance: float,
    engine: Engine,
    watch: Watch | None = None,
    longest: float = math.inf,
    roundings: Roundings | None = None,
) -> Run:
    """The run of one stage, ended where its guard falls through zero."""
    system, numbers = stage.system, stage.parameters
    event = stage.boundary
    final = event is not None and (event.then is None or event.stop is not None)
    takes = getattr(engine, "changes_on_the_way", False)
    clock = None if system.clock is None else system.states.index(system.clock[0])

    def run(dense: bool) -> Run:
        made = roundings.changes(float(times[0]), clock) if roundings and takes else None
        return scaled_run(
            engine, system, stage.start, numbers, times, tolerance,
            extents=stage.extents, dense=dense, watch=watch, longest=longest, changes=made,
        )  # fmt: skip

    if system.guard is None or not final or engine.finds_every_root:
        result = run(False)
        sees_all = not engine.finds_every_root or system.guard_is_entire
        if sees_all and result.outcome != "beyond":
            return result
        if _is_early(system, stage, result, tolerance):
            return _looked_at(stage, result, times, tolerance, engine, watch)
        if not is_beyond(system, result, numbers):
            return result
    result = run(True)
    if result.dense is None:
        if result.outcome == "beyond":
            raise StartError(without_dense(engine))
        return result
    return _ended_earlier(system, result, times, numbers)


def without_dense(engine: Engine) -> str:
    """The message where states between the samples of an engine are missing."""
    return (
        f"engine {engine.name}: expected Run.dense from run(dense=True), got None. Return a "
        "function of times, or read the solution at its times."
    )


def _is_early(system: System, stage: Stage, run: Run, tolerance: float) -> bool:
    """Whether a run was ended although its guard is far from zero.

    Truncated series that do not converge, such as of roots in long steps, can vanish anywhere.
    """
    if run.outcome != "edge":
        return False
    numbers = [float(x) for x in stage.parameters]
    here, before = (
        system.guard_at([float(x) for x in state], numbers) for state in (run.last, stage.start)
    )
    return here > tolerance * before


def _looked_at(
    stage: Stage, run: Run, times: np.ndarray, tolerance: float, engine: Engine, watch: Watch | None
) -> Run:
    """The run ended where the values of its guard, not their series, fall through zero."""
    system, start, numbers = stage.system, stage.start, stage.parameters
    begin, end = float(times[0]), float(times[-1])
    reach, sign = float(run.reached) - begin, -1.0 if end < begin else 1.0
    while True:
        reach *= 2
        until = end if abs(reach) >= abs(end - begin) else begin + reach
        inside = times[sign * times < sign * until]
        samples = np.append(inside, until)
        free = scaled_run(
            engine, system.unguarded, start, numbers, samples, tolerance, dense=True, watch=watch
        )
        ended = _ended_earlier(system, free, samples, numbers)
        if ended.outcome == "stuck" or not np.isfinite(floats(ended.last)).all():
            # Where the rates end without it, the series were right to see an end.
            return run
        if ended.outcome == "edge" or until == end:
            return ended


def is_beyond(system: System, run: Run, numbers: State) -> bool:
    """Whether a run continued where its guard is below zero.

    The series of a guard may have no finite value within a step, such as of roots, and a truncated
    series may vanish later than the guard.
    """
    if run.outcome == "beyond":
        return True
    values = [float(x) for x in numbers]
    if run.outcome == "edge":
        return system.guard_at([float(x) for x in run.last], values) < 0
    if len(run.states) < 2:
        return False
    room = np.broadcast_to(system.guard_along(run.states.T, values), len(run.states))
    return bool(room[0] > 0 and (room < 0).any())


def _ended_earlier(system: System, run: Run, times: np.ndarray, numbers: State) -> Run:
    """A run, cut where the guard fell through zero and rose again within one step."""
    values, dense = [float(x) for x in numbers], run.dense
    assert dense is not None

    def room(at: np.ndarray) -> np.ndarray:
        # Far beyond an edge anything may come.
        with np.errstate(all="ignore"):
            states = dense(at).astype(float)
        return np.broadcast_to(system.guard_along(states.T, values), len(at))

    def guard(at: np.ndarray) -> np.ndarray:
        with np.errstate(all="ignore"):
            states = dense(at).astype(float)
        return np.broadcast_to(system.plain_guard_along(states.T, values), len(at))

    begin, end = float(times[0]), float(run.reached)
    looked = close_times(begin, end, run)
    zeros = crossings(room, looked, room(looked), -1)
    outcome = "edge" if run.outcome == "beyond" else run.outcome
    if not len(zeros) and outcome != "edge":
        return replace(run, outcome=outcome, dense=None)
    sign = 1.0 if end >= begin else -1.0
    zero = crossing_beyond(guard, float(zeros[0]) if len(zeros) else end, sign)
    keep = sign * np.asarray(run.times).astype(float) < sign * zero
    last = dense(np.array([zero]))[0]
    return replace(
        run, times=run.times[keep], states=run.states[keep], reached=zero, last=last,
        outcome="edge", reason="", dense=None,
    )  # fmt: skip


def close_times(begin: float, end: float, run: Run) -> np.ndarray:
    """Times close enough to see what a run did between its steps."""
    count = max(PER_STEP * run.steps, run.evaluations, PARTS, 4 * len(run.times))
    remedy = "Ask over a shorter time, or solve to a lower accuracy."
    checks.check_room(int(count), f"{int(count):,} times between the steps", remedy)
    return np.linspace(begin, end, int(count) + 1)

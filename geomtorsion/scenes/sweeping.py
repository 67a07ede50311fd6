"""Sweeping: motions with equal equations found, solved together, and measured."""

from __future__ import annotations

import re
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from types import SimpleNamespace
from typing import TYPE_CHECKING, Any

import numpy as np

from geomtorsion.errors import AccuracyError, StartError, StuckError
from geomtorsion.motion import solve_many
from geomtorsion.scenes.flowing import parameters_of, start_of
from geomtorsion.scenes.measure import SweepRun
from geomtorsion.scenes.running import closed_form, read

if TYPE_CHECKING:
    from geomtorsion.motion import Engine
    from geomtorsion.scenes.scene import Scene

# Samples of each motion, at least, so that zeros between them are as good as the motion.
SAMPLES = 1001
# Numbers that are held at once.
ROOM = 20_000_000
# So many motions in closed form are checked against the integrator.
CHECKED = 3
_START = re.compile(r"start\.([^\W\d]\w*)(?:\[(\d+)\])?")


class Found:
    """What is measured while motions are solved."""

    def __init__(
        self, readers: Mapping[str, Callable], count: int, progress: Callable[[float], object]
    ) -> None:
        self.readers, self.count = readers, count
        self.columns = {name: np.full(count, np.nan) for name in readers}
        self.error, self.engines, self.done = 0.0, set[str](), 0
        self.lost: dict[int, str] = {}
        self.progress = progress

    def measure(self, place: int, run: SweepRun) -> None:
        """Read one motion."""
        for name, reader in self.readers.items():
            self.columns[name][place] = reader(run)
        self._went_on()

    def lose(self, place: int, why: str) -> None:
        """A motion that does not reach its end: nothing is measured, and that is said."""
        self.lost[place] = why
        self._went_on()

    def _went_on(self) -> None:
        self.done += 1
        self.progress(self.done / self.count)


@dataclass(frozen=True, eq=False)
class Lane:
    """One motion: its place, what is varied in it, its numbers, and its scene if it has its own."""

    place: int
    varied: Mapping[str, Any]
    start: Mapping[str, Any]
    parameters: Mapping[str, Any]
    scene: Scene | None


def groups(scene: Scene, lanes: Sequence[Mapping[str, Any]]) -> dict[Any, list[Lane]]:
    """Motions by their equations: those with equal ones can be solved in one batch."""
    groups: dict[Any, list[Lane]] = {}
    own = tuple(scene.numbers[1])
    for place, changes in enumerate(lanes):
        if all(_START.fullmatch(path) for path in changes):
            # Another start leaves the equations, and with them the plan, as they are.
            moved: Any = SimpleNamespace(plan=scene.plan, start=_restarted(scene, changes))
            lane = Lane(place, changes, start_of(moved), parameters_of(moved), None)
            key: Any = ("start", own)
        else:
            other = scene.replaced(changes)
            lane = Lane(place, changes, *other.numbers, other)
            made = other.assembly
            switches = str([part.switches for part in made.parts.values()])
            key = (tuple(lane.parameters), tuple(made.rates.items()), switches)
        groups.setdefault(key, []).append(lane)
    return groups


def _restarted(scene: Scene, changes: Mapping[str, Any]) -> Any:
    """The start of a scene with some of its numbers changed."""
    state: Any = scene.start
    for path, value in changes.items():
        match: Any = _START.fullmatch(path)
        items: Any = getattr(state, match[1], None)
        place = int(match[2] or 0)
        if match[2] is None or not isinstance(items, tuple) or place >= len(items):
            # The general way knows what to say of this path.
            state = scene.replaced({"start": state, path: value}).start
            continue
        items = (*items[:place], value, *items[place + 1 :])
        state = replace(state, **{match[1]: items})
    return state


def solve_group(scene: Scene, members: list[Lane], engine: Engine | None, found: Found) -> None:
    """Solve motions of equal equations, in the way that suits them, and measure them."""
    first = members[0].scene or scene
    if first.flow.law.stop is not None or np.ndim(first.t):
        _one_by_one(scene, members, engine, found)
    elif engine is None and closed_form(first) is not None:
        _in_closed_form(scene, members, found)
    else:
        try:
            _in_batches(first, members, engine, found)
        except (AccuracyError, StartError):
            # One by one there are more digits to be had, and those that fail are told apart.
            _one_by_one(scene, members, engine, found)


def _sampled(scene: Scene) -> np.ndarray:
    """Times close enough to measure what is between them."""
    return np.linspace(0.0, float(scene.times[-1]), max(SAMPLES, len(scene.times)))


def _in_batches(scene: Scene, members: list[Lane], engine: Engine | None, found: Found) -> None:
    """Some motions at a time, by `solve_many`."""
    flow, times = scene.flow, _sampled(scene)
    room = max(ROOM // (len(times) * flow.size), 1)
    for begin in range(0, len(members), room):
        some = members[begin : begin + room]
        starts = {
            name: np.array([float(lane.start[name]) for lane in some]) for name in flow.states
        }
        starts |= {
            name: np.array([float(lane.parameters[name]) for lane in some])
            for name in flow.law.parameters
        }
        bundle = solve_many(flow, starts, times, scene.accuracy, engine, progress=False)
        found.error = max(found.error, bundle.error)
        found.engines.add(bundle.engine)
        for k, lane in enumerate(some):
            if not bundle.finished[k]:
                found.lose(lane.place, "it does not reach the last time")
                continue
            watched = read(_with_numbers(scene, lane), times, bundle.states[k])
            found.measure(lane.place, SweepRun(times, watched, lane.varied))


def _in_closed_form(scene: Scene, members: list[Lane], found: Found) -> None:
    """Free bodies at all times at once; a few of them are checked against the integrator."""
    some = np.unique(np.linspace(0, len(members) - 1, CHECKED).round().astype(int)).tolist()
    for k, lane in enumerate(members):
        own = lane.scene or scene.replaced(dict(lane.varied))
        form, times = closed_form(own), _sampled(own)
        if form is None:
            _one_by_one(scene, [lane], None, found)
            continue
        if k in some:
            found.error = max(found.error, own.run().error)
        found.engines.add("closed form")
        watched = read(own, times, form.states(times))
        found.measure(lane.place, SweepRun(times, watched, lane.varied))


def _with_numbers(scene: Scene, lane: Lane) -> Any:
    """What is needed to read watched quantities off states, with the numbers of one motion."""
    flow = replace(scene.flow, parameters={**scene.flow.parameters, **lane.parameters})
    return SimpleNamespace(flow=flow, plan=scene.plan)


def _one_by_one(scene: Scene, members: list[Lane], engine: Engine | None, found: Found) -> None:
    """Motions that end at times of their own, or are asked for at times of the user's."""
    for lane in members:
        try:
            result = (lane.scene or scene.replaced(dict(lane.varied))).run(engine)
        except StuckError as stuck:
            found.lose(lane.place, str(stuck).partition(". Stop earlier")[0])
            continue
        found.error = max(found.error, result.error)
        found.engines.add(result.engine)
        found.measure(lane.place, SweepRun(result.times, result.values, lane.varied))

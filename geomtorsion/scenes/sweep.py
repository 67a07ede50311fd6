"""Sweep: one scene with many values of its parameters and its start, solved together."""

from __future__ import annotations

import re
import time
from collections.abc import Callable, Hashable, Iterable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from itertools import product
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from geomtorsion.errors import AccuracyError, SceneError, StartError, StuckError, UnknownNameError
from geomtorsion.ode import ODE, solve_many
from geomtorsion.ode.writing import pandas_table
from geomtorsion.pictures.scene_over_time import sweep_picture
from geomtorsion.pictures.style import STYLE, number, save
from geomtorsion.scenes.body import Number
from geomtorsion.scenes.metrics import Measure, SweepRun, Values, measures, only_words, quantities
from geomtorsion.scenes.observables import FINE
from geomtorsion.scenes.solve import checked_states, closed_form
from geomtorsion.scenes.to_ode import observed, parameters_of, start_of
from geomtorsion.support import checks
from geomtorsion.support.csv_table import write_csv
from geomtorsion.support.outgoing import size_text

if TYPE_CHECKING:
    import pandas
    from matplotlib.figure import Figure

    from geomtorsion.ode import Engine
    from geomtorsion.scenes.scene import Scene
    from geomtorsion.scenes.selection import StateSelection
    from geomtorsion.scenes.state import State

# Numbers in memory at once, 160 MB: longer batches are solved in parts.
LARGEST_BATCH = 20_000_000
_START = re.compile(r"start\.([^\W\d]\w*)(?:\[(\d+)\])?")


@dataclass(frozen=True, eq=False)
class SceneSweep:
    """Measured values for every combination of the varied values.

    title: of the scene.
    varied: path -> values, in the order of the axes; shape (n,), or (n, 3) for whole vectors.
    measured: name -> array with an axis for each path (a single axis with `together`).
    accuracy: requested; engine: the solver; seconds: total time.
    errors: estimate of the error of each motion, in the shape of the measures; nan where it does
        not reach its end.
    unfinished: (varied values, reason) of each motion that does not reach its end; its measures
        are nan.
    interrupted: whether Ctrl-C stopped it; finished measures are kept.
    """

    title: str
    varied: Mapping[str, np.ndarray]
    measured: Mapping[str, np.ndarray]
    accuracy: float
    errors: np.ndarray
    engine: str
    seconds: float
    unfinished: tuple[tuple[Mapping[str, Values], str], ...] = ()
    interrupted: bool = False

    @property
    def error(self) -> float:
        """The largest error of all motions."""
        return float(np.nanmax(self.errors))

    def __getitem__(self, name: str) -> np.ndarray:
        """The varied values or the measure of this name."""
        every = {**self.varied, **self.measured}
        kind = "a varied or measured name"
        return every[checks.known_name(name, every, "", UnknownNameError, expected=kind)]

    def columns(self) -> dict[str, np.ndarray]:
        """A column for each path and measure, a row for each combination."""
        shape = next(iter(self.measured.values())).shape
        table: dict[str, np.ndarray] = {}
        for axis, (path, values) in enumerate(self.varied.items()):
            for place in np.ndindex(values.shape[1:]):
                along = values[(slice(None), *place)]
                if len(shape) > 1:
                    along = along.reshape([-1 if k == axis else 1 for k in range(len(shape))])
                name = path + "".join(f"[{k}]" for k in place)
                table[name] = np.broadcast_to(along, shape).ravel()
        return table | {name: values.ravel() for name, values in self.measured.items()}

    def _ipython_key_completions_(self) -> list[str]:
        return [*self.varied, *self.measured]

    def to_pandas(self) -> pandas.DataFrame:
        """The table as a pandas frame.

        Raises
        ------
        MissingExtraError
            pandas is not installed.
        """
        return pandas_table(self.columns())

    def to_csv(self, path: str | Path) -> None:
        """Write the table as CSV with all digits."""
        write_csv(checks.file_name(path), self.columns())

    def plot(
        self,
        path: str | Path | None = None,
        *,
        measure: str | None = None,
        known: Callable[[float], float] | None = None,
        known_name: str = "known",
    ) -> Figure:
        """A measure against the varied values; `known`, a function of these, as a curve on top.

        Raises
        ------
        SceneError
            more than two things were varied.
        UnknownNameError
            no measure has this name.
        MissingExtraError
            matplotlib is not installed.
        """
        name = measure or next(iter(self.measured))
        kind = "a measured name"
        checks.known_name(name, self.measured, "", UnknownNameError, expected=kind)
        values = self.measured[name]
        # Whole vectors have no axis of their own: they are counted.
        pairs = [
            (path, row) if row.ndim == 1 else (f"{path}, number", np.arange(float(len(row))))
            for path, row in list(self.varied.items())[: values.ndim]
        ]
        if values.ndim > 2:
            raise SceneError(
                f"expected two varied quantities for a picture, got {values.ndim}. Use columns()."
            )
        curve = None
        if known is not None and values.ndim == 1:
            low, high = float(pairs[0][1].min()), float(pairs[0][1].max())
            spaced = np.geomspace if low > 0 and high > STYLE.wide * low else np.linspace
            fine = spaced(low, high, 401)
            curve = (known_name, fine, np.array([known(x) for x in fine]))
        error = number(float(f"{self.error:.1e}"))
        note = f"{values.size} motions by {self.engine}, error below {error}; {self.seconds:.2g} s."
        figure = sweep_picture(pairs, (name, values), curve, self.title, [note])
        if path is not None:
            save(figure, Path(path))
        return figure

    def __str__(self) -> str:
        sizes = " x ".join(f"{len(values)} {path}" for path, values in self.varied.items())
        lines = [f"{self.title or 'scene'}: {sizes}, by {self.engine} in {self.seconds:.2g} s"]
        for name, values in self.measured.items():
            there = values[np.isfinite(values)]
            span = f"{there.min():.6g} to {there.max():.6g}" if there.size else "none"
            lines.append(f"{name}: {span}")
        if self.interrupted:
            lines.append("stopped by Ctrl-C: finished measures are kept")
        if self.unfinished:
            where, why = self.unfinished[0]
            lines.append(f"{len(self.unfinished)} without a value; the first with {where}: {why}")
        return "\n".join(
            [*lines, f"error below {size_text(self.error)} (requested {self.accuracy:.1e})"]
        )

    __repr__ = __str__


def sweep(
    scene: Scene,
    varied: Mapping[str, Iterable[Number | Sequence[Number]]],
    measure: Measure | Mapping[str, Measure] | Sequence[str],
    *,
    together: bool = False,
    engine: Engine | None = None,
    progress: Callable[[float], object] = lambda _: None,
) -> SceneSweep:
    """Solve a scene for many values of its parameters and its start, and measure each motion.

    Motions of equal equations are solved in one batch, by `solve_many`; the others one by one.

    Parameters
    ----------
    scene
        the scene; its outputs can be measured.
    varied
        dotted path -> values: {"start.omega[0]": [1e-6, 1e-3], "gravity.g": [1.62, 9.81]}, or
        vectors: {"start.quaternion": [(1, 0, 0, 0), (0, 1, 0, 0)]}. Every combination is solved;
        with `together`, the first of each, then the second, ...
    measure
        "last", "max", "min", "mean", "first zero" or "between zeros" with a quantity, such as
        "between zeros omega[1]"; a function of a run (run["nutation"], run.times, run.zeros(...));
        or several, in a list or by name.

    Raises
    ------
    UnknownNameError
        a path does not exist.
    SceneError
        nothing is varied, lengths differ, or words are not a measure.
    StuckError
        no motion reaches its end; where only some do not, they are in `unfinished`.

    Examples
    --------
    >>> from geomtorsion.scenes import load
    >>> flips = sweep(load("dzhanibekov"), {"start.omega[0]": [1e-3, 1e-2]},
    ...               "between zeros omega[1]")
    >>> flips["between zeros omega[1]"].round(3).tolist()
    [28.731, 20.755]
    """
    began = time.perf_counter()
    if not checks.table(varied, "varied", SceneError):
        raise SceneError(
            "varied: expected paths with values, got none. Give for instance {'gravity.g': [1, 2]}."
        )
    readers = measures(measure)
    watch = quantities(measure)
    if not only_words(measure):
        watch = (*scene.watch, *watch)
    scene = scene.with_values(watch=watch)
    values = {path: _column(path, column) for path, column in varied.items()}
    shape = tuple(len(column) for column in values.values())
    if together and len(set(shape)) != 1:
        raise SceneError(f"together: expected lists of equal length, got {shape}.")
    combinations = list(
        zip(*values.values(), strict=True) if together else product(*values.values())
    )
    if not combinations:
        raise SceneError("varied: expected at least one value, got none.")
    changes = [dict(zip(values, map(_plain, chosen), strict=True)) for chosen in combinations]
    tally = _Measured(readers, len(changes), progress)
    try:
        for members in _groups(scene, changes).values():
            _solve_group(scene, members, engine, tally)
    except KeyboardInterrupt:
        # Where nothing is finished there is nothing to keep.
        if not tally.measured:
            raise
        tally.stop()
    unfinished = [(changes[place], reason) for place, reason in sorted(tally.unfinished.items())]
    if len(unfinished) == len(changes):
        raise StuckError(
            f"expected a motion that reaches its end, got none; with {unfinished[0][0]}: "
            f"{unfinished[0][1]}."
        )
    grid = (len(changes),) if together else shape
    return SceneSweep(
        scene.title or scene.name,
        values,
        {name: column.reshape(grid) for name, column in tally.columns.items()},
        scene.accuracy,
        tally.errors.reshape(grid),
        ", ".join(sorted(tally.engines)),
        time.perf_counter() - began,
        tuple(unfinished),
        tally.interrupted,
    )


def _column(path: str, column: Iterable[Number | Sequence[Number]]) -> np.ndarray:
    """Values of a path: numbers, or vectors of equal length."""
    lists = "a list of numbers, or of vectors of equal length"
    items = list(column) if isinstance(column, Iterable) and not isinstance(column, str) else "none"
    return checks.array(items, path, SceneError, expected=lists, infinite=None)


def _plain(value: np.ndarray) -> Values:
    """A number, or a tuple of them."""
    rows = value.tolist()
    return tuple(rows) if isinstance(rows, list) else rows


# -- motions of equal equations -------------------------------------------------------------------


@dataclass(frozen=True, eq=False)
class _Member:
    """One motion: its index, varied values, numbers, and its scene if it has its own."""

    place: int
    varied: Mapping[str, Values]
    start: Mapping[str, Number]
    parameters: Mapping[str, Number]
    scene: Scene | None


@dataclass
class _Measured:
    """Measures, filled while motions are solved."""

    readers: Mapping[str, Callable[[SweepRun], float]]
    count: int
    progress: Callable[[float], object]
    engines: set[str] = field(default_factory=set)
    unfinished: dict[int, str] = field(default_factory=dict)
    measured: set[int] = field(default_factory=set)
    interrupted: bool = False
    done: int = 0

    def __post_init__(self) -> None:
        """A column for each measure."""
        self.columns = {name: np.full(self.count, np.nan) for name in self.readers}
        self.errors = np.full(self.count, np.nan)

    def measure(
        self, member: _Member, times: np.ndarray, values: Mapping[str, np.ndarray], error: float
    ) -> None:
        """Read one motion."""
        self.errors[member.place] = error
        run = SweepRun(times, values, member.varied)
        for name, reader in self.readers.items():
            self.columns[name][member.place] = reader(run)
        self.measured.add(member.place)
        self._went_on()

    def lose(self, member: _Member, reason: str) -> None:
        """Record a motion that ends too early, with the reason and without a measurement."""
        self.unfinished[member.place] = reason
        self._went_on()

    def stop(self) -> None:
        """Ctrl-C: motions that were not measured yet are named."""
        self.interrupted = True
        for place in set(range(self.count)) - self.measured - self.unfinished.keys():
            self.unfinished[place] = "Ctrl-C stopped the sweep before this motion"

    def _went_on(self) -> None:
        self.done += 1
        self.progress(self.done / self.count)


def _groups(scene: Scene, changes: Sequence[Mapping[str, Values]]) -> dict[Hashable, list[_Member]]:
    """Motions by equations, times and accuracy: those with equal ones are solved in one batch."""
    groups: dict[Hashable, list[_Member]] = {}
    own = tuple(scene.numbers[1])
    for place, varied in enumerate(changes):
        if all(_START.fullmatch(path) for path in varied):
            # Another start leaves the equations, and with them the selection, as they are.
            state, chosen = _restarted(scene, varied), scene.selection
            numbers = start_of(chosen, state), parameters_of(chosen, state)
            member = _Member(place, varied, *numbers, None)
            key: Hashable = ("start", own)
        else:
            variant = scene.with_values(varied)
            member = _Member(place, varied, *variant.numbers, variant)
            assembly = variant.assembly
            switches = str([part.switches for part in assembly.parts.values()])
            # An axis of symmetry, for one, may be another while the equations are the same.
            read = tuple(x for item in variant.selection.watch for x in item.made_of(assembly))
            times = variant.t, variant.samples, variant.accuracy
            key = (tuple(member.parameters), tuple(assembly.rates.items()), switches, read, times)
        groups.setdefault(key, []).append(member)
    return groups


def _restarted(scene: Scene, changes: Mapping[str, Values]) -> State:
    """The start of a scene with some of its numbers changed."""
    state = scene.start
    for path, value in changes.items():
        match = _START.fullmatch(path)
        items = getattr(state, match[1], None) if match else None
        place = int(match[2] or 0) if match else 0
        if match is None or match[2] is None or not isinstance(items, tuple) or place >= len(items):
            # The general route has the message for this path.
            state = scene.with_values({"start": state, path: value}).start
            continue
        items = (*items[:place], value, *items[place + 1 :])
        state = replace(state, **{match[1]: items})
    return state


def _solve_group(
    scene: Scene, members: list[_Member], engine: Engine | None, found: _Measured
) -> None:
    """Solve motions of equal equations, in the way that suits them, and measure them."""
    first = members[0].scene or scene
    if first.ode.rates.stops or first.ode.is_switched or np.ndim(first.t):
        _one_by_one(scene, members, engine, found)
    elif engine is None and closed_form(first) is not None:
        _in_closed_form(scene, members, found)
    else:
        _in_batches(scene, members, engine, found)


def _sampled(scene: Scene) -> np.ndarray:
    """Times close enough for measures between them."""
    return np.linspace(0.0, float(scene.times[-1]), max(FINE, len(scene.times)))


def _in_batches(
    scene: Scene, members: list[_Member], engine: Engine | None, found: _Measured
) -> None:
    """Some motions at a time, by `solve_many`; those that need more digits one by one."""
    first = members[0].scene or scene
    ode, times = first.ode, _sampled(first)
    room = max(LARGEST_BATCH // (len(times) * ode.size), 1)
    for begin in range(0, len(members), room):
        some = members[begin : begin + room]
        starts = {name: np.array([float(m.start[name]) for m in some]) for name in ode.states}
        starts |= {
            name: np.array([float(m.parameters[name]) for m in some])
            for name in ode.rates.parameters
        }
        again: list[_Member] = []
        try:
            solved = solve_many(ode, starts, times, first.accuracy, engine, progress=False)
        except (AccuracyError, StartError) as error:
            # Single motions reach more digits, and an error names the motion that fails.
            solved = getattr(error, "ensemble", None)
            if solved is None:
                _one_by_one(scene, some, engine, found)
                continue
            again = [some[k] for k in solved.unfinished]
        if solved.finished.any():
            found.engines.add(solved.engine)
        for k, member in enumerate(some):
            if not solved.finished[k]:
                if not (again or solved.interrupted):
                    found.lose(member, "it does not reach the last time")
                continue
            own = replace(ode, parameters={**ode.parameters, **member.parameters})
            numbers = times, solved.states[k], float(solved.errors[k])
            _measure(found, member, own, first.selection, *numbers)
        if solved.interrupted:
            raise KeyboardInterrupt
        _one_by_one(scene, again, engine, found)


def _in_closed_form(scene: Scene, members: list[_Member], found: _Measured) -> None:
    """Free bodies at all times at once, each one checked against the integrator."""
    for member in members:
        own = member.scene or scene.with_values(dict(member.varied))
        form, times = closed_form(own), _sampled(own)
        try:
            checked = None if form is None else checked_states(form, times)
        except AccuracyError:
            checked = None
        if checked is None:
            _one_by_one(scene, [member], None, found)
            continue
        found.engines.add("closed form")
        _measure(found, member, own.ode, own.selection, times, checked.states, checked.error)


def _measure(
    found: _Measured,
    member: _Member,
    ode: ODE,
    selection: StateSelection,
    times: np.ndarray,
    states: np.ndarray,
    error: float,
) -> None:
    """Measure the states of a member; a member with a value that is not finite is lost."""
    try:
        values = observed(ode, selection, times, states)
    except SceneError as reason:
        found.lose(member, str(reason))
        return
    found.measure(member, times, values, error)


def _one_by_one(
    scene: Scene, members: list[_Member], engine: Engine | None, found: _Measured
) -> None:
    """Motions that end at different times, or are requested at times of the user."""
    for member in members:
        try:
            result = (member.scene or scene.with_values(dict(member.varied))).run(engine)
        except StuckError as stuck:
            found.lose(member, str(stuck).partition(". Stop earlier")[0])
            continue
        found.engines.add(result.engine)
        found.measure(member, result.times, result.values, result.error)

"""Scene: a body, its effects, start and outputs, and the cost of each effect."""

from __future__ import annotations

import re
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, fields, is_dataclass, replace
from functools import lru_cache
from typing import TYPE_CHECKING, Any

import numpy as np
import sympy as sp

from geomtorsion.errors import GeomtorsionError, SceneError, TimeError, UnknownNameError
from geomtorsion.exact.units import in_unit
from geomtorsion.ode import solve
from geomtorsion.ode.numbers import check_memory, checked_accuracy, checked_times
from geomtorsion.prices import EffectBudget, Offer, Request, called_for
from geomtorsion.scenes.assembly import Assembly, assemble
from geomtorsion.scenes.body import Body, Number
from geomtorsion.scenes.composition import SceneEffects
from geomtorsion.scenes.effects import EFFECTS, Drift, Effect, Spin, Surroundings
from geomtorsion.scenes.magnitudes import Magnitudes, at_surface, magnitudes
from geomtorsion.scenes.metrics import Measure
from geomtorsion.scenes.observables import OBSERVABLES, observable
from geomtorsion.scenes.result import SceneResult
from geomtorsion.scenes.selection import StateSelection
from geomtorsion.scenes.solve import scene_offer, solve_scene
from geomtorsion.scenes.state import State
from geomtorsion.scenes.sweep import SceneSweep, sweep
from geomtorsion.scenes.to_ode import ode_of, parameters_of, pruned_rates, start_of
from geomtorsion.support import checks
from geomtorsion.support.caching import cached_property
from geomtorsion.support.checks import near_names
from geomtorsion.support.copies import only_fields
from geomtorsion.support.hints import attribute_hints
from geomtorsion.support.outgoing import html_text

if TYPE_CHECKING:
    from pathlib import Path

    from geomtorsion.ode import ODE, Engine


# The word for only those effects that the accuracy calls for.
CALLED_FOR = "called for"
# Alternatives of which only one may be given: a new one replaces the old one.
ONE_OF = (("euler", "quaternion", "matrix"), ("moments", "inertia"))
_STEP = re.compile(r"([^\W\d]\w*)((?:\[\d+\])*)")


def with_values(scene: Scene, changes: Mapping[str, Any]) -> Scene:
    """The scene with each path set to its value; all at once, so that checks see the whole."""
    # Changes are collected first, because half of them could describe an impossible body.
    table: dict[str, Any] = {}
    keyed = dict(scene.keyed)
    for path, value in changes.items():
        head, *rest = _steps(path)
        name, places = head
        # Effects are called by their keys, as gravity.g; all else by fields of the scene.
        if name in keyed:
            if not rest:
                raise UnknownNameError(
                    f"{path!r}: expected a value of the effect, got the whole effect. "
                    f"{_inside(keyed[name])}"
                )
            if places:
                again = " Effects of a kind are counted by their keys, as spring2.stiffness."
                raise UnknownNameError(
                    f"{path!r}: expected the key of an effect, got an index: {name} is one "
                    f"effect.{again}"
                )
            keyed[name] = _set(keyed[name], rest, value, path)
        elif name in (item.name for item in fields(scene)) and name != "effects":
            now = table.get(name, getattr(scene, name))
            table[name] = _set_here(now, places, rest, value, path)
        else:
            names = (*(item.name for item in fields(scene) if item.name != "effects"), *keyed)
            raise UnknownNameError(f"{path!r} does not exist. {_near(name, names)}")
    return replace(scene, effects=tuple(keyed.values()), **table)


def _steps(path: str) -> list[tuple[str, tuple[int, ...]]]:
    """Names and indices of a path."""
    pairs = []
    for part in str(path).split("."):
        match = _STEP.fullmatch(part)
        if match is None:
            raise UnknownNameError(
                f"expected a path with dots and indices, such as body.moments[2], got {path!r}."
            )
        pairs.append((match[1], tuple(int(k) for k in re.findall(r"\d+", match[2]))))
    return pairs


def _set(thing: Any, steps: list[tuple[str, tuple[int, ...]]], value: Any, path: str) -> Any:
    """A dataclass, or a table of names, with the entry of the first step changed."""
    (name, places), *rest = steps
    if isinstance(thing, Mapping) and name in thing:
        return {**thing, name: _set_here(thing[name], places, rest, value, path)}
    field_names = {item.name for item in fields(thing)} if is_dataclass(thing) else set()
    if name not in field_names:
        raise UnknownNameError(f"{path!r} does not exist. {_inside(thing, name)}")
    new = _set_here(getattr(thing, name), places, rest, value, path)
    instead = next((set(names) - {name} for names in ONE_OF if name in names), ())
    others = {other: None for other in instead if new is not None and other in field_names}
    # That it is a dataclass is known from its fields, which types do not see.
    return replace(thing, **{name: new}, **others)  # type: ignore[type-var]


def _set_here(now: Any, places: tuple[int, ...], rest: Any, value: Any, path: str) -> Any:
    """A value with the element at these places changed."""
    if places:
        if not isinstance(now, tuple | list) or places[0] >= len(now):
            count = len(now) if isinstance(now, tuple | list) else 0
            raise UnknownNameError(
                f"{path!r}: there is no [{places[0]}] among {count} values here."
                if count
                else f"{path!r}: {now!r} has no components; set it as a whole first."
            )
        items = list(now)
        items[places[0]] = _set_here(items[places[0]], places[1:], rest, value, path)
        return tuple(items)
    return _set(now, rest, value, path) if rest else value


def _inside(thing: Any, name: str = "") -> str:
    """What there is to be set inside a thing."""
    if isinstance(thing, Mapping):
        names = tuple(thing)
    elif is_dataclass(thing):
        names = tuple(item.name for item in fields(thing))
    else:
        return f"{thing!r} has no parts."
    return _near(name, names) if names else "It has nothing to be set."


def _near(name: str, known: tuple[str, ...]) -> str:
    near = near_names(name, known) if name else ""
    listed = f"There are {', '.join(known)}."
    return f"Did you mean {near}? {listed}" if near else listed


def _assembled(body: Body, effects: Mapping[str, Effect]) -> Assembly:
    """The equations of a body under effects, the same for scenes that differ in other values."""
    key = body, tuple(effects.items())
    try:
        hash(key)
    except TypeError:
        # An effect of the user may have a list as a value.
        return assemble(body, effects)
    return _shared_assembly(*key)


@lru_cache
def _shared_assembly(body: Body, effects: tuple[tuple[str, Effect], ...]) -> Assembly:
    """As `assemble`."""
    return assemble(body, dict(effects))


@lru_cache
def _selected(
    title: str, assembly: Assembly, watch: tuple[str, ...], titles: tuple[tuple[str, str], ...]
) -> StateSelection:
    """The selection of all scenes with these equations and outputs."""
    quantities = tuple(observable(name, assembly) for name in watch)
    return StateSelection(title, assembly, quantities, dict(titles))


@attribute_hints(solve="scene.run()")
@dataclass(frozen=True)
class Scene:
    """A rigid body in motion, with exactly the states that its outputs and effects need.

    body: the body.
    effects: forces, torques and constraints; the free rotation (spin) is always included.
        "called for" means gravity and air at the surface of the Earth, as far as the accuracy
        calls for them: see `magnitudes` for their numbers and `called_for` for the choice.
    start: its initial state.
    watch: names of the quantities to report, see `geomtorsion.scenes.observables`.
    t: last time (s, or text such as "3 min"), or all times at which to report, from 0 on.
    accuracy: largest error of the states, relative to their size.
    name, title: for lists and tables.
    samples: number of times to report if t is one number.

    Raises
    ------
    SceneError
        There is no start or no effect, an effect occurs twice, or two contradict each other.
    UnknownNameError
        A quantity in `watch` does not exist; the message names similar ones.

    Examples
    --------
    >>> from geomtorsion.scenes import effects
    >>> top = Scene(Body(moments=(1, 1, 0.5)), [effects.Gravity(9.81), effects.Pivot([0, 0, 0.1])],
    ...             State(omega=(0, 0, 20), euler=(0, 0.3, 0)), watch=["nutation"], t=1)
    >>> top.selection.states
    ('Omega1', 'Omega2', 'Omega3', 'n1', 'n2', 'n3')
    >>> top.with_values({"gravity.g": 0.0, "start.omega[2]": 0.0}).start.omega
    (0, 0, 0.0)
    """

    body: Body
    effects: Sequence[Effect] = ()
    # Without a default it could not follow the effects; None is refused.
    start: State = None  # type: ignore[assignment]
    watch: Sequence[str] = ("omega",)
    t: float | Sequence[float] = 10.0
    accuracy: float = 1e-10
    name: str = ""
    title: str = ""
    samples: int = 201

    def __getstate__(self) -> dict[str, object]:
        return only_fields(self)

    def __post_init__(self) -> None:
        """Check everything that can be checked without solving."""
        remedy = "Write Body(moments=(1, 2, 3))."
        checks.instance(self.body, Body, "body", SceneError, remedy=remedy)
        if isinstance(self.effects, str) and self.effects == CALLED_FOR:
            around = replace(self, effects=at_surface(self.body))
            chosen = called_for(around).chosen
            object.__setattr__(self, "effects", chosen.effects)
            object.__setattr__(self, "accuracy", chosen.accuracy)
        object.__setattr__(self, "effects", _effect_list(self.effects))
        object.__setattr__(self, "watch", _names(self.watch))
        remedy = "Write State(omega=(0, 0, 1))."
        checks.instance(self.start, State, "start", SceneError, remedy=remedy)
        object.__setattr__(self, "accuracy", checked_accuracy(self.accuracy))
        object.__setattr__(self, "t", in_unit(self.t, "s", "t", TimeError))
        checked_times(self.t)
        if isinstance(self.t, Iterable) and checks.real(self.t) is None:
            object.__setattr__(self, "t", tuple(float(x) for x in self.t))
        samples = checks.count(self.samples, "samples", SceneError, 2)
        object.__setattr__(self, "samples", samples)
        # Before there are equations: every body has six numbers and their rates.
        check_memory(self.samples, 12)
        # Outputs of effects are known only when these have written their equations.
        for key, part in self.assembly.parts.items():
            for name in part.outputs:
                if name in OBSERVABLES:
                    raise SceneError(
                        f"{key}: expected a new name for the watched quantity, got {name!r}, which "
                        "exists already. Choose another name."
                    )
        _ = self.selection

    # -- equations -------------------------------------------------------------------------------

    @cached_property
    def keyed(self) -> Mapping[str, Effect]:
        """Effects by key; a second one of a kind is `spring2`."""
        table: dict[str, Effect] = {}
        for effect in self.effects:
            key, count = effect.key, 1
            while key in table:
                count += 1
                key = f"{effect.key}{count}"
            table[key] = effect
        return table

    @cached_property
    def assembly(self) -> Assembly:
        """All equations in symbols, before unneeded states are removed."""
        return _assembled(self.body, self.keyed)

    @cached_property
    def correct_assembly(self) -> Assembly:
        """The equations without the laws that are shipped as wrong."""
        right = {key: effect for key, effect in self.keyed.items() if not effect.wrong}
        return self.assembly if len(right) == len(self.keyed) else _assembled(self.body, right)

    @cached_property
    def selection(self) -> StateSelection:
        """Included and omitted states and effects, with reasons; prints as a table."""
        titles = {"spin": Spin.title}
        if self.assembly.constraint is None:
            titles["drift"] = Drift.title
        titles |= {key: effect.title for key, effect in self.keyed.items()}
        named = self.title or self.name
        return _selected(named, self.assembly, tuple(self.watch), tuple(titles.items()))

    @cached_property
    def ode(self) -> ODE:
        """The equations that are solved, with start, parameters and invariants."""
        name = self.title or self.name
        return ode_of(self.selection, self.start, self.correct_assembly, name)

    @property
    def equations(self) -> Mapping[str, sp.Expr]:
        """State -> rate as sympy expression, of the states that are solved for."""
        return pruned_rates(self.selection)

    @property
    def numbers(self) -> tuple[Mapping[str, Number], Mapping[str, Number]]:
        """Start of each state and value of each parameter: the numbers in the equations."""
        return start_of(self.selection, self.start), parameters_of(self.selection, self.start)

    @cached_property
    def observables(self) -> Mapping[str, str]:
        """Name -> meaning of each quantity that can be reported; also euler:CONVENTION."""
        own = [name for part in self.assembly.parts.values() for name in part.outputs]
        return {name: observable(name, self.assembly).meaning for name in (*OBSERVABLES, *own)}

    @property
    def times(self) -> np.ndarray:
        """Times that are reported, shape (m,)."""
        t = np.asarray(self.t, dtype=float)
        return t if t.ndim else np.linspace(0.0, float(t), self.samples if t else 1)

    # -- doing it --------------------------------------------------------------------------------

    def run(
        self,
        engine: Engine | None = None,
        checkpoint: str | Path | None = None,
        progress: Callable[[float], object] | bool | None = None,
        *,
        t: object = None,
    ) -> SceneResult:
        """Solve the scene; the result holds the outputs by name.

        A free body is solved in closed form; over its first turns each value is compared with an
        integration from the value before. Where they differ the motion is integrated, and `reason`
        names the difference. With an engine the motion is always integrated.

        Parameters
        ----------
        engine, checkpoint, progress
            as in `geomtorsion.solve`.
        t
            last time instead of the scene's, in seconds or with a unit: 20 or "3 min".

        Raises
        ------
        AccuracyError
            the accuracy cannot be reached.
        StartError
            the start lacks something that the selection needs.
        StuckError
            the motion cannot continue; the `solution` of the error is the result so far.
        """
        scene = self if t is None else self.with_values(t=t)
        return solve_scene(scene, engine, checkpoint, progress)

    def cost(self, engine: Engine | None = None, repeats: int = 5) -> SceneCost:
        """Number of states and run time, one row for each effect in the order of the scene."""
        return scene_cost(self, engine, repeats)

    def called_for(
        self,
        accuracy: float | None = None,
        engine: Engine | None = None,
        progress: Callable[[float], object] | bool | None = None,
    ) -> EffectBudget:
        """Smallest set of effects whose errors of omission and integration stay within an accuracy.

        The same as `gt.called_for(scene, accuracy)`, which describes the choice.

        Parameters
        ----------
        accuracy
            of the watched quantities, relative to their largest size; by default the accuracy of
            the scene.
        engine, progress
            as in `geomtorsion.solve`.

        Returns
        -------
        EffectBudget; its `chosen` scene has only the effects that are called for.

        Raises
        ------
        AccuracyError
            the accuracy cannot be reached.
        StartError, StuckError
            as for `run`, of the scene with all effects.

        Examples
        --------
        >>> from geomtorsion.scenes import effects, load
        >>> drag = effects.LinearDrag(1e-6)
        >>> scene = load("missile")
        >>> scene = scene.with_values(watch=["position"])
        >>> from dataclasses import replace
        >>> replace(scene, effects=[*scene.effects, drag]).called_for(1e-3).omitted
        ('linear_drag',)
        """
        return called_for(self, accuracy, engine=engine, progress=progress)

    def composite(self, watch: Sequence[str] | None = None) -> SceneEffects:
        """Effects, runs without some of them and watched quantities, for `gt.called_for`.

        watch: quantities instead of the watched ones of the scene.
        """
        return SceneEffects(self if watch is None else replace(self, watch=watch))

    def offer(self, request: Request) -> Offer:
        """Ways to the motion at an accuracy, and the cost of each effect, for `gt.price`."""

        def effects() -> list[tuple[str, float]]:
            return [(row.effect, row.run_seconds) for row in self.cost().rows if not row.note]

        return replace(scene_offer(self, request), effects=effects)

    def magnitudes(self, surroundings: Surroundings | None = None) -> Magnitudes:
        """Influence of each shipped effect that the scene does not have.

        Each effect whose numbers follow from the body and its surroundings (gravity, drag, the
        tide of an orbit) is added once; the change of the watched quantities is its influence.
        The scene remains as it is.

        surroundings: air and gravity, by default at sea level on the Earth.

        Raises
        ------
        AccuracyError, StartError, StuckError
            as for `run`.

        Examples
        --------
        >>> stone = Scene(Body.ellipsoid(mass=0.2, semiaxes=(0.03, 0.03, 0.02)),
        ...               start=State(velocity=(20, 0, 5)), watch=["position"], t=1)
        >>> [effect.key for effect in stone.magnitudes().lacking(1e-3)]
        ['gravity', 'quadratic_drag']
        """
        return magnitudes(self, surroundings)

    def sweep(
        self,
        varied: Mapping[str, Iterable[Number | Sequence[Number]]],
        measure: Measure | Mapping[str, Measure] | Sequence[str],
        **options: Any,
    ) -> SceneSweep:
        """Solve the scene for many values of its numbers, and measure each motion.

        Parameters
        ----------
        varied, measure, options
            as in `geomtorsion.scenes.sweep.sweep`: dotted path -> values; "max nutation" or
            "between zeros omega[1]" or a function; together, engine, progress.

        Raises
        ------
        UnknownNameError
            a path does not exist.
        SceneError
            nothing is varied, lengths differ, or words are not a measure.
        """
        return sweep(self, varied, measure, **options)

    def with_values(self, changes: Mapping[str, Any] | None = None, **fields: Any) -> Scene:
        """The same scene with other values, named by dotted paths.

        Parameters
        ----------
        changes
            path -> value: "body.moments[2]", "gravity.g", "start.omega[0]", "t", "accuracy";
            effects="called for" retains only the effects that the accuracy calls for, see
            `called_for`.

        Raises
        ------
        UnknownNameError
            a path does not exist; the message names the existing ones.
        """
        changes = checks.table(changes, "changes", SceneError) | fields
        chosen = changes.pop("effects", None)
        changed = with_values(self, changes)
        if chosen is None:
            return changed
        if chosen != CALLED_FOR:
            raise UnknownNameError(
                f"effects: expected {CALLED_FOR!r}, got {checks.shown(chosen)}. For other effects "
                "use dataclasses.replace(scene, effects=[...])."
            )
        return called_for(changed).chosen

    def _repr_html_(self) -> str:
        return f"<div><b>{html_text(str(self))}</b>{self.selection._repr_html_()}</div>"

    def __str__(self) -> str:
        acting = ", ".join(self.keyed) or "no effects"
        return f"{self.title or self.name or 'scene'}: {acting}; watched: {', '.join(self.watch)}"

    def __repr__(self) -> str:
        return f"Scene({self})"


def _names(watch: Any) -> tuple[str, ...]:
    """Names of what to report, each once."""
    names = tuple(watch) if isinstance(watch, list | tuple | set | dict) else (watch,)
    if not names:
        raise SceneError(
            'watch: expected at least one quantity, got none. Give a name, for instance "omega".'
        )
    for name in names:
        remedy = 'Give a list, for instance ["omega"].'
        checks.text(name, "watch", SceneError, expected="names as text", remedy=remedy)
    # In their order, each once.
    return tuple(dict.fromkeys(names))


def _effect_list(effects: Any) -> tuple[Effect, ...]:
    """Effects, each at most once unless it may be there several times, none against another."""
    if isinstance(effects, Effect | str):
        effects = (effects,)
    listed = tuple(effects) if isinstance(effects, Iterable) else (effects,)
    for effect in listed:
        if not isinstance(effect, Effect):
            name = getattr(effect, "__name__", repr(effect))
            hint = f" Write {name}(...)." if isinstance(effect, type) else ""
            names = ", ".join(kind.__name__ for kind in EFFECTS)
            raise SceneError(
                f"effects: expected an effect, got {name}.{hint} There are {names}, or "
                f"{CALLED_FOR!r}."
            )
    keys = [effect.key for effect in listed]
    for effect in listed:
        if keys.count(effect.key) > 1 and not effect.several:
            raise SceneError(
                f"effects: expected each effect once, got {effect.key} twice. Keep one of them."
            )
        for rival in listed:
            if rival.key in effect.excludes:
                raise SceneError(
                    f"expected effects that agree, got {effect.key} ({effect.title}) and "
                    f"{rival.key} ({rival.title}), which contradict each other. Keep one of them."
                )
    return listed


@dataclass(frozen=True)
class SceneCostRow:
    """A scene with its effects up to one of them.

    effect: the key that was added last ("spin" at first).
    states: number of equations; steps: of the integration.
    run_seconds: to integrate, best of several, without compiling.
    compile_seconds: once for all scenes with equal equations.
    note: why there are no figures, if there are none.
    """

    effect: str
    states: int
    steps: int
    run_seconds: float
    compile_seconds: float
    note: str = ""


@dataclass(frozen=True)
class SceneCost:
    """Cost of each effect of a scene; prints as a table.

    rows: one row per effect; effects are added in the order of the scene.
    """

    title: str
    accuracy: float
    rows: tuple[SceneCostRow, ...]

    def __str__(self) -> str:
        width = max(len("with effect"), *(len(row.effect) + 2 for row in self.rows))
        lines = [
            f"{self.title or 'scene'}, accuracy {self.accuracy:.3g}",
            f"{'with effect':<{width}}  states   steps  run, ms  added, ms  compile, s",
        ]
        before = 0.0
        for k, row in enumerate(self.rows):
            name = f"{'+ ' * (k > 0)}{row.effect}"
            if row.note:
                lines.append(f"{name:<{width}}  {row.note}")
                continue
            run = 1e3 * row.run_seconds
            lines.append(
                f"{name:<{width}}  {row.states:>6}  {row.steps:>6}  {run:>7.3f}  "
                f"{run - before:>+9.3f}  {row.compile_seconds:>10.2f}"
            )
            before = run
        return "\n".join(lines)

    def __repr__(self) -> str:
        return str(self)


def scene_cost(scene: Scene, engine: Engine | None = None, repeats: int = 5) -> SceneCost:
    """Measure a scene with its effects added one by one; see `Scene.cost`."""
    repeats = checks.count(repeats, "repeats", SceneError, 1)
    rows = []
    for count in range(len(scene.effects) + 1):
        key = tuple(scene.keyed)[count - 1] if count else "spin"
        rows.append(_row(scene, count, key, engine, repeats))
    return SceneCost(scene.title or scene.name, scene.accuracy, tuple(rows))


def _row(scene: Scene, count: int, key: str, engine: Engine | None, repeats: int) -> SceneCostRow:
    """The scene with its first effects, watching what there is to watch."""
    try:
        part = _with_first(scene, count)
        # The first run compiles; what it ran is not counted.
        first = solve(part.ode, part.times, part.accuracy, engine)
        runs = [solve(part.ode, part.times, part.accuracy, engine) for _ in range(repeats)]
    except GeomtorsionError as problem:
        return SceneCostRow(key, 0, 0, 0.0, 0.0, f"not by itself: {problem}")
    best = min(runs, key=lambda run: run.cost.run_seconds)
    compiled = first.cost.compile_seconds
    return SceneCostRow(key, part.ode.size, best.cost.steps, best.cost.run_seconds, compiled)


def _with_first(scene: Scene, count: int) -> Scene:
    """The scene with its first effects; what only later ones provide is not watched."""
    if count == len(scene.effects):
        return scene
    keyed = dict(list(scene.keyed.items())[:count])
    assembly = assemble(scene.body, keyed)
    names = []
    for name in scene.watch:
        # What only a later effect brings cannot be watched yet.
        try:
            observable(name, assembly)
        except GeomtorsionError:
            continue
        names.append(name)
    if not names:
        raise SceneError(
            "expected a watched quantity that exists without the effects that follow, got none. "
            "Watch another one."
        )
    return replace(scene, effects=tuple(keyed.values()), watch=tuple(names))

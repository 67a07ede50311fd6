"""Called for: the smallest set of effects that an accuracy calls for, by measured influence."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from geomtorsion.errors import AccuracyError, GeomtorsionError, UnknownNameError
from geomtorsion.ode.numbers import checked_accuracy
from geomtorsion.ode.solution import DOUBLE
from geomtorsion.pictures.scene_effects import influence_picture
from geomtorsion.pictures.style import pictured, save
from geomtorsion.scenes.sensitivity import Sensitivity, relative_changes, sensitivity
from geomtorsion.support.caching import cached_property
from geomtorsion.support.checks import known_name
from geomtorsion.support.outgoing import size_text
from geomtorsion.support.progress import reports

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from geomtorsion.ode import Engine
    from geomtorsion.scenes.result import SceneResult
    from geomtorsion.scenes.scene import Scene

# Runs that are compared with each other are two orders more accurate than requested: their
# differences are then effects, and not errors. Effects leave one order to the integration: digits
# cost less than effects.
ORDER = 0.1


@dataclass(frozen=True)
class EffectInfluence:
    """Influence of one effect on the watched quantities of a scene.

    effect: its key; title: its description.
    included: whether the accuracy calls for it.
    changes: watched quantity -> largest change at the reported times if only this effect is
        omitted, relative to the largest size of the quantity; infinite if there is no such motion,
        or if the quantity is zero with all effects.
    equations: number of equations that only this effect adds.
    seconds: time of integration that it adds, as measured; not a part of equality.
    note: why the motion does not exist without it, or why the influence is exactly zero.
    """

    effect: str
    title: str
    included: bool
    changes: Mapping[str, float]
    equations: int
    seconds: float = field(compare=False)
    note: str = ""

    @property
    def influence(self) -> float:
        """The largest change of a watched quantity."""
        return max(self.changes.values())

    @property
    def quantity(self) -> str:
        """The watched quantity that changes most."""
        return max(self.changes, key=self.changes.__getitem__)


@dataclass(frozen=True, eq=False)
class EffectBudget:
    """The effects that an accuracy calls for: omission and integration together stay within it.

    accuracy: the requested accuracy of the watched quantities, relative to their largest size.
    full: the scene with all its effects.
    scene: the scene with only the effects that are called for, at the accuracy that is left for
        its integration.
    rows: influence of each effect, the largest first.
    omission_error: change of the watched quantities by all omitted effects together, relative: the
        larger of the measured change and of the sum of the single changes, which gives effects that
        cancel each other no credit, with the error of the compared runs.
    numerical_error: error of the integration of `scene`, relative: the larger of its estimate and
        of the change of the watched quantities against a finer run.
    growth: how fast a small change of the start grows; None where it is not measured.
    result: the run of `scene`.
    seconds, full_seconds: time of integration of `scene`, and of `full` at the same accuracy.

    Examples
    --------
    >>> from geomtorsion.scenes import load
    >>> budget = load("thrown_body").called_for(1e-3)
    >>> budget.error <= budget.accuracy
    True
    """

    accuracy: float
    full: Scene
    scene: Scene
    rows: tuple[EffectInfluence, ...]
    omission_error: float
    numerical_error: float
    growth: Sensitivity | None
    result: SceneResult
    seconds: float
    full_seconds: float

    @property
    def effects(self) -> tuple[str, ...]:
        """Keys of the effects that are called for, in the order of the scene."""
        included = {row.effect for row in self.rows if row.included}
        return tuple(key for key in self.full.keyed if key in included)

    @property
    def omitted(self) -> tuple[str, ...]:
        """Keys of the omitted effects, in the order of the scene."""
        return tuple(key for key in self.full.keyed if key not in self.effects)

    @property
    def error(self) -> float:
        """Error of the watched quantities of `result` against the scene with all effects."""
        return self.omission_error + self.numerical_error

    def __getitem__(self, effect: str) -> EffectInfluence:
        """The row of an effect."""
        rows = {row.effect: row for row in self.rows}
        kind = "an effect of the scene"
        return rows[known_name(effect, rows, "", UnknownNameError, expected=kind)]

    def _ipython_key_completions_(self) -> list[str]:
        return [row.effect for row in self.rows]

    # -- showing ---------------------------------------------------------------------------------

    @property
    def errors(self) -> str:
        """One line: the error and its two parts."""
        return (
            f"error below {size_text(self.error)}: omission {size_text(self.omission_error)}, "
            f"integration {size_text(self.numerical_error)}"
        )

    @property
    def validity(self) -> str:
        """The times for which the choice holds, and the growth of small changes."""
        end = f"t = {float(self.full.times[-1]):.6g} s"
        if self.growth is None:
            return f"The choice holds for this start, up to {end}."
        if self.growth.chaotic:
            return (
                f"The motion is chaotic or passes close to an unstable one: {self.growth}. In a "
                "chaotic motion the influence of an omitted effect, however small, has no limit; "
                f"the choice holds only up to {end}."
            )
        return f"The choice holds for this start, up to {end}: {self.growth}."

    def __str__(self) -> str:
        count, every = len(self.effects), len(self.rows)
        name = self.full.title or self.full.name or "scene"
        watched = ", ".join(self.full.watch)
        heading = f"{name}: accuracy {self.accuracy:.3g} of {watched} calls for {count} of {every}"
        lines = [f"{heading} effect{'s' * (every != 1)}"]
        width = max([len("effect"), *(len(row.effect) for row in self.rows)])
        where = max([len("of"), *(len(row.quantity) for row in self.rows)])
        if self.rows:
            lines.append(
                f"{'':<9}{'effect':<{width}}  influence  {'of':<{where}}  equations  run, ms"
            )
        for row in self.rows:
            mark = "in" if row.included else "omitted"
            size = "needed" if math.isinf(row.influence) else size_text(row.influence)
            quantity = row.quantity if row.influence else ""
            line = (
                f"{mark:<9}{row.effect:<{width}}  {size:>9}  {quantity:<{where}}  "
                f"{row.equations:>+9}  {1e3 * row.seconds:>+7.3f}"
            )
            lines.append(f"{line}  {row.note}".rstrip())
        lines.append(self.errors)
        size, full_size = self.scene.ode.size, self.full.ode.size
        instead = f" instead of {full_size}" if size != full_size else ""
        before = f" instead of {1e3 * self.full_seconds:.3g} ms" if self.omitted else ""
        lines.append(
            f"{size} equation{'s' * (size != 1)}{instead}, integrated in "
            f"{1e3 * self.seconds:.3g} ms{before}"
        )
        return "\n".join([*lines, self.validity])

    def __repr__(self) -> str:
        return str(self)

    def _repr_html_(self) -> str:
        return pictured(str(self), self.plot)

    def plot(self, path: str | Path | None = None) -> Figure:
        """The influence of each effect against the accuracy; written to `path` if given.

        Raises
        ------
        MissingExtraError
            matplotlib is not installed.
        """
        figure = influence_picture(
            [(row.effect, row.influence, row.quantity, row.included) for row in self.rows],
            self.accuracy,
            self.full.title or self.full.name,
            [f"{self.errors.capitalize()}.", self.validity],
        )
        if path is not None:
            save(figure, Path(path))
        return figure

    def to_json(self) -> dict[str, Any]:
        """The budget as a JSON-ready mapping; an infinite influence is None."""
        growth = self.growth
        return {
            "title": self.full.title or self.full.name,
            "watch": list(self.full.watch),
            "t": float(self.full.times[-1]),
            "accuracy": self.accuracy,
            "effects": list(self.effects),
            "omitted": list(self.omitted),
            "error": self.error,
            "omission_error": self.omission_error,
            "numerical_error": self.numerical_error,
            "integration_accuracy": self.scene.accuracy,
            "equations": self.scene.ode.size,
            "all_equations": self.full.ode.size,
            "seconds": self.seconds,
            "all_seconds": self.full_seconds,
            "growth": None if growth is None else growth.factor,
            "growth_power": None if growth is None else growth.power,
            "chaotic": None if growth is None else growth.chaotic,
            "rows": [
                {
                    "effect": row.effect,
                    "included": row.included,
                    "influence": _finite(row.influence),
                    "quantity": row.quantity,
                    "changes": {name: _finite(size) for name, size in row.changes.items()},
                    "equations": row.equations,
                    "seconds": row.seconds,
                    "note": row.note,
                }
                for row in self.rows
            ],
        }


def _finite(value: float) -> float | None:
    """A number that JSON knows."""
    return value if math.isfinite(value) else None


# -- the choice -----------------------------------------------------------------------------------


@dataclass(frozen=True)
class _Omission:
    """A scene without some of its effects, compared with the whole scene.

    changes: quantity -> relative change at each time, shape (m,); None without a solution.
    error: estimate of the errors of both runs. note: the reason, if the motion has no solution.
    """

    changes: Mapping[str, np.ndarray] | None
    error: float = 0.0
    equations: int = 0
    seconds: float = 0.0
    note: str = ""

    @property
    def size(self) -> float:
        """The largest change."""
        if self.changes is None:
            return math.inf
        return max(float(change.max(initial=0.0)) for change in self.changes.values())


@dataclass(frozen=True, eq=False)
class _Comparison:
    """The whole scene, solved more accurately than requested, for comparison with parts of it."""

    result: SceneResult
    engine: Engine | None

    @property
    def scene(self) -> Scene:
        """The whole scene at the accuracy of the comparison."""
        assert self.result.scene is not None
        return self.result.scene

    @cached_property
    def seconds(self) -> float:
        """Time of its integration."""
        return _seconds(self.scene, self.result, self.engine)

    def without(self, keys: Iterable[str]) -> _Omission:
        """The scene without these effects."""
        whole, keys = self.scene, frozenset(keys)
        # No output depends on an effect that the selection omits.
        if not keys & {*whole.selection.effects}:
            still = dict.fromkeys(whole.watch, np.zeros(len(self.result.times)))
            return _Omission(still, note="exactly: no watched quantity depends on it")
        if _renames(whole, keys):
            return _Omission(None, note="without it watched effects of its kind get other names")
        try:
            part = without(whole, keys)
            run = part.run(self.engine)
        except GeomtorsionError as problem:
            return _Omission(None, note=f"without it: {str(problem).partition('. ')[0]}")
        changes = relative_changes(self.result.values, run.values)
        if changes is None:
            return _Omission(None, note="without it the motion ends at another time")
        added = whole.ode.size - part.ode.size
        seconds = self.seconds - _seconds(part, run, self.engine)
        return _Omission(changes, self.result.error + run.error, added, seconds)


def _seconds(scene: Scene, result: SceneResult, engine: Engine | None) -> float:
    """Time of the integration of a scene, without compiling: the shorter of two runs."""
    return min(result.cost.run_seconds, scene.run(engine).cost.run_seconds)


def _renames(scene: Scene, keys: frozenset[str]) -> bool:
    """Whether watched quantities of an effect are named otherwise without earlier ones: rotor2."""
    kinds: set[str] = set()
    for key, effect in scene.keyed.items():
        if key in keys:
            kinds.add(effect.key)
        elif effect.key in kinds and {*scene.assembly.parts[key].outputs} & {*scene.watch}:
            return True
    return False


def without(scene: Scene, keys: Iterable[str]) -> Scene:
    """The scene without the effects of these keys."""
    omitted = frozenset(keys)
    return replace(
        scene, effects=[effect for key, effect in scene.keyed.items() if key not in omitted]
    )


def called_for(
    scene: Scene,
    accuracy: float | None = None,
    engine: Engine | None = None,
    progress: Callable[[float], object] | bool | None = None,
) -> EffectBudget:
    """Choose the effects that an accuracy calls for; see `Scene.called_for`."""
    goal = scene.accuracy if accuracy is None else checked_accuracy(accuracy)
    with reports(progress, "effects") as show:
        # The whole, each effect omitted, all omitted effects, the integration and the growth.
        count, steps = 0, len(scene.keyed) + 4

        def step() -> None:
            nonlocal count
            count += 1
            if show is not None:
                show(min(count / steps, 1.0))

        whole = _Comparison(_finer(scene, goal, engine), engine)
        step()
        omissions = {}
        for key in scene.keyed:
            omissions[key] = whole.without([key])
            step()
        omitted, omission = _dropped(whole, omissions, goal)
        step()
        while True:
            try:
                result, numerical = _integrated(whole, omitted, goal, omission, engine)
                break
            except AccuracyError:
                # More of the accuracy is left for the digits of a scene with more effects.
                if not omission:
                    raise
                omitted, omission = _dropped(whole, omissions, omission / 2)
        step()
        growth = None
        # A free body has a closed form, and its motion is regular.
        if whole.result.closed_form is None:
            growth = sensitivity(scene.ode, scene.selection, scene.times, engine)
        step()
    rows = [
        EffectInfluence(
            key,
            effect.title,
            key not in omitted,
            _sizes(omissions[key], scene.watch),
            omissions[key].equations,
            omissions[key].seconds,
            omissions[key].note,
        )
        for key, effect in scene.keyed.items()
    ]
    rows.sort(key=lambda row: -row.influence)
    at_goal = replace(scene, accuracy=goal)
    assert result.scene is not None
    return EffectBudget(
        goal,
        at_goal,
        result.scene,
        tuple(rows),
        omission,
        numerical,
        growth,
        result,
        _seconds(result.scene, result, engine),
        _seconds(at_goal, at_goal.run(engine), engine),
    )


def _sizes(omission: _Omission, watch: Iterable[str]) -> dict[str, float]:
    """The largest change of each quantity."""
    changes = omission.changes
    if changes is None:
        return dict.fromkeys(watch, math.inf)
    return {name: float(change.max(initial=0.0)) for name, change in changes.items()}


def _finer(scene: Scene, goal: float, engine: Engine | None) -> SceneResult:
    """A run for comparison: as accurate as possible, up to a hundred times the accuracy."""
    for part in (ORDER**2, ORDER):
        try:
            return replace(scene, accuracy=max(part * goal, min(goal, DOUBLE))).run(engine)
        except AccuracyError:
            continue
    return replace(scene, accuracy=goal).run(engine)


def _dropped(
    whole: _Comparison, omissions: Mapping[str, _Omission], goal: float
) -> tuple[tuple[str, ...], float]:
    """Effects that can be omitted together, and the error by their omission."""
    limit = goal * (1 - ORDER)
    total = dict.fromkeys(whole.scene.watch, np.zeros(len(whole.result.times)))
    omitted: list[str] = []
    # The smallest first: this omits the most.
    for key in sorted(omissions, key=lambda key: omissions[key].size):
        changes = omissions[key].changes
        if changes is None:
            continue
        # Sizes are added, so that two effects that cancel each other are not omitted together.
        both = {name: total[name] + changes[name] for name in total}
        if _largest(both) + omissions[key].error <= limit:
            omitted.append(key)
            total = both
    while any(omissions[key].size for key in omitted):
        # Effects that replace each other matter only together: the whole choice has its own run.
        joint = whole.without(omitted)
        error = max(joint.size, _largest(total)) + joint.error
        if error <= limit:
            return tuple(omitted), error
        last = omitted.pop()
        total = {name: total[name] - (omissions[last].changes or {})[name] for name in total}
    return tuple(omitted), 0.0


def _largest(changes: Mapping[str, np.ndarray]) -> float:
    """The largest value of all."""
    return max(float(change.max(initial=0.0)) for change in changes.values())


def _integrated(
    whole: _Comparison,
    omitted: Sequence[str],
    goal: float,
    omission: float,
    engine: Engine | None,
) -> tuple[SceneResult, float]:
    """A run whose error and omission are within the accuracy together, and its error.

    Raises
    ------
    AccuracyError
        the watched quantities are not to be had with this accuracy.
    """
    rest = goal - omission
    part = without(whole.scene, omitted)
    finest = part.run(engine)
    accuracy, numerical = rest, math.inf
    while accuracy >= DOUBLE:
        result = replace(part, accuracy=accuracy).run(engine)
        changes = relative_changes(finest.values, result.values)
        # A quantity can lose digits that the states have, such as a difference of large energies.
        measured = math.inf if changes is None else _largest(changes)
        numerical = max(result.error, measured + finest.error)
        if numerical <= rest:
            return result, numerical
        accuracy *= min(rest / numerical, 1.0) / 2
    raise AccuracyError(
        f"accuracy: expected {goal:.3g} of {', '.join(part.watch)}, got {size_text(numerical)}; "
        "these lose digits that the states have. Request less, or watch other quantities."
    )

"""Effect choice: the smallest set of effects for an accuracy, by measured influence."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any, Protocol

import numpy as np

from geomtorsion.errors import AccuracyError, GeomtorsionError
from geomtorsion.ode import Engine
from geomtorsion.ode.numbers import checked_accuracy
from geomtorsion.ode.solution import DOUBLE
from geomtorsion.prices.effects.effect_budget import EffectBudget, EffectInfluence
from geomtorsion.prices.effects.sensitivity import NUDGE, Sensitivity, Series, relative_changes
from geomtorsion.support.caching import cached_property
from geomtorsion.support.outgoing import size_text
from geomtorsion.support.progress import reports

# Runs that are compared with each other are two orders more accurate than requested: their
# differences are then effects, and not errors. Effects leave one order to the integration: digits
# cost less than effects.
ORDER = 0.1


@dataclass(frozen=True)
class Trial:
    """A run of a thing without some of its effects.

    values: watched quantity -> values, shape (m, ...), the times first.
    error: estimate of their error, relative. result: the result of the thing's own run.
    accuracy: of the integration. equations: number of equations that were solved.
    first: time of its integration, in seconds. again: measures it once more.
    regular: whether the motion has a closed form, so that small changes do not grow fast.
    unresolved: quantities no larger than the error of the quantities measured with them.
    missed: time of a pulse that all steps passed over, or None.
    """

    values: Series
    error: float
    result: Any
    accuracy: float
    equations: int
    first: float
    again: Callable[[], float]
    regular: bool = False
    unresolved: tuple[str, ...] = ()
    missed: float | None = None

    @cached_property
    def seconds(self) -> float:
        """Time of the integration in seconds, without compiling; the shorter of two runs."""
        return min(self.first, self.again())


class Composite(Protocol):
    """Sum of effects: a scene, a motion with forces, a theory with terms.

    title: its name. effects: key -> description. watch: names of the watched quantities.
    thing: the scene, motion or theory itself. end: the last time, in words. accuracy: the default.
    """

    @property
    def accuracy(self) -> float:
        """Default accuracy."""
        ...

    @property
    def title(self) -> str:
        """Its name."""
        ...

    @property
    def thing(self) -> Any:
        """The scene, motion or theory itself."""
        ...

    @property
    def effects(self) -> Mapping[str, str]:
        """Key -> description of each effect, in order."""
        ...

    @property
    def watch(self) -> tuple[str, ...]:
        """Names of the watched quantities."""
        ...

    @property
    def end(self) -> str:
        """The last time, in words."""
        ...

    def without(self, keys: frozenset[str], accuracy: float) -> Any:
        """The thing without some effects, for an accuracy of its integration."""
        ...

    def run(self, keys: frozenset[str], accuracy: float, engine: Engine | None) -> Trial:
        """A run without some effects."""
        ...

    def idle(self, keys: frozenset[str]) -> str:
        """Why no watched quantity depends on these effects; empty if a quantity may."""
        ...

    def needed(self, keys: frozenset[str]) -> str:
        """Why these effects cannot be omitted for a comparison; empty if they can."""
        ...

    def growth(self, engine: Engine | None) -> Sensitivity | None:
        """Growth of a small change of the start; None where it cannot be measured."""
        ...

    def nudged(self, part: float) -> Composite:
        """The same sum of effects from a start changed by a part of its size."""
        ...


@dataclass(frozen=True)
class _Omission:
    """A run without some effects, compared with the run of the whole.

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
        return math.inf if self.changes is None else _largest(self.changes)


@dataclass(frozen=True, eq=False)
class _Comparison:
    """The whole, solved more accurately than requested, for comparison with parts of it."""

    composite: Composite
    whole: Trial
    engine: Engine | None

    @property
    def still(self) -> dict[str, np.ndarray]:
        """No change at any time."""
        return {name: np.zeros(len(values)) for name, values in self.whole.values.items()}

    def without(self, keys: Iterable[str]) -> _Omission:
        """The run without these effects, compared."""
        whole, omitted = self.whole, frozenset(keys)
        try:
            note = self.composite.needed(omitted)
            if note:
                return _Omission(None, note=note)
            idle = self.composite.idle(omitted)
            if idle:
                return _Omission(self.still, note=idle)
            part = self.composite.run(omitted, whole.accuracy, self.engine)
        except GeomtorsionError as problem:
            return _Omission(None, note=f"without it: {str(problem).partition('. ')[0]}")
        if whole.missed is not None and part.missed is None:
            when = f"t = {whole.missed:.4g}"
            return _Omission(None, note=f"not resolved: it acts near {when}, for less than a step")
        changes = relative_changes(whole.values, part.values)
        if changes is None:
            return _Omission(None, note="without it the motion ends at another time")
        added = whole.equations - part.equations
        return _Omission(changes, whole.error + part.error, added, whole.seconds - part.seconds)


def choose(
    composite: Composite,
    accuracy: float,
    engine: Engine | None = None,
    progress: Callable[[float], object] | bool | None = None,
) -> EffectBudget:
    """Choose the effects that an accuracy calls for; see `called_for`."""
    goal, keys = checked_accuracy(accuracy), tuple(composite.effects)
    with reports(progress, "effects") as show:
        # The whole, each effect omitted, the growth, all omitted effects and the integration.
        count, steps = 0, len(keys) + 4

        def step() -> None:
            nonlocal count
            count += 1
            if show is not None:
                show(min(count / steps, 1.0))

        comparison = _Comparison(composite, _finer(composite, goal, engine), engine)
        step()
        omissions = {}
        for key in keys:
            omissions[key] = comparison.without([key])
            step()
        growth = None if comparison.whole.regular else composite.growth(engine)
        step()
        if growth is not None and growth.factor * NUDGE > goal:
            _look_beside(comparison, omissions)
        omitted, omission = _dropped(comparison, omissions, goal)
        step()
        while True:
            try:
                trial, numerical = _integrated(comparison, omitted, goal, omission)
                break
            except AccuracyError:
                # More of the accuracy is left for the digits of a thing with more effects.
                if not omission:
                    raise
                omitted, omission = _dropped(comparison, omissions, omission / 2)
        step()
    rows = [
        EffectInfluence(
            effect=key,
            title=title,
            included=key not in omitted,
            changes=_sizes(omissions[key], composite.watch),
            equations=omissions[key].equations,
            seconds=omissions[key].seconds,
            note=omissions[key].note,
        )
        for key, title in composite.effects.items()
    ]
    rows.sort(key=lambda row: -row.influence)
    full = composite.run(frozenset(), goal, engine)
    return EffectBudget(
        title=composite.title,
        watch=composite.watch,
        accuracy=goal,
        full=composite.thing,
        chosen=composite.without(frozenset(omitted), trial.accuracy),
        effects=tuple(key for key in keys if key not in omitted),
        omitted=tuple(key for key in keys if key in omitted),
        rows=tuple(rows),
        omission_error=omission,
        numerical_error=numerical,
        integration_accuracy=trial.accuracy,
        growth=growth,
        result=trial.result,
        end=composite.end,
        equations=trial.equations,
        full_equations=full.equations,
        seconds=trial.seconds,
        full_seconds=full.seconds,
        unresolved=comparison.whole.unresolved,
    )


def _look_beside(comparison: _Comparison, omissions: dict[str, _Omission]) -> None:
    """Take the larger influence of those from this start and from one beside it.

    At an exact equilibrium, as of an upright top, a force without which the motion would
    be stable has no influence at all.
    """
    beside = comparison.composite.nudged(NUDGE)
    try:
        whole = beside.run(frozenset(), comparison.whole.accuracy, comparison.engine)
    except GeomtorsionError:
        return
    near = _Comparison(beside, whole, comparison.engine)
    for key, omission in omissions.items():
        other = near.without([key])
        if other.changes is not None and other.size > omission.size:
            note = omission.note or f"from a start moved by {size_text(NUDGE, 0)}"
            omissions[key] = replace(
                omission, changes=other.changes, error=max(other.error, omission.error), note=note
            )


def _sizes(omission: _Omission, watch: Iterable[str]) -> dict[str, float]:
    """The largest change of each quantity."""
    changes = omission.changes
    if changes is None:
        return dict.fromkeys(watch, math.inf)
    return {name: float(change.max(initial=0.0)) for name, change in changes.items()}


def _finer(composite: Composite, goal: float, engine: Engine | None) -> Trial:
    """A run for comparison: as accurate as possible, up to a hundred times the accuracy."""
    for part in (ORDER**2, ORDER):
        try:
            return composite.run(frozenset(), max(part * goal, min(goal, DOUBLE)), engine)
        except AccuracyError:
            continue
    return composite.run(frozenset(), goal, engine)


def _dropped(
    comparison: _Comparison, omissions: Mapping[str, _Omission], goal: float
) -> tuple[tuple[str, ...], float]:
    """Effects that can be omitted together, and the error by their omission."""
    limit = goal * (1 - ORDER)
    total = comparison.still
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
        joint = comparison.without(omitted)
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
    comparison: _Comparison, omitted: Sequence[str], goal: float, omission: float
) -> tuple[Trial, float]:
    """A run whose error and omission are within the accuracy together, and its error.

    Raises
    ------
    AccuracyError
        the watched quantities cannot be computed to this accuracy.
    """
    composite, engine, keys = comparison.composite, comparison.engine, frozenset(omitted)
    rest = goal - omission
    finest = composite.run(keys, comparison.whole.accuracy, engine)
    accuracy, numerical = rest, math.inf
    while accuracy >= DOUBLE:
        trial = composite.run(keys, accuracy, engine)
        changes = relative_changes(finest.values, trial.values)
        # A quantity can lose digits that the states have, such as a difference of large energies.
        measured = math.inf if changes is None else _largest(changes)
        numerical = max(trial.error, measured + finest.error)
        if numerical <= rest:
            return trial, numerical
        accuracy *= min(rest / numerical, 1.0) / 2
    raise AccuracyError(
        f"accuracy: expected {goal:.3g} of {', '.join(composite.watch)}, got "
        f"{size_text(numerical)}; these lose digits that the states have. Request less, or watch "
        "other quantities."
    )

"""Composition: effects of a scene, and its runs without some of them."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING

import numpy as np

from geomtorsion.errors import GeomtorsionError
from geomtorsion.ode import solve
from geomtorsion.ode.solution import DOUBLE
from geomtorsion.prices import Sensitivity, Trial, beside, growth, passed_over
from geomtorsion.scenes.to_ode import observed

if TYPE_CHECKING:
    from geomtorsion.ode import Engine
    from geomtorsion.scenes.scene import Scene


@dataclass(frozen=True, eq=False)
class SceneEffects:
    """The effects of a scene, for `called_for`.

    thing: the scene. start: numbers of states that replace its own.
    """

    thing: Scene
    start: Mapping[str, float] = field(default_factory=dict)

    @property
    def title(self) -> str:
        """The name of the scene."""
        return self.thing.title or self.thing.name or "scene"

    @property
    def accuracy(self) -> float:
        """The accuracy of the scene."""
        return self.thing.accuracy

    @property
    def effects(self) -> Mapping[str, str]:
        """Key -> description of each effect."""
        return {key: effect.title for key, effect in self.thing.keyed.items()}

    @property
    def watch(self) -> tuple[str, ...]:
        """The watched quantities."""
        return tuple(self.thing.watch)

    @property
    def end(self) -> str:
        """The last time."""
        return f"t = {float(self.thing.times[-1]):.6g} s"

    def without(self, keys: frozenset[str], accuracy: float) -> Scene:
        """The scene without the effects of these keys."""
        some = [effect for key, effect in self.thing.keyed.items() if key not in keys]
        return replace(self.thing, effects=some, accuracy=accuracy)

    def run(self, keys: frozenset[str], accuracy: float, engine: Engine | None) -> Trial:
        """A run without the effects of these keys."""
        scene = self.without(keys, accuracy)
        if self.start:
            return self._beside(scene, engine)
        result = scene.run(engine)
        solved = result.solved
        return Trial(
            result.values,
            result.error,
            result,
            accuracy,
            scene.ode.size,
            result.cost.run_seconds,
            lambda: scene.run(engine).cost.run_seconds,
            # A free body has a closed form, and its motion is regular.
            regular=result.closed_form is not None,
            missed=None if solved is None else passed_over(solved, accuracy),
        )

    def _beside(self, scene: Scene, engine: Engine | None) -> Trial:
        """A run of the equations of a scene from the other start."""
        ode, times = scene.ode, scene.times
        ode = ode.with_start({name: x for name, x in self.start.items() if name in ode.states})
        solved = solve(ode, times, scene.accuracy, engine)
        states = np.asarray(solved.states, dtype=float)
        return Trial(
            observed(ode, scene.selection, solved.times, states),
            max(solved.error, DOUBLE),
            solved,
            scene.accuracy,
            ode.size,
            solved.cost.run_seconds,
            lambda: solve(ode, times, scene.accuracy, engine).cost.run_seconds,
        )

    def nudged(self, part: float) -> SceneEffects:
        """The scene from a start of its equations that is moved by a part of its size."""
        ode = self.thing.ode
        numbers = zip(ode.states, beside(ode, part).start, strict=True)
        return replace(self, start={name: float(x) for name, x in numbers})

    def idle(self, keys: frozenset[str]) -> str:
        """No output depends on effects that the selection omits."""
        acting = keys & {*self.thing.selection.effects}
        return "" if acting else "exactly: no watched quantity depends on it"

    def needed(self, keys: frozenset[str]) -> str:
        """Watched quantities of an effect have other names without earlier ones: rotor2."""
        kinds: set[str] = set()
        for key, effect in self.thing.keyed.items():
            own = {*self.thing.assembly.parts[key].outputs} & {*self.thing.watch}
            if key in keys:
                kinds.add(effect.key)
            elif effect.key in kinds and own:
                return "without it watched effects of its kind get other names"
        return ""

    def growth(self, engine: Engine | None) -> Sensitivity | None:
        """The scene, solved from two starts that differ by the root of the default accuracy."""
        ode, selection, times = self.thing.ode, self.thing.selection, self.thing.times
        try:
            one = solve(ode, times, engine=engine)
            part = math.sqrt(one.accuracy)
            two = solve(beside(ode, part), times, engine=engine)
            first, second = (
                observed(ode, selection, run.times, np.asarray(run.states, float))
                for run in (one, two)
            )
        except GeomtorsionError:
            return None
        return growth(first, second, one.times, part)

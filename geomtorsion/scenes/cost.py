"""Cost: how many equations and how much time each effect adds, one by one."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

from geomtorsion.errors import GeomtorsionError, SceneError
from geomtorsion.ode import solve
from geomtorsion.scenes.assembly import assemble
from geomtorsion.scenes.observables import observable

if TYPE_CHECKING:
    from geomtorsion.ode import Engine
    from geomtorsion.scenes.scene import Scene


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
    """What each effect of a scene costs; prints as a table.

    rows: with the effects added one by one, in the order of the scene.
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
        raise SceneError("nothing that is watched exists without the effects that follow.")
    return replace(scene, effects=tuple(keyed.values()), watch=tuple(names))

"""Magnitudes: what the shipped effects would change in a scene that does not have them."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import asdict, dataclass, fields, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

from geomtorsion.errors import GeomtorsionError
from geomtorsion.ode.numbers import checked_accuracy
from geomtorsion.pictures.influences import influence_picture
from geomtorsion.pictures.style import pictured, save
from geomtorsion.prices import relative_changes
from geomtorsion.scenes.effects import EFFECTS, Drift, Effect, Spin, Surroundings
from geomtorsion.support import checks
from geomtorsion.support.outgoing import size_text

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from geomtorsion.scenes.body import Body
    from geomtorsion.scenes.scene import Scene


@dataclass(frozen=True)
class Magnitude:
    """Influence of an effect that a scene does not have.

    effect: the effect, with its numbers.
    changes: watched quantity -> largest change at the reported times if it is added, relative to
        the largest size of the quantity; infinite if the quantity is zero without it.
    formula, assumption: how its numbers follow from body and surroundings, and when.
    note: the reason why it cannot be added, or empty.
    """

    effect: Effect
    changes: Mapping[str, float]
    formula: str
    assumption: str
    note: str = ""

    @property
    def influence(self) -> float:
        """The largest change of a watched quantity; 0 for an effect that cannot be added."""
        return max(self.changes.values(), default=0.0)

    @property
    def quantity(self) -> str:
        """The watched quantity that changes most; empty if none does."""
        return max(self.changes, key=self.changes.__getitem__) if self.influence else ""

    @property
    def numbers(self) -> str:
        """The numbers of the effect, with their units."""
        units, parts = self.effect.units(), []
        for item in fields(self.effect):
            value = getattr(self.effect, item.name)
            if item.name in units and value != item.default:
                parts.append(f"{item.name} = {float(value):.3g} {units[item.name]}")
        return ", ".join(parts)


@dataclass(frozen=True, eq=False)
class Magnitudes:
    """Influence of the shipped effects that a scene does not have; the scene stays unchanged.

    scene: the unchanged scene.
    surroundings: air and gravity, from which the numbers follow.
    rows: the effects whose numbers follow, the largest influence first.
    devices: keys of the effects that a user has to describe, such as springs and engines.
    error: of the compared runs, relative: smaller influences are not resolved.
    """

    scene: Scene
    surroundings: Surroundings
    rows: tuple[Magnitude, ...]
    devices: tuple[str, ...]
    error: float

    def lacking(self, accuracy: float | None = None) -> tuple[Effect, ...]:
        """Effects whose influence exceeds an accuracy, by default the accuracy of the scene."""
        limit = self.scene.accuracy if accuracy is None else checked_accuracy(accuracy)
        return tuple(row.effect for row in self.rows if row.influence > limit)

    def __str__(self) -> str:
        name = self.scene.title or self.scene.name or "scene"
        watched = ", ".join(self.scene.watch)
        lines = [f"{name}: change of {watched} by effects that it does not have, each added once"]
        names = [row.effect.key for row in self.rows]
        width = max([len("effect"), *map(len, names)])
        where = max([len("of"), *(len(row.quantity) for row in self.rows)])
        if self.rows:
            lines.append(f"{'effect':<{width}}  influence  {'of':<{where}}  numbers")
        for key, row in zip(names, self.rows, strict=True):
            size = "from 0" if math.isinf(row.influence) else size_text(row.influence)
            if 0 < row.influence <= self.error:
                size = f"< {size_text(self.error, 0)}"
            line = f"{key:<{width}}  {size:>9}  {row.quantity:<{where}}  {row.note or row.numbers}"
            lines += [line, f"{'':<{width}}  {row.formula}: {row.assumption}"]
        if self.devices:
            lines.append(f"not estimated, as their numbers do not follow: {self._devices}")
        return "\n".join([*lines, "Nothing is added to the scene."])

    @property
    def _devices(self) -> str:
        return ", ".join(self.devices)

    def __repr__(self) -> str:
        return str(self)

    def _repr_html_(self) -> str:
        return pictured(str(self), self.plot)

    def plot(self, path: str | Path | None = None) -> Figure:
        """The influence of each effect beside the accuracy; written to `path` if given.

        Raises
        ------
        MissingExtraError
            matplotlib is not installed.
        """
        accuracy = self.scene.accuracy
        bars = [
            (row.effect.key, row.influence, row.quantity, row.influence > accuracy)
            for row in self.rows
        ]
        notes = [f"Not estimated: {self._devices}.", "Nothing is added to the scene."]
        name = self.scene.title or self.scene.name
        label = "largest change if the effect is added, relative"
        figure = influence_picture(bars, accuracy, name, notes, label=label, outside="")
        if path is not None:
            save(figure, Path(path))
        return figure

    def to_json(self) -> dict[str, Any]:
        """The table as a JSON-ready mapping; an infinite influence is None."""
        return {
            "title": self.scene.title or self.scene.name,
            "watch": list(self.scene.watch),
            "surroundings": asdict(self.surroundings),
            "error": self.error,
            "devices": list(self.devices),
            "rows": [
                {
                    "effect": row.effect.key,
                    "numbers": row.numbers,
                    "influence": row.influence if math.isfinite(row.influence) else None,
                    "quantity": row.quantity,
                    "formula": row.formula,
                    "assumption": row.assumption,
                    "note": row.note,
                }
                for row in self.rows
            ],
        }


def at_surface(body: Body) -> list[Effect]:
    """Effects on any body at rest or in motion near the surface of the Earth."""
    usual = [kind.typical(body, Surroundings()) for kind in EFFECTS]
    return [one.effect for one in usual if one is not None and one.at_surface]


def magnitudes(scene: Scene, surroundings: Surroundings | None = None) -> Magnitudes:
    """Influence of shipped effects that a scene lacks; see `Scene.magnitudes`."""
    around = Surroundings() if surroundings is None else surroundings
    checks.instance(around, Surroundings, "surroundings")
    whole = scene.run()
    rows, devices, error = [], [], whole.error
    for kind in EFFECTS:
        if kind.key in scene.keyed or kind in (Spin, Drift):
            continue
        typical = kind.typical(scene.body, around)
        if typical is None:
            if not kind.wrong:
                devices.append(kind.key)
            continue
        changes: dict[str, float] = {}
        note = ""
        try:
            more = replace(scene, effects=[*scene.effects, typical.effect])
            # No output depends on an effect that the selection omits.
            if kind.key in more.selection.effects:
                run = more.run()
                error = max(error, whole.error + run.error)
                series = relative_changes(whole.values, run.values)
                note = "" if series else "with it the motion ends at another time"
                changes = {key: float(x.max(initial=0.0)) for key, x in (series or {}).items()}
        except GeomtorsionError as problem:
            note = f"cannot be added: {str(problem).partition('. ')[0]}"
        rows.append(Magnitude(typical.effect, changes, typical.formula, typical.assumption, note))
    rows.sort(key=lambda row: -row.influence)
    return Magnitudes(scene, around, tuple(rows), tuple(devices), error)

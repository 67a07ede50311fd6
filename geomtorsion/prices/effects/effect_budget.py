"""Effect budget: the effects that an accuracy calls for, with the influence of each."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any, ClassVar

from geomtorsion.errors import UnknownNameError
from geomtorsion.prices.effects.sensitivity import Sensitivity
from geomtorsion.support.checks import known_name
from geomtorsion.support.displays import Plot, drawn_by, figure_by
from geomtorsion.support.outgoing import json_number, size_text


@dataclass(frozen=True, kw_only=True)
class EffectInfluence:
    """Influence of one effect on the watched quantities of a scene, a motion or a theory.

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


@dataclass(frozen=True, eq=False, kw_only=True)
class EffectBudget:
    """The effects that an accuracy calls for: omission and integration together stay within it.

    title: of the scene, motion or theory. watch: names of the watched quantities.
    accuracy: the requested accuracy of the watched quantities, relative to their largest size.
    full: the scene, problem or theory with all its effects.
    chosen: the same with only the effects that are called for.
    effects, omitted: keys of the effects that are called for, and of the others.
    rows: influence of each effect, the largest first.
    omission_error: change of the watched quantities by all omitted effects together, relative: the
        larger of the measured change and of the sum of the single changes, which gives effects that
        cancel each other no credit, with the error of the compared runs.
    numerical_error: error of the integration of `chosen`, relative: the larger of its estimate and
        of the change of the watched quantities against a finer run.
    integration_accuracy: the accuracy that is left for the integration of `chosen`.
    growth: how fast a small change of the start grows; None where it is not measured.
    result: the run of `chosen`.
    end: the last time, in words.
    equations, full_equations: number of equations that are solved for the watched quantities.
    seconds, full_seconds: time of integration of `chosen`, and of `full` at the same accuracy.
    unresolved: watched quantities that are no larger than the rounding errors of the quantities
        measured with them, and count as zero.

    Examples
    --------
    >>> from geomtorsion.scenes import load
    >>> budget = load("thrown_body").called_for(1e-3)
    >>> budget.error <= budget.accuracy
    True
    """

    title: str
    watch: tuple[str, ...]
    accuracy: float
    full: Any  # a scene, a problem or a theory; users know which one they gave
    chosen: Any
    effects: tuple[str, ...]
    omitted: tuple[str, ...]
    rows: tuple[EffectInfluence, ...]
    omission_error: float
    numerical_error: float
    integration_accuracy: float
    growth: Sensitivity | None
    result: Any
    end: str
    equations: int
    full_equations: int
    seconds: float
    full_seconds: float
    unresolved: tuple[str, ...] = ()

    @property
    def error(self) -> float:
        """Error of the watched quantities of `result` against a run with all effects."""
        return self.omission_error + self.numerical_error

    def __getitem__(self, effect: str) -> EffectInfluence:
        """The row of an effect."""
        rows = {row.effect: row for row in self.rows}
        kind = f"an effect of {self.title}"
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
        return " ".join([self._range, *self._limits])

    @property
    def _limits(self) -> list[str]:
        """Sentences about what the runs cannot see."""
        if not self.unresolved:
            return []
        names = ", ".join(self.unresolved)
        text = (
            f"Not resolved: {names}, no larger than the rounding errors of the quantities measured "
            "with it. Use an engine with more digits, such as gt.Taylor(precision=113)."
        )
        return [text]

    @property
    def _range(self) -> str:
        """The times for which the choice holds."""
        end = self.end
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
        watched = ", ".join(self.watch)
        heading = (
            f"{self.title}: accuracy {self.accuracy:.3g} of {watched} calls for {count} of {every}"
        )
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
        size, full_size = self.equations, self.full_equations
        instead = f" instead of {full_size}" if size != full_size else ""
        before = f" instead of {1e3 * self.full_seconds:.3g} ms" if self.omitted else ""
        lines.append(
            f"{size} equation{'s' * (size != 1)}{instead}, integrated in "
            f"{1e3 * self.seconds:.3g} ms{before}"
        )
        return "\n".join([*lines, self.validity])

    def __repr__(self) -> str:
        return str(self)

    _repr_html_ = drawn_by("influences", "effects_html")
    plot: ClassVar[Plot] = figure_by("influences", "draw_effects")

    def to_json(self) -> dict[str, Any]:
        """The budget as a JSON-ready mapping; an infinite influence is None."""
        growth = self.growth
        return {
            "title": self.title,
            "watch": list(self.watch),
            "end": self.end,
            "accuracy": self.accuracy,
            "effects": list(self.effects),
            "omitted": list(self.omitted),
            "error": self.error,
            "omission_error": self.omission_error,
            "numerical_error": self.numerical_error,
            "integration_accuracy": self.integration_accuracy,
            "unresolved": list(self.unresolved),
            "equations": self.equations,
            "all_equations": self.full_equations,
            "seconds": self.seconds,
            "all_seconds": self.full_seconds,
            "growth": None if growth is None else growth.factor,
            "growth_power": None if growth is None else growth.power,
            "chaotic": None if growth is None else growth.chaotic,
            "rows": [
                {
                    "effect": row.effect,
                    "included": row.included,
                    "influence": json_number(row.influence),
                    "quantity": row.quantity,
                    "changes": {name: json_number(size) for name, size in row.changes.items()},
                    "equations": row.equations,
                    "seconds": row.seconds,
                    "note": row.note,
                }
                for row in self.rows
            ],
        }

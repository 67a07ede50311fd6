"""SceneResult: the outputs at the requested times, with their error and cost."""

from __future__ import annotations

import json
import math
from collections.abc import Iterator, KeysView, Mapping
from dataclasses import dataclass, fields
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from geomtorsion.errors import FileFormatError, SceneError, UnknownNameError
from geomtorsion.ode import Cost, solve
from geomtorsion.ode.numbers import times_between
from geomtorsion.ode.writing import pandas_table
from geomtorsion.pictures.style import pictured
from geomtorsion.scenes.plotting import plot
from geomtorsion.scenes.to_ode import observed
from geomtorsion.support.caching import cached_property
from geomtorsion.support.checks import known_name, shown
from geomtorsion.support.copies import only_fields
from geomtorsion.support.files import written
from geomtorsion.support.hints import attribute_hints
from geomtorsion.support.npz import TEXT_FORM, ArrayForm, json_in, read_npz, write_npz
from geomtorsion.support.outgoing import size_text

if TYPE_CHECKING:
    import pandas
    from matplotlib.figure import Figure
    from numpy.typing import ArrayLike

    from geomtorsion.ode import Solution
    from geomtorsion.scenes.scene import Scene
    from geomtorsion.scenes.selection import StateSelection
    from geomtorsion.scenes.solve import ClosedForm


# Marks NPZ files of this kind.
FORMAT = "geomtorsion scene result 1"
ARRAYS = {
    "times": ArrayForm(("m",), "f"),
    "value *": ArrayForm(("m", ...)),
    "about": TEXT_FORM,
}
# What the metadata has to be.
ABOUT = {
    "format": frozenset({FORMAT}),
    "labels": {str: [str]},
    "units": {str: str},
    "accuracy": float,
    "error": (float, None),
    "drift": {str: float},
    "cost": {item.name: float for item in fields(Cost)},
    "engine": str,
    "reason": str,
    "outcome": str,
    "closed_form": (str, None),
    "selection": str,
    "watch": [str],
}
ADVICE = "Write one with SceneResult.save."


@attribute_hints()
@dataclass(frozen=True, eq=False)
class SceneResult:
    """Solved scene: its outputs over time, with an error estimate.

    scene: the solved scene; None if the result was loaded from a file.
    times: shape (m,), s.
    values: output -> array, shape (m,) or (m, components), or (m, 3, 3).
    labels, units: of each watched quantity.
    accuracy: the requested accuracy.
    error: estimate of the largest error of the states at `times`, relative to their size; no
        smaller than what the doubles in `values` hold, 1.1e-16. More digits are in `solution`.
    drift: invariant -> largest relative change.
    cost: steps, evaluations, seconds.
    engine, reason: the engine, and why it was chosen.
    outcome: "done", "stopped" (by a condition of the scene), "stuck" or "interrupted".
    selection: included and omitted states; a text in a loaded result.
    closed_form: name of the closed form that was used, or None.
    solved: the solution of the equations; None where the closed form was used.
    form: the closed form, or None.

    Examples
    --------
    >>> from geomtorsion.scenes import Body, Scene, State
    >>> scene = Scene(Body(moments=(1, 2, 3)), start=State(omega=(0.01, 1, 0)), t=9)
    >>> result = scene.run()
    >>> result["omega"].shape, result.closed_form
    ((201, 3), 'free top (Jacobi elliptic functions)')
    """

    scene: Scene | None
    times: np.ndarray
    values: Mapping[str, np.ndarray]
    labels: Mapping[str, tuple[str, ...]]
    units: Mapping[str, str]
    accuracy: float
    error: float
    drift: Mapping[str, float]
    cost: Cost
    engine: str
    reason: str
    outcome: str
    selection: StateSelection | str
    closed_form: str | None = None
    solved: Solution | None = None
    form: ClosedForm | None = None

    def __getstate__(self) -> dict[str, object]:
        return only_fields(self)

    @property
    def complete(self) -> bool:
        """Whether the motion reached the last time or the stop condition."""
        return self.outcome in ("done", "stopped")

    def __getitem__(self, name: str) -> np.ndarray:
        """A watched quantity at the times, shape (m,) or (m, components)."""
        kind, remedy = "a watched quantity", "For another one, add it to watch and run again."
        return self.values[
            known_name(name, self.values, "", UnknownNameError, expected=kind, remedy=remedy)
        ]

    def __iter__(self) -> Iterator[str]:
        return iter(self.values)

    def __contains__(self, name: object) -> bool:
        return name in self.values

    def keys(self) -> KeysView[str]:
        """Names of the watched quantities."""
        return self.values.keys()

    def at(self, time: ArrayLike) -> Mapping[str, np.ndarray]:
        """Outputs by name at any times up to the last.

        Between the times of the result they are interpolated by the engine, or exact where there
        is a closed form. Angles that continue beyond pi restart in each call.

        Raises
        ------
        SceneError
            the result was loaded from a file.
        TimeError
            a time is outside of the solution.
        """
        if self.scene is None:
            raise SceneError(
                "expected a result with its scene, got one from a file, which has no values "
                "between its times. Run the scene."
            )
        asked = times_between(time)
        flat = np.atleast_1d(asked)
        if self.form is not None:
            states = self.form.states(flat)
        else:
            states = np.asarray(self.solution.at(flat).states, dtype=float)
        quantities = observed(self.scene.ode, self.scene.selection, flat, states)
        return {k: v.reshape((*asked.shape, *v.shape[1:])) for k, v in quantities.items()}

    def changes(self) -> dict[str, np.ndarray]:
        """Relative change of each invariant since the start, or since the last switch.

        The largest value of each is the one in `drift`; a result from a file has none.

        Examples
        --------
        >>> from geomtorsion.scenes import load
        >>> result = load("lagrange_cusp").run()
        >>> changes = result.changes()
        >>> all(float(changes[name].max()) == result.drift[name] for name in result.drift)
        True
        """
        if self.scene is None:
            return {}
        if self.form is not None:
            states = self.form.states(self.times)
        elif self.solved is not None:
            states = np.asarray(self.solved.states, dtype=float)
        else:
            return {}
        return self.scene.ode.changes(self.times, states)

    @cached_property
    def solution(self) -> Solution:
        """The solution of the equations: single states, dense output, zeros.

        If the closed form was used, the equations are integrated at the first access.

        Raises
        ------
        SceneError
            the result was loaded from a file.
        """
        if self.solved is not None:
            return self.solved
        if self.scene is None:
            raise SceneError(
                "expected a result with its solution, got one from a file. Run the scene."
            )
        return solve(self.scene.ode, self.times, self.accuracy)

    # -- showing ---------------------------------------------------------------------------------

    @property
    def title(self) -> str:
        """The title of the scene, or its name."""
        return (self.scene.title or self.scene.name) if self.scene is not None else ""

    def _repr_html_(self) -> str:
        return pictured(str(self), self.plot)

    def __str__(self) -> str:
        how = self.closed_form or f"{self.engine} ({self.reason})"
        ended = "" if self.outcome == "done" else f", {self.outcome}"
        lines = [
            f"{self.title or 'scene'}: {', '.join(self.values)}",
            f"to t = {float(self.times[-1]):.6g} s{ended}, {len(self.times)} times, by {how}",
            f"error below {self.error:.2g} (requested: {self.accuracy:.2g}); {self.cost}",
        ]
        drifts = ", ".join(f"{name} {size_text(value)}" for name, value in self.drift.items())
        return "\n".join([*lines, f"drift: {drifts}"] if drifts else lines)

    def __repr__(self) -> str:
        return str(self)

    def columns(self) -> dict[str, np.ndarray]:
        """Column name -> array of shape (m,): the time, then each component."""
        table: dict[str, np.ndarray] = {"t": self.times}
        for name, value in self.values.items():
            labels = self.labels[name]
            flat = value.reshape(len(self.times), -1)
            if not labels:
                table[name] = flat[:, 0]
            else:
                table |= {f"{name}_{label}": flat[:, k] for k, label in enumerate(labels)}
        return table

    def plot(self, path: str | Path | None = None, *, figure: str = "watched") -> Figure:
        """A figure of the outputs over time; written to `path` (png, svg, pdf) if given.

        figure: another figure that these outputs have: "attitude" shows the axes of the body in
        space and needs the output "matrix"; "axis", "cones", "rolling", "path", "laws", "trust",
        "plan".

        Raises
        ------
        UnknownNameError
            The outputs have no figure of this name; the message lists those they have.
        MissingExtraError
            matplotlib is not installed.
        """
        return plot(self, path, figure)

    # -- taking it elsewhere ---------------------------------------------------------------------

    def _ipython_key_completions_(self) -> list[str]:
        return list(self.values)

    def to_pandas(self) -> pandas.DataFrame:
        """A pandas table: times, then each component of the outputs.

        Raises
        ------
        MissingExtraError
            pandas is not installed.
        """
        return pandas_table(self.columns())

    def save(self, path: str | Path) -> None:
        """Write an NPZ file with arrays and metadata; `SceneResult.load` reads it."""
        metadata = {
            "format": FORMAT,
            "labels": {k: list(v) for k, v in self.labels.items()},
            "units": dict(self.units),
            "accuracy": self.accuracy,
            # JSON knows no infinity, which is the error of a run that was stopped.
            "error": self.error if math.isfinite(self.error) else None,
            "drift": dict(self.drift),
            "cost": vars(self.cost),
            "engine": self.engine,
            "reason": self.reason,
            "outcome": self.outcome,
            "closed_form": self.closed_form,
            "selection": str(self.selection),
            "watch": list(self.values),
        }
        arrays: dict[str, Any] = {f"value {name}": value for name, value in self.values.items()}
        with written(path) as target:
            write_npz(target, {"times": self.times, "about": json.dumps(metadata), **arrays})

    @classmethod
    def load(cls, path: str | Path) -> SceneResult:
        """A result from an NPZ file that `save` wrote; its scene and solution are not in it.

        Raises
        ------
        FileFormatError
            the file cannot be read, or is not a result of a scene.
        """
        message = "{path}: this is not a saved result of a scene ({reason}). " + ADVICE
        arrays = read_npz(path, ARRAYS, message=message)
        metadata = json_in(arrays, "about", ABOUT, path=path, message=message)
        times = arrays["times"]
        named = {name: f"value {name}" for name in metadata["watch"]}
        values = {name: arrays[key] for name, key in named.items() if key in arrays}
        reason = _misfit(metadata, times, values)
        if reason:
            raise FileFormatError(message.format(path=path, reason=reason))
        error = metadata["error"]
        return cls(
            None,
            times,
            values,
            {name: tuple(labels) for name, labels in metadata["labels"].items()},
            metadata["units"],
            metadata["accuracy"],
            math.inf if error is None else error,
            metadata["drift"],
            Cost(**{item.name: metadata["cost"][item.name] for item in fields(Cost)}),
            metadata["engine"],
            metadata["reason"],
            metadata["outcome"],
            metadata["selection"],
            metadata["closed_form"],
        )


def _misfit(about: Mapping[str, Any], times: np.ndarray, values: Mapping[str, np.ndarray]) -> str:
    """Which parts of a file do not fit together, or nothing."""
    if not len(times) or not np.isfinite(times).all():
        return "times: expected at least one finite number"
    for name in about["watch"]:
        if name not in values:
            return f"value {shown(name)} is missing"
        if name not in about["labels"] or name not in about["units"]:
            return f"about: labels and units of {shown(name)} are missing"
        numbers = math.prod(values[name].shape[1:])
        if max(len(about["labels"][name]), 1) != numbers:
            return f"about: labels.{name}: expected {numbers} for value {name}"
    return ""


def result_of(scene: Scene, **known: Any) -> SceneResult:
    """A result with the metadata of the scene: labels, units, accuracy, selection."""
    selection = scene.selection
    return SceneResult(
        scene=scene,
        labels={item.name: item.labels for item in selection.watch},
        units={item.name: item.unit for item in selection.watch},
        accuracy=scene.accuracy,
        selection=selection,
        **known,
    )

"""Sweep: one scene with many values of its parameters and its start, solved together."""

from __future__ import annotations

import time
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass
from itertools import product
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from geomtorsion.errors import SceneError, StuckError
from geomtorsion.motion.tables import pandas_table
from geomtorsion.pictures.ink import number, save
from geomtorsion.pictures.scene_sweep import WIDE, sweep_picture
from geomtorsion.scenes.measure import Measure, measures, only_words, quantities
from geomtorsion.scenes.sweeping import Found, groups, solve_group
from geomtorsion.scenes.table import write_csv

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from geomtorsion.motion import Engine
    from geomtorsion.scenes.scene import Scene


@dataclass(frozen=True, eq=False)
class SceneSweep:
    """What was measured, for every combination of what was varied.

    title: of the scene.
    varied: path -> values, in the order of the axes; shape (n,), or (n, 3) for whole vectors.
    measured: name -> array with an axis for each path (one axis in all, if they go together).
    accuracy: asked for; error: largest estimate; engine: what solved it; seconds: in all.
    lost: (what was varied, why) of each motion that does not reach its end; nan is measured there.
    """

    title: str
    varied: Mapping[str, np.ndarray]
    measured: Mapping[str, np.ndarray]
    accuracy: float
    error: float
    engine: str
    seconds: float
    lost: tuple[tuple[Mapping[str, Any], str], ...] = ()

    def __getitem__(self, name: str) -> np.ndarray:
        """What was varied or measured under this name."""
        return self.measured[name] if name in self.measured else self.varied[name]

    def columns(self) -> dict[str, Any]:
        """A column for each path and measure, a row for each combination."""
        shape = next(iter(self.measured.values())).shape
        table: dict[str, Any] = {}
        for axis, (path, values) in enumerate(self.varied.items()):
            for place in np.ndindex(values.shape[1:]):
                along = values[(slice(None), *place)]
                if len(shape) > 1:
                    along = along.reshape([-1 if k == axis else 1 for k in range(len(shape))])
                name = path + "".join(f"[{k}]" for k in place)
                table[name] = np.broadcast_to(along, shape).ravel()
        return table | {name: values.ravel() for name, values in self.measured.items()}

    def to_pandas(self) -> Any:
        """The table as a pandas frame.

        Raises
        ------
        MissingExtraError
            pandas is not installed.
        """
        return pandas_table(self.columns())

    def to_csv(self, path: str | Path) -> None:
        """Write the table, every digit kept."""
        write_csv(Path(path), self.columns())

    def plot(
        self,
        path: str | Path | None = None,
        *,
        measure: str | None = None,
        known: Callable[[Any], Any] | None = None,
        known_name: str = "known",
    ) -> Figure:
        """A measure against what was varied; `known`, a function of the latter, as a curve on top.

        Raises
        ------
        SceneError
            more than two things were varied.
        MissingExtraError
            matplotlib is not installed.
        """
        name = measure or next(iter(self.measured))
        values = self.measured[name]
        # Whole vectors have no axis of their own: they are counted.
        pairs = [
            (path, row) if row.ndim == 1 else (f"{path}, number", np.arange(float(len(row))))
            for path, row in list(self.varied.items())[: values.ndim]
        ]
        if values.ndim > 2:
            raise SceneError(
                f"{values.ndim} things were varied; a picture shows two. Take columns()."
            )
        curve = None
        if known is not None and values.ndim == 1:
            low, high = float(pairs[0][1].min()), float(pairs[0][1].max())
            spaced = np.geomspace if low > 0 and high > WIDE * low else np.linspace
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
        if self.lost:
            where, why = self.lost[0]
            lines.append(f"{len(self.lost)} without a value; the first with {where}: {why}")
        return "\n".join([*lines, f"error below {self.error:.1e} (asked {self.accuracy:.1e})"])

    __repr__ = __str__


def sweep(
    scene: Scene,
    varied: Mapping[str, Iterable[Any]],
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
        what is solved; what it watches can be measured.
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
        a path leads nowhere.
    SceneError
        nothing is varied, lengths differ, or words that are no measure.
    StuckError
        no motion reaches its end; where only some do not, they are in `lost`.

    Examples
    --------
    >>> from geomtorsion.scenes import load
    >>> flips = sweep(load("dzhanibekov"), {"start.omega[0]": [1e-3, 1e-2]},
    ...               "between zeros omega[1]")
    >>> flips["between zeros omega[1]"].round(3).tolist()
    [28.731, 20.755]
    """

    began = time.perf_counter()
    if not varied or not isinstance(varied, Mapping):
        raise SceneError('nothing is varied. Give paths with values, as {"gravity.g": [1, 2]}.')
    readers = measures(measure)
    watch = quantities(measure)
    if not only_words(measure):
        watch = (*scene.watch, *watch)
    scene = scene.replaced(watch=watch)
    values = {path: _column(path, column) for path, column in varied.items()}
    shape = tuple(len(column) for column in values.values())
    if together and len(set(shape)) != 1:
        raise SceneError(f"what goes together has as many values each, not {shape}.")
    combinations = list(
        zip(*values.values(), strict=True) if together else product(*values.values())
    )
    if not combinations:
        raise SceneError("nothing is varied: there are no values.")
    lanes = [dict(zip(values, map(_plain, chosen), strict=True)) for chosen in combinations]
    found = Found(readers, len(lanes), progress)
    for members in groups(scene, lanes).values():
        solve_group(scene, members, engine, found)
    lost = [(lanes[place], why) for place, why in sorted(found.lost.items())]
    if len(lost) == len(lanes):
        raise StuckError(f"no motion reaches its end; with {lost[0][0]}: {lost[0][1]}.")
    grid = (len(lanes),) if together else shape
    return SceneSweep(
        scene.title or scene.name,
        values,
        {name: column.reshape(grid) for name, column in found.columns.items()},
        scene.accuracy,
        found.error,
        ", ".join(sorted(found.engines)),
        time.perf_counter() - began,
        tuple(lost),
    )


def _column(path: str, column: Any) -> np.ndarray:
    """Values of a path: numbers, or vectors of equal length."""
    try:
        return np.asarray(list(column), dtype=float)
    except (TypeError, ValueError):
        raise SceneError(
            f"{path}: a list of numbers, or of vectors of equal length, was needed; "
            f"{column!r} came."
        ) from None


def _plain(value: Any) -> Any:
    """A number, or a tuple of them."""
    rows = value.tolist()
    return tuple(_plain(row) for row in value) if isinstance(rows, list) else rows

"""Fates: how motions end, over two numbers of their start."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from enum import IntEnum
from typing import Any, ClassVar

import numpy as np

from geomtorsion.errors import AccuracyError, ShapeError, StartError
from geomtorsion.ode.engines import Engine
from geomtorsion.ode.ensemble import solve_many
from geomtorsion.support import checks
from geomtorsion.support.displays import Plot, drawn_by, figure_by
from geomtorsion.support.executors import Executor


class Fate(IntEnum):
    """Ends without a condition: on the way at the last time, or as the error decides."""

    undecided = -2
    on_the_way = -1


@dataclass(frozen=True, eq=False)
class EndMap:
    """How motions end, over two numbers of their start; made by `end_map`.

    names: of the two numbers. first, second: their values, shapes (n,) and (m,).
    conditions: that may stop a motion, as text.
    fate: shape (m, n): number of the condition that stopped each motion; -1 if it still moves at
        the last time, -2 if its end depends on its error (undecided).
    times: of the end of each motion, shape (m, n); NaN where undecided.
    errors: largest relative error of each motion, shape (m, n); NaN where undecided.
    """

    names: tuple[str, str]
    first: np.ndarray
    second: np.ndarray
    conditions: tuple[str, ...]
    fate: np.ndarray
    times: np.ndarray
    errors: np.ndarray

    @property
    def undecided(self) -> np.ndarray:
        """Motions whose end is not certain, shape (m, n)."""
        return self.fate == Fate.undecided

    @property
    def counts(self) -> dict[str, int]:
        """Number of motions for each end, in words."""
        ends = dict(enumerate(self.conditions))
        ends |= {Fate.on_the_way: "on the way", Fate.undecided: "undecided"}
        return {text: int((self.fate == k).sum()) for k, text in ends.items()}

    def __array__(self, dtype: Any = None, copy: bool | None = None) -> np.ndarray:
        """The fate of each motion."""
        return self.fate.astype(dtype)

    def __repr__(self) -> str:
        ends = ", ".join(f"{text}: {count}" for text, count in self.counts.items() if count)
        return f"ends of {self.fate.size} motions over {' and '.join(self.names)}: {ends}"

    _repr_html_ = drawn_by("end_maps", "ends_html")
    plot: ClassVar[Plot] = figure_by("end_maps", "draw_ends")


def end_map(
    problem: Any,
    values: Mapping[str, object],
    t: object,
    accuracy: float = 1e-6,
    engine: Engine | None = None,
    *,
    progress: bool | None = None,
    executor: Executor | None = None,
) -> EndMap:
    """How motions end, over two numbers of their start.

    Parameters
    ----------
    problem
        a curve with `stop=`, or first-order equations with `When`.
    values
        two names of `problem.variables` (states, parameters, coordinates, velocities), each with
        its values: shapes (n,) and (m,). Parameters of a curve cannot vary.
    t
        last time.
    accuracy, engine, progress, executor
        as in `solve_many`. A motion that does not reach the accuracy is marked; no error is
        raised.

    Raises
    ------
    StartError
        the problem has no condition that ends a motion, or a start is beyond it.
    ShapeError
        there are not two names, or values are not a list.
    UnknownNameError
        the start of the problem has no such name.

    Examples
    --------
    >>> from geomtorsion.ode import ODE, When
    >>> swing = ODE.of({"x": "v", "v": "-sin(x)"}, [0, 0], events=[When("pi - x")])
    >>> over = end_map(swing, {"x": [0.0, 1.0], "v": [1.0, 1.9, 2.1]}, 20.0)
    >>> over.fate.tolist()
    [[-1, -1], [-1, 0], [0, 0]]
    """
    table = checks.by_name(values, "values", StartError)
    if len(table) != 2:
        raise ShapeError(
            f"values: expected two names with their values, got {len(table)}. Give "
            '{"x": [...], "v": [...]}.'
        )
    if not getattr(problem, "stop_texts", ()):
        raise StartError(
            "expected a motion with a condition that ends it, got one without. Make the curve "
            "with stop=..., or the equations with events=[When(...)]."
        )
    (one, first), (two, second) = (
        (
            name,
            checks.array(x, f"values of {name}", StartError, shape=(None,), shape_error=ShapeError),
        )
        for name, x in table.items()
    )
    grid = np.meshgrid(first, second)
    columns = {name: x.ravel() for name, x in zip((one, two), grid, strict=True)}
    last = [checks.real(t)]
    if last[0] is None:
        raise StartError(f"t: expected the last time, got {checks.shown(t)}. Give one number.")
    try:
        many = solve_many(
            problem, t=last[0], accuracy=accuracy, engine=engine, progress=progress,
            executor=executor, **problem.bundle(columns),
        )  # fmt: skip
    except AccuracyError as error:
        if getattr(error, "ensemble", None) is None:
            raise
        many = error.ensemble
    # A condition with a kink counts as one, though each side of it stops the motion.
    texts = list(dict.fromkeys(problem.stop_texts))
    stops = np.array([*map(texts.index, problem.stop_texts), Fate.on_the_way])[many.rows.ends.stops]
    fate = np.where(many.finished, stops, Fate.undecided)
    times = np.where(many.finished, many.end.time, np.nan)
    shape = len(second), len(first)
    parts = (x.reshape(shape) for x in (fate, times, many.errors))
    return EndMap((one, two), first, second, tuple(texts), *parts)

"""Sensitivity: how fast a small change of the start grows in the watched quantities of a scene."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from geomtorsion.errors import GeomtorsionError
from geomtorsion.ode import solve
from geomtorsion.scenes.context import group_of
from geomtorsion.scenes.to_ode import observed

if TYPE_CHECKING:
    from geomtorsion.ode import ODE, Engine
    from geomtorsion.scenes.selection import StateSelection

Series = Mapping[str, np.ndarray]
# A change of the start grows linearly in a regular motion and exponentially in a chaotic one; an
# exponent of time between 1 and the least that an exponential shows, 2, separates them.
REGULAR = 1.5
# Transients grow faster than linearly also in regular motions, but not by so much.
TRANSIENT = 100.0


@dataclass(frozen=True)
class Sensitivity:
    """Growth of a small change of the start in the watched quantities.

    factor: largest change of a watched quantity, relative to its size, for each unit of change of
        the start, relative to the size of its groups.
    power: exponent p of the law t^p that fits the growth best; about 1 in a regular motion.

    Examples
    --------
    >>> Sensitivity(30.0, 1.0).chaotic, Sensitivity(4e3, 3.0).chaotic
    (False, True)
    """

    factor: float
    power: float

    @property
    def chaotic(self) -> bool:
        """Whether the change grows faster and further than in a regular motion."""
        return self.factor > TRANSIENT and self.power > REGULAR

    def __str__(self) -> str:
        grown = f"a change of the start grows by a factor {self.factor:.2g}, about as t^"
        return f"{grown}{max(self.power, 0.0):.1f}"


def relative_changes(one: Series, two: Series) -> dict[str, np.ndarray] | None:
    """Change of each quantity at each time, relative to its largest size in the first.

    Returns
    -------
    Name -> array, shape (m,), the largest over the components; infinite where the quantity is 0 in
    the first and not in the second. None if the quantities have other shapes: other times.

    Examples
    --------
    >>> relative_changes({"z": np.array([1.0, 4.0])}, {"z": np.array([1.0, 3.0])})
    {'z': array([0.  , 0.25])}
    """
    changes = {}
    for name, before in one.items():
        after = two[name]
        if after.shape != before.shape:
            return None
        change = np.abs(after - before).reshape(len(before), -1).max(axis=1)
        size = float(np.abs(before).max(initial=0.0))
        infinite = np.where(change == 0, 0.0, math.inf)
        changes[name] = change / size if size else infinite
    return changes


def sensitivity(
    ode: ODE, selection: StateSelection, times: np.ndarray, engine: Engine | None = None
) -> Sensitivity | None:
    """Growth of a small change of the start of a scene; None where it cannot be measured.

    The equations are solved twice with the default accuracy, from starts that differ by 1e-5 of
    their size, its root: the difference of the runs has as many digits as it is small.

    ode, selection, times: of the scene.

    Examples
    --------
    >>> from geomtorsion.scenes import load
    >>> disc = load("rolling_disc")
    >>> growth = sensitivity(disc.ode, disc.selection, disc.times)
    >>> growth.chaotic, round(growth.power)
    (False, 1)
    """
    try:
        first_run = solve(ode, times, engine=engine)
        part = math.sqrt(first_run.accuracy)
        runs = first_run, solve(_moved(ode, part), times, engine=engine)
        count = min(len(run.times) for run in runs)
        first, second = (
            observed(ode, selection, run.times[:count], np.asarray(run.states, float)[:count])
            for run in runs
        )
    except GeomtorsionError:
        return None
    reached = np.abs(runs[0].times[:count])
    if not reached.any():
        return None
    changes = [_sizes(second[name] - first[name]) for name in first]
    sizes = [np.maximum.accumulate(_sizes(first[name])) for name in first]
    # Relative to the size so far, since an accelerated motion grows itself.
    ratios = [_ratio(change, size) for change, size in zip(changes, sizes, strict=True)]
    grown = np.maximum.accumulate(np.max(ratios, axis=0))
    factors = [_ratio(change.max(), size[-1]) for change, size in zip(changes, sizes, strict=True)]
    # The first samples show how the change begins, and not how it grows.
    late = (reached > reached[-1] / count) & (grown > 0)
    if np.count_nonzero(late) < 2:
        return None
    power = float(np.polyfit(np.log(reached[late]), np.log(grown[late]), 1)[0])
    return Sensitivity(float(max(factors)) / part, power)


def _sizes(values: np.ndarray) -> np.ndarray:
    """The largest component at each time, shape (m,)."""
    return np.abs(values).reshape(len(values), -1).max(axis=1)


def _ratio(change: np.ndarray, size: np.ndarray) -> np.ndarray:
    """A relative change; 0 where a quantity is zero, which has none."""
    return np.divide(change, size, out=np.zeros(np.shape(change)), where=size > 0)


def _moved(ode: ODE, part: float) -> ODE:
    """The equations from a start that is moved by a part of the size of each group of states."""
    numbers = dict(zip(ode.states, map(float, ode.start), strict=True))
    sizes: dict[str, float] = {}
    for name, value in numbers.items():
        sizes[group_of(name)] = max(sizes.get(group_of(name), 0.0), abs(value))
    # Alternate signs, so that the change is not a mere stretching.
    for k, name in enumerate(ode.states):
        numbers[name] += (-1) ** k * part * sizes[group_of(name)]
    for group in ode.normalized:
        length = math.sqrt(sum(numbers[name] ** 2 for name in group))
        numbers |= {name: numbers[name] / length for name in group}
    return ode.with_start(numbers)

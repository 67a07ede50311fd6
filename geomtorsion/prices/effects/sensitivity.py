"""Sensitivity: how fast a small change of the start grows in the watched quantities."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from geomtorsion.curves import CurveProblem
from geomtorsion.ode import ODE
from geomtorsion.ode.numbers import Real
from geomtorsion.ode.solve import ACCURACY

# Part by which the start is moved: the root of the usual accuracy, far above its errors.
NUDGE = math.sqrt(ACCURACY)
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


def growth(first: Series, second: Series, times: np.ndarray, part: float) -> Sensitivity | None:
    """Growth of a small change of the start, from two runs; None where it cannot be measured.

    first, second: quantities of runs whose starts differ by a part of their size. times: shape (m,)
    of the first; a run that ends earlier counts so far.

    Examples
    --------
    >>> times = np.linspace(0.0, 10.0, 65)
    >>> one = {"x": np.cos(times)}
    >>> change = growth(one, {"x": np.cos(times) + 1e-5 * times}, times, 1e-5)
    >>> round(change.factor), round(change.power, 1), change.chaotic
    (10, 1.0, False)
    """
    count = min(map(len, [*first.values(), *second.values()]), default=0)
    reached = np.abs(times[:count])
    if not reached.any():
        return None
    changes = [_sizes(second[name][:count] - first[name][:count]) for name in first]
    sizes = [np.maximum.accumulate(_sizes(first[name][:count])) for name in first]
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


def moved(problem: CurveProblem | ODE, part: float) -> CurveProblem | ODE:
    """The motion from a start that is moved by a part of the size of each group of states.

    Frame velocities of a curve are moved by a part of each of them, so that a velocity along a
    forbidden leg stays zero. Equations with a maker remain within their constraints.

    Examples
    --------
    >>> from geomtorsion.ode import ODE
    >>> moved(ODE.of({"x": "v", "v": "-x"}, [1, 2]), 0.5).start
    (1.5, 1.0)
    """
    if isinstance(problem, CurveProblem):
        speeds = [float(u) * (1 + (-1) ** k * part) for k, u in enumerate(problem.frame_velocity)]
        if problem.start is None:
            return problem.with_start(frame_velocity=speeds)
        place = _alternately(problem, problem.coordinates, problem.start, part)
        return problem.with_start(list(place.values()), frame_velocity=speeds)
    return beside(problem, part)


def beside(problem: ODE, part: float) -> ODE:
    """Equations from a start that is moved by a part of the size of each group of states.

    Examples
    --------
    >>> from geomtorsion.ode import ODE
    >>> beside(ODE.of({"x": "v", "v": "-x"}, [1, 2]), 0.5).start
    (1.5, 1.0)
    """
    if problem.maker is not None:
        return problem.maker.moved(problem, part)
    numbers = _alternately(problem, problem.states, problem.start, part)
    for group in problem.normalized:
        length = math.sqrt(sum(numbers[name] ** 2 for name in group))
        numbers |= {name: numbers[name] / length for name in group}
    return problem.with_start(numbers)


def _alternately(
    problem: CurveProblem | ODE, names: Sequence[str], numbers: Sequence[Real], part: float
) -> dict[str, float]:
    """Numbers moved by a part of the size of their group."""
    values = {name: float(x) for name, x in zip(names, numbers, strict=True)}
    groups = {name: problem.together(name) or (name,) for name in values}
    sizes = {
        name: max(abs(values[one]) for one in group if one in values)
        for name, group in groups.items()
    }
    # Alternate signs, so that the change is not a mere stretching.
    return {name: x + (-1) ** k * part * sizes[name] for k, (name, x) in enumerate(values.items())}

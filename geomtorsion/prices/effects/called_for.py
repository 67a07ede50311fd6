"""Effects: `called_for`, the smallest set of effects of a scene, a motion or a theory."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import Any, Protocol, runtime_checkable

import numpy as np

from geomtorsion.curves import CurveProblem
from geomtorsion.errors import AccuracyError, ArgumentError, GeomtorsionError
from geomtorsion.ode import ODE, Engine, Solution, solve
from geomtorsion.ode.solution import DOUBLE
from geomtorsion.ode.solve import ACCURACY
from geomtorsion.prices.effects.effect_budget import EffectBudget
from geomtorsion.prices.effects.effect_choice import Composite, Trial, choose
from geomtorsion.prices.effects.passed_over import passed_over
from geomtorsion.prices.effects.sensitivity import Sensitivity, growth, moved
from geomtorsion.support import checks

# The finest accuracy that is requested of doubles: some sixty roundings.
FINEST = 64 * DOUBLE


@runtime_checkable
class HasEffects(Protocol):
    """An object with its own effects and times, such as a scene."""

    def composite(self, watch: Sequence[str] | None, /) -> Composite:
        """Effects of the object, its runs without some of them, and the watched quantities."""
        ...


@dataclass(frozen=True, eq=False)
class MotionEffects:
    """Effects of a motion: torsion and forces of a curve, terms of a theory, forces on a spin.

    problem: with all effects. times: to report. watch: names of its quantities.
    accuracy: where none is requested.
    """

    problem: CurveProblem | ODE
    times: np.ndarray | float
    watch: tuple[str, ...]
    accuracy: float
    _parts: dict[frozenset[str], CurveProblem | ODE] = field(
        default_factory=dict, repr=False, init=False
    )

    @property
    def title(self) -> str:
        """The problem in a few words."""
        maker = self.problem.maker if isinstance(self.problem, ODE) else None
        return str(self.problem).partition(":")[0] if maker is None else maker.title

    @property
    def thing(self) -> CurveProblem | ODE:
        """The problem."""
        return self.problem

    @property
    def effects(self) -> Mapping[str, str]:
        """Key -> description of each effect."""
        return self.problem.effects

    @property
    def end(self) -> str:
        """The last time."""
        last = float(np.atleast_1d(self.times)[-1])
        return f"{self.problem.time_name} = {last:.6g}"

    def without(self, keys: frozenset[str], accuracy: float) -> CurveProblem | ODE:
        """The problem without some effects; made once."""
        if keys not in self._parts:
            self._parts[keys] = self.problem.without(*sorted(keys))
        return self._parts[keys]

    def _restricted(self, problem: CurveProblem | ODE) -> CurveProblem | ODE:
        """The part on which the watched quantities depend."""
        return problem.restricted(self.watch) if isinstance(problem, ODE) else problem

    def _needed(self, keys: frozenset[str]) -> CurveProblem | ODE:
        """All that the watched quantities need without some effects."""
        return self._restricted(self.without(keys, self.accuracy))

    def run(self, keys: frozenset[str], accuracy: float, engine: Engine | None) -> Trial:
        """A solution without some effects."""
        problem = self._needed(keys)
        solution = self._resolved(problem, accuracy, engine)

        def again() -> float:
            return solve(problem, self.times, solution.accuracy, engine).cost.run_seconds

        values = {name: _above_noise(solution, name) for name in self.watch}
        return Trial(
            values,
            max(_error_of(solution, name) for name in self.watch),
            solution,
            solution.accuracy,
            len(solution.trajectory.segments[0].stage.start),
            solution.cost.run_seconds,
            again,
            unresolved=tuple(x for x in self.watch if solution[x].any() and not values[x].any()),
            missed=passed_over(solution, accuracy),
        )

    def _resolved(
        self, problem: CurveProblem | ODE, accuracy: float, engine: Engine | None
    ) -> Solution:
        """A solution in which each watched quantity is accurate relative to its own size.

        A quantity that is small beside those it is measured with needs more digits than these.
        """
        solution = solve(problem, self.times, accuracy, engine)
        while solution.accuracy > DOUBLE:
            errors = [_own_error(solution, name) for name in self.watch]
            worst = max(errors)
            if worst <= accuracy:
                break
            asked = max(solution.accuracy * min(accuracy / worst, 1.0) / 2, FINEST)
            if asked >= solution.accuracy:
                break
            try:
                solution = solve(problem, self.times, asked, engine)
            except AccuracyError:
                break
        return solution

    def nudged(self, part: float) -> MotionEffects:
        """The motion from a start that is moved by a part of its size."""
        return replace(self, problem=moved(self.problem, part))

    def idle(self, keys: frozenset[str]) -> str:
        """The equations of all that the watched quantities need may be the same without them."""
        part, whole = self._needed(keys), self._needed(frozenset())
        same = isinstance(part, ODE) and part == whole
        return "exactly: no watched quantity depends on it" if same else ""

    def needed(self, keys: frozenset[str]) -> str:
        """A watched quantity may exist only with them, as the density of a fluid."""
        part, whole = self.without(keys, self.accuracy), self.problem
        if not (isinstance(part, ODE) and isinstance(whole, ODE)):
            return ""
        lost = {*whole.states, *whole.outputs} - {*part.states, *part.outputs}
        missing = [name for name in self.watch if name in lost]
        return f"without it there is no {missing[0]}" if missing else ""

    def growth(self, engine: Engine | None) -> Sensitivity | None:
        """The problem, solved from two starts that differ by the root of the accuracy."""
        try:
            one = solve(self._needed(frozenset()), self.times, engine=engine)
            part = math.sqrt(one.accuracy)
            other = self._restricted(moved(self.problem, part))
            two = solve(other, self.times, engine=engine)
        except GeomtorsionError:
            return None
        first, second = ({name: run[name] for name in self.watch} for run in (one, two))
        return growth(first, second, one.times, part)


def _above_noise(solution: Solution, name: str) -> np.ndarray:
    """Values of a quantity; zero where all of them are rounding errors of others."""
    values = np.asarray(solution[name], dtype=float)
    together = solution.problem.together(name)
    size = max((float(np.abs(solution[word]).max()) for word in together), default=0.0)
    error = solution.error_of(name)
    noise = max(error if math.isfinite(error) else solution.error, DOUBLE) * size
    return values if np.abs(values).max(initial=0.0) > noise else np.zeros_like(values)


def _error_of(solution: Solution, name: str) -> float:
    """Error of a quantity relative to its own largest size; zero where it is rounding of others."""
    return _own_error(solution, name) if _above_noise(solution, name).any() else 0.0


def _own_error(solution: Solution, name: str) -> float:
    """Error of a quantity relative to its own largest size; zero where it is exactly zero."""
    values = np.abs(np.asarray(solution[name], dtype=float)).max(initial=0.0)
    if not values:
        return 0.0
    error = solution.error_of(name)
    together = solution.problem.together(name)
    size = max((float(np.abs(solution[word]).max()) for word in together), default=values)
    return float(error * max(size / values, 1.0))


def called_for(
    thing: Any,
    accuracy: float | None = None,
    at: Any = None,
    *,
    watch: Sequence[str] | str | None = None,
    engine: Engine | None = None,
    progress: Callable[[float], object] | bool | None = None,
) -> EffectBudget:
    """Smallest set of effects whose errors of omission and integration stay within an accuracy.

    Each effect is omitted once; the change of the watched quantities at the reported times is its
    influence. Effects are then omitted, the smallest influence first. The sum of their influences
    has to stay within the accuracy, and so does the change by all of them together, which has a run
    of its own. The integration gets the rest of the accuracy.

    A watched quantity that is small beside its neighbours has its own size: runs get finer until it
    is resolved, and `unresolved` lists what rounding hides. Where a change of the start grows, the
    influence is also measured from a start beside this one. A force of time that acts for less than
    a step (down to 1e-5 of the motion) is called for with a note, because no run shows its
    influence.

    Parameters
    ----------
    thing
        a scene: its forces and torques; a curve of `autoparallel`: torsion, nonmetricity and
        forces; a body of `spinning`: the force on its spin, its hidden momentum and torsion; a
        solution of one of these, or of `gravity.solve`: the terms of the Lagrangian and fluids.
    accuracy
        of the watched quantities, relative to their largest size; by default the accuracy of the
        scene or solution, and 1e-10 for a problem.
    at
        times for a problem (to 10 by default), as for `solve`; omit it for a scene or a solution,
        which have their own times.
    watch
        names of the quantities that count; by default the watched quantities of a scene, the
        coordinates of a curve, the unknown functions in the coframe of a theory.
    engine, progress
        as in `solve`.

    Returns
    -------
    EffectBudget; its `chosen` has only the effects that are called for, `result` is its run.

    Raises
    ------
    AccuracyError
        the accuracy is not a positive number, or cannot be reached.
    ArgumentError
        thing has no effects, or `at` does not fit it.
    UnknownNameError
        a watched quantity does not exist.

    Examples
    --------
    A weak bump in a potential well:

    >>> from geomtorsion.curves import autoparallel
    >>> curve = autoparallel("flat_polar", [1.0, 0.0], [0.0, 1.0],
    ...                      potential={"well": "r**2/2", "bump": "r**4/100000"})
    >>> called_for(curve, 1e-3, 1.0).effects
    ('torsion', 'well')
    >>> called_for(curve, 1e-6, 1.0).omitted
    ()
    """
    composite = _composite(thing, at, None if watch is None else _names(watch))
    return choose(composite, composite.accuracy if accuracy is None else accuracy, engine, progress)


def _composite(thing: Any, at: Any, watch: tuple[str, ...] | None) -> Composite:
    """The effects of a thing, with its times and watched quantities."""
    if isinstance(thing, CurveProblem | ODE):
        times = 10.0 if at is None else at
        return MotionEffects(thing, times, watch or thing.main_names, ACCURACY)
    if at is not None and isinstance(thing, Solution | HasEffects):
        raise ArgumentError(
            "at: expected nothing for a scene or a solution, which know their times; got "
            f"{checks.shown(at)}. Drop it, or give the problem."
        )
    if isinstance(thing, Solution):
        names = watch or thing.problem.main_names
        return MotionEffects(thing.problem, thing.times, names, thing.accuracy)
    if isinstance(thing, HasEffects):
        return thing.composite(watch)
    raise ArgumentError(
        "thing: expected a scene, a problem such as gt.autoparallel(...) or gt.spinning(...), or a "
        f"solution, got {checks.shown(thing)}. For a theory give the solution of gravity.solve."
    )


def _names(watch: object) -> tuple[str, ...]:
    """Names of quantities, each once, at least one."""
    listed = [watch] if isinstance(watch, str) else checks.entries(watch, "watch", ArgumentError)
    names = [checks.text(name, "watch", ArgumentError) for name in listed]
    if not names:
        raise ArgumentError("watch: expected a name, got none. Omit it to watch the usual ones.")
    return tuple(dict.fromkeys(names))

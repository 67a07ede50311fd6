"""Pair: autoparallel and geodesic from one start, as solved, ready to be drawn or tabulated."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np
import sympy as sp

from geomtorsion.curves import CurveProblem, autoparallel, distance_apart, geodesic
from geomtorsion.errors import AccuracyError, ChartEdgeError, StartError, TimeError
from geomtorsion.exact import unknown_functions
from geomtorsion.geometry import cartan
from geomtorsion.ode import Engine, Solution, solve
from geomtorsion.ode.numbers import Numbers, check_memory
from geomtorsion.spaces.embedding import Embedding
from geomtorsion.spaces.first_motion import first_motion
from geomtorsion.spaces.registry import embedding_of
from geomtorsion.spaces.space import Space
from geomtorsion.support import checks
from geomtorsion.support.caching import cached_property


@dataclass(frozen=True, eq=False)
class Pair:
    """Autoparallel and geodesic from one start.

    space: the space of both motions.
    straight, shortest: solutions; either may have stopped early.
    chosen: which of start, velocity, t and parameters were not given but chosen.
    stops: name of a curve -> where and why it stopped before the last time.
    """

    space: Space
    straight: Solution
    shortest: Solution
    chosen: tuple[str, ...] = ()
    stops: Mapping[str, str] = field(default_factory=dict)

    @property
    def curves(self) -> dict[str, Solution]:
        """The solutions by name."""
        return {"autoparallel": self.straight, "geodesic": self.shortest}

    @property
    def problem(self) -> CurveProblem:
        """The problem of the autoparallel; both have its start and parameters."""
        return self.straight.problem

    @property
    def parameters(self) -> dict[str, float]:
        """Values of the parameters, by name."""
        return {name: float(value) for name, value in self.problem.parameters.items()}

    @cached_property
    def embedding(self) -> Embedding | None:
        """Embedding for figures, if there is one and the home chart covers both motions."""
        return embedding_of(self.space.frame) if self.chart == self.problem.atlas.home else None

    @cached_property
    def chart(self) -> str:
        """The first chart, the home chart if possible, that contains both motions."""
        atlas = self.problem.atlas
        charts = [name for name in atlas.makers if name != atlas.home]
        for name in (atlas.home, *charts):
            try:
                for solution in self.curves.values():
                    solution.in_chart(name)
            except ChartEdgeError:
                continue
            return name
        raise ChartEdgeError(
            "expected a chart that covers both motions, got none. Request a shorter time."
        )

    @property
    def symbols(self) -> tuple[sp.Symbol, ...]:
        """Coordinates of that chart."""
        return self.problem.atlas.chart(self.chart).coordinates

    @cached_property
    def coordinates(self) -> dict[str, np.ndarray]:
        """For each curve its coordinates in that chart, shape (m, n); angles do not jump."""
        problem, chart = self.problem, self.chart
        return {
            name: problem.continued(
                solution.coordinates if chart == problem.atlas.home else solution.in_chart(chart),
                chart,
            )
            for name, solution in self.curves.items()
        }

    @cached_property
    def distance(self) -> np.ndarray:
        """Distance of the two motions while both continue, shape (m,)."""
        one, two = sorted(self.curves.values(), key=lambda solution: len(solution.times))
        return distance_apart(one, two, self.chart)

    @property
    def measure(self) -> str:
        """Definition of the distance, in words."""
        if np.linalg.eigvalsh(np.real(self.problem.frame.eta.at({}))).min() > 0:
            return "the coframe half way between the two: the true distance when small"
        return (
            "the coframe half way between the two, all signs of the metric taken as positive: "
            "a size for observers who carry the frame, no invariant"
        )

    @property
    def coincide(self) -> bool:
        """Whether the two are the same within their errors."""
        size = float(np.abs(self.coordinates["geodesic"]).max()) or 1.0
        # Each of the two may be off by the accuracy.
        return float(self.distance.max()) <= 2 * self.straight.accuracy * size

    @property
    def times(self) -> np.ndarray:
        """Times of the longer curve."""
        return max((self.straight.times, self.shortest.times), key=len)

    def columns(self) -> dict[str, np.ndarray]:
        """A table by named columns, shorter for a curve that stopped early.

        t; for each curve coordinates q, velocities q' (home chart only), frame velocities u;
        distance.
        """
        table: dict[str, np.ndarray] = {"t": self.times}
        names = [symbol.name for symbol in self.symbols]
        for curve, solution in self.curves.items():
            for k, name in enumerate(names):
                table[f"{curve} {name}"] = self.coordinates[curve][:, k]
            if self.chart == self.problem.atlas.home:
                for k, name in enumerate(names):
                    table[f"{curve} {name}'"] = solution.velocity[:, k]
                for k in range(self.problem.frame.dimension):
                    table[f"{curve} u{k}"] = solution.frame_velocity[:, k]
        table["distance"] = self.distance
        return table


def solve_pair(
    space: Space,
    start: Numbers | None = None,
    velocity: Numbers | None = None,
    *,
    frame_velocity: Numbers | None = None,
    t: float | None = None,
    parameters: Mapping[str, float] | None = None,
    moments: Sequence[float] | None = None,
    force: object = None,
    potential: object = None,
    accuracy: float = 1e-10,
    engine: Engine | None = None,
    samples: int = 401,
    progress: Callable[[float, str], object] | None = None,
) -> Pair:
    """Autoparallel and geodesic from one start; `Pair.chosen` lists missing values, chosen here.

    Parameters
    ----------
    space
        its connection defines autoparallels; by default the Cartan connection of the frame.
    start, velocity, frame_velocity, parameters
        q^mu; q'^mu or u^i; values by name.
    t
        last value of the curve parameter.
    moments
        kinetic metric of the geodesic, one number for each frame vector; the metric of
        the frame if None.
    force, potential
        on both motions, as in `autoparallel`.
    progress
        called with the finished fraction, from 0 to 1, and the name of the motion being solved.

    Raises
    ------
    GeomtorsionError
        the motion cannot start, or the accuracy cannot be reached. A motion that leaves its chart
        is not an error: the part before the end is kept.

    Examples
    --------
    >>> from geomtorsion.ode import RungeKutta
    >>> from geomtorsion.spaces import load
    >>> pair = solve_pair(load("flat_polar"), [1, 0], [0, 1], t=1, engine=RungeKutta(), samples=3)
    >>> pair.distance.round(6).tolist()
    [0.0, 0.124154, 0.488547]
    """
    problems, chosen, last = pair_problems(
        space,
        start,
        velocity,
        frame_velocity=frame_velocity,
        t=t,
        parameters=parameters,
        moments=moments,
        force=force,
        potential=potential,
    )
    times = _times(last, samples)
    stops: dict[str, str] = {}
    solutions = {}
    for number, (name, problem) in enumerate(problems.items(), 1):
        report = None
        if progress is not None:
            report = _share(progress, number - 1, len(problems), name)
        solutions[name] = _solved(name, problem, times, accuracy, engine, stops, report)
    return Pair(space, solutions["autoparallel"], solutions["geodesic"], chosen, stops)


def pair_problems(
    space: Space,
    start: Numbers | None = None,
    velocity: Numbers | None = None,
    *,
    frame_velocity: Numbers | None = None,
    t: float | None = None,
    parameters: Mapping[str, float] | None = None,
    moments: Sequence[float] | None = None,
    force: object = None,
    potential: object = None,
) -> tuple[dict[str, CurveProblem], tuple[str, ...], float]:
    """Problems of the autoparallel and the geodesic, names of chosen values, and the last time.

    Examples
    --------
    >>> from geomtorsion.spaces import load
    >>> problems, chosen, last = pair_problems(load("s2"), t=3)
    >>> list(problems), chosen, last
    (['autoparallel', 'geodesic'], ('start', 'velocity', 'parameters'), 3.0)
    """
    # The space chooses missing values, so that every space has a motion.
    checks.instance(space, Space, "space")
    refuse_unknown_functions(space)
    values = checks.by_name(parameters, "parameters")
    # A start that is given needs no look at the domain.
    first = first_motion(space.frame, values if start is None else {})
    # Arrays are neither true nor false.
    moving = frame_velocity if velocity is None else velocity
    arguments = {"start": start, "velocity": moving, "t": t}
    chosen = [name for name, value in arguments.items() if value is None]
    numbers = dict(first.parameters) | values
    if {symbol.name for symbol in space.frame.parameters} - set(values):
        chosen.append("parameters")
    connection = space.connection or cartan(space.frame)
    if velocity is None and frame_velocity is None:
        legs = range(space.frame.dimension) if connection.allowed is None else connection.allowed
        frame_velocity = [u if k in legs else 0.0 for k, u in enumerate(first.frame_velocity)]
    begin: dict[str, Any] = {
        "start": first.start if start is None else start,
        "velocity": velocity,
        "frame_velocity": frame_velocity,
        "parameters": numbers,
        "force": force,
        "potential": potential,
    }
    problems = {
        "autoparallel": autoparallel(connection, **begin),
        "geodesic": geodesic(space.frame, metric=moments, **begin),
    }
    return problems, tuple(chosen), first.t if t is None else checks.number(t, "t", TimeError)


def refuse_unknown_functions(space: Space) -> None:
    """Refuse a space whose frame contains an unknown function: a motion needs numbers."""
    tensors = [space.frame.coframe]
    if space.connection is not None:
        tensors.append(space.connection.coefficients)
    functions = unknown_functions(
        element for tensor in tensors for element in tensor.components.independent.values()
    )
    if functions:
        raise StartError(
            f"expected a space with numbers, got {space.name}, which contains the unknown function "
            f"{functions[0]}. Write a tetrad file with a formula instead of it."
        )


def _times(t: float, samples: int) -> np.ndarray:
    """Evenly spaced times from 0 on."""
    samples = checks.count(samples, "samples", StartError, 2)
    if t == 0:
        raise StartError("t: expected a time other than 0, got 0. Give t > 0 or t < 0.")
    check_memory(samples, 2)
    return np.linspace(0.0, float(t), samples)


def _share(
    progress: Callable[[float, str], object], before: int, count: int, name: str
) -> Callable[[float], None]:
    """Progress of one motion as a part of the whole."""

    def report(part: float) -> None:
        progress((before + part) / count, name)

    report(0.0)
    return report


def _solved(
    name: str,
    problem: CurveProblem,
    times: np.ndarray,
    accuracy: float,
    engine: Engine | None,
    stops: dict[str, str],
    report: Callable[[float], object] | None,
) -> Solution:
    """The solution, as far as it goes."""
    try:
        return solve(problem, times, accuracy, engine, progress=report)
    except ChartEdgeError as error:
        if not isinstance(error.solution, Solution) or len(error.solution.times) < 2:
            raise
        stops[name] = str(error).removesuffix(" The computed part is in the error's `solution`.")
        return error.solution
    except AccuracyError as error:
        raise AccuracyError(f"{name}: {error}") from None

"""pair: autoparallel and geodesic from one start, as solved, ready to be drawn or tabulated."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from functools import cached_property
from typing import TYPE_CHECKING

import numpy as np
import sympy as sp

from geomtorsion.curves import CurveProblem, distance_apart
from geomtorsion.errors import ChartEdgeError
from geomtorsion.ode import Solution
from geomtorsion.spaces.embeddings import Embedding, embedding_of

if TYPE_CHECKING:
    from geomtorsion.spaces.space import Space

# Two curves are one if they are within so many times the accuracy asked for.
WITHIN = 10.0


@dataclass(frozen=True, eq=False)
class Pair:
    """Two motions that begin alike: straightest and shortest.

    space: where they move.
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
        """The problem of the autoparallel; start and parameters are those of both."""
        return self.straight.problem

    @property
    def parameters(self) -> dict[str, float]:
        """Values of the parameters, by name."""
        return {name: float(value) for name, value in self.problem.parameters.items()}

    @cached_property
    def embedding(self) -> Embedding | None:
        """How the space is drawn, if that is known and the home chart reaches everywhere."""
        return embedding_of(self.space.frame) if self.chart == self.problem.atlas.home else None

    @cached_property
    def chart(self) -> str:
        """The first chart, the home chart if possible, in which both motions lie throughout."""
        atlas = self.problem.atlas
        others = [name for name in atlas.makers if name != atlas.home]
        for name in (atlas.home, *others):
            try:
                for solution in self.curves.values():
                    solution.in_chart(name)
            except ChartEdgeError:
                continue
            return name
        raise ChartEdgeError(
            "no chart of this space reaches everywhere the motions go. Ask for a shorter time."
        )

    @property
    def symbols(self) -> tuple[sp.Symbol, ...]:
        """Coordinates of that chart."""
        return self.problem.atlas.chart(self.chart).coordinates

    @cached_property
    def coordinates(self) -> dict[str, np.ndarray]:
        """For each curve its coordinates in that chart, shape (m, n)."""
        if self.chart == self.problem.atlas.home:
            return {name: solution.coordinates for name, solution in self.curves.items()}
        return {name: solution.in_chart(self.chart) for name, solution in self.curves.items()}

    @cached_property
    def distance(self) -> np.ndarray:
        """How far apart they are, as long as both go on, shape (m,)."""
        one, two = sorted(self.curves.values(), key=lambda solution: len(solution.times))
        return distance_apart(one, two, self.chart)

    @property
    def measure(self) -> str:
        """What the distance is, in a few words."""
        if np.linalg.eigvalsh(np.real(self.problem.frame.eta.at({}))).min() > 0:
            return "the coframe half way between the two: the true distance when small"
        return (
            "the coframe half way between the two, all signs of the metric taken as positive: "
            "a size for observers who carry the frame, no invariant"
        )

    @property
    def coincide(self) -> bool:
        """Whether the two are the same as far as their errors can tell."""
        size = float(np.abs(self.coordinates["geodesic"]).max()) or 1.0
        return float(self.distance.max()) <= WITHIN * self.straight.accuracy * size

    @property
    def times(self) -> np.ndarray:
        """Times of the curve that went on longer."""
        return max((self.straight.times, self.shortest.times), key=len)

    def columns(self) -> dict[str, np.ndarray]:
        """A table by named columns, those of a curve that stopped early being shorter.

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

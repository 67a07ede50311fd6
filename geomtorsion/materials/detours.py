"""Detours: how circuits go around missing nodes, along the rings of present nodes around them."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from geomtorsion.materials.rings import Rings
from geomtorsion.materials.windows import Windows
from geomtorsion.support.caching import cached_property


@dataclass(frozen=True, eq=False, repr=False)
class Detour:
    """How a circuit goes around missing nodes.

    A hole is a connected set of missing nodes. The circuit follows the ring of present nodes around
    each hole that it meets. It differs from the requested circuit only within these rings.

    nodes: missing nodes in these rings, numbers along both axes of the plane, shape (k, 2).
    area: of all these rings, in the square of the unit of length.
    change: of the enclosed area, signed: area of this circuit minus area of the requested one.
    distance: largest distance from a missing node to the ring around it.
    error: largest component of the sum of |b| of the rings, minus the part that noise explains: the
        two ways around a hole differ by the b of its ring.
    """

    nodes: np.ndarray
    area: float
    change: float
    distance: float
    error: float

    @property
    def errors(self) -> dict[str, float]:
        """The error as an entry of `Burgers.systematic`."""
        return {"detour": self.error}

    def to_json(self) -> dict[str, object]:
        """The detour as plain JSON data."""
        return {
            "nodes": self.nodes.tolist(),
            "area": self.area,
            "change": self.change,
            "distance": self.distance,
            "error": self.error,
        }

    def __repr__(self) -> str:
        count = len(self.nodes)
        return (
            f"Detour(around {count} missing node{'s' * (count != 1)}, up to {self.distance:.3g} "
            f"away; area {self.change:+.3g}; error {self.error:.2g})"
        )


def detour_of(
    rings: Rings,
    holes: np.ndarray,
    passages: np.ndarray,
    change: float,
    steps: Sequence[float],
    error: float,
) -> Detour:
    """The record of a circuit that passes holes.

    holes: numbers. passages: how often it passes each. steps: distances of nodes along both
    axes. change, error: as in `Detour`.
    """
    cell = abs(steps[0] * steps[1])
    nodes, distance = [], 0.0
    for hole in holes.tolist():
        at = np.argwhere(rings.hole == hole)
        nodes.append(at[:, :2])
        ring = rings.places[:, rings.first[hole] : rings.first[hole + 1]].T
        away = (rings.relative(at, hole)[:, None] - ring[None]) * np.array(steps)
        distance = max(distance, float(np.hypot(*np.moveaxis(away, -1, 0)).max()))
    area = cell * float(passages @ rings.cells[holes])
    return Detour(np.concatenate(nodes), area, change, distance, error)


@dataclass(frozen=True, eq=False)
class Passages:
    """The passages of all rectangular circuits of one size along rings."""

    rings: Rings
    windows: Windows

    def around(self, values: np.ndarray) -> np.ndarray:
        """Sums of a value of each hole over the passages of each circuit, (rows, places...).

        values: shape (rows, holes).
        """
        if not self.rings.count:
            return np.zeros((len(values), *self.windows.places(self.rings.missing.shape)))
        return self.windows.sums(*self.windows.along(*self.rings.shares(values)))

    @cached_property
    def count(self) -> np.ndarray:
        """Number of passages of each circuit, shape (places...)."""
        return self.around(np.ones((1, self.rings.count)))[0]

    @cached_property
    def change(self) -> np.ndarray:
        """Change of the enclosed area in cells, shape (places...)."""
        if not self.rings.count:
            return np.zeros(self.windows.places(self.rings.missing.shape))
        total = self.windows.rounds(*self.windows.along(*self.rings.changes))[0]
        return self.windows.sense * total

    @cached_property
    def refused(self) -> np.ndarray:
        """Whether a circuit meets a hole without a ring, or passes too many holes, (places...)."""
        if not self.rings.missing.any():
            return np.zeros(self.windows.places(self.rings.missing.shape), dtype=bool)
        blocked = (x.astype(np.int32) for x in self.rings.blocked)
        met = self.windows.sums(*self.windows.along(*blocked)) > 0
        inner = (x.astype(np.int32) for x in self.rings.inner)
        met |= self.windows.sums(*self.windows.along(*inner)) == 2 * sum(self.windows.size)
        within = self.around(self.rings.cells[None].astype(float))[0]
        return met | too_large(within, float(np.prod(self.windows.size)))


def too_large(within: np.ndarray | float, area: np.ndarray | float) -> np.ndarray:
    """Whether rings cover more than half of the area of a circuit, which is then another one."""
    return np.asarray(2 * np.asarray(within) > area)

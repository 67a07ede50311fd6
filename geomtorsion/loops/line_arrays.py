"""Line arrays: dislocation lines as numbers: nodes, pairs, Burgers vectors, images, box."""

from __future__ import annotations

from collections.abc import Hashable, Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import ArrayLike

from geomtorsion import checks
from geomtorsion.errors import NetworkError
from geomtorsion.loops.box import Box
from geomtorsion.loops.cochain import Cochain
from geomtorsion.loops.complexes import Complex
from geomtorsion.loops.validation import listed, whole


@dataclass(frozen=True, eq=False, init=False)
class LineArrays:
    """Straight dislocation lines between nodes in three dimensions, each described once.

    positions: of the nodes, shape (nodes, 3).
    pairs: first and second node of each line, along its sense, shape (lines, 2).
    burgers: b of each line, shape (lines, n).
    box: the cell of the simulation; without one nothing repeats.
    images: how many periods further the second node is meant, shape (lines, 3); the nearest image
        if not given.
    labels: names of the nodes; their numbers if not given.
    constraints: the number that a simulation gives each node, shape (nodes,); zero if not given.
    planes: normal of the glide plane of each line, shape (lines, 3), if known.

    Raises
    ------
    NetworkError
        Shapes do not fit, a node is not there, or a number is not finite.
    """

    positions: np.ndarray
    pairs: np.ndarray
    burgers: np.ndarray
    box: Box | None
    images: np.ndarray
    labels: Sequence[Hashable]
    constraints: np.ndarray
    planes: np.ndarray | None

    def __init__(
        self,
        positions: ArrayLike,
        pairs: ArrayLike,
        burgers: ArrayLike,
        box: Box | None = None,
        images: ArrayLike | None = None,
        labels: Sequence[Hashable] = (),
        constraints: ArrayLike | None = None,
        planes: ArrayLike | None = None,
    ) -> None:
        def put(name: str, value: object) -> None:
            object.__setattr__(self, name, value)

        put("positions", checks.array(positions, "positions", NetworkError, shape=(None, 3)))
        count = len(self.positions)
        put("pairs", whole(pairs, "pairs", 2))
        put("burgers", checks.array(burgers, "burgers", NetworkError, shape=(None, None)))
        if len(self.burgers) != len(self.pairs):
            raise NetworkError(
                f"burgers: one row for each of {len(self.pairs)} lines was needed, but "
                f"{len(self.burgers)} came."
            )
        put("box", None if box is None else checks.instance(box, Box, "box", NetworkError))
        put("labels", listed(labels, "labels") or range(count))
        given = np.zeros(count, np.int64) if constraints is None else constraints
        column = [[x] for x in checks.entries(checks.rows(given), "constraints", NetworkError)]
        put("constraints", whole(column, "constraints", 1).ravel())
        if len(self.constraints) != count:
            raise NetworkError(
                f"constraints: one for each of {count} nodes was needed, but "
                f"{len(self.constraints)} came."
            )
        put("planes", None)
        if planes is not None:
            shape = (len(self.pairs), 3)
            put("planes", checks.array(planes, "planes", NetworkError, shape=shape))
        Complex(count, self.pairs, np.zeros((len(self.pairs), 0), np.int64), labels=self.labels)
        put("images", self._found_images(images))
        with np.errstate(over="ignore", invalid="ignore"):
            extent = float(self.lengths.sum()) * float(np.abs(self.burgers).max(initial=0.0))
        if not extent < np.inf:
            raise NetworkError(
                "lengths of lines leave the range of floats. Give positions in other units."
            )

    def _found_images(self, given: ArrayLike | None) -> np.ndarray:
        """Images as given, or the nearest."""
        if self.box is None:
            if given is not None and np.size(given):
                raise NetworkError("images: lines have periodic images, but no box came. Give it.")
            return np.zeros((len(self.pairs), 0), dtype=np.int64)
        if given is not None:
            found = whole(given, "images", 3)
            if found[:, ~np.asarray(self.box.periodic)].any():
                raise NetworkError(
                    "images: a line leaves the box along an edge that is not periodic. "
                    "Give 0 there."
                )
            return found
        first, second = self.pairs.T
        return self.box.images(self.positions[second] - self.positions[first])

    @cached_property
    def cochain(self) -> Cochain:
        """b on the lines, as a cochain with periodic images: sums along any chain of lines."""
        made = Complex(len(self.positions), self.pairs, self._images, labels=self.labels)
        return Cochain(made, self.burgers)

    @property
    def _images(self) -> np.ndarray:
        """Images, which are always there."""
        assert self.images is not None
        return self.images

    @property
    def image_list(self) -> list[list[int]]:
        """Images as Python lists."""
        return self._images.tolist()

    @property
    def constraint_list(self) -> list[int]:
        """Constraints as a Python list."""
        assert self.constraints is not None
        return self.constraints.tolist()

    @cached_property
    def steps(self) -> np.ndarray:
        """From the first node of each line to the second, in its image, shape (lines, 3)."""
        periods = None if self.box is None else self.box.vectors
        return Cochain.between(self.cochain.complex, self.positions, periods).values

    @cached_property
    def lengths(self) -> np.ndarray:
        """Length of each line, shape (lines,)."""
        return np.linalg.norm(self.steps, axis=1)

    @cached_property
    def excess(self) -> np.ndarray:
        """b out minus b in at each node, shape (nodes, n): the boundary of the chain of lines."""
        return -(self.cochain.complex.boundary(0).T @ self.burgers)

    @cached_property
    def screw_shares(self) -> np.ndarray:
        """Share of b^2 along each line, cos^2 of the angle between the two, shape (lines,)."""
        sizes = np.linalg.norm(self.burgers, axis=1) * self.lengths
        along = (self.burgers * self.steps).sum(axis=1)
        return np.where(sizes > 0, along / np.where(sizes > 0, sizes, 1.0), 0.0) ** 2

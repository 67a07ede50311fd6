"""Circuit: the Burgers vector of a loop round lines of a network, by linking."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import islice

import numpy as np

from geomtorsion import checks
from geomtorsion.errors import NetworkError
from geomtorsion.loops.line_arrays import LineArrays
from geomtorsion.loops.line_families import Lattice, lattice_coordinates
from geomtorsion.loops.linking import Crossing, crossings
from geomtorsion.loops.loop import Loop
from geomtorsion.loops.reactions import Vector, size, total, vanishes, written


@dataclass(frozen=True, eq=False)
class CircuitBurgers:
    """What a circuit round lines of a network misses.

    exact: b, exact where that of the lines is, shape (n,).
    coordinates: the same in the lattice that was given, whole numbers; None without a lattice.
    crossings: lines that cross a surface which the circuit spans, with their images and signs.
    """

    exact: Vector
    coordinates: tuple[int, ...] | None
    crossings: tuple[Crossing, ...]

    @property
    def vector(self) -> np.ndarray:
        """b as floats, shape (n,)."""
        return np.array([float(x) for x in self.exact])


def circuit_burgers(
    lines: LineArrays,
    vectors: Sequence[Vector],
    loop: Loop,
    lattice: Lattice | None,
    tolerance: float,
) -> CircuitBurgers:
    """The signed sum of b over the lines that cross a surface; a second one must give the same.

    vectors: b of each line, exact where it is. tolerance: share of the largest b within which
    floats count as equal.

    Raises
    ------
    NetworkError
        Two surfaces give different sums: lines end between them. Or there is no line.
    """
    checks.instance(loop, Loop, "loop")
    if not vectors:
        raise NetworkError("a circuit needs lines to go round, but the network has none.")
    coordinates = None
    if lattice is not None:
        coordinates = lattice_coordinates(lines.burgers, lattice, tolerance)
    first, second = islice(crossings(lines, loop), 2)
    one, two = (_sum(vectors, found) for found in (first, second))
    missing = tuple(a - b for a, b in zip(one, two, strict=True))
    share = tolerance * (1 + len(first) + len(second))
    if not vanishes(missing, max(map(size, vectors)), share):
        raise NetworkError(
            "the circuit has no Burgers vector: lines end between two surfaces that it spans, "
            f"which give {written(one)} and {written(two)}. Mend the nodes that .node_rule() "
            "names, or lead the circuit elsewhere."
        )
    if coordinates is None:
        return CircuitBurgers(one, None, first)
    whole = np.zeros(coordinates.shape[1], dtype=np.int64)
    for crossing in first:
        whole += crossing.count * coordinates[crossing.line]
    return CircuitBurgers(one, tuple(whole.tolist()), first)


def _sum(vectors: Sequence[Vector], found: Sequence[Crossing]) -> Vector:
    """The sum of b over crossings."""
    rows = [tuple(one.count * x for x in vectors[one.line]) for one in found]
    return total(rows) if rows else tuple(0 * x for x in vectors[0])

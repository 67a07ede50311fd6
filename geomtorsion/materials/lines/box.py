"""Box: the cell of a simulation, periodic along any of its edges."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from geomtorsion.errors import NetworkError
from geomtorsion.support import checks
from geomtorsion.support.caching import cached_property


@dataclass(frozen=True, eq=False)
class Box:
    """The cell of a simulation in three dimensions.

    vectors: its edges as rows, shape (3, 3); coordinates.
    origin: one corner, shape (3,).
    periodic: along which edges it repeats, shape (3,).

    Raises
    ------
    NetworkError
        Wrong shapes, numbers that are not finite, or edges in one plane.

    Examples
    --------
    >>> box = Box.of_bounds([-1, -1, -1], [1, 1, 3])
    >>> box.volume, box.images([[1.5, 0, -3.0]]).tolist()
    (16.0, [[-1, 0, 1]])
    """

    vectors: np.ndarray | Sequence[Sequence[float]]
    origin: np.ndarray | Sequence[float] = (0.0, 0.0, 0.0)
    periodic: Sequence[bool] | np.ndarray = (True, True, True)

    def __post_init__(self) -> None:
        """Check shapes and numbers once."""
        vectors = checks.array(self.vectors, "vectors of the box", NetworkError, shape=(3, 3))
        origin = checks.array(self.origin, "origin of the box", NetworkError, shape=(3,))
        remedy = "Give one for each edge of the box."
        flags = checks.flags(self.periodic, 3, "periodic", NetworkError, remedy=remedy)
        for k, edge in enumerate(vectors):
            checks.measured(edge, f"vectors of the box[{k}]", NetworkError, is_length=True)
        checks.measured(origin, "origin of the box", NetworkError)
        sizes = float(np.prod(np.linalg.norm(vectors, axis=1)))
        # Edges that span less than rounding error are in one plane.
        if not _volume(vectors) > 8 * np.finfo(float).eps * sizes:
            raise NetworkError(
                f"vectors of the box: expected three edges that span a finite volume, got "
                f"{checks.shown(vectors.tolist())}. Give independent edges as rows."
            )
        object.__setattr__(self, "vectors", vectors)
        object.__setattr__(self, "origin", origin)
        object.__setattr__(self, "periodic", np.array(flags, dtype=bool))

    @classmethod
    def of_bounds(
        cls,
        low: Sequence[float] | np.ndarray,
        high: Sequence[float] | np.ndarray,
        periodic: bool | Sequence[bool] = True,
    ) -> Box:
        """A box along the coordinates, from its lowest corner to its highest, shape (3,) each."""
        start = checks.array(low, "low", NetworkError, shape=(3,))
        end = checks.array(high, "high", NetworkError, shape=(3,))
        for values, name in ((start, "low"), (end, "high")):
            checks.measured(values, name, NetworkError)
        if not (end > start).all():
            raise NetworkError(
                "box: expected a highest corner above the lowest, got "
                f"{checks.shown(end.tolist())} and {checks.shown(start.tolist())}. Correct them."
            )
        flags = [periodic] * 3 if isinstance(periodic, bool) else periodic
        return cls(np.diag(end - start), start, flags)

    @cached_property
    def volume(self) -> float:
        """Volume, in coordinate units cubed."""
        return _volume(np.asarray(self.vectors))

    @cached_property
    def inverse(self) -> np.ndarray:
        """Matrix from coordinates to fractions of the edges: x @ inverse, shape (3, 3)."""
        return np.linalg.inv(self.vectors)

    def images(self, steps: np.ndarray | Sequence[Sequence[float]]) -> np.ndarray:
        """Whole periods that make each step the shortest when added, shape (k, 3).

        Fractions of the edges are rounded, as in codes for dislocation dynamics: in a very skew box
        another image may be slightly nearer.

        Raises
        ------
        NetworkError
            A step is so long that its periods cannot be counted.
        """
        rows = checks.array(steps, "steps", NetworkError, shape=(None, 3))
        with np.errstate(over="ignore", invalid="ignore"):
            shares = np.where(self.periodic, np.rint(rows @ self.inverse), 0.0)
        if not (np.abs(shares) <= 2.0**31).all():
            raise NetworkError(
                "expected the nodes of a line at most 2**31 periods apart, got a larger distance. "
                "Are positions and box in the same units?"
            )
        return -shares.astype(np.int64)


def _volume(vectors: np.ndarray) -> float:
    """The product of three edges, without intermediate rounding for edges along the coordinates."""
    return abs(float(np.cross(vectors[0], vectors[1]) @ vectors[2]))

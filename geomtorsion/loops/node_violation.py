"""Node violation: a node of a network of lines at which b is not conserved."""

from __future__ import annotations

from collections.abc import Hashable
from dataclasses import dataclass

from geomtorsion.loops.reactions import Vector, written

# Numbers that ParaDiS and OpenDiS give nodes.
CONSTRAINTS = {1: "surface", 5: "surface", 6: "surface", 7: "pinned", 8: "surface"}


@dataclass(frozen=True)
class NodeViolation:
    """A node at which b is not conserved.

    node: which; excess: sum of b of the lines that leave minus those that arrive, shape (n,).
    constraint: the number that a simulation gives the node; 7: it is pinned.
    """

    node: Hashable
    excess: Vector
    constraint: int = 0

    @property
    def missing(self) -> Vector:
        """The b of a line that would have to leave the node for b to be conserved, shape (n,)."""
        return tuple(-x if x else x for x in self.excess)

    def __str__(self) -> str:
        pinned = " (it is pinned)" if CONSTRAINTS.get(self.constraint) == "pinned" else ""
        return f"node {self.node!r}{pinned}: b out minus b in = {written(self.excess)}"

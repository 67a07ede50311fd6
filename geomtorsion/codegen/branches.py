"""Branches: whether roots still have the signs with which they were read, at given numbers."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace
from functools import cached_property, lru_cache

import numpy as np
import sympy as sp
from numpy.typing import ArrayLike

from geomtorsion.codegen.expression_graph import Graph, graph
from geomtorsion.errors import BranchError
from geomtorsion.exact.element import Element
from geomtorsion.exact.generators import Branch
from geomtorsion.exact.tower import Tower

# Two readings of one root that differ by more than this part of their size are of two branches.
# Between branches lies a sign, or a part of a turn; rounding is smaller than both.
APART = 1e-3


def branch_check(fields: Iterable[Tower], names: Sequence[str]) -> BranchCheck | None:
    """The check of all branches on which elements of some fields rely; None where there is none.

    names: of the arguments; what depends on others, no element in these arguments relies on.
    """
    known = set(names)
    found = [
        (field.is_complex, branch)
        for field in dict.fromkeys(fields)
        for branch in field.relied_on
        if {symbol.name for symbol in branch.radical.free_symbols} <= known
    ]
    return _kept(BranchCheck(tuple(names), tuple(found))) if found else None


@dataclass(frozen=True, eq=False)
class BranchCheck:
    """Whether roots have the signs with which they were read.

    names: of the arguments. branches: each with whether it is about complex numbers.
    """

    names: tuple[str, ...]
    branches: tuple[tuple[bool, Branch], ...]

    # Checks of the very same branches are the same; whether others are may be undecided.
    @property
    def _key(self) -> tuple[object, ...]:
        return self.names, *((is_complex, id(branch)) for is_complex, branch in self.branches)

    def __eq__(self, other: object) -> bool:
        return isinstance(other, BranchCheck) and self._key == other._key

    def __hash__(self) -> int:
        return hash(self._key)

    @cached_property
    def _graph(self) -> Graph:
        """For each branch the root as it stands and as it was read, or what has to be positive."""
        outputs: list[Element | sp.Expr] = []
        for is_complex, branch in self.branches:
            if branch.holds is not None and not is_complex:
                outputs += [branch.holds, sp.S.Zero]
            else:
                outputs += [branch.radical, branch.read_as]
        found = graph(self.names, outputs, factor=False)
        # Points of complex frames are complex, also where nothing in a root is.
        is_complex = found.is_complex or any(is_complex for is_complex, _ in self.branches)
        return replace(found, is_complex=is_complex)

    def broken(self, *values: ArrayLike) -> np.ndarray:
        """For each branch whether it is left, shape (branches, ...)."""
        found = self._graph.numpy()(*values)
        one, two = found[0::2], found[1::2]
        result = np.zeros(one.shape, dtype=bool)
        with np.errstate(all="ignore"):
            for k, (is_complex, branch) in enumerate(self.branches):
                if branch.holds is not None and not is_complex:
                    result[k] = one[k].real < 0
                else:
                    size = np.maximum(np.abs(one[k]), np.abs(two[k]))
                    result[k] = np.abs(one[k] - two[k]) > APART * size
        return result

    def refuse(self, *values: ArrayLike) -> None:
        """Raise BranchError where a branch is left; the message names it and the first point."""
        broken = self.broken(*values)
        if not broken.any():
            return
        first = tuple(int(k) for k in np.argwhere(broken)[0])
        broad = np.broadcast_arrays(*values)
        needed = {symbol.name for symbol in self.branches[first[0]][1].radical.free_symbols}
        point = ", ".join(
            f"{name} = {array[first[1:]]:.6g}"
            for name, array in zip(self.names, broad, strict=True)
            if name in needed
        )
        branch = self.branches[first[0]][1]
        advice = "State a domain around the point: what may be read in several ways is read there."
        if isinstance(branch.radical, sp.Pow):
            advice = (
                "State a domain around the point (roots are read as they are there), or the value "
                f"that is meant: branches={{{branch.radical}: ...}}."
            )
        raise BranchError(f"{branch}; {point} came. {advice}")


@lru_cache(maxsize=64)
def _kept(check: BranchCheck) -> BranchCheck:
    """The first of equal checks: its code is made once."""
    return check

"""Reduced openings: starts of a smaller system for many motions at once."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from geomtorsion.motion.reduced.form import Reduction


@dataclass(frozen=True, eq=False)
class Openings:
    """Starts of motions that have one system.

    index: which of many they are.
    start, values, numbers: as in an `Opening`, each of shape (rows, number of motions).
    confined: whether the system is that of confined motions.
    """

    index: Any
    start: Any
    values: Any
    numbers: Any
    confined: bool


def openings(reduction: Reduction, starts: Any, parameters: Any) -> Iterator[Openings]:
    """Starts in double precision for Taylor series, of those motions that lose no digits by it.

    starts, parameters: of the full system, shapes (size, n) and (parameters, n).
    """
    import numpy as np

    written = reduction.written
    found = reduction.worked_out.of_many(starts, parameters)
    if found is None:
        return
    momenta, constants = found
    begun = np.array([*starts[: written.width], *momenta])
    values = np.array([*parameters, *(constants[k] for k in reduction.places)])
    numbers = np.array([*parameters, *constants][: len(reduction.out.parameters)])
    own = starts[written.width :]
    with np.errstate(all="ignore"):
        back = reduction.out.array_rates(*begun, *numbers)
        gap = np.max([np.abs(x - y) for x, y in zip(own, back, strict=True)], axis=0)
        serves = gap <= reduction.lost(np.abs(own).max(axis=0))
    serves &= np.isfinite(begun).all(axis=0) & np.isfinite(values).all(axis=0)
    confined = np.full(len(serves), False)
    if written.singles:
        confined[serves] = reduction.confined.holds(
            list(starts[:, serves]), list(numbers[:, serves])
        )
    for inside in (False, True):
        index = np.flatnonzero(serves & (confined == inside))
        if not len(index):
            continue
        start = begun[:, index]
        if inside:
            for place in reduction.confined.cosines:
                start[place] = np.cos(start[place])
        yield Openings(index, start, values[:, index], numbers[:, index], inside)

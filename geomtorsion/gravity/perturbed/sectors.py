"""Sectors: small fields sorted by spin and parity at rest, or by helicity along z."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

from flint import fmpq, fmpq_mat

from geomtorsion.gravity.perturbed.geometries import Component

# Coefficients of a combination of fields: number of the field -> coefficient.
Vector = dict[int, fmpq]


@dataclass(frozen=True)
class Sector:
    """Combinations of fields that no rotation and no reflection mixes with others.

    vectors: the combinations. odd: whether each has an odd number of indices, so that an odd
    number of derivatives leads from it to a scalar. label: spin and parity,
    or helicity and mirror sign.
    """

    label: tuple[int, int]
    vectors: tuple[Vector, ...]
    odd: tuple[bool, ...]

    def joined(self, other: Sector) -> Sector:
        """Both sectors as one, without a parity."""
        return Sector((self.label[0], 0), self.vectors + other.vectors, self.odd + other.odd)


def spins(components: Sequence[Component]) -> list[Sector]:
    """Sectors at rest by (spin, parity): of each multiplet the component without spin along z."""
    n = len(components)
    turns = [_turn(components, *plane) for plane in ((2, 3), (3, 1), (1, 2))]
    casimir = fmpq_mat(n, n)
    for turn in turns:
        casimir -= turn * turn
    highest = max(len(one.indices) for one in components)
    groups = _groups(components, lambda one: (_count(one, 1, 2, 3) % 2, len(one.indices) % 2))
    sectors: dict[tuple[int, int], tuple[list[Vector], list[bool]]] = {}
    for (space, rank), members in groups:
        for spin in range(highest + 1):
            rows = [casimir - _times(n, spin * (spin + 1)), turns[2]]
            vectors, odd = sectors.setdefault((spin, -1 if space else 1), ([], []))
            for vector in _kernel(rows, members):
                vectors.append(vector)
                odd.append(bool(rank))
    return [Sector(label, tuple(v), tuple(o)) for label, (v, o) in sorted(sectors.items()) if v]


def helicities(components: Sequence[Component]) -> list[Sector]:
    """Sectors along z by (helicity, sign under the reflection of y)."""
    n = len(components)
    turn = _turn(components, 1, 2)
    square = turn * turn
    highest = max(len(one.indices) for one in components)
    groups = _groups(components, lambda one: (_count(one, 2) % 2, len(one.indices) % 2))
    sectors: dict[tuple[int, int], tuple[list[Vector], list[bool]]] = {}
    for (mirror, rank), members in groups:
        for helicity in range(highest + 1):
            vectors, odd = sectors.setdefault((helicity, -1 if mirror else 1), ([], []))
            for vector in _kernel([square + _times(n, helicity**2)], members):
                vectors.append(vector)
                odd.append(bool(rank))
    return [Sector(label, tuple(v), tuple(o)) for label, (v, o) in sorted(sectors.items()) if v]


def _count(component: Component, *values: int) -> int:
    return sum(index in values for index in component.indices)


def _groups(components: Sequence[Component], key: object) -> Iterator[tuple[tuple, list[int]]]:
    """Numbers of the components by a key, in the order of the key."""
    groups: dict[tuple, list[int]] = {}
    for number, one in enumerate(components):
        groups.setdefault(key(one), []).append(number)  # type: ignore[operator]
    yield from sorted(groups.items())


def _turn(components: Sequence[Component], a: int, b: int) -> fmpq_mat:
    """The generator of rotations in a plane on the fields, one column for each field."""
    numbers = {one: k for k, one in enumerate(components)}
    matrix = fmpq_mat(len(components), len(components))
    for column, one in enumerate(components):
        for slot, index in enumerate(one.indices):
            for old, new, factor in ((a, b, 1), (b, a, -1)):
                if index == old and (image := one.moved(slot, new)) is not None:
                    row, sign = numbers[image[0]], image[1]
                    matrix[row, column] = matrix[row, column] + factor * sign
    return matrix


def _times(n: int, factor: int) -> fmpq_mat:
    """A multiple of the identity."""
    return fmpq_mat(n, n, [factor if i == j else 0 for i in range(n) for j in range(n)])


def _kernel(matrices: Sequence[fmpq_mat], members: Sequence[int]) -> list[Vector]:
    """Combinations of some fields that all matrices annihilate."""
    rows = [[m[i, k] for k in members] for m in matrices for i in range(m.nrows())]
    rows = [row for row in rows if any(row)]
    if not rows:
        return [{k: fmpq(1)} for k in members]
    form, rank = fmpq_mat(len(rows), len(members), [x for row in rows for x in row]).rref()
    pivots = [next(k for k in range(len(members)) if form[i, k] != 0) for i in range(rank)]
    vectors = []
    for free in (k for k in range(len(members)) if k not in pivots):
        vector = {members[free]: fmpq(1)}
        for i, pivot in enumerate(pivots):
            if form[i, free] != 0:
                vector[members[pivot]] = -form[i, free]
        vectors.append(vector)
    return vectors

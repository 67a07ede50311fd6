"""Symmetry: which components of an array are equal up to sign, so that each is computed once."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cache
from itertools import product

Index = tuple[int, ...]
Generator = tuple[tuple[int, ...], int]
Symmetry = tuple[Generator, ...]


def exchange(rank: int, first: int, second: int, sign: int) -> Generator:
    """Generator that swaps two slots of an array and multiplies it by sign.

    Examples
    --------
    >>> exchange(3, 0, 1, -1)
    ((1, 0, 2), -1)
    """
    order = list(range(rank))
    order[first], order[second] = order[second], order[first]
    return tuple(order), sign


def symmetric(rank: int, first: int = 0, second: int = 1) -> Symmetry:
    """Symmetry under the swap of two slots.

    Examples
    --------
    >>> symmetric(2)
    (((1, 0), 1),)
    """
    return (exchange(rank, first, second, 1),)


def antisymmetric(rank: int, first: int = 0, second: int = 1) -> Symmetry:
    """Antisymmetry under the swap of two slots.

    Examples
    --------
    >>> antisymmetric(3)
    (((1, 0, 2), -1),)
    """
    return (exchange(rank, first, second, -1),)


def alternating(rank: int) -> Symmetry:
    """Antisymmetry in all slots, as of a differential form.

    Examples
    --------
    >>> len(orbits(3, 4, alternating(3)).representatives)
    4
    """
    return tuple(exchange(rank, k, k + 1, -1) for k in range(rank - 1))


RIEMANN: Symmetry = (exchange(4, 0, 1, -1), exchange(4, 2, 3, -1), ((2, 3, 0, 1), 1))


@dataclass(frozen=True)
class Orbits:
    """Components that determine each other.

    canonical: index -> (sign, representative), sign 0 where the component must vanish;
    None stands for the identity.
    representatives: one index for each independent component.
    members: representative -> the indices of all components that it determines.
    """

    canonical: dict[Index, tuple[int, Index]] | None
    representatives: Sequence[Index]
    members: Mapping[Index, Sequence[Index]]

    def of(self, index: Index) -> tuple[int, Index]:
        """Sign and representative of an index."""
        return (1, index) if self.canonical is None else self.canonical[index]


@cache
def orbits(rank: int, dimension: int, symmetry: Symmetry) -> Orbits:
    """Orbits of all index tuples of an array under the group that the generators span.

    Examples
    --------
    >>> len(orbits(4, 4, RIEMANN).representatives)  # 20 after the cyclic identity
    21
    >>> orbits(2, 2, antisymmetric(2)).of((1, 0))
    (-1, (0, 1))
    """
    if not symmetry:
        every = tuple(product(range(dimension), repeat=rank))
        return Orbits(None, every, {index: (index,) for index in every})
    elements = _group(rank, symmetry)
    canonical: dict[Index, tuple[int, Index]] = {}
    members: dict[Index, Sequence[Index]] = {}
    for index in product(range(dimension), repeat=rank):
        if index in canonical:
            continue
        images: dict[Index, int] = {}
        sign_of_orbit = 1
        for order, sign in elements:
            image = tuple([index[k] for k in order])
            # A component that is its own negative vanishes.
            if images.setdefault(image, sign) != sign:
                sign_of_orbit = 0
        for image, sign in images.items():
            canonical[image] = (sign * sign_of_orbit, index)
        if sign_of_orbit:
            members[index] = tuple(images)
    return Orbits(canonical, tuple(members), members)


def _group(rank: int, symmetry: Symmetry) -> list[Generator]:
    """All products of the generators."""
    found: dict[tuple[int, ...], int] = {tuple(range(rank)): 1}
    waiting = list(found.items())
    elements = []
    while waiting:
        order, sign = waiting.pop()
        elements.append((order, sign))
        for step, step_sign in symmetry:
            image = tuple(order[k] for k in step)
            if image not in found:
                found[image] = sign * step_sign
                waiting.append((image, sign * step_sign))
    return elements


@cache
def effective(symmetry: Symmetry, slots: str) -> Symmetry:
    """The generators that hold for these slots: only slots of the same kind are exchanged.

    A tensor keeps the symmetry of its all-lower form; R_{abc}^d loses the exchange of c and d.

    Examples
    --------
    >>> effective(RIEMANN, "dddu") == (exchange(4, 0, 1, -1),)
    True
    """
    return tuple(
        (order, sign)
        for order, sign in symmetry
        if all(slots[k] == slots[j] for k, j in enumerate(order))
    )


def shifted(symmetry: Symmetry, by: int) -> Symmetry:
    """The same symmetry of the later slots after new slots were put in front.

    Examples
    --------
    >>> shifted(symmetric(2), 1)
    (((0, 2, 1), 1),)
    """
    front = tuple(range(by))
    return tuple((front + tuple(k + by for k in order), sign) for order, sign in symmetry)


def common(first: Symmetry, second: Symmetry) -> Symmetry:
    """Generators that both arrays have: the symmetry of their sum.

    Examples
    --------
    >>> common(symmetric(2), antisymmetric(2))
    ()
    """
    return tuple(generator for generator in first if generator in second)

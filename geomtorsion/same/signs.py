"""Signs: invariants of one sign in a whole region, by which two geometries differ."""

from __future__ import annotations

from collections.abc import Iterator, Mapping

from geomtorsion.errors import LimitError
from geomtorsion.exact import Certainty, Element
from geomtorsion.exact.common_values import LONGEST
from geomtorsion.exact.element import least_certain
from geomtorsion.geometry import contract, levi_civita
from geomtorsion.same.invariants import Invariants
from geomtorsion.same.scalars import is_constant

# Signs are read at some hundred points all over a region; after so many a different one is rarer.
SAMPLED = Certainty(proved=False, error=1e-2)


def opposite_signs(
    one: Invariants, two: Invariants, first: Mapping[str, Element], second: Mapping[str, Element]
) -> tuple[str, Certainty] | None:
    """A scalar, or the energy of light-like matter, of opposite signs in the two regions."""
    pairs = [(name, a, second[name]) for name, a in first.items()]
    energy, other = _null_energy(one), _null_energy(two)
    if energy is not None and other is not None:
        pairs.append(("the null energy R_ab k^a k^b", energy, other))
    return _opposite(pairs, one, two)


def mirror_images(one: Invariants, two: Invariants) -> tuple[str, Certainty] | None:
    """A scalar that a reflection changes in sign, of opposite signs in the two regions."""
    pairs = zip(pseudoscalars(one), pseudoscalars(two), strict=True)
    return _opposite([(name, a, b) for (name, a), (_, b) in pairs], one, two)


def _opposite(
    rows: list[tuple[str, Element, Element]], one: Invariants, two: Invariants
) -> tuple[str, Certainty] | None:
    words = {1: "positive", -1: "negative"}
    for name, a, b in rows:
        left, right = _sign(one, a), _sign(two, b)
        if left is not None and right is not None and left * right < 0:
            text = f"{name} is {words[left]} for the first and {words[right]} for the second"
            constant = is_constant(one, a) and is_constant(two, b)
            sure = [a.certainty, b.certainty, *([] if constant else [SAMPLED])]
            return f"{text} geometry", least_certain(sure)
    return None


def _sign(invariants: Invariants, x: Element) -> int | None:
    """The sign of an element in the region of its frame; None: both signs, or not decided."""
    if x.length > LONGEST:
        return None
    try:
        return invariants.frame.region.sign(x)
    except LimitError:
        return None


def _null_energy(invariants: Invariants) -> Element | None:
    """A component s l_0^2 of a Ricci tensor R_ab = s l_a l_b; None for other Ricci tensors."""
    frame, n = invariants.frame, range(invariants.frame.dimension)
    if invariants.keep == "legs" or len(n) < 3:
        return None
    ricci = levi_civita(frame).curvature.ricci.element
    k = next((k for k in n if ricci(k, k).is_zero is False), None)
    if k is None:
        return None
    minors = (
        frame.field.sum([(1, ricci(k, k), ricci(i, j)), (-1, ricci(k, i), ricci(k, j))])
        for i in n
        for j in range(i + 1)
    )
    return ricci(k, k) if all(x.is_zero is True for x in minors) else None


def pseudoscalars(invariants: Invariants) -> Iterator[tuple[str, Element]]:
    """Scalars of an odd number of volume forms."""
    frame, n = invariants.frame, invariants.frame.dimension
    letters = "abcdef"[:n]
    plain = invariants.slot == "d"
    volume = (frame.epsilon if plain else frame.epsilon.in_frame()).raised()
    for tensor in invariants.start:
        rank, symbol = len(tensor.slots), tensor.symbol
        if rank == 3 and n == 3:
            yield "the axial torsion", contract(f"{letters},{letters}->", volume, tensor).element()
        elif rank == 3 and n == 4:
            yield (
                f"epsilon^abcd {symbol}_abe {symbol}_cd^e",
                contract("abcd,abe,cde->", volume, tensor, tensor.raised(2)).element(),
            )
        elif rank == 4 and n == 4:
            mixed = tensor.raised(2).raised(3)
            yield (
                f"epsilon^abcd {symbol}_abef {symbol}_cd^ef",
                contract("abcd,abef,cdef->", volume, tensor, mixed).element(),
            )

"""Signs: invariants of one sign in a whole region, by which two geometries differ."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

from geomtorsion.errors import LimitError
from geomtorsion.exact import Certainty, Element
from geomtorsion.exact.common_values import LONGEST
from geomtorsion.exact.element import least_certain
from geomtorsion.geometry import levi_civita
from geomtorsion.same.invariants import Invariants
from geomtorsion.same.scalars import pseudoscalars


@dataclass(frozen=True)
class Contrast:
    """Why two geometries differ.

    text: the reason, with {first} and {second} for the two geometries.
    certainty: certainty of the reason.
    """

    text: str
    certainty: Certainty

    def reason(self, flipped: bool = False) -> str:
        """The reason in words. flipped: the geometries are printed in the other order."""
        names = ("second", "first") if flipped else ("first", "second")
        return self.text.format(first=names[0], second=names[1])


def opposite_signs(
    one: Invariants, two: Invariants, first: Mapping[str, Element], second: Mapping[str, Element]
) -> Contrast | None:
    """A scalar, or the energy of light-like matter, of opposite signs in the two regions."""
    pairs = [(name, a, second[name]) for name, a in first.items() if name in second]
    energy, other = _null_energy(one), _null_energy(two)
    if energy is not None and other is not None:
        pairs.append(("the null energy R_ab k^a k^b", energy, other))
    return _opposite(pairs, one, two)


def mirror_images(one: Invariants, two: Invariants) -> Contrast | None:
    """A scalar that a reflection changes in sign, of opposite signs in the two regions."""
    pairs = zip(pseudoscalars(one), pseudoscalars(two), strict=True)
    return _opposite([(name, a, b) for (name, a), (_, b) in pairs], one, two)


def _opposite(
    rows: list[tuple[str, Element, Element]], one: Invariants, two: Invariants
) -> Contrast | None:
    words = {1: "positive", -1: "negative"}
    for name, a, b in rows:
        left, right = _sign(one, a), _sign(two, b)
        if left is not None and right is not None and left * right < 0:
            kinds = words[left], words[right]
            text = f"{name} is {kinds[0]} for the {{first}} and {kinds[1]} for the {{second}}"
            return Contrast(f"{text} geometry", least_certain([a.certainty, b.certainty]))
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

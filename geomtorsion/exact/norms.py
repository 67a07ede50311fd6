"""Norms: denominators with roots, found again behind the norms that replaced them.

1/(A + B w) is kept as (A - B w)/(A**2 - B**2 P).  The norm below may vanish where A + B w
does not; written and evaluated, the quotient is therefore turned back where that is exact.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from flint.utils.flint_exceptions import DomainError

from geomtorsion.exact.inversion import monic, split

if TYPE_CHECKING:
    from geomtorsion.exact.element import Denominator, Element
    from geomtorsion.exact.field import Field

# Beyond this many roots in one denominator its conjugates are too many to try.
_MOST_ROOTS = 4


class Norms:
    """The denominators with roots met so far, each with conjugates and norm."""

    def __init__(self, field: Field) -> None:
        self.level = field.level
        self.count = len(field.rooted)
        self.table: list[tuple[list[Any], Denominator]] = []
        seen: set[str] = set()
        for element in field.rooted:
            for factor, _ in field.lift(element).factor()[1]:
                key = str(factor)
                if key not in seen and len(factor) > 1:
                    seen.add(key)
                    self._enter(field, factor)

    def _enter(self, field: Field, factor: Any) -> None:
        """Notes one factor, if it has roots and its norm is a product of known factors."""
        degrees = factor.degrees()
        places = [k for k, g in enumerate(field.generators) if g.degree == 2 and degrees[k] > 0]
        if not places or len(places) > _MOST_ROOTS:
            return
        conjugates = [factor]
        norm = factor
        for place in places:
            below, above = split(field, norm, place)
            tail = field.generators[place].tail
            assert tail is not None
            w = field.ctx.gen(place)
            # A root can already have left with another one: csc(x + y).
            if above:
                norm = field.reduced(below * below - above * above * field.lift(tail))
            flipped = []
            for poly in conjugates:
                low, high = split(field, poly, place)
                flipped.append(low - high * w)
            conjugates += flipped
        powers: dict[int, int] = {}
        for part, exponent in norm.factor()[1]:
            index = field.factor_index.get(str(monic(part)[0]))
            if index is None:
                return
            powers[index] = powers.get(index, 0) + exponent
        if powers:
            self.table.append((conjugates, tuple(sorted(powers.items()))))


def norms(field: Field) -> Norms:
    """The table of norms, made anew when the field has grown."""
    known = field.tables.get("norms")
    if known is None or known.level != field.level or known.count != len(field.rooted):
        known = field.tables["norms"] = Norms(field)
    return known


def roots_restored(element: Element) -> tuple[Any, Denominator, dict[str, tuple[Any, int]]]:
    """(num, den, {key: (polynomial, exponent)}): the element with roots below where exact."""
    field = element.field
    num, den = field.lift(element), element._den
    below: dict[str, tuple[Any, int]] = {}
    if not field.rooted or not den:
        return num, den, below
    for conjugates, powers in norms(field).table:
        while True:
            have = dict(den)
            part = {i: min(e, have.get(i, 0)) for i, e in powers}
            found = _divided(field, num, conjugates, powers) if any(part.values()) else None
            if found is None:
                break
            quotient, divisor = found
            # num/part = (quotient * norm/part)/divisor, and the norm is gone from below.
            num = quotient * field.cofactor(powers, tuple((i, e) for i, e in part.items() if e))
            den = tuple((i, e - part.get(i, 0)) for i, e in den if e > part.get(i, 0))
            positive, sign = monic(divisor)
            num = num * sign
            key = str(positive)
            below[key] = (positive, below.get(key, (None, 0))[1] + 1)
    return num, den, below


def _divided(
    field: Field, num: Any, conjugates: list[Any], powers: Denominator
) -> tuple[Any, Any] | None:
    """(q, c) with num/norm = q/c for a conjugate c, or None."""
    norm = field.cofactor(powers, ())
    for conjugate in conjugates:
        try:
            return field.reduced(num * conjugate) / norm, conjugate
        except DomainError:
            continue
    return None

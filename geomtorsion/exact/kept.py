"""Kept: sums of products that are not multiplied out (lazy elements).

A lazy element is the sum, or one over the sum, from which it was built; multiplying it out would be
expensive. Its value modulo a prime decides whether it vanishes (see `modular`), and its derivative
and its numbers follow from its parts. It is multiplied out only to be printed in a short form, or
where its polynomial is needed, as for a root.
"""

from __future__ import annotations

from collections import Counter
from dataclasses import dataclass
from math import prod
from typing import TYPE_CHECKING

from geomtorsion.errors import LimitError
from geomtorsion.exact.element import Element, Lazy, Recipe, Term, in_order
from geomtorsion.exact.limits import (
    LARGEST_KEPT,
    LARGEST_POWER_TERMS,
    LARGEST_PRODUCT,
    terms_of_power,
)

if TYPE_CHECKING:
    import sympy

    from geomtorsion.exact.tower import Tower

    # An irreducible factor by its index, or a lazy denominator by its identity.
    _Divisor = tuple[str, int]


def kept(field: Tower, terms: list[Term]) -> Element:
    """The sum of the terms as an element that is not multiplied out."""
    left = []
    for coefficient, *elements in terms:
        # A numerator that is there vanishes as a polynomial only if it is zero.
        if coefficient and all(x.is_kept or x._num for x in elements):
            factors = [x for x in elements if x.is_kept or not x.is_one]
            left.append((coefficient, *factors))
    if not left:
        return field.zero
    if len(left) == 1 and left[0][0] == 1 and len(left[0]) == 2:
        return left[0][1]
    return Lazy(field, Recipe(tuple(left)))


def reciprocal(field: Tower, element: Element) -> Element:
    """1 over an element, kept so."""
    if isinstance(element, Lazy) and element._recipe.below and len(element._recipe.terms) == 1:
        ((coefficient, *factors),) = element._recipe.terms
        return field.sum(((coefficient, *factors),))
    return Lazy(field, Recipe(((1, element),), below=True))


def derivative(field: Tower, element: Element, symbol: sympy.Symbol) -> Element:
    """The derivative of an element from its recipe, its parts first."""
    slopes: dict[int, Element] = {}

    def slope(part: Element) -> Element:
        return slopes[id(part)] if part.is_kept else part.diff(symbol)

    def known(part: Element) -> bool:
        if id(part) not in slopes and part._diffs is not None and symbol in part._diffs:
            slopes[id(part)] = part._diffs[symbol]
        return id(part) in slopes

    result = field.zero
    for node in in_order(element, known):
        terms = []
        for coefficient, *factors in node._recipe.terms:
            for place, factor in enumerate(factors):
                inner = slope(factor)
                if inner.is_kept or inner._num:
                    others = (*factors[:place], *factors[place + 1 :])
                    terms.append((coefficient, inner, *others))
        result = field.sum(terms) if terms else field.zero
        if node._recipe.below and terms:
            result = field.sum(((-1, result, node, node),))
        if result.is_kept and result.is_zero:
            result = field.zero
        slopes[id(node)] = result
        if node._diffs is None:
            node._diffs = {}
        node._diffs[symbol] = result
    return result


def conjugate(field: Tower, element: Element) -> Element:
    """The element with its parts conjugated."""
    conjugates: dict[int, Element] = {}
    for node in in_order(element, lambda x: id(x) in conjugates):
        terms = tuple(
            (c, *(conjugates[id(x)] if x.is_kept else x.conjugate() for x in xs))
            for c, *xs in node._recipe.terms
        )
        conjugates[id(node)] = Lazy(field, Recipe(terms, node._recipe.below))
    return conjugates[id(element)]


def multiplied_out(field: Tower, element: Element, briefly: bool = False) -> Element | None:
    """The element multiplied out; None where it shall be brief and is not.

    Brief is what takes at most LARGEST_POWER_TERMS pairs of terms, in all parts together.

    Raises
    ------
    LimitError
        it need not be brief, and one product is above the limit of all products.
    """
    # What a part costs is counted whether or not somebody multiplied it out before: the answer
    # must not depend on that.
    spent = 0
    counted: set[int] = set()
    for node in in_order(element, lambda x: id(x) in counted):
        counted.add(id(node))
        if node._whole is None or (node._whole is _LONG and not briefly):
            node._whole = _worked_out(field, node, briefly) or _LONG
        if node._whole is _LONG:
            return None
        spent += node._whole.pairs
        if briefly and (not node._whole.brief or spent > LARGEST_POWER_TERMS):
            return None
    if not isinstance(element, Lazy):
        return element
    assert element._whole is not None
    return element._whole.element


@dataclass(frozen=True, eq=False)
class Whole:
    """An element multiplied out, the pairs of terms that took, and whether each step was brief."""

    element: Element | None
    pairs: int
    brief: bool


# Result of an attempt: it would not be brief.
_LONG = Whole(None, LARGEST_PRODUCT, brief=False)


def _worked_out(field: Tower, one: Lazy, briefly: bool) -> Whole | None:
    """One element multiplied out whose parts are."""
    recipe = one._recipe
    terms = [(c, *(_plain(x) for x in xs)) for c, *xs in recipe.terms]
    pairs = sum(prod(len(field.lift(x)) for x in xs) for _, *xs in terms)
    steps = (LARGEST_POWER_TERMS,) if briefly else (LARGEST_POWER_TERMS, LARGEST_PRODUCT)
    for largest in steps:
        whole = field.added(terms, largest)
        if whole is not None and recipe.below:
            if not whole._num:
                raise ZeroDivisionError("division by an element that is exactly zero")
            whole = field.cleared(whole, largest)
        if whole is not None:
            return Whole(whole, pairs, largest == LARGEST_POWER_TERMS)
    if briefly:
        return None
    raise LimitError(
        f"products of more than {LARGEST_PRODUCT:,} pairs of terms are needed, which is the limit. "
        "Replace a power, a sum or a root in the expression by an unknown function"
    )


def _plain(part: Element) -> Element:
    """A part multiplied out."""
    if not isinstance(part, Lazy):
        return part
    assert part._whole is not None
    assert part._whole.element is not None
    return part._whole.element


def stays_kept(element: Element) -> bool:
    """Whether a kept element that was read may stay so: a sum of quotients, not too large.

    Raises
    ------
    LimitError
        its numerator would have more than LARGEST_KEPT terms over a common denominator, and it is
        not brief.
    """
    field = element.field
    # Terms of numerators, as if nothing cancelled, and powers of denominators.
    sizes: dict[int, tuple[int, Counter[_Divisor]]] = {}
    lengths: dict[_Divisor, int] = {}

    def size(part: Element) -> tuple[int, Counter[_Divisor]]:
        if part.is_kept:
            return sizes[id(part)]
        below = Counter({("factor", index): exponent for index, exponent in part._den})
        lengths.update((key, len(field.factors[key[1]])) for key in below)
        return len(field.lift(part)), below

    def terms_of(powers: Counter[_Divisor]) -> int:
        return prod(terms_of_power(lengths[key], exponent) for key, exponent in powers.items())

    for node in in_order(element, lambda x: id(x) in sizes):
        quotients = []
        for _, *factors in node._recipe.terms:
            num: int = 1
            den: Counter[_Divisor] = Counter()
            for factor, times in Counter(map(id, factors)).items():
                top, bottom = size(next(x for x in factors if id(x) == factor))
                num *= terms_of_power(top, times)
                for key, exponent in bottom.items():
                    den[key] += exponent * times
            quotients.append((num, den))
        common: Counter[_Divisor] = Counter()
        for _, den in quotients:
            common |= den
        above = sum(num * terms_of(common - den) for num, den in quotients)
        if node._recipe.below:
            lengths["kept", id(node)] = above
            sizes[id(node)] = (terms_of(common), Counter({("kept", id(node)): 1}))
        else:
            sizes[id(node)] = (above, common)
    above, common = sizes[id(element)]
    if terms_of(common) == 1:
        return False
    if above > LARGEST_KEPT and field.brief(element) is None:
        raise LimitError(
            f"the expression would have some 10**{len(str(above)) - 1} terms over a common "
            f"denominator; the limit is {LARGEST_KEPT:.0e}. Name a sum in it by an "
            "unknown function"
        )
    return True

"""Lengths: how long an expression would be, before any of it is written.

Expressions that are far too long are refused by the number of names and numbers that they contain.
"""

from __future__ import annotations

from collections import Counter
from typing import TYPE_CHECKING, Any

from geomtorsion.exact.element import Lazy, in_order
from geomtorsion.exact.form import LONGEST_FACTORED, Sum, form
from geomtorsion.exact.generators import Generator
from geomtorsion.exact.limits import check_parts

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable, Iterator

    from geomtorsion.exact.element import Element


def written_length(element: Element) -> int:
    """How many terms an element has, multiplied out, as it is written."""
    bases = [base for base, _ in form(element).powers]
    return max(sum(len(base.terms) if isinstance(base, Sum) else 1 for base in bases), 1)


def short_of(element: Element) -> Element | None:
    """A kept element multiplied out, if that is quickly done and can be factored."""
    whole = element.field.brief(element)
    return whole if whole is not None and len(whole._num) <= LONGEST_FACTORED else None


def vanishes(part: Element) -> bool:
    """Whether a kept part vanishes, decided as for components; not where that may take long."""
    return part.is_kept and part.field.all_sure and part.is_zero is True


def check_sums(element: Element, size_of: Callable[[Generator | Sum], int]) -> None:
    """Refuses a kept element with too many parts in sums that are surely written unchanged.

    The longest sums are examined first, because the length of a collected sum takes time to find,
    and a few sums suffice for an element that is far too long.
    """
    sums: dict[Sum, None] = {}
    either: dict[int, Element] = {}
    seen: set[int] = set()
    waiting = [element]
    while waiting:
        node = waiting.pop()
        if id(node) in seen or vanishes(node):
            continue
        seen.add(id(node))
        if not isinstance(node, Lazy):
            sums.update((base, None) for base, _ in form(node).powers if isinstance(base, Sum))
        elif (short := short_of(node)) is not None:
            either[id(node)] = short
        else:
            waiting += node._recipe.parts
    # A sum that may be written in several forms counts as one part.
    sizes = {base: 1 for node in either.values() for base, _ in form(node).powers}
    longest = sorted((base for base in sums if base not in sizes), key=lambda x: -len(x.terms))
    for k, base in enumerate(longest):
        sizes[base] = size_of(base)
        # Twice as many sums each time: that they are counted costs little beside them.
        if k & (k + 1) == 0 or base is longest[-1]:
            least = parts_at_least(
                element, either, lambda x: sizes.get(x, 2) if isinstance(x, Sum) else size_of(x)
            )
            check_parts(least, f"more than {least:,}")


def parts_at_least(
    element: Element, chosen: dict[int, Element], size_of: Callable[[Generator | Sum], int]
) -> int:
    """Lower bound on the written parts of a kept element, each counted at every occurrence.

    chosen: elements that are written multiplied out. Bases and exponents of products are examined
    separately; a common factor of a sum is written once in front of it, as in `_sum_of`.
    """
    sizes: dict[object, int] = {}
    base_powers: dict[int, dict[Any, int]] = {}

    def size(powers: Iterable[tuple[object, int]]) -> int:
        return max(sum(sizes[base] + exponents(base, power) for base, power in powers), 1)

    def powers_of(part: Element) -> dict[Any, int]:
        if id(part) not in base_powers:
            bases = base_powers[id(part)] = dict(form(chosen.get(id(part), part)).powers)
            sizes.update((base, size_of(base)) for base in bases if base not in sizes)
        return base_powers[id(part)]

    for node in in_order(element, lambda x: id(x) in base_powers or id(x) in chosen or vanishes(x)):
        recipe = node._recipe
        terms: list[Counter[Any]] = []
        for _, *factors in recipe.terms:
            if not any(map(vanishes, factors)):
                terms.append(Counter())
                for factor in factors:
                    terms[-1].update(powers_of(factor))
        first = dict.fromkeys(terms[0]) if terms else {}
        common = {b: min(term[b] for term in terms) for b in first if all(b in t for t in terms)}
        if len(terms) > 1:
            # Sums of equal terms are equal, wherever they were built.
            inside = tuple(
                tuple((b, e - common.get(b, 0)) for b, e in term.items() if e != common.get(b, 0))
                for term in terms
            )
            sizes[inside] = sum(map(size, inside))
            common[inside] = 1
        base_powers[id(node)] = {b: -e if recipe.below else e for b, e in common.items()}
    return size(power for power in powers_of(element).items() if power[1])


def terms_of(element: Element) -> Iterator[object]:
    """All terms of a kept element, including the terms of its parts."""
    seen: set[int] = set()
    for node in in_order(element, lambda x: id(x) in seen):
        seen.add(id(node))
        yield from node._recipe.terms


def exponents(base: object, exponent: int) -> int:
    """Number of numbers in a power besides its base: 3 in x**3, none in exp(3*x)."""
    inside = isinstance(base, Generator) and base.kind in ("exp", "root")
    return 0 if exponent == 1 or inside else 1

"""Arrays: products of sparse component arrays, lazily or all at once."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Sequence
from itertools import product

from geomtorsion.exact import Element, Field
from geomtorsion.geometry.components import Components, Row
from geomtorsion.geometry.symmetry import Index, Symmetry


def total(field: Field, terms: list) -> Element | None:
    """Sum of products, or None if there is nothing to add."""
    if len(terms) == 1 and len(terms[0]) == 2 and terms[0][0] == 1:
        return terms[0][1]
    return field.sum(terms) if terms else None


def change_slot(
    field: Field,
    components: Components,
    slot: int,
    rows: Sequence[Row],
    columns: Sequence[Row],
    symmetry: Symmetry,
) -> Components:
    """Multiply one slot by a sparse matrix: new index i, old index m, rows[i] = (m, element)."""
    get = components.get
    after = slot + 1

    def rule(index: Index) -> Element | None:
        head, tail = index[:slot], index[after:]
        terms = []
        for old, factor in rows[index[slot]]:
            value = get((*head, old, *tail))
            if value is not None:
                terms.append((1, factor, value))
        return total(field, terms)

    def bulk() -> dict[Index, Element]:
        collected: dict[Index, list] = defaultdict(list)
        for index, value in components.nonzero.items():
            head, tail = index[:slot], index[after:]
            for new, factor in columns[index[slot]]:
                collected[(*head, new, *tail)].append((1, factor, value))
        return _summed(field, collected, result)

    result = Components(components.rank, components.dimension, rule, symmetry, bulk)
    return result


def joined(
    field: Field,
    factors: tuple[Components, ...],
    groups: tuple[str, ...],
    wanted: str,
    symmetry: Symmetry,
) -> Components:
    """Product of one or two arrays, summed over the letters that are not wanted."""
    summed = [letter for letter in dict.fromkeys("".join(groups)) if letter not in wanted]
    everything = list(wanted) + summed
    places = [[everything.index(letter) for letter in group] for group in groups]
    dimension = factors[0].dimension

    def rule(index: Index) -> Element | None:
        terms = []
        for inner in product(range(dimension), repeat=len(summed)):
            values = index + inner
            found = []
            for factor, place in zip(factors, places, strict=True):
                value = factor.get(tuple([values[k] for k in place]))
                if value is None:
                    break
                found.append(value)
            else:
                terms.append((1, *found))
        return total(field, terms)

    def bulk() -> dict[Index, Element]:
        collected: dict[Index, list] = defaultdict(list)
        for values, product_ in _matches(factors, groups):
            collected[tuple([values[letter] for letter in wanted])].append((1, *product_))
        return _summed(field, collected, result)

    result = Components(len(wanted), dimension, rule, symmetry, bulk)
    return result


def _matches(factors: tuple[Components, ...], groups: tuple[str, ...]):
    """All products of non-vanishing components whose letters agree, with the letters' values."""
    shared = sorted(set(groups[0]) & set(groups[-1])) if len(groups) == 2 else []
    table: dict[Index, list[tuple[dict[str, int], tuple[Element, ...]]]] = defaultdict(list)
    if len(groups) == 2:
        for values, element in _assignments(factors[1], groups[1]):
            table[tuple([values[letter] for letter in shared])].append((values, (element,)))
    else:
        table[()].append(({}, ()))
    for values, element in _assignments(factors[0], groups[0]):
        for others, rest in table.get(tuple([values[letter] for letter in shared]), ()):
            yield {**values, **others}, (element, *rest)


def _assignments(components: Components, letters: str):
    """Each non-vanishing component with the values of its letters; a letter twice must agree."""
    for index, element in components.nonzero.items():
        values: dict[str, int] = {}
        if all(values.setdefault(letter, k) == k for letter, k in zip(letters, index, strict=True)):
            yield values, element


def _summed(field: Field, collected: dict[Index, list], result: Components) -> dict[Index, Element]:
    """Sum the collected terms, only at representative indices not known yet."""
    return {i: field.sum(terms) for i, terms in collected.items() if result.pending(i)}

"""Components: sparse arrays of exact elements, each computed on first use; products and inverses.

If a symmetry makes components equal up to sign, only one of them is computed.
"""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import cache
from itertools import combinations, permutations, product
from typing import Any

from geomtorsion.exact import Element, Field
from geomtorsion.exact.element import inside_out
from geomtorsion.support.caching import cached_property
from geomtorsion.support.exclusive import exclusive, unlocked

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
    None for the identity.
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
    canonical: dict[Index, tuple[int, Index]] = {}
    members: dict[Index, Sequence[Index]] = {}
    if symmetry == alternating(rank):
        # The group of a form in seven dimensions has 5040 elements: sorting is shorter.
        for index in product(range(dimension), repeat=rank):
            first = tuple(sorted(index))
            differ = len(set(index)) == rank
            canonical[index] = ((-1 if is_odd(index) else 1) if differ else 0, first)
        members = {
            first: tuple(permutations(first)) for first in combinations(range(dimension), rank)
        }
        return Orbits(canonical, tuple(members), members)
    elements = _group(rank, symmetry)
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
    signs: dict[tuple[int, ...], int] = {tuple(range(rank)): 1}
    waiting = list(signs.items())
    elements = []
    while waiting:
        order, sign = waiting.pop()
        elements.append((order, sign))
        for step, step_sign in symmetry:
            image = tuple(order[k] for k in step)
            if image not in signs:
                signs[image] = sign * step_sign
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
    """The same symmetry for the later slots after new slots were added in front.

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


Rule = Callable[[Index], Element]
Row = tuple[tuple[int, Element], ...]


@exclusive
class Components:
    """Sparse array with a symmetry; a component that vanishes is the zero of the field.

    field: the exact field of the components.
    rule: index -> Element, called once for each representative index and only when needed.
    bulk: all representatives at once, where that is cheaper than one by one.
    source: the array that bulk takes whole.
    """

    def __init__(
        self,
        field: Field,
        rank: int,
        dimension: int,
        rule: Rule,
        symmetry: Symmetry = (),
        bulk: Callable[[], Mapping[Index, Element]] | None = None,
        source: Components | None = None,
    ) -> None:
        self.field = field
        self.rank = rank
        self.dimension = dimension
        self.symmetry = symmetry
        self._rule = rule
        self._bulk = bulk
        self._source = source
        self._orbits = orbits(rank, dimension, symmetry)
        self._canonical = self._orbits.canonical
        self._known: dict[Index, Element] = {}
        # Components found to vanish, from which the certainty of each zero is estimated.
        self.zeros: dict[Index, Element] = {}
        # Undecided components: they are kept like nonzero ones.
        self.open: dict[Index, Element] = {}

    @classmethod
    def known(
        cls,
        field: Field,
        rank: int,
        dimension: int,
        values: Mapping[Index, Element],
        symmetry: Symmetry = (),
    ) -> Components:
        """Array whose representatives are all given; components not listed vanish."""
        verdicts = {index: value.is_zero for index, value in values.items()}
        nonzero = {index: value for index, value in values.items() if not verdicts[index]}
        components = cls(
            field,
            rank,
            dimension,
            lambda index: nonzero.get(index, field.zero),
            symmetry,
            lambda: nonzero,
        )
        components.zeros.update(
            (i, x) for i, x in values.items() if i not in nonzero and x is not field.zero
        )
        components.open.update((i, value) for i, value in nonzero.items() if verdicts[i] is None)
        return components

    @classmethod
    def placed(
        cls,
        field: Field,
        rank: int,
        dimension: int,
        values: Mapping[Index, Element],
        symmetry: Symmetry = (),
    ) -> Components:
        """Array of values at any index of each orbit; one value per orbit is kept."""
        probe = cls.known(field, rank, dimension, {}, symmetry)
        by_representative: dict[Index, Element] = {}
        for index, value in values.items():
            sign, representative = probe.representative(index)
            if sign:
                by_representative[representative] = value if sign > 0 else -value
        return cls.known(field, rank, dimension, by_representative, symmetry)

    def __repr__(self) -> str:
        return f"Components(rank={self.rank}, dimension={self.dimension})"

    def mapped(self, field: Field, change: Callable[[Index, Element], Element]) -> Components:
        """Each nonzero component changed, when it is first read; the symmetry stays.

        field: the field of the changed components.
        """

        def rule(index: Index) -> Element:
            value = self.get(index)
            return field.zero if value is self.field.zero else change(index, value)

        return Components(field, self.rank, self.dimension, rule, self.symmetry)

    @unlocked
    def get(self, index: Index) -> Element:
        """One component; the zero of the field where it vanishes."""
        try:
            return self._known[index]
        except KeyError:
            return self._compute(index)

    @exclusive
    def _compute(self, index: Index) -> Element:
        """Evaluate the rule at a representative, derive the rest from it; the value is cached."""
        zero = self.field.zero
        canonical = self._canonical
        sign, representative = (1, index) if canonical is None else canonical[index]
        if sign == 0:
            value = zero
        elif representative != index:
            value = self.get(representative)
            if sign < 0:
                value = -value
        elif "independent" in self.__dict__:
            # All representatives are known by now: components not listed vanish.
            value = self.independent.get(index, zero)
        else:
            value = self._rule(index)
            if self._vanishes(index, value):
                value = zero
        self._known[index] = value
        return value

    @cached_property
    def independent(self) -> dict[Index, Element]:
        """The components at representative indices that are not known to vanish."""
        if self._bulk is not None:
            for array in inside_out(self, _sources, _is_filled):
                if array is not self:
                    _ = array.nonzero
            # Components computed before are not computed again.
            zero = self.field.zero
            components = {i: v for i, v in self._known.items() if v is not zero and self._is_own(i)}
            components |= {i: x for i, x in self._bulk().items() if not self._vanishes(i, x)}
            self._known.update(components)
            # The order does not depend on which were computed before.
            return dict(sorted(components.items()))
        components, cached, zero = {}, self._known, self.field.zero
        for index in self._orbits.representatives:
            value = cached[index] if index in cached else self._compute(index)
            if value is not zero:
                components[index] = value
        return components

    def _vanishes(self, index: Index, value: Element) -> bool:
        """Whether a component is known to vanish; a verdict that needs a reason is noted."""
        if value is self.field.zero:
            return True
        verdict = value.is_zero
        if verdict:
            self.zeros[index] = value
        elif verdict is None:
            self.open[index] = value
        return verdict is True

    @cached_property
    def undecided(self) -> dict[Index, Element]:
        """Independent components for which it is not known whether they vanish."""
        return {index: x for index, x in self.independent.items() if index in self.open}

    @cached_property
    def support(self) -> tuple[Index, ...]:
        """Indices of all components not known to vanish, in order; no value is negated for it."""
        members = self._orbits.members
        return tuple(sorted([index for first in self.independent for index in members[first]]))

    @cached_property
    def nonzero(self) -> dict[Index, Element]:
        """All components that are not known to vanish, in order of their indices."""
        cached, orbits = self._known, self._orbits
        components: dict[Index, Element] = {}
        for first, value in self.independent.items():
            for index in orbits.members[first]:
                at = cached.get(index)
                if at is None:
                    at = cached[index] = value if orbits.of(index)[0] > 0 else -value
                components[index] = at
        return dict(sorted(components.items()))

    @cached_property
    def rows(self) -> tuple[Row, ...]:
        """Rows of a matrix: for each first index the nonzero pairs (second index, element)."""
        rows: list[list[tuple[int, Element]]] = [[] for _ in range(self.dimension)]
        for (i, j), value in self.nonzero.items():
            rows[i].append((j, value))
        return tuple(map(tuple, rows))

    @cached_property
    def columns(self) -> tuple[Row, ...]:
        """Columns of a matrix: for each second index the pairs (first index, element)."""
        columns: list[list[tuple[int, Element]]] = [[] for _ in range(self.dimension)]
        for (i, j), value in self.nonzero.items():
            columns[j].append((i, value))
        return tuple(map(tuple, columns))

    @property
    def length(self) -> float:
        """How many terms the independent components have in all (see `Element.length`)."""
        return sum(value.length for value in self.independent.values())

    @property
    def computed(self) -> int:
        """How many components have been computed so far."""
        return len(self._known)

    @unlocked
    def representative(self, index: Index) -> tuple[int, Index]:
        """Sign and representative of an index; sign 0 where symmetry makes it vanish."""
        return self._orbits.of(index)

    @unlocked
    def pending(self, index: Index) -> bool:
        """Whether a bulk computation has to supply this component."""
        return self._is_own(index) and index not in self._known

    def _is_own(self, index: Index) -> bool:
        """Whether an index is its own representative."""
        return self._orbits.of(index) == (1, index)


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

    def rule(index: Index) -> Element:
        head, tail = index[:slot], index[after:]
        return field.sum([(1, x, get((*head, old, *tail))) for old, x in rows[index[slot]]])

    def bulk() -> dict[Index, Element]:
        collected: dict[Index, list] = defaultdict(list)
        for index, value in components.nonzero.items():
            head, tail = index[:slot], index[after:]
            for new, factor in columns[index[slot]]:
                collected[(*head, new, *tail)].append((1, factor, value))
        return _summed(field, collected, result)

    result = Components(
        field, components.rank, components.dimension, rule, symmetry, bulk, source=components
    )
    return result


def _sources(components: Components) -> tuple[Components, ...]:
    """The array that is filled before another."""
    source = components._source
    return () if source is None else (source,)


def _is_filled(components: Components) -> bool:
    return "nonzero" in components.__dict__


def joined(
    field: Field,
    factors: tuple[Components, ...],
    groups: tuple[str, ...],
    wanted: str,
    symmetry: Symmetry,
) -> Components:
    """Product of one or two arrays, summed over all other letters."""
    summed = [letter for letter in dict.fromkeys("".join(groups)) if letter not in wanted]
    everything = list(wanted) + summed
    places = [[everything.index(letter) for letter in group] for group in groups]
    dimension, zero = factors[0].dimension, field.zero

    def rule(index: Index) -> Element:
        terms = []
        for inner in product(range(dimension), repeat=len(summed)):
            values = index + inner
            elements = []
            for factor, place in zip(factors, places, strict=True):
                value = factor.get(tuple([values[k] for k in place]))
                # A factor that multiplies zero is not computed.
                if value is zero:
                    break
                elements.append(value)
            else:
                terms.append((1, *elements))
        return field.sum(terms)

    def bulk() -> dict[Index, Element]:
        collected: dict[Index, list] = defaultdict(list)
        for values, product_ in _matches(factors, groups):
            collected[tuple([values[letter] for letter in wanted])].append((1, *product_))
        return _summed(field, collected, result)

    result = Components(field, len(wanted), dimension, rule, symmetry, bulk)
    return result


def _matches(
    factors: tuple[Components, ...], groups: tuple[str, ...]
) -> Iterator[tuple[dict[str, int], tuple[Element, ...]]]:
    """All products of non-vanishing components whose letters agree, with the letters' values."""
    # The second factor is sorted by its shared letters: zeros are then never met.
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


def _assignments(components: Components, letters: str) -> Iterator[tuple[dict[str, int], Element]]:
    """Each non-vanishing component with the values of its letters; a letter twice must agree."""
    for index, element in components.nonzero.items():
        values: dict[str, int] = {}
        if all(values.setdefault(letter, k) == k for letter, k in zip(letters, index, strict=True)):
            yield values, element


def _summed(field: Field, collected: dict[Index, list], result: Components) -> dict[Index, Element]:
    """Sum the collected terms, only at representative indices not known yet."""
    return {i: field.sum(terms) for i, terms in collected.items() if result.pending(i)}


Entries = Mapping[Any, Element]
Pair = tuple[int, int, Element]


def blocks(entries: Entries, n: int) -> list[tuple[list[int], list[int]]]:
    """Independent blocks of a matrix up to permutation: pairs (rows, columns)."""
    columns_of: dict[int, list[int]] = defaultdict(list)
    rows_of: dict[int, list[int]] = defaultdict(list)
    for i, j in entries:
        columns_of[i].append(j)
        rows_of[j].append(i)
    pairs = []
    seen: set[int] = set()
    for start in range(n):
        if start in seen:
            continue
        rows, columns, waiting = {start}, set(), [start]
        while waiting:
            for j in columns_of[waiting.pop()]:
                if j not in columns:
                    columns.add(j)
                    new = set(rows_of[j]) - rows
                    rows |= new
                    waiting.extend(new)
        seen |= rows
        pairs.append((sorted(rows), sorted(columns)))
    return pairs


def _minors(
    field: Field, entries: Entries, rows: Sequence[int], columns: Sequence[int]
) -> dict[int, Element]:
    """Minors of all given rows, by the bit mask of their columns (Laplace, row by row)."""
    # Minors of the first rows are shared by all that follow: 2^n products, not n!.
    minors = {0: field.one}
    for row in rows:
        collected: dict[int, list] = defaultdict(list)
        for mask, minor in minors.items():
            for place, column in enumerate(columns):
                bit = 1 << place
                entry = entries.get((row, column))
                if mask & bit or entry is None:
                    continue
                sign = -1 if (mask >> place).bit_count() % 2 else 1
                collected[mask | bit].append((sign, minor, entry))
        summed = {mask: field.sum(terms) for mask, terms in collected.items()}
        minors = {mask: value for mask, value in summed.items() if not value.is_zero}
    return minors


def is_odd(order: Sequence[int]) -> bool:
    """Whether a permutation, given as a list of distinct numbers, is odd."""
    inversions = sum(
        order[i] > order[j] for i in range(len(order)) for j in range(i + 1, len(order))
    )
    return inversions % 2 == 1


def determinant(field: Field, entries: Entries, n: int) -> Element:
    """Determinant, block by block."""
    result = field.one
    row_order: list[int] = []
    column_order: list[int] = []
    for rows, columns in blocks(entries, n):
        if len(rows) != len(columns):
            return field.zero
        minor = _minors(field, entries, rows, columns).get((1 << len(rows)) - 1)
        if minor is None:
            return field.zero
        result = result * minor
        row_order += rows
        column_order += columns
    return -result if is_odd(row_order) != is_odd(column_order) else result


def inverse(field: Field, entries: Entries, n: int) -> dict[tuple[int, int], Element]:
    """Inverse of a regular matrix, block by block, by cofactors."""
    inverted: dict[tuple[int, int], Element] = {}
    for rows, columns in blocks(entries, n):
        size = len(rows)
        if size == 1:
            i, j = rows[0], columns[0]
            inverted[j, i] = field.inverse(entries[i, j], briefly=True)
            continue
        everything = (1 << size) - 1
        cofactors: dict[tuple[int, int], Element] = {}
        for r, row in enumerate(rows):
            others = rows[:r] + rows[r + 1 :]
            for mask, minor in _minors(field, entries, others, columns).items():
                c = (everything ^ mask).bit_length() - 1
                cofactors[row, columns[c]] = -minor if (r + c) % 2 else minor
        # The determinant along the first row costs nothing more: its cofactors are there.
        first = rows[0]
        det = field.sum(
            [
                (1, entries[first, j], cofactors[first, j])
                for j in columns
                if (first, j) in cofactors and (first, j) in entries
            ]
        )
        reciprocal = field.inverse(det, briefly=True)
        for (i, j), cofactor in cofactors.items():
            inverted[j, i] = cofactor * reciprocal
    return inverted


def pairs_of_inverse(
    field: Field, entries: Entries, inverted: Entries, n: int
) -> dict[tuple[int, int], tuple[Element, list[Pair]]]:
    """E_i^a E_j^b - E_i^b E_j^a of the inverse E[a, i], for i < j: a factor, (a, b, value), a < b.

    Such a minor of the inverse is, up to its sign, the minor of all other rows and columns over the
    determinant (Jacobi): no square of the determinant is left that would cancel. The factor is
    1 over the determinant of a block; the values are to be multiplied by it.
    """
    pairs: dict[tuple[int, int], tuple[Element, list[Pair]]] = {}
    single: list[list[tuple[int, int, Element]]] = []
    for rows, columns in blocks(entries, n):
        everything = (1 << len(rows)) - 1
        whole = _minors(field, entries, rows, columns)[everything]
        reciprocal = field.inverse(whole, briefly=True) if len(rows) > 1 else field.one
        for r, s in combinations(range(len(rows)), 2):
            others = [row for k, row in enumerate(rows) if k not in (r, s)]
            minors: list[Pair] = []
            for mask, minor in _minors(field, entries, others, columns).items():
                c, d = (k for k in range(len(rows)) if not mask >> k & 1)
                value = -minor if (r + s + c + d) % 2 else minor
                minors.append((columns[c], columns[d], value))
            pairs[rows[r], rows[s]] = (reciprocal, minors)
        own = [(i, a) for i in rows for a in columns if (a, i) in inverted]
        single.append([(i, a, inverted[a, i]) for i, a in own])
    for firsts, seconds in combinations(single, 2):
        for i, a, first in firsts:
            for j, b, second in seconds:
                sign = 1 if (i < j) == (a < b) else -1
                place = (min(i, j), max(i, j))
                value = field.sum([(sign, first, second)])
                products = pairs.setdefault(place, (field.one, []))[1]
                products.append((min(a, b), max(a, b), value))
    return pairs


def dependence(field: Field, entries: Entries, n: int) -> dict[int, Element] | None:
    """Coefficients c_i with sum_i c_i row_i = 0, the last of them 1; None for a regular matrix."""
    done: list[tuple[int, dict[int, Element], dict[int, Element]]] = []
    for i in range(n):
        row = {j: entries[i, j] for j in range(n) if (i, j) in entries}
        combination = {i: field.one}
        for pivot, pivot_row, others in done:
            if pivot not in row:
                continue
            factor = row[pivot] / pivot_row[pivot]
            row = minus(field, row, pivot_row, factor)
            combination = minus(field, combination, others, factor)
        if not row:
            return combination
        done.append((min(row), row, combination))
    return None


def minus(
    field: Field, first: Mapping[int, Element], second: Mapping[int, Element], factor: Element
) -> dict[int, Element]:
    """first - factor * second, without zeros."""
    difference = {}
    for key in {**first, **second}:
        terms = []
        if key in first:
            terms.append((1, first[key]))
        if key in second:
            terms.append((-1, factor, second[key]))
        value = field.sum(terms)
        if not value.is_zero:
            difference[key] = value
    return difference

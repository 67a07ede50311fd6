"""Writing: elements as short sympy expressions."""

from __future__ import annotations

from bisect import insort
from dataclasses import dataclass
from functools import cmp_to_key
from itertools import starmap
from operator import attrgetter
from typing import TYPE_CHECKING, Any

import sympy
from flint import fmpq

from geomtorsion.errors import AllowanceError, LimitError
from geomtorsion.exact.collecting import Collector
from geomtorsion.exact.element import in_order
from geomtorsion.exact.form import LONGEST_FACTORED, Form, Sum, form
from geomtorsion.exact.generators import Generator, Names
from geomtorsion.exact.independence import without_idle_symbols
from geomtorsion.exact.lengths import (
    check_sums,
    exponents,
    parts_at_least,
    short_of,
    terms_of,
    vanishes,
    written_length,
)
from geomtorsion.exact.limits import check_parts, check_written
from geomtorsion.exact.polynomials import as_fmpq
from geomtorsion.support.allowance import check_limits

if TYPE_CHECKING:
    from collections.abc import Iterable, Sequence

    from geomtorsion.exact.element import Element


_ORDER = cmp_to_key(sympy.Basic.compare)
_SHOWN = attrgetter("shown")


@dataclass(frozen=True, eq=False, slots=True)
class Part:
    """A factor as sympy writes it; as an object of its own it is found without sympy's hash.

    base: what sympy merges it by, as it does sqrt(x)*x or exp(x)*exp(y); None if it may merge with
        anything, as roots of numbers and products do.
    """

    shown: sympy.Expr
    base: sympy.Expr | None

    @classmethod
    def of(cls, shown: sympy.Expr) -> Part:
        """The part of an expression."""
        base = shown if shown is sympy.I else shown.as_base_exp()[0]
        return cls(shown, None if base.is_Number or shown.is_Mul else base)


# Stands for all products where parts of different kinds are put in order.
_A_PRODUCT = Part.of(sympy.Mul(2, sympy.Symbol("x")))


class Parts:
    """Parts of the expressions of a field, each made once.

    collector: how sums are collected where that is shorter (see `collecting`), if they are.
    """

    def __init__(self, collector: Collector | None = None) -> None:
        self.collector: Collector | None = collector
        # Whether a part of a product may be a product itself, as sums with names are.
        self.has_names: bool = collector is not None and bool(collector.names)
        # Kept elements that are written, by their identity, with the elements.
        self.built: dict[int, tuple[Element, sympy.Expr]] = {}
        self._powers: dict[tuple[Generator | Sum, int], Part] = {}
        self._exponentials: dict[tuple[tuple[Generator, int], ...], Part] = {}
        self._sizes: dict[Generator | Sum, int] = {}
        self._numbers: dict[fmpq, Part] = {}
        self._places: dict[Part, int] = {_A_PRODUCT: 0}

    def written(self, element: Element) -> sympy.Expr:
        """An element that is multiplied out."""
        return element.sympy if self.collector is None else _of_form(self, form(element))

    def length(self, element: Element) -> int:
        """How long an element is, multiplied out: its terms, or its parts where it is collected."""
        if self.collector is None:
            return written_length(element)
        return self.collector.parts_of(form(element))

    def size(self, base: Generator | Sum) -> int:
        """Number of names and numbers in a generator or in a sum as written."""
        if base in self._sizes:
            return self._sizes[base]
        if isinstance(base, Generator):
            count = sum(not part.args for part in sympy.preorder_traversal(self._root(base)))
        else:
            collected = self.collector.collected(base) if self.collector else None
            terms = (
                base.terms if collected is None else [(x.coefficient, x.powers) for x in collected]
            )
            count = sum(self._size_of_product(value, powers) for value, powers in terms)
        self._sizes[base] = count
        return count

    def _size_of_product(self, value: fmpq, powers: Iterable[tuple[Generator | Sum, int]]) -> int:
        inside = sum(self.size(base) + exponents(base, power) for base, power in powers)
        return inside + 1 if abs(value) != 1 or not inside else inside

    def power(self, base: Generator | Sum, exponent: int) -> Part:
        """base**exponent."""
        part = self._powers.get((base, exponent))
        if part is None:
            plain = self._root(base) if isinstance(base, Generator) else _sum(self, base)
            part = Part.of(plain if exponent == 1 else plain**exponent)
            self._powers[base, exponent] = part
        return part

    def exponential(self, powers: tuple[tuple[Generator, int], ...]) -> Part:
        """The product of powers of exponentials, joined in one."""
        part = self._exponentials.get(powers)
        if part is None:
            exponents = (exponent * base.shown.args[0] for base, exponent in powers)
            part = self._exponentials[powers] = Part.of(sympy.exp(sympy.Add(*exponents)))
        return part

    def _root(self, base: Generator) -> sympy.Expr:
        """A generator as it is shown; the radicand of a root by names, if there are any."""
        if not self.has_names or base.kind != "root" or base.tail is None or base.argument:
            return base.shown
        return _of_form(self, form(base.tail)) ** sympy.Rational(1, base.degree)

    def number(self, value: fmpq) -> Part:
        """A coefficient."""
        part = self._numbers.get(value)
        if part is None:
            part = self._numbers[value] = Part.of(_number(value))
        return part

    def order(self, parts: Iterable[Part]) -> dict[Part, int]:
        """The places, including the places of the parts."""
        new = dict.fromkeys(part for part in parts if part not in self._places)
        if new:
            ordered = list(self._places)
            for part in new:
                check_limits()
                insort(ordered, part, key=_compared)
            self._places = {part: k for k, part in enumerate(ordered)}
        return self._places


def _compared(part: Part) -> Any:
    return _ORDER(part.shown)


def to_sympy(element: Element) -> sympy.Expr:
    """The element in its short form: factored, radicals and sin**2 restored."""
    if element.is_kept:
        return _as_built(element, element._field.tables.setdefault("parts", Parts()))
    if not element._field.all_sure and element.is_zero:
        return sympy.S.Zero
    written = form(element)
    # Equal elements, which are often different objects, have one form.
    written_forms = element._field.tables.setdefault("written", {})
    expression = written_forms.get(written)
    if expression is None:
        parts = element._field.tables.setdefault("parts", Parts())
        expression = written_forms[written] = _of_form(parts, written)
    return expression


def shortest(element: Element, names: Names = ()) -> sympy.Expr:
    """The element with its sums collected, or as `to_sympy` has it, whichever has fewer parts.

    names: quantities that may be written by their names.
    """
    parts_by_names = element._field.tables.setdefault("collected parts", {})
    if names not in parts_by_names:
        parts_by_names[names] = Parts(Collector(names))
    parts = parts_by_names[names]
    whole = short_of(element) if element.is_kept else element
    if whole is None:
        return _short_as_built(element, parts)
    plain = element.sympy
    return min(plain, _of_form(parts, form(whole)), key=_size) if plain else plain


def _short_as_built(element: Element, parts: Parts) -> sympy.Expr:
    """A long element that is kept, its sums collected on request or if too long."""
    if parts.has_names:
        return _as_built(element, parts)
    # Collecting takes longer than it helps: hundreds of sums that nobody reads to the end.
    try:
        return element.sympy
    except AllowanceError:
        raise
    except LimitError:
        return _by_parts(element, parts)


def _size(shown: sympy.Expr) -> int:
    """How many parts an expression has."""
    return sum(1 for _ in sympy.preorder_traversal(shown))


def _of_form(known: Parts, written: Form) -> sympy.Expr:
    """The expression of a form."""
    if known.has_names:
        return _with_names(known, written)
    return _product(known, written.coefficient, _factors(known, written.powers))


def _with_names(known: Parts, written: Form) -> sympy.Expr:
    """The expression of a form with factors that are products of names."""
    shown = [part.shown for part in _factors(known, written.powers)]
    product = sympy.Mul(_number(written.coefficient), *shown)
    number, rest = product.as_coeff_Mul()
    # -(b - a) reads better as a - b.
    for part in sympy.Mul.make_args(rest) if number < 0 else ():
        if part.is_Add and 2 * sum(x.could_extract_minus_sign() for x in part.args) == len(
            part.args
        ):
            return sympy.Mul(-number, *(-x if x is part else x for x in sympy.Mul.make_args(rest)))
    return product


def _as_built(element: Element, parts: Parts) -> sympy.Expr:
    """A kept element without symbols that drop out of it, or else by its parts."""
    reduced = without_idle_symbols(element)
    return _by_parts(element, parts) if reduced is None else parts.written(reduced)


def _by_parts(element: Element, parts: Parts) -> sympy.Expr:
    """A kept element: each part multiplied out or as it was built, whichever is shorter."""
    if element.is_zero:
        return sympy.S.Zero
    chosen: dict[int, Element] = {}
    lengths: dict[int, int] = {}

    def length(part: Element) -> int:
        if id(part) not in lengths:
            lengths[id(part)] = parts.length(part)
        return lengths[id(part)]

    whole = short_of(element)
    # The built form has at least one part for each of its terms.
    if whole is not None and parts.length(whole) <= len(list(terms_of(element))):
        return parts.written(whole)
    check_sums(element, parts.size)

    def is_counted(part: Element) -> bool:
        if id(part) not in lengths and vanishes(part):
            lengths[id(part)] = 0
        return id(part) in lengths

    for node in in_order(element, is_counted):
        recipe = node._recipe
        built = sum(length(part) for part in recipe.parts)
        short = short_of(node)
        if short is not None and length(short) <= built:
            chosen[id(node)] = short
            built = length(short)
        lengths[id(node)] = built
    least = parts_at_least(element, chosen, parts.size)
    check_parts(least, f"more than {least:,}")
    # A form that is too long is not kept, so that the next request is refused again.
    expressions: dict[int, tuple[Element, sympy.Expr]] = {}

    def known(part: Element) -> sympy.Expr | None:
        if not part.is_kept:
            return parts.written(part)
        if id(part) not in expressions and vanishes(part):
            expressions[id(part)] = part, sympy.S.Zero
        if id(part) in chosen and id(part) not in expressions:
            expressions[id(part)] = part, parts.written(chosen[id(part)])
        entry = expressions.get(id(part)) or parts.built.get(id(part))
        if entry is None:
            return part._sympy if parts.collector is None else None
        return entry[1]

    def text(part: Element) -> sympy.Expr:
        expr = known(part)
        assert expr is not None
        return expr

    for node in in_order(element, lambda x: known(x) is not None):
        recipe = node._recipe
        terms = [(_number(as_fmpq(c)), [text(x) for x in xs]) for c, *xs in recipe.terms]
        # A part that vanishes, as X - X/2 - X/2 does, takes its products with it.
        left = [term for term in terms if not any(x is sympy.S.Zero for x in term[1])]
        whole_sum = _sum_of(left) if left else sympy.S.Zero
        expressions[id(node)] = node, sympy.Pow(whole_sum, -1) if recipe.below else whole_sum
    written = text(element)
    check_written(written)
    if parts.collector is None:
        for part, shown in expressions.values():
            part._sympy = shown
    else:
        parts.built.update(expressions)
    return written


def _sum_of(terms: list[tuple[sympy.Expr, list[sympy.Expr]]]) -> sympy.Expr:
    """A sum of (number, factors) with what all terms have in common in front."""
    split = [_powers_of(value, factors) for value, factors in terms]
    bases = [powers for _, powers in split]
    # Mostly powers of one determinant in denominators.
    common = {
        base: min(powers[base] for powers in bases)
        for base in bases[0]
        if all(base in powers for powers in bases)
    }
    if len(split) == 1:
        ((value, powers),) = split
        return _written_product(value, powers)
    rest = [
        _written_product(value, {base: e - common.get(base, 0) for base, e in powers.items()})
        for value, powers in split
    ]
    inside = sympy.Add._from_args(rest)
    return _written_product(sympy.S.One, {**common, inside: 1}) if common else inside


def _powers_of(
    value: sympy.Expr, factors: list[sympy.Expr]
) -> tuple[sympy.Expr, dict[sympy.Expr, int]]:
    """value * factors as a number and powers of bases."""
    powers: dict[sympy.Expr, int] = {}
    for factor in factors:
        for part in sympy.Mul.make_args(factor):
            if part.is_Rational:
                value = value * part
                continue
            base, exponent = part.as_base_exp()
            if not exponent.is_Integer:
                base, exponent = part, sympy.S.One
            powers[base] = powers.get(base, 0) + int(exponent)
    return value, powers


def _written_product(value: sympy.Expr, powers: dict[sympy.Expr, int]) -> sympy.Expr:
    """value * product of base**exponent, as they are."""
    shown = [base if e == 1 else sympy.Pow(base, e) for base, e in powers.items() if e]
    if not shown or not value:
        return value
    if value != 1:
        shown.insert(0, value)
    return shown[0] if len(shown) == 1 else sympy.Mul._from_args(shown, is_commutative=True)


def _number(value: fmpq) -> sympy.Expr:
    return sympy.Rational(int(value.p), int(value.q)) if value.q != 1 else sympy.Integer(int(value))


def _stay_apart(factors: list[Part]) -> bool:
    """Whether sympy merges none of the factors of a product."""
    bases = {factor.base for factor in factors}
    return len(bases) == len(factors) and not any(base is None for base in bases)


def _product(known: Parts, value: fmpq, factors: list[Part]) -> sympy.Expr:
    """value * factors; where none merge, without sympy's search for like bases."""
    if not factors:
        return _number(value)
    if value == 1 and len(factors) == 1:
        return factors[0].shown
    number = known.number(value)
    # sympy distributes a number over a lone sum; then its own product is taken.
    if not _stay_apart(factors) or (len(factors) == 1 and factors[0].shown.is_Add):
        return sympy.Mul(number.shown, *[factor.shown for factor in factors])
    return _in_order(number, sorted(factors, key=known.order(factors).__getitem__))


def _factors(known: Parts, powers: Sequence[tuple[Generator | Sum, int]]) -> list[Part]:
    """base**exponent of each; exponentials of numbers and functions are joined in one."""
    exponentials: list[tuple[Generator, int]] = []
    others: list[tuple[Generator | Sum, int]] = []
    for base, exponent in powers:
        # The number e is a generator of this kind, but not an exp.
        if isinstance(base, Generator) and base.kind == "exp" and isinstance(base.shown, sympy.exp):
            exponentials.append((base, exponent))
        else:
            others.append((base, exponent))
    if len(exponentials) < 2:
        return list(starmap(known.power, powers))
    return [*starmap(known.power, others), known.exponential(tuple(exponentials))]


def _sum(known: Parts, base: Sum) -> sympy.Expr:
    """A sum of monomials, or what they are collected to."""
    if known.collector is not None and (forms := known.collector.collected(base)) is not None:
        total = sympy.Add(*(_of_form(known, one) for one in forms))
        # A sum over numbers that it shared with others may share one with its own terms, then.
        return _shared_number_out(total) if known.has_names else total
    split = list[tuple[Part, list[Part]]]()
    for x, powers in base.terms:
        split.append((known.number(x), _factors(known, powers)))
    if not all(_stay_apart(factors) for _, factors in split):
        products = zip(base.terms, split, strict=True)
        return sympy.Add(*(_product(known, x, factors) for (x, _), (_, factors) in products))
    # sympy's order of all that occurs gives the order within every product and of the products.
    place = known.order(part for number, factors in split for part in (number, *factors))
    terms = [_plain_product(number, factors, place) for number, factors in split]
    # Longer sums stay in their own order.
    if len(terms) <= LONGEST_FACTORED:
        terms.sort(key=lambda term: term[0])
    return sympy.Add._from_args([term for _, term in terms], is_commutative=True)


def _shared_number_out(shown: sympy.Expr) -> sympy.Expr:
    """3*a + 6*b as 3*(a + 2*b)."""
    number, rest = shown.primitive()
    return shown if number == 1 else sympy.Mul(number, rest, evaluate=False)


def _plain_product(
    number: Part, factors: list[Part], place: dict[Part, int]
) -> tuple[tuple[int, ...], sympy.Expr]:
    """A product whose factors stay apart, and what sympy orders it by: numbers first."""
    if not factors:
        return (-1,), number.shown
    if number.shown is sympy.S.One and len(factors) == 1:
        return (place[factors[0]],), factors[0].shown
    ordered = sorted(factors, key=place.__getitem__)
    counted = ordered if number.shown is sympy.S.One else [number, *ordered]
    key = (place[_A_PRODUCT], len(counted), *[place[part] for part in counted])
    return key, _in_order(number, ordered)


def _in_order(number: Part, factors: list[Part]) -> sympy.Expr:
    """number * factors, which are in sympy's order."""
    shown = list(map(_SHOWN, factors))
    if number.shown is not sympy.S.One:
        shown.insert(0, number.shown)
    return sympy.Mul._from_args(shown, is_commutative=True)

"""Tower: the arithmetic of a differential field, built generator upon generator.

Elements are polynomials over registered irreducible factors, in a polynomial ring that grows.
`Tower` is abstract: `Field` reads, differentiates, takes roots and writes.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from dataclasses import replace
from fractions import Fraction
from math import prod
from typing import TYPE_CHECKING, Any, Protocol

import sympy
from flint import Ordering, fmpq, fmpq_mpoly_ctx
from flint.utils.flint_exceptions import DomainError

from geomtorsion.errors import ExpressionError
from geomtorsion.exact import limits, polynomials
from geomtorsion.exact.element import Canonical, Denominator, Element, occurring
from geomtorsion.exact.generators import Branch, Generator, Generators, Names
from geomtorsion.exact.kept import kept
from geomtorsion.exact.polynomials import as_fmpq, factored, known_taken_out
from geomtorsion.support.allowance import check_limits
from geomtorsion.support.exclusive import exclusive

if TYPE_CHECKING:
    from collections.abc import Iterable, Mapping

    import mpmath
    from flint import fmpq_mpoly

    from geomtorsion.exact.element import Certainty, Value
    from geomtorsion.exact.generic_point import Places
    from geomtorsion.exact.polynomials import Factors


class Point(Protocol):
    """The generic point of a field, at which signs are read off; see `generic_point`."""

    @property
    def places(self) -> Places:
        """Where the point may be."""
        ...

    @property
    def values(self) -> dict[sympy.Expr, Any]:
        """The values of symbols at the point."""
        ...

    @property
    def given(self) -> dict[sympy.Expr, Any]:
        """The values that were given; empty where the point was searched."""
        ...

    def number_of(self, shown: sympy.Expr) -> mpmath.mpf:
        """The value of a symbol, or of an unknown function or its derivative."""
        ...

    def value(self, element: Element) -> mpmath.mpf:
        """The value of an element, to about 90 digits."""
        ...

    def is_positive(self, element: Element) -> bool:
        """Whether an element is positive; the answer binds the point."""
        ...

    def prefer_positive(self, element: Element) -> bool:
        """Whether an element is positive, after the point moved there if it may."""
        ...

    def sign(self, element: Element) -> int | None:
        """+1 or -1, or None where the declared domain has both signs."""
        ...

    def is_surely_nonzero(self, element: Element) -> bool:
        """Whether an element has a value that is not zero."""
        ...

    def place_in_words(self) -> str:
        """The point, for stating where a branch was chosen."""
        ...


class Tower(ABC):
    """Numerators, factored denominators and generators with their relations.

    chosen: values of roots that the user chose; rooted: denominators before roots were cleared.
    generators: the newest first; by_name: the same by their names in the polynomial ring.
    all_sure: whether the independence of all generators is proved.
    meanings: what functions known by name are in terms of others, by the names of generators.
    generator_slopes, factor_slopes: known derivatives; tables: what other files keep, by names.
    """

    is_complex: bool
    chosen: dict[sympy.Expr, sympy.Expr]
    sample: Point

    def __init__(self) -> None:
        # Elements made before a generator was added stay valid: their level is the number of
        # variables in which they are written, and `lift` brings them up when they are needed.
        self.ctx: fmpq_mpoly_ctx = fmpq_mpoly_ctx.get((), Ordering.lex)
        self.level: int = 0
        # Denominators are kept as exponents of these: no gcd is ever needed in a sum.
        self.factors: list[fmpq_mpoly] = []
        self.factor_index: dict[str, int] = {}
        # The same denominators meet again and again; products and multiples of them are kept.
        self._merged: dict[tuple[Denominator, Denominator], Denominator] = {}
        self._lcms: dict[tuple[Denominator, Denominator], Denominator] = {}
        self._cofactors: dict[tuple[Denominator, Denominator], fmpq_mpoly] = {}
        self._cofactor_sizes: dict[tuple[Denominator, Denominator], int] = {}
        self._factored: dict[str, Factors] = {}
        self._algebraic: list[tuple[int, int, fmpq_mpoly]] = []
        self.zero: Element = Canonical(self, self.ctx.constant(0), (), 0)
        self.one: Element = Canonical(self, self.ctx.constant(1), (), 0)
        self.symbols: tuple[sympy.Symbol, ...] = ()
        self._symbol_elements: dict[sympy.Symbol, Element] = {}
        self.generators: list[Generator] = []
        self.by_name: dict[str, Generator] = {}
        self.all_sure: bool = True
        self.tables: dict[str, Any] = {}
        self.meanings: dict[str, Element] = {}
        self.rooted: list[Element] = []
        self._rooted_keys: set[Element] = set()
        self._branches: dict[sympy.Expr, Branch] = {}
        self._settled: tuple[Branch, ...] | None = None
        self.generator_slopes: dict[tuple[str, sympy.Symbol], Element] = {}
        self.factor_slopes: dict[tuple[int, sympy.Symbol], Element] = {}

    # What files made for it answer.
    @abstractmethod
    def read(self, expr: sympy.Expr | Fraction | int, where: str = "expression") -> Element:
        """Read one sympy expression, int or Fraction."""

    @abstractmethod
    def inverse(self, element: Element, briefly: bool = False) -> Element:
        """1 over an element; briefly: lazy where it would be long."""

    @abstractmethod
    def root(self, element: Element, order: int, radical: sympy.Expr | None = None, /) -> Element:
        """The root of an order, positive at the generic point."""

    @abstractmethod
    def derivative(self, element: Element, symbol: sympy.Symbol, /) -> Element:
        """The partial derivative of an element."""

    @abstractmethod
    def conjugate(self, element: Element) -> Element:
        """The complex conjugate."""

    @abstractmethod
    def decide_zero(self, element: Element) -> bool | None:
        """Whether a lazy element, or an element with generators that may be dependent, vanishes."""

    @abstractmethod
    def certainty(self, element: Element) -> Certainty:
        """Whether the answer of `is_zero` is proved, or the chance that it is wrong."""

    @abstractmethod
    def whole(self, element: Element) -> Element:
        """An element multiplied out, if that is within the limits of all products."""

    @abstractmethod
    def brief(self, element: Element) -> Element | None:
        """An element multiplied out, if that is cheap."""

    @abstractmethod
    def cleared(self, element: Element, largest: int) -> Element | None:
        """1 over an element, multiplied out; None if a product would be larger than the limit."""

    @abstractmethod
    def square_class(self, element: Element, roots: Generators) -> Generators | None:
        """The roots whose radicands make a square of an element, if there are any."""

    @abstractmethod
    def with_symbol(self, symbol: sympy.Symbol, value: Value) -> Tower:
        """A field over one more symbol, into which nothing is read yet."""

    @abstractmethod
    def written(self, element: Element, names: Names | None = None) -> sympy.Expr:
        """The element as a short sympy expression; with its sums collected if there are names."""

    @abstractmethod
    def value(
        self, element: Element, point: Mapping[Any, Value], precision: int, at: Any = None
    ) -> float | complex | mpmath.mpf:
        """The value of an element at a point."""

    @abstractmethod
    def to_json(self, element: Element) -> dict[str, Any]:
        """An element as a JSON-ready mapping."""

    def add(self, *added: Generator) -> Element:
        """Add generators, one after the other, and return the last as an element.

        Elements built from a generator whose independence is not proved are not proved either.
        """
        # In front, because with a lexicographic order a relation w**n = tail then reduces
        # w before all that its tail contains.
        new, by = [self._as_sure(generator) for generator in reversed(added)], len(added)
        ctx = fmpq_mpoly_ctx.get((*(g.name for g in new), *self.ctx.names()), Ordering.lex)
        # Factors are used far more often than numerators: they are lifted at once.
        factors = [polynomials.lifted(ctx, poly, by) for poly in self.factors]
        algebraic = []
        for place, generator in enumerate(new):
            if generator.tail is not None:
                w, tail = ctx.gen(place), self.lift(generator.tail)
                relation = w**generator.degree - polynomials.lifted(ctx, tail, by)
                for power, value in generator.middle:
                    relation = relation - w**power * value
                algebraic.append((place, generator.degree, relation))
        algebraic += [
            (position + by, degree, polynomials.lifted(ctx, relation, by))
            for position, degree, relation in self._algebraic
        ]
        generators = [*new, *self.generators]
        by_name = self.by_name | {generator.name: generator for generator in new}
        level, sure = self.level + by, self.all_sure and all(g.sure for g in new)
        # All at once and without a call: whoever interrupts finds the field before or after.
        self.ctx, self.level, self.factors, self._algebraic = ctx, level, factors, algebraic
        self.generators, self.by_name, self.all_sure = generators, by_name, sure
        self._cofactors, self._factored = {}, {}
        return Canonical(self, self.ctx.gen(0), (), self.level)

    def _as_sure(self, generator: Generator) -> Generator:
        """A generator; not sure if its relation or argument depends on unproved generators."""
        if self.all_sure:
            return generator
        argument = generator.argument
        parts = [generator.tail, *(argument if isinstance(argument, tuple) else (argument,))]
        built = (self.generators_of(part) for part in parts if isinstance(part, Element))
        sure = generator.sure and all(inner.sure for generators in built for inner in generators)
        return replace(generator, sure=sure)

    def add_root(
        self, tail: Element, order: int, sure: bool, base: tuple[Element, int] | None = None
    ) -> Element:
        """w with w**order = tail, added if new; base = (f, n): w is the n-th root of f."""
        for generator in self.generators:
            if generator.kind == "root" and generator.degree == order and generator.tail == tail:
                return self.generator_element(generator)
        shown = tail.sympy ** sympy.Rational(1, order)
        if base is not None:
            shown = base[0].sympy ** sympy.Rational(1, base[1])
        name = self.next_name("root")
        return self.add(
            Generator("root", name, shown, tail.symbols, order, tail, argument=base, sure=sure)
        )

    def next_name(self, kind: str) -> str:
        """A name for the next generator that no other has."""
        return f"{kind[:2]}{len(self.generators)}"

    @exclusive
    def rational(self, p: int | Fraction | fmpq, q: int = 1) -> Element:
        """The rational number p/q."""
        return Canonical(self, self.ctx.constant(as_fmpq(p) / q), (), self.level)

    def symbol(self, symbol: sympy.Symbol) -> Element:
        """A coordinate or parameter as an element.

        Raises
        ------
        ExpressionError
            the field has no such symbol.
        """
        element = self._symbol_elements.get(symbol)
        if element is None:
            raise ExpressionError(
                f"{symbol} is neither a coordinate nor a parameter here; "
                f"known are {', '.join(map(str, self.symbols)) or 'none'}"
            )
        return element

    @property
    @exclusive
    def imaginary(self) -> Element:
        """The imaginary unit."""
        if not self.is_complex:
            raise ExpressionError("I occurs in a real frame; declare it with complex=True")
        return self.generator_element(self.by_name["I"])

    @exclusive
    def generator_element(self, generator: Generator) -> Element:
        """A generator as an element."""
        return Canonical(self, self.ctx.gen(self.generators.index(generator)), (), self.level)

    def polynomial(self, poly: fmpq_mpoly) -> Element:
        """A polynomial of the present ring as an element."""
        return Canonical(self, self.reduced(poly), (), self.level)

    @property
    def branches(self) -> tuple[Branch, ...]:
        """The signs with which roots were read, where the symbols' assumptions left a choice."""
        return tuple(self._branches.values())

    def note_rooted(self, denominator: Element) -> None:
        """Note a denominator that contains roots, so that it can be written in its first form."""
        if denominator not in self._rooted_keys:
            self._rooted_keys.add(denominator)
            self.rooted.append(denominator)

    def state_branch(self, branch: Branch) -> None:
        """Note the sign with which a root was read."""
        self._branches.setdefault(branch.radical, branch)

    @property
    def relied_on(self) -> tuple[Branch, ...]:
        """The branches on which values of elements rely: all of them, or those when it settled."""
        return self.branches if self._settled is None else self._settled

    @exclusive
    def settle(self) -> None:
        """Fix the branches on which elements rely; later readings have other branches."""
        if self._settled is None:
            self._settled = self.branches

    @exclusive
    def generators_of(self, element: Element) -> list[Generator]:
        """The generators that occur in an element."""
        stored, newest = element._bits, len(self.generators) - 1
        bits = occurring(self, element) if stored is None else stored
        return [g for k, g in enumerate(self.generators) if bits >> (newest - k) & 1]

    def lift(self, element: Element) -> fmpq_mpoly:
        """The numerator of an element, moved to the present polynomial ring."""
        if element._level != self.level:
            if not isinstance(element, Canonical):
                return self.lift(self.whole(element))
            element._num = polynomials.lifted(self.ctx, element._num, self.level - element._level)
            element._level = self.level
        return element._num

    @exclusive
    def sum(self, terms: Iterable[tuple[Any, ...]]) -> Element:
        """A sum of products (rational coefficient, element, element, ...), normalised once.

        It stays lazy where multiplying it out would be expensive (see `kept`).
        """
        # Making the terms may add generators; only then is the ring fixed.
        zero, key = self.zero, id(self.zero)
        # The middle and the last entry are all factors of a product of two.
        left: list[tuple[Any, ...]] = [
            term
            for term in terms
            if term[-1] is not zero
            and term[len(term) // 2] is not zero
            and (len(term) < 4 or key not in map(id, term))
        ]
        if not left:
            return zero
        if len(left) == 1:
            coefficient, *factors = left[0]
            # One element needs no new common denominator, nor does 1 of eta times one.
            if len(factors) == 2 and factors[0].is_one:
                factors.pop(0)
            if coefficient == 1 and len(factors) == 1:
                return factors[0]
        total = self.added(left, limits.MOST_AT_ONCE)
        return kept(self, left) if total is None else total

    def added(self, terms: list[tuple[Any, ...]], largest: int) -> Element | None:
        """The sum multiplied out; None if a product of more pairs of terms would be needed."""
        check_limits()
        level = self.level
        groups: dict[Denominator, list[fmpq_mpoly]] = {}
        for coefficient, *elements in terms:
            num = None
            den: Denominator = ()
            for element in elements:
                if element._level == level:
                    part = element._num
                elif element.is_kept:
                    return None
                else:
                    part = self.lift(element)
                if num is None:
                    num = part
                else:
                    pairs = len(num) * len(part)
                    if pairs > largest:
                        return None
                    if pairs > limits.LARGEST_POWER_TERMS:
                        num = polynomials.product(num, part, limits.LARGEST_POWER_TERMS)
                    else:
                        num = num * part
                if element._den:
                    den = self.merged(den, element._den) if den else element._den
            if num is None:
                num = self.ctx.constant(1)
            if coefficient != 1:
                num = -num if coefficient == -1 else num * as_fmpq(coefficient)
            # Terms over one denominator are added first: only their sums are multiplied up.
            groups.setdefault(den, []).append(num)
        if not groups:
            return self.zero
        if len(groups) == 1:
            ((den, nums),) = groups.items()
            return self._normalised(nums[0] if len(nums) == 1 else polynomials.added(nums), den)
        common: Denominator = ()
        for den in groups:
            common = self.lcm(common, den)
        whole = []
        for den, nums in groups.items():
            num = polynomials.added(nums)
            if den != common:
                if len(num) * self._cofactor_terms(common, den) > largest:
                    return None
                num = polynomials.product(
                    num, self.cofactor(common, den), limits.LARGEST_POWER_TERMS
                )
            whole.append(num)
        return self._normalised(polynomials.added(whole), common)

    def _cofactor_terms(self, common: Denominator, den: Denominator) -> int:
        """How many terms common/den has at most, whether or not it has been multiplied out."""
        count = self._cofactor_sizes.get((common, den))
        if count is None:
            have = dict(den)
            count = self._cofactor_sizes[common, den] = prod(
                limits.terms_of_power(len(self.factors[index]), exponent - have.get(index, 0))
                for index, exponent in common
            )
        return count

    @exclusive
    def scaled(self, element: Element, factor: int | Fraction | fmpq) -> Element:
        """A rational multiple of an element."""
        if not factor or element is self.zero:
            return self.zero
        if not isinstance(element, Canonical):
            return kept(self, [(factor, element)])
        if factor == -1:
            return Canonical(self, -element._num, element._den, element._level)
        return Canonical(self, element._num * as_fmpq(factor), element._den, element._level)

    def reduced(self, poly: fmpq_mpoly) -> fmpq_mpoly:
        """A polynomial of the present ring, reduced by every algebraic relation."""
        if not self._algebraic or not poly:
            return poly
        degrees = poly.degrees()
        changed = False
        for position, degree, relation in self._algebraic:
            if degrees[position] >= degree or (changed and poly.degrees()[position] >= degree):
                check_limits()
                # With a lexicographic order the remainder is the normal form for this relation.
                _, poly = divmod(poly, relation)
                changed = True
                if not poly:
                    break
        return poly

    def _normalised(self, num: fmpq_mpoly, den: Denominator) -> Element:
        """The element num/den: reduced, with common factors divided out."""
        num = self.reduced(num) if self._algebraic else num
        if not num:
            return self.zero
        if den:
            left = []
            for index, exponent in den:
                # Trial division by the few factors below is cheaper than a gcd with their product.
                factor = self.factors[index]
                while exponent:
                    try:
                        num = num / factor
                    except DomainError:
                        break
                    exponent -= 1
                if exponent:
                    left.append((index, exponent))
            den = tuple(left)
        return Canonical(self, num, den, self.level)

    def merged(self, a: Denominator, b: Denominator) -> Denominator:
        """The product of two denominators."""
        product = self._merged.get((a, b))
        if product is None:
            powers = dict(a)
            for index, exponent in b:
                powers[index] = powers.get(index, 0) + exponent
            product = self._merged[a, b] = tuple(sorted(powers.items()))
        return product

    def lcm(self, a: Denominator, b: Denominator) -> Denominator:
        """The least common multiple of two denominators."""
        if a == b or not b:
            return a
        if not a:
            return b
        multiple = self._lcms.get((a, b))
        if multiple is None:
            powers = dict(a)
            for index, exponent in b:
                powers[index] = max(powers.get(index, 0), exponent)
            multiple = self._lcms[a, b] = tuple(sorted(powers.items()))
        return multiple

    def cofactor(self, common: Denominator, den: Denominator) -> fmpq_mpoly:
        """The polynomial common/den."""
        quotient = self._cofactors.get((common, den))
        if quotient is None:
            have = dict(den)
            quotient = self.ctx.constant(1)
            for index, exponent in common:
                quotient = quotient * self.factors[index] ** (exponent - have.get(index, 0))
            self._cofactors[common, den] = quotient
        return quotient

    def factored(self, poly: fmpq_mpoly) -> Factors:
        """(content, [(factor, exponent)]) of a polynomial of the present ring that is not zero."""
        check_limits()
        content, factors, rest = known_taken_out(poly, self.factors)
        if not rest.is_constant():
            # Many numerators of one tensor differ by a number and by known factors.
            key = str(rest)
            own, others = self._factored.get(key) or factored(rest, limits.FACTORED_HERE)
            self._factored[key] = own, others
            content, factors = content * own, factors + others
        # In an order that does not depend on which were known.
        ordered = sorted(factors, key=lambda power: str(power[0])) if len(factors) > 1 else factors
        return content, ordered

    def register(self, factor: fmpq_mpoly) -> int:
        """The number of an irreducible polynomial without algebraic generators."""
        key = str(factor)
        index = self.factor_index.get(key)
        if index is None:
            index = len(self.factors)
            # First the factor: whoever interrupts leaves one more, and no number without one.
            self.factors.append(factor)
            self.factor_index[key] = index
        return index

    def over_factors(self, num: fmpq_mpoly, factors: Iterable[tuple[fmpq_mpoly, int]]) -> Element:
        """num over irreducible factors (polynomial, exponent) without algebraic generators."""
        powers: dict[int, int] = {}
        for factor, exponent in factors:
            index = self.register(factor)
            powers[index] = powers.get(index, 0) + exponent
        return self._normalised(num, tuple(sorted(powers.items())))

    @exclusive
    def denominator(self, element: Element) -> Element:
        """The denominator of an element as an element."""
        return Canonical(self, self.cofactor(element._den, ()), (), self.level)

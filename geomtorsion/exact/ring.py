"""Ring: sums of products over registered irreducible factors, in a polynomial ring that grows."""

from __future__ import annotations

from fractions import Fraction
from typing import TYPE_CHECKING, Any

from flint import Ordering, fmpq, fmpq_mpoly_ctx
from flint.utils.flint_exceptions import DomainError

from geomtorsion.exact.element import Denominator, Element

if TYPE_CHECKING:
    from collections.abc import Iterable

# Above this many products a sum is added up pairwise, so that its cost stays n log n.
_PAIRWISE = 24


class Ring:
    """The arithmetic under a `Field`: numerators, factored denominators, relations."""

    def __init__(self) -> None:
        self.ctx = fmpq_mpoly_ctx.get((), Ordering.lex)
        self.level = 0
        self.factors: list[Any] = []
        self.factor_index: dict[str, int] = {}
        self._merged: dict[tuple[Denominator, Denominator], Denominator] = {}
        self._lcms: dict[tuple[Denominator, Denominator], Denominator] = {}
        self._cofactors: dict[tuple[Denominator, Denominator], Any] = {}
        self._algebraic: list[tuple[int, int, Any]] = []
        self.zero = Element(self, self.ctx.constant(0), (), 0)
        self.one = Element(self, self.ctx.constant(1), (), 0)

    def _grow(self, name: str) -> None:
        """Puts a variable in front of the others.

        In front, because with a lexicographic order a relation w**n = tail then reduces
        w before all that its tail contains.
        """
        self.ctx = fmpq_mpoly_ctx.get((name, *self.ctx.names()), Ordering.lex)
        self.level += 1
        self.factors = [self.lifted(poly, 1) for poly in self.factors]
        self._cofactors.clear()

    def lifted(self, poly: Any, by: int) -> Any:
        """A polynomial of an earlier ring, `by` variables smaller, in the present one."""
        pad = (0,) * by
        return self.ctx.from_dict({pad + tuple(m): c for m, c in poly.to_dict().items()})

    def lift(self, element: Element) -> Any:
        """The numerator of an element, moved to the present polynomial ring."""
        if element._level != self.level:
            element._num = self.lifted(element._num, self.level - element._level)
            element._level = self.level
        return element._num

    def sum(self, terms: Iterable[tuple[Any, ...]]) -> Element:
        """A sum of products (rational coefficient, element, element, ...), normalised once."""
        terms = list(terms)  # making them may add generators; only then is the ring fixed
        level = self.level
        groups: dict[Denominator, list[Any]] = {}
        for coefficient, *elements in terms:
            num = None
            den: Denominator = ()
            for element in elements:
                part = element._num if element._level == level else self.lift(element)
                num = part if num is None else num * part
                if element._den:
                    den = self.merged(den, element._den) if den else element._den
            if num is None:
                num = self.ctx.constant(1)
            if coefficient != 1:
                num = -num if coefficient == -1 else num * _as_fmpq(coefficient)
            if den in groups:
                groups[den].append(num)
            else:
                groups[den] = [num]
        if not groups:
            return self.zero
        if len(groups) == 1:
            ((den, nums),) = groups.items()
            return self._normalised(_added(nums), den)
        common: Denominator = ()
        for den in groups:
            common = self.lcm(common, den)
        whole = [
            _added(nums) if den == common else _added(nums) * self.cofactor(common, den)
            for den, nums in groups.items()
        ]
        return self._normalised(_added(whole), common)

    def scaled(self, element: Element, factor: int | Fraction | fmpq) -> Element:
        """A rational multiple of an element."""
        if not factor:
            return self.zero
        return Element(self, element._num * _as_fmpq(factor), element._den, element._level)

    def reduced(self, poly: Any) -> Any:
        """A polynomial of the present ring, reduced by every algebraic relation."""
        if not self._algebraic or not poly:
            return poly
        degrees = poly.degrees()
        changed = False
        for position, degree, relation in self._algebraic:
            if degrees[position] >= degree or (changed and poly.degrees()[position] >= degree):
                _, poly = divmod(poly, relation)
                changed = True
                if not poly:
                    break
        return poly

    def _normalised(self, num: Any, den: Denominator) -> Element:
        """The element num/den: reduced, with common factors divided out."""
        num = self.reduced(num)
        if not num:
            return self.zero
        if den:
            left = []
            for index, exponent in den:
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
        return Element(self, num, den, self.level)

    def merged(self, a: Denominator, b: Denominator) -> Denominator:
        """The product of two denominators."""
        known = self._merged.get((a, b))
        if known is None:
            powers = dict(a)
            for index, exponent in b:
                powers[index] = powers.get(index, 0) + exponent
            known = self._merged[a, b] = tuple(sorted(powers.items()))
        return known

    def lcm(self, a: Denominator, b: Denominator) -> Denominator:
        """The least common multiple of two denominators."""
        if a == b or not b:
            return a
        if not a:
            return b
        known = self._lcms.get((a, b))
        if known is None:
            powers = dict(a)
            for index, exponent in b:
                powers[index] = max(powers.get(index, 0), exponent)
            known = self._lcms[a, b] = tuple(sorted(powers.items()))
        return known

    def cofactor(self, common: Denominator, den: Denominator) -> Any:
        """The polynomial common/den."""
        known = self._cofactors.get((common, den))
        if known is None:
            have = dict(den)
            known = self.ctx.constant(1)
            for index, exponent in common:
                known = known * self.factors[index] ** (exponent - have.get(index, 0))
            self._cofactors[common, den] = known
        return known

    def register(self, factor: Any) -> int:
        """The number of an irreducible polynomial without algebraic generators."""
        key = str(factor)
        index = self.factor_index.get(key)
        if index is None:
            index = self.factor_index[key] = len(self.factors)
            self.factors.append(factor)
        return index

    def over_factors(self, num: Any, factors: Iterable[tuple[Any, int]]) -> Element:
        """num over irreducible factors (polynomial, exponent) without algebraic generators."""
        powers: dict[int, int] = {}
        for factor, exponent in factors:
            index = self.register(factor)
            powers[index] = powers.get(index, 0) + exponent
        return self._normalised(num, tuple(sorted(powers.items())))

    def denominator(self, element: Element) -> Element:
        """The denominator of an element as an element."""
        return Element(self, self.cofactor(element._den, ()), (), self.level)


def _as_fmpq(value: Any) -> Any:
    """A rational number as FLINT takes it."""
    return fmpq(value.numerator, value.denominator) if isinstance(value, Fraction) else value


def _added(polys: list[Any]) -> Any:
    """The sum of polynomials, pairwise where there are many."""
    if len(polys) > _PAIRWISE:
        half = len(polys) // 2
        return _added(polys[:half]) + _added(polys[half:])
    total = polys[0]
    for poly in polys[1:]:
        total = total + poly
    return total

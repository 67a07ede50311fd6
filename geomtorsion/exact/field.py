"""Field: a differential field that grows; polynomial arithmetic over registered factors."""

from __future__ import annotations

from fractions import Fraction
from typing import TYPE_CHECKING, Any

import sympy
from flint import Ordering, fmpq, fmpq_mpoly_ctx
from flint.utils.flint_exceptions import DomainError

from geomtorsion.errors import CoordinateError, ExpressionError
from geomtorsion.exact import derivation, inversion
from geomtorsion.exact.element import Denominator, Element
from geomtorsion.exact.generators import Branch, Generator
from geomtorsion.exact.sample import Sample

if TYPE_CHECKING:
    from collections.abc import Iterable, Mapping, Sequence

# Above this many products a sum is added up pairwise, so that its cost stays n log n.
_PAIRWISE = 24


class Field:
    """The smallest differential field that holds what was read into it.

    Over the rationals, in polynomials of generators: coordinates and parameters, cos and
    sin, exp, log, roots, jets of unknown functions.  The field only ever grows, and growth
    changes no element: everything in it is a table of what is known so far.

    Parameters
    ----------
    symbols
        coordinates and parameters, sympy symbols.
    complex
        whether the imaginary unit may occur.
    sample
        values of symbols at a point inside the domain, for choosing branches of roots.
    branches
        chosen values of roots, {root as sympy expression: sympy expression}; each is checked.

    Examples
    --------
    >>> r, M = sympy.symbols("r M", positive=True)
    >>> field = Field([r, M])
    >>> h = field.read(sympy.sqrt(1 - 2 * M / r))
    >>> (h * h).sympy, h.diff(r) * h == field.read(M / r**2)
    ((-2*M + r)/r, True)
    """

    def __init__(
        self,
        symbols: Sequence[sympy.Symbol],
        *,
        complex: bool = False,  # noqa: A002 - the word of the mathematics
        sample: Mapping[sympy.Symbol, Any] | None = None,
        branches: Mapping[sympy.Expr, sympy.Expr] | None = None,
    ) -> None:
        if len(set(symbols)) != len(symbols):
            raise CoordinateError(f"symbols are repeated in {tuple(symbols)}; name each once")
        self.is_complex = complex
        self.chosen = dict(branches or {})
        self.generators: list[Generator] = []
        self.by_name: dict[str, Generator] = {}
        self.factors: list[Any] = []
        self.factor_index: dict[str, int] = {}
        self._merged: dict[tuple[Denominator, Denominator], Denominator] = {}
        self._lcms: dict[tuple[Denominator, Denominator], Denominator] = {}
        self._cofactors: dict[tuple[Denominator, Denominator], Any] = {}
        self._generator_diffs: dict[tuple[str, sympy.Symbol], Element] = {}
        self._factor_diffs: dict[tuple[int, sympy.Symbol], Element] = {}
        self._algebraic: list[tuple[int, int, Any]] = []
        self._branches: dict[sympy.Expr, Branch] = {}
        self.tables: dict[str, Any] = {}
        self.all_sure = True
        self.level = 0
        self.ctx = fmpq_mpoly_ctx.get((), Ordering.lex)
        self.zero = Element(self, self.ctx.constant(0), (), 0)
        self.one = Element(self, self.ctx.constant(1), (), 0)
        self.symbols: tuple[sympy.Symbol, ...] = ()
        self._symbol_elements: dict[sympy.Symbol, Element] = {}
        self.sample = Sample(self, sample or {})
        self._add_symbols(symbols)
        from geomtorsion.exact.reading import Reader

        self._reader = Reader(self)

    # ---- growth -----------------------------------------------------------------------
    def _add_symbols(self, symbols: Sequence[sympy.Symbol]) -> None:
        # The first symbol leads, so that factors read r - 2*M with r the coordinate.
        for symbol in reversed(symbols):
            name = f"s{len(self.generators)}"
            element = self.add(Generator("symbol", name, symbol, frozenset((symbol,))))
            self._symbol_elements[symbol] = element
        self.symbols = (*self.symbols, *symbols)

    def add(self, generator: Generator) -> Element:
        """Adds one generator in front of the others and returns it as an element.

        In front, because with a lexicographic order a relation w**n = tail then reduces
        w before all that its tail contains.
        """
        names = (generator.name, *self.ctx.names())
        self.ctx = fmpq_mpoly_ctx.get(names, Ordering.lex)
        self.generators.insert(0, generator)
        self.by_name[generator.name] = generator
        self.level += 1
        self.factors = [self._lifted(poly, 1) for poly in self.factors]
        self._cofactors.clear()
        if not generator.sure:
            self.all_sure = False
        self._algebraic = []
        for position, known in enumerate(self.generators):
            if known.tail is not None:
                w = self.ctx.gen(position)
                relation = w**known.degree - self.lift(known.tail)
                for power, value in known.middle:
                    relation = relation - w**power * value
                self._algebraic.append((position, known.degree, relation))
        return Element(self, self.ctx.gen(0), (), self.level)

    def next_name(self, kind: str) -> str:
        """A name for the next generator that no other has."""
        return f"{kind[:2]}{len(self.generators)}"

    def _lifted(self, poly: Any, by: int) -> Any:
        pad = (0,) * by
        return self.ctx.from_dict({pad + tuple(m): c for m, c in poly.to_dict().items()})

    def lift(self, element: Element) -> Any:
        """The numerator of an element, moved to the present polynomial ring."""
        if element._level != self.level:
            element._num = self._lifted(element._num, self.level - element._level)
            element._level = self.level
        return element._num

    # ---- making elements --------------------------------------------------------------
    def rational(self, p: int | Fraction | fmpq, q: int = 1) -> Element:
        """The rational number p/q."""
        value = fmpq(p.numerator, p.denominator) if isinstance(p, Fraction) else fmpq(p)
        return Element(self, self.ctx.constant(value / q), (), self.level)

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
    def imaginary(self) -> Element:
        """The imaginary unit."""
        if not self.is_complex:
            raise ExpressionError("I occurs in a real frame; declare it with complex=True")
        known = self.by_name.get("I")
        if known is None:
            minus_one = self.rational(-1)
            generator = Generator("imaginary", "I", sympy.I, frozenset(), 2, minus_one)
            return self.add(generator)
        return self.generator_element(known)

    def generator_element(self, generator: Generator) -> Element:
        """A generator as an element."""
        return Element(self, self.ctx.gen(self.generators.index(generator)), (), self.level)

    def polynomial(self, poly: Any) -> Element:
        """A polynomial of the present ring as an element."""
        return Element(self, self.reduced(poly), (), self.level)

    def read(self, expr: Any, where: str = "expression") -> Element:
        """Reads one sympy expression, int or Fraction.

        Raises
        ------
        ExpressionError
            a part cannot be read exactly; the message names `where` and the part.
        """
        return self._reader.read_all([(where, expr)])[0]

    def read_all(self, entries: Iterable[tuple[str, Any]]) -> list[Element]:
        """Reads expressions together, so that angles and exponents get one common basis."""
        return self._reader.read_all(list(entries))

    def from_json(self, data: Mapping[str, str], functions: Iterable[str] = ()) -> Element:
        """The element that `Element.to_json` wrote, read through the whitelist parser."""
        from geomtorsion.exact.parsing import parse_expression

        known = {str(symbol): symbol for symbol in self.symbols}
        table = {name: sympy.Function(name) for name in functions}
        return self.read(parse_expression(data["expression"], known, table))

    @property
    def branches(self) -> tuple[Branch, ...]:
        """The signs with which roots were read, where the symbols' assumptions left a choice."""
        return tuple(self._branches.values())

    def state_branch(self, branch: Branch) -> None:
        """Notes the sign with which a root was read."""
        self._branches.setdefault(branch.radical, branch)

    # ---- arithmetic -------------------------------------------------------------------
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

    def inverse(self, element: Element) -> Element:
        """1 over an element, its denominator free of algebraic generators."""
        if not element._num:
            raise ZeroDivisionError("division by an element that is exactly zero")
        return inversion.inverse(self, element)

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

    def root(self, element: Element, order: int, radical: sympy.Expr | None = None) -> Element:
        """The root of an order, positive at the sample point; adds a generator if it must."""
        from geomtorsion.exact import roots

        return roots.root(self, element, order, radical)

    # ---- structure --------------------------------------------------------------------
    def generators_of(self, element: Element) -> list[Generator]:
        """The generators that occur in an element."""
        used = [d > 0 for d in self.lift(element).degrees()]
        for index, _ in element._den:
            for position, degree in enumerate(self.factors[index].degrees()):
                used[position] |= degree > 0
        return [g for g, here in zip(self.generators, used, strict=True) if here]

    def conjugate(self, element: Element) -> Element:
        """The element with I replaced by -I."""
        if "I" not in self.by_name:
            return element
        position = self.generators.index(self.by_name["I"])
        flipped = {
            tuple(m): (-c if m[position] & 1 else c)
            for m, c in self.lift(element).to_dict().items()
        }
        return Element(self, self.ctx.from_dict(flipped), element._den, self.level)

    def derivative(self, element: Element, symbol: sympy.Symbol) -> Element:
        """The partial derivative of an element."""
        return derivation.derivative(self, element, symbol)

    def decide_zero(self, element: Element) -> bool | None:
        """Whether a non-trivial element vanishes, where generators may depend on others."""
        if all(generator.sure for generator in self.generators_of(element)):
            return False
        return False if self.sample.is_surely_nonzero(element) else None


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

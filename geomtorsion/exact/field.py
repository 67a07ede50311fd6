"""Field: a differential field that grows with each reading, and its derivation."""

from __future__ import annotations

from functools import partial
from math import prod
from typing import TYPE_CHECKING, Any

import sympy
from flint import fmpq

from geomtorsion.errors import CoordinateError
from geomtorsion.exact import algebraic_constants, kept, polynomials
from geomtorsion.exact.algebraic_constants import is_algebraic_constant
from geomtorsion.exact.element import PROVED, UNDECIDED, Canonical, Certainty, Element, inside_out
from geomtorsion.exact.evaluate import arguments, evaluate
from geomtorsion.exact.functions import jet
from geomtorsion.exact.generators import Generator, Generators, Names
from geomtorsion.exact.generic_point import Extended, GenericPoint, Places
from geomtorsion.exact.limits import MOST_AT_ONCE, NoPointError
from geomtorsion.exact.points import point_of, roomy_point_of
from geomtorsion.exact.primes import BITS
from geomtorsion.exact.reading import Reader, counted_as
from geomtorsion.exact.roots import inverse, root
from geomtorsion.exact.serialization import from_json, to_json
from geomtorsion.exact.special import slope
from geomtorsion.exact.tower import Point, Tower
from geomtorsion.exact.writing import shortest, to_sympy
from geomtorsion.support.exclusive import exclusive

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable, Mapping, Sequence
    from fractions import Fraction

    import mpmath
    from flint import fmpq_mpoly, fmpz_mod

    from geomtorsion.exact.element import Value

    # The derivative of a generator with respect to a symbol.
    Rule = Callable[[Tower, Generator, sympy.Symbol], Element]


def derivative(field: Tower, element: Element, symbol: sympy.Symbol, /) -> Element:
    """d(num/den) = d num / den - num / den * sum of exponent * d factor / factor."""
    if symbol not in field._symbol_elements:
        symbol = counted_as([symbol], field.symbols).get(symbol, symbol)
    if element.is_kept:
        return kept.derivative(field, element, symbol)
    num = field.lift(element)
    den = element._den
    # Everything goes into one sum, which is normalised once.
    terms: list[tuple[Any, ...]] = []
    for part, inner in _parts(field, num, symbol):
        terms.append((1, Canonical(field, part, den, field.level), inner))
    for index, exponent in den:
        inner = _factor_derivative(field, index, symbol)
        if inner.is_kept or inner._num:
            # d(1/f**e) = -e (1/f**e) df/f: the denominator grows by one power of each factor.
            once = Canonical(field, field.ctx.constant(1), ((index, 1),), field.level)
            terms.append((-exponent, element, inner, once))
    return field.sum(terms) if terms else field.zero


def _parts(
    field: Tower, poly: fmpq_mpoly, symbol: sympy.Symbol
) -> list[tuple[fmpq_mpoly, Element]]:
    """Pairs (d poly / d generator, d generator / d symbol) that are not zero."""
    products = []
    pairs = zip(field.generators, poly.degrees(), strict=True)
    names = [generator for generator, degree in pairs if degree > 0 and symbol in generator.depends]
    if not names:
        return []
    # A derivative may add generators (jets): all of them first, then one common ring.
    inners, slopes = [], field.generator_slopes
    is_known = partial(_has_slope, field, symbol)
    for generator in names:
        for part in inside_out(generator, partial(_made_of, symbol), is_known):
            slopes[part.name, symbol] = _RULES[part.kind](field, part, symbol)
        inners.append(slopes[generator.name, symbol])
    if poly.context() is not field.ctx:
        grown = field.ctx.nvars() - poly.context().nvars()
        poly = polynomials.lifted(field.ctx, poly, grown)
    for generator, inner in zip(names, inners, strict=True):
        if inner.is_kept or inner._num:
            products.append((poly.derivative(field.generators.index(generator)), inner))
    return products


def _has_slope(field: Tower, symbol: sympy.Symbol, generator: Generator) -> bool:
    """Whether the derivative of a generator is known."""
    return (generator.name, symbol) in field.generator_slopes


def _made_of(symbol: sympy.Symbol, generator: Generator) -> list[Generator]:
    """The generators on whose derivatives the derivative of one depends."""
    return [
        inner
        for part in arguments(generator)
        for inner in part.field.generators_of(part)
        if symbol in inner.depends
    ]


def _factor_derivative(field: Tower, index: int, symbol: sympy.Symbol) -> Element:
    """The derivative of a registered factor."""
    key = (index, symbol)
    total = field.factor_slopes.get(key)
    if total is None:
        parts = _parts(field, field.factors[index], symbol)
        total = field.sum((1, Canonical(field, part, (), field.level), d) for part, d in parts)
        field.factor_slopes[key] = total
    return total


def _constant(field: Tower, generator: Generator, symbol: sympy.Symbol) -> Element:
    return field.zero


def _symbol(field: Tower, generator: Generator, symbol: sympy.Symbol) -> Element:
    return field.one if generator.shown == symbol else field.zero


def _partnered(sign: int) -> Rule:
    """Rule for cos, sin, cosh, sinh: argument = (angle, name of the partner)."""

    def rule(field: Tower, generator: Generator, symbol: sympy.Symbol) -> Element:
        angle, partner = generator.argument
        other = field.generator_element(field.by_name[partner])
        return field.sum(((sign, other, angle.diff(symbol)),))

    return rule


def _exp(field: Tower, generator: Generator, symbol: sympy.Symbol) -> Element:
    return field.generator_element(generator) * generator.argument.diff(symbol)


def _log(field: Tower, generator: Generator, symbol: sympy.Symbol) -> Element:
    return generator.argument.diff(symbol) / generator.argument


def _root(field: Tower, generator: Generator, symbol: sympy.Symbol) -> Element:
    """w**n = P: w' = w P' / (n P)."""
    tail = generator.tail
    assert tail is not None
    slope = tail.diff(symbol) / tail
    return field.sum(((fmpq(1, generator.degree), field.generator_element(generator), slope),))


def _chebyshev(field: Tower, generator: Generator, symbol: sympy.Symbol) -> Element:
    """cos of a part of an angle: argument = (angle, function that gives its sine)."""
    angle, sine = generator.argument
    return field.sum(((-1, sine(), angle.diff(symbol)),))


def _primitive(field: Tower, generator: Generator, symbol: sympy.Symbol) -> Element:
    """argument = (inner element, derivative with respect to it, arguments)."""
    inner, slope, _ = generator.argument
    return field.sum(((1, slope, inner.diff(symbol)),))


def _jet(field: Tower, generator: Generator, symbol: sympy.Symbol) -> Element:
    """The chain rule over the arguments of an unknown function."""
    name, orders, arguments = generator.argument
    terms = []
    for k, argument in enumerate(arguments):
        inner = argument.diff(symbol)
        if inner.is_kept or inner._num:
            up = tuple(n + (j == k) for j, n in enumerate(orders))
            terms.append((1, jet(field, name, up, arguments), inner))
    return field.sum(terms)


def _opaque(field: Tower, generator: Generator, symbol: sympy.Symbol) -> Element:
    return slope(field, generator, symbol)


_RULES: dict[str, Rule] = {
    "symbol": _symbol,
    "cos": _partnered(-1),
    "sin": _partnered(1),
    "cosh": _partnered(1),
    "sinh": _partnered(1),
    "exp": _exp,
    "log": _log,
    "root": _root,
    "chebyshev": _chebyshev,
    "primitive": _primitive,
    "jet": _jet,
    "opaque": _opaque,
    "constant": _constant,
    "imaginary": _constant,
}


@exclusive
class Field(Tower):
    """The smallest differential field that contains everything read into it.

    Over the rationals, in polynomials of generators: coordinates and parameters, cos and
    sin, exp, log, roots, jets of unknown functions.  The field only ever grows, and growth
    changes no element: it contains only tables of known relations.

    Parameters
    ----------
    symbols
        coordinates and parameters, sympy symbols.
    complex
        whether the imaginary unit may occur.
    sample
        values of symbols at a point inside the domain, for choosing branches of roots; or several
        candidates for this point, the preferred one first.
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
        complex: bool = False,
        sample: Mapping[sympy.Symbol, Value] | Places | None = None,
        branches: Mapping[sympy.Expr, sympy.Expr] | None = None,
    ) -> None:
        if len(set(symbols)) != len(symbols):
            raise CoordinateError(f"symbols are repeated in {tuple(symbols)}; name each once")
        super().__init__()
        self.is_complex = complex
        # The frame that it belongs to, if any: copies of its elements share the field of the copy.
        self.owner: Any = None
        self.chosen: dict[sympy.Expr, sympy.Expr] = dict(branches or {})
        self.sample: Point = GenericPoint(self, sample)
        self._add_symbols(symbols)
        if complex:
            # First of all, so that later roots are compared with it.
            self.add(Generator("imaginary", "I", sympy.I, frozenset(), 2, self.rational(-1)))
        self._reader = Reader(self)

    def __reduce__(self) -> tuple[object, ...]:
        if self.owner is not None:
            return getattr, (self.owner, "field")
        settings = (self.is_complex, self.sample.given, self.chosen)
        return _made_again, (self.symbols, *settings)

    def __deepcopy__(self, _: object) -> Field:
        """Itself: it only grows, and growth changes no element."""
        return self

    @property
    def exact(self) -> Field:
        """The field itself; for truncated series, the field of their coefficients."""
        return self

    def with_symbol(self, symbol: sympy.Symbol, value: Value) -> Field:
        """A field over one more symbol, with its value at the point at which signs are read off."""
        return Field(
            (*self.symbols, symbol),
            complex=self.is_complex,
            sample=Extended(self.sample, {symbol: value}),
        )

    def with_symbols(self, symbols: Sequence[sympy.Symbol]) -> Field:
        """A field over more symbols, with the same domain and branches."""
        return Field(
            (*self.symbols, *symbols),
            complex=self.is_complex,
            sample=Extended(self.sample, {}),
            branches=self.chosen,
        )

    def declare(self, symbols: Iterable[sympy.Symbol]) -> None:
        """Add parameters after the field was made, such as the share of a blend."""
        self._add_symbols([symbol for symbol in symbols if symbol not in self._symbol_elements])

    def _add_symbols(self, symbols: Sequence[sympy.Symbol]) -> None:
        # The first symbol leads, so that factors read r - 2*M with r the coordinate.
        new = [
            Generator("symbol", f"s{k}", symbol, frozenset((symbol,)))
            for k, symbol in enumerate(reversed(symbols), len(self.generators))
        ]
        if new:
            self.add(*new)
        for generator in new:
            # In a field with functions whose independence is not proved it is a copy that is added.
            added = self.by_name[generator.name]
            self._symbol_elements[generator.shown] = self.generator_element(added)
        self.symbols: tuple[sympy.Symbol, ...] = (*self.symbols, *symbols)

    def read(self, expr: sympy.Expr | Fraction | int, where: str = "expression") -> Element:
        """Read a sympy expression, int or Fraction.

        Raises
        ------
        ExpressionError
            a part cannot be read exactly; the message names `where` and the part.
        """
        return self._reader.read_all([(where, expr)])[0]

    def read_all(self, entries: Iterable[tuple[str, Any]]) -> list[Element]:
        """Read expressions together, so that angles and exponents get one common basis."""
        return self._reader.read_all(entries)

    def from_json(self, data: Mapping[str, Any], functions: Iterable[str] = ()) -> Element:
        """The element that `Element.to_json` wrote, read through the whitelist parser."""
        return from_json(self, data, functions)

    def inverse(self, element: Element, briefly: bool = False) -> Element:
        """1 over an element, its denominator free of algebraic generators.

        briefly: the quotient stays lazy if its denominator, cleared of roots, is longer than its
            square.
        """
        if element.is_kept:
            if element.is_zero:
                raise ZeroDivisionError("division by an element that is exactly zero")
            return kept.reciprocal(self, element)
        if not element._num or (not self.all_sure and element.is_zero):
            raise ZeroDivisionError("division by an element that is exactly zero")
        if element.is_rational:
            return self.rational(1 / element._num.leading_coefficient())
        largest = MOST_AT_ONCE
        if briefly:
            tails = [g.tail for g in self.generators_of(element) if g.tail is not None]
            if tails:
                # If a sum under a root is short, so is the remainder after the root is cleared.
                own = int(element.length) + sum(len(self.lift(tail)) for tail in tails)
                largest = min(largest, own**4)
        reciprocal = inverse(self, element, largest)
        return kept.reciprocal(self, element) if reciprocal is None else reciprocal

    def cleared(self, element: Element, largest: int) -> Element | None:
        """1 over an element, multiplied out; None if a product would be larger than the limit."""
        return inverse(self, element, largest)

    def whole(self, element: Element) -> Element:
        """An element multiplied out.

        Raises
        ------
        LimitError
            a product is above the limit of all products.
        """
        expanded = kept.multiplied_out(self, element)
        assert expanded is not None
        return expanded

    def brief(self, element: Element) -> Element | None:
        """An element multiplied out, if that is cheap."""
        return kept.multiplied_out(self, element, briefly=True)

    # The functions that do it are the methods themselves.
    root = root
    derivative = derivative
    jet = jet

    def conjugate(self, element: Element) -> Element:
        """The element with I replaced by -I, also inside roots, logs and exponents."""
        if not self.is_complex:
            return element
        if element.is_kept:
            return kept.conjugate(self, element)
        position = self.generators.index(self.by_name["I"])
        if any(g.shown.has(sympy.I) and g.kind != "imaginary" for g in self.generators_of(element)):
            return self.read(element.sympy.xreplace({sympy.I: -sympy.I}))
        flipped = {
            tuple(m): (-c if m[position] & 1 else c)
            for m, c in self.lift(element).to_dict().items()
        }
        return Canonical(self, self.ctx.from_dict(flipped), element._den, self.level)

    def decide_zero(self, element: Element) -> bool | None:
        """Whether a lazy element, or an element with generators that may be dependent, vanishes."""
        unsure = [] if self.all_sure else [g for g in self.generators_of(element) if not g.sure]
        if not unsure and not element.is_kept:
            return not element._num
        # A polynomial in generators without relations vanishes whatever they are.  A root that may
        # be in the field already has more relations than its own, and only one of its values.
        if any(g.degree or is_algebraic_constant(self, g) for g in unsure):
            return self._decide_by_numbers(element)
        # A point at which very many roots have values is long to be found.
        if element.is_kept and self._has_many_roots(element):
            if self.sample.is_surely_nonzero(element):
                return False
            whole = self.brief(element)
            if whole is not None:
                return self.decide_zero(whole)
        image = self._image(element)
        if image is None and element.is_kept:
            # For very many roots no point is found; an element with a value does not vanish.
            if self.sample.is_surely_nonzero(element):
                return False
            element = self.whole(element)
        if image == 0 if image is not None else not element._num:
            return True
        if not unsure:
            return False
        return False if self.sample.is_surely_nonzero(element) else None

    def _has_many_roots(self, element: Element) -> bool:
        """Whether the roots of an element have more values together than a prime has bits."""
        return prod(g.degree for g in self.generators_of(element) if g.kind == "root") > BITS

    def _decide_by_numbers(self, element: Element) -> bool | None:
        """Whether an element vanishes some of whose roots may depend on others."""
        # A value decides without multiplying out, which takes long where roots are many.
        if self.sample.is_surely_nonzero(element):
            return False
        whole = self.brief(element)
        if whole is not None:
            verdict = algebraic_constants.vanishes(whole)
            if verdict is not None:
                return verdict
        image = self._image(element)
        return True if image is not None and image == 0 else None

    def _image(self, element: Element) -> fmpz_mod | None:
        """The value at a random point modulo a prime; None without a value."""
        try:
            return roomy_point_of(self).image(element)
        except NoPointError:
            return None

    def square_class(self, element: Element, roots: Generators) -> Generators | None:
        """The roots whose radicands make a square of an element, if any do: see `modular`."""
        return point_of(self).square_class(element, roots)

    def certainty(self, element: Element) -> Certainty:
        """Whether the answer of `is_zero` is proved, or the chance that it is wrong."""
        verdict = element.is_zero
        if not verdict:
            return UNDECIDED if verdict is None else PROVED
        whole = self.brief(element)
        if whole is not None and (not whole._num or algebraic_constants.vanishes(whole)):
            return PROVED
        return Certainty(proved=False, error=point_of(self).chance(element))

    def written(self, element: Element, names: Names | None = None) -> sympy.Expr:
        """The element as a short sympy expression; with its sums collected if there are names."""
        return to_sympy(element) if names is None else shortest(element, names)

    def value(
        self, element: Element, point: Mapping[Any, Value], precision: int, at: Any = None
    ) -> float | complex | mpmath.mpf:
        """The value of an element at a point; see `Element.evaluate`."""
        return evaluate(element, point, precision, at)

    def to_json(self, element: Element) -> dict[str, Any]:
        """An element as a JSON-ready mapping."""
        return to_json(element)


def _made_again(
    symbols: tuple[sympy.Symbol, ...],
    complex_: bool,
    sample: Mapping[sympy.Symbol, Value],
    branches: Mapping[sympy.Expr, sympy.Expr],
) -> Field:
    """A field from the plain data that `Field.__reduce__` gives."""
    return Field(symbols, complex=complex_, sample=sample, branches=branches)

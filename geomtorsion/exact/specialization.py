"""Specialization: elements of a field at one place, as exact numbers and parameters."""

from __future__ import annotations

import zlib
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from fractions import Fraction
from itertools import count, islice, takewhile
from typing import TYPE_CHECKING

import mpmath
import sympy

from geomtorsion.errors import GeomtorsionError
from geomtorsion.exact.candidates import GRAINS
from geomtorsion.exact.element import Element, in_order
from geomtorsion.exact.field import Field
from geomtorsion.exact.generators import Generator
from geomtorsion.exact.polynomials import as_fmpq

if TYPE_CHECKING:
    from flint import fmpq_mpoly

    from geomtorsion.exact.element import Value


# Kinds of generators for which a place may have any value that satisfies their own relation.
_FREE = frozenset("symbol cos sin cosh sinh exp log primitive jet opaque".split())


class Specialization:
    """A map from elements of a field to elements over its parameters; it keeps sums and products.

    Every generator that depends on a given symbol gets a rational number near its value at the
    generic point, or a root of such a number. The field contains all relations between
    generators, so that every identity between elements holds at each such place. Generators whose
    independence is not proved get their values at a rational point of the given symbols.

    field: the field of the elements.
    symbols: the symbols that get values.
    largest: largest denominator of the values; a larger one is nearer to the point.
    point: numbers of all symbols; by default the generic point of the field.

    Examples
    --------
    >>> import sympy
    >>> from geomtorsion.exact import Field, Specialization
    >>> r, theta, M = sympy.symbols("r theta M", positive=True)
    >>> field = Field([r, theta, M])
    >>> place = Specialization(field, [r, theta], 4)
    >>> values = [place(field.read(f(theta))) for f in (sympy.sin, sympy.cos)]
    >>> (values[0] ** 2 + values[1] ** 2).sympy, place(field.read(M * r / r)).sympy
    (1, M)
    """

    def __init__(
        self,
        field: Field,
        symbols: Iterable[sympy.Symbol],
        largest: int,
        point: Mapping[sympy.Symbol, Value] | None = None,
    ) -> None:
        self._point = None if point is None else dict(point)
        self.symbols = frozenset(symbols)
        self._source = field
        self._largest = largest
        parameters = [symbol for symbol in field.symbols if symbol not in self.symbols]
        sample = {symbol: self._number(field.symbol(symbol)) for symbol in parameters}
        self.field = Field(parameters, complex=field.is_complex, sample=sample)
        self._values: dict[str, Element] = {}
        self._images: dict[int, tuple[Element, Element]] = {}

    @classmethod
    def nearer(
        cls,
        field: Field,
        symbols: Iterable[sympy.Symbol],
        point: Mapping[sympy.Symbol, Value] | None = None,
        surrounds: Callable[[Mapping[sympy.Symbol, Fraction]], bool] = lambda rounded: True,
    ) -> Iterator[Specialization]:
        """Four places, each nearer to the point than the one before.

        surrounds: whether a rounded point is on the same side of all walls; others are skipped.
        """
        # Denominators of generic points: a finer place is the point itself.
        own, fineness = tuple(symbols), takewhile(GRAINS[0].__gt__, (4**k for k in count(1)))
        places = (cls(field, own, largest, point) for largest in fineness)
        return islice((place for place in places if surrounds(place.rounded)), 4)

    @property
    def rounded(self) -> dict[sympy.Symbol, sympy.Rational]:
        """Values of all symbols of the field at this place."""
        numbers = {s: self._number(self._source.symbol(s)) for s in self._source.symbols}
        return {s: sympy.Rational(x.numerator, x.denominator) for s, x in numbers.items()}

    def __call__(self, element: Element) -> Element:
        """The value of an element at the place.

        Raises
        ------
        ZeroDivisionError
            The element has a pole there.
        """
        if not element.is_kept:
            return self._canonical(element)
        for node in in_order(element, lambda one: id(one) in self._images):
            terms = [
                (c, *(self._image(one) for one in factors)) for c, *factors in node._recipe.terms
            ]
            total = self.field.sum(terms)
            self._images[id(node)] = node, total.inverse() if node._recipe.below else total
        return self._images[id(element)][1]

    def all(self, elements: Sequence[Element]) -> list[Element]:
        """The values of elements at the place."""
        return [self(element) for element in elements]

    def _image(self, element: Element) -> Element:
        kept = self._images.get(id(element))
        return self._canonical(element) if kept is None else kept[1]

    def _canonical(self, element: Element) -> Element:
        """The value of an element that is multiplied out."""
        source = self._source
        value = self._polynomial(source.lift(element))
        for index, exponent in element._den:
            below = self._polynomial(source.factors[index])
            value = value * below.inverse() ** exponent
        return value

    def _polynomial(self, poly: fmpq_mpoly) -> Element:
        generators = self._source.generators
        # A polynomial of an older ring has fewer variables; the newest generators come first.
        offset = len(generators) - poly.context().nvars()
        terms = []
        for monomial, coefficient in poly.to_dict().items():
            factors = [
                self._value(generators[offset + k]) ** int(exponent)
                for k, exponent in enumerate(monomial)
                if exponent
            ]
            terms.append((as_fmpq(coefficient), *factors))
        return self.field.sum(terms) if terms else self.field.zero

    def _value(self, generator: Generator) -> Element:
        """The value of a generator; partners such as sin and cos get theirs together."""
        if generator.name not in self._values:
            self._values |= self._values_of(generator)
        return self._values[generator.name]

    def _values_of(self, generator: Generator) -> dict[str, Element]:
        field, name = self.field, generator.name
        if generator.kind == "imaginary":
            return {name: field.imaginary}
        if generator.kind == "root" and generator.tail is not None:
            return {name: field.root(self(generator.tail), generator.degree)}
        if not generator.depends & self.symbols and generator.kind != "jet":
            return {name: field.read(generator.shown)}
        if not self._source.all_sure or generator.kind not in _FREE:
            point = {one: self._number(self._source.symbol(one)) for one in self.symbols}
            return {name: field.read(generator.shown.xreplace(point))}
        own = self._source.generator_element(generator)
        if generator.kind in ("cos", "sin", "cosh", "sinh"):
            other = self._source.by_name[generator.argument[1]]
            pair = {generator.kind: generator, other.kind: other}
            return self._pair(pair)
        return {name: field.rational(self._number(own))}

    def _pair(self, pair: dict[str, Generator]) -> dict[str, Element]:
        """Rational values of cos and sin, or of cosh and sinh, of one argument."""
        rational = self.field.rational
        if "cos" in pair:
            cos, sin = (
                self._float(self._source.generator_element(pair[k])) for k in ("cos", "sin")
            )
            # The tangent of half of the angle, with the smaller of two absolute values.
            half = self._near(sin / (1 + abs(cos)))
            below = 1 + half**2
            even = rational((1 - half**2) / below * (1 if cos >= 0 else -1))
            return {pair["cos"].name: even, pair["sin"].name: rational(2 * half / below)}
        both = (self._float(self._source.generator_element(pair[k])) for k in ("cosh", "sinh"))
        growth = self._near(sum(both))
        even, odd = (growth + 1 / growth) / 2, (growth - 1 / growth) / 2
        return {pair["cosh"].name: rational(even), pair["sinh"].name: rational(odd)}

    def _number(self, element: Element) -> Fraction:
        return self._near(self._float(element))

    def _near(self, value: float) -> Fraction:
        """A rational number near a value, of the same sign and not zero."""
        largest = self._largest
        while True:
            near = Fraction(value).limit_denominator(largest)
            if near or not value:
                return near or Fraction(1, largest)
            largest *= 2

    def _float(self, element: Element) -> float:
        """The value at the point; for an element without a value, a number from its name."""
        try:
            if self._point is None:
                return float(mpmath.re(self._source.sample.value(element)))
            return complex(element.evaluate(self._point)).real
        except (GeomtorsionError, ArithmeticError, ValueError):
            return 1 + zlib.crc32(str(element.sympy).encode()) / 2**32

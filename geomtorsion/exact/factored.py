"""Factored: sums of products of elements, read, shortened and put into a straight line."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from fractions import Fraction
from typing import TYPE_CHECKING

from geomtorsion.exact.emitting import short_line
from geomtorsion.exact.factoring import TooLong
from geomtorsion.exact.form import Sum, form
from geomtorsion.exact.generators import Generator
from geomtorsion.exact.literals import Literals
from geomtorsion.exact.straight_line import StraightLine
from geomtorsion.exact.sums import Term

if TYPE_CHECKING:
    from geomtorsion.exact.element import Element

# Functions that are written by their own names.
_CIRCULAR = {"cos": "cos", "sin": "sin", "cosh": "cosh", "sinh": "sinh", "chebyshev": "cos"}


def factored(
    arguments: Sequence[str],
    outputs: Sequence[Iterable[tuple[Element, tuple[str, ...]]]],
    constants: Iterable[str] = (),
) -> StraightLine | None:
    """A short straight line for sums of products, or None where they are too long for it.

    constants: those arguments that do not change while the others do; work with them alone is
        done once, and products with them cost little.

    Examples
    --------
    >>> import sympy
    >>> from geomtorsion.exact import Field
    >>> x, y = sympy.symbols("x y")
    >>> field = Field([x, y])
    >>> line = factored(["x", "y"], [((field.read(x), ("x",)), (field.read(x), ("y",)))])
    >>> [step.kind for step in line.steps]
    ['symbol', 'symbol', 'sum', 'product']
    """
    reader = ElementReader(arguments, constants)
    try:
        numbers = [
            reader.sums.entered([reader.product(element, factors) for element, factors in output])
            for output in outputs
        ]
        return short_line(reader, numbers)
    except (TooLong, RecursionError):
        return None


class ElementReader(Literals):
    """Reads elements; what has no function of its own in all engines is refused."""

    def product(self, element: Element, factors: tuple[str, ...]) -> Term:
        """An element times arguments."""
        return self.times([self.element(element), *(self.symbols[name] for name in factors)])

    def element(self, element: Element) -> Term:
        """An element as one term."""
        written = form(element)
        value = written.coefficient
        number = Fraction(int(value.p), int(value.q))
        parts = [self.power(self._base(base), exponent) for base, exponent in written.powers]
        return self.times([(number, (), ()), *parts])

    def _base(self, base: Generator | Sum) -> Term:
        key = ("base", base)
        if key not in self._known:
            found = self._generator(base) if isinstance(base, Generator) else self._sum(base)
            self._known[key] = found
        return self._known[key]

    def _sum(self, base: Sum) -> Term:
        terms = []
        for value, monomial in base.terms:
            parts = [
                self.power(self._base(generator), exponent) for generator, exponent in monomial
            ]
            terms.append(self.times([(Fraction(int(value.p), int(value.q)), (), ()), *parts]))
        return self.sums.literal(terms)

    def _generator(self, generator: Generator) -> Term:
        shown = str(generator.shown)
        if shown in self.symbols:
            return self.symbols[shown]
        kind, argument, tail = generator.kind, generator.argument, generator.tail
        if kind in _CIRCULAR:
            return self.call(_CIRCULAR[kind], self.element(argument[0]))
        if kind in ("exp", "log"):
            return self.call(kind, self.element(argument))
        if kind == "root" and tail is not None:
            return self.root(generator.degree, self.element(tail))
        if kind == "primitive":
            name = type(generator.shown).__name__
            if name in ("acot", "acoth"):
                partner = {"acot": "atan", "acoth": "atanh"}[name]
                return self.call(partner, self.element(1 / argument[0]))
            return self.call(name, *(self.element(part) for part in argument[2]))
        if not generator.depends and kind != "imaginary":
            return self.digits(generator.shown)
        # Today's writing has its own words for what is missing.
        raise TooLong

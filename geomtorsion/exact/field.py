"""Field: a differential field that grows with what is read into it."""

from __future__ import annotations

from dataclasses import replace
from fractions import Fraction
from typing import TYPE_CHECKING, Any

import sympy
from flint import fmpq

from geomtorsion.errors import CoordinateError, ExpressionError
from geomtorsion.exact import derivation, inversion
from geomtorsion.exact.element import Element
from geomtorsion.exact.generators import Branch, Generator
from geomtorsion.exact.ring import Ring
from geomtorsion.exact.sample import Sample

if TYPE_CHECKING:
    from collections.abc import Iterable, Mapping, Sequence


class Field(Ring):
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
        complex: bool = False,
        sample: Mapping[sympy.Symbol, Any] | None = None,
        branches: Mapping[sympy.Expr, sympy.Expr] | None = None,
    ) -> None:
        if len(set(symbols)) != len(symbols):
            raise CoordinateError(f"symbols are repeated in {tuple(symbols)}; name each once")
        super().__init__()
        self.is_complex = complex
        self.chosen = dict(branches or {})
        self.generators: list[Generator] = []
        self.by_name: dict[str, Generator] = {}
        self._generator_diffs: dict[tuple[str, sympy.Symbol], Element] = {}
        self._factor_diffs: dict[tuple[int, sympy.Symbol], Element] = {}
        self._branches: dict[sympy.Expr, Branch] = {}
        self.tables: dict[str, Any] = {}
        self.rooted: list[Element] = []
        self._rooted_keys: set[Element] = set()
        self.all_sure = True
        self.symbols: tuple[sympy.Symbol, ...] = ()
        self._symbol_elements: dict[sympy.Symbol, Element] = {}
        self.sample = Sample(self, sample or {})
        self._add_symbols(symbols)
        if complex:
            # First of all, so that later roots are compared with it.
            self.add(Generator("imaginary", "I", sympy.I, frozenset(), 2, self.rational(-1)))
        from geomtorsion.exact.reading import Reader

        self._reader = Reader(self)

    def declare(self, symbols: Iterable[sympy.Symbol]) -> None:
        """Adds parameters that come up later, such as the share of a blend."""
        self._add_symbols([symbol for symbol in symbols if symbol not in self._symbol_elements])

    def _add_symbols(self, symbols: Sequence[sympy.Symbol]) -> None:
        # The first symbol leads, so that factors read r - 2*M with r the coordinate.
        for symbol in reversed(symbols):
            name = f"s{len(self.generators)}"
            element = self.add(Generator("symbol", name, symbol, frozenset((symbol,))))
            self._symbol_elements[symbol] = element
        self.symbols = (*self.symbols, *symbols)

    def add(self, generator: Generator) -> Element:
        """Adds one generator and returns it as an element.

        What is built from a generator whose independence is not proved is not proved either.
        """
        if generator.sure and not self.all_sure and self._rests_on_unsure(generator):
            generator = replace(generator, sure=False)
        self._grow(generator.name)
        self.generators.insert(0, generator)
        self.by_name[generator.name] = generator
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

    def _rests_on_unsure(self, generator: Generator) -> bool:
        """Whether the relation or the argument of a generator contains unproved ones."""
        argument = generator.argument
        parts = [generator.tail, *(argument if isinstance(argument, tuple) else (argument,))]
        return any(
            not known.sure
            for part in parts
            if isinstance(part, Element)
            for known in self.generators_of(part)
        )

    def add_root(
        self, tail: Element, order: int, sure: bool, base: tuple[Element, int] | None = None
    ) -> Element:
        """w with w**order = tail, added if new; base = (f, n): w is the n-th root of f."""
        for known in self.generators:
            if known.kind == "root" and known.degree == order and known.tail == tail:
                return self.generator_element(known)
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
        return self.generator_element(self.by_name["I"])

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

    def from_json(self, data: Mapping[str, Any], functions: Iterable[str] = ()) -> Element:
        """The element that `Element.to_json` wrote, read through the whitelist parser."""
        from geomtorsion.exact.exchange import from_json

        return from_json(self, data, functions)

    @property
    def branches(self) -> tuple[Branch, ...]:
        """The signs with which roots were read, where the symbols' assumptions left a choice."""
        return tuple(self._branches.values())

    def note_rooted(self, denominator: Element) -> None:
        """Notes a denominator that contains roots, so that it can be written as it was."""
        if denominator not in self._rooted_keys:
            self._rooted_keys.add(denominator)
            self.rooted.append(denominator)

    def state_branch(self, branch: Branch) -> None:
        """Notes the sign with which a root was read."""
        self._branches.setdefault(branch.radical, branch)

    def inverse(self, element: Element) -> Element:
        """1 over an element, its denominator free of algebraic generators."""
        if not element._num:
            raise ZeroDivisionError("division by an element that is exactly zero")
        return inversion.inverse(self, element)

    def root(self, element: Element, order: int, radical: sympy.Expr | None = None) -> Element:
        """The root of an order, positive at the sample point; adds a generator if it must."""
        from geomtorsion.exact import roots

        return roots.root(self, element, order, radical)

    def generators_of(self, element: Element) -> list[Generator]:
        """The generators that occur in an element."""
        used = [d > 0 for d in self.lift(element).degrees()]
        for index, _ in element._den:
            for position, degree in enumerate(self.factors[index].degrees()):
                used[position] |= degree > 0
        return [g for g, here in zip(self.generators, used, strict=True) if here]

    def conjugate(self, element: Element) -> Element:
        """The element with I replaced by -I, also inside roots, logs and exponents."""
        if not self.is_complex:
            return element
        position = self.generators.index(self.by_name["I"])
        if any(g.shown.has(sympy.I) and g.kind != "imaginary" for g in self.generators_of(element)):
            return self.read(element.sympy.xreplace({sympy.I: -sympy.I}))
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

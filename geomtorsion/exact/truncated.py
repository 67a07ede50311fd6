"""Truncated: power series in a small parameter, cut after an order, with exact coefficients."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from fractions import Fraction
from itertools import product
from math import factorial, prod
from typing import TYPE_CHECKING, Any, cast

import sympy
from sympy.core.function import AppliedUndef

from geomtorsion.errors import ArgumentError, LimitError, SingularPointError, UndecidedError
from geomtorsion.exact.element import Certainty, Element, Term, least_certain
from geomtorsion.support import checks
from geomtorsion.support.exclusive import exclusive

if TYPE_CHECKING:
    import flint
    import mpmath

    from geomtorsion.exact.element import Value
    from geomtorsion.exact.field import Field
    from geomtorsion.exact.generators import Branch, Generator, Names


@exclusive
class Truncated(Element):
    """A series c0 + c1 epsilon + ... + cn epsilon^n of a `TruncatedField`.

    parts: the coefficients c0 ... cn, elements of the exact field below.
    """

    __slots__ = ("filled", "parts")

    # The shared arithmetic of elements then asks for no polynomial.
    is_kept = True
    _level = -1
    _field: Any

    def __init__(self, field: TruncatedField, parts: Sequence[Element]) -> None:
        self._field = field
        self.parts: tuple[Element, ...] = tuple(parts)
        # Pairs (order, coefficient), without coefficients that are plainly zero.
        self.filled: tuple[tuple[int, Element], ...] = tuple(
            (k, x) for k, x in enumerate(self.parts) if not _is_plain_zero(x)
        )
        self._bits = self._diffs = self._form = self._hash = self._images = self._sympy = None

    def _refuse(self) -> object:
        return self._field.tables

    # What compiled code and proofs ask of an element of an exact field.
    _num = _den = _recipe = property(_refuse)  # pyright: ignore[reportAssignmentType]

    @property
    def is_zero(self) -> bool | None:
        """Whether all coefficients vanish."""
        verdicts = {part.is_zero for _, part in self.filled}
        return False if False in verdicts else None if None in verdicts else True

    @property
    def is_rational(self) -> bool:
        """Whether the series is a rational number."""
        return all(k == 0 for k, _ in self.filled) and self.parts[0].is_rational

    @property
    def is_one(self) -> bool:
        """Whether the series is the number one."""
        return len(self.filled) == 1 and self.parts[0].is_one

    @property
    def length(self) -> float:
        """How many terms all coefficients have together."""
        return sum(part.length for _, part in self.filled)

    def as_fraction(self) -> Fraction:
        """See Element.as_fraction."""
        if not self.is_rational:
            raise ValueError(f"{self} is not a rational number")
        return self.parts[0].as_fraction()

    @property
    def symbols(self) -> frozenset[sympy.Symbol]:
        """The coordinates and parameters on which the series depends."""
        symbol_sets = [part.symbols for _, part in self.filled]
        small = {self._field.symbol} if any(k for k, _ in self.filled) else set()
        return frozenset().union(small, *symbol_sets)

    def written_as(self, expression: sympy.Expr) -> Element:
        """See Element.written_as."""
        series = Truncated(self._field, self.parts)
        series._sympy = expression
        return series

    def __hash__(self) -> int:
        return hash(self.parts)


def _is_plain_zero(element: Element) -> bool:
    """Whether an element is zero without a decision."""
    if element is element.field.zero:
        return True
    if isinstance(element, Truncated):
        return not element.filled
    return not element.is_kept and not element._num


@exclusive
class TruncatedField:
    """Series in a small parameter over an exact field, with the interface of `Field`.

    base: the exact field of the coefficients.
    symbol: the small parameter. order: the last power that is kept.

    Examples
    --------
    >>> from geomtorsion.exact import Field
    >>> x, epsilon = sympy.symbols("x epsilon", positive=True)
    >>> series = TruncatedField(Field([x, epsilon]), epsilon, 2)
    >>> root = series.read(sympy.sqrt(1 + epsilon * x))
    >>> root.sympy, (root * root - 1).sympy, (1 / root).sympy
    (-epsilon**2*x**2/8 + epsilon*x/2 + 1, epsilon*x, 3*epsilon**2*x**2/8 - epsilon*x/2 + 1)
    """

    def __init__(self, base: Field, symbol: sympy.Symbol, order: int) -> None:
        self.base = base
        self.symbol = symbol
        self.order = order
        self.owner: object = None
        self.zero: Truncated = Truncated(self, (base.zero,) * (order + 1))
        self.one: Truncated = self.raised(base.one)
        self.is_complex = base.is_complex

    def __reduce__(self) -> tuple[object, ...]:
        if self.owner is not None:
            return getattr, (self.owner, "field")
        return type(self), (self.base, self.symbol, self.order)

    def __deepcopy__(self, _: object) -> TruncatedField:
        """Itself: it only grows, and growth changes no element."""
        return self

    @property
    def tables(self) -> object:
        """Refused: compiled code needs an exact field, not series."""
        raise LimitError(
            f"expected exact components, got series in {self.symbol} cut after order "
            f"{self.order}. Take one order with tensor.order(k), or the frame that was expanded."
        )

    # -- what the exact field knows --------------------------------------------------------------

    @property
    def exact(self) -> Field:
        """The exact field of the coefficients."""
        return self.base.exact

    @property
    def symbols(self) -> tuple[sympy.Symbol, ...]:
        """Coordinates and parameters."""
        return self.base.symbols

    @property
    def generators(self) -> Sequence[Generator]:
        """The generators of the exact field."""
        return self.base.generators

    @property
    def branches(self) -> tuple[Branch, ...]:
        """The signs with which roots were read."""
        return self.base.branches

    @property
    def relied_on(self) -> tuple[Branch, ...]:
        """The branches on which values rely."""
        return self.base.relied_on

    @property
    def chosen(self) -> dict[sympy.Expr, sympy.Expr]:
        """Chosen values of roots."""
        return self.base.chosen

    @property
    def sample(self) -> object:
        """The point at which signs of roots are read."""
        return self.base.sample

    @property
    def imaginary(self) -> Element:
        """The imaginary unit."""
        return self.raised(self.base.imaginary)

    def settle(self) -> None:
        """Fix the branches on which elements rely."""
        self.base.settle()

    def declare(self, symbols: Iterable[sympy.Symbol]) -> None:
        """Add parameters after the field was made."""
        self.base.declare(symbols)

    def with_symbol(self, symbol: sympy.Symbol, value: Value) -> Field:
        """An exact field over one more symbol."""
        return self.base.with_symbol(symbol, value)

    def generators_of(self, element: Truncated) -> list[Generator]:
        """The generators that occur in the coefficients."""
        generators = {id(g): g for _, part in element.filled for g in self.base.generators_of(part)}
        return list(generators.values())

    def generator_element(self, generator: Generator) -> Element:
        """A generator as an element of the exact field."""
        return self.base.generator_element(generator)

    # -- arithmetic ------------------------------------------------------------------------------

    def raised(self, element: Element) -> Truncated:
        """An element of the exact field as a series."""
        return Truncated(self, (element, *(self.base.zero,) * self.order))

    def rational(self, p: int | Fraction | flint.fmpq, q: int = 1) -> Element:
        """The rational number p/q."""
        return self.raised(self.base.rational(p, q))

    def scaled(self, element: Truncated, factor: int | Fraction | flint.fmpq) -> Element:
        """A rational multiple."""
        if not factor or element is self.zero:
            return self.zero
        return Truncated(self, [self.base.scaled(part, factor) for part in element.parts])

    def sum(self, terms: Iterable[Term]) -> Truncated:
        """A sum of products (rational coefficient, series, series, ...), order by order."""
        collected: list[list[Term]] = [[] for _ in range(self.order + 1)]
        for coefficient, *factors in terms:
            products: list[tuple[int, Term]] = [(0, (coefficient,))]
            for factor in factors:
                products = [
                    (k + j, (*head, part))
                    for k, head in products
                    for j, part in factor.filled
                    if k + j <= self.order
                ]
            for k, term in products:
                collected[k].append(term)
        if not any(collected):
            return self.zero
        return Truncated(self, [self.base.sum(own) if own else self.base.zero for own in collected])

    def inverse(self, element: Truncated, briefly: bool = False) -> Element:
        """1 over a series that does not vanish at order zero."""
        first = element.parts[0]
        if element.is_zero:
            raise ZeroDivisionError("division by a series that is exactly zero")
        self._check_leading(element, "1 over it")
        below = self.base.inverse(first, briefly)
        coefficients = [below]
        for k in range(1, self.order + 1):
            terms = [(-1, below, element.parts[j], coefficients[k - j]) for j in range(1, k + 1)]
            coefficients.append(self.base.sum(terms))
        return Truncated(self, coefficients)

    def root(self, element: Truncated, order: int) -> Element:
        """The root of a series that does not vanish at order zero."""
        self._check_leading(element, "its root")
        first = self.base.root(element.parts[0], order)
        return self._power(element, Fraction(1, order), first)

    def _power(self, element: Truncated, power: Fraction, first: Element) -> Truncated:
        """A power of a series, whose coefficient at order zero is given."""
        # k b0 c_k = sum_j (power j - (k - j)) b_j c_{k-j}, from b c' = power b' c.
        below, coefficients = self.base.inverse(element.parts[0]), [first]
        for k in range(1, self.order + 1):
            terms = [
                ((power * j - (k - j)) / k, below, element.parts[j], coefficients[k - j])
                for j in range(1, k + 1)
            ]
            coefficients.append(self.base.sum(terms))
        return Truncated(self, coefficients)

    def _check_leading(self, element: Truncated, what: str) -> None:
        """Refuse a series that vanishes at order zero."""
        verdict = element.parts[0].is_zero
        if verdict is None:
            raise UndecidedError(
                f"whether {element.parts[0]} vanishes cannot be decided, so the order of {what} "
                f"is not known. {checks.KNOWN_IDENTITIES}"
            )
        if verdict:
            raise SingularPointError(
                f"expected a quantity that is regular at {self.symbol} = 0, got {element}: {what} "
                f"has no series in whole powers. Expand around another value of {self.symbol}."
            )

    def derivative(self, element: Truncated, symbol: sympy.Symbol) -> Element:
        """The derivative with respect to a coordinate or another parameter."""
        if symbol == self.symbol:
            raise LimitError(
                f"expected a derivative by another symbol, got one by {symbol}: it loses an order. "
                "Take the next order of the series."
            )
        slopes = [(k, part.diff(symbol)) for k, part in element.filled]
        parts = [self.base.zero] * (self.order + 1)
        for k, part in slopes:
            parts[k] = part
        return Truncated(self, parts) if slopes else self.zero

    def conjugate(self, element: Truncated) -> Truncated:
        """The complex conjugate; the small parameter is real."""
        return Truncated(self, [part.conjugate() for part in element.parts])

    def certainty(self, element: Truncated) -> Certainty:
        """Whether the answer of `is_zero` is proved, or the chance that it is wrong."""
        return least_certain(part.certainty for _, part in element.filled)

    # -- reading, writing and numbers ------------------------------------------------------------

    def read(self, expr: sympy.Expr | Fraction | int, where: str = "expression") -> Element:
        """Read one expression and expand it."""
        return self.read_all([(where, expr)])[0]

    def read_all(self, entries: Iterable[tuple[str, Any]]) -> list[Element]:
        """Read expressions and expand them."""
        pairs = list(entries)
        # One reading gives all angles and exponents one basis.
        free = [pair for pair in pairs if not self._is_moving(pair[1])]
        read = iter(self.base.read_all(free))
        return [
            self._expanded(value, where) if self._is_moving(value) else self.raised(next(read))
            for where, value in pairs
        ]

    def _is_moving(self, value: object) -> bool:
        """Whether an expression depends on the small parameter."""
        free: Any = getattr(value, "free_symbols", ())
        return self.symbol in free

    def _expanded(self, value: sympy.Expr, where: str) -> Truncated:
        """The series of an expression, from the series of its parts."""
        if not self._is_moving(value):
            return self.raised(self.base.read(value, where))
        if value == self.symbol:
            parts = [self.base.zero] * (self.order + 1)
            parts[1:2] = [self.base.one] * min(self.order, 1)
            return Truncated(self, parts)
        if isinstance(value, sympy.Add):
            return self.sum([(1, self._expanded(part, where)) for part in value.args])
        if isinstance(value, sympy.Mul):
            return self.sum([(1, *(self._expanded(part, where) for part in value.args))])
        if isinstance(value, sympy.Pow) and isinstance(value.exp, sympy.Rational):
            base = self._expanded(value.base, where)
            if value.exp.is_Integer:
                return cast(Truncated, base ** int(value.exp))
            self._check_leading(base, "a root of it")
            first = self.base.root(base.parts[0], int(value.exp.q)) ** int(value.exp.p)
            return self._power(base, Fraction(int(value.exp.p), int(value.exp.q)), first)
        if isinstance(value, AppliedUndef):
            places = tuple(self._expanded(part, where) for part in value.args)
            return self.jet(value.func, (0,) * len(places), places)
        if isinstance(value, sympy.Function) and len(value.args) == 1:
            return self._taylor(value, where)
        return self._differentiated(value, where)

    def _taylor(self, value: sympy.Function, where: str) -> Truncated:
        """f(c0 + rest) = sum of f^(k)(c0) rest^k / k!."""
        inner = self._expanded(value.args[0], where)
        rest = inner - self.raised(inner.parts[0])
        point, slot = inner.parts[0].sympy, sympy.Dummy("u")
        slope: sympy.Expr = value.func(slot)
        power, terms = self.one, []
        for k in range(self.order + 1):
            coefficient = self.base.read(_finite(slope.subs(slot, point).doit(), value, where))
            terms.append((Fraction(1, factorial(k)), self.raised(coefficient), power))
            slope, power = slope.diff(slot), power * rest
        return self.sum(terms)

    def jet(
        self,
        function: sympy.FunctionClass,
        orders: tuple[int, ...],
        arguments: tuple[Truncated, ...],
    ) -> Truncated:
        """A partial derivative of an unknown function at series, by Taylor's formula."""
        points = tuple(argument.parts[0] for argument in arguments)
        rests = [
            cast(Truncated, argument - self.raised(point))
            for argument, point in zip(arguments, points, strict=True)
        ]
        # A rest starts at order one, so that no more than `order` factors are needed.
        powers = [range(self.order + 1 if rest.filled else 1) for rest in rests]
        terms: list[Term] = []
        for counts in product(*powers):
            if sum(counts) <= self.order:
                up = tuple(n + k for n, k in zip(orders, counts, strict=True))
                slope = self.raised(self.base.jet(function, up, points))
                factors = [x for x, k in zip(rests, counts, strict=True) for _ in range(k)]
                terms.append((Fraction(1, prod(map(factorial, counts))), slope, *factors))
        return self.sum(terms)

    def _differentiated(self, value: sympy.Expr, where: str) -> Truncated:
        """The series by derivatives at zero."""
        parts = []
        for k in range(self.order + 1):
            at_zero = value.subs(self.symbol, 0).doit()
            parts.append(self.base.read(_finite(at_zero, value, where)) * Fraction(1, factorial(k)))
            value = value.diff(self.symbol)
        return Truncated(self, parts)

    def written(self, element: Truncated, names: Names | None = None) -> sympy.Expr:
        """The series as a sympy expression, by powers of the small parameter."""
        return sympy.Add(*(self.base.written(x, names) * self.symbol**k for k, x in element.filled))

    def value(
        self, element: Truncated, point: Mapping[Any, Value], precision: int, at: object = None
    ) -> float | complex | mpmath.mpf:
        """The value of the polynomial at a point; see `Element.evaluate`."""
        return self.polynomial(element).evaluate(point, precision, at)

    def polynomial(self, element: Truncated) -> Element:
        """The polynomial as one element of the exact field."""
        powers = [(k, self.base.symbol(self.symbol) ** k) for k, _ in element.filled]
        return self.base.sum([(1, element.parts[k], power) for k, power in powers])

    def to_json(self, element: Truncated) -> dict[str, Any]:
        """The polynomial as a JSON-ready mapping."""
        return self.base.to_json(self.polynomial(element))


def _finite(found: sympy.Basic, value: sympy.Expr, where: str) -> sympy.Expr:
    """A coefficient that has a value."""
    if not isinstance(found, sympy.Expr):
        raise ArgumentError(f"{where}: expected an expression, got {value}.")
    if found.has(sympy.zoo, sympy.nan, sympy.oo, -sympy.oo, sympy.AccumBounds):
        raise SingularPointError(
            f"{where}: expected an expression that is regular at zero, got {value}. It has no "
            "series there."
        )
    return found

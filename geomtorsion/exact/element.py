"""Elements: exact scalars in a form in which equal ones are identical, with a certainty of zero."""

from __future__ import annotations

from abc import ABC, abstractmethod
from dataclasses import dataclass
from fractions import Fraction
from math import inf
from typing import TYPE_CHECKING, Any, ClassVar, TypeVar

import flint
from flint import fmpq

from geomtorsion.errors import UndecidedError
from geomtorsion.exact import polynomials
from geomtorsion.exact.limits import LARGEST_PRODUCT, check_power, product_too_large
from geomtorsion.support.allowance import check_limits
from geomtorsion.support.exclusive import exclusive, unlocked

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence

    import mpmath
    import sympy
    from flint import fmpq_mpoly

    from geomtorsion.exact.kept import Whole
    from geomtorsion.exact.tower import Tower

    # What users give for the value of a symbol.
    Value = int | float | complex | Fraction | flint.fmpq | mpmath.mpf | sympy.Expr

Denominator = tuple[tuple[int, int], ...]
Number = int | Fraction | flint.fmpq
# Whatever has parts: expressions, elements, sums.
T = TypeVar("T")


@dataclass(frozen=True)
class Certainty:
    """Certainty of the answer whether an element vanishes.

    proved: True if the answer is proved.
    error: otherwise an upper bound on the probability that the answer is wrong; 1 if unknown.
    """

    proved: bool
    error: float = 0.0

    def __str__(self) -> str:
        if self.proved:
            return "proved"
        if self.error >= 1:
            return "undecided: no known relation decides whether it vanishes"
        return f"at a random point modulo a prime: chance of error below {self.error:.0e}"


PROVED = Certainty(proved=True)
UNDECIDED = Certainty(proved=False, error=1.0)


def least_certain(verdicts: Iterable[Certainty]) -> Certainty:
    """The certainty that all of some verdicts are right."""
    chances = [verdict.error for verdict in verdicts if not verdict.proved]
    return Certainty(proved=not chances, error=min(sum(chances), 1.0))


@exclusive
class Element(ABC):
    """A number of a differential field, canonical or lazy. Elements never change.

    A `Canonical` element is multiplied out, a `Lazy` one is kept as it was built. The size of the
    products decides which one a result is. Elements come from a `Field`, not from these classes.

    Examples
    --------
    >>> import sympy
    >>> from geomtorsion.exact import Field
    >>> x = sympy.Symbol("x")
    >>> field = Field([x])
    >>> one = field.read(sympy.sin(x) ** 2 + sympy.cos(x) ** 2)
    >>> one == 1, field.read(sympy.tan(x)), field.read(sympy.log(sympy.sin(x))).diff(x)
    (True, Element(sin(x)/cos(x)), Element(cos(x)/sin(x)))
    """

    __slots__ = ("_bits", "_diffs", "_field", "_form", "_hash", "_images", "_sympy")

    _field: Tower
    # Whether the element is kept as it was built.
    is_kept: ClassVar[bool]
    # Numerator and denominator; a lazy element is multiplied out for them.
    _num: fmpq_mpoly
    _den: Denominator
    # The number of generators over which the numerator is written; -1 for a lazy element.
    _level: int

    # Filled in on first use.
    _bits: int | None
    _diffs: dict[sympy.Symbol, Element] | None
    # What form.py made of it; its type would close a ring of imports.
    _form: Any
    _hash: int | None
    # Its values at points of the field, see `modular`: kind of point -> (place, value).
    _images: dict[object, tuple[object, Any]] | None
    _sympy: sympy.Expr | None

    @property
    @unlocked
    def field(self) -> Tower:
        """The field to which the element belongs."""
        return self._field

    def _coerced(self, other: object) -> Element | None:
        """`other` as an element of this field, or None where that makes no sense."""
        if isinstance(other, Element):
            if other._field is not self._field:
                raise UndecidedError(
                    "two elements of different fields meet; read both expressions into one field"
                )
            return other
        if isinstance(other, int | Fraction | fmpq):
            return self._field.rational(other)
        return None

    def __add__(self, other: Element | Number) -> Element:
        element = self._coerced(other)
        if element is None:
            return NotImplemented
        return self._field.sum(((1, self), (1, element)))

    __radd__ = __add__

    def __sub__(self, other: Element | Number) -> Element:
        element = self._coerced(other)
        if element is None:
            return NotImplemented
        return self._field.sum(((1, self), (-1, element)))

    def __rsub__(self, other: Number) -> Element:
        return (-self) + other

    def __mul__(self, other: Element | Number) -> Element:
        if isinstance(other, Element):
            return self._field.sum(((1, self, other),))
        if isinstance(other, int | Fraction | fmpq):
            return self._field.scaled(self, other)
        return NotImplemented

    __rmul__ = __mul__

    def __neg__(self) -> Element:
        return self._field.scaled(self, -1)

    def __truediv__(self, other: Element | Number) -> Element:
        element = self._coerced(other)
        if element is None:
            return NotImplemented
        return self * element.inverse()

    def __rtruediv__(self, other: Number) -> Element:
        return self.inverse() * other

    def __pow__(self, exponent: int) -> Element:
        if not isinstance(exponent, int):
            return NotImplemented
        if exponent < 0:
            return self.inverse() ** -exponent
        if not self.is_kept:
            check_power(self, exponent)
            if not self._den:
                return _power(self, exponent)
        result, square = self._field.one, self
        while exponent:
            if exponent & 1:
                result = result * square
            exponent >>= 1
            if exponent:
                square = square * square
        return result

    def inverse(self) -> Element:
        """1 over the element.

        Raises
        ------
        ZeroDivisionError
            the element is zero.
        """
        return self._field.inverse(self)

    def sqrt(self) -> Element:
        """The square root, positive at the field's sample point; it may add a generator."""
        return self._field.root(self, 2)

    def conjugate(self) -> Element:
        """The complex conjugate: I goes to -I, all other generators count as real."""
        return self._field.conjugate(self)

    def __eq__(self, other: object) -> bool:
        element = self._coerced(other)
        if element is None:
            return NotImplemented
        if self is element:
            return True
        if self.is_kept or element.is_kept:
            return (self - element).is_zero is True
        field = self._field
        # Denominators are canonical, so different ones mean different elements, where all
        # generators are known to be independent.
        is_same = self._den == element._den and field.lift(self) == field.lift(element)
        return is_same or (not field.all_sure and (self - element).is_zero is True)

    def __hash__(self) -> int:
        if self._hash is None:
            # The text does not depend on the ring in which the polynomial is written.
            self._hash = hash((str(self._num), self._den))
        return self._hash

    def __bool__(self) -> bool:
        raise TypeError("the truth of an element is ambiguous; use .is_zero")

    @property
    @abstractmethod
    def is_zero(self) -> bool | None:
        """Whether the element vanishes; None where an opaque function or constant leaves it open.

        Functions are opaque if not all of their relations are known (erf, Bessel; see `special`);
        so are constants such as atan(2), and odd roots of expressions with roots.
        """

    @property
    @abstractmethod
    def is_rational(self) -> bool:
        """Whether the element is a rational number."""

    @property
    @abstractmethod
    def length(self) -> float:
        """Number of terms of numerator and denominator; inf if the element is not multiplied out.

        Examples
        --------
        >>> import sympy
        >>> from geomtorsion.exact import Field
        >>> x, y = sympy.symbols("x y")
        >>> Field([x, y]).read((1 + x + y) / (x - y) ** 2).length
        7
        """

    @property
    @abstractmethod
    def is_one(self) -> bool:
        """Whether the element is canonical and the number one."""

    @property
    def certainty(self) -> Certainty:
        """Whether the answer of `is_zero` is proved, up to a chance of error, or undecided."""
        return self._field.certainty(self)

    def as_fraction(self) -> Fraction:
        """The element as a rational number.

        Raises
        ------
        ValueError
            the element is not a rational number.
        """
        if not self.is_rational:
            raise ValueError(f"{self} is not a rational number")
        # A constant polynomial has one coefficient, whatever the ring.
        value = fmpq(self._num.leading_coefficient()) if self._num else fmpq(0)
        return Fraction(int(value.p), int(value.q))

    def diff(self, symbol: sympy.Symbol) -> Element:
        """The partial derivative with respect to a coordinate or parameter."""
        if self._diffs is None:
            self._diffs = {}
        slope = self._diffs.get(symbol)
        if slope is None:
            slope = self._diffs[symbol] = self._field.derivative(self, symbol)
        return slope

    @property
    def symbols(self) -> frozenset[sympy.Symbol]:
        """The coordinates and parameters on which the element depends."""
        symbols: set[sympy.Symbol] = set()
        for generator in self._field.generators_of(self):
            symbols |= generator.depends
        return frozenset(symbols)

    def free_of(self, symbol: sympy.Symbol) -> bool:
        """Whether the element does not depend on the symbol."""
        return symbol not in self.symbols

    @property
    def sympy(self) -> sympy.Expr:
        """The element as a short sympy expression, made on first use and kept."""
        if self._sympy is None:
            self._sympy = self._field.written(self)
        return self._sympy

    def _sympy_(self) -> sympy.Expr:
        """Hook by which sympy reads the element as an expression."""
        return self.sympy

    @property
    def short(self) -> sympy.Expr:
        """The element as it is printed: sums by powers of a symbol where that is shorter.

        Examples
        --------
        >>> import sympy
        >>> from geomtorsion.exact import Field
        >>> x, y, z = sympy.symbols("x y z")
        >>> element = Field([x, y, z]).read(x**2 + 2 * x * y + y**2 + z)
        >>> element.sympy, element.short
        (x**2 + 2*x*y + y**2 + z, z + (x + y)**2)
        """
        return self._field.written(self, names=())

    @abstractmethod
    def written_as(self, expression: sympy.Expr) -> Element:
        """The same element, written in another way, such as a series by its powers."""

    def evaluate(
        self, point: Mapping[Any, Value], precision: int = 53, at: Any = None
    ) -> float | complex | mpmath.mpf:
        """The value at a point: float or complex at 53 bits, an mpmath number above.

        Parameters
        ----------
        point
            a number for every symbol (and unknown function) that the element contains.
        precision
            bits of the mantissa.
        at
            an empty table, for elements evaluated at one point: parts they share are done once.

        Raises
        ------
        MissingValueError
            a symbol of the element has no value.
        SingularPointError
            the element has no finite value there.
        """
        return self._field.value(self, point, precision, at)

    def to_json(self) -> dict[str, Any]:
        """The element as a JSON-ready mapping; `Field.from_json` reads it back."""
        return self._field.to_json(self)

    def __reduce__(self) -> tuple[object, ...]:
        return _read_again, (self._field, self.sympy)

    def __deepcopy__(self, _: object) -> Element:
        """Itself: it never changes."""
        return self

    def __str__(self) -> str:
        return str(self.sympy)

    def __repr__(self) -> str:
        return f"Element({self.sympy})"


@exclusive
class Canonical(Element):
    """An element as a numerator over a product of irreducible factors.

    The denominator holds no algebraic generator and shares no factor with the numerator, the
    numerator is reduced by all relations: two such elements are equal exactly when their parts are.
    """

    __slots__ = ("_den", "_level", "_num")

    is_kept = False

    def __init__(self, field: Tower, num: fmpq_mpoly, den: Denominator, level: int) -> None:
        self._field = field
        self._num = num
        self._den = den
        self._level = level
        self._bits = self._diffs = self._form = self._hash = self._images = self._sympy = None

    @property
    @unlocked
    def is_zero(self) -> bool | None:
        """See Element.is_zero."""
        if not self._num:
            return True
        # With proved independence a numerator that is not zero as a polynomial is not zero.
        return False if self._field.all_sure else self._field.decide_zero(self)

    @property
    @unlocked
    def is_rational(self) -> bool:
        """See Element.is_rational."""
        return not self._den and bool(self._num.is_constant())

    @property
    @unlocked
    def is_one(self) -> bool:
        """See Element.is_one."""
        return not self._den and self._num.is_one()

    @property
    def length(self) -> float:
        """See Element.length."""
        factors = self._field.factors
        return len(self._num) + sum(e * len(factors[index]) for index, e in self._den)

    def written_as(self, expression: sympy.Expr) -> Element:
        """See Element.written_as."""
        element = Canonical(self._field, self._num, self._den, self._level)
        element._sympy = expression
        return element


Term = tuple[Any, ...]


@dataclass(frozen=True, eq=False)
class Recipe:
    """How a lazy element is built: a sum of (rational, element, ...), or one over it."""

    terms: tuple[Term, ...]
    below: bool = False

    @property
    def parts(self) -> Iterator[Element]:
        """The elements that it is built from."""
        return (element for _, *elements in self.terms for element in elements)


@exclusive
class Lazy(Element):
    """An element kept as the sum, or one over the sum, from which it was built (see `kept`)."""

    __slots__ = ("_is_zero", "_recipe", "_whole")

    is_kept = True
    _level = -1

    def __init__(self, field: Tower, recipe: Recipe) -> None:
        self._field = field
        self._recipe = recipe
        # What it is multiplied out, once that was tried.
        self._whole: Whole | None = None
        self._is_zero: bool | None = None
        self._bits = self._diffs = self._form = self._hash = self._images = self._sympy = None

    @property
    def _num(self) -> fmpq_mpoly:  # pyright: ignore[reportIncompatibleVariableOverride]
        return self._field.whole(self)._num

    @property
    def _den(self) -> Denominator:  # pyright: ignore[reportIncompatibleVariableOverride]
        return self._field.whole(self)._den

    @property
    def is_zero(self) -> bool | None:
        """See Element.is_zero."""
        if self._is_zero is not None:
            return self._is_zero
        verdict = self._field.decide_zero(self)
        # Generators whose independence is not proved may turn out to depend on others.
        if self._field.all_sure:
            self._is_zero = verdict
        return verdict

    @property
    def is_rational(self) -> bool:
        """See Element.is_rational."""
        whole = self._field.brief(self)
        return whole is not None and whole.is_rational

    @property
    @unlocked
    def is_one(self) -> bool:
        """See Element.is_one."""
        return False

    @property
    def length(self) -> float:
        """See Element.length."""
        return inf

    def written_as(self, expression: sympy.Expr) -> Element:
        """See Element.written_as."""
        element = Lazy(self._field, self._recipe)
        element._sympy = expression
        return element


def _power(element: Element, exponent: int) -> Element:
    """A power of a polynomial, multiplied out: that its size is bounded has been checked."""
    field = element.field

    def product(one: Element, two: Element) -> Element:
        whole = field.added([(1, one, two)], LARGEST_PRODUCT)
        if whole is None:
            raise product_too_large(one, two)
        return whole

    result, square = field.one, element
    while exponent:
        if exponent & 1:
            result = product(result, square)
        exponent >>= 1
        if exponent:
            square = product(square, square)
    return result


def _read_again(field: Any, expression: sympy.Expr) -> Element:
    """An element from the plain data that `Element.__reduce__` gives."""
    # Such as velocities, which the field of a frame gets to know later.
    new = expression.free_symbols - set(field.symbols)
    field.declare(sorted(new, key=lambda symbol: symbol.name))
    return field.read(expression)


def inside_out(
    whole: T, parts: Callable[[T], Iterable[T]], is_done: Callable[[T], bool]
) -> Iterator[T]:
    """The whole and its parts as far as they are not done, each after its own; no recursion."""
    waiting = [] if is_done(whole) else [(whole, iter(parts(whole)))]
    while waiting:
        check_limits()
        item, left = waiting[-1]
        for part in left:
            if not is_done(part):
                waiting.append((part, iter(parts(part))))
                break
        else:
            waiting.pop()
            yield item


def in_order(element: Element, is_done: Callable[[Lazy], bool]) -> Iterator[Lazy]:
    """The lazy elements that are not done, each after its own parts."""

    def parts(one: Lazy) -> Sequence[Lazy]:
        # The last one first, so that derived elements keep their place in the field.
        return [part for part in one._recipe.parts if isinstance(part, Lazy)][::-1]

    return inside_out(element, parts, is_done) if isinstance(element, Lazy) else iter(())


def leaves(element: Element) -> Iterator[Element]:
    """The elements, multiplied out, of which it is built; each once."""
    seen: set[int] = set()
    if not element.is_kept:
        yield element
    for node in in_order(element, lambda x: id(x) in seen):
        seen.add(id(node))
        for part in node._recipe.parts:
            if not part.is_kept and id(part) not in seen:
                seen.add(id(part))
                yield part


def occurring(field: Tower, element: Element) -> int:
    """The generators that occur in what an element is built of: a bit for each, oldest first."""
    below = field.tables.setdefault("generators of factors", {})

    def of_polynomials(part: Element) -> int:
        bits = polynomials.occurring(part._num)
        for index, _ in part._den:
            if index not in below:
                below[index] = polynomials.occurring(field.factors[index])
            bits |= below[index]
        return bits

    for node in in_order(element, lambda x: x._bits is not None):
        bits = 0
        for part in node._recipe.parts:
            if part._bits is None:
                part._bits = of_polynomials(part)
            bits |= part._bits
        node._bits = bits
    if element._bits is None:
        element._bits = of_polynomials(element)
    return element._bits

"""Generic point: the point of a field at which signs are read off."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from functools import partial
from itertools import chain
from typing import TYPE_CHECKING, Any, Protocol

import mpmath
import sympy

from geomtorsion.errors import GeomtorsionError
from geomtorsion.exact.candidates import Candidates, value_of_name
from geomtorsion.exact.evaluate import LARGEST_BITS, settled_value, values
from geomtorsion.exact.generators import Generator
from geomtorsion.support.checks import expression
from geomtorsion.support.precision import EXACT_BITS, working_precision

if TYPE_CHECKING:
    from geomtorsion.exact.element import Element
    from geomtorsion.exact.evaluate import AtPoint
    from geomtorsion.exact.tower import Point, Tower

# Places tried before a radicand or the argument of a log is left negative, and at which the signs
# in a declared domain are compared.
TRIES = 96


class Places(Protocol):
    """Where the generic point of a field may be.

    is_declared: whether all of them are in a domain that was declared.
    """

    is_declared: bool

    def points(self) -> Iterator[Mapping[sympy.Expr, Any]]:
        """Values of symbols and unknown functions, the preferred point first."""
        ...

    def refusal(self) -> str:
        """The reason for a missing point, for an error."""
        ...


class Given:
    """A point that was given, as the only place."""

    is_declared = True

    def __init__(self, point: Mapping[sympy.Expr, Any]) -> None:
        self._point = dict(point)

    def points(self) -> Iterator[Mapping[sympy.Expr, Any]]:
        """The point."""
        yield self._point

    def refusal(self) -> str:
        """The reason why the point is invalid."""
        return f"it has no value at {self._point}. Give another point."


class Extended:
    """The places of another point, with values of further symbols."""

    def __init__(self, sample: Point, values: Mapping[sympy.Expr, Any]) -> None:
        self._sample, self._values = sample, dict(values)
        self.is_declared = sample.places.is_declared

    def points(self) -> Iterator[Mapping[sympy.Expr, Any]]:
        """The places from the present one on."""
        for point in chain([self._sample.values], self._sample.places.points()):
            yield {**point, **self._values}

    def refusal(self) -> str:
        """The reason for a missing point."""
        return self._sample.places.refusal()


class Anywhere:
    """The places of a field without a frame: all candidates."""

    is_declared = False

    def __init__(self, field: Tower) -> None:
        self._field = field

    def points(self) -> Iterator[Mapping[sympy.Expr, Any]]:
        """Candidates whose first symbol is the largest, then others with all symbols alike."""
        symbols = tuple(self._field.symbols)
        first, alike = Candidates(symbols, 1), Candidates(symbols, len(symbols))
        half = range(TRIES // 2)
        return chain(map(first.exact, half), map(alike.exact, half))

    def refusal(self) -> str:
        """The reason why no point is valid."""
        return "it has a value at no point that was tried. Declare a domain."


class GenericPoint:
    """A point for every symbol and unknown function, the same at every run.

    It is the first of its places. Asked to, it moves to another one, as long as every sign decided
    so far is the same there, so that new radicands come out positive.
    """

    def __init__(
        self, field: Tower, places: Mapping[sympy.Symbol, Any] | Places | None = None
    ) -> None:
        self._field = field
        if isinstance(places, Mapping):
            places = Given(places) if places else None
        self._places: Places = Anywhere(field) if places is None else places
        self._points: Iterator[Mapping[sympy.Expr, Any]] | None = None
        self._seen: list[dict[sympy.Expr, Any]] = []
        self._known: AtPoint = {}
        self._signs: list[tuple[Element, bool]] = []
        self._place = 0

    @property
    def places(self) -> Places:
        """Where the point may be."""
        return self._places

    @property
    def values(self) -> dict[sympy.Expr, Any]:
        """The values of symbols, and of the unknown functions that the places name."""
        return dict(self._at(self._place))

    def _at(self, place: int) -> dict[sympy.Expr, Any]:
        """The values at one place; the last one for all further numbers."""
        if self._points is None:
            self._points = self.places.points()
        while len(self._seen) <= place and (point := next(self._points, None)) is not None:
            self._seen.append(dict(point))
        return self._seen[min(place, len(self._seen) - 1)] if self._seen else {}

    def value(self, element: Element) -> mpmath.mpf:
        """The value of an element at the point, to about 90 digits.

        Raises
        ------
        SingularPointError
            the element is singular there, or its value is lost in cancellation.
        """
        compute = partial(values, element, self._value_of)
        # Zero is accepted at half of the bits that evaluation tries at most.
        return settled_value(compute, self._known, EXACT_BITS, LARGEST_BITS // 2)

    @property
    def given(self) -> dict[sympy.Expr, Any]:
        """The values that were given; empty where the point was searched."""
        return self.values if isinstance(self._places, Given) else {}

    def place_in_words(self) -> str:
        """The point, for stating where a branch was chosen."""
        numbers = ", ".join(
            f"{s} = {mpmath.nstr(self.value(self._field.symbol(s)), 4)}"
            for s in self._field.symbols
        )
        return f"the function is continued from {numbers}"

    def is_positive(self, element: Element) -> bool:
        """Whether the element is positive at the point; the answer binds the point."""
        sign = self._sign(element)
        self._signs.append((element, sign))
        return sign

    def sign(self, element: Element) -> int | None:
        """+1 or -1, which binds the point; None where a declared domain has both signs."""
        sign = self._sign(element)
        if self.places.is_declared:
            before = self._place
            try:
                for place in range(TRIES):
                    self._move(place)
                    has_value = self.is_surely_nonzero(element) and self._is_allowed()
                    if has_value and self._sign(element) != sign:
                        return None
            finally:
                self._move(before)
        self._signs.append((element, sign))
        return 1 if sign else -1

    def _sign(self, element: Element) -> bool:
        """Whether the real part, or where it vanishes the other, is positive."""
        try:
            value = self.value(element)
        # No value at the point: the principal branch is as good as any.
        except (GeomtorsionError, ArithmeticError, ValueError):
            return True
        real, imaginary = mpmath.re(value), mpmath.im(value)
        with working_precision(EXACT_BITS):
            negligible = mpmath.ldexp(max(abs(real), abs(imaginary)), -EXACT_BITS // 2)
            return bool(real > 0 if abs(real) > negligible else imaginary > 0)

    def prefer_positive(self, element: Element) -> bool:
        """Moves the point to where the element is positive, if that contradicts no sign."""
        sign = self._sign(element)
        # A radicand that is negative here may be positive elsewhere in the domain.
        if not sign and not self._field.is_complex:
            before = self._place
            try:
                sign = self._moved(element)
            finally:
                # Also whoever interrupts the search leaves the point where it was.
                if not sign:
                    self._move(before)
        self._signs.append((element, sign))
        return sign

    def _moved(self, element: Element) -> bool:
        """Whether the point moved to a place where the element is positive, all signs as before."""
        for place in range(1, TRIES):
            self._move(place)
            if self._sign(element) and self._is_allowed():
                return True
        return False

    def _is_allowed(self) -> bool:
        """Whether all signs that were decided hold at the present place."""
        return all(self._sign(element) == sign for element, sign in self._signs)

    def _move(self, place: int) -> None:
        if place != self._place:
            self._place, self._known = place, {}

    def is_surely_nonzero(self, element: Element) -> bool:
        """Whether two precisions agree on a value that is not zero."""
        try:
            return bool(self.value(element))
        except (GeomtorsionError, ArithmeticError, ValueError):
            return False

    def _value_of(self, generator: Generator) -> mpmath.mpf:
        return self.number_of(generator.shown)

    def number_of(self, shown: sympy.Expr) -> mpmath.mpf:
        """The value of a symbol, or of an unknown function or its derivative."""
        values_here = self._at(self._place)
        if shown in values_here:
            entry = expression(values_here[shown], str(shown))
            return mpmath.mpmathify(entry.evalf(int(mpmath.mp.dps) + 10))
        # Symbols that were declared later, and unknown functions.
        value = mpmath.mpf("0.3") + value_of_name(str(shown), self._place)
        return -value if getattr(shown, "is_negative", None) else value

"""Generic point: one point of the domain, at which signs are read off numerically."""

from __future__ import annotations

import zlib
from typing import TYPE_CHECKING, Any

import mpmath
import sympy

from geomtorsion.checks import expression
from geomtorsion.errors import GeomtorsionError
from geomtorsion.exact.evaluate import LARGEST_BITS, settled_value, values
from geomtorsion.precision import EXACT_BITS, working_precision

if TYPE_CHECKING:
    from collections.abc import Mapping

    from geomtorsion.exact.element import Element
    from geomtorsion.exact.evaluate import AtPoint
    from geomtorsion.exact.generators import Generator
    from geomtorsion.exact.tower import Tower

# Points tried before a radicand or the argument of a log is left negative.
_TRIES = 80


class GenericPoint:
    """A point for every symbol and unknown function, the same at every run.

    What the caller gives stays; the rest may move to another place as long as every sign
    decided so far is the same there, so that new radicands come out positive.
    """

    def __init__(self, field: Tower, given: Mapping[sympy.Symbol, Any]) -> None:
        self._field = field
        self._given = dict(given)
        self._known: AtPoint = {}
        self._signs: list[tuple[Element, bool]] = []
        self._place = 0

    def value(self, element: Element) -> mpmath.mpf:
        """The value of an element at the point, to about 90 digits.

        Raises
        ------
        SingularPointError
            the element is singular there, or its value drowns in cancellation.
        """

        def at_working_precision() -> mpmath.mpf:
            return values(element, self._value_of, self._known.setdefault(mpmath.mp.prec, {}))

        # Zero is accepted at half of the bits that evaluation tries at most.
        return settled_value(at_working_precision, EXACT_BITS, LARGEST_BITS // 2)

    def place_in_words(self) -> str:
        """The point, for stating where a branch was chosen."""
        values = ", ".join(
            f"{s} = {mpmath.nstr(self.value(self._field.symbol(s)), 4)}"
            for s in self._field.symbols
        )
        return f"the function is continued from {values}"

    def is_positive(self, element: Element) -> bool:
        """Whether the element is positive at the point; the answer binds the point."""
        sign = self._sign(element)
        self._signs.append((element, sign))
        return sign

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
        for place in range(1, _TRIES):
            self._move(place)
            if self._sign(element) and all(self._sign(e) == s for e, s in self._signs):
                return True
        return False

    def _move(self, place: int) -> None:
        self._place, self._known = place, {}

    def is_surely_nonzero(self, element: Element) -> bool:
        """Whether two precisions agree on a value that is not zero."""
        try:
            return bool(self.value(element))
        except (GeomtorsionError, ArithmeticError, ValueError):
            return False

    def _value_of(self, generator: Generator) -> mpmath.mpf:
        shown = generator.shown
        if shown in self._given:
            given = expression(self._given[shown], str(shown))
            return mpmath.mpmathify(given.evalf(int(mpmath.mp.dps) + 10))
        share = _share(f"{shown} {self._place}")
        if self._place:
            value = 3 * share
        elif shown in self._field.symbols:
            # Coordinates come first and are the larger ones: r > 2*M, and angles are acute.
            value = (1 + share / 10) * mpmath.mpf("0.6") ** self._field.symbols.index(shown)
        else:
            value = mpmath.mpf("0.3") + share
        return -value if getattr(shown, "is_negative", None) else value


def _share(text: str) -> mpmath.mpf:
    """A number between 0 and 1 made from a text."""
    # Made from the name, so that it is the same in every process and for every order of reading.
    seed = zlib.crc32(text.encode()) / 2**32
    return mpmath.frac(mpmath.sqrt(2) * 1000 * (seed + 1))

"""Sample: one generic point of the domain, at which signs are read off numerically."""

from __future__ import annotations

import zlib
from typing import TYPE_CHECKING, Any

import mpmath

from geomtorsion.errors import GeomtorsionError

if TYPE_CHECKING:
    from collections.abc import Mapping

    import sympy

    from geomtorsion.exact.element import Element
    from geomtorsion.exact.field import Field
    from geomtorsion.exact.generators import Generator

_BITS = 400
# A value this small relative to the precision counts as possibly zero.
_TINY = mpmath.mpf(10) ** -80


class Sample:
    """A point for every symbol and unknown function, the same at every run."""

    def __init__(self, field: Field, given: Mapping[sympy.Symbol, Any]) -> None:
        self._field = field
        self._given = dict(given)
        self._known: dict[str, Any] = {}

    def value(self, element: Element) -> Any:
        """The value of an element at the point, to about 100 digits.

        Raises
        ------
        SingularPointError
            the element is singular there.
        """
        from geomtorsion.exact.evaluate import values

        with mpmath.workprec(_BITS):
            return values(element, self._value_of, self._known)

    def is_positive(self, element: Element) -> bool:
        """Whether the element is positive at the point (by its real part, then the other)."""
        try:
            value = self.value(element)
        except (GeomtorsionError, ZeroDivisionError, ValueError):
            return True
        real, imaginary = mpmath.re(value), mpmath.im(value)
        size = max(abs(real), abs(imaginary))
        return bool(real > 0 if abs(real) > size * _TINY else imaginary > 0)

    def is_surely_nonzero(self, element: Element) -> bool:
        """Whether the value at the point is far from zero at 100 digits."""
        try:
            return bool(abs(self.value(element)) > _TINY)
        except (GeomtorsionError, ZeroDivisionError, ValueError):
            return False

    def _value_of(self, generator: Generator) -> Any:
        shown = generator.shown
        if shown in self._given:
            given = self._given[shown]
            if isinstance(given, int | float):
                return mpmath.mpf(given)
            return mpmath.mpmathify(given.evalf(130) if hasattr(given, "evalf") else given)
        # A fixed irrational-looking number in (0.3, 1.1) made from the name.
        seed = zlib.crc32(str(shown).encode()) / 2**32
        value = mpmath.mpf("0.3") + mpmath.mpf("0.8") * mpmath.frac(
            mpmath.sqrt(2) * 1000 * (seed + 1)
        )
        return -value if getattr(shown, "is_negative", None) else value

"""domain: the symbols that may occur in an answer, and their range."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from itertools import islice
from typing import TYPE_CHECKING

import sympy
from sympy.core.relational import Relational

from geomtorsion.exact import Field
from geomtorsion.geometry.validation import RealPoints
from geomtorsion.support.caching import cached_property
from geomtorsion.support.checks import GREEK

if TYPE_CHECKING:
    from geomtorsion.geometry import Frame

Point = Mapping[sympy.Symbol, sympy.Rational]
# As many points decide where in the domain an answer is right; each exact decision is separate.
POINTS = 24


@dataclass(frozen=True, eq=False)
class Domain:
    """Symbols with the domain of their values.

    symbols: the symbols that may occur in an answer, in order.
    relations: relations between them, such as 0 < x.

    Examples
    --------
    >>> x = sympy.Symbol("x", real=True)
    >>> domain = Domain((x,), (x > 0, x < 1))
    >>> all(0 < value < 1 for point in domain.points for value in point.values())
    True
    """

    symbols: tuple[sympy.Symbol, ...] = ()
    relations: tuple[Relational, ...] = ()

    @classmethod
    def of(cls, frame: Frame, *more: sympy.Symbol) -> Domain:
        """The coordinates and parameters of a frame, and further symbols."""
        return cls((*frame.coordinates, *frame.parameters, *more), frame.domain)

    @cached_property
    def names(self) -> Mapping[str, sympy.Symbol]:
        """Name -> symbol; Greek letters may also be typed directly."""
        table = {symbol.name: symbol for symbol in self.symbols}
        for symbol in self.symbols:
            for word, letter in GREEK.items():
                if symbol.name.startswith(word) and not symbol.name[len(word) :].isalpha():
                    table.setdefault(letter + symbol.name[len(word) :], symbol)
        return table

    @cached_property
    def points(self) -> tuple[Point, ...]:
        """Points all over the domain, always the same ones."""
        return tuple(islice(RealPoints(self.symbols, (), self.relations).points(), POINTS))

    @property
    def places(self) -> tuple[Point, ...]:
        """The points; a single point without coordinates if there are no symbols."""
        return self.points if self.symbols else ({},)

    def field(self) -> Field:
        """A fresh exact field over the symbols: no answer affects the next one."""
        return Field(self.symbols, sample=self.points[0] if self.symbols else None)

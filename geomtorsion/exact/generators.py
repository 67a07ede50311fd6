"""Generators: the independent symbols that a differential field is built from."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    import sympy
    from flint import fmpq

    from geomtorsion.exact.element import Element


@dataclass(frozen=True, eq=False)
class Generator:
    """One generator of a field: a coordinate, cos, exp, a root, a jet of an unknown function.

    kind
        symbol, cos, sin, cosh, sinh, exp, log, primitive, root, imaginary, chebyshev,
        jet, constant or opaque.
    name
        its variable name inside the polynomial ring.
    shown
        its sympy expression.
    depends
        sympy symbols on which it depends.
    degree, tail
        degree 0: transcendental; degree n: algebraic, generator**n = tail.
    middle
        further terms (power, rational) of that relation: + rational * generator**power.
    argument
        what its derivative is built from (the angle, the exponent, the radicand ...).
    sure
        False where independence of the other generators is not proved.
    """

    kind: str
    name: str
    shown: sympy.Expr
    depends: frozenset[sympy.Symbol]
    degree: int = 0
    tail: Element | None = None
    middle: tuple[tuple[int, fmpq], ...] = ()
    argument: Any = None
    sure: bool = True


Generators = tuple[Generator, ...]


@dataclass(frozen=True)
class Branch:
    """The choice of sign with which a root was read.

    radical
        the sympy expression that was read.
    read_as
        the sympy expression that it was replaced with.
    words
        part of the domain where the replacement is right, unless `holds` is enough.
    holds
        an element that is positive where it is right; None if no single element expresses it.
    """

    radical: sympy.Expr
    read_as: sympy.Expr
    words: str
    holds: Element | None = None

    @property
    def condition(self) -> str:
        """Where in the domain the replacement is right, in words."""
        return self.words or f"{self.holds} >= 0"

    def __str__(self) -> str:
        return f"{self.radical} read as {self.read_as}: right where {self.condition}"


@dataclass(frozen=True, eq=False)
class Name:
    """A quantity that is written by its name.

    generator: its notation; it belongs to no field.
    quantity: its value, multiplied out.
    """

    generator: Generator
    quantity: Element


Names = tuple[Name, ...]

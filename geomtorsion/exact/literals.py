"""Literals: what the letters in sums stand for, and products of them."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from fractions import Fraction
from typing import Any

from geomtorsion.exact.factoring import TooLong
from geomtorsion.exact.sums import Sums, Term

# Higher powers than this are refused: they would be spelt out.
_HIGHEST = 24


class Literals:
    """Literals of sums with what they stand for; written out as a straight line in the end."""

    def __init__(self, arguments: Sequence[str], constants: Iterable[str]) -> None:
        self.sums = Sums()
        self.constants = set(constants)
        self.symbols: dict[str, Term] = {}
        self.meaning: dict[int, tuple[Any, ...]] = {}
        # Literal of a root -> degree and what stands below it.
        self.roots: dict[int, tuple[int, Term]] = {}
        self._known: dict[Any, Term] = {}
        for name in arguments:
            self.symbols[name] = self._made(("symbol", name), constant=name in self.constants)

    def _made(self, meaning: tuple[Any, ...], *, constant: bool) -> Term:
        literal = self.sums.fresh(constant=constant)
        self.meaning[literal] = meaning
        return (Fraction(1), (literal,), ()) if constant else (Fraction(1), (), (literal,))

    def digits(self, value: Any) -> Term:
        """A number that is not rational."""
        key = ("digits", str(value))
        if key not in self._known:
            self._known[key] = self._made(("digits", value), constant=True)
        return self._known[key]

    def call(self, name: str, *inner: Term) -> Term:
        """A function of terms."""
        key = (name, *inner)
        if key not in self._known:
            numbers = tuple(self.sums.entered([term]) for term in inner)
            free = not any(rest for _, _, rest in inner)
            self._known[key] = self._made(("call", name, numbers), constant=free)
        return self._known[key]

    def root(self, degree: int, inner: Term) -> Term:
        """A root of a term."""
        key = (degree, inner)
        if key not in self._known:
            number = self.sums.entered([inner])
            found = self._made(("root", degree, number), constant=not inner[2])
            self._known[key] = found
            self.roots[(found[1] or found[2])[0]] = (degree, inner)
        return self._known[key]

    def power(self, term: Term, exponent: int) -> Term:
        """A term to a whole power."""
        if exponent == 1:
            return term
        if abs(exponent) > _HIGHEST:
            raise TooLong
        number, parameters, rest = term
        sign = -1 if exponent < 0 else 1
        spelt = tuple(sorted(sign * literal for literal in parameters * abs(exponent)))
        other = tuple(sorted(sign * literal for literal in rest * abs(exponent)))
        return (number**exponent, spelt, other)

    def times(self, terms: Sequence[Term]) -> Term:
        """A product of terms; a root as often as its degree is what stands below it."""
        number, parameters, rest = Fraction(1), list[int](), list[int]()
        for value, some, others in terms:
            number *= value
            parameters += some
            rest += others
        for entries in (parameters, rest):
            for literal in sorted(set(map(abs, entries)) & self.roots.keys()):
                degree, inner = self.roots[literal]
                above, below = entries.count(literal), entries.count(-literal)
                for sign, times in ((1, above // degree), (-1, below // degree)):
                    for _ in range(times * degree):
                        entries.remove(sign * literal)
                    if times:
                        value, some, others = self.power(inner, sign * times)
                        number *= value
                        parameters += some
                        rest += others
        return (number, tuple(sorted(parameters)), tuple(sorted(rest)))

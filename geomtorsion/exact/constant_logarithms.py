"""Constant logarithms: linear relations among logarithms and arcs of numbers, found and proved.

4 atan(1/5) - atan(1/239) = pi/4 (Machin 1706) is a relation of whole numbers among logarithms of
algebraic numbers.  Lattice reduction finds it (Lenstra, Lenstra, Lovasz 1982); that the product of
the powers of these numbers is one proves it, and of arcs the value says how many turns it leaves.
"""

from __future__ import annotations

from dataclasses import dataclass
from math import lcm
from typing import TYPE_CHECKING, SupportsInt

import mpmath
import sympy
from flint import fmpq, fmpz_mat

from geomtorsion.errors import GeomtorsionError
from geomtorsion.exact.arguments import of_inverse_function, power_of_pair, sum_of_angles
from geomtorsion.exact.limits import LARGEST_MULTIPLE
from geomtorsion.precision import EXACT_BITS, working_precision

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence

    from geomtorsion.exact.arguments import Pair
    from geomtorsion.exact.element import Element
    from geomtorsion.exact.tower import Tower


@dataclass(frozen=True, eq=False)
class _Known:
    """A constant: its value, and the number of which a multiple of it is the logarithm.

    power: cos and sin of an arc; of a logarithm the number that is exp(times * value).
    prime: whether it is the logarithm of a prime number.
    """

    element: Element
    value: mpmath.mpf
    power: Element | Pair
    times: int = 1
    prime: bool = False


class ConstantLogarithms:
    """The independent logarithms and arcs of numbers of one field."""

    def __init__(self, field: Tower) -> None:
        self._field = field
        self._logs: list[_Known] = []
        self._arcs: list[_Known] = []

    def placed(
        self, name: str, inner: Element, arguments: tuple[Element, ...], new: Callable[[], Element]
    ) -> Element:
        """A function of numbers by those that are known, or the generator that `new` adds."""
        value = self._value(name, arguments)
        try:
            arc = of_inverse_function(self._field, name, inner, arguments)
            times, power = (1, arc) if arc is not None else self._exponential(name, inner)
        # A root that cannot be taken, such as that of a number too large to be factored.
        except GeomtorsionError:
            return new()
        if value is None or power is None:
            return new()
        known = self._logs if arc is None else self._arcs
        prime = name == "log" and inner.is_rational
        # Whole numbers have one factorization: logarithms of primes are independent.
        if not prime or not all(x.prime for x in known):
            found = self._combination(known, value, power, times)
            if found is not None:
                return found
        element = new()
        known.append(_Known(element, value, power, times, prime))
        return element

    def _value(self, name: str, arguments: tuple[Element, ...]) -> mpmath.mpf | None:
        """The value of the function if it is real, else None."""
        try:
            with working_precision(EXACT_BITS):
                value = getattr(mpmath, name)(*map(self._field.sample.value, arguments))
        except (GeomtorsionError, ArithmeticError, ValueError):
            return None
        return value if isinstance(value, mpmath.mpf) else None

    def _exponential(self, name: str, inner: Element) -> tuple[int, Element | None]:
        """(n, e) with exp(n * function) = e."""
        if name == "log":
            return 1, inner
        if name in ("asinh", "acosh"):
            return 1, inner + (inner * inner + (1 if name == "asinh" else -1)).sqrt()
        if name == "atanh":
            return 2, (inner + 1) / (1 - inner)
        if name == "acoth":
            return 2, (inner + 1) / (inner - 1)
        return 1, None

    def _combination(
        self, known: list[_Known], value: mpmath.mpf, power: Element | Pair, times: int
    ) -> Element | None:
        """The new constant by those that are known, if a relation is found and proved."""
        arcs = isinstance(power, tuple)
        field = self._field
        parts = [_Known(field.zero, value, power, times), *known]
        with working_precision(EXACT_BITS):
            values = [part.value for part in parts] + ([+mpmath.pi] if arcs else [])
            relation = _relation(values)
        if relation is None:
            return None
        numbers = relation[: len(parts)]
        try:
            holds = _is_turned(parts, numbers, relation[-1]) if arcs else _is_one(parts, numbers)
        except (GeomtorsionError, ZeroDivisionError):
            return None
        if not holds:
            return None
        terms = [(fmpq(-n, numbers[0]), x.element) for n, x in zip(numbers, parts, strict=True)]
        if arcs and relation[-1]:
            terms.append((fmpq(-relation[-1], numbers[0]), field.read(sympy.pi)))
        return field.sum([term for term in terms[1:] if term[0]])


def _relation(values: list[mpmath.mpf]) -> list[int] | None:
    """Small whole numbers n, the first not zero, with sum n * value = 0 as far as is known."""
    # A lattice of vectors (n, scale * sum n * value): a relation is a short one.
    # Half of the bits tell relations from chance, and rounding is far below them.
    scale = EXACT_BITS // 2
    rows = [
        [int(j == k) for j in range(len(values))] + [int(mpmath.nint(mpmath.ldexp(value, scale)))]
        for k, value in enumerate(values)
    ]
    for row in _reduced(rows):
        *numbers, rest = (int(x) for x in row)
        size = sum(map(abs, numbers))
        if numbers[0] and abs(rest) <= size and max(map(abs, numbers)) <= LARGEST_MULTIPLE:
            return numbers
    return None


def _reduced(rows: list[list[int]]) -> Sequence[Sequence[SupportsInt]]:
    """A short basis of the lattice that the rows span."""
    return fmpz_mat(rows).lll().tolist()


def _is_turned(parts: list[_Known], numbers: list[int], halves: int) -> bool:
    """Whether a sum of arcs is -halves * pi: by cos and sin, the whole turns by its value."""
    field = parts[0].element.field
    cos, sin = field.one, field.zero
    for part, count in zip(parts, numbers, strict=True):
        assert isinstance(part.power, tuple)
        c, s = power_of_pair(part.power, abs(count), field)
        cos, sin = sum_of_angles((cos, sin), (c, -s if count < 0 else s))
    return (cos - (-1) ** (halves % 2)).is_zero is True and sin.is_zero is True


def _is_one(parts: list[_Known], numbers: list[int]) -> bool:
    """Whether the product of the powers of numbers is one."""
    common = lcm(*(part.times for part in parts))
    product = parts[0].element.field.one
    for part, count in zip(parts, numbers, strict=True):
        assert not isinstance(part.power, tuple)
        product = product * part.power ** (count * common // part.times)
    return (product - 1).is_zero is True

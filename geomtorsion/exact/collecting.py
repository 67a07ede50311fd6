"""Collecting: sums by the powers of a symbol or of a named quantity, where that is shorter.

An expanded numerator such as Lambda*a**4*cos(theta)**4 + 2*Lambda*a**2*r**2*cos(theta)**2 +
Lambda*r**4 + Q**2 is Lambda*(a**2*cos(theta)**2 + r**2)**2 + Q**2 as a person writes it, and
Lambda*Sigma**2 + Q**2 where a**2*cos(theta)**2 + r**2 has the name Sigma.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from geomtorsion.exact.form import Form, Sum, form
from geomtorsion.exact.limits import FACTORED_HERE
from geomtorsion.exact.roots import coefficients

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator

    from flint import fmpq, fmpq_mpoly

    from geomtorsion.exact.element import Element
    from geomtorsion.exact.generators import Generator, Names
    from geomtorsion.exact.tower import Tower

    # The parts of a sum as it is written, and what it is collected to, if it is.
    Written = tuple[int, tuple[Form, ...] | None]


class Collector:
    """How the sums of one field are written, each found once.

    names: quantities that are written by their names where that is shorter.
    """

    def __init__(self, names: Names = ()) -> None:
        self.names: Names = names
        self._known: dict[Sum, Written] = {}

    def collected(self, base: Sum) -> tuple[Form, ...] | None:
        """The terms of a sum by powers of one quantity; None where it is written as it is."""
        return self._written(base)[1]

    def parts_of(self, written: Form) -> int:
        """How many parts a product has as it is written: numbers, powers and pairs of brackets.

        Examples
        --------
        >>> import sympy
        >>> from geomtorsion.exact import Field
        >>> x, y, z = sympy.symbols("x y z")
        >>> element = Field([x, y, z]).read(3 * x * (y + z) ** 2)
        >>> element.sympy, Collector().parts_of(form(element))
        (3*x*(y + z)**2, 5)
        """
        return _parts(written, lambda base: self._written(base)[0])

    def _written(self, base: Sum) -> Written:
        """How a sum is written, found once."""
        if base.source is None:
            return _expanded(base), None
        if base not in self._known:
            self._known[base] = self._shortest(base, base.source)
        return self._known[base]

    def _shortest(self, base: Sum, source: Element) -> Written:
        """A sum by powers of what makes it shortest, if it is shorter at all."""
        expanded = _expanded(base)
        num = source.field.lift(source)
        # Each way takes every term in hand and factors what it puts together.
        if len(num) * sum(map(bool, num.degrees())) > FACTORED_HERE:
            return expanded, None
        # What the coefficients themselves are collected to is found for one way only.
        best = min(self._ways(source), key=_parts_at_first, default=())
        parts = sum(map(self.parts_of, best))
        return (parts, best) if 0 < parts < expanded else (expanded, None)

    def _ways(self, source: Element) -> Iterator[tuple[Form, ...]]:
        """A sum by powers of each symbol and of each name, with coefficients in factors."""
        field = source.field
        num = field.lift(source)
        for position, degree in enumerate(num.degrees()):
            parts = coefficients(field, num, position, int(degree) + 1) if degree else []
            yield from _by_powers(field, num, field.generators[position], parts)
        for name in self.names:
            for parts in _digits(field, num, name.quantity):
                yield from _by_powers(field, num, name.generator, parts)


def _by_powers(
    field: Tower, num: fmpq_mpoly, generator: Generator, parts: list[fmpq_mpoly]
) -> Iterator[tuple[Form, ...]]:
    """A sum of coefficients times powers of a generator, unless it is unchanged."""
    shared = {power: part for power, part in enumerate(parts) if part}
    # One term for each power means no change.
    if 0 < len(shared) < len(num):
        forms = {power: form(field.polynomial(part)) for power, part in shared.items()}
        yield tuple(
            Form(one.coefficient, ((generator, power), *one.powers) if power else one.powers)
            for power, one in forms.items()
        )


def _digits(field: Tower, num: fmpq_mpoly, quantity: Element) -> Iterator[list[fmpq_mpoly]]:
    """The coefficients of the powers of a quantity in a polynomial, in each way there is.

    As digits are found, by division with remainder: by one term of the quantity, which is its
    highest in one of the generators.
    """
    top, below = field.lift(quantity), field.cofactor(quantity._den, ())
    for position, degree in enumerate(top.degrees()):
        if not 0 < degree <= num.degrees()[position] or below.degrees()[position] >= degree:
            continue
        *_, lead = coefficients(field, top, position, int(degree) + 1)
        if len(lead) > 1:
            continue
        lead = lead * field.ctx.gen(position) ** int(degree)
        digits, rest, power = [], num, field.ctx.constant(1)
        while rest:
            rest, digit = _divided(rest, top, lead)
            digits.append(field.reduced(digit * power))
            power = power * below
        # A result that is not shorter could lead from name to name in a cycle.
        if all(len(digit) < len(num) for digit in digits):
            yield digits


def _divided(
    poly: fmpq_mpoly, divisor: fmpq_mpoly, lead: fmpq_mpoly
) -> tuple[fmpq_mpoly, fmpq_mpoly]:
    """(quotient, remainder), where no term of the remainder is divisible by one of the divisor."""
    least, value = lead.monomial(0), lead.leading_coefficient()
    quotient = poly.context().constant(0)
    while True:
        terms = {
            tuple(e - low for e, low in zip(monomial, least, strict=True)): x / value
            for monomial, x in poly.to_dict().items()
            if all(e >= low for e, low in zip(monomial, least, strict=True))
        }
        if not terms:
            return quotient, poly
        part = poly.context().from_dict(terms)
        quotient, poly = quotient + part, poly - part * divisor


def _parts_at_first(forms: tuple[Form, ...]) -> int:
    """The parts of a sum of products whose own sums are not collected."""
    return sum(_parts(one, _expanded) for one in forms)


def _parts(one: Form, parts_of_sum: Callable[[Sum], int]) -> int:
    sums = [base for base, _ in one.powers if isinstance(base, Sum)]
    inner = sum(parts_of_sum(base) + 1 for base in sums)
    return _with_number(one.coefficient, len(one.powers) - len(sums) + inner)


def _with_number(value: fmpq, parts: int) -> int:
    """The parts of a product, its number included."""
    return parts + 1 if abs(value) != 1 or not parts else parts


def _expanded(base: Sum) -> int:
    """The parts of a sum that is not collected."""
    return sum(_with_number(value, len(powers)) for value, powers in base.terms)

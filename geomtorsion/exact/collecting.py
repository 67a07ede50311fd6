"""Collecting: sums by the powers of one of their symbols, where that is shorter.

An expanded numerator such as Lambda*a**4*cos(theta)**4 + 2*Lambda*a**2*r**2*cos(theta)**2 +
Lambda*r**4 + Q**2 is Lambda*(a**2*cos(theta)**2 + r**2)**2 + Q**2 as a person writes it.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from geomtorsion.exact.form import Form, Sum, form
from geomtorsion.exact.limits import FACTORED_HERE
from geomtorsion.exact.radical_denominators import coefficients

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator

    from flint import fmpq

    from geomtorsion.exact.element import Element

    # The parts of a sum as it is written, and what it is collected to, if it is.
    Written = tuple[int, tuple[Form, ...] | None]


def collected(base: Sum) -> tuple[Form, ...] | None:
    """The terms of a sum by powers of one symbol; None where it is written as it is."""
    return _written(base)[1]


def parts_of(written: Form) -> int:
    """How many parts a product has as it is written: numbers, powers and pairs of brackets.

    Examples
    --------
    >>> import sympy
    >>> from geomtorsion.exact import Field
    >>> x, y, z = sympy.symbols("x y z")
    >>> element = Field([x, y, z]).read(3 * x * (y + z) ** 2)
    >>> element.sympy, parts_of(form(element))
    (3*x*(y + z)**2, 5)
    """
    return _parts(written, lambda base: _written(base)[0])


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


def _written(base: Sum) -> Written:
    """How a sum is written, found once."""
    if base.source is None:
        return _expanded(base), None
    known = base.source.field.tables.setdefault("collected", {})
    if base not in known:
        known[base] = _shortest(base, base.source)
    return known[base]


def _shortest(base: Sum, source: Element) -> Written:
    """A sum by powers of the symbol for which that is shortest, if it is shorter at all."""
    expanded = _expanded(base)
    # What the coefficients themselves are collected to is found for one symbol only.
    best = min(
        _ways(source), key=lambda forms: sum(_parts(x, _expanded) for x in forms), default=()
    )
    parts = sum(map(parts_of, best))
    return (parts, best) if 0 < parts < expanded else (expanded, None)


def _ways(source: Element) -> Iterator[tuple[Form, ...]]:
    """A sum by powers of each of its symbols, with coefficients in factors."""
    field = source.field
    num = field.lift(source)
    degrees = num.degrees()
    # Each way takes every term in hand and factors what it puts together.
    if len(num) * sum(map(bool, degrees)) > FACTORED_HERE:
        return
    for position, degree in enumerate(degrees):
        parts = coefficients(field, num, position, int(degree) + 1) if degree else []
        shared = {power: part for power, part in enumerate(parts) if part}
        # One term for each power is what was there.
        if 0 < len(shared) < len(num):
            generator = field.generators[position]
            forms = {power: form(field.polynomial(part)) for power, part in shared.items()}
            yield tuple(
                Form(one.coefficient, ((generator, power), *one.powers) if power else one.powers)
                for power, one in forms.items()
            )

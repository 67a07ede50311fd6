"""Limits: where exact work is refused because it would not end."""

from __future__ import annotations

import sys
from math import comb, isqrt, log2, prod
from typing import TYPE_CHECKING

import mpmath

from geomtorsion.errors import LimitError

if TYPE_CHECKING:
    import sympy
    from flint import fmpq

    from geomtorsion.exact.element import Element

# cos(n x) is a polynomial of degree n in cos(x).
LARGEST_MULTIPLE = 1000
# Terms of a power that is multiplied out, and pairs of terms in a product that is quickly done.
LARGEST_POWER_TERMS = 1_000_000
# Parts of an expression of sympy, which takes seconds to turn so many into text.
LARGEST_WRITTEN = LARGEST_POWER_TERMS // 4
# Pairs of terms in any product: more would take minutes, and fill the memory.
LARGEST_PRODUCT = 30_000_000
# A product of more pairs is multiplied out only on request: half a millisecond. Products that are
# multiplied out lose no digits where terms of a sum cancel.
MOST_AT_ONCE = LARGEST_POWER_TERMS // 250
# Terms times degrees: smaller polynomials are factored in less than a second, also with two
# variables of high degree.
FACTORED_HERE = LARGEST_POWER_TERMS // 50
# Terms that a sum of quotients may have over its common denominator, which nobody multiplies out.
LARGEST_KEPT = LARGEST_PRODUCT * LARGEST_POWER_TERMS
_WORD = (sys.maxsize + 1).bit_length()


class NoPointError(Exception):
    """No point modulo a prime was found at which all generators have values."""


def check_multiple(n: int, kind: str, atom: Element, unit: fmpq) -> None:
    """Refuses angles or exponents whose common unit is too fine.

    Raises
    ------
    LimitError
        a multiple above LARGEST_MULTIPLE of the common unit is needed.
    """
    if abs(n) > LARGEST_MULTIPLE:
        raise LimitError(
            f"{kind} that are rational multiples of {atom} have the common unit {unit} * {atom}, "
            f"of which the multiple {n} would be needed; the limit is {LARGEST_MULTIPLE}. "
            "Write one of the two ratios as a parameter"
        )


def check_power(base: Element, exponent: int) -> None:
    """Refuses powers that would be multiplied out to very many terms.

    Raises
    ------
    LimitError
        more than LARGEST_POWER_TERMS terms are to be expected.
    """
    terms = len(base._num)
    if terms < 2:
        return
    check_digits(base, exponent)
    if base._den:
        # A power of a quotient is kept as it is where it would be long.
        return
    field = base.field
    # What relations reduce stays below their degree.
    dense = prod(
        generator.degree or exponent * int(degree) + 1
        for generator, degree in zip(field.generators, field.lift(base).degrees(), strict=True)
        if degree
    )
    if min(comb(exponent + terms - 1, terms - 1), dense) > LARGEST_POWER_TERMS:
        raise LimitError(
            f"the power {exponent} of an expression of {terms} terms would have more than "
            f"{LARGEST_POWER_TERMS} terms, the limit; write the power as an unknown function"
        )


def terms_of_power(terms: int, exponent: int) -> int:
    """How many terms a power of a polynomial has at most."""
    return comb(exponent + terms - 1, exponent)


def product_too_large(a: Element, b: Element) -> LimitError:
    """The error for a product of polynomials that would fill the memory."""
    return LimitError(
        f"a product of {len(a._num):,} by {len(b._num):,} terms is needed; the limit is "
        f"{LARGEST_PRODUCT:,} pairs. Replace a power, a sum or a root by an unknown function"
    )


def check_size(element: Element) -> None:
    """Refuses an expression that is too long when multiplied out.

    Whatever is derived from a frame multiplies its entries by one another: a polynomial whose
    square is above the limit of a product is of no use. Numbers have to be such as Python writes.

    Raises
    ------
    LimitError
        it has more terms than the root of LARGEST_PRODUCT, or a number of too many digits.
    """
    terms, most = len(element._num), isqrt(LARGEST_PRODUCT)
    if terms > most:
        raise LimitError(
            f"the expression has {terms:,} terms when it is multiplied out; the limit is {most:,}. "
            "Replace a power or a sum in it by an unknown function of its coordinates"
        )
    check_digits(element, 1)


def check_digits(element: Element, exponent: int) -> None:
    """Refuses numbers, in a power of an expression, with more digits than Python writes.

    Raises
    ------
    LimitError
        there is one.
    """
    digits = sys.get_int_max_str_digits()
    sizes = (max(x.p.bit_length(), x.q.bit_length()) for x in element._num.coeffs())
    if digits and max(sizes, default=0) * exponent > digits * log2(10):
        raise LimitError(
            f"a number in the expression has more than {digits:,} digits when it is multiplied "
            "out. Replace it by a parameter"
        )


def check_exponent(exponent: Element) -> None:
    """Refuses exp of a number so large that mpmath and sympy would not end over its digits.

    Raises
    ------
    LimitError
        the number has more bits than a machine word.
    """
    if exponent._num and not exponent.symbols:
        size = exponent.field.sample.value(exponent)
        if mpmath.mag(abs(size)) > _WORD:
            raise LimitError(
                f"exp of a number of more than {_WORD} bits is needed. Replace it by a parameter"
            )


def check_written(shown: sympy.Expr) -> None:
    """Refuses an expression on which sympy would not end, each part counted at every occurrence.

    Raises
    ------
    LimitError
        it has more than LARGEST_WRITTEN parts.
    """
    # The size of a part with several occurrences is computed once and added for each.
    sizes: dict[int, int] = {}
    waiting: list[tuple[sympy.Basic, bool]] = [(shown, False)]
    while waiting:
        part, ready = waiting.pop()
        if id(part) in sizes:
            continue
        if ready:
            sizes[id(part)] = 1 + sum(sizes[id(inner)] for inner in part.args)
        else:
            waiting.append((part, True))
            waiting += [(inner, False) for inner in part.args if id(inner) not in sizes]
    check_parts(sizes[id(shown)], f"{sizes[id(shown)]:,}")


def check_parts(parts: int, in_words: str) -> None:
    """Refuses an expression of more than LARGEST_WRITTEN parts.

    Raises
    ------
    LimitError
        it has more.
    """
    if parts > LARGEST_WRITTEN:
        raise LimitError(
            f"an expression of {in_words} parts would be written; the limit is "
            f"{LARGEST_WRITTEN:,}. Use .at(point), numpy_function or .is_zero, which do not "
            "need it"
        )

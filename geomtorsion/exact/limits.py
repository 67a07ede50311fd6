"""Limits: where exact work is refused because it would not end."""

from __future__ import annotations

from math import comb, prod
from typing import TYPE_CHECKING

from geomtorsion.errors import LimitError

if TYPE_CHECKING:
    from flint import fmpq, fmpq_mpoly

    from geomtorsion.exact.element import Element

# cos(n x) is a polynomial of degree n in cos(x).
LARGEST_MULTIPLE = 1000
LARGEST_POWER_TERMS = 1_000_000
LARGEST_PRODUCT = 30_000_000


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
            f"{LARGEST_POWER_TERMS} terms; write the power as a parameter or a new symbol"
        )


def check_product(a: fmpq_mpoly, b: fmpq_mpoly) -> None:
    """Refuses a product of polynomials that would fill the memory.

    Raises
    ------
    LimitError
        more than LARGEST_PRODUCT pairs of terms would be multiplied.
    """
    if len(a) * len(b) > LARGEST_PRODUCT:
        raise LimitError(
            f"clearing the roots from a denominator needs a product of {len(a)} by {len(b)} "
            "terms; name one of the roots by a parameter"
        )

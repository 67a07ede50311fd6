"""Polynomials: those of FLINT in a larger ring, terms, long sums and products; their numbers."""

from __future__ import annotations

from fractions import Fraction
from itertools import compress
from typing import TYPE_CHECKING, SupportsInt, TypeVar

from flint import fmpq, fmpz

from geomtorsion.errors import LimitError

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence

    from flint import fmpq_mpoly, fmpq_mpoly_ctx


# Numbers of up to this many bits are factored in well under a second.
_BITS = 150
# Of larger ones the prime factors of up to this many bits are found.
_SMOOTH_BITS = 30
# What stands for a variable of the ring.
T = TypeVar("T")


def lifted(ctx: fmpq_mpoly_ctx, poly: fmpq_mpoly, by: int) -> fmpq_mpoly:
    """A polynomial in a ring of `by` variables more, which come first."""
    if len(poly) == 1:
        # One term is written down again more quickly.
        return ctx.from_dict({(0,) * by + m: c for m, c in poly.to_dict().items()})
    return poly.project_to_context(ctx, {k: k + by for k in range(poly.context().nvars())})


def occurring(poly: fmpq_mpoly) -> int:
    """The variables that occur in a polynomial: a bit for each, the last one first."""
    # The polynomial 0 has degrees of -1.
    return sum(1 << k for k, degree in enumerate(reversed(poly.degrees())) if degree > 0)


def powers(variables: Sequence[T], monomial: Sequence[SupportsInt]) -> tuple[tuple[T, int], ...]:
    """The variables that occur in a monomial, each with its exponent."""
    places = compress(range(len(monomial)), monomial)
    return tuple([(variables[k], int(monomial[k])) for k in places])


def terms(
    variables: Sequence[T], poly: fmpq_mpoly
) -> Iterator[tuple[fmpq, tuple[tuple[T, int], ...]]]:
    """The terms of a polynomial: coefficient and powers of variables."""
    for value, monomial in zip(poly.coeffs(), poly.monoms(), strict=True):
        yield value, powers(variables, monomial)


def split(poly: fmpq_mpoly, position: int) -> tuple[fmpq_mpoly, fmpq_mpoly]:
    """(A, B) with poly = A + B w, for the variable w at a position, degree at most 1."""
    above = poly.derivative(position)
    return poly - above * poly.context().gen(position), above


def product(one: fmpq_mpoly, two: fmpq_mpoly, pairs: int) -> fmpq_mpoly:
    """The product, in pieces of so many pairs of terms: between them one can stop."""
    if len(one) * len(two) <= pairs:
        return one * two
    long, short = (one, two) if len(one) > len(two) else (two, one)
    terms, size = list(short.to_dict().items()), max(1, pairs // len(long))
    pieces = (terms[k : k + size] for k in range(0, len(terms), size))
    return added([long * long.context().from_dict(dict(piece)) for piece in pieces])


def added(polys: list[fmpq_mpoly]) -> fmpq_mpoly:
    """The sum of polynomials, pairwise: of many long ones the cost stays n log n."""
    if len(polys) == 1:
        return polys[0]
    half = len(polys) // 2
    return added(polys[:half]) + added(polys[half:])


def prime_factors(number: fmpz | int) -> list[tuple[fmpz, int]]:
    """(prime, exponent) of a positive integer.

    Raises
    ------
    LimitError
        a part of more than 150 bits without small factors is no prime.
    """
    number = fmpz(number)
    if number.bit_length() <= _BITS:
        return list(number.factor())
    found: list[tuple[fmpz, int]] = []
    for part, exponent in number.factor_smooth(_SMOOTH_BITS):
        if part.bit_length() <= _BITS:
            found += [(prime, inner * exponent) for prime, inner in part.factor()]
        elif part.is_probable_prime():
            found.append((part, exponent))
        else:
            raise LimitError(
                f"the integer {str(part)[:20]}... of {len(str(part))} digits is too large to be "
                "factored; name it by a parameter"
            )
    return found


def as_fmpq(value: int | Fraction | fmpq) -> fmpq:
    """A rational number as FLINT takes it."""
    return fmpq(value.numerator, value.denominator) if isinstance(value, Fraction) else fmpq(value)

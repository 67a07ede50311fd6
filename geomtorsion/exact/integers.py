"""Integers: prime factors, within a limit of size."""

from __future__ import annotations

from fractions import Fraction

from flint import fmpq, fmpz

from geomtorsion.errors import LimitError

# Numbers of up to this many bits are factored in well under a second.
_BITS = 150
# Of larger ones the prime factors of up to this many bits are found.
_SMOOTH_BITS = 30


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

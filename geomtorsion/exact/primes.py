"""Primes: modulo which fields have the roots of unity that they need, and each number odd roots."""

from __future__ import annotations

import hashlib
from math import prod
from typing import TYPE_CHECKING

from flint import fmpz

from geomtorsion.exact.algebraic_constants import part_of_turn

if TYPE_CHECKING:
    from flint import fmpz_mod, fmpz_mod_ctx

    from geomtorsion.exact.generators import Generator
    from geomtorsion.exact.tower import Tower

# Bits of the primes: an accidental zero is far less probable than a broken computer.
BITS = 256
# The prime is one more than a multiple of this, so that roots of unity of all these orders and the
# square roots of small whole numbers exist; but see `order_for`.
ORDER = prod((8, 9, 25, 7, 11, 13, 17, 19, 23))


def order_for(field: Tower) -> int:
    """Order of the roots of unity that a prime has for a field.

    Where it has none of order 3, each number has one cube root; else one number in three has any.
    So with all odd degrees, unless a constant needs the roots of unity.
    """
    entry = field.tables.get("order of unity")
    if entry is None or entry[0] != field.level:
        degrees = [g.degree for g in field.generators if g.degree > 2 and not g.middle]
        left = {int(q) for degree in degrees for q, _ in fmpz(degree).factor() if q > 2}
        for needed in map(_needed, field.generators) if left else ():
            left -= {q for q in left if not needed % q}
        order = prod(q**e for q, e in fmpz(ORDER).factor() if int(q) not in left)
        entry = field.tables["order of unity"] = field.level, int(order)
    return entry[1]


def _needed(generator: Generator) -> int:
    """The order of the roots of unity in terms of which a constant is written; 1 for others."""
    share, tail = part_of_turn(generator), generator.tail
    if share is not None:
        return int(share.q)
    # Square roots of numbers are Gauss sums.
    is_root = generator.degree == 2 and tail is not None and tail.is_rational
    return tail.as_fraction().numerator if is_root and tail is not None else 1


def nth_prime(number: int, order: int) -> fmpz:
    """The prime of a number: BITS bits, without roots of unity of other parts of ORDER."""
    digest = hashlib.sha512(f"prime {number}".encode()).digest()
    start = (int.from_bytes(digest, "big") % 2 ** (BITS - 1)) | 2 ** (BITS - 1)
    prime = fmpz(start - start % order + 1)
    others = fmpz(ORDER // order)
    while not prime.is_probable_prime() or (prime - 1).gcd(others) != 1:
        prime += order
    return prime


def root_of_unity(ring: fmpz_mod_ctx, prime: fmpz, order: int) -> fmpz_mod:
    """A number of exactly an order."""
    orders = [int(q) for q, _ in fmpz(order).factor()]
    base = 2
    while True:
        root = ring(base) ** ((prime - 1) // order)
        if all(root ** (order // q) != 1 for q in orders):
            return root
        base += 1

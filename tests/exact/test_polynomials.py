"""Polynomials: integers that are factored, and integers that are too large."""

from __future__ import annotations

import pytest
import sympy as sp

from geomtorsion.errors import LimitError
from geomtorsion.exact.polynomials import prime_factors


def primes(*bits: int) -> list[int]:
    """For each number of bits, the first prime with more than that many bits."""
    return [int(sp.nextprime(2**count)) for count in bits]


def test_how_large_a_product_of_two_primes_is_factored() -> None:
    """A product of two primes is factored up to about 150 bits, in well under a second."""
    one, two = primes(64, 80)
    assert prime_factors(one * two) == [(one, 1), (two, 1)]
    one, two = primes(79, 80)
    with pytest.raises(LimitError, match="too large to be factored"):
        prime_factors(one * two)


@pytest.mark.parametrize(("bits", "found"), [(28, True), (40, False)])
def test_how_large_the_factors_of_a_larger_number_may_be(bits: int, found: bool) -> None:
    """A prime factor of 28 bits is found beside one of 160 bits; a factor of 40 bits is not."""
    one, two = primes(bits, 160)
    if found:
        assert prime_factors(one * two) == [(one, 1), (two, 1)]
    else:
        with pytest.raises(LimitError, match="too large to be factored"):
            prime_factors(one * two)

"""Polynomials: integers that are factored, and those that are too large."""

from __future__ import annotations

import pytest
import sympy as sp

from geomtorsion.errors import LimitError
from geomtorsion.exact.polynomials import prime_factors


def primes(*bits: int) -> list[int]:
    """The first prime with more than so many bits, for each."""
    return [int(sp.nextprime(2**count)) for count in bits]


def test_how_large_a_product_of_two_primes_is_factored() -> None:
    """Up to 150 bits, which takes well under a second."""
    one, two = primes(64, 80)
    assert prime_factors(one * two) == [(one, 1), (two, 1)]
    one, two = primes(79, 80)
    with pytest.raises(LimitError, match="too large to be factored"):
        prime_factors(one * two)


@pytest.mark.parametrize(("bits", "found"), [(28, True), (40, False)])
def test_how_large_the_factors_of_a_larger_number_may_be(bits: int, found: bool) -> None:
    """All but one: that may be any prime."""
    one, two = primes(bits, 160)
    if found:
        assert prime_factors(one * two) == [(one, 1), (two, 1)]
    else:
        with pytest.raises(LimitError, match="too large to be factored"):
            prime_factors(one * two)

"""Polynomials of FLINT in a larger ring: terms, long sums and products, numbers, factors.

FLINT does not react to Ctrl-C or to limits while it factors, which takes half a minute for some
polynomials of 300 terms. It factors in a process of its own, which can be ended at once, with the
same result.
"""

from __future__ import annotations

import json
import random
from fractions import Fraction
from functools import partial
from itertools import compress
from math import gcd, lcm
from operator import attrgetter
from pathlib import Path
from typing import TYPE_CHECKING, SupportsInt, TypeVar

from flint import Ordering, fmpq, fmpq_mpoly_ctx, fmpq_poly, fmpz
from flint.utils.flint_exceptions import DomainError

from geomtorsion.errors import LimitError
from geomtorsion.exact import factoring_process
from geomtorsion.exact.other_process import OtherProcess
from geomtorsion.support.allowance import check_limits

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence

    from flint import fmpq_mpoly

    Factors = tuple[fmpq, list[tuple[fmpq_mpoly, int]]]


# Numbers of up to this many bits are factored in well under a second.
_BITS = 150
# In larger numbers, prime factors of up to this many bits are found.
_SMOOTH_BITS = 30
# The value of a variable of the ring.
T = TypeVar("T")


def lifted(ctx: fmpq_mpoly_ctx, poly: fmpq_mpoly, by: int) -> fmpq_mpoly:
    """The polynomial in a ring with `by` more variables, before the others."""
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
    exponents = map(int, compress(monomial, monomial))
    return tuple(zip(compress(variables, monomial), exponents, strict=True))


def terms(
    variables: Sequence[T], poly: fmpq_mpoly
) -> Iterator[tuple[fmpq, tuple[tuple[T, int], ...]]]:
    """The terms of a polynomial: coefficient and powers of variables."""
    return zip(poly.coeffs(), map(partial(powers, variables), poly.monoms()), strict=True)


def split(poly: fmpq_mpoly, position: int) -> tuple[fmpq_mpoly, fmpq_mpoly]:
    """(A, B) with poly = A + B w, for the variable w at a position, degree at most 1."""
    above = poly.derivative(position)
    return poly - above * poly.context().gen(position), above


def product(one: fmpq_mpoly, two: fmpq_mpoly, pairs: int) -> fmpq_mpoly:
    """The product, in pieces of a limited number of pairs of terms; work can stop between them."""
    if len(one) * len(two) <= pairs:
        return one * two
    long, short = (one, two) if len(one) > len(two) else (two, one)
    terms, size = list(short.to_dict().items()), max(1, pairs // len(long))
    products = []
    for k in range(0, len(terms), size):
        check_limits()
        products.append(long * long.context().from_dict(dict(terms[k : k + size])))
    return added(products)


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
        a part of more than 150 bits without small factors is not a prime.
    """
    number = fmpz(number)
    if number.bit_length() <= _BITS:
        return list(number.factor())
    factors: list[tuple[fmpz, int]] = []
    for part, exponent in number.factor_smooth(_SMOOTH_BITS):
        if part.bit_length() <= _BITS:
            factors += [(prime, inner * exponent) for prime, inner in part.factor()]
        elif part.is_probable_prime():
            factors.append((part, exponent))
        else:
            raise LimitError(
                f"the integer {str(part)[:20]}... of {len(str(part))} digits is too large to be "
                "factored; name it by a parameter"
            )
    return factors


def as_fmpq(value: int | Fraction | fmpq) -> fmpq:
    """A rational number as FLINT takes it."""
    return fmpq(value.numerator, value.denominator) if isinstance(value, Fraction) else fmpq(value)


def factored(poly: fmpq_mpoly, largest: int) -> Factors:
    """(content, [(irreducible factor, exponent)]) of a polynomial that is not zero.

    The other process factors polynomials with too many terms times degrees.
    """
    degrees = poly.degrees()
    # With degree 1 in a variable it is irreducible up to common factors of its two coefficients.
    slopes = [poly.derivative(k) for k, degree in enumerate(degrees) if degree == 1]
    slope = min(slopes, key=len, default=None)
    # One term shares nothing where no variable divides the whole.
    single = slope is not None and len(slope) == 1 and not any(poly.term_content().degrees())
    # In few variables Flint is as fast as a line.
    if single or (len(poly) > 2 * poly.total_degree() and is_irreducible_on_a_line(poly)):
        return _irreducible(poly)
    if len(poly) * sum(degrees) > largest:
        factorization = factored_apart(poly, _OTHER)
        if factorization is not None:
            return factorization
    if slope is not None:
        shared = poly.gcd(slope)
        if shared.is_constant():
            return _irreducible(poly)
        content, rest = _irreducible(poly / shared)
        inner, factors = factored(shared, largest)
        return content * inner, factors + rest
    content, factors = poly.factor()
    return fmpq(content), [(factor, int(exponent)) for factor, exponent in factors]


def _irreducible(poly: fmpq_mpoly) -> Factors:
    """An irreducible polynomial in the form of Flint: whole numbers without a common divisor, the
    first one positive.
    """
    coefficients = poly.coeffs()
    above, below = map(attrgetter("p"), coefficients), map(attrgetter("q"), coefficients)
    content = fmpq(gcd(*map(int, above)), lcm(*map(int, below)))
    content = content if coefficients[0] > 0 else -content
    return content, [(poly / content, 1)]


def is_irreducible_on_a_line(poly: fmpq_mpoly) -> bool:
    """Whether a polynomial is irreducible on a certain line, and hence at all; False means unknown.

    If the degree on the line is the total degree, no factor is lost. By
    Hilbert's theorem nearly all lines will do, and factoring in one variable is far quicker.
    """
    numbers = random.Random(1)
    line = fmpq_mpoly_ctx.get(("t",), Ordering.lex)
    t, variables = line.gen(0), range(poly.context().nvars())
    places = [numbers.randint(-9, 9) + numbers.randint(1, 9) * t for _ in variables]
    there = poly.compose(*places, ctx=line)
    degree = int(there.total_degree())
    if degree < poly.total_degree():
        return False
    coefficients = there.to_dict()
    plain = fmpq_poly([coefficients.get((k,), 0) for k in range(degree + 1)])
    _, factors = plain.numer().factor()
    return len(factors) == 1 and factors[0][1] == 1


def known_taken_out(
    poly: fmpq_mpoly, known: list[fmpq_mpoly]
) -> tuple[fmpq, list[tuple[fmpq_mpoly, int]], fmpq_mpoly]:
    """(content, powers, rest) with poly = content * powers * rest, where rest has leading
    coefficient 1; the powers belong to variables and known irreducible polynomials.

    Trial division by a few of these takes a tenth of the time of factoring.
    """
    common, context = poly.term_content(), poly.context()
    degrees = common.degrees()
    variables, exponents = compress(context.gens(), degrees), map(int, compress(degrees, degrees))
    powers = list(zip(variables, exponents, strict=True))
    rest = poly / common
    for factor in known:
        exponent = 0
        while len(rest) > 1 and len(factor) > 1:
            try:
                rest = rest / factor
            except DomainError:
                break
            exponent += 1
        if exponent:
            powers.append((factor, exponent))
    leading = rest.leading_coefficient()
    return common.leading_coefficient() * leading, powers, rest / leading


def factored_apart(poly: fmpq_mpoly, other: OtherProcess) -> Factors | None:
    """The factors, from another process; None if no process can run."""
    ctx = poly.context()
    line = other.ask(json.dumps([ctx.nvars(), factoring_process.terms_of(poly)]))
    if not line:
        return None
    p, q, factors = json.loads(line)
    pairs = [(factoring_process.polynomial(ctx, terms), e) for terms, e in factors]
    return fmpq(fmpz(int(p)), fmpz(int(q))), pairs


_OTHER = OtherProcess(str(Path(factoring_process.__file__)))

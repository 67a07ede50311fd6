"""Polynomials: those of flint in a larger ring, their terms, long sums and products."""

from __future__ import annotations

from itertools import compress
from typing import TYPE_CHECKING, SupportsInt, TypeVar

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence

    from flint import fmpq, fmpq_mpoly, fmpq_mpoly_ctx

# What stands for a variable of the ring.
T = TypeVar("T")


def lifted(ctx: fmpq_mpoly_ctx, poly: fmpq_mpoly, by: int) -> fmpq_mpoly:
    """A polynomial in a ring of `by` variables more, which come first."""
    if len(poly) == 1:
        # One term is written down again more quickly.
        return ctx.from_dict({(0,) * by + m: c for m, c in poly.to_dict().items()})
    return poly.project_to_context(ctx, {k: k + by for k in range(poly.context().nvars())})


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

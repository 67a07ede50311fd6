"""Polynomials: those of flint in a larger ring, their long sums and products."""

from __future__ import annotations

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from flint import fmpq_mpoly, fmpq_mpoly_ctx


def lifted(ctx: fmpq_mpoly_ctx, poly: fmpq_mpoly, by: int) -> fmpq_mpoly:
    """A polynomial in a ring of `by` variables more, which come first."""
    if len(poly) > 2:
        # By the names of the variables; what is shorter is written down again more quickly.
        return poly.project_to_context(ctx)
    pad = (0,) * by
    return ctx.from_dict({pad + tuple(m): c for m, c in poly.to_dict().items()})


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

"""Factoring process: a script that factors polynomials, one JSON request per line, until they end.

It imports only flint, so that it starts in a tenth of a second.
"""

from __future__ import annotations

import json
import sys
from typing import IO, Any

from flint import Ordering, fmpq, fmpq_mpoly, fmpq_mpoly_ctx

# The terms of a polynomial: exponents, numerator and denominator as text.
Terms = list[list[Any]]


def terms_of(poly: fmpq_mpoly) -> Terms:
    """A polynomial as JSON knows it."""
    return [[list(map(int, m)), str(c.p), str(c.q)] for m, c in poly.to_dict().items()]


def polynomial(ctx: fmpq_mpoly_ctx, terms: Terms) -> fmpq_mpoly:
    """A polynomial from its terms."""
    return ctx.from_dict({tuple(m): fmpq(int(p), int(q)) for m, p, q in terms})


def ring(variables: int) -> fmpq_mpoly_ctx:
    """A ring of so many variables."""
    return fmpq_mpoly_ctx.get([f"x{k}" for k in range(variables)], Ordering.lex)


def serve(requests: IO[str], replies: IO[str]) -> None:
    """Answer each request with the content and the factors."""
    # Coefficients may have any number of digits.
    sys.set_int_max_str_digits(0)
    for line in requests:
        variables, terms = json.loads(line)
        content, factors = polynomial(ring(variables), terms).factor()
        powers = [[terms_of(factor), int(exponent)] for factor, exponent in factors]
        content = fmpq(content)
        replies.write(json.dumps([str(content.p), str(content.q), powers]) + "\n")
        replies.flush()


if __name__ == "__main__":
    serve(sys.stdin, sys.stdout)

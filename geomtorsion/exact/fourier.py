"""Fourier: high powers of cos and sin written as multiple angles, which keeps their digits.

cos(60 x) is a polynomial of degree 60 in cos(x) with coefficients near 2**59: exact, but
worthless in floating point.  As a sum of multiple angles the coefficients stay small.
"""

from __future__ import annotations

from functools import lru_cache
from math import comb
from typing import TYPE_CHECKING

import flint
import sympy
from flint import fmpq

from geomtorsion.exact import polynomials
from geomtorsion.exact.generators import Generator

if TYPE_CHECKING:
    from geomtorsion.exact.tower import Tower

Terms = dict[tuple[int, ...], flint.fmpq]
Named = list[tuple[flint.fmpq, tuple[tuple[Generator, int], ...]]]

# Up to this degree powers lose less than two digits and read better.
HIGHEST_DEGREE = 8


def high_pairs(terms: Terms, pairs: list[tuple[int, int]]) -> list[tuple[int, int]]:
    """The pairs (cos, sin) in which a polynomial has a high degree."""
    return [
        (cos, sin) for cos, sin in pairs if any(m[cos] + m[sin] > HIGHEST_DEGREE for m in terms)
    ]


def multiple_angles(field: Tower, terms: Terms, pairs: list[tuple[int, int]]) -> Named:
    """The same sum with cos**a sin**b of these pairs replaced by cos(k x) and sin(k x)."""
    collected: dict[tuple[tuple[int, ...], tuple[tuple[int, bool], ...]], fmpq] = {}
    for monomial, value in terms.items():
        rest = list(monomial)
        products: list[tuple[fmpq, tuple[tuple[int, bool], ...]]] = [(value, ())]
        for cos, sin in pairs:
            # Products of powers of one angle are sums of its multiples; angles are independent.
            waves = _harmonics(monomial[cos], monomial[sin])
            rest[cos] = rest[sin] = 0
            products = [
                (v * share, (*made, wave)) for v, made in products for wave, share in waves.items()
            ]
        for share, made in products:
            key = (tuple(rest), made)
            collected[key] = collected.get(key, fmpq(0)) + share
    named: Named = []
    for (rest, made), value in collected.items():
        if value:
            factors = [
                (_multiple(field, field.generators[sin if odd else cos], k), 1)
                for (cos, sin), (k, odd) in zip(pairs, made, strict=True)
                if k
            ]
            named.append((value, (*factors, *polynomials.powers(field.generators, rest))))
    return named


@lru_cache(maxsize=4096)
def _harmonics(a: int, b: int) -> dict[tuple[int, bool], fmpq]:
    """cos**a sin**b as {(k, is a sine): coefficient}."""
    # With z = exp(i x): cos = (z + 1/z)/2 and sin = (z - 1/z)/(2 i).
    powers: dict[int, int] = {}
    for j in range(a + 1):
        for m in range(b + 1):
            k = a - 2 * j + b - 2 * m
            powers[k] = powers.get(k, 0) + comb(a, j) * comb(b, m) * (-1) ** m
    # 1/i**b is real for even b, where z**k pairs to cosines, else to sines.
    sign = (-1) ** (b // 2)
    found: dict[tuple[int, bool], fmpq] = {}
    for k, value in powers.items():
        if k < 0 or not value:
            continue
        weight = 1 if k == 0 else 2
        found[k, bool(b % 2)] = fmpq(sign * weight * value, 2 ** (a + b))
    return found


def _multiple(field: Tower, generator: Generator, k: int) -> Generator:
    """cos or sin of k times the angle: for writing only, no generator of the field."""
    if k == 1:
        return generator
    known = field.tables.setdefault("multiples", {})
    key = (generator.name, k)
    if key not in known:
        angle = generator.argument[0] * k
        function = sympy.cos if generator.kind == "cos" else sympy.sin
        known[key] = Generator(
            generator.kind,
            f"{generator.name}_{k}",
            function(angle.sympy),
            generator.depends,
            argument=(angle, generator.argument[1]),
        )
    return known[key]

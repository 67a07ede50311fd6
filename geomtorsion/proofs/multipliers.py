"""Multipliers: proved Floquet multipliers of a closed orbit, and its stability."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from flint import acb, acb_poly, arb, arb_mat


@dataclass(frozen=True, eq=False)
class Multipliers:
    """Eigenvalues of the monodromy matrix.

    trivial: how many are exactly 1: along the motion, and across each conserved quantity.
    balls: enclosures of all others; empty where they are not separated from each other.
    stability: "attracting", "repelling", "saddle" (none on the unit circle), "elliptic" (all on the
        unit circle), "neutral" (there are no others), or "undecided".
    """

    trivial: int
    balls: tuple[acb, ...]
    stability: str

    @classmethod
    def of(cls, monodromy: arb_mat, trivial: int, *, paired: bool) -> Multipliers:
        """From a monodromy matrix in balls.

        trivial: a lower bound of the multiplicity of 1.
        paired: whether eigenvalues are proved to come in pairs l, 1/l.
        """
        n = monodromy.nrows()
        if paired and (n - trivial) % 2:
            # A real matrix of positive determinant has an even number of pairs that are their own.
            trivial += 1
        rest = list(monodromy.charpoly())
        for _ in range(trivial):
            rest = _without_one(rest)
        if len(rest) == 1:
            return cls(trivial, (), "neutral")
        if paired:
            return _of_pairs(trivial, rest)
        balls = _roots(rest)
        if not balls:
            return cls(trivial, (), "undecided")
        sizes = [abs(x) for x in balls]
        if all(x < 1 for x in sizes):
            return cls(trivial, balls, "attracting")
        if all(x > 1 for x in sizes):
            return cls(trivial, balls, "repelling")
        apart = all(x < 1 or x > 1 for x in sizes)
        return cls(trivial, balls, "saddle" if apart else "undecided")


def _without_one(row: Sequence[arb]) -> list[arb]:
    """A polynomial with the root 1, lowest power first, divided by x - 1."""
    quotient, total = [], arb(0)
    for value in reversed(row[1:]):
        total = total + value
        quotient.append(total)
    return quotient[::-1]


def _of_pairs(trivial: int, row: Sequence[arb]) -> Multipliers:
    """Roots of a polynomial whose roots are pairs l, 1/l, by their sums s = l + 1/l."""
    half = (len(row) - 1) // 2
    # x^-half p(x) = c_half + sum c_k (x^k + x^-k); x^k + x^-k is a polynomial in s (Chebyshev).
    powers = [[arb(2)], [arb(0), arb(1)]]
    for _ in range(2, half + 1):
        shifted = [arb(0), *powers[-1]]
        before = [*powers[-2], *[arb(0)] * (len(shifted) - len(powers[-2]))]
        powers.append([x - y for x, y in zip(shifted, before, strict=True)])
    sums = [arb(0)] * (half + 1)
    sums[0] = row[half]
    for k in range(1, half + 1):
        for j, value in enumerate(powers[k]):
            sums[j] += row[half + k] * value
    roots = _roots(sums)
    if not roots:
        return Multipliers(trivial, (), "undecided")
    balls: list[acb] = []
    on, off = 0, 0
    for s in roots:
        is_real = s.imag.is_zero()
        on += bool(is_real and abs(s.real) < 2)
        off += bool((is_real and abs(s.real) > 2) or s.imag > 0 or s.imag < 0)
        balls += _pair(s)
    stability = "elliptic" if on == half else "saddle" if off == half else "undecided"
    if on + off == half and on and off:
        stability = "partly elliptic"
    return Multipliers(trivial, tuple(balls), stability)


def _pair(s: acb) -> list[acb]:
    """l and 1/l with the sum s."""
    if s.imag.is_zero() and abs(s.real) < 2:
        real, imag = s.real / 2, (1 - (s.real / 2) ** 2).sqrt()
        return [acb(real, imag), acb(real, -imag)]
    if s.imag.is_zero() and abs(s.real) > 2:
        sign = 1 if s.real > 0 else -1
        size = abs(s.real) / 2
        large = sign * (size + (size * size - 1).sqrt())
        return [acb(large), acb(1 / large)]
    root = (s * s / 4 - 1).sqrt()
    return [s / 2 + root, s / 2 - root]


def _roots(row: Sequence[arb]) -> tuple[acb, ...]:
    """All roots of a real polynomial, lowest power first; empty where they are not separated."""
    lead = row[-1]
    if len(row) == 2:
        return (acb(-row[0] / lead),)
    if len(row) == 3:
        half, product = -row[1] / (2 * lead), row[0] / lead
        square = half * half - product
        if square > 0:
            # The smaller root as a quotient: without cancellation.
            large = half + square.sqrt() if half > 0 else half - square.sqrt()
            small = product / large if not large.contains(0) else 2 * half - large
            return acb(large), acb(small)
        if square < 0:
            return acb(half, (-square).sqrt()), acb(half, -((-square).sqrt()))
        return ()
    try:
        roots = acb_poly([acb(x) for x in row]).roots()
    except (ValueError, ZeroDivisionError):
        return ()
    return tuple(_as_real(x, roots) for x in roots)


def _as_real(x: acb, roots: Sequence[acb]) -> acb:
    """A root that is the only one in its disk and in the mirror image of this disk is real."""
    others = [y for y in roots if y is not x]
    mirror = acb(x.real, -x.imag)
    alone = x.imag.contains(0) and not any(y.overlaps(mirror) for y in others)
    return acb(x.real) if alone else x

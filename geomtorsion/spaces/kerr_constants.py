"""kerr_constants: energy, angular momentum and Carter constant of orbits of a rotating hole."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TypeAlias

import mpmath
from flint import acb, arb, fmpq, fmpq_poly

from geomtorsion.support.precision import EPS, ball_precision

# Coefficients of r^0, r^1, ...
Polynomial: TypeAlias = Sequence[int | mpmath.mpf]


def constants(
    a: mpmath.mpf, p: mpmath.mpf, e: mpmath.mpf, x: mpmath.mpf
) -> tuple[mpmath.mpf, ...] | None:
    """E, L, Q, L/x and the radii; None where no orbit is bound or scattered.

    The outer radius is negative for e > 1 and infinite for e = 1.
    """
    inner, z2 = p / (1 + e), 1 - x * x
    outer = mpmath.inf if e == 1 else p / (1 - e)
    # Coefficients of r^0, r^1, ...: E^2 f - 2 E l x g - l^2 h = d with l = L/x.
    f = [z2 * a**4, 2 * a * a * (1 - z2), a * a * (1 + z2), 0, 1]
    g = [0, 2 * a]
    h = [z2 * a * a, -2, 1]
    d = [z2 * a**4, -2 * z2 * a * a, a * a * (1 + z2), -2, 1]

    def value(row: Polynomial, place: mpmath.mpf) -> mpmath.mpf:
        return mpmath.fsum(c * place**k for k, c in enumerate(row))

    def slope(row: Polynomial) -> mpmath.mpf:
        # The divided difference between the turning points, which has a limit where they meet.
        return mpmath.fsum(
            c * outer**i * inner ** (k - 1 - i) for k, c in enumerate(row) for i in range(k)
        )

    def cross(one: Polynomial, two: Polynomial) -> mpmath.mpf:
        return value(one, outer) * slope(two) - value(two, outer) * slope(one)

    def squares() -> list[mpmath.mpf]:
        """Candidates for E^2: both turning points are roots."""
        if e == 1:
            return [mpmath.mpf(1)]
        kappa, epsilon, rho = cross(d, h), cross(d, g), cross(f, h)
        eta, sigma = cross(f, g), cross(g, h)
        inside = sigma * (sigma * (x * epsilon) ** 2 + rho * epsilon * kappa - eta * kappa**2)
        below = rho**2 + 4 * x * x * eta * sigma
        if inside < 0 or below == 0:
            return []
        middle, half = kappa * rho + 2 * x * x * epsilon * sigma, 2 * x * mpmath.sqrt(inside)
        # Behind infinity the other sign belongs to the same sense.
        return [(middle - half) / below, (middle + half) / below][: 2 if e > 1 else 1]

    place = outer if e < 1 else inner
    for square in squares():
        if not (0 < square < 1 if e < 1 else square == 1 if e == 1 else square > 1):
            continue
        energy = mpmath.sqrt(square)
        half, rest = x * value(g, place) * energy, value(f, place) * square - value(d, place)
        root = half**2 + rest * value(h, place)
        if root < 0:
            continue
        root = mpmath.sqrt(root)
        # The form of the root in which nothing cancels.
        reduced = rest / (half + root) if half >= 0 else (root - half) / value(h, place)
        if e > 1 and not _is_root(
            [value(f, outer) * square, -2 * energy * reduced * x * value(g, outer),
             -(reduced**2) * value(h, outer), -value(d, outer)]
        ):  # fmt: skip
            continue
        carter = z2 * (a * a * (1 - square) + reduced**2)
        if e == 1:
            total = ((x * reduced) ** 2 + carter) / 2 - inner
            product = a * a * carter / (2 * inner)
        else:
            total = 2 / (1 - square) - outer - inner
            product = a * a * carter / ((1 - square) * outer * inner)
        gap = total**2 - 4 * product
        third = (total + mpmath.sqrt(gap)) / 2 if gap >= 0 else mpmath.inf
        if reduced > 0 and third < inner and inner > 1 + mpmath.sqrt(1 - a * a):
            radii = outer, inner, third, product / third
            return energy, x * reduced, carter, reduced, *radii, inner - third
    return None


def _is_root(terms: Sequence[mpmath.mpf]) -> bool:
    """Whether terms cancel to half of their digits."""
    return abs(mpmath.fsum(terms)) <= mpmath.sqrt(mpmath.mp.eps) * mpmath.fsum(map(abs, terms))


def radial_roots(
    a: mpmath.mpf, energy: mpmath.mpf, turn: mpmath.mpf, carter: mpmath.mpf
) -> list[mpmath.mpf]:
    """Real roots of R(r), from the largest one: where a particle has no radial speed.

    R = (E^2 - 1) r^4 + 2 r^3 + (a^2 (E^2 - 1) - L^2 - Q) r^2 + 2 ((L - a E)^2 + Q) r - a^2 Q
    """
    E, L, Q, spin = (_rational(x) for x in (energy, turn, carter, a))
    size = (E - 1) * (E + 1)
    rows = [
        -(spin**2) * Q,
        2 * ((L - spin * E) ** 2 + Q),
        spin**2 * size - L**2 - Q,
        fmpq(2),
        size,
    ]
    with ball_precision(mpmath.mp.prec):
        # Exact numbers have exact multiplicities, and a real root is known to be real.
        roots: list[tuple[acb, int]] = fmpq_poly(rows).complex_roots()  # type: ignore[assignment]
    real = [_middle(x.real) for x, count in roots if x.imag == 0 for _ in range(count)]
    return sorted(real, reverse=True)


def _rational(value: mpmath.mpf) -> fmpq:
    """The exact value of a number."""
    sign, mantissa, exponent, _ = value._mpf_
    size = fmpq(-mantissa if sign else mantissa)
    return size * fmpq(2) ** exponent


def _middle(ball: arb) -> mpmath.mpf:
    """The middle of a ball."""
    mantissa, exponent = ball.mid().man_exp()
    return mpmath.ldexp(mpmath.mpf(int(mantissa)), int(exponent))


def inclination(
    a: mpmath.mpf, energy: mpmath.mpf, turn: mpmath.mpf, carter: mpmath.mpf
) -> mpmath.mpf:
    """Cosine x of the inclination: the largest cos(theta)^2 of the orbit is 1 - x^2."""
    bound = a**2 * (1 - energy) * (1 + energy)
    total = carter + turn**2 + bound
    if total == 0:
        return mpmath.mpf(1)
    root = mpmath.sqrt(total**2 - 4 * bound * carter)
    z2 = 2 * carter / (total + root)
    size = mpmath.sqrt(max(1 - z2, 0))
    # Below the rounding of the numbers an orbit is polar.
    if abs(turn) <= EPS * mpmath.sqrt(total):
        return mpmath.mpf(0)
    return mpmath.sign(turn) * size

"""Digits: development of a circle on the sphere, with fifty digits."""

from itertools import pairwise

import mpmath


def sphere_closure(radius: float) -> list[mpmath.mpf]:
    """X' = R e, angle' = cos(theta) phi' on the circle about (1, 0.3), by Fourier series."""
    with mpmath.workdps(50):
        n = 48
        r = mpmath.mpf(radius)
        times = [2 * mpmath.pi * k / n for k in range(n)]

        def series(values):
            return [
                mpmath.fsum(
                    v * mpmath.expjpi(mpmath.mpf(-2 * m * k) / n) for k, v in enumerate(values)
                )
                / n
                for m in range(-n // 2 + 1, n // 2)
            ]

        rate = [mpmath.cos(1 + r * mpmath.cos(t)) * r * mpmath.cos(t) for t in times]
        waves = list(range(-n // 2 + 1, n // 2))
        found = series(rate)
        mean = found[waves.index(0)].real

        def angle(t):
            total = mean * t
            for m, c in zip(waves, found, strict=True):
                if m:
                    total += (c * (mpmath.exp(1j * m * t) - 1) / (1j * m)).real
            return total

        def integrand(component):
            def value(t):
                a = angle(t)
                one, two = -r * mpmath.sin(t), mpmath.sin(1 + r * mpmath.cos(t)) * r * mpmath.cos(t)
                # A transported vector turns by -integral cos(theta) dphi.
                turned = (
                    mpmath.cos(a) * one - mpmath.sin(a) * two,
                    mpmath.sin(a) * one + mpmath.cos(a) * two,
                )
                return turned[component]

            return value

        nodes = [(2 * mpmath.pi * (k + 0)) / 8 for k in range(9)]
        return [_gauss(integrand(c), nodes) for c in range(2)]


def _gauss(function, nodes):
    """Integral by 12 Gauss points per interval, in the working precision."""
    rule = mpmath.calculus.quadrature.GaussLegendre(mpmath.mp).calc_nodes(3, mpmath.mp.prec)
    total = mpmath.mpf(0)
    for low, high in pairwise(nodes):
        half, middle = (high - low) / 2, (high + low) / 2
        total += half * mpmath.fsum(w * function(middle + half * p) for p, w in rule)
    return total

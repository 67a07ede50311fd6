"""Special values: numbers of special functions by Arb, to any precision."""

from __future__ import annotations

from collections.abc import Callable

import mpmath
from flint import acb, arb

from geomtorsion.support.precision import ball_precision


def _polygamma(order: acb, z: acb) -> acb:
    """Real on the whole real axis, where Arb gives a small imaginary ball left of zero."""
    value = z.polygamma(order)
    is_real = z.imag.is_zero() and order.imag.is_zero() and order.real.is_integer()
    return acb(value.real) if is_real else value


# Numbers of functions by Arb, by the names of sympy's classes; mpmath takes ten seconds for 200
# digits of Y_2.
VALUES: dict[str, Callable[..., acb]] = {
    "besselj": lambda n, z: z.bessel_j(n),
    "bessely": lambda n, z: z.bessel_y(n),
    "besseli": lambda n, z: z.bessel_i(n),
    "besselk": lambda n, z: z.bessel_k(n),
    "erf": acb.erf,
    "erfc": acb.erfc,
    "erfi": acb.erfi,
    "erf2": lambda x, y: y.erf() - x.erf(),
    "LambertW": lambda z, branch=0: z.lambertw(int(float(acb(branch).real))),
    "gamma": acb.gamma,
    "loggamma": acb.lgamma,
    "polygamma": _polygamma,
    "factorial": lambda x: (x + 1).gamma(),
    "beta": lambda x, y: x.gamma() * y.gamma() * (x + y).rgamma(),
    "uppergamma": lambda s, x: x.gamma_upper(s),
    "lowergamma": lambda s, x: x.gamma_lower(s),
    "Ei": acb.ei,
    "expint": lambda n, x: x.expint(n),
    "li": acb.li,
    "Si": acb.si,
    "Ci": acb.ci,
    "Shi": acb.shi,
    "Chi": acb.chi,
    "airyai": acb.airy_ai,
    "airybi": acb.airy_bi,
    "airyaiprime": lambda x: x.airy_ai(derivative=1),
    "airybiprime": lambda x: x.airy_bi(derivative=1),
}


def number(name: str, *arguments: mpmath.mpf) -> mpmath.mpf:
    """The value of a function at the working precision of mpmath.

    Raises
    ------
    ZeroDivisionError
        it has no finite value there, or one of which too few bits are known.
    """
    with ball_precision(mpmath.mp.prec):
        value = VALUES[name](*map(_ball, arguments))
    # With more bits, which are tried next, less is lost.
    if not value.is_finite() or value.rel_accuracy_bits() < mpmath.mp.prec // 2:
        raise ZeroDivisionError(f"{name} has no finite value here")
    if value.imag.is_zero():
        return _middle(value.real)
    return mpmath.mpc(_middle(value.real), _middle(value.imag))


def _ball(value: mpmath.mpf) -> acb:
    """A number of mpmath for Arb, exactly."""
    whole = mpmath.mpmathify(value)
    return acb(arb(whole.real), arb(whole.imag))


def _middle(ball: arb) -> mpmath.mpf:
    """The midpoint of a ball as a number of mpmath."""
    mantissa, exponent = ball.mid().man_exp()
    return mpmath.mpf((int(mantissa), int(exponent)))

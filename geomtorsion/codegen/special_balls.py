"""Special balls: power series of special functions in balls, and where complex ones are analytic.

Both tables hold the functions of `special_values`, by the names of sympy's classes.
"""

from __future__ import annotations

from collections.abc import Callable
from functools import partial
from typing import Any, TypeAlias

from flint import acb, arb, arb_series, ctx

from geomtorsion.exact.special_values import VALUES

# An arb, acb or arb_series; python-flint does not declare its types.
Ball: TypeAlias = Any

NAN = acb("nan", "nan")
# Where each function has its cut: on the imaginary axis from i and -i on, on the real axis from 1
# and -1 on, below 1, or below 0.
CUTS = {
    "atan": "imaginary", "asinh": "imaginary", "asin": "outer", "acos": "outer", "atanh": "outer",
    "acosh": "below one", "loggamma": "negative", "Ci": "negative", "Chi": "negative",
    "uppergamma": "negative", "lowergamma": "negative", "expint": "negative",
}  # fmt: skip
# Functions without a cut; at their poles they are not finite.
UNCUT = ("airyai", "airybi", "airyaiprime", "airybiprime", "Si", "Shi", "erf", "erfc", "erfi",
         "erf2", "gamma", "factorial", "beta")  # fmt: skip


def touches_cut(x: acb, cut: str) -> bool:
    """Whether a ball may meet a cut, by its name in the table of cuts."""
    real, imaginary = x.real, x.imag
    if cut == "imaginary":
        return real.contains(0) and not abs(imaginary) < 1
    if not imaginary.contains(0):
        return False
    if cut == "outer":
        return not abs(real) < 1
    return not real > (1 if cut == "below one" else 0)


# -- complex balls: each function takes the flag `analytic` last -----------------------------------


def _uncut(name: str) -> Callable[..., acb]:
    method = VALUES[name]
    return lambda *given: method(*given[:-1])


def _with_cut(name: str) -> Callable[..., acb]:
    """A function with a cut in its last argument."""
    method, cut = VALUES[name], CUTS[name]

    def value(*given: Any) -> acb:
        *arguments, analytic = given
        return NAN if analytic and touches_cut(arguments[-1], cut) else method(*arguments)

    return value


def _bessel(name: str, *, entire: bool) -> Callable[[acb, acb, bool], acb]:
    """A Bessel function (order, x); entire: whether it has no cut where the order is whole."""
    method = VALUES[name]

    def value(order: acb, x: acb, analytic: bool) -> acb:
        whole = order.imag.is_zero() and order.real.is_integer()
        if analytic and not (entire and whole) and touches_cut(x, "negative"):
            return NAN
        return method(order, x)

    return value


def _polygamma(order: acb, x: acb, analytic: bool) -> acb:
    if analytic and not (order.imag.is_zero() and order.real.is_integer()):
        return NAN
    return VALUES["polygamma"](order, x)


def _ei(x: acb, analytic: bool) -> acb:
    """Ei, analytic around each half of the real axis: left of zero it is -E_1(-x)."""
    if not analytic:
        return x.ei()
    if x.real < 0:
        return -(-x).expint(acb(1))
    return NAN if touches_cut(x, "negative") else x.ei()


def _li(x: acb, analytic: bool) -> acb:
    """Ei(log x), analytic around (0, 1) and above 1."""
    return _ei(x.log(analytic=True), True) if analytic else x.li()


def _lambertw(x: acb, branch: acb | int = 0, analytic: bool = False) -> acb:
    """W, analytic around the real intervals on which its branches 0 and -1 are real."""
    number = _branch(acb(branch).real)
    if not analytic:
        return x.lambertw(number)
    if number not in (0, -1):
        return NAN
    if x.imag.contains(0) and not x.real > -(arb(-1).exp()):
        return NAN
    if number == 0:
        return x.lambertw()
    return NAN if x.imag.contains(0) and not x.real < 0 else x.lambertw(-1, middle=True)


def _branch(branch: arb) -> int:
    return int(float(branch))


def _of_lambertw(*given: Any) -> acb:
    """With or without a branch; the flag is the last argument."""
    *arguments, analytic = given
    return _lambertw(*arguments, analytic=analytic)


ANALYTIC: dict[str, Callable[..., acb]] = {
    **{name: _uncut(name) for name in UNCUT},
    **{name: _with_cut(name) for name in CUTS if name in VALUES},
    "besselj": _bessel("besselj", entire=True),
    "besseli": _bessel("besseli", entire=True),
    "bessely": _bessel("bessely", entire=False),
    "besselk": _bessel("besselk", entire=False),
    "polygamma": _polygamma,
    "Ei": _ei,
    "li": _li,
    "LambertW": _of_lambertw,
}  # fmt: skip

# -- power series ----------------------------------------------------------------------------------


def undefined() -> arb_series:
    """A series of which no coefficient is known."""
    return arb_series([arb("nan")] * ctx.cap, prec=ctx.cap)


def _value(name: str, *arguments: arb) -> arb:
    """A value on the real axis; not a number where it is not real."""
    result = VALUES[name](*map(acb, arguments))
    return result.real if result.imag.is_zero() else arb("nan")


def _along(coefficients: list[arb], x: arb_series) -> arb_series:
    """The function with such Taylor coefficients at x(0), at the series x."""
    if not all(value.is_finite() for value in coefficients):
        return undefined()
    slopes = x.coeffs()[1:]
    if not slopes:
        return arb_series(coefficients[:1], prec=x.prec)
    inner = arb_series([arb(0), *slopes], prec=x.prec)
    return arb_series(coefficients, prec=ctx.cap)(inner)


def _series_bessel(name: str, order: arb, x: arb_series) -> arb_series:
    """A Bessel function of a fixed order, from its differential equation at x(0).

    z^2 y'' + z y' + (s z^2 - n^2) y = 0, s = 1 for J and Y, -1 for I and K.
    """
    at = x[0]
    sign = 1 if name in ("besselj", "bessely") else -1
    if at.contains(0):
        return _bessel_at_zero(name, order, x, sign)
    below, above = (_value(name, order + k, at) for k in (-1, 1))
    slope = {"besselj": below - above, "bessely": below - above,
             "besseli": below + above, "besselk": -below - above}[name] / 2  # fmt: skip
    found = [_value(name, order, at), slope]
    for k in range(ctx.cap - 2):
        total = at * (k + 1) * (2 * k + 1) * found[k + 1]
        total += (k * k + sign * at * at - order * order) * found[k]
        total += 2 * sign * at * found[k - 1] if k >= 1 else 0
        total += sign * found[k - 2] if k >= 2 else 0
        found.append(-total / (at * at * (k + 2) * (k + 1)))
    return _along(found[: ctx.cap], x)


def _bessel_at_zero(name: str, order: arb, x: arb_series, sign: int) -> arb_series:
    """J_n or I_n of whole n: 2 J_n' = J_(n - 1) - J_(n + 1), and the same with + for I_n."""
    if name in ("bessely", "besselk") or not order.is_integer():
        return undefined()
    n, at = int(order.fmpz()), x[0]

    def value(m: int) -> arb:
        flips = sign > 0 and m < 0 and m % 2
        return (-1 if flips else 1) * _value(name, arb(abs(m)), at)

    row = [value(n + k) for k in range(-ctx.cap, ctx.cap + 1)]
    found, factorial = [], arb(1)
    for k in range(ctx.cap):
        factorial = factorial * max(k, 1)
        found.append(row[len(row) // 2] / factorial)
        row = [(a - sign * b) / 2 for a, b in zip(row[:-2], row[2:], strict=True)]
    return _along(found, x)


def _series_polygamma(order: arb, x: arb_series) -> arb_series:
    """psi^(m), whose derivatives are polygamma functions."""
    if not order.is_integer():
        return undefined()
    found, factorial = [], arb(1)
    for k in range(ctx.cap):
        factorial = factorial * max(k, 1)
        found.append(_value("polygamma", order + k, x[0]) / factorial)
    return _along(found, x)


def _series_expint(order: arb, x: arb_series) -> arb_series:
    """E_n(x) = x^(n - 1) Gamma(1 - n, x)."""
    if not x[0] > 0:
        return undefined()
    return ((order - 1) * x.log()).exp() * arb_series.gamma_upper(1 - order, x)


def _series_lambertw(x: arb_series, branch: arb | int = 0) -> arb_series:
    if not x[0] > -(arb(-1).exp()):
        return undefined()
    return x.lambertw(_branch(arb(branch)))


def _is_fixed(function: Callable[..., Ball]) -> Callable[..., Ball]:
    """A function whose series is known only where all arguments but the last are numbers."""

    def value(*given: Ball) -> Ball:
        if any(isinstance(x, arb_series) for x in given[:-1]):
            return undefined()
        return function(*given)

    return value


SERIES: dict[str, Callable[..., Ball]] = {
    **{name: _is_fixed(partial(_series_bessel, name))
       for name in ("besselj", "bessely", "besseli", "besselk")},
    "erf": lambda x: x.erf(),
    "erfc": lambda x: x.erfc(),
    "erfi": lambda x: x.erfi(),
    "erf2": lambda x, y: y.erf() - x.erf(),
    "gamma": lambda x: x.gamma(),
    "loggamma": lambda x: x.lgamma(),
    "factorial": lambda x: (x + 1).gamma(),
    "beta": lambda x, y: x.gamma() * y.gamma() * (x + y).rgamma(),
    "polygamma": _is_fixed(_series_polygamma),
    "uppergamma": _is_fixed(arb_series.gamma_upper),
    "lowergamma": _is_fixed(arb_series.gamma_lower),
    "expint": _is_fixed(_series_expint),
    "Ei": lambda x: x.ei(),
    "li": lambda x: x.li(),
    "Si": lambda x: x.si(),
    "Ci": lambda x: x.ci(),
    "Shi": lambda x: x.shi(),
    "Chi": lambda x: x.chi(),
    "airyai": lambda x: x.airy_ai(),
    "airybi": lambda x: x.airy_bi(),
    "airyaiprime": lambda x: x.airy_ai_prime(),
    "airybiprime": lambda x: x.airy_bi_prime(),
    "LambertW": _series_lambertw,
}  # fmt: skip

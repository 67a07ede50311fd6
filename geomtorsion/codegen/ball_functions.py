"""Ball functions: functions in graphs, on balls (arb, acb) and power series in balls (arb_series).

Complex functions take a flag `analytic`: where it is true they have a value only where they are
analytic, and are not a number elsewhere. FLINT itself does so for logarithms, roots and powers.
"""

from __future__ import annotations

from collections.abc import Callable
from functools import partial
from typing import Any

from flint import acb, arb, arb_series

from geomtorsion.codegen.special_balls import (
    ANALYTIC,
    CUTS,
    NAN,
    SERIES,
    Ball,
    touches_cut,
    undefined,
)
from geomtorsion.exact.special_values import VALUES

# -- complex functions -----------------------------------------------------------------------------

UNIT = acb(0, 1)


def _with_cut(name: str) -> Callable[[acb, bool], acb]:
    """A method of acb that has a cut."""
    method, cut = getattr(acb, name), CUTS[name]
    return lambda x, analytic: NAN if analytic and touches_cut(x, cut) else method(x)


def _plain(name: str) -> Callable[[acb, bool], acb]:
    """A method of acb that is analytic where it is finite."""
    method = getattr(acb, name)
    return lambda x, analytic: method(x)


def _complex_atan2(y: acb, x: acb, analytic: bool) -> acb:
    """(log(x + i y) - log(x - i y)) / 2 i: on real numbers the angle, analytic off both cuts."""
    if not analytic and y.imag.is_zero() and x.imag.is_zero():
        return acb(arb.atan2(y.real, x.real))
    plus, minus = x + UNIT * y, x - UNIT * y
    return (plus.log(analytic=analytic) - minus.log(analytic=analytic)) / (2 * UNIT)


def _complex_root(x: acb, degree: int, analytic: bool) -> acb:
    if degree == 2:
        return x.sqrt(analytic=analytic)
    return x.pow(acb(1) / degree, analytic=analytic)


def _complex_power(base: acb, exponent: acb, analytic: bool) -> acb:
    return base.pow(exponent, analytic=analytic)


def _complex_size(x: acb, analytic: bool) -> acb:
    """|x| of real numbers continues as x or -x; for complex numbers it is nowhere analytic."""
    return x.real_abs(analytic=True) if analytic else acb(abs(x))


def _complex_sign(x: acb, analytic: bool) -> acb:
    return x.real_sgn(analytic=True) if analytic else x.sgn()


def _real_extension(name: str) -> Callable[..., acb]:
    """A function of real numbers, continued as it is on both sides of its jumps and kinks."""
    method = getattr(acb, name)
    return lambda x, analytic: method(x, analytic=analytic)


def _extreme(name: str) -> Callable[..., acb]:
    method = getattr(acb, name)

    def value(*given: Any) -> acb:
        *values, analytic = given
        best = values[0]
        for ball in values[1:]:
            best = method(best, ball, analytic=analytic)
        return best

    return value


COMPLEX: dict[str, Callable[..., acb]] = {
    **ANALYTIC,
    **{name: _plain(name) for name in ("sin", "cos", "tan", "sinh", "cosh", "tanh", "exp")},
    **{name: _with_cut(name) for name in ("atan", "asinh", "asin", "acos", "atanh", "acosh")},
    "log": lambda x, analytic: x.log(analytic=analytic),
    "atan2": _complex_atan2,
    "power": _complex_power,
    "root": _complex_root,
    "Abs": _complex_size,
    "sign": _complex_sign,
    "floor": _real_extension("real_floor"),
    "ceiling": _real_extension("real_ceil"),
    "Max": _extreme("real_max"),
    "Min": _extreme("real_min"),
}  # fmt: skip

# -- real functions, and power series --------------------------------------------------------------


def _first(x: Ball) -> arb:
    return x[0] if isinstance(x, arb_series) else x


def _real(
    name: str, series: Callable[[arb_series], arb_series] | None = None
) -> Callable[[Ball], Ball]:
    """A method of arb; for series the method of that name, or the given function."""
    method = getattr(arb, name)
    on_series = series or getattr(arb_series, name, None) or (lambda x: undefined())
    return lambda x: method(x) if isinstance(x, arb) else on_series(x)


def _series_quotient(above: Ball, below: Ball) -> Ball:
    """A quotient. FLINT would shorten series whose first coefficients are zero."""
    if isinstance(below, arb_series) and below[0].contains(0):
        return undefined()
    return above / below


def _series_tanh(x: arb_series) -> arb_series:
    # Each of both keeps the digits of the distance from 1 or -1 on its side.
    if x[0] > 0:
        return 1 - _series_quotient(arb(2), (2 * x).exp() + 1)
    return _series_quotient(arb(2), (-2 * x).exp() + 1) - 1


def _series_sinh(x: arb_series) -> arb_series:
    e = x.exp()
    return (e - _series_quotient(arb(1), e)) / 2


def _series_cosh(x: arb_series) -> arb_series:
    e = x.exp()
    return (e + _series_quotient(arb(1), e)) / 2


def _step_value(x: arb_series, value: arb) -> Ball:
    """A function that is constant between its jumps, for a series away from them."""
    return value if value.is_exact() and value.is_finite() else undefined()


def _size(x: Ball) -> Ball:
    if isinstance(x, arb):
        return abs(x)
    return x if x[0] > 0 else -x if x[0] < 0 else undefined()


def _sign(x: Ball) -> Ball:
    return x.sgn() if isinstance(x, arb) else _step_value(x, x[0].sgn())


def _whole(name: str) -> Callable[[Ball], Ball]:
    """Floor or ceiling."""
    method = getattr(arb, name)

    def value(x: Ball) -> Ball:
        if isinstance(x, arb):
            return method(x)
        return undefined() if x[0].contains_integer() else _step_value(x, method(x[0]))

    return value


def _series_extreme(sign: int, *values: Ball) -> Ball:
    """The largest (sign 1) or the smallest (sign -1) of numbers and series."""
    best = values[0]
    for ball in values[1:]:
        if isinstance(best, arb) and isinstance(ball, arb):
            best = best.max(ball) if sign > 0 else best.min(ball)
        else:
            ahead = sign * (_first(best) - _first(ball))
            best = best if ahead > 0 else ball if ahead < 0 else undefined()
    return best


def _real_root(x: Ball, degree: int) -> Ball:
    if degree == 2:
        return x.sqrt()
    return x.root(degree) if isinstance(x, arb) else (x.log() / degree).exp()


def _real_power(base: Ball, exponent: Ball) -> Ball:
    if isinstance(base, arb) and isinstance(exponent, arb):
        return base**exponent
    if isinstance(exponent, arb) and exponent.is_integer():
        count = int(exponent.fmpz())
        power = base ** abs(count)
        return power if count >= 0 else _series_quotient(arb(1), power)
    return ((base.log()) * exponent).exp()


def _real_atan2(y: Ball, x: Ball) -> Ball:
    if isinstance(x, arb) and isinstance(y, arb):
        return arb.atan2(y, x)
    above, right = _first(y), _first(x)
    if right > 0:
        return (y / x).atan()
    if above > 0:
        return arb.pi() / 2 - (x / y).atan()
    if above < 0:
        return -arb.pi() / 2 - (x / y).atan()
    return undefined()


def _real_special(name: str) -> Callable[..., Ball]:
    """A special function of real numbers; not a number where its value is not real."""
    method, on_series = VALUES[name], SERIES[name]

    def value(*given: Ball) -> Ball:
        if any(isinstance(x, arb_series) for x in given):
            return on_series(*given)
        result = method(*map(acb, given))
        return result.real if result.imag.is_zero() else arb("nan")

    return value


REAL: dict[str, Callable[..., Ball]] = {
    **{name: _real_special(name) for name in VALUES},
    **{name: _real(name) for name in ("sin", "cos", "tan", "exp", "log", "atan", "asin", "acos")},
    "sinh": _real("sinh", _series_sinh),
    "cosh": _real("cosh", _series_cosh),
    "tanh": _real("tanh", _series_tanh),
    "asinh": _real("asinh", lambda x: (x + (x * x + 1).sqrt()).log()),
    "acosh": _real("acosh", lambda x: (x + (x * x - 1).sqrt()).log()),
    "atanh": _real("atanh", lambda x: _series_quotient(1 + x, 1 - x).log() / 2),
    "atan2": _real_atan2,
    "power": _real_power,
    "root": _real_root,
    "Abs": _size,
    "sign": _sign,
    "floor": _whole("floor"),
    "ceiling": _whole("ceil"),
    "Max": partial(_series_extreme, 1),
    "Min": partial(_series_extreme, -1),
    "over": _series_quotient,
}  # fmt: skip

"""Special functions: their derivatives, and the relations that tie them together.

Bessel functions of neighbouring orders, gamma functions of neighbouring arguments, W and exp(W) are
generators of their own, so that their numbers are exact function values: J_20 made of
J_0 and J_1 has no right digit at small arguments.  The meaning of such a generator is what it is in
terms of a few of them.  Zero is decided by meanings (see `modular`), numbers never are.
"""

from __future__ import annotations

from collections.abc import Callable
from fractions import Fraction
from functools import partial
from math import factorial
from typing import TYPE_CHECKING

import mpmath
import sympy
from flint import fmpq
from mpmath.libmp import to_rational

from geomtorsion.errors import ExpressionError, GeomtorsionError
from geomtorsion.exact.generators import Branch
from geomtorsion.exact.limits import LARGEST_MULTIPLE
from geomtorsion.exact.polynomials import as_fmpq
from geomtorsion.support.precision import EXACT_BITS, working_precision

if TYPE_CHECKING:
    from geomtorsion.exact.element import Element
    from geomtorsion.exact.generators import Generator
    from geomtorsion.exact.tower import Tower

    # What a function of these arguments is in terms of others; None where it is its own.
    Meaning = Callable[[Tower, tuple[Element, ...]], Element | None]
    # The partial derivatives of a function, one for each argument; None where it has none.
    Slopes = Callable[[Tower, tuple[Element, ...]], tuple[Element | None, ...]]


def slope(field: Tower, generator: Generator, symbol: sympy.Symbol) -> Element:
    """The derivative of a function that is known by name.

    Raises
    ------
    ExpressionError
        the symbol occurs in an argument, such as an order, in which no derivative is known.
    """
    shown = generator.shown
    rule = _SLOPES.get(type(shown).__name__)
    if rule is None:
        return field.read(shown.diff(symbol), f"derivative of {shown}")
    terms = []
    for inner, argument in zip(rule(field, generator.argument), generator.argument, strict=True):
        change = argument.diff(symbol)
        if change.is_kept or change._num:
            if inner is None:
                raise ExpressionError(
                    f"{shown} has no derivative by {symbol} that is known exactly: {argument} is "
                    f"an order. Write a number or a parameter instead of {symbol}"
                )
            terms.append((1, inner, change))
    return field.sum(terms)


def meaning(field: Tower, generator: Generator) -> Element | None:
    """A generator in terms of others, by the known relations that hold here.

    A relation may hold on one branch only: it counts where both sides have one value at the point
    at which signs are read off.
    """
    name, arguments = type(generator.shown).__name__, generator.argument
    if generator.kind == "log":
        candidate = _of_logarithm(field, generator)
    elif name in _MEANINGS:
        candidate = _attempt(partial(_MEANINGS[name], field, arguments))
    else:
        # Arguments are generators of their own; sympy's Airy functions expand to None.
        expanded = generator.shown.expand(func=True, deep=False)
        candidate = None
        if expanded not in (None, generator.shown) and arguments:
            candidate = _attempt(partial(field.read, expanded))
    if candidate is None or not _agree(field, field.generator_element(generator), candidate):
        return None
    return candidate


def _attempt(read: Callable[[], Element | None]) -> Element | None:
    """The element that `read` returns, or None if it cannot be read."""
    try:
        return read()
    except (GeomtorsionError, ZeroDivisionError):
        return None


def _agree(field: Tower, one: Element, other: Element) -> bool:
    """Whether two elements have one value at the generic point."""
    try:
        with working_precision(EXACT_BITS):
            first, second = field.sample.value(one), field.sample.value(other)
            size = abs(first) + abs(second)
            return bool(abs(first - second) <= mpmath.ldexp(size, -EXACT_BITS // 2))
    except (GeomtorsionError, ArithmeticError, ValueError):
        return False


def _called(field: Tower, function: object, *arguments: Element | int) -> Element:
    """A function of sympy at elements, read."""
    shown = (x if isinstance(x, int) else x.sympy for x in arguments)
    return field.read(function(*shown))  # type: ignore[operator]


def _split(element: Element) -> tuple[Element, int, fmpq]:
    """(base, n, share): the element is base + n, the rational part of base is 0 <= share < 1."""
    if element.is_kept or element._den:
        return element, 0, fmpq(0)
    field = element.field
    constant = fmpq(0)
    for monomial, value in field.lift(element).to_dict().items():
        if not any(monomial):
            constant = as_fmpq(value)
    whole = int(constant.floor())
    return element - whole, whole, constant - whole


def _is_turned(element: Element) -> bool:
    """Whether the first term of an element has a minus; of an element and its opposite one has."""
    return not element.is_kept and bool(element._num) and element._num.leading_coefficient() < 0


# -- Bessel functions --------------------------------------------------------------------------

# F(n + 1) = step * (2 n / z) F(n) + back * F(n - 1), and the slope of F(n) by its neighbours:
# lower * F(n - 1) - (n / z) F(n) = (n / z) F(n) + upper * F(n + 1).
_BESSEL: dict[str, tuple[int, int, int, int]] = {
    "besselj": (1, -1, 1, -1),
    "bessely": (1, -1, 1, -1),
    "besseli": (-1, 1, 1, 1),
    "besselk": (1, 1, -1, -1),
}


def _bessel_slopes(
    name: str, field: Tower, arguments: tuple[Element, ...]
) -> tuple[Element | None, ...]:
    """By the order there is none that is known; by the argument from one neighbour or two."""
    order, z = arguments
    function = getattr(sympy, name)
    _, _, lower, upper = _BESSEL[name]
    if not order._num:
        return None, _called(field, function, 1, z) * upper
    below, above = order - 1, order + 1
    if (
        name in ("besselj", "besseli")
        and order.is_rational
        and order.as_fraction().denominator == 1
    ):
        # At z = 0 these have values, and so has this sum.
        half = fmpq(1, 2)
        both = _called(field, function, below, z) * (lower * half)
        return None, both + _called(field, function, above, z) * (upper * half)
    own = _called(field, function, order, z) * order / z
    orders = {
        generator.argument[0]
        for generator in field.generators
        if generator.kind == "opaque"
        and type(generator.shown).__name__ == name
        and generator.argument[1] == z
    }
    if above in orders and below not in orders:
        return None, own + _called(field, function, above, z) * upper
    return None, _called(field, function, below, z) * lower - own


def _bessel_meaning(name: str, field: Tower, arguments: tuple[Element, ...]) -> Element | None:
    """By two functions of one order between 0 and 1, and by J and I for the second kind."""
    order, z = arguments
    function = getattr(sympy, name)
    step, back, _, _ = _BESSEL[name]
    base, n, share = _split(order)
    if base._num and not base.is_rational and _is_turned(base):
        return _of_opposite_order(name, field, -order, z)
    is_half = base.is_rational and share == fmpq(1, 2)
    if is_half and n in (0, -1):
        return _of_half_order(name, field, n, z)
    # The two orders in which the others are counted: base and base + 1, or -1/2 and 1/2.
    first = base - 1 if is_half else base
    n += is_half
    if n in (0, 1):
        return _by_wronskian(name, field, first, z) if n else None
    if abs(n) > LARGEST_MULTIPLE:
        return None
    before, now = _called(field, function, first, z), _called(field, function, first + 1, z)
    double = z.inverse() * 2
    if n > 1:
        for k in range(1, n):
            before, now = now, double * (first + k) * now * step + before * back
        return now
    for k in range(-n):
        # F(m - 1) = back * (F(m + 1) - step * (2 m / z) F(m)), as back is 1 or -1.
        before, now = (now - double * (first - k) * before * step) * back, before
    return before


def _of_half_order(name: str, field: Tower, n: int, z: Element) -> Element:
    """The functions of order 1/2 (n = 0) and -1/2 (n = -1)."""
    shown = z.sympy
    size = sympy.sqrt(2 / (sympy.pi * shown))
    if name == "besselk":
        return field.read(sympy.pi / 2 * size * sympy.exp(-shown))
    sine, cosine = sympy.sin(shown), sympy.cos(shown)
    if name == "besseli":
        sine, cosine = sympy.sinh(shown), sympy.cosh(shown)
    if name == "bessely":
        sine, cosine = -cosine, sine
    return field.read(size * (cosine if n else sine))


def _of_opposite_order(name: str, field: Tower, order: Element, z: Element) -> Element:
    """The function of order -n by the functions of order n."""
    angle = sympy.pi * order.sympy
    if name == "besselk":
        return _called(field, sympy.besselk, order, z)
    if name == "besseli":
        second = _called(field, sympy.besselk, order, z)
        factor = field.read(2 * sympy.sin(angle) / sympy.pi)
        return _called(field, sympy.besseli, order, z) + factor * second
    first, second = (_called(field, f, order, z) for f in (sympy.besselj, sympy.bessely))
    cosine, sine = field.read(sympy.cos(angle)), field.read(sympy.sin(angle))
    if name == "besselj":
        return cosine * first - sine * second
    return sine * first + cosine * second


def _by_wronskian(name: str, field: Tower, order: Element, z: Element) -> Element | None:
    """Y(n + 1) by Y(n), J(n) and J(n + 1); K(n + 1) by K(n), I(n) and I(n + 1)."""
    if name in ("besselj", "besseli"):
        return None
    own = _called(field, getattr(sympy, name), order, z)
    partner = sympy.besselj if name == "bessely" else sympy.besseli
    low, high = _called(field, partner, order, z), _called(field, partner, order + 1, z)
    if name == "bessely":
        return (high * own - field.read(2 / sympy.pi) / z) / low
    return (z.inverse() - high * own) / low


# -- W and exp(W) ------------------------------------------------------------------------------


def _lambert_slopes(field: Tower, arguments: tuple[Element, ...]) -> tuple[Element | None, ...]:
    """exp(-W)/(1 + W), which has a value at 0, as W/(z (1 + W)) has not."""
    own = _called(field, sympy.LambertW, *arguments)
    slope = field.read(sympy.exp(-own.sympy)) / (own + 1)
    return (slope, *(None for _ in arguments[1:]))


def _lambert_meaning(field: Tower, arguments: tuple[Element, ...]) -> Element | None:
    """z exp(-W)."""
    own = _called(field, sympy.LambertW, *arguments)
    return arguments[0] * field.read(sympy.exp(-own.sympy))


def undone(field: Tower, shown: sympy.Expr, arguments: tuple[Element, ...]) -> Element | None:
    """u, of W(u exp(u)), with its branch stated; None if W is not a rational multiple of a factor.

    W and u have to have one value at the point at which signs are read off.
    """
    try:
        with working_precision(EXACT_BITS):
            z, *branch = map(field.sample.value, arguments)
            value = mpmath.lambertw(z, *(int(k) for k in branch))
    except (GeomtorsionError, ArithmeticError, ValueError):
        return None
    for inner in _inverted(field, value, arguments[0]):
        product = _attempt(partial(field.read, inner.sympy * sympy.exp(inner.sympy)))
        if product is not None and (product - arguments[0]).is_zero is True:
            branch = Branch(shown, inner.sympy, field.sample.place_in_words())
            field.state_branch(branch)
            return inner
    return None


def _inverted(field: Tower, value: mpmath.mpf, z: Element) -> list[Element]:
    """Rational multiples of factors of z that have a value."""
    if z.is_kept:
        return []
    rest = z
    for generator in field.generators_of(z):
        if generator.kind == "exp":
            degree = field.lift(z).degrees()[field.generators.index(generator)]
            rest = rest / field.generator_element(generator) ** int(degree)
    parts = [rest, *(field.polynomial(factor) for factor, _ in field.factored(field.lift(z))[1])]
    multiples = []
    for part in parts:
        try:
            with working_precision(EXACT_BITS):
                ratio = value / field.sample.value(part)
                near = Fraction(*map(int, to_rational(mpmath.re(ratio)._mpf_)))
                near = near.limit_denominator(LARGEST_MULTIPLE)
                far = abs(ratio - mpmath.mpf(near.numerator) / near.denominator)
        except (GeomtorsionError, ArithmeticError, ValueError):
            continue
        if near and far < mpmath.ldexp(1, -EXACT_BITS // 2):
            multiples.append(part * near)
    return multiples


def _of_logarithm(field: Tower, generator: Generator) -> Element | None:
    """log(W) is log(z) - W; log(gamma(u)) is loggamma(u)."""
    for inner in field.generators_of(generator.argument):
        if inner.kind != "opaque" or generator.argument not in (
            field.generator_element(inner),
            -field.generator_element(inner),
        ):
            continue
        name = type(inner.shown).__name__
        if name == "LambertW":
            sign = 1 if generator.argument == field.generator_element(inner) else -1
            logarithm = sympy.log(inner.argument[0].sympy * sign)
            return _attempt(partial(field.read, logarithm - inner.shown))
        if name == "gamma":
            return _attempt(partial(_called, field, sympy.loggamma, *inner.argument))
    return None


# -- gamma functions ---------------------------------------------------------------------------


def _product(base: Element, n: int) -> Element:
    """gamma(base + n) / gamma(base)."""
    product = base.field.one
    for k in range(abs(n)):
        product = product * (base + k if n > 0 else base - (k + 1))
    return product if n > 0 else product.inverse()


def _gamma(field: Tower, arguments: tuple[Element, ...]) -> Element | None:
    (u,) = arguments
    base, n, _ = _split(u)
    if base._num and not base.is_rational and _is_turned(base):
        # The reflection: gamma(u) gamma(1 - u) = pi/sin(pi u).
        reflected = _called(field, sympy.gamma, 1 - u)
        return field.read(sympy.pi / sympy.sin(sympy.pi * u.sympy)) / reflected
    if abs(n) > LARGEST_MULTIPLE:
        return None
    if n:
        return _called(field, sympy.gamma, base) * _product(base, n)
    return field.read(sympy.exp(sympy.loggamma(u.sympy)))


def _loggamma(field: Tower, arguments: tuple[Element, ...]) -> Element | None:
    (u,) = arguments
    base, n, _ = _split(u)
    if not n or abs(n) > LARGEST_MULTIPLE:
        return None
    steps = range(n) if n > 0 else range(n, 0)
    sign = 1 if n > 0 else -1
    return field.sum(
        [(1, _called(field, sympy.loggamma, base))]
        + [(sign, _called(field, sympy.log, base + k)) for k in steps]
    )


def _polygamma_meaning(field: Tower, arguments: tuple[Element, ...]) -> Element | None:
    order, u = arguments
    base, n, _ = _split(u)
    if not order.is_rational or abs(n) > LARGEST_MULTIPLE:
        return None
    m = int(order.as_fraction())
    if base._num and not base.is_rational and _is_turned(base):
        # (-1)**m psi_m(1 - u) = psi_m(u) + (pi cot(pi u)) differentiated m times.
        t = sympy.Dummy()
        change = sympy.diff(sympy.pi * sympy.cot(sympy.pi * t), t, m).subs(t, u.sympy)
        return _called(field, sympy.polygamma, m, 1 - u) * (-1) ** m - field.read(change)
    if not n:
        return None
    steps, sign = (range(n), 1) if n > 0 else (range(n, 0), -1)
    weight = sign * (-1) ** m * factorial(m)
    terms = [(weight, (base + k).inverse() ** (m + 1)) for k in steps]
    return field.sum([(1, _called(field, sympy.polygamma, m, base)), *terms])


def _uppergamma(field: Tower, arguments: tuple[Element, ...]) -> Element | None:
    """Reduce the first argument to 0..1 by gamma(s + 1, x) = s gamma(s, x) + x**s/e**x."""
    s, x = arguments
    base, n, share = _split(s)
    if abs(n) > LARGEST_MULTIPLE:
        return None
    if not n:
        if base.is_rational and share == fmpq(1, 2):
            return field.read(sympy.sqrt(sympy.pi) * sympy.erfc(sympy.sqrt(x.sympy)))
        return field.read(sympy.expint(1, x.sympy)) if not base._num else None
    value = _called(field, sympy.uppergamma, base, x)
    steps = range(n) if n > 0 else range(-1, n - 1, -1)
    for k in steps:
        term = field.read(x.sympy ** (base + k).sympy * sympy.exp(-x.sympy))
        value = value * (base + k) + term if n > 0 else (value - term) / (base + k)
    return value


def _expint(field: Tower, arguments: tuple[Element, ...]) -> Element | None:
    """E_1(x) = -Ei(-x); whole orders by E_1, others by incomplete gamma functions."""
    order, x = arguments
    if not (order.is_rational and order.as_fraction().denominator == 1):
        power = x.sympy ** (order - 1).sympy
        return field.read(power * sympy.uppergamma(1 - order.sympy, x.sympy))
    n = int(order.as_fraction())
    if n == 1:
        return -_called(field, sympy.Ei, -x)
    if not 1 < n <= LARGEST_MULTIPLE:
        return None
    integral, falling = _called(field, sympy.expint, 1, x), field.read(sympy.exp(-x.sympy))
    for k in range(1, n):
        integral = (falling - x * integral) * fmpq(1, k)
    return integral


# -- by other functions ------------------------------------------------------------------------


def _rewritten(rule: Callable[..., sympy.Expr]) -> Meaning:
    """A function that an expression of sympy gives by others."""
    return lambda field, arguments: field.read(rule(*(x.sympy for x in arguments)))


def _of_gammas(n: sympy.Expr, k: sympy.Expr) -> sympy.Expr:
    if k.is_Integer:
        return sympy.expand_func(sympy.binomial(n, k))
    return sympy.gamma(n + 1) / (sympy.gamma(k + 1) * sympy.gamma(n - k + 1))


def _spherical(function: object) -> Meaning:
    """jn and yn by Bessel functions of half orders."""
    return _rewritten(
        lambda n, z: sympy.sqrt(sympy.pi / (2 * z)) * function(n + sympy.S.Half, z)  # type: ignore[operator]
    )


def _zeta(s: sympy.Expr, u: sympy.Expr = sympy.S.One) -> sympy.Expr:
    m = s - 1
    return (-1) ** (m + 1) * sympy.polygamma(m, u) / sympy.factorial(m)


_SLOPES: dict[str, Slopes] = {
    **{name: partial(_bessel_slopes, name) for name in _BESSEL},
    "LambertW": _lambert_slopes,
}
_MEANINGS: dict[str, Meaning] = {
    **{name: partial(_bessel_meaning, name) for name in _BESSEL},
    "LambertW": _lambert_meaning,
    "gamma": _gamma,
    "loggamma": _loggamma,
    "polygamma": _polygamma_meaning,
    "uppergamma": _uppergamma,
    "expint": _expint,
    "jn": _spherical(sympy.besselj),
    "yn": _spherical(sympy.bessely),
    **{name: _rewritten(rule) for name, rule in {
        "erfc": lambda x: 1 - sympy.erf(x),
        "erf2": lambda x, y: sympy.erf(y) - sympy.erf(x),
        "factorial": lambda x: sympy.gamma(x + 1),
        "binomial": _of_gammas,
        "beta": lambda x, y: sympy.gamma(x) * sympy.gamma(y) / sympy.gamma(x + y),
        "harmonic": lambda x: sympy.polygamma(0, x + 1) + sympy.EulerGamma,
        "zeta": _zeta,
        "lowergamma": lambda s, x: sympy.gamma(s) - sympy.uppergamma(s, x),
        "li": lambda x: sympy.Ei(sympy.log(x)),
        "Li": lambda x: sympy.Ei(sympy.log(x)) - sympy.Ei(sympy.log(2)),
        "Shi": lambda x: (sympy.Ei(x) - sympy.Ei(-x)) / 2,
        "Chi": lambda x: (sympy.Ei(x) + sympy.Ei(-x)) / 2,
        "hankel1": lambda n, z: sympy.besselj(n, z) + sympy.I * sympy.bessely(n, z),
        "hankel2": lambda n, z: sympy.besselj(n, z) - sympy.I * sympy.bessely(n, z),
        "airybiprime": lambda x: (
            (1 / sympy.pi + sympy.airyaiprime(x) * sympy.airybi(x)) / sympy.airyai(x)
        ),
    }.items()},
}  # fmt: skip
# Functions that are read whether or not sympy knows all their derivatives.
NAMED = frozenset(_SLOPES)

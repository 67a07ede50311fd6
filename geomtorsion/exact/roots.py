"""Roots: square roots decided in towers of quadratic extensions, odd roots by factors."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import sympy
from flint import fmpq, fmpz

from geomtorsion.errors import ExpressionError
from geomtorsion.exact.generators import Branch, Generator
from geomtorsion.exact.inversion import monic, split

if TYPE_CHECKING:
    from geomtorsion.exact.element import Element
    from geomtorsion.exact.field import Field


def root(field: Field, element: Element, order: int, radical: sympy.Expr | None = None) -> Element:
    """The root of an order: odd part first, then square roots one by one."""
    if not element._num:
        return field.zero
    value = element
    odd = order
    while odd % 2 == 0:
        odd //= 2
    if odd > 1:
        value = _odd_root(field, value, odd)
    while odd < order:
        value = _square_root(field, value, radical)
        odd *= 2
    return value


# ---- square roots ---------------------------------------------------------------------
def _square_root(field: Field, element: Element, radical: sympy.Expr | None) -> Element:
    """The square root: inside the field where it exists there, else a new generator."""
    inside = square_root_inside(field, element)
    if inside is not None:
        positive = inside if field.sample.is_positive(inside) else -inside
        _state(field, element, positive, radical)
        return positive
    outer, content, tail = _squares_taken_out(field, element)
    if content < 0 and field.is_complex:
        turned = _square_root(field, -element, None)
        return turned * field.imaginary
    generator = _new_root(field, tail, 2, _is_decided(field, tail))
    value = outer * generator
    if not outer.is_rational:
        if not _matches_principal(field, value, element):
            value = -value
        _state(field, element, value, radical, outer)
    return value


def square_root_inside(field: Field, element: Element) -> Element | None:
    """An exact square root within the field as it stands, or None.

    In F(w), w**2 = P: A is a square if A or A P is one in F; A + B w is one exactly if
    A**2 - B**2 P = n**2 in F and (A + n)/2 or (A - n)/2 is a square there.
    """
    quadratic = [g for g in reversed(field.generators) if g.degree == 2]
    base = [g for g in quadratic if g.tail is not None and not _algebraic(field, g.tail)]
    nested = [g for g in quadratic if g not in base]
    return _inside(field, element, base, nested)


def _algebraic(field: Field, element: Element) -> bool:
    """Whether an element contains algebraic generators."""
    return any(g.degree for g in field.generators_of(element))


def _inside(
    field: Field, element: Element, base: list[Generator], nested: list[Generator]
) -> Element | None:
    """The square root in the tower: base generators first, nested ones on top; or None."""
    if not element._num:
        return field.zero
    if not nested and not any(g.degree == 2 for g in field.generators_of(element)):
        return _by_parity(field, element, base)
    top = (nested or base)[-1]
    below = (base, nested[:-1]) if nested else (base[:-1], nested)
    assert top.tail is not None
    position = field.generators.index(top)
    low, high = split(field, field.lift(element), position)
    if not high:
        found = _inside(field, element, *below)
        if found is not None:
            return found
        found = _inside(field, element * top.tail, *below)
        return None if found is None else found / field.generator_element(top)
    den = field.denominator(element).inverse()
    a, b = field.polynomial(low) * den, field.polynomial(high) * den
    norm = _inside(field, a * a - b * b * top.tail, *below)
    if norm is None:
        return None
    for sign in (1, -1):
        half = (a + norm * sign) * fmpq(1, 2)
        first = _inside(field, half, *below)
        if first is not None and first._num:
            return first + b / (first * 2) * field.generator_element(top)
    return None


def _by_parity(field: Field, element: Element, base: list[Generator]) -> Element | None:
    """The square root of an element without radicals, by odd exponents of its factors.

    The element is a square exactly if its odd factors are the sum, over GF(2), of those of
    some radicands; then it is a rational square times these radicands.
    """
    rows: list[tuple[frozenset[str], frozenset[int]]] = []
    tails = [g.tail for g in base if g.tail is not None]
    for k, tail in enumerate(tails):
        odd, used = _odd_factors(field, tail), frozenset((k,))
        for other, members in rows:
            if odd and min(other) in odd:
                odd, used = odd ^ other, used ^ members
        if odd:
            rows.append((odd, used))
    odd, used = _odd_factors(field, element), frozenset()
    for other, members in rows:
        if min(other) in odd:
            odd, used = odd ^ other, used ^ members
    if odd:
        return None
    product, roots = element, field.one
    for k in used:
        product = product * tails[k]
        roots = roots * field.generator_element(base[k])
    found = _rational_square_root(field, product)
    return None if found is None else found / roots


def _odd_factors(field: Field, element: Element) -> frozenset[str]:
    """The irreducible factors, primes and sign with odd exponents."""
    content, factors = field.lift(element).factor()
    content = fmpq(content)
    odd: set[str] = set()
    for factor, exponent in factors:
        positive, sign = monic(factor)
        if exponent % 2:
            odd.add(str(positive))
            content = content * sign
    odd ^= {str(field.factors[index]) for index, exponent in element._den if exponent % 2}
    if content < 0:
        odd.add("-1")
    for prime, exponent in fmpz(abs(content.p * content.q)).factor():
        if exponent % 2:
            odd.add(str(prime))
    return frozenset(odd)


def _rational_square_root(field: Field, element: Element) -> Element | None:
    """The square root over the transcendental generators: all exponents even."""
    num = field.lift(element)
    scale = field.one
    for position, generator in enumerate(field.generators):
        # v**m = f with m odd: v**e = v**(e + m) / f, whose exponent is even.
        if generator.degree > 2 and num.degrees()[position]:
            powers = {int(m[position]) for m in num.to_dict()}
            if len(powers) != 1 or generator.kind != "root":
                return None
            power = powers.pop()
            v = field.ctx.gen(position)
            num = num / v**power
            assert generator.tail is not None
            up = power + generator.degree if power % 2 else power
            half = field.generator_element(generator) ** (up // 2)
            if power % 2:
                rest = field.polynomial(num) / generator.tail / field.denominator(element)
                inner = _rational_square_root(field, rest)
                return None if inner is None else inner * half * scale
            scale = scale * half
    content, factors = num.factor()
    if any(exponent % 2 for _, exponent in factors) or any(e % 2 for _, e in element._den):
        return None
    outside = _square_of_rational(content)
    if outside is None:
        return None
    top = field.ctx.constant(outside)
    for factor, exponent in factors:
        top = top * factor ** (exponent // 2)
    bottom = [(field.factors[i], e // 2) for i, e in element._den]
    return field.over_factors(top, bottom) * scale


def _square_of_rational(value: Any) -> Any:
    """The root of a rational square, or None."""
    value = fmpq(value)
    if value < 0:
        return None
    p, q = fmpz(value.p).isqrt(), fmpz(value.q).isqrt()
    return fmpq(p, q) if p * p == value.p and q * q == value.q else None


def _squares_taken_out(field: Field, element: Element) -> tuple[Element, Any, Element]:
    """(outer, content, tail) with element = outer**2 * tail, tail a polynomial."""
    content, factors = field.lift(element).factor()
    outer, tail = field.ctx.constant(1), field.ctx.constant(1)
    for factor, exponent in factors:
        outer = outer * factor ** (exponent // 2)
        tail = tail * factor ** (exponent % 2)
    below = field.one
    for index, exponent in element._den:
        tail = tail * field.factors[index] ** (exponent % 2)
        below = below * field.polynomial(field.factors[index]) ** ((exponent + 1) // 2)
    square, free = _square_part(fmpq(content))
    outside = field.polynomial(outer) / below * square
    return outside, free, field.polynomial(tail * free)


def _square_part(value: Any) -> tuple[Any, Any]:
    """(s, f) with value = s**2 f, f a square-free integer with the sign of value."""
    whole = fmpz(value.p * value.q)
    sign = -1 if whole < 0 else 1
    square, free = fmpz(1), fmpz(sign)
    for prime, exponent in abs(whole).factor():
        square *= prime ** (exponent // 2)
        free *= prime ** (exponent % 2)
    return fmpq(square, value.q), free


def _is_decided(field: Field, tail: Element) -> bool:
    """Whether the tower decides that `tail` is no square (no higher roots involved)."""
    return not any(g.degree > 2 for g in field.generators_of(tail))


def _matches_principal(field: Field, value: Element, element: Element) -> bool:
    """Whether value is the principal root of element at the sample point."""
    import mpmath

    try:
        with mpmath.workprec(200):
            want = mpmath.sqrt(field.sample.value(element))
            have = field.sample.value(value)
            return bool(abs(have - want) <= abs(have + want))
    except (ArithmeticError, ValueError):
        return True


# ---- odd roots ------------------------------------------------------------------------
def _odd_root(field: Field, element: Element, order: int) -> Element:
    """The odd root: factor by factor, each factor positive at the sample point."""
    if any(g.degree for g in field.generators_of(element)):
        square = element * element
        if any(g.degree for g in field.generators_of(square)):
            tail = field.polynomial(field.lift(element)) * field.denominator(element) ** (order - 1)
            new = _new_root(field, tail, order, sure=False)
            return new / field.denominator(element)
        # u**(1/m) = u / ((u**2)**(1/m))**((m - 1)/2), and u**2 has no algebraic generator.
        return element / _odd_root(field, square, order) ** ((order - 1) // 2)
    content, factors = field.lift(element).factor()
    value = fmpq(content)
    powers = [(field.polynomial(factor), exponent) for factor, exponent in factors]
    powers += [(field.polynomial(field.factors[i]), -e) for i, e in element._den]
    result, sign = field.one, -1 if value < 0 else 1
    for prime, exponent in [*abs(fmpz(value.p)).factor(), *_negated(fmpz(value.q).factor())]:
        result = result * _factor_power(field, field.rational(fmpq(prime)), exponent, order)
    for base, exponent in powers:
        if not field.sample.is_positive(base):
            base = -base
            sign *= -1 if exponent % 2 else 1
        result = result * _factor_power(field, base, exponent, order)
    if sign < 0 and field.is_complex:
        raise ExpressionError(
            f"the root of order {order} of {element} is that of a negative number at the sample "
            "point; give a domain where it is positive"
        )
    return result * sign


def _negated(factors: Any) -> list[tuple[Any, int]]:
    return [(prime, -exponent) for prime, exponent in factors]


def _factor_power(field: Field, base: Element, exponent: int, order: int) -> Element:
    """base**(exponent/order) for an irreducible base."""
    whole, rest = divmod(exponent, order)
    result = base**whole
    if not rest:
        return result
    return result * _irreducible_root(field, base, order) ** rest


def _irreducible_root(field: Field, base: Element, order: int) -> Element:
    """base**(1/order), through the finest root of this base that is already there."""
    from math import gcd, lcm

    finest, depth = base, 1
    for generator in reversed(field.generators):
        if generator.kind == "root" and generator.argument is not None:
            if generator.argument[0] == base:
                finest, depth = field.generator_element(generator), generator.argument[1]
    if depth % order == 0:
        return finest ** (depth // order)
    step = lcm(depth, order) // depth
    assert gcd(step, 2) == 1
    new = _new_root(field, finest, step, sure=True, base=(base, depth * step))
    return new ** (depth * step // order)


def _new_root(
    field: Field, tail: Element, order: int, sure: bool, base: tuple[Element, int] | None = None
) -> Element:
    """A new generator with generator**order = tail."""
    shown = tail.sympy ** sympy.Rational(1, order)
    if base is not None:
        shown = base[0].sympy ** sympy.Rational(1, base[1])
    generator = Generator(
        "root", field.next_name("root"), shown, tail.symbols, order, tail, argument=base, sure=sure
    )
    return field.add(generator)


def _state(
    field: Field,
    element: Element,
    value: Element,
    radical: sympy.Expr | None,
    outer: Element | None = None,
) -> None:
    """Notes the branch, unless the symbols' assumptions leave only one."""
    shown = (value if outer is None else outer).sympy
    if radical is None or shown.is_nonnegative:
        return
    field.state_branch(Branch(radical, value.sympy, f"{shown} >= 0"))

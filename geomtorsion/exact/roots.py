"""Roots: rational powers of elements with the branch that was chosen, and which are in the field.

Whether an element is a square is decided in towers of quadratic extensions.
"""

from __future__ import annotations

from math import lcm, prod
from typing import TYPE_CHECKING

import mpmath
import sympy
from flint import fmpq, fmpz

from geomtorsion.errors import ExpressionError
from geomtorsion.exact.generators import Branch, Generator
from geomtorsion.exact.limits import NoPointError
from geomtorsion.exact.polynomials import prime_factors, split
from geomtorsion.precision import working_precision

if TYPE_CHECKING:
    from geomtorsion.exact.element import Element
    from geomtorsion.exact.tower import Tower


def root(
    field: Tower, element: Element, order: int, radical: sympy.Expr | None = None, /
) -> Element:
    """The root of an order, positive at the sample point; it may add a generator.

    The odd part comes first, then square roots one by one.
    """
    if not element._num:
        return field.zero
    value = element
    odd = order
    # Square roots are decided in towers of quadratic extensions, so they come last.
    while odd % 2 == 0:
        odd //= 2
    if odd > 1:
        value = _odd_root(field, value, odd)
    while odd < order:
        value = _square_root(field, value, radical)
        odd *= 2
    return value


def _square_root(field: Tower, element: Element, radical: sympy.Expr | None) -> Element:
    """The square root: inside the field where it exists there, else a new generator."""
    if not field.sample.prefer_positive(element) and not field.is_complex:
        raise ExpressionError(
            f"the square root of {element}, which is negative at every place that was tried; turn "
            "its sign, give a domain where it is positive, or declare the frame complex"
        )
    inside = square_root_inside(field, element)
    if inside is not None:
        positive = inside if field.sample.is_positive(inside) else -inside
        _state(field, element, positive, radical)
        return positive
    taken = without_odd_roots(field, element)
    if taken is not None and taken[0] != 1:
        half, rest = taken
        value = half * _square_root(field, rest, None)
        return value if _matches_principal(field, value, element) else -value
    outer, content, tail = _squares_taken_out(field, element)
    if content < 0 and field.is_complex:
        # sqrt(-x) and sqrt(x) are dependent through I: one of them is enough.
        turned = _square_root(field, -element, None) * field.imaginary
        return turned if _matches_principal(field, turned, element) else -turned
    generator = field.add_root(tail, 2, _is_decided(field, tail))
    value = outer * generator
    if not outer.is_rational:
        if not _matches_principal(field, value, element):
            value, outer = -value, -outer
        _state(field, element, value, radical, outer)
    return value


def _squares_taken_out(field: Tower, element: Element) -> tuple[Element, fmpz, Element]:
    """(outer, content, tail) with element = outer**2 * tail, tail a polynomial."""
    content, factors = field.factored(field.lift(element))
    # Squares go outside, so that sqrt(4 x) and sqrt(x) share one generator.
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


def _square_part(value: fmpq) -> tuple[fmpq, fmpz]:
    """(s, f) with value = s**2 f, f a square-free integer with the sign of value."""
    whole = fmpz(value.p * value.q)
    sign = -1 if whole < 0 else 1
    square, free = fmpz(1), fmpz(sign)
    for prime, exponent in prime_factors(abs(whole)):
        square *= prime ** (exponent // 2)
        free *= prime ** (exponent % 2)
    return fmpq(square, value.q), free


def _is_decided(field: Tower, tail: Element) -> bool:
    """Whether the tower decides that `tail` is no square (no higher roots involved)."""
    return not any(g.degree > 2 for g in field.generators_of(tail))


def _matches_principal(field: Tower, value: Element, element: Element) -> bool:
    """Whether value is the principal root of element at the sample point."""
    try:
        with working_precision(200):
            want = mpmath.sqrt(field.sample.value(element))
            have = field.sample.value(value)
            return bool(abs(have - want) <= abs(have + want))
    except (ArithmeticError, ValueError):
        return True


def _state(
    field: Tower,
    element: Element,
    value: Element,
    radical: sympy.Expr | None,
    outer: Element | None = None,
) -> None:
    """Notes the branch, unless the symbols' assumptions leave only one."""
    if radical is None:
        return
    positive = value if outer is None else outer
    if not positive.sympy.is_nonnegative:
        field.state_branch(Branch(radical, value.sympy, "", positive))


def _odd_root(field: Tower, element: Element, order: int) -> Element:
    """The odd root: factor by factor, each factor positive at the sample point."""
    if any(g.degree for g in field.generators_of(element)):
        # An odd root of u with square roots in it: if u**2 has none, its root is enough.
        square = element * element
        if any(g.degree for g in field.generators_of(square)):
            if not field.sample.prefer_positive(element) and not field.is_complex:
                positive = _odd_root(field, -element, order)
                _state_odd(field, element, order, positive)
                return -positive
            tail = field.polynomial(field.lift(element)) * field.denominator(element) ** (order - 1)
            new = field.add_root(tail, order, sure=False)
            return new / field.denominator(element)
        # u**(1/m) = u / ((u**2)**(1/m))**((m - 1)/2), and u**2 has no algebraic generator.
        return element / _odd_root(field, square, order) ** ((order - 1) // 2)
    field.sample.prefer_positive(element)
    content, factors = field.factored(field.lift(element))
    value = fmpq(content)
    powers = [(field.polynomial(factor), exponent) for factor, exponent in factors]
    powers += [(field.polynomial(field.factors[i]), -e) for i, e in element._den]
    result, sign = field.one, -1 if value < 0 else 1
    for prime, exponent in [*prime_factors(abs(value.p)), *_negated(prime_factors(value.q))]:
        result = result * _factor_power(field, field.rational(fmpq(prime)), exponent, order)
    for base, exponent in powers:
        if not field.sample.is_positive(base):
            base = -base
            sign *= -1 if exponent % 2 else 1
        result = result * _factor_power(field, base, exponent, order)
    if sign < 0 and not field.is_complex:
        _state_odd(field, element, order, result)
    if sign < 0 and field.is_complex:
        raise ExpressionError(
            f"the root of order {order} of {element} is that of a negative number at the sample "
            "point; give a domain where it is positive"
        )
    return result * sign


def _state_odd(field: Tower, element: Element, order: int, positive: Element) -> None:
    """Notes that the odd root of what is negative is read as the real one."""
    shown = element.sympy ** sympy.Rational(1, order)
    branch = Branch(shown, (-positive).sympy, f"{element} <= 0: the real root", -element)
    field.state_branch(branch)


def _negated(factors: list[tuple[fmpz, int]]) -> list[tuple[fmpz, int]]:
    return [(prime, -exponent) for prime, exponent in factors]


def _factor_power(field: Tower, base: Element, exponent: int, order: int) -> Element:
    """base**(exponent/order) for an irreducible base."""
    whole, rest = divmod(exponent, order)
    result = base**whole
    if not rest:
        return result
    return result * _irreducible_root(field, base, order) ** rest


def _irreducible_root(field: Tower, base: Element, order: int) -> Element:
    """base**(1/order), through the finest root of this base that is already there."""
    # x**(1/3) and x**(1/9) are dependent: the finest root so far gives the others.
    finest, depth = base, 1
    for generator in reversed(field.generators):
        known = generator.argument if generator.kind == "root" else None
        if known is not None and known[0] == base:
            finest, depth = field.generator_element(generator), known[1]
    if depth % order == 0:
        return finest ** (depth // order)
    step = lcm(depth, order) // depth
    new = field.add_root(finest, step, sure=True, base=(base, depth * step))
    return new ** (depth * step // order)


def square_root_inside(
    field: Tower, element: Element, *, by_its_own: bool = False
) -> Element | None:
    """An exact square root within the field as it stands, or None.

    In F(w), w**2 = P: A is a square if A or A P is one in F; A + B w is one exactly if
    A**2 - B**2 P = n**2 in F and (A + n)/2 or (A - n)/2 is a square there.

    by_its_own: with no other roots than the element has, and those that stand below them.
    """
    among = _with_those_below(field, element) if by_its_own else field.generators
    # Oldest first: each root stands above those that its radicand contains.
    quadratic = [g for g in reversed(field.generators) if g.degree == 2 and g in among]
    quadratic = [g for g in quadratic if _plain(field, g)]
    if any(
        g not in quadratic if g.degree == 2 else g.degree and not _plain(field, g)
        for g in field.generators_of(element)
    ):
        return None
    try:
        return _inside(field, element, *_levels(field, quadratic), briefly=True)
    except _DearError:
        # Norms of sums under many roots are long: which roots there may be is told without them.
        return _by_classes(field, element, quadratic)


def _levels(field: Tower, quadratic: list[Generator]) -> tuple[list[Generator], list[Generator]]:
    """Roots whose radicands have none, which are compared by their factors alone, and others."""
    base = [g for g in quadratic if g.tail is not None and not _algebraic(field, g.tail)]
    return base, [g for g in quadratic if g not in base]


def _by_classes(field: Tower, element: Element, quadratic: list[Generator]) -> Element | None:
    """The square root of an element with some of these roots; level by level, the highest first."""
    elements = [element, *(g.tail for g in quadratic if g.tail is not None)]
    inner = set[Generator]().union(*(_with_those_below(field, one) for one in elements))
    # Square roots of small numbers are there modulo every prime: these are no equations.
    outer = tuple(g for g in quadratic if g not in inner and g.depends)
    try:
        chosen = field.square_class(element, outer)
    except NoPointError:
        return _inside(field, element, *_levels(field, quadratic))
    if chosen is None:
        return None
    if not outer:
        return _inside(field, element, *_levels(field, quadratic))
    for generator in chosen:
        assert generator.tail is not None
        element = element * generator.tail
    found = _by_classes(field, element, [g for g in quadratic if g not in outer])
    roots = prod(map(field.generator_element, chosen), start=field.one)
    return None if found is None else found / roots


class _DearError(Exception):
    """A norm is too long to be multiplied out before it is known to be needed."""


def _with_those_below(field: Tower, element: Element) -> set[Generator]:
    """The algebraic generators of an element, and of their radicands in turn."""
    found: set[Generator] = set()
    waiting = [element]
    while waiting:
        new = {g for g in field.generators_of(waiting.pop()) if g.degree} - found
        found |= new
        waiting += [g.tail for g in new if g.tail is not None]
    return found


def _plain(field: Tower, generator: Generator) -> bool:
    """Whether the tower below an algebraic generator is quadratic throughout.

    A higher root must stand on no other root: its powers would bring those back.
    """
    assert generator.tail is not None
    below = [g for g in field.generators_of(generator.tail) if g.degree]
    if generator.degree > 2:
        return not below
    return all(g.degree == 2 and _plain(field, g) for g in below)


def _algebraic(field: Tower, element: Element) -> bool:
    """Whether an element contains algebraic generators."""
    return any(g.degree for g in field.generators_of(element))


def _inside(
    field: Tower,
    element: Element,
    base: list[Generator],
    nested: list[Generator],
    briefly: bool = False,
) -> Element | None:
    """The square root in the tower: base generators first, nested ones on top; or None.

    briefly: a `_DearError` where a norm is not multiplied out at once.
    """
    if element.is_kept:
        if briefly:
            raise _DearError
        # Roots that cancel when it is multiplied out would look as if they were there.
        element = field.whole(element)
    if not element._num:
        return field.zero
    if not nested and not any(g.degree == 2 for g in field.generators_of(element)):
        return _by_parity(field, element, base)
    top = (nested or base)[-1]
    below = (base, nested[:-1]) if nested else (base[:-1], nested)
    assert top.tail is not None
    position = field.generators.index(top)
    low, high = split(field.lift(element), position)
    if not high:
        found = _inside(field, element, *below, briefly)
        if found is not None:
            return found
        found = _inside(field, element * top.tail, *below, briefly)
        return None if found is None else found / field.generator_element(top)
    den = field.denominator(element).inverse()
    a, b = field.polynomial(low) * den, field.polynomial(high) * den
    norm = _inside(field, a * a - b * b * top.tail, *below, briefly)
    if norm is None:
        return None
    # One of the two halves is a square where the element is one; which, its branch decides.
    for sign in (1, -1):
        half = (a + norm * sign) * fmpq(1, 2)
        first = _inside(field, half, *below, briefly)
        if first is not None and first._num:
            return first + b / (first * 2) * field.generator_element(top)
    return None


def _by_parity(field: Tower, element: Element, base: list[Generator]) -> Element | None:
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


def _odd_factors(field: Tower, element: Element) -> frozenset[str]:
    """The irreducible factors, primes and sign with odd exponents."""
    content, factors = field.factored(field.lift(element))
    content = fmpq(content)
    odd = {str(factor) for factor, exponent in factors if exponent % 2}
    odd ^= {str(field.factors[index]) for index, exponent in element._den if exponent % 2}
    if content < 0:
        odd.add("-1")
    for prime, exponent in prime_factors(abs(content.p * content.q)):
        if exponent % 2:
            odd.add(str(prime))
    return frozenset(odd)


def without_odd_roots(field: Tower, element: Element) -> tuple[Element, Element] | None:
    """(half, rest) with element = half**2 * rest and no odd root in rest; None if it cannot be.

    With v**m = f and m odd, v**e is v**(e + m)/f, and one of the two exponents is even.
    """
    half, rest = field.one, element
    for generator in field.generators_of(element):
        if generator.degree <= 2:
            continue
        num = field.lift(rest)
        position = field.generators.index(generator)
        powers = {int(m[position]) for m in num.to_dict()}
        if len(powers) != 1 or generator.kind != "root" or generator.tail is None:
            return None
        power = powers.pop()
        v = field.generator_element(generator)
        rest = field.polynomial(num / field.ctx.gen(position) ** power) / field.denominator(rest)
        if power % 2:
            rest = rest / generator.tail
            power += generator.degree
        half = half * v ** (power // 2)
    return half, rest


def _rational_square_root(field: Tower, element: Element) -> Element | None:
    """The square root over the transcendental generators: all exponents even."""
    taken = without_odd_roots(field, element)
    if taken is None:
        return None
    scale, element = taken
    num = field.lift(element)
    content, factors = field.factored(num)
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


def _square_of_rational(value: fmpq) -> fmpq | None:
    """The root of a rational square, or None."""
    value = fmpq(value)
    if value < 0:
        return None
    p, q = fmpz(value.p).isqrt(), fmpz(value.q).isqrt()
    return fmpq(p, q) if p * p == value.p and q * q == value.q else None

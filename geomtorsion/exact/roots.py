"""Roots: rational powers with their branches, roots in the field and roots in denominators.

Whether an element is a square is decided in towers of quadratic extensions.
Roots in denominators are cleared by conjugates, and restored where that is exact: 1/(A + B w) is
kept as (A - B w)/(A**2 - B**2 P).  That norm may vanish where A + B w does not; written and
evaluated, the quotient is therefore turned back.
"""

from __future__ import annotations

from itertools import combinations
from math import gcd, lcm, prod
from typing import TYPE_CHECKING

import sympy
from flint import fmpq, fmpz
from flint.utils.flint_exceptions import DomainError

from geomtorsion.errors import ExpressionError, LimitError
from geomtorsion.exact import polynomials
from geomtorsion.exact.generators import Branch, Generator
from geomtorsion.exact.limits import (
    LARGEST_POWER_TERMS,
    LARGEST_PRODUCT,
    MOST_AT_ONCE,
    NoPointError,
    terms_of_power,
)
from geomtorsion.exact.polynomials import prime_factors, split
from geomtorsion.exact.square_factors import square_factors
from geomtorsion.support.allowance import check_limits

if TYPE_CHECKING:
    from flint import fmpq_mpoly

    from geomtorsion.exact.element import Denominator, Element
    from geomtorsion.exact.tower import Tower

    Below = dict[str, tuple[fmpq_mpoly, int]]


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
            f"contains the square root of {element}, which is negative at every point that was "
            f'tried; declare where it is positive, domain="{element} > 0", or declare the frame '
            "complex"
        )
    inside = square_root_inside(field, element)
    if inside is not None:
        positive = _principal(field, inside)
        _state(field, element, positive, radical)
        return positive
    taken = without_odd_roots(field, element)
    if taken is not None and taken[0] != 1:
        half, rest = taken
        return _principal(field, half * _square_root(field, rest, None))
    outer, content, tail = _squares_taken_out(field, element)
    if content < 0 and field.is_complex:
        # sqrt(-x) and sqrt(x) are dependent through I: one of them is enough.
        return _principal(field, _square_root(field, -element, None) * field.imaginary)
    more = square_factors(field, field.lift(tail))
    if more is not None:
        inner, _, tail = _squares_taken_out(field, field.polynomial(more[1]))
        outer = outer * inner * field.polynomial(more[0])
    generator = _multiple_of_another(field, tail)
    if generator is None:
        generator = field.add_root(tail, 2, _is_decided(field, tail))
    value = outer * generator
    if not outer.is_rational:
        if not field.sample.is_positive(value):
            value, outer = -value, -outer
        _state(field, element, value, radical, outer)
    return value


def _multiple_of_another(field: Tower, tail: Element) -> Element | None:
    """The root of a polynomial, where it is a number times a root in the field."""
    num = field.lift(tail)
    for generator in field.generators:
        if generator.kind != "root" or generator.degree != 2 or not generator.depends:
            continue
        assert generator.tail is not None
        other = field.lift(generator.tail)
        ratio = num.leading_coefficient() / other.leading_coefficient()
        # sqrt(2 x) beside sqrt(x): a quotient of the two would be singular where x = 0.
        if ratio > 0 and not generator.tail._den and other * ratio == num:
            number = _square_root(field, field.rational(ratio), None)
            return field.generator_element(generator) * number
    return None


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
    """Whether the tower decides that `tail` is not a square (no higher roots involved)."""
    return not any(g.degree > 2 for g in field.generators_of(tail))


def _principal(field: Tower, value: Element) -> Element:
    """The one of value and -value that is a principal root at the sample point."""
    return value if field.sample.is_positive(value) else -value


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
            f"contains the root of order {order} of {element}, which is negative at the sample "
            "point; give a domain where it is positive"
        )
    return result * sign


def _state_odd(field: Tower, element: Element, order: int, positive: Element) -> None:
    """Notes that the odd root of a negative element is read as the real root."""
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
        base_and_order = generator.argument if generator.kind == "root" else None
        if base_and_order is not None and base_and_order[0] == base:
            finest, depth = field.generator_element(generator), base_and_order[1]
    if depth % order == 0:
        return finest ** (depth // order)
    step = lcm(depth, order) // depth
    new = field.add_root(finest, step, sure=True, base=(base, depth * step))
    return new ** (depth * step // order)


def square_root_inside(
    field: Tower, element: Element, *, by_its_own: bool = False
) -> Element | None:
    """An exact square root within the present field, or None.

    In F(w), w**2 = P: A is a square if A or A P is one in F; A + B w is one exactly if
    A**2 - B**2 P = n**2 in F and (A + n)/2 or (A - n)/2 is a square there.

    by_its_own: only with roots that occur in the element or in their radicands.
    """
    among = _with_those_below(field, element) if by_its_own else field.generators
    # Oldest first: each root is newer than the roots in its radicand.
    quadratic = [g for g in reversed(field.generators) if g.degree == 2 and g in among]
    quadratic = [g for g in quadratic if _plain(field, g)]
    if any(
        g not in quadratic if g.degree == 2 else g.degree and not _plain(field, g)
        for g in field.generators_of(element)
    ):
        return None
    quadratic = _without_idle_roots(field, element, quadratic)
    try:
        return _inside(field, element, *_levels(field, quadratic), briefly=True)
    except _DearError:
        # Norms of sums under many roots are long: possible roots are found without them.
        return _by_classes(field, element, quadratic)


def _without_idle_roots(
    field: Tower, element: Element, quadratic: list[Generator]
) -> list[Generator]:
    """The quadratic roots without higher roots that cannot make a square of an element.

    All roots f**(1/n) extend a field L in which an irreducible f has no double factor. In L, they
    can make only f itself a square (Kummer), which sqrt(f) shows.
    """
    base, nested = _levels(field, quadratic)
    bottoms = [(g, _only_factor(field, g)) for g in nested]
    if not all(bottom for _, bottom in bottoms):
        return quadratic
    needed = {_only_factor(field, g) for g in _with_those_below(field, element)}
    for generator in base:
        if _only_factor(field, generator) is None:
            assert generator.tail is not None
            _, factors = field.factored(field.lift(generator.tail))
            needed |= {str(factor) for factor, _ in factors}
    idle = {g for g, bottom in bottoms if bottom not in needed}
    return [g for g in quadratic if g not in idle]


def _only_factor(field: Tower, generator: Generator) -> str | None:
    """The irreducible f whose power the root is; None if it is not a power of one f."""
    if generator.kind != "root" or generator.tail is None or generator.tail._den:
        return None
    num, bottom = field.lift(generator.tail), None
    inner = [g for g in field.generators_of(generator.tail) if g.degree]
    if inner:
        place = field.generators.index(inner[0])
        bottom = _only_factor(field, inner[0])
        powers = {int(monomial[place]) for monomial in num.monoms()}
        if len(inner) > 1 or len(powers) > 1 or bottom is None:
            return None
        num = num / field.ctx.gen(place) ** powers.pop()
    content, factors = field.factored(num)
    keys = {str(factor) for factor, exponent in factors if inner or exponent == 1}
    if content != 1 or len(keys) != len(factors) or not keys <= {bottom or min(keys, default="")}:
        return None
    return bottom or min(keys, default=None)


def _levels(field: Tower, quadratic: list[Generator]) -> tuple[list[Generator], list[Generator]]:
    """Roots whose radicands have none, which are compared only by their factors, and others."""
    base = [g for g in quadratic if g.tail is not None and not _algebraic(field, g.tail)]
    return base, [g for g in quadratic if g not in base]


def _by_classes(field: Tower, element: Element, quadratic: list[Generator]) -> Element | None:
    """The square root of an element with some of these roots; level by level, the highest first."""
    elements = [element, *(g.tail for g in quadratic if g.tail is not None)]
    inner = set[Generator]().union(*(_with_those_below(field, one) for one in elements))
    # Square roots of small numbers exist modulo every prime, and give no equations.
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
    square_root = _by_classes(field, element, [g for g in quadratic if g not in outer])
    roots = prod(map(field.generator_element, chosen), start=field.one)
    return None if square_root is None else square_root / roots


class _DearError(Exception):
    """A norm is too long to be multiplied out before it is known to be needed."""


def _with_those_below(field: Tower, element: Element) -> set[Generator]:
    """The algebraic generators of an element, and of their radicands in turn."""
    generators: set[Generator] = set()
    waiting = [element]
    while waiting:
        new = {g for g in field.generators_of(waiting.pop()) if g.degree} - generators
        generators |= new
        waiting += [g.tail for g in new if g.tail is not None]
    return generators


def _plain(field: Tower, generator: Generator) -> bool:
    """Whether the tower below an algebraic generator is quadratic throughout.

    The radicand of a higher root must contain no other root, because powers would bring it back.
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
        square_root = _inside(field, element, *below, briefly)
        if square_root is not None:
            return square_root
        square_root = _inside(field, element * top.tail, *below, briefly)
        return None if square_root is None else square_root / field.generator_element(top)
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

    The element is a square exactly if its odd factors are the sum, over GF(2), of the odd factors
    of some radicands; then it is a rational square times these radicands.
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
    square_root = _rational_square_root(field, product)
    return None if square_root is None else square_root / roots


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
            # v**e = v**(e + m) f / f**2: the denominator stays out of the root.
            rest, half = rest * generator.tail, half / generator.tail
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


def inverse(field: Tower, element: Element, largest: int = LARGEST_PRODUCT) -> Element | None:
    """1/element = den/num, with num freed of algebraic generators first.

    None where a product of more than `largest` pairs of terms would be needed for that.
    """
    num = field.lift(element)
    den = field.cofactor(element._den, ())
    multiplier = field.ctx.constant(1)
    degrees = num.degrees()
    # A quotient by several terms with roots reads better as it was: the denominator is noted.
    rooted = len(num) > 1 and any(
        g.degree and d > 0 for g, d in zip(field.generators, degrees, strict=True)
    )
    numerator = num
    for position, generator in enumerate(field.generators):
        if generator.degree and degrees[position] > 0:
            cleared = _cleared_of(field, position, num, multiplier, largest)
            if cleared is None:
                return None
            # A conjugate may bring in roots of the radicand; later passes clear them.
            num, multiplier = cleared
            degrees = num.degrees()
    # Where roots depend on one another, the norm may vanish of what does not.
    if not num or (not field.all_sure and field.polynomial(num).is_zero):
        return None
    # The time of factoring grows at least as fast as the time of squaring.
    if len(num) ** 2 > largest or len(multiplier) * len(den) > largest:
        return None
    if rooted:
        field.note_rooted(field.polynomial(numerator))
    content, factors = field.factored(num)
    # Irreducible factors are registered once, so that later sums share them.
    return field.over_factors(multiplier * den * (1 / content), factors)


def _cleared_of(
    field: Tower, position: int, num: fmpq_mpoly, multiplier: fmpq_mpoly, largest: int
) -> tuple[fmpq_mpoly, fmpq_mpoly] | None:
    """num and multiplier times a conjugate, so that num is free of a root; None if too large."""
    generator = field.generators[position]
    if generator.degree > 2:
        pair = _conjugate_of_few_powers(field, num, position, largest)
        if pair is None:
            pair = _conjugate(field, num, position, largest)
        if pair is None or len(multiplier) * len(pair[1]) > largest:
            return None
        # Division by factors of such a high degree takes as long as the square.
        if _is_high(generator) and (len(multiplier) * len(pair[1])) ** 2 > largest:
            return None
        return pair[0], field.reduced(multiplier * pair[1])
    assert generator.tail is not None
    tail = field.lift(generator.tail)
    w = field.ctx.gen(position)
    below, above = polynomials.split(num, position)
    # 1/(B w) = w/(B P): no conjugate is needed.
    if not below:
        return field.reduced(above * tail), field.reduced(multiplier * w)
    most = max(len(num), len(multiplier)) * len(num)
    if most > largest or len(above) ** 2 * len(tail) > largest:
        return None
    square = field.reduced(below * below - above * above * tail)
    return square, field.reduced(multiplier * (below - above * w))


def coefficients(field: Tower, poly: fmpq_mpoly, position: int, degree: int) -> list[fmpq_mpoly]:
    """The coefficients of 1, w, ..., w**(degree - 1) for the generator at a position."""
    parts: list[dict[tuple[int, ...], fmpq]] = [{} for _ in range(degree)]
    for monomial, value in poly.to_dict().items():
        exponents = list(monomial)
        power, exponents[position] = int(exponents[position]), 0
        parts[power][tuple(exponents)] = value
    return [field.ctx.from_dict(part) for part in parts]


def _conjugate_of_few_powers(
    field: Tower, num: fmpq_mpoly, position: int, largest: int
) -> tuple[fmpq_mpoly, fmpq_mpoly] | None:
    """(norm, c) as `_conjugate` gives them, in closed form for B w**k and A + B w**k.

    With m = n / gcd(n, k) the power (w**k)**m is free of w, and A + u divides A**m - (-u)**m.
    """
    generator = field.generators[position]
    powers = sorted({int(monomial[position]) for monomial in num.monoms()})
    if generator.middle or len(powers) > 2 or (len(powers) == 2 and powers[0]):
        return None
    n, k = generator.degree, powers[-1]
    w = field.ctx.gen(position)
    if len(powers) == 1:
        factor = w ** (n - k)
        return field.reduced(num * factor), factor
    parts = coefficients(field, num, position, n)
    below, above = parts[0], parts[k]
    m = n // gcd(n, k)
    # Powers of sums are bounded as sums of m equal parts; the product of both is the conjugate.
    if terms_of_power(len(below), m) * terms_of_power(len(above), m) > largest:
        return None
    step = -above * w**k
    conjugate, lower = field.ctx.constant(0), [field.ctx.constant(1)]
    for _ in range(m):
        lower.append(field.reduced(lower[-1] * below))
    upper = field.ctx.constant(1)
    for j in range(m):
        conjugate = conjugate + lower[m - 1 - j] * upper
        upper = field.reduced(upper * step)
    return field.reduced(lower[m] - upper), field.reduced(conjugate)


def _conjugate(
    field: Tower, num: fmpq_mpoly, position: int, largest: int
) -> tuple[fmpq_mpoly, fmpq_mpoly] | None:
    """(norm, c) with num * c = norm, free of the generator w of degree n at the position.

    Multiplication by num is an n by n matrix on the powers of w; c is made of the cofactors
    of its first row and the norm is its determinant, both without any division. None where a
    product is larger than `largest`, or where the minors, one for each subset of the columns, are
    too many.
    """
    generator = field.generators[position]
    n = generator.degree
    # The matrix has n**2 entries, with n times as many terms as its first column.
    if _is_high(generator) or n**2 * len(num) > largest:
        return None
    w = field.ctx.gen(position)
    columns = []
    power = num
    for _ in range(n):
        columns.append(coefficients(field, power, position, n))
        power = field.reduced(power * w)
    # minors[S]: determinant of the last len(S) rows in the columns S, built row by row.
    minors: dict[tuple[int, ...], fmpq_mpoly] = {(): field.ctx.constant(1)}
    for size in range(1, n):
        row = n - size
        larger = {}
        for chosen in combinations(range(n), size):
            minor = _expanded(field, [columns[k][row] for k in chosen], chosen, minors, largest)
            if minor is None:
                return None
            larger[chosen] = minor
        minors = larger
    norm = conjugate = field.ctx.constant(0)
    for k in range(n):
        minor = minors[tuple(j for j in range(n) if j != k)]
        cofactor = -minor if k % 2 else minor
        if len(columns[k][0]) * len(cofactor) > largest:
            return None
        norm = norm + columns[k][0] * cofactor
        conjugate = conjugate + cofactor * w**k
    return field.reduced(norm), field.reduced(conjugate)


def _is_high(generator: Generator) -> bool:
    """Whether a root is of so high an order that its minors are too many."""
    return generator.degree * 2 ** (generator.degree - 1) > LARGEST_POWER_TERMS


def _expanded(
    field: Tower,
    row: list[fmpq_mpoly],
    chosen: tuple[int, ...],
    minors: dict[tuple[int, ...], fmpq_mpoly],
    largest: int,
) -> fmpq_mpoly | None:
    """A determinant expanded along its first row; None where a product would be too large."""
    check_limits()
    total = field.ctx.constant(0)
    for place, entry in enumerate(row):
        if entry:
            minor = minors[chosen[:place] + chosen[place + 1 :]]
            if len(entry) * len(minor) > largest:
                return None
            product = entry * minor
            total = total - product if place % 2 else total + product
    return field.reduced(total)


class Norms:
    """The denominators with roots met so far, each with conjugates and norm.

    units: those whose norm is a number, such as sqrt(x**2 + 1) + x, without a minus.
    """

    def __init__(self, field: Tower) -> None:
        self.level: int = field.level
        self.count: int = len(field.rooted)
        self.table: list[tuple[list[fmpq_mpoly], Denominator]] = []
        self.units: list[fmpq_mpoly] = []
        self._seen: set[str] = set()
        for element in tuple(field.rooted):
            for factor, _ in field.factored(field.lift(element))[1]:
                self._enter(field, factor)

    def _enter(self, field: Tower, factor: fmpq_mpoly) -> None:
        """Notes one factor, if it has roots and its norm is a product of known factors."""
        key = str(factor)
        if key in self._seen or len(factor) < 2:
            return
        self._seen.add(key)
        conjugates, norm = [factor], factor
        for place, generator in enumerate(field.generators):
            # The norm over one root may bring in the roots of its radicand.
            if generator.degree != 2 or not norm.degrees()[place]:
                continue
            below, above = polynomials.split(norm, place)
            assert generator.tail is not None
            norm = field.reduced(below * below - above * above * field.lift(generator.tail))
            if factor.degrees()[place]:
                w = field.ctx.gen(place)
                halves = [polynomials.split(poly, place) for poly in conjugates]
                conjugates += [low - high * w for low, high in halves]
        if norm == factor:
            return
        powers: dict[int, int] = {}
        factors = field.factored(norm)[1]
        # The norm of a square is one; as a polynomial it has no factors, for its roots are reduced.
        if len(factor) ** 2 <= MOST_AT_ONCE and all(exponent % 2 == 0 for _, exponent in factors):
            try:
                inside = square_root_inside(field, field.polynomial(factor), by_its_own=True)
            except LimitError:
                # Numbers too large to be factored: the denominator is written as it is.
                return
            if inside is not None and not inside._den:
                for part, _ in field.factored(field.lift(inside))[1]:
                    self._enter(field, part)
                return
        for part, exponent in factors:
            index = field.factor_index.get(str(part))
            # Only norms in the denominator of some element can be replaced.
            if index is None:
                return
            powers[index] = powers.get(index, 0) + exponent
        if powers:
            self.table.append((conjugates, tuple(sorted(powers.items()))))
        elif not _mixed(factor):
            self.units.append(factor)


def norms(field: Tower) -> Norms:
    """The table of norms, made again when the field has grown."""
    table = field.tables.get("norms")
    if table is None or table.level != field.level or table.count != len(field.rooted):
        table = field.tables["norms"] = Norms(field)
    return table


def roots_restored(element: Element) -> tuple[fmpq_mpoly, Denominator, Below]:
    """(num, den, {key: (polynomial, exponent)}): the element with roots below where exact."""
    field = element.field
    num, den = field.lift(element), element._den
    below: Below = {}
    if not field.rooted:
        return num, den, below
    # Whole norms first; what several inverses share, or one of them in part, may be left.
    for whole in (True, False):
        for conjugates, powers in norms(field).table:
            while part := _shared(den, powers, whole):
                check_limits()
                quotient = _divided(field, num, conjugates, part)
                if quotient is None:
                    break
                # num/part = quotient/divisor, and the cleared factor is gone from the denominator.
                num, divisor = quotient
                den = _without(den, part)
                if divisor.leading_coefficient() < 0:
                    num, divisor = -num, -divisor
                _enter_below(below, divisor)
        if whole and den and not below and (quotient := _reciprocal(field, num, den)) is not None:
            return field.ctx.constant(1), (), {str(quotient): (quotient, 1)}
    for unit in norms(field).units:
        # sqrt(x**2 + 1) - x has no right digit for large x; 1/(sqrt(x**2 + 1) + x) has them all.
        while _mixed(num) and len(product := field.reduced(num * unit)) < len(num):
            num = product
            _enter_below(below, unit)
    return num, den, below


def _mixed(poly: fmpq_mpoly) -> bool:
    """Whether terms of both signs are there, which may cancel."""
    signs = {value > 0 for value in poly.coeffs()}
    return len(signs) == 2


def _enter_below(below: Below, divisor: fmpq_mpoly) -> None:
    """Note one more factor with roots in a denominator."""
    key = str(divisor)
    below[key] = (divisor, below.get(key, (None, 0))[1] + 1)


def _shared(den: Denominator, powers: Denominator, whole: bool) -> Denominator:
    """What a denominator and a norm have in common; nothing where all of its factors have to."""
    have = dict(den)
    part = tuple((i, min(e, have[i])) for i, e in powers if i in have)
    return part if not whole or len(part) == len(powers) else ()


def _without(den: Denominator, part: Denominator) -> Denominator:
    """The quotient of two denominators."""
    cleared = dict(part)
    return tuple((i, e - cleared.get(i, 0)) for i, e in den if e > cleared.get(i, 0))


def _reciprocal(field: Tower, num: fmpq_mpoly, den: Denominator) -> fmpq_mpoly | None:
    """den/num where that is a polynomial with roots: the inverted factor shared a norm."""
    norm = field.cofactor(den, ())
    # Clearing the denominator does not shorten the conjugate in the numerator.
    if len(num) > len(norm) or len(num) < 2:
        return None
    conjugate, own = field.ctx.constant(1), num
    for place, generator in enumerate(field.generators):
        if generator.degree == 2 and own.degrees()[place]:
            below, above = polynomials.split(own, place)
            flipped = below - above * field.ctx.gen(place)
            # A long norm belongs to a long polynomial, which is not worth writing.
            if max(len(conjugate), len(own)) * len(flipped) > MOST_AT_ONCE:
                return None
            conjugate, own = field.reduced(conjugate * flipped), field.reduced(own * flipped)
    if own == num:
        return None
    try:
        return conjugate / (own / norm)
    except (DomainError, ZeroDivisionError):
        return None


def _divided(
    field: Tower, num: fmpq_mpoly, conjugates: list[fmpq_mpoly], part: Denominator
) -> tuple[fmpq_mpoly, fmpq_mpoly] | None:
    """(q, c) with num/part = q/c for a conjugate c, or None."""
    divided_by = field.cofactor(part, ())
    for conjugate in conjugates:
        try:
            return field.reduced(num * conjugate) / divided_by, conjugate
        except DomainError:
            continue
    return None

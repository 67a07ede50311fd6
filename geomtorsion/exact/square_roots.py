"""Squares: decides whether an element is a square, in towers of quadratic extensions."""

from __future__ import annotations

from typing import TYPE_CHECKING

from flint import fmpq, fmpz

from geomtorsion.exact.polynomials import prime_factors, split

if TYPE_CHECKING:
    from geomtorsion.exact.element import Element
    from geomtorsion.exact.generators import Generator
    from geomtorsion.exact.tower import Tower


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
    # Radicands without roots are compared by their factors alone, nested ones by norms.
    base = [g for g in quadratic if g.tail is not None and not _algebraic(field, g.tail)]
    nested = [g for g in quadratic if g not in base]
    return _inside(field, element, base, nested)


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
    field: Tower, element: Element, base: list[Generator], nested: list[Generator]
) -> Element | None:
    """The square root in the tower: base generators first, nested ones on top; or None."""
    if element.is_kept:
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
    # One of the two halves is a square where the element is one; which, its branch decides.
    for sign in (1, -1):
        half = (a + norm * sign) * fmpq(1, 2)
        first = _inside(field, half, *below)
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

"""Algebraic constants: whether a sum of products of them vanishes, proved by balls of numbers.

Such a sum times its denominator is an algebraic integer.  Its norm, the product of all its
conjugates, is a whole number: a value below 1/(bound of the conjugates)**(degree - 1) is zero
(Liouville 1844), and a ball that holds no zero proves the opposite.
"""

from __future__ import annotations

from dataclasses import dataclass
from math import lcm, prod
from typing import TYPE_CHECKING

import sympy
from flint import acb, arb, fmpq, fmpz

from geomtorsion.exact import polynomials
from geomtorsion.exact.evaluate import LARGEST_BITS
from geomtorsion.support.precision import ball_precision

if TYPE_CHECKING:
    from flint import fmpq_mpoly

    from geomtorsion.exact.element import Element
    from geomtorsion.exact.generators import Generator
    from geomtorsion.exact.tower import Tower


@dataclass(frozen=True)
class _Size:
    """Size of an algebraic number: times below it is an integer; bound limits its conjugates."""

    below: int
    bound: int


def is_algebraic_constant(field: Tower, generator: Generator) -> bool:
    """Whether a generator is a root or a root of unity, built only from numbers."""
    if generator.depends or generator.kind == "symbol":
        return False
    if generator.kind == "root":
        assert generator.tail is not None
        return all(is_algebraic_constant(field, g) for g in field.generators_of(generator.tail))
    return generator.kind == "imaginary" or part_of_turn(generator) is not None


def part_of_turn(generator: Generator) -> fmpq | None:
    """q of a generator cos(2 pi q) or sin(2 pi q)."""
    shown = generator.shown
    if generator.kind == "opaque" and isinstance(shown, sympy.cos | sympy.sin):
        share = shown.args[0] / (2 * sympy.pi)
        if share.is_Rational:
            return fmpq(int(share.p), int(share.q))
    return None


def vanishes(element: Element) -> bool | None:
    """Whether an element, multiplied out, vanishes; None if that is not seen from its constants.

    Its terms are sorted by their factors that are not algebraic constants: each sum of constants
    has to vanish.
    """
    field = element.field
    used = field.generators_of(element)
    constant = [g in used and is_algebraic_constant(field, g) for g in field.generators]
    groups: dict[tuple[int, ...], dict[tuple[int, ...], fmpq]] = {}
    for monomial, value in field.lift(element).to_dict().items():
        inner = tuple(e if c else 0 for e, c in zip(monomial, constant, strict=True))
        outer = tuple(0 if c else e for e, c in zip(monomial, constant, strict=True))
        groups.setdefault(outer, {})[inner] = value
    open_, nonzero = False, False
    for terms in groups.values():
        verdict = _sum_vanishes(field, field.ctx.from_dict(terms))
        nonzero = nonzero or verdict is False
        open_ = open_ or verdict is None
    if not nonzero:
        return None if open_ else True
    # One sum that does not vanish is enough where what multiplies it is independent.
    others = (g for g, c in zip(field.generators, constant, strict=True) if not c and g in used)
    return False if all(g.sure for g in others) else None


def _sum_vanishes(field: Tower, poly: fmpq_mpoly) -> bool | None:
    """Whether a polynomial in algebraic constants vanishes; None above LARGEST_BITS bits."""
    sizes: dict[str, _Size] = {}
    whole = _size(field, poly, sizes)
    others = _degree(field, sizes) - 1
    least = whole.below.bit_length() + others * (whole.bound * whole.below).bit_length()
    bits = 64
    while bits < 2 * min(least, LARGEST_BITS) + 64:
        value = _ball(field, poly, bits)
        if not value.contains(0):
            return False
        size = value.abs_upper()
        if least <= LARGEST_BITS and size < arb(2) ** -least:
            return True
        bits *= 2
    return None


def _size(field: Tower, poly: fmpq_mpoly, sizes: dict[str, _Size]) -> _Size:
    """The size of a polynomial in algebraic constants; collects the sizes of its generators."""
    below, parts = 1, []
    for coefficient, powers in polynomials.terms(field.generators, poly):
        for generator, _ in powers:
            if generator.name not in sizes:
                sizes[generator.name] = _size_of_generator(field, generator, sizes)
        factors = [(sizes[generator.name], exponent) for generator, exponent in powers]
        below = lcm(below, int(coefficient.q) * prod(size.below**e for size, e in factors))
        parts.append((coefficient, prod(size.bound**e for size, e in factors)))
    bound = sum((abs(value) * size for value, size in parts), fmpq(0))
    return _Size(below, -(-int(bound.p) // int(bound.q)))


def _size_of_generator(field: Tower, generator: Generator, sizes: dict[str, _Size]) -> _Size:
    """Size of a root, of the imaginary unit, or of a cosine: twice a cosine is an integer."""
    if generator.kind == "imaginary":
        return _Size(1, 1)
    if generator.kind != "root":
        return _Size(2, 1)
    assert generator.tail is not None
    # With w**n = t and d t an integer, (d w)**n = d**(n - 1) (d t) is one.
    tail = _size(field, field.lift(generator.tail), sizes)
    return _Size(tail.below, int(fmpz(tail.bound).root(generator.degree)) + 1)


def _degree(field: Tower, sizes: dict[str, _Size]) -> int:
    """A bound on the degree of the field of numbers that these generators span."""
    order, roots = 1, 1
    for name in sizes:
        generator = field.by_name[name]
        share = part_of_turn(generator)
        if share is not None:
            # sin(2 pi q) is a polynomial in exp(2 pi i q) and i.
            order = lcm(order, int(share.q), 4 if isinstance(generator.shown, sympy.sin) else 1)
        elif generator.kind == "imaginary":
            order = lcm(order, 4)
        else:
            roots *= generator.degree
    return roots * int(fmpz(order).euler_phi())


def _ball(field: Tower, poly: fmpq_mpoly, bits: int) -> acb:
    """A ball that contains a polynomial in algebraic constants."""
    balls: dict[str, acb] = {}

    def of_generator(generator: Generator) -> acb:
        if generator.name not in balls:
            balls[generator.name] = computed(generator)
        return balls[generator.name]

    def computed(generator: Generator) -> acb:
        if generator.kind == "imaginary":
            return acb(0, 1)
        share = part_of_turn(generator)
        if share is not None:
            angle = 2 * share
            return acb(
                arb.cos_pi_fmpq(angle)
                if isinstance(generator.shown, sympy.cos)
                else arb.sin_pi_fmpq(angle)
            )
        assert generator.tail is not None
        return of_polynomial(field.lift(generator.tail)).root(generator.degree)

    def of_polynomial(poly: fmpq_mpoly) -> acb:
        total = acb(0)
        for coefficient, powers in polynomials.terms(field.generators, poly):
            total += acb(arb(coefficient)) * prod(
                (of_generator(generator) ** exponent for generator, exponent in powers),
                start=acb(1),
            )
        return total

    with ball_precision(bits):
        return of_polynomial(poly)

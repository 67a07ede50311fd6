"""Angles: cos and sin of any argument in terms of one cos and one sin an atom."""

from __future__ import annotations

from typing import TYPE_CHECKING

import mpmath
import sympy
from flint import fmpq

from geomtorsion.exact import limits
from geomtorsion.exact.functions import opaque
from geomtorsion.exact.generators import Generator
from geomtorsion.exact.rational_basis import RationalBasis, single_generator, terms, undone_by_cos
from geomtorsion.exact.roots import square_root_inside
from geomtorsion.precision import working_precision

if TYPE_CHECKING:
    from geomtorsion.exact.element import Element
    from geomtorsion.exact.tower import Tower

Pair = tuple["Element", "Element"]


class Angles:
    """cos and sin by the addition theorems over a rational basis of the angles."""

    def __init__(self, field: Tower) -> None:
        self._field = field
        self.basis: RationalBasis = RationalBasis(field, undone_by_cos)
        self._multiples: dict[tuple[int, fmpq], Pair] = {}
        self._finest: dict[int, tuple[fmpq, Pair]] = {}

    def prepare(self, angles: list[Element]) -> None:
        """Chooses units that serve all these angles at once."""
        # Multiples of pi have values in radicals; the rest is counted in atoms.
        rests = [self._turn_taken_out(angle)[1] for angle in angles]
        self.basis.choose(rests)
        for rest in rests:
            for coefficient, index in self.basis.decompose(rest):
                if index not in self._finest:
                    self.basis.refine_unit(index, coefficient)

    def cos_sin(self, angle: Element) -> Pair:
        """(cos, sin) of an angle without imaginary part."""
        field = self._field
        turn, rest = self._turn_taken_out(angle)
        pair: Pair = (field.one, field.zero)
        for coefficient, index in self.basis.decompose(rest):
            pair = sum_of_angles(pair, self._multiple(index, coefficient))
        if turn:
            pair = sum_of_angles(pair, self._constant(turn))
        return pair

    def _turn_taken_out(self, angle: Element) -> tuple[fmpq, Element]:
        """(q, rest) with angle = q pi + rest."""
        field = self._field
        circle = field.by_name.get("pi")
        if circle is None:
            return fmpq(0), angle
        pi = field.generator_element(circle)
        for value, monomial in terms(angle):
            if monomial == pi:
                return value, angle - pi * value
        return fmpq(0), angle

    def _constant(self, turn: fmpq) -> Pair:
        """cos and sin of a rational multiple of pi."""
        angle = sympy.pi * sympy.Rational(int(turn.p), int(turn.q))
        if sympy.cos(angle).has(sympy.cos, sympy.sin) and int(turn.q) % 2 == 0:
            return self._halved(self._constant(turn * 2), angle)
        return self._constant_value(sympy.cos(angle)), self._constant_value(sympy.sin(angle))

    def _halved(self, whole: Pair, angle: sympy.Expr) -> Pair:
        """cos and sin of half a constant angle, by roots with the signs of their values."""
        half = fmpq(1, 2)
        cos, sin = ((whole[0] + 1) * half).sqrt(), ((1 - whole[0]) * half).sqrt()
        number = angle.evalf(30)
        return (
            cos if sympy.cos(number) > 0 else -cos,
            sin if sympy.sin(number) > 0 else -sin,
        )

    def _constant_value(self, value: sympy.Expr) -> Element:
        """An algebraic constant, in radicals where sympy knows them."""
        if value.has(sympy.cos, sympy.sin):
            return opaque(self._field, value, ())
        return self._field.read(value)

    def _multiple(self, index: int, coefficient: fmpq) -> Pair:
        """cos and sin of coefficient * atom."""
        known = self._multiples.get((index, coefficient))
        if known is not None:
            return known
        unit, pair = self._base(index, coefficient)
        count = coefficient / unit
        if count.q != 1:
            unit, pair = self._refined(index, int(count.q))
            count = coefficient / unit
        n = int(count.p)
        limits.check_multiple(n, "angles", self.basis.elements[index], unit)
        # cos(n u) by repeated doubling: log(n) products instead of n.
        cos, sin = power_of_pair(pair, abs(n), self._field)
        result = (cos, -sin if n < 0 else sin)
        self._multiples[index, coefficient] = result
        return result

    def _base(self, index: int, coefficient: fmpq) -> tuple[fmpq, Pair]:
        """The finest unit of an atom and its pair; made on first use."""
        if index not in self._finest:
            atom = self.basis.elements[index]
            inverse = _of_atom(self._field, atom)
            unit = fmpq(1) if inverse else self.basis.units[index] or coefficient
            self.basis.units[index] = unit
            self._finest[index] = (unit, inverse or self._new_pair(atom * unit))
        return self._finest[index]

    def _new_pair(self, angle: Element) -> Pair:
        field = self._field
        n, shown = len(field.generators), angle.sympy
        names = (f"co{n}", f"si{n}")
        c = Generator("cos", names[0], sympy.cos(shown), angle.symbols, argument=(angle, names[1]))
        cos = field.add(c)
        tail = field.one - cos * cos
        s = Generator(
            "sin", names[1], sympy.sin(shown), angle.symbols, 2, tail, argument=(angle, names[0])
        )
        return cos, field.add(s)

    def _refined(self, index: int, parts: int) -> tuple[fmpq, Pair]:
        """The pair of a finer unit: an algebraic generator for each prime part."""
        unit, pair = self._finest[index]
        limits.check_multiple(parts, "angles", self.basis.elements[index], unit / parts)
        prime = 2
        while parts > 1:
            while parts % prime:
                prime += 1
            parts //= prime
            unit = unit / prime
            pair = self._part(self.basis.elements[index] * unit, pair, prime)
        self._finest[index] = (unit, pair)
        return unit, pair

    def _part(self, angle: Element, whole: Pair, prime: int) -> Pair:
        """cos and sin of angle from those of prime * angle."""
        field = self._field
        cos = None
        if prime == 2:
            inside = square_root_inside(field, (whole[0] + 1) * fmpq(1, 2))
            if inside is not None:
                with working_precision(200):
                    want = mpmath.cos(field.sample.value(angle))
                    have = field.sample.value(inside)
                cos = inside if mpmath.re(want * have) > 0 else -inside
        if cos is None:
            cos = self._algebraic_part(angle, whole, prime)
        return cos, whole[1] / _second_kind(prime - 1, cos, field)

    def _algebraic_part(self, angle: Element, whole: Pair, prime: int) -> Element:
        """cos of the part of an angle; where cos of the whole is no polynomial, by a root."""
        field = self._field
        # A polynomial relation T_n(w) = cos(n u) can be a generator; a quotient cannot.
        if not whole[0]._den:
            return self._new_part(angle, whole, prime)
        if prime > 2:
            return opaque(field, sympy.cos(angle.sympy), (angle,))
        with working_precision(200):
            positive = mpmath.re(mpmath.cos(field.sample.value(angle))) > 0
        root = ((whole[0] + 1) * fmpq(1, 2)).sqrt()
        return root if positive else -root

    def _new_part(self, angle: Element, whole: Pair, prime: int) -> Element:
        """A generator w with T_prime(w) = cos(prime * angle)."""
        field = self._field
        lead = fmpq(1, 2 ** (prime - 1))
        rest = sympy.Poly(sympy.chebyshevt_poly(prime, sympy.Symbol("w")), sympy.Symbol("w"))
        middle = tuple(
            (power, -fmpq(int(value)) * lead)
            for (power,), value in rest.terms()
            if 0 < power < prime
        )
        constant = fmpq(int(rest.eval(0)))
        tail = (whole[0] - constant) * lead
        name = field.next_name("part")

        def sine() -> Element:
            w = field.generator_element(field.by_name[name])
            return whole[1] / _second_kind(prime - 1, w, field)

        generator = Generator(
            "chebyshev", name, sympy.cos(angle.sympy), angle.symbols, prime, tail, middle,
            argument=(angle, sine),
        )  # fmt: skip
        return field.add(generator)


def _of_atom(field: Tower, atom: Element) -> Pair | None:
    """cos and sin of an atom that is an inverse function."""
    generator = single_generator(field, atom)
    if generator is None or generator.kind != "primitive":
        return None
    inner, _, arguments = generator.argument
    return of_inverse_function(field, type(generator.shown).__name__, inner, arguments)


def of_inverse_function(
    field: Tower, name: str, inner: Element, arguments: tuple[Element, ...]
) -> Pair | None:
    """cos and sin of atan, atan2, asin, acos: algebraic."""
    if name == "atan2":
        y, x = arguments
        radius = (x * x + y * y).sqrt()
        return x / radius, y / radius
    if name in ("atan", "acot"):
        # acot(u) is atan(1/u), which has the sign of u.
        slope = inner if name == "atan" else 1 / inner
        root = (slope * slope + 1).sqrt()
        return 1 / root, slope / root
    if name in ("asin", "acos"):
        root = (1 - inner * inner).sqrt()
        return (root, inner) if name == "asin" else (inner, root)
    return None


def sum_of_angles(a: Pair, b: Pair) -> Pair:
    """cos and sin of a sum of angles."""
    if a[0].is_one:
        return b
    field = a[0].field
    return (
        field.sum(((1, a[0], b[0]), (-1, a[1], b[1]))),
        field.sum(((1, a[1], b[0]), (1, a[0], b[1]))),
    )


def power_of_pair(pair: Pair, n: int, field: Tower) -> Pair:
    """cos and sin of n times the angle."""
    result: Pair = (field.one, field.zero)
    while n:
        if n & 1:
            result = sum_of_angles(result, pair)
        n >>= 1
        if n:
            pair = sum_of_angles(pair, pair)
    return result


def _second_kind(n: int, x: Element, field: Tower) -> Element:
    """The Chebyshev polynomial U_n(x): sin((n + 1) t) = sin t U_n(cos t)."""
    before, now = field.zero, field.one
    for _ in range(n):
        before, now = now, 2 * x * now - before
    return now

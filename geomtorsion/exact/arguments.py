"""Arguments: angles and exponents, counted in elements that are independent over Q."""

from __future__ import annotations

from math import gcd
from typing import TYPE_CHECKING

import mpmath
import sympy
from flint import fmpq, fmpq_mat

from geomtorsion.exact import limits
from geomtorsion.exact.element import Canonical, Denominator, Element
from geomtorsion.exact.functions import opaque
from geomtorsion.exact.generators import Generator
from geomtorsion.exact.roots import square_root_inside
from geomtorsion.support.precision import working_precision

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence

    from flint import fmpq_mpoly

    from geomtorsion.exact.tower import Tower


class RationalBasis:
    """Elements independent over the rationals, each with the unit in which it is counted.

    stands_alone: which terms are atoms wherever they occur, as the function undoes them.
    """

    def __init__(self, field: Tower, stands_alone: Callable[[Tower, Element], bool]) -> None:
        self._field = field
        self._stands_alone = stands_alone
        self.elements: list[Element] = []
        self.units: list[fmpq] = []
        self._index: dict[Element, int] = {}
        self._all_monomials = True

    def decompose(self, element: Element) -> list[tuple[fmpq, int]]:
        """The element as sum of coefficient * atom; new atoms are added where needed."""
        parts = terms(element)
        if self._all_monomials and not element._den:
            for _, monomial in parts:
                if monomial not in self._index:
                    self._add(monomial)
            # Different monomials are independent: no linear algebra is needed.
            return [(value, self._index[monomial]) for value, monomial in parts]
        # Sums that are atoms themselves may span this one; only if not, its terms become atoms.
        coefficients = self._express(element)
        if coefficients is None:
            for _, part in parts:
                if self._express(part) is None:
                    self._add(part)
            coefficients = self._express(element)
            assert coefficients is not None
        return [(value, index) for index, value in enumerate(coefficients) if value]

    def choose(self, elements: list[Element]) -> None:
        """Adds atoms for all these at once: whole sums where these are fewer than their terms.

        A single cos(k*x - w*t) keeps its angle; cos(x), cos(y) and cos(x + y) are split. exp of a
        logarithm is simplified, cos of a logarithm is not: there sums also stay whole.
        """
        if self._all_monomials and all(_is_monomial(element) for element in elements):
            # Different monomials are independent: no linear algebra is needed.
            parts = [part for element in elements for _, part in terms(element)]
            for part in sorted(parts, key=lambda x: not self._stands_alone(self._field, x)):
                if part not in self._index:
                    self._add(part)
            return
        whole: list[Element] = []
        monomials: list[Element] = []
        for element in elements:
            rest = element
            for value, part in terms(element):
                if self._stands_alone(self._field, part):
                    self._add_new(part)
                    rest = rest - part * value
            if rest._num and self._express(rest) is None:
                trial = [*self.elements, *whole]
                if express(self._field, [rest], [[atom] for atom in trial]) is None:
                    whole.append(rest)
                for _, part in terms(rest):
                    trial = [*self.elements, *monomials]
                    if express(self._field, [part], [[atom] for atom in trial]) is None:
                        monomials.append(part)
        for atom in whole if len(whole) < len(monomials) else monomials:
            self._add_new(atom)

    def _add_new(self, atom: Element) -> None:
        """Adds an atom that the present ones do not span."""
        if self._express(atom) is None:
            self._add(atom)

    def _express(self, element: Element) -> list[fmpq] | None:
        return express(self._field, [element], [[atom] for atom in self.elements])

    def _add(self, atom: Element) -> None:
        single = len(self._field.lift(atom)) == 1 and not atom._den
        index = {**self._index, atom: len(self.elements)}
        elements, units = [*self.elements, atom], [*self.units, fmpq(0)]
        # All at once: whoever interrupts finds all of it or nothing.
        self._index, self.elements, self.units = index, elements, units
        self._all_monomials = self._all_monomials and single

    def refine_unit(self, index: int, coefficient: fmpq) -> None:
        """Makes the unit of an atom divide a coefficient; only before the unit is in use."""
        self.units[index] = rational_gcd(self.units[index], coefficient)


def _is_monomial(element: Element) -> bool:
    """Whether an element has at most one term, and no denominator."""
    return not element.is_kept and not element._den and len(element._num) < 2


def undone_by_exp(field: Tower, atom: Element) -> bool:
    """Whether the atom is a single logarithm or inverse function."""
    generator = single_generator(field, atom)
    if generator is None:
        return False
    return generator.kind in ("log", "primitive") or isinstance(generator.shown, sympy.log)


def undone_by_cos(field: Tower, atom: Element) -> bool:
    """Whether the atom is a single inverse function."""
    generator = single_generator(field, atom)
    return generator is not None and generator.kind == "primitive"


def single_generator(field: Tower, atom: Element) -> Generator | None:
    """The generator that the element is, or None."""
    num = field.lift(atom)
    if atom._den or len(num) != 1 or num.total_degree() != 1 or num.leading_coefficient() != 1:
        return None
    return next(g for g, degree in zip(field.generators, num.degrees(), strict=True) if degree)


def rational_gcd(a: fmpq, b: fmpq) -> fmpq:
    """The largest rational of which both are integer multiples."""
    q = int(a.q) * int(b.q) // gcd(int(a.q), int(b.q))
    return fmpq(gcd(int(a.p) * (q // int(a.q)), int(b.p) * (q // int(b.q))), q)


def terms(element: Element) -> list[tuple[fmpq, Element]]:
    """The element as sum of rational * monomial: its polynomial part, then the part over den.

    u/R + pi/3 is kept as (3 u + pi R)/(3 R); division with remainder takes pi/3 out again.
    """
    field = element.field
    rest = field.lift(element)
    if len(rest) == 1 and not element._den:
        value = rest.leading_coefficient()
        return [(value, Canonical(field, rest / value, (), field.level))]
    parts: list[tuple[fmpq_mpoly, Denominator]] = [(rest, element._den)]
    if element._den:
        whole, rest = divmod(rest, field.cofactor(element._den, ()))
        parts = [(whole, ()), (rest, element._den)]
    return [
        (value, Canonical(field, field.ctx.from_dict({tuple(m): fmpq(1)}), den, field.level))
        for poly, den in parts
        for m, value in poly.to_dict().items()
    ]


def express(
    field: Tower, target: Sequence[Element], basis: Sequence[Sequence[Element]]
) -> list[fmpq] | None:
    """Rational q_j with target = sum q_j basis_j (row by row), or None.

    Each vector is a sequence of elements; all have one length.  Monomials over a common
    denominator are independent, so this is linear algebra on their coefficients.
    """
    answer = [fmpq(0)] * len(basis)
    places = _without_own_poles(target, basis)
    if places is None:
        return None
    chosen = [basis[place] for place in places]
    columns = [dict[tuple[int, tuple[int, ...]], fmpq]() for _ in range(len(chosen) + 1)]
    for row in range(len(target)):
        entries = [vector[row] for vector in chosen] + [target[row]]
        common: Denominator = ()
        for entry in entries:
            common = field.lcm(common, entry._den)
        for column, entry in zip(columns, entries, strict=True):
            poly = field.lift(entry) * field.cofactor(common, entry._den)
            for monomial, value in field.reduced(poly).to_dict().items():
                column[row, tuple(monomial)] = value
    keys = sorted({key for column in columns for key in column})
    if not keys:
        return answer
    matrix = fmpq_mat(
        len(keys), len(columns), [c.get(key, fmpq(0)) for key in keys for c in columns]
    )
    reduced, rank = matrix.rref()
    last = len(chosen)
    for row in range(rank):
        pivot = next(j for j in range(last + 1) if reduced[row, j] != 0)
        if pivot == last:
            return None
        answer[places[pivot]] = reduced[row, last]
    return answer


def _without_own_poles(
    target: Sequence[Element], basis: Sequence[Sequence[Element]]
) -> list[int] | None:
    """The places of the vectors that may have a share in the target; None if it is in no span.

    A vector whose denominator has a factor to a higher power than all others has no share in a sum
    without it. This test is cheap; a common denominator has 2**n terms for n nested logarithms.
    """
    # The target comes last.
    vectors, left = [*basis, target], list(range(len(basis) + 1))
    while True:
        own: set[int] = set()
        for row in range(len(target)):
            highest: dict[int, int] = {}
            holders: dict[int, list[int]] = {}
            for place in left:
                for factor, exponent in vectors[place][row]._den:
                    if exponent > highest.get(factor, 0):
                        highest[factor], holders[factor] = exponent, []
                    if exponent == highest[factor]:
                        holders[factor].append(place)
            own.update(places[0] for places in holders.values() if len(places) == 1)
        if len(basis) in own:
            return None
        if not own:
            return left[:-1]
        left = [place for place in left if place not in own]


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
        multiple = self._multiples.get((index, coefficient))
        if multiple is not None:
            return multiple
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
        """cos and sin of angle from cos and sin of prime * angle."""
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
        """cos of the part of an angle; by a root where cos of the whole is not a polynomial."""
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


class Exponents:
    """exp over a rational basis of the exponents.

    An atom met only under cosh and sinh keeps these two as its generators; one that is
    also met under exp is written only in exp.
    """

    def __init__(self, field: Tower) -> None:
        self._field = field
        self.basis: RationalBasis = RationalBasis(field, undone_by_exp)
        self._plain: set[int] = set()
        self._base: dict[int, tuple[fmpq, Element, Element]] = {}
        self._powers: dict[tuple[int, fmpq], tuple[Element, Element]] = {}

    def prepare(self, exponents: list[Element], hyperbolic: list[Element]) -> None:
        """Chooses units that serve all these at once, and which atoms take exp."""
        self.basis.choose([*exponents, *hyperbolic])
        for plain, batch in ((True, exponents), (False, hyperbolic)):
            for exponent in batch:
                for coefficient, index in self.basis.decompose(exponent):
                    if index not in self._base:
                        self.basis.refine_unit(index, coefficient)
                        if plain:
                            self._plain.add(index)

    def exp(self, exponent: Element) -> Element:
        """exp of an exponent without imaginary part."""
        result = self._field.one
        for coefficient, index in self.basis.decompose(exponent):
            self._plain.add(index)
            result = result * self._power(index, coefficient)[0]
        return result

    def cosh_sinh(self, argument: Element) -> tuple[Element, Element]:
        """(cosh, sinh) of an argument without imaginary part."""
        # cosh and sinh of a sum are sums of products of exponentials, each of one atom.
        up = down = self._field.one
        for coefficient, index in self.basis.decompose(argument):
            a, b = self._power(index, coefficient)
            up, down = up * a, down * b
        half = fmpq(1, 2)
        return (up + down) * half, (up - down) * half

    def _power(self, index: int, coefficient: fmpq) -> tuple[Element, Element]:
        """exp of plus and of minus coefficient * atom."""
        pair = self._powers.get((index, coefficient))
        if pair is not None:
            return pair
        if index not in self._base:
            self._make(index, coefficient)
        unit, up, down = self._base[index]
        count = coefficient / unit
        if count.q != 1:
            parts = int(count.q)
            limits.check_multiple(parts, "exponents", self.basis.elements[index], unit / parts)
            up = self._field.root(up, parts)
            unit, down = unit / parts, up.inverse()
            self._base[index] = (unit, up, down)
            count = coefficient / unit
        n = int(count.p)
        limits.check_multiple(n, "exponents", self.basis.elements[index], unit)
        result = (up**n, down**n) if n > 0 else (down**-n, up**-n)
        self._powers[index, coefficient] = result
        return result

    def _make(self, index: int, coefficient: fmpq) -> None:
        field = self._field
        atom = self.basis.elements[index]
        inverse = self._of_inverse_function(atom)
        if inverse is not None:
            self._base[index] = (fmpq(1), inverse, inverse.inverse())
            return
        unit = self.basis.units[index] or abs(coefficient)
        self.basis.units[index] = unit
        exponent = atom * unit
        n, shown = len(field.generators), exponent.sympy
        if index in self._plain:
            name = f"ex{n}"
            up = field.add(
                Generator("exp", name, _power_of_logs(shown), exponent.symbols, argument=exponent)
            )
            self._base[index] = (unit, up, up.inverse())
            return
        names = (f"ch{n}", f"sh{n}")
        cosh = field.add(
            Generator(
                "cosh",
                names[0],
                sympy.cosh(shown),
                exponent.symbols,
                argument=(exponent, names[1]),
            )
        )
        sinh = field.add(
            Generator(
                "sinh",
                names[1],
                sympy.sinh(shown),
                exponent.symbols,
                2,
                cosh * cosh - 1,
                argument=(exponent, names[0]),
            )
        )
        # exp(u) and exp(-u) by cosh and sinh, so that results read in these two.
        self._base[index] = (unit, cosh + sinh, cosh - sinh)

    def _of_inverse_function(self, atom: Element) -> Element | None:
        """exp of log, asinh, acosh, atanh: algebraic."""
        field = self._field
        generator = single_generator(field, atom)
        if generator is None:
            return None
        if generator.kind == "constant" and isinstance(generator.shown, sympy.log):
            return field.read(generator.shown.args[0])
        if generator.kind not in ("log", "primitive"):
            return None
        if generator.kind == "log":
            return generator.argument
        u = generator.argument[0]
        name = type(generator.shown).__name__
        if name == "asinh":
            return u + (u * u + 1).sqrt()
        if name == "acosh":
            return u + (u * u - 1).sqrt()
        if name in ("atanh", "acoth"):
            return ((1 + u) / (1 - u) if name == "atanh" else (u + 1) / (u - 1)).sqrt()
        return None


def _power_of_logs(exponent: sympy.Expr) -> sympy.Expr:
    """exp(exponent), as base**p where the exponent is p * log(base)."""
    factors = sympy.Mul.make_args(exponent)
    logs = [factor for factor in factors if isinstance(factor, sympy.log)]
    if len(logs) != 1:
        return sympy.exp(exponent)
    return logs[0].args[0] ** (exponent / logs[0])

"""Modular: the value of an element at a random point modulo a large prime, which decides zero.

Generators take values in the integers modulo a prime of 256 bits that obey all their relations:
cos and sin are on the circle, roots are roots. This is a homomorphism: zero is mapped to zero, and
an element with a nonzero image is not zero. An element that is not zero is mapped to zero with a
probability of at most degree / prime (Schwartz 1980, Zippel 1979), which `chance` returns.

Half of the numbers modulo a prime p have no square root. In the field of p**2 elements all of them
have one: this field is used where many square roots are needed at once.
"""

from __future__ import annotations

import hashlib
from contextlib import suppress
from copy import copy
from math import prod
from typing import TYPE_CHECKING, Any, TypeVar

import sympy
from flint import (
    fmpq,
    fmpz,
    fmpz_mod_ctx,
    fmpz_mod_poly_ctx,
    fq_default,
    fq_default_ctx,
    fq_default_poly_ctx,
)

from geomtorsion.exact.algebraic_constants import is_algebraic_constant, part_of_turn
from geomtorsion.exact.degrees import degree
from geomtorsion.exact.element import in_order
from geomtorsion.exact.limits import NoPointError
from geomtorsion.exact.polynomials import as_fmpq
from geomtorsion.exact.primes import BITS, ORDER, nth_prime, order_for, root_of_unity
from geomtorsion.support.allowance import check_limits

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable, Sequence
    from fractions import Fraction

    from flint import fmpq_mpoly, fmpz_mod, fmpz_mod_poly

    from geomtorsion.exact.element import Element
    from geomtorsion.exact.generators import Generator, Generators
    from geomtorsion.exact.tower import Tower

# The product of small primes, whose square roots are Gauss sums.
_ROOTS = prod((2, 3, 5, 7, 11, 13, 17, 19, 23))

# Where an element has no value yet.
_NOWHERE: tuple[object, Any] = (object(), None)

T = TypeVar("T")


class _MovedError(Exception):
    """A generator or an element has no value at the present point."""


class _PrimeError(_MovedError):
    """A number, such as a root of two, has no value modulo the present prime."""


class ModularPoint:
    """A random point modulo a prime for the generators of a field, the same at every run.

    extended: values are in the field of p**2 numbers, where each of the p numbers has square roots.
    """

    def __init__(self, field: Tower, extended: bool = False) -> None:
        self._field = field
        self._extended = extended
        # The key of its values in elements; an object for each place.
        self._kind: tuple[bool, sympy.Symbol | None] = (extended, None)
        self._here: object = None
        # Symbol -> a place of this point, and the point at which what depends on it has moved.
        self._moved: dict[sympy.Symbol, tuple[object, ModularPoint]] = {}
        self._place = self._number_of_prime = -1
        # Places since the last at which all generators had values.
        self._tried: int = 0
        # Values of the generators, the oldest first, as far as they exist.
        self._values: list[fmpz_mod | None] = []
        self._rests: dict[str, frozenset[int]] = {}
        # sin goes with cos, sinh with cosh: both are chosen at once.
        self._partners: dict[str, fmpz_mod] = {}
        self._settle()

    # -- values of elements ----------------------------------------------------------------------

    def image(self, element: Element) -> fmpz_mod:
        """The value of an element (see `images`)."""
        return self.images([element])[0]

    def images(self, elements: Sequence[Element]) -> list[fmpz_mod]:
        """The values of elements at one place.

        Raises
        ------
        NoPointError
            no point was found at which all have one.
        """

        def found() -> list[fmpz_mod]:
            self._fill(range(len(self._field.generators)))
            return [self._image(element) for element in elements]

        return self._somewhere(found)

    def square_class(self, element: Element, roots: Generators) -> Generators | None:
        """The square roots whose radicands, times an element, form a square.

        In F(sqrt(a), sqrt(b), ...) an element of F has a root exactly if one of its products with
        a, b, ... has one in F (Kummer), and only one does where these are independent. At each
        place it is a linear equation modulo 2 which of them are squares. None: no product is one.

        Raises
        ------
        NoPointError
            no point was found at which the radicands and the element have values.
        """
        every = [*(root.tail for root in roots if root.tail is not None), element]
        needed = self._below(every)

        def nonresidues() -> int:
            self._fill(needed)
            values = [self._image(one) for one in every]
            if 0 in values:
                raise _MovedError
            return sum(self._is_no_residue(value) << k for k, value in enumerate(values))

        # (pivot, row) of the equations so far, each pivot only in its own row.
        rows: list[tuple[int, int]] = []
        # One point for each unknown; each further point removes half of the wrong candidates.
        for _ in range(len(every) + BITS):
            equation = self._somewhere(nonresidues)
            self._settle()
            for pivot, row in rows:
                equation ^= row if equation & pivot else 0
            pivot = equation & -equation
            if pivot >> len(roots) & 1:
                return None
            if pivot:
                rows = [(p, row ^ equation if row & pivot else row) for p, row in rows]
                rows.append((pivot, equation))
        chosen = sum(pivot for pivot, row in rows if row >> len(roots) & 1)
        return tuple(root for k, root in enumerate(roots) if chosen >> k & 1)

    def moves(self, element: Element, symbol: sympy.Symbol) -> bool | None:
        """Whether an element has another value where only what depends on a symbol has.

        None: too many roots depend on the symbol to find a place with values of all in time.
        """
        oldest = self._field.generators[::-1]
        moved = frozenset(k for k, g in enumerate(oldest) if symbol in g.depends)
        # More tries than this would leave no time before the prime changes.
        if prod(oldest[k].degree for k in moved if oldest[k].kind == "root") > BITS:
            return None
        while True:
            check_limits()
            value, point = self.image(element), self._moved_point(symbol, moved)
            if point._number_of_prime == self._number_of_prime:
                with suppress(_MovedError):
                    point._fill(range(len(oldest)), search=False)
                    return bool(point._image(element) != value)
            self._settle(moved=moved)

    def _moved_point(self, symbol: sympy.Symbol, moved: frozenset[int]) -> ModularPoint:
        """The point at which only what depends on a symbol has moved; one for each place."""
        here, point = self._moved.get(symbol, (None, self))
        # Roots added since may have taken other values here and there.
        if here is not self._here or len(point._values) != len(self._values):
            point = copy(self)
            point._kind, point._partners = (self._extended, symbol), dict(self._partners)
            point._settle(moved=moved)
            self._moved[symbol] = self._here, point
        return point

    def leave(self) -> None:
        """Other values for all generators."""
        self._rests.clear()
        self._settle()

    def _somewhere(self, found: Callable[[], T]) -> T:
        """The result at the present point, or at the next where all of its operands have values."""
        while True:
            check_limits()
            try:
                value = found()
            except _PrimeError:
                self._settle(another_prime=True)
            except _MovedError:
                self._settle()
            else:
                self._tried = 0
                return value

    def _below(self, elements: Iterable[Element]) -> list[int]:
        """The places of the generators of elements and of those on which they rest."""
        generators: set[Generator] = set()
        waiting = list(elements)
        while waiting:
            new = set(self._field.generators_of(waiting.pop())) - generators
            generators |= new
            waiting += [inner for generator in new for inner in self._inner(generator)]
        oldest = self._field.generators[::-1]
        return [place for place, generator in enumerate(oldest) if generator in generators]

    def _inner(self, generator: Generator) -> list[Element]:
        """What the value of a generator is made of: the other side of its relation."""
        both = (generator.tail, self._field.meanings.get(generator.name))
        return [element for element in both if element is not None]

    def _known(self, element: Element) -> fmpz_mod | None:
        """The value at the present place, if it is known."""
        here, value = (element._images or {}).get(self._kind, _NOWHERE)
        return value if here is self._here else None

    def _keep(self, element: Element, value: fmpz_mod) -> None:
        """Note the value of an element at the present place."""
        if element._images is None:
            element._images = {}
        element._images[self._kind] = self._here, value

    def _image(self, element: Element) -> fmpz_mod:
        if not element.is_kept:
            return self._of_polynomials(element)
        for node in in_order(element, lambda x: self._known(x) is not None):
            recipe = node._recipe
            total = self._zero
            for coefficient, *factors in recipe.terms:
                value = self._number(coefficient)
                for factor in factors:
                    stored = self._known(factor)
                    value = value * (self._of_polynomials(factor) if stored is None else stored)
                total = total + value
            if recipe.below:
                total = self._inverse(total)
            self._keep(node, total)
        image = self._known(element)
        assert image is not None
        return image

    def _of_polynomials(self, element: Element) -> fmpz_mod:
        """The value of an element that is multiplied out."""
        value = self._known(element)
        if value is None:
            value = self._polynomial(self._field.lift(element))
            for index, exponent in element._den:
                below = self._polynomial(self._field.factors[index])
                value = value * self._inverse(below) ** exponent
            self._keep(element, value)
        return value

    def _polynomial(self, poly: fmpq_mpoly) -> fmpz_mod:
        """The value of a polynomial of the present ring."""
        total, powers = self._zero, {}
        newest = len(self._field.generators) - 1
        if poly.total_degree() < BITS and not self._extended:
            # In whole numbers, which stay small enough: five times as fast for thousands of terms.
            values = [0] * (newest + 1 - len(self._values))
            values += [0 if value is None else int(value) for value in self._values[::-1]]
            return self._number(poly(*values))
        for monomial, coefficient in poly.to_dict().items():
            term = self._number(coefficient)
            for position, exponent in enumerate(monomial):
                if exponent:
                    key = (position, exponent)
                    if key not in powers:
                        value = self._values[newest - position]
                        assert value is not None
                        powers[key] = value ** int(exponent)
                    term = term * powers[key]
            total = total + term
        return total

    def _number(self, value: int | Fraction | fmpq) -> fmpz_mod:
        """A rational number modulo the prime."""
        if isinstance(value, int):
            return self._ring(value)
        ratio = as_fmpq(value)
        return self._ring(ratio.p) if ratio.q == 1 else self._ring(ratio.p) / self._ring(ratio.q)

    def _inverse(self, value: fmpz_mod) -> fmpz_mod:
        """1 over a value; at a pole the point moves."""
        if value == 0:
            raise _MovedError
        return value**-1

    # -- values of generators --------------------------------------------------------------------

    def _settle(self, another_prime: bool = False, moved: frozenset[int] = frozenset()) -> None:
        """The next place: other values of the symbols, modulo another prime now and then.

        moved: the generators that take other values, with all that depend on them, modulo the same
        prime. Where two roots depend on x and two on y, four values of x are tried and four of y,
        not sixteen of both.
        """
        place, tried = self._place + 1, self._tried + 1
        # One point in n has a root of degree n: all of BITS * n tries fail with a chance of
        # 2**-BITS. With more than ten square roots of a symbol a point may be missed, after 20 s.
        if tried > BITS * min(prod(self._degrees()), 2**10):
            raise NoPointError
        # Symbols have other values at each place.  Roots of numbers, also below a root of a
        # product, need another prime, which takes more time to find.
        values: list[fmpz_mod | None] = []
        if another_prime or place % BITS == 0:
            number = self._number_of_prime + 1
            order = order_for(self._field)
            prime = nth_prime(number, order)
            ring: Any = fmpz_mod_ctx(prime)
            turn: Any = root_of_unity(ring, prime, order)
            polynomials: Any = fmpz_mod_poly_ctx(ring)
            if self._extended:
                ring = fq_default_ctx(prime, 2)
                turn, polynomials = ring(int(turn)), fq_default_poly_ctx(ring)
            modulo = prime, ring, polynomials, ring(0), order, turn
        else:
            number = self._number_of_prime
            prime, ring, polynomials = self._prime, self._ring, self._polynomials
            modulo = prime, ring, polynomials, self._zero, self._order, self._turn
            if moved:
                oldest = self._field.generators[::-1]
                values = [
                    None if moved & self._rests_on(generator) else value
                    for generator, value in zip(oldest, self._values, strict=False)
                ]
        # All at once: whoever interrupts finds the old place or the new one.
        self._here = object()
        self._place, self._number_of_prime, self._values = place, number, values
        self._tried = tried
        self._prime, self._ring, self._polynomials, self._zero, self._order, self._turn = modulo

    def _degrees(self) -> list[int]:
        """The degrees of all algebraic generators."""
        return [generator.degree for generator in self._field.generators if generator.degree]

    def _fill(self, needed: Sequence[int], search: bool = True) -> None:
        """Values for the generators at some places that have none yet, the oldest first.

        search: where one has none, those on which it rests move until it has.
        """
        generators = self._field.generators
        while True:
            self._values += [None] * (len(generators) - len(self._values))
            place = next((place for place in needed if self._values[place] is None), None)
            if place is None:
                return
            generator = generators[len(generators) - 1 - place]
            try:
                self._values[place] = self._value(generator)
            except _MovedError as error:
                if not search:
                    raise
                is_fixed = is_algebraic_constant(self._field, generator)
                if is_fixed or self._order != order_for(self._field):
                    raise _PrimeError from error
                last = max(self._rests_on(generator), default=None)
                if last is None:
                    raise
                self._settle(moved=frozenset([last]))

    def _rests_on(self, generator: Generator) -> frozenset[int]:
        """The places of the generators with random values on which one rests, its own included."""
        if generator.name not in self._rests:
            generators, places = self._field.generators, frozenset[int]()
            if self._inner(generator):
                for element in self._inner(generator):
                    inner = map(self._rests_on, self._field.generators_of(element))
                    places = places.union(*inner)
            elif generator.depends or generator.kind == "constant":
                places = frozenset([len(generators) - 1 - generators.index(generator)])
            self._rests[generator.name] = places
        return self._rests[generator.name]

    def _value(self, generator: Generator) -> fmpz_mod:
        kind = generator.kind
        if kind == "imaginary":
            return self._unity(4)
        if kind in ("cos", "cosh"):
            # Points of the circle and the hyperbola, by one number u.
            u = self._random(generator)
            down = self._inverse(u)
            height = (u - down) / 2
            self._partners[generator.argument[1]] = (
                height / self._unity(4) if kind == "cos" else height
            )
            return (u + down) / 2
        if generator.name in self._partners:
            return self._partners[generator.name]
        if generator.degree:
            return self._algebraic(generator)
        meaning = self._field.meanings.get(generator.name)
        if meaning is not None:
            # It may be made of younger generators, which were added when it was read.
            self._fill(self._below([meaning]), search=False)
            return self._image(meaning)
        if kind == "opaque" and not generator.depends:
            return self._trigonometric(generator)
        return self._random(generator)

    def _random(self, generator: Generator) -> fmpz_mod:
        """A number made from the name, so that it is the same in every process."""
        digest = hashlib.sha512(f"{generator.name} {self._place}".encode()).digest()
        return self._ring(int.from_bytes(digest, "big"))

    def _unity(self, order: int) -> fmpz_mod:
        """exp(2 pi i / order)."""
        if self._order % order:
            raise _MovedError
        return self._turn ** (self._order // order)

    def _algebraic(self, generator: Generator) -> fmpz_mod:
        """A root of the relation of a generator."""
        assert generator.tail is not None
        tail = self._of_polynomials(generator.tail)
        if generator.degree == 2 and not generator.middle:
            return self._square_root(generator.tail, tail)
        if not generator.middle:
            # The number of nonzero elements of the field of the value.
            whole = self._prime - 1 if self._is_whole(tail) else self._prime**2 - 1
            shared = whole.gcd(fmpz(generator.degree))
            if shared == 1:
                return tail ** pow(generator.degree, -1, int(whole))
            if not self._extended and tail ** int(whole // shared) not in (0, 1):
                # Euler's criterion: not a power of this degree, without a search for roots.
                raise _MovedError
        relation: list[Any] = [-tail, *([self._zero] * (generator.degree - 1)), self._ring(1)]
        for power, value in generator.middle:
            relation[power] = relation[power] - self._number(value)
        roots = self._roots(self._polynomials(relation))
        if not roots:
            raise _MovedError
        return min(roots, key=_in_order)

    def _is_whole(self, value: fmpz_mod | fq_default) -> bool:
        """Whether a value is one of the numbers modulo the prime."""
        return not isinstance(value, fq_default) or not any(value.to_list()[1:])

    def _square_root(self, tail: Element, value: fmpz_mod) -> fmpz_mod:
        """The square root; for small whole numbers it agrees with the roots of unity."""
        if tail.is_rational:
            number = tail.as_fraction()
            # Large numbers are not factored: products of these primes are small.
            if number.denominator == 1 and number > 1 and _ROOTS % number.numerator == 0:
                root = self._ring(1)
                for prime, _ in fmpz(number.numerator).factor():
                    root = root * self._root_of_prime(int(prime))
                return root
        if self._is_no_residue(value):
            raise _MovedError
        root = value.sqrt()
        return min(root, -root, key=_in_order)

    def _is_no_residue(self, value: fmpz_mod | fq_default) -> bool:
        """Whether a number has no square root; modulo the prime by its Jacobi symbol."""
        if isinstance(value, fq_default):
            return not value.is_square()
        return fmpz(int(value)).jacobi(self._prime) < 0

    def _root_of_prime(self, prime: int) -> fmpz_mod:
        """The positive square root of a small prime, as a Gauss sum."""
        if prime == 2:
            eighth = self._unity(8)
            return eighth + eighth**-1
        unit, total, power = self._unity(prime), self._zero, self._ring(1)
        squares = {k * k % prime for k in range(1, prime)}
        for k in range(1, prime):
            power = power * unit
            total = total + power if k in squares else total - power
        return total if prime % 4 == 1 else total / self._unity(4)

    def _roots(self, relation: fmpz_mod_poly) -> list[fmpz_mod]:
        return [root for root, _ in relation.roots()]

    def _trigonometric(self, generator: Generator) -> fmpz_mod:
        """cos and sin of parts of a turn by roots of unity; other constants are random."""
        share = part_of_turn(generator)
        if share is None or ORDER % int(share.q):
            return self._random(generator)
        up = self._unity(int(share.q)) ** int(share.p)
        down = up**-1
        if isinstance(generator.shown, sympy.cos):
            return (up + down) / 2
        return (up - down) / (2 * self._unity(4))

    # -- certainty -------------------------------------------------------------------------------

    def chance(self, element: Element) -> float:
        """A bound on the chance that an element that is not zero goes to zero."""
        roots = self._degrees()
        # The norm multiplies degrees by the degrees of all roots; points without roots are omitted.
        size = degree(element) * prod(roots) ** 2
        return int(size) / 2 ** (BITS - 1)


def _in_order(value: fmpz_mod | fq_default) -> list[int]:
    """Key for the order of several values."""
    return list(map(int, value.to_list())) if isinstance(value, fq_default) else [int(value)]

"""Region signs: the sign of an expression all over a region, proved.

Each symbol becomes a fraction of variables that run from 0 to infinity: r > 2*M > 0 is r = 2*M + s.
A polynomial without a minus sign among its coefficients is then positive. Otherwise each variable
is split at 1 (s = 1 + 2*s' and s = 1/(1 + 2*s')), as in Vincent's theorem, until all cells agree.
Two signs are proved by two points inside, at which balls enclose the values.
"""

from __future__ import annotations

import math
from collections import deque
from collections.abc import Collection, Iterable, Mapping, Sequence
from fractions import Fraction
from functools import reduce
from itertools import chain, product
from typing import TYPE_CHECKING, Literal

import sympy as sp
from flint import Ordering, arb, fmpq, fmpq_mpoly, fmpq_mpoly_ctx

from geomtorsion.codegen.balls import BallCode, exact_ball
from geomtorsion.codegen.expression_graph import graph
from geomtorsion.errors import AllowanceError, GeomtorsionError
from geomtorsion.geometry.real_points import replaced, side
from geomtorsion.support.caching import cached_property
from geomtorsion.support.exclusive import exclusive
from geomtorsion.support.precision import CONSTANT_BITS, ball_precision

if TYPE_CHECKING:
    from geomtorsion.exact import Element
    from geomtorsion.exact.generators import Generator
    from geomtorsion.geometry.regions import Region
    from geomtorsion.geometry.walls import Walls

Verdict = Literal["positive", "negative", "zero", "both", "undecided"]
# A fraction: numerator, and a denominator that is positive where all variables are.
Pair = tuple[fmpq_mpoly, fmpq_mpoly]

# a, b, c, d of a variable (a*s + b)/(c*s + d).
Map = tuple[fmpq, fmpq, fmpq, fmpq]
# A polynomial, the map of each variable, and how many times it was split.
Cell = tuple[fmpq_mpoly, list[Map], int]

# Largest number of cells in which a polynomial is checked: a sliver a thousandth wide needs some
# tens. A polynomial with more terms than this is not split; it would take seconds.
CELLS = 400


@exclusive
class RegionSigns:
    """The signs of elements in one region of a frame."""

    def __init__(self, walls: Walls, region: Region) -> None:
        self._walls, self._region = walls, region
        self._field = walls.frame.field.exact
        self._wall_names = {str(x) for x in walls.elements.values()}

    # -- the answer ----------------------------------------------------------------------------

    def verdict(self, element: Element, columns: Iterable[Mapping[sp.Expr, Fraction]]) -> Verdict:
        """The sign of an element; columns are points to check, for both signs."""
        if element.is_zero:
            return "zero"
        try:
            sign, points = self._product(element)
        except AllowanceError:
            raise
        except GeomtorsionError:
            # Too long to be multiplied out, or with a constant of which no ball is known.
            sign, points = 0, []
        if sign:
            return "positive" if sign > 0 else "negative"
        signs = set[int]()
        for point in (*points, *columns):
            signs |= self._sign_at(element, point)
            if len(signs) == 2:
                return "both"
        return "undecided"

    def _product(self, element: Element) -> tuple[int, list[dict[sp.Expr, Fraction]]]:
        """(sign, points of both signs) of an element, from its factors; sign 0: not proved."""
        field = self._field
        whole = field.whole(element) if element.is_kept else element
        content, factors = field.factored(field.lift(whole))
        below = [(field.factors[i], e) for i, e in whole._den]
        sign, rest = 1 if content > 0 else -1, []
        for factor, exponent in (*factors, *below):
            if exponent % 2:
                part = field.polynomial(factor)
                own = self._of_wall(part) or self._of_polynomial(part)[0]
                sign *= own or 1
                rest += [] if own else [part]
        if not rest:
            return sign, []
        own, points = self._of_polynomial(reduce(lambda a, b: a * b, rest))
        return sign * own, points

    def _of_wall(self, factor: Element) -> int:
        """The sign of a wall, which is the one at the point of the region; 0 for others."""
        if str(factor) not in self._wall_names:
            return 0
        signs = self._sign_at(factor, self._center)
        return signs.pop() if signs else 0

    @cached_property
    def _center(self) -> dict[sp.Expr, Fraction]:
        point = {**self._walls.first_point(), **self._region.point}
        return {s: _fraction(point[s]) for s in self._walls.arguments}

    def _sign_at(self, element: Element, point: Mapping[sp.Expr, Fraction]) -> set[int]:
        """The sign at a point, if it is in the region and the sign is proved by balls."""
        try:
            code = self._code([element.sympy])
            with ball_precision(CONSTANT_BITS):
                numbers = (point[s] for s in self._walls.arguments)
                balls = [arb(fmpq(x.numerator, x.denominator)) for x in numbers]
                if not all(isinstance(x, arb) and x > 0 for x in self._inside.real(balls)):
                    return set()
                (value,) = code.real(balls)
        except GeomtorsionError:
            return set()
        if not isinstance(value, arb):
            return set()
        return {1} if value > 0 else {-1} if value < 0 else set()

    @cached_property
    def _inside(self) -> BallCode:
        """Positive functions of a point inside: sides of relations, and walls with their signs."""
        sides = [side(relation) for relation in self._inequalities]
        return self._code([*sides, *(x * sign for x, sign in self._region.signs.items())])

    @property
    def _inequalities(self) -> list[sp.Basic]:
        """The relations that bound the region: not x != 0."""
        return [relation for relation in self._region.relations if hasattr(relation, "gts")]

    def _code(self, expressions: Iterable[sp.Expr]) -> BallCode:
        """Expressions as functions of balls."""
        names = {s: sp.Symbol(f"x{k}") for k, s in enumerate(self._walls.arguments)}
        plain = [replaced(x, names) for x in expressions]
        return BallCode(graph([x.name for x in names.values()], plain))

    # -- variables from 0 to infinity ----------------------------------------------------------

    @cached_property
    def bounds(self) -> dict[sp.Symbol, tuple[sp.Expr | None, sp.Expr | None]]:
        """Symbol -> its bounds, polynomials in symbols before it or None, in such an order."""
        every = {s: self._bounds_of(s) for s in self._walls.symbols}
        ordered = dict[sp.Symbol, tuple[sp.Expr | None, sp.Expr | None]]()
        while waiting := [s for s in every if s not in ordered]:
            bounded = {s: sum(_is_over(x, ordered) for x in chain(*every[s])) for s in waiting}
            # First those whose bounds are all known: M > 0, then r > 2*M, but not M < r/2.
            s = max(waiting, key=lambda s: (bounded[s] == sum(map(len, every[s])), bounded[s] > 0))
            ends = ([x for x in end if _is_over(x, ordered)] for end in every[s])
            # A bound by other symbols is sharper than one by a number.
            low, high = (max(end, key=lambda x: len(x.free_symbols), default=None) for end in ends)
            ordered[s] = low, high
        return ordered

    def _bounds_of(self, s: sp.Symbol) -> tuple[list[sp.Expr], list[sp.Expr]]:
        """All lower and all upper bounds of a symbol."""
        low = [sp.S.Zero] if s.is_nonnegative else []
        high = [sp.S.Zero] if s.is_nonpositive else []
        for relation in self._inequalities:
            inner = side(relation)
            if inner.is_polynomial(*inner.free_symbols) and sp.degree(inner, s) == 1:
                slope = inner.coeff(s)
                if slope.is_number:
                    (low if slope > 0 else high).append(sp.expand(s - inner / slope))
        return low, high

    def _of_polynomial(self, element: Element) -> tuple[int, list[dict[sp.Expr, Fraction]]]:
        """The sign of a polynomial over generators, and points where it may have either sign."""
        generators = self._field.generators_of(element)
        if self._walls.frame.complex or any(one.kind == "imaginary" for one in generators):
            return 0, []
        variables = Variables(self, generators)
        sign, cells = decided(variables.numerator(self._field.lift(element)), variables.free)
        return sign, [{**self._center, **variables.point(cell)} for cell in cells]

    def sign_of_generator(self, one: Generator) -> int:
        """The sign of a generator: a wall, a root, or a logarithm; 0 where it is not known."""
        own = self._of_wall(self._field.generator_element(one))
        if own or (one.kind == "root" and not one.degree % 2):
            return own or 1
        return self.proved(one.argument - 1) if one.kind == "log" else 0

    def proved(self, element: Element) -> int:
        """The sign of an element; 0 where it is not proved."""
        return 0 if element.is_zero else self._product(element)[0]


class Variables:
    """Symbols and generators as fractions of variables that run from 0 to infinity.

    free: numbers of the variables that run from minus infinity instead.
    """

    def __init__(self, signs: RegionSigns, generators: Sequence[Generator]) -> None:
        self._bounds = signs.bounds
        used = _with_bounds({s for one in generators for s in one.depends}, self._bounds)
        # One for each symbol and generator, and for the numbers in two bounds of a symbol.
        names = [f"v{k}" for k in range(3 * len(used) + len(generators))]
        self._ring = fmpq_mpoly_ctx.get(names, Ordering.lex)
        self._unused = iter(range(len(names)))
        self.free: list[int] = []
        self._symbols: dict[sp.Symbol, Pair] = {}
        # Angles and exponents: the variable, and the inverse of the function.
        self._inner: dict[tuple[sp.Expr, str], Pair] = {}
        self._generators: dict[str, Pair] = {}
        self._numbers: dict[sp.Expr, Pair] = {}
        for s in used:
            self._symbols[s] = self._between(*map(self._bound, self._bounds[s]))
        for one in generators:
            self._generators[one.name] = self._of_generator(one, signs)

    # -- ranges --------------------------------------------------------------------------------

    def _constant(self, value: Fraction) -> Pair:
        number = fmpq(value.numerator, value.denominator)
        return self._ring.constant(number), self._ring.constant(1)

    def _variable(self, is_free: bool = False) -> fmpq_mpoly:
        number = next(self._unused)
        self.free += [number] * is_free
        return self._ring.gens()[number]

    def _between(self, low: Pair | None, high: Pair | None) -> Pair:
        """All values between two."""
        v, one = self._variable(low is None and high is None), self._ring.constant(1)
        if low is None:
            return (v, one) if high is None else (high[0] - v * high[1], high[1])
        if high is None:
            return low[0] + v * low[1], low[1]
        (n, d), (m, e) = low, high
        return n * e + m * d * v, d * e * (1 + v)

    def _bound(self, value: sp.Expr | None) -> Pair | None:
        """A bound of a symbol."""
        if value is None:
            return None
        total = self._constant(Fraction(0))
        for term in sp.Add.make_args(value):
            factors = [x for x in sp.Mul.make_args(term) if x.free_symbols]
            n, d = self._number(sp.Mul(*(x for x in sp.Mul.make_args(term) if x not in factors)))
            for factor in factors:
                base, power = factor.as_base_exp()
                above, below = self._symbols[base]
                n, d = n * above ** int(power), d * below ** int(power)
            total = total[0] * d + n * total[1], total[1] * d
        return total

    def _number(self, value: sp.Expr) -> Pair:
        """A number; an irrational one is a variable between two fractions."""
        fraction, rest = value.as_coeff_Mul()
        n, d = self._constant(_fraction(fraction))
        if rest == 1:
            return n, d
        if rest not in self._numbers:
            self._numbers[rest] = self._between(*map(self._constant, _ends(rest)))
        above, below = self._numbers[rest]
        return n * above, d * below

    def _of_generator(self, one: Generator, signs: RegionSigns) -> Pair:
        """The values of a generator."""
        unit = self._ring.constant(1)
        if one.kind == "symbol":
            return self._symbols.get(one.shown) or self._between(None, None)
        if not one.depends:
            return self._number(one.shown)
        if one.kind in ("cos", "sin", "cosh", "sinh"):
            n, d = self._half(one.shown.args[0], one.kind[-1] == "h")
            if one.kind == "sin":
                return 2 * n * d, n * n + d * d
            if one.kind == "cos":
                return d * d - n * n, n * n + d * d
            # n/d is the exponential of the argument.
            return n * n + (d * d if one.kind == "cosh" else -d * d), 2 * n * d
        if one.kind == "exp":
            low, high = {1: (1, None), -1: (0, 1), 0: (0, None)}[signs.proved(one.argument)]
            ends = (None if x is None else self._constant(Fraction(x)) for x in (low, high))
            pair = self._between(*ends)
            self._inner[one.shown.args[0], "exp"] = pair
            return pair
        sign = signs.sign_of_generator(one)
        return (sign * self._variable(), unit) if sign else self._between(None, None)

    def _half(self, argument: sp.Expr, is_hyperbolic: bool) -> Pair:
        """tan(x/2), or exp(x), between its values at the bounds of x."""
        key = argument, "exp" if is_hyperbolic else "tan"
        if key not in self._inner:
            factor, symbol = argument.as_coeff_Mul()
            bounds = (x and factor * x for x in self._bounds.get(symbol, (None, None)))
            low, high = bounds if factor > 0 else reversed([*bounds])
            if is_hyperbolic:
                is_above = low is not None and low.is_nonnegative
                self._inner[key] = self._between(self._constant(Fraction(is_above)), None)
            elif low is not None and high is not None and _is_within(low, high):
                # Rounded outwards; at half a turn the tangent has no bound.
                tangents = (None if abs(x) == sp.pi else _ends(sp.tan(x / 2)) for x in (low, high))
                ends = (x and self._constant(x[k]) for k, x in enumerate(tangents))
                self._inner[key] = self._between(*ends)
            else:
                self._inner[key] = self._between(None, None)
        return self._inner[key]

    # -- polynomials ---------------------------------------------------------------------------

    def numerator(self, poly: fmpq_mpoly) -> fmpq_mpoly:
        """A polynomial over generators with their values inserted, times positive factors."""
        names, degrees = poly.context().names(), poly.degrees()
        places = [k for k, degree in enumerate(degrees) if degree]
        powers = [_powers(self._generators[names[k]], int(degrees[k])) for k in places]
        total = self._ring.constant(0)
        for exponents, number in poly.to_dict().items():
            term = self._ring.constant(number)
            for k, own in zip(places, powers, strict=True):
                term = term * own[int(exponents[k])]
            total = total + term
        return total

    def point(self, values: Sequence[Fraction]) -> dict[sp.Expr, Fraction]:
        """Values of the symbols at values of the variables."""

        def number(pair: Pair) -> Fraction:
            above, below = (x(*(fmpq(v.numerator, v.denominator) for v in values)) for x in pair)
            return Fraction(int(above.p), int(above.q)) / Fraction(int(below.p), int(below.q))

        found: dict[sp.Expr, Fraction] = {s: number(pair) for s, pair in self._symbols.items()}
        for (argument, name), pair in self._inner.items():
            if argument.is_Symbol:
                inner = float(number(pair))
                inverse = 2 * math.atan(inner) if name == "tan" else math.log(inner)
                found[argument] = Fraction(inverse)
        return found


def decided(poly: fmpq_mpoly, free: Sequence[int]) -> tuple[int, list[tuple[Fraction, ...]]]:
    """The sign of a polynomial where all variables are positive, those that are free of any sign.

    The sign is 0 where cells differ or are too many; then the middles of cells come with it.

    Examples
    --------
    >>> ring = fmpq_mpoly_ctx.get(["x"], Ordering.lex)
    >>> x = ring.gens()[0]
    >>> decided(x**2 - x + 1, [])
    (1, [])
    >>> decided(x**2 - 2 * x + 1 - fmpq(1, 10**6), [])[1][0]
    (Fraction(1, 1),)
    """
    degrees = poly.degrees()
    squares = [k for k, degree in enumerate(degrees) if degree == 2]
    free = [k for k in free if degrees[k]]
    for k in squares if len(poly) <= CELLS else ():
        if sign := _of_square(poly, k, free):
            return sign, []
    queue, signs, middles = deque(_first_cells(poly, free)), set[int](), {}
    for _ in range(CELLS):
        if not queue:
            break
        here, maps, depth = queue.popleft()
        coefficients = here.coeffs()
        negative = sum(x < 0 for x in coefficients)
        middle = sum(coefficients, fmpq(0))
        if middle and (1 if middle > 0 else -1) not in middles:
            middles[1 if middle > 0 else -1] = tuple(_middle(m) for m in maps)
        if negative in (0, len(coefficients)):
            signs.add(-1 if negative else 1)
        elif len(here) > CELLS:
            break
        else:
            queue.extend(_halves(here, maps, depth))
        if len(middles) == 2:
            break
    else:
        return 0, list(middles.values())
    if not queue and len(signs) == 1:
        return signs.pop(), []
    return 0, list(middles.values())


def _first_cells(poly: fmpq_mpoly, free: Sequence[int]) -> list[Cell]:
    """A polynomial in each orthant: all variables positive, those that are free of either sign."""
    ring = poly.context()
    cells: list[Cell] = []
    for reflected in product((1, -1), repeat=len(free)):
        signs = {**dict.fromkeys(range(ring.nvars()), 1), **dict(zip(free, reflected, strict=True))}
        maps: list[Map] = [(fmpq(sign), fmpq(0), fmpq(0), fmpq(1)) for sign in signs.values()]
        gens = [signs[k] * x for k, x in enumerate(ring.gens())]
        cells.append((poly.compose(*gens, ctx=ring) if -1 in reflected else poly, maps, 0))
    return cells


def _of_square(poly: fmpq_mpoly, place: int, free: Sequence[int]) -> int:
    """The sign of a*s^2 + b*s + c without real zeros s; 0 for others."""
    ring, parts = poly.context(), ({}, {}, {})
    for exponents, number in poly.to_dict().items():
        rest = (*exponents[:place], 0, *exponents[place + 1 :])
        parts[int(exponents[place])][rest] = number
    c, b, a = map(ring.from_dict, parts)
    others = [k for k in free if k != place]
    gap = 4 * a * c - b * b
    # Where a vanishes, b vanishes as well, and a*s^2 + b*s + c is c.
    is_clear = bool(gap) and decided(gap, others)[0] > 0
    return decided(a, others)[0] if is_clear else 0


def _halves(here: fmpq_mpoly, maps: list[Map], depth: int) -> list[Cell]:
    """The two halves of a cell: s = 1 + 2*s' and s = 1/(1 + 2*s') of one variable."""
    ring, degrees = here.context(), here.degrees()
    occurring = [k for k, degree in enumerate(degrees) if degree]
    place = occurring[depth % len(occurring)]
    degree, gens = int(degrees[place]), list(ring.gens())
    gens[place] = 2 * gens[place] + 1
    turned = {
        (*e[:place], degree - int(e[place]), *e[place + 1 :]): c for e, c in here.to_dict().items()
    }
    a, b, c, d = maps[place]
    above, below = list(maps), list(maps)
    above[place] = 2 * a, a + b, 2 * c, c + d
    below[place] = 2 * b, a + b, 2 * d, c + d
    return [
        (here.compose(*gens, ctx=ring), above, depth + 1),
        (ring.from_dict(turned).compose(*gens, ctx=ring), below, depth + 1),
    ]


def _middle(one: Map) -> Fraction:
    """The value of a variable in the middle of a cell."""
    a, b, c, d = one
    value = (a + b) / (c + d)
    return Fraction(int(value.p), int(value.q))


def _powers(pair: Pair, degree: int) -> list[fmpq_mpoly]:
    """n^k d^(degree - k) for k from 0 to the degree, of a fraction n/d."""
    n, d = pair
    return [n**k * d ** (degree - k) for k in range(degree + 1)]


def _ends(number: sp.Expr) -> tuple[Fraction, Fraction]:
    """Two fractions around a number, equal for a fraction."""
    if number.is_Rational:
        return _fraction(number), _fraction(number)
    with ball_precision(CONSTANT_BITS):
        ball = exact_ball(number)
        low, high = (
            Fraction(int(man)) * Fraction(2) ** int(exp)
            for man, exp in (ball.lower().man_exp(), ball.upper().man_exp())
        )
    return low, high


def _is_within(low: sp.Expr, high: sp.Expr) -> bool:
    """Whether numbers bound an angle within half a turn to each side."""
    if not (low.is_number and high.is_number):
        return False
    return bool(-sp.pi <= low) and bool(high <= sp.pi)


def _is_over(value: sp.Expr, symbols: Collection[sp.Symbol]) -> bool:
    """Whether a bound is a finite polynomial in some symbols."""
    free = value.free_symbols
    return bool(value.is_finite is not False and free <= set(symbols)) and bool(
        value.is_polynomial(*free)
    )


def _with_bounds(
    symbols: Collection[sp.Basic], bounds: Mapping[sp.Symbol, tuple[sp.Expr | None, ...]]
) -> list[sp.Symbol]:
    """Symbols and those in their bounds, in the order of the bounds."""
    needed = set(symbols)
    for s in reversed(bounds):
        if s in needed:
            needed |= {x for end in bounds[s] if end is not None for x in end.free_symbols}
    return [s for s in bounds if s in needed]


def _fraction(value: sp.Expr) -> Fraction:
    return Fraction(int(value.p), int(value.q))  # pyright: ignore[reportAttributeAccessIssue]

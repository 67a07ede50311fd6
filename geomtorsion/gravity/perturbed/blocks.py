"""Blocks: the operator between combinations of fields, as a real symmetric polynomial matrix.

Waves exp(-i w t + i k z) with real w and k make the operator Hermitian. With a factor i for each
odd combination it is real and symmetric: at rest in powers of q = w^2, along z in powers of w for
k = 1.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import sympy as sp
from flint import nmod, nmod_mat, nmod_poly

from geomtorsion.errors import GravityError
from geomtorsion.exact import Element, Field, reduced, squares
from geomtorsion.geometry import determinant
from geomtorsion.gravity.perturbed.sectors import Sector
from geomtorsion.gravity.theory.operator import LinearOperator
from geomtorsion.support.caching import cached_property

# Ranks and degrees are found at random values of the couplings modulo this prime.
PRIME = 2**61 - 1
# The variable of a block: q = w^2 at rest, the square of a mass.
VARIABLE = sp.Symbol("mass2")
# Polynomial in q or w: power -> coefficient.
Powers = dict[int, Element]


@dataclass(frozen=True, eq=False)
class Waves:
    """A flat operator for waves along z, with coefficients in a field of the couplings only.

    couplings: the symbols in the coefficients.
    entries: (row, column) -> {(order in t, order in z): coefficient}.
    size: the number of fields.
    """

    couplings: tuple[sp.Symbol, ...]
    field: Field
    entries: Mapping[tuple[int, int], Mapping[tuple[int, int], Element]]
    size: int

    @classmethod
    def of(cls, operator: LinearOperator) -> Waves:
        """The waves of an operator about flat space."""
        entries = {
            key: {(orders[0], orders[3]): x.sympy for orders, x in one.items()}
            for key, one in operator.entries.items()
        }
        return cls._read(entries, len(operator.fields))

    def subs(self, values: Mapping[sp.Symbol, sp.Expr]) -> Waves:
        """The waves for other couplings."""
        entries = {
            key: {orders: x.sympy.xreplace(dict(values)) for orders, x in one.items()}
            for key, one in self.entries.items()
        }
        return self._read(entries, self.size)

    @classmethod
    def _read(
        cls, written: Mapping[tuple[int, int], Mapping[tuple[int, int], sp.Expr]], size: int
    ) -> Waves:
        """Coefficients as expressions in the couplings, read into a field of these only."""
        distinct = list(dict.fromkeys(x for one in written.values() for x in one.values()))
        couplings = sorted({s for x in distinct for s in x.free_symbols}, key=str)
        for x in distinct:
            if not x.is_rational_function(*couplings) or not _has_fractions(x, couplings):
                raise GravityError(
                    f"spectrum: expected rational functions of the couplings, got {x}. Give its "
                    "irrational part a name, and numbers that are fractions."
                )
        field = Field(couplings)
        elements = field.read_all([("coupling", x) for x in distinct])
        read = dict(zip(distinct, elements, strict=True))
        entries = {
            key: {orders: read[x] for orders, x in one.items() if not read[x].is_zero}
            for key, one in written.items()
        }
        kept = {key: one for key, one in entries.items() if one}
        return cls(tuple(couplings), field, kept, size)

    # -- numbers modulo the prime ----------------------------------------------------------------

    @cached_property
    def numbers(self) -> dict[sp.Symbol, int]:
        """Values of the couplings that fulfil no relation by chance."""
        return {s: pow(3, 10**6 + 7919 * k, PRIME) for k, s in enumerate(self.couplings)}

    def number(self, expression: sp.Expr) -> int:
        """An expression in the couplings at these values."""
        top, bottom = sp.fraction(sp.together(expression))
        return self._integer(top) * pow(self._integer(bottom), -1, PRIME) % PRIME

    def _integer(self, polynomial: sp.Expr) -> int:
        poly = sp.Poly(polynomial, *self.couplings) if self.couplings else None
        if poly is None:
            return int(sp.Rational(polynomial).p) * pow(int(sp.Rational(polynomial).q), -1, PRIME)
        total = 0
        for powers, c in poly.terms():
            term = int(c.p) * pow(int(c.q), -1, PRIME)
            for s, k in zip(self.couplings, powers, strict=True):
                term = term * pow(self.numbers[s], k, PRIME) % PRIME
            total += term
        return total % PRIME

    @cached_property
    def _values(self) -> dict[Element, int]:
        distinct = dict.fromkeys(x for one in self.entries.values() for x in one.values())
        return {x: self.number(x.sympy) for x in distinct}

    @cached_property
    def rank(self) -> int:
        """The rank for general frequencies and wave numbers."""
        s, p = pow(5, 10**5 + 3, PRIME), pow(7, 10**5 + 3, PRIME)
        matrix = nmod_mat(self.size, self.size, PRIME)
        for (i, j), one in self.entries.items():
            matrix[i, j] = (
                sum(
                    self._values[x] * pow(s, a, PRIME) * pow(p, b, PRIME)
                    for (a, b), x in one.items()
                )
                % PRIME
            )
        return matrix.rank()

    def modulo_prime(self, poly: sp.Poly) -> nmod_poly:
        """A polynomial at these values."""
        return nmod_poly([self.number(c) for c in reversed(poly.all_coeffs())], PRIME)

    # -- blocks ----------------------------------------------------------------------------------

    def couples(self, one: Sector, two: Sector, at_rest: bool) -> bool:
        """Whether the operator has an entry between two sectors."""
        return any(self._between(u, v, at_rest) for u in one.vectors for v in two.vectors)

    def block(self, sector: Sector, at_rest: bool) -> Block:
        """The operator within a sector, in powers of q at rest, else of w."""
        n = range(len(sector.vectors))
        entries: dict[tuple[int, int], Powers] = {}
        for i in n:
            for j in n:
                powers: dict[int, list] = {}
                row, column = int(sector.odd[i]), int(sector.odd[j])
                for (a, b), x in self._between(
                    sector.vectors[i], sector.vectors[j], at_rest
                ).items():
                    sign = (-1) ** ((b - a + column - row) // 2)
                    power = (a + row + column) // 2 if at_rest else a
                    powers.setdefault(power, []).append((sign, x))
                sums = {k: self.field.sum(terms) for k, terms in powers.items()}
                kept = {k: x for k, x in sums.items() if not x.is_zero}
                if kept:
                    entries[i, j] = kept
        return Block(self, sector, entries)

    def _between(self, one: dict, two: dict, at_rest: bool) -> dict[tuple[int, int], Element]:
        """Derivative -> coefficient between two combinations of fields."""
        terms: dict[tuple[int, int], list] = {}
        for i, u in one.items():
            for j, v in two.items():
                for orders, x in self.entries.get((i, j), {}).items():
                    if not (at_rest and orders[1]):
                        terms.setdefault(orders, []).append((u * v, x))
        sums = {orders: self.field.sum(parts) for orders, parts in terms.items()}
        return {orders: x for orders, x in sums.items() if not x.is_zero}


@dataclass(frozen=True, eq=False)
class Block:
    """A real symmetric matrix of polynomials in one variable, over the field of the couplings."""

    waves: Waves
    sector: Sector
    entries: Mapping[tuple[int, int], Powers]

    @property
    def size(self) -> int:
        """The number of combinations of fields."""
        return len(self.sector.vectors)

    @cached_property
    def _numbers(self) -> dict[tuple[int, int], dict[int, int]]:
        number = self.waves.number
        cached: dict[Element, int] = {}
        result = {}
        for key, powers in self.entries.items():
            for x in powers.values():
                if x not in cached:
                    cached[x] = number(x.sympy)
            result[key] = {k: cached[x] for k, x in powers.items()}
        return result

    def _matrix_at(self, place: int) -> nmod_mat:
        matrix = nmod_mat(self.size, self.size, PRIME)
        for (i, j), powers in self._numbers.items():
            matrix[i, j] = sum(c * pow(place, k, PRIME) for k, c in powers.items()) % PRIME
        return matrix

    @cached_property
    def pivots(self) -> tuple[int, ...]:
        """Combinations whose rows are independent and span all others, short ones first."""
        order = sorted(
            range(self.size),
            key=lambda i: sum(
                x.length for (a, _), one in self.entries.items() if a == i for x in one.values()
            ),
        )
        whole = self._matrix_at(pow(11, 10**5 + 1, PRIME))
        moved = nmod_mat(self.size, self.size, PRIME)
        for a in range(self.size):
            for b in range(self.size):
                moved[a, b] = whole[a, order[b]]
        form, rank = moved.rref()
        n = range(self.size)
        columns = [next(k for k in n if int(form[i, k])) for i in range(rank)]
        return tuple(sorted(order[k] for k in columns))

    @cached_property
    def divisor(self) -> nmod_poly:
        """The common divisor of all minors of the highest rank, modulo the prime.

        Its roots are the frequencies of waves that no gauge freedom removes.
        """
        rank = len(self.pivots)
        if not rank:
            return nmod_poly([1], PRIME)
        common = nmod_poly([], PRIME)
        for number in (1, 2):
            common = common.gcd(self._minor(rank, number))
        return common

    def _minor(self, rank: int, number: int) -> nmod_poly:
        """The determinant of random combinations of rows and columns."""
        left = _random(rank, self.size, 2 * number)
        right = _random(self.size, rank, 2 * number + 1)
        degree = rank * max((k for one in self.entries.values() for k in one), default=0)
        places = list(range(1, degree + 2))
        values = [int((left * self._matrix_at(x) * right).det()) for x in places]
        return _through(places, values)

    @cached_property
    def factors(self) -> list[sp.Poly]:
        """Irreducible factors, in the variable of the block, of a minor of the highest rank.

        Some of them may belong to the choice of the minor: their multiplicity is zero.
        """
        powers = self._factored_minor(self.pivots)[1]
        return [sp.Poly(x, VARIABLE) for x, _ in powers if x.has(VARIABLE)]

    def _factored_minor(self, chosen: Sequence[int]) -> tuple[bool, list[tuple[sp.Expr, int]]]:
        """The determinant of some rows and the same columns: its sign and its factors."""
        field = Field([*self.waves.couplings, VARIABLE])
        q = field.symbol(VARIABLE)
        entries = {}
        for i, a in enumerate(chosen):
            for j, b in enumerate(chosen):
                if (a, b) in self.entries:
                    powers = {k: field.read(x.sympy) for k, x in self.entries[a, b].items()}
                    entries[i, j] = field.sum([(1, x, q**k) for k, x in powers.items()])
        minor = determinant(field, entries, len(chosen))
        if minor.is_zero:
            return False, [(sp.S.Zero, 1)]
        bottom = field.lift(field.denominator(minor))
        content, factors = field.factored(field.lift(minor) * bottom)
        return content < 0, [(field.polynomial(x).sympy, n) for x, n in factors]

    def weight(self, factor: sp.Poly) -> sp.Expr:
        """An expression in the variable with the sign of the energy at the roots of a factor.

        Each diagonal entry of the residue of the inverse at the root has this sign.
        """
        negative, whole = self._factored_minor(self.pivots)
        for i in self.pivots:
            turned, part = self._factored_minor([k for k in self.pivots if k != i])
            polys = [(sp.Poly(x, VARIABLE), n) for x, n in part]
            if any(x.is_zero or x == factor for x, _ in polys):
                continue
            odd: set[sp.Poly] = set()
            for x, n in [*((sp.Poly(x, VARIABLE), n) for x, n in whole), *polys]:
                if n % 2 and x != factor:
                    odd ^= {x}
            rest = sp.Poly(-1 if negative != turned else 1, VARIABLE)
            for x in [factor.diff(), *sorted(odd, key=str)]:
                rest = (rest * x).rem(factor)
            return sp.factor(rest.as_expr())
        raise GravityError(
            f"spectrum: the energy where {factor.as_expr()} = 0 is undecided. Give other numbers."
        )

    def multiplicity(self, factor: sp.Poly) -> int:
        """How often a polynomial divides the common divisor of the minors."""
        return self._count(self.waves.modulo_prime(factor))

    def _count(self, factor: nmod_poly) -> int:
        rest, count = self.divisor, 0
        while not (rest % factor) and factor.degree():
            rest, count = rest // factor, count + 1
        return count

    def modes(self, mass2: sp.Expr) -> list[Element]:
        """Weights of the waves at a value of the variable, positive for positive energy.

        The kernel of the block, with the slope of the block as a quadratic form, diagonalised.
        Gauge waves and waves that grow in time have no weight and are omitted.
        """
        field = self.waves.field
        place = field.read(mass2)
        value: dict[tuple[int, int], Element] = {}
        slope: dict[tuple[int, int], Element] = {}
        for key, powers in self.entries.items():
            value[key] = field.sum([(1, x, place**k) for k, x in powers.items()])
            slope[key] = field.sum([(k, x, place ** (k - 1)) for k, x in powers.items() if k])
        n, zero = range(self.size), field.zero
        rows = [[value.get((i, j), zero) for j in n] for i in n]
        kernel = reduced(field, rows, self.size).kernel()
        form = [
            [field.sum([(1, u[i], x, v[j]) for (i, j), x in slope.items()]) for v in kernel]
            for u in kernel
        ]
        return squares(field, form)


def _has_fractions(expression: sp.Expr, couplings: Sequence[sp.Symbol]) -> bool:
    """Whether the numbers in a rational function are fractions."""
    parts = sp.fraction(sp.together(expression))
    if not couplings:
        return all(x.is_Rational for x in parts)
    return all(c.is_Rational for x in parts for c in sp.Poly(x, *couplings).coeffs())


def _random(rows: int, columns: int, seed: int) -> nmod_mat:
    """A matrix of numbers modulo the prime, the same for equal seeds."""
    value, numbers = seed + 12345, []
    for _ in range(rows * columns):
        value = (value * 6364136223846793005 + 1442695040888963407) % 2**64
        numbers.append(value % PRIME)
    return nmod_mat(rows, columns, numbers, PRIME)


def _through(places: Sequence[int], values: Sequence[int]) -> nmod_poly:
    """The polynomial with given values (Newton's divided differences)."""
    table = [nmod(v, PRIME) for v in values]
    for level in range(1, len(places)):
        for k in range(len(places) - 1, level - 1, -1):
            table[k] = (table[k] - table[k - 1]) / (places[k] - places[k - level])
    result = nmod_poly([], PRIME)
    for k in range(len(places) - 1, -1, -1):
        result = result * nmod_poly([-places[k], 1], PRIME) + nmod_poly([int(table[k])], PRIME)
    return result

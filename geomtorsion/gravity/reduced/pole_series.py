"""Expansion: power series of unknown functions about a point where their equations have a pole.

Each equation is a power series in the distance from the point. Where the coefficients below order k
are known, the next ones enter linearly. They may occur in the equations at different orders, so
a few higher coefficients are eliminated with them.
"""

from __future__ import annotations

import math
from collections.abc import Collection, Iterator, Mapping, Sequence
from itertools import pairwise

import mpmath
import sympy as sp
from flint import arb, arb_poly, arb_series, ctx
from sympy.core.function import AppliedUndef

from geomtorsion.codegen import balls, graph
from geomtorsion.errors import GravityError, StartError
from geomtorsion.exact import Element
from geomtorsion.gravity.reduced.jets import Jets, jet_name
from geomtorsion.gravity.reduced.starts import root_of
from geomtorsion.support.precision import EXACT_BITS, series_length

# A coefficient of a power series: (number of the function, order).
Term = tuple[int, int]
# A coefficient of an equation: (order, number of the equation).
Power = tuple[int, int]
# Row of a linear system: term -> factor, and the value of the equation.
Row = tuple[dict[Term, arb], arb]
# The first of the numbers, one apart, at which equations are evaluated: B (B^2 - 1) has two roots
# that are one apart.
_FIRST = arb(3) / 8


class Expansion:
    """Power series about a point, whose coefficients follow from equations order by order.

    jets: the functions and their derivatives as symbols.
    functions: those with a series; equations: expressions in the jets that vanish.
    place: the value of the variable at the point; step: 2 for even functions, else 1.
    numbers: values of the parameters; near: rough values of derivatives, by the names of jets;
    nonzero: names of functions that vanish nowhere.

    Works in balls, at the precision of flint and mpmath at each call.
    """

    def __init__(
        self,
        jets: Jets,
        functions: Sequence[AppliedUndef],
        equations: Sequence[Element],
        place: sp.Expr,
        step: int,
        numbers: Mapping[str, sp.Expr],
        near: Mapping[str, sp.Expr],
        nonzero: Collection[str],
    ) -> None:
        self.jets, self.functions, self.step = jets, tuple(functions), step
        self._near, self._nonzero, self._place = near, nonzero, balls.exact_ball(place)
        # (function, order of the derivative) of each symbol in the equations.
        self._places: list[Term] = []
        symbols: list[sp.Symbol] = []
        for i, function in enumerate(self.functions):
            for order in range(jets.highest + 1):
                symbol = jets.symbol(function, order)
                if any(symbol in one.symbols for one in equations):
                    symbols.append(symbol)
                    self._places.append((i, order))
        self.order = max(order for _, order in self._places)
        names = [one.name for one in symbols] + [*numbers, jets.variable.name]
        self._numbers = [balls.exact_ball(value) for value in numbers.values()]
        slopes = [one.diff(symbol) for one in equations for symbol in symbols]
        self._values = balls.BallCode(graph(names, list(equations), factor=False))
        self._slopes = balls.BallCode(graph(names, slopes, factor=False))
        self._count = len(equations)
        # Function -> order -> coefficient, as far as they are determined.
        self.rows: list[dict[int, arb]] = [{} for _ in self.functions]
        self._width = 1
        # Width -> slopes, once they no longer change.
        self._late: dict[int, list[list[list[arb]]]] = {}

    def set(self, name: str, value: sp.Expr) -> None:
        """Set a derivative at the point, by the name of its symbol."""
        for i, function in enumerate(self.functions):
            for order in range(self.jets.highest + 1):
                if self.jets.symbol(function, order).name == name:
                    self.rows[i][order] = _ball(value) / math.factorial(order)

    def run(self, last: int) -> None:
        """Determine all coefficients up to an order.

        Raises
        ------
        StartError
            A coefficient is free, or has several values.
        GravityError
            No power series has these values.
        """
        for order in range(0, last + 1, self.step):
            while any(order not in row for row in self.rows):
                self._determine(order)

    def derivative(self, i: int, order: int, way: arb) -> arb:
        """A derivative of a function beside the point, by its series."""
        total = arb(0)
        for k in range(max(self.rows[i]), order - 1, -1):
            total = total * way + self.rows[i].get(k, arb(0)) * math.perm(k, order)
        return total

    # -- one order -------------------------------------------------------------------------------

    def _determine(self, order: int) -> None:
        """Determine coefficients of an order, with the fewest higher ones."""
        widest = self.order + self._width
        for width in range(self._width, widest + 1):
            solved, left = self._solved(order, width)
            if any(not value.contains(0) for value in left.values()):
                raise GravityError(
                    f"start: expected values with a regular solution at {self.jets.variable} = "
                    f"{self._here}, got ones without a power series there. Change the values, or "
                    "omit one of them, which may then follow from the others."
                )
            solved = solved or self._root(order, width)
            if solved:
                for (i, k), value in solved.items():
                    self.rows[i][k] = value
                if all(order in row for row in self.rows):
                    self._width = width
                return
        self._refuse(order)

    def _solved(self, order: int, width: int) -> tuple[dict[Term, arb], dict[Power, arb]]:
        """Terms of an order that linear equations determine, and the remainders of equations."""
        terms = [
            (i, k)
            for k in range(order + (width - 1) * self.step, order - 1, -self.step)
            for i, row in enumerate(self.rows)
            if k not in row
        ]
        rows = self._linear(order, width, terms)
        pivots: list[tuple[Term, Row]] = []
        for term in terms:
            ways = [power for power, (row, _) in rows.items() if term in row]
            if ways:
                # The first pivot with half of the digits, so that equal equations have equal ones.
                bits = [min(rows[x][0][term].rel_accuracy_bits(), ctx.prec // 2) for x in ways]
                row, value = rows.pop(ways[bits.index(max(bits))])
                pivots.append((term, (row, value)))
                rows = {power: _reduced(one, term, row, value) for power, one in rows.items()}
        result: dict[Term, arb] = {}
        for term, (row, value) in reversed(pivots):
            others = [one for one in row if one != term]
            if term[1] == order and all(one in result for one in others):
                total = value + sum((row[one] * result[one] for one in others), arb(0))
                result[term] = -total / row[term]
        return result, {power: value for power, (_, value) in rows.items()}

    def _linear(self, order: int, width: int, terms: Sequence[Term]) -> dict[Power, Row]:
        """The equations that are linear in terms and independent of higher ones."""
        above = order + width * self.step
        length = (width + 2) * self.step + 3 * self.order
        if order <= length + self.order:
            generic = {term: _FIRST * (n + 1) for n, term in enumerate(terms)}
            plain, moved = self._matrix({}, length), self._matrix(generic, length)
        else:
            # Here the slopes depend on lower coefficients only.
            plain = moved = self._late.get(width) or self._matrix({}, length)
            self._late[width] = plain
        # The first power in which the coefficients beyond the terms occur.
        limits = [
            above + min((_valuation(x) - d for x, (_, d) in self._paired(row)), default=0)
            for row in moved
        ]
        values = self._evaluated(max(limits))
        rows: dict[Power, Row] = {}
        for j, limit in enumerate(limits):
            for m in range(limit):
                here, value = self._row(plain[j], m, terms), balls.coefficient(values[j], m)
                same = moved is plain or _agree(here, self._row(moved[j], m, terms))
                if same and (here or not value.contains(0)):
                    rows[m, j] = here, value
        return rows

    def _root(self, order: int, width: int) -> dict[Term, arb]:
        """A coefficient of an order that is the only unknown after linear elimination."""
        free = [(i, order) for i, row in enumerate(self.rows) if order not in row]
        for term in free:
            equation = self._equation(term, width)
            if equation is not None:
                name, factor = self._name(term), math.factorial(order)
                if name in self._nonzero:
                    equation = equation[next(k for k, x in enumerate(equation) if x != 0) :]
                x = sp.Symbol(name)
                polynomial = sp.Add(*(n * x**k for k, n in enumerate(equation)))
                root = root_of(polynomial, x, polynomial.evalf(6), self._near.get(name))
                return {term: _ball(root) / factor}
        return {}

    def _equation(self, term: Term, width: int) -> list[sp.Expr] | None:
        """The coefficients of a polynomial that vanishes at the derivative of a term, if any."""
        i, k = term
        samples: list[dict[Power, arb]] = []
        # A power n of numbers up to n takes n log2(n) bits.
        while len(samples) < ctx.prec // 8:
            self.rows[i][k] = (_FIRST + len(samples)) / math.factorial(k)
            try:
                samples.append(self._solved(k, width)[1])
            finally:
                del self.rows[i][k]
            common = set(samples[0]).intersection(*samples)
            powers = sorted(x for x in common if any(not one[x].contains(0) for one in samples))
            if not powers and len(samples) > 1:
                return None
            for power in powers:
                polynomial = _interpolated([one[power] for one in samples])
                if polynomial is not None:
                    return polynomial
        return None

    def _refuse(self, order: int) -> None:
        free = [(i, order) for i, row in enumerate(self.rows) if order not in row]
        names = ", ".join(self._name(term) for term in free)
        raise StartError(
            f"start: expected numbers for all that a regular solution leaves free at "
            f"{self.jets.variable} = {self._here}, got none for {names}. Add a number for one of "
            "these."
        )

    # -- series ----------------------------------------------------------------------------------

    @property
    def _here(self) -> str:
        return self._place.str(5, radius=False)

    def _name(self, term: Term) -> str:
        return jet_name(self.functions[term[0]], term[1])

    def _arguments(self, more: Mapping[Term, arb], length: int) -> list[arb | arb_series]:
        """Arguments of the equations: all derivatives, parameters, and the variable."""
        result: list[arb | arb_series] = []
        for i, d in self._places:
            row = self.rows[i] | {k: value for (own, k), value in more.items() if own == i}
            numbers = [row.get(m + d, arb(0)) * math.perm(m + d, d) for m in range(length)]
            result.append(arb_series(numbers, prec=length))
        return [*result, *self._numbers, arb_series([self._place, 1], prec=length)]

    def _series(
        self, code: balls.BallCode, more: Mapping[Term, arb], length: int
    ) -> list[arb | arb_series]:
        """Expressions in the derivatives as power series."""
        with series_length(length):
            series = code.real(self._arguments(more, length))
        for one in series:
            if not all(balls.coefficient(one, m).is_finite() for m in range(length)):
                raise GravityError(
                    f"start: expected equations that are power series at {self.jets.variable} = "
                    f"{self._here}, got a root, a logarithm or a quotient at zero. Change the "
                    "values, give numbers for more functions, or start beside this point."
                )
        return series

    def _evaluated(self, length: int) -> list[arb | arb_series]:
        """The equations as power series."""
        return self._series(self._values, {}, length)

    def _matrix(self, more: Mapping[Term, arb], length: int) -> list[list[list[arb]]]:
        """The slopes of each equation by each derivative: coefficients of power series."""
        flat = self._series(self._slopes, more, length)
        every = [[balls.coefficient(x, m) for m in range(length)] for x in flat]
        size = len(self._places)
        return [every[j * size : (j + 1) * size] for j in range(self._count)]

    def _paired(self, row: Sequence[list[arb]]) -> Iterator[tuple[list[arb], Term]]:
        """Slopes that do not vanish, with their derivatives."""
        pairs = zip(row, self._places, strict=True)
        return ((x, place) for x, place in pairs if _valuation(x) < len(x))

    def _row(self, slopes: Sequence[list[arb]], m: int, terms: Sequence[Term]) -> dict[Term, arb]:
        """The factors of terms in the coefficient m of an equation."""
        row: dict[Term, arb] = {}
        for i, k in terms:
            total = arb(0)
            for slope, (own, d) in zip(slopes, self._places, strict=True):
                power = m - k + d
                if own == i and k >= d and 0 <= power < len(slope):
                    total += slope[power] * math.perm(k, d)
            if not total.contains(0):
                row[i, k] = total
        return row


def _interpolated(values: Sequence[arb]) -> list[sp.Expr] | None:
    """A polynomial through values at places one apart, once their differences end."""
    row, differences = list(values), list[arb]()
    while row:
        differences.append(row[0])
        row = [after - before for before, after in pairwise(row)]
    if len(differences) < 4 or not all(x.contains(0) for x in differences[-2:]):
        return None
    total, basis = arb_poly([0]), arb_poly([1])
    for n, difference in enumerate(differences[:-2]):
        total += basis * difference
        basis = basis * arb_poly([-_FIRST - n, 1]) * (arb(1) / (n + 1))
    return [sp.S.Zero if x.contains(0) else _float(x) for x in total.coeffs()]


def _agree(one: Mapping[Term, arb], two: Mapping[Term, arb]) -> bool:
    """Whether factors of the same terms may be equal."""
    return one.keys() == two.keys() and all((one[x] - two[x]).contains(0) for x in one)


def _reduced(one: Row, term: Term, row: Mapping[Term, arb], value: arb) -> Row:
    """A row without a term, by a row with it."""
    factors, own = one
    if term not in factors:
        return one
    share = factors[term] / row[term]
    result = {}
    for other in {**factors, **row}:
        if other != term:
            x = factors.get(other, arb(0)) - share * row.get(other, arb(0))
            if not x.contains(0):
                result[other] = x
    return result, own - share * value


def _valuation(series: Sequence[arb]) -> int:
    """The first power with a coefficient other than zero."""
    return next((m for m, x in enumerate(series) if not x.contains(0)), len(series))


def _ball(value: sp.Expr) -> arb:
    """A number, with a radius if it is a rounded root."""
    ball = balls.exact_ball(value)
    if value.has(sp.Float):
        return arb(ball.mid(), abs(ball.mid()) * arb(2) ** (EXACT_BITS // 8 - ctx.prec))
    return ball


def _float(value: arb) -> sp.Float:
    mantissa, exponent = value.mid().man_exp()
    return sp.Float(mpmath.mpf((int(mantissa), int(exponent))), mpmath.mp.dps)

"""Centre: a power series from a regular singular point, such as r = 0 in a star.

There r y' = g(r, y) with g regular and g(0, y0) = 0. The coefficients of y = sum y_k r^k follow
from (k - J) y_k = (coefficient k of g at the polynomial before), with J = dg/dy at the centre.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence

import sympy as sp
from flint import arb, arb_mat, arb_series

from geomtorsion.codegen import balls, graph
from geomtorsion.errors import GravityError
from geomtorsion.gravity.jets import Jets
from geomtorsion.support import checks
from geomtorsion.support.precision import CONSTANT_BITS, EXACT_BITS, ball_precision, series_length

# The series is used up to this share of its radius of convergence: with steps of this size a Taylor
# method costs least for its digits (Jorba, Zou 2005).
SHARE = math.exp(-2)


class Centre:
    """First-order equations at a regular singular point.

    jets: the states and parameters as symbols.
    rates: state -> its derivative; place: the value of the variable at the point.
    """

    def __init__(self, jets: Jets, rates: Mapping[str, sp.Expr], place: sp.Expr) -> None:
        self.jets, self.place, self.states = jets, place, tuple(rates)
        self._symbols = [next(x for x in jets.symbols if x.name == name) for name in rates]
        way = jets.field.read(jets.variable - place)
        self.rates = {name: way * jets.field.read(rate) for name, rate in rates.items()}
        for name, rate in self.rates.items():
            if self._here(sp.fraction(rate.sympy)[1]) == 0:
                raise GravityError(
                    f"start: expected {jets.variable} {name}' without a pole at {jets.variable} = "
                    f"{place}, got {name}' = {checks.cut(str(rates[name]))}. Start beside this "
                    f"point, with origin={float(place) + 0.1:.3g}."
                )

    def _here(self, expression: sp.Expr) -> sp.Expr:
        return expression.xreplace({self.jets.variable: self.place})

    @property
    def conditions(self) -> list[sp.Expr]:
        """Expressions in the states that vanish at the point."""
        return [self._here(rate.sympy) for rate in self.rates.values()]

    def beside(
        self, start: Mapping[str, sp.Expr], parameters: Mapping[str, sp.Expr]
    ) -> tuple[sp.Expr, dict[str, sp.Expr]]:
        """A place beside the point, and the states there, by the series.

        start: states at the point, which satisfy the conditions.
        """
        names = (*self.states, *parameters, self.jets.variable.name)
        rates = list(self.rates.values())
        slopes = [rate.diff(symbol) for rate in rates for symbol in self._symbols]
        with ball_precision(EXACT_BITS):
            rows = [[balls.exact_ball(start[name])] for name in self.states]
            numbers = [balls.exact_ball(value) for value in parameters.values()]
            place = balls.exact_ball(self.place)
            along = balls.BallCode(graph(names, rates))
            first = [*(row[0] for row in rows), *numbers, place]
            values = balls.BallCode(graph(names, slopes)).real(first)
            size = len(rows)
            jacobian = arb_mat(size, size, values)
            for order in range(1, math.ceil(-CONSTANT_BITS / math.log2(SHARE)) + 1):
                with series_length(order + 1):
                    series = [arb_series(row, prec=order + 1) for row in rows]
                    here = arb_series([place, 1], prec=order + 1)
                    right = [
                        balls.coefficient(x, order) for x in along.real([*series, *numbers, here])
                    ]
                for row, value in zip(rows, self._solved(jacobian, right, order), strict=True):
                    row.append(value)
            way = _way(rows)
            values = [_value(row, way) for row in rows]
        return self.place + way, dict(zip(self.states, values, strict=True))

    def _solved(self, jacobian: arb_mat, right: Sequence[arb], order: int) -> list[arb]:
        """y_k with (k - J) y_k = right side."""
        size = len(right)
        unit = arb_mat([[order * int(i == j) for j in range(size)] for i in range(size)])
        try:
            column = (unit - jacobian).solve(arb_mat(size, 1, list(right)))
        except ZeroDivisionError:
            raise GravityError(
                f"start: expected a regular centre at {self.jets.variable} = {self.place}, got one "
                f"where a coefficient of order {order} is free. Start beside this point."
            ) from None
        return [column[k, 0] for k in range(size)]


def _way(rows: Sequence[Sequence[arb]]) -> sp.Rational:
    """A power of two below a share of the radius of convergence, by the size of coefficients."""
    slopes: list[float] = []
    for row in rows:
        sizes = [(k, _log(value.mid())) for k, value in enumerate(row) if value.mid() != 0]
        # From the first coefficient that does not vanish to each of the upper half.
        slopes += [
            (size - sizes[0][1]) / (k - sizes[0][0]) for k, size in sizes[1:] if 2 * k >= len(row)
        ]
    return sp.Rational(2) ** math.floor(math.log2(SHARE) - max(slopes, default=0.0))


def _log(value: arb) -> float:
    """The binary logarithm of the size of a number, of any exponent."""
    return float(abs(value).log()) / math.log(2)


def _value(row: Sequence[arb], way: sp.Rational) -> sp.Expr:
    """The polynomial at a place."""
    total, step = arb(0), balls.exact_ball(way)
    for value in reversed(row):
        total = total * step + value
    mantissa, exponent = total.mid().man_exp()
    return sp.Rational(int(mantissa)) * sp.Rational(2) ** int(exponent)

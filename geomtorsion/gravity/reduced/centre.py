"""Centre: a regular solution from a point where equations have a pole, such as r = 0 in a star."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence

import sympy as sp
from flint import arb

from geomtorsion.codegen import balls
from geomtorsion.errors import GravityError
from geomtorsion.exact import Element
from geomtorsion.gravity.reduced.elimination import Eliminated
from geomtorsion.gravity.reduced.jets import Jets
from geomtorsion.gravity.reduced.pole_series import Expansion
from geomtorsion.gravity.reduced.starts import check_constraint, check_parameters, filled
from geomtorsion.support import checks
from geomtorsion.support.caching import cached_property
from geomtorsion.support.precision import (
    CONSTANT_BITS,
    EPS,
    EXACT_BITS,
    ball_precision,
    working_precision,
)

# The series is used up to this share of its radius of convergence: with steps of this size a Taylor
# method costs least for its digits (Jorba, Zou 2005).
SHARE = math.exp(-2)
# The order at which a power of this share is below the rounding of constants.
_LAST = math.ceil(-CONSTANT_BITS / math.log2(SHARE))


class Centre:
    """Regular solutions of equations about a point.

    jets, eliminated: the equations; place: the value of the variable at the point.
    names: conditions that give a function's argument a name.
    """

    def __init__(
        self, jets: Jets, eliminated: Eliminated, place: sp.Expr, names: Sequence[str] = ()
    ) -> None:
        self.jets, self.place, self._names = jets, place, names
        self._functions = tuple(eliminated.rules)
        self._nonzero = eliminated.nonzero
        self._equations = tuple(self._series_of(eliminated))
        self._states = {
            jets.symbol(function, order).name: (i, order)
            for i, (function, rule) in enumerate(eliminated.rules.items())
            for order in range(rule.order)
        }

    def _series_of(self, eliminated: Eliminated) -> list[Element]:
        """Equations that are power series at the point and that determine all functions."""
        every = [*eliminated.residuals, *eliminated.constraints]
        # The rules are equivalent, and a root such as sqrt(1 + R) is not regular before R is known.
        equations = [one for one in every if not self._is_nested(one)]
        longest = max(one.length for one in equations) if len(equations) == len(every) else math.inf
        for function, rule in eliminated.rules.items():
            # A rule follows from the equations, but occurs at lower orders of the series. A longer
            # one costs more than it saves.
            if rule.value.length <= longest:
                equation = self.jets.element(function, rule.order) - rule.value
                equations.append(self.jets.field.read(sp.fraction(equation.sympy)[0]))
        poles = [one for one in equations if self._has_pole(one)]
        if poles:
            names = list(self._names) or [f"S({self.jets.variable}) = R"]
            raise GravityError(
                f"start: expected equations that are power series at {self.jets.variable} = "
                f"{self.place}, got a function with a pole in {checks.cut(str(poles[0]))}. Name "
                f"its argument: reduce({str(self.jets.variable)!r}, conditions={names}), or start "
                "beside this point."
            )
        return equations

    def _is_nested(self, equation: Element) -> bool:
        """Whether an equation has roots or functions of unknown functions and of the variable."""
        expression = equation.sympy
        roots = {x for x in expression.atoms(sp.Pow) if not x.exp.is_Integer}
        arguments = (x.free_symbols for x in roots | expression.atoms(sp.Function))
        return any(self.jets.variable in x and x & self.jets.symbols for x in arguments)

    def _has_pole(self, equation: Element) -> bool:
        """Whether a function in an equation has an argument with a pole at the point."""
        here = equation.sympy.xreplace({self.jets.variable: self.place})
        return here.has(sp.zoo, sp.nan, sp.oo)

    @cached_property
    def names(self) -> tuple[str, ...]:
        """Derivatives in the equations, which have values at the point."""
        symbols = {x for one in self._equations for x in self.jets.places(one)}
        return tuple(sorted({*self._states, *(one.symbol.name for one in symbols)}))

    def _step(self, start: Mapping[str, sp.Expr]) -> int:
        """2 for even functions, which are smooth at a centre; 1 if a function vanishes there."""
        zero = any(start.get(self.jets.symbol(one, 0).name) == 0 for one in self._functions)
        return 2 if self._allows_even_functions and not zero else 1

    @cached_property
    def _allows_even_functions(self) -> bool:
        """Whether the equations keep their form as the functions are mirrored at the point."""
        table = {self.jets.variable: self.jets.field.read(2 * self.place - self.jets.variable)}
        table |= {symbol: -self.jets.field.read(symbol) for symbol in self._odd}
        for one in self._equations:
            mirrored = self.jets.replaced(one, table)
            if not ((mirrored - one).is_zero or (mirrored + one).is_zero):
                return False
        return True

    @property
    def _odd(self) -> list[sp.Symbol]:
        """The symbols of derivatives of odd order."""
        orders = range(1, self.jets.highest + 1, 2)
        return [self.jets.symbol(one, order) for one in self._functions for order in orders]

    def states(
        self,
        start: Mapping[str, sp.Expr],
        numbers: Mapping[str, sp.Expr],
        near: Mapping[str, sp.Expr],
    ) -> dict[str, sp.Expr]:
        """Values of all states at the point.

        start, near: numbers and rough numbers of derivatives; numbers: of parameters.
        """
        highest = max(order for _, order in self._states.values())
        exact = self._exact(start, numbers, near)
        with ball_precision(EXACT_BITS), working_precision(EXACT_BITS):
            series = self._series(exact, numbers, near, highest)
            return {
                name: exact.get(name, _number(series.derivative(i, order, arb(0))))
                for name, (i, order) in self._states.items()
            }

    def beside(
        self,
        start: Mapping[str, sp.Expr],
        numbers: Mapping[str, sp.Expr],
        near: Mapping[str, sp.Expr],
        reach: sp.Expr | None = None,
    ) -> tuple[sp.Expr, dict[str, sp.Expr]]:
        """A place beside the point, and the states there, by power series; at most at a reach."""
        exact = self._exact(start, numbers, near)
        values = dict[str, arb]()
        # Each order may cost some bits.
        for bits in (EXACT_BITS, 2 * EXACT_BITS, 4 * EXACT_BITS):
            with ball_precision(bits), working_precision(bits):
                series = self._series(exact, numbers, near, _LAST)
                way = _way([[row.get(k, arb(0)) for k in range(_LAST + 1)] for row in series.rows])
                way = way if reach is None else min(way, reach)
                here = balls.exact_ball(way)
                values = {
                    name: series.derivative(i, order, here)
                    for name, (i, order) in self._states.items()
                }
                if all(map(_is_sharp, values.values())):
                    return self.place + way, {name: _number(x) for name, x in values.items()}
        listed = ", ".join(f"{name} = {value.str(5)}" for name, value in values.items())
        raise GravityError(
            f"start: expected a power series from {self.jets.variable} = {self.place}, got one "
            f"with too few digits: {listed}. Start beside this point."
        )

    def _series(
        self,
        exact: Mapping[str, sp.Expr],
        numbers: Mapping[str, sp.Expr],
        near: Mapping[str, sp.Expr],
        last: int,
    ) -> Expansion:
        """Power series up to an order."""
        series = Expansion(
            self.jets,
            self._functions,
            self._equations,
            self.place,
            self._step(exact),
            numbers,
            near,
            {one.name for one in self._nonzero},
        )
        for name, value in exact.items():
            series.set(name, value)
        series.run(last)
        return series

    def _exact(
        self,
        start: Mapping[str, sp.Expr],
        numbers: Mapping[str, sp.Expr],
        near: Mapping[str, sp.Expr],
    ) -> dict[str, sp.Expr]:
        """The start, completed by the equations at the point itself."""
        symbols = {one.name: one for one in self.jets.symbols}
        values = dict(start)
        if self._step(start) == 2:
            for odd in self._odd:
                if values.setdefault(odd.name, sp.S.Zero) != 0:
                    raise GravityError(
                        f"start: expected {odd.name} = 0, because the functions are even at "
                        f"{self.jets.variable} = {self.place}, got {values[odd.name]}. Omit it."
                    )
        every = {x for one in self._equations for x in one.symbols} - {self.jets.variable}
        check_parameters({one.name for one in every - self.jets.symbols}, numbers)
        table = {symbols[name]: value for name, value in values.items() if value == 0}
        table |= {one: numbers[one.name] for one in every if one.name in numbers}
        conditions = self._conditions(table | {self.jets.variable: self.place})
        with working_precision(EXACT_BITS):
            values = filled(conditions, self.names, symbols, values, near)
            table = {symbols[name]: value for name, value in values.items()}
            for one in conditions:
                if one.free_symbols <= table.keys():
                    check_constraint(one, table)
        return values

    def _conditions(self, table: Mapping[sp.Symbol, sp.Expr]) -> list[sp.Expr]:
        """Numerators of the equations at the point, without factors that vanish nowhere."""
        result: dict[sp.Expr, None] = {}
        for one in self._equations:
            here = one.sympy.xreplace(dict(table))
            above = sp.fraction(self.jets.field.read(here).sympy)[0]
            factors = [
                x for x in sp.Mul.make_args(above) if not x.is_number and x not in self._nonzero
            ]
            if above != 0:
                result[sp.Mul(*factors)] = None
        return list(result)


def _is_sharp(value: arb) -> bool:
    """Whether a ball is far smaller than the rounding of a double."""
    return value.rad() <= EPS**2 * (abs(value.mid()) + EPS)


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


def _number(value: arb) -> sp.Expr:
    """The middle of a ball."""
    mantissa, exponent = value.mid().man_exp()
    return sp.Rational(int(mantissa)) * sp.Rational(2) ** int(exponent)

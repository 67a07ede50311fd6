"""Series: a system in balls, the Taylor coefficients of its solutions and of their derivatives."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from fractions import Fraction
from typing import TYPE_CHECKING, Any

from flint import acb, arb, arb_mat, arb_series, ctx

from geomtorsion.codegen import Graph
from geomtorsion.codegen.ball_functions import Ball
from geomtorsion.codegen.balls import BallCode, BallFunction, coefficient
from geomtorsion.codegen.steps import Builder
from geomtorsion.support.caching import cached_property
from geomtorsion.support.precision import series_length

if TYPE_CHECKING:
    from collections.abc import Callable

    from geomtorsion.ode.system import System

# Coefficients of each state, order after order.
Rows = list[list[arb]]


@dataclass(frozen=True)
class Slopes:
    """Coefficients of the nonzero entries of a Jacobian, at positions (i, j)."""

    places: tuple[tuple[int, int], ...]
    series: tuple[tuple[arb, ...], ...]

    def matrix(self, order: int, size: int) -> arb_mat:
        """The matrix of one order."""
        rows = [[arb(0)] * size for _ in range(size)]
        for (i, j), row in zip(self.places, self.series, strict=True):
            rows[i][j] = row[order]
        return arb_mat(rows)


@dataclass(frozen=True, eq=False)
class BallSystem:
    """Rates f and their Jacobian J as functions of balls, with numbers for the parameters.

    size: number of states.
    parameters: makes the values of the parameters at the precision in use.
    rates, jacobian: graphs over states, then parameters.
    """

    size: int
    parameters: Callable[[], list[arb]]
    rates: Graph
    jacobian: Graph
    _known: dict[int, list[list[arb]]] = field(default_factory=dict, init=False, repr=False)

    @classmethod
    def of(
        cls,
        system: System,
        parameters: Callable[[], list[arb]],
        *,
        backwards: bool = False,
        varied: Sequence[str] = (),
    ) -> BallSystem:
        """A system of the library, or the same run backwards in time.

        varied: names of parameters that are further states, at the end, with rates of zero; then
            `parameters` makes the values of the others.
        """
        rates = system.rates
        if backwards:
            rates = replace(rates, outputs=tuple((-sign, place) for sign, place in rates.outputs))
        states = (*system.states, *varied)
        if varied:
            rest = (name for name in system.parameters if name not in varied)
            rates = _with_constants(rates, (*states, *rest), len(varied))
        return cls(len(states), parameters, rates, rates.derivative(states))

    @cached_property
    def places(self) -> tuple[tuple[int, int], ...]:
        """Rows and columns of the entries of the Jacobian that do not vanish."""
        return tuple((k // self.size, k % self.size) for k in self._entries)

    @cached_property
    def _entries(self) -> list[int]:
        steps = self.jacobian.steps
        return [
            k
            for k, (_, place) in enumerate(self.jacobian.outputs)
            if not (steps[place].kind == "number" and steps[place].detail == 0)
        ]

    def _values(self) -> list[list[arb]]:
        """Parameters, and the numbers of both graphs, at the precision in use."""
        bits = ctx.prec
        if bits not in self._known:
            codes = BallCode(self.rates), BallCode(self.jacobian)
            self._known[bits] = [self.parameters(), *(code.numbers() for code in codes)]
        return self._known[bits]

    @cached_property
    def _rates(self) -> BallFunction:
        return BallCode(self.rates).real_function()

    @cached_property
    def _complex_rates(self) -> BallFunction:
        return BallCode(self.rates).complex_function()

    @cached_property
    def _slopes(self) -> BallFunction:
        return BallCode(self.jacobian).real_function()

    @cached_property
    def _complex_slopes(self) -> BallFunction:
        return BallCode(self.jacobian).complex_function()

    def rates_at(self, states: Sequence[Ball]) -> list[Ball]:
        """f at real balls, or at series."""
        parameters, numbers, _ = self._values()
        return self._rates([*states, *parameters], numbers)

    def rates_on(self, states: Sequence[acb]) -> list[acb]:
        """f at complex balls; not finite where it is not analytic."""
        parameters, numbers, _ = self._values()
        return self._complex_rates([*states, *parameters], numbers, True)

    def edge_near(self, states: Sequence[arb]) -> str:
        """The first function of rates or slopes without a value or a series at a point, in words.

        It is "" where all have both.
        """
        parameters, *numbers = self._values()
        with series_length(2):
            along = [arb_series([x, 1], prec=2) for x in states]
            for graph, values in zip((self.rates, self.jacobian), numbers, strict=True):
                steps = graph.steps
                every = BallCode(replace(graph, outputs=tuple((1, k) for k in range(len(steps)))))
                function = every.real_function()
                pairs = zip(steps, function([*states, *parameters], values),
                            function([*along, *parameters], values), strict=True)  # fmt: skip
                for step, value, series in pairs:
                    name = step.detail if step.kind == "call" else f"a {step.kind}"
                    if not value.is_finite():
                        return f"{name} has no finite value"
                    if not coefficient(series, 1).is_finite():
                        return f"{name} has no power series"
        return ""

    def slopes_at(self, states: Sequence[Ball]) -> list[Ball]:
        """The entries of J that do not vanish, at real balls or at series."""
        parameters, _, numbers = self._values()
        values = self._slopes([*states, *parameters], numbers)
        return [values[k] for k in self._entries]

    def slopes_on(self, states: Sequence[acb]) -> list[acb]:
        """The same at complex balls; not finite where they are not analytic."""
        parameters, _, numbers = self._values()
        values = self._complex_slopes([*states, *parameters], numbers, True)
        return [values[k] for k in self._entries]


def _with_constants(rates: Graph, arguments: Sequence[str], count: int) -> Graph:
    """Rates over arguments in another order, with zeros for further states that do not change."""
    places = [arguments.index(name) for name in rates.arguments]
    builder = Builder()
    for step in rates.steps:
        detail = places[step.detail] if step.kind == "argument" else step.detail
        builder.add(step.kind, step.operands, detail, signs=step.signs, constant=step.constant)
    zero = builder.number(Fraction(0))
    return Graph(
        tuple(arguments), *builder.needed([*rates.outputs, *[(1, zero)] * count]), rates.is_complex
    )


def taylor(system: BallSystem, start: Sequence[arb], order: int, block: int) -> tuple[Rows, Slopes]:
    """Series coefficients, up to an order, of the solution through a start, and some of J along it.

    In blocks: f at the polynomial that is known gives a block of further coefficients but for J
    times the block itself, which is a short triangular recurrence: f is evaluated order / block
    times. J has as many coefficients as the first block, and one more.
    """
    n = system.size
    rows = [[x] for x in start]
    first = min(block, order)
    for k in range(first):
        rates = _along(system.rates_at, rows, k + 1)
        for i in range(n):
            rows[i].append(coefficient(rates[i], k) / (k + 1))
    slopes = slopes_along(system, rows, first)
    by_row: list[list[tuple[int, tuple[arb, ...]]]] = [[] for _ in range(n)]
    for (i, j), entry in zip(slopes.places, slopes.series, strict=True):
        by_row[i].append((j, entry))
    length = first
    while length < order:
        count = min(block, order - length)
        rates = _along(system.rates_at, rows, length + count)
        for k in range(length, length + count):
            # The polynomial ends at `known`; what the coefficients after it add to f is J times
            # them, as long as their squares are beyond this block.
            new = []
            for i in range(n):
                value = coefficient(rates[i], k)
                for j, entry in by_row[i]:
                    for order_of_state in range(length + 1, k + 1):
                        value += entry[k - order_of_state] * rows[j][order_of_state]
                new.append(value / (k + 1))
            for i in range(n):
                rows[i].append(new[i])
        length += count
    return rows, slopes


def slopes_along(system: BallSystem, rows: Rows, order: int) -> Slopes:
    """Coefficients of J, up to an order, along polynomials."""
    entries = _along(system.slopes_at, rows, order + 1)
    series = tuple(tuple(coefficient(x, k) for k in range(order + 1)) for x in entries)
    return Slopes(system.places, series)


def _along(function: Callable[[list[arb_series]], list[Ball]], rows: Rows, length: int) -> list:
    """A function of series, to some number of coefficients, at the known polynomials."""
    with series_length(length):
        return function([arb_series(row, prec=length) for row in rows])


def variation(slopes: Slopes, start: arb_mat, order: int) -> list[arb_mat]:
    """Taylor coefficients W_0 .. W_order of the solution of W' = J W with W(0) = `start`."""
    jacobians = [slopes.matrix(k, start.nrows()) for k in range(order)]
    coefficients = [start]
    for k in range(order):
        total = jacobians[0] * coefficients[k]
        for m in range(1, k + 1):
            total = total + jacobians[m] * coefficients[k - m]
        coefficients.append(total * (1 / arb(k + 1)))
    return coefficients


def polynomial(row: Sequence[Any], time: arb) -> Any:
    """The value of a polynomial of numbers or matrices, by Horner's rule."""
    total = row[-1]
    for value in reversed(row[:-1]):
        total = total * time + value
    return total

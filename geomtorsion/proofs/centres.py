"""Centres: the regular solution at a simple pole of the rates, by a series with a proved tail.

With x the distance from the pole and y' = rate(x, y), G(x, y) = x rate(x, y) is analytic and
G(0, y(0)) = 0 [Briot, Bouquet 1856]. The coefficients follow from (k - A) y_k = c_k, A = dG/dy at
the pole. With P their polynomial up to the order N, the rest y - P = x^(N+1) v solves
x v' + (N+1) v = (G(x, P) - x P') / x^(N+1) + J v. On a disk of radius R let M bound G(x, P) - x P'
and L the entries of J, for rests up to W. If M + L U <= (N+1) U and U <= W, then the integral
equation of v maps the functions with |x^(N+1) v| <= (|x| / R)^(N+1) U into themselves and
contracts: the rest exists, is the only one, and has this bound.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import sympy as sp
from flint import acb, arb, arb_mat, arb_series, ctx

from geomtorsion.codegen import Graph, graph
from geomtorsion.codegen.balls import BallCode, coefficient, exact_ball
from geomtorsion.errors import ProofError
from geomtorsion.exact import Field
from geomtorsion.ode import ODE
from geomtorsion.proofs.wanted import upper
from geomtorsion.support.precision import ball_precision, series_length

# Disks that are tried, in distances between the pole and the start; the series converges to about
# seven of them.
DISKS = (4.0, 3.0, 2.0, 1.5)


@dataclass(frozen=True, eq=False)
class RegularStart:
    """States at the start of a regular solution, as balls.

    problem: the equations; rates: G over states, parameters and the distance x.
    values: of the states at the pole; parameters: numbers or balls.
    """

    problem: ODE
    rates: Graph
    values: tuple[Any, ...]
    parameters: Mapping[str, Any]

    @classmethod
    def of(cls, problem: ODE, parameters: Mapping[str, Any]) -> RegularStart | None:
        """The regular solution of a problem; None where it has none that is known exactly.

        parameters: numbers or balls instead of parameters of the problem.
        """
        centre, rates = problem.centre, problem.rates
        if centre is None or not set(rates.states) <= set(centre.values):
            return None
        values = {**problem.parameters, **parameters}
        x, time = (sp.Symbol(name, real=True) for name in (_free(rates.names), rates.time))
        place = sp.Symbol(centre.place, real=True)
        here = _exact(centre.origin) + x - place
        symbols = [*(sp.Symbol(n, real=True) for n in (*rates.states, *rates.parameters)), x]
        field = Field(symbols)
        terms = [field.read(x * rate.xreplace({time: here})).sympy
                 for rate in rates.expressions.values()]  # fmt: skip
        # A root whose sign changes at the pole was read for one side of it.
        if any(x in branch.radical.free_symbols for branch in field.relied_on):
            return None
        start = tuple(centre.values[name] for name in rates.states)
        at = {x: sp.S.Zero}
        known = dict(zip(rates.states, start, strict=True))
        known |= {n: v for n, v in problem.parameters.items() if n not in parameters}
        at |= {sp.Symbol(n, real=True): _exact(v) for n, v in known.items()}
        for term in terms:
            there = term.xreplace(at)
            if there.has(sp.zoo, sp.nan, sp.oo) or not field.read(there).is_zero:
                return None
        names = [symbol.name for symbol in symbols]
        return cls(problem, graph(names, terms, factor=False), start, values)

    def boxes(self) -> list[arb]:
        """The states at the start, at the precision in use.

        Raises
        ------
        ProofError
            Coefficients are not determined, or no bound of the rest is proved.
        """
        bits = ctx.prec
        reach = exact_ball(self.parameters[self._centre.place]) - exact_ball(self._centre.origin)
        for ratio in DISKS:
            order = math.ceil((bits + 16) / math.log2(ratio))
            with ball_precision(2 * bits + order):
                rows = self._coefficients(order)
                rest = self._rest(rows, abs(reach) * ratio, order)
                if rest is not None:
                    share = (1 / arb(ratio)) ** (order + 1)
                    return [
                        _polynomial(row, reach) + (x * share).upper() * arb(0, 1)
                        for row, x in zip(rows, rest, strict=True)
                    ]
        raise ProofError(
            "the series at the pole has no bound of its tail where the motion starts. Start nearer "
            "to it"
        )

    @property
    def _centre(self) -> Any:
        return self.problem.centre

    def _numbers(self) -> list[arb]:
        return [exact_ball(self.parameters[name]) for name in self.problem.rates.parameters]

    def _coefficients(self, order: int) -> list[list[arb]]:
        """The coefficients of each state, up to an order."""
        code, numbers = BallCode(self.rates), self._numbers()
        rows = [[exact_ball(x)] for x in self.values]
        n = len(rows)
        start = [row[0] for row in rows]
        flat = BallCode(self._slopes).real([*start, *numbers, arb(0)])
        slopes = arb_mat([[flat[i * n + j] for j in range(n)] for i in range(n)])
        for k in range(1, order + 1):
            with series_length(k + 1):
                given = [arb_series([*row, arb(0)], prec=k + 1) for row in rows]
                series = code.real([*given, *numbers, arb_series([0, 1], prec=k + 1)])
            right = arb_mat([[coefficient(x, k)] for x in series])
            unit = arb_mat([[k * int(i == j) for j in range(n)] for i in range(n)])
            try:
                solved = (unit - slopes).solve(right)
            except ZeroDivisionError:
                raise ProofError(
                    f"the coefficient of order {k} at the pole is not determined: it is free, or "
                    "the solution has a logarithm. Start beside the pole"
                ) from None
            for i, row in enumerate(rows):
                row.append(solved[i, 0])
        return rows

    @property
    def _slopes(self) -> Graph:
        return self.rates.derivative(self.problem.rates.states)

    def _rest(self, rows: Sequence[list[arb]], radius: arb, order: int) -> list[arb] | None:
        """Bounds U of the rest on a disk; None where they are not proved."""
        n, ball = len(rows), arb(0, 1)
        numbers = [acb(x) for x in self._numbers()]
        disk = acb(radius * ball, radius * ball)
        spreads = [_size(row, radius) for row in rows]
        speeds = [_size([k * x for k, x in enumerate(row)], radius) for row in rows]
        boxes = [acb(row[0] + s * ball, s * ball) for row, s in zip(rows, spreads, strict=True)]
        values = BallCode(self.rates).complex([*boxes, *numbers, disk], analytic=True)
        defects = [(upper(x) + speed).upper() for x, speed in zip(values, speeds, strict=True)]
        slopes = BallCode(self._slopes)
        widths = [(2 * x / (order + 1)).upper() for x in defects]
        while True:
            # Wider boxes end where the rates are not finite, or where no rest is so small.
            wide = [x + acb(w * ball, w * ball) for x, w in zip(boxes, widths, strict=True)]
            flat = slopes.complex([*wide, *numbers, disk], analytic=True)
            if not all(x.is_finite() for x in (*flat, *values)):
                return None
            bound = arb_mat([[upper(flat[i * n + j]) for j in range(n)] for i in range(n)])
            tried = _contracted(bound, defects, order)
            if tried is None:
                return None
            if all(x <= w for x, w in zip(tried, widths, strict=True)):
                return tried
            widths = [(2 * w).max(2 * x).upper() for x, w in zip(tried, widths, strict=True)]


def _contracted(bound: arb_mat, defects: Sequence[arb], order: int) -> list[arb] | None:
    """Bounds U > 0 with defects + bound U <= (order + 1) U; None where they are not proved."""
    n = len(defects)
    unit = arb_mat([[(order + 1) * int(i == j) for j in range(n)] for i in range(n)])
    try:
        rest = (unit - bound).solve(arb_mat([[x] for x in defects]))
    except ZeroDivisionError:
        return None
    tried = [(rest[i, 0] * arb(1.01)).upper() for i in range(n)]
    grown = bound * arb_mat([[x] for x in tried])
    holds = all(x > 0 and defects[i] + grown[i, 0] <= (order + 1) * x for i, x in enumerate(tried))
    return tried if holds else None


def _exact(value: Any) -> sp.Expr:
    """A number as an exact expression; floats are binary fractions."""
    is_exact = isinstance(value, sp.Expr) and not value.has(sp.Float)
    return value if is_exact else sp.Rational(value)


def _free(names: Sequence[str]) -> str:
    """A name of the distance from the pole."""
    name = "distance"
    while name in names:
        name += "_"
    return name


def _size(row: Sequence[arb], radius: arb) -> arb:
    """Sum of |c_k| radius^k over k > 0."""
    total = arb(0)
    for x in reversed(row[1:]):
        total = (total + upper(x)) * radius
    return total.upper()


def _polynomial(row: Sequence[arb], x: arb) -> arb:
    total = arb(0)
    for value in reversed(row):
        total = total * x + value
    return total

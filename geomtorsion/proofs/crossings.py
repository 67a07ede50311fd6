"""Crossings: where a motion crosses a surface, proved with its derivative by the start."""

from __future__ import annotations

import math
import time
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import flint
import sympy as sp
from flint import arb, ctx, fmpq

from geomtorsion.codegen import graph
from geomtorsion.codegen.balls import BallCode, exact_ball
from geomtorsion.errors import ArgumentError, ProofError, UnknownNameError
from geomtorsion.ode import ODE
from geomtorsion.proofs.arguments import checked_balls
from geomtorsion.proofs.closing import as_ode, sections_of
from geomtorsion.proofs.courses import exact_time
from geomtorsion.proofs.events import Fall
from geomtorsion.proofs.motions import MOST_STEPS, Box, Leg, RefusalError, follow
from geomtorsion.proofs.packing import WithBalls
from geomtorsion.proofs.prove import ALWAYS, certain_digits
from geomtorsion.proofs.series import BallSystem
from geomtorsion.proofs.sets import LohnerSet
from geomtorsion.proofs.steps import Method
from geomtorsion.proofs.wanted import MOST_BITS, SPARE, log2
from geomtorsion.support import checks
from geomtorsion.support.exclusive import exclusive
from geomtorsion.support.precision import ball_precision, series_length


@exclusive
@dataclass(frozen=True, eq=False, repr=False)
class Crossing(WithBalls):
    """Proved crossing of a surface: the image of a start under a Poincare map.

    problem: the equations.
    time: ball of the time of the crossing, of all motions from the balls of the start.
    point: state -> ball at the crossing.
    derivative: state -> balls of its derivatives at the crossing by the start of each state, in the
        order of the states; shape (n, n).
    time_derivative: balls of the derivatives of the time by the start of each state, shape (n,).
    digits, bits, steps, seconds: the requested digits, and what the proof took.
    assumes: assumptions of the proof.
    """

    problem: ODE
    time: arb
    point: Mapping[str, arb]
    derivative: Mapping[str, tuple[arb, ...]]
    time_derivative: tuple[arb, ...]
    digits: int
    bits: int
    steps: int
    seconds: float
    assumes: tuple[str, ...]

    def __getitem__(self, name: str) -> arb:
        """The ball of a state at the crossing."""
        return self.point[checks.known_name(name, self.point, "name", UnknownNameError)]

    def lines(self) -> list[str]:
        """The time and the states with their certain digits, one per line."""
        rows = {"time": self.time, **self.point}
        with ball_precision(self.bits):
            return [f"{name} = {certain_digits(x, self.digits)}" for name, x in rows.items()]

    def __str__(self) -> str:
        cost = f"{self.digits} digits, {self.bits} bits, {self.seconds:.3g} s"
        return "\n".join([f"proved crossing, {cost}:", *(f"  {line}" for line in self.lines())])

    __repr__ = __str__


@exclusive
def poincare(
    problem: Any,
    section: Any,
    t: object,
    *,
    count: int = 1,
    start: Mapping[str, Any] | Sequence[Any] | None = None,
    parameters: Mapping[str, Any] | None = None,
    digits: int = 15,
) -> Crossing:
    """Prove where a motion crosses a surface, and how this depends on the start.

    The crossings are proved to be the first ones, and transversal; interval Newton encloses the
    time. A start on the surface is not a crossing.

    Equation
    --------
    P(x) = phi(tau(x), x) with g(P(x)) = 0; DP = V - f (g' V) / (g' f)

    Parameters
    ----------
    problem
        An ODE without the time in its rates, or a curve, which is written in its home chart.
    section
        Expression g (or When(g)): the crossings are those where it falls through zero. For those
        where it rises, give -g.
    t
        Time up to which the crossing is searched.
    count
        Which crossing: 1 for the first return, 2 for the second, ...
    start, parameters
        Numbers or balls that replace values of the problem, as for `prove`.
    digits
        How many digits of the largest state, from 1 to 1000; fewer where starts are wide balls.

    Raises
    ------
    ProofError
        There is no crossing up to t, it is not transversal, or the motion is not followed there.
    ArgumentError, UnknownNameError, ExpressionError
        An argument is of another kind, or names something unknown.

    Examples
    --------
    A pendulum from the angle 1 is at rest again after half of its period:

    >>> from geomtorsion.ode import ODE
    >>> swing = ODE.of({"x": "v", "v": "-sin(x)"}, [1, 0])
    >>> crossing = poincare(swing, "-v", 5, digits=20)
    >>> print(crossing.time.str(18, radius=False), crossing["x"].str(10, radius=False))
    3.34998783218522636 -1.000000000
    """
    began = time.perf_counter()
    checks.count(digits, "digits", ArgumentError, 1, 1000)
    checks.count(count, "count", ArgumentError, 1)
    last = checks.real(t)
    if last is None or not 0 < last < math.inf:
        raise ArgumentError(f"t: expected a time above zero, got {checks.shown(t)}. Give one.")
    equations = as_ode(problem)
    terms = sections_of(equations, section)
    if len(terms) != 1:
        raise ArgumentError(f"section: expected one expression, got {len(terms)}. Give one.")
    given = checked_balls(parameters, "parameters")
    for name in given:
        checks.known_name(name, equations.parameters, "parameters", UnknownNameError)
    values = {**equations.parameters, **given}
    balls = _start_of(equations, start)
    surface = Surface(equations, terms[0], values)
    wanted = math.ceil(digits * math.log2(10)) + 1
    with ball_precision(53), series_length(flint.ctx.cap):
        image, bits = _sharp(surface, balls, exact_time(float(last)), count, wanted)
    names = equations.states
    columns = [dict(zip(names, column, strict=True)) for column in image.columns]
    return Crossing(
        equations, image.time, dict(zip(names, image.point, strict=True)),
        {name: tuple(column[name] for column in columns) for name in names},
        tuple(image.time_slopes), digits, bits, image.steps, time.perf_counter() - began,
        ALWAYS,
    )  # fmt: skip


def _start_of(problem: ODE, start: object) -> tuple[Any, ...]:
    """Numbers or balls of all states."""
    known = dict(zip(problem.states, problem.start, strict=True))
    if start is None:
        return problem.start
    if not isinstance(start, Mapping):
        entries = checks.entries(start, "start", ArgumentError, len(known))
        start = dict(zip(known, entries, strict=True))
    given = checked_balls(start, "start")
    for name in given:
        checks.known_name(name, known, "start", UnknownNameError, expected="a state")
    return tuple(given.get(name, x) for name, x in known.items())


@dataclass(frozen=True, eq=False)
class Image:
    """A crossing in balls; columns: derivatives of the point by the start of each state."""

    time: arb
    point: list[arb]
    columns: list[list[arb]]
    time_slopes: list[arb]
    steps: int = 0


@dataclass(frozen=True, eq=False)
class Surface:
    """A surface g = 0 across a motion; values: of the parameters, numbers or balls."""

    problem: ODE
    term: sp.Expr
    values: Mapping[str, Any]

    def _fall(self, sign: int) -> Fall:
        """Where g (or -g) falls through zero."""
        rates = self.problem.rates
        code = BallCode(rates.numbers)

        def given() -> list[arb]:
            return [exact_ball(self.values[name]) for name in rates.parameters]

        def numbers() -> list[arb]:
            return code.real(given())

        system = BallSystem.of(self.problem.system, numbers)
        return Fall(
            system, graph(rates.names, [sign * self.term], factor=False), rates.states, given, None
        )

    def image(self, start: Sequence[Any], last: fmpq, count: int, *, wide: bool) -> Image:
        """The crossing of a number, at the precision in use.

        Raises
        ------
        RefusalError
            It does not exist up to a time, or is not proved.
        """
        n = self.problem.size
        point = [exact_ball(x) for x in start]
        columns = [[arb(int(i == k)) for i in range(n)] for k in range(n)]
        here = Image(arb(0), point, columns, [arb(0)] * n)
        falls = {sign: self._fall(sign) for sign in (1, -1)}
        value, rate = falls[1].value(point), falls[1].rate(point)
        if value > 0 or (value.contains(0) and rate > 0):
            signs = [1]
        elif value < 0 or (value.contains(0) and rate < 0):
            signs = [-1, 1]
        else:
            raise RefusalError(
                "the motion starts along the section, or this is not decided",
                fmpq(0),
                "Start on one side of it, or give a smaller ball.",
            )
        for sign in [*signs, *[-1, 1] * (count - 1)]:
            here = self._next(here, falls[sign], last, wide=wide)
        return here

    def _next(self, here: Image, fall: Fall, last: fmpq, *, wide: bool) -> Image:
        """The next crossing after a point on the surface, or on its positive side."""
        whole = LohnerSet.of(here.point, here.columns)
        leg = Leg(fall.system, fmpq(0), last, (), fall)
        path = follow(leg, whole, Method.of(ctx.prec), MOST_STEPS - here.steps, may_widen=wide)
        if path.stop is None:
            raise RefusalError(
                "there is no further crossing of the section", last, "Search up to a later time."
            )
        after, box = path.stop
        return self._projected(here, fall, after, box, here.steps + path.steps)

    def _projected(self, here: Image, fall: Fall, after: arb, box: Box, steps: int) -> Image:
        """Derivatives along the surface: the time of the crossing also depends on the start."""
        rate = fall.rate(box.states)
        if rate.contains(0):
            raise RefusalError("the crossing is not transversal", fmpq(0), "Move the section.")
        speeds: list[Any] = fall.system.rates_at(box.states)
        slopes = fall.slopes(box.states)
        columns, times = [], []
        for column, before in zip(box.columns, here.time_slopes, strict=True):
            change = -sum((x * y for x, y in zip(slopes, column, strict=False)), arb(0)) / rate
            columns.append([x + v * change for x, v in zip(column, speeds, strict=True)])
            times.append(before + change)
        return Image(here.time + after, box.states, columns, times, steps)


def _sharp(
    surface: Surface, start: Sequence[Any], last: fmpq, count: int, wanted: int
) -> tuple[Image, int]:
    """The crossing with a number of bits, or as sharp as the start."""
    wide = any(isinstance(x, arb) and not x.is_exact() for x in start)
    middle = [x.mid() if isinstance(x, arb) else x for x in start]
    bits = wanted + SPARE
    while bits < MOST_BITS:
        with ball_precision(bits):
            try:
                image = surface.image(middle, last, count, wide=False)
                missing = wanted - _bits(image)
                if missing <= 0 and wide:
                    image = _mean_value(
                        image, surface.image(start, last, count, wide=True), middle, start
                    )
                if missing <= 0:
                    return image, bits
            except RefusalError as error:
                if error.width is None or wide:
                    when = float(arb(error.when))
                    raise ProofError(
                        f"the crossing is not proved: {error.reason} at {when:.6g}. {error.advice}"
                    ) from None
                missing = bits
        bits += math.ceil(missing) + 6
    raise ProofError("expected more digits, got no more. Request fewer digits.")


def _bits(image: Image) -> float:
    """Bits of the time, the point and the derivatives."""
    rows = [[image.time], image.point, *image.columns]
    return min(
        max(log2(x.mid()) for x in row) - max(log2(x.rad()) for x in row)
        for row in rows
        if any(not x.contains(0) for x in row)
    )


def _mean_value(thin: Image, wide: Image, middle: Sequence[Any], start: Sequence[Any]) -> Image:
    """The image of a ball: the image of its middle, and slopes over the ball times its radius."""
    offs = [exact_ball(x) - exact_ball(m) for x, m in zip(start, middle, strict=True)]
    point = [
        x + sum((column[i] * off for column, off in zip(wide.columns, offs, strict=True)), arb(0))
        for i, x in enumerate(thin.point)
    ]
    after = thin.time + sum(
        (slope * off for slope, off in zip(wide.time_slopes, offs, strict=True)), arb(0)
    )
    return Image(after, point, wide.columns, wide.time_slopes, wide.steps)

"""Events: first zeros of functions along a motion, by halving and Newton's method."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

from flint import arb, ctx

from geomtorsion.codegen import Graph
from geomtorsion.codegen.ball_functions import Ball
from geomtorsion.codegen.balls import BallCode
from geomtorsion.errors import ProofError
from geomtorsion.proofs.series import BallSystem
from geomtorsion.proofs.steps import Step
from geomtorsion.support.caching import cached_property


@dataclass(frozen=True, eq=False)
class Fall:
    """Function of states, parameters and time: the motion stops when it falls to zero.

    system: the equations; term: the graph, with one output, over names of states, then parameters,
    then the time.
    states: names of the states of the equations, except a clock.
    parameters: makes the values of the parameters of the term at the precision in use.
    ticks: time unit of a clock, which is the state after these; None without a clock.
    """

    system: BallSystem
    term: Graph
    states: Sequence[str]
    parameters: Callable[[], list[arb]]
    ticks: int | None

    @cached_property
    def _value(self) -> BallCode:
        return BallCode(self.term)

    @cached_property
    def _slopes(self) -> BallCode:
        return BallCode(self.term.derivative((*self.states, self.term.arguments[-1])))

    def _arguments(self, states: Sequence[arb]) -> list[arb]:
        n = len(self.states)
        time = arb(0) if self.ticks is None else self.ticks * states[n]
        return [*states[:n], *self.parameters(), time]

    def value(self, states: Sequence[arb]) -> arb:
        """The term at a box."""
        return self._value.real(self._arguments(states))[0]

    def slopes(self, states: Sequence[arb]) -> list[arb]:
        """Derivatives of the term by the states, then by the time, at a box."""
        return self._slopes.real(self._arguments(states))

    def rate(self, states: Sequence[arb]) -> arb:
        """The rate of the term at a box."""
        slopes = self.slopes(states)
        rates: list[Ball] = self.system.rates_at(states)
        if self.ticks is not None:
            n = len(self.states)
            rates = [*rates[:n], self.ticks * rates[n]]
        return sum((x * y for x, y in zip(slopes, rates, strict=False)), arb(0))

    def first(self, step: Step) -> arb | None:
        """The time in a step at which the term falls through zero; None where it stays positive.

        Raises
        ------
        ProofError
            it comes so near to zero that neither can be decided.
        """
        if self.value(step.tube) > 0:
            return None
        waiting = [(arb(0), arb(step.length))]
        shortest = arb(step.length) * arb(2) ** (-ctx.prec // 2)
        while waiting:
            low, high = waiting.pop()
            time = low.union(high)
            # Before `low` the term is positive, or at zero where the motion begins.
            box = step.hull(time)
            if self.value(box) > 0:
                continue
            rate, end = self.rate(box), self.value(step.hull(high))
            if rate > 0 or (rate < 0 and end > 0):
                continue
            if rate < 0 and end < 0:
                return self._newton(step, time)
            if high - low < shortest:
                raise ProofError("it touches the stop, or comes within rounding of it")
            middle = ((low + high) / 2).mid()
            waiting += [(middle, high), (low, middle)]
        return None

    def _newton(self, step: Step, time: arb) -> arb:
        """All zeros of the members of a set, in an interval in which each has one."""
        while True:
            middle = time.mid()
            value = self.value(step.hull(middle))
            image = middle - value / self.rate(step.hull(time))
            if not (image.is_finite() and image.overlaps(time)):
                return time
            both = image.intersection(time)
            # Convergence is quadratic until rounding: it ends where an interval is not halved.
            if not 2 * both.rad() < time.rad():
                return both
            time = both

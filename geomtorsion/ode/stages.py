"""Stages: a motion whose equations change on the way, from one change to the next."""

from __future__ import annotations

import math
from bisect import bisect_right
from collections.abc import Callable, Iterable, Sequence
from dataclasses import replace
from functools import partial
from operator import itemgetter
from typing import TypeAlias

import numpy as np
import sympy as sp

from geomtorsion.errors import StartError
from geomtorsion.ode.error_estimate import NOISE
from geomtorsion.ode.numbers import Real, floats, mpf, perturbed
from geomtorsion.ode.rates import CLOCK, Rates
from geomtorsion.ode.switching import Ended, Mode, Position, Switching
from geomtorsion.ode.terms import At, moments
from geomtorsion.ode.trajectory import MOST_STAGES, Event, Stage, State
from geomtorsion.support.caching import cached_property
from geomtorsion.support.precision import HALF, working_precision

BACKWARDS = "it changes there, and changes act forwards in time only"
# A stage, or the outcome of a motion with its reason.
Next: TypeAlias = Stage | tuple[str, str]


class Stages:
    """The stages of one run, at one precision.

    own: the surfaces. perturbation: the part by which numbers are changed.
    """

    def __init__(self, own: Switching, precision: int, perturbation: float) -> None:
        self.own, self.problem, self.rates = own, own.problem, own.rates
        self.precision, self.perturbation = precision, perturbation
        self._bits = precision + 20
        self._bounded: dict[object, Rates] = {}

    def first(self) -> Stage:
        """The stage that begins at t = 0.

        Raises
        ------
        StartError
            the motion cannot begin there.
        """
        above = (True,) * len(self.own.surfaces)
        start, parameters = list(self.problem.start), dict(self.problem.parameters)
        try:
            return self._begun(Position(0.0, start, parameters, above))
        except Ended as reason:
            raise StartError(
                f"start: expected a motion that can begin, got one that cannot: {reason}."
            ) from None

    def _begun(self, position: Position) -> Stage:
        position = self._at_time(position, initial=True)
        if self.perturbation:
            states = perturbed(position.states, self.perturbation, self.precision, all_of_them=True)
            position = replace(position, states=states)
        return self.stage(position)

    @cached_property
    def _timed(self) -> list[tuple[float, int, At]]:
        """Changes at times, in order."""
        rows = moments(self.problem.events, self.problem.parameters)
        return [(one.time, k, self.problem.events[k]) for one, k in rows]

    def _at_time(self, position: Position, *, initial: bool = False) -> Position:
        """The position after all that happens at its time."""
        time = position.moment
        for at, number, event in self._timed:
            if at == time:
                position = self.own.acted(position, event, number, self._bits)
        if initial:
            position = self.own.settled(self.own.sides(position), 0.0, self._bits, acts=False)
        else:
            knots = self.own.times(position.parameters)
            for at, k in knots[: bisect_right(knots, time, key=itemgetter(0))]:
                if at <= time and not position.above[k]:
                    position = self.own.crossed(position, k, self._bits)
            position = self.own.settled(position, 0.0, self._bits)
        return position

    def stage(self, position: Position) -> Stage:
        """The stage that begins at a position."""
        mode, problem = self.own.mode(position), self.problem
        start = problem.normalized_state(position.states, self.precision)
        position = replace(position, states=start)
        bounds, numbers = self._bounds(mode, position)
        key = id(mode), tuple((term, below, above) for term, below, above in bounds)
        if key not in self._bounded:
            self._bounded[key] = _with_guards(mode.rates, bounds)
        rates = self._bounded[key]
        values: Sequence[Real] | np.ndarray = rates.numbers.exactly(
            [*(position.parameters[x] for x in self.rates.parameters), *numbers]
        )
        if self.perturbation:
            values = perturbed(values, self.perturbation, self.precision, all_of_them=False)
        states: Sequence[Real] | np.ndarray = position.states
        if rates.has_clock:
            states = [*states, position.time / CLOCK]
        if self.precision == 53:
            states, values = (np.array(floats(row)) for row in (states, values))
        events = []
        if rates.system.guard is not None:
            follow = _Following(partial(self._after, mode, position, rates))
            events.append(Event(None, follow.then, follow.ending, lambda _state: None))
        after = self._next_time(position)
        if after is not None:
            follow = _Following(partial(self._later, position))
            events.append(Event(after, follow.then, follow.ending))
        knots = [at for at, k in self.own.times(position.parameters) if position.above[k]]
        if knots:
            events.append(Event(knots[-1], None, lambda _time, _state: ("stuck", BACKWARDS)))
        groups = rates.system.groups[:-1] if rates.has_clock else rates.system.groups
        return Stage(
            "", rates.system, states, values, position.time, tuple(events), groups=groups,
            kept=problem.normalizer(self.precision), changes=position.count,
        )  # fmt: skip

    def _next_time(self, position: Position) -> float | None:
        """The next time at which something changes."""
        knots = self.own.times(position.parameters)
        place = bisect_right(knots, position.moment, key=itemgetter(0))
        times = [at for at, _ in knots[place : place + 1]]
        times += [at for at, _, _ in self._timed if at > position.moment]
        return min(times, default=None)

    def _bounds(
        self, mode: Mode, position: Position
    ) -> tuple[list[tuple[sp.Expr, bool, bool]], list[Real]]:
        """For each term whether it has a level below and above; and the numbers of these levels.

        A motion that is on a level is kept a rounding away from it.
        """
        _, slopes, sizes = self.own.looked(mode, position)
        levels = self.own.numbers(position.parameters, self._bits)
        numbers = [position.parameters[x] for x in self.rates.parameters]
        exact = mode.terms.exactly([*position.states, *numbers, position.time], self._bits)
        bounds, rows = [], list[Real]()
        for term in self.own.untimed:
            place = self.own.terms.index(term)
            here = mpf(exact[place], self._bits)
            own = [
                (mpf(levels[k], self._bits), position.above[k])
                for k, at, _ in self.own.watched
                if at == place
            ]
            below = [level for level, is_above in own if is_above]
            above = [level for level, is_above in own if not is_above]
            bounds.append((term, bool(below), bool(above)))
            reach = abs(float(slopes[place])) * abs(position.moment)
            for sign, found in ((1, max(below, default=None)), (-1, min(above, default=None))):
                if found is None:
                    continue
                size = NOISE * (float(sizes[place]) + abs(float(found))) + reach
                room = size * 2.0 ** (3 - self.precision)
                with working_precision(self._bits):
                    gap = sign * (here - found)
                    rows.append(found if gap > room else here - sign * room)
        if self.precision == 53:
            rows = [float(x) for x in rows]
        return bounds, rows

    # -- from stage to stage ---------------------------------------------------------------------

    def _later(self, position: Position, time: float, state: State) -> Next:
        """The stage behind a change at a time, or the end of the motion."""
        states = list(state[: len(self.rates.states)])
        elapsed = replace(position, time=time, states=states)
        return self._stopped(elapsed) or self._continued(lambda: self._at_time(elapsed))

    def _after(self, mode: Mode, begin: Position, rates: Rates, time: float, state: State) -> Next:
        """The stage behind a guard that has fallen, or the end of the motion."""
        if float(time) < begin.moment:
            return "stuck", BACKWARDS
        states = list(state[: len(self.rates.states)])
        position = replace(begin, time=time, states=states)
        if not np.isfinite(floats(states)).all():
            return "stuck", "a state exceeds the range of floats"
        elapsed = position.moment - begin.moment
        values, slopes, _ = self.own.looked(mode, position)
        levels = self.own.numbers(position.parameters)
        best, chosen = math.inf, None
        stops = len(self.own.terms)
        for k in range(len(rates.stops)):
            left = _time_left(values[stops + k], slopes[stops + k])
            if left < best:
                best, chosen = left, ("stop", k)
        for k, place, _ in self.own.watched:
            sign = 1.0 if position.above[k] else -1.0
            gap = sign * (values[place] - float(levels[k]))
            left = _time_left(gap, sign * slopes[place])
            if left < best:
                best, chosen = left, ("surface", k)
        far = HALF * max(abs(position.moment), elapsed)
        if chosen is None or best > far:
            reason = next(iter(rates.edges.values()), "the motion cannot continue")
            return "stuck", reason
        kind, k = chosen
        if kind == "stop":
            return "stopped", str(self.rates.stops[k])
        return self._continued(lambda: self.own.settled(position, elapsed, self._bits, crossed=k))

    def _continued(self, move: Callable[[], Position]) -> Next:
        """The stage behind a move, or how the motion ends."""
        try:
            position = move()
            return self._stopped(position) or self.stage(position)
        except Ended as reason:
            return "stuck", str(reason)

    def _stopped(self, position: Position) -> tuple[str, str] | None:
        """The end of a motion that a change has carried beyond a stop."""
        if not self.rates.stops:
            return None
        try:
            values, _, _ = self.own.looked(self.own.mode(position), position)
        except Ended as reason:
            return "stuck", str(reason)
        rooms = values[len(self.own.terms) :]
        k = int(np.argmin(rooms))
        return ("stopped", str(self.rates.stops[k])) if rooms[k] < 0 else None


class _Following:
    """The rule by which a stage follows another one."""

    def __init__(self, rule: Callable[[float, State], Next]) -> None:
        self.rule = rule

    def then(self, time: float, state: State) -> Stage | None:
        """The next stage, or None where the motion ends."""
        found = self.rule(time, state)
        return found if isinstance(found, Stage) else None

    def ending(self, time: float, state: State) -> tuple[str, str]:
        """Outcome and reason where no stage follows."""
        found = self.rule(time, state)
        return ("stuck", f"more than {MOST_STAGES:,} stages") if isinstance(found, Stage) else found


def _time_left(gap: float, slope: float) -> float:
    """Time after which a falling term reaches its level, by its slope."""
    if not (math.isfinite(gap) and math.isfinite(slope)):
        return math.inf
    if gap <= 0:
        return 0.0
    return gap / -slope if slope < 0 else math.inf


def _with_guards(rates: Rates, bounds: Iterable[tuple[sp.Expr, bool, bool]]) -> Rates:
    """The equations of a mode with the levels between which they hold, as further parameters."""
    guards, names = [], []
    for k, (term, below, above) in enumerate(bounds):
        # With a blank in it no user can have given this name.
        if below:
            names.append(f"low {k}")
            guards.append(term - sp.Symbol(names[-1], real=True))
        if above:
            names.append(f"high {k}")
            guards.append(sp.Symbol(names[-1], real=True) - term)
    return replace(rates, parameters=(*rates.parameters, *names), guards=tuple(guards))

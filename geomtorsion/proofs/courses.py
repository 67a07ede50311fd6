"""Courses: a problem as a proof sees it: its start, its equations, and when these change.

All numbers are computed again in balls from the user's input: floats are the dyadic numbers that
they are, fractions and expressions exact.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any, Protocol

from flint import arb, fmpq

from geomtorsion.codegen import rational
from geomtorsion.codegen.balls import BallCode, exact_ball
from geomtorsion.ode import ODE
from geomtorsion.ode.rates import CLOCK
from geomtorsion.proofs.events import Fall
from geomtorsion.proofs.motions import Leg, RefusalError
from geomtorsion.proofs.series import BallSystem
from geomtorsion.proofs.sets import LohnerSet


@dataclass(frozen=True)
class Stretch:
    """Times between which one system holds.

    begin, end: exact, in the direction of the motion; label: of the coordinates.
    samples: the requested times in it.
    reference: about where the motion is at the beginning, to choose among angles that are one.
    """

    begin: fmpq
    end: fmpq
    label: str
    samples: tuple[fmpq, ...]
    reference: tuple[float, ...] = ()


@dataclass(frozen=True, eq=False)
class Position:
    """Where a motion is.

    whole: the set of states of the equations; label: of their coordinates.
    constant: velocities that do not change, and are parameters of the equations.
    """

    whole: LohnerSet
    label: str = ""
    constant: tuple[arb, ...] = ()


class Course(Protocol):
    """A problem in balls. Its methods work at the precision in use."""

    def stretches(self, times: Sequence[fmpq], hints: Sequence[Stretch]) -> list[Stretch]:
        """Where something changes; hints: charts in which a solution followed the motion."""
        ...

    def enter(self, stretch: Stretch, before: Position | None) -> tuple[Position, Leg]:
        """The set and the equations with which a stretch begins; before: None at the start."""
        ...

    def names(self, label: str) -> tuple[str, ...]:
        """Names of the states in the coordinates of a label."""
        ...

    def shown(self, label: str, box: Sequence[arb]) -> list[arb]:
        """States as users count them, from the states of the equations."""
        ...


def exact_time(time: Any) -> fmpq:
    """A time of any engine as the exact ratio that it is."""
    ratio = rational(time)
    assert ratio is not None, "times are finite"
    return fmpq(ratio.numerator, ratio.denominator)


@dataclass(frozen=True, eq=False)
class OdeCourse:
    """First-order equations: parameters and states change at given times.

    backwards: whether the motion runs to negative times.
    start, parameters: numbers or balls that replace the values of the problem.
    """

    problem: ODE
    backwards: bool
    start: Sequence[Any] = ()
    parameters: Mapping[str, Any] = field(default_factory=dict)

    def stretches(self, times: Sequence[fmpq], hints: Sequence[Stretch]) -> list[Stretch]:
        """From one change to the next."""
        end = times[-1]
        changes = [] if self.backwards else [exact_time(x.time) for x in self.problem.events]
        begins = [fmpq(0), *(x for x in changes if 0 < x <= end)]
        stretches = []
        for begin, last in zip(begins, [*begins[1:], None], strict=True):
            inside = (x for x in times if begin <= x and (last is None or x < last))
            stretches.append(Stretch(begin, end if last is None else last, "", tuple(inside)))
        return stretches

    def enter(self, stretch: Stretch, before: Position | None) -> tuple[Position, Leg]:
        """Changes at the beginning of a stretch, lengths of one, and the clock."""
        rates, size = self.problem.rates, self.problem.size
        start_values = self.start or self.problem.start
        boxes = (
            [exact_ball(x) for x in start_values] if before is None else before.whole.hull[:size]
        )
        changed: set[str] = set()
        for event in self.problem.events:
            if exact_time(event.time) == stretch.begin:
                for name in event.changes.keys() & set(rates.states):
                    boxes[rates.states.index(name)] = exact_ball(event.changes[name])
                    changed.add(name)
        for group in self.problem.normalized:
            if before is None or changed & set(group):
                places = [rates.states.index(name) for name in group]
                length = sum((boxes[k] * boxes[k] for k in places), arb(0)).sqrt()
                for k in places:
                    boxes[k] = boxes[k] / length
        if rates.has_clock:
            boxes.append(arb(stretch.begin / CLOCK))
        leg = self._leg(stretch)
        if leg.fall is not None:
            self._refuse_stopped(leg.fall, boxes, stretch.begin, is_start=before is None)
        if before is not None and not changed:
            return before, leg
        return Position(LohnerSet.of(boxes)), leg

    def _leg(self, stretch: Stretch) -> Leg:
        rates, values = self.problem.rates, self._values(stretch.begin)
        code = BallCode(rates.numbers)

        def given() -> list[arb]:
            return [exact_ball(values[name]) for name in rates.parameters]

        def numbers() -> list[arb]:
            return code.real(given())

        system = BallSystem.of(self.problem.system, numbers, backwards=self.backwards)
        term, fall = rates.stop_graph, None
        if term is not None:
            fall = Fall(system, term, rates.states, given, CLOCK if rates.has_clock else None)
        return Leg(system, stretch.begin, stretch.end, stretch.samples, fall)

    def _values(self, time: fmpq) -> dict[str, Any]:
        """The parameters from a time on."""
        values = {**self.problem.parameters, **self.parameters}
        for event in self.problem.events:
            if exact_time(event.time) <= time:
                values |= {k: x for k, x in event.changes.items() if k in values}
        return values

    def _refuse_stopped(
        self, fall: Fall, boxes: Sequence[arb], time: fmpq, *, is_start: bool
    ) -> None:
        """Refuse to continue from where the motion has ended, or may have."""
        room = fall.value(boxes)
        if not room > 0 and not (is_start and room >= 0):
            raise RefusalError(
                f"the stop {self.problem.rates.stop} is {float(room.mid()):.6g}, or this is not "
                "proved",
                time,
                "Start where it is above zero.",
            )

    def names(self, label: str) -> tuple[str, ...]:
        """The states."""
        return self.problem.states

    def shown(self, label: str, box: Sequence[arb]) -> list[arb]:
        """The states without the clock."""
        return list(box[: self.problem.size])

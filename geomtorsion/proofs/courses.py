"""Courses: a problem as a proof sees it: its start, its equations, and when these change.

All numbers are computed again in balls from the user's input: floats are exact binary
fractions, fractions and expressions are exact.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any, Protocol

from flint import arb, fmpq

from geomtorsion.codegen import Graph, graph, rational
from geomtorsion.codegen.balls import BallCode, exact_ball
from geomtorsion.errors import ProofError
from geomtorsion.ode import ODE
from geomtorsion.ode.pieces import has_pieces
from geomtorsion.ode.problem import flat
from geomtorsion.ode.rates import CLOCK
from geomtorsion.proofs.centres import RegularStart
from geomtorsion.proofs.events import Fall
from geomtorsion.proofs.motions import Leg, RefusalError
from geomtorsion.proofs.series import BallSystem
from geomtorsion.proofs.sets import LohnerSet
from geomtorsion.support.caching import cached_property


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
        """States or derivatives in the units of users, from the states of the equations."""
        ...


def exact_time(time: Any) -> fmpq:
    """A time of any engine as an exact ratio."""
    ratio = rational(time)
    assert ratio is not None, "times are finite"
    return fmpq(ratio.numerator, ratio.denominator)


@dataclass(frozen=True, eq=False)
class OdeCourse:
    """First-order equations: parameters and states change at given times.

    backwards: whether the motion runs to negative times.
    start, parameters: numbers or balls that replace the values of the problem.
    by: names of parameters and starts of states by which derivatives are taken.
    """

    problem: ODE
    backwards: bool
    start: Sequence[Any] = ()
    parameters: Mapping[str, Any] = field(default_factory=dict)
    by: tuple[str, ...] = ()

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
        if before is None and self.regular is not None:
            boxes = self._regular_boxes(self.regular, stretch.begin)
        elif before is None:
            boxes = [exact_ball(x) for x in start_values]
        else:
            boxes = before.whole.hull[:size]
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
        if before is not None and not changed and not self._varied:
            return before, leg
        return Position(self._set(stretch, before, boxes, changed)), leg

    @cached_property
    def regular(self) -> RegularStart | None:
        """The regular solution at a pole beside which the motion starts, or None."""
        if self.start or self.problem.centre is None:
            return None
        return RegularStart.of(self.problem, self.parameters)

    def _regular_boxes(self, regular: RegularStart, time: fmpq) -> list[arb]:
        """States at the start, by a series from the pole."""
        if self.by:
            raise RefusalError(
                "derivatives from a pole of the rates are not proved", time, "Omit derivatives."
            )
        try:
            return regular.boxes()
        except ProofError as error:
            raise RefusalError(str(error), time) from None

    # -- derivatives -------------------------------------------------------------------------------

    @cached_property
    def _slopes(self) -> Graph:
        """Derivatives of the numbers of the system by each parameter."""
        return self.problem.rates.numbers.derivative(self.problem.rates.parameters)

    @cached_property
    def _varied(self) -> tuple[str, ...]:
        """Numbers of the system that depend on a parameter by which derivatives are taken."""
        names, steps = self.problem.rates.parameters, self._slopes.steps
        depends = set()
        for k, (_, place) in enumerate(self._slopes.outputs):
            row, column = divmod(k, len(names))
            is_zero = steps[place].kind == "number" and steps[place].detail == 0
            if names[column] in self.by and not is_zero:
                depends.add(row)
        return tuple(self.problem.system.parameters[k] for k in sorted(depends))

    def _set(
        self, stretch: Stretch, before: Position | None, boxes: list[arb], changed: set[str]
    ) -> LohnerSet:
        """The set at the beginning of a stretch, with derivatives."""
        if not self.by:
            return LohnerSet.of(boxes)
        rates, size, count = self.problem.rates, self.problem.size, len(boxes)
        if any(changed & set(group) for group in self.problem.normalized):
            raise RefusalError(
                "a change of states of length one has no derivatives",
                stretch.begin,
                "Prove the motion without derivatives.",
            )
        values = self._values(stretch.begin)
        given = [exact_ball(values[name]) for name in rates.parameters]
        numbers, slopes = BallCode(rates.numbers).real(given), BallCode(self._slopes).real(given)
        places = [self.problem.system.parameters.index(name) for name in self._varied]
        columns = []
        for k, name in enumerate(self.by):
            if before is None:
                column = [arb(int(x == name)) for x in rates.states]
            else:
                column = before.whole.columns[k].hull[:size]
            for state in changed:
                column[rates.states.index(state)] = arb(0)
            column += [arb(0)] * (count - size)
            acts = name in rates.parameters and not self._is_changed(name, stretch.begin)
            for place in places:
                at = place * len(rates.parameters)
                slope = slopes[at + rates.parameters.index(name)] if acts else arb(0)
                column.append(slope)
            columns.append(column)
        return LohnerSet.of([*boxes, *(numbers[place] for place in places)], columns)

    def _is_changed(self, name: str, time: fmpq) -> bool:
        """Whether a parameter has had another value, on which nothing depends, up to a time."""
        return any(
            name in event.changes and exact_time(event.time) <= time
            for event in self.problem.events
        )

    def _leg(self, stretch: Stretch) -> Leg:
        rates, values = self.problem.rates, self._values(stretch.begin)
        code = BallCode(rates.numbers)

        def given() -> list[arb]:
            return [exact_ball(values[name]) for name in rates.parameters]

        names = self.problem.system.parameters
        rest = [k for k, name in enumerate(names) if name not in self._varied]

        def numbers() -> list[arb]:
            every = code.real(given())
            return [every[k] for k in rest]

        system = BallSystem.of(
            self.problem.system, numbers, backwards=self.backwards, varied=self._varied
        )
        term, fall = rates.stop_graph, None
        if term is not None and not isinstance(term, Graph):
            raise RefusalError("a stop given by pieces is not proved", stretch.begin)
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
                f"the stop {self.problem.stop_texts[0]} is {float(room.mid()):.6g}, or this is not "
                "proved",
                time,
                "Start where it is above zero.",
            )

    def names(self, label: str) -> tuple[str, ...]:
        """The states."""
        return self.problem.states

    def outputs(self, time: arb, when: fmpq, box: Sequence[arb]) -> dict[str, Any]:
        """Smooth outputs at a time, from the states there; tuples for vectors.

        when: about this time, at which parameters have their values.
        """
        terms, code = self._outputs
        if not terms:
            return {}
        values, table = self._values(when), {}
        given = [exact_ball(values[name]) for name in self.problem.rates.parameters]
        row = code.real([*box[: self.problem.size], *given, time])
        for name, term in terms.items():
            if isinstance(term, tuple):
                table[name], row = tuple(row[: len(term)]), row[len(term) :]
            else:
                table[name], row = row[0], row[1:]
        return table

    @cached_property
    def _outputs(self) -> tuple[dict[str, Any], BallCode]:
        """Outputs without pieces, whose values in balls are known, and their code."""
        every = {name: flat({name: term}) for name, term in self.problem.outputs.items()}
        smooth = {name: row for name, row in every.items() if not has_pieces(row)}
        terms = {name: self.problem.outputs[name] for name in smooth}
        return terms, BallCode(graph(self.problem.rates.names, flat(terms), factor=False))

    def shown(self, label: str, box: Sequence[arb]) -> list[arb]:
        """The states without the clock."""
        return list(box[: self.problem.size])

"""Solutions: the states of a solved motion at its times, proved and compared."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any, TypeAlias

import numpy as np
from flint import arb, ctx, fmpq

from geomtorsion.codegen.balls import exact_ball
from geomtorsion.curves import CurveProblem
from geomtorsion.errors import ArgumentError, ProofError, ShapeError, UnknownNameError
from geomtorsion.ode import ODE, Solution
from geomtorsion.ode.trajectory import Segment
from geomtorsion.proofs.charts import CurveCourse
from geomtorsion.proofs.courses import Course, OdeCourse, Position, Stretch, exact_time
from geomtorsion.proofs.motions import MOST_STEPS, Box, RefusalError, follow
from geomtorsion.proofs.steps import SMALLER, Method
from geomtorsion.proofs.wanted import FAR_BELOW, MOST_BITS, SPARE, Wanted, log2
from geomtorsion.support import checks
from geomtorsion.support.precision import ball_precision

# Values that may replace a start.
Start: TypeAlias = Mapping[str, Any] | Sequence[Any] | None
# A set is hopeless where it was narrow when no step could be proved: more bits would not help.
NARROW = 0.6


@dataclass(frozen=True, eq=False)
class Sample:
    """One sample of a solution.

    time: exact, in the time of the stages, positive; label: of its coordinates.
    row: its states as numbers; groups: indices of states that are measured together.
    """

    time: fmpq
    label: str
    row: tuple[Any, ...]
    groups: tuple[tuple[int, ...], ...]


@dataclass(frozen=True, eq=False)
class MotionBalls:
    """Proved states.

    boxes: states of the equations at each sample that the motion reaches; stop: the time at which
    it ends, and its states there, or None.
    bits, steps: the precision, and how many steps were taken.
    """

    boxes: tuple[Box, ...]
    stop: tuple[arb, Box] | None
    bits: int
    steps: int


@dataclass(frozen=True, eq=False)
class SolutionTask:
    """Task: the values of a solution that are to be proved.

    samples: all samples, the start included where it is one; end: where it was stopped, or None.
    is_exact: whether start and parameters are numbers, and not wider balls.
    """

    solution: Solution
    course: Course
    samples: tuple[Sample, ...]
    end: Sample | None
    stretches: tuple[Stretch, ...]
    is_exact: bool

    @classmethod
    def of(
        cls,
        solution: Solution,
        start: Start = None,
        parameters: Mapping[str, Any] | None = None,
        by: tuple[str, ...] = (),
    ) -> SolutionTask:
        """The task of a solution, with balls instead of its start and parameters.

        by: names by which derivatives are taken.
        """
        problem, segments = solution.problem, solution.trajectory.segments
        backwards = solution.trajectory.reached < 0
        samples, hints = _samples_and_stretches(problem, segments, -1 if backwards else 1)
        stopped = None
        if solution.outcome == "stopped":
            last = segments[-1]
            row = _rows(problem, last, last.last[None, :])[0]
            time = exact_time(abs(last.run.reached))
            stopped = Sample(time, last.label, tuple(row), last.stage.groups)
            samples = [sample for sample in samples if sample.time < time]
        if not samples:
            raise ProofError(
                "expected a solution that reached one of its times, got one without samples. Solve "
                "to a later time."
            )
        # A motion may reach an edge after the last sample.
        end = samples[-1].time
        hints = [x for x in hints if x.begin <= end]
        # Each ends exactly where the next one begins.
        ends = [*(x.begin for x in hints[1:]), end]
        hints = [replace(x, end=last) for x, last in zip(hints, ends, strict=True)]
        course = course_of(problem, backwards, start, parameters, by)
        times = [sample.time for sample in samples]
        if stopped is not None:
            # The true motion may end a little later.
            times.append(stopped.time * fmpq(1001, 1000))
        stretches = tuple(course.stretches(times, hints))
        if stopped is not None:
            stretches = _without_last_sample(stretches)
        is_exact = all(_is_number(x) for x in (*_entries(start), *_entries(parameters)))
        return cls(solution, course, tuple(samples), stopped, stretches, is_exact)

    def proved(self, wanted: Wanted) -> MotionBalls:
        """States in balls, with the requested accuracy where possible.

        Raises
        ------
        ProofError
            the motion ends, or reaches an edge, or touches a stop.
        """
        bits, refused, before = wanted.bits + SPARE, None, math.inf
        while True:
            try:
                with ball_precision(bits):
                    motion = self._followed()
                    missing = wanted.bits - self._known_bits(motion)
            except RefusalError as error:
                more = self._more(error, bits, refused, wanted)
                if more is None:
                    raise self._refusal(error) from None
                bits, refused = more, error.when
                continue
            if missing <= 0 or not self.is_exact:
                return motion
            if bits >= MOST_BITS or missing >= before:
                raise ProofError(
                    f"expected more digits with {bits} bits, got no more than with fewer. Request "
                    "fewer digits."
                )
            before = missing
            bits = min(MOST_BITS, bits + math.ceil(missing) + 6)

    def _more(
        self, error: RefusalError, bits: int, refused: fmpq | None, wanted: Wanted
    ) -> int | None:
        """The bits with which to try again; None where no bits would help."""
        if error.width is None or error.width < -NARROW * bits or not self.is_exact:
            return None
        again = refused is not None and error.when <= refused * fmpq(1_000_001, 1_000_000)
        if again or bits >= MOST_BITS:
            return None
        lost, end = bits + error.width, self.stretches[-1].end
        share = min(float(arb(end / error.when)), 1e3) if error.when > 0 else 1e3
        needed = wanted.bits + 20 + int(1.1 * lost * share)
        return min(MOST_BITS, max(bits + 20, min(2 * bits, needed)))

    def _refusal(self, error: RefusalError) -> ProofError:
        """A refusal in the time of users."""
        problem = self.solution.problem
        sign = -1 if self.solution.trajectory.reached < 0 else 1
        time = sign * float(arb(error.when)) / problem.time_unit
        advice = error.advice or (
            "The motion ends there, or comes to the edge of a function. Prove a shorter one."
        )
        return ProofError(
            f"the motion is not proved beyond {problem.time_name} = {time:.6g}: {error.reason}. "
            f"{advice}",
            time,
        )

    def _followed(self) -> MotionBalls:
        """The motion at the precision in use."""
        bits = ctx.prec
        method, steps = Method.of(bits), 0
        boxes: list[Box] = []
        position: Position | None = None
        for stretch in self.stretches:
            position, leg = self.course.enter(stretch, position)
            left, may_widen = MOST_STEPS - steps, not self.is_exact
            path = follow(leg, position.whole, method, left, may_widen=may_widen)
            boxes += path.samples
            steps += path.steps
            if not all(x.is_finite() for box in path.samples for x in box.states):
                raise RefusalError("states have no finite bounds", stretch.end)
            if path.stop is not None:
                return MotionBalls(tuple(boxes), path.stop, bits, steps)
            assert path.whole is not None
            position = Position(path.whole, position.label, position.constant)
        return MotionBalls(tuple(boxes), None, bits, steps)

    # -- comparison --------------------------------------------------------------------------------

    @property
    def every(self) -> tuple[Sample, ...]:
        """All samples, and where it was stopped."""
        return self.samples if self.end is None else (*self.samples, self.end)

    def _extents(self) -> dict[tuple[str, tuple[int, ...]], arb]:
        """The largest size of each group of states, in each set of coordinates."""
        extents: dict[tuple[str, tuple[int, ...]], arb] = {}
        firsts = [
            (segment.label, tuple(segment.stage.first.tolist()), segment.stage.groups)
            for segment in self.solution.trajectory.segments
        ]
        rows = [(sample.label, sample.row, sample.groups) for sample in self.every]
        for label, row, groups in (*rows, *firsts):
            for group in groups:
                for k in group:
                    if k < len(row):
                        size = abs(exact_ball(row[k]))
                        key = label, group
                        extent = extents.get(key, arb(0))
                        extents[key] = extent.max(size) if size.is_finite() else extent
        return extents

    def _known_bits(self, motion: MotionBalls) -> float:
        """How many bits of each group of states are known, at the worst sample."""
        extents = self._extents()
        # A group that is always zero is compared with the largest group; if all are, with one.
        top = max((log2(x) for x in extents.values() if x > 0), default=0.0)
        worst = math.inf
        for sample, (box, columns) in self.pairs(motion):
            for group in sample.groups:
                inside = [k for k in group if k < len(sample.row)]
                largest = extents[sample.label, group]
                extent = log2(largest) if largest > 0 else top
                size = max((log2(box[k].mid()) for k in inside), default=extent)
                size = max(min(size, extent), extent - SMALLER)
                radius = max((log2(box[k].rad()) for k in inside), default=-math.inf)
                worst = min(worst, size - radius)
            worst = min([worst, *(_column_bits(column, sample.groups) for column in columns)])
        if motion.stop is not None:
            time = motion.stop[0]
            worst = min(worst, log2(time) - log2(time.rad()))
        return worst

    def pairs(self, motion: MotionBalls) -> Iterator[tuple[Sample, Box]]:
        """Samples with the boxes of the same moments."""
        yield from zip(self.samples, motion.boxes, strict=False)
        if self.end is not None and motion.stop is not None:
            yield self.end, motion.stop[1]

    @property
    def assumes(self) -> tuple[str, ...]:
        """An assumption of a motion from beside a pole whose values there are not exact."""
        course = self.course
        if not isinstance(course, OdeCourse) or course.start or course.problem.centre is None:
            return ()
        if course.regular is not None:
            return ()
        return ("the start beside the pole is the number of a power series without a bound",)

    def outputs(self, motion: MotionBalls, count: int) -> dict[str, tuple[Any, ...]]:
        """Outputs by name at the last samples, and the time where the motion is stopped."""
        if not isinstance(self.course, OdeCourse):
            return {}
        sign, rows = -1 if self.course.backwards else 1, []
        for sample, (box, _) in list(self.pairs(motion))[-count:]:
            is_end = sample is self.end and motion.stop is not None
            time = motion.stop[0] if is_end and motion.stop else arb(sample.time)
            rows.append(self.course.outputs(sign * time, sample.time, box))
        table = {name: tuple(row[name] for row in rows) for name in (rows[0] if rows else ())}
        time_name = self.solution.problem.time_name
        if motion.stop is not None and time_name not in {*table, *self.course.names("")}:
            table[time_name] = (sign * motion.stop[0],)
        return table

    def gap(self, motion: MotionBalls) -> arb:
        """|result - truth| at the worst sample, each group of states against its largest size.

        It is infinite where only one of both is stopped, or where the result has samples after the
        true end.
        """
        if len(motion.boxes) < len(self.samples):
            # Samples are behind the true end; one may be too near it to be decided.
            assert motion.stop is not None
            behind = arb(self.samples[-1].time) > motion.stop[0]
            return arb.pos_inf() if behind else arb(0).union(arb.pos_inf())
        if (motion.stop is not None) != (self.end is not None):
            return arb.pos_inf()
        worst = arb(0)
        if self.end is not None and motion.stop is not None:
            time = arb(self.end.time)
            worst = abs(time - motion.stop[0]) / time
        extents, undecided = self._extents(), False
        for sample, (box, _) in self.pairs(motion):
            for group in sample.groups:
                inside = [k for k in group if k < len(sample.row)]
                differences = [abs(box[k] - exact_ball(sample.row[k])) for k in inside]
                largest = arb(0)
                for difference in differences:
                    largest = largest.max(difference)
                extent = extents[sample.label, group]
                if extent > 0:
                    worst = worst.max(largest / extent)
                elif largest > 0:
                    return arb.pos_inf()
                elif not largest.is_zero():
                    # Zero in the result: a ball around zero does not decide whether it is.
                    undecided = True
        return worst.union(arb.pos_inf()) if undecided else worst


def _samples_and_stretches(
    problem: Any, segments: Sequence[Segment], sign: int
) -> tuple[list[Sample], list[Stretch]]:
    """The samples of all segments, and stretches of segments with one label."""
    samples, stretches = list[Sample](), list[Stretch]()
    for segment in segments:
        rows = zip(segment.times, _rows(problem, segment, segment.states), strict=True)
        mine = [
            Sample(exact_time(sign * t), segment.label, tuple(row), segment.stage.groups)
            for t, row in rows
        ]
        samples += mine
        begin, end = (exact_time(abs(x)) for x in (segment.stage.begin, segment.run.reached))
        times = tuple(sample.time for sample in mine)
        if stretches and stretches[-1].label == segment.label:
            last = stretches[-1]
            stretches[-1] = replace(last, end=end, samples=last.samples + times)
        else:
            first = tuple(segment.stage.first.tolist())
            stretches.append(Stretch(begin, end, segment.label, times, first))
    return samples, stretches


def _entries(given: Start) -> Sequence[Any]:
    """Numbers and balls that replace others."""
    return () if given is None else tuple(given.values() if isinstance(given, Mapping) else given)


def _is_number(value: Any) -> bool:
    """Whether a value is one number, and not a wider ball."""
    return not isinstance(value, arb) or value.is_exact()


def _column_bits(column: Sequence[arb], groups: Sequence[Sequence[int]]) -> float:
    """How many bits of the derivatives of each group of states are known, at one time.

    A group that is small against all others is measured as if it were larger, as states are.
    """
    top = max(log2(x.mid()) for x in column)
    if top <= FAR_BELOW:
        top = 0.0
    worst = math.inf
    for group in groups:
        inside = [k for k in group if k < len(column)]
        size = max((log2(column[k].mid()) for k in inside), default=top)
        radius = max((log2(column[k].rad()) for k in inside), default=-math.inf)
        worst = min(worst, max(size, top - SMALLER) - radius)
    return worst


def course_of(
    problem: object,
    backwards: bool,
    start: Start,
    parameters: Mapping[str, Any] | None,
    by: tuple[str, ...] = (),
) -> Course:
    """The course of a problem; by: names by which derivatives are taken."""
    if isinstance(problem, ODE):
        if problem.is_switched or len(problem.rates.stops) > 1:
            raise ArgumentError(
                "expected equations that change at fixed times only and have at most one stop, got "
                f"{problem}, which has pieces, tables, conditions with changes, or several stops. "
                "Prove each part by itself, from where the part before it ends."
            )
        start_balls = _start(problem.states, problem.start, start)
        return OdeCourse(problem, backwards, start_balls, dict(parameters or {}), by)
    if isinstance(problem, CurveProblem):
        _check_stops(problem, start, parameters)
        start_balls = _start(problem.coordinates, problem.start or (), start)
        return CurveCourse(problem, backwards, start_balls, dict(parameters or {}), by)
    raise ArgumentError(
        f"expected a solution of an ODE or of a curve, got one of {type(problem).__name__}. "
        "Write the motion as one of these."
    )


def _check_stops(problem: CurveProblem, start: Start, parameters: Mapping[str, Any] | None) -> None:
    """Refuse several conditions to stop, and one whose numbers would be other ones."""
    terms = ", ".join(stop.text for stop in problem.stops)
    if len(problem.stops) > 1 or (problem.stops and (start is not None or parameters)):
        raise ProofError(
            "expected a curve with at most one condition to stop, from its own start and "
            f"parameters, got stop = {terms}. Solve it with one, or without, to the time at which "
            "it stopped."
        )


def _start(names: Sequence[str], known: Sequence[Any], given: Start) -> tuple[Any, ...]:
    """Numbers or balls that replace a start; empty where nothing was given.

    Raises
    ------
    UnknownNameError
        a name is not one of the states.
    ShapeError
        there is not one number for each.
    """
    if given is None:
        return ()
    if isinstance(given, Mapping):
        for name in given:
            checks.known_name(name, names, "start", UnknownNameError, expected="a state")
        return tuple(given.get(name, x) for name, x in zip(names, known, strict=True))
    if len(given) != len(names) or not known:
        raise ShapeError(
            f"start: expected {len(names)} numbers ({', '.join(names)}), got {len(given)}."
        )
    return tuple(given)


def _without_last_sample(stretches: tuple[Stretch, ...]) -> tuple[Stretch, ...]:
    """The stretches with the end as a time to go to, and not as a sample."""
    *first, last = stretches
    samples = last.samples[:-1] if last.samples and last.samples[-1] == last.end else last.samples
    return *first, Stretch(last.begin, last.end, last.label, samples, last.reference)


def _rows(problem: Any, segment: Segment, states: np.ndarray) -> np.ndarray:
    """States of a segment as they are compared."""
    return problem.rows(segment, states, segment.label)

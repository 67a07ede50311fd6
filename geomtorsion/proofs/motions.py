"""Motions: sets followed through times, step by step, with stops and edges."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import NamedTuple

from flint import arb, fmpq

from geomtorsion.codegen import Graph
from geomtorsion.codegen.balls import BallCode
from geomtorsion.errors import ProofError
from geomtorsion.proofs.events import Fall
from geomtorsion.proofs.series import BallSystem
from geomtorsion.proofs.sets import LohnerSet
from geomtorsion.proofs.steps import Method, Step, prove_step
from geomtorsion.proofs.wanted import log2

# A set as large as this part of the motion (in bits) contains no digits of it.
TOO_WIDE = -8.0
# Work that a proof may take: minutes of the double pendulum.
MOST_STEPS = 100_000
# A motion is stiff if this number of steps in a row are shorter by this factor than the time in
# which it changes, and this many times more steps would be needed: minutes without progress.
STIFF = 100
# Steps shorter than this part of the interval lead to a point where the motion ends.
STANDSTILL = 2**50


class RefusalError(ProofError):
    """Why a motion cannot be followed further.

    reason, advice: in words; when: the time of the equations.
    width: of a set for which no step was proved, its logarithm, relative to the motion: more bits
        may help; None where they do not.
    """

    def __init__(
        self, reason: str, when: fmpq, advice: str = "", width: float | None = None
    ) -> None:
        super().__init__(f"{reason} at {float(arb(when)):.6g}. {advice}".rstrip())
        self.reason, self.when, self.advice, self.width = reason, when, advice, width


@dataclass(frozen=True, eq=False)
class Leg:
    """One system over a stretch of time.

    system: its equations; begin, end: times, exact; samples: times in between at which to look.
    fall: the motion stops when this function falls to zero; None: at the end of the time.
    inside: conditions that have to stay positive, with their words.
    """

    system: BallSystem
    begin: fmpq
    end: fmpq
    samples: tuple[fmpq, ...]
    fall: Fall | None = None
    inside: Graph | None = None
    words: tuple[str, ...] = ()


class Box(NamedTuple):
    """Bounds at one time: of the states, and of each column of derivatives."""

    states: list[arb]
    columns: list[list[arb]]

    @classmethod
    def of(cls, whole: LohnerSet) -> Box:
        """The smallest box around a set."""
        return cls(whole.hull, [column.hull for column in whole.columns])


@dataclass(frozen=True, eq=False)
class Followed:
    """Result of one leg.

    samples: boxes at its samples, as many as were reached.
    whole: the set at its end; None where it was stopped.
    stop: time and box of the fall that ended it, or None.
    steps: how many there were.
    """

    samples: list[Box]
    whole: LohnerSet | None
    stop: tuple[arb, Box] | None
    steps: int


def follow(
    leg: Leg,
    whole: LohnerSet,
    method: Method,
    steps_left: int = MOST_STEPS,
    *,
    may_widen: bool = False,
) -> Followed:
    """A set followed through one leg, at the precision in use.

    may_widen: whether a set that is as wide as the motion is followed, as one of wide starts is.

    Raises
    ------
    RefusalError
        the motion ends, reaches the edge of its chart or touches a stop; or the set of motions
        grew too wide for a step.
    """
    boxes: list[Box] = []
    waiting = list(leg.samples)
    time, radius, steps = leg.begin, None, 0
    lengths, slow = list[fmpq](), 0
    while waiting and waiting[0] == time:
        boxes.append(Box.of(whole))
        waiting.pop(0)
    while time < leg.end:
        if steps >= steps_left:
            words = f"more than {MOST_STEPS:,} steps are needed"
            raise RefusalError(words, time, "Prove a shorter motion, or fewer digits.")
        step = _step(leg, whole, method, radius, time)
        radius, steps = step.radius, steps + 1
        if step.length * STANDSTILL < leg.end and step.length < leg.end - time:
            raise RefusalError(
                "steps become ever shorter",
                time,
                (
                    "The motion ends there, or reaches the edge of the domain of a function. "
                    "Prove a shorter motion."
                ),
            )
        lengths = [*lengths[-STIFF:], step.length]
        slow = slow + 1 if STIFF * float(arb(step.length)) < step.own_time else 0
        _check_pace(lengths, slow, leg, time)
        stop = None if leg.fall is None else _stop(leg.fall, step, time)
        last = arb(step.length) if stop is None else stop
        if stop is None:
            _check_inside(leg, step, time)
        while waiting and waiting[0] <= time + step.length:
            here = arb(waiting[0] - time)
            if stop is not None and not here < last:
                break
            boxes.append(Box(step.hull(here), step.columns(here)))
            waiting.pop(0)
        if stop is not None:
            box = Box(step.hull(stop), step.columns(stop))
            return Followed(boxes, None, (arb(time) + stop, box), steps)
        try:
            whole = step.end()
        except ProofError as error:
            raise RefusalError(str(error), time, "", _width(step.whole)) from None
        time += step.length
        if not may_widen:
            _check_width(step, whole, time)
    if waiting:
        # Otherwise boxes would be assigned to the wrong samples.
        raise RefusalError("a sample is outside its part of the motion", time)
    return Followed(boxes, whole, None, steps)


def _check_pace(lengths: Sequence[fmpq], slow: int, leg: Leg, time: fmpq) -> None:
    """Refuse a motion that would need too many steps as short as all of the last ones.

    slow: how many in a row were far shorter than the time in which the motion changes.
    """
    if len(lengths) < STIFF:
        return
    needed = int(float(arb((leg.end - time) / max(lengths))))
    if needed > MOST_STEPS or (slow >= STIFF and needed > STIFF**2):
        raise RefusalError(
            f"after {STIFF} steps as short as these some {needed:,} more would be needed: the "
            "equations are stiff, the edge of a function is near, or the motion is too long",
            time,
            "Prove a shorter motion.",
        )


def _step(leg: Leg, whole: LohnerSet, method: Method, radius: float | None, time: fmpq) -> Step:
    """The next step; a refusal with its time."""
    try:
        return prove_step(leg.system, whole, method, radius, leg.end - time)
    except ProofError as error:
        raise RefusalError(str(error), time, "", _width(whole)) from None


def _width(whole: LohnerSet) -> float:
    """The logarithm of the radius of a set, relative to its largest state."""
    return max(log2(x) for x in whole.radii) - max(log2(x) for x in whole.middle)


def _check_width(step: Step, whole: LohnerSet, time: fmpq) -> None:
    """Refuse a set that contains no digits of its motion."""
    widest = max(log2(r) - size for r, size in zip(whole.radii, step.sizes, strict=True))
    if widest > TOO_WIDE:
        words = "the set of motions has grown to the size of the motion"
        raise RefusalError(
            words, time, "All digits are lost there. Prove a shorter motion.", widest
        )


def _stop(fall: Fall, step: Step, time: fmpq) -> arb | None:
    try:
        return fall.first(step)
    except ProofError as error:
        raise RefusalError(str(error), time, "Move the stop, or the start.") from None


def _check_inside(leg: Leg, step: Step, time: fmpq) -> None:
    """Refuse a step on which a condition of the chart is not proved, by halving it."""
    if leg.inside is None:
        return
    code, parameters = BallCode(leg.inside), leg.system.parameters()

    def positive(box: Sequence[arb]) -> list[bool]:
        return [x > 0 for x in code.real([*box, *parameters])]

    if all(positive(step.tube)):
        return
    waiting = [(arb(0), arb(step.length), 0)]
    while waiting:
        low, high, depth = waiting.pop()
        verdicts = positive(step.hull(low.union(high)))
        if all(verdicts):
            continue
        if depth > 20:
            words = next(x for x, good in zip(leg.words, verdicts, strict=True) if not good)
            words = f"it reaches the edge of its chart ({words})"
            raise RefusalError(words, time, "Prove a shorter motion, or use another chart.")
        middle = ((low + high) / 2).mid()
        waiting += [(middle, high, depth + 1), (low, middle, depth + 1)]

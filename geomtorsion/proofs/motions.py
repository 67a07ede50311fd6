"""Motions: sets followed through times, step by step, with stops and edges."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from flint import arb, fmpq

from geomtorsion.codegen import Graph
from geomtorsion.codegen.balls import BallCode
from geomtorsion.errors import ProofError
from geomtorsion.proofs.events import Fall
from geomtorsion.proofs.series import BallSystem
from geomtorsion.proofs.sets import LohnerSet
from geomtorsion.proofs.steps import Method, Step, prove_step
from geomtorsion.proofs.wanted import log2

# A set of this part of the size of the motion (in bits) holds no digits of it.
TOO_WIDE = -8.0
# Work that a proof may take: minutes of the double pendulum.
MOST_STEPS = 100_000


class WideSetError(ProofError):
    """A set has grown so wide that no step can be proved: more bits may help.

    lost: how many bits are left of the set, below zero; time: where it was.
    """

    def __init__(self, message: str, time: float, lost: float) -> None:
        super().__init__(message, time)
        self.lost = lost


@dataclass(frozen=True, eq=False)
class Leg:
    """One system over a stretch of time.

    system: its equations; begin, end: times, exact; samples: times in between at which to look.
    fall: at whose fall through zero the motion ends, or None.
    inside: conditions that have to stay positive, with their words.
    """

    system: BallSystem
    begin: fmpq
    end: fmpq
    samples: tuple[fmpq, ...]
    fall: Fall | None = None
    inside: Graph | None = None
    words: tuple[str, ...] = ()


@dataclass(frozen=True, eq=False)
class Followed:
    """What one leg gave.

    samples: boxes at its samples, as many as were reached.
    whole: the set at its end; None where it was stopped.
    stop: time and box of the fall that ended it, or None.
    steps: how many there were.
    """

    samples: list[list[arb]]
    whole: LohnerSet | None
    stop: tuple[arb, list[arb]] | None
    steps: int


def follow(leg: Leg, whole: LohnerSet, method: Method, steps_left: int = MOST_STEPS) -> Followed:
    """A set followed through one leg, at the precision in use.

    Raises
    ------
    WideSetError
        the set grew too wide for a step.
    ProofError
        the motion ends, or comes to the edge of its chart, or touches a stop.
    """
    found: list[list[arb]] = []
    waiting = list(leg.samples)
    time, radius, steps = leg.begin, None, 0
    while waiting and waiting[0] == time:
        found.append(whole.hull)
        waiting.pop(0)
    while time < leg.end:
        if steps >= steps_left:
            raise ProofError(
                f"more than {MOST_STEPS:,} steps are needed {at(time)}. Prove a shorter motion, or "
                "fewer digits.",
                as_float(time),
            )
        step = _step(leg, whole, method, radius, time)
        radius, steps = step.radius, steps + 1
        stop = None if leg.fall is None else _stop(leg.fall, step, time)
        last = arb(step.length) if stop is None else stop
        if stop is None:
            _check_inside(leg, step, time)
        while waiting and waiting[0] <= time + step.length:
            here = arb(waiting[0] - time)
            if stop is not None and not here < last:
                break
            found.append(step.hull(here))
            waiting.pop(0)
        if stop is not None:
            return Followed(found, None, (arb(time) + stop, step.hull(stop)), steps)
        whole = step.end()
        time += step.length
        _check_width(step, whole, time)
    return Followed(found, whole, None, steps)


def _step(leg: Leg, whole: LohnerSet, method: Method, radius: float | None, time: fmpq) -> Step:
    """The next step; a refusal with its time."""
    try:
        return prove_step(leg.system, whole, method, radius, leg.end - time)
    except ProofError as error:
        size = max(log2(x) for x in whole.middle)
        width = max(log2(x) for x in whole.radii)
        raise WideSetError(f"{error} {at(time)}", as_float(time), width - size) from None


def _check_width(step: Step, whole: LohnerSet, time: fmpq) -> None:
    """Refuse a set that holds no digits of its motion."""
    widest = max(log2(r) - size for r, size in zip(whole.radii, step.sizes, strict=True))
    if widest > TOO_WIDE:
        message = f"the set of motions has grown to the size of the motion {at(time)}"
        raise WideSetError(message, as_float(time), widest)


def _stop(fall: Fall, step: Step, time: fmpq) -> arb | None:
    try:
        return fall.first(step)
    except ProofError as error:
        raise ProofError(
            f"the motion has no proved end: {error} {at(time)}.", as_float(time)
        ) from None


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
            message = f"the motion comes to the edge of its chart {at(time)}: {words}."
            raise ProofError(message, as_float(time))
        middle = ((low + high) / 2).mid()
        waiting += [(middle, high, depth + 1), (low, middle, depth + 1)]


def as_float(time: fmpq) -> float:
    """A time as a float."""
    return float(time.p) / float(time.q) if time.q < 2**1000 else float(arb(time))


def at(time: fmpq) -> str:
    """A time in messages."""
    return f"at t = {as_float(time):.6g}"

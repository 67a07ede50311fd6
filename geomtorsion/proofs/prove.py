"""Prove: balls that contain the true value of a result, and whether its error holds."""

from __future__ import annotations

import math
import time
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import Any, TypeAlias

import flint
import numpy as np
from flint import arb

from geomtorsion.errors import ArgumentError, ProofError, TimeError, UnknownNameError
from geomtorsion.loops import BurgersVector, Development, HasInterpolant
from geomtorsion.ode import Solution, solution
from geomtorsion.ode.derivatives import derivative_name
from geomtorsion.proofs.arc_integrals import proved_integrals
from geomtorsion.proofs.arguments import (
    checked_balls,
    checked_derivatives,
    checked_start,
    refuse_unknown,
)
from geomtorsion.proofs.developments import proved_development
from geomtorsion.proofs.interpolants import proved_interpolant
from geomtorsion.proofs.packing import WithBalls
from geomtorsion.proofs.solutions import SolutionTask
from geomtorsion.proofs.wanted import Wanted, upper_float
from geomtorsion.support import checks
from geomtorsion.support.caching import cached_property
from geomtorsion.support.displays import drawn_by
from geomtorsion.support.exclusive import exclusive
from geomtorsion.support.precision import EXACT_BITS, ball_precision, series_length

Result: TypeAlias = BurgersVector | Development | Solution | HasInterpolant
ALWAYS = (
    "components that a zero test dropped vanish, with the certainty of that test",
    "floats are exact binary fractions; fractions, text and expressions are exact",
    "FLINT's ball arithmetic is right",
)


@exclusive
@dataclass(frozen=True, eq=False, repr=False)
class Proof(WithBalls):
    """Balls that contain the true value of a result.

    result: the result that was proved.
    balls: the components of a Burgers vector; for a development the components of burgers, then the
        rows of the rotation; for a solution one tuple for each of its times: the states, then their
        derivatives by the first name, by the second, ... `solve(problem, 1.0)` reports 65 times,
        and its error covers all of them; `at(1.0)` has the requested one.
    names: names of the balls, or of the states and derivatives at each time.
    charts: for a solution the chart of its states at each time.
    digits: number of requested digits.
    error: proved bound of |result - truth|, in the measure used for the error of the result.
    holds: True: the result is within its error; False: it is not; None: the balls do not decide.
    bits, steps, seconds: the precision, the steps (arcs of a loop), and the time that it took.
    assumes: assumptions of the proof.
    outputs: outputs of a solution at each of its times; and where a condition stops it, the time.
    start, parameters, derivatives: as given to `prove`.
    """

    result: Result
    balls: tuple[Any, ...]
    names: tuple[Any, ...]
    charts: tuple[str, ...]
    digits: int
    error: float
    holds: bool | None
    bits: int
    steps: int
    seconds: float
    assumes: tuple[str, ...]
    outputs: Mapping[str, tuple[Any, ...]] = field(default_factory=dict)
    start: Any = None
    parameters: Mapping[str, Any] | None = None
    derivatives: tuple[str, ...] = ()

    @cached_property
    def values(self) -> Any:
        """Midpoints as floats: an array of the shape of `balls`, or a tuple of rows.

        Rows differ in length where charts have different numbers of coordinates.
        """
        return self._floats(lambda ball: float(ball.mid()))

    @cached_property
    def radii(self) -> Any:
        """Largest possible distance of the true value from `values`, in the same shape."""
        return self._floats(_radius)

    @cached_property
    def relative_radius(self) -> float:
        """Largest radius of a ball over the largest value, at the time where this is largest."""
        rows = self.balls if isinstance(self.balls[0], tuple) else (self.balls,)
        with ball_precision(self.bits):
            return max(upper_float(_relative(row)) for row in rows)

    def __getitem__(self, name: str) -> Any:
        """The ball of a name; for a solution a tuple of balls, one for each of its times.

        Raises
        ------
        UnknownNameError
            Nothing has this name, or not in the chart at one of the times.
        """
        if name in self.outputs:
            return self.outputs[name]
        if not isinstance(self.balls[0], tuple):
            checks.known_name(name, self.names, "name", UnknownNameError)
            return self.balls[self.names.index(name)]
        return tuple(
            row[checks.known_name(name, names, "name", UnknownNameError) and names.index(name)]
            for names, row in zip(self.names, self.balls, strict=True)
        )

    def at(self, time: object) -> Mapping[str, arb]:
        """The balls at any time of a solution by name, in the chart of the solution there.

        A time between the times of the solution needs a proof of its own, from the start to there.

        Raises
        ------
        TimeError
            The time is outside of the solution, or the proof is about another result.
        ProofError
            Nothing is proved at this time.

        Examples
        --------
        >>> from geomtorsion.ode import ODE, solve
        >>> proof = prove(solve(ODE.of({"x": "v", "v": "-x"}, [1, 0]), [1.0]))
        >>> print(proof.at(0.5)["x"].str(15, radius=False))
        0.877582561890373
        """
        number = checks.real(time)
        if not isinstance(self.result, Solution) or number is None:
            shown = "one number" if isinstance(self.result, Solution) else "a proof of a solution"
            raise TimeError(
                f"time: expected {shown}, got {checks.shown(time)}. Read other proofs by name."
            )
        times = self.result.times.tolist()
        if number in times:
            k = times.index(number)
            return dict(zip(self.names[k], self.balls[k], strict=True))
        between = prove(
            solution.read_at(self.result, number), self.digits, start=self.start,
            parameters=self.parameters, derivatives=self.derivatives,
        )  # fmt: skip
        return dict(zip(between.names[-1], between.balls[-1], strict=True))

    def _floats(self, read: Callable[[arb], float]) -> Any:
        with ball_precision(self.bits):
            if not isinstance(self.balls[0], tuple):
                return np.array([read(ball) for ball in self.balls])
            rows = [np.array([read(ball) for ball in row]) for row in self.balls]
        return np.array(rows) if len({len(row) for row in rows}) == 1 else tuple(rows)

    def lines(self) -> list[str]:
        """Each value with its certain digits, one per line; for a solution at its end."""
        row, names = self.balls, self.names
        if isinstance(row[0], tuple):
            row, names = row[-1], names[-1]
        last = {name: values[-1] for name, values in self.outputs.items()}
        rows = [*zip(names, row, strict=True), *last.items()]
        with ball_precision(self.bits):
            return [f"{name} = {self._text(ball)}" for name, ball in rows]

    def _text(self, ball: Any) -> str:
        """The certain digits of a ball, or of each part of a vector."""
        if isinstance(ball, tuple):
            return f"({', '.join(map(self._text, ball))})"
        return certain_digits(ball, self.digits)

    def to_json(self) -> dict[str, Any]:
        """The proof as a JSON-ready mapping: values with their certain digits, as text."""
        return {
            "values": self.lines(),
            "holds": self.holds,
            "error": self.error,
            "bits": self.bits,
            "steps": self.steps,
            "seconds": self.seconds,
            "assumes": list(self.assumes),
            "text": str(self),
        }

    def __str__(self) -> str:
        verdict = {True: "holds", False: "does NOT hold", None: "is not decided"}[self.holds]
        reported, subject = self._reported
        place = ""
        if isinstance(self.result, Solution):
            place = f" at {self.result.problem.time_name} = {float(self.result.times[-1]):.6g}"
        return "\n".join(
            [
                f"proved{place}, {self.digits} digits, {self.bits} bits, {self.seconds:.3g} s:",
                *(f"  {line}" for line in self.lines()),
                f"  the reported {subject} {reported:.2g} {verdict}: proved {self.error:.2g}",
                *(f"  {text}" for text in self.assumes if text not in ALWAYS),
            ]
        )

    @property
    def _reported(self) -> tuple[float, str]:
        """The error that was judged, and its name."""
        if isinstance(self.result, HasInterpolant):
            return self.result.systematic["quadrature"], "error of the integral"
        return self.result.error, "error"

    __repr__ = __str__
    _repr_html_ = drawn_by("notebook_pictures", "proof_html")


def _relative(row: Sequence[arb]) -> arb:
    """Largest radius over largest value; the radius itself where all values may be zero."""
    radius, size = arb(0), arb(0)
    for ball in row:
        radius, size = radius.max(ball.rad()), size.max(ball.abs_lower())
    return radius / size if size > 0 else radius


def certain_digits(ball: arb, digits: int) -> str:
    """The certain digits of a number, up to a maximal count; else its bounds.

    Examples
    --------
    >>> certain_digits(arb("1.2345678 +/- 1e-5"), 15), certain_digits(arb(0, 1e-9), 15)
    ('1.2346', '0 +- 1.01e-9')
    """
    if ball.is_zero():
        return "0"
    if not abs(ball) > 0:
        # Rounded to three digits it is still a bound.
        bound = abs(ball).upper() * arb(1.006)
        return f"0 +- {bound.str(3, radius=False)}"
    return ball.str(digits, radius=False)


def _radius(ball: arb) -> float:
    """How far anything in a ball is from the float of its midpoint."""
    return upper_float(abs(ball - arb(float(ball.mid()))))


@exclusive
def prove(
    result: Result,
    digits: int = 15,
    *,
    start: Mapping[str, Any] | Sequence[Any] | None = None,
    parameters: Mapping[str, Any] | None = None,
    derivatives: Sequence[str] = (),
) -> Proof:
    """Prove a result: balls that contain the true value, and whether its error holds.

    The numbers are computed again by ball arithmetic (FLINT) from the exact expressions, by routes
    that share nothing with the computation of the result. This takes much longer.

    Parameters
    ----------
    result
        A BurgersVector, a Development, or a Solution: its states at all of its times. The Burgers
        vector of a SampledFrame is proved for its interpolant, polynomials with exact coefficients;
        noise and the field between the nodes are not part of the theorem.
    digits
        How many digits of the largest component, or of each group of states, from 1 to 1000. More
        are used where the reported error could not be judged otherwise.
    start
        For a solution: numbers or balls (flint.arb) instead of its start; a mapping may name
        some of the states or coordinates. The proof is about all motions that start in the balls.
    parameters
        Numbers or balls instead of parameters, name -> value.
    derivatives
        For a solution: names of parameters and of numbers at the start, as for `solve`. The
        derivative of x by k is `proof["dx_dk"]`, over all motions from the balls. It is proved in
        the run of the motion (a C^1 Lohner set), through all charts.

    Raises
    ------
    ProofError
        Nothing is proved: a pole or an edge is on the path, or the motion ends, touches a stop, or
        loses all digits. The message names the time or the point.
    ArgumentError
        The result is of another kind, or digits is out of range.
    UnknownNameError, StartError
        Names of derivatives are unknown, repeated, or refer to a curve that carries vectors.

    Examples
    --------
    How a motion depends on its parameter:

    >>> from geomtorsion.ode import ODE, solve
    >>> growth = solve(ODE.of({"x": "k*x"}, [1], parameters={"k": 2}), [1.0])
    >>> print(prove(growth, 20, derivatives=["k"])["dx_dk"][-1].str(20, radius=False))
    7.3890560989306502272

    A Burgers vector of 3e-24:

    >>> from geomtorsion.loops import Loop, burgers_vector
    >>> from geomtorsion.spaces import load
    >>> b = burgers_vector(load("so3").frame, Loop.circle([0.3, 1, 0.2], 1e-12))
    >>> proof = prove(b)
    >>> print(proof.balls[0].str(15, radius=False), proof.holds)
    3.00127809594327e-24 True
    """
    began = time.perf_counter()
    checks.count(digits, "digits", ArgumentError, 1, 1000)
    changed = checked_balls(parameters, "parameters")
    by = checked_derivatives(result, derivatives)
    start_balls = checked_start(start)
    # The precision of FLINT belongs to the process: no other thread may set it meanwhile.
    with ball_precision(EXACT_BITS), series_length(flint.ctx.cap):
        if isinstance(result, Solution):
            proof = _solution(result, digits, start_balls, changed, by)
        elif start_balls is not None:
            raise ArgumentError("start: expected nothing for a loop, which has none. Drop it.")
        elif changed and isinstance(result, HasInterpolant):
            raise ArgumentError("parameters: expected nothing for data, which have none. Drop it.")
        elif isinstance(result, HasInterpolant):
            proof = _data(result, digits)
        elif isinstance(result, BurgersVector):
            proof = _burgers(result, digits, changed)
        elif isinstance(result, Development):
            proof = _development(result, digits, changed)
        else:
            raise ArgumentError(
                "result: expected a BurgersVector, a Development or a Solution, got "
                f"{type(result).__name__}. For a scene prove result.solution."
            )
    seconds = time.perf_counter() - began
    assumes = ALWAYS
    if start is not None or changed:
        assumes = (*assumes, "start or parameters are in the given balls")
    made = proof(seconds, assumes)
    return replace(made, start=start_balls, parameters=changed or None, derivatives=by)


Made = Callable[[float, tuple[str, ...]], Proof]


def _verdict(gap: arb, error: arb) -> bool | None:
    """Whether a gap is within an error; None where the ball does not decide."""
    if gap <= error:
        return True
    return False if gap > error else None


def _burgers(result: BurgersVector, digits: int, changed: Mapping[str, Any]) -> Made:
    frame = result.frame
    if frame.complex or np.iscomplexobj(result.reduced):
        raise ProofError(
            "expected a real frame, got a complex one, for which integrals are not proved. Use a "
            "real frame."
        )
    refuse_unknown(changed, result.parameters)
    parameters = {**result.parameters, **changed}
    with ball_precision(EXACT_BITS):
        unit = arb(result.size) ** result.power
        value = [arb(x) * unit for x in result.reduced.tolist()]
        error = arb(result.reduced_error) * unit
        size = max((abs(x) for x in value), key=float)
    accuracy = Wanted.of(digits, error, size)
    totals = proved_integrals(frame, result.loop, parameters, accuracy, is_exact=not changed)
    with ball_precision(EXACT_BITS):
        gap = _largest(totals.balls, value)
        bound, holds = upper_float(gap), _verdict(gap, error)
    names = tuple(f"b{k + 1}" for k in range(len(value)))
    return lambda seconds, assumes: Proof(
        result, totals.balls, names, (), digits, bound, holds, totals.bits, totals.arcs, seconds,
        assumes,
    )  # fmt: skip


def _data(result: HasInterpolant, digits: int) -> Made:
    """Burgers vector of the interpolant of a grid."""
    field = result.interpolant
    if field is None:
        raise ProofError(
            "expected b of the values of a grid, got b of a source without an interpolant, such as "
            "an orientation map or a displacement, which is a sum of steps. Use a SampledFrame."
        )
    with ball_precision(EXACT_BITS):
        value = [arb(x) for x in result.vector.tolist()]
        error = arb(result.systematic["quadrature"])
    accuracy = Wanted.of(digits, error, max((abs(x) for x in value), key=float))
    totals = proved_interpolant(field, accuracy)
    with ball_precision(EXACT_BITS):
        gap = _largest(totals.balls, value)
        bound, holds = upper_float(gap), _verdict(gap, error)
    about = (
        f"b belongs to the interpolant of order {field.order} through the values at the nodes; "
        "noise and the field between the nodes are not judged"
    )
    return lambda seconds, assumes: Proof(
        result, totals.balls, result.components, (), digits, bound, holds, totals.bits,
        totals.arcs, seconds, (about, *assumes),
    )  # fmt: skip


def _largest(balls: Sequence[arb], values: Sequence[arb]) -> arb:
    """The largest difference."""
    largest = arb(0)
    for ball, value in zip(balls, values, strict=True):
        largest = largest.max(abs(ball - value))
    return largest


def _development(result: Development, digits: int, changed: Mapping[str, Any]) -> Made:
    connection = result.connection
    if connection.frame.complex or np.iscomplexobj(result.motion.increment):
        raise ProofError(
            "expected a real frame, got a complex one, for which developments are not proved. Use "
            "a real frame."
        )
    refuse_unknown(changed, result.parameters)
    parameters = {**result.parameters, **changed}
    with ball_precision(EXACT_BITS):
        burgers = [arb(x) for x in result.burgers.tolist()]
        turn = [arb(x) for x in result.motion.turn.ravel().tolist()]
        errors = arb(result.error), arb(result.turn_error)
        goals = [
            Wanted.of(digits, error, max((abs(x) for x in row), key=float))
            for row, error in zip((burgers, turn), errors, strict=True)
        ]
    path = proved_development(connection, result.loop, parameters, goals, is_exact=not changed)
    rows = path.rotation
    with ball_precision(EXACT_BITS):
        turned = [x - int(i == j) for i, row in enumerate(rows) for j, x in enumerate(row)]
        gaps = _largest(path.burgers, burgers), _largest(turned, turn)
        bound = upper_float(gaps[0])
        verdicts = [_verdict(gap, error) for gap, error in zip(gaps, errors, strict=True)]
    holds = False if False in verdicts else None if None in verdicts else True
    n = len(burgers)
    names = (
        *(f"b{k + 1}" for k in range(n)),
        *(f"R{i + 1}{j + 1}" for i in range(n) for j in range(n)),
    )
    balls = (*path.burgers, *(x for row in rows for x in row))
    return lambda seconds, assumes: Proof(
        result, balls, names, (), digits, bound, holds, path.bits, path.steps, seconds, assumes
    )


def _solution(
    result: Solution, digits: int, start: Any, changed: Mapping[str, Any], by: tuple[str, ...]
) -> Made:
    refuse_unknown(changed, getattr(result.problem, "parameters", {}))
    task = SolutionTask.of(result, start, changed, by)
    with ball_precision(EXACT_BITS):
        error = arb(result.error) if math.isfinite(result.error) else arb.pos_inf()
        accuracy = Wanted.of(digits, error if error.is_finite() else arb(0), arb(1))
    motion = task.proved(accuracy)
    with ball_precision(motion.bits):
        gap = task.gap(motion)
        bound, holds = upper_float(gap), _verdict(gap, error)
        shown = list(task.pairs(motion))[-len(result.times) :]
        balls = tuple(
            tuple(x for row in (box, *columns) for x in task.course.shown(sample.label, row))
            for sample, (box, columns) in shown
        )
        outputs = task.outputs(motion, len(result.times))
    charts = tuple(sample.label for sample, _ in shown)
    names = tuple(_with_derivatives(task.course.names(label), by) for label in charts)
    more = task.assumes
    return lambda seconds, assumes: Proof(
        result, balls, names, charts, digits, bound, holds, motion.bits, motion.steps, seconds,
        (*more, *assumes), outputs,
    )  # fmt: skip


def _with_derivatives(names: Sequence[str], by: Sequence[str]) -> tuple[str, ...]:
    """Names of states, then of their derivatives."""
    return (*names, *(derivative_name(name, word) for word in by for name in names))

"""Orbits: a proved closed orbit with its start, period, box and multipliers."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, ClassVar

from flint import acb, arb

from geomtorsion.errors import UnknownNameError
from geomtorsion.ode import ODE, Solution, solve
from geomtorsion.proofs.packing import WithBalls
from geomtorsion.proofs.prove import certain_digits
from geomtorsion.support import checks
from geomtorsion.support.caching import cached_property
from geomtorsion.support.displays import Plot, drawn_by, figure_by
from geomtorsion.support.exclusive import exclusive
from geomtorsion.support.precision import ball_precision


@exclusive
@dataclass(frozen=True, eq=False, repr=False)
class ClosedOrbit(WithBalls):
    """Theorem: the box contains the start of exactly one closed orbit.

    problem: the equations, from the middle of the start.
    start: state -> ball of the start of the orbit.
    period: ball of its period T, x(T) = x(0); T may be a multiple of the smallest period.
    box: state -> ball; no other closed orbit of these conditions starts in it, with a period in
        `period_box`.
    growth: state -> by how much it grows in one period, for states that do not return.
    multipliers: Floquet multipliers that are not exactly 1, as complex balls; `trivial` of them are
        exactly 1. Empty where they are not separated.
    stability: "attracting", "repelling", "saddle", "elliptic", "partly elliptic" (pairs on and off
        the unit circle), "neutral" (all multipliers are 1) or "undecided".
    digits, bits, steps, seconds: the requested digits, and what the proof took.
    assumes: assumptions of the proof.
    """

    problem: ODE
    start: Mapping[str, arb]
    period: arb
    box: Mapping[str, arb]
    period_box: arb
    growth: Mapping[str, arb]
    multipliers: tuple[acb, ...]
    trivial: int
    stability: str
    digits: int
    bits: int
    steps: int
    seconds: float
    assumes: tuple[str, ...]

    def __getitem__(self, name: str) -> arb:
        """The ball of a state at the start."""
        return self.start[checks.known_name(name, self.start, "name", UnknownNameError)]

    @cached_property
    def solution(self) -> Solution:
        """The orbit in floats, over one period."""
        return solve(self.problem, float(self.period.mid()))

    def lines(self) -> list[str]:
        """Start, period and multipliers with their certain digits, one per line."""
        with ball_precision(self.bits):
            rows = {**self.start, "period": self.period}
            lines = [f"{name} = {certain_digits(x, self.digits)}" for name, x in rows.items()]
            lines += [
                f"growth of {name} = {certain_digits(x, self.digits)}"
                for name, x in self.growth.items()
            ]
            return [
                *lines,
                *(
                    f"multiplier {k + 1} = {_complex(x, self.digits)}"
                    for k, x in enumerate(self.multipliers)
                ),
            ]

    def to_json(self) -> dict[str, Any]:
        """The theorem as a JSON-ready mapping: values with their certain digits, as text.

        box: the middle and half the side of each, as exact text "mantissa*2^exponent".
        """
        with ball_precision(self.bits):
            box = {**self.box, "period": self.period_box}
            numbers = {
                "start": {name: certain_digits(x, self.digits) for name, x in self.start.items()},
                "period": certain_digits(self.period, self.digits),
                "multipliers": [_complex(x, self.digits) for x in self.multipliers],
                "box": {name: [_exact(x.mid()), _exact(x.rad())] for name, x in box.items()},
            }
        return {
            **numbers,
            "values": self.lines(),
            "stability": self.stability,
            "trivial": self.trivial,
            "bits": self.bits,
            "steps": self.steps,
            "seconds": self.seconds,
            "assumes": list(self.assumes),
            "text": str(self),
        }

    def theorem(self) -> list[str]:
        """The theorem in full: the exact box, and each assumption, one per line."""
        lines = ["exactly one closed orbit starts in the box"]
        with ball_precision(self.bits):
            for name, x in {**self.box, "period": self.period_box}.items():
                half = (x.rad() * arb(1.006)).str(3, radius=False)
                lines.append(f"  {name} = {x.mid().str(self.digits, radius=False)} +- {half}")
        return [*lines, *(f"  assumed: {text}" for text in self.assumes)]

    def __str__(self) -> str:
        radius = max(float(x.rad()) for x in self.box.values())
        cost = f"{self.digits} digits, {self.bits} bits, {self.seconds:.3g} s"
        return "\n".join(
            [
                f"theorem, {cost}: exactly one closed orbit starts within {radius:.2g} of",
                *(f"  {line}" for line in self.lines()),
                f"  {self.trivial} trivial multipliers; {self.stability}",
            ]
        )

    __repr__ = __str__
    _repr_html_ = drawn_by("notebook_pictures", "proof_html")
    plot: ClassVar[Plot] = figure_by("orbits", "draw_closed_orbit")


def _exact(x: arb) -> str:
    """A dyadic number as text."""
    mantissa, exponent = x.man_exp()
    return f"{mantissa}*2^{exponent}"


def _complex(x: acb, digits: int) -> str:
    parts = [certain_digits(part, digits) for part in (x.real, x.imag)]
    return parts[0] if x.imag.is_zero() else f"{parts[0]} + {parts[1]} i"

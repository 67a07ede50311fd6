"""Closed orbits: theorems about their existence, uniqueness in a box, period and stability."""

from __future__ import annotations

import math
import time
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

import flint
import numpy as np
import sympy as sp
from flint import acb, arb, arb_mat

from geomtorsion.errors import ArgumentError, ProofError
from geomtorsion.ode import ODE, Solution, solve
from geomtorsion.proofs.closing import Closing, as_ode, closing_of, real, vanishes
from geomtorsion.proofs.multipliers import Multipliers
from geomtorsion.proofs.prove import ALWAYS, certain_digits
from geomtorsion.proofs.solutions import SolutionTask
from geomtorsion.proofs.wanted import FAR_BELOW, SPARE, Wanted, around_zero, log2, upper
from geomtorsion.support import checks
from geomtorsion.support.caching import cached_property
from geomtorsion.support.copies import only_fields
from geomtorsion.support.exclusive import exclusive
from geomtorsion.support.precision import ball_precision, series_length

# Newton's method takes no more steps than this, and halves a step no more often.
MOST_NEWTON = 40
# Newton's method starts with so many bits, and ends where steps are this part of the orbit; then
# steps with the last slopes take over.
ROUGH, ROUGHLY = 23, 1e-6
# Half sides of the boxes that are tried, in bits below the size of the orbit: from a box in which
# people look for an orbit to one that only rounding fills.
BOXES = (34, 64, 100, 160)


@exclusive
@dataclass(frozen=True, eq=False, repr=False)
class ClosedOrbit:
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

    def __getstate__(self) -> dict[str, object]:
        return {name: _packed(value) for name, value in only_fields(self).items()}

    def __setstate__(self, state: Mapping[str, Any]) -> None:
        for name, value in state.items():
            object.__setattr__(self, name, _unpacked(value))

    def __getitem__(self, name: str) -> arb:
        """The ball of a state at the start."""
        return self.start[checks.known_name(name, self.start, "name", ArgumentError)]

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
            return [*lines, *(f"multiplier {_complex(x)}" for x in self.multipliers)]

    def to_json(self) -> dict[str, Any]:
        """The theorem as a JSON-ready mapping: values with their certain digits, as text."""
        return {
            "values": self.lines(),
            "stability": self.stability,
            "trivial": self.trivial,
            "bits": self.bits,
            "steps": self.steps,
            "seconds": self.seconds,
            "assumes": list(self.assumes),
            "text": str(self),
        }

    def __str__(self) -> str:
        radius = max(float(x.rad()) for x in self.box.values())
        return "\n".join(
            [
                f"theorem, {self.digits} digits, {self.bits} bits, {self.seconds:.3g} s: exactly "
                f"one closed orbit starts within {radius:.2g} of",
                *(f"  {line}" for line in self.lines()),
                f"  {self.trivial} trivial multipliers; {self.stability}",
            ]
        )

    __repr__ = __str__


def _complex(x: acb) -> str:
    digits = 6
    if x.imag.is_zero():
        return certain_digits(x.real, digits)
    return f"{certain_digits(x.real, digits)} + {certain_digits(x.imag, digits)} i"


def _packed(value: Any) -> Any:
    """Balls of FLINT, which cannot be pickled, as exact numbers."""
    if isinstance(value, arb):
        (m, e), (r, s) = value.mid().man_exp(), value.rad().man_exp()
        return _Packed((int(m), int(e), int(r), int(s)))
    if isinstance(value, acb):
        return _Packed((*_packed(value.real), *_packed(value.imag)))
    if isinstance(value, Mapping):
        return {name: _packed(x) for name, x in value.items()}
    if type(value) is tuple:
        return tuple(_packed(x) for x in value)
    return value


class _Packed(tuple[int, ...]):
    """The numbers of one ball."""

    __slots__ = ()


def _unpacked(value: Any) -> Any:
    if isinstance(value, _Packed):
        parts = [arb(value[k : k + 2], value[k + 2 : k + 4]) for k in range(0, len(value), 4)]
        return parts[0] if len(parts) == 1 else acb(*parts)
    if isinstance(value, dict):
        return {name: _unpacked(x) for name, x in value.items()}
    if type(value) is tuple:
        return tuple(_unpacked(x) for x in value)
    return value


@exclusive
def closed_orbit(
    problem: Any,
    period: object,
    *,
    near: Mapping[str, Any] | Sequence[Any] | None = None,
    section: Any = None,
    symmetry: Mapping[str, Any] | Sequence[str] | None = None,
    conserved: Mapping[str, Any] | Sequence[Any] = (),
    shift: Mapping[str, Any] | None = None,
    digits: int = 15,
) -> ClosedOrbit:
    """Find a closed orbit from a rough guess, and prove that it exists.

    Newton's method finds it to any number of digits. Krawczyk's operator proves that the box holds
    exactly one [Krawczyk 1969]; interval Newton then encloses its start, period and multipliers.

    Equation
    --------
    x(T) = x(0) + shift; with a symmetry R, R x(0) = x(0) and R x(T/2) = x(T/2)

    Parameters
    ----------
    problem
        An ODE without the time in its rates, or a geodesic, autoparallel or constrained motion,
        which is written in its home chart.
    period
        Rough guess of the period T > 0.
    near
        Rough guess of the start, as for `ODE.with_start`; None: the start of the problem. States of
        a curve are its coordinates and u1, u2, ...
    section
        Expression (or When) that vanishes at the start, which chooses one point of the orbit; a
        list of several. None: the plane through `near` across the motion.
    symmetry
        States that change their sign where the motion is reversed in time, or state -> value of
        its mirror. The orbit starts and half-ends on the mirror; only half of it is followed.
    conserved
        Names of invariants, or expressions, which keep the value that they have at `near`; or
        expression -> value. Closed orbits come in families where something is conserved: each such
        quantity needs a value, or a section instead where there is a symmetry.
    shift
        State -> number by which it grows in one period, such as 2*pi for an angle; None for a
        state on which nothing depends and which need not return.
    digits
        How many digits of the start and the period, from 1 to 1000.

    Raises
    ------
    ProofError
        Newton's method finds no orbit, it is an equilibrium, its section is not transversal, a
        conserved quantity is missing, or no box is proved.
    ArgumentError, UnknownNameError, ExpressionError
        An argument is of another kind, names something unknown, or does not hold exactly.

    Examples
    --------
    The limit cycle x^2 + y^2 = 1 of a rotation with damping:

    >>> from geomtorsion.ode import ODE
    >>> cycle = ODE.of({"x": "x*(1-x**2-y**2)-y", "y": "y*(1-x**2-y**2)+x"}, [1.1, 0])
    >>> orbit = closed_orbit(cycle, 6.2, section="y", digits=20)
    >>> print(orbit["x"].str(15, radius=False), orbit.period.str(18, radius=False))
    1.00000000000000 6.28318530717958648
    >>> print(orbit.stability, orbit.multipliers[0].real.str(10, radius=False))
    attracting 3.487342356e-6
    """
    began = time.perf_counter()
    checks.count(digits, "digits", ArgumentError, 1, 1000)
    guess = checks.real(period)
    if guess is None or not 0 < guess < math.inf:
        raise ArgumentError(
            f"period: expected a number above zero, got {checks.shown(period)}. Give a rough guess."
        )
    equations = as_ode(problem)
    if near is not None:
        equations = equations.with_start(near)
    closing = closing_of(equations, equations.start, section, symmetry, conserved, shift)
    with ball_precision(53), series_length(flint.ctx.cap):
        orbit = _Search.of(closing, guess, digits).proved()
    return replace(orbit, seconds=time.perf_counter() - began)


@dataclass(frozen=True, eq=False)
class _Image:
    """What the unknowns give: the end of the motion, gaps of the conditions, columns of the end."""

    end: list[arb]
    gaps: list[arb]
    columns: Mapping[str, list[arb]]
    bits: int
    steps: int


@dataclass(frozen=True, eq=False)
class _Search:
    """Search for a closed orbit, and its proof.

    solution: in floats, from the guess; first: the guess; sizes: of the unknowns.
    """

    closing: Closing
    solution: Solution
    first: tuple[arb, ...]
    sizes: tuple[float, ...]
    digits: int

    @classmethod
    def of(cls, closing: Closing, guess: float, digits: int) -> _Search:
        """From a guess of the period; the start is in the problem."""
        scaled = closing.scaled.with_start(parameters={closing.period_name: guess})
        solution = solve(scaled, [1.0], 1e-6)
        path = solve(scaled, 1.0, 1e-6)
        extents = {x: float(np.abs(path[x]).max()) or 1.0 for x in closing.states}
        known = dict(zip(closing.states, closing.near, strict=True))
        first = [arb(sp.Rational(known[x]).p) / sp.Rational(known[x]).q for x in closing.free]
        first.append(arb(guess))
        count = len(closing.multiplier_names)
        sizes = [*(extents[x] for x in closing.free), guess, *[1.0] * count]
        return cls(closing, solution, (*first, *[arb(0)] * count), tuple(sizes), digits)

    def image(self, unknown: Sequence[arb], bits: int, by: Sequence[str] = ()) -> _Image:
        """The end of the motion from a start, with derivatives by some names."""
        closing = self.closing
        start, parameters = closing.start(unknown), closing.parameters(unknown)
        task = SolutionTask.of(self.solution, start, parameters, tuple(by))
        # The enclosures of the theorem tell how many bits are known.
        task = replace(task, is_exact=False)
        motion = task.proved(Wanted(bits, arb(0)))
        with ball_precision(motion.bits):
            end, columns = motion.boxes[-1]
            size = len(closing.states)
            table = {name: row[:size] for name, row in zip(by, columns, strict=True)}
            gaps = closing.gaps(unknown, end[:size])
        return _Image(end[:size], gaps, table, motion.bits, motion.steps)

    # -- Newton's method -------------------------------------------------------------------------

    def _newton(self) -> tuple[list[arb], arb_mat]:
        """The unknowns as exact numbers, to half of the digits of floats; and an inverse slope."""
        unknown, names = [x.mid() for x in self.first], self.closing.unknowns
        here = self._tried(unknown, names)
        if here is None:
            raise ProofError(
                "the motion from the guess is not followed over the guessed period. Give another "
                "start or period."
            )
        for _ in range(MOST_NEWTON):
            image, inverse, step = here
            change = self._size(step)
            if change < ROUGHLY:
                return [(x - y).mid() for x, y in zip(unknown, step, strict=True)], inverse
            share, after = 1.0, None
            for _ in range(MOST_NEWTON):
                tried = [(x - share * y).mid() for x, y in zip(unknown, step, strict=True)]
                after = self._tried(tried, names) if tried[len(self.closing.free)] > 0 else None
                # The natural monotonicity test [Deuflhard 2004].
                if after is not None:
                    gaps = arb_mat([[x] for x in after[0].gaps])
                    if self._size(_column(inverse * gaps)) < (1 - share / 4) * change:
                        break
                share, after = share / 2, None
                if share < 2.0**-12:
                    break
            if after is None:
                break
            unknown, here = tried, after
        raise ProofError(
            "Newton's method finds no closed orbit near the guess. Give a better start or period, "
            "or another section."
        )

    def _tried(
        self, unknown: Sequence[arb], names: Sequence[str]
    ) -> tuple[_Image, arb_mat, list[arb]] | None:
        """The image of a guess, the inverse of the slopes there, and Newton's step."""
        try:
            image = self.image(unknown, ROUGH, names)
        except ProofError:
            return None
        slopes = self.closing.slopes(unknown, image.columns)
        middle = arb_mat([[x.mid() for x in row] for row in slopes.tolist()])
        try:
            inverse = middle.inv()
        except ZeroDivisionError:
            raise self._singular() from None
        exact = arb_mat([[x.mid() for x in row] for row in inverse.tolist()])
        return image, exact, _column(exact * arb_mat([[x.mid()] for x in image.gaps]))

    def _size(self, step: Sequence[arb]) -> float:
        """The largest part of a step, in units of the unknowns."""
        return max(
            abs(float(x.mid())) / size for x, size in zip(step, self.sizes, strict=True)
        )

    def _singular(self) -> ProofError:
        """Why the conditions do not determine one orbit."""
        return ProofError(
            "the conditions do not determine one orbit: their derivative is singular. Closed orbits "
            "come in a family there: name what is conserved in conserved=[...], give a symmetry or "
            "another section; or the motion is at rest, or along the section."
        )

    def _polished(self, unknown: list[arb], inverse: arb_mat, bits: int) -> tuple[list[arb], _Image]:
        """The unknowns to a number of bits, by steps with one slope, and their image."""
        before = math.inf
        while True:
            image = self.image(unknown, bits)
            with ball_precision(image.bits):
                step = _column(inverse * arb_mat([[x] for x in image.gaps]))
                change = max(
                    log2(x.mid()) - math.log2(size)
                    for x, size in zip(step, self.sizes, strict=True)
                )
                if change < 4 - bits or change > before - 1:
                    return unknown, image
                before = change
                unknown = [(x - y).mid() for x, y in zip(unknown, step, strict=True)]

    # -- the theorem -----------------------------------------------------------------------------

    def proved(self) -> ClosedOrbit:
        """The theorem.

        Raises
        ------
        ProofError
            Nothing is found or proved.
        """
        unknown, inverse = self._newton()
        self._refuse_rest(unknown)
        wanted = math.ceil(self.digits * math.log2(10)) + 1
        unknown, box, slopes = self._box(unknown, inverse)
        bits = wanted + 8
        while True:
            unknown, image = self._polished(unknown, inverse, bits)
            with ball_precision(image.bits):
                enclosed = _enclosed(unknown, slopes, image.gaps, inverse)
                pairs = zip(enclosed, self.sizes, strict=True)
                known = min(math.log2(size) - log2(x.rad()) for x, size in pairs)
            if known >= wanted:
                return self._theorem(enclosed, box, bits)
            if bits > 4 * wanted + 200:
                raise ProofError(
                    f"expected {self.digits} digits, got {int(known / math.log2(10))}. Request "
                    "fewer digits."
                )
            bits += math.ceil(wanted - known) + 4

    def _refuse_rest(self, unknown: Sequence[arb]) -> None:
        """Refuse an equilibrium, which is closed with any period."""
        image = self.image(unknown, ROUGH, (self.closing.period_name,))
        column = image.columns[self.closing.period_name]
        time = self.sizes[len(self.closing.free)]
        sizes = dict(zip(self.closing.free, self.sizes, strict=False))
        moving = max(
            abs(float(x.mid())) * time / sizes.get(name, 1.0)
            for name, x in zip(self.closing.states, column, strict=True)
        )
        if moving < ROUGHLY:
            raise ProofError(
                "Newton's method found an equilibrium instead of a closed orbit. Give a start "
                "further from it."
            )

    def _box(
        self, unknown: list[arb], inverse: arb_mat
    ) -> tuple[list[arb], list[arb], arb_mat]:
        """A box in which exactly one orbit starts, its middle, and the slopes over it."""
        reason = ""
        for small in BOXES:
            try:
                unknown, image = self._polished(unknown, inverse, small + SPARE)
                # Exactly these balls, without rounding, are the box of the theorem.
                box = [arb(x, size * 2.0**-small) for x, size in zip(unknown, self.sizes)]
                wide = self.image(box, small, self.closing.unknowns)
            except ProofError as error:
                reason = str(error)
                continue
            with ball_precision(image.bits):
                slopes = self.closing.slopes(box, wide.columns)
                if _is_krawczyk(slopes, inverse, image.gaps, [arb(x.rad()) for x in box]):
                    return unknown, box, slopes
            reason = "Krawczyk's operator does not map any box into itself"
        raise ProofError(
            f"no box is proved to contain one closed orbit, from 2^-{BOXES[0]} to 2^-{BOXES[-1]} of "
            f"its size: {reason.rstrip('.')}. {self._singular()}"
        )

    def _theorem(self, enclosed: list[arb], box: list[arb], bits: int) -> ClosedOrbit:
        """The theorem from an enclosure of the unknowns."""
        closing, n = self.closing, len(self.closing.free)
        # Multipliers of conserved quantities vanish on closed orbits.
        exact = [*enclosed[: n + 1], *[arb(0)] * len(closing.multiplier_names)]
        names = closing.closed
        last = self.image(exact, min(bits, 64), names)
        places = [closing.states.index(x) for x in names]
        with ball_precision(last.bits):
            half = arb_mat([[last.columns[y][k] for y in names] for k in places])
            monodromy = half
            if closing.mirrored:
                signs = [-1 if x in closing.mirrored else 1 for x in names]
                turn = arb_mat([[s * int(i == j) for j in range(len(signs))]
                                for i, s in enumerate(signs)])  # fmt: skip
                monodromy = turn * half.inv() * turn * half
            trivial = 1 + len(closing.conserved)
            paired = bool(closing.mirrored) or (
                len(names) - trivial == 2 and _keeps_volume(closing.problem, names)
            )
            multipliers = Multipliers.of(monodromy, trivial, paired=paired)
            values = [_ball(x) for x in closing.start(enclosed)]
            growth = {
                name: (last.end[k] - values[k]) * (2 if closing.mirrored else 1)
                for k, name in enumerate(closing.states)
                if name in closing.shift
            }
        middle = {x: float(y.mid()) for x, y in zip(closing.states, values, strict=True)}
        return ClosedOrbit(
            closing.problem.with_start(middle), dict(zip(closing.states, values, strict=True)),
            enclosed[n], dict(zip(closing.free, box, strict=False)), box[n], growth,
            multipliers.balls, multipliers.trivial, multipliers.stability, self.digits, bits + SPARE,
            last.steps, 0.0, ALWAYS,
        )  # fmt: skip


def _ball(x: Any) -> arb:
    from geomtorsion.codegen.balls import exact_ball
    return exact_ball(x)


def _column(matrix: arb_mat) -> list[arb]:
    return [matrix[i, 0] for i in range(matrix.nrows())]


def _is_krawczyk(
    slopes: arb_mat, inverse: arb_mat, gaps: Sequence[arb], radii: Sequence[arb]
) -> bool:
    """Whether m - Y F(m) + (1 - Y F'(box)) (box - m) is inside the box around m."""
    step = inverse * arb_mat([[x] for x in gaps])
    rest = inverse * slopes
    n = len(radii)
    for i in range(n):
        reach = upper(step[i, 0])
        for j in range(n):
            reach = reach + upper(int(i == j) - rest[i, j]) * radii[j]
        if not reach < radii[i]:
            return False
    return True


def _enclosed(
    unknown: Sequence[arb], slopes: arb_mat, gaps: Sequence[arb], inverse: arb_mat
) -> list[arb]:
    """m - F'(box)^-1 F(m), which contains the zero in the box."""
    step = (inverse * slopes).solve(inverse * arb_mat([[x] for x in gaps]))
    return [x - y for x, y in zip(unknown, _column(step), strict=True)]


def _keeps_volume(problem: ODE, names: Sequence[str]) -> bool:
    """Whether the divergence of the rates of some states vanishes."""
    rates = problem.rates.expressions
    return vanishes(sp.Add(*(sp.diff(rates[x], real(x)) for x in names)))

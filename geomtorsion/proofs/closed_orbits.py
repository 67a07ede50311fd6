"""Closed orbits: theorems about their existence, uniqueness in a box, period and stability."""

from __future__ import annotations

import math
import time
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any, TypeAlias

import flint
import numpy as np
from flint import arb, arb_mat

from geomtorsion.codegen.balls import exact_ball
from geomtorsion.errors import ArgumentError, ProofError
from geomtorsion.ode import Solution, solve
from geomtorsion.proofs.closing import Closing, as_ode, closing_of, density_of
from geomtorsion.proofs.multipliers import Multipliers
from geomtorsion.proofs.orbits import ClosedOrbit
from geomtorsion.proofs.prove import ALWAYS
from geomtorsion.proofs.solutions import SolutionTask
from geomtorsion.proofs.wanted import SPARE, Wanted, log2, upper
from geomtorsion.support import checks
from geomtorsion.support.exclusive import exclusive
from geomtorsion.support.precision import ball_precision, series_length

# Newton's method takes no more steps than this, and halves a step no more often.
MOST_NEWTON = 20
# Bits with which Newton's method begins; it ends three bits above rounding, and steps with the last
# slopes follow.
ROUGH = 23
ROUGHLY = 2.0 ** (3 - ROUGH)
# Half sides of the boxes that are tried, in bits below the size of the orbit: from a box in which
# people look for an orbit to one that only rounding fills.
BOXES = (34, 64, 100, 160)


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
        Rough guess of the period T > 0; the search covers half of it to twice it.
    near
        Rough guess of the start, as for `ODE.with_start`; None: the start of the problem. States of
        a curve are its coordinates and u1, u2, ...
    section
        Expression (or When) that vanishes at the start, which chooses one point of the orbit; a
        list of several. None: the plane through `near` across the motion.
    symmetry
        States that change sign under time reversal, or state -> value of its mirror. The orbit
        starts on the mirror and returns to it after half a period; only this half is computed.
    conserved
        Names of invariants, or expressions, which keep the value that they have at `near`; or
        expression -> value. Closed orbits come in families where something is conserved: each such
        quantity needs a value, or a section instead where there is a symmetry.
    shift
        State -> number by which it grows in one period, such as 2*pi for an angle; None for a state
        that need not return because no rate depends on it.
    digits
        Number of digits of the start and the period, from 1 to 1000.

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
    closing = replace(closing, density=density_of(problem))
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


# An image, the inverse of the slopes there, and Newton's step.
_Trial: TypeAlias = tuple[_Image, arb_mat, list[arb]]


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
        first = [exact_ball(known[x]).mid() for x in closing.free]
        first.append(arb(guess))
        count = len(closing.multiplier_names)
        sizes = [*(extents[x] for x in closing.free), guess, *[1.0] * count]
        return cls(closing, solution, (*first, *[arb(0)] * count), tuple(sizes), digits)

    def image(self, unknown: Sequence[arb], bits: int, by: Sequence[str] = ()) -> _Image:
        """The end of the motion from a start, with derivatives by some names."""
        closing = self.closing
        start, parameters = closing.start(unknown), closing.parameters(unknown)
        task = SolutionTask.of(self.solution, start, parameters, tuple(by))
        # How many bits are known follows from the enclosures of the theorem.
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
                "the motion from the guess cannot be followed over the guessed period. Give "
                "another start or period."
            )
        for _ in range(MOST_NEWTON):
            _, inverse, step = here
            change = self._size(step)
            if change < ROUGHLY:
                return [(x - y).mid() for x, y in zip(unknown, step, strict=True)], inverse
            next_one = self._damped(unknown, here, names)
            if next_one is None:
                break
            unknown, here = next_one
        raise ProofError(
            "Newton's method finds no closed orbit near the guess. Give a better start or period, "
            "or another section; where orbits come in a family, list what stays constant in "
            "conserved=[...]."
        )

    def _damped(
        self, unknown: Sequence[arb], here: _Trial, names: Sequence[str]
    ) -> tuple[list[arb], _Trial] | None:
        """The longest of some halved steps that comes nearer, and its image; None without one."""
        _, inverse, step = here
        change, share = self._size(step), 1.0
        for _ in range(MOST_NEWTON):
            tried = [(x - share * y).mid() for x, y in zip(unknown, step, strict=True)]
            place = len(self.closing.free)
            # The guess of the period is at least so good.
            is_near = self.first[place] < 2 * tried[place] < 4 * self.first[place]
            after = self._tried(tried, names) if is_near else None
            # The natural monotonicity test [Deuflhard 2004].
            if after is not None:
                gaps = arb_mat([[x] for x in after[0].gaps])
                if self._size(_column(inverse * gaps)) < (1 - share / 4) * change:
                    return tried, after
            share = share / 2
        return None

    def _tried(self, unknown: Sequence[arb], names: Sequence[str]) -> _Trial | None:
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
        return max(abs(float(x.mid())) / size for x, size in zip(step, self.sizes, strict=True))

    def _singular(self) -> ProofError:
        """Why the conditions do not determine one orbit."""
        return ProofError(
            "the conditions do not determine one orbit: their derivative is singular. Where closed "
            "orbits come in a family, list what stays constant in conserved=[...], give a symmetry "
            "or another section; the motion may also be at rest, or along the section."
        )

    def _polished(
        self, unknown: list[arb], inverse: arb_mat, bits: int
    ) -> tuple[list[arb], _Image]:
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
                "further from it; where orbits come in a family, list what stays constant in "
                "conserved=[...]."
            )

    def _box(self, unknown: list[arb], inverse: arb_mat) -> tuple[list[arb], list[arb], arb_mat]:
        """A box in which exactly one orbit starts, its middle, and the slopes over it."""
        reason, before = "", arb.pos_inf()
        for small in BOXES:
            try:
                unknown, image = self._polished(unknown, inverse, small + SPARE)
                # Exactly these balls, without rounding, are the box of the theorem.
                box = [
                    arb(x, size * 2.0**-small) for x, size in zip(unknown, self.sizes, strict=True)
                ]
                wide = self.image(box, small, self.closing.unknowns)
            except ProofError as error:
                reason = str(error)
                continue
            with ball_precision(image.bits):
                slopes = self.closing.slopes(box, wide.columns)
                radii = [arb(x.rad()) for x in box]
                size = _contraction(slopes, inverse, image.gaps, radii)
            if size < 1:
                return unknown, box, slopes
            reason = "Krawczyk's operator does not map any box into itself"
            if not size < before / 2:
                # Where slopes are singular, smaller boxes do not help.
                break
            before = size
        raise ProofError(
            f"no box is proved to contain one closed orbit: {reason.rstrip('.')}. "
            f"{self._singular()}"
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
            paired = bool(closing.mirrored) or (len(names) - trivial == 2 and closing.keeps_volume)
            multipliers = Multipliers.of(monodromy, trivial, paired=paired)
            values = [exact_ball(x) for x in closing.start(enclosed)]
            growth = {
                name: (last.end[k] - values[k]) * (2 if closing.mirrored else 1)
                for k, name in enumerate(closing.states)
                if name in closing.shift
            }
        middle = {x: float(y.mid()) for x, y in zip(closing.states, values, strict=True)}
        return ClosedOrbit(
            closing.problem.with_start(middle), dict(zip(closing.states, values, strict=True)),
            enclosed[n], dict(zip(closing.free, box, strict=False)), box[n], growth,
            multipliers.balls, multipliers.trivial, multipliers.stability, self.digits,
            bits + SPARE, last.steps, 0.0, ALWAYS,
        )  # fmt: skip


def _column(matrix: arb_mat) -> list[arb]:
    return [matrix[i, 0] for i in range(matrix.nrows())]


def _contraction(
    slopes: arb_mat, inverse: arb_mat, gaps: Sequence[arb], radii: Sequence[arb]
) -> arb:
    """How large m - Y F(m) + (1 - Y F'(box)) (box - m) is in units of the box around m."""
    step = inverse * arb_mat([[x] for x in gaps])
    rest = inverse * slopes
    n, largest = len(radii), arb(0)
    for i in range(n):
        reach = upper(step[i, 0])
        for j in range(n):
            reach = reach + upper(int(i == j) - rest[i, j]) * radii[j]
        largest = largest.max(reach / radii[i])
    return largest.upper()


def _enclosed(
    unknown: Sequence[arb], slopes: arb_mat, gaps: Sequence[arb], inverse: arb_mat
) -> list[arb]:
    """m - F'(box)^-1 F(m), which contains the zero in the box."""
    step = (inverse * slopes).solve(inverse * arb_mat([[x] for x in gaps]))
    return [x - y for x, y in zip(unknown, _column(step), strict=True)]

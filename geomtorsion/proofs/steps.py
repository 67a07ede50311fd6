"""Steps: one proved step of a motion, from a Taylor polynomial and a bound of its defect.

From an exact point m: the polynomial P of order N has the defect d = f(P) - P' with a zero of order
N at t = 0. Where |d| <= M on |t| <= R, Schwarz's lemma gives |d(t)| <= M (|t| / R)^N, so that
|x(t) - P(t)| <= exp(L |t|) (rho + M R / (N + 1) (|t| / R)^(N + 1)), state by state, for all starts
within rho of m, as long as |J| <= L on a tube around P that x does not leave. Everything holds for
complex t, and so bounds the coefficients of V' = J V by Cauchy's estimate.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

from flint import acb, arb, arb_mat, ctx, fmpq

from geomtorsion.errors import ProofError
from geomtorsion.proofs.series import (
    BallSystem,
    Rows,
    Slopes,
    polynomial,
    slopes_along,
    taylor,
    variation,
)
from geomtorsion.proofs.sets import FURTHEST, LOW_BITS, LohnerSet, times
from geomtorsion.proofs.wanted import FAR_BELOW, SHARPER, around_zero, log2, upper
from geomtorsion.support.allowance import check_limits
from geomtorsion.support.caching import cached_property
from geomtorsion.support.precision import ball_precision

# A state smaller than the largest by more bits than this counts as smaller by only these bits.
SMALLER = 30
# The radius of the disk is changed by SHRINK until a step gets no longer. If no step is proved,
# radius and step are changed by its third power, at most MOST_TRIES times.
SHRINK, MOST_TRIES = 0.87, 100
# Bits to which the derivative V is computed, and the highest order of its series.
VARIATION_BITS, HIGHEST_VARIATION = 16, 24
# Largest number of times that a tube is widened to its own image.
MOST_TUBES = 3
# Terms of the series are no larger than the states times 2 to this power: larger ones would cancel.
TERMS = 3


@dataclass(frozen=True)
class Method:
    """How steps are made.

    order: of the polynomial, N; block: coefficients that are computed together.
    variation_bits: about how many bits of the derivative V are known.
    """

    order: int
    block: int
    variation_bits: int = VARIATION_BITS

    @classmethod
    def of(cls, bits: int) -> Method:
        """The method for a precision: each order adds a few bits to a step."""
        order = max(16, int(bits / 2.5))
        return cls(order, max(4, min(12, order // 4)))


@dataclass(frozen=True, eq=False, kw_only=True)
class Step:
    """A proved step from a set, valid for |t| <= length.

    system, whole: the equations, and the set from which the step starts.
    coefficients: of P, by order, for each state.
    length: exact; remainder: bounds of |x(t) - P(t)| from m itself for |t| <= length.
    tube: a box around all motions from the set for |t| <= length.
    outer: the radius of the disk in which growth bounds |V|; growth: exp(L outer).
    variation_order: of the polynomial for V; column_order: of those for derivatives by the start of
        the motion, or 0; block: coefficients that are computed together; bits: the precision.
    radius: of the disk used, with which the next step begins.
    sizes: logarithms of the sizes of the states.
    own_time: about the time in which a state changes by its own size, the shortest of all.
    """

    system: BallSystem
    whole: LohnerSet
    coefficients: Rows
    length: fmpq
    remainder: tuple[arb, ...]
    tube: tuple[arb, ...]
    outer: arb
    growth: arb_mat
    variation_order: int
    column_order: int
    block: int
    bits: int
    radius: float
    sizes: tuple[float, ...]
    own_time: float

    @cached_property
    def _variations(self) -> list[arb_mat]:
        """Coefficients of V over all starts of the set."""
        order = self.variation_order
        if self.whole.columns and order <= self.column_order:
            slopes = self._slopes
        else:
            _, slopes = taylor(self.system, self.whole.hull, order, order)
        n = self.system.size
        unit = arb_mat([[int(i == j) for j in range(n)] for i in range(n)])
        return variation(slopes, unit, order)

    def variation(self, time: arb) -> arb_mat:
        """The derivative of x(time) by the start, over the whole set; |time| <= length."""
        with ball_precision(LOW_BITS):
            share = upper(time) / self.outer
            tail = variation_tail(share, self.variation_order)
            total = polynomial(self._variations, time)
            n = self.system.size
            rest = [
                [around_zero(upper(self.growth[i, j]) * tail) for j in range(n)] for i in range(n)
            ]
            return total + arb_mat(rest)

    @cached_property
    def _slopes(self) -> Slopes:
        """Coefficients of J over all starts of the set, for the columns and for V."""
        with ball_precision(self.bits):
            rows, _ = taylor(self.system, self.whole.hull, self.column_order, self.block)
            return slopes_along(self.system, rows, self.column_order)

    @cached_property
    def _carried(self) -> list[arb_mat]:
        """Coefficients of V W over all starts of the set, W the middles of the columns."""
        columns = [column.middle for column in self.whole.columns]
        start = arb_mat([list(row) for row in zip(*columns, strict=True)])
        return variation(self._slopes, start, self.column_order)

    def _column_middles(self, time: arb) -> list[list[arb]]:
        """V(time) w for the middle w of each column, over the whole set."""
        if not self.whole.columns:
            return []
        with ball_precision(LOW_BITS):
            tail = variation_tail(upper(time) / self.outer, self.column_order)
            bound = self.growth * tail
            rests = [
                times(bound, [upper(x) for x in column.middle]) for column in self.whole.columns
            ]
        total = polynomial(self._carried, time)
        return [
            [total[i, k] + around_zero(x) for i, x in enumerate(rest)]
            for k, rest in enumerate(rests)
        ]

    def columns(self, time: arb) -> list[list[arb]]:
        """Boxes around the derivatives of x(time) by numbers at the start of the motion."""
        middles = self._column_middles(time)
        slopes = self.variation(time)
        pairs = zip(self.whole.columns, middles, strict=True)
        return [column.image(values, slopes) for column, values in pairs]

    def middle(self, time: arb) -> list[arb]:
        """x(time) from m itself; |time| <= length."""
        rows = zip(self.coefficients, self.remainder, strict=True)
        return [polynomial(row, time) + around_zero(rest) for row, rest in rows]

    def hull(self, time: arb) -> list[arb]:
        """A box around x(time) of all motions from the set; time may be a ball."""
        return self.whole.image(self.middle(time), self.variation(time))

    def end(self) -> LohnerSet:
        """The set at the end of the step."""
        time = arb(self.length)
        middles = self._column_middles(time)
        return self.whole.moved(self.middle(time), self.variation(time), self.sizes, middles)


def variation_tail(share: arb, order: int) -> arb:
    """sum of share^k over k > order: Cauchy's bound for the remainder of the series of V."""
    return (share ** (order + 1) / (1 - share)).upper()


@dataclass(frozen=True, eq=False)
class Disk:
    """A disk |t| <= radius on which f(P) is analytic, with bounds M of the defect on it."""

    radius: float
    defect: tuple[arb, ...]
    longest: float

    def remainder(self, time: arb, order: int) -> list[arb]:
        """Bounds of the integral of the defect: M R / (N + 1) (t / R)^(N + 1)."""
        return defect_integral(self.defect, arb(self.radius), time, order)


def defect_integral(defect: Sequence[arb], radius: arb, time: arb, order: int) -> list[arb]:
    """Bounds of the integral of a defect with a zero of an order, bounded on a disk."""
    share = (time / radius) ** (order + 1)
    return [(bound * radius / (order + 1) * share).upper() for bound in defect]


class Stepper:
    """Search for the longest step that can be proved from a set; its state belongs to one step."""

    def __init__(self, system: BallSystem, whole: LohnerSet, method: Method, bits: int) -> None:
        self.system, self.whole, self.method = system, whole, method
        self.coefficients, _ = taylor(system, whole.middle, method.order, method.block)
        with ball_precision(LOW_BITS):
            sizes = [[upper(x) for x in row] for row in self.coefficients]
            if not all(x.is_finite() for row in sizes for x in row):
                edge = system.edge_near(whole.middle)
                raise ProofError(f"the rates have no power series{edge and f': {edge} there'}")
            self._table = arb_mat([row[1:] for row in sizes])
            self._middle = [acb(x) for x in whole.middle]
            self._rho = whole.radii
            # Numbers that never change do not count for the time scale of the motion.
            pairs = zip(whole.middle, sizes, strict=True)
            state = max((log2(x) for x, row in pairs if not row[1].is_zero()), default=FAR_BELOW)
            speed = max(log2(row[1]) for row in sizes)
            # Accuracy for each state: a rounding of its size, or of its change nearby.
            is_moving = state > FAR_BELOW and speed > FAR_BELOW
            time = state - speed if is_moving else 0.0
            rows = zip(whole.middle, sizes, strict=True)
            levels = [max(log2(x), log2(row[1]) + time) for x, row in rows]
            top = max(levels)
            if top <= FAR_BELOW:
                top = 0.0
            self.sizes = [max(x, top - SMALLER) for x in levels]
            # The time in which the motion changes by its own size.
            self.time = 2.0 ** min(max(time, -FURTHEST), FURTHEST)
            pairs = ((log2(x), log2(row[1])) for x, row in zip(whole.middle, sizes, strict=True))
            moving = [a - b for a, b in pairs if a > FAR_BELOW and b > FAR_BELOW]
            self.own_time = 2.0 ** min(max(min(moving, default=0.0), -FURTHEST), FURTHEST)
            self._tolerance = [x - bits - 2 for x in self.sizes]
            self._bits = bits

    def reach(self, radius: float | arb) -> tuple[list[arb], list[arb]]:
        """Bounds of |P - m| and of |P'| on |t| <= radius, for each state."""
        r, order = arb(radius), self.method.order
        powers = [r]
        for _ in range(order - 1):
            powers.append(powers[-1] * r)
        bounds = self._table * arb_mat([[x, (k + 1) * x] for k, x in enumerate(powers)])
        rows = range(self.system.size)
        return [bounds[i, 0].upper() for i in rows], [(bounds[i, 1] / r).upper() for i in rows]

    def box(self, reach: Sequence[arb], wider: Sequence[arb] | None = None) -> list[acb]:
        """A complex box around m, of such half sides."""
        sides = reach if wider is None else [x + y for x, y in zip(reach, wider, strict=True)]
        return [
            x + acb(around_zero(r), around_zero(r))
            for x, r in zip(self._middle, sides, strict=True)
        ]

    def disk(self, radius: float) -> Disk | None:
        """The bound of the defect on a disk; None where f is not analytic on it."""
        reach, speed = self.reach(radius)
        rates = self.system.rates_on(self.box(reach))
        if not all(x.is_finite() for x in (*rates, *speed)):
            return None
        defect = [(upper(x) + v).upper() for x, v in zip(rates, speed, strict=True)]
        worst = max(log2(x) - y for x, y in zip(defect, self._tolerance, strict=True))
        order = self.method.order
        gain = (worst + math.log2(radius / (order + 1))) / (order + 1)
        return Disk(radius, tuple(defect), math.log2(radius) - max(gain, 0.0))

    def best_disk(self, radius: float, last: float) -> Disk:
        """The disk that allows the longest step, near a radius; last: a step long enough.

        Disks larger than 8 steps to the end gain nothing. Where forces cancel at the start, only
        roundings give the first radius, which is larger by far.
        """
        best, shrunk = self.disk(radius), 0
        while best is None:
            radius = min(radius * SHRINK**3, 8 * last)
            shrunk += 1
            if shrunk > MOST_TRIES:
                raise ProofError("there is no disk on which the rates are analytic")
            best = self.disk(radius)
        for factor in (SHRINK,) if shrunk else (1 / SHRINK, SHRINK):
            while factor < 1 or radius <= 8 * last:
                disk = self.disk(radius * factor)
                if disk is None or disk.longest <= best.longest + 1e-3:
                    break
                radius, best = radius * factor, disk
        return best

    def step(self, radius: float | None, most: fmpq) -> Step:
        """The longest step that is proved, up to `most`."""
        with ball_precision(LOW_BITS):
            last = float(arb(most))
            disk = self.best_disk(self.time if radius is None else radius, last)
            length = min(2.0**disk.longest, disk.radius / 2)
            if length >= last:
                length = last
            elif 2 * length > last:
                # Two even steps instead of one and a bit.
                length = last / 2 * (1 + 1e-7)
            for _ in range(MOST_TRIES):
                step = None
                if self._terms_are_small(length):
                    exact = most if length >= last else dyadic_below(length)
                    step = self.proved(disk, exact)
                if step is not None:
                    return step
                length *= SHRINK**3
            raise ProofError("no step is proved, however short")

    def _terms_are_small(self, length: float) -> bool:
        reach, _ = self.reach(length)
        return all(log2(x) <= size + TERMS for x, size in zip(reach, self.sizes, strict=True))

    def proved(self, disk: Disk, length: fmpq) -> Step | None:
        """A step of a length; None where its tube is not proved, or V would cost too much."""
        h, order = float(arb(length)), self.method.order
        time = arb(length)
        # The tube reaches into complex times, up to a radius between the step and the disk.
        for outer in (math.sqrt(h * disk.radius), h * (disk.radius / h) ** 0.25, 1.05 * h):
            tube = self._tube(disk, outer)
            if tube is None:
                continue
            bound, width = tube
            growth = growth_of(bound, arb(outer))
            needed = self._variation_order(growth, math.log2(outer / h))
            if needed > HIGHEST_VARIATION:
                continue
            column_order = self._column_order(growth, math.log2(outer / h))
            # Bounded on a disk of a radius halfway, twice the order would do without growth.
            if column_order > 2 * order + HIGHEST_VARIATION:
                continue
            local = grown(bound, time, disk.remainder(time, order))
            reach, _ = self.reach(time)
            sides = [(x + w).upper() for x, w in zip(reach, width, strict=True)]
            around = [x.real + around_zero(s) for x, s in zip(self._middle, sides, strict=True)]
            return Step(
                system=self.system, whole=self.whole, coefficients=self.coefficients,
                length=length, remainder=tuple(local), tube=tuple(around), outer=arb(outer),
                growth=growth, variation_order=max(4, needed), radius=disk.radius,
                column_order=column_order, block=self.method.block, bits=self._bits,
                sizes=tuple(self.sizes), own_time=self.own_time,
            )  # fmt: skip
        return None

    def _tube(self, disk: Disk, outer: float) -> tuple[arb_mat, list[arb]] | None:
        """L and a width that no motion from the set leaves for |t| <= outer; None if not proved."""
        reach, _ = self.reach(outer)
        time = arb(outer)
        defect = disk.remainder(time, self.method.order)
        width = [
            (s / 1024 + arb(2) ** math.floor(t) + 8 * r).upper()
            for s, t, r in zip(reach, self._tolerance, self._rho, strict=True)
        ]
        for _ in range(MOST_TUBES):
            box = self.box(reach, width)
            slopes = self.system.slopes_on(box)
            if not all(x.is_finite() for x in (*slopes, *self.system.rates_on(box))):
                return None
            bound = self._bound(slopes)
            starts = [(r + d).upper() for r, d in zip(self._rho, defect, strict=True)]
            out = grown(bound, time, starts)
            if not all(x.is_finite() for x in out):
                return None
            if all(x < w for x, w in zip(out, width, strict=True)):
                return bound, width
            width = [max(2 * x, w).upper() for x, w in zip(out, width, strict=True)]
        return None

    def _bound(self, slopes: Sequence[acb]) -> arb_mat:
        """L: bounds of the entries of |J|."""
        n = self.system.size
        rows = [[arb(0)] * n for _ in range(n)]
        for (i, j), value in zip(self.system.places, slopes, strict=True):
            rows[i][j] = upper(value)
        return arb_mat(rows)

    def _variation_order(self, growth: arb_mat, gain: float) -> int:
        """The order of the series of V with a small remainder, in units of the states."""
        n = self.system.size
        largest = max(
            log2(growth[i, j]) + self.sizes[j] - self.sizes[i] for i in range(n) for j in range(n)
        )
        if gain <= 0:
            return HIGHEST_VARIATION + 1
        return math.ceil((self.method.variation_bits + max(largest, 0.0)) / gain)

    def _column_order(self, growth: arb_mat, gain: float) -> int:
        """The order at which the tail of the series is below the width of a column, or rounding."""
        columns = self.whole.columns
        if not columns:
            return 0
        # Derivatives are no sharper than the set over which they are taken.
        pairs = zip(self.sizes, self._rho, strict=True)
        bits = min(float(self._bits), min(size - log2(r) for size, r in pairs) + SHARPER)
        largest = max(log2(upper(growth[i, j])) for i in range(self.system.size)
                      for j in range(self.system.size))  # fmt: skip
        needed = max(bits, self.method.variation_bits) + max(largest, 0.0)
        return math.ceil(needed / max(gain, 1 / self._bits))


def growth_of(bound: arb_mat, time: arb) -> arb_mat:
    """exp(L t): by how much neighbours part at most (Gronwall), and a bound of |V|."""
    return (bound * time).exp()


def grown(bound: arb_mat, time: arb, starts: Sequence[arb]) -> list[arb]:
    """exp(L t) times the values at the start, state by state."""
    n = len(starts)
    growth = growth_of(bound, time)
    return [
        sum((upper(growth[i, j]) * starts[j] for j in range(n)), arb(0)).upper() for i in range(n)
    ]


def dyadic_below(value: float, bits: int = 12) -> fmpq:
    """A positive number rounded down to a fraction with a given number of bits."""
    mantissa, exponent = math.frexp(value)
    return fmpq(int(mantissa * 2**bits), 2**bits) * fmpq(2) ** exponent


def prove_step(
    system: BallSystem, whole: LohnerSet, method: Method, radius: float | None, most: fmpq
) -> Step:
    """The longest step that is proved from a set, up to `most`, at the precision in use.

    radius: the radius of the previous step's disk.
    """
    check_limits()
    return Stepper(system, whole, method, ctx.prec).step(radius, most)

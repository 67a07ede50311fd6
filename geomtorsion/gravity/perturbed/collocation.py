"""Collocation: frequencies at which radial equations have waves that only leave.

The wave leaves into the hole and outwards. Its two factors are taken out, so that the rest is a
smooth function of x = (1/r_h - 1/r)/(1/r_h - 1/r_out), a polynomial through nodes between 0 and 1.
The radial equations at the nodes are a matrix of polynomials in the frequency, or in w + k for a
field with a mass far away, k^2 = w^2 - m^2. A coarse grid in doubles gives rough frequencies.
Newton's iteration in many digits gives the others, on finer and finer grids.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass

import mpmath
import numpy as np
import scipy  # loads its parts on first use
import sympy as sp
from flint import acb, acb_mat, arb, arb_mat, ctx

from geomtorsion.errors import AccuracyError
from geomtorsion.support.caching import cached_property

R = sp.Symbol("r", positive=True)
# Order in t and in r -> coefficient, a function of r.
Coefficients = Mapping[tuple[int, int], sp.Expr]
# Coefficients for each field.
Row = Sequence[Coefficients]
# Power of w and of k -> coefficient, a function of r.
Series = Mapping[tuple[int, int], sp.Expr]
Factor = Callable[[mpmath.mpf], mpmath.mpc]
# Numbers of nodes: of the rough frequencies, and of the finer grids with their step.
ROUGH = (30, 38)
FIRST, STEP, LAST = 44, 12, 128
# Frequencies that are looked for: oscillations and damping in units of 1/duration of the hole, and
# the largest damping in units of 1/r_h.
SLOWEST, LEAST, MOST = 0.02, 0.004, 4.0
HEAVY = " A wave of a field with a large mass may have no such frequency."
# Relative distance in which two rough grids share a frequency.
SHARED = 1e-2
# Relative distance from a rough frequency that the iteration may go, and the steps it may take.
NEAR, STEPS = 0.1, 30


@dataclass(frozen=True)
class Hole:
    """The outside of a static hole, -f dt^2 + (stretch^2/f) dr^2 + area_radius^2 dOmega^2.

    f, stretch, area_radius: functions of r without other symbols. inner, outer: horizons; outer
    is oo where space is flat far away.
    """

    f: sp.Expr
    inner: sp.Expr
    outer: sp.Expr
    stretch: sp.Expr = sp.S.One
    area_radius: sp.Expr = R

    @cached_property
    def place(self) -> sp.Expr:
        """x(r), 0 at the horizon and 1 outside."""
        return (1 / self.inner - 1 / R) / self._width

    @property
    def _width(self) -> sp.Expr:
        return 1 / self.inner - (0 if self.outer == sp.oo else 1 / self.outer)

    def leaving(self, mass2: sp.Expr) -> Series:
        """F'/(i F) of the factor F that leaves on both sides, in powers of w and k."""
        x, f = self.place, self.f / self.stretch
        if self.outer != sp.oo:
            return {(1, 0): (2 * x - 1) / f}
        near = (1 - x) ** 2
        if mass2 == 0:
            return {(1, 0): (1 - 2 * near) / f}
        # f F'/(i F) = k + m^2 M/(k r) + ... far away, f = 1 - 2 M/r + ...
        pull = mass2 * sp.limit(R * (1 - self.f), R, sp.oo) / 2
        far = (1 - near) / f
        return {(1, 0): -near / f, (0, 1): far, (0, -1): far * pull / R}

    @cached_property
    def duration(self) -> float:
        """The time of the slowest waves: r_h, or 1/(2 kappa) between two horizons if longer.

        kappa is the surface gravity.
        """
        if self.outer == sp.oo:
            return float(self.inner)
        gravity = (sp.diff(self.f, R) / self.stretch).subs(R, self.inner)
        return float(max(self.inner, 1 / gravity))

    def radius(self, x: arb) -> mpmath.mpf:
        """r at a place."""
        inner, width = mpmath.mpmathify(1 / self.inner), mpmath.mpmathify(self._width)
        return 1 / (inner - _mpf(x) * width)


@dataclass(frozen=True)
class Dispersion:
    """w and k of a wave far away, k^2 = w^2 - m^2, by one number z: z = w, or z = w + k.

    The wave leaves where |w + k| > m; otherwise it is bound.
    """

    mass2: sp.Expr

    def powers(self, w: int, k: int) -> dict[int, int | sp.Expr]:
        """w^w k^k times a common factor, in powers of z."""
        if self.mass2 == 0:
            return {w + k: 1}
        z, m = sp.Symbol("z"), self.mass2
        product = (z**2 + m) ** w * (z**2 - m) ** (k + 2) * (2 * z) ** (2 - w - k)
        return {power: c for (power,), c in sp.Poly(product, z).terms()}

    def frequency(self, z: acb) -> acb:
        """w at z."""
        return z if self.mass2 == 0 else (z + acb(mpmath.mpmathify(self.mass2)) / z) / 2

    def momentum(self, z: acb) -> acb:
        """k at z."""
        return z if self.mass2 == 0 else z - self.frequency(z)

    def leaves(self, z: complex) -> bool:
        """Whether the wave at z is not bound."""
        return abs(z) ** 2 > float(self.mass2)


@dataclass(frozen=True, eq=False)
class Radial:
    """Radial equations of some fields, each with a scale that makes it smooth at both ends.

    mass2: m^2 of the fields far away.
    """

    hole: Hole
    rows: Sequence[Row]
    scales: Sequence[sp.Expr]
    mass2: sp.Expr = sp.S.Zero

    @property
    def dispersion(self) -> Dispersion:
        """w and k far away."""
        return Dispersion(self.mass2 if self.hole.outer == sp.oo else sp.S.Zero)

    @cached_property
    def _pieces(self) -> list[list[list[tuple[dict[int, mpmath.mpf], int, Factor]]]]:
        """For each row and field: powers of z, order of d/dx, and its factor as a function of r."""
        wave, dx = self.hole.leaving(self.dispersion.mass2), sp.diff(self.hole.place, R)
        pieces = []
        for row in self.rows:
            line = []
            for coefficients, scale in zip(row, self.scales, strict=True):
                # The field is F scale h(x), and d/dr of it F scale (dx d/dx + q) h.
                q = {key: sp.I * p for key, p in wave.items()}
                q = _sum(q, {(0, 0): sp.diff(scale, R) / scale})
                steps: list[list[Series]] = [
                    [{(0, 0): sp.S.One}],
                    [q, {(0, 0): dx}],
                    [
                        _sum({key: sp.diff(one, R) for key, one in q.items()}, _product(q, q)),
                        _sum({(0, 0): sp.diff(dx, R)}, _product(q, {(0, 0): 2 * dx})),
                        {(0, 0): dx**2},
                    ],
                ]
                total: dict[int, Series] = {}
                for (in_t, in_r), c in coefficients.items():
                    factor = {(in_t, 0): (-sp.I) ** in_t * c * scale}
                    for order, one in enumerate(steps[in_r]):
                        total[order] = _sum(total.get(order, {}), _product(one, factor))
                line.append(
                    [
                        (
                            {
                                p: mpmath.mpmathify(c)
                                for p, c in self.dispersion.powers(*key).items()
                            },
                            order,
                            sp.lambdify(R, value, "mpmath"),
                        )
                        for order, one in total.items()
                        for key, value in one.items()
                    ]
                )
            pieces.append(line)
        return pieces

    def matrices(self, count: int) -> list[acb_mat]:
        """Matrices of the powers of z on a grid with this number of nodes."""
        nodes, *operators = grid(count)
        radii = [self.hole.radius(x) for x in nodes]
        n = len(self.scales) * count
        highest = max(
            p for line in self._pieces for one in line for powers, *_ in one for p in powers
        )
        result = [[acb(0)] * n * n for _ in range(highest + 1)]
        for a, line in enumerate(self._pieces):
            for k, r in enumerate(radii):
                values = [[(p, order, g(r)) for p, order, g in one] for one in line]
                size = max(abs(v) for one in values for *_, v in one)
                for b, one in enumerate(values):
                    start = (a * count + k) * n + b * count
                    for power, weights in _weights(one, size).items():
                        entries = result[power]
                        for order, weight in weights.items():
                            if order == 0:
                                entries[start + k] += weight
                                continue
                            operator = operators[order - 1]
                            for j in range(count):
                                entries[start + j] += weight * operator[k, j]
        return [acb_mat(n, n, entries) for entries in result]


def _weights(
    terms: Iterable[tuple[Mapping[int, mpmath.mpf], int, mpmath.mpc]], size: mpmath.mpf
) -> dict[int, dict[int, acb]]:
    """Power of z -> order of d/dx -> its factor at a node, divided by a size."""
    total: dict[int, dict[int, acb]] = {}
    for powers, order, value in terms:
        scaled = acb(value / size)
        for power, c in powers.items():
            own = total.setdefault(power, {})
            own[order] = own.get(order, acb(0)) + scaled * acb(c)
    return total


def _sum(one: Series, two: Series) -> Series:
    return {key: one.get(key, sp.S.Zero) + two.get(key, sp.S.Zero) for key in {**one, **two}}


def _product(one: Series, two: Series) -> Series:
    total: dict[tuple[int, int], sp.Expr] = {}
    for (w, k), x in one.items():
        for (v, q), y in two.items():
            total[w + v, k + q] = total.get((w + v, k + q), sp.S.Zero) + x * y
    return total


def _mpf(x: arb) -> mpmath.mpf:
    return mpmath.make_mpf(x.mid()._mpf_)


def grid(count: int) -> tuple[list[arb], arb_mat, arb_mat]:
    """Chebyshev's nodes between 0 and 1, and d/dx and its square on polynomials through them.

    [Berrut and Trefethen 2004], barycentric weights.
    """
    angles = [arb(2 * k + 1) / (2 * count) for k in range(count)]
    nodes = [((1 - x.cos_pi()) / 2).mid() for x in angles]
    weights = [(-1) ** k * x.sin_pi().mid() for k, x in enumerate(angles)]
    slopes, second = arb_mat(count, count), arb_mat(count, count)
    for i in range(count):
        others = [j for j in range(count) if j != i]
        row = {j: (weights[j] / weights[i] / (nodes[i] - nodes[j])).mid() for j in others}
        own = -sum(row.values(), arb(0)).mid()
        bent = {j: (2 * row[j] * (own - 1 / (nodes[i] - nodes[j]))).mid() for j in others}
        slopes[i, i], second[i, i] = own, -sum(bent.values(), arb(0)).mid()
        for j in others:
            slopes[i, j], second[i, j] = row[j], bent[j]
    return nodes, slopes, second


def rough(radial: Radial) -> list[complex]:
    """Numbers z of waves in doubles that two grids share, those damped least first."""
    first, second = (_eigenvalues(radial.matrices(count)) for count in ROUGH)
    hole, shared = radial.hole, []
    for z in map(complex, second):
        if z == 0 or not radial.dispersion.leaves(z):
            continue
        w = complex(radial.dispersion.frequency(acb(z)))
        if min(w.real / SLOWEST, -w.imag / LEAST) * hole.duration < 1:
            continue
        if -w.imag * float(hole.inner) > MOST:
            continue
        # A grid also has false waves where k is almost 0.
        if np.abs(first - z).min() < SHARED * abs(complex(radial.dispersion.momentum(acb(z)))):
            shared.append((-w.imag, z))
    return [z for _, z in sorted(shared, key=lambda one: one[0])]


def _eigenvalues(matrices: Sequence[acb_mat]) -> np.ndarray:
    """Finite eigenvalues of a matrix of polynomials, by its companion."""
    parts = [np.array([[complex(x) for x in row] for row in m.tolist()]) for m in matrices]
    degree, n = len(parts) - 1, len(parts[0])
    left = np.zeros((degree * n, degree * n), complex)
    right = np.eye(degree * n, dtype=complex)
    for k in range(degree - 1):
        left[k * n : (k + 1) * n, (k + 1) * n : (k + 2) * n] = np.eye(n)
    for k in range(degree):
        left[(degree - 1) * n :, k * n : (k + 1) * n] = -parts[k]
    right[(degree - 1) * n :, (degree - 1) * n :] = parts[degree]
    values = scipy.linalg.eigvals(left, right)
    return values[np.isfinite(values)]


@dataclass(eq=False)
class Candidate:
    """A rough frequency on its way to digits.

    z: see Dispersion. changes: of the frequency by each finer grid; None before the first grid.
    alive: False once the iteration has left its neighbourhood.
    """

    dispersion: Dispersion
    z: acb
    changes: list[float] | None = None
    alive: bool = True

    @property
    def frequency(self) -> acb:
        """w at z."""
        return self.dispersion.frequency(self.z)

    @property
    def error(self) -> float:
        """Twice the larger change by the last two refinements: one may be small by chance."""
        return 2 * max(self.changes[-2:]) if self.changes and len(self.changes) > 1 else math.inf

    @property
    def stalled(self) -> bool:
        """Whether the last finer grid changed it no less than the grid before."""
        last = (self.changes or [])[-2:]
        return len(last) > 1 and last[1] >= last[0]

    def settled(self, tolerance: float) -> bool:
        """Whether its relative error is within a tolerance."""
        return self.error < tolerance * _size(self.frequency)

    def refine(self, matrices: Sequence[acb_mat]) -> None:
        """Follow it to the next grid."""
        before, value = self.frequency, _newton(matrices, self.z)
        if value is None:
            self.alive = False
            return
        self.z = value
        if self.changes is None:
            # The value before was rough.
            self.changes = []
            return
        self.changes.append(_size(self.frequency - before))


def frequencies(radial: Radial, modes: int, digits: int) -> list[tuple[acb, float]]:
    """Frequencies with their errors, those damped least first.

    Raises
    ------
    AccuracyError
        The digits are not reached, or there are fewer modes.
    """
    with mpmath.workdps(digits + 30), ctx.workdps(digits + 30):
        candidates = [Candidate(radial.dispersion, acb(z)) for z in rough(radial)]
    tolerance, distinct = 10.0**-digits, list[tuple[acb, float]]()
    for count in range(FIRST, LAST + 1, STEP):
        # A finer grid loses more digits.
        work = digits + 30 + count // 2
        with mpmath.workdps(work), ctx.workdps(work):
            active = _refined(candidates, radial.matrices(count), modes, tolerance)
            settled = [one for one in active if one.settled(tolerance)]
            distinct = _distinct([(one.frequency, one.error) for one in settled])
        if len(distinct) >= modes and all(one in settled or one.stalled for one in active):
            return distinct[:modes]
        candidates = [one for one in candidates if one.alive]
        if len(settled) == len(candidates):
            break
    left = [one.changes[-1] for one in candidates if one.changes and not one.settled(tolerance)]
    others = ", ".join(f"{x:.0e}" for x in left[:modes]) or "nothing"
    raise AccuracyError(
        f"ringing: expected {modes} frequencies with {digits} digits, got {len(distinct)}; the "
        f"finest grid changed others by {others}. "
        "Request fewer digits or modes."
    )


def _refined(
    candidates: Sequence[Candidate], matrices: Sequence[acb_mat], modes: int, tolerance: float
) -> list[Candidate]:
    """Those damped least, refined; more than modes where one stalls or occurs twice."""
    active: list[Candidate] = []
    values: list[tuple[acb, float]] = []
    for one in candidates:
        # Rough frequencies damped almost alike have no order.
        last = active[-1].frequency if active else acb(0)
        beyond = float((last - one.frequency).imag.mid()) > SHARED * _size(last)
        if len(values) >= modes and beyond:
            break
        if not one.settled(tolerance):
            one.refine(matrices)
        if one.alive:
            active.append(one)
            if not one.stalled:
                values = _distinct([*values, (one.frequency, min(one.error, 1e-2 * tolerance))])
    return active


def _size(value: acb) -> float:
    return float(abs(value).mid())


def _distinct(values: Sequence[tuple[acb, float]]) -> list[tuple[acb, float]]:
    """Frequencies that differ, those damped least first."""
    kept: list[tuple[acb, float]] = []
    for value, error in sorted(values, key=lambda one: -float(one[0].imag.mid())):
        if all(_size(value - other) > 100 * (error + e) for other, e in kept):
            kept.append((value, error))
    return kept


def _newton(matrices: Sequence[acb_mat], start: acb) -> acb | None:
    """The eigenvalue near a start; None where the iteration leaves its neighbourhood.

    Each step squares the error, so that twice the digits are right behind the last one.
    """
    w, n = start, matrices[0].nrows()
    vector = acb_mat(n, 1, [acb(1)] * n)
    for number in range(STEPS):
        whole, slope = matrices[0], matrices[0] * acb(0)
        for k, matrix in enumerate(matrices[1:], 1):
            whole = whole + matrix * w**k
            slope = slope + matrix * (k * w ** (k - 1))
        try:
            moved = whole.solve(slope * vector, algorithm="approx")
        except ZeroDivisionError:
            return w
        peak = max(range(n), key=lambda k: _size(moved[k, 0]))
        step = (vector[peak, 0] / moved[peak, 0]).mid()
        vector = acb_mat(n, 1, [(moved[k, 0] / moved[peak, 0]).mid() for k in range(n)])
        w = (w - step).mid()
        if _size(w - start) > NEAR * _size(start):
            return None
        # The first step has no direction yet: it is small near an eigenvalue, and inaccurate.
        if number and _size(step) < 10.0 ** (-ctx.dps / 4):
            return w
    return None

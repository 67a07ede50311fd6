"""Collocation: frequencies at which radial equations have waves that only leave.

The wave leaves into the hole and outwards. Its two factors are taken out, so that the rest is a
smooth function of x = (1/r_h - 1/r)/(1/r_h - 1/r_out), a polynomial through nodes between 0 and 1.
The radial equations at the nodes are a matrix of polynomials in the frequency. A coarse grid in
doubles gives rough frequencies. Newton's iteration in many digits gives the others, on finer and
finer grids.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass

import mpmath
import numpy as np
import scipy  # loads its parts on first use
import sympy as sp
from flint import acb, acb_mat, ctx

from geomtorsion.errors import AccuracyError
from geomtorsion.support.caching import cached_property

R = sp.Symbol("r", positive=True)
# Order in t and in r -> coefficient, a function of r.
Coefficients = Mapping[tuple[int, int], sp.Expr]
# Coefficients for each field.
Row = Sequence[Coefficients]
# Numbers of nodes: of the rough frequencies, and of the finer grids with their step.
ROUGH = (30, 38)
FIRST, STEP, LAST = 44, 12, 128
# Frequencies that are looked for, in units of 1/r_h: oscillations, and damping.
SLOWEST, LEAST, MOST = 0.02, 0.004, 4.0
# Rough frequencies that are refined beyond the requested ones: some belong to the grid.
SPARE = 3
# Relative distance from a rough frequency that the iteration may go, and the steps it may take.
NEAR, STEPS = 0.1, 30


@dataclass(frozen=True)
class Hole:
    """The outside of a static hole with g_tt = -f.

    f: a function of r without other symbols. inner, outer: its horizons; outer is oo where space
    is flat far away.
    """

    f: sp.Expr
    inner: sp.Expr
    outer: sp.Expr

    @cached_property
    def place(self) -> sp.Expr:
        """x(r), 0 at the horizon and 1 outside."""
        return (1 / self.inner - 1 / R) / self._width

    @property
    def _width(self) -> sp.Expr:
        return 1 / self.inner - (0 if self.outer == sp.oo else 1 / self.outer)

    @property
    def leaving(self) -> sp.Expr:
        """F'/(i w F) of the factor F that leaves on both sides."""
        x = self.place
        sign = 1 - 2 * (1 - x) ** 2 if self.outer == sp.oo else 2 * x - 1
        return sign / self.f

    def radius(self, x: mpmath.mpf) -> mpmath.mpf:
        """r at a place."""
        inner, width = mpmath.mpmathify(1 / self.inner), mpmath.mpmathify(self._width)
        return 1 / (inner - x * width)


@dataclass(frozen=True, eq=False)
class Radial:
    """Radial equations of some fields, each with a scale that makes it smooth at both ends."""

    hole: Hole
    rows: Sequence[Row]
    scales: Sequence[sp.Expr]

    @property
    def size(self) -> int:
        """The number of fields."""
        return len(self.scales)

    @cached_property
    def _pieces(self) -> list[list[list[tuple[int, int, Callable[[mpmath.mpf], mpmath.mpc]]]]]:
        """For each row and field: power of w, order of d/dx, and its factor as a function of r."""
        s, x = self.hole.leaving, self.hole.place
        dx = sp.diff(x, R)
        pieces = []
        for row in self.rows:
            line = []
            for coefficients, scale in zip(row, self.scales, strict=True):
                q = sp.diff(scale, R) / scale
                # (power of w, order of d/dx) -> factor, for d/dr once and twice.
                once = {(0, 1): dx, (1, 0): sp.I * s, (0, 0): q}
                twice = {
                    (0, 2): dx**2,
                    (0, 1): sp.diff(dx, R) + 2 * q * dx,
                    (1, 1): 2 * sp.I * s * dx,
                    (0, 0): sp.diff(q, R) + q**2,
                    (1, 0): sp.I * (sp.diff(s, R) + 2 * q * s),
                    (2, 0): -(s**2),
                }
                total: dict[tuple[int, int], sp.Expr] = {}
                for (in_t, in_r), c in coefficients.items():
                    parts = ({(0, 0): sp.S.One}, once, twice)[in_r]
                    for (power, order), factor in parts.items():
                        key = (power + in_t, order)
                        total[key] = (
                            total.get(key, sp.S.Zero) + (-sp.I) ** in_t * c * factor * scale
                        )
                line.append(
                    [(*key, sp.lambdify(R, value, "mpmath")) for key, value in total.items()]
                )
            pieces.append(line)
        return pieces

    def matrices(self, count: int) -> list[mpmath.matrix]:
        """Matrices of the powers of w on a grid with this number of nodes."""
        nodes, slopes, second = grid(count)
        radii = [self.hole.radius(x) for x in nodes]
        n = self.size * count
        highest = max(p for line in self._pieces for one in line for p, _, _ in one)
        result = [mpmath.matrix(n, n) for _ in range(highest + 1)]
        for a, line in enumerate(self._pieces):
            for k, r in enumerate(radii):
                values = [
                    [(p, order, mpmath.mpmathify(g(r))) for p, order, g in one] for one in line
                ]
                size = max(abs(v) for one in values for *_, v in one)
                row = a * count + k
                for b, one in enumerate(values):
                    for power, order, value in one:
                        value = value / size
                        if order == 0:
                            result[power][row, b * count + k] += value
                            continue
                        weights = slopes if order == 1 else second
                        for j in range(count):
                            result[power][row, b * count + j] += value * weights[k, j]
        return result


def grid(count: int) -> tuple[list[mpmath.mpf], mpmath.matrix, mpmath.matrix]:
    """Chebyshev's nodes between 0 and 1, and d/dx and its square on polynomials through them.

    [Berrut and Trefethen 2004], barycentric weights.
    """
    angles = [mpmath.pi * (k + mpmath.mpf(1) / 2) / count for k in range(count)]
    nodes = [(1 - mpmath.cos(angle)) / 2 for angle in angles]
    weights = [(-1) ** k * mpmath.sin(angle) for k, angle in enumerate(angles)]
    slopes, second = mpmath.matrix(count, count), mpmath.matrix(count, count)
    for i in range(count):
        for j in range(count):
            if i != j:
                slopes[i, j] = weights[j] / weights[i] / (nodes[i] - nodes[j])
        slopes[i, i] = -mpmath.fsum(slopes[i, j] for j in range(count) if j != i)
        for j in range(count):
            if i != j:
                second[i, j] = 2 * slopes[i, j] * (slopes[i, i] - 1 / (nodes[i] - nodes[j]))
        second[i, i] = -mpmath.fsum(second[i, j] for j in range(count) if j != i)
    return nodes, slopes, second


def rough(radial: Radial) -> list[complex]:
    """Frequencies in doubles that two grids share, those damped least first."""
    first, second = (_eigenvalues(radial.matrices(count)) for count in ROUGH)
    unit = float(radial.hole.inner)
    shared = []
    for w in second:
        scaled = w * unit
        if scaled.real < SLOWEST or not -MOST < scaled.imag < -LEAST:
            continue
        if np.abs(first - w).min() < 1e-2 * abs(w):
            shared.append(complex(w))
    return sorted(shared, key=lambda w: -w.imag)


def _eigenvalues(matrices: Sequence[mpmath.matrix]) -> np.ndarray:
    """Finite eigenvalues of a matrix of polynomials, by its companion."""
    parts = [np.array(m.tolist(), dtype=complex) for m in matrices]
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


def frequencies(radial: Radial, modes: int, digits: int) -> list[tuple[acb, float]]:
    """Frequencies with their errors: twice the larger change by the last two refinements.

    One change may be small by chance.

    Raises
    ------
    AccuracyError
        The digits are not reached, or there are fewer modes.
    """
    with mpmath.workdps(digits + 30):
        latest: dict[int, acb] = {k: acb(w.real, w.imag) for k, w in enumerate(rough(radial))}
    settled: dict[int, tuple[acb, float]] = {}
    changes: dict[int, list[float]] = {k: [] for k in latest}
    distinct: list[tuple[acb, float]] = []
    # A finer grid loses more digits.
    work = digits + 30 + LAST // 2
    with mpmath.workdps(work), ctx.workdps(work):
        for count in range(FIRST, LAST + 1, STEP):
            matrices = [_ball(m) for m in radial.matrices(count)]
            for k in sorted(latest.keys() - settled.keys())[: modes + SPARE]:
                value = _newton(matrices, latest[k])
                if value is None:
                    del latest[k]
                    continue
                change = _size(value - latest[k])
                latest[k] = value
                if count == FIRST:
                    # The value before was rough.
                    continue
                changes[k].append(change)
                worst = max(changes[k][-2:])
                if len(changes[k]) > 1 and worst < 10.0**-digits * _size(value) / 2:
                    settled[k] = value, 2 * worst
            distinct = _distinct(settled)
            if len(distinct) >= modes:
                return distinct[:modes]
            if latest.keys() == settled.keys():
                break
    left = sorted(x[-1] for k, x in changes.items() if x and k not in settled)[:modes]
    raise AccuracyError(
        f"ringing: expected {modes} frequencies with {digits} digits, got {len(distinct)}; the "
        f"finest grid changed others by {', '.join(f'{x:.0e}' for x in left) or 'nothing'}. "
        "Request fewer digits or modes."
    )


def _size(value: acb) -> float:
    return float(abs(value).mid())


def _distinct(settled: Mapping[int, tuple[acb, float]]) -> list[tuple[acb, float]]:
    """Frequencies that differ, those damped least first."""
    kept: list[tuple[acb, float]] = []
    for value, error in sorted(settled.values(), key=lambda one: -float(one[0].imag.mid())):
        if all(_size(value - other) > 100 * (error + e) for other, e in kept):
            kept.append((value, error))
    return kept


def _ball(matrix: mpmath.matrix) -> acb_mat:
    return acb_mat(matrix.rows, matrix.cols, [acb(x) for x in matrix])


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

"""Collocation: frequencies at which radial equations have waves that only leave.

The wave leaves into the hole and outwards. Its two factors are taken out, so that the rest is a
smooth function of x = (1/r_h - 1/r)/(1/r_h - 1/r_out), a polynomial through nodes between 0 and 1.
The radial equations at the nodes are a matrix of polynomials in the frequency. A coarse grid in
doubles gives rough frequencies. Newton's iteration in many digits gives the others, on finer and
finer grids.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import mpmath
import numpy as np
import scipy.linalg
import sympy as sp
from flint import acb, acb_mat, arb, ctx

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
    def _pieces(self) -> list[list[list[tuple[int, int, object]]]]:
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
                        total[key] = total.get(key, sp.S.Zero) + (-sp.I) ** in_t * c * factor * scale
                line.append(
                    [(*key, sp.lambdify(R, value, "mpmath")) for key, value in total.items()]
                )
            pieces.append(line)
        return pieces

    def matrices(self, count: int) -> list[mpmath.matrix]:
        """Matrices of the powers of w on a grid with this number of nodes."""
        nodes, slopes = grid(count)
        second = slopes * slopes
        radii = [self.hole.radius(x) for x in nodes]
        n = self.size * count
        highest = max(p for line in self._pieces for one in line for p, _, _ in one)
        result = [mpmath.matrix(n, n) for _ in range(highest + 1)]
        for a, line in enumerate(self._pieces):
            for k, r in enumerate(radii):
                values = [[(p, order, mpmath.mpmathify(g(r))) for p, order, g in one] for one in line]
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


def grid(count: int) -> tuple[list[mpmath.mpf], mpmath.matrix]:
    """Chebyshev's nodes between 0 and 1, and the matrix of d/dx on polynomials through them."""
    angles = [mpmath.pi * (k + mpmath.mpf(1) / 2) / count for k in range(count)]
    nodes = [(1 - mpmath.cos(angle)) / 2 for angle in angles]
    weights = [(-1) ** k * mpmath.sin(angle) for k, angle in enumerate(angles)]
    slopes = mpmath.matrix(count, count)
    for i in range(count):
        for j in range(count):
            if i != j:
                slopes[i, j] = weights[j] / weights[i] / (nodes[i] - nodes[j])
        slopes[i, i] = -mpmath.fsum(slopes[i, j] for j in range(count) if j != i)
    return nodes, slopes


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
    """Frequencies with their errors: how much the last refinement of the grid changed them.

    Raises
    ------
    AccuracyError
        The digits are not reached, or there are fewer modes.
    """
    work = digits + 30
    with mpmath.workdps(work):
        starts = rough(radial)
        found: list[tuple[acb, float]] = []
        count = FIRST
        open_starts = [(w, None) for w in starts]
        settled: dict[int, tuple[acb, float]] = {}
        latest: dict[int, acb] = {}
        changes: dict[int, float] = {}
        old = ctx.dps
        ctx.dps = work + LAST // 2
        try:
            with mpmath.workdps(work + LAST // 2):
                while count <= LAST:
                    matrices = [_ball(m) for m in radial.matrices(count)]
                    for k, (start, _) in enumerate(open_starts):
                        if k in settled:
                            continue
                        value = _newton(matrices, latest.get(k, acb(start.real, start.imag)))
                        if value is None:
                            continue
                        if k in latest:
                            change = float(abs(value - latest[k]).mid())
                            changes[k] = change
                            if change < 10.0**-digits * float(abs(value).mid()) / 2:
                                settled[k] = (value, 2 * change)
                        latest[k] = value
                    distinct = _distinct(settled)
                    if len(distinct) >= modes:
                        found = distinct[:modes]
                        break
                    count += STEP
        finally:
            ctx.dps = old
    if len(found) < modes:
        reached = sorted(changes.values())
        raise AccuracyError(
            f"ringing: expected {modes} frequencies with {digits} digits, got "
            f"{len(_distinct(settled))}; the others changed by "
            f"{', '.join(f'{x:.0e}' for x in reached[:modes]) or 'more than their size'} on the "
            "finest grid. Request fewer digits or modes."
        )
    return found


def _distinct(settled: Mapping[int, tuple[acb, float]]) -> list[tuple[acb, float]]:
    """Frequencies that differ, those damped least first."""
    kept: list[tuple[acb, float]] = []
    for value, error in sorted(settled.values(), key=lambda one: -float(one[0].imag.mid())):
        if all(float(abs(value - other).mid()) > 100 * (error + e) for other, e in kept):
            kept.append((value, error))
    return kept


def _ball(matrix: mpmath.matrix) -> acb_mat:
    def entry(x: mpmath.mpc) -> acb:
        z = mpmath.mpc(x)
        return acb(arb(mpmath.nstr(z.real, ctx.dps)), arb(mpmath.nstr(z.imag, ctx.dps)))

    return acb_mat(matrix.rows, matrix.cols, [entry(x) for x in matrix])


def _newton(matrices: Sequence[acb_mat], start: acb) -> acb | None:
    """The eigenvalue near a start; None where the iteration leaves its neighbourhood."""
    w, n = start, matrices[0].nrows()
    vector = acb_mat(n, 1, [acb(1)] * n)
    for _ in range(30):
        whole, slope = matrices[0], matrices[0] * acb(0)
        for k, matrix in enumerate(matrices[1:], 1):
            whole = whole + matrix * w**k
            slope = slope + matrix * (k * w ** (k - 1))
        try:
            moved = whole.solve(slope * vector, algorithm="approx")
        except ZeroDivisionError:
            return w
        peak = max(range(n), key=lambda k: float(abs(moved[k, 0]).mid()))
        step = (vector[peak, 0] / moved[peak, 0]).mid()
        vector = acb_mat(n, 1, [(moved[k, 0] / moved[peak, 0]).mid() for k in range(n)])
        w = (w - step).mid()
        if float(abs(w - start).mid()) > 0.1 * float(abs(start).mid()):
            return None
        if float(abs(step).mid()) < 10.0 ** (-ctx.dps / 2):
            return w
    return None

"""Collocation: frequencies at which radial equations have waves that only leave.

The wave leaves into the hole and outwards. Its two factors are taken out, so that the rest is a
smooth function of x = (1/r_h - 1/r)/(1/r_h - 1/r_out), a polynomial through nodes between 0 and 1.
The radial equations at the nodes are a matrix of polynomials in the frequency, or in w + k for a
field with a mass far away, k^2 = w^2 - m^2.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, replace

import mpmath
import sympy as sp
from flint import acb, acb_mat, arb, arb_mat

from geomtorsion.support.caching import cached_property

R = sp.Symbol("r", positive=True)
# Order in t and in r -> coefficient, a function of r.
Coefficients = Mapping[tuple[int, int], sp.Expr]
# Coefficients for each field.
Row = Sequence[Coefficients]
# Power of w and of k -> coefficient, a function of r.
Series = Mapping[tuple[int, int], sp.Expr]
Factor = Callable[[mpmath.mpc], mpmath.mpc]
# Places at which the light ring is looked for.
NODES = 64


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
    def damping(self) -> float:
        """The damping of short waves at the light ring, the peak of V = f/area_radius^2.

        sqrt(-V''/(8 V)) with derivatives by the tortoise radius [Schutz, Will 1985].
        """
        potential = self.f / self.area_radius**2
        slope = sp.diff(potential, R)
        nodes = grid(NODES)[0]
        radii = [self.radius(acb(x)).real for x in nodes]
        values = [sp.lambdify(R, potential, "mpmath")(r) for r in radii]
        peak = min(max(values.index(max(values)), 1), NODES - 2)
        near = radii[peak - 1], radii[peak + 1]
        ring = mpmath.findroot(sp.lambdify(R, slope, "mpmath"), near, solver="anderson")
        bend = (self.f / self.stretch) ** 2 * sp.diff(slope, R) / potential
        return math.sqrt(-float(sp.lambdify(R, bend, "mpmath")(ring)) / 8)

    @cached_property
    def duration(self) -> float:
        """The time of the slowest waves: r_h, or 1/(2 kappa) between two horizons if longer.

        kappa is the surface gravity.
        """
        if self.outer == sp.oo:
            return float(self.inner)
        gravity = (sp.diff(self.f, R) / self.stretch).subs(R, self.inner)
        return float(max(self.inner, 1 / gravity))

    def radius(self, x: acb) -> mpmath.mpc:
        """r at a place."""
        inner, width = mpmath.mpmathify(1 / self.inner), mpmath.mpmathify(self._width)
        return 1 / (inner - mpmath.mpc(_mpf(x.real), _mpf(x.imag)) * width)


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

    def with_mass(self, mass2: sp.Expr) -> Radial:
        """The equation of one field, as a field with another mass obeys it."""
        ((wave,),) = self.rows
        change = (mass2 - self.mass2) * self.hole.f * wave[2, 0]
        value = sp.cancel(wave.get((0, 0), sp.S.Zero) + change)
        return replace(self, rows=[[{**wave, (0, 0): value}]], mass2=mass2)

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

    def _path(
        self, nodes: Sequence[arb], first: arb_mat, second: arb_mat
    ) -> tuple[list[acb], acb_mat, acb_mat]:
        """Places, and d/dx and its square on them; where space is flat far away, at complex r.

        x = s + i s (1 - s) turns r by 45 degrees far away, where the wave that leaves differs by
        a power of e from the one that comes in, also for k = -i |k| of a heavy field.
        """
        bend = acb(0, 1) if self.hole.outer == sp.oo else acb(0)
        places = [s + bend * s * (1 - s) for s in nodes]
        slopes = [1 + bend * (1 - 2 * s) for s in nodes]
        n = len(nodes)
        once = acb_mat(n, n, [first[i, j] / slopes[i] for i in range(n) for j in range(n)])
        twice = [
            (second[i, j] + 2 * bend * once[i, j]) / slopes[i] ** 2
            for i in range(n)
            for j in range(n)
        ]
        return places, once, acb_mat(n, n, twice)

    def matrices(self, count: int) -> list[acb_mat]:
        """Matrices of the powers of z on a grid with this number of nodes."""
        nodes, *operators = self._path(*grid(count))
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

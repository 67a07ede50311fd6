"""Interpolants: proved Burgers vectors of data, as integrals of polynomials on the cells of a grid.

The interpolant of floats is exact: its coefficients are rational. Arcs are cut where they cross
lines of nodes, and each piece is integrated by `acb.integral`, whose integrand has no poles.
"""

from __future__ import annotations

import itertools
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import reduce
from sys import float_info

import numpy as np
from flint import acb, arb, fmpq

from geomtorsion.codegen.balls import exact_ball, integral
from geomtorsion.errors import ProofError
from geomtorsion.loops.arcs import Arc, Ellipse, Part, Segment, shown
from geomtorsion.loops.interpolants import Interpolant
from geomtorsion.proofs.arc_integrals import Integrals, missing_bits
from geomtorsion.proofs.paths import BallArc, arc_in_balls, ellipse_vectors, segment_ends
from geomtorsion.proofs.wanted import MOST_BITS, SPARE, Wanted
from geomtorsion.support.allowance import check_limits
from geomtorsion.support.precision import ball_precision

_UNDECIDED = (
    "the loop touches a line of nodes, or almost: whether it crosses it is not decided. Move the "
    "loop by a part of the spacing."
)
# Squares of floats and their sums are exact in so many bits, so that touching a line is decided.
EXACT_SUMS = 2 * (float_info.max_exp - float_info.min_exp + 2 * float_info.mant_dig)


@dataclass(frozen=True, eq=False)
class _Cell:
    """The polynomial of one cell.

    first: its first node along each axis; sizes: how many nodes along each axis.
    values: e^i_mu at its nodes in balls, by row, mu and node.
    """

    first: tuple[int, ...]
    sizes: tuple[int, ...]
    values: dict[tuple[int, ...], arb]

    def weights(self, places: Sequence[acb]) -> dict[tuple[int, ...], acb]:
        """Product of Lagrange's polynomials of each node."""
        rows = [
            _lagrange(size, place - first)
            for size, place, first in zip(self.sizes, places, self.first, strict=True)
        ]
        return {
            node: reduce(lambda x, y: x * y, (row[k] for row, k in zip(rows, node, strict=True)))
            for node in itertools.product(*map(range, self.sizes))
        }


def _lagrange(size: int, t: acb) -> list[acb]:
    """Values at t of the polynomials that are 1 at one of the nodes 0, 1, ..., size - 1."""
    values = []
    for j in range(size):
        value = acb(1)
        for k in range(size):
            if k != j:
                value = value * (t - k) / (j - k)
        values.append(value)
    return values


def proved_interpolant(field: Interpolant, wanted: Wanted) -> Integrals:
    """Integrals of the interpolant along its loop, with the requested accuracy.

    Raises
    ------
    ProofError
        an arc is neither straight nor elliptic, or touches a line of nodes so closely that this
        is not decided.
    """
    bits = wanted.bits + SPARE
    while True:
        with ball_precision(bits):
            integrals = _integrals(field, bits)
            lost = missing_bits(integrals.balls, wanted)
        if not lost or bits >= MOST_BITS:
            return integrals
        bits = min(MOST_BITS, bits + min(max(lost, 8), bits))


def _integrals(field: Interpolant, bits: int) -> Integrals:
    rows = len(field.values)
    total, count = [arb(0)] * rows, 0
    tolerance = arb(field.loop.size) * arb(2) ** (10 - bits)
    for part in field.loop.parts:
        for arc in part.arcs:
            cuts = _cuts(field, part, arc)
            path, begin = arc_in_balls(arc, part), arb(0)
            for cut in [*cuts, arb(1)]:
                check_limits()
                count += 1
                for i in range(rows):
                    whole = _across(field, path, cut, i)
                    if begin < cut.lower():
                        whole += _between(field, path, (begin, cut.lower()), i, tolerance)
                    total[i] += part.times * whole
                begin = cut.upper()
    return Integrals(tuple(total), bits, count)


def _between(
    field: Interpolant, path: BallArc, ends: tuple[arb, arb], i: int, tolerance: arb
) -> arb:
    """The integral between two cuts; of each polynomial that may hold there."""
    pieces = [
        integral(_integrand(field, path, cell, i, *ends), tolerance).real
        for cell in _cells(field, path, *ends)
    ]
    return reduce(arb.union, pieces)


def _across(field: Interpolant, path: BallArc, cut: arb, i: int) -> arb:
    """The integral over a ball that contains crossings: all polynomials nearby, times its width."""
    width = cut.upper() - cut.lower()
    if width.is_zero():
        return arb(0)
    places = [x.real for x in _places(field, list(map(acb, path.places(cut))))]
    middle = [float(x.mid()) for x in places]
    bound = arb(0)
    for signs in itertools.product((-1, 1), repeat=len(middle)):
        cell = _cell_at(field, [x + sign / 4 for x, sign in zip(middle, signs, strict=True)])
        if cell is not None:
            value = _integrand(field, path, cell, i, arb(0), arb(1))(acb(cut), False).real
            bound = bound.max(abs(value).upper())
    return width * bound * arb(0, 1)


def _integrand(
    field: Interpolant, path: BallArc, cell: _Cell, i: int, begin: arb, end: arb
) -> Callable[[acb, bool], acb]:
    """e^i_mu(q(s)) q'^mu(s) ds/dr of a piece, r from 0 to 1."""
    n, width = path.dimension, end - begin
    moving = [mu for mu in range(n) if path.moving[mu]]

    def value(r: acb, analytic: bool) -> acb:
        point = path.path(begin + width * r, analytic)
        weights = cell.weights(_places(field, point[:n]))
        total = acb(0)
        for mu in moving:
            entry = sum((x * cell.values[i, mu, *node] for node, x in weights.items()), acb(0))
            total += entry * point[n + mu]
        return total * width

    return value


def _places(field: Interpolant, point: Sequence[acb]) -> list[acb]:
    """A point in units of the spacing."""
    return [
        (x - exact_ball(a)) / exact_ball(h)
        for x, a, h in zip(point, field.origin, field.steps, strict=True)
    ]


def _cells(field: Interpolant, path: BallArc, begin: arb, end: arb) -> list[_Cell]:
    """The polynomial at the point halfway between two cuts.

    Where its side of a line is undecided, both polynomials, which agree on the line.
    """
    middle = path.places((begin + end) / 2)
    options = []
    for x in (place.real for place in _places(field, list(map(acb, middle)))):
        if x.is_exact() and x.is_integer():
            options.append([float(x)])
        elif x.contains_integer():
            options.append([float(x.mid().floor()) + off for off in (-0.5, 0.5, 1.5)])
        else:
            options.append([float(x.floor().mid()) + 0.5])
    cells = [_cell_at(field, places) for places in itertools.product(*options)]
    known = [cell for cell in cells if cell is not None]
    if len(known) < len(cells):
        raise ProofError(
            f"the loop has no interpolant near {shown(float(x.mid()) for x in middle)}, where "
            "nodes are missing. Lead it around them."
        )
    return known


def _cell_at(field: Interpolant, places: Sequence[float]) -> _Cell | None:
    """The polynomial of a cell, from a place in it; None where nodes are missing."""
    block = field.known.blocks(np.array(places)[:, None], field.order)
    size = int(block.used[0])
    if not size:
        return None
    first = tuple(int(x) for x in block.first[:, 0])
    sizes = tuple(1 if thin else size for thin in block.thin[:, 0])
    shape, values = field.values.shape[2:], {}
    for node in itertools.product(*map(range, sizes)):
        at = tuple(
            (a + k) % count if wraps else a + k
            for a, k, count, wraps in zip(first, node, shape, field.periodic, strict=True)
        )
        for i, mu in itertools.product(range(len(field.values)), range(len(shape))):
            values[i, mu, *node] = exact_ball(float(field.values[i, mu, *at]))
    return _Cell(first, sizes, values)


# -- crossings of lines of nodes -------------------------------------------------------------------


def _cuts(field: Interpolant, part: Part, arc: Arc) -> list[arb]:
    """Disjoint balls in [0, 1], in order, around each s at which a line of nodes is crossed."""
    if isinstance(arc, Segment):
        every = _segment_cuts(field, part, arc)
    elif isinstance(arc, Ellipse):
        every = _ellipse_cuts(field, part, arc)
    else:
        raise ProofError(
            "expected straight and elliptic arcs through a grid, got "
            f"{type(arc).__name__.lower()}s. Use Loop.polygon, Loop.circle or Loop.ellipse."
        )
    if not all(s.is_finite() for s in every):
        raise ProofError(_UNDECIDED)
    inside = [s.intersection(arb(0.5, 0.5)) for s in every if s.overlaps(arb(0.5, 0.5))]
    cuts: list[arb] = []
    for cut in sorted(inside, key=lambda s: fmpq(*_ratio(s.lower()))):
        if cuts and cuts[-1].overlaps(cut):
            cut = cuts.pop().union(cut)
        cuts.append(cut)
    return cuts


def _segment_cuts(field: Interpolant, part: Part, arc: Segment) -> list[arb]:
    start, end = segment_ends(arc, part)
    return [
        (line - a) / (b - a)
        for axis, (a, b) in enumerate(zip(start, end, strict=True))
        if not (b - a).is_zero()
        for line in _lines(field, axis, a.union(b))
    ]


def _ratio(s: arb) -> tuple[int, int]:
    """An exact ball as a ratio."""
    mantissa, exponent = s.man_exp()
    power = int(exponent)
    return int(mantissa) * 2 ** max(power, 0), 2 ** max(-power, 0)


def _lines(field: Interpolant, axis: int, reach: arb) -> list[arb]:
    """Coordinates of the lines of nodes that a range overlaps."""
    origin, step = exact_ball(field.origin[axis]), exact_ball(field.steps[axis])
    places = (reach - origin) / step
    low, high = int(places.lower().floor().fmpz()), int(places.upper().ceil().fmpz())
    return [origin + k * step for k in range(low, high + 1)]


def _ellipse_cuts(field: Interpolant, part: Part, arc: Ellipse) -> list[arb]:
    """cos(2 pi s - phi) = (line - centre) / size along each axis."""
    found = []
    for axis in range(len(field.steps)):
        turns = []
        with ball_precision(EXACT_SUMS):
            centre, first, second = (row[axis] for row in ellipse_vectors(arc, part))
            square = first * first + second * second
            if square.is_zero():
                continue
            size = square.sqrt()
            for line in _lines(field, axis, centre + size * arb(0, 1)):
                off = line - centre
                excess = off * off - square
                if excess < 0:
                    turns.append((off / size).acos())
                elif not excess >= 0:
                    # It may touch or cross: anywhere nearby.
                    near = arb(0).union(abs(off / size).lower().acos())
                    turns.append(near if off > 0 else arb.pi() - near)
        phase = arb.atan2(second, first)
        found += [(phase + sign * turn) / (2 * arb.pi()) for turn in turns for sign in (1, -1)]
    # One that may be at the start may also be at the end.
    return [s - turns for s in found for turns in (-1, 0, 1)]

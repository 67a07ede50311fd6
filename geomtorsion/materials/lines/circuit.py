"""Circuit: the Burgers vector of a loop around lines of a network, by linking."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from itertools import islice

import numpy as np

from geomtorsion.errors import LoopError, NetworkError, SingularPointError
from geomtorsion.loops import Loop, Part, Segment
from geomtorsion.loops.arcs import shown
from geomtorsion.materials.burgers import Burgers
from geomtorsion.materials.lines.line_arrays import LineArrays
from geomtorsion.materials.lines.line_families import (
    Lattice,
    lattice_coordinates,
    lattice_vectors,
)
from geomtorsion.materials.lines.reactions import Vector, size, total, vanishes, written
from geomtorsion.support import checks
from geomtorsion.support.precision import CALCULATED


@dataclass(frozen=True)
class Crossing:
    """A line that crosses the surface.

    line: its number; image: periods by which its first node is moved, shape (3,); count: number of
    signed crossings, positive where the loop is right-handed about the line.
    """

    line: int
    image: tuple[int, ...]
    count: int


@dataclass(frozen=True, eq=False)
class _Stretches:
    """Straight lines in space, relative to the centre of a loop.

    numbers: of the lines; images: periods of the first nodes; starts, ends: shape (k, 3).
    """

    numbers: np.ndarray
    images: np.ndarray
    starts: np.ndarray
    ends: np.ndarray

    def of(self, chosen: np.ndarray) -> _Stretches:
        """A subset of these lines."""
        return _Stretches(
            self.numbers[chosen], self.images[chosen], self.starts[chosen], self.ends[chosen]
        )

    def touching(self, low: np.ndarray, high: np.ndarray) -> np.ndarray:
        """Numbers of the lines whose boxes meet the box between two corners."""
        least, most = np.minimum(self.starts, self.ends), np.maximum(self.starts, self.ends)
        return np.flatnonzero(((least <= high) & (most >= low)).all(axis=1))


def crossings(lines: LineArrays, loop: Loop) -> Iterator[tuple[Crossing, ...]]:
    """Crossings with one spanning surface after another, each in general position.

    Raises
    ------
    LoopError
        The loop is not closed in space, or contains symbols.
    SingularPointError
        The loop meets a line; the message names line and position.
    """
    if loop.dimension != 3:
        raise LoopError(
            f"loop: expected three coordinates, got {loop.dimension}. Give a loop in the space of "
            "the lines."
        )
    if loop.gap.any():
        raise LoopError(
            "loop: expected a loop that closes in space, got one that closes only modulo periods, "
            "which spans no surface. Lead it back to its start."
        )
    if loop.symbols:
        names = ", ".join(sorted(symbol.name for symbol in loop.symbols))
        raise LoopError(
            f"loop: expected a loop without symbols, got {names}. Give them numbers: "
            "loop.at({...})."
        )
    surfaces = [_surfaces(lines, part) for part in loop.parts]
    for each in zip(*surfaces, strict=False):
        total: dict[tuple[int, tuple[int, ...]], int] = {}
        for part, counts in zip(loop.parts, each, strict=True):
            for key, count in counts.items():
                total[key] = total.get(key, 0) + part.times * count
        yield tuple(Crossing(*key, count) for key, count in sorted(total.items()) if count)


Counts = dict[tuple[int, tuple[int, ...]], int]


def _surfaces(lines: LineArrays, part: Part) -> Iterator[Counts]:
    """Signed crossings with cones over a closed path, for one apex after another."""
    corners, reach = _outline(part)
    low, high = corners.min(axis=0), corners.max(axis=0)
    width = float((high - low).max())
    margin = width / 4 + reach
    near = _stretches(lines, np.array(part.centre), low - margin, high + margin)
    corners = _polygon(lines, part, near)
    rng = np.random.default_rng(0)
    # An apex fails to be in general position only by accident: so many do not happen in a row.
    for _ in range(32):
        # Beside the middle, so that no symmetry of a lattice puts a node into the surface.
        apex = corners.mean(axis=0) + width * rng.uniform(-0.25, 0.25, 3)
        counts = _cone(near, corners, apex)
        if counts is not None:
            yield counts
    raise NetworkError(
        f"expected a loop that keeps a distance from all lines, got one at {shown(part.centre)} "
        "that touches lines within rounding errors. Move it a little."
    )


# -- the loop as a polygon that has the same linking ----------------------------------------------


def _pieces(part: Part) -> tuple[np.ndarray, np.ndarray]:
    """Number of the arc and ends in s of pieces that are straight enough for a first polygon."""
    owner: list[int] = []
    ends: list[tuple[float, float]] = []
    for k, arc in enumerate(part.arcs):
        # Eight pieces to the shortest wave, as for the winding number.
        count = 1 if isinstance(arc, Segment) else 8 * max(4, arc.waves)
        s = np.linspace(0, 1, count + 1)
        owner += [k] * count
        ends += zip(s[:-1].tolist(), s[1:].tolist(), strict=True)
    return np.array(owner), np.array(ends)


def _chords(
    part: Part, owner: np.ndarray, ends: np.ndarray
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Ends of the chords, shape (k, 3) each, and distances of arcs from them, shape (k,)."""
    share = np.linspace(0, 1, 9)
    starts, stops, away = np.zeros((len(owner), 3)), np.zeros((len(owner), 3)), np.zeros(len(owner))
    for k in np.unique(owner):
        mine = owner == k
        s = ends[mine, :1] + share * (ends[mine, 1:] - ends[mine, :1])
        offsets = part.size * part.arcs[k].shape(s.ravel())[0].reshape(3, *s.shape)
        first, last = offsets[:, :, :1], offsets[:, :, -1:]
        starts[mine], stops[mine] = first[:, :, 0].T, last[:, :, 0].T
        if not isinstance(part.arcs[k], Segment):
            gap = offsets - first - share * (last - first)
            # Twice what samples show: between them a smooth arc bends hardly further.
            away[mine] = 2 * np.linalg.norm(gap, axis=0).max(axis=1)
    return starts, stops, away


def _outline(part: Part) -> tuple[np.ndarray, float]:
    """Corners of the first polygon and the largest distance of the path from it."""
    starts, _, away = _chords(part, *_pieces(part))
    return starts, float(away.max())


def _polygon(lines: LineArrays, part: Part, near: _Stretches) -> np.ndarray:
    """Corners of a polygon into which the path can be pulled without meeting a line, (k, 3)."""
    owner, ends = _pieces(part)
    starts, stops, away = _chords(part, owner, ends)
    far = np.abs(lines.positions).max(initial=0.0) + np.abs(part.centre).max()
    least = CALCULATED * part.size + 4 * np.finfo(float).eps * float(far)
    fine = np.zeros(len(owner), dtype=bool)
    while not fine.all():
        split = np.zeros(len(owner), dtype=bool)
        for k in np.flatnonzero(~fine):
            reach = away[k] + least
            low = np.minimum(starts[k], stops[k]) - reach
            high = np.maximum(starts[k], stops[k]) + reach
            some = near.of(near.touching(low, high))
            distances = _distances(some.starts, some.ends, starts[k], stops[k])
            if not (distances <= reach).any():
                fine[k] = True
                continue
            if away[k] <= least:
                hit = int(distances.argmin())
                a, b = (lines.labels[n] for n in lines.pairs[some.numbers[hit]])
                place = np.array(part.centre) + (starts[k] + stops[k]) / 2
                raise SingularPointError(
                    f"the loop meets the line {a!r} -> {b!r} near {shown(place)}, where its "
                    "Burgers vector is not defined. Lead it past the line."
                )
            split[k] = True
        middle = ends[split].mean(axis=1, keepdims=True)
        halves = np.concatenate(
            [np.hstack([ends[split, :1], middle]), np.hstack([middle, ends[split, 1:]])]
        )
        owner = np.concatenate([owner[~split], owner[split], owner[split]])
        ends = np.concatenate([ends[~split], halves])
        fine = np.concatenate([fine[~split], np.zeros(2 * split.sum(), dtype=bool)])
        order = np.lexsort((ends[:, 0], owner))
        owner, ends, fine = owner[order], ends[order], fine[order]
        starts, stops, away = _chords(part, owner, ends)
    return starts


def _distances(p: np.ndarray, q: np.ndarray, a: np.ndarray, b: np.ndarray) -> np.ndarray:
    """Distances of segments p to q, shape (k, 3) each, from one segment a to b, shape (k,)."""
    one, two, between = q - p, b - a, p - a
    tiny = np.finfo(float).tiny
    square, other = np.maximum((one * one).sum(axis=1), tiny), max(float(two @ two), tiny)
    along, across, mixed = (one * between).sum(axis=1), between @ two, one @ two
    # At an end of one of the two, or at a line perpendicular to both.
    to_start = np.clip(across / other, 0, 1)
    to_end = np.clip((across + mixed) / other, 0, 1)
    from_start = np.clip(-along / square, 0, 1)
    from_end = np.clip((mixed - along) / square, 0, 1)
    twist = np.maximum(square * other - mixed * mixed, tiny)
    inner = np.clip((mixed * across - along * other) / twist, 0, 1)
    inner_other = np.clip((inner * mixed + across) / other, 0, 1)
    zero, full = np.zeros(len(p)), np.ones(len(p))
    pairs = (
        (zero, to_start), (full, to_end), (from_start, zero), (from_end, full),
        (inner, inner_other),
    )  # fmt: skip
    gaps = [between + s[:, None] * one - t[:, None] * two for s, t in pairs]
    return np.min([np.linalg.norm(gap, axis=1) for gap in gaps], axis=0)


# -- lines in reach -------------------------------------------------------------------------------


def _stretches(
    lines: LineArrays, centre: np.ndarray, low: np.ndarray, high: np.ndarray
) -> _Stretches:
    """All images of lines that reach into a box about a centre."""
    box, places = lines.box, lines.positions - centre
    first, second = lines.pairs.T
    numbers = np.arange(len(first))
    if box is None:
        every = _Stretches(
            numbers, np.zeros((len(first), 3), np.int64), places[first], places[second]
        )
        return every.of(every.touching(low, high))
    corners = np.array([[x, y, z] for x in (0, 1) for y in (0, 1) for z in (0, 1)])
    reach = (low + corners * (high - low)) @ box.inverse
    begins = places[first] @ box.inverse
    finish = begins + lines.steps @ box.inverse
    # Rounding may exclude an image that touches; a thousandth of a period more does no harm.
    least = np.ceil(reach.min(axis=0) - np.maximum(begins, finish) - 1e-3)
    most = np.floor(reach.max(axis=0) - np.minimum(begins, finish) + 1e-3)
    least, most = (np.where(box.periodic, x, 0) for x in (least, most))
    counts = np.maximum(most - least + 1, 0)
    total = counts.prod(axis=1)
    checks.check_room(
        12 * int(min(total.sum(), 2.0**62)),
        f"a loop near {total.sum():.3g} images of lines",
        "Give a smaller loop.",
    )
    sizes = total.astype(np.int64)
    chosen = np.repeat(numbers, sizes)
    rank = np.arange(len(chosen)) - np.repeat(np.cumsum(sizes) - sizes, sizes)
    shifts = np.zeros((len(chosen), 3), dtype=np.int64)
    for axis in (2, 1, 0):
        width = counts[chosen, axis].astype(np.int64)
        shifts[:, axis] = least[chosen, axis].astype(np.int64) + rank % width
        rank = rank // width
    # A node must have the same digits in all its lines: images of nodes are formed first.
    starts = places[first[chosen]] + shifts @ box.vectors
    ends = places[second[chosen]] + (shifts + lines.cochain.complex.images[chosen]) @ box.vectors
    every = _Stretches(chosen, shifts, starts, ends)
    return every.of(every.touching(low, high))


# -- signed crossings -----------------------------------------------------------------------------


def _cone(near: _Stretches, corners: np.ndarray, apex: np.ndarray) -> Counts | None:
    """Signed crossings with the triangles from an apex to each side; None if one is ambiguous."""
    counts: Counts = {}
    for k in range(len(corners)):
        triangle = np.array([apex, corners[k], corners[(k + 1) % len(corners)]])
        some = near.of(near.touching(triangle.min(axis=0), triangle.max(axis=0)))
        sides = [triangle[j] - some.starts for j in range(3)]
        step = some.ends - some.starts
        round_it = [_sign(step, sides[j], sides[(j + 1) % 3]) for j in range(3)]
        one, two = triangle[1] - apex, triangle[2] - apex
        before = _sign(some.starts - apex, one, two)
        after = _sign(some.ends - apex, one, two)
        signs = np.array(round_it)
        # Certainly outside: on one side of the plane, or beyond a side of the triangle.
        outside = (before * after > 0) | ((signs > 0).any(axis=0) & (signs < 0).any(axis=0))
        inside = ~outside & (before * after < 0) & (signs != 0).all(axis=0)
        if not (outside | inside).all():
            return None
        for j in np.flatnonzero(inside):
            key = int(some.numbers[j]), tuple(some.images[j].tolist())
            counts[key] = counts.get(key, 0) + int(after[j])
    return counts


def _sign(a: np.ndarray, b: np.ndarray, c: np.ndarray) -> np.ndarray:
    """Sign of the determinant of three vectors, zero where rounding may have made it."""
    cross = np.cross(b, c)
    value = (a * cross).sum(axis=-1)
    b, c = np.broadcast_arrays(np.abs(b), np.abs(c))
    size = b[..., [1, 2, 0]] * c[..., [2, 0, 1]] + b[..., [2, 0, 1]] * c[..., [1, 2, 0]]
    bound = CALCULATED * (np.abs(a) * size).sum(axis=-1)
    return np.where(np.abs(value) <= bound, 0, np.sign(value)).astype(np.int64)


@dataclass(frozen=True, eq=False, repr=False, kw_only=True)
class LineBurgers(Burgers):
    """Burgers vector of a circuit around the lines of a network.

    exact: b, exact where b of the lines is, shape (n,). whole: b in the given lattice.
    crossings: lines that cross a surface which the circuit spans, with their images and signs.
    """

    exact: Vector
    crossings: tuple[Crossing, ...]


def circuit_burgers(
    lines: LineArrays,
    vectors: Sequence[Vector],
    loop: Loop,
    lattice: Lattice | None,
    tolerance: float,
) -> LineBurgers:
    """The signed sum of b over the lines that cross a surface; a second one must give the same.

    vectors: b of each line, exact where it is. tolerance: share of the largest b within which
    floats count as equal.

    Raises
    ------
    NetworkError
        Two surfaces give different sums: lines end between them. Or there is no line.
    """
    checks.instance(loop, Loop, "loop")
    if not vectors:
        raise NetworkError(
            "expected a network with lines that a circuit can surround, got one without lines. Add "
            "lines."
        )
    first, second = islice(crossings(lines, loop), 2)
    one, two = (_sum(vectors, passages) for passages in (first, second))
    missing = tuple(a - b for a, b in zip(one, two, strict=True))
    share = tolerance * (1 + len(first) + len(second))
    if not vanishes(missing, max(map(size, vectors)), share):
        raise NetworkError(
            "expected one Burgers vector for all surfaces that the circuit spans, got "
            f"{written(one)} and {written(two)} for two of them, because lines end in between. "
            "Correct the nodes that .node_rule() names, or choose another circuit."
        )
    vector, name = np.array([float(x) for x in one]), loop.name
    if lattice is None:
        return LineBurgers(vector=vector, exact=one, crossings=first, name=name)
    cell = lattice_vectors(lattice, lines.burgers.shape[1])
    coordinates = lattice_coordinates(lines.burgers, cell, tolerance)
    whole = np.zeros(coordinates.shape[1], dtype=np.int64)
    for crossing in first:
        whole += crossing.count * coordinates[crossing.line]
    return LineBurgers(
        vector=vector, whole=whole, lattice=cell, exact=one, crossings=first, name=name
    )


def _sum(vectors: Sequence[Vector], found: Sequence[Crossing]) -> Vector:
    """The sum of b over crossings."""
    rows = [tuple(one.count * x for x in vectors[one.line]) for one in found]
    return total(rows) if rows else tuple(0 * x for x in vectors[0])

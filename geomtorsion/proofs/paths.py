"""Paths: the arcs of a loop in balls, made again from the numbers that the user gave."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from typing import TypeAlias

import sympy as sp
from flint import acb, arb, arb_mat

from geomtorsion.codegen import Graph, graph
from geomtorsion.codegen.balls import BallCode, exact_ball
from geomtorsion.errors import ProofError
from geomtorsion.loops.arcs import Arc, Cubic, Curve, Ellipse, Part, Segment, dyadic_number
from geomtorsion.support.caching import cached_property

Balls: TypeAlias = Sequence[arb]
# (s from 0 to 1, analytic) -> coordinates, then their slopes.
Path = Callable[[acb, bool], list[acb]]
# The coefficients of a cubic, the highest power first.
Coefficients = tuple[arb, arb, arb, arb]
# The curve parameter of every arc.
S = sp.Symbol("s", real=True)


@dataclass(frozen=True, eq=False)
class BallArc:
    """An arc with s from 0 to 1.

    dimension: number of coordinates, n.
    graph: over s and numbers that are balls: n coordinates, then n slopes.
    values: these balls.
    """

    dimension: int
    graph: Graph
    values: tuple[arb, ...]

    @classmethod
    def of(cls, coordinates: Sequence[sp.Expr], values: dict[sp.Symbol, arb]) -> BallArc:
        """From expressions over s and symbols, each with a ball."""
        slopes = [x.diff(S) for x in coordinates]
        names = [S.name, *(symbol.name for symbol in values)]
        arc_graph = graph(names, [*coordinates, *slopes], factor=False)
        return cls(len(coordinates), arc_graph, tuple(values.values()))

    @cached_property
    def moving(self) -> tuple[bool, ...]:
        """For each coordinate whether it changes at all."""
        steps = [self.graph.steps[place] for _, place in self.graph.outputs[self.dimension :]]
        return tuple(not (step.kind == "number" and step.detail == 0) for step in steps)

    @cached_property
    def path(self) -> Path:
        """Coordinates and slopes as a function of s."""
        code = BallCode(self.graph)
        function, numbers = code.complex_function(), code.numbers()
        return lambda s, analytic: function([s, *self.values], numbers, analytic)

    def places(self, s: arb) -> list[arb]:
        """Coordinates at a real ball."""
        return BallCode(self.graph).real([s, *self.values])[: self.dimension]


def arcs_of(part: Part) -> Iterator[BallArc]:
    """The arcs of a part, of numbers at the precision in use.

    Raises
    ------
    ProofError
        an arc is of a kind that is not known here.
    """
    cubics = [arc for arc in part.arcs if isinstance(arc, Cubic)]
    if len(cubics) == len(part.arcs):
        yield from _spline(cubics, *_frame_of(part))
        return
    for arc in part.arcs:
        yield arc_in_balls(arc, part)


def _frame_of(part: Part) -> tuple[list[arb], arb]:
    """Centre and size of a part."""
    centre, size = part.given or (part.centre, part.size)
    return [exact_ball(x) for x in centre], exact_ball(size)


def ellipse_vectors(arc: Ellipse, part: Part) -> tuple[list[arb], list[arb], list[arb]]:
    """Centre, and the vectors u and v of centre + u cos(2 pi s) + v sin(2 pi s)."""
    centre, size = _frame_of(part)
    pair = (arc.first, arc.second) if arc.meant is None else arc.meant(read=dyadic_number)
    first, second = ([size * exact_ball(x) for x in vector] for vector in pair)
    return centre, first, second


def segment_ends(arc: Segment, part: Part) -> tuple[list[arb], list[arb]]:
    """Both ends of a straight arc."""
    centre, size = _frame_of(part)
    points = arc.held or arc.given
    if points is not None:
        start, end = ([exact_ball(x) for x in point] for point in points)
        return start, end
    start, end = (
        [c + size * exact_ball(x) for c, x in zip(centre, point, strict=True)]
        for point in (arc.start, arc.end)
    )
    return start, end


def arc_in_balls(arc: Arc, part: Part) -> BallArc:
    """One arc of a part.

    Raises
    ------
    ProofError
        the arc is of a kind that is not known here.
    """
    if isinstance(arc, Ellipse):
        return _ellipse(*ellipse_vectors(arc, part))
    if isinstance(arc, Segment):
        start, end = segment_ends(arc, part)
        return _polynomials([(b - a, a) for a, b in zip(start, end, strict=True)])
    centre, size = _frame_of(part)
    if isinstance(arc, Curve):
        low, width = arc.start, arc.end - arc.start
        middle, scale = _named("c", centre), _named("r", [size])
        (radius,) = scale
        offsets = [x.subs(arc.parameter, low + width * S) for x in arc.expressions]
        places = [c + radius * x for c, x in zip(middle, offsets, strict=True)]
        return BallArc.of(places, middle | scale)
    raise ProofError(
        f"expected circles, ellipses, segments, splines and curves, got {type(arc).__name__}. "
        "Write the loop with these."
    )


def _named(letter: str, balls: Balls) -> dict[sp.Symbol, arb]:
    """Symbols that represent balls."""
    return {sp.Symbol(f"{letter}{k}", real=True): ball for k, ball in enumerate(balls)}


def _ellipse(centre: Balls, first: Balls, second: Balls) -> BallArc:
    """q = centre + first cos(2 pi s) + second sin(2 pi s)."""
    c, u, v = _named("c", centre), _named("u", first), _named("v", second)
    turn = 2 * sp.pi * S
    rows = zip(c, u, v, strict=True)
    places = [x + (y * sp.cos(turn) if not u[y].is_zero() else 0)
              + (z * sp.sin(turn) if not v[z].is_zero() else 0) for x, y, z in rows]  # fmt: skip
    return BallArc.of(places, c | u | v)


def _polynomials(rows: Sequence[Sequence[arb]]) -> BallArc:
    """Each coordinate by its coefficients, the highest power first."""
    values: dict[sp.Symbol, arb] = {}
    places = []
    for k, row in enumerate(rows):
        named = _named(f"p{k}_", row)
        values |= named
        total: sp.Expr = sp.S.Zero
        for symbol, ball in named.items():
            total = total * S + (0 if ball.is_zero() else symbol)
        places.append(total)
    return BallArc.of(places, values)


def _spline(pieces: Sequence[Cubic], centre: Balls, size: arb) -> Iterator[BallArc]:
    """The periodic cubic spline through the points: in balls its pieces join."""
    if all(piece.given is not None for piece in pieces):
        points = [[exact_ball(x) for x in piece.given or ()] for piece in pieces]
    else:
        points = [
            [c + size * exact_ball(row[3]) for c, row in zip(centre, x.coefficients, strict=True)]
            for x in pieces
        ]
    for rows in spline_coefficients(points):
        yield _polynomials(rows)


def spline_coefficients(points: Sequence[Balls]) -> Iterator[list[Coefficients]]:
    """For each piece of a periodic cubic spline over the chord length its cubics in s from 0 to 1.

    Slopes d_k at the points: h_k d_(k-1) + 2 (h_(k-1) + h_k) d_k + h_(k-1) d_(k+1)
    = 3 (h_k / h_(k-1) (y_k - y_(k-1)) + h_(k-1) / h_k (y_(k+1) - y_k)).
    """
    count, n = len(points), len(points[0])
    after = [*range(1, count), 0]
    steps = [
        [b - a for a, b in zip(points[k], points[after[k]], strict=True)] for k in range(count)
    ]
    chords = [sum((x * x for x in step), arb(0)).sqrt() for step in steps]
    matrix = [[arb(0)] * count for _ in range(count)]
    right = []
    for k in range(count):
        before, here = chords[k - 1], chords[k]
        for column, value in ((k - 1, here), (k, 2 * (before + here)), (after[k], before)):
            matrix[k][column % count] += value
        ratio = here / before
        pairs = zip(steps[k - 1], steps[k], strict=True)
        right.append([3 * (ratio * one + two / ratio) for one, two in pairs])
    slopes = arb_mat(matrix).solve(arb_mat(right))
    for k in range(count):
        rows = []
        for i in range(n):
            rise, h = steps[k][i], chords[k]
            one, two = slopes[k, i] * h, slopes[after[k], i] * h
            rows.append((one + two - 2 * rise, 3 * rise - 2 * one - two, one, points[k][i]))
        yield rows

"""Constructors: circles, ellipses, polygons, splines, cycles and curves as parts of a loop."""

from __future__ import annotations

from collections.abc import Callable, Hashable, Mapping, Sequence
from dataclasses import replace
from functools import partial
from typing import TYPE_CHECKING

import numpy as np
import scipy  # loads its parts on first use
import sympy as sp

from geomtorsion.errors import ExpressionError, LoopError
from geomtorsion.exact import parse_expression
from geomtorsion.exact.names import FUNCTIONS
from geomtorsion.exact.reading import counted_as
from geomtorsion.geometry.validation import free_symbols
from geomtorsion.loops import validation
from geomtorsion.loops.arcs import (
    Cubic,
    Curve,
    Ellipse,
    Number,
    Parameters,
    Part,
    Plane,
    Point,
    Segment,
    dyadic_number,
    exact_number,
    shown,
)
from geomtorsion.loops.quadrature import kronrod
from geomtorsion.support import checks
from geomtorsion.support.exclusive import exclusive
from geomtorsion.support.precision import CALCULATED

if TYPE_CHECKING:
    import networkx as nx

# Prime numbers of samples: a frequency that hides from one shows itself to the next.
SAMPLES = (251, 1009, 4093, 16381, 65521)
Directions = Callable[[Plane, int], tuple[Sequence[sp.Expr], Sequence[sp.Expr]]]
SMOOTH = frozenset(made for made, _ in FUNCTIONS.values() if isinstance(made, type))


def parametric(
    expressions: Sequence[Number | str],
    parameter: str | sp.Symbol,
    interval: Sequence[Number | str],
    centre: Point | None,
    size: Number,
    symbols: Mapping[str, sp.Symbol] | None,
    periods: Mapping[int, Number | str] | None = None,
) -> Part:
    """Closed curve from expressions; see Loop.parametric."""
    symbol = (
        parameter if isinstance(parameter, sp.Symbol) else sp.Symbol(_name(parameter), real=True)
    )
    names = {**(symbols or {}), str(symbol): symbol}
    several = "two expressions or more, one for each coordinate"
    listed = checks.entries(expressions, "curve", LoopError, expected=several)
    if len(listed) < 2:
        checks.refuse(LoopError, "curve", several, expressions)
    read = tuple(_read(x, names, f"curve[{k}]") for k, x in enumerate(listed))
    bounds = checks.entries(interval, "interval", LoopError, 2, expected="two bounds")
    start, end = (_read(x, dict(symbols or {}), "interval") for x in bounds)
    declared = (symbol, *(symbols or {}).values())
    twins = counted_as(free_symbols([*read, start, end]), declared, LoopError)
    read = tuple(x.xreplace(twins) for x in read)
    start, end = start.xreplace(twins), end.xreplace(twins)
    place = (0.0,) * len(read) if centre is None else validation.vector(centre, "centre", len(read))
    source = ((0,) * len(read), 1) if centre is None else (tuple(centre), size)
    if centre is None and size != 1:
        raise LoopError(f"size {size} counts offsets from a centre; give the centre as well.")
    scale = validation.length(size, "size")
    arc = Curve(read, symbol, start, end)
    part = Part(place, scale, (arc,), given=source, periods=_periods(periods, len(read)))
    return part if arc.symbols else _finished(part, arc, centre is None)


def _finished(part: Part, arc: Curve, movable: bool) -> Part:
    """A part checked and ready for numbers; its constant terms become the centre if movable."""
    if float(arc.end) == float(arc.start):
        raise LoopError(f"interval: it has no length, both bounds are {arc.start}.")
    gap = _check_closed(arc, part)
    if gap.any() and not part.periods:
        turning = tuple((k, float(2 * sp.pi)) for k in np.flatnonzero(gap).tolist())
        part = replace(part, periods=turning, assumed=True)
    if movable:
        constants = tuple(x.as_independent(arc.parameter, as_Add=True)[0] for x in arc.expressions)
        offsets = tuple(x - c for x, c in zip(arc.expressions, constants, strict=True))
        arc, place = replace(arc, expressions=offsets), tuple(map(float, constants))
        part = replace(part, centre=place, given=(constants, 1))
    return replace(part, arcs=(_resolved(arc, gap),), gap=tuple(gap.tolist()) if gap.any() else ())


def _periods(
    periods: Mapping[int, Number | str] | None, dimension: int
) -> tuple[tuple[int, float], ...]:
    """Coordinate and period of each coordinate that is an angle."""
    pairs = []
    for key, value in checks.table(periods, "periods", LoopError).items():
        where = f"periods[{checks.shown(key)}]"
        column = checks.count(key, where, LoopError, 0, dimension - 1)
        period = _read(value, {}, where)
        if not (period.is_number and period.is_positive):
            raise LoopError(f"{where}: expected a positive number, got {period}.")
        pairs.append((column, float(period)))
    return tuple(pairs)


def filled(part: Part, values: Parameters) -> Part:
    """A part with numbers for its symbols that have a value; see Loop.at."""
    (arc,) = part.arcs
    if not isinstance(arc, Curve) or not arc.symbols:
        return part
    names = checks.by_name(values, "parameters", LoopError)
    table = {
        s: exact_number(validation.exact_input(names[s.name], s.name))
        for s in arc.symbols
        if s.name in names
    }
    for symbol, value in table.items():
        checks.check_declared(symbol, value)
    curve = replace(
        arc,
        expressions=tuple(x.subs(table) for x in arc.expressions),
        start=arc.start.subs(table),
        end=arc.end.subs(table),
    )
    if curve.symbols:
        return replace(part, arcs=(curve,))
    return _finished(part, curve, part.size == 1 and not any(part.centre))


def symbolic_ellipse(
    centre: Point, axes: Sequence[Number], plane: Plane, directions: Directions
) -> Part:
    """Ellipse whose centre or axes contain symbols, for exact integrals."""
    s = sp.Symbol("s", real=True)
    validation.rows(plane, len(centre))
    u, v = directions(plane, len(centre))
    a, b = (exact_number(axis) for axis in axes)
    counted_as(free_symbols([*centre, *axes]), (), LoopError)
    expressions = tuple(
        exact_number(q) + a * x * sp.cos(s) + b * y * sp.sin(s)
        for q, x, y in zip(centre, u, v, strict=True)
    )
    arc = Curve(expressions, s, sp.S.Zero, 2 * sp.pi, is_periodic=True, waves=1)
    return Part((0.0,) * len(centre), 1.0, (arc,), given=((0,) * len(centre), 1))


def _name(parameter: str | sp.Symbol) -> str:
    """The name of the parameter."""
    name = checks.text(parameter, "parameter", LoopError, expected="a name or a symbol")
    if not name.isidentifier():
        checks.refuse(LoopError, "parameter", "a name or a symbol", name)
    return name


def _read(value: object, names: Mapping[str, sp.Symbol], where: str) -> sp.Expr:
    """A smooth real expression from text or sympy."""
    read = partial(parse_expression, symbols=names, functions={}, where=where, decimals=True)
    expression = exact_number(checks.expression(value, where, LoopError, read=read))
    # Decimals are exact: 0.3 is 3/10.
    expression = expression.xreplace({x: exact_number(x) for x in expression.atoms(sp.Float)})
    if expression.has(sp.I, sp.nan, sp.zoo, sp.oo):
        raise ExpressionError(f"{where}: {expression} is not real and finite.")
    for part in expression.atoms(sp.Function, sp.Piecewise):
        if part.func not in SMOOTH:
            raise ExpressionError(
                f"{where}: {part} is not known to be smooth. A curve with corners is a polygon."
            )
    return expression


def _check_closed(arc: Curve, part: Part) -> np.ndarray:
    """Refuse a curve whose ends do not meet, that is a point, or is not finite.

    Returns the whole periods between its ends, in units of the size, shape (n,). Where no period is
    declared, every coordinate may be an angle; only a frame decides it.
    """
    with np.errstate(all="ignore"):
        points, _ = arc.shape(np.linspace(0, 1, 258)[1:-1])
        first, last = arc.shape(np.array([0.0, 1.0]))[0].T
    ends = np.array([first, last])
    if not (np.isfinite(points).all() and np.isfinite(ends).all()):
        raise LoopError(
            f"curve: it is not finite everywhere between {arc.start} and {arc.end}. "
            "Choose an interval on which every expression is."
        )
    extent = np.abs(points - points[:, :1]).max()
    if extent <= 1e-15 * np.abs(points).max():
        raise LoopError(f"curve: it stays at the point {shown(points[:, 0])} and has no length.")
    gap, turns = _gap(arc), np.zeros(len(first))
    turning = part.periods or [(k, float(2 * sp.pi)) for k in range(len(first))]
    for column, period in turning:
        turns[column] = round(part.size * gap[column] / period) * period / part.size
    left = gap - turns
    if np.abs(left).max() > CALCULATED * extent:
        left = left if part.periods else gap
        more = " beside whole periods" if part.periods and turns.any() else ""
        raise LoopError(
            f"curve: it does not close: it starts at {shown(first)} and ends at {shown(last)}, the "
            f"gap is {shown(left)}{more}. Choose the interval so that both ends meet."
        )
    return turns


@exclusive
def _gap(arc: Curve) -> np.ndarray:
    """End minus start, with more digits than a double has."""
    gaps = [
        (x.subs(arc.parameter, arc.end) - x.subs(arc.parameter, arc.start)).evalf(30, chop=True)
        for x in arc.expressions
    ]
    return np.array([float(gap) for gap in gaps])


def _resolved(arc: Curve, gap: np.ndarray) -> Curve:
    """The curve with its highest frequency, and whether it repeats after the interval.

    gap: by how much it is further then, whole periods.
    """
    probe = np.array([0.137, 0.311, 0.618, 0.871])
    with np.errstate(all="ignore"):
        here, (places, slopes) = arc.shape(probe), arc.shape(probe + 1)
        after = places - gap[:, None], slopes
    scale = np.abs(here[1]).max()
    periodic = all(
        np.isfinite(two).all() and np.abs(one - two).max() <= 1e-9 * scale
        for one, two in zip(here, after, strict=True)
    )
    if not periodic:
        _check_length(arc)
        return arc
    frequencies = [_highest(arc, samples) for samples in SAMPLES[:2]]
    for samples in SAMPLES[2:]:
        if frequencies[-1] is not None and frequencies[-1] == frequencies[-2]:
            break
        frequencies.append(_highest(arc, samples))
    waves = frequencies[-1]
    if waves is None:
        _check_length(arc)
        waves = SAMPLES[-1] // 3
    return replace(arc, is_periodic=True, waves=waves)


def _check_length(arc: Curve) -> None:
    """Refuse a curve whose length does not converge: it runs through a pole."""

    def speed(_: np.ndarray, slopes: np.ndarray) -> np.ndarray:
        return np.sqrt((slopes * slopes).sum(axis=0))[None]

    with np.errstate(all="ignore"):
        length = kronrod((arc,), speed, 1e-3, 0.0, SAMPLES[-1])
    if not length.converged:
        place = arc.start + (arc.end - arc.start) * (length.worst[1] if length.worst else 0.0)
        raise LoopError(
            f"curve: its length is not finite near {arc.parameter} = {float(place):.6g}. "
            "Choose an interval on which every expression is finite."
        )


def _highest(arc: Curve, samples: int) -> int | None:
    """The highest frequency that these samples show, None if they resolve none."""
    _, slopes = arc.shape(np.arange(samples) / samples)
    spectrum = np.abs(np.fft.rfft(slopes, axis=1)).max(axis=0)
    # A frequency that is nothing against the largest is rounding.
    present = np.flatnonzero(spectrum > CALCULATED * spectrum.max())
    highest = int(present[-1]) if len(present) else 0
    return highest if highest < samples // 3 else None


# Neighbours closer than this share of the loop's size are one point after rounding.
COINCIDE = 4 * float(np.finfo(float).eps)


def circle(centre: Point, radius: Number, plane: Plane) -> Part:
    """Circle of a radius about a centre; see Loop.circle."""
    if validation.is_symbolic(centre, radius):
        return symbolic_ellipse(centre, (radius, radius), plane, validation.exact_orthonormal)
    place = validation.vector(centre, "centre")
    u, v = validation.orthonormal(*validation.rows(plane, len(place)))
    size = validation.length(radius, "radius")
    exact_axes = partial(validation.exact_orthonormal, plane, len(place))
    side = Ellipse(tuple(u.tolist()), tuple(v.tolist()), exact_axes)
    return Part(place, size, (side,), given=(tuple(centre), radius))


def ellipse(centre: Point, axes: Sequence[Number], plane: Plane) -> Part:
    """Ellipse with two semi-axes along two directions; see Loop.ellipse."""
    axes = checks.entries(axes, "axes", LoopError, 2, expected="two semi-axes")
    if validation.is_symbolic(centre, axes):
        return symbolic_ellipse(centre, axes, plane, validation.exact_rows)
    place = validation.vector(centre, "centre")
    first, second = validation.rows(plane, len(place))
    a, b = (validation.length(axis, f"axes[{k}]") for k, axis in enumerate(axes))
    size = max(a, b)
    exact_axes = partial(validation.exact_multiples, plane, tuple(axes), len(place))
    u, v = first * (a / size), second * (b / size)
    side = Ellipse(tuple(u.tolist()), tuple(v.tolist()), exact_axes)
    return Part(place, size, (side,), given=(tuple(centre), axes[0] if a >= b else axes[1]))


def polygon(vertices: Sequence[Point] | np.ndarray, centre: Point | None, size: Number) -> Part:
    """Closed chain of straight sides; see Loop.polygon."""
    place, scale, offsets, source = _offsets(vertices, centre, size, "vertices", "vertex")
    exact = None if source else [tuple(vertices[k]) for k in range(len(offsets))]
    source = source or ((0,) * len(place), 1)
    return Part(place, scale, _straight([tuple(x) for x in offsets.tolist()], exact), given=source)


def _straight(
    corners: Sequence[tuple[float, ...]],
    meant: Sequence[tuple[Number, ...]] | None,
    held: Sequence[tuple[Number, ...]] | None = None,
) -> tuple[Segment, ...]:
    """Sides from corner to corner.

    meant: the corners as coordinates, as the user gave them; held: with floats as they are held.
    """
    following = [*range(1, len(corners)), 0]
    return tuple(
        Segment(
            corners[k],
            corners[j],
            (meant[k], meant[j]) if meant else None,
            (held[k], held[j]) if held else None,
        )
        for k, j in enumerate(following)
    )


def plaquette(corner: Point, steps: Sequence[Number], plane: Plane) -> Part:
    """Parallelogram from a corner; see Loop.plaquette."""
    place = validation.vector(corner, "corner")
    first, second = validation.rows(plane, len(place))
    steps = checks.entries(steps, "steps", LoopError, 2, expected="two steps")
    a, b = (validation.number(step, f"steps[{k}]") for k, step in enumerate(steps))
    if not (a and b):
        raise LoopError(f"steps: expected two steps that are not zero, got {tuple(steps)!r}.")
    scale = max(abs(a), abs(b))
    u, v = first * (a / scale), second * (b / scale)
    middle = tuple((float(q) + scale * (x + y) / 2) for q, x, y in zip(place, u, v, strict=True))
    corners = [tuple(x.tolist()) for x in (-(u + v) / 2, (u - v) / 2, (u + v) / 2, (v - u) / 2)]
    exact, dyadic = (
        _exact_corners(corner, steps, plane, read) for read in (exact_number, dyadic_number)
    )
    return Part(middle, scale, _straight(corners, exact, dyadic), given=((0,) * len(place), 1))


def _exact_corners(
    corner: Point, steps: Sequence[Number], plane: Plane, read: validation.Reading
) -> list[tuple[sp.Expr, ...]]:
    """The corners of a parallelogram as exact numbers; read: what a number is taken for."""
    rows = validation.exact_rows(plane, len(corner), read)
    first, second = ([read(step) * x for x in row] for step, row in zip(steps, rows, strict=True))
    return [
        tuple(read(q) + j * x + k * y for q, x, y in zip(corner, first, second, strict=True))
        for j, k in ((0, 0), (1, 0), (1, 1), (0, 1))
    ]


def spline(points: Sequence[Point] | np.ndarray, centre: Point | None, size: Number) -> Part:
    """Periodic cubic spline through points; see Loop.spline."""
    place, scale, offsets, _ = _offsets(points, centre, size, "points", "point")
    closed = np.vstack([offsets, offsets[:1]])
    chords = np.linalg.norm(np.diff(closed, axis=0), axis=1)
    knots = np.concatenate([[0.0], np.cumsum(chords)])
    pieces = scipy.interpolate.CubicSpline(knots, closed, bc_type="periodic").c
    # From powers of the chord length to powers of s in 0..1 on each piece.
    powers = chords[None, :] ** np.arange(3, -1, -1)[:, None]
    scaled = (pieces * powers[:, :, None]).transpose(1, 2, 0)
    exact_points = [tuple(points[k]) if centre is None else None for k in range(len(offsets))]
    sides = tuple(
        Cubic(tuple(tuple(row) for row in piece), point)
        for piece, point in zip(scaled.tolist(), exact_points, strict=True)
    )
    return Part(place, scale, sides)


def cycle(graph: nx.Graph[Hashable], nodes: Sequence[Hashable], position: str) -> Part:
    """Polygon along a cycle of a graph; see Loop.from_cycle."""
    chain = validation.once_round(nodes, "cycle")
    corners = []
    for node in chain:
        if node not in graph:
            raise LoopError(f"cycle: node {node!r} is not in the graph.")
        if position not in graph.nodes[node]:
            raise LoopError(
                f"cycle: node {node!r} has no {position!r}. Give every node its coordinates with "
                f"networkx.set_node_attributes(graph, positions, {position!r})."
            )
        corners.append(graph.nodes[node][position])
    for start, end in zip(chain, chain[1:] + chain[:1], strict=True):
        if not graph.has_edge(start, end) and not graph.has_edge(end, start):
            raise LoopError(f"cycle: there is no edge between {start!r} and {end!r}.")
    return polygon(corners, None, 1)


def _offsets(
    points: Sequence[Point] | np.ndarray, centre: Point | None, size: Number, where: str, what: str
) -> tuple[tuple[float, ...], float, np.ndarray, tuple[tuple[Number, ...], Number] | None]:
    """Centre, size and offsets of points, closed and without neighbours that coincide."""
    corners = checks.entries(points, where, LoopError, expected="a list of points")
    dimension = len(corners[0]) if corners and checks.is_list(corners[0]) else None
    rows = np.array(
        [validation.vector(row, f"{where}[{k}]", dimension) for k, row in enumerate(corners)]
    )
    if len(rows) > 3 and (rows[0] == rows[-1]).all():
        rows = rows[:-1]
    if len(rows) < 3:
        raise LoopError(
            f"{where}: expected at least three points, got {len(rows)}: a path back and forth "
            "between two points encloses nothing."
        )
    if centre is None:
        if size != 1:
            raise LoopError(f"size {size} counts offsets from a centre; give the centre as well.")
        middle = rows.mean(axis=0)
        offsets = rows - middle
        scale = float(np.abs(offsets).max())
        place, source = tuple(middle.tolist()), None
        offsets = offsets / scale if scale else offsets
    else:
        place = validation.vector(centre, "centre", rows.shape[1])
        scale, offsets = validation.length(size, "size"), rows
        source = (tuple(centre), size)
    steps = np.abs(offsets - np.roll(offsets, 1, axis=0)).max(axis=1)
    for k in np.flatnonzero(steps <= COINCIDE * np.abs(offsets).max()).tolist():
        raise LoopError(
            f"{where}: {what} {(k - 1) % len(rows)} and {what} {k} coincide at "
            f"{shown(rows[k])}. Omit one of them."
        )
    return place, scale, offsets, source

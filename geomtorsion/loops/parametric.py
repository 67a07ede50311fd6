"""Curves: closed parametric loops from exact expressions."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from functools import partial

import numpy as np
import sympy as sp

from geomtorsion import checks
from geomtorsion.errors import ExpressionError, LoopError, MissingValueError
from geomtorsion.exact import parse_expression
from geomtorsion.exact.names import FUNCTIONS
from geomtorsion.exact.twins import counted_as
from geomtorsion.geometry.validation import free_symbols
from geomtorsion.loops import planes
from geomtorsion.loops.arcs import (
    Curve,
    Number,
    Parameters,
    Part,
    Plane,
    Point,
    exact_number,
    shown,
)
from geomtorsion.loops.quadrature import kronrod
from geomtorsion.precision import CALCULATED

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
    if isinstance(expressions, str) or not hasattr(expressions, "__len__") or len(expressions) < 2:
        raise LoopError(
            "curve: at least two expressions were needed, one per coordinate, but "
            f"{checks.shown(expressions)} came."
        )
    read = tuple(_read(x, names, f"curve[{k}]") for k, x in enumerate(expressions))
    if not hasattr(interval, "__len__") or isinstance(interval, str) or len(interval) != 2:
        raise LoopError(f"interval: two bounds were needed, but {checks.shown(interval)} came.")
    start, end = (_read(x, dict(symbols or {}), "interval") for x in interval)
    known = (symbol, *(symbols or {}).values())
    twins = counted_as(free_symbols([*read, start, end]), known, LoopError)
    read = tuple(x.xreplace(twins) for x in read)
    start, end = start.xreplace(twins), end.xreplace(twins)
    place = (0.0,) * len(read) if centre is None else planes.vector(centre, "centre", len(read))
    given = ((0,) * len(read), 1) if centre is None else (tuple(centre), size)
    if centre is None and size != 1:
        raise LoopError(f"size {size} counts offsets from a centre; give the centre as well.")
    scale = planes.length(size, "size")
    arc = Curve(read, symbol, start, end)
    part = Part(place, scale, (arc,), given=given, periods=_periods(periods, len(read)))
    return part if arc.symbols else _finished(part, arc, centre is None)


def _finished(part: Part, arc: Curve, movable: bool) -> Part:
    """A part checked and ready for numbers; its constant terms become the centre if movable."""
    if float(arc.end) == float(arc.start):
        raise LoopError(f"interval: it has no length, both bounds are {arc.start}.")
    gap = _check_closed(arc, part)
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
    found = []
    for key, value in checks.table(periods, "periods", LoopError).items():
        where = f"periods[{checks.shown(key)}]"
        column = checks.count(key, where, LoopError, 0, dimension - 1)
        period = _read(value, {}, where)
        if not (period.is_number and period.is_positive):
            raise LoopError(f"{where}: a positive number was needed, but {period} came.")
        found.append((column, float(period)))
    return tuple(found)


def filled(part: Part, values: Parameters) -> Part:
    """A part with numbers for its symbols; see Loop.at."""
    (arc,) = part.arcs
    if not isinstance(arc, Curve) or not arc.symbols:
        return part
    names = checks.by_name(values, "parameters", LoopError)
    missing = sorted(s.name for s in arc.symbols if s.name not in names)
    if missing:
        raise MissingValueError(
            f"the loop contains {', '.join(missing)}: give values, "
            f"parameters={{{', '.join(f'{name!r}: ...' for name in missing)}}}."
        )
    table = {s: exact_number(planes.exact_input(names[s.name], s.name)) for s in arc.symbols}
    known = replace(
        arc,
        expressions=tuple(x.subs(table) for x in arc.expressions),
        start=arc.start.subs(table),
        end=arc.end.subs(table),
    )
    return _finished(part, known, part.size == 1 and not any(part.centre))


def symbolic_ellipse(
    centre: Point, axes: Sequence[Number], plane: Plane, directions: Directions
) -> Part:
    """Ellipse whose centre or axes contain symbols, for exact integrals."""
    s = sp.Symbol("s", real=True)
    planes.rows(plane, len(centre))
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
    if not isinstance(parameter, str) or not parameter.isidentifier():
        came = checks.shown(parameter)
        raise LoopError(f"parameter: a name or a symbol was needed, but {came} came.")
    return parameter


def _read(value: object, names: Mapping[str, sp.Symbol], where: str) -> sp.Expr:
    """A smooth real expression from text or sympy."""
    read = partial(parse_expression, symbols=names, functions={}, where=where, decimals=True)
    expression = exact_number(checks.expression(value, where, LoopError, read=read))
    # Decimals count as what they say: 0.3 is 3/10.
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

    Returns the whole periods between its ends, in units of the size, shape (n,).
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
    for column, period in part.periods:
        turns[column] = round(part.size * gap[column] / period) * period / part.size
    left = gap - turns
    if np.abs(left).max() > CALCULATED * extent:
        more = " beside whole periods" if turns.any() else ""
        raise LoopError(
            f"curve: it does not close: it starts at {shown(first)} and ends at {shown(last)}, the "
            f"gap is {shown(left)}{more}. Choose the interval so that both ends meet."
        )
    return turns


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
    found = [_highest(arc, samples) for samples in SAMPLES[:2]]
    for samples in SAMPLES[2:]:
        if found[-1] is not None and found[-1] == found[-2]:
            break
        found.append(_highest(arc, samples))
    waves = found[-1]
    if waves is None:
        _check_length(arc)
        waves = SAMPLES[-1] // 3
    return replace(arc, is_periodic=True, waves=waves)


def _check_length(arc: Curve) -> None:
    """Refuse a curve whose length does not converge: it runs through a pole."""

    def speed(_: np.ndarray, slopes: np.ndarray) -> np.ndarray:
        return np.sqrt((slopes * slopes).sum(axis=0))[None]

    with np.errstate(all="ignore"):
        found = kronrod((arc,), speed, 1e-3, 0.0, SAMPLES[-1])
    if not found.converged:
        place = arc.start + (arc.end - arc.start) * (found.worst[1] if found.worst else 0.0)
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

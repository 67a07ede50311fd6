"""Atlas check: whether maps between charts keep the metric, the frame, and lead there and back.

Everything is computed from exact elements at generic points, to 400 bits: two sides that agree at
half of them are equal, and a difference is shown with its component. The tests check shipped
atlases; `atlas=` checks a user's atlas.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from itertools import islice

import mpmath

from geomtorsion.curves.atlas import Atlas, Chart, TransitionMap
from geomtorsion.errors import CoordinateError, GeomtorsionError, ShapeError
from geomtorsion.geometry import Frame
from geomtorsion.ode.numbers import Real, mpf
from geomtorsion.support.checks import shown
from geomtorsion.support.precision import EXACT_BITS, working_precision

# Half of the bits may be lost: analytic functions that agree in the other half are equal.
EQUAL = mpmath.mpf(2) ** (-EXACT_BITS // 2)

Row = list[mpmath.mpf]
Point = tuple[Row, dict[str, Real]]


def check_atlas(frame: Frame, atlas: Atlas, points: int = 3) -> int:
    """Number of points of the domain at which each map of an atlas was found right.

    Raises
    ------
    CoordinateError
        the home chart is not the chart of the frame; a map does not pull the metric (or the frame,
        where its charts claim to keep it) back, does not lead back, or has no value at any point
        tried.
    ShapeError
        a map does not have one expression for each coordinate of its target.

    Examples
    --------
    >>> from geomtorsion.curves.atlas import atlas_of
    >>> from geomtorsion.spaces import load
    >>> s2 = load("s2").frame
    >>> check_atlas(s2, atlas_of(s2))
    6
    """
    home = atlas.chart(atlas.home)
    if home.coordinates != frame.coordinates:
        raise CoordinateError(
            f"expected an atlas over {shown(frame.coordinates)}, got one whose home chart "
            f"{home.name!r} has {shown(home.coordinates)}. Give that chart the coordinates of the "
            "frame."
        )
    changes = atlas.changes()
    for change in changes:
        _check_shape(atlas, change)
    counts = [0] * len(changes)
    for point, numbers in _points(frame):
        reached = {atlas.home: point}
        for name in atlas.makers:
            _reach(atlas, reached, name, numbers)
        for k, change in enumerate(changes):
            if change.source in reached:
                counts[k] += _is_right(atlas, change, reached[change.source], numbers)
        if min(counts, default=points) >= points:
            break
    for change, count in zip(changes, counts, strict=True):
        if not count:
            raise CoordinateError(
                f"{_name(change)}: expected a value at points of the domain of the frame, got none "
                "at any point tried. Restrict the domain of the frame."
            )
    return sum(counts)


def _name(change: TransitionMap) -> str:
    return f"the map from chart {change.source!r} to chart {change.target!r}"


def _check_shape(atlas: Atlas, change: TransitionMap) -> None:
    """A map has the coordinates of its source and an expression for each of its target's."""
    source, target = atlas.chart(change.source), atlas.chart(change.target)
    if change.coordinates != source.coordinates or len(change.expressions) != len(
        target.coordinates
    ):
        raise ShapeError(
            f"{_name(change)}: expected {len(target.coordinates)} expressions over {source.names}, "
            f"one for each coordinate of the target, got {len(change.expressions)} over "
            f"{shown(change.coordinates)}."
        )


def _points(frame: Frame) -> Iterator[Point]:
    """Generic points of the region with values of the parameters."""
    region = frame.region
    # Without a domain the maps need not hold far from the point.
    points = region.points() if frame.domain else region.near()
    for point in islice(points, 60):
        numbers: dict[str, Real] = {p.name: point[p] for p in frame.parameters}
        yield [mpf(point[x], EXACT_BITS) for x in frame.coordinates], numbers


def _reach(atlas: Atlas, reached: dict[str, Row], name: str, numbers: dict[str, Real]) -> None:
    """The point in another chart, by the maps that lead there from home."""
    for change in atlas.route(atlas.home, name):
        if change.target not in reached:
            there = _mapped(change, reached.get(change.source), numbers)
            if there is None:
                return
            reached[change.target] = there


def _mapped(change: TransitionMap, point: Row | None, numbers: dict[str, Real]) -> Row | None:
    """A point in the target, or None where the map has no real value."""
    if point is None:
        return None
    try:
        image = change.precisely(point, numbers, EXACT_BITS)
    except (ArithmeticError, TypeError, GeomtorsionError):
        return None
    real = all(isinstance(x, mpmath.mpf) and mpmath.isfinite(x) for x in image)
    return image if real else None


def _is_right(atlas: Atlas, change: TransitionMap, point: Row, numbers: dict[str, Real]) -> bool:
    """Whether the map was found right at a point; False where it has no value there."""
    there = _mapped(change, point, numbers)
    if there is None:
        return False
    source, target = atlas.chart(change.source), atlas.chart(change.target)
    try:
        pushed = _pushed(source, change, point, numbers)
        if source.keeps_frame and target.keeps_frame:
            _compare_frames(change, target, pushed, there, numbers)
        else:
            _compare_metrics(change, source, target, pushed, there, numbers)
    except ArithmeticError:
        return False
    for back in atlas.changes():
        if (back.source, back.target) == (change.target, change.source):
            _compare_points(change, back, atlas, (point, there), numbers)
    return True


def _pushed(
    source: Chart, change: TransitionMap, point: Row, numbers: dict[str, Real]
) -> list[list[Real]]:
    """Legs of the source, written in the coordinates of the target."""
    place = dict(zip(source.names, point, strict=True)) | numbers
    n = source.frame_vectors.shape[1]
    legs = [source.frame_vectors.precisely(place, _unit(i, n), EXACT_BITS) for i in range(n)]
    return [change.slopes.precisely(place, leg, EXACT_BITS) for leg in legs]


def _unit(i: int, n: int) -> list[Real]:
    return [float(i == k) for k in range(n)]


def _compare_frames(
    change: TransitionMap,
    target: Chart,
    pushed: Sequence[Sequence[Real]],
    there: Row,
    numbers: dict[str, Real],
) -> None:
    """Legs of both charts are the same fields."""
    place = dict(zip(target.names, there, strict=True)) | numbers
    n = len(pushed)
    for i, leg in enumerate(pushed):
        own = target.frame_vectors.precisely(place, _unit(i, n), EXACT_BITS)
        for name, one, two in zip(target.names, leg, own, strict=True):
            if _differ(one, two, [*leg, *own]):
                raise CoordinateError(
                    f"{_name(change)}: expected a map that keeps the frame, got {name}-component "
                    f"{_short(one)} of leg {i}, where the chart has {_short(two)}. Correct the "
                    "map, or give keeps_frame=False if only the metric is the same."
                )


def _compare_metrics(
    change: TransitionMap,
    source: Chart,
    target: Chart,
    pushed: Sequence[Sequence[Real]],
    there: Row,
    numbers: dict[str, Real],
) -> None:
    """The products of the legs of the source are the same in the metric of the target."""
    if source.frame is None or target.frame is None:
        raise CoordinateError(
            f"{_name(change)}: expected charts with a metric, got a redundant chart, which has "
            "none. Give keeps_frame=True, or give the chart a frame."
        )
    place = dict(zip(target.names, there, strict=True)) | numbers
    turned = [target.coframe.precisely(place, leg, EXACT_BITS) for leg in pushed]
    eta, own = _eta(target.frame), _eta(source.frame)
    n = len(turned)
    with working_precision(EXACT_BITS):
        for i in range(n):
            for j in range(i + 1):
                terms = [
                    eta[k][m] * turned[i][k] * turned[j][m] for k in range(n) for m in range(n)
                ]
                got = mpmath.fsum(terms)
                if _differ(got, own[i][j], [*terms, own[i][j]]):
                    raise CoordinateError(
                        f"{_name(change)}: expected a map that preserves the metric, got "
                        f"{_short(got)} for the product of legs {j} and {i}, which is "
                        f"{_short(own[i][j])}. Correct the expressions of the map, or the chart."
                    )


def _eta(frame: Frame) -> list[list[mpmath.mpf]]:
    n = frame.dimension
    return [[mpf(frame.eta[i, j], EXACT_BITS) for j in range(n)] for i in range(n)]


def _compare_points(
    change: TransitionMap,
    back: TransitionMap,
    atlas: Atlas,
    points: tuple[Row, Row],
    numbers: dict[str, Real],
) -> None:
    """A round trip leads to the same point, perhaps with other coordinates of it."""
    point, there = points
    trip = _mapped(back, there, numbers)
    if trip is None or _first_gap(back, point, trip) is None:
        return
    image = _mapped(change, trip, numbers)
    if image is not None and _first_gap(change, there, image) is None:
        return
    k = _first_gap(back, point, trip) or 0
    name = atlas.chart(change.source).names[k]
    raise CoordinateError(
        f"{_name(change)} and {_name(back)}: expected maps that are inverse to each other, got "
        f"{name} = {_short(trip[k])} after both from {name} = {_short(point[k])}. Correct one of "
        f"them, or list {name} among the angles of the second."
    )


def _first_gap(change: TransitionMap, one: Row, two: Row) -> int | None:
    """The first coordinate of the target in which two points differ, angles by no full turns."""
    for k, (x, y) in enumerate(zip(one, two, strict=True)):
        with working_precision(EXACT_BITS):
            gap = x - y
            if k in change.angles:
                gap -= 2 * mpmath.pi * mpmath.nint(gap / (2 * mpmath.pi))
        if abs(gap) > EQUAL * max(abs(x), abs(y), 1):
            return k
    return None


def _differ(one: Real, two: Real, sizes: Sequence[Real]) -> bool:
    size = max(1, *(abs(x) for x in sizes))
    return abs(one - two) > EQUAL * size


def _short(value: Real) -> str:
    return f"{float(value):.6g}"

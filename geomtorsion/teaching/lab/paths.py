"""paths: the straightest and the shortest curve from one start, and their distance."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np

from geomtorsion.pictures.style import SERIES, STROKES, ends, number
from geomtorsion.pictures.text import greek_name
from geomtorsion.spaces import solve_pair
from geomtorsion.support.outgoing import size_text
from geomtorsion.teaching.exercises.worker_pool import Json
from geomtorsion.teaching.lab.numbers import names_text, table
from geomtorsion.teaching.lab.plot import key, mark, plane, svg
from geomtorsion.teaching.lab.settings import PAGE
from geomtorsion.teaching.lab.space_info import space_of
from geomtorsion.teaching.lab.turning import Curve, Film, in_space, thinned
from geomtorsion.teaching.messages import in_language
from geomtorsion.teaching.texts import ENGLISH, Texts, texts

if TYPE_CHECKING:
    from geomtorsion.spaces import Pair

# Not a colour of either curve: on a page a colour has one meaning.
DISTANCE = SERIES[2]


def paths(
    space: str,
    velocity: Sequence[float],
    t: float,
    moments: Sequence[float] | None = None,
    language: str = ENGLISH,
) -> Json:
    """Both curves of a shipped space from its usual start.

    Parameters
    ----------
    velocity
        u^i along the frame vectors.
    t
        last value of the curve parameter.
    moments
        kinetic metric of the geodesic, one number for each frame vector.
    language
        of the words in pictures, table and sentence.

    Returns
    -------
    space: an HTML document with the turnable curves; or picture: an svg element if the
    space is a plane. distance: svg. table, sentence: HTML and text. largest: of the distances.

    Examples
    --------
    >>> paths("flat_polar", [0.3, 1.0], 2.0)["largest"] > 0.5
    True
    """
    pair = solve_pair(
        space_of(space),
        frame_velocity=[float(x) for x in velocity],
        t=float(t),
        # JSON sends a whole slider value as an integer; the solver needs floats.
        moments=None if moments is None else [float(x) for x in moments],
        accuracy=PAGE.accuracy,
        samples=PAGE.samples,
    )
    largest = float(pair.distance.max())
    text = texts("figures", "paths", language)
    return {
        **_drawn(pair, text),
        "distance": _distance(pair, text),
        "table": _table(pair, text),
        "sentence": _sentence(pair, largest, text),
        "largest": largest,
    }


def _drawn(pair: Pair, text: Texts) -> Json:
    """The curves in the most readable projection."""
    embedding = pair.embedding
    name = f"paths {pair.space.name}"
    if embedding is not None and len(embedding.place) == 3:
        places = places_of(pair)
        radius = _radius(places) if embedding.isometric else 0.0
        scene = Film(
            name, text.named("drawn", embedding.title), _three(embedding.axes),
            curves_of(pair, text),
            times=times_of(pair), globe=radius, equal=embedding.isometric, language=text.language,
        )  # fmt: skip
        return in_space(scene)
    if embedding is not None and len(embedding.place) == 2:
        places = places_of(pair)
        return {"picture": _plane(places, embedding.axes, text("plane"), text, equal=True)}
    if embedding is not None and embedding.attitude is not None:
        scene = Film(
            name, text("axes"), ("x", "y", "z"), _axes(pair, text), times=times_of(pair),
            globe=1.0, note=text("behind"), language=text.language,
        )  # fmt: skip
        return in_space(scene)
    names = tuple(greek_name(symbol.name) for symbol in pair.symbols)
    title = text("coordinates", names=names_text(names[:3], text.language))
    if len(names) == 2:
        return {"picture": _plane(pair.coordinates, names, title, text, equal=False)}
    scene = Film(
        name, title, _three(names), curves_of(pair, text), times=times_of(pair),
        language=text.language,
    )  # fmt: skip
    return in_space(scene)


def places_of(pair: Pair) -> dict[str, np.ndarray]:
    """Positions of both curves in the space in which they are drawn."""
    if pair.embedding is None or not pair.embedding.place:
        return {curve: points[:, :3] for curve, points in pair.coordinates.items()}
    return {
        curve: pair.embedding.places(points, pair.parameters)
        for curve, points in pair.coordinates.items()
    }


def _three(names: Sequence[str]) -> tuple[str, str, str]:
    first, second, third = names[:3]
    return first, second, third


def _radius(places: dict[str, np.ndarray]) -> float:
    """Radius of the sphere that contains all points, or zero."""
    lengths = np.concatenate([np.linalg.norm(points, axis=1) for points in places.values()])
    return float(lengths.max()) if np.ptp(lengths) < 1e-6 * lengths.max() else 0.0


def times_of(pair: Pair) -> list[float]:
    """Times of the points that are drawn."""
    return thinned(pair.times.tolist())


def curves_of(pair: Pair, text: Texts) -> tuple[Curve, ...]:
    """Both curves as they are drawn in space; text: has their labels."""
    return tuple(
        Curve(thinned(points.tolist()), STROKES[curve], text(curve))
        for curve, points in places_of(pair).items()
    )


def _axes(pair: Pair, text: Texts) -> tuple[Curve, ...]:
    """Traces of two body axes on the unit sphere, for both curves."""
    curves = []
    for curve, points in pair.coordinates.items():
        assert pair.embedding is not None
        turns = pair.embedding.attitudes(points, pair.parameters)
        for axis in (0, 2):
            look = STROKES[curve]
            label = text(curve) if axis == 2 else ""
            trace = thinned(turns[:, :, axis].tolist())
            curves.append(Curve(trace, look, label, tip=str(axis + 1)))
    return tuple(curves)


def _plane(
    places: dict[str, np.ndarray], names: Sequence[str], title: str, text: Texts, *, equal: bool
) -> str:
    figure, axes = plane(title, (names[0], names[1]), equal=equal)
    for curve, points in places.items():
        axes.plot(*points.T, **STROKES[curve].line, label=text(curve))
        ends(axes, points, STROKES[curve])
    key(figure, axes)
    return svg(figure, text.language)


def _distance(pair: Pair, text: Texts) -> str:
    """The distance between them over time; beside the accuracy if the curves coincide."""
    times = pair.times[: len(pair.distance)]
    if pair.coincide:
        figure, axes = plane(text("equal"), ("t", text("distance")))
        axes.plot(times, pair.distance, **DISTANCE.line)
        axes.axhline(PAGE.accuracy, **SERIES[5].line, label=text("accuracy"))
        largest = max(PAGE.accuracy, float(pair.distance.max()))
        axes.set_ylim(-0.1 * largest, 1.25 * largest)
        key(figure, axes)
        return svg(figure, text.language)
    figure, axes = plane(text("distances"), ("t", text("distance")))
    stroke, last = DISTANCE, (times[-1], pair.distance[-1])
    axes.plot(times, pair.distance, **stroke.line)
    mark(axes, last, stroke.color, stroke.end, number(float(pair.distance[-1])))
    return svg(figure, text.language)


def _table(pair: Pair, text: Texts) -> str:
    """Cost and error of each solution."""
    rows = [
        [
            text(curve),
            solution.engine,
            size_text(solution.error, 0),
            f"{solution.cost.run_seconds * 1e3:.3g} ms",
            number(float(solution.times[-1])),
        ]
        for curve, solution in pair.curves.items()
    ]
    heads = [text(key) for key in ("curve", "method", "error", "computing", "last")]
    return table(heads, rows, text("caption"))


def _sentence(pair: Pair, largest: float, text: Texts) -> str:
    if pair.coincide:
        first = text("coincide", distance=size_text(largest, 0))
    else:
        first = text("separate", distance=f"{largest:.4g}")
    stops = [
        text(f"ended_{curve}", reason=in_language(reason, text.language))
        for curve, reason in pair.stops.items()
    ]
    return " ".join([first, *stops])

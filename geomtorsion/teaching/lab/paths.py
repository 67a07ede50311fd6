"""paths: the straightest and the shortest curve from one start, and their distance."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
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

if TYPE_CHECKING:
    from geomtorsion.spaces import Pair

# Not a colour of either curve: on a page a colour has one meaning.
DISTANCE = SERIES[2]
LABELS = {"autoparallel": "straightest (autoparallel)", "geodesic": "shortest (geodesic)"}


def paths(
    space: str, velocity: Sequence[float], t: float, moments: Sequence[float] | None = None
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
    return {
        **_drawn(pair),
        "distance": _distance(pair),
        "table": _table(pair),
        "sentence": _sentence(pair, largest),
        "largest": largest,
    }


def _drawn(pair: Pair) -> Json:
    """The curves in the most readable projection."""
    embedding = pair.embedding
    name = f"paths {pair.space.name}"
    if embedding is not None and len(embedding.place) == 3:
        places = places_of(pair)
        radius = _radius(places) if embedding.isometric else 0.0
        scene = Film(
            name, _capital(embedding.title), _three(embedding.axes), curves_of(pair),
            times=times_of(pair), globe=radius, equal=embedding.isometric,
        )  # fmt: skip
        return in_space(scene)
    if embedding is not None and len(embedding.place) == 2:
        picture = _plane(places_of(pair), embedding.axes, "The curves in the plane", equal=True)
        return {"picture": picture}
    if embedding is not None and embedding.attitude is not None:
        scene = Film(
            name, "Directions of the body axes 1 and 3", ("x", "y", "z"), _axes(pair),
            times=times_of(pair), globe=1.0, note="Pale lines: behind the globe.",
        )  # fmt: skip
        return in_space(scene)
    names = tuple(greek_name(symbol.name) for symbol in pair.symbols)
    title = f"The curves in the coordinates {names_text(names[:3])}"
    if len(names) == 2:
        return {"picture": _plane(pair.coordinates, names, title, equal=False)}
    return in_space(Film(name, title, _three(names), curves_of(pair), times=times_of(pair)))


def places_of(pair: Pair) -> dict[str, np.ndarray]:
    """Positions of both curves in the space in which they are drawn."""
    if pair.embedding is None or not pair.embedding.place:
        return {curve: points[:, :3] for curve, points in pair.coordinates.items()}
    return {
        curve: pair.embedding.places(points, pair.parameters)
        for curve, points in pair.coordinates.items()
    }


def _capital(title: str) -> str:
    """A title with a capital letter, unless it begins with a symbol.

    >>> _capital("path of the body"), _capital("r, θ, φ as in flat space")
    ('Path of the body', 'r, θ, φ as in flat space')
    """
    return title[:1].upper() + title[1:] if title[1:2].isalpha() else title


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


def curves_of(pair: Pair, labels: Mapping[str, str] = LABELS) -> tuple[Curve, ...]:
    """Both curves as they are drawn in space."""
    return tuple(
        Curve(thinned(points.tolist()), STROKES[curve], labels[curve])
        for curve, points in places_of(pair).items()
    )


def _axes(pair: Pair) -> tuple[Curve, ...]:
    """Traces of two body axes on the unit sphere, for both curves."""
    curves = []
    for curve, points in pair.coordinates.items():
        assert pair.embedding is not None
        turns = pair.embedding.attitudes(points, pair.parameters)
        for axis in (0, 2):
            look = STROKES[curve]
            label = LABELS[curve] if axis == 2 else ""
            trace = thinned(turns[:, :, axis].tolist())
            curves.append(Curve(trace, look, label, tip=str(axis + 1)))
    return tuple(curves)


def _plane(places: dict[str, np.ndarray], names: Sequence[str], title: str, *, equal: bool) -> str:
    figure, axes = plane(title, (names[0], names[1]), equal=equal)
    for curve, points in places.items():
        axes.plot(*points.T, **STROKES[curve].line, label=LABELS[curve])
        ends(axes, points, STROKES[curve])
    key(figure, axes)
    return svg(figure)


def _distance(pair: Pair) -> str:
    """The distance between them over time; beside the accuracy if the curves coincide."""
    times = pair.times[: len(pair.distance)]
    if pair.coincide:
        figure, axes = plane("The two curves are equal within the accuracy", ("t", "distance"))
        axes.plot(times, pair.distance, **DISTANCE.line)
        axes.axhline(PAGE.accuracy, **SERIES[5].line, label="requested accuracy")
        largest = max(PAGE.accuracy, float(pair.distance.max()))
        axes.set_ylim(-0.1 * largest, 1.25 * largest)
        key(figure, axes)
        return svg(figure)
    figure, axes = plane("Distance between the two curves over time", ("t", "distance"))
    stroke, last = DISTANCE, (times[-1], pair.distance[-1])
    axes.plot(times, pair.distance, **stroke.line)
    mark(axes, last, stroke.color, stroke.end, number(float(pair.distance[-1])))
    return svg(figure)


def _table(pair: Pair) -> str:
    """Cost and error of each solution."""
    rows = [
        [
            LABELS[curve],
            solution.engine,
            size_text(solution.error, 0),
            f"{solution.cost.run_seconds * 1e3:.3g} ms",
            number(float(solution.times[-1])),
        ]
        for curve, solution in pair.curves.items()
    ]
    return table(
        ("curve", "method", "error", "computing time", "last t"), rows, "Methods and errors"
    )


def _sentence(pair: Pair, largest: float) -> str:
    if pair.coincide:
        text = f"The straightest and the shortest curve coincide here, to {size_text(largest, 0)}."
    else:
        text = f"The straightest and the shortest curve separate by at most {largest:.4g}."
    kinds = {"autoparallel": "straightest", "geodesic": "shortest"}
    ends = [f"The {kinds[curve]} curve: {reason}" for curve, reason in pair.stops.items()]
    return " ".join([text, *ends])

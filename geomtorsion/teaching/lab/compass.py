"""compass: a ship that keeps its compass course, and the great circle from the same start."""

from __future__ import annotations

from math import cos, radians, sin

from geomtorsion.pictures.style import STROKES
from geomtorsion.spaces import solve_pair
from geomtorsion.teaching.exercises.worker_pool import Json
from geomtorsion.teaching.lab.paths import places_of, times_of
from geomtorsion.teaching.lab.settings import PAGE
from geomtorsion.teaching.lab.space_info import space_of
from geomtorsion.teaching.lab.turning import Curve, Film, thinned, turnable

LABELS = {
    "autoparallel": "keeps its compass course (straightest)",
    "geodesic": "sails along a great circle (shortest)",
}
# Colatitude and longitude of the start, near the equator.
START = (1.5, 0.0)


def compass(course: float) -> Json:
    """Both paths on the unit sphere.

    Parameters
    ----------
    course
        from north to east, degrees.

    Returns
    -------
    space: an HTML document with the turnable globe. title: its name.

    Examples
    --------
    >>> compass(75)["space"].count("great circle")
    1
    """
    angle = radians(float(course))
    pair = solve_pair(
        space_of("s2"),
        list(START),
        frame_velocity=[-cos(angle), sin(angle)],
        t=PAGE.sail,
        parameters={"R": 1.0},
        accuracy=PAGE.accuracy,
        samples=PAGE.samples,
    )
    curves = tuple(
        Curve(thinned(points.tolist()), STROKES[name], LABELS[name])
        for name, points in places_of(pair).items()
    )
    film = Film(
        "compass", "Two ships on one globe", ("x", "y", "north"), curves, times=times_of(pair),
        globe=1.0, equal=True, turn=1.3, note="Black dots: the start. Pale: behind the globe.",
    )  # fmt: skip
    return {"space": turnable(film), "title": f"Film: {film.title}"}

"""compass: a ship that keeps its compass course, and the great circle from the same start."""

from __future__ import annotations

from math import cos, radians, sin

from geomtorsion.spaces import solve_pair
from geomtorsion.teaching.exercises.worker_pool import Json
from geomtorsion.teaching.lab.paths import curves_of, times_of
from geomtorsion.teaching.lab.settings import PAGE
from geomtorsion.teaching.lab.space_info import space_of
from geomtorsion.teaching.lab.turning import Film, in_space
from geomtorsion.teaching.texts import ENGLISH, texts

# Colatitude and longitude of the start, near the equator.
START = (1.5, 0.0)


def compass(course: float, language: str = ENGLISH) -> Json:
    """Both paths on the unit sphere.

    Parameters
    ----------
    course
        from north to east, degrees.
    language
        of the words in the picture.

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
    text = texts("figures", "compass", language)
    scene = Film(
        "compass", text("title"), ("0°", "90°", text("north")),
        curves_of(pair, text), times=times_of(pair), globe=1.0, equal=True, turn=1.3,
        note=text("note"), language=language,
    )  # fmt: skip
    return in_space(scene)

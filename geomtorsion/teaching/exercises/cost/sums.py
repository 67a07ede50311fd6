"""7.2: two ways to add up a loop, and their orders."""

from collections.abc import Callable
from functools import cache
from itertools import count as counting
from math import cos, log2, pi, sin, sqrt

import numpy as np

from geomtorsion.codegen import numpy_function
from geomtorsion.geometry import Frame
from geomtorsion.loops import Loop, burgers_vector
from geomtorsion.spaces import load
from geomtorsion.teaching.exercises.authoring import (
    Draw,
    Mistake,
    Question,
    Step,
    Texts,
    Variant,
    tex,
)

# Relative error that the exercise requires, and the points of its coarse sums.
WANTED = 1e-10
COARSE = 64


def make(draw: Draw, text: Texts) -> Variant:
    """A circle in the angles of the paper; the seed chooses its radius and centre."""
    frame = load("so3").frame
    radius = draw.choice((0.5, 0.3, 0.4, 0.6, 0.7))
    first, middle = draw.choice((0.3, 0.1, 0.5, 0.7)), draw.choice((1.0, 1.1, 1.2, 1.3, 1.5))
    centre = [first, middle, 0.2]
    exact = cache(lambda: burgers_vector(frame, Loop.circle(centre, radius, plane=(0, 1))).vector)

    @cache
    def error(count: int, chords: bool) -> float:
        return float(abs(added(frame, centre, radius, count, chords) - exact()).max())

    def needed() -> int:
        size = float(abs(exact()).max())
        return next(n for n in counting(3) if error(n, False) < WANTED * size)

    def by_chords() -> float:
        size = float(abs(exact()).max())
        return COARSE * sqrt(error(COARSE, True) / (WANTED * size))

    return Variant(
        statement=text(
            "statement",
            coframe=tex.coframe(frame),
            radius=f"{radius:g}",
            first=f"{first:g}",
            middle=f"{middle:g}",
        ),
        questions=(
            Question(
                name="order",
                kind="number",
                prompt=text("order.prompt"),
                answer=lambda: log2(error(COARSE, True) / error(2 * COARSE, True)),
                errors=lambda: [
                    Mistake("forgotten", 1, text("order.forgotten")),
                    Mistake("another", 4, text("order.another")),
                ],
                tolerance=0.05,
                generic=(),
            ),
            Question(
                name="points",
                kind="number",
                prompt=text("points.prompt"),
                answer=needed,
                errors=lambda: [Mistake("forgotten", by_chords(), text("points.forgotten"))],
                tolerance=0.21,
                generic=(),
                points=2,
            ),
        ),
        hints=text.all("hints"),
        worked=lambda: _worked(text, error, needed),
    )


def added(frame: Frame, centre: list[float], radius: float, count: int, chords: bool) -> np.ndarray:
    """The sum over count points of a circle in the plane of the first two angles."""
    angles = [2 * pi * (k + 0.5 * chords) / count for k in range(count)]
    short = cos(pi / count) if chords else 1.0
    length = 2 * sin(pi / count) if chords else 2 * pi / count
    total = np.zeros(frame.dimension)
    for s in angles:
        place = (centre[0] + radius * short * cos(s), centre[1] + radius * short * sin(s),
                 centre[2])  # fmt: skip
        step = radius * length * np.array([-sin(s), cos(s), 0.0])
        total += coframe_at(frame, place) @ step
    return total


@cache
def coframe_function(frame: Frame):
    """The coframe as a function of numbers."""
    n = range(frame.dimension)
    entries = [frame.coframe.element(i, mu) for i in n for mu in n]
    return numpy_function(entries, frame.coordinates)


def coframe_at(frame: Frame, place: tuple[float, ...]) -> np.ndarray:
    """The coframe at a point, shape (n, n)."""
    return coframe_function(frame)(*place).reshape(frame.dimension, frame.dimension)


def _worked(
    text: Texts, error: Callable[[int, bool], float], needed: Callable[[], int]
) -> tuple[Step, ...]:
    """The errors of both sums, and the orders that follow from them."""
    chords = {count: error(count, True) for count in (COARSE, 2 * COARSE)}
    shown = "; ".join(
        text("worked.error", error=f"{value:.3g}", count=count) for count, value in chords.items()
    )
    count = needed()
    steps = "; ".join(
        text("worked.error", error=f"{error(n, False):.2g}", count=n)
        for n in range(count - 4, count + 1, 2)
    )
    return (
        Step(text("worked.1", errors=shown)),
        Step(text("worked.2"), "order", 2),
        Step(text("worked.3", errors=steps, count=count), "points", count),
    )

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
    Variant,
    steps,
    tex,
)

# Relative error that the exercise requires, and the points of its coarse sums.
WANTED = 1e-10
COARSE = 64


def make(draw: Draw) -> Variant:
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
        statement=(
            f"The body-fixed frame of a rigid body has the coframe $$e = {tex.coframe(frame)},$$ "
            f"in which each row is a one-form. A circle in the plane of $\\phi_1$ and $\\phi_2$ "
            f"has the radius ${radius:g}$ and the centre $\\phi = ({first:g}, {middle:g}, 0.2)$. "
            f"Its Burgers vector is computed in two "
            "ways from $N$ points $\\phi_k = \\phi(s_k)$ at equal angles $s_k$ around the "
            "circle:\n\n"
            r"- **chords**: $\sum_k e^i{}_\mu(\text{midpoint of the chord})\,"
            r"(\phi^\mu_{k+1}-\phi^\mu_k)$,"
            "\n"
            r"- **trapezoid**: $\frac{2\pi}{N}\sum_k e^i{}_\mu(\phi_k)\,"
            r"\frac{\mathrm{d}\phi^\mu}{\mathrm{d}s}(s_k)$."
        ),
        questions=(
            Question(
                name="order",
                kind="number",
                prompt="The error of the sum over **chords** decreases like $N^{-p}$. What is the "
                "order $p$?",
                answer=lambda: log2(error(COARSE, True) / error(2 * COARSE, True)),
                errors=lambda: [
                    Mistake(
                        "forgotten",
                        1,
                        "That is the order with an end of each chord. The midpoint is more "
                        "accurate.",
                    ),
                    Mistake("another", 4, "That is the order of Simpson's rule."),
                ],
                tolerance=0.05,
                generic=(),
            ),
            Question(
                name="points",
                kind="number",
                prompt="How many points does the **trapezoid** sum need for an error below "
                "$10^{-10}$ of the largest component? An answer within 20 % is accepted.",
                answer=needed,
                errors=lambda: [
                    Mistake(
                        "forgotten",
                        by_chords(),
                        "That is the number for the chords. For a smooth periodic function the "
                        "trapezoid sum converges faster than any power of $1/N$.",
                    )
                ],
                tolerance=0.21,
                generic=(),
                points=2,
            ),
        ),
        hints=steps(
            "Compute the sum over chords for $N = 64$ and $N = 128$. The ratio of the errors is "
            "$2^p$.",
            "The trapezoid sum over a period is exact for the harmonics $\\cos(m s)$ and "
            "$\\sin(m s)$ with $0 < m < N$. The error comes from the higher harmonics of the "
            "integrand, which decrease rapidly with $m$.",
            "In Python: `gt.numpy_function` makes the coframe a function of arrays. Ten to twenty "
            "points are enough.",
        ),
        worked=lambda: _worked(error, needed),
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


def _worked(error: Callable[[int, bool], float], needed: Callable[[], int]) -> tuple[Step, ...]:
    """The errors of both sums, and the orders that follow from them."""
    chords = {count: error(count, True) for count in (COARSE, 2 * COARSE)}
    shown = "; ".join(f"{value:.3g} for $N = {count}$" for count, value in chords.items())
    count = needed()
    steps = "; ".join(
        f"{error(n, False):.2g} for $N = {n}$" for n in range(count - 4, count + 1, 2)
    )
    return (
        Step(f"The errors of the sum over chords are {shown}."),
        Step(
            "With twice as many points the error is four times smaller: $2^p = 4$. The order is "
            "$p = 2$, as for the midpoint rule.",
            "order",
            2,
        ),
        Step(
            f"The errors of the trapezoid sum are {steps}. They decrease faster than any power of "
            f"$1/N$. With {count} points the error is below $10^{{-10}}$ of the largest component.",
            "points",
            count,
        ),
    )

"""5.3: a loop in the rotations that is not small, in numbers."""

import numpy as np

from geomtorsion.geometry import cartan
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


def make(draw: Draw) -> Variant:
    """A circle in the plane of two angles; the seed chooses centre, radius and plane."""
    frame = load("so3").frame
    centre = [draw.choice((0.3, 0.2, 0.5, 0.8)), draw.choice((1.0, 0.9, 1.1, 1.3)), 0.2]
    radius, plane = draw.choice((0.5, 0.6, 0.4)), draw.choice(((0, 1), (1, 2)))
    loop = Loop.circle(centre, radius, plane=plane)
    one, two = (k + 1 for k in plane)

    def estimate() -> list[float]:
        place = dict(zip(frame.coordinates, centre, strict=True))
        torsion = cartan(frame).torsion.T.at(place)
        area = float(loop.area[plane])
        legs = frame.coframe.at(place)
        return [float(legs[k] @ torsion[plane]) * area for k in range(3)]

    return Variant(
        statement=(
            f"In the frame of a body, $$e = {tex.coframe(frame)},$$ a circle of radius "
            f"${radius:g}$ about $\\phi = ({', '.join(f'{x:g}' for x in centre)})$ runs once round "
            f"in the plane of $\\phi_{one}$ and $\\phi_{two}$, from the first towards the second."
        ),
        questions=(
            Question(
                name="burgers",
                kind="number",
                prompt=r"The three components of $b^k = \oint e^k{}_\mu\,\mathrm{d}\phi^\mu$ in "
                "the frame, to three digits, as `[b1, b2, b3]`.",
                answer=lambda: burgers_vector(frame, loop).vector,
                errors=lambda: [
                    Mistake("direction", burgers_vector(frame, loop.reversed()).vector),
                    Mistake("basis", burgers_vector(frame, loop).in_coordinates()),
                    Mistake(
                        "forgotten",
                        estimate(),
                        "That is the torsion at the centre times the area: the loop is too large "
                        "for that.",
                    ),
                ],
                shape=(3,),
                label="b",
                tolerance=2e-3,
                points=2,
            ),
        ),
        hints=steps(
            r"Put the circle in: $\phi(s)$ with its derivative, and integrate $s$ from $0$ to "
            r"$2\pi$, numerically.",
            "The sum over equally many steps of a periodic function is already very accurate with "
            "a few dozen of them.",
            "In Python: `gt.burgers_vector(frame, gt.Loop.circle(centre, radius, plane=...))`.",
        ),
        worked=lambda: _worked(centre, radius, plane),
    )


def _worked(centre: list[float], radius: float, plane: tuple[int, int]) -> tuple[Step, ...]:
    """The loop integral as a sum over equal steps, with the coframe written out."""

    def total(count: int) -> np.ndarray:
        found = np.zeros(3)
        for s in 2 * np.pi * np.arange(count) / count:
            place, slope = np.array(centre), np.zeros(3)
            place[list(plane)] += radius * np.array([np.cos(s), np.sin(s)])
            slope[list(plane)] = radius * np.array([-np.sin(s), np.cos(s)])
            (s1, s2), (c1, c2) = np.sin(place[:2]), np.cos(place[:2])
            coframe = np.array([[0, s1, -c1 * s2], [0, c1, s1 * s2], [1, 0, c2]])
            found += coframe @ slope * 2 * np.pi / count
        return found

    one, two = (k + 1 for k in plane)
    sums = {
        count: ", ".join(f"{round(x, 6) + 0.0:.6f}" for x in total(count)) for count in (6, 12, 48)
    }
    return (
        Step(
            f"On the circle $\\phi_{one} = {centre[plane[0]]:g} + {radius:g}\\cos s$ and "
            f"$\\phi_{two} = {centre[plane[1]]:g} + {radius:g}\\sin s$; the third angle is "
            "constant. Both derivatives with respect to $s$ are put into "
            r"$b^k = \int_0^{2\pi} e^k{}_\mu\,\phi'^\mu\,\mathrm{d}s$."
        ),
        Step(
            r"The sum over $N$ equal steps, $\frac{2\pi}{N}\sum_k e^i{}_\mu\phi'^\mu(s_k)$, is "
            "the vector "
            + "; ".join(f"$({vector})$ with $N = {count}$" for count, vector in sums.items())
            + "."
        ),
        Step("It has settled: three digits are right with twelve steps.", "burgers", total(48)),
    )

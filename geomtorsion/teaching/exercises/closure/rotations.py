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
            "The body-fixed frame of a rigid body has the coframe "
            f"$$e = {tex.coframe(frame)},$$ in which each row is a one-form. In the plane of the "
            f"angles $\\phi_{one}$ and $\\phi_{two}$, a circle of radius ${radius:g}$ with the "
            f"centre $\\phi = ({', '.join(f'{x:g}' for x in centre)})$ is traversed once, from "
            f"$\\phi_{one}$ towards $\\phi_{two}$."
        ),
        questions=(
            Question(
                name="burgers",
                kind="number",
                prompt="Find the three frame components of the Burgers vector "
                r"$b^k = \oint e^k{}_\mu\,\mathrm{d}\phi^\mu$ to three digits, as `[b1, b2, b3]`.",
                answer=lambda: burgers_vector(frame, loop).vector,
                errors=lambda: [
                    Mistake("direction", burgers_vector(frame, loop.reversed()).vector),
                    Mistake("basis", burgers_vector(frame, loop).in_coordinates()),
                    Mistake(
                        "forgotten",
                        estimate(),
                        "That is the torsion at the centre times the area. The loop is too large "
                        "for this estimate.",
                    ),
                ],
                shape=(3,),
                label="b",
                tolerance=2e-3,
                points=2,
            ),
        ),
        hints=steps(
            r"Describe the circle by an angle $s$. Insert $\phi(s)$ and its derivative into the "
            r"loop integral, and integrate numerically over $s$ from $0$ to $2\pi$.",
            "For a smooth periodic function, a sum over equal steps is very accurate: a few dozen "
            "steps are enough.",
            "In Python: `gt.burgers_vector(frame, gt.Loop.circle(centre, radius, plane=...))`.",
        ),
        worked=lambda: _worked(centre, radius, plane),
    )


def _worked(centre: list[float], radius: float, plane: tuple[int, int]) -> tuple[Step, ...]:
    """The loop integral as a sum over equal steps, with the coframe written out."""

    def total(count: int) -> np.ndarray:
        integral = np.zeros(3)
        for s in 2 * np.pi * np.arange(count) / count:
            place, slope = np.array(centre), np.zeros(3)
            place[list(plane)] += radius * np.array([np.cos(s), np.sin(s)])
            slope[list(plane)] = radius * np.array([-np.sin(s), np.cos(s)])
            (s1, s2), (c1, c2) = np.sin(place[:2]), np.cos(place[:2])
            coframe = np.array([[0, s1, -c1 * s2], [0, c1, s1 * s2], [1, 0, c2]])
            integral += coframe @ slope * 2 * np.pi / count
        return integral

    one, two = (k + 1 for k in plane)
    sums = {
        count: ", ".join(f"{round(x, 6) + 0.0:.6f}" for x in total(count)) for count in (6, 12, 48)
    }
    return (
        Step(
            f"On the circle $\\phi_{one} = {centre[plane[0]]:g} + {radius:g}\\cos s$ and "
            f"$\\phi_{two} = {centre[plane[1]]:g} + {radius:g}\\sin s$; the remaining angle is "
            "constant. Insert the derivatives with respect to $s$ into "
            r"$b^k = \int_0^{2\pi} e^k{}_\mu\,\phi'^\mu\,\mathrm{d}s$."
        ),
        Step(
            r"The sum over $N$ equal steps, $\frac{2\pi}{N}\sum_n e^k{}_\mu\phi'^\mu(s_n)$, is "
            + "; ".join(f"$({vector})$ for $N = {count}$" for count, vector in sums.items())
            + "."
        ),
        Step(
            "The sum has converged: three digits are right with twelve steps.", "burgers", total(48)
        ),
    )

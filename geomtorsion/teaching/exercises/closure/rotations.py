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
    Texts,
    Variant,
    tex,
)


def make(draw: Draw, text: Texts) -> Variant:
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
        statement=text(
            "statement",
            coframe=tex.coframe(frame),
            one=one,
            two=two,
            radius=f"{radius:g}",
            centre=", ".join(f"{x:g}" for x in centre),
        ),
        questions=(
            Question(
                name="burgers",
                kind="number",
                prompt=text("burgers.prompt"),
                answer=lambda: burgers_vector(frame, loop).vector,
                errors=lambda: [
                    Mistake("direction", burgers_vector(frame, loop.reversed()).vector),
                    Mistake("basis", burgers_vector(frame, loop).in_coordinates()),
                    Mistake("forgotten", estimate(), text("burgers.forgotten")),
                ],
                shape=(3,),
                label="b",
                tolerance=2e-3,
                points=2,
            ),
        ),
        hints=text.all("hints"),
        worked=lambda: _worked(text, centre, radius, plane),
    )


def _worked(
    text: Texts, centre: list[float], radius: float, plane: tuple[int, int]
) -> tuple[Step, ...]:
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
            text(
                "worked.1",
                one=one,
                across=f"{centre[plane[0]]:g}",
                radius=f"{radius:g}",
                two=two,
                up=f"{centre[plane[1]]:g}",
            )
        ),
        Step(
            text(
                "worked.2",
                sums="; ".join(
                    text("worked.sum", vector=vector, count=count) for count, vector in sums.items()
                ),
            )
        ),
        Step(text("worked.3"), "burgers", total(48)),
    )

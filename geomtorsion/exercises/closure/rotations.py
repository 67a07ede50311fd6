"""5.3: a loop in the rotations that is not small, in numbers."""

from random import Random

from geomtorsion.exercises.authoring import Mistake, Question, Variant, steps
from geomtorsion.geometry import cartan
from geomtorsion.loops import Loop, burgers_vector
from geomtorsion.spaces import load


def make(draw: Random, seed: int) -> Variant:
    """A circle in the plane of two angles; the seed chooses centre, radius and plane."""
    frame = load("so3").frame
    centre = [0.3, 1.0, 0.2]
    radius, plane = 0.5, (0, 1)
    if seed:
        centre = [draw.choice((0.2, 0.5, 0.8)), draw.choice((0.9, 1.1, 1.3)), 0.4]
        radius, plane = draw.choice((0.3, 0.4, 0.5)), draw.choice(((0, 1), (1, 2)))
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
            "In the angles of the paper (coframe of exercise 1.2, seed 0) a circle of radius "
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
    )

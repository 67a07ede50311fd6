"""5.5: a vector that is transported around a loop on the sphere comes back rotated."""

from functools import cache
from math import cos, pi

from geomtorsion.geometry import cartan, levi_civita
from geomtorsion.loops import Loop, develop
from geomtorsion.spaces import load
from geomtorsion.teaching.exercises.authoring import Draw, Mistake, Question, Step, Variant, steps


def make(draw: Draw) -> Variant:
    """A patch between two circles of latitude and two meridians; the seed chooses them."""
    frame = load("s2").frame
    low, high = draw.choice((0.6, 0.4, 0.5, 0.7)), draw.choice((1.1, 1.2, 1.3, 1.4))
    width = draw.choice((0.4, 0.3, 0.5, 0.8, 1.0))
    loop = Loop.plaquette([low, 0.0], (high - low, width), plane=(0, 1))

    @cache
    def angle(path: Loop, connection=levi_civita) -> float:
        return float(develop(connection(frame), path, parameters={"R": 1}).angle or 0.0)

    return Variant(
        statement=(
            r"On the unit sphere, $e^1 = \mathrm{d}\theta$, $e^2 = \sin\theta\,\mathrm{d}\phi$, a "
            f"loop runs along $\\phi = 0$ from $\\theta = {low:g}$ to ${high:g}$, then along the "
            f"circle of latitude to $\\phi = {width:g}$, back to $\\theta = {low:g}$ and back to "
            "the start. A vector is carried parallel along it."
        ),
        questions=(
            Question(
                name="riemann",
                kind="number",
                prompt="By which angle (in radians) is the vector turned, if it is carried by the "
                r"**Levi-Civita** connection? Positive: from $e_\theta$ towards $e_\phi$.",
                unit="rad",
                answer=lambda: angle(loop),
                errors=lambda: [
                    Mistake("direction", angle(loop.reversed())),
                    Mistake("cartan", angle(loop, cartan)),
                    Mistake(
                        "forgotten",
                        (high - low) * width,
                        r"That is the area in the coordinates; on the sphere it is "
                        r"$\int\sin\theta\,\mathrm{d}\theta\,\mathrm{d}\phi$.",
                    ),
                ],
                tolerance=2e-3,
                points=2,
            ),
            Question(
                name="cartan",
                kind="number",
                prompt="And by the **Cartan** connection of the two legs?",
                unit="rad",
                answer=lambda: angle(loop, cartan),
                errors=lambda: [Mistake("levi-civita", angle(loop))],
                tolerance=1e-9,
                generic=(),
            ),
        ),
        hints=steps(
            "On a surface the angle is the integral of Gauss's curvature over what is enclosed.",
            f"The area is $(\\cos {low:g} - \\cos {high:g})\\cdot {width:g}$; it must be below "
            f"{2 * pi:.4f}.",
            "The legs themselves are parallel for the Cartan connection: they come back as they "
            "went.",
        ),
        worked=lambda: _worked(low, high, width),
    )


def _worked(low: float, high: float, width: float) -> tuple[Step, ...]:
    """Curvature one, times the area."""
    area = (cos(low) - cos(high)) * width
    return (
        Step(
            "On the unit sphere Gauss's curvature is 1: the angle is the area enclosed, positive "
            r"as the loop runs from $e_\theta$ towards $e_\phi$."
        ),
        Step(
            r"The area is $\int\sin\theta\,\mathrm{d}\theta\,\mathrm{d}\phi = "
            f"(\\cos {low:g} - \\cos {high:g})\\cdot {width:g} = {area:.6g}$.",
            "riemann",
            area,
        ),
        Step(
            "For the Cartan connection the legs are parallel, so that every vector comes back as "
            "it went: the angle is 0.",
            "cartan",
            0,
        ),
    )

"""5.5: a vector that is transported around a loop on the sphere comes back rotated."""

from functools import cache
from math import cos

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
            r"The unit sphere has the coframe $e^1 = \mathrm{d}\theta$, $e^2 = "
            r"\sin\theta\,\mathrm{d}\phi$. A loop runs along the meridian $\phi = 0$ from "
            f"$\\theta = {low:g}$ to $\\theta = {high:g}$, then along the circle of latitude to "
            f"$\\phi = {width:g}$, back along this meridian to $\\theta = {low:g}$, and along the "
            "circle of latitude back to its start. A vector is parallel transported along it."
        ),
        questions=(
            Question(
                name="riemann",
                kind="number",
                prompt="By which angle (in radians) is the vector rotated if it is transported by "
                "the **Levi-Civita** connection? A rotation from the direction of increasing "
                r"$\theta$ towards increasing $\phi$ is positive.",
                unit="rad",
                answer=lambda: angle(loop),
                errors=lambda: [
                    Mistake("direction", angle(loop.reversed())),
                    Mistake("cartan", angle(loop, cartan)),
                    Mistake(
                        "forgotten",
                        (high - low) * width,
                        r"That is the area in the coordinate plane. On the sphere the area is "
                        r"$\int\sin\theta\,\mathrm{d}\theta\,\mathrm{d}\phi$.",
                    ),
                ],
                tolerance=2e-3,
                points=2,
            ),
            Question(
                name="cartan",
                kind="number",
                prompt="By which angle is it rotated if it is transported by the **Cartan** "
                "connection, for which the two legs are parallel everywhere?",
                unit="rad",
                answer=lambda: angle(loop, cartan),
                errors=lambda: [Mistake("levi-civita", angle(loop))],
                tolerance=1e-9,
                generic=(),
            ),
        ),
        hints=steps(
            "For the Levi-Civita connection on a surface, the angle is the integral of the "
            "Gaussian curvature over the enclosed area. On the unit sphere the curvature is 1.",
            f"The enclosed area is $(\\cos {low:g} - \\cos {high:g})\\cdot {width:g}$.",
            "The legs are parallel for the Cartan connection: each leg returns unchanged.",
        ),
        worked=lambda: _worked(low, high, width),
    )


def _worked(low: float, high: float, width: float) -> tuple[Step, ...]:
    """Curvature one, times the area."""
    area = (cos(low) - cos(high)) * width
    return (
        Step(
            "On the unit sphere the Gaussian curvature is 1, so the angle equals the enclosed "
            r"area. It is positive because the loop runs from $\theta$ towards $\phi$."
        ),
        Step(
            r"The area is $\int\sin\theta\,\mathrm{d}\theta\,\mathrm{d}\phi = "
            f"(\\cos {low:g} - \\cos {high:g})\\cdot {width:g} = {area:.6g}$.",
            "riemann",
            area,
        ),
        Step(
            "For the Cartan connection the legs are parallel, so every vector returns unchanged: "
            "the angle is 0.",
            "cartan",
            0,
        ),
    )

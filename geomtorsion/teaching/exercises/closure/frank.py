"""5.5: a vector that is transported around a loop on the sphere comes back rotated."""

from functools import cache
from math import cos

from geomtorsion.geometry import cartan, levi_civita
from geomtorsion.loops import Loop, develop
from geomtorsion.spaces import load
from geomtorsion.teaching.exercises.authoring import Draw, Mistake, Question, Step, Texts, Variant


def make(draw: Draw, text: Texts) -> Variant:
    """A patch between two circles of latitude and two meridians; the seed chooses them."""
    frame = load("s2").frame
    low, high = draw.choice((0.6, 0.4, 0.5, 0.7)), draw.choice((1.1, 1.2, 1.3, 1.4))
    width = draw.choice((0.4, 0.3, 0.5, 0.8, 1.0))
    loop = Loop.plaquette([low, 0.0], (high - low, width), plane=(0, 1))

    @cache
    def angle(path: Loop, connection=levi_civita) -> float:
        return float(develop(connection(frame), path, parameters={"R": 1}).angle or 0.0)

    return Variant(
        statement=text("statement", low=f"{low:g}", high=f"{high:g}", width=f"{width:g}"),
        questions=(
            Question(
                name="riemann",
                kind="number",
                prompt=text("riemann.prompt"),
                unit="rad",
                answer=lambda: angle(loop),
                errors=lambda: [
                    Mistake("direction", angle(loop.reversed())),
                    Mistake("cartan", angle(loop, cartan)),
                    Mistake("forgotten", (high - low) * width, text("riemann.forgotten")),
                ],
                tolerance=2e-3,
                points=2,
            ),
            Question(
                name="cartan",
                kind="number",
                prompt=text("cartan.prompt"),
                unit="rad",
                answer=lambda: angle(loop, cartan),
                errors=lambda: [Mistake("levi-civita", angle(loop))],
                tolerance=1e-9,
                generic=(),
            ),
        ),
        hints=text.all("hints", low=f"{low:g}", high=f"{high:g}", width=f"{width:g}"),
        worked=lambda: _worked(text, low, high, width),
    )


def _worked(text: Texts, low: float, high: float, width: float) -> tuple[Step, ...]:
    """Curvature one, times the area."""
    area = (cos(low) - cos(high)) * width
    return (
        Step(text("worked.1")),
        Step(
            text(
                "worked.2", low=f"{low:g}", high=f"{high:g}", width=f"{width:g}", area=f"{area:.6g}"
            ),
            "riemann",
            area,
        ),
        Step(text("worked.3"), "cartan", 0),
    )

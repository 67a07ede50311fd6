"""4.4: steering by compass against the great circle."""

from functools import cache
from math import atan2, cos, log, pi, radians, sin, tan

from geomtorsion.curves import CurveProblem, autoparallel, geodesic
from geomtorsion.geometry import cartan
from geomtorsion.ode import solve
from geomtorsion.spaces import load
from geomtorsion.teaching.exercises.authoring import Draw, Mistake, Question, Step, Texts, Variant


def make(draw: Draw, text: Texts) -> Variant:
    """A ship on the unit sphere; the seed chooses start, course and distance."""
    frame = load("s2").frame
    colatitude = draw.choice((1.0, 0.8, 0.9, 1.1))
    course = draw.choice((60, 50, 70, 75, 105, 110))
    last = draw.choice((1.0, 0.6, 0.8, 1.2))
    # Course from north to east: north is against the colatitude.
    u = [-cos(radians(course)), sin(radians(course))]
    begin = {"start": [colatitude, 0.0], "frame_velocity": u, "parameters": {"R": 1}}
    steered, great = autoparallel(cartan(frame), **begin), geodesic(frame, **begin)

    @cache
    def longitude(problem: CurveProblem) -> float:
        return float(solve(problem, [last]).coordinates[-1, 1])

    def gap() -> float:
        one, two = (solve(p, [last]).coordinates[-1] for p in (steered, great))
        cosine = cos(one[0]) * cos(two[0]) + sin(one[0]) * sin(two[0]) * cos(one[1] - two[1])
        return float(max(-1.0, min(1.0, cosine)))

    return Variant(
        statement=text("statement", colatitude=f"{colatitude:g}", course=course, last=f"{last:g}"),
        questions=(
            Question(
                name="compass",
                kind="number",
                prompt=text("compass.prompt"),
                unit="rad",
                answer=lambda: longitude(steered),
                errors=lambda: [
                    Mistake("levi-civita", longitude(great), text("compass.levi-civita"))
                ],
                tolerance=1e-3,
            ),
            Question(
                name="circle",
                kind="number",
                prompt=text("circle.prompt"),
                unit="rad",
                answer=lambda: longitude(great),
                errors=lambda: [Mistake("cartan", longitude(steered), text("circle.cartan"))],
                tolerance=1e-3,
            ),
            Question(
                name="cosine",
                kind="number",
                prompt=text("cosine.prompt"),
                answer=gap,
                tolerance=1e-4,
                generic=(),
            ),
        ),
        hints=text.all("hints", course=course, radians=f"{course * pi / 180:.4f}"),
        worked=lambda: _worked(text, colatitude, radians(course), last),
    )


def _worked(text: Texts, colatitude: float, course: float, last: float) -> tuple[Step, ...]:
    """The loxodrome in closed form, the great circle in space."""
    end = colatitude - cos(course) * last
    along = tan(course) * log(tan(colatitude / 2) / tan(end / 2))
    start = (sin(colatitude), 0.0, cos(colatitude))
    speed = (-cos(course) * cos(colatitude), sin(course), cos(course) * sin(colatitude))
    x, y, z = (a * cos(last) + b * sin(last) for a, b in zip(start, speed, strict=True))
    ship = (sin(end) * cos(along), sin(end) * sin(along), cos(end))
    cosine = x * ship[0] + y * ship[1] + z * ship[2]
    return (
        Step(text("worked.1", end=f"{end:.6g}")),
        Step(text("worked.2", along=f"{along:.6g}"), "compass", along),
        Step(
            text(
                "worked.3",
                start=", ".join(f"{a:.5g}" for a in start),
                velocity=", ".join(f"{a:.5g}" for a in speed),
                x=f"{x:.5g}",
                y=f"{y:.5g}",
                z=f"{z:.5g}",
                longitude=f"{atan2(y, x):.6g}",
            ),
            "circle",
            atan2(y, x),
        ),
        Step(
            text("worked.4", ship=", ".join(f"{a:.5g}" for a in ship), cosine=f"{cosine:.6g}"),
            "cosine",
            cosine,
        ),
    )

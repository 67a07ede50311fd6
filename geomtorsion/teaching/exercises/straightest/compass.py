"""4.4: steering by compass against the great circle."""

from functools import cache
from math import atan2, cos, log, pi, radians, sin, tan

from geomtorsion.curves import CurveProblem, autoparallel, geodesic
from geomtorsion.geometry import cartan
from geomtorsion.ode import solve
from geomtorsion.spaces import load
from geomtorsion.teaching.exercises.authoring import Draw, Mistake, Question, Step, Variant, steps


def make(draw: Draw) -> Variant:
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
        statement=(
            "A ship on the unit sphere starts at colatitude "
            f"$\\theta = {colatitude:g}$ and longitude $0$, with speed 1 on the course ${course}$ "
            f"degrees (from north towards east), and sails for the time ${last:g}$. On the first "
            "voyage it keeps the compass course, an autoparallel (straightest line) of the compass "
            "frame. On the second voyage it follows the great circle, a geodesic (shortest line)."
        ),
        questions=(
            Question(
                name="compass",
                kind="number",
                prompt="Find the longitude of the end point by compass, in radians.",
                unit="rad",
                answer=lambda: longitude(steered),
                errors=lambda: [
                    Mistake(
                        "levi-civita",
                        longitude(great),
                        "That is the longitude on the great circle.",
                    )
                ],
                tolerance=1e-3,
            ),
            Question(
                name="circle",
                kind="number",
                prompt="Find the longitude of the end point on the great circle, in radians.",
                unit="rad",
                answer=lambda: longitude(great),
                errors=lambda: [
                    Mistake(
                        "cartan", longitude(steered), "That is the longitude on the compass course."
                    )
                ],
                tolerance=1e-3,
            ),
            Question(
                name="cosine",
                kind="number",
                prompt="How far apart are the two end points? Give the cosine of the angle between "
                "them, seen from the centre of the sphere.",
                answer=gap,
                tolerance=1e-4,
                generic=(),
            ),
        ),
        hints=steps(
            r"By compass: $\dot\theta = -\cos\kappa$ and $\dot\phi = \sin\kappa/\sin\theta$ with "
            r"constant $\kappa$.",
            r"$\phi = -\tan\kappa\,[\ln\tan(\theta/2)]$ between start and end.",
            "On the great circle, let $x_0$ be the unit vector of the start and $v_0$ the unit "
            r"vector of the velocity: $x(t) = x_0\cos t + v_0\sin t$.",
            f"The course in radians is {course}*pi/180, about {course * pi / 180:.4f}.",
        ),
        worked=lambda: _worked(colatitude, radians(course), last),
    )


def _worked(colatitude: float, course: float, last: float) -> tuple[Step, ...]:
    """The loxodrome in closed form, the great circle in space."""
    end = colatitude - cos(course) * last
    along = tan(course) * log(tan(colatitude / 2) / tan(end / 2))
    start = (sin(colatitude), 0.0, cos(colatitude))
    speed = (-cos(course) * cos(colatitude), sin(course), cos(course) * sin(colatitude))
    x, y, z = (a * cos(last) + b * sin(last) for a, b in zip(start, speed, strict=True))
    ship = (sin(end) * cos(along), sin(end) * sin(along), cos(end))
    cosine = x * ship[0] + y * ship[1] + z * ship[2]
    return (
        Step(
            r"By compass $\dot\theta = -\cos\kappa$, so the colatitude at the end is "
            f"$\\theta = {end:.6g}$."
        ),
        Step(
            r"The integral of $\dot\phi = \sin\kappa/\sin\theta$ is $\phi = "
            r"\tan\kappa\,\ln(\tan(\theta_0/2)/\tan(\theta/2))$, here "
            f"${along:.6g}$.",
            "compass",
            along,
        ),
        Step(
            r"On the great circle $x(t) = x_0\cos t + v_0\sin t$ with the start "
            f"$x_0 = ({', '.join(f'{a:.5g}' for a in start)})$ and the velocity "
            f"$v_0 = ({', '.join(f'{a:.5g}' for a in speed)})$. The end point is "
            f"$({x:.5g}, {y:.5g}, {z:.5g})$, with the longitude ${atan2(y, x):.6g}$.",
            "circle",
            atan2(y, x),
        ),
        Step(
            "The end point by compass is "
            f"$({', '.join(f'{a:.5g}' for a in ship)})$. The scalar product of both end points is "
            f"${cosine:.6g}$.",
            "cosine",
            cosine,
        ),
    )

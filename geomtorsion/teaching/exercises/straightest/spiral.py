"""4.1: the end point of an autoparallel of the polar frame."""

from functools import cache
from math import log

from geomtorsion.curves import CurveProblem, autoparallel, geodesic
from geomtorsion.geometry import cartan
from geomtorsion.ode import solve
from geomtorsion.spaces import load
from geomtorsion.teaching.exercises.authoring import Draw, Mistake, Question, Step, Texts, Variant


def make(draw: Draw, text: Texts) -> Variant:
    """Radius, speeds and time; the seed chooses them."""
    frame = load("flat_polar").frame
    radius = draw.choice((1.0, 0.5, 1.5, 2.0))
    out, around = draw.choice((0.5, 0.4, 0.8)), draw.choice((1, 2, 3))
    last = draw.choice((2.0, 1.0, 1.5, 2.5))
    start = [radius, 0.2]
    straight = autoparallel(cartan(frame), start, frame_velocity=[out, around])
    short = geodesic(frame, start, frame_velocity=[out, around])
    mistaken = autoparallel(cartan(frame), start, velocity=[out, around])
    return Variant(
        statement=text(
            "statement",
            radius=f"{radius:g}",
            out=f"{out:g}",
            around=f"{around:g}",
            last=f"{last:g}",
        ),
        questions=(
            _number(text, "radius", text("radius.prompt"), "",
                    0, last, straight, short, mistaken),
            _number(text, "angle", text("angle.prompt"), "rad",
                    1, last, straight, short, mistaken),
        ),
        hints=text.all("hints"),
        worked=lambda: _worked(text, radius, out, around, last),
    )  # fmt: skip


def _number(
    text: Texts, name: str, prompt: str, unit: str, k: int, last: float,
    straight: CurveProblem, short: CurveProblem, mistaken: CurveProblem,
) -> Question:  # fmt: skip
    """One coordinate at the end, on the requested line and on the lines it is confused with."""

    @cache
    def at_end(problem: CurveProblem) -> float:
        return float(solve(problem, [last], 1e-12).coordinates[-1, k])

    return Question(
        name=name,
        kind="number",
        prompt=prompt,
        unit=unit,
        answer=lambda: at_end(straight),
        errors=lambda: [
            Mistake("levi-civita", at_end(short), text("end.levi-civita")),
            Mistake("basis", at_end(mistaken), text("end.basis")),
        ],
        tolerance=1e-3,
    )


def _worked(text: Texts, radius: float, out: float, around: float, last: float) -> tuple[Step, ...]:
    """Two integrals, one after the other."""
    end = radius + out * last
    turned = 0.2 + around / out * log(end / radius)
    return (
        Step(text("worked.1", radius=f"{radius:g}", out=f"{out:g}")),
        Step(text("worked.2", last=f"{last:g}", end=f"{end:g}"), "radius", end),
        Step(
            text(
                "worked.3",
                around=f"{around:g}",
                out=f"{out:g}",
                end=f"{end:g}",
                radius=f"{radius:g}",
                turned=f"{turned:.6g}",
            ),
            "angle",
            turned,
        ),
    )

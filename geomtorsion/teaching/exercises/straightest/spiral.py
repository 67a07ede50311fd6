"""4.1: the end point of an autoparallel of the polar frame."""

from functools import cache
from math import log

from geomtorsion.curves import CurveProblem, autoparallel, geodesic
from geomtorsion.geometry import cartan
from geomtorsion.ode import solve
from geomtorsion.spaces import load
from geomtorsion.teaching.exercises.authoring import Draw, Mistake, Question, Step, Variant, steps


def make(draw: Draw) -> Variant:
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
        statement=(
            r"In the plane let $e^1 = \mathrm{d}r$ and $e^2 = r\,\mathrm{d}\phi$. A traveller "
            f"starts at $r = {radius:g}$, $\\phi = 0.2$ and keeps the frame components of the "
            f"velocity constant: $u^1 = e^1{{}}_\\mu\\dot q^\\mu = {out:g}$, $u^2 = {around:g}$. "
            "The path is an autoparallel, a **straightest** line of the Cartan connection. Follow "
            f"it to $t = {last:g}$."
        ),
        questions=(
            _number("radius", "Find the radius $r$ at the end.", "",
                    0, last, straight, short, mistaken),
            _number("angle", r"Find the angle $\phi$ at the end, in radians (with all full turns).",
                    "rad", 1, last, straight, short, mistaken),
        ),
        hints=steps(
            r"The velocity in coordinates is $\dot r = u^1$, $\dot\phi = u^2/r$.",
            "The radius grows linearly. Insert it into the equation for the angle and integrate.",
            r"$\phi = \phi_0 + (u^2/u^1)\,\ln(1 + u^1 t/r_0)$: a spiral.",
        ),
        worked=lambda: _worked(radius, out, around, last),
    )  # fmt: skip


def _number(
    name: str, prompt: str, unit: str, k: int, last: float,
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
            Mistake(
                "levi-civita",
                at_end(short),
                "That is the value on the geodesic, a straight line in the plane. The question is "
                "about the autoparallel of the frame.",
            ),
            Mistake(
                "basis",
                at_end(mistaken),
                "The frame components $u^i$ were used as coordinate velocities.",
            ),
        ],
        tolerance=1e-3,
    )


def _worked(radius: float, out: float, around: float, last: float) -> tuple[Step, ...]:
    """Two integrals, one after the other."""
    end = radius + out * last
    turned = 0.2 + around / out * log(end / radius)
    return (
        Step(
            r"The frame components are constant: $\dot r = u^1$ and $r\,\dot\phi = u^2$, so "
            f"$r = {radius:g} + {out:g}\\,t$."
        ),
        Step(f"At $t = {last:g}$ this is $r = {end:g}$.", "radius", end),
        Step(
            r"$\phi = \phi_0 + \int u^2/r\,\mathrm{d}t = \phi_0 + (u^2/u^1)\,\ln(r/r_0)$, here "
            f"$0.2 + ({around:g}/{out:g})\\,\\ln({end:g}/{radius:g}) = {turned:.6g}$.",
            "angle",
            turned,
        ),
    )

"""4.1: the end point of the straightest line of the polar frame."""

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
            f"velocity, $u^1 = e^1{{}}_\\mu\\dot q^\\mu = {out:g}$ and $u^2 = {around:g}$, for "
            f"ever: that is the **straightest** line of the Cartan connection. Follow it to "
            f"$t = {last:g}$."
        ),
        questions=(
            _number("radius", "The radius $r$ there.", "", 0, last, straight, short, mistaken),
            _number("angle", r"The angle $\phi$ there, in radians (not reduced by turns).", "rad",
                    1, last, straight, short, mistaken),
        ),
        hints=steps(
            r"The velocity in coordinates is $\dot r = u^1$, $\dot\phi = u^2/r$.",
            "The radius grows steadily; put it into the equation for the angle and integrate.",
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
                "That is where the shortest line leads, straight on in the plane; asked is the "
                "straightest line of the frame.",
            ),
            Mistake(
                "basis",
                at_end(mistaken),
                "The frame components $u^i$ were taken for coordinate velocities.",
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
            r"The frame components are constant: $\dot r = u^1$ and $r\,\dot\phi = u^2$, so that "
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

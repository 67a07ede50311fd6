"""7.1: how many digits a tiny loop loses."""

import sys
from functools import cache
from math import log10
from statistics import median

from geomtorsion.loops import BurgersVector, Loop, burgers_vector
from geomtorsion.spaces import load
from geomtorsion.teaching.exercises.authoring import Draw, Mistake, Question, Step, Texts, Variant

PLACES = 5
# Digits that double precision has.
ALL_DIGITS = sys.float_info.dig + 1


def make(draw: Draw, text: Texts) -> Variant:
    """A circle in the angles of the paper; the seed chooses how tiny."""
    frame = load("so3").frame
    decades = draw.choice((8, 5, 6, 7, 9, 10))
    middle, plane = draw.choice((1.0, 0.6, 0.8, 1.2, 1.4)), draw.choice(((0, 1), (1, 2)))
    one, two = (k + 1 for k in plane)
    # Rounding errors scatter: the median over several positions is more reliable than one value.
    loops = [
        Loop.circle([0.3, middle + 0.1 * k, 0.2], 10.0**-decades, plane=plane)
        for k in range(PLACES)
    ]

    @cache
    def found() -> list[BurgersVector]:
        return [burgers_vector(frame, loop) for loop in loops]

    def by_line() -> float:
        gaps = [float(abs(b.check.line - b.vector).max()) / b.magnitude for b in found()]
        return -log10(median(gaps))

    def by_flux() -> float:
        return min(ALL_DIGITS, -log10(median(b.relative_error for b in found())))

    return Variant(
        statement=text("statement", one=one, two=two, decades=decades, middle=f"{middle:g}"),
        questions=(
            Question(
                name="line",
                kind="number",
                prompt=text("line.prompt"),
                answer=by_line,
                errors=lambda: [
                    Mistake(
                        "forgotten", max(ALL_DIGITS - 2 * decades, 0) or 0.5, text("line.forgotten")
                    ),
                    Mistake("forgotten", ALL_DIGITS, text("line.forgotten_cancellation")),
                ],
                tolerance=0.9 / (ALL_DIGITS - decades),
                generic=(),
            ),
            Question(
                name="flux",
                kind="number",
                prompt=text("flux.prompt"),
                answer=by_flux,
                errors=lambda: [Mistake("forgotten", by_line(), text("flux.forgotten"))],
                tolerance=0.15,
                generic=(),
            ),
        ),
        hints=text.all("hints"),
        worked=lambda: _worked(text, decades),
    )


def _worked(text: Texts, decades: int) -> tuple[Step, ...]:
    """The error of the terms against the size of the result."""
    return (
        Step(text("worked.1", decades=decades, double=ALL_DIGITS, digits=ALL_DIGITS + decades)),
        Step(
            text("worked.2", powers=2 * decades, left=ALL_DIGITS - decades),
            "line",
            ALL_DIGITS - decades,
        ),
        Step(text("worked.3", double=ALL_DIGITS), "flux", ALL_DIGITS),
    )

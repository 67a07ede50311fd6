"""7.1: how many digits a tiny loop loses."""

import sys
from functools import cache
from math import log10
from statistics import median

from geomtorsion.loops import BurgersVector, Loop, burgers_vector
from geomtorsion.spaces import load
from geomtorsion.teaching.exercises.authoring import Draw, Mistake, Question, Step, Variant, steps

PLACES = 5
# Digits that double precision has.
ALL_DIGITS = sys.float_info.dig + 1


def make(draw: Draw) -> Variant:
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
        statement=(
            r"A rigid body has the attitude $R_z(\phi_3)R_y(\phi_2)R_z(\phi_1)$. In the plane of "
            rf"its angles $\phi_{one}$ and $\phi_{two}$, a circle has the radius $\rho = 10^{{-"
            rf"{decades}}}$ and the centre $\phi = (0.3, {middle:g}, 0.2)$. The size of its "
            r"Burgers vector is about $\pi\rho^2$. The vector is computed in double precision (16 "
            r"digits) as the sum of $e^i{}_\mu\,\Delta\phi^\mu$ over steps $\Delta\phi$ along the "
            r"circle, where $e^i{}_\mu$ is the body-fixed coframe. The terms of the sum have the "
            r"size of $\rho$."
        ),
        questions=(
            Question(
                name="line",
                kind="number",
                prompt="About how many digits of the sum are right?",
                answer=by_line,
                errors=lambda: [
                    Mistake(
                        "forgotten",
                        max(ALL_DIGITS - 2 * decades, 0) or 0.5,
                        "The rounding errors are proportional to the terms: they have the size "
                        "$10^{-16}\\rho$, not $10^{-16}$. Compare this size with $\\rho^2$.",
                    ),
                    Mistake(
                        "forgotten",
                        ALL_DIGITS,
                        "The terms nearly cancel. Each term is right to 16 digits, but the sum is "
                        "not.",
                    ),
                ],
                tolerance=0.9 / (ALL_DIGITS - decades),
                generic=(),
            ),
            Question(
                name="flux",
                kind="number",
                prompt="About how many digits are right if the vector is computed as the flux of "
                "torsion through the disk, by Stokes' theorem?",
                answer=by_flux,
                errors=lambda: [
                    Mistake(
                        "forgotten",
                        by_line(),
                        "That is the number for the sum. In the flux nothing cancels, because the "
                        "torsion has one sign on the disk.",
                    )
                ],
                tolerance=0.15,
                generic=(),
            ),
        ),
        hints=steps(
            "Rounding gives each term a relative error of $10^{-16}$.",
            r"The error of the sum is about $10^{-16}\rho$, and the result is about $\rho^2$. How "
            r"large "
            "is the relative error?",
            "In Python: `gt.burgers_vector(frame, loop).check` contains the results of both "
            "methods.",
        ),
        worked=lambda: _worked(decades),
    )


def _worked(decades: int) -> tuple[Step, ...]:
    """The error of the terms against the size of the result."""
    return (
        Step(
            f"The terms have the size $\\rho = 10^{{-{decades}}}$, each with a rounding error of "
            f"about $10^{{-{ALL_DIGITS}}}\\rho = 10^{{-{ALL_DIGITS + decades}}}$."
        ),
        Step(
            f"The result has the size $\\rho^2 = 10^{{-{2 * decades}}}$. The relative error is "
            f"$10^{{-{ALL_DIGITS - decades}}}$, so about {ALL_DIGITS - decades} digits are right.",
            "line",
            ALL_DIGITS - decades,
        ),
        Step(
            "The torsion has one sign on the disk, so nothing cancels in its flux: nearly all "
            f"{ALL_DIGITS} digits are right.",
            "flux",
            ALL_DIGITS,
        ),
    )

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
            r"A circle of radius $\rho = 10^{-" + str(decades) + r"}$ about $\phi = (0.3, "
            rf"{middle:g}, 0.2)$ runs round in the plane of $\phi_{one}$ and $\phi_{two}$, angles "
            r"of a rigid body with the attitude $R_z(\phi_3)R_y(\phi_2)R_z(\phi_1)$. Its Burgers "
            r"vector, about $\pi\rho^2$, is computed in double precision (16 digits) as the sum of "
            r"$e^i{}_\mu\,\Delta\phi^\mu$ along the circle. The terms are of the size of $\rho$."
        ),
        questions=(
            Question(
                name="line",
                kind="number",
                prompt="How many digits of the sum are right, about?",
                answer=by_line,
                errors=lambda: [
                    Mistake(
                        "forgotten",
                        max(ALL_DIGITS - 2 * decades, 0) or 0.5,
                        "Rounding errors are not of size 1 but of the size of the terms, "
                        "$10^{-16}\\rho$; compare that with $\\rho^2$.",
                    ),
                    Mistake(
                        "forgotten",
                        ALL_DIGITS,
                        "The terms nearly cancel: each is right to 16 digits, the sum is not.",
                    ),
                ],
                tolerance=0.9 / (ALL_DIGITS - decades),
                generic=(),
            ),
            Question(
                name="flux",
                kind="number",
                prompt="And if it is computed as the flux of torsion through the disk, by Stokes?",
                answer=by_flux,
                errors=lambda: [
                    Mistake(
                        "forgotten",
                        by_line(),
                        "The flux has nothing to cancel: the torsion has one sign on the disk.",
                    )
                ],
                tolerance=0.15,
                generic=(),
            ),
        ),
        hints=steps(
            "Rounding gives each term a relative error of $10^{-16}$.",
            r"Error $10^{-16}\rho$ against result $\rho^2$: which share is that?",
            "In Python: `gt.burgers_vector(frame, loop).check` holds both routes.",
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
            f"The result has the size $\\rho^2 = 10^{{-{2 * decades}}}$: the error is a share of "
            f"$10^{{-{ALL_DIGITS - decades}}}$ of it, and about {ALL_DIGITS - decades} digits are "
            "right.",
            "line",
            ALL_DIGITS - decades,
        ),
        Step(
            "The torsion has one sign on the disk: nothing cancels in its flux, which has nearly "
            f"all {ALL_DIGITS} digits.",
            "flux",
            ALL_DIGITS,
        ),
    )

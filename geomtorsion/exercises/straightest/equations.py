"""4.3: the equations of the straightest lines in coordinates."""

from random import Random

import sympy as sp

from geomtorsion.exercises.authoring import Domain, Mistake, Question, Variant, scaled, steps, tex
from geomtorsion.exercises.families import circles
from geomtorsion.exercises.straightest.force import christoffel_terms, quadratic
from geomtorsion.geometry import cartan


def make(draw: Random, seed: int) -> Variant:
    """Polar legs for seed 0; other seeds: circles of other lengths."""
    frame = circles(draw, seed)
    rates = [sp.Symbol(f"{symbol}_d", real=True) for symbol in frame.coordinates]
    table = cartan(frame).coefficients

    def straight():
        return quadratic(table.nonzero(), rates, -1)

    return Variant(
        statement=(
            f"For the forms ${tex.forms(frame)}$ write down the equations of the **straightest** "
            "lines of the Cartan connection, the autoparallels,\n\n"
            r"$$\ddot q^c + \Gamma_{ab}{}^c\,\dot q^a\dot q^b = 0 .$$"
        ),
        questions=(
            Question(
                name="equations",
                kind="equations",
                prompt="Two equations for `r''` and `phi''`, with `r'` and `phi'` for the "
                "velocities, separated by a semicolon; any equivalent pair will do.",
                domain=Domain.of(frame, *rates),
                answer=straight,
                errors=lambda: [
                    Mistake(
                        "levi-civita",
                        scaled(christoffel_terms(frame, rates), -1),
                        "These are the equations of the shortest lines, the geodesics.",
                    ),
                    Mistake(
                        "factor",
                        scaled(straight(), 2),
                        "The product $\\dot r\\dot\\phi$ occurs only once: the Cartan connection "
                        "is not symmetric.",
                    ),
                ],
                unknowns=("r''", "phi''"),
                points=2,
            ),
        ),
        hints=steps(
            "Which components does the connection have? Only one: see exercise 2.1.",
            "Along the line the frame components of the velocity are constant: differentiate "
            r"$e^i{}_\mu\dot q^\mu$ with respect to time.",
        ),
    )

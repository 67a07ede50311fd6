"""4.3: the equations of the autoparallels in coordinates."""

import sympy as sp

from geomtorsion.geometry import Frame, cartan
from geomtorsion.teaching.exercises.authoring import (
    Domain,
    Draw,
    Mistake,
    Question,
    Step,
    Texts,
    Variant,
    by_hand,
    scaled,
    tex,
)
from geomtorsion.teaching.exercises.families import circles
from geomtorsion.teaching.exercises.straightest.force import christoffel_terms, quadratic


def make(draw: Draw, text: Texts) -> Variant:
    """Polar legs for seed 0; other seeds: circles of other lengths."""
    frame = draw.choice(circles())
    rates = [sp.Symbol(f"{symbol}_d", real=True) for symbol in frame.coordinates]
    table = cartan(frame).coefficients

    def straight():
        return quadratic(table.nonzero(), rates, -1)

    return Variant(
        statement=text("statement", forms=tex.forms(frame)),
        questions=(
            Question(
                name="equations",
                kind="equations",
                prompt=text("equations.prompt"),
                domain=Domain.of(frame, *rates),
                answer=straight,
                errors=lambda: [
                    Mistake(
                        "levi-civita",
                        scaled(christoffel_terms(frame, rates), -1),
                        text("equations.levi-civita"),
                    ),
                    Mistake("factor", scaled(straight(), 2), text("equations.factor")),
                ],
                unknowns=("r''", "phi''"),
                points=2,
            ),
        ),
        hints=text.all("hints", component=tex.tex(table[0, 1, 1])),
        worked=lambda: _worked(text, frame, rates),
    )


def _worked(text: Texts, frame: Frame, rates: list[sp.Symbol]) -> tuple[Step, ...]:
    """Constant frame components, differentiated."""
    f, r = frame.coframe[1, 1], frame.coordinates[0]
    factor = by_hand.tidy(f.diff(r) / f)
    return (
        Step(text("worked.1", f=tex.tex(f))),
        Step(text("worked.2", slope=tex.tex(f.diff(r)))),
        Step(
            text("worked.3", factor=tex.tex(factor)),
            "equations",
            [sp.S.Zero, -factor * rates[0] * rates[1]],
        ),
    )

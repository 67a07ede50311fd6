"""4.5: the torsion of a constraint, which decides whether it can be integrated."""

from functools import cache
from itertools import product

import sympy as sp

from geomtorsion.geometry import Frame, constrained
from geomtorsion.teaching.exercises.authoring import (
    Domain,
    Draw,
    Mistake,
    Question,
    Step,
    Texts,
    Variant,
    by_hand,
    tex,
)
from geomtorsion.teaching.exercises.families import mixed


def make(draw: Draw, text: Texts) -> Variant:
    """A skate for seed 0; other seeds: skates with other units, contact forms, gradients."""
    frame = draw.choice(constraints())
    verdict = constrained(frame, (0, 1)).integrable
    torsion = verdict.obstructions.get((0, 1, 2), sp.S.Zero)
    return Variant(
        statement=text("statement", forms=tex.forms(frame), coordinates=tex.symbols(frame)),
        questions=(
            Question(
                name="torsion",
                kind="expression",
                prompt=text("torsion.prompt"),
                domain=Domain.of(frame),
                answer=lambda: torsion,
                errors=lambda: [
                    Mistake("factor", torsion / 2, text("torsion.factor")),
                    Mistake("sign", -torsion),
                ],
            ),
            Question(
                name="integrable",
                kind="choice",
                prompt=text("integrable.prompt"),
                answer=lambda: "yes" if verdict else "no",
                options=text.table("integrable.options"),
            ),
        ),
        hints=text.all("hints"),
        worked=lambda: _worked(text, frame),
    )


@cache
def constraints() -> tuple[Frame, ...]:
    """Frames whose third form is a constraint: not integrable, or a gradient."""
    x, y, z, theta = sp.symbols("x y z theta", real=True)
    c, s = sp.cos(theta), sp.sin(theta)
    skates = [
        Frame([x, y, theta], [[p * c, p * s, 0], [0, 0, k], [-s, c, 0]], name="skate")
        for p, k in product((1, 2, 3), (1, 2))
    ]
    contacts = [
        Frame([x, y, z], [[1, 0, 0], [0, 1, 0], [-k * y**n, 0, 1]], name="contact form")
        for k, n in product((1, 2, 3), (1, 2))
    ]
    gradients = [
        Frame([x, y, z], [[1, 0, 0], [0, 1, 0], [-f.diff(x), -f.diff(y), 1]], name="gradient")
        for f in (x * y, x**2 * y, x * y**2, sp.sin(x) * y)
    ]
    return mixed(skates, contacts, gradients)


def _worked(text: Texts, frame: Frame) -> tuple[Step, ...]:
    """The derivative of the forbidden form, in the forms."""
    value = by_hand.anholonomy(frame).get((0, 1, 2), sp.S.Zero)
    return (
        Step(text("worked.1", differentials=by_hand.differentials(frame))),
        Step(text("worked.2", value=tex.tex(value)), "torsion", value),
        Step(
            text("worked.3_integrable") if value == 0 else text("worked.3_not_integrable"),
            "integrable",
            "yes" if value == 0 else "no",
        ),
    )

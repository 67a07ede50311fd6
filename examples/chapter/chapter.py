"""chapter: functions that make exercises of chapter.toml."""

import sympy

from geomtorsion import Frame
from geomtorsion.teaching.exercises.authoring import (
    Domain,
    Draw,
    Mistake,
    Question,
    Step,
    Texts,
    Variant,
    tex,
)


def cell(draw: Draw, text: Texts) -> Variant:
    """The determinant of a metric; the draw chooses how fast the rulers grow."""
    r, theta = sympy.symbols("r theta", positive=True)
    power = draw.choice((1, 2, 3, 4, 5))
    frame = Frame([r, theta], [[1, 0], [0, r**power]])
    metric = frame.metric
    answer = metric[0, 0] * metric[1, 1] - metric[0, 1] ** 2
    root = sympy.sqrt(answer)
    return Variant(
        statement=text("statement", forms=tex.forms(frame)),
        questions=(
            Question(
                name="determinant",
                kind="expression",
                prompt=text("determinant.prompt"),
                domain=Domain.of(frame),
                answer=lambda: answer,
                errors=lambda: [Mistake("another", root, text("determinant.another"))],
            ),
        ),
        hints=text.all("hints"),
        worked=lambda: (Step(text("worked.1", root=tex.tex(root)), "determinant", answer),),
    )

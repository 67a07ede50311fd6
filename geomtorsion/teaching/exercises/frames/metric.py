"""1.2: the metric of a coframe, eq. (9) of the paper."""

import sympy as sp

from geomtorsion.geometry import Frame
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
from geomtorsion.teaching.exercises.families import bodies, matrix_of


def make(draw: Draw, text: Texts) -> Variant:
    """Body-fixed frames of the rotation group; other seeds: other angles, stretched forms."""
    body = draw.choice(bodies())
    frame = body.frame
    n = frame.dimension

    def wrong_side() -> sp.Matrix:
        rows = matrix_of(frame.coframe)
        return (rows * rows.T).applyfunc(sp.factor)

    return Variant(
        statement=text(
            "statement" if body.rigid else "stretched",
            coordinates=tex.symbols(frame),
            coframe=tex.coframe(frame),
        ),
        questions=(
            Question(
                name="metric",
                kind="components",
                prompt=text("metric.prompt"),
                domain=Domain.of(frame),
                answer=lambda: frame.metric,
                errors=lambda: [
                    Mistake("inverse", frame.inverse_metric, text("metric.inverse")),
                    Mistake("permuted", wrong_side(), text("metric.permuted")),
                ],
                shape=(n, n),
                label="g",
                symmetry="symmetric",
            ),
            Question(
                name="volume",
                kind="expression",
                prompt=text("volume.prompt"),
                domain=Domain.of(frame),
                answer=lambda: frame.determinant[()],
                errors=lambda: [
                    Mistake("inverse", 1 / frame.determinant[()], text("volume.inverse")),
                    Mistake("another", frame.determinant[()] ** 2, text("volume.another")),
                ],
            ),
        ),
        hints=text.all("hints"),
        worked=lambda: _worked(text, frame),
    )


def _worked(text: Texts, frame: Frame) -> tuple[Step, ...]:
    """Scalar products of the columns, and the determinant."""
    e = matrix_of(frame.coframe)
    g = (e.T * e).applyfunc(by_hand.tidy)
    columns = ",\\quad ".join(tex.matrix([[x] for x in e[:, k]]) for k in range(3))
    determinant = by_hand.tidy(e.det())
    return (
        Step(text("worked.1", columns=columns)),
        Step(text("worked.2", metric=tex.matrix(g.tolist())), "metric", g),
        Step(
            text(
                "worked.3", determinant=tex.tex(determinant), square=tex.tex(by_hand.tidy(g.det()))
            ),
            "volume",
            determinant,
        ),
    )

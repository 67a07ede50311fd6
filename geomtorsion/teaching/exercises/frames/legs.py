"""1.1: the legs of a coframe, a matrix inverse."""

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
    reordered,
    tex,
)
from geomtorsion.teaching.exercises.families import matrix_of, planes


def make(draw: Draw, text: Texts) -> Variant:
    """Cartesian one-forms in polar coordinates; other seeds turn, boost and scale them."""
    frame = draw.choice(planes())
    n = frame.dimension
    return Variant(
        statement=text("statement", coordinates=tex.symbols(frame), coframe=tex.coframe(frame)),
        questions=(
            Question(
                name="legs",
                kind="components",
                prompt=text("legs.prompt"),
                domain=Domain.of(frame),
                answer=lambda: frame.legs,
                errors=lambda: [
                    Mistake("inverse", frame.coframe),
                    Mistake("permuted", reordered(frame.legs, (1, 0)), text("legs.permuted")),
                ],
                shape=(n, n),
                label="E",
                marks="^_",
            ),
        ),
        hints=text.all("hints", determinant=tex.tex(frame.determinant[()])),
        worked=lambda: _worked(text, frame),
    )


def _worked(text: Texts, frame: Frame) -> tuple[Step, ...]:
    """Determinant, adjugate, quotient."""
    e = matrix_of(frame.coframe)
    determinant = by_hand.tidy(e.det())
    return (
        Step(text("worked.1", determinant=tex.tex(determinant))),
        Step(text("worked.2", adjugate=tex.matrix(e.adjugate().tolist()))),
        Step(
            text("worked.3", legs=tex.matrix(by_hand.legs(frame).tolist())),
            "legs",
            by_hand.legs(frame),
        ),
    )

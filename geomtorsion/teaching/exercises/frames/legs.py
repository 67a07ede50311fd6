"""1.1: the legs of a coframe, a matrix inverse."""

from geomtorsion.geometry import Frame
from geomtorsion.teaching.exercises.authoring import (
    Domain,
    Draw,
    Mistake,
    Question,
    Step,
    Variant,
    by_hand,
    reordered,
    steps,
    tex,
)
from geomtorsion.teaching.exercises.families import matrix_of, planes


def make(draw: Draw) -> Variant:
    """Cartesian one-forms in polar coordinates; other seeds turn, boost and scale them."""
    frame = draw.choice(planes())
    n = frame.dimension
    return Variant(
        statement=(
            f"In the coordinates ${tex.symbols(frame)}$, the coframe "
            r"$e^i = e^i{}_\mu\,\mathrm{d}q^\mu$ has the matrix"
            f"\n\n$${tex.coframe(frame)},$$\n\nin which each row is a one-form. "
            r"The legs $E_i = E_i{}^\mu\,\partial_\mu$ are the vectors dual to it: "
            r"$e^i{}_\mu E_j{}^\mu = \delta^i_j$."
        ),
        questions=(
            Question(
                name="legs",
                kind="components",
                prompt=r"Find the matrix $E_i{}^\mu$ with one leg per **column**: "
                r"row $\mu$, column $i$.",
                domain=Domain.of(frame),
                answer=lambda: frame.legs,
                errors=lambda: [
                    Mistake("inverse", frame.coframe),
                    Mistake(
                        "permuted",
                        reordered(frame.legs, (1, 0)),
                        "That is the transposed matrix: one leg per row, not per column.",
                    ),
                ],
                shape=(n, n),
                label="E",
                marks="^_",
            ),
        ),
        hints=steps(
            r"Duality means $e\,E = 1$ as matrices, where the columns of $E$ are the legs.",
            "For a matrix with two rows: exchange the diagonal entries, change the sign of the "
            r"other two, and divide by $\det e$.",
            f"Here the determinant is ${tex.tex(frame.determinant[()])}$.",
        ),
        worked=lambda: _worked(frame),
    )


def _worked(frame: Frame) -> tuple[Step, ...]:
    """Determinant, adjugate, quotient."""
    e = matrix_of(frame.coframe)
    determinant = by_hand.tidy(e.det())
    return (
        Step(
            r"Duality means $e\,E = 1$ as matrices: the legs are the columns of the inverse. "
            f"The determinant is $\\det e = {tex.tex(determinant)}$."
        ),
        Step(
            "Exchange the diagonal entries and change the sign of the other two: "
            f"$${tex.matrix(e.adjugate().tolist())}.$$"
        ),
        Step(
            f"Divide by the determinant: $$E = {tex.matrix(by_hand.legs(frame).tolist())}.$$",
            "legs",
            by_hand.legs(frame),
        ),
    )

"""1.2: the metric of a coframe, eq. (9) of the paper."""

import sympy as sp

from geomtorsion.geometry import Frame
from geomtorsion.teaching.exercises.authoring import (
    Domain,
    Draw,
    Mistake,
    Question,
    Step,
    Variant,
    by_hand,
    steps,
    tex,
)
from geomtorsion.teaching.exercises.families import bodies, matrix_of


def make(draw: Draw) -> Variant:
    """Body-fixed frames of the rotation group; other seeds: other angles, stretched forms."""
    body = draw.choice(bodies())
    frame = body.frame
    n = frame.dimension

    def wrong_side() -> sp.Matrix:
        rows = matrix_of(frame.coframe)
        return (rows * rows.T).applyfunc(sp.factor)

    return Variant(
        statement=(
            ("The coframe of a rigid body" if body.rigid else "A coframe")
            + f" in the angles ${tex.symbols(frame)}$ is"
            f"\n\n$$e = {tex.coframe(frame)},\\qquad \\eta = 1.$$"
        ),
        questions=(
            Question(
                name="metric",
                kind="components",
                prompt=r"Find the metric $g_{\mu\nu} = e^i{}_\mu\,\eta_{ij}\,e^j{}_\nu$.",
                domain=Domain.of(frame),
                answer=lambda: frame.metric,
                errors=lambda: [
                    Mistake("inverse", frame.inverse_metric, "That is the inverse metric."),
                    Mistake(
                        "permuted",
                        wrong_side(),
                        "That is $e\\,e^T$, a sum over the coordinates. The metric is $e^T e$, a "
                        "sum over the frame index.",
                    ),
                ],
                shape=(n, n),
                label="g",
                symmetry="symmetric",
            ),
            Question(
                name="volume",
                kind="expression",
                prompt=r"Find the volume element $\det e$ (with its sign).",
                domain=Domain.of(frame),
                answer=lambda: frame.determinant[()],
                errors=lambda: [
                    Mistake(
                        "inverse",
                        1 / frame.determinant[()],
                        "That is the determinant of the legs.",
                    ),
                    Mistake(
                        "another",
                        frame.determinant[()] ** 2,
                        "That is the determinant of the metric, $\\det g = (\\det e)^2$.",
                    ),
                ],
            ),
        ),
        hints=steps(
            "As a matrix the metric is $e^T e$: its entries are scalar products of the columns.",
            r"Use $\sin^2 + \cos^2 = 1$ for each angle.",
            r"Check your results with $\det g = (\det e)^2$.",
        ),
        worked=lambda: _worked(frame),
    )


def _worked(frame: Frame) -> tuple[Step, ...]:
    """Scalar products of the columns, and the determinant."""
    e = matrix_of(frame.coframe)
    g = (e.T * e).applyfunc(by_hand.tidy)
    columns = ",\\quad ".join(tex.matrix([[x] for x in e[:, k]]) for k in range(3))
    determinant = by_hand.tidy(e.det())
    return (
        Step(f"The columns of the coframe are $${columns}.$$"),
        Step(
            r"$g_{\mu\nu}$ is the scalar product of columns $\mu$ and $\nu$. With "
            f"$\\sin^2 + \\cos^2 = 1$: $$g = e^T e = {tex.matrix(g.tolist())}.$$",
            "metric",
            g,
        ),
        Step(
            f"The determinant is $\\det e = {tex.tex(determinant)}$. Its square is "
            f"$\\det g = {tex.tex(by_hand.tidy(g.det()))}$, as it must be.",
            "volume",
            determinant,
        ),
    )

"""1.2: the metric of a coframe, eq. (9) of the paper."""

from random import Random

import sympy as sp

from geomtorsion.exercises.authoring import Domain, Mistake, Question, Variant, steps, tex
from geomtorsion.exercises.families import matrix_of, rotations


def make(draw: Random, seed: int) -> Variant:
    """Body-fixed frames of the rotation group; other seeds: other angles, stretched forms."""
    frame = rotations(draw, seed)
    n = frame.dimension

    def wrong_side() -> sp.Matrix:
        rows = matrix_of(frame.coframe)
        return (rows * rows.T).applyfunc(sp.factor)

    return Variant(
        statement=(
            f"The coframe of a rigid body in the angles ${tex.symbols(frame)}$ is"
            f"\n\n$$e = {tex.coframe(frame)},\\qquad \\eta = 1.$$"
        ),
        questions=(
            Question(
                name="metric",
                kind="components",
                prompt=r"The metric $g_{\mu\nu} = e^i{}_\mu\,\eta_{ij}\,e^j{}_\nu$.",
                domain=Domain.of(frame),
                answer=lambda: frame.metric,
                errors=lambda: [
                    Mistake("inverse", frame.inverse_metric, "That is the inverse metric."),
                    Mistake(
                        "permuted",
                        wrong_side(),
                        "That is $e\\,e^T$, summed over coordinates; needed is $e^T e$, summed "
                        "over the frame.",
                    ),
                ],
                shape=(n, n),
                label="g",
                symmetry="symmetric",
            ),
            Question(
                name="volume",
                kind="expression",
                prompt=r"The volume element $\det e$ (with its sign).",
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
                        "That is the determinant of the metric; $\\det e$ is a root of it.",
                    ),
                ],
            ),
        ),
        hints=steps(
            "As matrices the metric is $e^T e$: scalar products of the columns.",
            r"Squares of sine and cosine of one angle add up to one; most of the entries vanish.",
            r"$\det g = (\det e)^2$ checks the one against the other.",
        ),
    )

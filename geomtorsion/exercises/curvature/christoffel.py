"""3.2: a Christoffel symbol of a surface of revolution."""

from random import Random

import sympy as sp

from geomtorsion.exercises.authoring import Domain, Mistake, Question, Variant, steps, tex
from geomtorsion.exercises.families import profile
from geomtorsion.geometry import Frame, cartan, levi_civita


def make(draw: Random, seed: int) -> Variant:
    """The sphere for seed 0, with phi1 along its circles; other seeds: other surfaces."""
    phi1, phi2 = sp.symbols("phi1 phi2", real=True)
    f = profile(draw, phi2) if seed else sp.sin(phi2)
    end = 1 if seed else sp.pi
    frame = Frame(
        (phi1, phi2),
        [[f, 0], [0, 1]],
        domain=(phi1 > 0, phi1 < 2 * sp.pi, phi2 > 0, phi2 < end),
        name="a surface of revolution",
    )
    bar, straight = levi_civita(frame), cartan(frame)
    return Variant(
        statement=(
            "The legs along the circles and along the meridians of a surface of revolution are dual"
            f" to ${tex.forms(frame)}$, with $0 < \\phi_2 < {tex.tex(end)}$. "
            r"Their metric is $g = e^T e$, and $\bar\Gamma$ is its Levi-Civita connection."
        ),
        questions=(
            Question(
                name="christoffel",
                kind="expression",
                prompt=r"$\bar\Gamma_{12}{}^1$, where 1 and 2 stand for $\phi_1$ and $\phi_2$.",
                domain=Domain.of(frame),
                answer=lambda: bar[0, 1, 0],
                errors=lambda: [
                    Mistake("cartan", straight[0, 1, 0]),
                    Mistake(
                        "inverse",
                        bar.coefficients.lowered(2)[0, 1, 0],
                        r"That is $\bar\Gamma_{121}$: the last index is still to be raised with "
                        "the inverse metric.",
                    ),
                    Mistake("permuted", bar[0, 0, 1], r"That is $\bar\Gamma_{11}{}^2$."),
                ],
            ),
        ),
        hints=steps(
            f"The metric is diagonal, with $g_{{11}} = {tex.tex(frame.metric[0, 0])}$ and "
            "$g_{22} = 1$.",
            r"$\bar\Gamma_{12}{}^1 = \tfrac12\,g^{11}\,\partial_2 g_{11}$: the other terms vanish.",
        ),
    )

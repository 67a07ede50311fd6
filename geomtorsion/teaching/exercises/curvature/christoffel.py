"""3.2: a Christoffel symbol of a surface made of circles."""

import sympy as sp

from geomtorsion.geometry import Frame, cartan, levi_civita
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
from geomtorsion.teaching.exercises.families import profiles


def make(draw: Draw) -> Variant:
    """The sphere for seed 0, with phi1 along its circles; other seeds: other surfaces."""
    phi1, phi2 = sp.symbols("phi1 phi2", real=True)
    sphere = sp.sin(phi2)
    f = draw.choice((sphere, *profiles(phi2)))
    end = sp.pi if f == sphere else 1
    frame = Frame(
        (phi1, phi2),
        [[f, 0], [0, 1]],
        domain=(phi1 > 0, phi1 < 2 * sp.pi, phi2 > 0, phi2 < end),
        name=f"circles of length 2 pi {f}",
    )
    bar, straight = levi_civita(frame), cartan(frame)
    return Variant(
        statement=(
            "A surface consists of circles, and $\\phi_1$ is the angle along a circle. The circle "
            "at $\\phi_2$, with "
            f"$0 < \\phi_2 < {tex.tex(end)}$, has the length $2\\pi f$ with $f = {tex.tex(f)}$; "
            "$\\phi_2$ is the distance measured across the circles. The legs along and across the "
            f"circles are dual to ${tex.forms(frame)}$. "
            r"The metric is $g = e^T e$, and $\bar\Gamma$ is its Levi-Civita connection."
        ),
        questions=(
            Question(
                name="christoffel",
                kind="expression",
                prompt=r"Find $\bar\Gamma_{12}{}^1$. The indices 1 and 2 belong to $\phi_1$ and "
                r"$\phi_2$.",
                domain=Domain.of(frame),
                answer=lambda: bar[0, 1, 0],
                errors=lambda: [
                    Mistake("cartan", straight[0, 1, 0]),
                    Mistake(
                        "inverse",
                        bar.coefficients.lowered(2)[0, 1, 0],
                        r"That is $\bar\Gamma_{121}$. Raise the last index with the inverse "
                        "metric.",
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
        worked=lambda: _worked(frame),
    )


def _worked(frame: Frame) -> tuple[Step, ...]:
    """Half the logarithmic slope of one component of the metric."""
    f, across = frame.coframe[0, 0], frame.coordinates[1]
    slope = by_hand.tidy((f**2).diff(across))
    value = by_hand.tidy(slope / (2 * f**2))
    return (
        Step(f"The metric is diagonal: $g_{{11}} = {tex.tex(f**2)}$, $g_{{22}} = 1$."),
        Step(
            r"In $\bar\Gamma_{12}{}^1 = \tfrac12 g^{11}(\partial_1 g_{21} + \partial_2 g_{11} - "
            r"\partial_1 g_{12})$ only the middle term is nonzero: "
            f"$\\partial_2 g_{{11}} = {tex.tex(slope)}$."
        ),
        Step(
            f"Multiplied by $g^{{11}}/2 = {tex.tex(1 / (2 * f**2))}$, it gives "
            rf"$\bar\Gamma_{{12}}{{}}^1 = {tex.tex(value)}$.",
            "christoffel",
            value,
        ),
    )

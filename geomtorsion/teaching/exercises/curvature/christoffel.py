"""3.2: a Christoffel symbol of a surface made of circles."""

import sympy as sp

from geomtorsion.geometry import Frame, cartan, levi_civita
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
from geomtorsion.teaching.exercises.families import profiles


def make(draw: Draw, text: Texts) -> Variant:
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
        statement=text("statement", end=tex.tex(end), f=tex.tex(f), forms=tex.forms(frame)),
        questions=(
            Question(
                name="christoffel",
                kind="expression",
                prompt=text("christoffel.prompt"),
                domain=Domain.of(frame),
                answer=lambda: bar[0, 1, 0],
                errors=lambda: [
                    Mistake("cartan", straight[0, 1, 0]),
                    Mistake(
                        "inverse", bar.coefficients.lowered(2)[0, 1, 0], text("christoffel.inverse")
                    ),
                    Mistake("permuted", bar[0, 0, 1], text("christoffel.permuted")),
                ],
            ),
        ),
        hints=text.all("hints", metric=tex.tex(frame.metric[0, 0])),
        worked=lambda: _worked(text, frame),
    )


def _worked(text: Texts, frame: Frame) -> tuple[Step, ...]:
    """Half the logarithmic slope of one component of the metric."""
    f, across = frame.coframe[0, 0], frame.coordinates[1]
    slope = by_hand.tidy((f**2).diff(across))
    value = by_hand.tidy(slope / (2 * f**2))
    return (
        Step(text("worked.1", metric=tex.tex(f**2))),
        Step(text("worked.2", slope=tex.tex(slope))),
        Step(
            text("worked.3", factor=tex.tex(1 / (2 * f**2)), value=tex.tex(value)),
            "christoffel",
            value,
        ),
    )

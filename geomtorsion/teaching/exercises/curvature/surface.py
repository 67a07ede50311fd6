"""3.3: Ricci tensor and curvature scalar of a surface."""

import sympy as sp

from geomtorsion.geometry import Frame, levi_civita
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
from geomtorsion.teaching.exercises.families import circles


def make(draw: Draw, text: Texts) -> Variant:
    """A sphere of radius R for seed 0; other seeds: other surfaces made of circles."""
    frame = draw.choice((_sphere(), *circles()[1:]))
    curvature = levi_civita(frame).curvature
    return Variant(
        statement=text("statement", forms=tex.forms(frame)),
        questions=(
            Question(
                name="ricci",
                kind="components",
                prompt=text("ricci.prompt"),
                domain=Domain.of(frame),
                answer=lambda: curvature.ricci,
                errors=lambda: [
                    Mistake("cartan", {}),
                    Mistake("basis", curvature.ricci.in_frame()),
                    Mistake("sign", -curvature.ricci, text("ricci.sign")),
                ],
                shape=(2, 2),
                label="R",
                symmetry="symmetric",
            ),
            Question(
                name="scalar",
                kind="expression",
                prompt=text("scalar.prompt"),
                domain=Domain.of(frame),
                answer=lambda: curvature.scalar[()],
                errors=lambda: [
                    Mistake("cartan", 0),
                    Mistake("factor", curvature.scalar[()] / 2, text("scalar.factor")),
                ],
            ),
        ),
        hints=text.all("hints", f=tex.tex(frame.coframe[1, 1])),
        worked=lambda: _worked(text, frame),
    )


def _sphere() -> Frame:
    """A sphere of radius R in the length of its meridians."""
    radius = sp.Symbol("R", positive=True)
    r, phi = sp.symbols("r phi", real=True)
    domain = (r > 0, r < sp.pi * radius, phi > 0, phi < 2 * sp.pi)
    return Frame((r, phi), [[1, 0], [0, radius * sp.sin(r / radius)]], domain=domain)


def _worked(text: Texts, frame: Frame) -> tuple[Step, ...]:
    """Gaussian curvature, and the Ricci tensor that follows from it in two dimensions."""
    f, r = frame.coframe[1, 1], frame.coordinates[0]
    gauss, ricci, scalar = by_hand.surface_ricci(frame)
    return (
        Step(text("worked.1", f=tex.tex(f), second=tex.tex(f.diff(r, 2)))),
        Step(text("worked.2", gauss=tex.tex(gauss))),
        Step(text("worked.3", ricci=tex.matrix(ricci)), "ricci", ricci),
        Step(text("worked.4", scalar=tex.tex(scalar)), "scalar", scalar),
    )

"""3.3: Ricci tensor and curvature scalar of a surface."""

import sympy as sp

from geomtorsion.geometry import Frame, levi_civita
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
from geomtorsion.teaching.exercises.families import circles


def make(draw: Draw) -> Variant:
    """A sphere of radius R for seed 0; other seeds: other surfaces made of circles."""
    frame = draw.choice((_sphere(), *circles()[1:]))
    curvature = levi_civita(frame).curvature
    return Variant(
        statement=(
            f"A surface has the one-forms ${tex.forms(frame)}$. Its circles "
            "$r = \\mathrm{const}$ have the length $2\\pi f(r)$, and $r$ is the distance measured "
            r"across them. The Levi-Civita connection has the Ricci tensor $R_{nl} = R_{mnl}{}^m$, "
            r"positive for spheres, and the curvature scalar $R = g^{nl}R_{nl}$."
        ),
        questions=(
            Question(
                name="ricci",
                kind="components",
                prompt=r"Find the Ricci tensor $R_{ab}$ in the coordinates.",
                domain=Domain.of(frame),
                answer=lambda: curvature.ricci,
                errors=lambda: [
                    Mistake("cartan", {}),
                    Mistake("basis", curvature.ricci.in_frame()),
                    Mistake(
                        "sign",
                        -curvature.ricci,
                        "The sign is wrong. Some books use the opposite sign, but here spheres "
                        "have positive curvature.",
                    ),
                ],
                shape=(2, 2),
                label="R",
                symmetry="symmetric",
            ),
            Question(
                name="scalar",
                kind="expression",
                prompt="Find the curvature scalar $R$.",
                domain=Domain.of(frame),
                answer=lambda: curvature.scalar[()],
                errors=lambda: [
                    Mistake("cartan", 0),
                    Mistake(
                        "factor",
                        curvature.scalar[()] / 2,
                        "That is the Gaussian curvature $K$. In two dimensions $R = 2K$.",
                    ),
                ],
            ),
        ),
        hints=steps(
            r"For $\mathrm{d}r^2 + f(r)^2\mathrm{d}\phi^2$ the Gaussian curvature is $K = -f''/f$.",
            "In two dimensions $R_{ab} = K g_{ab}$.",
            f"Here $f = {tex.tex(frame.coframe[1, 1])}$.",
        ),
        worked=lambda: _worked(frame),
    )


def _sphere() -> Frame:
    """A sphere of radius R in the length of its meridians."""
    radius = sp.Symbol("R", positive=True)
    r, phi = sp.symbols("r phi", real=True)
    domain = (r > 0, r < sp.pi * radius, phi > 0, phi < 2 * sp.pi)
    return Frame((r, phi), [[1, 0], [0, radius * sp.sin(r / radius)]], domain=domain)


def _worked(frame: Frame) -> tuple[Step, ...]:
    """Gaussian curvature, and the Ricci tensor that follows from it in two dimensions."""
    f, r = frame.coframe[1, 1], frame.coordinates[0]
    gauss, ricci, scalar = by_hand.surface_ricci(frame)
    return (
        Step(
            f"The metric is $\\mathrm{{d}}r^2 + f^2\\,\\mathrm{{d}}\\phi^2$ with "
            f"$f = {tex.tex(f)}$, and $f'' = {tex.tex(f.diff(r, 2))}$."
        ),
        Step(f"The Gaussian curvature is $K = -f''/f = {tex.tex(gauss)}$."),
        Step(
            f"In two dimensions $R_{{ab}} = K g_{{ab}}$: $$R = {tex.matrix(ricci)}.$$",
            "ricci",
            ricci,
        ),
        Step(f"Its trace is $R = 2K = {tex.tex(scalar)}$.", "scalar", scalar),
    )

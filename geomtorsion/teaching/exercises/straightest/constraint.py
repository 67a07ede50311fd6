"""4.5: the torsion of a constraint, which decides whether it can be integrated."""

from functools import cache
from itertools import product

import sympy as sp

from geomtorsion.geometry import Frame, constrained
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
from geomtorsion.teaching.exercises.families import mixed


def make(draw: Draw) -> Variant:
    """A skate for seed 0; other seeds: skates with other units, contact forms, gradients."""
    frame = draw.choice(constraints())
    verdict = constrained(frame, (0, 1)).integrable
    torsion = verdict.obstructions.get((0, 1, 2), sp.S.Zero)
    return Variant(
        statement=(
            f"Consider the one-forms\n\n$${tex.forms(frame)}$$\n\nin the coordinates "
            f"${tex.symbols(frame)}$. They are orthonormal for the kinetic energy of a body. A "
            "constraint forbids every velocity with a part along $E_3$: $e^3(v) = 0$. The body "
            "follows an autoparallel of the constrained connection. Two of its permitted legs, "
            "$E_1$ and $E_2$, have the torsion $2S_{12}{}^3 = e^3([E_2, E_1])$ along the forbidden "
            r"leg, or $\mathrm{d}e^3 = 2S_{12}{}^3\,e^1\wedge e^2 + \dots$"
        ),
        questions=(
            Question(
                name="torsion",
                kind="expression",
                prompt="Find $2S_{12}{}^3$.",
                domain=Domain.of(frame),
                answer=lambda: torsion,
                errors=lambda: [
                    Mistake("factor", torsion / 2, "That is $S$, not $2S$."),
                    Mistake("sign", -torsion),
                ],
            ),
            Question(
                name="integrable",
                kind="choice",
                prompt="Can the constraint be integrated, to a constraint on the coordinates?",
                answer=lambda: "yes" if verdict else "no",
                options={
                    "yes": "yes: the body stays on a surface",
                    "no": "no: the body can reach every point",
                },
            ),
        ),
        hints=steps(
            r"Compute $\mathrm{d}e^3$, and express it in the one-forms.",
            r"$\mathrm{d}e^3 = \tfrac12\,(2S_{ij}{}^3)\,e^i\wedge e^j$: the coefficient of "
            r"$e^1\wedge e^2$ is $2S_{12}{}^3$.",
            "The theorem of Frobenius: the constraint is integrable exactly if this torsion "
            "vanishes. Then the bracket of two permitted legs is permitted.",
        ),
        worked=lambda: _worked(frame),
    )


@cache
def constraints() -> tuple[Frame, ...]:
    """Frames whose third form is a constraint: not integrable, or a gradient."""
    x, y, z, theta = sp.symbols("x y z theta", real=True)
    c, s = sp.cos(theta), sp.sin(theta)
    skates = [
        Frame([x, y, theta], [[p * c, p * s, 0], [0, 0, k], [-s, c, 0]], name="skate")
        for p, k in product((1, 2, 3), (1, 2))
    ]
    contacts = [
        Frame([x, y, z], [[1, 0, 0], [0, 1, 0], [-k * y**n, 0, 1]], name="contact form")
        for k, n in product((1, 2, 3), (1, 2))
    ]
    gradients = [
        Frame([x, y, z], [[1, 0, 0], [0, 1, 0], [-f.diff(x), -f.diff(y), 1]], name="gradient")
        for f in (x * y, x**2 * y, x * y**2, sp.sin(x) * y)
    ]
    return mixed(skates, contacts, gradients)


def _worked(frame: Frame) -> tuple[Step, ...]:
    """The derivative of the forbidden form, in the forms."""
    value = by_hand.anholonomy(frame).get((0, 1, 2), sp.S.Zero)
    return (
        Step(f"The derivatives of the forms are $${by_hand.differentials(frame)}.$$"),
        Step(
            f"In $\\mathrm{{d}}e^3$ the coefficient of $e^1\\wedge e^2$ is "
            f"$2S_{{12}}{{}}^3 = {tex.tex(value)}$.",
            "torsion",
            value,
        ),
        Step(
            "It vanishes, so the constraint is integrable: $e^3$ is a multiple of a gradient, and "
            "the body stays on a surface."
            if value == 0
            else "It does not vanish, so the constraint is not integrable: the two permitted "
            "motions, one after the other and back, lead along the forbidden leg.",
            "integrable",
            "yes" if value == 0 else "no",
        ),
    )

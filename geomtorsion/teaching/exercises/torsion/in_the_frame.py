"""2.4: torsion in the frame; for seed 0, the body-fixed frame, eq. (12) of the paper."""

from geomtorsion.geometry import Frame, cartan, levi_civita
from geomtorsion.teaching.exercises.authoring import (
    TORSION,
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
from geomtorsion.teaching.exercises.families import bodies


def make(draw: Draw) -> Variant:
    """The body-fixed frame of so3 for seed 0; other seeds: other angles, forms stretched."""
    body = draw.choice(bodies())
    frame, other = body.frame, body.space_frame
    which, factor = body.stretch
    torsion = cartan(frame).torsion
    return Variant(
        statement=(
            ("Body-fixed forms" if body.rigid else "Forms")
            + f" in the angles ${tex.symbols(frame)}$ are\n\n"
            f"$$e = {tex.coframe(frame)},\\qquad \\eta = 1.$$\n\n"
            + (
                f"(They are those of a body, with form {which + 1} stretched by {factor}.) "
                if factor > 1
                else ""
            )
            + r"In the frame the torsion of the Cartan connection has constant components."
        ),
        questions=(
            Question(
                name="torsion",
                kind="components",
                prompt=r"The components $2S_{ij}{}^k$ in the frame that do not vanish, those with "
                "$i<j$ at least.",
                domain=Domain.of(frame),
                answer=torsion.T.in_frame,
                errors=lambda: [
                    Mistake("factor", torsion.S.in_frame(), "That is $S$; asked is $2S$."),
                    Mistake(
                        "axes",
                        cartan(other).torsion.T.in_frame(),
                        "That belongs to forms fixed in space (structure constants of the other "
                        "sign), not in the body.",
                    ),
                    Mistake("basis", torsion.T),
                ],
                shape=(3, 3, 3),
                label="2S",
                marks="__^",
                remarks=TORSION,
                symmetry="antisymmetric",
                points=2,
            ),
            Question(
                name="scalar",
                kind="expression",
                prompt=r"The torsion scalar $\tfrac14 T_{abc}T^{abc} + \tfrac12 T_{abc}T^{cba} - "
                r"v_a v^a$ with $T = 2S$.",
                domain=Domain.of(frame),
                answer=lambda: torsion.scalar[()],
                errors=lambda: [
                    Mistake(
                        "factor",
                        torsion.scalar[()] / 4,
                        "A quarter of it: $S$ was put in where $T = 2S$ should stand.",
                    ),
                    Mistake(
                        "levi-civita",
                        levi_civita(frame).curvature.scalar[()],
                        r"That is the curvature scalar $\bar R$ of the metric, of the other sign.",
                    ),
                ],
            ),
        ),
        hints=steps(
            r"In the frame $2S_{ij}{}^k$ is the object of anholonomy: "
            r"$\mathrm{d}e^k = \tfrac12\,(2S_{ij}{}^k)\,e^i\wedge e^j$.",
            "Without stretching the forms are the angular velocity of the body, and turns do not "
            r"commute: the answer is made of $\epsilon_{ijk}$.",
            "A stretched form multiplies its own upper index and divides its lower ones.",
        ),
        worked=lambda: _worked(frame),
    )


def _worked(frame: Frame) -> tuple[Step, ...]:
    """The derivatives of the forms in the frame, and the three sums of the scalar."""
    t = by_hand.anholonomy(frame)
    half = {key: value for key, value in t.items() if key[0] < key[1]}
    squares = sum(x**2 for x in t.values())
    turned = sum(x * t.get((c, b, a), 0) for (a, b, c), x in t.items())
    traces = [sum(t.get((a, b, b), 0) for b in range(3)) for a in range(3)]
    trace = sum(x**2 for x in traces)
    scalar = by_hand.tidy(squares / 4 + turned / 2 - trace)
    return (
        Step(f"The derivatives of the forms are $${by_hand.differentials(frame)}.$$"),
        Step(
            r"Written by the forms, $\mathrm{d}e^k = \tfrac12\,2S_{ij}{}^k\,e^i\wedge e^j$, they "
            f"are constant: $${by_hand.listed('2S', half)}.$$",
            "torsion",
            t,
        ),
        Step(
            f"With $\\eta = 1$ all indices may stand below: $T_{{abc}}T_{{abc}} = "
            f"{tex.tex(squares)}$, $T_{{abc}}T_{{cba}} = {tex.tex(turned)}$, $v_a v_a = "
            f"{tex.tex(trace)}$. So the torsion scalar is ${tex.tex(scalar)}$.",
            "scalar",
            scalar,
        ),
    )

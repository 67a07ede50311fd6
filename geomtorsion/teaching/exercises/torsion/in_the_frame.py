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
    frame, space_frame = body.frame, body.space_frame
    which, factor = body.stretch
    torsion = cartan(frame).torsion
    return Variant(
        statement=(
            ("The body-fixed coframe of a rigid body" if body.rigid else "A coframe")
            + f" in the angles ${tex.symbols(frame)}$ is\n\n"
            f"$$e = {tex.coframe(frame)},\\qquad \\eta = 1.$$\n\n"
            + (
                f"(It is the body-fixed coframe of a rigid body, with $e^{which + 1}$ multiplied "
                f"by {factor}.) "
                if factor > 1
                else ""
            )
            + r"The torsion of the Cartan connection has constant components in the frame."
        ),
        questions=(
            Question(
                name="torsion",
                kind="components",
                prompt=r"Find the nonzero components $2S_{ij}{}^k$ in the frame. Those with "
                "$i<j$ are enough.",
                domain=Domain.of(frame),
                answer=torsion.T.in_frame,
                errors=lambda: [
                    Mistake("factor", torsion.S.in_frame(), "That is $S$, not $2S$."),
                    Mistake(
                        "axes",
                        cartan(space_frame).torsion.T.in_frame(),
                        "That is the torsion for forms fixed in space, with the opposite sign. "
                        "Here the forms are fixed in the body.",
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
                prompt="Find the torsion scalar "
                r"$\tfrac14 T_{abc}T^{abc} + \tfrac12 T_{abc}T^{cba} - "
                r"v_a v^a$ with $T = 2S$.",
                domain=Domain.of(frame),
                answer=lambda: torsion.scalar[()],
                errors=lambda: [
                    Mistake(
                        "factor",
                        torsion.scalar[()] / 4,
                        "That is a quarter of it: insert $T = 2S$, not $S$.",
                    ),
                    Mistake(
                        "levi-civita",
                        levi_civita(frame).curvature.scalar[()],
                        r"That is the curvature scalar $\bar R$ of the metric, which has the "
                        "opposite sign.",
                    ),
                ],
            ),
        ),
        hints=steps(
            r"In the frame $2S_{ij}{}^k$ is the object of anholonomy: "
            r"$\mathrm{d}e^k = \tfrac12\,(2S_{ij}{}^k)\,e^i\wedge e^j$.",
            "The one-forms of a rigid body give its angular velocity, and rotations do not "
            r"commute: the components are $\epsilon_{ijk}$ up to a common sign.",
            "If a form is multiplied by a factor, the components with its upper index are "
            "multiplied by the factor, and those with its lower index are divided by it.",
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
            r"Expressed in the forms, $\mathrm{d}e^k = \tfrac12\,2S_{ij}{}^k\,e^i\wedge e^j$ with "
            f"constant coefficients: $${by_hand.listed('2S', half)}.$$",
            "torsion",
            t,
        ),
        Step(
            f"With $\\eta = 1$ all indices can be lowered: $T_{{abc}}T_{{abc}} = "
            f"{tex.tex(squares)}$, $T_{{abc}}T_{{cba}} = {tex.tex(turned)}$, $v_a v_a = "
            f"{tex.tex(trace)}$. So the torsion scalar is ${tex.tex(scalar)}$.",
            "scalar",
            scalar,
        ),
    )

"""3.4: the Ricci tensor of a group: the rotations, stretched ones, and others."""

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
from geomtorsion.teaching.exercises.families import bodies, frame_of, groups, mixed


def make(draw: Draw) -> Variant:
    """so3 for seed 0; other seeds: stretched (Berger's) spheres and other groups."""
    frame = frame_of(draw.choice(mixed(bodies(), groups(curved=True))))
    curvature, straight = levi_civita(frame).curvature, cartan(frame)
    return Variant(
        statement=(
            f"Consider the one-forms\n\n$${tex.forms(frame)}$$\n\nin the coordinates "
            f"${tex.symbols(frame)}$, with the frame metric $\\eta = 1$. The curvature of the "
            "Cartan connection vanishes. The curvature of the Levi-Civita connection follows from "
            "the torsion, and all its components in the frame are constant."
        ),
        questions=(
            Question(
                name="ricci",
                kind="components",
                prompt=r"Find the components $\bar R_{ij}$ of the Ricci tensor of the Levi-Civita "
                "connection in the **frame**.",
                domain=Domain.of(frame),
                answer=curvature.ricci.in_frame,
                errors=lambda: [
                    Mistake("cartan", straight.curvature.ricci),
                    Mistake("basis", curvature.ricci),
                ],
                shape=(3, 3),
                label="R",
                symmetry="symmetric",
                points=2,
            ),
            Question(
                name="scalar",
                kind="expression",
                prompt=r"Find the curvature scalar $\bar R$ of the Levi-Civita connection.",
                domain=Domain.of(frame),
                answer=lambda: curvature.scalar[()],
                errors=lambda: [
                    Mistake("cartan", 0),
                    Mistake(
                        "sign",
                        -curvature.scalar[()],
                        "The sign is wrong: $\\bar R = -T - 2\\bar D_a v^a$ with the torsion "
                        "scalar $T$.",
                    ),
                ],
            ),
        ),
        hints=steps(
            r"With constant $C_{ij}{}^k$, where $\mathrm{d}e^k = \tfrac12 C_{ij}{}^k\,e^i\wedge "
            "e^j$, the connection coefficients in the frame are constant: "
            r"$\bar\omega_{ijk} = -\tfrac12(C_{ijk} - C_{jki} + C_{kij})$.",
            "The curvature then contains no derivatives: it is a sum of products of these "
            "coefficients with each other and with $C$.",
            f"The torsion scalar is ${tex.tex(straight.torsion.scalar[()])}$.",
        ),
        worked=lambda: _worked(frame),
    )


def _worked(frame: Frame) -> tuple[Step, ...]:
    """Structure constants, the connection they make, products of it."""
    constants = by_hand.anholonomy(frame)
    half = {key: value for key, value in constants.items() if key[0] < key[1]}
    connection = by_hand.group_connection(constants, 3)
    ricci = by_hand.group_ricci(constants, 3)
    return (
        Step(
            r"$\mathrm{d}e^k = \tfrac12 C_{ij}{}^k\,e^i\wedge e^j$ with "
            f"$${by_hand.listed('C', half)}.$$"
        ),
        Step(
            r"With all indices lowered, $\bar\omega_{ijk} = -\tfrac12(C_{ijk} - C_{jki} + "
            rf"C_{{kij}})$ gives $${by_hand.listed('omega_bar', connection, 0)}.$$"
        ),
        Step(
            r"All coefficients are constant, so $\bar R_{jk} = \bar\omega_{jkm}\bar\omega_{imi} - "
            r"\bar\omega_{ikm}\bar\omega_{jmi} + C_{ijm}\bar\omega_{mki}$, summed over $i$ and "
            f"$m$: $$\\bar R = {tex.matrix(ricci.tolist())}.$$",
            "ricci",
            ricci,
        ),
        Step(
            f"The trace is $\\bar R = {tex.tex(by_hand.tidy(ricci.trace()))}$.",
            "scalar",
            by_hand.tidy(ricci.trace()),
        ),
    )

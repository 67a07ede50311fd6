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
            f"The forms, in ${tex.symbols(frame)}$, are\n\n$${tex.forms(frame)},$$\n\n"
            "and $\\eta = 1$. The Cartan curvature vanishes; the Levi-Civita connection of the "
            "metric has a curvature of its own, made of the torsion: in the frame all its "
            "components are constant."
        ),
        questions=(
            Question(
                name="ricci",
                kind="components",
                prompt=r"The Ricci tensor $\bar R_{ij}$ in the **frame**.",
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
                prompt=r"The curvature scalar $\bar R$.",
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
            "With constant $C_{ij}{}^k$ the connection in the frame is constant too: "
            r"$\bar\omega_{ijk} = -\tfrac12(C_{ijk} - C_{jki} + C_{kij})$.",
            "The curvature is then a sum of products of two of these, without any derivative.",
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
            r"With $\bar\omega_{ijk} = -\tfrac12(C_{ijk} - C_{jki} + C_{kij})$ and all indices "
            rf"below: $${by_hand.listed('omega_bar', connection, 0)}.$$"
        ),
        Step(
            r"All are constant, so that $\bar R_{jk} = \bar\omega_{jkm}\bar\omega_{imi} - "
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

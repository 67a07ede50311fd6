"""3.4: the Ricci tensor of a group: the rotations, stretched ones, and others."""

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
from geomtorsion.teaching.exercises.families import bodies, frame_of, groups, mixed


def make(draw: Draw, text: Texts) -> Variant:
    """so3 for seed 0; other seeds: stretched (Berger's) spheres and other groups."""
    frame = frame_of(draw.choice(mixed(bodies(), groups(curved=True))))
    curvature, straight = levi_civita(frame).curvature, cartan(frame)
    return Variant(
        statement=text("statement", forms=tex.forms(frame), coordinates=tex.symbols(frame)),
        questions=(
            Question(
                name="ricci",
                kind="components",
                prompt=text("ricci.prompt"),
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
                prompt=text("scalar.prompt"),
                domain=Domain.of(frame),
                answer=lambda: curvature.scalar[()],
                errors=lambda: [
                    Mistake("cartan", 0),
                    Mistake("sign", -curvature.scalar[()], text("scalar.sign")),
                ],
            ),
        ),
        hints=text.all("hints", scalar=tex.tex(straight.torsion.scalar[()])),
        worked=lambda: _worked(text, frame),
    )


def _worked(text: Texts, frame: Frame) -> tuple[Step, ...]:
    """Structure constants, the connection they make, products of it."""
    constants = by_hand.anholonomy(frame)
    half = {key: value for key, value in constants.items() if key[0] < key[1]}
    connection = by_hand.group_connection(constants, 3)
    ricci = by_hand.group_ricci(constants, 3)
    return (
        Step(text("worked.1", components=by_hand.listed("C", half))),
        Step(text("worked.2", connection=by_hand.listed("omega_bar", connection, 0))),
        Step(text("worked.3", ricci=tex.matrix(ricci.tolist())), "ricci", ricci),
        Step(
            text("worked.4", trace=tex.tex(by_hand.tidy(ricci.trace()))),
            "scalar",
            by_hand.tidy(ricci.trace()),
        ),
    )

"""3.1: which connection is flat, and which has torsion."""

from geomtorsion.geometry import Frame, cartan, levi_civita
from geomtorsion.spaces import load
from geomtorsion.teaching.exercises.authoring import (
    Draw,
    Mistake,
    Question,
    Step,
    Texts,
    Variant,
    by_hand,
    tex,
)
from geomtorsion.teaching.exercises.families import (
    bodies,
    circles,
    frame_of,
    groups,
    matrix_of,
    mixed,
)

SPACES = ("flat_spherical", "s3")


def make(draw: Draw, text: Texts) -> Variant:
    """so3 for seed 0; other seeds: spheres, groups, flat space, circles."""
    shipped = [load(name).frame for name in SPACES]
    frame = frame_of(draw.choice(mixed(bodies(), circles(), groups(), shipped)))
    straight, short = cartan(frame), levi_civita(frame)
    return Variant(
        statement=text("statement", forms=tex.forms(frame), coordinates=tex.symbols(frame)),
        questions=(
            _question(
                text,
                "cartan",
                text("cartan.prompt"),
                lambda: straight.curvature.is_zero,
                lambda: short.curvature.is_zero,
                "levi-civita",
            ),
            _question(
                text,
                "riemann",
                text("riemann.prompt"),
                lambda: short.curvature.is_zero,
                lambda: straight.curvature.is_zero,
                "cartan",
            ),
            _question(
                text,
                "torsion",
                text("torsion.prompt"),
                lambda: straight.torsion.S.is_zero,
                lambda: short.torsion.S.is_zero,
                "levi-civita",
            ),
        ),
        hints=text.all("hints"),
        worked=lambda: _worked(text, frame),
    )


def _question(text: Texts, name, prompt, answer, other, code) -> Question:
    """Zero or not, with the answer for the other connection as the mistake."""
    key = {True: "zero", False: "not zero"}
    return Question(
        name=name,
        kind="choice",
        prompt=prompt,
        answer=lambda: key[answer()],
        errors=lambda: [Mistake(code, key[other()])],
        options=text.table("options"),
    )


def _worked(text: Texts, frame: Frame) -> tuple[Step, ...]:
    """Parallel legs; the metric; closed forms."""
    flat, twisted = by_hand.is_flat(frame), bool(by_hand.curls(frame))
    e = matrix_of(frame.coframe)
    metric = (e.T * e).applyfunc(by_hand.tidy).tolist()
    return (
        Step(text("worked.1"), "cartan", "zero"),
        Step(
            text("worked.2_flat" if flat else "worked.2_curved", metric=tex.matrix(metric)),
            "riemann",
            "zero" if flat else "not zero",
        ),
        Step(
            text("worked.3_open", differentials=by_hand.differentials(frame))
            if twisted
            else text("worked.3_closed"),
            "torsion",
            "not zero" if twisted else "zero",
        ),
    )

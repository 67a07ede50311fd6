"""2.4: torsion in the frame; for seed 0, the body-fixed frame, eq. (12) of the paper."""

from geomtorsion.geometry import Frame, cartan, levi_civita
from geomtorsion.teaching.exercises.authoring import (
    TORSION,
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
from geomtorsion.teaching.exercises.families import Body, bodies


def make(draw: Draw, text: Texts) -> Variant:
    """The body-fixed frame of so3 for seed 0; other seeds: other angles, forms stretched."""
    body = draw.choice(bodies())
    frame, space_frame = body.frame, body.space_frame
    torsion = cartan(frame).torsion
    return Variant(
        statement=_stated(text, body),
        questions=(
            Question(
                name="torsion",
                kind="components",
                prompt=text("torsion.prompt"),
                domain=Domain.of(frame),
                answer=torsion.T.in_frame,
                errors=lambda: [
                    Mistake("factor", torsion.S.in_frame(), text("torsion.factor")),
                    Mistake("axes", cartan(space_frame).torsion.T.in_frame(), text("torsion.axes")),
                    Mistake("basis", torsion.T),
                ],
                shape=(3, 3, 3),
                label="2S",
                marks="__^",
                remarks=TORSION.of(text.language),
                symmetry="antisymmetric",
                points=2,
            ),
            Question(
                name="scalar",
                kind="expression",
                prompt=text("scalar.prompt"),
                domain=Domain.of(frame),
                answer=lambda: torsion.scalar[()],
                errors=lambda: [
                    Mistake("factor", torsion.scalar[()] / 4, text("scalar.factor")),
                    Mistake(
                        "levi-civita",
                        levi_civita(frame).curvature.scalar[()],
                        text("scalar.levi-civita"),
                    ),
                ],
            ),
        ),
        hints=text.all("hints"),
        worked=lambda: _worked(text, frame),
    )


def _stated(text: Texts, body: Body) -> str:
    """The coframe, with the factor of a stretched form."""
    coordinates, coframe = tex.symbols(body.frame), tex.coframe(body.frame)
    if body.rigid:
        return text("statement", coordinates=coordinates, coframe=coframe)
    which, factor = body.stretch
    return text(
        "stretched", coordinates=coordinates, coframe=coframe, form=which + 1, factor=factor
    )


def _worked(text: Texts, frame: Frame) -> tuple[Step, ...]:
    """The derivatives of the forms in the frame, and the three sums of the scalar."""
    t = by_hand.anholonomy(frame)
    half = {key: value for key, value in t.items() if key[0] < key[1]}
    squares = sum(x**2 for x in t.values())
    turned = sum(x * t.get((c, b, a), 0) for (a, b, c), x in t.items())
    traces = [sum(t.get((a, b, b), 0) for b in range(3)) for a in range(3)]
    trace = sum(x**2 for x in traces)
    scalar = by_hand.tidy(squares / 4 + turned / 2 - trace)
    return (
        Step(text("worked.1", differentials=by_hand.differentials(frame))),
        Step(text("worked.2", components=by_hand.listed("2S", half)), "torsion", t),
        Step(
            text(
                "worked.3",
                squares=tex.tex(squares),
                turned=tex.tex(turned),
                trace=tex.tex(trace),
                scalar=tex.tex(scalar),
            ),
            "scalar",
            scalar,
        ),
    )

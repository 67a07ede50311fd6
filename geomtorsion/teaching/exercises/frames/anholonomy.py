"""1.3: the object of anholonomy, where forms are not closed."""

from geomtorsion.geometry import Frame, cartan
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
from geomtorsion.teaching.exercises.families import groups


def make(draw: Draw, text: Texts) -> Variant:
    """A left-invariant frame of a small group; the seed chooses group and constants."""
    frame = draw.choice(groups())
    n = frame.dimension
    return Variant(
        statement=text("statement", forms=tex.forms(frame), coordinates=tex.symbols(frame)),
        questions=(
            Question(
                name="anholonomy",
                kind="components",
                prompt=text("anholonomy.prompt"),
                domain=Domain.of(frame),
                answer=lambda: frame.anholonomy,
                errors=lambda: [
                    Mistake("sign", -frame.anholonomy, text("anholonomy.sign")),
                    Mistake("factor", frame.anholonomy / 2, text("anholonomy.factor")),
                    Mistake("basis", cartan(frame).torsion.T),
                ],
                shape=(n, n, n),
                label="C",
                marks="__^",
                remarks=TORSION.of(text.language),
                symmetry="antisymmetric",
            ),
            Question(
                name="closed",
                kind="number",
                prompt=text("closed.prompt"),
                answer=lambda: closed_forms(frame),
                errors=lambda: [
                    Mistake(
                        "another", frame.dimension - closed_forms(frame), text("closed.another")
                    )
                ],
                generic=(),
                tolerance=1e-9,
            ),
        ),
        hints=text.all("hints"),
        worked=lambda: _worked(text, frame),
    )


def closed_forms(frame: Frame) -> int:
    """Number of closed forms."""
    return frame.dimension - len({k for _, _, k in frame.anholonomy.nonzero()})


def _worked(text: Texts, frame: Frame) -> tuple[Step, ...]:
    """The derivatives of the forms, written in the forms."""
    table = by_hand.anholonomy(frame)
    open_forms = {k for _, _, k in by_hand.curls(frame)}
    half = {key: value for key, value in table.items() if key[0] < key[1]}
    closed = frame.dimension - len(open_forms)
    return (
        Step(text("worked.1", differentials=by_hand.differentials(frame))),
        Step(text("worked.2", closed=closed), "closed", closed),
        Step(text("worked.3", legs=tex.matrix(by_hand.legs(frame).tolist()))),
        Step(text("worked.4", components=by_hand.listed("C", half)), "anholonomy", table),
    )

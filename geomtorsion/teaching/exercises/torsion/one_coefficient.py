"""2.1: the one coefficient of the Cartan connection of circles."""

from geomtorsion.geometry import Frame
from geomtorsion.teaching.exercises.authoring import (
    Draw,
    Step,
    Texts,
    Variant,
    by_hand,
    tex,
)
from geomtorsion.teaching.exercises.families import circles
from geomtorsion.teaching.exercises.torsion.cartan_connection import connection_question


def make(draw: Draw, text: Texts) -> Variant:
    """Polar legs for seed 0; other seeds: circles of other lengths."""
    frame = draw.choice(circles())
    return Variant(
        statement=text("statement", coordinates=tex.symbols(frame), forms=tex.forms(frame)),
        questions=(connection_question(text, frame),),
        hints=text.all("hints"),
        worked=lambda: _worked(text, frame),
    )


def _worked(text: Texts, frame: Frame) -> tuple[Step, ...]:
    """The only entry that depends on a coordinate."""
    f = frame.coframe[1, 1]
    slope = f.diff(frame.coordinates[0])
    value = by_hand.tidy(slope / f)
    return (
        Step(text("worked.1", f=tex.tex(f), slope=tex.tex(slope))),
        Step(text("worked.2", inverse=tex.tex(1 / f))),
        Step(text("worked.3", value=tex.tex(value)), "connection", {(0, 1, 1): value}),
    )

"""2.3: torsion in coordinates, with the half and traced."""

from geomtorsion.geometry import Frame, cartan
from geomtorsion.spaces import load
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
from geomtorsion.teaching.exercises.families import circles, groups, mixed


def make(draw: Draw, text: Texts) -> Variant:
    """Spherical legs in flat space for seed 0; other seeds: groups and circles."""
    frame = draw.choice((load("flat_spherical").frame, *mixed(circles(), groups())))
    n, torsion = frame.dimension, cartan(frame).torsion
    return Variant(
        statement=text("statement", forms=tex.forms(frame), coordinates=tex.symbols(frame)),
        questions=(
            Question(
                name="torsion",
                kind="components",
                prompt=text("torsion.prompt"),
                domain=Domain.of(frame),
                answer=lambda: torsion.S,
                errors=lambda: [
                    Mistake("factor", torsion.T, text("torsion.factor")),
                    Mistake("basis", torsion.S.in_frame()),
                    Mistake("levi-civita", {}, text("torsion.levi-civita")),
                ],
                shape=(n, n, n),
                label="S",
                marks="__^",
                remarks=TORSION.of(text.language),
                symmetry="antisymmetric",
                points=2,
            ),
            Question(
                name="vector",
                kind="components",
                prompt=text("vector.prompt"),
                domain=Domain.of(frame),
                answer=lambda: torsion.vector,
                errors=lambda: [
                    Mistake("basis", torsion.vector.in_frame()),
                    Mistake("sign", -torsion.vector, text("vector.sign")),
                ],
                shape=(n,),
                label="v",
                remarks=TORSION.of(text.language),
            ),
        ),
        hints=text.all("hints"),
        worked=lambda: _worked(text, frame),
    )


def _worked(text: Texts, frame: Frame) -> tuple[Step, ...]:
    """The connection, its antisymmetric part, the trace."""
    table = by_hand.cartan_table(frame)
    keys = {*table, *((b, a, c) for a, b, c in table)}
    torsion = by_hand.nonzero(
        {(a, b, c): (table.get((a, b, c), 0) - table.get((b, a, c), 0)) / 2 for a, b, c in keys}
    )
    half = {key: value for key, value in torsion.items() if key[0] < key[1]}
    vector: dict[tuple[int, ...], object] = {}
    for (a, b, c), value in torsion.items():
        if b == c:
            vector[a,] = vector.get((a,), 0) + 2 * value
    vector = by_hand.nonzero(vector)
    return (
        Step(text("worked.1", connection=by_hand.listed("Gamma", table))),
        Step(text("worked.2", components=by_hand.listed("S", half)), "torsion", torsion),
        Step(text("worked.3", vector=by_hand.listed("v", vector, 0)), "vector", vector),
    )

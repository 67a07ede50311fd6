"""5.1: the Burgers vector of a small loop."""

import sympy as sp

from geomtorsion.geometry import Frame, cartan
from geomtorsion.teaching.exercises.authoring import (
    Domain,
    Draw,
    Mistake,
    Question,
    Step,
    Texts,
    Variant,
    by_hand,
    scaled,
    tex,
)
from geomtorsion.teaching.exercises.families import bodies, frame_of, groups, mixed


def make(draw: Draw, text: Texts) -> Variant:
    """so3 and the plane of its first two legs for seed 0."""
    frame = frame_of(draw.choice(mixed(bodies(), groups())))
    area = sp.Symbol("A", positive=True)
    torsion = cartan(frame).torsion.T.in_frame()
    planes = sorted({(i, j) for i, j, _ in torsion.nonzero() if i < j})
    i, j = draw.choice(planes)

    def burgers() -> dict[tuple[int, ...], sp.Expr]:
        return {(k,): torsion[i, j, k] * area for k in range(3)}

    return Variant(
        statement=text(
            "statement",
            forms=tex.forms(frame),
            coordinates=tex.symbols(frame),
            first=i + 1,
            second=j + 1,
        ),
        questions=(
            Question(
                name="burgers",
                kind="components",
                prompt=text("burgers.prompt"),
                domain=Domain((area,)),
                answer=burgers,
                errors=lambda: [
                    Mistake("direction", scaled(burgers(), -1)),
                    Mistake(
                        "factor",
                        scaled(burgers(), sp.Rational(1, 2)),
                        text("burgers.factor", first=i + 1, second=j + 1),
                    ),
                ],
                shape=(3,),
                label="b",
            ),
        ),
        hints=text.all("hints", first=i + 1, second=j + 1),
        worked=lambda: _worked(text, frame, i, j, area),
    )


def _worked(text: Texts, frame: Frame, i: int, j: int, area: sp.Symbol) -> tuple[Step, ...]:
    """Stokes over a small area in the plane of two legs."""
    table = by_hand.anholonomy(frame)
    vector = [table.get((i, j, k), sp.S.Zero) * area for k in range(3)]
    pairs = {(i, j, k): table.get((i, j, k), sp.S.Zero) for k in range(3)}
    return (
        Step(text("worked.1", differentials=by_hand.differentials(frame))),
        Step(text("worked.2", first=i + 1, second=j + 1, components=by_hand.listed("2S", pairs))),
        Step(text("worked.3", components=", ".join(map(tex.tex, vector))), "burgers", vector),
    )

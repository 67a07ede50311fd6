"""6.2: the torque of the weight of a top, in the frame of the body."""

import sympy as sp

from geomtorsion.action import equations_of_motion
from geomtorsion.geometry import Frame
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
from geomtorsion.teaching.exercises.families import Body, vectors

# The attitude of the paper.
BODY = Body("zyz")


def make(draw: Draw, text: Texts) -> Variant:
    """Centre of mass on the third axis for seed 0; other seeds: elsewhere in the body."""
    frame = BODY.frame
    weight = sp.Symbol("W", positive=True)
    place = draw.choice(vectors()[1:])
    potential = weight * (BODY.rotation() * sp.Matrix(place))[2]
    n = frame.dimension

    def moment() -> list[sp.Expr]:
        u = sp.symbols("u1 u2 u3")
        energy = sp.Add(*(x**2 / 2 for x in u)) - potential
        return list(equations_of_motion(frame, energy).accelerations)

    def pushed(table: Frame, legs: bool = True) -> list[sp.Expr]:
        slopes = [-potential.diff(x) for x in frame.coordinates]
        rows = table.legs if legs else table.coframe
        return [
            sp.Add(*((rows[mu, k] if legs else rows[k, mu]) * slopes[mu] for mu in range(n)))
            for k in range(n)
        ]

    return Variant(
        statement=text(
            "statement",
            coframe=tex.coframe(frame),
            point=", ".join(map(str, place)),
            potential=tex.tex(potential),
        ),
        questions=(
            Question(
                name="moment",
                kind="components",
                prompt=text("moment.prompt"),
                domain=Domain.of(frame, weight),
                answer=moment,
                errors=lambda: [
                    Mistake(
                        "basis",
                        [-potential.diff(x) for x in frame.coordinates],
                        text("moment.basis"),
                    ),
                    Mistake("inverse", pushed(frame, legs=False)),
                    Mistake("axes", pushed(BODY.space_frame)),
                    Mistake("sign", scaled(moment(), -1), text("moment.sign")),
                ],
                shape=(3,),
                label="M",
                points=2,
            ),
        ),
        hints=text.all("hints", row=tex.matrix(BODY.rotation()[2, :].tolist())),
        worked=lambda: _worked(text, place, weight),
    )


def _worked(text: Texts, place: tuple[int, ...], weight: sp.Symbol) -> tuple[Step, ...]:
    """A vector product with the vertical as the body sees it."""
    vertical = list(BODY.rotation()[2, :])
    moment = [by_hand.tidy(-weight * x) for x in by_hand.cross(place, vertical)]
    return (
        Step(text("worked.1", vertical=tex.matrix([vertical]))),
        Step(text("worked.2")),
        Step(
            text(
                "worked.3",
                point=", ".join(map(str, place)),
                moment=tex.matrix([[x] for x in moment]),
            ),
            "moment",
            moment,
        ),
    )

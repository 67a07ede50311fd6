"""6.1: Euler's equations, eq. (1) of the paper."""

from itertools import permutations

import sympy as sp

from geomtorsion.action import equations_of_motion
from geomtorsion.geometry import Frame
from geomtorsion.spaces import load
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


def make(draw: Draw, text: Texts) -> Variant:
    """Moments as letters for seed 0, as numbers for other seeds."""
    frame = load("so3").frame
    turns = omegas()
    letters = sp.symbols("I1 I2 I3", positive=True)
    moments = draw.choice((letters, *permutations(map(sp.Integer, range(1, 8)), 3)))
    symbols = letters if moments == letters else ()
    values = ",\\ ".join(f"I_{k + 1} = {tex.tex(x)}" for k, x in enumerate(moments))
    return Variant(
        statement=text("statement") if symbols else text("numbers", values=values),
        questions=(
            Question(
                name="equations",
                kind="equations",
                prompt=text("equations.prompt"),
                domain=Domain((*turns, *symbols)),
                answer=lambda: turning(frame, moments),
                errors=lambda: [
                    Mistake("naive", turning(frame, moments, "naive")),
                    Mistake(
                        "axes", turning(load("so3_right").frame, moments), text("equations.axes")
                    ),
                    Mistake(
                        "principle",
                        turning(frame, moments, "closed_in_image"),
                        text("equations.principle"),
                    ),
                ],
                unknowns=tuple(f"Omega{k}'" for k in (1, 2, 3)),
                generic=("sign", "factor"),
                points=2,
            ),
        ),
        hints=text.all("hints"),
        worked=lambda: _worked(text, moments),
    )


def omegas() -> tuple[sp.Symbol, ...]:
    """The angular velocity as symbols."""
    return sp.symbols("Omega1 Omega2 Omega3", real=True)


def turning(
    frame: Frame, moments: tuple[sp.Expr, ...], principle: str = "closed_in_coordinates"
) -> list[sp.Expr]:
    """Omega'_k of a free body, by the equations of motion of the library."""
    u = sp.symbols("u1 u2 u3")
    energy = sp.Add(*(m * x**2 / 2 for m, x in zip(moments, u, strict=True)))
    accelerations = equations_of_motion(frame, energy, principle=principle).accelerations
    table = dict(zip(u, omegas(), strict=True))
    return [value.xreplace(table) for value in accelerations]


def _worked(text: Texts, moments: tuple[sp.Expr, ...]) -> tuple[Step, ...]:
    """A vector product."""
    turns = omegas()
    momenta = [m * w for m, w in zip(moments, turns, strict=True)]
    change = [-x for x in by_hand.cross(turns, momenta)]
    rates = [sp.factor(x / m) for x, m in zip(change, moments, strict=True)]
    return (
        Step(text("worked.1", momenta=", ".join(map(tex.tex, momenta)))),
        Step(text("worked.2", change=tex.matrix([[sp.factor(x)] for x in change]))),
        Step(text("worked.3", rates=tex.matrix([[x] for x in rates])), "equations", rates),
    )

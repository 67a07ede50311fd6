"""5.4: loops around a dislocation, once and several times."""

from functools import cache

import sympy as sp

from geomtorsion.loops import Loop, exact_burgers_vector
from geomtorsion.spaces import load
from geomtorsion.teaching.exercises.authoring import (
    Domain,
    Draw,
    Mistake,
    Question,
    Step,
    Texts,
    Variant,
    scaled,
    tex,
)


def make(draw: Draw, text: Texts) -> Variant:
    """A screw along z; the seed chooses how often the loop winds around it, and in which sense."""
    frame = load("screw_dislocation").frame
    b = frame.parameters[0]
    turns = draw.choice((2, -3, 3, -1, 1, -2, 4, -4))
    radius = draw.choice((1, 2, 3, 4))
    away = radius + draw.choice((1, 2))
    around = Loop.circle([0, 0, 0], radius, plane=(0, 1))
    winding = around.times(turns)
    next_to_it = Loop.circle([away, 0, 0], sp.Rational(radius, 2), plane=(0, 1))

    @cache
    def vector(loop: Loop) -> dict[tuple[int, ...], sp.Expr]:
        components = exact_burgers_vector(frame, loop).vector
        return {(k,): value for k, value in enumerate(components)}

    return Variant(
        statement=text("statement"),
        questions=(
            Question(
                name="around",
                kind="components",
                prompt=text("around.prompt", radius=radius, turning=_turning(text, turns)),
                domain=Domain((b,)),
                answer=lambda: vector(winding),
                errors=lambda: [
                    Mistake("direction", scaled(vector(winding), -1)),
                    Mistake(
                        "forgotten",
                        scaled(vector(around), 1 if turns > 0 else -1),
                        text("around.forgotten"),
                    ),
                    Mistake("forgotten", {}, text("around.forgotten_axis")),
                ],
                shape=(3,),
                label="b",
            ),
            Question(
                name="beside",
                kind="components",
                prompt=text("beside.prompt", away=away),
                domain=Domain((b,)),
                answer=lambda: vector(next_to_it),
                errors=lambda: [Mistake("another", vector(around), text("beside.another"))],
                shape=(3,),
                label="b",
            ),
        ),
        hints=text.all("hints"),
        worked=lambda: _worked(text, turns, b),
    )


def _turning(text: Texts, turns: int) -> str:
    """How often and in which sense the loop winds around the axis."""
    first, second = "xy" if turns > 0 else "yx"
    if abs(turns) == 1:
        return text("turning.once", first=first, second=second)
    return text("turning.several", times=abs(turns), first=first, second=second)


def _worked(text: Texts, turns: int, b: sp.Symbol) -> tuple[Step, ...]:
    """A closed form whose integral counts turns."""
    return (
        Step(text("worked.1")),
        Step(
            text("worked.2", turning=_turning(text, turns), halves=2 * turns, b=tex.tex(turns * b)),
            "around",
            {(2,): turns * b},
        ),
        Step(text("worked.3"), "beside", {}),
    )

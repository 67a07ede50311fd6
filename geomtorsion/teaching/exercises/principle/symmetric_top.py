"""6.4: the free symmetric top, seen from the body and from space."""

from itertools import permutations

import sympy as sp

from geomtorsion.action import equations_of_motion
from geomtorsion.spaces import load
from geomtorsion.teaching.exercises.authoring import (
    Domain,
    Draw,
    Mistake,
    Question,
    Step,
    Texts,
    Variant,
    tex,
)
from geomtorsion.teaching.exercises.principle.euler import omegas, turning


def make(draw: Draw, text: Texts) -> Variant:
    """Letters for seed 0; other seeds: moments as numbers."""
    w, v = sp.symbols("w v", positive=True)
    letters = sp.symbols("A C", positive=True)
    across, along = draw.choice((letters, *permutations(map(sp.Integer, range(1, 10)), 2)))
    letters = tuple(x for x in (across, along) if x.is_Symbol)
    domain = Domain((*letters, w, v))
    turns = omegas()

    def in_body() -> sp.Expr:
        first = turning(load("so3").frame, (across, across, along))[0]
        return -first.diff(turns[1]).subs(turns[2], w)

    def in_space() -> sp.Expr:
        u = sp.symbols("u1 u2 u3")
        energy = (across * (u[0] ** 2 + u[1] ** 2) + along * u[2] ** 2) / 2
        momenta = equations_of_motion(load("so3").frame, energy).momenta
        square = sp.Add(*(p**2 for p in momenta)).subs({u[0]: v, u[1]: 0, u[2]: w})
        return sp.sqrt(square) / across

    return Variant(
        statement=text("statement", across=tex.tex(across), along=tex.tex(along)),
        questions=(
            Question(
                name="body",
                kind="expression",
                prompt=text("body.prompt"),
                domain=domain,
                answer=in_body,
                errors=lambda: [Mistake("axes", in_space(), text("body.axes"))],
            ),
            Question(
                name="space",
                kind="expression",
                prompt=text("space.prompt"),
                domain=domain,
                answer=in_space,
                errors=lambda: [
                    Mistake("axes", in_body(), text("space.axes")),
                    Mistake("forgotten", along * w / across, text("space.forgotten")),
                ],
                points=2,
            ),
        ),
        hints=text.all("hints"),
        worked=lambda: _worked(text, across, along, w, v),
    )


def _worked(
    text: Texts, across: sp.Expr, along: sp.Expr, w: sp.Symbol, v: sp.Symbol
) -> tuple[Step, ...]:
    """A linear equation in the body, a constant vector in space."""
    inside = (along - across) * w / across
    outside = sp.sqrt(across**2 * v**2 + along**2 * w**2) / across
    return (
        Step(text("worked.1")),
        Step(text("worked.2", inside=tex.tex(inside)), "body", inside),
        Step(text("worked.3")),
        Step(text("worked.4", outside=tex.tex(outside)), "space", outside),
    )

"""6.5: the velocity of a body in its own frame, eq. (2) of the paper."""

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
    by_hand,
    tex,
)
from geomtorsion.teaching.exercises.families import vectors
from geomtorsion.teaching.exercises.principle.euler import omegas


def make(draw: Draw, text: Texts) -> Variant:
    """No force for seed 0; other seeds: a thruster fixed in the body."""
    mass = sp.Symbol("M", positive=True)
    push = [sp.Integer(x) for x in draw.choice(vectors())]
    speeds = sp.symbols("V1 V2 V3", real=True)
    turns = omegas()
    force = ", ".join(map(str, push))

    def rates(principle: str = "closed_in_coordinates", pushed: bool = True) -> list[sp.Expr]:
        u = sp.symbols("u1:7")
        energy = sp.Add(*(x**2 / 2 for x in u[:3])) + mass * sp.Add(*(x**2 / 2 for x in u[3:]))
        forces = [0, 0, 0, *(push if pushed else (0, 0, 0))]
        motion = equations_of_motion(load("r3xso3").frame, energy, forces, principle)
        table = dict(zip(u, (*turns, *speeds), strict=True))
        return [value.xreplace(table) for value in motion.accelerations[3:]]

    def expected() -> list[Mistake]:
        cross = rates(pushed=False)
        turned = [right - 2 * term for right, term in zip(rates(), cross, strict=True)]
        return [
            Mistake("naive", rates("naive")),
            Mistake("principle", rates("closed_in_image"), text("equations.principle")),
            Mistake("axes", turned, text("equations.axes")),
            Mistake("forgotten", cross, text("equations.forgotten")),
            Mistake(
                "forgotten",
                [term + mass * (right - term) for right, term in zip(rates(), cross, strict=True)],
                text("equations.forgotten_mass"),
            ),
        ]

    return Variant(
        statement=text("pushed", force=force) if any(push) else text("statement"),
        questions=(
            Question(
                name="equations",
                kind="equations",
                prompt=text("equations.prompt"),
                domain=Domain((*turns, *speeds, mass)),
                answer=rates,
                errors=expected,
                unknowns=("V1'", "V2'", "V3'"),
                generic=("sign",),
                points=2,
            ),
        ),
        hints=text.all("hints"),
        worked=lambda: _worked(text, mass, push),
    )


def _worked(text: Texts, mass: sp.Symbol, push: list[sp.Expr]) -> tuple[Step, ...]:
    """A vector at rest in space, seen from the body."""
    speeds = sp.symbols("V1 V2 V3", real=True)
    turning = [-x for x in by_hand.cross(omegas(), speeds)]
    rates = [x + f / mass for x, f in zip(turning, push, strict=True)]
    return (
        Step(text("worked.1")),
        Step(text("worked.2", turning=tex.matrix([[x] for x in turning]))),
        Step(
            text(
                "worked.3", force=", ".join(map(str, push)), rates=tex.matrix([[x] for x in rates])
            ),
            "equations",
            rates,
        ),
    )

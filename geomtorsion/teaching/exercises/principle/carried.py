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
    Variant,
    by_hand,
    steps,
    tex,
)
from geomtorsion.teaching.exercises.families import vectors
from geomtorsion.teaching.exercises.principle.euler import omegas


def make(draw: Draw) -> Variant:
    """No force for seed 0; other seeds: a thruster fixed in the body."""
    mass = sp.Symbol("M", positive=True)
    push = [sp.Integer(x) for x in draw.choice(vectors())]
    speeds = sp.symbols("V1 V2 V3", real=True)
    turns = omegas()
    sentence = (
        "No force acts on it."
        if not any(push)
        else "A thruster fixed in the body exerts a force on the centre of mass, with the "
        f"components $F = ({', '.join(map(str, push))})$ along the axes of the body."
    )

    def rates(principle: str = "closed_in_coordinates", force: bool = True) -> list[sp.Expr]:
        u = sp.symbols("u1:7")
        energy = sp.Add(*(x**2 / 2 for x in u[:3])) + mass * sp.Add(*(x**2 / 2 for x in u[3:]))
        forces = [0, 0, 0, *(push if force else (0, 0, 0))]
        motion = equations_of_motion(load("r3xso3").frame, energy, forces, principle)
        table = dict(zip(u, (*turns, *speeds), strict=True))
        return [value.xreplace(table) for value in motion.accelerations[3:]]

    def expected() -> list[Mistake]:
        cross = rates(force=False)
        turned = [right - 2 * term for right, term in zip(rates(), cross, strict=True)]
        return [
            Mistake("naive", rates("naive")),
            Mistake(
                "principle",
                rates("closed_in_image"),
                "These are the equations of the autoparallels (straightest lines) of the frame of "
                "rotations and translations. On an autoparallel the body moves like a screw. The "
                "centre of mass of a free body moves on a straight line.",
            ),
            Mistake(
                "axes",
                turned,
                "The term with $\\Omega\\times V$ has the opposite sign. In body axes, a vector "
                "that is constant in space has the rate $-\\Omega\\times V$.",
            ),
            Mistake("forgotten", cross, "The force is missing."),
            Mistake(
                "forgotten",
                [term + mass * (right - term) for right, term in zip(rates(), cross, strict=True)],
                "Divide the force by the mass.",
            ),
        ]

    return Variant(
        statement=(
            "A body of mass $M$ has the angular velocity $\\Omega$, and its centre of mass has the "
            "velocity $V$. The components of both are along the axes of the **body**. " + sentence
        ),
        questions=(
            Question(
                name="equations",
                kind="equations",
                prompt="Give three equations for `V1'`, `V2'`, `V3'`, separated by semicolons. "
                "`V1'` is the time derivative of `V1`.",
                domain=Domain((*turns, *speeds, mass)),
                answer=rates,
                errors=expected,
                unknowns=("V1'", "V2'", "V3'"),
                generic=("sign",),
                points=2,
            ),
        ),
        hints=steps(
            r"Along axes fixed in space, momentum $p$ and force $f$ obey $\dot p = f$. If a vector "
            "is constant in space, how do its components along the axes of the body change?",
            r"Let $P = MV$ and $F$ be the momentum and the force along the axes of the body. They "
            r"obey $\dot P + \Omega\times P = F$.",
        ),
        worked=lambda: _worked(mass, push),
    )


def _worked(mass: sp.Symbol, push: list[sp.Expr]) -> tuple[Step, ...]:
    """A vector at rest in space, seen from the body."""
    speeds = sp.symbols("V1 V2 V3", real=True)
    turning = [-x for x in by_hand.cross(omegas(), speeds)]
    rates = [x + f / mass for x, f in zip(turning, push, strict=True)]
    return (
        Step(
            r"Seen from the body, a vector that is constant in space rotates with $-\Omega$: "
            r"$\dot P = -\Omega\times P$. With the force $F$ along the axes of the body, the "
            r"momentum $P = MV$ obeys $\dot P + \Omega\times P = F$."
        ),
        Step(
            r"The vector product is "
            f"$$-\\Omega\\times V = {tex.matrix([[x] for x in turning])}.$$"
        ),
        Step(
            f"Add $F/M$ with $F = ({', '.join(map(str, push))})$: "
            f"$$\\dot V = {tex.matrix([[x] for x in rates])}.$$",
            "equations",
            rates,
        ),
    )

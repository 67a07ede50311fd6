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
    Variant,
    by_hand,
    scaled,
    steps,
    tex,
)
from geomtorsion.teaching.exercises.families import Body, vectors

# The attitude of the paper.
BODY = Body("zyz")


def make(draw: Draw) -> Variant:
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
        statement=(
            "A top rotates about a fixed point. Its attitude is "
            r"$R = R_z(\phi_3)R_y(\phi_2)R_z(\phi_1)$, and its body-fixed coframe is "
            f"$$e = {tex.coframe(frame)}.$$ "
            "Along the axes of the body, its centre of mass is at "
            f"$({', '.join(map(str, place))})$. $W$ is the weight times the unit of "
            "length. The potential energy is "
            f"\n\n$$V = {tex.tex(potential)}.$$"
        ),
        questions=(
            Question(
                name="moment",
                kind="components",
                prompt=r"Find the torque of the weight along the axes of the **body**, "
                r"$M_k = -E_k{}^\mu\,\partial_\mu V$. The leg $E_k$ is column $k$ of $e^{-1}$.",
                domain=Domain.of(frame, weight),
                answer=moment,
                errors=lambda: [
                    Mistake(
                        "basis",
                        [-potential.diff(x) for x in frame.coordinates],
                        r"These are the components $-\partial_\mu V$ in the coordinates. Multiply "
                        r"them by the legs $E_k{}^\mu$.",
                    ),
                    Mistake("inverse", pushed(frame, legs=False)),
                    Mistake("axes", pushed(BODY.space_frame)),
                    Mistake(
                        "sign",
                        scaled(moment(), -1),
                        "The sign is wrong: the torque acts towards smaller $V$.",
                    ),
                ],
                shape=(3,),
                label="M",
                points=2,
            ),
        ),
        hints=steps(
            "If the body has the angular velocity $\\Omega$, the power of the torque is "
            "$M_k\\Omega^k = -\\dot V$.",
            r"As vectors in the body: $M = -W\,l\times n$, where $l$ is the position of the centre "
            "of mass and $n$ the unit vector of the upward vertical.",
            r"Along the axes of the body, $n$ is the last row of $R$: "
            f"$$n = {tex.matrix(BODY.rotation()[2, :].tolist())}.$$",
        ),
        worked=lambda: _worked(place, weight),
    )


def _worked(place: tuple[int, ...], weight: sp.Symbol) -> tuple[Step, ...]:
    """A vector product with the vertical as the body sees it."""
    vertical = list(BODY.rotation()[2, :])
    moment = [by_hand.tidy(-weight * x) for x in by_hand.cross(place, vertical)]
    return (
        Step(
            "The unit vector of the upward vertical, seen from the body, is the last row of $R$: "
            f"$$n = {tex.matrix([vertical])}.$$"
        ),
        Step(
            r"Let $l$ be the position of the centre of mass in the body. Seen from the body, "
            r"$\dot n = -\Omega\times n$. So the potential energy $V = W\,l\cdot n$ has the rate "
            r"$\dot V = -W\,l\cdot(\Omega\times n) = W\,\Omega\cdot(l\times n)$. The power of the "
            r"torque is $M\cdot\Omega = -\dot V$, so $M = -W\,l\times n$."
        ),
        Step(
            f"With $l = ({', '.join(map(str, place))})$: "
            f"$$M = {tex.matrix([[x] for x in moment])}.$$",
            "moment",
            moment,
        ),
    )

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
    Variant,
    by_hand,
    steps,
    tex,
)


def make(draw: Draw) -> Variant:
    """Moments as letters for seed 0, as numbers for other seeds."""
    frame = load("so3").frame
    turns = omegas()
    letters = sp.symbols("I1 I2 I3", positive=True)
    moments = draw.choice((letters, *permutations(map(sp.Integer, range(1, 8)), 3)))
    symbols = letters if moments == letters else ()
    values = ",\\ ".join(f"I_{k + 1} = {tex.tex(x)}" for k, x in enumerate(moments))
    where = "" if symbols else f" with ${values}$"
    return Variant(
        statement=(
            r"A body rotates freely about its centre of mass. Its Lagrangian is the kinetic energy "
            r"$L = \tfrac12\,(I_1\Omega_1^2 + I_2\Omega_2^2 + I_3\Omega_3^2)$" + where + r", where "
            r"$\Omega$ is the angular velocity along the axes of the body. Vary the action. The "
            "rotation angles stay fixed at the start and at the end time (Hamilton's principle in "
            "the frame of the body)."
        ),
        questions=(
            Question(
                name="equations",
                kind="equations",
                prompt="Give three equations for `Omega1'`, `Omega2'`, `Omega3'`, separated by "
                "semicolons, in any equivalent form. `Omega1'` is the time derivative of `Omega1`.",
                domain=Domain((*turns, *symbols)),
                answer=lambda: turning(frame, moments),
                errors=lambda: [
                    Mistake("naive", turning(frame, moments, "naive")),
                    Mistake(
                        "axes",
                        turning(load("so3_right").frame, moments),
                        "The terms with $\\Omega\\times p$ have the opposite sign. In body axes "
                        "$\\dot p = -\\Omega\\times p$ with $p_i = I_i\\,\\Omega_i$.",
                    ),
                    Mistake(
                        "principle",
                        turning(frame, moments, "closed_in_image"),
                        "These are the equations of the autoparallels (straightest lines). They "
                        "follow from Kleinert's principle, which fixes the end points of the flat "
                        "image $x^i(t)$ with $\\dot x^i = \\Omega_i$. Here the angles are fixed.",
                    ),
                ],
                unknowns=tuple(f"Omega{k}'" for k in (1, 2, 3)),
                generic=("sign", "factor"),
                points=2,
            ),
        ),
        hints=steps(
            r"The frame velocities are $u^i = \Omega_i$. The torsion in the frame consists of the "
            r"structure constants of the rotations: $2S_{ijk} = -\epsilon_{ijk}$, where "
            r"$\epsilon_{123} = 1$ and each exchange of two indices changes the sign. Insert them "
            r"into $\dot p_k = 2S_{kj}{}^i\,u^j p_i$ with $p_i = \partial L/\partial u^i$.",
            r"As vectors: $\dot p = -\Omega\times p$ with $p = (I_1\Omega_1, I_2\Omega_2, "
            r"I_3\Omega_3)$.",
            r"The first equation is $I_1\dot\Omega_1 = (I_2 - I_3)\,\Omega_2\Omega_3$.",
        ),
        worked=lambda: _worked(moments),
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


def _worked(moments: tuple[sp.Expr, ...]) -> tuple[Step, ...]:
    """A vector product."""
    turns = omegas()
    momenta = [m * w for m, w in zip(moments, turns, strict=True)]
    change = [-x for x in by_hand.cross(turns, momenta)]
    rates = [sp.factor(x / m) for x, m in zip(change, moments, strict=True)]
    return (
        Step(
            r"The momenta are $p_i = \partial L/\partial\Omega_i$: $p = ("
            f"{', '.join(map(tex.tex, momenta))})$."
        ),
        Step(
            r"The torsion in this frame is $2S_{ijk} = -\epsilon_{ijk}$. So the equations of "
            r"motion $\dot p_k = 2S_{kj}{}^i\,\Omega^j p_i$ become $\dot p = -\Omega\times p$: "
            f"$$\\dot p = {tex.matrix([[sp.factor(x)] for x in change])}.$$"
        ),
        Step(
            "Divide by the moments of inertia: "
            f"$$\\dot\\Omega = {tex.matrix([[x] for x in rates])}.$$",
            "equations",
            rates,
        ),
    )
